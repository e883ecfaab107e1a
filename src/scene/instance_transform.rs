//! Transforms of instances, and bounds on the error with which the kernel applies them.

use glam::Vec3Swizzles as _;

use crate::math::{Bounds, DAffine3, DMat3, DVec3, ROUNDING, shutter_time, time_segment};

/// Bound on the error of a coordinate that is transformed into an instance's frame, in units of the summands that make
/// the coordinate: half a unit in the last place of each summand.
const PLACEMENT_ERROR: f64 = 0.5 * ROUNDING as f64;

/// Bound on the error of a matrix's element that the kernel interpolates in time, in units of [`PLACEMENT_ERROR`]: of the
/// weight, its complement, two products and a sum.
const INTERPOLATION_ERRORS: f64 = 5.0;

/// A matrix is inverted accurately in single precision only while the sum of the magnitudes of its determinant's
/// products is less than this many times the determinant.
///
/// For rotations, and for stretches along the axes before or after a rotation, this ratio stays below 2 whatever the
/// stretch.
const CANCELLED: f64 = 16.0;

/// The transform of an instance, and bounds on the error with which the kernel transforms rays by it.
///
/// The kernel inverts the matrix in single precision and adds the inverse's translation, rounded, to every ray's
/// origin. Both operations move the ray in the object's frame by an error that need not be along the normal, nor small
/// in the scene: where the transform stretches, a step in the object's frame becomes many times as long in the scene
/// frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstanceTransform {
    pub to_scene: DAffine3,
    /// Inverse transpose of the matrix, which transforms normals.
    pub normals: DMat3,
    /// Absolute values of the matrix's elements.
    stretch: DMat3,
    /// Bound on the rounding error in the object's frame, for each unit of a coordinate in the scene frame.
    rounding: DMat3,
    /// Bound on the sum of the rounding error and the error of the inverse, in the same units as `rounding`.
    inverting: DMat3,
    /// The magnitudes between which the kernel interpolates, where the instance moves.
    interpolated: Option<Magnitudes>,
}

/// The larger magnitudes of the elements of two transforms.
#[derive(Clone, Copy, Debug)]
struct Magnitudes {
    matrix: DMat3,
    translation: DVec3,
}

impl Magnitudes {
    /// The larger of each element's magnitudes in the two transforms.
    fn larger(a: &DAffine3, b: &DAffine3) -> Self {
        let larger = |a: DVec3, b: DVec3| a.abs().max(b.abs());
        let (m, n) = (a.matrix3, b.matrix3);
        let matrix =
            DMat3::from_cols(larger(m.x_axis, n.x_axis), larger(m.y_axis, n.y_axis), larger(m.z_axis, n.z_axis));
        Self { matrix, translation: larger(a.translation, b.translation) }
    }
}

/// The transforms of an instance during the shutter interval.
#[derive(Debug)]
pub(super) struct InstancePath {
    start: InstanceTransform,
    /// The transforms at moments evenly spaced from time 0 to time 1; empty where the instance is at rest.
    steps: Box<[DAffine3]>,
    is_of_group: bool,
}

impl InstancePath {
    /// `steps` are the transforms at moments evenly spaced from time 0 to time 1, at least one.
    pub(super) fn new(steps: &[DAffine3]) -> Self {
        let start = InstanceTransform::new(steps[0]);
        let steps = if steps.len() == 1 { [].into() } else { steps.iter().map(rounded).collect() };
        Self { start, steps, is_of_group: false }
    }

    /// The path of a group at rest.
    pub(super) fn of_group(to_scene: DAffine3) -> Self {
        Self { is_of_group: true, ..Self::new(&[to_scene]) }
    }

    /// Whether the frame of the instance is that of a group, and not that of a mesh.
    pub(super) fn is_of_group(&self) -> bool {
        self.is_of_group
    }

    /// Whether the instance moves.
    pub(super) fn moves(&self) -> bool {
        !self.steps.is_empty()
    }

    /// The transform at time 0.
    pub(super) fn start(&self) -> &InstanceTransform {
        &self.start
    }

    /// A box around what this box of the instance's frame passes.
    pub(super) fn bounds(&self, own: &Bounds) -> Bounds {
        // Between two moments every point goes along a straight line, and stays in the boxes around both.
        let later = self.steps.iter().map(|step| own.transformed(step));
        later.fold(own.transformed(&self.start.to_scene), |all, one| all.union(one))
    }

