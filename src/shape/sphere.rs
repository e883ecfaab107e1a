//! Spheres.

use std::f64::consts::{PI, TAU};

use super::ray::DRay;
use super::roots::first_between;
use crate::math::{Bounds, DVec3, shutter_time, time_segment};

/// A sphere in the scene frame, normals outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub centre: DVec3,
    /// Radius > 0.
    pub radius: f64,
}

impl Sphere {
    /// The nearest t in (tnear, tfar) at which the ray intersects the surface, from inside or outside.
    ///
    /// The quadratic is set up from the point of the ray nearest to the centre, so that neither a far origin nor a large
    /// radius cancels. Source: Haines, Günther, Akenine-Möller, *Ray Tracing Gems* ch. 7.
    #[inline]
    pub fn intersect(&self, ray: &DRay) -> Option<f64> {
        let to_origin = ray.origin - self.centre;
        let length2 = ray.direction.length_squared();
        let foot = -to_origin.dot(ray.direction) / length2;
        let nearest = to_origin + foot * ray.direction;
        let distance = nearest.length();
        let half_chord2 = (self.radius - distance) * (self.radius + distance);
        if half_chord2 < 0.0 || half_chord2.is_nan() {
            return None;
        }
        // t^2 - 2 foot t + (|o - c|^2 - r^2) / |d|^2 = 0, its discriminant known more exactly than b^2 - c.
        let half_chord = (half_chord2 / length2).sqrt();
        let c = (to_origin.length() - self.radius) * (to_origin.length() + self.radius) / length2;
        let far_side = foot + half_chord.copysign(foot);
        let (near, far) = if far_side == 0.0 {
            (0.0, 0.0)
        } else if foot >= 0.0 {
            (c / far_side, far_side)
        } else {
            (far_side, c / far_side)
        };
        first_between(near, far, ray)
    }

    /// The surface point nearest to `p` and the outward normal there; `p` must not be the centre.
    #[inline]
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        let normal = (p - self.centre).normalize();
        (self.centre + self.radius * normal, normal)
    }

    /// Texture coordinates of the point of a sphere that lies in this direction from the centre, in the sphere's own frame: u grows from
    /// 0 to 1 once around the y axis, to the right as it is seen from outside, and is 1/2 towards +z; v grows with the latitude, from 0
    /// at -y to 1 at +y.
    #[inline]
    pub fn texture_coordinates(direction: DVec3) -> [f64; 2] {
        let DVec3 { x, y, z } = direction;
        [0.5 + x.atan2(z) / TAU, 0.5 + y.atan2(x.hypot(z)) / PI]
    }

    /// The unit vector towards the point with this first texture coordinate and this height along the y axis, in radii.
    pub fn direction(u: f64, height: f64) -> DVec3 {
        let level = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        let (sin, cos) = (TAU * (u - 0.5)).sin_cos();
        DVec3::new(level * sin, height, level * cos)
    }

    /// The height along the y axis, in radii, of the points with this second texture coordinate.
    pub fn height(v: f64) -> f64 {
        (PI * (v - 0.5)).sin()
    }

    /// The sphere at a time in [0, 1] among those at moments evenly spaced over it, of which there are two at least. Between them its
    /// centre moves along a straight line and its radius grows evenly.
    #[inline]
    pub(crate) fn between(spheres: &[Self], time: f32) -> Self {
        let (step, weight) = time_segment(spheres.len(), shutter_time(time));
        let (from, to, weight) = (&spheres[step], &spheres[step + 1], f64::from(weight));
        Self { centre: from.centre.lerp(to.centre, weight), radius: from.radius * (1.0 - weight) + to.radius * weight }
    }

    /// A bounding box.
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.centre - self.radius, max: self.centre + self.radius }
    }

    /// Surface area.
    pub fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ray, Vec3};

    fn hit(centre: DVec3, radius: f64, origin: Vec3, direction: Vec3) -> Option<f64> {
        Sphere { centre, radius }.intersect(&DRay::from(&Ray::new(origin, direction)))
    }

    #[test]
    fn small_and_far() {
        // D - t = sqrt(1 - 0.96875^2) for a unit sphere at distance D, whatever D.
        for (distance, expected) in
            [(1e2, 99.751_960_814_587_69), (1e4, 9_999.751_960_814_588), (1e6, 999_999.751_960_814_6)]
        {
            let centre = DVec3::new(0.0, 0.0, distance);
            let t = hit(centre, 1.0, Vec3::new(0.96875, 0.0, 0.0), Vec3::Z).unwrap();
            assert!((t - expected).abs() <= 4.0 * f64::EPSILON * distance, "{t} {expected}");
            assert!(hit(centre, 1.0, Vec3::new(0.99, 0.0, 0.0), Vec3::Z).is_some());
            assert!(hit(centre, 1.0, Vec3::new(1.01, 0.0, 0.0), Vec3::Z).is_none());
        }
    }

    #[test]
    fn huge_ball_as_ground() {
        for (degrees, expected) in [(45.0_f64, 1.414_214_269_48), (10.0, 5.758_863_097_05), (1.0, 57.393_029_544_3)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let ray = DRay { origin: DVec3::Y, direction: DVec3::new(cos, -sin, 0.0), tnear: 0.0, tfar: f64::INFINITY };
            let t = Sphere { centre: DVec3::new(0.0, -1e6, 0.0), radius: 1e6 }.intersect(&ray).unwrap();
            assert!((t / expected - 1.0).abs() < 1e-9, "{t} {expected}");
        }
    }

    #[test]
    fn from_inside_and_grazing() {
        assert_eq!(hit(DVec3::ZERO, 1.0, Vec3::ZERO, Vec3::X), Some(1.0));
        assert_eq!(hit(DVec3::ZERO, 1.0, Vec3::new(-2.0, 0.0, 0.0), Vec3::X * 1e-10), Some(1.0 / 1e-10_f32 as f64));
        let t = hit(DVec3::ZERO, 1.0, Vec3::new(-1.0, 1.0 - f32::EPSILON / 2.0, 0.0), Vec3::X).unwrap();
        assert!((1.0 - t - 3.452_669_778_70e-4).abs() < 1e-9, "{t}");
        assert!(hit(DVec3::ZERO, 1.0, Vec3::new(-1.0, 1.0 + f32::EPSILON, 0.0), Vec3::X).is_none());
    }
}
