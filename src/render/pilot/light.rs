//! What light paths tell a pilot of its squares.

use std::collections::BTreeMap;

use super::SEED;
use super::gain::{Caustics, TIMES_AS_MANY};
use super::measure::Measure;
use super::size::Size;
use crate::control::Parallel;
use crate::error::Result;
use crate::integrator::aim::Aims;
use crate::integrator::light_tracing::{LightPaths, PATHS_A_BLOCK};
use crate::render::order::SQUARE;
use crate::render::pass::PassInput;
use crate::render::ways::LIGHT_SEED;
use crate::spectrum::LUMINANCE_WEIGHTS;

/// The light that light paths bring to the squares.
#[derive(Debug)]
pub(super) struct Traced {
    /// Number of rays.
    pub rays: u64,
    /// Number of light paths.
    pub count: u32,
    /// For each square and pixel that some of them reach, the light, by the weights of the last way, and the moments of each way.
    brought: BTreeMap<(usize, usize), (f64, Vec<Caustics>)>,
}

/// None.
impl Default for Traced {
    fn default() -> Self {
        Self { rays: 0, count: 1, brought: BTreeMap::new() }
    }
}

impl Traced {
    /// The luminance that they bring to a pixel of a square.
    pub fn light(&self, square: usize, pixel: usize) -> f64 {
        self.brought.get(&(square, pixel)).map_or(0.0, |(light, _)| *light)
    }

    /// What they tell of a square's error in each of so many ways.
    pub fn caustics(&self, square: usize, ways: usize, measure: &Measure, size: Size) -> Vec<Caustics> {
        let mut caustics = vec![Caustics::default(); ways];
        let pixels = self.brought.range((square, 0)..(square + 1, 0));
        for (&(_, pixel), (_, moments)) in pixels {
            // Of the mean of a pixel's samples, and of the square's pixels.
            let scale = 1.0 / (measure.squared(square)[pixel] * size.samples_of(1.0));
            for (sum, of) in caustics.iter_mut().zip(moments) {
                // Light paths know of rare bright paths, which squares meet by chance; but the errors that these are taken off have none.
                let weighted = if measure.leaves_out(square, pixel) { 0.0 } else { of.weighted };
                sum.add(&Caustics { weighted, ..*of }, scale);
            }
        }
        caustics
    }
}

/// Traces light paths to the squares that begin at `origins`. `aims` are those of each way that all squares have.
///
/// # Errors
/// As [`super::pilot`].
pub(super) fn trace_light(
    input: &PassInput,
    paths: &LightPaths,
    count: u32,
    aims: &[Option<Aims>],
    origins: Vec<[u32; 2]>,
    parallel: &mut impl Parallel,
) -> Result<Traced> {
    let (scene, paths, aims, token) = (input.scene.clone(), paths.clone(), aims.to_vec(), parallel.token());
    let shares = f64::from(paths.count()) / f64::from(count);
    let blocks = parallel.map(count.div_ceil(PATHS_A_BLOCK) as usize, move |block| {
        let first = block as u32 * PATHS_A_BLOCK;
        let range = first..count.min(first + PATHS_A_BLOCK);
        let mut told = Vec::new();
        if token.is_cancelled() {
            return (told, 0);
        }
        let rays = paths.connections(&scene, (0, SEED ^ LIGHT_SEED), range, &mut |connection| {
            let inside = |origin: &[u32; 2]| {
                (0..2).all(|axis| {
                    let at = connection.place[axis] - origin[axis] as f32;
                    (0.0..SQUARE as f32).contains(&at)
                })
            };
            let Some(square) = origins.iter().position(inside) else { return };
            let [x, y] = [0, 1].map(|axis| (connection.place[axis] - origins[square][axis] as f32) as u32);
            let pixel = (y.min(SQUARE - 1) * SQUARE + x.min(SQUARE - 1)) as usize;
            let value = f64::from(connection.light.dot(LUMINANCE_WEIGHTS));
            let density = f64::from(connection.density);
            let [p, n, wi] = connection.at;
            let of = aims.iter().map(|aims| {
                let aimed = aims.as_ref().filter(|aims| !aims.is_empty()).map_or(0.0, |aims| aims.pdf(p, n, wi));
                let own = f64::from(connection.seen * (connection.pdf + aimed));
                let both = own + density;
                let moment = shares * value * value * density;
                let beside = TIMES_AS_MANY.map(|times| moment / (own + f64::from(times) * density));
                let caustics = Caustics { alone: moment / own, weighted: moment * own / (both * both), beside };
                (shares * value * density / both, caustics)
            });
            let of: Vec<(f64, Caustics)> = of.collect();
            told.push((square, pixel, of));
        });
        (told, rays)
    })?;
    parallel.check()?;
    let mut traced = Traced { count, ..Traced::default() };
    for (told, block_rays) in blocks {
        traced.rays += block_rays;
        for (square, pixel, of) in told {
            let (light, moments) =
                traced.brought.entry((square, pixel)).or_insert_with(|| (0.0, vec![Caustics::default(); of.len()]));
            *light += of.last().map(|(light, _)| *light).filter(|it| it.is_finite()).unwrap_or(0.0);
            for (sum, (_, of)) in moments.iter_mut().zip(&of).filter(|(_, (_, of))| of.alone.is_finite()) {
                sum.add(of, 1.0);
            }
        }
    }
    Ok(traced)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_count_for_their_square_and_those_of_noisy_pixels_for_rare_paths_alone() {
        let size = Size { across: 2, samples: 8 };
        let mut squares = vec![vec![[2.0, 0.1]; 64]; 4];
        squares[1][7][1] = 1e6;
        let ways: Vec<Vec<&[[f64; 2]]>> = squares.iter().map(|pixels| vec![pixels.as_slice()]).collect();
        let measure = Measure::of(&ways, &vec![vec![2.0; 64]; 4]);
        assert!(measure.leaves_out(1, 7) && !measure.leaves_out(1, 6));
        let of = Caustics { alone: 4.0, weighted: 1.0, beside: [2.0; TIMES_AS_MANY.len()] };
        let brought = [(0, 63), (1, 6), (1, 7), (2, 0)].map(|place| (place, (0.5, vec![of; 2])));
        let traced = Traced { rays: 10, count: 5, brought: brought.into_iter().collect() };
        assert_eq!([traced.light(1, 6), traced.light(1, 8), traced.light(3, 0)], [0.5, 0.0, 0.0]);
        // Of 64 pixels with 8 samples, whose squared mean is 4, and a hundredth of that more.
        let scale = 1.0 / (4.04 * 64.0 * 8.0);
        for caustics in traced.caustics(1, 2, &measure, size) {
            let expected = [8.0, 1.0, 4.0].map(|it| it * scale);
            for (found, expected) in [caustics.alone, caustics.weighted, caustics.beside[0]].into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{caustics:?}");
            }
        }
        assert_eq!(traced.caustics(3, 2, &measure, size), [Caustics::default(); 2]);
    }
}
