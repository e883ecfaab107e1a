//! Cameras: from a position on the film to a ray.

use crate::desc::{CameraDesc, FovAxis};
use crate::error::{Error, Result};
use crate::math::{DVec3, Ray, RayCone, Vec3};

/// A pinhole camera, optionally with a near plane through which its rays start.
///
/// Everything is set up in double precision relative to the scene's centre and only then rounded.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    origin: Vec3,
    /// Vector from the eye to the film's top left corner, at any scale.
    corner: Vec3,
    /// One pixel to the right.
    dx: Vec3,
    /// Step of one pixel down.
    dy: Vec3,
    /// Rays start on the film plane instead of in the eye.
    starts_on_plane: bool,
    /// Unit view direction.
    forward: Vec3,
}

impl Camera {
    /// The camera for a film of `resolution` pixels in a scene whose frame has its origin at `centre`.
    ///
    /// Fails where view direction, up vector or field of view make no image.
    pub fn new(desc: &CameraDesc, resolution: [u32; 2], centre: DVec3) -> Result<Self> {
        let [width, height] = resolution.map(f64::from);
        let aspect = width / height;
        let (target, from, up, fov_deg) = match *desc {
            CameraDesc::Perspective { eye, look_at, up, fov_deg, .. } => (look_at, eye, up, fov_deg),
            CameraDesc::ViewPlane { centre, look_at, up, fov_deg } => (look_at, centre, up, fov_deg),
        };
        if !(fov_deg > 0.0 && fov_deg < 180.0) {
            return Err(Error::invalid("camera.fieldOfView", format!("{fov_deg} is not between 0 and 180 degrees")));
        }
        let tan_half = (0.5 * fov_deg).to_radians().tan();
        let forward = (target - from).try_normalize().ok_or_else(|| {
            Error::invalid("camera.lookAt", "is the camera's own position: there is no direction to look in")
        })?;
        let right = forward.cross(up);
        let parallel = || Error::invalid("camera.up", "is zero or parallel to the view direction");
        // Vectors that are parallel except for rounding count as parallel: the rest of their cross product is noise.
        if right.length() <= 1e-12 * up.length() || !right.is_finite() {
            return Err(parallel());
        }
        // `eye` to the middle of the film, and half the film's sides.
        let (origin, middle, half_width, half_height, starts_on_plane) = match *desc {
            CameraDesc::Perspective { eye, fov_axis, .. } => {
                let right = right.try_normalize().ok_or_else(parallel)?;
                let above = right.cross(forward);
                let (x, y) = match fov_axis {
                    FovAxis::Horizontal => (tan_half, tan_half / aspect),
                    FovAxis::Vertical => (tan_half * aspect, tan_half),
                };
                (eye, forward, x * right, y * above, false)
            }
            CameraDesc::ViewPlane { centre: plane, .. } => {
                // The plane's size follows from the up vector's length, as the report's renderer has it.
                let above = right.cross(forward);
                let middle = forward * (right.length() * aspect.sqrt() / tan_half);
                (plane - middle, middle, aspect.sqrt() * right, above / aspect.sqrt(), true)
            }
        };
        let camera = Self {
            origin: (origin - centre).as_vec3a(),
            corner: (middle - half_width + half_height).as_vec3a(),
            dx: (2.0 / width * half_width).as_vec3a(),
            dy: (-2.0 / height * half_height).as_vec3a(),
            starts_on_plane,
            forward: forward.as_vec3a(),
        };
        let finite = [camera.origin, camera.corner, camera.dx, camera.dy].iter().all(|v| v.is_finite());
        if !finite || camera.dx == Vec3::ZERO || camera.dy == Vec3::ZERO {
            return Err(Error::invalid(
                "camera",
                "is too far away or its view too narrow or wide for single precision",
            ));
        }
        Ok(camera)
    }

