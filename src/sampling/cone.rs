//! Cones of directions, sampled uniformly.

use super::warps;
use crate::math::{Frame, Vec3};

/// A cone of directions: its unit axis and 1 - cos of its half angle, which keeps the digits of narrow cones.
#[derive(Clone, Copy, Debug)]
pub struct DirectionCone {
    /// The axis.
    pub axis: Vec3,
    /// 1 - cos of the half angle.
    pub one_minus_cos: f32,
}

impl DirectionCone {
    /// The cone in which the ball of this centre and radius is seen from `p`; `None` where `p` lies inside the ball.
    #[inline]
    pub fn of_ball(p: Vec3, centre: Vec3, radius: f32) -> Option<Self> {
        let axis = centre - p;
        let distance = axis.length();
        let sin = radius / distance;
        if sin.is_nan() || sin >= 1.0 {
            return None;
        }
        let one_minus_cos = warps::one_minus_cos_from_sin2(sin * sin);
        Some(Self { axis: axis / distance, one_minus_cos })
    }

    /// A direction in the cone, uniform by solid angle.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        Frame::from_normal(self.axis).to_world(warps::uniform_cone(u, self.one_minus_cos))
    }

    /// Density of [`Self::sample`] (sr^-1) inside the cone.
    #[inline]
    pub fn pdf(&self) -> f32 {
        warps::uniform_cone_pdf(self.one_minus_cos)
    }

    /// Whether a unit direction lies in the cone. The square of the chord is 2 (1 - cos), without the cosine's rounding.
    #[inline]
    pub fn holds(&self, direction: Vec3) -> bool {
        direction.distance_squared(self.axis) <= 2.0 * self.one_minus_cos
    }
}
