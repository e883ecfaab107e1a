//! Fibres that stand up from a surface.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{outward, same_side};
use super::memo::memo;
use super::microfacet::AlbedoCurve;
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// The sheen of fibres, which is brightest towards the horizon: f = color D G / (4 cos cos) with D in proportion to
/// sin^(1/alpha), and Smith's height-correlated masking by a fit of Lambda. Reciprocal; facets that are not in it absorb.
///
/// Chosen over the fit of Zeltner, Burley and Chiang 2022 because that one is not reciprocal, and photons and paths from the
/// camera would disagree.
///
/// Source: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen<C: Spectrum = Rgb> {
    color: C,
    /// 1 / alpha.
    exponent: f32,
    /// Coefficients of the fit of Lambda.
    fit: [f32; 5],
    /// Albedo of white fibres.
    albedo: AlbedoCurve,
    mean: f32,
    /// Factor that keeps the albedo of white fibres at 1 or below.
    scale: f32,
}

memo!(
    /// White fibres by alpha.
    FIBRES: u32 => Sheen, 1024
);

impl Sheen {
    /// Fibres of this colour in [0, 1] and this perceptual roughness in (0, 1], of which alpha is the square.
    pub fn new(color: Rgb, roughness: f32) -> Self {
        let alpha = (roughness * roughness).max(0.005);
        let between = (1.0 - alpha) * (1.0 - alpha);
        let ends =
            [(25.3245, 21.5473), (3.32435, 3.82987), (0.16801, 0.19823), (-1.27393, -1.97760), (-4.85967, -4.32054)];
        let fit = ends.map(|(rough, smooth): (f32, f32)| between * rough + (1.0 - between) * smooth);
        let fibres = || {
            let (albedo, mean) = (AlbedoCurve::zero(), 0.0);
            let mut fibres = Self { color: Rgb::ONE, exponent: 1.0 / alpha, fit, albedo, mean, scale: 1.0 };
            let greatest = (1..=256).map(|i| fibres.integrated(f64::from(i) / 256.0)).fold(0.0, f64::max);
            fibres.scale = (1.0 / greatest).min(1.0) as f32;
            fibres.albedo = AlbedoCurve::new(0.25, |mu| fibres.integrated(mu));
            fibres.mean = fibres.albedo.mean();
            fibres
        };
        Self { color, ..FIBRES.get(&alpha.to_bits(), fibres) }
    }

    /// The roughness, as bits.
    pub(super) fn shape(&self) -> u32 {
        self.exponent.to_bits()
    }

    /// Albedo of white fibres at this cosine, by quadrature.
    fn integrated(&self, mu: f64) -> f64 {
        const N: u32 = 64;
        let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt() as f32, 0.0, mu.max(1e-6) as f32);
        let mut sum = 0.0;
        for i in 0..N {
            // cos = t^2 puts more points at the horizon, where fibres are brightest.
            let t = (f64::from(i) + 0.5) / f64::from(N);
            let (cos, jacobian) = (t * t, 2.0 * t);
            let sin = (1.0 - cos * cos).sqrt();
            for j in 0..N {
                let (s, c) = (PI * (f64::from(j) + 0.5) / f64::from(N)).sin_cos();
                let wi = Vec3::new((sin * c) as f32, (sin * s) as f32, cos as f32);
                sum += f64::from(self.white(wo, wi)) * cos * jacobian;
            }
        }
        sum * 2.0 * PI / f64::from(N * N)
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Sheen<C> {
        Sheen {
            color: C::from_reflectance(self.color, wavelengths),
            exponent: self.exponent,
            fit: self.fit,
            albedo: self.albedo,
            mean: self.mean,
            scale: self.scale,
        }
    }
}

impl<C: Spectrum> Sheen<C> {
    /// The same with fibres of this colour.
    pub(super) fn with_color(self, color: C) -> Self {
        Self { color, ..self }
    }

    /// Albedo of white fibres in a direction.
    pub(super) fn white_albedo(&self, w: Vec3) -> f32 {
        self.albedo.at(w.z.abs())
    }

    /// The mean albedo of white fibres, for light from all sides.
    pub(super) fn white_mean(&self) -> f32 {
        self.mean
    }

    fn lambda(&self, cos: f32) -> f32 {
        let [a, b, c, d, e] = self.fit;
        let fit = |x: f32| a / (1.0 + b * x.powf(c)) + d * x + e;
        if cos < 0.5 { fit(cos).exp() } else { (2.0 * fit(0.5) - fit(1.0 - cos)).exp() }
    }

    /// f of white fibres; both directions are on the outer side.
    fn white(&self, wo: Vec3, wi: Vec3) -> f32 {
        let m = (wo + wi).normalize();
        let sin2 = (1.0 - m.z * m.z).max(0.0);
        let d = (2.0 + self.exponent) * sin2.powf(0.5 * self.exponent) * 0.5 * FRAC_1_PI;
        let seen = 1.0 + self.lambda(wo.z) + self.lambda(wi.z);
        self.scale * d / (seen * 4.0 * wo.z * wi.z)
    }
}

impl<C: Spectrum> Model<C> for Sheen<C> {
    fn lobes(&self) -> Lobes {
        Lobes::DIFFUSE_REFLECTION
    }

    fn albedo(&self) -> C {
        self.color * self.mean
    }

    fn share(&self, wo: Vec3) -> f32 {
        self.color.max_element() * self.white_albedo(wo).max(1e-3)
    }

    #[inline(never)]
    fn f(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> C {
        if same_side(wo, wi) { self.color * self.white(outward(wo), outward(wi)) } else { C::ZERO }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if same_side(wo, wi) { warps::uniform_hemisphere_pdf() } else { 0.0 }
    }

    /// Directions are uniform: towards the horizon fibres are brighter than the cosine is small.
    #[inline(never)]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        let wi = warps::uniform_hemisphere([u[0], u[1]]);
        let pdf = warps::uniform_hemisphere_pdf();
        let weight = self.color * (self.white(outward(wo), wi) * wi.z / pdf);
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z));
        (wi.z != 0.0).then_some(BsdfSample { wi, weight, pdf, lobe: Lobes::DIFFUSE_REFLECTION, eta: 1.0 })
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        Some(self.color * (self.white_albedo(wo) * FRAC_1_PI))
    }

    fn is_even(&self) -> bool {
        false
    }
}
