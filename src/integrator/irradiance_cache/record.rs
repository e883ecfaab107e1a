//! What is known of the irradiance at one point, and how far around that is worth anything.

use crate::math::{Frame, Vec3};
use crate::spectrum::Rgb;

use super::hemisphere::Estimate;

/// Walls that cut a record's ball.
pub(super) const WALLS: usize = 2;

/// Greatest distance of a point from the plane between a record and itself, in radii of the record: beyond, it lies on
/// a step in front of it or behind.
const STEP: f32 = 0.05;

/// Where a record speaks, 32 bytes: all that most queries look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub p: [f32; 3],
    /// 1 / radius.
    pub inverse_radius: f32,
    /// Unit normal on the side that light comes from.
    pub n: [f32; 3],
    /// Number of the record.
    pub record: u32,
}

/// What a record says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Irradiance [W m^-2].
    irradiance: Rgb,
    /// Its change along each axis of the scene frame.
    translation: [Rgb; 3],
    /// Its change for a rotation about each axis.
    rotation: [Rgb; 3],
    /// Planes behind which it says nothing: normal towards the record and distance from it. (0, 0, 0), 0 for none.
    walls: [([f32; 3], f32); WALLS],
}

impl Ball {
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

    /// The weight of the record at `p` with normal `n`, from 1 at its own place down to 0 where its error reaches what is
    /// allowed: by distance over radius, and by the turn of the normal. Not above 0 where it says nothing.
    ///
    /// `inverse_error`: 1 / the error that is allowed.
    ///
    /// Sources: Ward et al. 1988, Eq. 4 (the error); Tabellion and Lamorlette 2004, Eq. 3 to 5 (a weight that goes down to
    /// 0, the greater of the two errors).
    #[inline]
    pub fn weight(&self, p: Vec3, n: Vec3, inverse_error: f32) -> f32 {
        let way = (p - self.position()) * self.inverse_radius;
        let distance2 = way.length_squared();
        if distance2.is_nan() || distance2 >= 1.0 {
            return 0.0;
        }
        let own = self.normal();
        // Ward's test, for both sides: what lies in front of the record sees something else, and so does what lies behind.
        let is_level = (way.dot(n + own)).abs() <= 2.0 * STEP;
        let cos = n.dot(own);
        if !is_level || cos <= LEAST_COSINE {
            return 0.0;
        }
        let turn = (1.0 - cos).max(0.0).sqrt() * inverse_error;
        1.0 - distance2.sqrt().max(turn)
    }
}

/// Normals that are farther apart have nothing to say to each other, whatever error is allowed.
const LEAST_COSINE: f32 = 0.5;

impl Record {
    /// What an estimate in `frame` says. `fading`: what the translation gradient is multiplied with.
    pub fn new(estimate: &Estimate, frame: &Frame, fading: f32, walls: [([f32; 3], f32); WALLS]) -> Self {
        let [s, t] = [frame.s, frame.t].map(|axis| axis.to_array());
        let along = |[x, y]: [Rgb; 2]| std::array::from_fn(|axis| x * s[axis] + y * t[axis]);
        Self {
            irradiance: estimate.irradiance,
            translation: along(estimate.translation.map(|v| v * fading)),
            rotation: along(estimate.rotation),
            walls,
        }
    }

    /// Irradiance at `p` with normal `n`, as far as the gradients tell; `None` behind one of the walls.
    #[inline]
    pub fn at(&self, ball: &Ball, p: Vec3, n: Vec3) -> Option<Rgb> {
        let way = p - ball.position();
        if self.walls.iter().any(|(normal, distance)| way.dot(Vec3::from_array(*normal)) < -distance) {
            return None;
        }
        let axis = ball.normal().cross(n);
        let [x, y, z] = &self.translation;
        let moved = *x * way.x + *y * way.y + *z * way.z;
        let [x, y, z] = &self.rotation;
        let turned = *x * axis.x + *y * axis.y + *z * axis.z;
        Some((self.irradiance + moved + turned).max(Rgb::ZERO))
    }
}
