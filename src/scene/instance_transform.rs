//! Where instances stand, and how far off the kernel sees what stands there.

use glam::Vec3Swizzles as _;

use crate::math::{DAffine3, DMat3, DVec3, ROUNDING};

/// Bound on the error of a coordinate on its way into an instance's frame, in units of its parts: half a unit in the last place
/// of each.
const PLACEMENT_ERROR: f64 = 0.5 * ROUNDING as f64;

/// A matrix whose determinant is smaller than the sum of its products by this is no longer inverted well in single precision.
///
/// Turns, and stretches along the axes before or after a turn, stay below 2 whatever they stretch by.
const CANCELLED: f64 = 16.0;

/// Where an instance stands, and how exactly the kernel moves rays there.
///
/// The kernel inverts the matrix in single precision and adds the inverse's translation, rounded, to every ray's origin. Both
/// move the ray in the object's frame by an error that need not be along the normal, nor small in the scene: where the
/// transform stretches, the same step in the object's frame is many lengths in the scene's.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstanceTransform {
    pub to_scene: DAffine3,
    /// Inverse transpose, for normals.
    pub normals: DMat3,
    /// Magnitudes of the matrix.
    stretch: DMat3,
    /// Bound on the error in the object's frame that comes of rounding, for each unit of a coordinate in the scene's frame.
    rounding: DMat3,
    /// The same, and with it the error of the inverse.
    inverting: DMat3,
}

/// What an inversion in single precision is made of.
struct Cofactors {
    /// The cofactors with the magnitudes of their products added, transposed.
    sums: DMat3,
    /// Magnitude of the determinant.
    determinant: f64,
    /// The sum of the magnitudes of its products over the determinant: by this much its relative error grows.
    cancelled: f64,
}

impl Cofactors {
    fn new(m: &DMat3) -> Self {
        let DMat3 { x_axis: a, y_axis: b, z_axis: c } = magnitudes(m);
        let cross = |a: DVec3, b: DVec3| a.yzx() * b.zxy() + a.zxy() * b.yzx();
        let determinant = m.determinant().abs();
        let sums = DMat3::from_cols(cross(b, c), cross(c, a), cross(a, b)).transpose();
        Self { sums, determinant, cancelled: a.dot(cross(b, c)) / determinant }
    }
}

/// Whether the kernel, which inverts an instance's transform in single precision, sees the instance where it is. One that it
/// does not is better copied into the scene's frame.
pub(super) fn inverts_well(transform: &DAffine3) -> bool {
    let Cofactors { determinant, cancelled, .. } = Cofactors::new(&transform.matrix3);
    (determinant as f32).is_normal() && cancelled < CANCELLED
}

fn magnitudes(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

impl InstanceTransform {
    /// The transform as the kernel is given it: rounded to single precision.
    pub(super) fn new(to_scene: DAffine3) -> Self {
        let to_scene = DAffine3::from_cols_array(&to_scene.to_cols_array().map(|x| f64::from(x as f32)));
        let m = to_scene.matrix3;
        let inverse = m.inverse();
        let rounding = magnitudes(&inverse) * PLACEMENT_ERROR;
        let Cofactors { sums, determinant, cancelled } = Cofactors::new(&m);
        // Cofactors over the determinant: what cancels in them was rounded before.
        let inverting =
            sums * (PLACEMENT_ERROR / determinant) + magnitudes(&inverse) * (PLACEMENT_ERROR * cancelled) + rounding;
        let stretch = magnitudes(&m);
        Self { to_scene, normals: inverse.transpose(), stretch, rounding, inverting }
    }

    /// How far from its plane, along the normal, a triangle may seem to the kernel because of its place; times the length of the
    /// normal after the transform. `p` is the point in the scene, `ng` the normal and `e1` and `e2` sides of the triangle in its
    /// own frame.
    #[inline]
    pub(super) fn error(&self, p: DVec3, ng: DVec3, [e1, e2]: [DVec3; 2]) -> f64 {
        let translation = self.to_scene.translation;
        let around = (p - translation).abs() + self.stretch * e1.abs().max(e2.abs());
        let moved = self.rounding * (p.abs() + translation.abs()) + self.inverting * around;
        ng.abs().dot(moved)
    }
}
