//! The energy-preserving Oren-Nayar model.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{diffuse_pdf, same_side, sample_diffuse};
use super::model::{BsdfSample, Model};
use super::oren_nayar::OrenNayar;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Fujii's model ([`OrenNayar`]) and the light that its facets reflect more than once:
/// f = f_Fujii + rho_ms (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_mean)), where E is the albedo of Fujii's model with white facets.
/// Reciprocal; white facets reflect everything.
///
/// Source: Portsmouth, Kutz, Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eon<C: Spectrum = Rgb> {
    once: OrenNayar<C>,
    /// The same with white facets.
    white: OrenNayar,
    /// rho_ms / (1 - E_mean).
    multiple: C,
    albedo: C,
}

impl Eon {
    /// A rough diffuse surface. `albedo` in [0, 1] per channel, `roughness` in (0, 1].
    pub fn new(albedo: Rgb, roughness: f32) -> Self {
        let white = OrenNayar::new(Rgb::ONE, roughness);
        Self { once: white, white, multiple: Rgb::ZERO, albedo: Rgb::ZERO }.with_albedo(albedo)
    }

    /// What does not depend on the colour.
    pub(super) fn shape(&self) -> [f32; 2] {
        self.white.shape()
    }

    /// White facets, and what they scatter once.
    pub(super) fn once_white(&self) -> OrenNayar {
        self.white
    }

    /// The same with white facets.
    pub(super) fn white(&self) -> Self {
        let mean = self.white.mean_albedo().r();
        let missing = 1.0 - mean;
        // As in `new`, with an albedo of 1: mean / (1 - missing) is 1.
        let multiple = if missing > 1e-6 { Rgb::splat(1.0 / missing) } else { Rgb::ZERO };
        Self { once: self.white, white: self.white, multiple, albedo: Rgb::ONE }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Eon<C> {
        // The factor of multiple scattering may exceed 1: as a reflectance it is the colour without the mean.
        let missing = 1.0 - self.white.mean_albedo().r();
        Eon {
            once: self.once.in_spectrum::<C>(wavelengths),
            white: self.white,
            multiple: if missing > 1e-6 {
                C::from_reflectance(self.multiple * missing, wavelengths) / missing
            } else {
                C::ZERO
            },
            albedo: C::from_reflectance(self.albedo, wavelengths),
        }
    }
}

impl<C: Spectrum> Eon<C> {
    /// The same with facets of this albedo.
    pub(super) fn with_albedo(self, albedo: C) -> Self {
        let mean = self.white.mean_albedo().r();
        let missing = 1.0 - mean;
        let several = albedo.map(|rho| rho * rho * mean / (1.0 - rho * missing));
        Self {
            once: self.once.with_albedo(albedo),
            // A roughness too small for single precision loses nothing.
            multiple: if missing > 1e-6 { several / missing } else { C::ZERO },
            albedo: albedo * mean + several * missing,
            ..self
        }
    }

    /// 1 - E of a direction.
    fn missing(&self, w: Vec3) -> f32 {
        (1.0 - self.white.directional_albedo(w).r()).max(0.0)
    }

    /// pi f.
    fn weight(&self, wo: Vec3, wi: Vec3) -> C {
        self.once.weight(wo, wi) + self.multiple * (self.missing(wo) * self.missing(wi))
    }
}

impl<C: Spectrum> Model<C> for Eon<C> {
    fn lobes(&self) -> Lobes {
        Lobes::DIFFUSE_REFLECTION
    }

    fn albedo(&self) -> C {
        self.albedo
    }

    #[inline(never)]
    fn f(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> C {
        if same_side(wo, wi) { self.weight(wo, wi) * FRAC_1_PI } else { C::ZERO }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        diffuse_pdf(wo, wi)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(sample_diffuse(wo, u, |wi| self.weight(wo, wi)))
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        let missing = 1.0 - self.white.mean_albedo().r();
        let several = self.multiple * (self.missing(wo) * missing);
        Some((self.once.directional_albedo(wo) + several) * FRAC_1_PI)
    }

    fn is_even(&self) -> bool {
        false
    }
}
