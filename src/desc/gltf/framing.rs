//! A camera for scenes that have none.

use super::super::{CameraDesc, FovAxis};
use crate::math::{Bounds, DVec3};

/// Vertical angle of view [degree].
const FOV_DEG: f64 = 40.0;

/// A camera that sees the sphere around a box from a three-quarter view: from the right, from above and from the front (+z), with +y
/// upwards. It fits into square images and into wider ones. `None` for a box that holds nothing.
pub(super) fn frame_camera(bounds: &Bounds) -> Option<CameraDesc> {
    if bounds.is_empty() {
        return None;
    }
    let centre = bounds.centre();
    let radius = (0.5 * (bounds.max - bounds.min)).length();
    // A single point is seen from a distance that its own coordinates can express.
    let radius = radius.max(1e-6 * centre.abs().max_element()).max(1e-6);
    let direction = DVec3::new(1.0, 0.75, 1.5).normalize();
    // The margin keeps the sphere off the edge of the image.
    let distance = 1.05 * radius / (0.5 * FOV_DEG).to_radians().sin();
    Some(CameraDesc::Perspective {
        eye: centre + distance * direction,
        look_at: centre,
        up: DVec3::Y,
        fov_deg: FOV_DEG,
        fov_axis: FovAxis::Vertical,
    })
}
