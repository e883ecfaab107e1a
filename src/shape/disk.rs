//! Flat disks.

use super::DRay;
use crate::math::{Bounds, DVec3};

/// A flat disk in the scene frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Centre.
    pub centre: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Radius > 0.
    pub radius: f64,
}

impl Disk {
    /// The t in (tnear, tfar) at which the ray crosses the disk; none for a ray in its plane.
    #[inline]
    pub fn intersect(&self, ray: &DRay) -> Option<f64> {
        let t = (self.centre - ray.origin).dot(self.normal) / ray.direction.dot(self.normal);
        if !(t > ray.tnear && t < ray.tfar) {
            return None;
        }
        let p = ray.origin + t * ray.direction;
        (p.distance_squared(self.centre) <= self.radius * self.radius).then_some(t)
    }

    /// The point of the disk's plane nearest to `p`, and the normal.
    #[inline]
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        (p - (p - self.centre).dot(self.normal) * self.normal, self.normal)
    }

    /// A box around it.
    pub fn bounds(&self) -> Bounds {
        let n = self.normal;
        // Half extent along an axis is r sqrt(1 - n_axis^2), with the square root's argument as a sum that cannot cancel.
        let extent = self.radius
            * DVec3::new(
                (n.y * n.y + n.z * n.z).sqrt(),
                (n.x * n.x + n.z * n.z).sqrt(),
                (n.x * n.x + n.y * n.y).sqrt(),
            );
        Bounds { min: self.centre - extent, max: self.centre + extent }
    }
}
