//! Oren and Nayar's model of rough diffuse surfaces, in its qualitative form.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{bright_side, diffuse_pdf, same_side, sample_diffuse, tangential_dot};
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// The qualitative Oren-Nayar model:
/// f = albedo / pi (A + B max(0, cos(phi_i - phi_o)) sin(alpha) tan(beta)), alpha the larger and beta the smaller of the two
/// polar angles, A = 1 - sigma^2 / (2 (sigma^2 + 0.33)), B = 0.45 sigma^2 / (sigma^2 + 0.09).
///
/// sin(alpha) sin(beta) is the product of both sines whichever is larger, so the second term is the tangential product of
/// the two directions over the larger cosine and needs no trigonometric function.
///
/// It is reciprocal, but not strictly energy conserving: for sigma near 0.3 and albedo 1 the directional albedo passes 1
/// within a degree or two of grazing (1.004 at 89 degrees), while rougher surfaces lose light (0.62 at normal incidence for
/// sigma = 1), because the qualitative form leaves out interreflection between facets.
///
/// Source: Oren and Nayar 1994, "Generalization of Lambert's Reflectance Model", the qualitative model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayarQualitative<C: Spectrum = Rgb> {
    albedo: C,
    a: f32,
    b: f32,
}

impl OrenNayarQualitative {
    /// What does not depend on the colour.
    pub(super) fn shape(&self) -> [f32; 2] {
        [self.a, self.b]
    }

    /// The same with white facets.
    pub(super) fn white(&self) -> Self {
        Self { albedo: Rgb::ONE, ..*self }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> OrenNayarQualitative<C> {
        OrenNayarQualitative { albedo: C::from_reflectance(self.albedo, wavelengths), a: self.a, b: self.b }
    }
}

impl<C: Spectrum> OrenNayarQualitative<C> {
    /// The same with facets of this albedo.
    pub(super) fn with_albedo(self, albedo: C) -> Self {
        Self { albedo, ..self }
    }

    /// A rough diffuse surface. `albedo`: of the facets, in [0, 1] per channel. `sigma`: standard deviation of the facets'
    /// slope angle, radians, >= 0.
    pub fn new(albedo: C, sigma: f32) -> Self {
        let s2 = f64::from(sigma) * f64::from(sigma);
        // An infinite sigma has a limit; the quotient in this form reaches it.
        let (a, b) = if s2 > 0.0 { (1.0 - 0.5 / (1.0 + 0.33 / s2), 0.45 / (1.0 + 0.09 / s2)) } else { (1.0, 0.0) };
        Self { albedo, a: a as f32, b: b as f32 }
    }

    /// Share of the power that comes from all directions alike, or of a beam along `w`, that is scattered: the directional
    /// albedo. By the integral of f cos over the hemisphere.
    pub fn directional_albedo(&self, w: Vec3) -> C {
        self.albedo * (self.a + self.b * FRAC_1_PI * bright_side(w))
    }

    /// pi f: the weight of a cosine-distributed sample.
    #[inline]
    fn weight(&self, wo: Vec3, wi: Vec3) -> C {
        let larger_cosine = wo.z.abs().max(wi.z.abs());
        self.albedo * (self.a + self.b * (tangential_dot(wo, wi).max(0.0) / larger_cosine))
    }
}

impl<C: Spectrum> Model<C> for OrenNayarQualitative<C> {
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
