//! Descriptions of materials.

use crate::spectrum::Rgb;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// The material's name.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// The scattering model and its parameters.
    pub bsdf: BsdfDesc,
    /// The survival probability of Russian roulette at this material in (0, 1], where the scene states one (the
    /// report's `reflectionRate`). Paths use it only with [`super::RouletteDesc::File`]. It changes noise and time, never the
    /// image.
    pub survival: Option<f32>,
}

/// A scattering model and its parameters. Reflectances are in [0, 1] per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfDesc {
    /// A surface that absorbs all light.
    Black,
    /// Lambert's model.
    Lambert {
        /// Albedo.
        albedo: Rgb,
    },
    /// Oren and Nayar's qualitative model (the report's equations 2 and 3).
    OrenNayarQualitative {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Standard deviation of the facets' slope angle, radians, >= 0.
        sigma: f32,
    },
    /// Fujii's improved Oren-Nayar model.
    OrenNayar {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Fujii's roughness sigma' in [0, 1], which is not an angle.
        roughness: f32,
    },
    /// Perfect mirror.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
    },
    /// A smooth dielectric, which reflects by Fresnel's equations and refracts by Snell's law.
    Dielectric {
        /// Index of refraction on the side opposite to the normal, > 0.
        ior: f32,
        /// Index of refraction on the normal's side, > 0; 1 unless the object is inside another dielectric.
        exterior_ior: f32,
    },
}
