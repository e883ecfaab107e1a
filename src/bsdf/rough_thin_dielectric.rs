//! Rough thin sheet of glass.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::outward;
use super::microfacet::{FacetShares, Microfacets, MissingEnergy, average, choose};
use super::model::{BsdfSample, Model};
use super::thin_dielectric::Sheet;
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A frosted sheet: facets, each of which is a small thin sheet, and what facets scatter more than once.
///
/// Light that passes leaves as if it had been reflected and then mirrored at the sheet, so that both lobes have the same width:
/// f = R D G2 / (4 cos cos) on one side, and the same with T and the mirrored `wi` on the other. The form is symmetric. What
/// facets lose is that of white ones, since a clear sheet absorbs nothing, and it is spread over both sides in the proportion
/// of the mean shares of a facet, with the colour of several facets, as for metals
/// ([`RoughConductor`](super::RoughConductor)).
///
/// The sheet's two faces are rough together. A sheet whose faces are rough independently of each other blurs what is seen through
/// it (n - 1) / sqrt(2) times as much as what is seen in it, which is less; equal widths are what glTF 2.0 asks for
/// (`KHR_materials_transmission`), at whose materials this model is aimed.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughThinDielectric<C: Spectrum = Rgb> {
    sheet: Sheet,
    facets: Microfacets,
    multiple: Option<Multiple>,
    /// What a flat sheet scatters of light from all sides.
    mean: Rgb,
    wavelengths: C::Wavelengths,
}

/// What is scattered more than once.
#[derive(Clone, Debug, PartialEq)]
struct Multiple {
    missing: MissingEnergy,
    /// Colours of what is reflected and of what is transmitted.
    colours: [Rgb; 2],
    /// Probabilities with which a cosine-distributed direction is drawn on either side, for light of which facets lose all.
    probabilities: [f32; 2],
}

impl RoughThinDielectric {
    /// A rough sheet. `is_compensated`: whether light that facets scatter more than once is included.
    pub(super) fn new(sheet: Sheet, facets: Microfacets, is_compensated: bool) -> Self {
        let means = [0, 1].map(|share: usize| {
            Rgb::from_array(std::array::from_fn(|channel| {
                average(|mu| f64::from(sheet.shares(mu as f32)[share].to_array()[channel])) as f32
            }))
        });
        let whole = means[0] + means[1];
        let white = |_| FacetShares { reflected: 1.0, transmitted: None };
        let multiple = is_compensated.then(|| MissingEnergy::new(&facets, (0.0, false), white)).and_then(|missing| {
            if missing.mean() <= 1e-7 {
                return None;
            }
            // At least two facets, each of the mean colour S: S^2 E_mean / (1 - S (1 - E_mean)), of which each side gets its share.
            let once = 1.0 - missing.mean();
            let colours = means.map(|mean| {
                Rgb::from_array(std::array::from_fn(|channel| {
                    let s = whole[channel].min(1.0);
                    mean[channel] * s * once / (1.0 - s * missing.mean())
                }))
            });
            let probabilities = colours.map(Rgb::max_element);
            let sum = probabilities[0] + probabilities[1];
            let probabilities = if sum > 1.0 { probabilities.map(|p| p / sum) } else { probabilities };
            Some(Multiple { missing, colours, probabilities })
        });
        Self { sheet, facets, multiple, mean: whole.min(Rgb::ONE), wavelengths: () }
    }

    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> RoughThinDielectric<C> {
        RoughThinDielectric {
            sheet: self.sheet,
            facets: self.facets,
            multiple: self.multiple.clone(),
            mean: self.mean,
            wavelengths: *wavelengths,
        }
    }
}

impl<C: Spectrum> RoughThinDielectric<C> {
    /// With its facets turned.
    pub(super) fn turned(&self, turn: [f32; 2]) -> Self {
        Self { facets: self.facets.turned(turn), ..self.clone() }
    }

