//! Which pixels get more samples than others.
//!
//! An image's error is a sum over pixels of v / n, v the variance of one sample (as the error weighs it) and n their number. For
//! a given sum of all n it is least where n is in proportion to sqrt(v). So after a pilot of as many samples everywhere, and
//! again each time that the samples have doubled, goals are set by what v is estimated to be by then.
//!
//! **Why that is no bias.** Had a pixel's own samples a say in how many more it gets, those that have missed their bright
//! paths would stop early: too dark on average. So a pixel's goal is set by its neighbours only. With the pilot, that is exact:
//! given everybody else's samples, a pixel's number of samples is a constant, and the mean of a given number of samples has
//! no bias. What is left is of second order, and not measurable in tests/error_estimates.rs: all goals have a common factor,
//! in which a pixel has the weight of one in all; and later goals are set by neighbours whose own numbers of samples (not
//! their values) were set by this pixel's, among others. To stop once the whole image's error is small is another choice by
//! the samples, with the same weight of one pixel in all; it matters only where few pixels have all the error, and there
//! a render goes on (see `schedule`).

use crate::Cancel;
use crate::film::{ErrorMeasure, Film, REPLICATES};
use crate::sampling::hash;

/// Samples that every pixel gets before any gets more than another: two for each replicate.
pub(super) const PILOT: u32 = 2 * REPLICATES as u32;

/// In smaller images a pixel is so large a part of all that its own samples would have a say in its goal.
pub(super) const LEAST_PIXELS: u64 = 128;

/// What a pixel gets whatever its neighbours' errors are, as a share of the mean: none starves, none is cut off.
const SHARE_OF_ALL: f64 = 0.25;

/// How far neighbours reach: 5 x 5 pixels but the one in the middle. Eight replicates tell a standard error to a
/// quarter of itself, 24 pixels of them to a twentieth. Figures: docs/performance.md.
const REACH: usize = 2;

/// A part of an adaptive render at the end of which goals are set anew.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    /// Samples that pixels had at its beginning, row by row.
    from: Vec<u32>,
    /// Samples that they are to have at its end.
    to: Vec<u32>,
    /// The same of the mean over pixels.
    begin: u32,
    end: u32,
}

impl Stage {
    /// The stage in which the mean over pixels goes from `begin`, where the film is, to `end`; `None` if it was cancelled.
    ///
    /// A pure function of the film and the numbers.
    pub(super) fn new(
        film: &Film,
        measure: ErrorMeasure,
        [begin, end]: [u32; 2],
        seed: u64,
        cancel: &Cancel,
    ) -> Option<Self> {
        let [width, height] = film.options().resolution.map(|n| n as usize);
        let mut from = vec![0; width * height];
        // Roots of the variances of one sample.
        let mut deviations = vec![0.0; width * height];
        let is_whole = film.for_each_error(measure, true, cancel, |place, count, error2| {
            from[place] = count;
            let variance = error2 * f64::from(count);
            deviations[place] = if variance > 0.0 && variance.is_finite() { variance.sqrt() } else { 0.0 };
        });
        if !is_whole {
            return None;
        }
        let weights = weights(&deviations, [width, height], cancel)?;
        let unit = film.options().share.saturating_mul(REPLICATES as u32);
        let to = goals(&from, &weights, unit, end, hash(seed, u64::from(begin)), cancel)?;
        Some(Self { from, to, begin, end })
    }

    /// What each pixel is to have when the mean over pixels is `level`: as far on its way as all.
    pub(super) fn goals(&self, level: u32) -> Vec<u32> {
        let (done, all) = (u64::from(level.clamp(self.begin, self.end) - self.begin), u64::from(self.end - self.begin));
        let on_the_way = |(&from, &to): (&u32, &u32)| from + (u64::from(to - from) * done).div_ceil(all.max(1)) as u32;
        self.from.iter().zip(&self.to).map(on_the_way).collect()
    }
}

