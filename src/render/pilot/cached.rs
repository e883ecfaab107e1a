//! Whether a pilot takes the irradiance cache in place of paths, where the settings allow a bias.
//!
//! Paths have the error V / n after n samples of each pixel, in the time n T. The cache has b² + v / n in the time s + n t: its bias b does
//! not fall with the number of samples, and filling it takes the time s once. For the number of samples that is asked for, the way with the
//! least product of error and time is the one that is worth most. So a cache is taken for few samples, and paths for many.
//!
//! Squares of the picture show beforehand what a cache without bias would come to: its noise is that of light that paths see of lamps
//! themselves and by way of mirrors and glass. Where that would gain too little, no cache is filled, and filling is given up after the time with
//! which it would.
//!
//! The same squares by the cache, and by paths of other random numbers, then give v and b². The mean of each square is compared, because the
//! bias is smooth and the noise of a mean is less than that of a pixel: of the square of the difference, the variances of both means are taken
//! off. Where that is less than what the cache's own probes have found of indirect light, times the share that this has of the squares' light,
//! the latter counts.

use std::sync::Arc;

use super::gain::Best;
use super::measure::{Measure, squared};
use super::size::Size;
use super::{Rendered, SEED, place, render_square};
use crate::control::Parallel;
use crate::desc::RenderDesc;
use crate::error::{Error, ErrorKind, Result};
use crate::integrator::photon::Plan;
use crate::render::method::Method;
use crate::render::pass::PassInput;

/// Greatest share of the time of paths that filling a cache may take before it is given up.
const LARGEST_FILL: f64 = 0.4;

/// Time of a ray of filling and reading the cache over the time of a path's ray. Such rays go one by one, and few of them share the
/// cost of a sample: 1.6 in the Cornell box, 1.8 in the room, 2.7 among coats.
const TIME_OF_A_RAY: f64 = 1.9;

/// The gain from which on the cache is taken.
const LEAST_GAIN: f64 = 1.5;

/// Greatest error of the cache, in that of paths, with which it is taken. Points that are spread evenly make paths better than
/// 16 samples tell.
const MOST_ERROR: f64 = 0.75;

/// Variance of the mean of a square below which a square counts as free of noise.
const QUIET: f64 = 1e-8;

/// What a pilot found of the cache.
#[derive(Clone, Debug)]
pub(in super::super) enum Cached {
    /// It was not filled, or not to the end.
    GivenUp,
    Compared(Comparison),
}

/// The cache against the best way of paths, for the number of samples that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Comparison {
    /// How many times longer paths take, error times time.
    gain: f64,
    /// Error of the cache, with its bias, over that of paths.
    error: f64,
    /// Root of the relMSE that is the bias.
    bias: f64,
}

impl Cached {
    /// Whether the cache is to be taken: it saves time, and the picture is no worse than the one that was asked for.
    pub fn is_taken(&self) -> bool {
        matches!(self, Self::Compared(Comparison { gain, error, .. }) if *gain >= LEAST_GAIN && *error <= MOST_ERROR)
    }

    /// Why, or why not, in a sentence without a full stop.
    pub fn why(&self) -> String {
        let Self::Compared(Comparison { gain, error, bias }) = self else {
            return "the irradiance cache would gain too little for the time that filling it takes".to_owned();
        };
        if !(gain.is_finite() && error.is_finite() && bias.is_finite()) {
            return "paths have no noise that the irradiance cache could be compared with".to_owned();
        }
        let bias = 100.0 * bias;
        if self.is_taken() {
            format!(
                "a pilot expected the same error in {gain:.1} times less time than by paths, its bias of {bias:.2} % counted"
            )
        } else if *error > MOST_ERROR {
            format!(
                "a pilot expected the irradiance cache to have {error:.1} times the error that paths have after so many samples, by a \
                 bias of {bias:.2} %"
            )
        } else {
            format!(
                "a pilot expected too little of the irradiance cache: the same error in {gain:.1} times less time, with a bias of \
                 {bias:.2} %"
            )
        }
    }
}

/// What the picture asks of paths.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Asked {
    /// Number of samples of each pixel.
    pub samples: f64,
    /// Number of pixels that filling is for: those of the picture, or where time ends the render, those that are rendered.
    pub pixels: f64,
    /// The pilot's.
    pub size: Size,
}

/// What the squares tell of the cache.
#[derive(Clone, Copy, Debug, Default)]
struct Tried {
    /// Error of the samples of the pilot, without the bias, as the mean over squares.
    error: f64,
    /// Rays of a sample.
    rays: f64,
    /// Rays of filling.
    fill: f64,
    /// Squared bias, as relMSE counts it.
    bias: f64,
}

