//! Reads scene files of the report's renderer, `mcrt`, as descriptions whose image is physically correct.
//!
//! Albedo and mirror reflectance are given by `color`, and glass is clear. An area light is a triangle that reflects
//! nothing and emits radiance color * intensity on the side of (v2 - v1) x (v3 - v1). A point light has radiant
//! intensity color * intensity. `reflectionRate` is a survival probability, which only renders with the file's roulette
//! use and which does not change the image. Meshes are shaded flat. Keys without a meaning are skipped with a warning,
//! where `mcrt` skips them silently.

use std::path::Path;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, Scale, did_you_mean, join};
use super::{
    BsdfDesc, CameraDesc, Dialect, MaterialDesc, SceneDesc, ShapeDesc, SurfaceLook, camera_check, transform, validate,
};
use crate::control::WorkProgress;
use crate::math::DVec3;
use crate::{Error, Result};

#[derive(Deserialize)]
struct Top<'a> {
    #[serde(borrow)]
    camera: &'a RawValue,
    #[serde(borrow)]
    lights: Option<&'a RawValue>,
    #[serde(borrow)]
    materials: Option<&'a RawValue>,
    #[serde(borrow)]
    surfaces: Option<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Camera {
    origin: Option<[f64; 3]>,
    look_at: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
    field_of_view: Option<f64>,
}

#[derive(Deserialize)]
struct PointLight {
    #[serde(rename = "type")]
    _type: String,
    origin: [f64; 3],
    color: [f64; 3],
    intensity: f64,
}