    /// Calls `with` with the transform at this time ([`crate::math::Ray::time`]).
    #[inline(always)]
    pub(super) fn with_transform<R>(&self, time: f32, with: impl Fn(&InstanceTransform) -> R) -> R {
        if self.steps.is_empty() { with(&self.start) } else { with(&self.at(time)) }
    }

    /// The transform at this time of a moving instance.
    fn at(&self, time: f32) -> InstanceTransform {
        let (to_scene, [from, to]) = lerp_steps(&self.steps, time);
        InstanceTransform { interpolated: Some(Magnitudes::larger(from, to)), ..InstanceTransform::exact(to_scene) }
    }
}

/// The transform at this time ([`crate::math::Ray::time`]) among those at moments evenly spaced from time 0 to time 1, of which there
/// are two at least: its elements change linearly. Also returns the two between which it is.
pub(super) fn lerp_steps(steps: &[DAffine3], time: f32) -> (DAffine3, [&DAffine3; 2]) {
    let (step, weight) = time_segment(steps.len(), shutter_time(time));
    let (from, to, weight) = (&steps[step], &steps[step + 1], f64::from(weight));
    let between = DAffine3 {
        matrix3: from.matrix3 * (1.0 - weight) + to.matrix3 * weight,
        translation: from.translation.lerp(to.translation, weight),
    };
    (between, [from, to])
}

/// The transform as the kernel receives it, rounded to single precision.
fn rounded(transform: &DAffine3) -> DAffine3 {
    DAffine3::from_cols_array(&transform.to_cols_array().map(|x| f64::from(x as f32)))
}

/// The parts from which a matrix is inverted in single precision.
struct Cofactors {
    /// The transposed cofactors, in which the magnitudes of the products are added.
    sums: DMat3,
    /// Absolute value of the determinant.
    determinant: f64,
    /// The sum of the magnitudes of the determinant's products, divided by the determinant. This ratio is the factor by
    /// which the relative error of the determinant grows.
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

/// Returns whether the kernel, which inverts an instance's transform in single precision, sees the instance in its true
/// place. A mesh whose transform fails this test is better copied into the scene frame.
pub(super) fn inverts_well(transform: &DAffine3) -> bool {
    let Cofactors { determinant, cancelled, .. } = Cofactors::new(&transform.matrix3);
    (determinant as f32).is_normal() && cancelled < CANCELLED
}

fn magnitudes(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

impl InstanceTransform {
    /// Stores the transform as the kernel receives it, rounded to single precision.
    pub(super) fn new(to_scene: DAffine3) -> Self {
        Self::exact(rounded(&to_scene))
    }

    fn exact(to_scene: DAffine3) -> Self {
        let m = to_scene.matrix3;
        let inverse = m.inverse();
        let rounding = magnitudes(&inverse) * PLACEMENT_ERROR;
        let Cofactors { sums, determinant, cancelled } = Cofactors::new(&m);
        // The inverse consists of cofactors over the determinant. The products that cancel in the cofactors were
        // rounded before.
        let inverting =
            sums * (PLACEMENT_ERROR / determinant) + magnitudes(&inverse) * (PLACEMENT_ERROR * cancelled) + rounding;
        let stretch = magnitudes(&m);
        Self { to_scene, normals: inverse.transpose(), stretch, rounding, inverting, interpolated: None }
    }

    /// Bounds how far, along the normal, a triangle may appear to the kernel from its plane because of the instance's
    /// transform. The bound is multiplied by the length of the normal after the transform. `own` and `p` are the point in
    /// the triangle's own frame and in the scene frame, `ng` the normal and `e1` and `e2` are sides of the triangle in its
    /// own frame.
    #[inline]
    pub(super) fn error(&self, [own, p]: [DVec3; 2], ng: DVec3, [e1, e2]: [DVec3; 2]) -> f64 {
        let translation = self.to_scene.translation;
        let around = (p - translation).abs() + self.stretch * e1.abs().max(e2.abs());
        let mut moved = self.rounding * (p.abs() + translation.abs()) + self.inverting * around;
        if let Some(larger) = &self.interpolated {
            moved += self.rounding * (INTERPOLATION_ERRORS * (larger.matrix * own.abs() + larger.translation));
        }
        ng.abs().dot(moved)
    }
}
