//! Thin sheet of glass.

use super::fresnel::{fresnel_polarised, refracted_cosine};
use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// What a sheet of glass with two smooth parallel faces reflects and lets pass, with all reflections between the faces.
///
/// With R the reflectance of a face for one polarisation, and a the share that is left after one way through the sheet,
/// T = (1 - R)^2 a / (1 - R^2 a^2), which is (1 - R) / (1 + R) in clear glass, and the sheet reflects R (1 + a T). Both are means
/// over the polarisations. Source: Born and Wolf, *Principles of Optics*, Sec. 7.6, without interference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Index of the sheet over index around it.
    eta: f64,
    /// What is left after the way along the normal.
    transmittance: Rgb,
}

impl Sheet {
    /// A sheet. `ior`: its index of refraction, `exterior_ior`: of what is around it. `transmittance`: what is left of light
    /// that crossed it once along the normal, in [0, 1].
    pub(super) fn new(ior: f32, exterior_ior: f32, transmittance: Rgb) -> Self {
        Self { eta: f64::from(ior) / f64::from(exterior_ior), transmittance }
    }

    /// What the sheet reflects and transmits, for light at this cosine to its normal.
    pub(super) fn shares(&self, cos: f32) -> [Rgb; 2] {
        let cos = f64::from(cos);
        let faces = fresnel_polarised(cos, self.eta);
        let channel = |a: f64| {
            let both = faces.map(|r| {
                // Both faces reflect everything at grazing incidence, where the closed form is 0 / 0.
                let transmitted = if r < 1.0 { (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a) } else { 0.0 };
                [0.5 * r * (1.0 + a * transmitted), 0.5 * transmitted]
            });
            [0, 1].map(|share: usize| (both[0][share] + both[1][share]) as f32)
        };
        if self.transmittance == Rgb::ONE {
            return channel(1.0).map(Rgb::splat);
        }
        // Under total reflection nothing enters the sheet.
        let way = refracted_cosine(cos, self.eta).unwrap_or(1.0).recip();
        let channels = self.transmittance.to_array().map(|left| channel(f64::from(left).powf(way)));
        [0, 1].map(|share| Rgb::from_array(channels.map(|both| both[share])))
    }
}

/// A thin sheet with smooth faces. Light that passes goes straight on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<C: Spectrum = Rgb> {
    sheet: Sheet,
    wavelengths: C::Wavelengths,
}

impl ThinDielectric {
    pub(super) fn new(sheet: Sheet) -> Self {
        Self { sheet, wavelengths: () }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> ThinDielectric<C> {
        ThinDielectric { sheet: self.sheet, wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> ThinDielectric<C> {
    fn lobes_at(&self, wo: Vec3) -> [BsdfSample<C>; 2] {
        let [reflected, transmitted] =
            self.sheet.shares(wo.z.abs()).map(|share| C::from_reflectance(share, &self.wavelengths));
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
