//! What sampling an emitter gives: a direction towards it, or a place from which light leaves.

use crate::math::{DVec3, HitPoint, Vec3};
use crate::spectrum::Rgb;

/// A direction towards an emitter.
#[derive(Clone, Copy, Debug)]
pub struct EmitterSample {
    /// Unit direction from the reference point.
    pub wi: Vec3,
    /// Where a shadow ray ends: on the emitter, moved off it to its outer side by what the kernel may be off there.
    pub target: Vec3,
    /// Radiance that arrives when nothing is in between [W m^-2 sr^-1]; for a point light, irradiance on a surface that
    /// faces it [W m^-2].
    pub radiance: Rgb,
    /// Density of `wi` per solid angle times the probability of the emitter; for a point light that probability alone.
    pub pdf: f32,
    /// Number of the emitter, once the sample is one of a set.
    pub emitter: u32,
    /// Whether the emitter is a point, which no Bsdf sample can hit.
    pub is_delta: bool,
}

impl EmitterSample {
    /// The sample of a point of an emitting surface with this outward unit normal, seen from `from`. `pdf`: per solid angle.
    #[inline]
    pub(super) fn of_surface(from: DVec3, point: DVec3, normal: DVec3, radiance: Rgb, pdf: f32) -> Self {
        let to_light = point - from;
        let distance = to_light.length();
        let height = -to_light.dot(normal);
        let (point, normal) = (point.as_vec3a(), normal.as_vec3a());
        let mut target = HitPoint::new(point, HitPoint::rounding_error(point, normal)).seen_from(distance as f32);
        // A shadow ray must not end behind `from`.
        target.error = target.error.min((0.5 * height.max(0.0)) as f32);
        let wi = (to_light / distance).as_vec3a().normalize();
        Self { wi, target: target.offset(normal), radiance, pdf, emitter: 0, is_delta: false }
    }
}

/// Where light leaves an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// The place.
    pub point: HitPoint,
    /// Unit normal on the side that shines; `None` for a point, which shines all around.
    pub normal: Option<Vec3>,
}

impl Departure {
    /// From a point of a surface with this unit normal.
    #[inline]
    pub(super) fn of_surface(p: DVec3, normal: DVec3) -> Self {
        let (p, normal) = (p.as_vec3a(), normal.as_vec3a());
        Self { point: HitPoint::new(p, HitPoint::rounding_error(p, normal)), normal: Some(normal) }
    }
}
