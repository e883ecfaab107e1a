//! Error estimates of an image, from the scatter of the image's own samples.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::reference::Reference;
use super::sums::{CountSums, PixelError, Terms, mean_of_channels};
use super::{Film, FilmOptions, Pixel, PixelExtras, PixelPhotonState, TILE, Tile, lock};
use crate::Cancel;
use crate::control::{Alone, Parallel};
use crate::error::Result;
use crate::room::with_room;
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

/// Number of rows of tiles by which the time of all is estimated.
const TIMED_ROWS: u32 = 2;

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
        if self.has_no_estimate() {
            return None;
        }
        self.estimates(&[measure], &mut Alone::default()).ok()?.of(measure)
    }

    /// Whether the first pixel of a tile has too few samples for an estimate, so that there is none of the film.
    fn has_no_estimate(&self) -> bool {
        let has_none =
            |tile: &Tile| tile.pixels.first().is_none_or(|first| first.variance(self.options.share)[0].is_nan());
        self.tiles.iter().any(|tile| has_none(&lock(tile)))
    }

    /// The errors in these measures, and the numbers of samples. They are the same for any number of threads.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`] if the work was stopped before the end, [`ErrorKind::OutOfMemory`], and other errors of
    /// `parallel`.
    pub(crate) fn estimates(&self, measures: &[ErrorMeasure], parallel: &mut impl Parallel) -> Result<Estimates> {
        // Where time has ended a pass, some pixels may have too few samples; the others are not asked then.
        let measures = if self.has_no_estimate() { &[] } else { measures };
        let [is_relative, is_displayed] = ErrorMeasure::ALL.map(|measure| measures.contains(&measure));
        let reference = if is_relative { Some(Reference::new(self, parallel)?) } else { None };
        let (film, cancel) = (self.handle(), parallel.token());
        let rows = parallel.map(self.tile_rows(), move |row| {
            let ([mut relative, mut displayed], mut counts) = ([Terms::default(); 2], CountSums::default());
            film.for_each_of_row(row, &cancel, |place, pixel, beside| {
                counts.add(pixel.count());
                if reference.is_none() && !is_displayed {
                    return;
                }
                let (own, squared) = (pixel.mean(film.options.weighted), film.squared_error(pixel, &beside));
                if let Some(reference) = &reference {
                    relative.add(reference.error(row, place, own, squared));
                }
                if is_displayed {
                    let value = displayed_error(own, squared);
                    displayed.add(PixelError { value, bound: value });
                }
            })?;
            Ok(([relative, displayed], counts))
        })?;
        let ([mut relative, mut displayed], mut counts) = ([Terms::default(); 2], CountSums::default());
        for row in rows {
            let ([of_row, displayed_of_row], counts_of_row): ([Terms; 2], CountSums) = row?;
            relative.join(of_row);
            displayed.join(displayed_of_row);
            counts.join(counts_of_row);
        }
        // No terms have no mean.
        Ok(Estimates {
            rel_mse: relative.mean(),
            display: displayed.mean().map(ErrorEstimate::root),
            counts: Some(counts.counts()),
        })
    }

    /// About how long [`Film::estimates`] takes on so many threads, by those of the rows of tiles at the top; `None` as long as there are
    /// no estimates.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`], and [`ErrorKind::OutOfMemory`].
    pub(crate) fn time_of_estimates(
        &self,
        measures: &[ErrorMeasure],
        threads: usize,
        cancel: &Cancel,
    ) -> Result<Option<Duration>> {
        let [width, height] = self.options.resolution;
        let resolution = [width, height.min(TIMED_ROWS * TILE)];
        let top = Self { options: FilmOptions { resolution, ..self.options }, tiles: Arc::clone(&self.tiles) };
        let start = Instant::now();
        let found = top.estimates(measures, &mut Alone(cancel.clone()))?;
        if found.rel_mse.is_none() && found.display.is_none() {
            return Ok(None);
        }
        let turns = self.tile_rows().div_ceil(threads.max(1)) as f64;
        Ok(Some(start.elapsed().mul_f64(turns / top.tile_rows().max(1) as f64)))
    }

    /// Numbers of samples over the pixels; `None` if it was cancelled before the end.
    pub(crate) fn counts_unless(&self, cancel: &Cancel) -> Option<SampleCounts> {
        let mut counts = CountSums::default();
        let is_whole = self.for_each_unless(cancel, |_, pixel, _| counts.add(pixel.count()));
        is_whole.then(|| counts.counts())
    }

    /// Numbers of samples over the pixels.
    pub fn counts(&self) -> SampleCounts {
        self.counts_unless(&Cancel::new()).unwrap_or_default()
    }

    /// Numbers of samples of the pixels, and their squared errors in a measure, both in row order. Relative errors are relative
    /// to the pixels' own means, and never to their surroundings (see [`Reference::own_means`]).
    ///
    /// # Errors
    /// As [`Film::estimates`].
    pub(crate) fn own_errors(
        &self,
        measure: ErrorMeasure,
        parallel: &mut impl Parallel,
    ) -> Result<(Vec<u32>, Vec<f64>)> {
        let reference = match measure {
            ErrorMeasure::RelMse => Some(Reference::own_means(self, parallel)?),
            ErrorMeasure::Display => None,
        };
        self.pixel_errors(reference, parallel)
    }

    /// Numbers of samples of the pixels, and their squared errors relative to `reference`, or as they are displayed.
    fn pixel_errors(&self, reference: Option<Reference>, parallel: &mut impl Parallel) -> Result<(Vec<u32>, Vec<f64>)> {
        let (film, cancel) = (self.handle(), parallel.token());
        let rows = parallel.map(self.tile_rows(), move |row| {
            let places = film.places_of_row(row);
            let (mut counts, mut errors) = (with_room(places.len())?, with_room(places.len())?);
            counts.resize(places.len(), 0);
            errors.resize(places.len(), 0.0);
            film.for_each_of_row(row, &cancel, |place, pixel, beside| {
                let (own, squared) = (pixel.mean(film.options.weighted), film.squared_error(pixel, &beside));
                counts[place - places.start] = pixel.count();
                errors[place - places.start] = match &reference {
                    Some(reference) => reference.error(row, place, own, squared).value,
                    None => displayed_error(own, squared),
                };
            })?;
            Ok((counts, errors))
        })?;
        let (mut counts, mut errors) = (with_room(self.pixel_count())?, with_room(self.pixel_count())?);
        for row in rows {
            let row: (Vec<u32>, Vec<f64>) = row?;
            counts.extend(row.0);
            errors.extend(row.1);
        }
        Ok((counts, errors))
    }

    /// Squared errors of a pixel's channels: the variance of its mean, and the square of its bias where photons have one.
    fn squared_error(&self, pixel: &Pixel, beside: &PixelExtras) -> [f64; 3] {
        let biases = beside.gathering.and_then(PixelPhotonState::biases).unwrap_or_default();
        let variances = pixel.variance(self.options.share);
        std::array::from_fn(|channel| variances[channel] + biases[0][channel] * biases[1][channel])
    }
}

