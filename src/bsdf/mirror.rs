//! Perfect mirror.

use super::{BsdfSample, reflect};
use crate::math::Vec3;
use crate::spectrum::Rgb;

/// A perfect mirror with the same reflectance at every angle, on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    reflectance: Rgb,
}

impl Mirror {
    /// A mirror. `reflectance`: in [0, 1] per channel.
    pub fn new(reflectance: Rgb) -> Self {
        Self { reflectance }
    }

    /// Share of the incoming power that is reflected.
    #[inline]
    pub fn reflectance(&self) -> Rgb {
        self.reflectance
    }

    /// The one direction it reflects into.
    #[inline]
    pub fn sample(&self, wo: Vec3) -> BsdfSample {
        BsdfSample { wi: reflect(wo), weight: self.reflectance, pdf: 0.0, is_delta: true, eta: 1.0 }
    }
}
