//! What the squares of a pilot and its light paths tell of the time to a given error in each way.

use super::super::order::SQUARE;
use super::super::ways::SAMPLES;
use super::cached::Cached;
use crate::film::ErrorEstimate;

/// Time of a ray of sharing over the time of a path's ray without. The rays that sharing adds are shadow rays to common ends.
const TIME_OF_A_SHARED_RAY: f64 = 0.45;

/// The same for a ray of a light path, with the choice of where it begins.
pub(super) const TIME_OF_A_LIGHT_RAY: f64 = 1.6;

/// Mean time of a ray where pixels share hits, of which many are shadow rays to common ends, where paths by themselves are not known.
pub(super) const TIME_OF_A_RAY_AMONG_SHARED: f64 = 0.65;

/// Time of the ray of one more light sample at the first hit, with the choice of a lamp, over that of a path's ray.
const TIME_OF_A_LIGHT_SAMPLE: f64 = 1.4;

/// What a way with more light samples costs counts so many times: of the errors that few bright pixels have, which squares rarely meet, more
/// light samples take nothing away.
const DOUBT_OF_SAMPLES: f64 = 1.25;

/// Numbers of light samples at the first hit that are considered, in those of other hits, and the one that is rendered.
const TIMES_AS_MANY_SAMPLES: [u32; 4] = [1, 2, 4, MOST_TIMES];
pub(super) const SAMPLES_TRIED: u32 = 4;
pub(in super::super) const MOST_TIMES: u32 = 8;

/// The gain in time from which on another way than that of paths by themselves is taken. Pilots promise a little more than pictures keep.
const LEAST_GAIN: f64 = 1.1;

/// The same for light paths. What their squares tell knows nothing of the even spread of samples, which makes camera paths better than
/// that.
const LEAST_LIGHT_GAIN: f64 = 1.2;

/// Numbers of light paths that are considered, in those of [`LightPaths::new`].
pub(super) const TIMES_AS_MANY: [u32; 4] = [1, 2, 4, 8];

/// The error of a square of which few pixels have most is at most so many times that of another way.
const FEW_TIMES: f64 = 4.0;

/// The least share of a square's error that is taken to have nothing to do with caustics.
const LEAST_REST: f64 = 0.05;

/// What a pilot found.
#[derive(Clone, Debug)]
pub(in super::super) struct Found {
    /// How many times longer a picture takes without shared hits to the same error, where it was asked.
    pub sharing: f64,
    /// How many times longer it takes without light paths, and how many of them are best for each sample.
    pub light: f64,
    pub count: u32,
    /// Number of light samples at the hits that the camera sees, in that of other hits.
    pub first_shadow_rays: u32,
    /// What the best of these ways costs.
    pub best: Best,
    /// What was found of the irradiance cache, where it was asked.
    pub cached: Option<Cached>,
    /// Number of rays of the pilot, and their time, in that of a ray of paths by themselves.
    pub rays: u64,
    pub time: f64,
}

/// What the best way of paths costs.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Best {
    /// Its place among those that the squares were rendered in; `None` with light paths, which know of errors that no square shows.
    pub way: Option<usize>,
    /// Error of the samples of the pilot, as the mean over squares.
    pub error: f64,
    /// Time of a sample of a pixel, in that of a ray of paths by themselves.
    pub rays: f64,
}

impl Found {
    /// Whether pixels are to share hits.
    pub fn shares(&self) -> bool {
        self.sharing >= LEAST_GAIN
    }

    /// Whether light paths are to be traced.
    pub fn traces_light(&self) -> bool {
        self.light >= LEAST_LIGHT_GAIN
    }
}

pub(super) const NO_ERROR: ErrorEstimate = ErrorEstimate { value: 0.0, standard_error: 0.0 };

/// What a square of the pilot came to in one way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    /// Estimated relMSE, or [`NO_ERROR`] where the square is black.
    pub error: ErrorEstimate,
    pub rays: u64,
}

/// What is known of a square.
#[derive(Clone, Debug)]
pub(super) struct Square {
    pub origin: [u32; 2],
    /// For each way: by itself, with shared hits where these are open, and in some squares the last of these with more light samples.
    pub costs: Vec<Cost>,
    /// For each way the mean luminance of each pixel and its variance, where light paths are open.
    pub pixels: Vec<Vec<[f64; 2]>>,
    /// What light paths tell of it, for each way.
    pub caustics: Vec<Caustics>,
}

