//! One pixel: sums, and replicate means for its error.

use crate::math::Vec3;
use crate::spectrum::Rgb;

/// Sums of a pixel. Samples come in order of their index, so the sums do not depend on how they are divided into passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    sum: [f64; 3],
    weight: f64,
    /// Where `sum` stood when the current replicate began.
    replicate_start: [f64; 3],
    /// Sum of the squares of the replicates' sums.
    squares: [f64; 3],
    count: u32,
    in_replicate: u32,
    replicates: u32,
    non_finite: u32,
}

impl Pixel {
    /// Adds a sample with its filter weight. `replicate_size`: how many samples make a replicate.
    ///
    /// A sample that is not finite counts as black, is counted apart, and leaves no other trace.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, weight: f32, replicate_size: u32) {
        if radiance.is_finite() {
            for (sum, value) in self.sum.iter_mut().zip(radiance.to_array()) {
                *sum += f64::from(weight) * f64::from(value);
            }
        } else {
            self.non_finite += 1;
        }
        self.weight += f64::from(weight);
        self.count += 1;
        self.in_replicate += 1;
        if self.in_replicate == replicate_size {
            for channel in 0..3 {
                let replicate = self.sum[channel] - self.replicate_start[channel];
                self.squares[channel] += replicate * replicate;
            }
            self.replicate_start = self.sum;
            self.replicates += 1;
            self.in_replicate = 0;
        }
    }

    /// Samples so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Samples that were not finite.
    pub fn non_finite(&self) -> u32 {
        self.non_finite
    }

    /// The pixel's value. `weighted`: divide by the sum of weights instead of the number of samples.
    pub fn mean(&self, weighted: bool) -> [f32; 3] {
        let total = if weighted && self.weight != 0.0 { self.weight } else { f64::from(self.count.max(1)) };
        self.sum.map(|sum| (sum / total) as f32)
    }

    /// Variance of the mean per channel, from the spread of complete replicates; NaN while there are fewer than two.
    ///
    /// Samples of one replicate depend on each other (they are stratified), so their own spread says nothing about the
    /// error of their mean; replicates are scrambled independently. With weights of both signs it is that of the sum
    /// before it is divided by the weights, which is more than the error of the quotient.
    pub fn variance(&self) -> [f64; 3] {
        if self.replicates < 2 {
            return [f64::NAN; 3];
        }
        let n = f64::from(self.replicates);
        let complete = f64::from(self.count - self.in_replicate);
        std::array::from_fn(|channel| {
            let sum = self.replicate_start[channel];
            // Of the sum of all samples: n times the variance of one replicate's sum. Rounding may leave -0 or a hair less.
            let of_sum = (n / (n - 1.0) * (self.squares[channel] - sum * sum / n)).max(0.0);
            // What an incomplete replicate adds to the mean is counted at the complete ones' rate.
            of_sum / (complete * complete) * (complete / f64::from(self.count))
        })
    }
}

/// Sums of what the first hit was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Auxiliary {
    /// Sum of albedos.
    pub albedo: [f64; 3],
    /// Sum of shading normals, facing the camera, scene frame.
    pub normal: [f64; 3],
    depth: f64,
    hits: u32,
}

impl Auxiliary {
    /// Adds the first hit of a sample. `depth` along the view direction, scene units.
    #[inline]
    pub fn add(&mut self, albedo: Rgb, normal: Vec3, depth: f32) {
        for (sum, value) in self.albedo.iter_mut().zip(albedo.to_array()) {
            *sum += f64::from(value);
        }
        for (sum, value) in self.normal.iter_mut().zip(normal.to_array()) {
            *sum += f64::from(value);
        }
        self.depth += f64::from(depth);
        self.hits += 1;
    }

    /// Share of `samples` that hit anything; 1 before the first.
    pub fn coverage(&self, samples: u32) -> f32 {
        if samples == 0 { 1.0 } else { (f64::from(self.hits) / f64::from(samples)) as f32 }
    }

    /// Mean depth of the samples that hit anything; infinite where none did.
    pub fn mean_depth(&self) -> f32 {
        if self.hits == 0 { f32::INFINITY } else { (self.depth / f64::from(self.hits)) as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_of_the_mean_is_that_of_replicates() {
        // Replicate means 1, 2, 3, 6: their variance is 14/3, that of their mean 14/12.
        let mut pixel = Pixel::default();
        for mean in [1.0, 2.0, 3.0, 6.0] {
            pixel.add(Rgb::splat(mean - 0.5), 1.0, 2);
            assert!(pixel.variance()[0].is_nan() || mean > 2.0);
            pixel.add(Rgb::splat(mean + 0.5), 1.0, 2);
        }
        assert!((pixel.variance()[0] - 14.0 / 12.0).abs() < 1e-12, "{:?}", pixel.variance());
    }

    #[test]
    fn bad_samples_are_counted_and_leave_no_trace() {
        let mut pixel = Pixel::default();
        pixel.add(Rgb::ONE, 1.0, 4);
        pixel.add(Rgb::new(f32::NAN, 0.0, 0.0), 1.0, 4);
        pixel.add(Rgb::new(0.0, f32::INFINITY, 0.0), 1.0, 4);
        assert_eq!((pixel.count(), pixel.non_finite(), pixel.mean(false)), (3, 2, [1.0 / 3.0; 3]));
    }
}
