//! Reads the native scene format, `"etendue": 1`: its top level, camera and lights. Writes camera and lights.
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
    CameraDesc, Dialect, EnvironmentDesc, EnvironmentMapDesc, FovAxis, RenderDesc, SceneDesc, SkyProjection,
    light_keys, material_keys, numbers, render_keys, save, surface, texture_check, texture_keys, validate,
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

/// Which kind of camera; a pinhole unless it says otherwise.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum CameraType {
    /// A pinhole at `origin`.
    #[default]
    Perspective,
    /// The report's camera: `origin` is the centre of the view plane, the eye is behind it.
    ViewPlane,
}

/// The side of the image that `fieldOfView` spans.
#[derive(Clone, Copy, Default, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Axis {
    /// The width.
    #[default]
    Horizontal,
    /// The height.
    Vertical,
}

/// Where the scene is seen from.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Camera {
    /// `perspective` (default) or `view-plane`.
    #[serde(default, deserialize_with = "json::name")]
    r#type: Option<CameraType>,
    /// The eye; with `view-plane` the centre of the view plane. Default [0, 0, 0].
    origin: Option<[f64; 3]>,
    /// A point in the middle of the image. Default [0, 0, -1].
    look_at: Option<[f64; 3]>,
    /// Upwards in the image. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// Full angle of view across `fieldOfViewAxis`, degrees, between 0 and 180. Default 90.
    field_of_view: Option<f64>,
    /// `horizontal` (default) or `vertical`.
    #[serde(default, deserialize_with = "json::name")]
    field_of_view_axis: Option<Axis>,
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
    builder.scene.camera = camera(top.camera, "camera")?;
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

fn camera(raw: &RawValue, path: &str) -> Result<CameraDesc> {
    let camera: Camera = json::object(raw, path)?;
    let centre = DVec3::from_array(camera.origin.unwrap_or_default());
    let look_at = camera.look_at.map_or(DVec3::NEG_Z, DVec3::from_array);
    let up = camera.up.map_or(DVec3::Y, DVec3::from_array);
    let fov_deg = camera.field_of_view.unwrap_or(90.0);
    let fov_axis = match camera.field_of_view_axis.unwrap_or_default() {
        Axis::Horizontal => FovAxis::Horizontal,
        Axis::Vertical => FovAxis::Vertical,
    };
    match camera.r#type.unwrap_or_default() {
        CameraType::Perspective => {
            validate::camera(path, CameraDesc::Perspective { eye: centre, look_at, up, fov_deg, fov_axis })
        }
        CameraType::ViewPlane => {
            let camera = validate::camera(path, CameraDesc::ViewPlane { centre, look_at, up, fov_deg })?;
            if fov_axis == FovAxis::Vertical {
                let message = "a view-plane camera's field of view is horizontal";
                return Err(Error::invalid(join(path, "fieldOfViewAxis"), message));
            }
            Ok(camera)
        }
    }
}

/// Writes a camera, whose numbers have been checked.
pub(super) fn write_camera(camera: &CameraDesc) -> Result<Box<RawValue>> {
    let (kind, origin, look_at, up, fov_deg, fov_axis) = match *camera {
        CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis } => {
            (CameraType::Perspective, eye, look_at, up, fov_deg, fov_axis)
        }
        CameraDesc::ViewPlane { centre, look_at, up, fov_deg } => {
            (CameraType::ViewPlane, centre, look_at, up, fov_deg, FovAxis::Horizontal)
        }
    };
    save::raw(&Camera {
        r#type: Some(kind),
        origin: Some(origin.to_array()),
        look_at: Some(look_at.to_array()),
        up: Some(up.to_array()),
        field_of_view: Some(fov_deg),
        field_of_view_axis: (fov_axis == FovAxis::Vertical).then_some(Axis::Vertical),
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
    match json::tag(raw, path, "type", &["point", "area", "environment", "spot", "web"])?.as_str() {
        "point" => {
            builder.scene.lights.push(light_keys::point(raw, path)?);
            Ok(())
        }
        "spot" => {
            builder.scene.lights.push(light_keys::spot(raw, path)?);
            Ok(())
        }
        "web" => {
            let light = light_keys::web(raw, path, builder)?;
            builder.scene.lights.push(light);
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