/// The cache against paths, for so many samples.
fn compare(paths: Best, cache: Tried, Asked { samples, pixels, size }: Asked) -> Comparison {
    let fewer = f64::from(size.samples) / samples;
    let (of_paths, of_cache) = (paths.error * fewer, cache.bias + cache.error * fewer);
    let time = TIME_OF_A_RAY * (cache.rays + cache.fill / (pixels * samples));
    let error = if of_paths > 0.0 { of_cache / of_paths } else { f64::INFINITY };
    Comparison { gain: paths.rays / (error * time).max(f64::MIN_POSITIVE), error, bias: cache.bias.sqrt() }
}

/// Most rays of filling with which a cache without bias would still be taken.
fn most_of_fill(paths: Best, cache: Tried, Asked { samples, pixels, .. }: Asked) -> f64 {
    let of_paths = paths.error * paths.rays;
    let of_cache = (LEAST_GAIN * TIME_OF_A_RAY * cache.error).max(f64::MIN_POSITIVE);
    (pixels * samples * (of_paths / of_cache - cache.rays)).max(0.0)
}

/// The difference of a square's mean between the cache and paths, relative to its pixels, and the variance of that.
#[derive(Clone, Copy, Debug)]
struct Difference {
    mean: f64,
    variance: f64,
}

impl Difference {
    /// From the mean luminances of pixels and the variances of these, by the cache and by paths.
    fn of(cache: &[[f64; 2]], paths: &[[f64; 2]]) -> Self {
        // Where one of them is black, the other counts all the same.
        let means: Vec<f64> = cache.iter().zip(paths).map(|(cache, paths)| 0.5 * (cache[0] + paths[0])).collect();
        let count = means.len().max(1) as f64;
        let (mut mean, mut variance) = (0.0, 0.0);
        for ((squared, cache), paths) in squared(&means).iter().zip(cache).zip(paths) {
            mean += (cache[0] - paths[0]) / squared.sqrt();
            variance += (cache[1] + paths[1]) / squared;
        }
        Self { mean: mean / count, variance: variance / (count * count) }
    }
}

/// The share of a square's light that is not direct, by the mean luminances of its pixels.
fn indirect_share(all: &[[f64; 2]], direct: &[[f64; 2]]) -> f64 {
    let sum = |pixels: &[[f64; 2]]| pixels.iter().map(|[mean, _]| *mean).sum::<f64>();
    let all = sum(all);
    if all > 0.0 { (1.0 - sum(direct) / all).clamp(0.0, 1.0) } else { 0.0 }
}

/// The squared bias that differences of squares show, and one standard error more. Squares that paths find very noisy count less.
fn squared_bias(differences: &[Difference]) -> f64 {
    let known = differences.iter().filter(|it| it.mean.is_finite() && it.variance.is_finite());
    let mut noise: Vec<f64> = known.clone().map(|it| it.variance).filter(|variance| *variance > QUIET).collect();
    noise.sort_unstable_by(f64::total_cmp);
    let middle = noise.get(noise.len() / 2).copied().unwrap_or(QUIET);
    let (mut sum, mut weights, mut variances) = (0.0, 0.0, 0.0);
    for Difference { mean, variance } in known {
        // Those with the middle's noise and less count alike.
        let weight = (2.0 * middle / (variance + middle)).powi(2).min(1.0);
        sum += weight * (mean * mean - variance);
        weights += weight;
        // The square of a normal variable has twice the square of its variance.
        variances += 2.0 * (weight * variance).powi(2);
    }
    if weights > 0.0 { (f64::max(sum, 0.0) + f64::sqrt(variances)) / weights } else { f64::INFINITY }
}

/// Squares of the picture, to be rendered in other ways than those of paths.
struct Squares<'a> {
    input: PassInput,
    size: Size,
    measure: &'a Measure,
}

