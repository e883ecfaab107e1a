//! Smooth metal.

use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::metal_facet::MetalFacet;
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::desc::ThinFilmDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A smooth metal: a mirror whose reflectance depends on the angle by Fresnel's equations. It reflects on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Conductor<C: Spectrum = Rgb> {
    facet: MetalFacet,
    mean: Rgb,
    wavelengths: C::Wavelengths,
}

impl Conductor {
    /// A metal that reflects by this law.
    pub fn new(facet: MetalFacet) -> Self {
        Self { mean: facet.mean_reflectance(), facet, wavelengths: () }
    }

    /// As [`super::Bsdf::with_film`].
    pub(super) fn with_film(self, film: ThinFilmDesc) -> Self {
        Self::new(self.facet.with_film(film))
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Conductor<C> {
        Conductor { facet: self.facet.clone(), mean: self.mean, wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> Conductor<C> {
    fn reflection(&self, wo: Vec3) -> BsdfSample<C> {
        let weight = self.facet.reflectance_in(wo.z.abs(), &self.wavelengths);
        BsdfSample { wi: reflect(wo), weight, pdf: 0.0, lobe: Lobes::SPECULAR_REFLECTION, eta: 1.0 }
    }
}

impl<C: Spectrum> Model<C> for Conductor<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR_REFLECTION
    }

    fn albedo(&self) -> C {
        C::from_reflectance(self.mean, &self.wavelengths)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, _: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(self.reflection(wo))
    }

    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        [Some(self.reflection(wo)), None, None]
    }
}
