//! Cameras: from a position on the film to a ray.

mod lens;
mod moving;
mod panorama;

pub use self::moving::MovingCamera;

use self::lens::Lens;
use self::panorama::PanoramaView;
use crate::desc::{CameraDesc, FovAxis, Panorama};
use crate::error::{Error, Result};
use crate::math::{DVec3, Ray, RayCone, Vec3};

/// Where the rays of a camera start.
#[derive(Clone, Copy, Debug)]
enum Projection {
    /// In the eye.
    Central,
    /// On the film plane, away from the eye.
    ViewPlane,
    /// On the film plane, which the eye is in, all in the view direction.
    Parallel,
    /// In the eye, by film coordinates of their own.
    Panorama(PanoramaView),
}

/// A pinhole camera, optionally with a near plane through which its rays start or with a thin lens, or a camera of
/// parallel rays.
///
/// Everything is set up in double precision relative to the scene's centre and only then rounded.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    origin: Vec3,
    /// Vector from the eye to the film's top left corner. Its length along the view direction is 1 for a perspective
    /// camera, which a lens relies on, and 0 for parallel rays.
    corner: Vec3,
    /// One pixel to the right.
    dx: Vec3,
    /// Step of one pixel down.
    dy: Vec3,
    /// The step across the wider side of a pixel, in pixels. It is the one to the right where pixels are square.
    wider: [f32; 2],
    projection: Projection,
    /// Unit view direction.
    forward: Vec3,
    lens: Option<Lens>,
}

/// How wide a pixel is: at the start of its ray, and how much wider for each unit of distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelWidth {
    /// At the start of the ray, scene units.
    pub at_start: f32,
    /// For each unit of distance.
    pub spread: f32,
}

impl PixelWidth {
    /// The width at this distance.
    #[inline]
    pub fn at(self, distance: f32) -> f32 {
        self.at_start + distance * self.spread
    }
}

