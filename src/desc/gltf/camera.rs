//! Cameras of nodes.

use super::super::{CameraDesc, FilmDesc, FovAxis, SceneDesc, camera_check, framing};
use super::accessor::unsupported;
use super::document::{Camera, Document, called, element, missing};
use super::nodes::Nodes;
use crate::math::DVec3;
use crate::{Error, Result};

/// Most and least of the width of an image over its height that a camera decides.
const ASPECTS: [f64; 2] = [1.0 / 16.0, 16.0];

/// Sets the camera of a scene that is complete but for it: the chosen one (a name or a number of `cameras`), the first one of the
/// scene, or one that frames all that is there.
pub(super) fn set(document: &Document<'_>, nodes: &Nodes, chosen: Option<&str>, scene: &mut SceneDesc) -> Result<()> {
    let cameras = &document.cameras;
    let chosen = match chosen {
        Some(chosen) => Some(super::choose("cameras", chosen, cameras.iter().map(|it| it.name.as_deref()))?),
        None => None,
    };
    let mut placed = Vec::new();
    for node in &nodes.drawn {
        if let Some(camera) = document.nodes[*node].camera {
            let (camera, _) = element(cameras, "cameras", &format!("nodes[{node}].camera"), camera)?;
            placed.push((*node, camera));
        }
    }
    let name = |camera: usize| called(&format!("cameras[{camera}]"), cameras[camera].name.as_deref());
    let taken = match chosen {
        Some(camera) => {
            let found = placed.iter().position(|(_, it)| *it == camera);
            Some(found.ok_or_else(|| Error::invalid(name(camera), "no node of the scene has this camera"))?)
        }
        None => (!placed.is_empty()).then_some(0),
    };
    let Some(taken) = taken else {
        framing::frame(scene);
        return Ok(());
    };
    let (node, camera) = placed[taken];
    let others = placed.iter().enumerate().filter(|(i, _)| *i != taken);
    let others: Vec<_> = others.map(|(_, (_, camera))| name(*camera)).collect();
    if chosen.is_none() && !others.is_empty() {
        let text = format!("{} is taken; the scene has other cameras: {}", name(camera), super::listed(others));
        super::warn(&mut scene.warnings, text);
    }
    let lens = view(&format!("cameras[{camera}]"), &cameras[camera])?;
    if let Some(aspect) = lens.aspect {
        let height = scene.render.resolution[1];
        let width = (f64::from(height) * aspect.clamp(ASPECTS[0], ASPECTS[1])).round().max(1.0) as u32;
        scene.render.resolution = [width, height];
    }
    let to_world = nodes.to_world[node];
    // Lengths of a camera's axes mean nothing, so that scaled nodes see the same.
    let axis = |axis: DVec3| to_world.transform_vector3(axis).try_normalize();
    let (Some(forward), Some(up)) = (axis(DVec3::NEG_Z), axis(DVec3::Y)) else {
        return Err(Error::invalid(
            format!("nodes[{node}]"),
            "the node flattens its camera, expected a scale that is not 0",
        ));
    };
    let eye = to_world.translation;
    // Far from the origin, a point one unit ahead could round to the eye.
    let distance = eye.abs().max_element().max(1.0);
    let look_at = eye + distance * forward;
    let axis = FovAxis::Vertical;
    let camera = match lens.height {
        Height::Degrees(fov_deg) => {
            CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis: axis, film: FilmDesc::default() }
        }
        Height::Length(size) => CameraDesc::Orthographic { eye, look_at, up, size, axis, film: FilmDesc::default() },
    };
    scene.camera = camera_check::camera(&format!("nodes[{node}].camera"), camera)?;
    Ok(())
}

/// What a camera sees across the height of its image.
enum Height {
    /// An angle.
    Degrees(f64),
    /// A length, by parallel rays.
    Length(f64),
}

/// What a camera sees.
struct View {
    height: Height,
    /// Width over height of the image, where the camera decides it.
    aspect: Option<f64>,
}

/// Reads what the camera at `path` sees.
fn view(path: &str, camera: &Camera) -> Result<View> {
    let positive = |path: String, value: f64, what: &str| {
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(Error::invalid(path, format!("{value} is no {what}, expected a number > 0")))
    };
    match camera.kind.as_str() {
        "perspective" => {
            let perspective = camera.perspective.as_ref().ok_or_else(|| missing(path, "perspective"))?;
            let path = format!("{path}.perspective");
            let yfov = perspective.yfov.ok_or_else(|| missing(&path, "yfov"))?;
            if !(yfov > 0.0 && yfov < std::f64::consts::PI) {
                let message = format!("{yfov} radians are out of range, expected an angle between 0 and pi");
                return Err(Error::invalid(format!("{path}.yfov"), message));
            }
            let ratio = |aspect| positive(format!("{path}.aspectRatio"), aspect, "ratio of width and height");
            let aspect = perspective.aspect_ratio.map(ratio).transpose()?;
            Ok(View { height: Height::Degrees(yfov.to_degrees()), aspect })
        }
        "orthographic" => {
            let orthographic = camera.orthographic.as_ref().ok_or_else(|| missing(path, "orthographic"))?;
            let path = format!("{path}.orthographic");
            let half = |key: &str, value: Option<f64>| {
                let value = value.ok_or_else(|| missing(&path, key))?;
                positive(format!("{path}.{key}"), value, "half of what an image spans")
            };
            let (x, y) = (half("xmag", orthographic.xmag)?, half("ymag", orthographic.ymag)?);
            Ok(View { height: Height::Length(2.0 * y), aspect: Some(x / y) })
        }
        kind => {
            let message = format!("'{kind}' is not supported, expected \"perspective\" or \"orthographic\"");
            Err(unsupported(&format!("{path}.type"), message))
        }
    }
}
