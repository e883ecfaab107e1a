//! Reads the native scene format, `"etendue": 1`: its top level and lights.
//!
//! `docs/scene-format.md` describes every key. The reader first reads the tag (`type`, `geometry`) of each element and
//! then the element itself, into a plain structure that refuses unknown keys, so every error has an exact path.

use std::f64::consts::PI;
use std::path::Path;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::photometric::{LightKeys, Unit};
use super::{
    Dialect, RenderDesc, SceneDesc, backplate_keys, camera_keys, group_keys, json, light_keys, material_keys,
    render_keys, sky_keys, spectrum_keys, surface, texture_keys,
};
use crate::control::WorkProgress;
use crate::math::DVec3;
use crate::{Error, Result};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Top<'a> {
    #[serde(rename = "etendue")]
    _etendue: IgnoredAny,
    #[serde(rename = "$schema")]
    _schema: Option<String>,
    #[serde(rename = "description")]
    _description: Option<String>,
    #[serde(borrow)]
    camera: &'a RawValue,
    #[serde(borrow)]
    render: Option<&'a RawValue>,
    #[serde(borrow)]
    lights: Option<&'a RawValue>,
    #[serde(borrow)]
    backplate: Option<&'a RawValue>,
    #[serde(borrow)]
    textures: Option<&'a RawValue>,
    #[serde(borrow)]
    materials: Option<&'a RawValue>,
    #[serde(borrow)]
    meshes: Option<&'a RawValue>,
    #[serde(borrow)]
    groups: Option<&'a RawValue>,
    #[serde(borrow)]
    surfaces: Option<&'a RawValue>,
}

/// A triangle that shines on the side of (v2 - v1) x (v3 - v1) and reflects nothing.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct AreaLight {
    #[serde(rename = "type")]
    _type: AreaTag,
    /// First corner.
    #[serde(rename = "vertex-1")]
    vertex_1: [f64; 3],
    /// Second corner.
    #[serde(rename = "vertex-2")]
    vertex_2: [f64; 3],
    /// Third corner.
    #[serde(rename = "vertex-3")]
    vertex_3: [f64; 3],
    /// Times `intensity`: radiance, W/(m^2 sr) per channel. Required, or `temperature`, or a `unit`.
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", "cd/m2", or "lm" of the triangle. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: radiance, W/(m^2 sr nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum AreaTag {
    Area,
}

/// Reads a native scene that has been split at its top.
pub(super) fn read(
    document: &RawValue,
    base_dir: &Path,
    file: Option<&Path>,
    work: &WorkProgress<'static>,
) -> Result<SceneDesc> {
    let top: Top<'_> = json::object(document, "")?;
    let mut builder = Builder::new(Dialect::Native, base_dir, file, work);
    camera_keys::read(top.camera, "camera", &mut builder.scene)?;
    if let Some(raw) = top.render {
        builder.scene.render = render_keys::read(raw, "render", &RenderDesc::default())?;
    }
    builder.read_ahead(&texture_keys::image_files(top.textures))?;
    json::each(top.textures, "textures", |path, raw| texture_keys::read(raw, path, &mut builder))?;
    json::each(top.materials, "materials", |path, raw| material_keys::read(raw, path, &mut builder))?;
    json::each(top.meshes, "meshes", |path, raw| surface::shared_mesh(raw, path, &mut builder))?;
    json::each(top.groups, "groups", |path, raw| group_keys::read(raw, path, &mut builder))?;
    if let Some(raw) = top.backplate {
        builder.scene.backplate = Some(backplate_keys::read(raw, &builder)?);
    }
    json::each(top.lights, "lights", |path, raw| light(raw, path, &mut builder))?;
    json::each(top.surfaces, "surfaces", |path, raw| surface::read(raw, path, &mut builder))?;
    Ok(builder.scene)
}

fn light(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    match json::tag(raw, path, "type", &["point", "area", "distant", "environment", "sky", "spot", "web"])?.as_str() {
        "point" => {
            let light = light_keys::point(raw, path, builder)?;
            light_keys::put(&mut builder.scene, path, light)
        }
        "spot" => {
            let light = light_keys::spot(raw, path, builder)?;
            light_keys::put(&mut builder.scene, path, light)
        }
        "web" => {
            let light = light_keys::web(raw, path, builder)?;
            light_keys::put(&mut builder.scene, path, light)
        }
        "area" => {
            let light: AreaLight = json::object(raw, path)?;
            let vertices = [light.vertex_1, light.vertex_2, light.vertex_3].map(DVec3::from_array);
            let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
            let AreaLight { color, intensity, temperature, unit, .. } = light;
            let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
            // A triangle without an area is refused as such.
            let [a, b, c] = vertices;
            let area = 0.5 * (b - a).cross(c - a).length();
            let per_luminance = if area > 0.0 && area.is_finite() { PI * area } else { 1.0 };
            let light = keys.resolve(path, None, &[(Unit::CandelaPerArea, 1.0), (Unit::Lumen, per_luminance)])?;
            builder.add_area_light(path, vertices, light, spectrum)
        }
        "distant" => {
            let light = sky_keys::distant(json::object(raw, path)?, path, builder)?;
            builder.scene.distant_lights.push(light);
            Ok(())
        }
        kind => {
            if let Some(first) = &builder.scene.environment {
                let message = format!("{} is an environment already, expected one at most", first.path);
                return Err(Error::invalid(path, message));
            }
            builder.scene.environment = Some(match kind {
                "sky" => sky_keys::sky(json::object(raw, path)?, path)?,
                _ => sky_keys::environment(json::object(raw, path)?, path, builder)?,
            });
            Ok(())
        }
    }
}