impl ErrorMeasure {
    /// Both measures.
    pub(crate) const ALL: [Self; 2] = [Self::RelMse, Self::Display];
}

/// Estimates of a film's errors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Estimates {
    /// See [`Film::rel_mse`].
    pub rel_mse: Option<ErrorEstimate>,
    /// See [`Film::display_error`].
    pub display: Option<ErrorEstimate>,
    /// See [`Film::counts`].
    pub counts: Option<SampleCounts>,
}

impl Estimates {
    /// The error in a measure.
    pub fn of(&self, measure: ErrorMeasure) -> Option<ErrorEstimate> {
        match measure {
            ErrorMeasure::RelMse => self.rel_mse,
            ErrorMeasure::Display => self.display,
        }
    }
}

/// Squared error of a pixel as it is displayed, the mean over channels.
fn displayed_error(own: [f32; 3], squared: [f64; 3]) -> f64 {
    mean_of_channels(|i| display_error2(own[i], squared[i]))
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
pub(super) mod tests {
    use super::*;
    use crate::ErrorKind;
    use crate::film::{FilmOptions, REPLICATES, TILE};
    use crate::sampling::Rng;
    use crate::spectrum::Rgb;

    /// A film without samples.
    fn empty(resolution: [u32; 2], gathering: bool) -> Film {
        let options = FilmOptions {
            resolution,
            placement: None,
            auxiliary: false,
            light_parts: false,
            share: 1,
            weighted: false,
            gathering,
        };
        Film::new(options).unwrap()
    }

    /// A film of 2 x 2 pixels whose replicates are `mean + off` and `mean - off` in turn.
    fn film(pixels: [(f32, f32); 4], samples: u32) -> Film {
        let film = empty([2, 2], false);
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
    pub fn grey_but(others: &[([usize; 2], [f32; REPLICATES])], gathering: bool) -> Film {
        grey([7, 7], others, gathering)
    }

    /// The same of any size.
    pub fn grey(resolution: [u32; 2], others: &[([usize; 2], [f32; REPLICATES])], gathering: bool) -> Film {
        let film = empty(resolution, gathering);
        for number in 0..film.tile_count() {
            let [left, top] = film.tile_origin(number).map(|length| length as usize);
            let mut tile = film.tile(number);
            for (index, pixel) in tile.pixels.iter_mut().enumerate() {
                let place = [left + index % TILE as usize, top + index / TILE as usize];
                let own = others.iter().find(|(at, _)| *at == place);
                for value in own.map_or([1.0; REPLICATES], |(_, values)| *values) {
                    pixel.add(Rgb::splat(value), 1.0, 1);
                }
            }
        }
        film
    }

    /// Replicates of which so many have met something of this brightness.
    pub fn hits(count: usize, brightness: f32) -> [f32; REPLICATES] {
        std::array::from_fn(|replicate| if replicate < count { brightness } else { 1.0 })
    }

    /// Errors of the pixels, relative to their surroundings where these count.
    fn errors(film: &Film) -> Vec<f64> {
        let reference = Reference::new(film, &mut Alone::default()).unwrap();
        film.pixel_errors(Some(reference), &mut Alone::default()).unwrap().1
    }

    /// What a pixel in the middle of the film is relative to, as a mean.
    fn level(film: &Film) -> f64 {
        let (errors, mut means, mut variance) = (errors(film), 0.0, 0.0);
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
            let level = level(&grey_but(&[([3, 3], hits(1, brightness))], false));
            assert!((level - 1.0).abs() < 0.01, "{brightness}: {level}");
        }
        // A reflection that two of eight replicates have met counts as light of its pixel. A sample that is a little brighter
        // than its surroundings may be chance.
        for (count, brightness) in [(2, 1e4), (3, 1e4)] {
            let film = grey_but(&[([3, 3], hits(count, brightness))], false);
            let (level, own) = (level(&film), mean(&film));
            assert!((level / own - 1.0).abs() < 0.01, "{count} of {brightness}: {level}, {own}");
        }
        let mut dark = [0.0; REPLICATES];
        dark[..2].fill(10.0);
        let level = level(&grey_but(&[([3, 3], dark)], false));
        assert!((level - 1.0).abs() < 0.01, "{level}");
    }

    #[test]
    fn between_doubt_and_belief_there_is_no_jump() {
        let mut former = None;
        // Two hits, ever brighter: a known mean, one in doubt, and one that is believed.
        for step in 0..400 {
            let brightness = 2.0 * 1.02_f32.powi(step);
            let film = grey_but(&[([3, 3], hits(2, brightness))], false);
            let level = level(&film) / f64::from(film.develop().pixel(3, 3)[0]);
            let change = former.replace(level).map_or(1.0, |former: f64| level / former);
            assert!((0.8..1.25).contains(&change), "{change} at {brightness}");
        }
    }

    #[test]
    fn the_edge_of_a_reflection_is_compared_with_the_reflection() {
        let film = grey_but(&[([3, 3], hits(1, 801.0)), ([4, 3], [5000.0; 8]), ([4, 4], [5000.0; 8])], false);
        // Its own mean is 101: two of its 24 neighbours count as much.
        let expected = (22.0 + 2.0 * 101.0) / 24.0;
        assert!((level(&film) / expected - 1.0).abs() < 0.01, "{}", level(&film));
    }

    #[test]
    fn stray_bright_samples_elsewhere_are_light_that_surroundings_have_not_met() {
        let film = grey_but(&[([3, 3], hits(1, 801.0)), ([0, 0], hits(1, 801.0)), ([6, 6], hits(1, 801.0))], false);
        // Two others of 100 more than their surroundings, over 48 pixels.
        let expected = 1.0 + 200.0 / 48.0;
        let (mut variance, errors) = (0.0, errors(&film));
        film.for_each(|place, pixel, _| variance = if place == 24 { pixel.variance(1)[0] } else { variance });
        let floor = 1e-2 * (349.0_f64 / 49.0).powi(2);
        let level = (variance / errors[24] - floor).sqrt();
        assert!((level / expected - 1.0).abs() < 0.01, "{level}, {expected}");
    }

    /// Surroundings reach across rows of tiles, and stray paths count from all of them.
    #[test]
    fn rows_of_tiles_are_one_image() {
        let [width, height] = [20, 40];
        let pixels = (width * height) as f64;
        for y in [15, 16] {
            let others = [([3, y], hits(1, 801.0)), ([18, 2], hits(1, 801.0)), ([10, 39], hits(1, 801.0))];
            let lamps = [([4, y - 1], [5000.0; 8]), ([4, y + 1], [5000.0; 8])];
            let film = grey([width as u32, height as u32], &[&others[..], &lamps[..]].concat(), false);
            let mean = (pixels + 3.0 * 100.0 + 2.0 * 4999.0) / pixels;
            let floor = 1e-2 * mean * mean;
            let lift = |level: f64| level.hypot(floor.sqrt());
            // Two of the 24 neighbours count as much as the pixel, whose mean is 101.
            let around = (22.0 + 2.0 * 101.0) / 24.0;
            let expected = around + lift(around) * 200.0 / lift(1.0) / (pixels - 1.0);
            let place = y * width + 3;
            let mut variance = 0.0;
            film.for_each(|at, pixel, _| variance = if at == place { pixel.variance(1)[0] } else { variance });
            let level = (variance / errors(&film)[place] - floor).sqrt();
            assert!((level / expected - 1.0).abs() < 1e-3, "row {y}: {level}, {expected}");
        }
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
        let film = grey_but(&others, false);
        let (mut means, mut variances, errors) = (Vec::new(), Vec::new(), errors(&film));
        film.for_each(|_, pixel, _| {
            means.push(f64::from(pixel.mean(false)[0]));
            variances.push(pixel.variance(1)[0]);
        });
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
    fn standard_errors_count_what_one_sample_has_met_as_stray() {
        let mut film = grey_but(&[([3, 3], hits(1, 801.0))], false);
        let by_paths = film.rel_mse().unwrap();
        film.options.gathering = true;
        let by_photons = film.rel_mse().unwrap();
        assert!(by_photons.value < 0.01 * by_paths.value, "{by_photons:?}, {by_paths:?}");
        assert!((by_photons.standard_error / by_paths.standard_error - 1.0).abs() < 0.02);
        assert!(by_photons.is_heavy_tailed());
    }

    #[test]
    fn goals_of_adaptive_samples_know_no_surroundings() {
        let tame = |film: &Film| film.own_errors(ErrorMeasure::RelMse, &mut Alone::default()).unwrap().1;
        // The whole image's mean is the same.
        let [a, b] = [[3, 4], [6, 0]].map(|at| tame(&grey_but(&[([3, 3], hits(1, 801.0)), (at, [9.0; 8])], false)));
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

    /// Does the pieces of some work in the other order.
    struct Backwards;

    impl Parallel for Backwards {
        fn check(&mut self) -> Result<()> {
            Ok(())
        }

        fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
        where
            R: Send + 'static,
            F: Fn(usize) -> R + Send + Sync + 'static,
        {
            let mut results: Vec<R> = (0..count).rev().map(piece).collect();
            results.reverse();
            Ok(results)
        }
    }

    #[test]
    fn the_order_of_the_work_changes_no_estimate() {
        let film = empty([50, 70], false);
        let time = |threads| film.time_of_estimates(&ErrorMeasure::ALL, threads, &Cancel::new()).unwrap();
        assert_eq!(time(1), None, "there is nothing to estimate by");
        let mut rng = Rng::new(3, 1);
        for number in 0..film.tile_count() {
            let mut tile = film.tile(number);
            for pixel in &mut tile.pixels {
                for _ in 0..8 + rng.next_u64() % 3 {
                    // One sample of fifty has met something bright.
                    let scale = if rng.next_f32() < 0.02 { 1000.0 } else { 1.0 };
                    pixel.add(Rgb::splat(scale * rng.next_f32()), 1.0, 1);
                }
            }
        }
        let alone = film.estimates(&ErrorMeasure::ALL, &mut Alone::default()).unwrap();
        assert_eq!([alone.rel_mse, alone.display], [film.rel_mse(), film.display_error()]);
        assert!(time(1).unwrap() > Duration::ZERO && time(64).unwrap() > Duration::ZERO);
        let counts = film.own_errors(ErrorMeasure::Display, &mut Alone::default()).unwrap().0;
        film.for_each(|place, pixel, _| assert_eq!(counts[place], pixel.count()));
        let SampleCounts { min, mean, max } = film.counts();
        assert_eq!([min, max], [8, 10]);
        assert_eq!(mean, counts.iter().map(|count| f64::from(*count)).sum::<f64>() / (50.0 * 70.0));
        let found = film.estimates(&ErrorMeasure::ALL, &mut Backwards).unwrap();
        assert_eq!([found.rel_mse, found.display], [alone.rel_mse, alone.display]);
        assert_eq!([found.counts, alone.counts], [Some(film.counts()); 2]);
        // Every pixel is counted once.
        let mean = errors(&film).iter().sum::<f64>() / (50.0 * 70.0);
        let found = alone.rel_mse.unwrap().value;
        assert!((found / mean - 1.0).abs() < 1e-12, "{found}, {mean}");
        let cancel = Cancel::new();
        cancel.cancel();
        assert_eq!(film.estimates(&ErrorMeasure::ALL, &mut Alone(cancel)).unwrap_err().kind(), ErrorKind::Cancelled);
    }
}
