//! What sampling an emitter gives: a direction towards it, or a place from which light leaves.

use crate::math::{HitPoint, Vec3};
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
    /// Whether the emitter is a point, which no Bsdf sample can hit.
    pub is_delta: bool,
}

/// Where light leaves an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// The place.
    pub point: HitPoint,
    /// Unit normal on the side that shines; `None` for a point, which shines all around.
    pub normal: Option<Vec3>,
}
