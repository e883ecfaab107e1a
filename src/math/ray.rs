//! Rays, and the scale-free way in which they leave a surface.

use super::Vec3;

/// A ray segment: `origin + t * direction` for t in `[tnear, tfar]`. The direction need not be of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t is 0.
    pub origin: Vec3,
    /// Direction, any length but zero.
    pub direction: Vec3,
    /// Start of the segment, >= 0.
    pub tnear: f32,
    /// End of the segment, may be infinite.
    pub tfar: f32,
}

impl Ray {
    /// A ray without an end.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, tnear: 0.0, tfar: f32::INFINITY }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// Whether it can be traced: all components finite, direction not zero, no NaN in the interval.
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != Vec3::ZERO
            && self.tnear >= 0.0
            && !self.tfar.is_nan()
    }
}

/// Twice the unit roundoff of f32: a bound on the relative error of a number that was rounded once, with room to spare.
pub const ROUNDING: f32 = f32::EPSILON;

/// Bound on the kernel's error in the distance of a plane from a ray's end, in units of the ray's length.
const DISTANCE_ERROR: f32 = 4.0 * ROUNDING;

/// A point on a surface together with how far from it a ray has to start not to meet the same surface again.
///
/// The point itself was rebuilt in double precision and rounded once, so it is off the surface by half a unit in the last
/// place of its coordinates. A traversal kernel in single precision adds an error that grows with the distance from the
/// ray's origin to the primitive's vertices, so `error` also covers the primitive's extent. Both scale with the scene:
/// there is no absolute epsilon.
#[derive(Clone, Copy, Debug)]
pub struct HitPoint {
    /// The point, scene frame.
    pub p: Vec3,
    /// Bound on the distance, along the normal, within which the same primitive may be met again.
    pub error: f32,
}

impl HitPoint {
    /// Bound on the error of a point that was computed in double precision and rounded once, along the unit normal `n`: twice
    /// that, since what is added to the point is rounded too.
    #[inline]
    pub fn rounding_error(p: Vec3, n: Vec3) -> f32 {
        ROUNDING * p.abs().dot(n.abs())
    }

    /// The same point as the end of a ray that comes from so far away.
    ///
    /// The kernel sees it in coordinates relative to the ray's origin, rounded at that size: the plane of a small triangle
    /// seems nearer or farther by that along its normal, and so along the ray by any factor when seen at a grazing angle.
    #[inline]
    #[must_use]
    pub fn seen_from(self, distance: f32) -> Self {
        Self { error: self.error + DISTANCE_ERROR * distance, ..self }
    }

    /// Where a ray into the side `n` points to (unit normal, flipped towards the ray) starts.
    ///
    /// Each coordinate is rounded away from the surface. Source: Pharr, Jakob, Humphreys, *Physically Based
    /// Rendering* 4e, Sec. 6.8.6, with our own bound.
    #[inline]
    pub fn offset(&self, n: Vec3) -> Vec3 {
        // One unit in the last place, or two, in the direction of `d`; without a branch, which would go either way.
        #[inline]
        fn away(p: f32, d: f32) -> f32 {
            let moved = p + d;
            let step = (moved.abs() * f32::EPSILON).copysign(d);
            moved + if d == 0.0 { 0.0 } else { step }
        }
        let d = n * self.error;
        Vec3::new(away(self.p.x, d.x), away(self.p.y, d.y), away(self.p.z, d.z))
    }
}
