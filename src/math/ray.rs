//! Rays, and the scale-free offset with which they leave a surface.

use super::{RayCone, Vec3};

/// A ray segment: `origin + t * direction` for t in `[tnear, tfar]`, at one moment of the shutter interval. The direction
/// need not be of unit length.
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
    /// The moment at which the ray sees the scene: 0 is the opening of the shutter and 1 its closing. Only scenes with
    /// motion read it. There a time outside of [0, 1] counts as the nearer end, and NaN counts as 0.
    pub time: f32,
    /// What a pixel sees through the ray. Only scenes with materials that ask for footprints keep it.
    pub cone: RayCone,
}

/// Returns the moment that a scene with motion shows to a ray of this time ([`Ray::time`]).
#[inline]
pub(crate) fn shutter_time(time: f32) -> f32 {
    if time > 0.0 { time.min(1.0) } else { 0.0 }
}

/// The two moments that enclose a time in [0, 1], of `count` >= 2 evenly spaced moments, and the weight of the second. It
/// is what Embree computes, to the last bit.
pub(crate) fn time_segment(count: usize, time: f32) -> (usize, f32) {
    let segments = (count - 1) as f32;
    let scaled = time * segments;
    let first = scaled.floor().clamp(0.0, segments - 1.0);
    (first as usize, scaled - first)
}

impl Ray {
    /// A ray without an end, at time 0.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self::segment(origin, direction, f32::INFINITY)
    }

    /// The segment from the origin to `tfar`, at time 0.
    #[inline]
    pub fn segment(origin: Vec3, direction: Vec3, tfar: f32) -> Self {
        Self { origin, direction, tnear: 0.0, tfar, time: 0.0, cone: RayCone::default() }
    }

    /// The same ray at another time.
    #[inline]
    #[must_use]
    pub fn at_time(self, time: f32) -> Self {
        Self { time, ..self }
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

/// A point on a surface, with the distance from it at which a ray has to start in order not to hit the same surface
/// again.
///
/// The point itself was reconstructed in double precision and rounded once, so it is off the surface by half a unit in
/// the last place of its coordinates. A traversal kernel in single precision adds an error that grows with the distance
/// from the ray's origin to the primitive's vertices, so `error` also covers the primitive's extent. Both scale with
/// the scene: there is no absolute epsilon.
#[derive(Clone, Copy, Debug)]
pub struct HitPoint {
    /// The point, scene frame.
    pub p: Vec3,
    /// Bound on the distance, along the normal, within which a ray may hit the same primitive again.
    pub error: f32,
    /// The moment at which the surface is at this point, which rays that leave the point take over: [`Ray::time`].
    pub time: f32,
    /// The cone of the ray that met the surface, from this point on. Rays without an end that leave the point take it over:
    /// [`Ray::cone`].
    pub cone: RayCone,
    /// The mean curvature of the surface [1 / scene unit], positive where it bends away from its outer normal. It is known in scenes
    /// whose rays have cones, and 0 in others.
    pub curvature: f32,
}

impl HitPoint {
    /// A point on a surface at time 0.
    #[inline]
    pub fn new(p: Vec3, error: f32) -> Self {
        Self { p, error, time: 0.0, cone: RayCone::default(), curvature: 0.0 }
    }

    /// Bound on the error of a point that was computed in double precision and rounded once, along the unit normal `n`.
    /// The bound is twice that error, since an offset added to the point is rounded too.
    #[inline]
    pub fn rounding_error(p: Vec3, n: Vec3) -> f32 {
        ROUNDING * p.abs().dot(n.abs())
    }

    /// The same point as the end of a ray of length `distance`.
    ///
    /// The kernel computes with coordinates relative to the ray's origin, rounded at that size. The plane of a small
    /// triangle therefore seems nearer or farther by that error along its normal, and by any multiple of it along a ray
    /// at a grazing angle.
    #[inline]
    #[must_use]
    pub fn seen_from(self, distance: f32) -> Self {
        Self { error: self.error + DISTANCE_ERROR * distance, ..self }
    }

    /// A ray without an end that leaves into `direction` towards the side `n` (unit normal), at the point's time and with
    /// its cone.
    #[inline]
    pub fn leave(&self, n: Vec3, direction: Vec3) -> Ray {
        Ray { time: self.time, cone: self.cone, ..Ray::new(self.offset(n), direction) }
    }

    /// The segment from the surface on the side `n` (unit normal) to `target`, at the point's time. It carries no cone, since
    /// nothing is shaded at its end.
    #[inline]
    pub fn leave_to(&self, n: Vec3, target: Vec3) -> Ray {
        let origin = self.offset(n);
        Ray { time: self.time, ..Ray::segment(origin, target - origin, 1.0) }
    }

    /// Origin of a ray that leaves towards the side `n` (unit normal, flipped towards the ray).
    ///
    /// Each coordinate is rounded away from the surface. Source: Pharr, Jakob, Humphreys, *Physically Based Rendering*
    /// 4e, Sec. 6.8.6, with our own bound.
    #[inline(always)]
    pub fn offset(&self, n: Vec3) -> Vec3 {
        // One or two units in the last place, in the direction of `d`, without a branch, which would be unpredictable.
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
