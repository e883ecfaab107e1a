//! A record: irradiance and its gradients at one point, and the region around the point where the record is valid.

use crate::math::{Frame, Vec3};
use crate::spectrum::Rgb;

use super::hemisphere::Estimate;

/// Most walls that limit a record's region.
pub(super) const MAX_WALLS: usize = 2;

/// Greatest height of a point over the mean tangent plane of the point and a record, in radii of the record. A point
/// beyond it lies on a step in front of the record or behind it.
const MAX_STEP: f32 = 0.05;

/// The sphere in which a record is valid. It takes 32 bytes and is all that most queries read.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordSphere {
    pub p: [f32; 3],
    /// 1 / radius.
    pub inverse_radius: f32,
    /// Unit normal on the side from which light comes.
    pub n: [f32; 3],
    /// Index of the record.
    pub record: u32,
}

/// Irradiance and its gradients at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct IrradianceRecord {
    /// Irradiance [W m^-2].
    irradiance: Rgb,
    /// Translation gradient: the change of irradiance along each axis of the scene frame.
    translation: [Rgb; 3],
    /// Rotation gradient: the change of irradiance for a rotation about each axis.
    rotation: [Rgb; 3],
    /// Planes behind which the record is invalid, each as the normal towards the record and the distance from it; (0,
    /// 0, 0) and 0 stand for none.
    walls: [([f32; 3], f32); MAX_WALLS],
}

impl RecordSphere {
    pub fn new(p: Vec3, n: Vec3, radius: f32, record: u32) -> Self {
        Self { p: p.to_array(), inverse_radius: 1.0 / radius, n: n.to_array(), record }
    }

    pub fn position(&self) -> Vec3 {
        Vec3::from_array(self.p)
    }

    pub fn normal(&self) -> Vec3 {
        Vec3::from_array(self.n)
    }

    pub fn radius(&self) -> f32 {
        1.0 / self.inverse_radius
    }

    /// The weight of the record at `p` with normal `n`. It is 1 at the record's own position and falls to 0 where the
    /// estimated error reaches the allowed error. The error is the greater of two: distance over radius, and the
    /// difference of the normals. The weight is not above 0 where the record is invalid.
    ///
    /// `inverse_error`: 1 / the allowed error.
    ///
    /// Sources: Ward et al. 1988, Eq. 4 (the error); Tabellion and Lamorlette 2004, Eq. 3 to 5 (a weight that falls to
    /// 0, the greater of the two errors).
    #[inline]
    pub fn weight(&self, p: Vec3, n: Vec3, inverse_error: f32) -> f32 {
        let offset = (p - self.position()) * self.inverse_radius;
        let distance2 = offset.length_squared();
        if distance2.is_nan() || distance2 >= 1.0 {
            return 0.0;
        }
        let own = self.normal();
        // Ward's test, applied to both sides: a point in front of the record or behind it sees other surfaces.
        let is_level = (offset.dot(n + own)).abs() <= 2.0 * MAX_STEP;
        let cos = n.dot(own);
        if !is_level || cos <= MIN_COSINE {
            return 0.0;
        }
        let turning_error = (1.0 - cos).max(0.0).sqrt() * inverse_error;
        1.0 - distance2.sqrt().max(turning_error)
    }
}

/// A record has no weight for a normal whose cosine with its own is below this, whatever error is allowed.
const MIN_COSINE: f32 = 0.5;

impl IrradianceRecord {
    /// The record of an estimate whose gradients are in `frame`. `gradient_scale` multiplies the translation gradient.
    pub fn new(estimate: &Estimate, frame: &Frame, gradient_scale: f32, walls: [([f32; 3], f32); MAX_WALLS]) -> Self {
        let [s, t] = [frame.s, frame.t].map(|axis| axis.to_array());
        let along = |[x, y]: [Rgb; 2]| std::array::from_fn(|axis| x * s[axis] + y * t[axis]);
        Self {
            irradiance: estimate.irradiance,
            translation: along(estimate.translation.map(|v| v * gradient_scale)),
            rotation: along(estimate.rotation),
            walls,
        }
    }

    /// Irradiance at `p` with normal `n`, extrapolated along the gradients; `None` behind one of the walls.
    #[inline]
    pub fn extrapolate(&self, sphere: &RecordSphere, p: Vec3, n: Vec3) -> Option<Rgb> {
        let offset = p - sphere.position();
        if self.walls.iter().any(|(normal, distance)| offset.dot(Vec3::from_array(*normal)) < -distance) {
            return None;
        }
        let axis = sphere.normal().cross(n);
        let [x, y, z] = &self.translation;
        let moved = *x * offset.x + *y * offset.y + *z * offset.z;
        let [x, y, z] = &self.rotation;
        let turned = *x * axis.x + *y * axis.y + *z * axis.z;
        Some((self.irradiance + moved + turned).max(Rgb::ZERO))
    }
}
