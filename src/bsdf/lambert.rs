//! Ideal diffuse reflection.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{diffuse_pdf, same_side, sample_diffuse};
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Lambert's law: f = albedo / pi, the same in every direction. Conserves energy for albedos up to 1.
///
/// Source: Lambert 1760, *Photometria*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert<C: Spectrum = Rgb> {
    albedo: C,
}

impl Lambert {
    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Lambert<C> {
        Lambert { albedo: C::from_reflectance(self.albedo, wavelengths) }
    }
}

impl<C: Spectrum> Lambert<C> {
    /// A diffuse surface. `albedo`: share of the incoming power that is reflected, in [0, 1] per channel.
    pub fn new(albedo: C) -> Self {
        Self { albedo }
    }
}

impl<C: Spectrum> Model<C> for Lambert<C> {
    #[inline]
    fn lobes(&self) -> Lobes {
        Lobes::DIFFUSE_REFLECTION
    }

    #[inline]
    fn albedo(&self) -> C {
        self.albedo
    }

    #[inline]
    fn f(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> C {
        if same_side(wo, wi) { self.albedo * FRAC_1_PI } else { C::ZERO }
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        diffuse_pdf(wo, wi)
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(sample_diffuse(wo, u, |_| self.albedo))
    }

    #[inline]
    fn constant_f(&self) -> Option<C> {
        Some(self.albedo * FRAC_1_PI)
    }

    #[inline]
    fn mean_f(&self, _: Vec3) -> Option<C> {
        Some(self.albedo * FRAC_1_PI)
    }
}