impl Squares<'_> {
    /// Renders all squares in so many ways, each with a seed.
    fn render<const N: usize>(
        &self,
        ways: [(Method, u64); N],
        parallel: &mut impl Parallel,
    ) -> Result<Vec<[Rendered; N]>> {
        let (input, size, token) = (self.input.clone(), self.size, parallel.token());
        let squares = parallel.map(size.squares(), move |number| {
            let origin = place(&input, size.across, number as u32);
            let render = |(method, seed)| {
                let desc = Arc::new(RenderDesc { seed, ..(*input.desc).clone() });
                render_square(PassInput { method, desc, ..input.clone() }, origin, token.clone())
            };
            let rendered = ways.clone().map(render).into_iter().collect::<Result<Vec<_>>>()?;
            rendered.try_into().map_err(|_| Error::new(ErrorKind::Internal, "a square lacks a way"))
        })?;
        parallel.check()?;
        squares.into_iter().collect()
    }

    /// The noise and the time of a way that all squares were rendered in.
    fn tried<'a>(&self, squares: impl Iterator<Item = &'a Rendered>) -> Tried {
        let (mut error, mut rays, mut count) = (0.0, 0, 0.0);
        for (number, square) in squares.enumerate() {
            error += self.measure.error(number, &square.pixels);
            rays += square.rays;
            count += 1.0;
        }
        let count = f64::max(count, 1.0);
        Tried { error: error / count, rays: rays as f64 / self.size.samples_of(count), ..Tried::default() }
    }
}

