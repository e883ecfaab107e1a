//! Error estimates of an image, from the scatter of the image's own samples.

use super::unknown_mean::{UnknownMean, compare_with_surroundings};
use super::{Film, PixelPhotonState, Tile, lock};
use crate::Cancel;
use crate::spectrum::srgb_encode;

/// A measure of the error of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ErrorMeasure {
    /// relMSE: the mean over pixels and channels of squared error / (mean^2 + e), where e is 1 % of the squared mean of the
    /// whole image, so that black pixels do not dominate. It falls about as 1 / N.
    #[default]
    RelMse,
    /// Error of displayed values: the root of the mean over pixels and channels of the squared error, in levels of 255, after
    /// clamping to [0, 1] and the sRGB curve. It falls about as 1 / sqrt(N).
    Display,
}

/// An estimated error with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimated error.
    pub value: f64,
    /// Standard error of `value`, from the scatter over pixels. The scatter includes the differences between the pixels'
    /// expectations, so the standard error is rather too large. Light that no sample has met yet is not included. For
    /// photon methods, the standard error counts a bright path that one sample has met as a stray path, although `value`
    /// counts it as what is likely.
    pub standard_error: f64,
}

/// Numbers of samples over the pixels of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleCounts {
    /// Smallest number of any pixel.
    pub min: u32,
    /// Mean over all pixels.
    pub mean: f64,
    /// Greatest number of any pixel.
    pub max: u32,
}

/// An estimate whose standard error is more than this fraction of its value rests on few pixels: those that rare bright paths
/// have reached.
pub(crate) const FEW_PIXELS: f64 = 0.35;

/// What a pixel adds to the error of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelError {
    /// The pixel's squared error, the mean over channels.
    pub value: f64,
    /// The same if a bright path that one sample has met was a stray path. Standard errors are computed from it.
    pub bound: f64,
}

/// Sums over the pixels' terms of a mean, from which the mean and its standard error follow.
#[derive(Clone, Copy, Default)]
struct Terms {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Terms {
    fn add(&mut self, error: PixelError) {
        self.count += 1.0;
        self.sum += error.value;
        self.squares += error.bound * error.bound;
    }

    /// The mean and its standard error; `None` if a pixel has no estimate or the image is black.
    fn mean(&self) -> Option<ErrorEstimate> {
        // Products of noisy bias estimates may be negative.
        let value = if self.sum < 0.0 { 0.0 } else { self.sum / self.count };
        let scatter = (self.squares - self.sum * self.sum / self.count).max(0.0);
        // One pixel has no scatter. The standard error is then that of an exponential distribution.
        let standard_error =
            if self.count > 1.0 { (scatter / (self.count * (self.count - 1.0))).sqrt() } else { value };
        value.is_finite().then_some(ErrorEstimate { value, standard_error })
    }
}

impl ErrorEstimate {
    /// Whether few pixels have most of the estimate, which is so if its standard error is more than about a third of its value.
    /// Pixels that have not met their rare bright paths yet may then have large errors as well. The estimate may be wrong by a
    /// multiple of itself, which its standard error does not include.
    pub fn is_heavy_tailed(&self) -> bool {
        self.standard_error > FEW_PIXELS * self.value
    }

    /// The estimate of the square root of the quantity.
    fn root(self) -> Self {
        let value = self.value.sqrt();
        Self { value, standard_error: if value > 0.0 { 0.5 * self.standard_error / value } else { 0.0 } }
    }
}

impl Film {
    /// Estimated relMSE (see [`ErrorMeasure::RelMse`]), from the variances of the replicates. The error of a pixel whose own mean
    /// is not yet known is relative to its surroundings, as far as the pixel may be no brighter than these
    /// (docs/error-estimates.md). Where photon maps are built anew for each pass, the square of their estimated bias is added. It
    /// is the product of two independent estimates of the bias, because the square of one estimate would count noise as bias.
    ///
    /// `None` until every pixel has an estimate (see [`Pixel::variance`](super::Pixel::variance)), and for an image without
    /// light.
    pub fn rel_mse(&self) -> Option<ErrorEstimate> {
        self.error(ErrorMeasure::RelMse)
    }

