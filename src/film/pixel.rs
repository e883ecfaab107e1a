//! A pixel: sums of its replicates, whose scatter gives its standard error.

use super::tile_bytes::{AsBytes, Bytes, put_all};
use crate::math::Vec3;
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};

/// Number of replicates: parts of a pixel's samples that are independent of each other, so that their scatter gives the
/// error of their mean.
///
/// Samples are distributed in turns. Let `share` be the number of consecutive samples with correlated errors (those
/// that read the same photon maps, else 1). The first `share` samples belong to replicate 0, the next to replicate 1,
/// and after the last replicate the first follows again. Replicates therefore grow equally, whatever the number of
/// samples. Their cost is in docs/performance.md.
pub const REPLICATES: usize = 8;

/// Fewer replicates than this give no estimate: with two, one in twenty errors would seem smaller by a factor of 16.
const MIN_REPLICATES: usize = 4;

/// Sums of a pixel, 208 bytes. Samples are added in the order of their index, so that the sums do not depend on the
/// division into passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sums of each replicate and channel.
    sums: [[f64; 3]; REPLICATES],
    weight: f64,
    count: u32,
    non_finite: u32,
}

impl Pixel {
    /// Adds a sample with its filter weight. `share`: number of consecutive samples with correlated errors, which go to
    /// one replicate.
    ///
    /// A sample that is not finite counts as black and is counted separately; it has no other effect.
    #[inline]
    pub fn add(&mut self, radiance: Rgb, weight: f32, share: u32) {
        let replicate = (self.count / share.max(1)) as usize % REPLICATES;
        if radiance.is_finite() {
            add_weighted(&mut self.sums[replicate], radiance, weight);
        } else {
            self.non_finite += 1;
        }
        self.weight += f64::from(weight);
        self.count += 1;
    }

    /// Number of samples so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Number of samples that were not finite.
    pub fn non_finite(&self) -> u32 {
        self.non_finite
    }

    /// Sum of all samples, times their weights.
    #[inline]
    pub(super) fn sum(&self) -> [f64; 3] {
        std::array::from_fn(|channel| self.sums.iter().map(|sum| sum[channel]).sum())
    }

    /// Value of the pixel. `weighted`: divide by the sum of weights instead of the number of samples.
    pub fn mean(&self, weighted: bool) -> [f32; 3] {
        self.mean_of(self.sum(), weighted)
    }

    /// The mean of a sum over the pixel's samples, as [`Pixel::mean`].
    pub(super) fn mean_of(&self, sum: [f64; 3], weighted: bool) -> [f32; 3] {
        let total = if weighted && self.weight != 0.0 { self.weight } else { f64::from(self.count.max(1)) };
        sum.map(|sum| (sum / total) as f32)
    }

    /// Variance of the mean for each channel, from the scatter of the replicates' means; NaN while fewer than four of
    /// them have samples. With eight replicates, the error in units of its estimate follows Student's t with 7 degrees
    /// of freedom, where the error is normally distributed at all. `share`: the same value as in [`Pixel::add`].
    ///
    /// Samples of one replicate are not independent (they are stratified), so their own scatter does not give the error
    /// of their mean; replicates are scrambled independently. With weights of both signs, the result is the variance of
    /// the sum before the division by the weights, which is larger than that of the quotient.
    pub fn variance(&self, share: u32) -> [f64; 3] {
        let Some((counts, used)) = self.used_replicates(share) else { return [f64::NAN; 3] };
        std::array::from_fn(|channel| self.scatter(&counts, used, |sum| sum[channel]))
    }