    /// The ray through the film position (x, y) in pixels, (0, 0) at the top left corner; unit direction.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let to_film = self.corner + x * self.dx + y * self.dy;
        let origin = if self.starts_on_plane { self.origin + to_film } else { self.origin };
        Ray::new(origin, to_film.normalize())
    }

    /// The cone through which a pixel at this film position sees: as wide as the pixel where rays cross the film.
    pub fn cone(&self, x: f32, y: f32) -> RayCone {
        let to_film = self.corner + x * self.dx + y * self.dy;
        let pixel = self.dx.length();
        RayCone::new(if self.starts_on_plane { pixel } else { 0.0 }, pixel / to_film.length())
    }

    /// The film position of a scene-frame point, in pixels as [`Camera::ray`] takes them, possibly beyond the film's
    /// edges; `None` for a point behind the eye, or before the near plane where there is one.
    pub fn film_position(&self, p: Vec3) -> Option<[f32; 2]> {
        let [corner, dx, dy] = [self.corner, self.dx, self.dy].map(|v| v.as_dvec3());
        let v = (p - self.origin).as_dvec3();
        // v = t (corner + x dx + y dy), by Cramer's rule.
        let normal = dx.cross(dy);
        let t = v.dot(normal) / corner.dot(normal);
        if !(t > 0.0 && (t >= 1.0 || !self.starts_on_plane)) {
            return None;
        }
        let v = v / t - corner;
        let scale = normal.dot(normal);
        let (x, y) = (v.cross(dy).dot(normal) / scale, dx.cross(v).dot(normal) / scale);
        (x.is_finite() && y.is_finite()).then_some([x as f32, y as f32])
    }

    /// Distance of a scene-frame point from the eye.
    pub fn eye_distance(&self, p: Vec3) -> f32 {
        p.distance(self.origin)
    }

    /// Distance of a scene-frame point from the eye, along the view direction.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        (p - self.origin).dot(self.forward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_plane_camera_of_the_report() {
        // Eye (-2, 0, 0) looking at +x, image right = +z, rays start at x = -1.
        let desc = CameraDesc::ViewPlane { centre: DVec3::NEG_X, look_at: DVec3::X, up: DVec3::Y, fov_deg: 90.0 };
        let camera = Camera::new(&desc, [256, 256], DVec3::ZERO).unwrap();
        let middle = camera.ray(128.0, 128.0);
        assert!((middle.origin - Vec3::NEG_X).length() < 1e-6 && (middle.direction - Vec3::X).length() < 1e-6);
        let corner = camera.ray(256.0, 0.0);
        assert!((corner.origin - Vec3::new(-1.0, 1.0, 1.0)).length() < 1e-6, "{corner:?}");
        assert!((corner.direction * 3.0_f32.sqrt() - Vec3::ONE).length() < 1e-6, "{corner:?}");
    }

    #[test]
    fn points_of_a_ray_are_seen_where_it_left_the_film() {
        let perspective = CameraDesc::Perspective {
            eye: DVec3::new(1.0, 2.0, 3.0),
            look_at: DVec3::new(-3.0, 1.0, 0.5),
            up: DVec3::new(0.2, 1.0, 0.0),
            fov_deg: 70.0,
            fov_axis: FovAxis::Vertical,
        };
        let look_at = DVec3::new(2.0, 0.5, 1.0);
        let plane = CameraDesc::ViewPlane { centre: DVec3::NEG_X, look_at, up: DVec3::Y, fov_deg: 60.0 };
        for desc in [perspective, plane] {
            let camera = Camera::new(&desc, [64, 48], DVec3::ZERO).unwrap();
            for (x, y, t) in [(0.5, 0.5, 0.7), (63.0, 10.25, 3.0), (32.0, 24.0, 100.0), (-5.0, 70.0, 1.0)] {
                let ray = camera.ray(x, y);
                let [u, v] = camera.film_position(ray.at(t)).unwrap();
                assert!((u - x).abs() < 1e-3 && (v - y).abs() < 1e-3, "{desc:?} {x} {y}: {u} {v}");
                // Behind the eye, which is behind the plane.
                assert_eq!(camera.film_position(camera.origin - ray.direction), None);
            }
        }
        let camera = Camera::new(&plane, [64, 48], DVec3::ZERO).unwrap();
        let ray = camera.ray(20.0, 20.0);
        assert_eq!(camera.film_position(ray.at(-0.01)), None, "before the plane");
    }

    #[test]
    fn impossible_cameras_are_errors() {
        let desc = |look_at, up, fov_deg| CameraDesc::Perspective {
            eye: DVec3::ZERO,
            look_at,
            up,
            fov_deg,
            fov_axis: FovAxis::Horizontal,
        };
        for (desc, path) in [
            (desc(DVec3::ZERO, DVec3::Y, 90.0), "camera.lookAt"),
            (desc(DVec3::Y, DVec3::Y, 90.0), "camera.up"),
            (desc(DVec3::Y, DVec3::ZERO, 90.0), "camera.up"),
            (desc(DVec3::X, DVec3::Y, 180.0), "camera.fieldOfView"),
            (desc(DVec3::X, DVec3::Y, f64::NAN), "camera.fieldOfView"),
        ] {
            let error = Camera::new(&desc, [4, 4], DVec3::ZERO).unwrap_err();
            assert_eq!(error.location().json_path, path);
        }
    }
}