    /// Estimated error of displayed values, in levels of 255 (see [`ErrorMeasure::Display`]), without exposure and tone maps. A
    /// pixel's error is half the difference of the displayed values at one standard error above and below the mean. For small
    /// errors, that is the slope of the sRGB curve times the standard error; near black and white, clamping limits it.
    ///
    /// `None` where [`Film::rel_mse`] is `None`.
    pub fn display_error(&self) -> Option<ErrorEstimate> {
        self.error(ErrorMeasure::Display)
    }

    /// The estimated error in a measure; see [`Film::rel_mse`] and [`Film::display_error`].
    pub fn error(&self, measure: ErrorMeasure) -> Option<ErrorEstimate> {
        self.error_unless(measure, &Cancel::new())
    }

    /// The same as [`Film::error`]; also `None` if it was cancelled before the end.
    pub(crate) fn error_unless(&self, measure: ErrorMeasure, cancel: &Cancel) -> Option<ErrorEstimate> {
        // Usually all pixels have equally many samples. If the first pixels have too few for an estimate, the others are not
        // read.
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

    /// Calls `visit` with the index of each pixel in row order, its number of samples, and its squared error in `measure`, the
    /// mean over channels. Returns `false` if it was cancelled before the end.
    ///
    /// `is_tame`: errors are always relative to the pixel's own mean, and never to its surroundings. Such errors are too small
    /// where samples are rare and bright, so that these samples do not dominate. A pixel's error then depends on other pixels'
    /// samples only by the mean of the whole image.
    pub(crate) fn for_each_error(
        &self,
        measure: ErrorMeasure,
        is_tame: bool,
        cancel: &Cancel,
        mut visit: impl FnMut(usize, u32, PixelError),
    ) -> bool {
        let (weighted, share) = (self.options.weighted, self.options.share);
        let is_relative = measure == ErrorMeasure::RelMse;
        let (mut means, mut unknown) = (Vec::new(), Vec::new());
        if is_relative {
            means.resize(self.pixel_count(), [0.0; 3]);
            let is_whole = self.for_each_unless(cancel, |place, pixel, _| {
                let mean = pixel.mean(weighted);
                means[place] = mean;
                if !is_tame {
                    unknown.extend(UnknownMean::new(place, mean, pixel.variance(share)));
                }
            });
            if !is_whole {
                return false;
            }
        }
        let sum: f64 = means.iter().flatten().copied().map(f64::from).sum();
        let mean = sum / (3 * self.pixel_count()).max(1) as f64;
        let floor = 1e-2 * mean * mean;
        let width = self.options.resolution[0] as usize;
        let Some(rare) = compare_with_surroundings(&mut unknown, &means, width, floor, cancel) else { return false };
        // Where paths find the light that walls scatter, stray paths are so many that the numbers tell nothing of reflections.
        let repeats = if self.options.gathering { rare.repeats() as f32 } else { 0.0 };
        drop(means);
        self.for_each_unless(cancel, |place, pixel, beside| {
            let biases = beside.gathering.and_then(PixelPhotonState::biases).unwrap_or_default();
            let variances = pixel.variance(share);
            let own = pixel.mean(weighted);
            let squared: [f64; 3] =
                std::array::from_fn(|channel| variances[channel] + biases[0][channel] * biases[1][channel]);
            let error = if is_relative {
                let relative_to = |mean: [f32; 3]| {
                    mean_of_channels(|i| squared[i] / (f64::from(mean[i]) * f64::from(mean[i]) + floor))
                };
                let by_own = relative_to(own);
                match unknown.binary_search_by_key(&place, |pixel| pixel.place as usize) {
                    Err(_) => PixelError { value: by_own, bound: by_own },
                    Ok(found) => {
                        let UnknownMean { surroundings, weight, .. } = unknown[found];
                        // The mean that the pixel is expected to have: brighter than its surroundings where a bright path that
                        // one sample has met is more than chance.
                        let expected =
                            std::array::from_fn(|i| surroundings[i] + repeats * (own[i] - surroundings[i]).max(0.0));
                        let [value, bound] = [expected, surroundings].map(|mean| {
                            let by_others = relative_to(mean);
                            // Products of noisy bias estimates may be negative. They have no geometric mean.
                            if by_own > 0.0 && by_others > 0.0 {
                                by_own * (by_others / by_own).powf(weight)
                            } else {
                                by_others
                            }
                        });
                        PixelError { value, bound }
                    }
                }
            } else {
                let value = mean_of_channels(|i| display_error2(own[i], squared[i]));
                PixelError { value, bound: value }
            };
            visit(place, pixel.count(), error);
        })
    }

    /// Numbers of samples over the pixels; `None` if it was cancelled before the end.
    pub(crate) fn counts_unless(&self, cancel: &Cancel) -> Option<SampleCounts> {
        let (mut min, mut max, mut sum) = (u32::MAX, 0, 0_u64);
        let is_whole = self.for_each_unless(cancel, |_, pixel, _| {
            (min, max) = (min.min(pixel.count()), max.max(pixel.count()));
            sum += u64::from(pixel.count());
        });
        is_whole.then(|| SampleCounts { min, mean: sum as f64 / self.pixel_count().max(1) as f64, max })
    }

    /// Numbers of samples over the pixels.
    pub fn counts(&self) -> SampleCounts {
        self.counts_unless(&Cancel::new()).unwrap_or_default()
    }
}

fn mean_of_channels(value: impl Fn(usize) -> f64) -> f64 {
    (value(0) + value(1) + value(2)) / 3.0
}

/// Squared error of a displayed value in levels of 255, from the squared error of the radiance.
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
    use super::super::unknown_mean::RarePixels;
    use super::*;
    use crate::film::{FilmOptions, REPLICATES, TILE};
    use crate::spectrum::Rgb;

