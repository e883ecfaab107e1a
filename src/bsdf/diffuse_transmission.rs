//! Thin sheet that scatters diffusely.

use std::f32::consts::FRAC_1_PI;

use super::lobes::{Lobes, TransportMode};
use super::local::{same_side, sample_diffuse};
use super::model::{BsdfSample, Model};
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A sheet that reflects one share of the light and transmits another, both the same in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission<C: Spectrum = Rgb> {
    reflectance: C,
    transmittance: C,
    /// Probability with which a reflected direction is drawn.
    reflects: f32,
}

impl DiffuseTransmission {
    /// A sheet with these shares, which sum to 1 at most in each channel and are not both 0.
    pub fn new(reflectance: Rgb, transmittance: Rgb) -> Self {
        let [r, t] = [reflectance, transmittance].map(Rgb::max_element);
        Self { reflectance, transmittance, reflects: r / (r + t) }
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> DiffuseTransmission<C> {
        DiffuseTransmission {
            reflectance: C::from_reflectance(self.reflectance, wavelengths),
            transmittance: C::from_reflectance(self.transmittance, wavelengths),
            reflects: self.reflects,
        }
    }
}

impl<C: Spectrum> DiffuseTransmission<C> {
    /// The same that reflects another share.
    pub(super) fn with_reflectance(self, reflectance: C) -> Self {
        Self { reflectance, ..self }
    }

    /// The same that transmits another share.
    pub(super) fn with_transmittance(self, transmittance: C) -> Self {
        Self { transmittance, ..self }
    }
}

impl<C: Spectrum> Model<C> for DiffuseTransmission<C> {
    fn lobes(&self) -> Lobes {
        Lobes::DIFFUSE
    }

    fn albedo(&self) -> C {
        self.reflectance + self.transmittance
    }

    fn diffuse_albedo(&self) -> C {
        self.reflectance
    }

    fn f(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> C {
        if same_side(wo, wi) {
            self.reflectance * FRAC_1_PI
        } else if wo.z * wi.z < 0.0 {
            self.transmittance * FRAC_1_PI
        } else {
            C::ZERO
        }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let side = if same_side(wo, wi) {
            self.reflects
        } else if wo.z * wi.z < 0.0 {
            1.0 - self.reflects
        } else {
            0.0
        };
        side * warps::cosine_hemisphere_pdf(wi.z.abs())
    }

    #[inline(never)]
    fn sample(&self, wo: Vec3, u: [f32; 3], _: TransportMode) -> Option<BsdfSample<C>> {
        let (seen_from, probability, share, lobe) = if u[2] < self.reflects {
            (wo, self.reflects, self.reflectance, Lobes::DIFFUSE_REFLECTION)
        } else {
            (-wo, 1.0 - self.reflects, self.transmittance, Lobes::DIFFUSE_TRANSMISSION)
        };
        let sample = sample_diffuse(seen_from, u, |_| share / probability);
        Some(BsdfSample { pdf: probability * sample.pdf, lobe, ..sample })
    }

    fn mean_f(&self, _: Vec3) -> Option<C> {
        Some(self.reflectance * FRAC_1_PI)
    }
}
