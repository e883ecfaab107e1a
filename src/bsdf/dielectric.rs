//! Smooth interface between two dielectrics.

use super::fresnel::{fresnel_dielectric, refracted_cosine};
use super::lobes::{Lobes, TransportMode};
use super::local::reflect;
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

/// A smooth, colourless interface: reflects the share that Fresnel's equations give and refracts the rest by Snell's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index on the inner side over index on the outer side. In double precision, as Snell's law close to the critical
    /// angle is.
    eta: f64,
}

impl Dielectric {
    /// An interface. `ior`: index of refraction on the inner side (z < 0), `exterior_ior`: on the outer side (z > 0);
    /// both > 0.
    pub fn new(ior: f32, exterior_ior: f32) -> Self {
        Self { eta: f64::from(ior) / f64::from(exterior_ior) }
    }

    /// An interface whose index on the inner side over that on the outer side is this, > 0.
    pub(super) fn of_ratio(eta: f64) -> Self {
        Self { eta }
    }

    /// Index on the far side over index on `wo`'s side.
    #[inline]
    fn relative_eta(&self, wo: Vec3) -> f64 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    /// Reflectance in [0, 1].
    #[inline]
    pub fn reflectance(&self, wo: Vec3) -> f32 {
        fresnel_dielectric(f64::from(wo.z), self.relative_eta(wo)) as f32
    }

    /// Both ways light can go: the reflectance F, the mirror direction, and unless reflection is total the refracted
    /// direction with the relative index (far side over `wo`'s side) it crosses into. The refracted branch carries the
    /// share 1 - F, and radiance along it another factor 1 / eta^2.
    #[inline]
    pub fn branches(&self, wo: Vec3) -> (f32, Vec3, Option<(Vec3, f32)>) {
        let eta = self.relative_eta(wo);
        let reflectance = fresnel_dielectric(f64::from(wo.z), eta) as f32;
        (reflectance, reflect(wo), refract(wo, eta).map(|wi| (wi, eta as f32)))
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, _: &C::Wavelengths) -> Self {
        *self
    }
}

impl<C: Spectrum> Model<C> for Dielectric {
    #[inline]
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR
    }

    #[inline]
    fn albedo(&self) -> C {
        C::ONE
    }

    /// Chooses a lobe with `u[2]`, with probability equal to its share, so that a reflection's weight is 1 and a
    /// refraction's 1, or 1 / eta^2 for radiance.
    // Inlined, it would make the choice among models save and restore registers for every sample of any model.
    #[inline(never)]
    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let eta = self.relative_eta(wo);
        let reflectance = fresnel_dielectric(f64::from(wo.z), eta) as f32;
        if u[2] >= reflectance
            && let Some(wi) = refract(wo, eta)
        {
            let weight = match mode {
                TransportMode::Radiance => C::splat((1.0 / (eta * eta)) as f32),
                TransportMode::Importance => C::ONE,
            };
            return Some(refraction(wi, weight, eta as f32));
        }
        Some(reflection(wo, C::ONE))
    }

    /// The reflectance F, and 1 - F for the refracted direction unless reflection is total; for radiance with another
    /// factor 1 / eta^2.
    #[inline]
    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let (reflectance, _, refracted) = self.branches(wo);
        let refraction = refracted.map(|(wi, eta)| {
            let transmittance = match mode {
                TransportMode::Radiance => (1.0 - reflectance) / (eta * eta),
                TransportMode::Importance => 1.0 - reflectance,
            };
            refraction(wi, C::splat(transmittance), eta)
        });
        [Some(reflection(wo, C::splat(reflectance))), refraction, None]
    }
}

/// A sample of the mirror direction.
#[inline]
pub(super) fn reflection<C: Spectrum>(wo: Vec3, weight: C) -> BsdfSample<C> {
    BsdfSample { wi: reflect(wo), weight, pdf: 0.0, lobe: Lobes::SPECULAR_REFLECTION, eta: 1.0 }
}

/// A sample of the refracted direction.
#[inline]
pub(super) fn refraction<C: Spectrum>(wi: Vec3, weight: C, eta: f32) -> BsdfSample<C> {
    BsdfSample { wi, weight, pdf: 0.0, lobe: Lobes::SPECULAR_TRANSMISSION, eta }
}

/// The refracted direction on the other side, or `None` under total reflection. With `eta` 1 it is -wo, bit for bit.
#[inline]
pub(super) fn refract(wo: Vec3, eta: f64) -> Option<Vec3> {
    if eta == 1.0 {
        return Some(-wo);
    }
    let cos_theta_t = refracted_cosine(f64::from(wo.z), eta)?;
    let tangential = |x: f32| (-f64::from(x) / eta) as f32;
    Some(Vec3::new(tangential(wo.x), tangential(wo.y), -(cos_theta_t as f32).copysign(wo.z)))
}
