//! Ideal diffuse reflection.

use std::f32::consts::FRAC_1_PI;

use crate::spectrum::Rgb;

/// Lambert's law: f = albedo / pi, the same in every direction. Conserves energy for albedos up to 1.
///
/// Source: Lambert 1760, *Photometria*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    albedo: Rgb,
    f: Rgb,
}

impl Lambert {
    /// A diffuse surface. `albedo`: share of the incoming power that is reflected, in [0, 1] per channel.
    pub fn new(albedo: Rgb) -> Self {
        Self { albedo, f: albedo * FRAC_1_PI }
    }

    /// Share of the incoming power that is reflected.
    #[inline]
    pub fn albedo(&self) -> Rgb {
        self.albedo
    }

    /// The scattering function for two directions on one side (sr^-1).
    #[inline]
    pub fn f(&self) -> Rgb {
        self.f
    }
}