    fn colour(&self, share: Rgb) -> C {
        C::from_reflectance(share, &self.wavelengths)
    }

    /// What single scattering loses of light from `w`; 0 without compensation.
    #[inline]
    fn missing(&self, w: Vec3) -> f32 {
        self.multiple.as_ref().map_or(0.0, |multiple| multiple.missing.at(&self.facets, w))
    }

    /// Probabilities with which a cosine-distributed direction is drawn on either side instead of a facet.
    #[inline]
    fn several(&self, missing: f32) -> [f32; 2] {
        self.multiple.as_ref().map_or([0.0; 2], |multiple| multiple.probabilities.map(|p| missing * p))
    }

    /// Probability with which a facet with these shares reflects.
    #[inline]
    fn reflects([reflected, transmitted]: [Rgb; 2]) -> f32 {
        let [r, t] = [reflected, transmitted].map(Rgb::max_element);
        if r + t > 0.0 { r / (r + t) } else { 0.5 }
    }

    /// f cos(wi) and the density. Both directions are mirrored to the outer side; `side` is 0 where they are on one side and 1
    /// where light passes. `m` is the normal of the facet between them, `missing` is that of `wo`.
    #[inline]
    fn evaluate(&self, wo: Vec3, wi: Vec3, m: Vec3, side: usize, missing: f32) -> (C, f32) {
        let shares = self.sheet.shares(wo.dot(m));
        let reflects = Self::reflects(shares);
        let (once, pdf_once) = self.facets.reflection(wo, wi, m);
        let pdf_once = pdf_once * if side == 0 { reflects } else { 1.0 - reflects };
        let once = self.colour(shares[side]) * once;
        let Some(multiple) = &self.multiple else { return (once, pdf_once) };
        let back = missing * multiple.missing.at(&self.facets, wi) * FRAC_1_PI / multiple.missing.mean();
        let several = self.several(missing);
        let pdf = (1.0 - several[0] - several[1]) * pdf_once + several[side] * warps::cosine_hemisphere_pdf(wi.z);
        (once + self.colour(multiple.colours[side]) * (back * wi.z), pdf)
    }
}

impl<C: Spectrum> Model<C> for RoughThinDielectric<C> {
    fn lobes(&self) -> Lobes {
        Lobes::GLOSSY
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
        if wo.z * wi.z == 0.0 {
            return (C::ZERO, 0.0);
        }
        let side = usize::from(wo.z * wi.z < 0.0);
        let (wo, wi) = (outward(wo), outward(wi));
        let (f_cos, pdf) = self.evaluate(wo, wi, (wo + wi).normalize(), side, self.missing(wo));
        (f_cos / wi.z, pdf)
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, mut u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        let from = wo.z;
        let wo = outward(wo);
        let missing = self.missing(wo);
        let [several_reflected, several_transmitted] = self.several(missing);
        let several = several_reflected + several_transmitted;
        let (wi, m, side) = if several > 0.0 && choose(several, &mut u[2]) {
            let wi = warps::cosine_hemisphere([u[0], u[1]]);
            (wi, (wo + wi).normalize(), usize::from(u[2] * several >= several_reflected))
        } else {
            let m = self.facets.reflecting_normal(wo, &mut u);
            let reflects = Self::reflects(self.sheet.shares(wo.dot(m)));
            (2.0 * wo.dot(m) * m - wo, m, usize::from(u[2] >= reflects))
        };
        // What a facet scatters down into the surface meets another one: the light that is made up for.
        if wi.z <= 0.0 {
            return None;
        }
        let wi = wi.normalize();
        let (f_cos, pdf) = self.evaluate(wo, wi, m, side, missing);
        let weight = f_cos / pdf;
        let (lobe, z) = if side == 0 { (Lobes::GLOSSY_REFLECTION, from) } else { (Lobes::GLOSSY_TRANSMISSION, -from) };
        let wi = Vec3::new(wi.x, wi.y, wi.z.copysign(z));
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }
}
