//! Fujii's variant of the Oren-Nayar model.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::{FRAC_PI_2, PI};

use super::lobes::{Lobes, TransportMode};
use super::local::{bright_side, diffuse_pdf, same_side, sample_diffuse, sine, tangential_dot};
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// Fujii's improved Oren-Nayar model: f = albedo (A + B s / t) with A = 1 / (pi + (pi/2 - 2/3) sigma'), B = sigma' A,
/// s = wi.wo - (n.wi)(n.wo), and t = max(n.wi, n.wo) where s > 0, else 1.
///
/// Reciprocal and smooth where the qualitative form has a crease. It conserves energy for albedos up to 1, but loses some:
/// the directional albedo for facets of albedo 1 lies between 0.777 (sigma' = 1, normal incidence) and 1, and averages
/// (1 + (2/3 - 28/(15 pi)) sigma') / (1 + (1/2 - 2/(3 pi)) sigma').
///
/// Source: Fujii, "A tiny improvement of Oren-Nayar reflectance model"; albedo: Portsmouth et al. 2024.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar<C: Spectrum = Rgb> {
    albedo: C,
    /// pi A and pi B, so that both are near 1.
    a: f32,
    b: f32,
}

impl OrenNayar {
    /// What does not depend on the colour.
    pub(super) fn shape(&self) -> [f32; 2] {
        [self.a, self.b]
    }

    /// The same with white facets.
    pub(super) fn white(&self) -> Self {
        Self { albedo: Rgb::ONE, ..*self }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> OrenNayar<C> {
        OrenNayar { albedo: C::from_reflectance(self.albedo, wavelengths), a: self.a, b: self.b }
    }
}

impl<C: Spectrum> OrenNayar<C> {
    /// The same with facets of this albedo.
    pub(super) fn with_albedo(self, albedo: C) -> Self {
        Self { albedo, ..self }
    }

    /// A rough diffuse surface. `albedo`: of the facets, in [0, 1] per channel. `roughness`: sigma' in [0, 1].
    pub fn new(albedo: C, roughness: f32) -> Self {
        let sigma = f64::from(roughness);
        let a = PI / (PI + (FRAC_PI_2 - 2.0 / 3.0) * sigma);
        Self { albedo, a: a as f32, b: (sigma * a) as f32 }
    }

    /// Share of the power that comes from all directions alike, or of a beam along `w`, that is scattered: the directional
    /// albedo. By the integral of f cos over the hemisphere.
    pub fn directional_albedo(&self, w: Vec3) -> C {
        self.albedo * (self.a + self.b * FRAC_1_PI * (bright_side(w) - 2.0 / 3.0 * sine(w)))
    }

    /// Mean of [`Self::directional_albedo`] over the hemisphere, weighed by the cosine.
    pub fn mean_albedo(&self) -> C {
        const MEAN: f32 = 2.0 / 3.0 - 28.0 / 15.0 * FRAC_1_PI;
        self.albedo * (self.a + self.b * MEAN)
    }

    /// pi f: the weight of a cosine-distributed sample.
    #[inline]
    pub(super) fn weight(&self, wo: Vec3, wi: Vec3) -> C {
        let s = tangential_dot(wo, wi);
        // t is at most 1: a positive s grows when divided by it, a negative one would fall. The larger of both is s / t by
        // the model's rule, without a branch on a sign that is as good as random.
        let s_over_t = (s / wo.z.abs().max(wi.z.abs())).max(s);
        // At sigma' = 1 and both directions opposite at grazing, a + b s is 0 up to rounding.
        self.albedo * (self.a + self.b * s_over_t).max(0.0)
    }
}

impl<C: Spectrum> Model<C> for OrenNayar<C> {
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
        if same_side(wo, wi) { self.weight(wo, wi) * FRAC_1_PI } else { C::ZERO }
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        diffuse_pdf(wo, wi)
    }

    #[inline]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        Some(sample_diffuse(wo, u, |wi| self.weight(wo, wi)))
    }

    #[inline]
    fn mean_f(&self, wo: Vec3) -> Option<C> {
        Some(self.directional_albedo(wo) * FRAC_1_PI)
    }

    fn is_even(&self) -> bool {
        false
    }
}