impl Camera {
    /// The camera for a film of `resolution` pixels in a scene whose frame has its origin at `centre`.
    ///
    /// Fails where view direction, up vector, field of view or lens make no image.
    pub fn new(desc: &CameraDesc, resolution: [u32; 2], centre: DVec3) -> Result<Self> {
        let [width, height] = resolution.map(f64::from);
        // Of the image as it is shown, with pixels of their shape.
        let aspect = width / height * desc.pixel_aspect();
        let [from, target, up] = desc.view();
        let fov_deg = desc.fov_deg().unwrap_or(90.0);
        let is_possible = match desc {
            CameraDesc::Panoramic { panorama, .. } => panorama.is_possible(),
            _ => fov_deg > 0.0 && fov_deg < 180.0,
        };
        if !is_possible {
            let message = format!("{fov_deg} degrees are no angle of view of such a camera");
            return Err(Error::invalid("camera.fieldOfView", message));
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
        let axes = || {
            let right = right.try_normalize().ok_or_else(parallel)?;
            Ok::<_, Error>((right, right.cross(forward)))
        };
        // Half the film's sides where one of them is known.
        let sides = |half: f64, axis| match axis {
            FovAxis::Horizontal => (half, half / aspect),
            FovAxis::Vertical => (half * aspect, half),
        };
        // `eye` to the middle of the film, and half the film's sides.
        let (origin, middle, half_width, half_height, projection) = match *desc {
            CameraDesc::Perspective { eye, fov_axis, .. } | CameraDesc::ThinLens { eye, fov_axis, .. } => {
                let (right, above) = axes()?;
                let (x, y) = sides(tan_half, fov_axis);
                (eye, forward, x * right, y * above, Projection::Central)
            }
            CameraDesc::Orthographic { eye, size, axis, .. } => {
                let (right, above) = axes()?;
                let (x, y) = sides(0.5 * size, axis);
                (eye, DVec3::ZERO, x * right, y * above, Projection::Parallel)
            }
            CameraDesc::Panoramic { eye, panorama, .. } => {
                let (right, above) = axes()?;
                let view = PanoramaView::new(&panorama, [right, above, forward].map(DVec3::as_vec3a));
                let half = 0.5 * fov_deg.to_radians();
                let (x, y) = match panorama.kind {
                    Panorama::Spherical => (half, 0.5 * half),
                    Panorama::Cylindrical => (half, half / aspect),
                    Panorama::Fisheye => sides(1.0, panorama.fov_axis),
                };
                (eye, DVec3::ZERO, x * DVec3::X, y * DVec3::Y, Projection::Panorama(view))
            }
            CameraDesc::ViewPlane { centre: plane, .. } => {
                // The plane's size follows from the up vector's length, as the report's renderer has it.
                let above = right.cross(forward);
                let middle = forward * (right.length() * aspect.sqrt() / tan_half);
                (plane - middle, middle, aspect.sqrt() * right, above / aspect.sqrt(), Projection::ViewPlane)
            }
        };
        // A film that is moved stays in its plane: the corner keeps its depth, which a lens and the depths of hits rely on.
        let [right, above] = desc.film().unwrap_or_default().shift.map(|shift| 2.0 * shift);
        let middle = middle + right * half_width + above * half_height;
        let lens = match desc {
            CameraDesc::ThinLens { lens, .. } => {
                let (right, above) = axes()?;
                Lens::new(lens, [right, above, forward], target - from, from)?
            }
            _ => None,
        };
        let camera = Self {
            origin: (origin - centre).as_vec3a(),
            corner: (middle - half_width + half_height).as_vec3a(),
            dx: (2.0 / width * half_width).as_vec3a(),
            dy: (-2.0 / height * half_height).as_vec3a(),
            wider: if desc.pixel_aspect() < 1.0 { [0.0, 1.0] } else { [1.0, 0.0] },
            projection,
            forward: forward.as_vec3a(),
            lens,
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

    /// The ray through the film position (x, y) in pixels, (0, 0) at the top left corner; unit direction. With a lens, the
    /// ray goes through its middle, as that of a pinhole does.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let to_film = self.corner + x * self.dx + y * self.dy;
        match self.projection {
            Projection::Central => Ray::new(self.origin, to_film.normalize()),
            Projection::ViewPlane => Ray::new(self.origin + to_film, to_film.normalize()),
            Projection::Parallel => Ray::new(self.origin + to_film, self.forward),
            Projection::Panorama(view) => Ray::new(self.origin, view.direction(to_film)),
        }
    }

    /// Where the rays of a camera without a lens start, that sees in perspective from one point.
    #[inline]
    pub(crate) fn eye(&self) -> Vec3 {
        self.origin
    }

    /// Whether all rays start at the eye and cross a flat film: a camera in perspective without a lens.
    pub(crate) fn is_pinhole(&self) -> bool {
        matches!(self.projection, Projection::Central) && self.lens.is_none()
    }

    /// Number of pixels that a unit solid angle around a unit direction from the eye fills (sr^-1), of a camera that
    /// [`Self::is_pinhole`]. With the film's plane at the distance h, a pixel of area A under the angle t to its normal fills
    /// A cos^3 t / h^2.
    #[inline]
    pub(crate) fn pixels_a_steradian(&self, direction: Vec3) -> f32 {
        let pixel = self.dx.cross(self.dy);
        let height = self.corner.dot(pixel).abs();
        let along = direction.dot(pixel).abs();
        // h = height / A and cos t = along / A.
        height * height / (along * along * along)
    }

    /// Whether the camera has a lens, so that rays need points on it.
    #[inline]
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// The ray through a film position as [`Camera::ray`] takes it and through the point on the lens for `u` in [0, 1)^2, uniform by
    /// area; unit direction. The rays of a film position meet in the plane of focus. Without a lens, `u` changes nothing.
    #[inline]
    pub fn ray_through_lens(&self, x: f32, y: f32, u: [f32; 2]) -> Ray {
        let Some(lens) = &self.lens else { return self.ray(x, y) };
        let (point, direction) = lens.ray(self.corner + x * self.dx + y * self.dy, u);
        Ray::new(self.origin + point, direction.normalize())
    }

    /// How wide the pixel at this film position is along its ray, across its wider side.
    pub fn pixel_width(&self, x: f32, y: f32) -> PixelWidth {
        match self.projection {
            Projection::Central | Projection::ViewPlane | Projection::Panorama(_) => {
                let [right, down] = self.wider;
                let spread = self.ray(x, y).direction.distance(self.ray(x + right, y + down).direction);
                PixelWidth { at_start: 0.0, spread }
            }
            Projection::Parallel => PixelWidth { at_start: self.wider_side(), spread: 0.0 },
        }
    }

    /// Length of a pixel's wider side on the film.
    #[inline]
    fn wider_side(&self) -> f32 {
        let [right, down] = self.wider;
        (right * self.dx + down * self.dy).length()
    }

    /// The cone through which a pixel at this film position sees: as wide as the wider side of the pixel where rays cross the film. A lens does
    /// not change it: textures are filtered as through its middle, and the blur is that of the rays.
    pub fn cone(&self, x: f32, y: f32) -> RayCone {
        let to_film = self.corner + x * self.dx + y * self.dy;
        let pixel = self.wider_side();
        match self.projection {
            Projection::Central => RayCone::new(0.0, pixel / to_film.length()),
            Projection::ViewPlane => RayCone::new(pixel, pixel / to_film.length()),
            Projection::Parallel => RayCone::new(pixel, 0.0),
            Projection::Panorama(view) => {
                // The wider of a step to the right and one down, as from a wide angle's side where a pixel is at the edge.
                let here = view.direction(to_film);
                let width = |step: Vec3| {
                    [to_film + step, to_film - step]
                        .map(|film| view.direction(film).distance(here))
                        .into_iter()
                        .fold(0.0, f32::max)
                };
                RayCone::new(0.0, width(self.dx).max(width(self.dy)))
            }
        }
    }

    /// The film position of a scene-frame point, in pixels as [`Camera::ray`] takes them, possibly beyond the film's
    /// edges; `None` for a point behind the eye, or before the plane where rays start on one. With a lens, it is the position under
    /// which the middle of the lens sees the point.
    pub fn film_position(&self, p: Vec3) -> Option<[f32; 2]> {
        if let Projection::Panorama(view) = &self.projection {
            let film = view.film(p - self.origin)? - self.corner;
            return Some([film.x / self.dx.x, film.y / self.dy.y]);
        }
        let [corner, dx, dy] = [self.corner, self.dx, self.dy].map(|v| v.as_dvec3());
        let v = (p - self.origin).as_dvec3();
        let normal = dx.cross(dy);
        let v = if matches!(self.projection, Projection::Parallel) {
            if v.dot(self.forward.as_dvec3()) < 0.0 {
                return None;
            }
            v - corner
        } else {
            // v = t (corner + x dx + y dy), by Cramer's rule.
            let t = v.dot(normal) / corner.dot(normal);
            if !(t > 0.0 && (t >= 1.0 || !matches!(self.projection, Projection::ViewPlane))) {
                return None;
            }
            v / t - corner
        };
        let scale = normal.dot(normal);
        let (x, y) = (v.cross(dy).dot(normal) / scale, dx.cross(v).dot(normal) / scale);
        (x.is_finite() && y.is_finite()).then_some([x as f32, y as f32])
    }

    /// Distance of a scene-frame point from the eye.
    pub fn eye_distance(&self, p: Vec3) -> f32 {
        p.distance(self.origin)
    }

    /// Distance of a scene-frame point from the eye, along the view direction; of a panorama the distance itself.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        match self.projection {
            Projection::Panorama(_) => self.eye_distance(p),
            _ => (p - self.origin).dot(self.forward),
        }
    }

