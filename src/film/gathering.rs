//! What a pixel remembers of photons between passes.

use crate::spectrum::Rgb;

/// A radius that shrinks as photons are met, and what was met.
///
/// Source: Hachisuka and Jensen 2009, "Stochastic Progressive Photon Mapping", Eq. 7 to 10, once for each pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShrinkingRadius {
    /// As it is; 0 before it was first asked for.
    radius: f32,
    /// Photons that count as kept.
    kept: f32,
    /// Photons met in the pass under way, and estimates in which.
    met: f32,
    estimates: f32,
    pass: u32,
}

impl ShrinkingRadius {
    /// The radius for a pass; `first` says what it begins with. `alpha`: the share of new photons that is kept.
    #[inline]
    pub fn begin(&mut self, pass: u32, alpha: f32, first: impl FnOnce() -> f32) -> f32 {
        if self.radius == 0.0 {
            self.radius = first();
            self.pass = pass;
        } else if pass != self.pass {
            let met = self.met / self.estimates.max(1.0);
            if met > 0.0 {
                let kept = self.kept + alpha * met;
                self.radius *= (kept / (self.kept + met)).sqrt();
                self.kept = kept;
            }
            (self.met, self.estimates, self.pass) = (0.0, 0.0, pass);
        }
        self.radius
    }

    /// Notes the photons of one estimate.
    #[inline]
    pub fn note(&mut self, count: u32) {
        self.met += count as f32;
        self.estimates += 1.0;
    }
}

/// What a pixel remembers between passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gathering {
    /// Of the caustic map.
    pub caustic: ShrinkingRadius,
    /// Of the map of indirect light.
    pub indirect: ShrinkingRadius,
    /// Sums of estimated biases, of passes with even and odd numbers: two estimates that are independent.
    bias: [[f64; 3]; 2],
    samples: [u32; 2],
}

impl Gathering {
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

    /// The two independent estimates of the bias of the pixel's mean; `None` before both are there.
    pub fn biases(&self) -> Option<[[f64; 3]; 2]> {
        let [even, odd] = self.samples.map(f64::from);
        let [a, b] = self.bias;
        (even > 0.0 && odd > 0.0).then(|| [a.map(|sum| sum / even), b.map(|sum| sum / odd)])
    }

    /// The estimated bias of the pixel's mean, of all passes together.
    pub fn bias(&self) -> Option<[f64; 3]> {
        let count = f64::from(self.samples[0]) + f64::from(self.samples[1]);
        let [a, b] = self.bias;
        (count > 0.0).then(|| std::array::from_fn(|channel| (a[channel] + b[channel]) / count))
    }
}
