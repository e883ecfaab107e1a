//! Light from infinity, the same from all directions.

use std::f64::consts::PI;

use super::{Departure, EmitterSample, Receiver};
use crate::math::{DVec3, Frame, HitPoint, Vec3};
use crate::sampling::warps;
use crate::spectrum::Rgb;

/// An environment of uniform radiance, infinitely far away.
///
/// A receiver with a normal is given cosine-distributed directions, any other uniform ones. Photons begin on the ball that
/// holds the scene.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentEmitter {
    /// Radiance from every direction [W m^-2 sr^-1].
    pub radiance: Rgb,
    /// Centre of the ball that holds the scene, scene frame.
    centre: Vec3,
    /// Its radius.
    radius: f32,
}

impl EnvironmentEmitter {
    /// An environment around everything that lies in the ball of this centre and radius (> 0), scene frame.
    pub fn new(radiance: Rgb, centre: Vec3, radius: f32) -> Self {
        Self { radiance, centre, radius }
    }

    /// Area of the ball from which photons come [length^2].
    pub(super) fn area(&self) -> f64 {
        4.0 * PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// Power that enters the ball (W): pi L A.
    pub(super) fn power(&self) -> DVec3 {
        PI * self.area() * self.radiance.to_f64()
    }

    /// Centre of the ball.
    pub(super) fn centre(&self) -> Vec3 {
        self.centre
    }

    /// Samples a direction for a receiver.
    #[inline]
    pub(super) fn sample(&self, receiver: &Receiver, u: [f32; 2]) -> EmitterSample {
        let wi = match receiver.normal() {
            Some(normal) => Frame::from_normal(normal).to_world(warps::cosine_hemisphere(u)).normalize(),
            None => warps::uniform_sphere(u),
        };
        // Beyond the ball, wherever the receiver is.
        let distance = 2.0 * self.radius + self.centre.distance(receiver.p);
        let target = receiver.p + wi * distance;
        EmitterSample { wi, target, radiance: self.radiance, pdf: self.pdf(receiver, wi), is_delta: false }
    }

    /// Density of a direction (sr^-1).
    #[inline]
    pub(super) fn pdf(&self, receiver: &Receiver, wi: Vec3) -> f32 {
        match receiver.normal() {
            Some(normal) => warps::cosine_hemisphere_pdf(normal.dot(wi)),
            None => (0.25 / PI) as f32,
        }
    }

    /// A place on the ball, uniformly by area, with the normal inwards.
    #[inline]
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        let outwards = warps::uniform_sphere(u);
        Departure { point: HitPoint { p: self.centre + outwards * self.radius, error: 0.0 }, normal: Some(-outwards) }
    }
}