    /// A film of 2 x 2 pixels whose replicates are `mean + off` and `mean - off` in turn.
    fn film(pixels: [(f32, f32); 4], samples: u32) -> Film {
        let options = FilmOptions {
            resolution: [2, 2],
            placement: None,
            auxiliary: false,
            light_parts: false,
            share: 1,
            weighted: false,
            gathering: false,
        };
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
        // The surroundings of the bright pixel have a mean of 1.
        let expected = 1e6 / (1.0 + 1e-2 * mean * mean) / 4.0;
        let found = film.rel_mse().unwrap().value;
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, {expected}");
    }

    /// A film of 7 x 7 grey pixels of 1, but for some pixels whose replicates are these.
    fn grey_but(others: &[([usize; 2], [f32; REPLICATES])]) -> Film {
        let options = FilmOptions {
            resolution: [7, 7],
            placement: None,
            auxiliary: false,
            light_parts: false,
            share: 1,
            weighted: false,
            gathering: false,
        };
        let film = Film::new(options).unwrap();
        let mut tile = film.tile(0);
        for (y, x) in (0..7).flat_map(|y| (0..7).map(move |x| (y, x))) {
            let replicates =
                others.iter().find(|(at, _)| *at == [x, y]).map_or([1.0; REPLICATES], |(_, values)| *values);
            for value in replicates {
                tile.pixels[x + y * TILE as usize].add(Rgb::splat(value), 1.0, 1);
            }
        }
        drop(tile);
        film
    }

    /// Replicates of which so many have met something of this brightness.
    fn hits(count: usize, brightness: f32) -> [f32; REPLICATES] {
        std::array::from_fn(|replicate| if replicate < count { brightness } else { 1.0 })
    }

    /// What a pixel in the middle of the film is relative to, as a mean.
    fn level(film: &Film) -> f64 {
        let (mut errors, mut means, mut variance) = (Vec::new(), 0.0, 0.0);
        assert!(
            film.for_each_error(ErrorMeasure::RelMse, false, &Cancel::new(), |_, _, error| errors.push(error.value))
        );
        film.for_each(|place, pixel, _| {
            means += f64::from(pixel.mean(false)[0]) / 49.0;
            variance = if place == 24 { pixel.variance(1)[0] } else { variance };
        });
        let place = errors.iter().position(|error| *error > 0.0).unwrap();
        (variance / errors[place] - 1e-2 * means * means).sqrt()
    }

