//! How far an image is from its expectation, as far as it can tell itself.

use super::{Film, PixelPhotonState, Tile, lock};
use crate::Cancel;
use crate::spectrum::{luminance, srgb_encode};

/// What the error of an image is measured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ErrorMeasure {
    /// relMSE: the mean over pixels and channels of squared error / (mean^2 + e), with e = 1 % of the squared mean of the
    /// whole image so that black pixels do not rule it. It falls about as 1 / N.
    #[default]
    RelMse,
    /// As a screen shows it: the root of the mean over pixels and channels of the squared error, in levels of 255, after
    /// clamping to [0, 1] and the sRGB curve. It falls about as 1 / sqrt(N).
    Display,
}

/// An estimate, and how far it may itself be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimated error.
    pub value: f64,
    /// Standard error of `value`, from the scatter over pixels. That counts what pixels differ by expectation as well, so it
    /// is rather too large; and it knows only of what has been sampled.
    pub standard_error: f64,
}

/// Samples of the pixels of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleCounts {
    /// Of the pixel that has fewest.
    pub min: u32,
    /// Of all pixels together, divided by their number.
    pub mean: f64,
    /// Of the pixel that has most.
    pub max: u32,
}

/// Variance of a pixel's mean over its square up to which it is a fair judge of its own error.
const KNOWN: f64 = 0.1;

/// Sums over pixels of what they add to a mean, from which its standard error follows.
#[derive(Clone, Copy, Default)]
struct Terms {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Terms {
    fn add(&mut self, term: f64) {
        self.count += 1.0;
        self.sum += term;
        self.squares += term * term;
    }

    /// Mean and its standard error; `None` if a pixel has no estimate, or there is no light to compare with.
    fn mean(&self) -> Option<ErrorEstimate> {
        // Products of noise alone may be negative.
        let value = if self.sum < 0.0 { 0.0 } else { self.sum / self.count };
        let scatter = (self.squares - self.sum * self.sum / self.count).max(0.0);
        // One pixel tells nothing of its kind: as if it were an exponential distribution's.
        let standard_error =
            if self.count > 1.0 { (scatter / (self.count * (self.count - 1.0))).sqrt() } else { value };
        value.is_finite().then_some(ErrorEstimate { value, standard_error })
    }
}

impl ErrorEstimate {
    /// Of the root of what this is the estimate of.
    fn root(self) -> Self {
        let value = self.value.sqrt();
        Self { value, standard_error: if value > 0.0 { 0.5 * self.standard_error / value } else { 0.0 } }
    }
}

impl Film {
    /// Estimated relMSE (see [`ErrorMeasure::RelMse`]), from the replicates' variances. Where photon maps are made anew for each
    /// pass, the square of their estimated bias is added: the product of two independent estimates of it, since the square of
    /// one would count its noise as bias.
    ///
    /// `None` until every pixel has an estimate (see [`Pixel::variance`](super::Pixel::variance)), and for an image without
    /// light.
    pub fn rel_mse(&self) -> Option<ErrorEstimate> {
        self.error(ErrorMeasure::RelMse)
    }

    /// Estimated error of what a screen shows, in levels of 255 (see [`ErrorMeasure::Display`]); exposure and tone maps are
    /// not thought of. A pixel's error is half of what the curve makes of one standard error to each side: its slope there
    /// where errors are small, and not too much near black and white where it ends.
    ///
    /// `None` where [`Film::rel_mse`] is.
    pub fn display_error(&self) -> Option<ErrorEstimate> {
        self.error(ErrorMeasure::Display)
    }

    /// Either of the two.
    pub fn error(&self, measure: ErrorMeasure) -> Option<ErrorEstimate> {
        self.error_unless(measure, &Cancel::new())
    }

    /// The same; `None` too if it was cancelled in the middle.
    pub(crate) fn error_unless(&self, measure: ErrorMeasure, cancel: &Cancel) -> Option<ErrorEstimate> {
        // Usually all pixels are as far: a first picture need not look at them all to learn that it knows nothing.
        let has_none =
            |tile: &Tile| tile.pixels.first().is_none_or(|first| first.variance(self.options.share)[0].is_nan());
        if self.tiles.first().is_none_or(|tile| has_none(&lock(tile))) {
            return None;
        }
        let mut terms = Terms::default();
        if !self.for_each_error(measure, false, cancel, |_, _, error| terms.add(error)) {
            return None;
        }
        match measure {
            ErrorMeasure::RelMse => terms.mean(),
            ErrorMeasure::Display => terms.mean().map(ErrorEstimate::root),
        }
    }

