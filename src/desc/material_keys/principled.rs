//! Keys of the principled material.

use super::super::builder::Builder;
use super::super::json::{Whole, join};
use super::super::numbers::{degrees, single, unless, unless_color};
use super::super::{BsdfDesc, MediumDesc, PrincipledDesc, validate};
use super::{Kind, SharedKeys, keys, material, tags};
use crate::Result;
use crate::spectrum::Rgb;

material!(
    /// One model with the parameters of OpenPBR, in its names.
    Principled, Principled, {
    /// Factor on `base_color`. Default 1.
    base_weight: Option<f64>,
    /// Colour of the diffuse part, and of the metal at normal incidence. Default [0.8, 0.8, 0.8].
    base_color: Option<[f64; 3]>,
    /// Roughness of the diffuse part. Default 0.
    base_diffuse_roughness: Option<f64>,
    /// Share of metal. Default 0.
    base_metalness: Option<f64>,
    /// Factor on the reflectance of metal and dielectric. Default 1.
    specular_weight: Option<f64>,
    /// Tint of the edge of the metal. Default [1, 1, 1].
    specular_color: Option<[f64; 3]>,
    /// Perceptual roughness of metal and dielectric. Default 0.3.
    specular_roughness: Option<f64>,
    /// In [0, 0.99]. Default 0.
    specular_roughness_anisotropy: Option<f64>,
    /// Degrees; a key that OpenPBR leaves to the tangent. Default 0.
    specular_rotation: Option<f64>,
    /// Index of refraction of the dielectric, > 0. Default 1.5.
    specular_ior: Option<f64>,
    /// Share of the dielectric that is clear. Default 0.
    transmission_weight: Option<f64>,
    /// Colour of what is left of light that enters and leaves, or that travels `transmission_depth` inside. Default [1, 1, 1].
    transmission_color: Option<[f64; 3]>,
    /// The distance after which `transmission_color` is left, scene units. Default 0: the colour belongs to the surface.
    transmission_depth: Option<f64>,
    /// Share of the surface that has a coat. Default 0.
    coat_weight: Option<f64>,
    /// Colour of what is left of light that passes the coat down and up. Default [1, 1, 1].
    coat_color: Option<[f64; 3]>,
    /// Perceptual roughness of the coat. Default 0.
    coat_roughness: Option<f64>,
    /// In [0, 0.99]. Default 0.
    coat_roughness_anisotropy: Option<f64>,
    /// Index of refraction of the coat, in [1, 100]. Default 1.6.
    coat_ior: Option<f64>,
    /// How much light that bounces under the coat darkens the base. Default 1.
    coat_darkening: Option<f64>,
    /// Share of the surface that is covered by fuzz. Default 0.
    fuzz_weight: Option<f64>,
    /// Colour of the fuzz. Default [1, 1, 1].
    fuzz_color: Option<[f64; 3]>,
    /// Perceptual roughness of the fuzz, above 0 and up to 1. Default 0.5.
    fuzz_roughness: Option<f64>,
    /// Whether the surface is a thin sheet, which refracts nothing. Default false. OpenPBR calls it `geometry_thin_walled`.
    thin_walled: Option<bool>,
    /// Which medium fills the overlap of bodies that transmit: the one with the larger priority. Default 0.
    priority: Option<Whole>,
    /// Absorption coefficient inside bodies that transmit, 1 / scene unit, 0 or more per channel, in addition to that of
    /// `transmission_depth`. Default [0, 0, 0].
    absorption: Option<[f64; 3]>,
    /// Whether light that facets scatter more than once is made up for. Default true.
    #[serde(rename = "multipleScattering")]
    multiple_scattering: Option<bool>,
});