    #[test]
    fn one_bright_sample_is_no_evidence_and_two_are() {
        let mean = |film: &Film| f64::from(film.develop().pixel(3, 3)[0]);
        // A single bright sample says only that bright samples are rare, however bright it is.
        for brightness in [8.0, 100.0, 1e4, 1e6] {
            let level = level(&grey_but(&[([3, 3], hits(1, brightness))]));
            assert!((level - 1.0).abs() < 0.01, "{brightness}: {level}");
        }
        // A reflection that two of eight replicates have met counts as light of its pixel. A sample that is a little brighter
        // than its surroundings may be chance.
        for (count, brightness) in [(2, 1e4), (3, 1e4)] {
            let film = grey_but(&[([3, 3], hits(count, brightness))]);
            let (level, own) = (level(&film), mean(&film));
            assert!((level / own - 1.0).abs() < 0.01, "{count} of {brightness}: {level}, {own}");
        }
        let mut dark = [0.0; REPLICATES];
        dark[..2].fill(10.0);
        let level = level(&grey_but(&[([3, 3], dark)]));
        assert!((level - 1.0).abs() < 0.01, "{level}");
    }

    #[test]
    fn between_doubt_and_belief_there_is_no_jump() {
        let mut former = None;
        // Two hits, ever brighter: a known mean, one in doubt, and one that is believed.
        for step in 0..400 {
            let brightness = 2.0 * 1.02_f32.powi(step);
            let film = grey_but(&[([3, 3], hits(2, brightness))]);
            let level = level(&film) / f64::from(film.develop().pixel(3, 3)[0]);
            let change = former.replace(level).map_or(1.0, |former: f64| level / former);
            assert!((0.8..1.25).contains(&change), "{change} at {brightness}");
        }
    }

    #[test]
    fn the_edge_of_a_reflection_is_compared_with_the_reflection() {
        let film = grey_but(&[([3, 3], hits(1, 801.0)), ([4, 3], [5000.0; 8]), ([4, 4], [5000.0; 8])]);
        // Its own mean is 101: two of its 24 neighbours count as much.
        let expected = (22.0 + 2.0 * 101.0) / 24.0;
        assert!((level(&film) / expected - 1.0).abs() < 0.01, "{}", level(&film));
    }

    #[test]
    fn stray_bright_samples_elsewhere_are_light_that_surroundings_have_not_met() {
        let film = grey_but(&[([3, 3], hits(1, 801.0)), ([0, 0], hits(1, 801.0)), ([6, 6], hits(1, 801.0))]);
        // Two others of 100 more than their surroundings, over 48 pixels.
        let expected = 1.0 + 200.0 / 48.0;
        let (mut variance, mut errors) = (0.0, Vec::new());
        film.for_each(|place, pixel, _| variance = if place == 24 { pixel.variance(1)[0] } else { variance });
        assert!(
            film.for_each_error(ErrorMeasure::RelMse, false, &Cancel::new(), |_, _, error| errors.push(error.value))
        );
        let floor = 1e-2 * (349.0_f64 / 49.0).powi(2);
        let level = (variance / errors[24] - floor).sqrt();
        assert!((level / expected - 1.0).abs() < 0.01, "{level}, {expected}");
    }