    /// Calls `visit` with the number of each pixel in rows, its samples, and its squared error as `measure` weighs it, the mean
    /// over channels; false if it was cancelled in the middle. `is_tame`: relative to the pixel's own mean instead
    /// of its surroundings', too small where samples are rare and bright, so that such are not all that counts.
    pub(crate) fn for_each_error(
        &self,
        measure: ErrorMeasure,
        is_tame: bool,
        cancel: &Cancel,
        mut visit: impl FnMut(usize, u32, f64),
    ) -> bool {
        let (weighted, share) = (self.options.weighted, self.options.share);
        let is_relative = measure == ErrorMeasure::RelMse;
        let mut means = Vec::new();
        if is_relative {
            means.resize(self.pixel_count(), [0.0; 3]);
            if !self.for_each_unless(cancel, |place, pixel, _| means[place] = pixel.mean(weighted)) {
                return false;
            }
        }
        let sum: f64 = means.iter().flatten().copied().map(f64::from).sum();
        let mean = sum / (3 * self.pixel_count()).max(1) as f64;
        let floor = 1e-2 * mean * mean;
        let levels = Levels::new(&means, self.options.resolution);
        self.for_each_unless(cancel, |place, pixel, beside| {
            let biases = beside.gathering.and_then(PixelPhotonState::biases).unwrap_or_default();
            let variances = pixel.variance(share);
            let own = pixel.mean(weighted);
            let is_known = || {
                let square = |mean: f32| f64::from(mean) * f64::from(mean);
                variances.iter().sum::<f64>() <= KNOWN * own.into_iter().map(square).sum::<f64>()
            };
            let level = if is_relative && !is_tame && !is_known() { levels.around(place) } else { own };
            let mut sum = 0.0;
            for channel in 0..3 {
                let squared = variances[channel] + biases[0][channel] * biases[1][channel];
                sum += if is_relative {
                    squared / (f64::from(level[channel]) * f64::from(level[channel]) + floor)
                } else {
                    display_error2(own[channel], squared)
                };
            }
            visit(place, pixel.count(), sum / 3.0);
        })
    }

    /// How many samples pixels have; `None` if it was cancelled in the middle.
    pub(crate) fn counts_unless(&self, cancel: &Cancel) -> Option<SampleCounts> {
        let (mut min, mut max, mut sum) = (u32::MAX, 0, 0_u64);
        let is_whole = self.for_each_unless(cancel, |_, pixel, _| {
            (min, max) = (min.min(pixel.count()), max.max(pixel.count()));
            sum += u64::from(pixel.count());
        });
        is_whole.then(|| SampleCounts { min, mean: sum as f64 / self.pixel_count().max(1) as f64, max })
    }

    /// How many samples pixels have.
    pub fn counts(&self) -> SampleCounts {
        self.counts_unless(&Cancel::new()).unwrap_or_default()
    }
}

/// What pixels are to be compared with.
struct Levels<'m> {
    means: &'m [[f32; 3]],
    luminances: Vec<f32>,
    size: [usize; 2],
}

impl<'m> Levels<'m> {
    fn new(means: &'m [[f32; 3]], resolution: [u32; 2]) -> Self {
        let luminances = means.iter().map(|&mean| luminance(mean.into())).collect();
        Self { means, luminances, size: resolution.map(|n| n as usize) }
    }

    /// The mean of the pixel that is the median, by luminance, of a pixel and its eight neighbours: for a pixel that does not
    /// know its own.
    ///
    /// Relative to its own mean, a bright path that one sample has met would be large against itself only, and no pixel
    /// off by more than its own value; relative to what its other samples say, pixels at the edge of a lamp that few samples
    /// meet would be off by far too much. A median knows of the one and keeps the edges of the other.
    fn around(&self, place: usize) -> [f32; 3] {
        let [width, height] = self.size;
        let (x, y) = (place % width, place / width);
        let (mut found, mut count) = ([(0.0_f32, 0); 9], 0);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            for column in x.saturating_sub(1)..(x + 2).min(width) {
                let place = row * width + column;
                found[count] = (self.luminances[place], place);
                count += 1;
            }
        }
        // Of few numbers, put in their order one by one.
        for i in 1..count {
            let mut j = i;
            while j > 0 && found[j - 1].0 > found[j].0 {
                found.swap(j - 1, j);
                j -= 1;
            }
        }
        self.means[found[count / 2].1]
    }
}

