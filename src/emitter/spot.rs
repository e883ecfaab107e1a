//! Cones of light with a soft edge.

use std::f64::consts::{PI, TAU};

use crate::math::{DQuat, DVec3, Frame, Vec3};
use crate::sampling::warps;

/// The factor of a spot light on its radiant intensity: 1 up to the inner angle from the axis, 0 from the outer angle on, and between
/// them ((cos a - cos outer) / (cos inner - cos outer))^2.
///
/// Source: Khronos Group, glTF extension `KHR_lights_punctual`, "Inner and Outer Cone Angles". The least width of the edge in its code,
/// which keeps a shader from dividing by 0, is left out: where both angles are the same, the edge is hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Unit.
    axis: Vec3,
    /// 1 - cos of the inner angle. Differences from 1 keep the digits of narrow cones.
    inner: f32,
    /// 1 - cos of the outer angle.
    outer: f32,
    /// The same angle.
    angle: f64,
}

impl Spot {
    /// A spot light around the unit vector `axis`; 0 <= `inner` <= `outer` <= pi are angles from it, and `outer` > 0.
    pub fn new(axis: DVec3, inner: f64, outer: f64) -> Self {
        let one_minus_cos = |angle: f64| (2.0 * (0.5 * angle).sin().powi(2)) as f32;
        let (inner, angle) = (one_minus_cos(inner), outer);
        Self { axis: axis.as_vec3a(), inner, outer: one_minus_cos(outer).max(inner), angle }
    }

    /// The same light, turned.
    pub(super) fn turned(self, rotation: DQuat) -> Self {
        Self { axis: (rotation * self.axis.as_dvec3()).as_vec3a(), ..self }
    }

    /// The factor of a unit direction that leaves the light.
    #[inline]
    pub fn factor(&self, direction: Vec3) -> f32 {
        let one_minus_cos = 0.5 * direction.distance_squared(self.axis);
        if one_minus_cos <= self.inner {
            1.0
        } else if one_minus_cos >= self.outer {
            0.0
        } else {
            let t = (self.outer - one_minus_cos) / (self.outer - self.inner);
            t * t
        }
    }

    /// The integral of the factor over the sphere \[sr\].
    #[inline]
    pub fn flux(&self) -> f64 {
        let (inner, outer) = (f64::from(self.inner), f64::from(self.outer));
        TAU * (inner + (outer - inner) / 3.0)
    }

    /// A direction with a density in proportion to the factor, by inversion; `u` is uniform in [0, 1)^2.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        let edge = self.outer - self.inner;
        let at = u[0] * (self.inner + edge / 3.0);
        // In the edge, the cube of what is squared in the factor is uniform.
        let one_minus_cos = if at < self.inner {
            at
        } else {
            self.outer - edge * (1.0 - 3.0 * (at - self.inner) / edge).max(0.0).cbrt()
        };
        let around_z = warps::uniform_cone([1.0, u[1]], one_minus_cos.clamp(0.0, self.outer));
        Frame::from_normal(self.axis).to_world(around_z)
    }

    /// The cone that holds all of the light: its unit axis and its half angle.
    pub fn cone(&self) -> (DVec3, f64) {
        (self.axis.as_dvec3().normalize(), self.angle.min(PI))
    }
}