    /// Whether the image is a circle, beyond which the film stays black.
    pub fn has_rim(&self) -> bool {
        matches!(&self.projection, Projection::Panorama(view) if view.has_rim())
    }

    /// Whether light arrives at this film position. [`Camera::ray`] gives any ray where it does not.
    pub fn sees(&self, x: f32, y: f32) -> bool {
        match &self.projection {
            Projection::Panorama(view) => view.sees(self.corner + x * self.dx + y * self.dy),
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{FilmDesc, FocusDesc, LensDesc};

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
            film: FilmDesc::default(),
        };
        let look_at = DVec3::new(2.0, 0.5, 1.0);
        let plane = CameraDesc::ViewPlane { centre: DVec3::NEG_X, look_at, up: DVec3::Y, fov_deg: 60.0 };
        let parallel = CameraDesc::Orthographic {
            eye: DVec3::new(1.0, 2.0, 3.0),
            look_at: DVec3::new(-3.0, 1.0, 0.5),
            up: DVec3::new(0.2, 1.0, 0.0),
            size: 5.0,
            axis: FovAxis::Vertical,
            film: FilmDesc::default(),
        };
        let film = FilmDesc { shift: [0.75, -2.5], pixel_aspect: 0.4 };
        let moved = [perspective, parallel].map(|mut desc| {
            if let CameraDesc::Perspective { film: it, .. } | CameraDesc::Orthographic { film: it, .. } = &mut desc {
                *it = film;
            }
            desc
        });
        for desc in [perspective, plane, parallel].into_iter().chain(moved) {
            let camera = Camera::new(&desc, [64, 48], DVec3::ZERO).unwrap();
            for (x, y, t) in [(0.5, 0.5, 0.7), (63.0, 10.25, 3.0), (32.0, 24.0, 100.0), (-5.0, 70.0, 1.0)] {
                let ray = camera.ray(x, y);
                let [u, v] = camera.film_position(ray.at(t)).unwrap();
                assert!((u - x).abs() < 1e-3 && (v - y).abs() < 1e-3, "{desc:?} {x} {y}: {u} {v}");
                // Behind the eye, which is behind the plane or in it.
                assert_eq!(camera.film_position(camera.origin - ray.direction), None);
            }
        }
        let camera = Camera::new(&plane, [64, 48], DVec3::ZERO).unwrap();
        let ray = camera.ray(20.0, 20.0);
        assert_eq!(camera.film_position(ray.at(-0.01)), None, "before the plane");
    }

