//! The description of the principled material.

use super::MicrofacetsDesc;
use crate::spectrum::Rgb;

/// The parameters of the principled material. Names and defaults are those of OpenPBR Surface 1.1 where it has them;
/// `docs/materials.md` compares them with OpenPBR and glTF. Colours and weights are in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledDesc {
    /// Factor on `base_color` for the metal and for the diffuse part.
    pub base_weight: f32,
    /// Colour of the diffuse part; reflectance of the metal at normal incidence.
    pub base_color: Rgb,
    /// Roughness of the diffuse part.
    pub base_diffuse_roughness: f32,
    /// Share of metal.
    pub base_metalness: f32,
    /// Factor on the reflectance of the metal and, at normal incidence, of the dielectric.
    pub specular_weight: f32,
    /// Tint of the edge of the metal.
    pub specular_color: Rgb,
    /// Roughness of metal and dielectric.
    pub specular_roughness: f32,
    /// How much narrower highlights are along one direction, in [0, 1).
    pub specular_roughness_anisotropy: f32,
    /// Angle of that direction, radians.
    pub specular_rotation: f32,
    /// Index of refraction of the dielectric, > 0.
    pub specular_ior: f32,
    /// Share of the dielectric that light passes, instead of being scattered diffusely.
    pub transmission_weight: f32,
    /// Colour of what is transmitted: of light that has entered and left, or of light that has travelled `transmission_depth`.
    pub transmission_color: Rgb,
    /// The distance inside a body after which `transmission_color` is left [scene unit]; 0 colours light at the surface instead.
    /// A thin sheet has no inside.
    pub transmission_depth: f32,
    /// Share of the surface that has a coat.
    pub coat_weight: f32,
    /// Colour of what passes the coat down and up again along the normal.
    pub coat_color: Rgb,
    /// Roughness of the coat.
    pub coat_roughness: f32,
    /// Anisotropy of the coat, in [0, 1).
    pub coat_roughness_anisotropy: f32,
    /// Index of refraction of the coat, in [1, 100].
    pub coat_ior: f32,
    /// How much a coat darkens what is under it, by light that bounces between the two: 1 is the physical darkening.
    pub coat_darkening: f32,
    /// Share of the surface that is covered by fuzz.
    pub fuzz_weight: f32,
    /// Colour of the fuzz.
    pub fuzz_color: Rgb,
    /// Roughness of the fuzz, in (0, 1].
    pub fuzz_roughness: f32,
    /// Whether the surface is a thin sheet: what is transmitted is not refracted.
    pub thin_walled: bool,
    /// Whether the light that facets reflect more than once is made up for.
    pub multiple_scattering: bool,
}

impl Default for PrincipledDesc {
    fn default() -> Self {
        Self {
            base_weight: 1.0,
            base_color: Rgb::splat(0.8),
            base_diffuse_roughness: 0.0,
            base_metalness: 0.0,
            specular_weight: 1.0,
            specular_color: Rgb::ONE,
            specular_roughness: 0.3,
            specular_roughness_anisotropy: 0.0,
            specular_rotation: 0.0,
            specular_ior: 1.5,
            transmission_weight: 0.0,
            transmission_color: Rgb::ONE,
            transmission_depth: 0.0,
            coat_weight: 0.0,
            coat_color: Rgb::ONE,
            coat_roughness: 0.0,
            coat_roughness_anisotropy: 0.0,
            coat_ior: 1.6,
            coat_darkening: 1.0,
            fuzz_weight: 0.0,
            fuzz_color: Rgb::ONE,
            fuzz_roughness: 0.5,
            thin_walled: false,
            multiple_scattering: true,
        }
    }
}

impl PrincipledDesc {
    /// Whether light that is refracted into it is inside of a body.
    pub(crate) fn has_inside(&self) -> bool {
        self.transmission_weight > 0.0 && self.base_metalness < 1.0 && !self.thin_walled
    }

    /// The index of refraction of the clear part over the one around it, with the factor on its reflectance at normal incidence.
    pub(crate) fn clear_eta(&self, around: f32) -> f32 {
        weighted_eta(self.specular_ior / around, self.specular_weight)
    }

    /// The absorption coefficient inside bodies [1 / scene unit]; `None` for a surface without an inside, or whose colour is its own.
    pub(crate) fn absorption(&self) -> Option<Rgb> {
        let of = |left: f32| (-f64::from(left).ln() / f64::from(self.transmission_depth)).max(0.0) as f32;
        (self.has_inside() && self.transmission_depth > 0.0)
            .then(|| Rgb::from_array(self.transmission_color.to_array().map(of)))
    }

    /// The facets of the metal and of the dielectric.
    pub fn specular_facets(&self) -> MicrofacetsDesc {
        MicrofacetsDesc {
            anisotropy: self.specular_roughness_anisotropy,
            rotation: self.specular_rotation,
            multiple_scattering: self.multiple_scattering,
            ..MicrofacetsDesc::rough(self.specular_roughness)
        }
    }

    /// The facets of the coat.
    pub fn coat_facets(&self) -> MicrofacetsDesc {
        MicrofacetsDesc {
            anisotropy: self.coat_roughness_anisotropy,
            multiple_scattering: self.multiple_scattering,
            ..MicrofacetsDesc::rough(self.coat_roughness)
        }
    }
}

/// The index of a dielectric with this factor on its reflectance at normal incidence, over what is around it.
pub(crate) fn weighted_eta(eta: f32, weight: f32) -> f32 {
    let reflected = (weight.sqrt() * (eta - 1.0) / (eta + 1.0)).clamp(-0.999, 0.999);
    (1.0 + reflected) / (1.0 - reflected)
}
