//! Reads the native scene format, `"etendue": 1`: its top level and lights. Writes lights.
//!
//! `docs/scene-format.md` describes every key. The reader first reads the tag (`type`, `geometry`) of each element and
//! then the element itself, into a plain structure that refuses unknown keys, so every error has an exact path.

use std::path::Path;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::numbers::unless;
use super::save::Names;
use super::{
    Dialect, EnvironmentDesc, EnvironmentMapDesc, PointLightDesc, RenderDesc, SceneDesc, SkyProjection, camera_keys,
    material_keys, numbers, render_keys, save, surface, texture_check, texture_keys, validate,
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
    textures: Option<&'a RawValue>,
    #[serde(borrow)]
    materials: Option<&'a RawValue>,
    #[serde(borrow)]
    meshes: Option<&'a RawValue>,
    #[serde(borrow)]
    surfaces: Option<&'a RawValue>,
}

/// A light that shines from a point, the same in all directions.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct PointLight {
    #[serde(rename = "type")]
    _type: PointTag,
    /// Position.
    origin: [f64; 3],
    /// Times `intensity`: radiant intensity, W/sr per channel.
    color: [f64; 3],
    /// Factor on `color`. Default 1.
    intensity: Option<f64>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum PointTag {
    Point,
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
    /// Times `intensity`: radiance, W/(m^2 sr) per channel.
    color: [f64; 3],
    /// Factor on `color`. Default 1.
    intensity: Option<f64>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum AreaTag {
    Area,
}

/// Light from infinity, the same from all directions or by a texture. A scene has one environment at most.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Environment {
    #[serde(rename = "type")]
    _type: EnvironmentTag,
    /// Times `intensity`: radiance, W/(m^2 sr) per channel; with a texture a factor on it. Required without a texture. Default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`. Default 1.
    intensity: Option<f64>,
    /// Name of a texture over longitude and latitude, which varies the radiance.
    texture: Option<String>,
    /// With a texture: how the directions lie in its image. Default "latlong".
    projection: Option<ProjectionTag>,
    /// With a texture: the direction that is up in it. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// With a texture: degrees by which it is turned about `up`, counter-clockwise as seen from above. Default 0.
    rotation: Option<f64>,
    /// Whether camera rays that meet nothing show it. Default true.
    visible: Option<bool>,
}

/// How the directions of a sky lie in an image.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "lowercase")]
enum ProjectionTag {
    /// By longitude and latitude.
    LatLong,
    /// The unfolded faces of an octahedron.
    Octahedral,
    /// The six faces of a cube, one under another.
    Cube,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum EnvironmentTag {
    Environment,
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
    builder.scene.camera = camera_keys::read(top.camera, "camera")?;
    if let Some(raw) = top.render {
        builder.scene.render = render_keys::read(raw, "render", &RenderDesc::default())?;
    }
    builder.read_ahead(&texture_keys::image_files(top.textures))?;
    json::each(top.textures, "textures", |path, raw| texture_keys::read(raw, path, &mut builder))?;
    json::each(top.materials, "materials", |path, raw| material_keys::read(raw, path, &mut builder))?;
    json::each(top.meshes, "meshes", |path, raw| surface::shared_mesh(raw, path, &mut builder))?;
    json::each(top.lights, "lights", |path, raw| light(raw, path, &mut builder))?;
    json::each(top.surfaces, "surfaces", |path, raw| surface::read(raw, path, &mut builder))?;
    Ok(builder.scene)
}

/// Writes a point light, whose numbers have been checked.
pub(super) fn write_point_light(light: &PointLightDesc) -> Result<Box<RawValue>> {
    save::raw(&PointLight {
        _type: PointTag::Point,
        origin: light.position.to_array(),
        color: numbers::color(light.intensity),
        intensity: None,
    })
}

/// Writes an environment, whose numbers have been checked.
pub(super) fn write_environment(environment: &EnvironmentDesc, names: &Names) -> Result<Box<RawValue>> {
    let map = environment.map.as_ref();
    save::raw(&Environment {
        _type: EnvironmentTag::Environment,
        color: Some(numbers::color(environment.radiance)),
        intensity: None,
        texture: map.map(|map| names.textures[map.texture].clone()),
        projection: map.and_then(|map| match map.projection {
            SkyProjection::LatLong => None,
            SkyProjection::Octahedral => Some(ProjectionTag::Octahedral),
            SkyProjection::Cube => Some(ProjectionTag::Cube),
        }),
        up: map.filter(|map| map.up != DVec3::Y).map(|map| map.up.to_array()),
        rotation: map.and_then(|map| unless(map.rotation_deg, 0.0)),
        visible: (!environment.visible).then_some(false),
    })
}

fn environment(light: Environment, path: &str, builder: &Builder<'_>) -> Result<EnvironmentDesc> {
    let color = match (light.color, &light.texture) {
        (Some(color), _) => color,
        (None, Some(_)) => [1.0; 3],
        (None, None) => return Err(Error::invalid(path, "missing key `color`, or `texture`")),
    };
    let even = validate::environment(path, color, light.intensity.unwrap_or(1.0))?;
    let map = match light.texture {
        Some(name) => {
            let texture = builder.texture(&join(path, "texture"), &name)?;
            let up = light.up.map_or(DVec3::Y, DVec3::from_array);
            let projection = match light.projection {
                None | Some(ProjectionTag::LatLong) => SkyProjection::LatLong,
                Some(ProjectionTag::Octahedral) => SkyProjection::Octahedral,
                Some(ProjectionTag::Cube) => SkyProjection::Cube,
            };
            Some(EnvironmentMapDesc { texture, projection, up, rotation_deg: light.rotation.unwrap_or(0.0) })
        }
        None => {
            let directed = [
                ("up", light.up.is_some()),
                ("rotation", light.rotation.is_some()),
                ("projection", light.projection.is_some()),
            ];
            if let Some((key, _)) = directed.into_iter().find(|(_, given)| *given) {
                let message = "an even sky looks the same from all sides, expected a `texture` with it";
                return Err(Error::invalid(join(path, key), message));
            }
            None
        }
    };
    let environment = EnvironmentDesc { map, visible: light.visible.unwrap_or(true), ..even };
    texture_check::environment(&environment, &builder.scene.textures)?;
    Ok(environment)
}

fn light(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    match json::tag(raw, path, "type", &["point", "area", "environment"])?.as_str() {
        "point" => {
            let light: PointLight = json::object(raw, path)?;
            let factor = light.intensity.unwrap_or(1.0);
            builder.scene.lights.push(validate::point_light(path, light.origin, light.color, factor)?);
            Ok(())
        }
        "area" => {
            let light: AreaLight = json::object(raw, path)?;
            let factor = light.intensity.unwrap_or(1.0);
            let vertices = [light.vertex_1, light.vertex_2, light.vertex_3].map(DVec3::from_array);
            builder.add_area_light(path, vertices, light.color, factor)
        }
        _ => {
            let light: Environment = json::object(raw, path)?;
            if let Some(first) = &builder.scene.environment {
                let message = format!("{} is an environment already, expected one at most", first.path);
                return Err(Error::invalid(path, message));
            }
            builder.scene.environment = Some(environment(light, path, builder)?);
            Ok(())
        }
    }
}
