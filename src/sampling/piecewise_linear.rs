//! A density on the unit interval that is piecewise linear.

/// A density on [0, 1] that changes linearly between values at evenly spaced places.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseLinear {
    values: Box<[f64]>,
    /// The integral up to each place, in units of a piece.
    sums: Box<[f64]>,
}

impl PiecewiseLinear {
    /// The density that is in proportion to these values. `None` for less than two of them, for one below 0 or not finite, and where
    /// their sum is 0.
    pub fn new(values: &[f64]) -> Option<Self> {
        let is_density = values.len() > 1 && values.iter().all(|value| *value >= 0.0 && value.is_finite());
        // Values of any size have a sum that is finite.
        let largest = values.iter().copied().fold(0.0, f64::max);
        if !is_density || largest <= 0.0 {
            return None;
        }
        let values: Box<[f64]> = values.iter().map(|value| value / largest).collect();
        let mut sum = 0.0;
        let pieces = values.windows(2).map(|pair| {
            sum += 0.5 * (pair[0] + pair[1]);
            sum
        });
        let sums = std::iter::once(0.0).chain(pieces).collect();
        Some(Self { values, sums })
    }

    /// The place up to which the density has the integral `u` in [0, 1): the inverse of its distribution function.
    ///
    /// Source: Pharr, Jakob and Humphreys 2023, Sec. 2.4.1, for one piece.
    pub fn sample(&self, u: f32) -> f32 {
        let pieces = self.values.len() - 1;
        let reached = f64::from(u) * self.sums[pieces];
        // The last piece that begins at or before it and is not empty.
        let piece = self.sums.partition_point(|sum| *sum <= reached).clamp(1, pieces) - 1;
        let (a, b) = (self.values[piece], self.values[piece + 1]);
        let share = ((reached - self.sums[piece]) / (self.sums[piece + 1] - self.sums[piece])).clamp(0.0, 1.0);
        let root = (a * a * (1.0 - share) + b * b * share).sqrt();
        let within = if a + root > 0.0 { share * (a + b) / (a + root) } else { 0.0 };
        (((piece as f64) + within.clamp(0.0, 1.0)) / pieces as f64) as f32
    }

    /// The density at a place in [0, 1].
    pub fn pdf(&self, x: f32) -> f64 {
        let pieces = self.values.len() - 1;
        let along = f64::from(x).clamp(0.0, 1.0) * pieces as f64;
        let piece = (along as usize).min(pieces - 1);
        let share = along - piece as f64;
        let value = self.values[piece] * (1.0 - share) + self.values[piece + 1] * share;
        value * pieces as f64 / self.sums[pieces]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_the_integral_that_they_are_asked_for() {
        for values in [&[1.0, 1.0][..], &[0.0, 1.0, 1.0, 1.0, 0.0], &[3.0, 0.0, 0.0, 0.0, 1e-3, 5.0], &[0.0, 1e300]] {
            let density = PiecewiseLinear::new(values).unwrap();
            let mut integral = 0.0;
            let mut next = 0;
            let cells = 1_000_000;
            for i in 0..cells {
                integral += density.pdf((i as f32 + 0.5) / cells as f32) / f64::from(cells);
                let x = (i as f32 + 1.0) / cells as f32;
                // Places of a few integrals, as the sum reaches them.
                while next < 8 && integral >= f64::from(next) / 8.0 + 1e-4 {
                    let u = (f64::from(next) / 8.0 + 1e-4) as f32;
                    let found = density.sample(u);
                    // Where the density is 0, a place is anywhere in the gap.
                    let gap = (found - x).abs() < 1e-4 || density.pdf(found.midpoint(x)) < 1e-2;
                    assert!(gap, "{values:?}: {found}, not {x} for {u}");
                    next += 1;
                }
            }
            assert_eq!(next, 8);
            assert!((integral - 1.0).abs() < 1e-4, "{integral}");
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        for values in [&[][..], &[1.0], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN, 1.0], &[1.0, f64::INFINITY]] {
            assert_eq!(PiecewiseLinear::new(values), None, "{values:?}");
        }
    }
}
