//! How the errors of a pilot's squares count: as relMSE of the picture would, but for the few pixels that have most of it.
//!
//! A pilot sees a small part of the picture. Whether it meets pixels that have many times the error of others, such as those that a far
//! lamp fills in part, is chance, and the error of few samples there is chance too; both would say which way is best. So the pixels that are
//! the noisiest in some way are left out of all ways.

use crate::render::order::SQUARE;

/// Share of the pixels with noise that is left out.
const LEFT_OUT: f64 = 0.02;

/// Luminances of a square's pixels and the variances of these.
pub(super) type Pixels = Vec<[f64; 2]>;

/// What errors of the squares' pixels are divided by, and which of them count.
#[derive(Clone, Debug)]
pub(super) struct Measure {
    /// For each square and pixel.
    squared: Vec<Vec<f64>>,
    is_left_out: Vec<Vec<bool>>,
}

impl Measure {
    /// From the pixels of each square in each way, where not all squares have all ways, and the means of their pixels.
    pub fn of(squares: &[Vec<&[[f64; 2]]>], means: &[Vec<f64>]) -> Self {
        let all: Vec<f64> = means.iter().flatten().copied().collect();
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        let floor = (1e-2 * mean * mean).max(f64::MIN_POSITIVE);
        let squared: Vec<Vec<f64>> = means.iter().map(|means| blurred(means, floor)).collect();
        let error = |square: usize, way: &[[f64; 2]], pixel: usize| way[pixel][1] / squared[square][pixel];
        let ways = squares.iter().map(|ways| ways.len()).max().unwrap_or(0);
        // Ways with little noise have noisy pixels too.
        let typical = (0..ways).map(|way| {
            let of = squares.iter().enumerate().filter_map(|(square, ways)| Some((square, ways.get(way)?)));
            let errors = of.flat_map(|(square, way)| (0..way.len()).map(move |pixel| (square, way, pixel)));
            let mut errors: Vec<f64> =
                errors.map(|(square, way, pixel)| error(square, way, pixel)).filter(|&it| it > 0.0).collect();
            errors.sort_unstable_by(f64::total_cmp);
            errors.get(errors.len() * 3 / 4).copied().unwrap_or(1.0)
        });
        let typical: Vec<f64> = typical.collect();
        let noise = |square: usize, pixel: usize| {
            let ways = squares[square].iter().zip(&typical);
            ways.map(|(way, typical)| error(square, way, pixel) / typical).fold(0.0, f64::max)
        };
        let noise: Vec<Vec<f64>> = means
            .iter()
            .enumerate()
            .map(|(square, means)| (0..means.len()).map(|pixel| noise(square, pixel)).collect())
            .collect();
        let mut sorted: Vec<f64> = noise.iter().flatten().copied().filter(|&noise| noise > 0.0).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let kept = ((1.0 - LEFT_OUT) * sorted.len() as f64).ceil() as usize;
        let most = kept.checked_sub(1).map_or(f64::INFINITY, |last| sorted[last]);
        let is_left_out = noise.iter().map(|square| square.iter().map(|&noise| noise > most).collect()).collect();
        Self { squared, is_left_out }
    }

    /// All pixels count, each square by its own light: the error of a bias is no chance.
    pub fn whole(means: &[Vec<f64>]) -> Self {
        let is_left_out = means.iter().map(|means| vec![false; means.len()]).collect();
        Self { squared: means.iter().map(|means| squared(means)).collect(), is_left_out }
    }

    /// What relMSE divides the pixels of a square by.
    pub fn squared(&self, square: usize) -> &[f64] {
        &self.squared[square]
    }

    /// Whether the noise of this pixel does not count.
    pub fn leaves_out(&self, square: usize, pixel: usize) -> bool {
        self.is_left_out[square][pixel]
    }

    /// The error of a square by the variances of its pixels, in any way.
    pub fn error(&self, square: usize, pixels: &[[f64; 2]]) -> f64 {
        let squared = self.squared[square].iter().zip(&self.is_left_out[square]);
        let errors = pixels.iter().zip(squared).filter(|(_, (_, is_left_out))| !**is_left_out);
        let sum: f64 = errors.map(|([_, variance], (squared, _))| variance / squared).filter(|it| it.is_finite()).sum();
        sum / self.squared[square].len().max(1) as f64
    }
}

