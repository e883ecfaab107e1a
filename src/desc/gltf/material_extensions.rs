//! The extensions of materials, as they are written.

use serde::Deserialize;

use super::super::json;
use super::document::{Extensions, TextureInfo};
use crate::Result;

/// An extension of materials.
pub(super) trait Extension<'a>: Deserialize<'a> + Default {
    /// Its name.
    const NAME: &'static str;
}

/// The path of an extension below that of its material, and its keys; `None` where the material does not have it.
pub(super) fn read<'a, E: Extension<'a>>(path: &str, extensions: &Extensions<'a>) -> Result<Option<(String, E)>> {
    let Some(raw) = extensions.get(E::NAME).copied() else { return Ok(None) };
    let path = format!("{path}.extensions.{}", E::NAME);
    let read = json::object(raw, &path)?;
    Ok(Some((path, read)))
}

/// Declares the keys of extensions: numbers, then textures.
macro_rules! extensions {
    ($($(#[$meta:meta])* $name:ident = $key:literal {
        $($number:ident: $type:ty,)* ; $($texture:ident,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Debug, Default, Deserialize)]
        #[serde(rename_all = "camelCase")]
        pub(super) struct $name<'a> {
            $(pub $number: Option<$type>,)*
            $(#[serde(borrow)] pub $texture: Option<TextureInfo<'a>>,)*
            #[serde(skip)]
            _document: std::marker::PhantomData<&'a str>,
        }

        impl<'a> Extension<'a> for $name<'a> {
            const NAME: &'static str = $key;
        }
    )*};
}

extensions! {
    /// Highlights that are longer in one direction.
    Anisotropy = "KHR_materials_anisotropy" {
        anisotropy_strength: f64,
        anisotropy_rotation: f64,
        ;
        anisotropy_texture,
    }
    /// A clear coat.
    Clearcoat = "KHR_materials_clearcoat" {
        clearcoat_factor: f64,
        clearcoat_roughness_factor: f64,
        ;
        clearcoat_texture,
        clearcoat_roughness_texture,
        clearcoat_normal_texture,
    }
    /// Light that passes a thin sheet diffusely.
    DiffuseTransmission = "KHR_materials_diffuse_transmission" {
        diffuse_transmission_factor: f64,
        diffuse_transmission_color_factor: [f64; 3],
        ;
        diffuse_transmission_texture,
        diffuse_transmission_color_texture,
    }
    /// A factor on what is emitted.
    EmissiveStrength = "KHR_materials_emissive_strength" {
        emissive_strength: f64,
        ;
    }
    /// The index of refraction.
    Ior = "KHR_materials_ior" {
        ior: f64,
        ;
    }
    /// The older parameters of reflection.
    SpecularGlossiness = "KHR_materials_pbrSpecularGlossiness" {
        diffuse_factor: [f64; 4],
        specular_factor: [f64; 3],
        glossiness_factor: f64,
        ;
        diffuse_texture,
        specular_glossiness_texture,
    }
    /// Fibres that stand up from the surface.
    Sheen = "KHR_materials_sheen" {
        sheen_color_factor: [f64; 3],
        sheen_roughness_factor: f64,
        ;
        sheen_color_texture,
        sheen_roughness_texture,
    }
    /// Strength and colour of the reflection of what is no metal.
    Specular = "KHR_materials_specular" {
        specular_factor: f64,
        specular_color_factor: [f64; 3],
        ;
        specular_texture,
        specular_color_texture,
    }
    /// Light that passes the surface.
    Transmission = "KHR_materials_transmission" {
        transmission_factor: f64,
        ;
        transmission_texture,
    }
    /// What is inside of the surface.
    Volume = "KHR_materials_volume" {
        thickness_factor: f64,
        attenuation_distance: f64,
        attenuation_color: [f64; 3],
        ;
        thickness_texture,
    }
}