impl Principled {
    /// The keys that differ from their defaults.
    pub(super) fn of(shared: SharedKeys, it: &PrincipledDesc, medium: Option<MediumDesc>) -> Self {
        let default = PrincipledDesc::default();
        let MediumDesc { absorption, priority } = medium.unwrap_or_default();
        let number = |value: f32, default: f32| unless(single(value), single(default));
        let flag = |value: bool, default: bool| (value != default).then_some(value);
        keys!(Self, tags::Principled::Principled, shared, {
            base_weight: number(it.base_weight, default.base_weight),
            base_color: unless_color(it.base_color, default.base_color),
            base_diffuse_roughness: number(it.base_diffuse_roughness, default.base_diffuse_roughness),
            base_metalness: number(it.base_metalness, default.base_metalness),
            specular_weight: number(it.specular_weight, default.specular_weight),
            specular_color: unless_color(it.specular_color, default.specular_color),
            specular_roughness: number(it.specular_roughness, default.specular_roughness),
            specular_roughness_anisotropy: number(it.specular_roughness_anisotropy, default.specular_roughness_anisotropy),
            specular_rotation: unless(degrees(it.specular_rotation), 0.0),
            specular_ior: number(it.specular_ior, default.specular_ior),
            transmission_weight: number(it.transmission_weight, default.transmission_weight),
            transmission_color: unless_color(it.transmission_color, default.transmission_color),
            transmission_depth: number(it.transmission_depth, default.transmission_depth),
            coat_weight: number(it.coat_weight, default.coat_weight),
            coat_color: unless_color(it.coat_color, default.coat_color),
            coat_roughness: number(it.coat_roughness, default.coat_roughness),
            coat_roughness_anisotropy: number(it.coat_roughness_anisotropy, default.coat_roughness_anisotropy),
            coat_ior: number(it.coat_ior, default.coat_ior),
            coat_darkening: number(it.coat_darkening, default.coat_darkening),
            fuzz_weight: number(it.fuzz_weight, default.fuzz_weight),
            fuzz_color: unless_color(it.fuzz_color, default.fuzz_color),
            fuzz_roughness: number(it.fuzz_roughness, default.fuzz_roughness),
            thin_walled: flag(it.thin_walled, default.thin_walled),
            priority: (priority > 0).then_some(Whole(priority.into())),
            absorption: unless_color(absorption, Rgb::ZERO),
            multiple_scattering: flag(it.multiple_scattering, default.multiple_scattering),
        })
    }
}

impl Kind for Principled {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let default = PrincipledDesc::default();
        let number = |key: &str, value: Option<f64>, default: f32| match value {
            Some(value) => validate::number(&join(path, key), value).map(|value| value as f32),
            None => Ok(default),
        };
        let color = |key: &str, value: Option<[f64; 3]>, default: Rgb| match value {
            Some(value) => validate::reflectance(&join(path, key), value),
            None => Ok(default),
        };
        let degrees = self.specular_rotation.unwrap_or(0.0);
        let rotation = validate::number(&join(path, "specular_rotation"), degrees)?.to_radians() as f32;
        let desc = PrincipledDesc {
            base_weight: number("base_weight", self.base_weight, default.base_weight)?,
            base_color: color("base_color", self.base_color, default.base_color)?,
            base_diffuse_roughness: number("base_diffuse_roughness", self.base_diffuse_roughness, 0.0)?,
            base_metalness: number("base_metalness", self.base_metalness, default.base_metalness)?,
            specular_weight: number("specular_weight", self.specular_weight, default.specular_weight)?,
            specular_color: color("specular_color", self.specular_color, default.specular_color)?,
            specular_roughness: number("specular_roughness", self.specular_roughness, default.specular_roughness)?,
            specular_roughness_anisotropy: number(
                "specular_roughness_anisotropy",
                self.specular_roughness_anisotropy,
                0.0,
            )?,
            specular_rotation: rotation,
            specular_ior: number("specular_ior", self.specular_ior, default.specular_ior)?,
            transmission_weight: number("transmission_weight", self.transmission_weight, default.transmission_weight)?,
            transmission_color: color("transmission_color", self.transmission_color, default.transmission_color)?,
            transmission_depth: number("transmission_depth", self.transmission_depth, default.transmission_depth)?,
            coat_weight: number("coat_weight", self.coat_weight, default.coat_weight)?,
            coat_color: color("coat_color", self.coat_color, default.coat_color)?,
            coat_roughness: number("coat_roughness", self.coat_roughness, default.coat_roughness)?,
            coat_roughness_anisotropy: number("coat_roughness_anisotropy", self.coat_roughness_anisotropy, 0.0)?,
            coat_ior: number("coat_ior", self.coat_ior, default.coat_ior)?,
            coat_darkening: number("coat_darkening", self.coat_darkening, default.coat_darkening)?,
            fuzz_weight: number("fuzz_weight", self.fuzz_weight, default.fuzz_weight)?,
            fuzz_color: color("fuzz_color", self.fuzz_color, default.fuzz_color)?,
            fuzz_roughness: number("fuzz_roughness", self.fuzz_roughness, default.fuzz_roughness)?,
            thin_walled: self.thin_walled.unwrap_or(default.thin_walled),
            multiple_scattering: self.multiple_scattering.unwrap_or(default.multiple_scattering),
        };
        Ok(BsdfDesc::Principled(desc))
    }

    fn medium(&self, path: &str) -> Result<Option<MediumDesc>> {
        let priority = match self.priority {
            Some(priority) => validate::whole(&join(path, "priority"), priority, 0, u32::MAX.into())?,
            None => 0,
        };
        let absorption = match self.absorption {
            Some(absorption) => validate::absorption(&join(path, "absorption"), absorption)?,
            None => Rgb::ZERO,
        };
        let medium = MediumDesc { absorption, priority };
        Ok((medium != MediumDesc::default()).then_some(medium))
    }
}
