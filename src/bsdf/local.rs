//! Geometry of the local frame, and sampling that the diffuse models share.

use super::fresnel::refracted_cosine;
use super::lobes::Lobes;
use super::model::BsdfSample;
use crate::math::Vec3;
use crate::sampling::warps;
use crate::spectrum::Spectrum;

/// A cosine-distributed direction on `wo`'s side with the weight pi f that `weight` gives it.
#[inline]
pub(super) fn sample_diffuse<C: Spectrum>(wo: Vec3, u: [f32; 3], weight: impl FnOnce(Vec3) -> C) -> BsdfSample<C> {
    let up = warps::cosine_hemisphere([u[0], u[1]]);
    let wi = Vec3::new(up.x, up.y, up.z.copysign(wo.z));
    let pdf = warps::cosine_hemisphere_pdf(up.z);
    BsdfSample { wi, weight: weight(wi), pdf, lobe: Lobes::DIFFUSE_REFLECTION, eta: 1.0 }
}

/// Density of [`sample_diffuse`].
#[inline]
pub(super) fn diffuse_pdf(wo: Vec3, wi: Vec3) -> f32 {
    if same_side(wo, wi) { warps::cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
}

/// Whether both directions are strictly on one side of the surface. The product of two tiny cosines may underflow, which
/// counts as lying in the surface and keeps every quotient of cosines finite.
#[inline]
pub(super) fn same_side(wo: Vec3, wi: Vec3) -> bool {
    wo.z * wi.z > 0.0
}

/// The direction mirrored to the outer side.
#[inline]
pub(super) fn outward(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, w.z.abs())
}

/// The mirror direction about the normal.
#[inline]
pub(super) fn reflect(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// The direction into which a facet with normal `m` refracts, or `None` under total reflection. `m` faces `wo`; `eta` is the
/// index of refraction behind the facet over that in front of it.
#[inline]
pub(super) fn refract_about(wo: Vec3, m: Vec3, eta: f64) -> Option<Vec3> {
    let cos_o = f64::from(wo.dot(m));
    let cos_t = refracted_cosine(cos_o, eta)?;
    let along = (cos_o / eta - cos_t) as f32;
    Some((m * along - wo * (1.0 / eta) as f32).normalize())
}

/// pi times the directional albedo of max(0, sin sin cos(phi)) / (pi max(cos, cos)), which the rough diffuse models have in
/// common: s (theta - s c) + 2/3 s (1 - s^3) / c for sine s and cosine c of the direction's angle theta.
///
/// Source: Portsmouth, Kutz, Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", Eq. 14, without its last term.
pub(super) fn bright_side(w: Vec3) -> f32 {
    let (s, c) = (sine(w), w.z.abs());
    // (1 - s^3) / c without a difference of what is nearly the same.
    let rest = c * (1.0 + s + s * s) / (1.0 + s);
    s * (s.atan2(c) - s * c) + 2.0 / 3.0 * s * rest
}

/// Sine of a unit direction's angle to the normal.
pub(super) fn sine(w: Vec3) -> f32 {
    w.x.hypot(w.y)
}

/// Product of the two directions' tangential parts, sin theta_o sin theta_i cos(phi_o - phi_i), free of cancellation
/// against the cosines and of any trouble at the pole.
#[inline]
pub(super) fn tangential_dot(wo: Vec3, wi: Vec3) -> f32 {
    wo.x * wi.x + wo.y * wi.y
}