/// What pixels should get in proportion: the mean over their neighbours' deviations, and a share of the mean over all.
///
/// The mean of the roots and not the root of the mean, of which a single firefly would be nearly all.
fn weights(deviations: &[f64], [width, height]: [usize; 2], cancel: &Cancel) -> Option<Vec<f64>> {
    let mut pooled = Vec::with_capacity(deviations.len());
    for y in 0..height {
        if cancel.is_cancelled() {
            return None;
        }
        for x in 0..width {
            let (mut sum, mut count) = (0.0, 0.0);
            for row in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
                for column in x.saturating_sub(REACH)..(x + REACH + 1).min(width) {
                    // The pixel itself is left out and not subtracted: not even by rounding has it a say.
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
    // Nothing is known of any error: to all alike.
    if !(mean > 0.0 && mean.is_finite()) {
        return Some(vec![1.0; pooled.len()]);
    }
    Some(pooled.iter().map(|pooled| SHARE_OF_ALL + (1.0 - SHARE_OF_ALL) * pooled / mean).collect())
}

/// Goals in proportion to `weights`, in multiples of `unit`, so that replicates stay equal; never less than `from`, and
/// `mean` on average, but for less than a unit in the whole image.
///
/// They are rounded up or down by chance, at a place of the pixel's own.
fn goals(from: &[u32], weights: &[f64], unit: u32, mean: u32, seed: u64, cancel: &Cancel) -> Option<Vec<u32>> {
    let offsets: Vec<f64> =
        (0..from.len()).map(|pixel| (hash(seed, pixel as u64) >> 11) as f64 * (-53_f64).exp2()).collect();
    let goal = |pixel: usize, factor: f64| {
        let units = (factor * weights[pixel] / f64::from(unit) + offsets[pixel]).floor();
        // A float above all of u32 becomes its largest.
        from[pixel].max((units as u32).saturating_mul(unit))
    };
    let budget = u64::from(mean) * from.len() as u64;
    let total = |factor: f64| (0..from.len()).map(|pixel| u64::from(goal(pixel, factor))).sum::<u64>();
    // The largest factor that the budget allows, to a relative 2^-40.
    let (mut low, mut high) = (0.0, 2.0 * f64::from(mean));
    while total(high) <= budget && high < 1e15 && !cancel.is_cancelled() {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..40 {
        if cancel.is_cancelled() {
            return None;
        }
        let middle = 0.5 * (low + high);
        if total(middle) <= budget { low = middle } else { high = middle }
    }
    let mut goals: Vec<u32> = (0..from.len()).map(|pixel| goal(pixel, low)).collect();
    // What is left, by pixels that are nearly at the same place.
    let mut left = budget.saturating_sub(goals.iter().map(|goal| u64::from(*goal)).sum());
    let mut pixel = (hash(seed, u64::MAX) % from.len().max(1) as u64) as usize;
    while left >= u64::from(unit) {
        goals[pixel] = goals[pixel].saturating_add(unit);
        left -= u64::from(unit);
        pixel = (pixel + 1) % from.len();
    }
    Some(goals)
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
                // Those that have enough already leave less for others.
                let wanted = weight / mean_weight * f64::from(mean);
                assert!(f64::from(*goal) < wanted + f64::from(unit) + 16.0, "{goal} for {wanted}");
                assert!(f64::from(*goal) > 0.8 * wanted - f64::from(unit), "{goal} for {wanted}");
            }
        }
    }

    #[test]
    fn a_pixel_has_no_say_in_its_own_weight() {
        // Pixel 17 is in the middle, pixel 0 too far away to know it.
        let mut deviations: Vec<f64> = (0..35).map(|i| f64::from(1 + i % 4)).collect();
        let relative = |deviations: &[f64], pixel: usize| {
            let weights = weights(deviations, [7, 5], &Cancel::new()).unwrap();
            let mean = weights.iter().sum::<f64>() / 35.0;
            // But for what all get.
            (weights[pixel] / mean - SHARE_OF_ALL) / (weights[0] / mean - SHARE_OF_ALL)
        };
        let before = [17, 18].map(|pixel| relative(&deviations, pixel));
        deviations[17] = 1e3;
        let after = [17, 18].map(|pixel| relative(&deviations, pixel));
        assert!((before[0] / after[0] - 1.0).abs() < 1e-9, "{before:?}, {after:?}");
        assert!(after[1] > 10.0 * before[1], "{before:?}, {after:?}");
    }

    #[test]
    fn alike_where_nothing_is_known() {
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