/// The part of an error that is of caustics, in one way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Caustics {
    /// By paths from the camera alone.
    pub alone: f64,
    /// By these with the weights that they have beside light paths.
    pub weighted: f64,
    /// With light paths beside, for each of [`TIMES_AS_MANY`].
    pub beside: [f64; TIMES_AS_MANY.len()],
}

impl Caustics {
    /// Adds others, times `scale`.
    pub fn add(&mut self, other: &Self, scale: f64) {
        self.alone += scale * other.alone;
        self.weighted += scale * other.weighted;
        self.beside.iter_mut().zip(other.beside).for_each(|(sum, of)| *sum += scale * of);
    }
}

/// The errors of a square in two ways. One that rests on few pixels counts [`FEW_TIMES`] the other at most, since rare bright paths may have
/// been met by chance in one way only.
pub(super) fn errors_of([first, second]: [ErrorEstimate; 2]) -> [f64; 2] {
    let limited = |error: ErrorEstimate, other: ErrorEstimate| {
        let most = if error.is_heavy_tailed() { FEW_TIMES * other.value } else { f64::INFINITY };
        error.value.min(most)
    };
    [limited(first, second), limited(second, first)]
}

/// The mean of errors, and how sure it is.
pub(super) fn mean_error(errors: impl Iterator<Item = f64>) -> ErrorEstimate {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for error in errors.filter(|error| error.is_finite()) {
        (count, sum, squares) = (count + 1.0, sum + error, squares + error * error);
    }
    if count < 2.0 {
        return NO_ERROR;
    }
    let value: f64 = sum / count;
    let variance = (squares / count - value * value).max(0.0) / (count - 1.0);
    ErrorEstimate { value, standard_error: variance.sqrt() }
}

/// What squares tell of the time to a given error, in that of paths by themselves.
struct Model {
    /// For each way the error that has nothing to do with caustics, what is known of these, and the time of a sample.
    rest: Vec<f64>,
    caustics: Vec<Caustics>,
    times: Vec<f64>,
    /// Number of light paths for each sample of all pixels, and their time.
    light: Option<(u32, f64)>,
    /// Error that is of light samples at the hits that the camera sees, and the time of one more of these.
    direct: Option<[f64; 2]>,
}

impl Model {
    /// From the squares of so many ways with few light samples. `ray`: mean time of a ray in the first of these, over that of a path's.
    fn of(squares: &[Square], ways: usize, light: Option<(u32, f64)>, ray: f64) -> Self {
        let rays = |way: usize| squares.iter().map(|square| square.costs[way].rays).sum::<u64>() as f64;
        let few = rays(0).max(1.0);
        let times = (0..ways).map(|way| 1.0 + TIME_OF_A_SHARED_RAY * (rays(way) / few - 1.0)).collect();
        let light = light.map(|(count, rays)| (count, TIME_OF_A_LIGHT_RAY * rays / (few * ray)));
        let mut errors = vec![0.0; ways];
        for square in squares {
            let [first, second] = errors_of([square.costs[0].error, square.costs[ways - 1].error]);
            errors[ways - 1] += second;
            if ways > 1 {
                errors[0] += first;
            }
        }
        let caustics: Vec<Caustics> = (0..ways)
            .map(|way| {
                squares.iter().filter_map(|square| square.caustics.get(way)).fold(Caustics::default(), |mut sum, of| {
                    sum.add(of, 1.0);
                    sum
                })
            })
            .collect();
        let rest = errors.iter().zip(&caustics).map(|(error, of)| (error - of.weighted).max(LEAST_REST * error));
        let rest = rest.collect();
        // Of squares that were rendered with more light samples too: errors with few and with more, and rays of paths by themselves, with
        // few light samples and with more.
        let mut sums = [0.0; 5];
        for square in squares {
            let (Some(few), Some(more)) = (square.costs.get(ways - 1), square.costs.get(ways)) else { continue };
            let [rays, rays_of_few, rays_of_more] = [&square.costs[0], few, more].map(|cost| cost.rays as f64);
            let [with_few, with_more] = errors_of([few.error, more.error]);
            let of = [with_few, with_more, rays, rays_of_few, rays_of_more];
            sums.iter_mut().zip(of).for_each(|(sum, of)| *sum += of);
        }
        let [with_few, with_more, alone, rays_of_few, rays_of_more] = sums;
        let tried = f64::from(SAMPLES_TRIED);
        let direct = (with_few > 0.0 && alone > 0.0).then(|| {
            let share = (1.0 - with_more / with_few) * tried / (tried - 1.0);
            // Paths of other random numbers have other numbers of rays.
            let more = (rays_of_more - rays_of_few).max(0.0);
            let time = TIME_OF_A_LIGHT_SAMPLE * more / (alone * ray * (tried - 1.0));
            [share.clamp(0.0, 1.0) * errors[ways - 1], time]
        });
        Self { rest, caustics, times, light, direct }
    }

