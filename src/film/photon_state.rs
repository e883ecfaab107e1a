//! Photon statistics of a pixel that persist between passes.

use super::tile_bytes::{AsBytes, Bytes, put_all};
use crate::spectrum::Rgb;

/// A gathering radius that shrinks as photons are found, and the statistics for that.
///
/// Source: Hachisuka and Jensen 2009, "Stochastic Progressive Photon Mapping", Eq. 7 to 10, once for each pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShrinkingRadius {
    /// The current radius; 0 before its first use.
    radius: f32,
    /// Accumulated photons that are retained.
    retained: f32,
    /// Photons found in the current pass, and the number of estimates that found them.
    found: f32,
    estimates: f32,
    pass: u32,
}

impl ShrinkingRadius {
    /// The radius for a pass; `first` gives the initial radius. `alpha`: the fraction of new photons that is retained.
    #[inline]
    pub fn begin(&mut self, pass: u32, alpha: f32, first: impl FnOnce() -> f32) -> f32 {
        if self.radius == 0.0 {
            self.radius = first();
            self.pass = pass;
        } else if pass != self.pass {
            let found = self.found / self.estimates.max(1.0);
            if found > 0.0 {
                let retained = self.retained + alpha * found;
                self.radius *= (retained / (self.retained + found)).sqrt();
                self.retained = retained;
            }
            (self.found, self.estimates, self.pass) = (0.0, 0.0, pass);
        }
        self.radius
    }

    /// Adds the number of photons that one estimate found.
    #[inline]
    pub fn add_estimate(&mut self, count: u32) {
        self.found += count as f32;
        self.estimates += 1.0;
    }
}

impl AsBytes for ShrinkingRadius {
    fn put(&self, out: &mut Vec<u8>) {
        let numbers = [self.radius, self.retained, self.found, self.estimates];
        numbers.iter().for_each(|number| out.extend(number.to_le_bytes()));
        out.extend(self.pass.to_le_bytes());
    }

    fn get(bytes: &mut Bytes<'_>) -> Option<Self> {
        let numbers @ [radius, retained, found, estimates] = std::array::from_fn(|_| bytes.f32());
        let is_possible = numbers.iter().all(|number| number.is_finite() && *number >= 0.0);
        let pass = bytes.u32();
        is_possible.then_some(Self { radius, retained, found, estimates, pass })
    }
}

/// State of a pixel that persists between passes of photon mapping.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelPhotonState {
    /// Radius for the caustic map.
    pub caustic: ShrinkingRadius,
    /// Radius for the map of indirect light.
    pub indirect: ShrinkingRadius,
    /// Sums of estimated biases over passes with even and odd indices, which give two independent estimates.
    bias: [[f64; 3]; 2],
    samples: [u32; 2],
}

impl PixelPhotonState {
    /// Adds the estimated bias of a sample.
    #[inline]
    pub fn add_bias(&mut self, pass: u32, bias: Rgb) {
        if !bias.is_finite() {
            return;
        }
        let half = (pass & 1) as usize;
        for (sum, value) in self.bias[half].iter_mut().zip(bias.to_array()) {
            *sum += f64::from(value);
        }
        self.samples[half] += 1;
    }

    /// The two independent estimates of the bias of the pixel's mean; `None` until both exist.
    pub fn biases(&self) -> Option<[[f64; 3]; 2]> {
        let [even, odd] = self.samples.map(f64::from);
        let [a, b] = self.bias;
        (even > 0.0 && odd > 0.0).then(|| [a.map(|sum| sum / even), b.map(|sum| sum / odd)])
    }

    /// The estimated bias of the pixel's mean over all passes.
    pub fn bias(&self) -> Option<[f64; 3]> {
        let count = f64::from(self.samples[0]) + f64::from(self.samples[1]);
        let [a, b] = self.bias;
        (count > 0.0).then(|| std::array::from_fn(|channel| (a[channel] + b[channel]) / count))
    }
}

impl AsBytes for PixelPhotonState {
    fn put(&self, out: &mut Vec<u8>) {
        self.caustic.put(out);
        self.indirect.put(out);
        put_all(self.bias.as_flattened(), out);
        self.samples.iter().for_each(|count| out.extend(count.to_le_bytes()));
    }

    fn get(bytes: &mut Bytes<'_>) -> Option<Self> {
        let (caustic, indirect) = (AsBytes::get(bytes)?, AsBytes::get(bytes)?);
        let bias = [bytes.three(), bytes.three()];
        let samples = [bytes.u32(), bytes.u32()];
        bias.as_flattened().iter().all(|sum| sum.is_finite()).then_some(Self { caustic, indirect, bias, samples })
    }
}
