//! Flat disks under affine transforms.

use super::ray::DRay;
use crate::math::{Bounds, DAffine3, DVec3, Frame};

/// The unit disk x^2 + y^2 <= 1, z = 0 of a frame of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    to_own: DAffine3,
    centre: DVec3,
    /// The frame's x and y axes in the scene: two conjugate radii.
    radii: [DVec3; 2],
    normal: DVec3,
}

/// Points whose squared distance from the centre is 1 within this are on the edge.
const ON_EDGE: f64 = 1e-9;

impl Disk {
    /// The disk of this centre, unit normal and radius > 0 under an invertible transform.
    pub fn new(centre: DVec3, normal: DVec3, radius: f64, transform: &DAffine3) -> Self {
        let frame = Frame::from_normal(normal.as_vec3a());
        // The frame is single precision: once the axes are orthogonal to the normal again, any pair will do.
        let s = frame.s.as_dvec3();
        let s = (s - s.dot(normal) * normal).normalize();
        let own = DAffine3 {
            matrix3: crate::math::DMat3::from_cols(radius * s, radius * normal.cross(s), radius * normal),
            translation: centre,
        };
        let to_scene = *transform * own;
        let to_own = to_scene.inverse();
        Self {
            to_own,
            centre: to_scene.translation,
            radii: [to_scene.matrix3.x_axis, to_scene.matrix3.y_axis],
            normal: (transform.matrix3.inverse().transpose() * normal).normalize(),
        }
    }

    /// The same disk with its normal on the other side.
    pub fn flipped(&self) -> Self {
        Self { normal: -self.normal, ..*self }
    }

    /// The t in (tnear, tfar) at which the ray crosses the disk; none for a ray in its plane.
    #[inline]
    pub fn intersect(&self, ray: &DRay) -> Option<f64> {
        let t = (self.centre - ray.origin).dot(self.normal) / ray.direction.dot(self.normal);
        // The comparison is written so that NaN, from a ray in the plane, fails.
        if !(t > ray.tnear && t < ray.tfar) {
            return None;
        }
        let own = self.to_own.transform_point3(ray.origin + t * ray.direction);
        (own.x * own.x + own.y * own.y <= 1.0).then_some(t)
    }

    /// The point of the disk's plane nearest to `p`, and the normal.
    #[inline]
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        (p - (p - self.centre).dot(self.normal) * self.normal, self.normal)
    }

    /// The centre.
    #[inline]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The unit normal.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The area [length^2].
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.radii[0].cross(self.radii[1]).length()
    }

    /// The coordinates of a point of the plane, as of the unit disk.
    #[inline]
    pub fn coordinates(&self, p: DVec3) -> [f64; 2] {
        let own = self.to_own.transform_point3(p);
        [own.x, own.y]
    }

    /// [`Self::coordinates`] of a vector of the plane.
    #[inline]
    pub fn coordinates_of(&self, vector: DVec3) -> [f64; 2] {
        let own = self.to_own.transform_vector3(vector);
        [own.x, own.y]
    }

    /// The point at these coordinates of the unit disk. The mapping keeps ratios of areas.
    #[inline]
    pub fn at(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + x * self.radii[0] + y * self.radii[1]
    }

    /// The centre, and a point of the edge for each of these angles [radians].
    pub(super) fn rim(&self, angles: impl Iterator<Item = f64>) -> (DVec3, Vec<DVec3>) {
        let [a, b] = self.radii;
        (self.centre, angles.map(|angle| self.centre + angle.cos() * a + angle.sin() * b).collect())
    }

    /// Triangles from the centre to points of the edge, `count` >= 3 of them.
    pub(crate) fn fan(&self, count: u32) -> Vec<[DVec3; 3]> {
        let step = std::f64::consts::TAU / f64::from(count);
        let (centre, edge) = self.rim((0..count).map(|i| f64::from(i) * step));
        (0..count as usize).map(|i| [centre, edge[i], edge[(i + 1) % edge.len()]]).collect()
    }

    /// Whether a point is on the edge.
    pub(crate) fn is_on_edge(&self, p: DVec3) -> bool {
        let [x, y] = self.coordinates(p);
        (x * x + y * y - 1.0).abs() < ON_EDGE
    }

    /// The middle of the shorter arc between two points of the edge.
    pub(crate) fn middle_of_arc(&self, a: DVec3, b: DVec3) -> DVec3 {
        let [x, y] = self.coordinates(0.5 * (a + b));
        let length = x.hypot(y);
        self.at([x / length, y / length])
    }

    /// A bounding box.
    pub fn bounds(&self) -> Bounds {
        // The largest coordinate of c + a cos + b sin along an axis is c + sqrt(a^2 + b^2).
        let [a, b] = self.radii;
        let extent = (a * a + b * b).map(f64::sqrt);
        Bounds { min: self.centre - extent, max: self.centre + extent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_and_stretched() {
        let stretch = DAffine3::from_scale(DVec3::new(3.0, 1.0, 1.0));
        for (transform, edge) in [(DAffine3::IDENTITY, 0.5), (stretch, 1.5)] {
            let disk = Disk::new(DVec3::new(0.0, 0.0, 2.0), DVec3::NEG_Z, 0.5, &transform);
            for (x, hit) in [(0.0, true), (0.999 * edge, true), (-0.999 * edge, true), (1.001 * edge, false)] {
                let ray = DRay {
                    origin: DVec3::new(x, 0.0, -1.0),
                    direction: DVec3::new(0.0, 0.0, 0.5),
                    tnear: 0.0,
                    tfar: 1e9,
                };
                assert_eq!(disk.intersect(&ray).map(|t| (t - 6.0).abs() < 1e-14), hit.then_some(true), "{x}");
            }
            assert_eq!(disk.project(DVec3::new(0.1, 0.0, 2.5)), (DVec3::new(0.1, 0.0, 2.0), DVec3::NEG_Z));
            let bounds = disk.bounds();
            assert!((bounds.max - DVec3::new(edge, 0.5, 2.0)).abs().max_element() < 1e-7, "{bounds:?}");
            let in_plane =
                DRay { origin: DVec3::new(-9.0, 0.0, 2.0), direction: DVec3::X, tnear: 0.0, tfar: f64::INFINITY };
            assert_eq!(disk.intersect(&in_plane), None);
        }
    }
}
