//! A model whose transmitted light is tinted.

use std::sync::Arc;

use super::Bsdf;
use super::lobes::{Lobes, TransportMode};
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A transmitting model with a factor on what it transmits.
#[derive(Clone, Debug, PartialEq)]
pub struct TintedTransmission<C: Spectrum = Rgb> {
    base: Arc<Bsdf<C>>,
    tint: C,
}

impl<C: Spectrum> TintedTransmission<C> {
    /// The model `base` with the factor `tint` in [0, 1] on what passes the surface.
    pub fn new(base: Bsdf<C>, tint: C) -> Self {
        Self { base: Arc::new(base), tint }
    }

    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { base: Arc::new(self.base.turned(turn)), tint: self.tint }
    }

    /// f of the base, tinted if the directions are on two sides.
    #[inline]
    fn on_its_side(&self, wo: Vec3, wi: Vec3, f: C) -> C {
        if wo.z * wi.z < 0.0 { f * self.tint } else { f }
    }

    fn tinted(&self, sample: BsdfSample<C>) -> BsdfSample<C> {
        if Lobes::TRANSMISSION.contains(sample.lobe) {
            BsdfSample { weight: sample.weight * self.tint, ..sample }
        } else {
            sample
        }
    }
}

impl TintedTransmission {
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> TintedTransmission<C> {
        let tint = C::from_reflectance(self.tint, wavelengths);
        TintedTransmission { base: Arc::new(self.base.in_spectrum::<C>(wavelengths)), tint }
    }
}

impl<C: Spectrum> Model<C> for TintedTransmission<C> {
    fn lobes(&self) -> Lobes {
        self.base.lobes()
    }

    fn albedo(&self) -> C {
        self.base.albedo()
    }

    fn disperses(&self) -> bool {
        self.base.disperses()
    }

    fn is_anisotropic(&self) -> bool {
        self.base.is_anisotropic()
    }

    fn narrowest(&self) -> f32 {
        self.base.narrowest()
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.on_its_side(wo, wi, self.base.f(wo, wi, mode))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.base.pdf(wo, wi)
    }

    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        let (f, pdf) = self.base.f_pdf(wo, wi, mode);
        (self.on_its_side(wo, wi, f), pdf)
    }

    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        self.base.sample(wo, u, mode).map(|sample| self.tinted(sample))
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        self.base.specular_lobes(wo, mode).map(|lobe| lobe.map(|lobe| self.tinted(lobe)))
    }
}