    #[test]
    fn stray_light_is_a_share_of_the_surroundings_light() {
        // The left of the film is at 0.5, the right at 8; a stray path on either side.
        let mut others: Vec<([usize; 2], [f32; REPLICATES])> = Vec::new();
        for (y, x) in (0..7).flat_map(|y| (0..7).map(move |x| (y, x))) {
            others.push(([x, y], [if x < 4 { 0.5 } else { 8.0 }; REPLICATES]));
        }
        for (at, brightness) in [([0, 3], 0.5), ([6, 3], 8.0)] {
            let hit = std::array::from_fn(|replicate| brightness * if replicate == 0 { 801.0 } else { 1.0 });
            others.iter_mut().find(|(place, _)| *place == at).unwrap().1 = hit;
        }
        let film = grey_but(&others);
        let (mut means, mut variances, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        film.for_each(|_, pixel, _| {
            means.push(f64::from(pixel.mean(false)[0]));
            variances.push(pixel.variance(1)[0]);
        });
        assert!(
            film.for_each_error(ErrorMeasure::RelMse, false, &Cancel::new(), |_, _, error| errors.push(error.value))
        );
        let mean = means.iter().sum::<f64>() / 49.0;
        let floor = 1e-2 * mean * mean;
        // Each side is 101 times as bright as its surroundings, and the other pixel's share is 100 or less by the floor.
        let lift = |level: f64| level.hypot(floor.sqrt());
        for (at, own, other) in [(3 * 7, 0.5, 8.0), (3 * 7 + 6, 8.0, 0.5)] {
            let expected = own + lift(own) * 100.0 * other / lift(other) / 48.0;
            let level = (variances[at] / errors[at] - floor).sqrt();
            assert!((level / expected - 1.0).abs() < 0.01, "{level}, {expected}");
        }
    }

    #[test]
    fn what_photon_films_meet_once_may_be_met_again() {
        // In this order: there is no rare pixel, there is a single one, both kinds are equally many, and there are only stray
        // paths.
        let repeats = |once, often| RarePixels { once, often }.repeats();
        assert_eq!(
            (repeats(0.0, 0.0), repeats(1.0, 0.0), repeats(5.0, 4.0), repeats(100.0, 0.0)),
            (1.0, 1.0, 1.0, 0.01)
        );
        let of = |film: &Film, gathering: bool| {
            let (mut means, mut unknown) = (Vec::new(), Vec::new());
            film.for_each(|place, pixel, _| {
                means.push(pixel.mean(false));
                unknown.extend(UnknownMean::new(place, pixel.mean(false), pixel.variance(1)));
            });
            let rare = compare_with_surroundings(&mut unknown, &means, 7, 1e-2, &Cancel::new()).unwrap();
            let UnknownMean { place, surroundings: [around, ..], weight } = unknown[0];
            let repeats = if gathering { rare.repeats() as f32 } else { 0.0 };
            (around, around + repeats * (means[place as usize][0] - around), weight)
        };
        let one = grey_but(&[([3, 3], hits(1, 801.0))]);
        assert_eq!(of(&one, false), (1.0, 1.0, 1.0));
        assert_eq!(of(&one, true), (1.0, 101.0, 1.0));
        // Four that one sample has met and one that two have: half.
        let at = [[0, 0], [6, 0], [0, 6], [6, 6]].map(|at| (at, hits(1, 801.0)));
        let more = grey_but(&[&at[..], &[([3, 3], hits(2, 801.0))]].concat());
        let (around, expected, _) = of(&more, true);
        assert!(((expected - around) / (101.0 - around) - 0.5).abs() < 0.01, "{around}, {expected}");
    }

    #[test]
    fn standard_errors_count_what_one_sample_has_met_as_stray() {
        let mut film = grey_but(&[([3, 3], hits(1, 801.0))]);
        let by_paths = film.rel_mse().unwrap();
        film.options.gathering = true;
        let by_photons = film.rel_mse().unwrap();
        assert!(by_photons.value < 0.01 * by_paths.value, "{by_photons:?}, {by_paths:?}");
        assert!((by_photons.standard_error / by_paths.standard_error - 1.0).abs() < 0.02);
        assert!(by_photons.is_heavy_tailed());
    }

    #[test]
    fn goals_of_adaptive_samples_know_no_surroundings() {
        let tame = |film: &Film| {
            let mut errors = Vec::new();
            assert!(
                film.for_each_error(ErrorMeasure::RelMse, true, &Cancel::new(), |_, _, error| errors.push(error.value))
            );
            errors
        };
        // The whole image's mean is the same.
        let [a, b] = [[3, 4], [6, 0]].map(|at| tame(&grey_but(&[([3, 3], hits(1, 801.0)), (at, [9.0; 8])])));
        assert_eq!(a[24], b[24]);
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
