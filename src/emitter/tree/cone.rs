//! Cones of directions.

use std::f64::consts::PI;

use crate::math::DVec3;

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::emitter) struct Cone {
    /// Unit.
    pub axis: DVec3,
    /// In [0, pi].
    pub angle: f64,
}

impl Cone {
    /// All directions.
    pub const ALL: Self = Self { axis: DVec3::Z, angle: PI };

    /// One direction.
    pub fn along(axis: DVec3) -> Self {
        Self { axis, angle: 0.0 }
    }

    /// The smallest cone that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        let cross = wide.axis.cross(narrow.axis);
        let sin = cross.length();
        let between = sin.atan2(wide.axis.dot(narrow.axis));
        if between + narrow.angle <= wide.angle {
            return wide;
        }
        let angle = 0.5 * (wide.angle + between + narrow.angle);
        if angle >= PI || sin == 0.0 {
            return Self::ALL;
        }
        // The wide one's axis, turned towards the narrow one's.
        let (sin_turn, cos_turn) = (angle - wide.angle).sin_cos();
        let across = (cross / sin).cross(wide.axis);
        Self { axis: (cos_turn * wide.axis + sin_turn * across).normalize(), angle }
    }
}
