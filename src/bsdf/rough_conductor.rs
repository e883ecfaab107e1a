//! Rough metal.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::lobes::{Lobes, TransportMode};
use super::local::{outward, same_side};
use super::metal_facet::MetalFacet;
use super::metal_spectrum::{MetalCurves, MetalInSpectrum};
use super::microfacet::{FacetShares, Microfacets, MissingEnergy, choose};
use super::model::{BsdfSample, Model};
use super::thin_film::FilmedMetal;
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
    /// Albedo of facets that reflect everything.
    albedo: f32,
    is_compensated: bool,
    by_wavelength: MetalInSpectrum<C>,
    wavelengths: C::Wavelengths,
}

/// F_ms of facets of this mean reflectance, which lose this share of the light in one reflection:
/// F_mean^2 E_mean / (1 - F_mean (1 - E_mean)), at least two reflections, each of the mean colour.
fn several_reflections<C: Spectrum>(mean: C, missing: f32) -> C {
    mean.map(|f| f * f * (1.0 - missing) / (1.0 - f * missing))
}

impl RoughConductor {
    /// A rough metal. `is_compensated`: whether light that is reflected more than once is included.
    pub fn new(facet: MetalFacet, facets: Microfacets, is_compensated: bool) -> Self {
        let white = |_| FacetShares { reflected: 1.0, transmitted: None };
        let missing = MissingEnergy::new(&facets, (0.0, false), white);
        let albedo = 1.0 - missing.mean();
        let mean = facet.mean_reflectance();
        let multiple = several_reflections(mean, missing.mean());
        let once = mean * albedo;
        let mean = if is_compensated { once + multiple * missing.mean() } else { once };
        let missing = (is_compensated && missing.mean() > 1e-7).then_some(missing);
        let by_wavelength = MetalInSpectrum::default();
        Self { facet, facets, missing, multiple, mean, albedo, is_compensated, by_wavelength, wavelengths: () }
    }

    /// The same metal in three channels, and this one by the wavelength.
    pub(super) fn measured(self, metal: MetalCurves) -> Self {
        Self { by_wavelength: MetalInSpectrum::Curves(metal), ..self }
    }

    /// The same facets of a metal with a thin film.
    pub(super) fn filmed(&self, metal: Arc<FilmedMetal>) -> Self {
        Self::new(MetalFacet::Filmed(metal), self.facets, self.is_compensated)
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> RoughConductor<C> {
        RoughConductor {
            facet: self.facet.clone(),
            facets: self.facets,
            missing: self.missing.clone(),
            multiple: self.multiple,
            mean: self.mean,
            albedo: self.albedo,
            is_compensated: self.is_compensated,
            by_wavelength: self.by_wavelength.in_spectrum(wavelengths),
            wavelengths: *wavelengths,
        }
    }
}

impl<C: Spectrum> RoughConductor<C> {
    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { facets: self.facets.turned(turn), ..self.clone() }
    }

    /// What a facet reflects at this cosine to its normal.
    fn facet_reflectance(&self, cos: f32) -> C {
        match self.by_wavelength.at() {
            Some(metal) => metal.reflectance(cos),
            None => self.facet.reflectance_in(cos, &self.wavelengths),
        }
    }

    /// F_ms at the wavelengths of a path, where the metal is known by the wavelength.
    fn measured_multiple(&self) -> Option<C> {
        self.by_wavelength.at().map(|metal| several_reflections(metal.mean, 1.0 - self.albedo))
    }

    /// F_ms.
    fn multiple(&self) -> C {
        self.measured_multiple().unwrap_or_else(|| C::from_reflectance(self.multiple, &self.wavelengths))
    }

    /// What single scattering loses of light from `w`; 0 without compensation.
    #[inline]
    fn missing(&self, w: Vec3) -> f32 {
        self.missing.as_ref().map_or(0.0, |missing| missing.at(&self.facets, w))
    }

    /// Probability with which a cosine-distributed direction is drawn instead of a facet.
    #[inline]
    fn several(&self, missing: f32) -> f32 {
        missing * self.measured_multiple().map_or(self.multiple.max_element(), C::max_element)
    }

    /// f cos(wi) and the density. Both directions are on the outer side, `m` is the normal of the facet between them, and
    /// `missing` is that of `wo`.
    #[inline]
    fn evaluate(&self, wo: Vec3, wi: Vec3, m: Vec3, missing: f32) -> (C, f32) {
        let (once, pdf_once) = self.facets.reflection(wo, wi, m);
        let once = self.facet_reflectance(wo.dot(m)) * once;
        let Some(lost) = &self.missing else { return (once, pdf_once) };
        let back = missing * lost.at(&self.facets, wi) * FRAC_1_PI / lost.mean();
        let several = self.several(missing);
        let pdf = pdf_once + several * (warps::cosine_hemisphere_pdf(wi.z) - pdf_once);
        (once + self.multiple() * (back * wi.z), pdf)
    }
}

impl<C: Spectrum> Model<C> for RoughConductor<C> {
    fn lobes(&self) -> Lobes {
        Lobes::GLOSSY_REFLECTION
    }

    fn albedo(&self) -> C {
        match self.by_wavelength.at() {
            Some(metal) if self.is_compensated => metal.mean * self.albedo + self.multiple() * (1.0 - self.albedo),
            Some(metal) => metal.mean * self.albedo,
            None => C::from_reflectance(self.mean, &self.wavelengths),
        }
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