/// Squared error in levels of 255 of a value with this squared error.
fn display_error2(mean: f32, squared: f64) -> f64 {
    if squared.is_nan() {
        return f64::NAN;
    }
    let off = squared.max(0.0).sqrt() as f32;
    let half = 0.5 * (f64::from(srgb_encode(mean + off)) - f64::from(srgb_encode(mean - off)));
    (255.0 * half) * (255.0 * half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmOptions, REPLICATES, TILE};
    use crate::spectrum::Rgb;

    /// A film of 2 x 2 pixels whose replicates are `mean + off` and `mean - off` in turn.
    fn film(pixels: [(f32, f32); 4], samples: u32) -> Film {
        let options = FilmOptions { resolution: [2, 2], auxiliary: false, share: 1, weighted: false, gathering: false };
        let film = Film::new(options).unwrap();
        let mut tile = film.tile(0);
        for (i, (mean, off)) in pixels.into_iter().enumerate() {
            let index = i % 2 + i / 2 * TILE as usize;
            for sample in 0..samples {
                let sign = if sample % 2 == 0 { 1.0 } else { -1.0 };
                tile.pixels[index].add(Rgb::splat(mean + sign * off), 1.0, 1);
            }
        }
        drop(tile);
        film
    }

    #[test]
    fn rel_mse_is_the_mean_of_relative_variances() {
        let samples = REPLICATES as u32;
        let film = film([(1.0, 0.1), (2.0, 0.0), (4.0, 1.0), (1.0, 0.0)], samples);
        // Of eight replicates at +-d, the variance of the mean is d^2 / 7. Mean of the image: 2.
        let term = |mean: f64, off: f64| off * off / 7.0 / (mean * mean + 0.04);
        let terms = [term(1.0, 0.1), 0.0, term(4.0, 1.0), 0.0];
        let mean = terms.iter().sum::<f64>() / 4.0;
        let error = (terms.iter().map(|t| (t - mean) * (t - mean)).sum::<f64>() / 12.0).sqrt();
        let found = film.rel_mse().unwrap();
        // 0.1 is rounded to single precision.
        assert!((found.value / mean - 1.0).abs() < 1e-6, "{found:?}, {mean}");
        assert!((found.standard_error / error - 1.0).abs() < 1e-6, "{found:?}, {error}");
        assert_eq!(film.counts(), SampleCounts { min: samples, mean: f64::from(samples), max: samples });
    }

    #[test]
    fn a_firefly_is_measured_by_its_surroundings() {
        let film = film([(1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 0.0)], 8);
        let mut tile = film.tile(0);
        // One of eight samples of 8000: its mean is 1000, and so is its standard error.
        for sample in 0..8 {
            let value = if sample == 3 { 8000.0 } else { 0.0 };
            tile.pixels[TILE as usize + 1] =
                if sample == 0 { Default::default() } else { tile.pixels[TILE as usize + 1] };
            tile.pixels[TILE as usize + 1].add(Rgb::splat(value), 1.0, 1);
        }
        drop(tile);
        let mean = 1003.0 / 4.0;
        // Of 1, 1, 1 and 1000 the third is 1.
        let expected = 1e6 / (1.0 + 1e-2 * mean * mean) / 4.0;
        let found = film.rel_mse().unwrap().value;
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, {expected}");
    }

    #[test]
    fn too_few_samples_and_no_light_are_no_estimate() {
        assert_eq!(film([(1.0, 0.1); 4], 3).rel_mse(), None);
        assert_eq!(film([(1.0, 0.1); 4], 3).display_error(), None);
        assert!(film([(1.0, 0.1); 4], 4).rel_mse().is_some());
        assert_eq!(film([(0.0, 0.0); 4], 64).rel_mse(), None);
        assert_eq!(film([(0.0, 0.0); 4], 64).display_error().map(|error| error.value), Some(0.0));
    }

    #[test]
    fn display_error_follows_the_curve_and_ends_with_it() {
        // In the middle, the slope: s' = 1.055 / 2.4 x^(1 / 2.4 - 1).
        let slope = 1.055 / 2.4 * 0.5_f64.powf(1.0 / 2.4 - 1.0);
        let error = display_error2(0.5, 1e-6).sqrt();
        assert!((error / (255.0 * slope * 1e-3) - 1.0).abs() < 1e-3, "{error}");
        // The straight part below 0.0031308.
        assert!((display_error2(0.001, 1e-8).sqrt() / (255.0 * 12.92 * 1e-4) - 1.0).abs() < 1e-3);
        // White stays white, and black has one side only.
        assert_eq!(display_error2(3.0, 1.0), 0.0);
        assert!((display_error2(0.0, 1e-6).sqrt() / (255.0 * 12.92 * 0.5e-3) - 1.0).abs() < 1e-3);
        assert!(display_error2(0.5, f64::NAN).is_nan());
    }
}
