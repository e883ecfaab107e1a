//! Adaptive sampling: the choice of the pixels that get more samples than others.
//!
//! The error of an image is a sum over pixels of v / n, where v is the variance of one sample (as the error measure weighs
//! it) and n is the pixel's number of samples. For a given sum of all n, the error is least where n is in proportion to
//! sqrt(v). Each pixel therefore has a goal, a number of samples that is set from the current estimate of v: first after
//! a pilot with the same number of samples for every pixel, and again each time that the number of samples has doubled.
//!
//! **Bias.** If a pixel's number of samples depended on the pixel's own samples, pixels that have missed their bright paths
//! would stop early, and the image would be too dark on average. A pixel's goal therefore depends on the pixel's neighbours
//! only. For the first goals after the pilot, this makes the pixel exactly unbiased: given the samples of all other pixels,
//! the pixel's number of samples is a constant, and the mean of a fixed number of samples has no bias. Two effects of second
//! order remain, which tests/error_estimates.rs cannot measure. First, all goals have a common factor, in which each pixel
//! has the weight of one pixel among all. Second, later goals depend on neighbours whose numbers of samples (but not whose
//! values) depend on this pixel, among others. A render that ends at a target error is a further choice by the samples, in
//! which a pixel again has the weight of one pixel among all. This choice matters only where few pixels have most of the
//! error, and in that case the render continues (see `schedule`).

use crate::Cancel;
use crate::control::Parallel;
use crate::error::Result;
use crate::film::{ErrorMeasure, Film, REPLICATES};
use crate::sampling::hash;

/// Number of samples that every pixel gets before the numbers of samples differ: two for each replicate.
pub(super) const PILOT: u32 = 2 * REPLICATES as u32;

/// Smallest number of pixels of an adaptive render. In smaller images, a pixel's own samples would influence the pixel's goal
/// through the common factor of all goals.
pub(super) const MIN_PIXELS: u64 = 128;

/// Fraction of the mean number of samples that every pixel gets, whatever the errors of its neighbours are.
const UNIFORM_FRACTION: f64 = 0.25;

/// Reach of the neighbourhood in pixels: the neighbours are 5 x 5 pixels without the one in the middle. The relative error
/// of a standard error is a quarter with the eight replicates of one pixel, and a twentieth with those of 24 pixels.
/// Measurements: docs/performance.md.
const NEIGHBOURHOOD: usize = 2;

/// The part of an adaptive render from one choice of goals to the next.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    /// Number of samples of each pixel at the beginning of the stage, row by row.
    from: Vec<u32>,
    /// Goals: the number of samples of each pixel at the end of the stage, row by row.
    to: Vec<u32>,
    /// Mean number of samples over all pixels at the beginning and at the end of the stage.
    begin: u32,
    end: u32,
}

impl Stage {
    /// Makes the stage in which the mean number of samples over pixels rises from `begin`, the film's current number, to
    /// `end`. The result depends on the film and the arguments only.
    ///
    /// # Errors
    /// [`ErrorKind::Cancelled`](crate::ErrorKind::Cancelled) if the render was cancelled, and other errors of `parallel`.
    pub(super) fn new(
        film: &Film,
        measure: ErrorMeasure,
        [begin, end]: [u32; 2],
        seed: u64,
        parallel: &mut impl Parallel,
    ) -> Result<Self> {
        let (from, mut deviations) = film.own_errors(measure, parallel)?;
        // Square roots of the variances of one sample.
        for (error, &count) in deviations.iter_mut().zip(&from) {
            let variance = *error * f64::from(count);
            *error = if variance > 0.0 && variance.is_finite() { variance.sqrt() } else { 0.0 };
        }
        let cancel = &parallel.token();
        let weights = weights(&deviations, film.options().resolution.map(|n| n as usize), cancel)?;
        let unit = film.options().share.saturating_mul(REPLICATES as u32);
        let to = goals(&from, &weights, unit, end, hash(seed, u64::from(begin)), cancel)?;
        Ok(Self { from, to, begin, end })
    }

    /// A stage from `begin` to `end` without pixels, for a stage that is read.
    pub fn empty([begin, end]: [u32; 2]) -> Self {
        Self { from: Vec::new(), to: Vec::new(), begin, end }
    }

