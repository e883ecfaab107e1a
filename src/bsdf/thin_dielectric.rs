//! Thin sheet of glass.

use super::fresnel::{fresnel_polarised, refracted_cosine};
use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A sheet of glass with two smooth parallel faces, with all reflections between them. Light that passes goes straight on.
///
/// With R the reflectance of a face for one polarisation, and a the share that is left after one way through the sheet,
/// T = (1 - R)^2 a / (1 - R^2 a^2), which is (1 - R) / (1 + R) in clear glass, and the sheet reflects R (1 + a T). Both are means
/// over the polarisations. Source: Born and Wolf, *Principles of Optics*, Sec. 7.6, without interference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<C: Spectrum = Rgb> {
    /// Index of the sheet over index around it.
    eta: f64,
    /// What is left after the way along the normal.
    transmittance: Rgb,
    wavelengths: C::Wavelengths,
}

impl ThinDielectric {
    /// A sheet. `ior`: its index of refraction, `exterior_ior`: of what is around it. `transmittance`: what is left of light
    /// that crossed it once along the normal, in [0, 1].
    pub fn new(ior: f32, exterior_ior: f32, transmittance: Rgb) -> Self {
        Self { eta: f64::from(ior) / f64::from(exterior_ior), transmittance, wavelengths: () }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> ThinDielectric<C> {
        ThinDielectric { eta: self.eta, transmittance: self.transmittance, wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> ThinDielectric<C> {
    /// What the sheet reflects and transmits, for light at this cosine to its normal.
    fn shares(&self, cos: f32) -> [Rgb; 2] {
        let cos = f64::from(cos);
        let faces = fresnel_polarised(cos, self.eta);
        // Under total reflection nothing enters the sheet.
        let way = refracted_cosine(cos, self.eta).unwrap_or(1.0).recip();
        let channel = |left: f32| {
            let a = if left == 1.0 { 1.0 } else { f64::from(left).powf(way) };
            faces.map(|r| {
                // Both faces reflect everything at grazing incidence, where the closed form is 0 / 0.
                let transmitted = if r < 1.0 { (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a) } else { 0.0 };
                [0.5 * r * (1.0 + a * transmitted), 0.5 * transmitted]
            })
        };
        let both = self.transmittance.to_array().map(channel);
        [0, 1].map(|share| Rgb::from_array(both.map(|[s, p]| (s[share] + p[share]) as f32)))
    }

    fn lobes_at(&self, wo: Vec3) -> [BsdfSample<C>; 2] {
        let [reflected, transmitted] =
            self.shares(wo.z.abs()).map(|share| C::from_reflectance(share, &self.wavelengths));
        let sample = |wi, weight, lobe| BsdfSample { wi, weight, pdf: 0.0, lobe, eta: 1.0 };
        [
            sample(reflect(wo), reflected, Lobes::SPECULAR_REFLECTION),
            sample(-wo, transmitted, Lobes::SPECULAR_TRANSMISSION),
        ]
    }
}

impl<C: Spectrum> Model<C> for ThinDielectric<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR
    }

    fn albedo(&self) -> C {
        C::ONE
    }

    /// Chooses a lobe in proportion to the larger channel of its share.
    #[inline(never)]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        let [reflected, transmitted] = self.lobes_at(wo);
        let [r, t] = [reflected, transmitted].map(|lobe| lobe.weight.max_element());
        let probability = r / (r + t);
        let (chosen, probability) =
            if u[2] < probability { (reflected, probability) } else { (transmitted, 1.0 - probability) };
        (chosen.weight != C::ZERO).then(|| BsdfSample { weight: chosen.weight / probability, ..chosen })
    }

    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        let [reflected, transmitted] = self.lobes_at(wo);
        [Some(reflected), None, Some(transmitted)]
    }
}
