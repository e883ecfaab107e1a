//! Inverses of the warps: the point of the unit square that a warp maps to a sample.

use std::f32::consts::{FRAC_PI_4, TAU};

use etendue::math::Vec3;

/// The point of the unit square that `warps::uniform_disk` maps to `p`.
pub fn uniform_disk_inverse(p: [f32; 2]) -> [f32; 2] {
    let radius = p[0].hypot(p[1]);
    let (x, y) = if p[0].abs() > p[1].abs() {
        let x = radius.copysign(p[0]);
        (x, (p[1] / p[0]).atan() / FRAC_PI_4 * x)
    } else if p[1] != 0.0 {
        let y = radius.copysign(p[1]);
        ((p[0] / p[1]).atan() / FRAC_PI_4 * y, y)
    } else {
        (0.0, 0.0)
    };
    [0.5 * x + 0.5, 0.5 * y + 0.5]
}

/// The point of the unit square that `warps::cosine_hemisphere` maps to `w`.
pub fn cosine_hemisphere_inverse(w: Vec3) -> [f32; 2] {
    uniform_disk_inverse([w.x, w.y])
}

/// Angle around z in turns, in [0, 1).
fn turn(w: Vec3) -> f32 {
    let turn = w.y.atan2(w.x) / TAU;
    (if turn < 0.0 { turn + 1.0 } else { turn }).min(1.0_f32.next_down())
}

/// 1 - cos(theta) of a unit vector, without cancellation around the axis.
fn one_minus_cos(w: Vec3) -> f32 {
    if w.z > 0.0 { (w.x * w.x + w.y * w.y) / (1.0 + w.z) } else { 1.0 - w.z }
}

/// The point of the unit square that `warps::uniform_hemisphere` maps to `w`.
pub fn uniform_hemisphere_inverse(w: Vec3) -> [f32; 2] {
    [one_minus_cos(w), turn(w)]
}

/// The point of the unit square that `warps::uniform_sphere` maps to `w`.
pub fn uniform_sphere_inverse(w: Vec3) -> [f32; 2] {
    [0.5 * one_minus_cos(w), turn(w)]
}

/// The point of the unit square that `warps::uniform_cone` maps to `w`.
pub fn uniform_cone_inverse(w: Vec3, one_minus_cos_max: f32) -> [f32; 2] {
    [one_minus_cos(w) / one_minus_cos_max, turn(w)]
}

/// The point of the unit square that `warps::uniform_triangle` maps to barycentric coordinates `b`.
pub fn uniform_triangle_inverse(b: [f32; 3]) -> [f32; 2] {
    if b[0] < b[1] { [2.0 * b[0], b[0] + b[1]] } else { [b[0] + b[1], 2.0 * b[1]] }
}
