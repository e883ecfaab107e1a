//! Perfect mirror.

use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A perfect mirror with the same reflectance at every angle, on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror<C: Spectrum = Rgb> {
    reflectance: C,
}

impl Mirror {
    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Mirror<C> {
        Mirror { reflectance: C::from_reflectance(self.reflectance, wavelengths) }
    }
}

impl<C: Spectrum> Mirror<C> {
    /// A mirror. `reflectance`: in [0, 1] per channel.
    pub fn new(reflectance: C) -> Self {
        Self { reflectance }
    }

    /// The one direction it reflects into.
    #[inline]
    fn reflection(&self, wo: Vec3) -> BsdfSample<C> {
        BsdfSample { wi: reflect(wo), weight: self.reflectance, pdf: 0.0, lobe: Lobes::SPECULAR_REFLECTION, eta: 1.0 }
    }
}

impl<C: Spectrum> Model<C> for Mirror<C> {
    #[inline]
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR_REFLECTION
    }

    #[inline]
    fn albedo(&self) -> C {
        self.reflectance
    }

    #[inline]
    fn sample(&self, wo: Vec3, _: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(self.reflection(wo))
    }

    #[inline]
    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        [Some(self.reflection(wo)), None, None]
    }
}
