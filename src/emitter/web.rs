//! Photometric webs as distributions of light in the scene.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use crate::math::{DMat3, DQuat, DVec3, Vec3};
use crate::photometry::Web;

/// A web that stands in the scene. Its factor is luminous intensity \[cd\].
#[derive(Clone, Debug)]
pub struct TurnedWeb {
    web: Arc<Web>,
    /// From the lamp's frame to the world: the directions of C = 0, of C = 90 degrees and of gamma = 0.
    to_world: DMat3,
    flux: f64,
}

impl TurnedWeb {
    /// A web whose axis, gamma = 0, is the unit vector `axis`, and whose C = 0 is as near to `c0` as it can be. C grows
    /// counter-clockwise as seen along the axis, which is from above for a lamp that hangs. A `c0` along the axis has no part across it;
    /// then any direction across stands for it.
    pub fn new(web: Arc<Web>, axis: DVec3, c0: DVec3) -> Self {
        let across = c0 - axis * c0.dot(axis);
        // What is left of a vector along the axis is rounding, in any direction.
        let is_across = across.length() > 1e-9 * c0.length();
        let c0 = if is_across { across.normalize() } else { axis.any_orthonormal_vector() };
        let to_world = DMat3::from_cols(c0, c0.cross(axis), axis);
        let flux = web.flux();
        Self { web, to_world, flux }
    }

    /// The same lamp, turned.
    pub(super) fn turned(&self, rotation: DQuat) -> Self {
        Self { to_world: DMat3::from_quat(rotation) * self.to_world, ..self.clone() }
    }

    /// The intensity \[cd\] in a unit direction that leaves the lamp.
    pub fn factor(&self, direction: Vec3) -> f32 {
        self.web.candela(self.to_world.transpose() * direction.as_dvec3()) as f32
    }

    /// The luminous flux \[lm\].
    #[inline]
    pub fn flux(&self) -> f64 {
        self.flux
    }

    /// The largest intensity \[cd\].
    pub fn peak(&self) -> f64 {
        self.web.peak()
    }

    /// A unit direction with a density in proportion to the intensity; `u` is uniform in [0, 1)^2.
    pub fn sample(&self, u: [f64; 2]) -> Vec3 {
        (self.to_world * self.web.sample(u)).normalize().as_vec3a()
    }

    /// A cone that holds all of the light: its unit axis and its half angle.
    pub fn cone(&self) -> (DVec3, f64) {
        (self.to_world.z_axis, self.web.reach())
    }

    /// As [`TurnedWeb::cone`] of a web that shines into the hemisphere about `normal` only, which is about the axis or against it.
    pub(super) fn cone_about(&self, normal: DVec3) -> (DVec3, f64) {
        let (axis, reach) = self.cone();
        if axis.dot(normal) > 0.0 { (axis, reach.min(FRAC_PI_2)) } else { (-axis, FRAC_PI_2) }
    }

    /// The web.
    pub fn web(&self) -> &Web {
        &self.web
    }
}