#[derive(Deserialize)]
struct AreaLight {
    #[serde(rename = "type")]
    _type: String,
    #[serde(rename = "vertex-1")]
    vertex_1: [f64; 3],
    #[serde(rename = "vertex-2")]
    vertex_2: [f64; 3],
    #[serde(rename = "vertex-3")]
    vertex_3: [f64; 3],
    color: [f64; 3],
    intensity: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Material {
    name: String,
    #[serde(rename = "type")]
    _type: String,
    color: [f64; 3],
    brdf: Option<String>,
    refraction_index: Option<f64>,
    reflection_rate: Option<f64>,
    roughness: Option<f64>,
}

#[derive(Deserialize)]
struct Sphere {
    #[serde(rename = "geometry")]
    _geometry: String,
    origin: [f64; 3],
    radius: f64,
    material: String,
}

#[derive(Deserialize)]
struct Triangle {
    #[serde(rename = "geometry")]
    _geometry: String,
    #[serde(rename = "vertex-1")]
    vertex_1: [f64; 3],
    #[serde(rename = "vertex-2")]
    vertex_2: [f64; 3],
    #[serde(rename = "vertex-3")]
    vertex_3: [f64; 3],
    material: String,
}

#[derive(Deserialize)]
struct Mesh {
    #[serde(rename = "geometry")]
    _geometry: String,
    file: String,
    origin: [f64; 3],
    scale: Option<f64>,
    rotate: Option<[f64; 3]>,
    material: String,
}

/// Reads a scene of the report's renderer that has already been split at its outermost object.
pub(super) fn read(
    document: &RawValue,
    base_dir: &Path,
    file: Option<&Path>,
    work: &WorkProgress<'static>,
) -> Result<SceneDesc> {
    let mut builder = Builder::new(Dialect::Mcrt, base_dir, file, work);
    let top: Top<'_> = object(document, "", &mut builder)?;
    builder.scene.camera = camera(top.camera, "camera", &mut builder)?;
    json::each(top.materials, "materials", |path, raw| material(raw, path, &mut builder))?;
    json::each(top.lights, "lights", |path, raw| light(raw, path, &mut builder))?;
    json::each(top.surfaces, "surfaces", |path, raw| surface(raw, path, &mut builder))?;
    Ok(builder.scene)
}

/// Reads an object. Keys without a meaning become warnings.
fn object<'a, T: Deserialize<'a>>(raw: &'a RawValue, path: &str, builder: &mut Builder<'_>) -> Result<T> {
    json::object_lenient(raw, path, |key| builder.warn(&join(path, &json::elided(&key)), "unknown key, ignored"))
}

fn camera(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<CameraDesc> {
    let camera: Camera = object(raw, path, builder)?;
    let centre = DVec3::from_array(camera.origin.unwrap_or_default());
    let look_at = camera.look_at.map_or(DVec3::NEG_Z, DVec3::from_array);
    let up = camera.up.map_or(DVec3::Y, DVec3::from_array);
    let fov_deg = camera.field_of_view.unwrap_or(90.0);
    camera_check::camera(path, CameraDesc::ViewPlane { centre, look_at, up, fov_deg })
}

fn light(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    if json::tag(raw, path, "type", &["point", "area"])? == "point" {
        let light: PointLight = object(raw, path, builder)?;
        builder.scene.lights.push(validate::point_light(path, light.origin, light.color, light.intensity)?);
        return Ok(());
    }
    let light: AreaLight = object(raw, path, builder)?;
    let vertices = [light.vertex_1, light.vertex_2, light.vertex_3].map(DVec3::from_array);
    builder.add_area_light(path, vertices, (light.color, light.intensity), None)
}

fn material(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let missing = |key: &str| Error::invalid(path, format!("missing key `{key}`"));
    let kind = json::tag(raw, path, "type", &["diffuse", "reflective", "refractive"])?;
    let material: Material = object(raw, path, builder)?;
    let mut survival = None;
    let bsdf = match kind.as_str() {
        "diffuse" => {
            match material.reflection_rate {
                // The rate must be above 0 in single precision too, because throughputs are divided by the rounded
                // value.
                Some(rate) if rate as f32 > 0.0 && rate <= 1.0 => survival = Some(rate as f32),
                Some(rate) => {
                    builder.warn(&at("reflectionRate"), &format!("{rate} is no probability above 0; ignored"));
                }
                None => {}
            }
            let albedo = validate::reflectance(&at("color"), material.color)?;
            match material.brdf.as_deref() {
                None | Some("lambertian") => BsdfDesc::Lambert { albedo },
                Some("oren-nayar") => {
                    let roughness = material.roughness.ok_or_else(|| missing("roughness"))?;
                    BsdfDesc::OrenNayar { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
                }
                Some(other) => {
                    let known = ["lambertian", "oren-nayar"];
                    let hint = did_you_mean(other, known);
                    let message =
                        format!("unknown brdf '{}', expected one of {}{hint}", json::elided(other), known.join(", "));
                    return Err(Error::invalid(at("brdf"), message));
                }
            }
        }
        "reflective" => BsdfDesc::Mirror { reflectance: validate::reflectance(&at("color"), material.color)? },
        _ => {
            if material.color != [1.0; 3] {
                builder.warn(&at("color"), "glass is clear; the colour is ignored");
            }
            let index = material.refraction_index.ok_or_else(|| missing("refractionIndex"))?;
            let ior = validate::positive(&at("refractionIndex"), index)? as f32;
            BsdfDesc::Dielectric { ior, exterior_ior: 1.0 }
        }
    };
    if builder.scene.find_material(&material.name).is_some() {
        let again = format!("a second material named '{}'; the first is used", json::elided(&material.name));
        builder.warn(&at("name"), &again);
        return Ok(());
    }
    builder
        .scene
        .put_material(MaterialDesc {
            name: material.name,
            path: path.to_owned(),
            bsdf,
            survival,
            ..MaterialDesc::default()
        })
        .map(|_| ())
}

fn surface(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let (shape, local, material) = match json::tag(raw, path, "geometry", &["sphere", "triangle", "mesh"])?.as_str() {
        "sphere" => {
            let it: Sphere = object(raw, path, builder)?;
            let (shape, local) = ShapeDesc::sphere(it.origin.into(), it.radius).map_err(json::below(path))?;
            (shape, local, it.material)
        }
        "triangle" => {
            let it: Triangle = object(raw, path, builder)?;
            let vertices = [it.vertex_1, it.vertex_2, it.vertex_3].map(DVec3::from_array);
            let (shape, local) = ShapeDesc::triangle(vertices).map_err(json::below(path))?;
            (shape, local, it.material)
        }
        _ => {
            let it: Mesh = object(raw, path, builder)?;
            let origin = validate::vector(&at("origin"), it.origin)?;
            let radians = validate::vector(&at("rotate"), it.rotate.unwrap_or_default())?;
            let scale = transform::factors(&at("scale"), it.scale.map(Scale::Uniform))?;
            let local = transform::place(scale, radians, origin);
            validate::invertible(path, &local)?;
            let mesh = builder.mesh_file(&at("file"), &it.file, false)?;
            (ShapeDesc::Mesh { mesh, smooth: false }, local, it.material)
        }
    };
    let material = builder.material(&at("material"), &material)?;
    let look = SurfaceLook { material: Some(material), ..SurfaceLook::default() };
    builder.scene.put_surface(path, shape, local, look).map(|_| ())
}
