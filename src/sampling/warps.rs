//! Warps of the unit square to discs, spheres and triangles, each with its density.
//!
//! Solid angles in steradians; z is the axis. All are continuous and keep stratification; densities are constant where
//! not stated otherwise.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};
use std::hint::select_unpredictable;

use crate::math::Vec3;

/// The concentric map: signed radius in (-1, 1), and cosine and sine of the angle. The radius never reaches 1, so that
/// no direction made from it lies in the base plane.
///
/// The map has no branch, because a branch would be unpredictable. Source: Shirley and Chiu 1997, "A Low Distortion Map
/// Between Disk and Square".
#[inline]
fn concentric(u: [f32; 2]) -> (f32, f32, f32) {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let is_wide = x.abs() > y.abs();
    let (radius, other) = select_unpredictable(is_wide, (x, y), (y, x));
    // At the centre any angle is valid.
    let ratio = other / if radius == 0.0 { 1.0 } else { radius };
    let (sin, cos) = sin_cos_eighth(FRAC_PI_4 * ratio);
    // The angle is that of the nearer axis, or a quarter turn minus it.
    let (cos, sin) = select_unpredictable(is_wide, (cos, sin), (sin, cos));
    (radius.clamp(-1.0_f32.next_down(), 1.0_f32.next_down()), cos, sin)
}

/// Sine and cosine of an angle of at most pi / 4 either way, to 1e-7.
///
/// Source: Moshier, *Cephes* (sinf.c), minimax polynomials.
#[inline]
fn sin_cos_eighth(angle: f32) -> (f32, f32) {
    let a2 = angle * angle;
    let sin = angle + angle * a2 * (-1.666_665_5e-1 + a2 * (8.332_161e-3 + a2 * -1.951_529_6e-4));
    let cos = 1.0 - 0.5 * a2 + a2 * a2 * (4.166_664_6e-2 + a2 * (-1.388_731_6e-3 + a2 * 2.443_315_7e-5));
    (sin, cos)
}

/// Uniform point on the unit disc, concentric map.
///
/// Source: Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square".
#[inline]
pub fn uniform_disk(u: [f32; 2]) -> [f32; 2] {
    let (radius, cos, sin) = concentric(u);
    [radius * cos, radius * sin]
}

/// Uniform point on the regular polygon of `sides` sides (3 or more, a whole number) that is inscribed in the unit circle, with a
/// vertex at (1, 0). The density per unit area is one over the polygon's area, sides / 2 sin(2 pi / sides).
///
/// The concentric map gives a radius and an angle, uniform on the disk. Within the angle of a side, the same radius and an
/// even step along the side for each step of the angle are uniform in the triangle of the side and the centre, because
/// the area between two such steps is in proportion to the radius, as it is in the disk. The map is continuous and
/// folds nothing, so that it keeps points that are spread well spread well.
#[inline]
pub fn uniform_polygon(u: [f32; 2], sides: f32) -> [f32; 2] {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let is_wide = x.abs() > y.abs();
    let (radius, other) = if is_wide { (x, y) } else { (y, x) };
    let eighth = 0.125 * other / if radius == 0.0 { 1.0 } else { radius };
    // In turns from the first axis; a negative radius is half a turn further.
    let turn = if is_wide { eighth } else { 0.25 - eighth } + if radius < 0.0 { 0.5 } else { 0.0 };
    let along = turn * sides;
    let side = along.floor();
    // The point on the side, seen from its middle direction: the half side is sin(pi / sides) long and cos(pi / sides) away.
    let (half, away) = (PI / sides).sin_cos();
    let (far, left) = (radius.abs() * away, radius.abs() * half * (2.0 * (along - side) - 1.0));
    let (sin, cos) = (TAU / sides * (side + 0.5)).sin_cos();
    [far * cos - left * sin, far * sin + left * cos]
}

/// Density of [`uniform_disk`] per unit area.
#[inline]
pub fn uniform_disk_pdf() -> f32 {
    FRAC_1_PI
}

/// Direction in the upper hemisphere, density cos(theta) / pi: the disc lifted onto the hemisphere. z is above 0.
///
/// Source: Malley's method; Pharr, Jakob, Humphreys, *Physically Based Rendering* 4e, Sec. A.5.3.
#[inline]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let (radius, cos, sin) = concentric(u);
    let z = ((1.0 - radius) * (1.0 + radius)).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

/// Density of [`cosine_hemisphere`] (sr^-1) at a direction with this cosine; 0 below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A direction from 1 - cos(theta) in [0, 2], which keeps narrow cones exact, and an angle around z in turns.
#[inline]
fn from_one_minus_cos(one_minus_cos: f32, turn: f32) -> Vec3 {
    let sin_theta = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (sin, cos) = (TAU * turn).sin_cos();
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - one_minus_cos)
}

/// Uniform direction in the upper hemisphere; z is above 0.
#[inline]
pub fn uniform_hemisphere(u: [f32; 2]) -> Vec3 {
    from_one_minus_cos(u[0], u[1])
}

/// Density of [`uniform_hemisphere`] (sr^-1).
#[inline]
pub fn uniform_hemisphere_pdf() -> f32 {
    1.0 / TAU
}

/// Uniform direction on the sphere.
#[inline]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    from_one_minus_cos(2.0 * u[0], u[1])
}

/// Density of [`uniform_sphere`] (sr^-1).
#[inline]
pub fn uniform_sphere_pdf() -> f32 {
    1.0 / (2.0 * TAU)
}

/// 1 - cos(theta) for sin^2(theta) in [0, 1] and theta up to a right angle: sin^2 / (1 + cos), exact for small angles.
///
/// For a ball of radius r at distance d, sin^2(theta) = r^2 / d^2.
#[inline]
pub fn one_minus_cos_from_sin2(sin2_theta: f32) -> f32 {
    sin2_theta / (1.0 + (1.0 - sin2_theta).max(0.0).sqrt())
}

/// Uniform direction in the cone around z with this 1 - cos(theta) at its edge, in (0, 2].
#[inline]
pub fn uniform_cone(u: [f32; 2], one_minus_cos_max: f32) -> Vec3 {
    from_one_minus_cos(u[0] * one_minus_cos_max, u[1])
}

/// Density of [`uniform_cone`] (sr^-1) inside the cone: one over its solid angle.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

/// Barycentric coordinates of a uniform point in a triangle, for its three vertices in order; each >= 0, sum 1. The
/// density per unit area is one over the triangle's area.
///
/// Source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
#[inline]
pub fn uniform_triangle(u: [f32; 2]) -> [f32; 3] {
    let half = 0.5 * u[0].min(u[1]);
    let (b0, b1) = (u[0] - half, u[1] - half);
    [b0, b1, (1.0 - b0 - b1).max(0.0)]
}