    /// Mean number of samples over all pixels at the beginning and at the end of the stage.
    pub fn span(&self) -> [u32; 2] {
        [self.begin, self.end]
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.from.len()
    }

    /// The rows of an image of this width: numbers of samples at the beginning, and those at the end.
    pub fn rows(&self, width: usize) -> impl Iterator<Item = [&[u32]; 2]> {
        self.from.chunks(width).zip(self.to.chunks(width)).map(|(from, to)| [from, to])
    }

    /// Adds a row: `width` numbers of samples at the beginning, and as many at the end. `false` where memory is short, and for
    /// goals that lie behind.
    pub fn push_row(&mut self, [from, to]: [&[u32]; 2]) -> bool {
        let has_room = self.from.try_reserve(from.len()).is_ok() && self.to.try_reserve(to.len()).is_ok();
        if has_room {
            self.from.extend_from_slice(from);
            self.to.extend_from_slice(to);
        }
        has_room && from.iter().zip(to).all(|(from, to)| from <= to)
    }

    /// The number of samples of each pixel when the mean over pixels is `level`. Every pixel has then taken the same fraction
    /// of the samples that it gets in this stage.
    pub(super) fn goals(&self, level: u32) -> Vec<u32> {
        let (done, all) = (u64::from(level.clamp(self.begin, self.end) - self.begin), u64::from(self.end - self.begin));
        let goal = |(&from, &to): (&u32, &u32)| from + (u64::from(to - from) * done).div_ceil(all.max(1)) as u32;
        self.from.iter().zip(&self.to).map(goal).collect()
    }
}

/// Weights to which the numbers of samples are to be in proportion: the mean of the neighbours' standard deviations, and a
/// fraction of the mean over all pixels.
///
/// Standard deviations are averaged and not variances, because a single firefly would dominate a mean of variances.
fn weights(deviations: &[f64], [width, height]: [usize; 2], cancel: &Cancel) -> Result<Vec<f64>> {
    let mut pooled = Vec::with_capacity(deviations.len());
    for y in 0..height {
        cancel.check()?;
        for x in 0..width {
            let (mut sum, mut count) = (0.0, 0.0);
            for row in y.saturating_sub(NEIGHBOURHOOD)..(y + NEIGHBOURHOOD + 1).min(height) {
                for column in x.saturating_sub(NEIGHBOURHOOD)..(x + NEIGHBOURHOOD + 1).min(width) {
                    // The pixel itself is left out of the sum, so that it does not influence the weight even by rounding.
                    if (column, row) != (x, y) {
                        sum += deviations[row * width + column];
                        count += 1.0;
                    }
                }
            }
            pooled.push(if count > 0.0 { sum / count } else { 0.0 });
        }
    }
    let mean = pooled.iter().sum::<f64>() / pooled.len().max(1) as f64;
    // Where no error is known, all pixels get the same weight.
    if !(mean > 0.0 && mean.is_finite()) {
        return Ok(vec![1.0; pooled.len()]);
    }
    Ok(pooled.iter().map(|pooled| UNIFORM_FRACTION + (1.0 - UNIFORM_FRACTION) * pooled / mean).collect())
}

