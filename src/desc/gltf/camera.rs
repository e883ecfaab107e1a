//! Cameras of nodes.

use super::super::{CameraDesc, FovAxis, SceneDesc, framing, validate};
use super::accessor::unsupported;
use super::document::{Document, called, element, missing};
use super::nodes::Nodes;
use crate::math::DVec3;
use crate::{Error, Result};

/// Most and least of the width of an image over its height that a camera decides.
const ASPECTS: [f64; 2] = [1.0 / 16.0, 16.0];

/// Sets the camera of a scene that is complete but for it: the chosen one (a name or a number of `cameras`), the first perspective
/// one of the scene, or one that frames all that is there.
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
    let is_perspective = |camera: usize| cameras[camera].kind == "perspective";
    let taken = match chosen {
        Some(camera) if !is_perspective(camera) => {
            let message =
                format!("the camera is {}, which is not supported; expected a perspective one", cameras[camera].kind);
            return Err(unsupported(&name(camera), message));
        }
        Some(camera) => {
            let found = placed.iter().position(|(_, it)| *it == camera);
            Some(found.ok_or_else(|| Error::invalid(name(camera), "no node of the scene has this camera"))?)
        }
        None => placed.iter().position(|(_, camera)| is_perspective(*camera)),
    };
    let left_out: Vec<_> =
        placed.iter().filter(|(_, camera)| !is_perspective(*camera)).map(|(_, it)| name(*it)).collect();
    if !left_out.is_empty() {
        let text = format!("orthographic cameras are not supported and left out: {}", super::listed(left_out));
        super::warn(&mut scene.warnings, text);
    }
    let Some(taken) = taken else {
        framing::frame(scene);
        return Ok(());
    };
    let (node, camera) = placed[taken];
    let others = placed.iter().enumerate().filter(|(i, (_, camera))| *i != taken && is_perspective(*camera));
    let others: Vec<_> = others.map(|(_, (_, camera))| name(*camera)).collect();
    if chosen.is_none() && !others.is_empty() {
        let text = format!("{} is taken; the scene has other cameras: {}", name(camera), super::listed(others));
        super::warn(&mut scene.warnings, text);
    }
    let path = format!("cameras[{camera}]");
    let perspective = cameras[camera].perspective.as_ref().ok_or_else(|| missing(&path, "perspective"))?;
    let path = format!("{path}.perspective");
    let yfov = perspective.yfov.ok_or_else(|| missing(&path, "yfov"))?;
    if !(yfov > 0.0 && yfov < std::f64::consts::PI) {
        let message = format!("{yfov} radians are out of range, expected an angle between 0 and pi");
        return Err(Error::invalid(format!("{path}.yfov"), message));
    }
    if let Some(aspect) = perspective.aspect_ratio {
        if !(aspect > 0.0 && aspect.is_finite()) {
            let message = format!("{aspect} is no ratio of width and height, expected a number > 0");
            return Err(Error::invalid(format!("{path}.aspectRatio"), message));
        }
        let height = scene.render.resolution[1];
        let width = (f64::from(height) * aspect.clamp(ASPECTS[0], ASPECTS[1])).round().max(1.0) as u32;
        scene.render.resolution = [width, height];
    }
    let to_world = nodes.to_world[node];
    // Lengths of a camera's axes mean nothing, so that scaled nodes see the same.
    let axis = |axis: DVec3| to_world.transform_vector3(axis).try_normalize();
    let (Some(view), Some(up)) = (axis(DVec3::NEG_Z), axis(DVec3::Y)) else {
        return Err(Error::invalid(
            format!("nodes[{node}]"),
            "the node flattens its camera, expected a scale that is not 0",
        ));
    };
    let eye = to_world.translation;
    // Far from the origin, a point one unit ahead could round to the eye.
    let distance = eye.abs().max_element().max(1.0);
    let fov_deg = yfov.to_degrees();
    let camera =
        CameraDesc::Perspective { eye, look_at: eye + distance * view, up, fov_deg, fov_axis: FovAxis::Vertical };
    scene.camera = validate::camera(&format!("nodes[{node}].camera"), camera)?;
    Ok(())
}