    /// What a way costs with light paths at this place of [`TIMES_AS_MANY`] or without, with the number of light samples at the first hit
    /// that makes it least.
    fn cost(&self, way: usize, place: Option<usize>) -> WayCost {
        let (mut error, mut time) = (self.rest[way], self.times[way]);
        match (place, self.light) {
            (Some(place), Some((_, light))) => {
                error += self.caustics[way].beside[place];
                time += light * f64::from(TIMES_AS_MANY[place]);
            }
            _ => error += self.caustics[way].alone,
        }
        let with = |times: u32| {
            let [direct, longer] = self.direct.unwrap_or_default();
            let gone = direct * (1.0 - 1.0 / f64::from(times));
            let error = (error - gone).max(LEAST_REST * error);
            WayCost { error, time: time + f64::from(times - 1) * longer, first_shadow_rays: times }
        };
        let costs = TIMES_AS_MANY_SAMPLES.map(with).into_iter();
        costs.min_by(|a, b| a.counted().total_cmp(&b.counted())).unwrap_or_else(|| with(1))
    }
}

/// What a way costs.
#[derive(Clone, Copy, Debug)]
struct WayCost {
    /// Sum of the errors of the squares.
    error: f64,
    /// In that of paths by themselves.
    time: f64,
    /// Number of light samples at the hits that the camera sees, in that of other hits.
    first_shadow_rays: u32,
}

impl WayCost {
    /// Error times time, as it counts against other ways.
    fn counted(&self) -> f64 {
        let doubt = if self.first_shadow_rays > 1 { DOUBT_OF_SAMPLES } else { 1.0 };
        doubt * self.error * self.time
    }
}

