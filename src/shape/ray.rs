//! Rays as the analytic shapes want them.

use crate::math::{DVec3, Ray};

/// A ray in double precision.
#[derive(Clone, Copy, Debug)]
pub struct DRay {
    /// Origin.
    pub origin: DVec3,
    /// Direction, any length but zero.
    pub direction: DVec3,
    /// Start of the segment; a hit lies beyond it.
    pub tnear: f64,
    /// End of the segment; a hit lies before it.
    pub tfar: f64,
}

impl From<&Ray> for DRay {
    #[inline]
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            tnear: f64::from(ray.tnear),
            tfar: f64::from(ray.tfar),
        }
    }
}
