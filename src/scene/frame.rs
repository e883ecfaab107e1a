//! Chooses the origin of the scene frame, and decides when a camera that moved needs another one.

use super::Scene;
use crate::camera::Camera;
use crate::desc::CameraDesc;
use crate::math::{Bounds, DVec3, Ray, Vec3};

/// A scene frame is kept while the distance from its origin to the eye is at most this many times the distance from the
/// eye to the surfaces that it sees. Single precision then displaces a vertex by 2^-24 of the distance from the origin,
/// which the eye sees under 2^-13 radians at most, an eighth of a pixel at 1000 pixels and 60 degrees.
/// pixel at 1000 pixels and 60 degrees.
/// The rule contains no length, so it is independent of the scene's scale. In a room, the camera may come as close to a
/// wall as a 2048th of the distance that it moved, and around an object it may move anywhere; above a ground seen from
/// an eye height of 1.7, the frame changes after every three thousand units.
const KEPT: f64 = 2048.0;

/// Number of rays along each side of the image that search for near surfaces.
const GRID: u32 = 8;

/// The position of the camera.
fn eye(camera: &CameraDesc) -> DVec3 {
    let [eye, ..] = camera.view();
    eye
}

/// Returns the world position of the scene frame's origin: the camera, or the point of the scene's box nearest to the
/// camera.
pub(super) fn origin(camera: &CameraDesc, bounds: &Bounds) -> DVec3 {
    let eye = eye(camera);
    if bounds.is_empty() { eye } else { eye.clamp(bounds.min, bounds.max) }
}

/// Returns whether the frame of `scene` is accurate enough for this camera: no surface is too near to the eye for the
/// eye's distance from the origin.
///
/// Short rays are traced around the eye and through the image. A surface that none of these rays hits may be rendered
/// less exactly, but it is not lost.
pub(super) fn still_serves(scene: &Scene, camera: &CameraDesc) -> bool {
    let off = origin(camera, &scene.info().bounds).distance(scene.centre());
    if off == 0.0 {
        return true;
    }
    // Pixels of parallel rays are equally wide at all distances: the width of the image stands for the distance of the surfaces.
    if let CameraDesc::Orthographic { size, .. } = *camera {
        return off <= KEPT * size;
    }
    let reach = (off / KEPT) as f32;
    let eye = scene.to_scene(eye(camera));
    let is_free = |origin: Vec3, direction: Vec3| {
        scene.unoccluded(&Ray { tfar: reach, ..Ray::new(origin, direction.normalize()) })
    };
    // The directions are those to the faces, edges and corners of a cube.
    let steps = || [-1.0_f32, 0.0, 1.0].into_iter();
    let around = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vec3::new(x, y, z))));
    if !around.filter(|direction| *direction != Vec3::ZERO).all(|direction| is_free(eye, direction)) {
        return false;
    }
    // An invalid camera is refused elsewhere.
    let Ok(view) = Camera::new(camera, [GRID; 2], scene.centre()) else { return true };
    (0..GRID * GRID).all(|i| {
        let ray = view.ray((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5);
        is_free(ray.origin, ray.direction)
    })
}