/// What relMSE of a square by itself divides its pixels by, from their means.
pub(super) fn squared(means: &[f64]) -> Vec<f64> {
    let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
    blurred(means, (1e-2 * mean * mean).max(f64::MIN_POSITIVE))
}

/// Squares of a square's means over 3 x 3 pixels, with a floor, because a pixel's own mean is large where chance made its error large.
fn blurred(means: &[f64], floor: f64) -> Vec<f64> {
    let side = SQUARE as usize;
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
    let blurred = |pixel: usize| {
        let (x, y) = (pixel % side, pixel / side);
        let (mut sum, mut count) = (0.0, 0.0);
        for y in around(y) {
            for x in around(x) {
                (sum, count) = (sum + means[y * side + x], count + 1.0);
            }
        }
        let mean: f64 = sum / count;
        mean * mean + floor
    };
    (0..means.len()).map(blurred).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXELS: usize = (SQUARE * SQUARE) as usize;

    /// Squares of grey pixels of 2 in two ways with these variances, but for some pixels whose variances are these.
    fn squares(variances: [f64; 2], others: &[(usize, usize, [f64; 2])]) -> Vec<Vec<Pixels>> {
        let mut squares = vec![variances.map(|variance| vec![[2.0, variance]; PIXELS]).to_vec(); 10];
        for (square, pixel, variances) in others {
            (0..2).for_each(|way| squares[*square][way][*pixel][1] = variances[way]);
        }
        squares
    }

    fn errors(squares: &[Vec<Pixels>]) -> [f64; 2] {
        let of: Vec<Vec<&[[f64; 2]]>> = squares.iter().map(|ways| ways.iter().map(Vec::as_slice).collect()).collect();
        let measure = Measure::of(&of, &vec![vec![2.0; PIXELS]; squares.len()]);
        [0, 1].map(|way| (0..squares.len()).map(|square| measure.error(square, &squares[square][way])).sum::<f64>())
    }

    #[test]
    fn errors_are_variances_over_squared_means() {
        let [few, many] = errors(&squares([0.4, 0.1], &[]));
        // The floor is a hundredth of the squared mean of all.
        let expected = 10.0 * 0.4 / 4.04;
        assert!((few / expected - 1.0).abs() < 1e-12 && (many / few - 0.25).abs() < 1e-12, "{few}, {many}");
        assert_eq!(errors(&squares([0.0, 0.0], &[])), [0.0, 0.0]);
    }

    #[test]
    fn pixels_that_are_noisy_in_one_way_count_in_none() {
        let plain = errors(&squares([0.4, 0.1], &[]));
        let one = (10 * PIXELS) as f64;
        for variances in [[1e6, 0.1], [0.4, 1e6], [1e6, 1e6], [0.5, 10.0]] {
            let found = errors(&squares([0.4, 0.1], &[(3, 17, variances), (7, 0, variances)]));
            for (found, plain) in found.into_iter().zip(plain) {
                assert!((found / plain - (1.0 - 2.0 / one)).abs() < 1e-9, "{variances:?}: {found}, {plain}");
            }
        }
        // Where most pixels have no noise, those that have some are what counts.
        let others: Vec<_> = (0..100).map(|at| (at / 50, at % 50, [0.2, 0.1])).collect();
        let found = errors(&squares([0.0, 0.0], &others));
        assert!((found[0] / (100.0 * 0.2 / 4.04 / PIXELS as f64) - 1.0).abs() < 1e-12, "{found:?}");
        // A fiftieth of the pixels at most.
        let many: Vec<_> = (0..200).map(|at| (at / 50, at % 50, [40.0, 10.0])).collect();
        let found = errors(&squares([0.4, 0.1], &many));
        assert!((found[0] / found[1] - 4.0).abs() < 1e-12 && found[0] > 20.0 * plain[0], "{found:?}");
    }

    #[test]
    fn a_bright_pixel_is_measured_by_its_surroundings() {
        let mut means = vec![1.0; PIXELS];
        means[9] = 1000.0;
        let squared = blurred(&means, 0.5);
        assert!((squared[9] - (1008.0_f64 / 9.0).powi(2) - 0.5).abs() < 1e-9, "{}", squared[9]);
        assert_eq!(squared[63], 1.5);
    }
}