    /// Mean of the samples' luminance, and the variance of that mean as in [`Pixel::variance`], both in double precision.
    ///
    /// The variance is that of the replicates' luminances. It cannot be had from the variances of the channels, since these
    /// are correlated.
    pub fn luminance(&self, share: u32) -> [f64; 2] {
        let [r, g, b] = LUMINANCE_WEIGHTS.to_array().map(f64::from);
        let of = |sum: &[f64; 3]| r * sum[0] + g * sum[1] + b * sum[2];
        let mean = of(&self.sum()) / f64::from(self.count.max(1));
        match self.used_replicates(share) {
            Some((counts, used)) => [mean, self.scatter(&counts, used, of)],
            None => [mean, f64::NAN],
        }
    }

    /// Numbers of samples of the replicates, and how many replicates have any; `None` where they are too few for an
    /// estimate of the variance.
    fn used_replicates(&self, share: u32) -> Option<([f64; REPLICATES], usize)> {
        if (self.count as usize) < MIN_REPLICATES {
            return None;
        }
        let counts = self.replicate_counts(share);
        let used = counts.iter().filter(|count| **count > 0.0).count();
        (used >= MIN_REPLICATES).then_some((counts, used))
    }

    /// Variance of the mean of what `value` makes of a replicate's sums.
    fn scatter(&self, counts: &[f64; REPLICATES], used: usize, value: impl Fn(&[f64; 3]) -> f64) -> f64 {
        let n = f64::from(self.count);
        // If a replicate of n_r samples has the variance s^2 / n_r, then the sum over replicates of n_r (m_r - m)^2 has the
        // expectation (k - 1) s^2, for any n_r.
        let mean = value(&self.sum()) / n;
        let scatter: f64 = self
            .sums
            .iter()
            .zip(counts)
            .filter(|(_, count)| **count > 0.0)
            .map(|(sum, count)| {
                let off = value(sum) - count * mean;
                off * off / count
            })
            .sum();
        scatter / ((used - 1) as f64 * n)
    }

    /// Number of samples of each replicate.
    #[inline]
    fn replicate_counts(&self, share: u32) -> [f64; REPLICATES] {
        let share = share.max(1);
        let round = share.saturating_mul(REPLICATES as u32);
        let (rounds, rest) = (self.count / round, self.count % round);
        std::array::from_fn(|r| f64::from(rounds * share + rest.saturating_sub(r as u32 * share).min(share)))
    }
}

#[inline(always)]
fn add_weighted(sums: &mut [f64; 3], radiance: Rgb, weight: f32) {
    for (sum, value) in sums.iter_mut().zip(radiance.to_array()) {
        *sum += f64::from(weight) * f64::from(value);
    }
}

/// Sums of parts of a pixel's light, by how often it was scattered on its way. The rest of the light was scattered more often.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightSums {
    /// Light that was not scattered, but came from an emitter to the camera.
    pub emission: [f64; 3],
    /// Light that was scattered exactly once.
    pub direct: [f64; 3],
}

impl LightSums {
    /// Adds both parts of a sample with its filter weight.
    #[inline]
    pub fn add(&mut self, [emission, direct]: [Rgb; 2], weight: f32) {
        add_weighted(&mut self.emission, emission, weight);
        add_weighted(&mut self.direct, direct, weight);
    }
}

/// Sums of the first hits' properties.
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

    /// Fraction of `samples` that hit a surface; 1 before the first sample.
    pub fn coverage(&self, samples: u32) -> f32 {
        if samples == 0 { 1.0 } else { (f64::from(self.hits) / f64::from(samples)) as f32 }
    }

    /// Mean depth of the samples that hit a surface; infinite where none did.
    pub fn mean_depth(&self) -> f32 {
        if self.hits == 0 { f32::INFINITY } else { (self.depth / f64::from(self.hits)) as f32 }
    }
}

impl AsBytes for Pixel {
    fn put(&self, out: &mut Vec<u8>) {
        put_all(self.sums.as_flattened(), out);
        put_all([&self.weight], out);
        out.extend(self.count.to_le_bytes());
        out.extend(self.non_finite.to_le_bytes());
    }