/// Goals in proportion to `weights`. Goals are multiples of `unit`, so that all replicates of a pixel have equally many
/// samples, and not below `from`. Their sum is that of `mean` samples for each pixel, or less by fewer than `unit` samples.
///
/// Goals are rounded up or down at random, by a hash of `seed` and the pixel.
fn goals(from: &[u32], weights: &[f64], unit: u32, mean: u32, seed: u64, cancel: &Cancel) -> Result<Vec<u32>> {
    let offsets: Vec<f64> =
        (0..from.len()).map(|pixel| (hash(seed, pixel as u64) >> 11) as f64 * (-53_f64).exp2()).collect();
    let goal = |pixel: usize, factor: f64| {
        let units = (factor * weights[pixel] / f64::from(unit) + offsets[pixel]).floor();
        // The conversion saturates at the largest u32.
        from[pixel].max((units as u32).saturating_mul(unit))
    };
    let budget = u64::from(mean) * from.len() as u64;
    let total = |factor: f64| (0..from.len()).map(|pixel| u64::from(goal(pixel, factor))).sum::<u64>();
    // Bisection for the largest factor that the budget allows, to a relative accuracy of 2^-40.
    let (mut low, mut high) = (0.0, 2.0 * f64::from(mean));
    while total(high) <= budget && high < 1e15 && !cancel.is_cancelled() {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..40 {
        cancel.check()?;
        let middle = 0.5 * (low + high);
        if total(middle) <= budget { low = middle } else { high = middle }
    }
    let mut goals: Vec<u32> = (0..from.len()).map(|pixel| goal(pixel, low)).collect();
    // The rest of the budget goes to consecutive pixels, one unit each, from a random pixel on.
    let mut left = budget.saturating_sub(goals.iter().map(|goal| u64::from(*goal)).sum());
    let mut pixel = (hash(seed, u64::MAX) % from.len().max(1) as u64) as usize;
    while left >= u64::from(unit) {
        goals[pixel] = goals[pixel].saturating_add(unit);
        left -= u64::from(unit);
        pixel = (pixel + 1) % from.len();
    }
    Ok(goals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_in_proportion_and_add_up() {
        let weights: Vec<f64> = (0..1000).map(|i| 0.25 + f64::from(i) * 0.0015).collect();
        let mean_weight = weights.iter().sum::<f64>() / 1000.0;
        for (mean, unit) in [(32, 8), (100, 8), (1000, 32)] {
            let from = vec![16 / unit * unit; 1000];
            let goals = goals(&from, &weights, unit, mean, 3, &Cancel::new()).unwrap();
            let total: u64 = goals.iter().map(|goal| u64::from(*goal)).sum();
            let budget = u64::from(mean) * 1000;
            assert!(total <= budget && total + u64::from(unit) > budget, "{total} of {budget}");
            assert!(goals.iter().all(|goal| goal % unit == 0));
            for (goal, weight) in goals.iter().zip(&weights) {
                // Pixels that already have more samples than their weight asks for leave fewer for the others.
                let wanted = weight / mean_weight * f64::from(mean);
                assert!(f64::from(*goal) < wanted + f64::from(unit) + 16.0, "{goal} for {wanted}");
                assert!(f64::from(*goal) > 0.8 * wanted - f64::from(unit), "{goal} for {wanted}");
            }
        }
    }

    #[test]
    fn a_pixels_weight_does_not_depend_on_its_own_deviation() {
        // Pixel 17 is in the middle. Pixel 0 is not among its neighbours.
        let mut deviations: Vec<f64> = (0..35).map(|i| f64::from(1 + i % 4)).collect();
        let relative = |deviations: &[f64], pixel: usize| {
            let weights = weights(deviations, [7, 5], &Cancel::new()).unwrap();
            let mean = weights.iter().sum::<f64>() / 35.0;
            // Without the fraction that all pixels get.
            (weights[pixel] / mean - UNIFORM_FRACTION) / (weights[0] / mean - UNIFORM_FRACTION)
        };
        let before = [17, 18].map(|pixel| relative(&deviations, pixel));
        deviations[17] = 1e3;
        let after = [17, 18].map(|pixel| relative(&deviations, pixel));
        assert!((before[0] / after[0] - 1.0).abs() < 1e-9, "{before:?}, {after:?}");
        assert!(after[1] > 10.0 * before[1], "{before:?}, {after:?}");
    }

    #[test]
    fn weights_are_equal_where_no_error_is_known() {
        assert_eq!(weights(&[0.0; 12], [4, 3], &Cancel::new()).unwrap(), [1.0; 12]);
        assert_eq!(weights(&[5.0], [1, 1], &Cancel::new()).unwrap(), [1.0]);
        assert_eq!(goals(&[16], &[1.0], 8, 32, 7, &Cancel::new()).unwrap(), [32]);
    }

    #[test]
    fn stages_go_forward_to_their_end() {
        let stage = Stage { from: vec![16, 16, 24], to: vec![16, 48, 64], begin: 20, end: 43 };
        assert_eq!(stage.goals(20), stage.from);
        assert_eq!(stage.goals(43), stage.to);
        let (early, late) = (stage.goals(25), stage.goals(40));
        assert!(early.iter().zip(&late).all(|(early, late)| early <= late));
    }
}