/// The gain of other ways than the first, by the squares' costs in so many ways with few light samples. `light`: number of light paths for
/// each sample of all pixels, and their number of rays for the samples of the squares. `ray`: see [`Model::of`].
pub(super) fn compare(squares: &[Square], ways: usize, light: Option<(u32, f64)>, ray: f64) -> Found {
    let rays = squares.iter().flat_map(|square| &square.costs).map(|cost| cost.rays).sum();
    let rays_of_more = squares.iter().flat_map(|square| square.costs.get(ways)).map(|cost| cost.rays).sum::<u64>();
    let model = Model::of(squares, ways, light, ray);
    // Black squares, and those without noise, gain nothing.
    let gain = |before: f64, after: f64| if before > 0.0 { before / after.max(f64::MIN_POSITIVE) } else { 0.0 };
    let gain_of_second = |costs: &[WayCost]| match costs {
        [first, second, ..] => gain(first.counted(), second.counted()),
        _ => 0.0,
    };
    let plain: Vec<_> = (0..ways).map(|way| model.cost(way, None)).collect();
    let sharing = gain_of_second(&plain);
    let chosen = |sharing: f64| usize::from(sharing >= LEAST_GAIN);
    let few = squares.iter().map(|square| square.costs[0].rays).sum::<u64>() as f64;
    let count = squares.len().max(1) as f64;
    let best = |way, cost: WayCost| {
        let samples = count * f64::from(SQUARE * SQUARE * SAMPLES);
        Best { way, error: cost.error / count, rays: cost.time * few * ray / samples }
    };
    let without = chosen(sharing);
    let without = Found {
        sharing,
        light: 0.0,
        count: 0,
        first_shadow_rays: plain[without].first_shadow_rays,
        best: best(Some(without), plain[without]),
        cached: None,
        rays,
        time: ray * few * model.times.iter().sum::<f64>() + TIME_OF_A_RAY_AMONG_SHARED * rays_of_more as f64,
    };
    let Some((count, _)) = light else { return without };
    // For each way the least cost, and of how many light paths it is.
    let lit: Vec<_> = (0..ways)
        .map(|way| {
            let costs = (0..TIMES_AS_MANY.len()).map(|place| (model.cost(way, Some(place)), TIMES_AS_MANY[place]));
            costs.min_by(|a, b| a.0.counted().total_cmp(&b.0.counted())).unwrap_or((model.cost(way, None), 1))
        })
        .collect();
    let lit_sharing = gain_of_second(&lit.iter().map(|(cost, _)| *cost).collect::<Vec<_>>());
    let way = chosen(lit_sharing);
    let (cost, times) = lit[way];
    let gained = gain(plain[chosen(sharing)].counted(), cost.counted());
    let count = count.saturating_mul(times);
    if gained < LEAST_LIGHT_GAIN {
        return Found { light: gained, count, ..without };
    }
    let first_shadow_rays = cost.first_shadow_rays;
    Found { sharing: lit_sharing, light: gained, count, first_shadow_rays, best: best(None, cost), ..without }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares with errors [value, standard error] without and with shared hits.
    fn squares(errors: &[[[f64; 2]; 2]], rays: [u64; 2]) -> Vec<Square> {
        let cost = |[value, standard_error]: [f64; 2], rays| {
            let error = ErrorEstimate { value, standard_error };
            Cost { error, rays }
        };
        let square = |errors: &[[f64; 2]; 2]| {
            let costs = [0, 1].map(|way| cost(errors[way], rays[way])).to_vec();
            Square { origin: [0; 2], costs, pixels: Vec::new(), caustics: vec![Caustics::default(); 2] }
        };
        errors.iter().map(square).collect()
    }

    #[test]
    fn the_gain_is_that_of_errors_over_that_of_rays() {
        let found = compare(&squares(&[[[0.3, 0.01], [0.1, 0.01]]; 36], [100, 300]), 2, None, 1.0);
        assert!((found.sharing - 3.0 / 1.9).abs() < 1e-12, "{found:?}");
        assert_eq!(found.rays, 36 * 400);
        assert!(found.shares() && !found.traces_light());
        assert!(!compare(&squares(&[[[0.3, 0.01], [0.2, 0.01]]; 36], [100, 300]), 2, None, 1.0).shares());
    }

    #[test]
    fn rare_bright_paths_do_not_decide() {
        let mut errors = [[[0.3, 0.01], [0.1, 0.01]]; 36];
        errors[7][1] = [1e6, 9e5];
        errors[20][0] = [1e9, 9e8];
        let found = compare(&squares(&errors, [100, 100]), 2, None, 1.0);
        // One of 36 squares is four times as bad, another four times as good.
        let expected = (35.0 * 0.3 + 4.0 * 0.1) / (35.0 * 0.1 + 4.0 * 0.3);
        assert!((found.sharing - expected).abs() < 1e-12, "{found:?}");
        // Both ways have the same few noisy pixels, as at the edges of lamps.
        errors[7] = [[300.0, 200.0]; 2];
        assert!(compare(&squares(&errors, [100, 100]), 2, None, 1.0).sharing < 1.1);
    }

    #[test]
    fn squares_without_light_or_noise_share_nothing() {
        let of = |errors, rays| compare(&squares(&[errors; 36], rays), 2, None, 1.0).shares();
        assert!(!of([[0.0; 2]; 2], [100, 100]));
        assert!(!of([[0.0; 2]; 2], [0, 0]));
        assert!(of([[0.1, 0.0], [0.0; 2]], [100, 100]));
        let dark = compare(&squares(&[[[0.0; 2]; 2]; 36], [100, 100]), 2, Some((10, 5.0)), 1.0);
        assert!(!dark.shares() && !dark.traces_light(), "{dark:?}");
    }

    #[test]
    fn more_light_samples_are_taken_where_these_are_most_of_the_noise() {
        // Ways by themselves and with shared hits, and the latter with four times as many light samples at the first hit.
        let tried = |errors: [[f64; 2]; 2], [more, rays]: [f64; 2]| {
            let mut squares = squares(&[errors; 36], [100, 300]);
            let error = ErrorEstimate { value: more, standard_error: 1e-3 * more };
            squares.iter_mut().step_by(2).for_each(|square| square.costs.push(Cost { error, rays: rays as u64 }));
            compare(&squares, 2, None, 1.0)
        };
        // Of 0.1, 0.08 are of light samples: 0.1 (A + B / n) (T + n t) is least for 4 of 1, 2, 4 and 8.
        let found = tried([[0.3, 0.01], [0.1, 0.001]], [0.04, 360.0]);
        assert_eq!(found.first_shadow_rays, 4, "{found:?}");
        let sample = TIME_OF_A_LIGHT_SAMPLE * 0.2;
        assert!((found.sharing - 0.3 / (1.25 * 0.04 * (1.9 + 3.0 * sample))).abs() < 1e-9, "{found:?}");
        assert_eq!(found.rays, 36 * 400 + 18 * 360);
        // Not where they take much time, and not where they bring nothing.
        assert_eq!(tried([[0.3, 0.01], [0.1, 0.001]], [0.04, 600.0]).first_shadow_rays, 1);
        assert_eq!(tried([[0.3, 0.01], [0.1, 0.001]], [0.09, 360.0]).first_shadow_rays, 1);
        assert_eq!(tried([[0.3, 0.01], [0.1, 0.001]], [0.2, 360.0]).first_shadow_rays, 1);
        // Fewer rays by chance are no time that is gained.
        let few = tried([[0.3, 0.01], [0.1, 0.001]], [0.098, 100.0]);
        assert!(few.first_shadow_rays == 1 && few.sharing > 0.0 && few.sharing < 2.0, "{few:?}");
        // Sharing takes the noise of what is not shared to account.
        let apart = tried([[0.2, 0.001], [0.15, 0.001]], [0.0395, 360.0]);
        assert!(apart.shares() && apart.first_shadow_rays == 8, "{apart:?}");
        assert!(!compare(&squares(&[[[0.2, 0.001], [0.15, 0.001]]; 36], [100, 300]), 2, None, 1.0).shares());
        // A square that met rare bright paths once does not decide.
        let mut few = squares(&[[[0.3, 0.01], [0.1, 0.001]]; 36], [100, 300]);
        let cost = |value, standard_error| Cost { error: ErrorEstimate { value, standard_error }, rays: 360 };
        few.iter_mut().for_each(|square| square.costs.push(cost(0.04, 1e-3)));
        few[3].costs[2] = cost(1e6, 9e5);
        assert_eq!(compare(&few, 2, None, 1.0).first_shadow_rays, 4);
    }

    /// Squares in which light paths tell of caustics, in both ways.
    fn with_caustics(errors: [[f64; 2]; 2], caustics: [Caustics; 2]) -> Vec<Square> {
        let mut squares = squares(&[errors; 36], [100, 300]);
        squares.iter_mut().for_each(|square| square.caustics = caustics.to_vec());
        squares
    }

    #[test]
    fn light_paths_are_traced_where_caustics_are_most_of_the_noise() {
        let caustics = |alone, beside: f64| Caustics {
            alone,
            weighted: 0.0,
            beside: [1.0, 0.5, 0.25, 0.125].map(|it| it * beside),
        };
        let errors = [[0.1, 0.001], [0.08, 0.001]];
        // A few light rays beside 3600 of paths: as many of them as make their noise small.
        let found = compare(&with_caustics(errors, [caustics(0.9, 0.1); 2]), 2, Some((10, 36.0)), 1.0);
        assert!(found.traces_light() && !found.shares(), "{found:?}");
        let with = |times: f64, noise: f64| (0.1 + noise) * (1.0 + TIME_OF_A_LIGHT_RAY * times * 0.01);
        assert_eq!(found.count, 80);
        assert!((found.light - 1.0 / with(8.0, 0.0125)).abs() < 1e-9, "{found:?}");
        // Where they are little of it, they are not worth their time, and sharing is chosen as without.
        let errors = [[0.3, 0.001], [0.1, 0.001]];
        let found = compare(&with_caustics(errors, [caustics(0.01, 0.001); 2]), 2, Some((10, 36.0)), 1.0);
        assert!(!found.traces_light() && found.shares(), "{found:?}");
        // Both.
        let found = compare(&with_caustics(errors, [caustics(0.9, 0.1), caustics(0.6, 0.1)]), 2, Some((10, 36.0)), 1.0);
        assert!(found.traces_light() && found.shares(), "{found:?}");
        // Light rays that take longer than all paths.
        let found = compare(&with_caustics(errors, [caustics(0.1, 0.01); 2]), 2, Some((10, 36000.0)), 1.0);
        assert!(!found.traces_light(), "{found:?}");
    }

    #[test]
    fn errors_of_few_pixels_are_unsure() {
        let even = mean_error([2.0; 64].into_iter());
        assert!(even.value == 2.0 && even.standard_error == 0.0 && !even.is_heavy_tailed());
        let few = mean_error((0..64).map(|pixel| if pixel == 5 { 64.0 } else { 0.0 }));
        assert!(few.value == 1.0 && few.is_heavy_tailed());
        assert_eq!(mean_error([f64::NAN; 64].into_iter()), NO_ERROR);
    }
}
