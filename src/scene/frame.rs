//! Where the scene frame has its origin, and when a camera that moved needs another.

use super::Scene;
use crate::camera::Camera;
use crate::desc::CameraDesc;
use crate::math::{Bounds, DVec3, Ray, Vec3};

/// A frame whose origin is off by at most this many times the distance from the eye to what it sees is kept: single
/// precision then displaces a vertex by 2^-24 of that offset, which the eye sees under 2^-13 radians at most, an eighth of a
/// pixel at 1000 pixels and 60 degrees.
///
/// So the rule knows no length. In a room the camera may go anywhere down to a 2048th of its way from a wall, and around an
/// object wherever it likes; on a ground seen from eye height, 1.7, the frame follows every three thousand.
const KEPT: f64 = 2048.0;

/// Rays to each side of the image that look for what is near.
const GRID: u32 = 8;

/// The camera's own position.
fn eye(camera: &CameraDesc) -> DVec3 {
    match *camera {
        CameraDesc::Perspective { eye, .. } => eye,
        CameraDesc::ViewPlane { centre, .. } => centre,
    }
}

/// The world position that becomes the scene frame's origin: the camera, or the point of the scene's box nearest to it.
pub(super) fn origin(camera: &CameraDesc, bounds: &Bounds) -> DVec3 {
    let eye = eye(camera);
    if bounds.is_empty() { eye } else { eye.clamp(bounds.min, bounds.max) }
}

/// Whether the frame of `scene` will do for this camera: nothing is too near to the eye for its distance from the origin.
///
/// Asked are short rays, around the eye and through the image. What none of them meets may be seen less exactly; it is not
/// missed.
pub(super) fn still_serves(scene: &Scene, camera: &CameraDesc) -> bool {
    let off = origin(camera, &scene.info().bounds).distance(scene.centre());
    if off == 0.0 {
        return true;
    }
    let reach = (off / KEPT) as f32;
    let eye = scene.to_scene(eye(camera));
    let is_free = |origin: Vec3, direction: Vec3| {
        scene.unoccluded(&Ray { tfar: reach, ..Ray::new(origin, direction.normalize()) })
    };
    // Faces, edges and corners of a cube.
    let steps = || [-1.0_f32, 0.0, 1.0].into_iter();
    let around = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vec3::new(x, y, z))));
    if !around.filter(|direction| *direction != Vec3::ZERO).all(|direction| is_free(eye, direction)) {
        return false;
    }
    // A camera that is none is refused elsewhere.
    let Ok(view) = Camera::new(camera, [GRID; 2], scene.centre()) else { return true };
    (0..GRID * GRID).all(|i| {
        let ray = view.ray((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5);
        is_free(ray.origin, ray.direction)
    })
}
