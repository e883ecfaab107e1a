//! Points that do not shine the same in all directions.

use crate::math::{DQuat, DVec3, Vec3};
use crate::spectrum::Rgb;

use super::spot::Spot;
use super::web::TurnedWeb;

/// A point whose radiant intensity varies by direction.
#[derive(Clone, Debug)]
pub struct DirectedPoint {
    /// Position.
    pub position: Vec3,
    /// The radiant intensity [W sr^-1] where the distribution is 1.
    pub intensity: Rgb,
    /// By what the radiant intensity in each direction is multiplied.
    pub distribution: Distribution,
}

/// A factor of each direction on the radiant intensity of a point.
#[derive(Clone, Debug)]
pub enum Distribution {
    /// A cone of light.
    Spot(Spot),
    /// A measured lamp.
    Web(TurnedWeb),
}

impl DirectedPoint {
    /// Emitted power \[W\].
    pub fn power(&self) -> DVec3 {
        self.distribution.flux() * self.intensity.to_f64()
    }
}

impl Distribution {
    /// The same distribution, turned.
    pub(super) fn turned(&self, rotation: DQuat) -> Self {
        match self {
            Self::Spot(spot) => Self::Spot(spot.turned(rotation)),
            Self::Web(web) => Self::Web(web.turned(rotation)),
        }
    }

    /// The factor of a unit direction that leaves the point.
    #[inline]
    pub fn factor(&self, direction: Vec3) -> f32 {
        match self {
            Self::Spot(spot) => spot.factor(direction),
            Self::Web(web) => web.factor(direction),
        }
    }

    /// The integral of the factor over the sphere \[sr\].
    #[inline]
    pub fn flux(&self) -> f64 {
        match self {
            Self::Spot(spot) => spot.flux(),
            Self::Web(web) => web.flux(),
        }
    }

    /// The largest factor.
    pub fn peak(&self) -> f64 {
        match self {
            Self::Spot(_) => 1.0,
            Self::Web(web) => web.peak(),
        }
    }

    /// A unit direction whose density is [`Self::pdf`]; `u` is uniform in [0, 1)^2, and `more`, of which the same is true, has further
    /// digits of it for grids of many cells.
    #[inline]
    pub fn sample(&self, u: [f32; 2], more: [f32; 2]) -> Vec3 {
        let digits = |k: usize| f64::from(u[k]) + f64::from(more[k]) * (-24_f64).exp2();
        match self {
            Self::Spot(spot) => spot.sample(u),
            Self::Web(web) => web.sample([digits(0), digits(1)]),
        }
    }

    /// The density of [`Self::sample`] [sr^-1]: the factor over its integral.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f64 {
        f64::from(self.factor(direction)) / self.flux()
    }

    /// A cone, by its unit axis and its half angle, outside of which the factor is 0.
    pub fn cone(&self) -> (DVec3, f64) {
        match self {
            Self::Spot(spot) => spot.cone(),
            Self::Web(web) => web.cone(),
        }
    }

    /// A bound of the share of the light that goes into a cone around the unit `axis` with this 1 - cos at its edge.
    pub fn most_into(&self, axis: Vec3, one_minus_cos: f64) -> f64 {
        most_into(self.cone(), self.peak() / self.flux(), axis, one_minus_cos)
    }
}

/// A bound of the share of light that goes into a cone around the unit `axis` with this 1 - cos at its edge, of light that stays in a
/// cone of its own, by its unit axis and its half angle, and whose largest intensity is `peak` times its flux.
pub(super) fn most_into((own, angle): (DVec3, f64), peak: f64, axis: Vec3, one_minus_cos: f64) -> f64 {
    let axis = axis.as_dvec3();
    let between = own.cross(axis).length().atan2(own.dot(axis));
    let other = 2.0 * (0.5 * one_minus_cos).sqrt().min(1.0).asin();
    if between > angle + other {
        return 0.0;
    }
    (std::f64::consts::TAU * one_minus_cos * peak).min(1.0)
}