    fn through(lens: LensDesc) -> CameraDesc {
        CameraDesc::ThinLens {
            eye: DVec3::new(1.0, 2.0, 3.0),
            look_at: DVec3::new(-3.0, 1.0, 0.5),
            up: DVec3::new(0.2, 1.0, 0.0),
            fov_deg: 70.0,
            fov_axis: FovAxis::Horizontal,
            lens,
            film: FilmDesc::default(),
        }
    }

    #[test]
    fn a_lens_of_radius_0_is_a_pinhole() {
        let with = |desc| Camera::new(&desc, [64, 48], DVec3::ZERO).unwrap();
        let CameraDesc::ThinLens { eye, look_at, up, fov_deg, fov_axis, .. } = through(LensDesc::new(0.0)) else {
            unreachable!()
        };
        let pinhole = with(CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis, film: FilmDesc::default() });
        let closed = with(through(LensDesc { blades: 5, ..LensDesc::new(0.0) }));
        let open = with(through(LensDesc::new(0.5)));
        assert!(!pinhole.has_lens() && !closed.has_lens() && open.has_lens());
        for (x, y) in [(0.0, 0.0), (13.25, 40.0), (63.0, 1.0)] {
            let ray = pinhole.ray(x, y);
            assert_eq!(closed.ray_through_lens(x, y, [0.1, 0.9]), ray);
            assert_eq!(open.ray(x, y), ray);
            assert_ne!(open.ray_through_lens(x, y, [0.1, 0.9]), ray);
            assert_eq!(open.cone(x, y), pinhole.cone(x, y));
        }
    }

    #[test]
    fn impossible_lenses_are_errors() {
        let focused = |focus| LensDesc { focus, ..LensDesc::new(0.1) };
        for (lens, path) in [
            (LensDesc::new(-1.0), "camera.lensRadius"),
            (LensDesc::new(f64::NAN), "camera.lensRadius"),
            (LensDesc::new(f64::INFINITY), "camera.lensRadius"),
            (LensDesc { focus: FocusDesc::Distance(1e-30), ..LensDesc::new(1e30) }, "camera.lensRadius"),
            (focused(FocusDesc::Distance(0.0)), "camera.focusDistance"),
            (focused(FocusDesc::Distance(f64::NAN)), "camera.focusDistance"),
            (focused(FocusDesc::Point(DVec3::splat(9.0))), "camera.focusAt"),
            (LensDesc { blades: 2, ..LensDesc::new(0.1) }, "camera.blades"),
            (LensDesc { blades: 33, ..LensDesc::new(0.1) }, "camera.blades"),
            (LensDesc { squeeze: 0.0, ..LensDesc::new(0.1) }, "camera.lensRadius"),
        ] {
            let error = Camera::new(&through(lens), [4, 4], DVec3::ZERO).unwrap_err();
            assert_eq!(error.location().json_path, path, "{lens:?}");
        }
        for size in [0.0, f64::NAN, 1e300, 1e-300] {
            let (eye, look_at, up, axis) = (DVec3::ZERO, DVec3::X, DVec3::Y, FovAxis::Horizontal);
            let desc = CameraDesc::Orthographic { eye, look_at, up, size, axis, film: FilmDesc::default() };
            assert!(Camera::new(&desc, [4, 4], DVec3::ZERO).is_err(), "{size}");
        }
    }

    #[test]
    fn impossible_cameras_are_errors() {
        let desc = |look_at, up, fov_deg| CameraDesc::Perspective {
            eye: DVec3::ZERO,
            look_at,
            up,
            fov_deg,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
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