/// Fills the cache, unless that takes longer than it can be worth, and compares it with the best way of paths. Returns the number of rays too.
///
/// # Errors
/// As [`super::pilot`].
pub(super) fn try_cache(
    input: &PassInput,
    plan: &mut Plan,
    (measure, paths): (&Measure, Best),
    asked: Asked,
    parallel: &mut impl Parallel,
) -> Result<(Cached, u64)> {
    let input = PassInput { light: None, first_shadow_rays: input.desc.shadow_rays, ..input.clone() };
    let squares = Squares { input, size: asked.size, measure };
    // Paths of other random numbers than those by which they were chosen: the least of several errors is too small.
    let rendered = squares.render([(Method::Path, !SEED), (Method::Whitted, SEED)], parallel)?;
    let mut rays = rendered.iter().flatten().map(|way| way.rays).sum::<u64>();
    let time = paths.rays * asked.samples * asked.pixels;
    // Light that paths see of lamps themselves and by way of mirrors and glass has the noise of a cache without bias.
    let hoped = squares.tried(rendered.iter().map(|[_, seen]| seen));
    let most = most_of_fill(paths, hoped, asked).min(LARGEST_FILL * time / TIME_OF_A_RAY);
    if most < 1.0 {
        return Ok((Cached::GivenUp, rays));
    }
    let before = plan.rays;
    let made = plan.cache_within(most as u64, parallel)?;
    let fill = plan.rays - before;
    rays += fill;
    // What the cache does not know of itself, squares alone would have to tell.
    let Some((gather, Some(rms_error))) = made else { return Ok((Cached::GivenUp, rays)) };
    let cached = squares.render([(Method::Gather(Box::new(gather)), SEED)], parallel)?;
    rays += cached.iter().flatten().map(|way| way.rays).sum::<u64>();
    let both = || cached.iter().map(|[cache]| &cache.pixels).zip(&rendered);
    let differences: Vec<_> = both().map(|(cache, [paths, _])| Difference::of(cache, &paths.pixels)).collect();
    let shares = both().map(|(cache, [_, seen])| indirect_share(cache, &seen.pixels).powi(2));
    let of_probes = rms_error * rms_error * shares.sum::<f64>() / cached.len().max(1) as f64;
    let bias = squared_bias(&differences).max(of_probes);
    let tried = squares.tried(cached.iter().map(|[cache]| cache));
    let cache = Tried { fill: fill as f64, bias, ..tried };
    Ok((Cached::Compared(compare(paths, cache, asked)), rays))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    const SIZE: Size = Size { across: 6, samples: 16 };
    const PATHS: Best = Best { error: 0.01, rays: 10.0 };

    #[test]
    fn the_bias_counts_more_the_more_samples_there_are() {
        let cache = Tried { error: 0.002, rays: 2.0, fill: 0.0, bias: 1e-4 };
        let of = |cache: Tried, samples: f64| compare(PATHS, cache, Asked { samples, pixels: 1000.0, size: SIZE });
        // Of 16 samples: 0.01 times 10 over 0.0021 times 2 rays.
        let few = of(cache, 16.0);
        assert!((few.gain - 0.1 / (0.0021 * 2.0 * TIME_OF_A_RAY)).abs() < 1e-9, "{few:?}");
        assert!((few.error - 0.21).abs() < 1e-12 && few.bias == 0.01 && Cached::Compared(few).is_taken(), "{few:?}");
        // Of 3200 samples, the noise is 0.00001, and that of paths 0.00005: the bias is twice that, although it takes less time.
        let many = of(cache, 3200.0);
        assert!((many.gain - 0.0005 / (1.1e-4 * 2.0 * TIME_OF_A_RAY)).abs() < 1e-9, "{many:?}");
        assert!((many.error - 2.2).abs() < 1e-12 && !Cached::Compared(many).is_taken(), "{many:?}");
        let without = of(Tried { bias: 0.0, ..cache }, 3200.0);
        assert!(Cached::Compared(without).is_taken(), "{without:?}");
        // The time of filling is that of as many samples.
        let filled = Tried { fill: 32_000.0, ..cache };
        assert!((of(filled, 16.0).gain - 0.5 * few.gain).abs() < 1e-9);
        let dark = compare(Best { error: 0.0, ..PATHS }, cache, Asked { samples: 16.0, pixels: 1.0, size: SIZE });
        assert!(!Cached::Compared(dark).is_taken(), "{dark:?}");
    }

    #[test]
    fn filling_is_given_up_where_it_could_gain_too_little() {
        let asked = Asked { samples: 64.0, pixels: 1000.0, size: SIZE };
        let cache = Tried { error: 0.002, rays: 2.0, ..Tried::default() };
        let fill = most_of_fill(PATHS, cache, asked);
        assert!(fill > 0.0 && (compare(PATHS, Tried { fill, ..cache }, asked).gain - LEAST_GAIN).abs() < 1e-9);
        assert_eq!(most_of_fill(PATHS, Tried { error: 0.02, ..cache }, asked), 0.0);
        assert_eq!(most_of_fill(Best { error: 0.0, ..PATHS }, cache, asked), 0.0);
    }

    #[test]
    fn a_bias_is_told_from_noise() {
        // Squares of 64 pixels whose light is 2, by paths with a standard deviation of 0.4 and by a cache with one of 0.1.
        let mut rng = Rng::new(7, 0);
        let mut noise = |deviation: f64| deviation * 3.0_f64.sqrt() * (2.0 * f64::from(rng.next_f32()) - 1.0);
        let mut squares = |bias: f64| -> Vec<Difference> {
            let mut pixels = |mean: f64, deviation: f64| -> Vec<[f64; 2]> {
                (0..64).map(|_| [mean + noise(deviation), deviation * deviation]).collect()
            };
            (0..100).map(|_| Difference::of(&pixels(2.0 + bias, 0.1), &pixels(2.0, 0.4))).collect()
        };
        // A mean of a square is known to 0.05 / 2, of which the square is 6e-4, and 100 of them to a seventh of that.
        let without = squared_bias(&squares(0.0));
        assert!(without < 4e-4, "{without}");
        let with = squared_bias(&squares(0.1));
        assert!((0.0024..0.0031).contains(&with), "{with}");
        // Squares of which few samples are very bright are left out, and where nothing is known, nothing is promised.
        let mut some = squares(0.1);
        some[3] = Difference { mean: 50.0, variance: 3000.0 };
        some[5] = Difference { mean: f64::NAN, variance: 1.0 };
        assert!((0.0022..0.0033).contains(&squared_bias(&some)), "{}", squared_bias(&some));
        assert_eq!(squared_bias(&[]), f64::INFINITY);
        // Squares without light or noise are a part of the picture, and no proof for the rest of it.
        let black = Difference { mean: 0.0, variance: 0.0 };
        for quiet in [black, Difference { mean: 1e-7, variance: 1e-14 }] {
            let mut most = vec![quiet; 60];
            most.extend([Difference { mean: 0.1, variance: 1e-4 }; 40]);
            assert!((squared_bias(&most) - 0.4 * (0.01 - 1e-4)).abs() < 2e-5, "{}", squared_bias(&most));
        }
        assert_eq!(squared_bias(&[black; 36]), 0.0);
        // A cache that misses all light of its squares.
        let missed = Difference::of(&[[0.0, 0.0]; 64], &[[2.0, 0.16]; 64]);
        assert!((squared_bias(&[missed; 36]) - 4.0).abs() < 0.1, "{missed:?}");
    }

    #[test]
    fn the_share_of_indirect_light_is_within_bounds() {
        let pixels = |mean: f64| vec![[mean, 0.0]; 4];
        assert_eq!(indirect_share(&pixels(2.0), &pixels(1.5)), 0.25);
        assert_eq!(indirect_share(&pixels(2.0), &pixels(2.5)), 0.0);
        assert_eq!(indirect_share(&pixels(0.0), &pixels(0.0)), 0.0);
    }
}
