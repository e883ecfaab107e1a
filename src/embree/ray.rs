//! Rays and hits in Embree's form.

use super::sys;
use crate::math::{Ray, Vec3};

/// Marks "none" in Embree's identifiers.
pub(super) const INVALID: u32 = u32::MAX;

/// The first hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// For a triangle the barycentric weight of its second vertex, which rounding may put outside [0, 1] by 4 ULP of 1;
    /// for user geometry what it reported.
    pub u: f32,
    /// For a triangle the barycentric weight of its third vertex, with the same proviso; for user geometry what it
    /// reported.
    pub v: f32,
    /// Geometric normal, not of unit length, in the frame of the instanced scene if there is one. For a triangle
    /// (p1 - p0) x (p2 - p0), whichever side the ray comes from.
    pub ng: Vec3,
    /// Index of the primitive within its geometry.
    pub prim: u32,
    /// The geometry within its scene, as [`super::GeometryId`].
    pub geom: u32,
    /// The instance through which the geometry was met, or [`Hit::NO_INSTANCE`].
    pub inst: u32,
}

impl Hit {
    /// The value of `inst` for geometry that belongs to the queried scene itself.
    pub const NO_INSTANCE: u32 = INVALID;
}

/// Whether a ray can be given to Embree, which is built without a guard against NaN and infinity: its results for them
/// are arbitrary. Here such rays hit nothing. Multiplication by zero gives NaN exactly for these values, without a
/// branch for each.
#[inline]
pub(super) fn is_traceable(ray: &Ray) -> bool {
    let (o, d) = (ray.origin, ray.direction);
    let not_finite = (o.x * 0.0 + d.x * 0.0) + (o.y * 0.0 + d.y * 0.0) + (o.z * 0.0 + d.z * 0.0);
    let has_direction = (d.x != 0.0) | (d.y != 0.0) | (d.z != 0.0);
    (not_finite == 0.0) & has_direction & (ray.tnear >= 0.0) & (ray.tnear <= ray.tfar)
}

/// The ray in Embree's form, at this time of the shutter interval.
///
/// Embree loads it as three vectors of 16 bytes. Where the fields were stored one by one just before, the processor
/// cannot forward them to such a load and waits until they reach the cache. They are therefore stored as vectors too.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(super) fn to_embree(ray: &Ray, time: f32) -> sys::RTCRay {
    use std::arch::x86_64::{__m128, _mm_set_ps};
    let (o, d) = (ray.origin, ray.direction);
    // SAFETY: SSE is part of every x86-64 processor.
    let vectors: [__m128; 3] = unsafe {
        [
            _mm_set_ps(ray.tnear, o.z, o.y, o.x),
            _mm_set_ps(time, d.z, d.y, d.x),
            _mm_set_ps(0.0, 0.0, f32::from_bits(u32::MAX), ray.tfar),
        ]
    };
    // SAFETY: `RTCRay` is twelve floats and integers of 4 bytes each in this order: org, tnear, dir, time, tfar, mask,
    // id, flags (the build script checked the layout), for which all bit patterns are values.
    unsafe { std::mem::transmute::<[__m128; 3], sys::RTCRay>(vectors) }
}

/// The ray in Embree's form, at this time of the shutter interval.
#[cfg(not(target_arch = "x86_64"))]
#[inline]
pub(super) fn to_embree(ray: &Ray, time: f32) -> sys::RTCRay {
    sys::RTCRay {
        org_x: ray.origin.x,
        org_y: ray.origin.y,
        org_z: ray.origin.z,
        tnear: ray.tnear,
        dir_x: ray.direction.x,
        dir_y: ray.direction.y,
        dir_z: ray.direction.z,
        time,
        tfar: ray.tfar,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

/// A hit structure that stands for "no hit yet".
#[inline]
pub(super) fn no_hit() -> sys::RTCHit {
    // SAFETY: `RTCHit` is plain floats and integers, for which all-zero bytes are a value. (Written so because one of
    // its fields exists only in some configurations of Embree.)
    let mut hit: sys::RTCHit = unsafe { std::mem::zeroed() };
    hit.geomID = INVALID;
    hit.instID[0] = INVALID;
    hit
}

#[inline]
pub(super) fn from_embree(found: &sys::RTCRayHit) -> Option<Hit> {
    if found.hit.geomID == INVALID {
        return None;
    }
    Some(Hit {
        t: found.ray.tfar,
        u: found.hit.u,
        v: found.hit.v,
        ng: Vec3::new(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z),
        prim: found.hit.primID,
        geom: found.hit.geomID,
        inst: found.hit.instID[0],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_arrives_field_by_field() {
        let ray = Ray { tnear: 7.0, ..Ray::segment(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0), 8.0) };
        let r = to_embree(&ray, 9.0);
        assert_eq!((r.org_x, r.org_y, r.org_z, r.tnear), (1.0, 2.0, 3.0, 7.0));
        assert_eq!((r.dir_x, r.dir_y, r.dir_z, r.time), (4.0, 5.0, 6.0, 9.0));
        assert_eq!((r.tfar, r.mask, r.id, r.flags), (8.0, u32::MAX, 0, 0));
    }

    #[test]
    fn the_cheap_test_of_a_ray_agrees_with_the_plain_one() {
        let odd = [0.0, -0.0, 1.0, -1.0, 1e-45, f32::MAX, f32::MIN, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for a in odd {
            for b in odd {
                for axis in 0..3 {
                    let mut ray = Ray::new(Vec3::ZERO, Vec3::ZERO);
                    ray.origin[axis] = a;
                    ray.direction[axis] = b;
                    assert_eq!(is_traceable(&ray), ray.is_valid(), "{ray:?}");
                    let ray = Ray { tnear: a, tfar: b, ..Ray::new(Vec3::ZERO, Vec3::X) };
                    // An empty interval is valid, and holds nothing to meet.
                    assert_eq!(is_traceable(&ray), ray.is_valid() && a <= b, "{ray:?}");
                }
            }
        }
    }
}