    fn get(bytes: &mut Bytes<'_>) -> Option<Self> {
        let sums = std::array::from_fn(|_| bytes.three());
        let pixel = Self { sums, weight: bytes.f64(), count: bytes.u32(), non_finite: bytes.u32() };
        let is_finite = sums.as_flattened().iter().all(|sum| sum.is_finite()) && pixel.weight.is_finite();
        (is_finite && pixel.non_finite <= pixel.count).then_some(pixel)
    }
}

impl AsBytes for Auxiliary {
    fn put(&self, out: &mut Vec<u8>) {
        put_all(self.albedo.iter().chain(&self.normal).chain([&self.depth]), out);
        out.extend(self.hits.to_le_bytes());
    }

    fn get(bytes: &mut Bytes<'_>) -> Option<Self> {
        Some(Self { albedo: bytes.three(), normal: bytes.three(), depth: bytes.f64(), hits: bytes.u32() })
    }
}

impl AsBytes for LightSums {
    fn put(&self, out: &mut Vec<u8>) {
        put_all(self.emission.iter().chain(&self.direct), out);
    }

    fn get(bytes: &mut Bytes<'_>) -> Option<Self> {
        let [emission, direct] = std::array::from_fn(|_| bytes.three());
        let is_finite = emission.iter().chain(&direct).all(|sum: &f64| sum.is_finite());
        is_finite.then_some(Self { emission, direct })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_of_the_mean_is_that_of_replicates() {
        // Replicate means 1 to 8, two samples each: their variance is 6, that of their mean 6/8.
        for share in [1, 2] {
            let mut pixel = Pixel::default();
            for sample in 0..16 {
                let replicate = sample / share % 8;
                let off = if (sample / share / 8 * share + sample % share) % 2 == 0 { -0.5 } else { 0.5 };
                assert!(pixel.variance(share)[0].is_nan() == (sample <= 3 * share), "{sample} samples, {share} shared");
                pixel.add(Rgb::splat(1.0 + replicate as f32 + off), 1.0, share);
            }
            assert!((pixel.variance(share)[0] - 0.75).abs() < 1e-12, "{:?}", pixel.variance(share));
        }
    }

    #[test]
    fn luminance_has_the_variance_of_its_own_replicates() {
        // Red and green that add up to the same luminance in all replicates, and blue that scatters by itself.
        let [r, g, b] = LUMINANCE_WEIGHTS.to_array();
        let mut pixel = Pixel::default();
        for sample in 0..8 {
            let off = if sample % 2 == 0 { 1.0 } else { -1.0 };
            pixel.add(Rgb::new(2.0 + off / r, 2.0 - off / g, 2.0 + off), 1.0, 1);
        }
        let [mean, variance] = pixel.luminance(1);
        assert!((mean - 2.0).abs() < 1e-6, "{mean}");
        let expected = f64::from(b * b) / 7.0;
        assert!((variance / expected - 1.0).abs() < 1e-4, "{variance}, {expected}");
        assert!(Pixel::default().luminance(1)[1].is_nan());
    }

    /// For any number of samples, the estimate is unbiased for independent samples.
    #[test]
    fn unequal_replicates_are_no_bias() {
        let mut rng = crate::sampling::Rng::new(9, 0);
        for (count, share) in [(4, 1), (6, 1), (11, 1), (29, 1), (30, 4), (45, 4)] {
            const RUNS: u32 = 100_000;
            let mut sum = 0.0;
            for _ in 0..RUNS {
                let mut pixel = Pixel::default();
                (0..count).for_each(|_| pixel.add(Rgb::splat(rng.next_f32()), 1.0, share));
                sum += pixel.variance(share)[0];
            }
            let expected = 1.0 / 12.0 / f64::from(count);
            let ratio = sum / f64::from(RUNS) / expected;
            // Of three degrees of freedom: a standard error of 0.8 / sqrt(RUNS) = 0.0026.
            assert!((ratio - 1.0).abs() < 0.011, "{count} samples, {share} shared: {ratio}");
        }
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
