//! Reads the native scene format, `"etendue": 1`: its top level, camera, lights and materials.
//!
//! `docs/scene-format.md` describes every key. The reader first reads the tag (`type`, `geometry`) of each element and
//! then the element itself, into a plain structure that refuses unknown keys, so every error has an exact path.

use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::{
    BsdfDesc, CameraDesc, Dialect, FovAxis, MaterialDesc, RenderDesc, SceneDesc, render_keys, surface, validate,
};
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
    materials: Option<&'a RawValue>,
    #[serde(borrow)]
    meshes: Option<&'a RawValue>,
    #[serde(borrow)]
    surfaces: Option<&'a RawValue>,
}

/// Which kind of camera; a pinhole unless it says otherwise.
#[derive(Clone, Copy, Default, Deserialize)]
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
#[derive(Clone, Copy, Default, Deserialize, PartialEq, Eq)]
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
#[derive(Deserialize)]
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

/// A light that shines from a point, the same in all directions.
#[derive(Deserialize)]
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

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum PointTag {
    Point,
}

/// A triangle that shines on the side of (v2 - v1) x (v3 - v1) and reflects nothing.
#[derive(Deserialize)]
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

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum AreaTag {
    Area,
}

/// How a diffuse surface scatters.
#[derive(Clone, Copy, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Brdf {
    /// The same radiance in all directions.
    #[default]
    Lambertian,
    /// Fujii's improved Oren-Nayar model, by `roughness`.
    OrenNayar,
    /// Oren and Nayar's qualitative model, by `sigmaDeg`.
    OrenNayarQualitative,
}

/// Scatters light in all directions.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Diffuse {
    name: String,
    #[serde(rename = "type")]
    _type: DiffuseTag,
    /// Albedo, [0, 1] per channel.
    color: [f64; 3],
    /// `lambertian` (default), `oren-nayar` or `oren-nayar-qualitative`.
    #[serde(default, deserialize_with = "json::name")]
    brdf: Option<Brdf>,
    /// For `oren-nayar`: Fujii's sigma', in [0, 1].
    roughness: Option<f64>,
    /// For `oren-nayar-qualitative`: standard deviation of the facets' slope angle, degrees, in [0, 90].
    sigma_deg: Option<f64>,
    /// Russian roulette's survival probability, above 0 and up to 1, for renders with `"roulette": "file"`. Changes noise and
    /// time, never the image.
    reflection_rate: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum DiffuseTag {
    Diffuse,
}

/// A perfect mirror.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Reflective {
    name: String,
    #[serde(rename = "type")]
    _type: ReflectiveTag,
    /// Reflectance, [0, 1] per channel. Default [1, 1, 1].
    color: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ReflectiveTag {
    Reflective,
}

/// Smooth clear glass, water and the like.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Refractive {
    name: String,
    #[serde(rename = "type")]
    _type: RefractiveTag,
    /// Index of refraction inside, > 0.
    refraction_index: f64,
    /// Index of refraction outside, > 0. Default 1.
    exterior_index: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum RefractiveTag {
    Refractive,
}

/// Absorbs everything.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Black {
    name: String,
    #[serde(rename = "type")]
    _type: BlackTag,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum BlackTag {
    Black,
}

/// Reads a native scene that has been split at its top.
pub(super) fn read(document: &RawValue, base_dir: &Path, file: Option<&Path>) -> Result<SceneDesc> {
    let top: Top<'_> = json::object(document, "")?;
    let mut builder = Builder::new(Dialect::Native, base_dir, file);
    builder.scene.camera = camera(top.camera, "camera")?;
    if let Some(raw) = top.render {
        builder.scene.render = render_keys::read(raw, "render", &RenderDesc::default())?;
    }
    json::each(top.materials, "materials", |path, raw| material(raw, path, &mut builder))?;
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

fn light(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    if json::tag(raw, path, "type", &["point", "area"])? == "point" {
        let light: PointLight = json::object(raw, path)?;
        let factor = light.intensity.unwrap_or(1.0);
        builder.scene.lights.push(validate::point_light(path, light.origin, light.color, factor)?);
        return Ok(());
    }
    let light: AreaLight = json::object(raw, path)?;
    let factor = light.intensity.unwrap_or(1.0);
    let vertices = [light.vertex_1, light.vertex_2, light.vertex_3].map(DVec3::from_array);
    builder.add_area_light(path, vertices, light.color, factor)
}

fn material(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let kind = json::tag(raw, path, "type", &["diffuse", "reflective", "refractive", "black"])?;
    let (name, bsdf, survival) = match kind.as_str() {
        "diffuse" => diffuse(json::object(raw, path)?, path)?,
        "reflective" => {
            let mirror: Reflective = json::object(raw, path)?;
            let reflectance = validate::reflectance(&at("color"), mirror.color.unwrap_or([1.0; 3]))?;
            (mirror.name, BsdfDesc::Mirror { reflectance }, None)
        }
        "refractive" => {
            let glass: Refractive = json::object(raw, path)?;
            let ior = validate::positive(&at("refractionIndex"), glass.refraction_index)? as f32;
            let outside = glass.exterior_index.unwrap_or(1.0);
            let exterior_ior = validate::positive(&at("exteriorIndex"), outside)? as f32;
            (glass.name, BsdfDesc::Dielectric { ior, exterior_ior }, None)
        }
        _ => (json::object::<Black>(raw, path)?.name, BsdfDesc::Black, None),
    };
    builder.scene.put_material(MaterialDesc { name, path: path.to_owned(), bsdf, survival }).map(|_| ())
}

fn diffuse(diffuse: Diffuse, path: &str) -> Result<(String, BsdfDesc, Option<f32>)> {
    let at = |key: &str| join(path, key);
    let albedo = validate::reflectance(&at("color"), diffuse.color)?;
    let brdf = diffuse.brdf.unwrap_or_default();
    // A parameter of another model is an error, because the author was mistaken about which model is used.
    let misplaced = match brdf {
        Brdf::Lambertian => [("roughness", diffuse.roughness), ("sigmaDeg", diffuse.sigma_deg)],
        Brdf::OrenNayar => [("sigmaDeg", diffuse.sigma_deg), ("", None)],
        Brdf::OrenNayarQualitative => [("roughness", diffuse.roughness), ("", None)],
    };
    if let Some((key, _)) = misplaced.into_iter().find(|(_, value)| value.is_some()) {
        let owner = if key == "roughness" { "oren-nayar" } else { "oren-nayar-qualitative" };
        return Err(Error::invalid(at(key), format!("only a material with brdf '{owner}' has this key")));
    }
    let needed = |key: &str, value: Option<f64>| {
        value.ok_or_else(|| Error::invalid(path, format!("missing key `{key}`, which this brdf needs")))
    };
    let bsdf = match brdf {
        Brdf::Lambertian => BsdfDesc::Lambert { albedo },
        Brdf::OrenNayar => {
            let roughness = needed("roughness", diffuse.roughness)?;
            BsdfDesc::OrenNayar { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
        }
        Brdf::OrenNayarQualitative => {
            let degrees = needed("sigmaDeg", diffuse.sigma_deg)?;
            validate::within(&at("sigmaDeg"), degrees, 0.0, 90.0)?;
            BsdfDesc::OrenNayarQualitative { albedo, sigma: degrees.to_radians() as f32 }
        }
    };
    let survival = match diffuse.reflection_rate {
        None => None,
        Some(rate) => Some(validate::survival_rate(&at("reflectionRate"), rate)?),
    };
    Ok((diffuse.name, bsdf, survival))
}
