//! Smooth metal.

use std::sync::Arc;

use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::metal_facet::MetalFacet;
use super::metal_spectrum::{MetalCurves, MetalInSpectrum};
use super::model::{BsdfSample, Model, SpecularLobes};
use super::thin_film::FilmedMetal;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A smooth metal: a mirror whose reflectance depends on the angle by Fresnel's equations. It reflects on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Conductor<C: Spectrum = Rgb> {
    facet: MetalFacet,
    mean: Rgb,
    by_wavelength: MetalInSpectrum<C>,
    wavelengths: C::Wavelengths,
}

impl Conductor {
    /// A metal that reflects by this law.
    pub fn new(facet: MetalFacet) -> Self {
        let by_wavelength = MetalInSpectrum::default();
        Self { mean: facet.mean_reflectance(), facet, by_wavelength, wavelengths: () }
    }

    /// The same metal in three channels, and this one by the wavelength.
    pub(super) fn measured(self, metal: MetalCurves) -> Self {
        Self { by_wavelength: MetalInSpectrum::Curves(metal), ..self }
    }

    /// A metal with a thin film.
    pub(super) fn filmed(metal: Arc<FilmedMetal>) -> Self {
        Self::new(MetalFacet::Filmed(metal))
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Conductor<C> {
        let by_wavelength = self.by_wavelength.in_spectrum(wavelengths);
        Conductor { facet: self.facet.clone(), mean: self.mean, by_wavelength, wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> Conductor<C> {
    fn reflection(&self, wo: Vec3) -> BsdfSample<C> {
        let weight = match self.by_wavelength.at() {
            Some(metal) => metal.reflectance(wo.z.abs()),
            None => self.facet.reflectance_in(wo.z.abs(), &self.wavelengths),
        };
        BsdfSample { wi: reflect(wo), weight, pdf: 0.0, lobe: Lobes::SPECULAR_REFLECTION, eta: 1.0 }
    }
}

impl<C: Spectrum> Model<C> for Conductor<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR_REFLECTION
    }

    fn albedo(&self) -> C {
        match self.by_wavelength.at() {
            Some(metal) => metal.mean,
            None => C::from_reflectance(self.mean, &self.wavelengths),
        }
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, _: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(self.reflection(wo))
    }

    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        [Some(self.reflection(wo)), None, None]
    }
}
