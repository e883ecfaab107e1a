//! Vectors, frames, rays and boxes; uses nothing else of the library.

mod cone;
mod frame;
mod keyed_path;
mod ray;

pub use cone::RayCone;
pub use frame::Frame;
pub use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4, EulerRot, Vec2, Vec3A as Vec3, Vec4};
pub(crate) use keyed_path::flattens_between;
pub use keyed_path::{KeyedPath, Pose};
pub use ray::{HitPoint, ROUNDING, Ray};
pub(crate) use ray::{shutter_time, time_segment};

/// An axis-aligned box in double precision; `min > max` in any axis means empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// The box that holds nothing; the identity of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::splat(f64::INFINITY), max: DVec3::splat(f64::NEG_INFINITY) };

    /// The smallest box that holds all the points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::include)
    }

    /// The smallest box that holds this one and `point`.
    #[must_use]
    pub fn include(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether it holds no point at all.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether it holds a point.
    pub fn contains(&self, point: DVec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Midpoint; meaningless for an empty box.
    pub fn centre(&self) -> DVec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
    }

    /// The box around this one after `transform`.
    #[must_use]
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::around(self.corners().map(|corner| transform.transform_point3(corner)))
    }
}

/// Relative deviation from a similarity up to which a transform keeps spheres round.
const SIMILARITY: f64 = 1e-9;

/// The uniform scale of a similarity transform, `None` for any other.
pub(crate) fn similarity_scale(transform: &DAffine3) -> Option<f64> {
    let m = transform.matrix3;
    let scale2 = m.x_axis.length_squared();
    let close = |x: f64, y: f64| (x - y).abs() <= SIMILARITY * scale2;
    (close(m.y_axis.length_squared(), scale2)
        && close(m.z_axis.length_squared(), scale2)
        && close(m.x_axis.dot(m.y_axis), 0.0)
        && close(m.y_axis.dot(m.z_axis), 0.0)
        && close(m.z_axis.dot(m.x_axis), 0.0))
    .then(|| scale2.sqrt())
}
