//! Rough metal.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{outward, same_side};
use super::metal_facet::MetalFacet;
use super::microfacet::{FacetShares, Microfacets, MissingEnergy, choose};
use super::model::{BsdfSample, Model};
use crate::desc::ThinFilmDesc;
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A metal of facets: f = F D G / (4 cos cos), and what the facets reflect more than once. It reflects on both sides.
///
/// Light that is reflected between facets is spread as f = F_ms (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_mean)), where E is the
/// albedo of facets that reflect everything, and F_ms is the colour after several reflections. The form is reciprocal, unlike a
/// factor by the view alone, so that photons and paths from the camera agree; a metal that reflects everything then has the
/// albedo 1 in all directions.
///
/// With a film, facets reflect what interference leaves ([`MetalFacet::Filmed`]); F_ms is that of its colour in three channels.
///
/// Sources: Torrance and Sparrow 1967, "Theory for Off-Specular Reflection From Roughened Surfaces"; Cook and Torrance 1982, "A
/// Reflectance Model for Computer Graphics"; Walter et al. 2007; Kulla and Conty 2017, "Revisiting Physically Based Shading at
/// Imageworks" (with Hill's correction of F_ms).
#[derive(Clone, Debug, PartialEq)]
pub struct RoughConductor<C: Spectrum = Rgb> {
    facet: MetalFacet,
    facets: Microfacets,
    missing: Option<MissingEnergy>,
    /// F_ms.
    multiple: Rgb,
    mean: Rgb,
    wavelengths: C::Wavelengths,
}

impl RoughConductor {
    /// A rough metal. `is_compensated`: whether light that is reflected more than once is included.
    pub fn new(facet: MetalFacet, facets: Microfacets, is_compensated: bool) -> Self {
        let white = |_| FacetShares { reflected: 1.0, transmitted: None };
        let missing = MissingEnergy::new(&facets, (0.0, false), white);
        let albedo = 1.0 - missing.mean();
        let mean = facet.mean_reflectance();
        // F_mean^2 E_mean / (1 - F_mean (1 - E_mean)): at least two reflections, each of the mean colour.
        let several = |f: f32| f * f * albedo / (1.0 - f * missing.mean());
        let multiple = Rgb::from_array(mean.to_array().map(several));
        let once = mean * albedo;
        let mean = if is_compensated { once + multiple * missing.mean() } else { once };
        let missing = (is_compensated && missing.mean() > 1e-7).then_some(missing);
        Self { facet, facets, missing, multiple, mean, wavelengths: () }
    }

    /// As [`super::Bsdf::with_film`].
    pub(super) fn with_film(self, film: ThinFilmDesc) -> Self {
        Self::new(self.facet.with_film(film), self.facets, self.missing.is_some())
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> RoughConductor<C> {
        RoughConductor {
            facet: self.facet.clone(),
            facets: self.facets,
            missing: self.missing.clone(),
            multiple: self.multiple,
            mean: self.mean,
            wavelengths: *wavelengths,
        }
    }
}

impl<C: Spectrum> RoughConductor<C> {
    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { facets: self.facets.turned(turn), ..self.clone() }
    }

    fn colour(&self, reflectance: Rgb) -> C {
        C::from_reflectance(reflectance, &self.wavelengths)
    }

    /// What single scattering loses of light from `w`; 0 without compensation.
    #[inline]
    fn missing(&self, w: Vec3) -> f32 {
        self.missing.as_ref().map_or(0.0, |missing| missing.at(&self.facets, w))
    }

    /// Probability with which a cosine-distributed direction is drawn instead of a facet.
    #[inline]
    fn several(&self, missing: f32) -> f32 {
        missing * self.multiple.max_element()
    }

    /// f cos(wi) and the density. Both directions are on the outer side, `m` is the normal of the facet between them, and
    /// `missing` is that of `wo`.
    #[inline]
    fn evaluate(&self, wo: Vec3, wi: Vec3, m: Vec3, missing: f32) -> (C, f32) {
        let (once, pdf_once) = self.facets.reflection(wo, wi, m);
        let once = self.facet.reflectance_in::<C>(wo.dot(m), &self.wavelengths) * once;
        let Some(lost) = &self.missing else { return (once, pdf_once) };
        let back = missing * lost.at(&self.facets, wi) * FRAC_1_PI / lost.mean();
        let several = self.several(missing);
        let pdf = pdf_once + several * (warps::cosine_hemisphere_pdf(wi.z) - pdf_once);
        (once + self.colour(self.multiple) * (back * wi.z), pdf)
    }
}

impl<C: Spectrum> Model<C> for RoughConductor<C> {
    fn lobes(&self) -> Lobes {
        Lobes::GLOSSY_REFLECTION
    }

    fn albedo(&self) -> C {
        self.colour(self.mean)
    }

    fn is_anisotropic(&self) -> bool {
        self.facets.is_anisotropic()
    }

    fn narrowest(&self) -> f32 {
        self.facets.widths()[1].min(1.0)
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.f_pdf(wo, wi, mode).0
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.f_pdf(wo, wi, TransportMode::Radiance).1
    }

    #[inline(never)]
    fn f_pdf(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> (C, f32) {
        if !same_side(wo, wi) {
            return (C::ZERO, 0.0);
        }
        let (wo, wi) = (outward(wo), outward(wi));
        let (f_cos, pdf) = self.evaluate(wo, wi, (wo + wi).normalize(), self.missing(wo));
        (f_cos / wi.z, pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, mut u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        let side = wo.z;
        let wo = outward(wo);
        let missing = self.missing(wo);
        let several = self.several(missing);
        let (wi, m) = if several > 0.0 && choose(several, &mut u[2]) {
            let wi = warps::cosine_hemisphere([u[0], u[1]]);
            (wi, (wo + wi).normalize())
        } else {
            let m = self.facets.reflecting_normal(wo, &mut u);
            (2.0 * wo.dot(m) * m - wo, m)
        };
        // What a facet reflects down into the surface meets another one: the light that is made up for.
        if wi.z <= 0.0 {
            return None;
        }
        let wi = wi.normalize();
        let (f_cos, pdf) = self.evaluate(wo, wi, m, missing);
        let weight = f_cos / pdf;
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(side));
        // At the edge of what single precision holds a density can be infinite or 0.
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf,
            lobe: Lobes::GLOSSY_REFLECTION,
            eta: 1.0,
        })
    }
}
