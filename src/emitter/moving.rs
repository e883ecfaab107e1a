//! Emitters that move while the shutter is open.
//!
//! They are sampled where they are at the time of the path. The choice among emitters knows no time: bounds hold for all times.

use super::tree::Cone;
use super::{DirectedPoint, Distribution, Emitter, EmitterSample, SphereEmitter, TriangleEmitter, sample_point};
use crate::math::{Bounds, DQuat, DVec3, KeyedPath, Vec3, shutter_time, time_segment};
use crate::shape::{Sphere, Triangle};
use crate::spectrum::Rgb;

/// An emitter that moves.
#[derive(Clone, Debug)]
pub enum MovingEmitter {
    /// A one-sided triangle whose corners move along straight lines between moments.
    Triangle {
        /// Corners at moments evenly spaced from time 0 to time 1, two or more.
        steps: Box<[[Vec3; 3]]>,
        /// Emitted radiance [W m^-2 sr^-1].
        radiance: Rgb,
        /// The bound of [`crate::math::HitPoint`] for points on it, at all times.
        error: f32,
    },
    /// A sphere that emits outwards, whose centre moves along straight lines between moments.
    Sphere {
        /// The sphere at moments evenly spaced from time 0 to time 1, two or more.
        steps: Box<[Sphere]>,
        /// Emitted radiance [W m^-2 sr^-1].
        radiance: Rgb,
    },
    /// A point.
    Point(MovingPoint),
}

/// A point light that a path of transforms moves and turns.
#[derive(Clone, Debug)]
pub struct MovingPoint {
    /// The position before it is moved, world frame.
    pub position: DVec3,
    /// The radiant intensity [W sr^-1], or that where the distribution is 1.
    pub intensity: Rgb,
    /// By what the radiant intensity is multiplied in each direction, before it is turned; `None` where it is the same in all.
    pub distribution: Option<Distribution>,
    /// The transforms.
    pub path: KeyedPath,
    /// When the shutter opens and closes, in the seconds of the path.
    pub interval: [f64; 2],
    /// World position of the scene frame's origin.
    pub centre: DVec3,
}

impl MovingPoint {
    /// Position in the scene frame and rotation at a time ([`crate::math::Ray::time`]).
    fn at(&self, time: f32) -> (Vec3, DQuat) {
        let [open, close] = self.interval;
        let pose = self.path.pose(open + (close - open) * f64::from(shutter_time(time)));
        ((pose.transform().transform_point3(self.position) - self.centre).as_vec3a(), pose.rotation)
    }

    fn sample(&self, p: Vec3, time: f32) -> Option<EmitterSample> {
        let (position, rotation) = self.at(time);
        let even = sample_point(p, position, self.intensity)?;
        let Some(distribution) = &self.distribution else { return Some(even) };
        let leaving = (rotation.conjugate() * -even.wi.as_dvec3()).as_vec3a();
        let factor = distribution.factor(leaving);
        (factor > 0.0).then(|| EmitterSample { radiance: even.radiance * factor, ..even })
    }

    fn flux(&self) -> f64 {
        self.distribution.as_ref().map_or(4.0 * std::f64::consts::PI, Distribution::flux)
    }

    /// The cone of its light, whatever the time.
    fn cone(&self) -> Cone {
        match &self.distribution {
            Some(distribution) if self.path.only_moves_in(self.interval) => {
                let (axis, angle) = distribution.cone();
                Cone { axis: self.path.pose(self.interval[0]).rotation * axis, angle }
            }
            _ => Cone::ALL,
        }
    }
}

impl MovingEmitter {
    /// The triangle at a time; `None` where it has no area then.
    fn triangle_at(steps: &[[Vec3; 3]], time: f32) -> Option<Triangle> {
        let (step, weight) = time_segment(steps.len(), shutter_time(time));
        let corner = |i: usize| {
            let [from, to] = [steps[step][i], steps[step + 1][i]].map(Vec3::as_dvec3);
            from.lerp(to, f64::from(weight)).as_vec3a()
        };
        Triangle::new([corner(0), corner(1), corner(2)])
    }

    /// Samples a direction from `p` towards the emitter at a time ([`crate::math::Ray::time`]), as emitters that rest do.
    #[cold]
    #[inline(never)]
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2], time: f32) -> Option<EmitterSample> {
        match self {
            Self::Triangle { steps, radiance, error } => {
                TriangleEmitter::new(Self::triangle_at(steps, time)?, *radiance, *error).sample(p, u)
            }
            Self::Sphere { steps, radiance } => {
                SphereEmitter { sphere: Sphere::between(steps, time), radiance: *radiance }.sample(p, u)
            }
            Self::Point(point) => point.sample(p, time),
        }
    }

    /// Density per solid angle at `p` of the direction that meets the emitter in `hit`, at a time ([`crate::math::Ray::time`]).
    #[cold]
    #[inline(never)]
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3, time: f32) -> f32 {
        match self {
            Self::Triangle { steps, radiance, error } => Self::triangle_at(steps, time)
                .map_or(0.0, |triangle| TriangleEmitter::new(triangle, *radiance, *error).pdf(p, hit)),
            Self::Sphere { steps, radiance } => {
                SphereEmitter { sphere: Sphere::between(steps, time), radiance: *radiance }.pdf(p)
            }
            Self::Point(_) => 0.0,
        }
    }

    /// The emitter at rest where it is at a time ([`crate::math::Ray::time`]); `None` where it has no area then.
    pub(crate) fn at(&self, time: f32) -> Option<Emitter> {
        Some(match self {
            Self::Triangle { steps, radiance, error } => {
                Emitter::Triangle(TriangleEmitter::new(Self::triangle_at(steps, time)?, *radiance, *error))
            }
            Self::Sphere { steps, radiance } => {
                Emitter::Sphere(SphereEmitter { sphere: Sphere::between(steps, time), radiance: *radiance })
            }
            Self::Point(point) => {
                let (position, rotation) = point.at(time);
                match &point.distribution {
                    None => Emitter::Point { position, intensity: point.intensity },
                    Some(distribution) => Emitter::Directed(Box::new(DirectedPoint {
                        position,
                        intensity: point.intensity,
                        distribution: distribution.turned(rotation),
                    })),
                }
            }
        })
    }

    /// Emitted power \[W\], the mean over the moments.
    pub(super) fn power(&self) -> DVec3 {
        match self {
            Self::Point(point) => point.flux() * point.intensity.to_f64(),
            Self::Triangle { radiance, .. } | Self::Sphere { radiance, .. } => {
                std::f64::consts::PI * self.area() * radiance.to_f64()
            }
        }
    }

    /// Emitting area [length^2], the mean over the moments; 0 for a point.
    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Triangle { steps, .. } => {
                let areas = steps.iter().map(|step| Triangle::new(*step).map_or(0.0, |it| f64::from(it.area)));
                areas.sum::<f64>() / steps.len() as f64
            }
            Self::Sphere { steps, .. } => steps.iter().map(Sphere::area).sum::<f64>() / steps.len() as f64,
            Self::Point(_) => 0.0,
        }
    }

    /// The radiance that leaves it; 0 of a point.
    pub(super) fn radiance(&self) -> Rgb {
        match self {
            Self::Triangle { radiance, .. } | Self::Sphere { radiance, .. } => *radiance,
            Self::Point(_) => Rgb::ZERO,
        }
    }

    /// Its centre at time 0.
    pub(super) fn centre(&self) -> Vec3 {
        match self {
            Self::Point(point) => point.at(0.0).0,
            Self::Triangle { steps, .. } => (steps[0][0] + steps[0][1] + steps[0][2]) / 3.0,
            Self::Sphere { steps, .. } => steps[0].centre.as_vec3a(),
        }
    }

    /// Radiant intensity in the brightest direction over the emitted power, in units of 1 / pi.
    pub(super) fn intensity_per_power(&self) -> f64 {
        match self {
            Self::Triangle { .. } => 1.0,
            Self::Sphere { .. } => 0.25,
            Self::Point(MovingPoint { distribution: None, .. }) => 0.25,
            Self::Point(MovingPoint { distribution: Some(distribution), .. }) => {
                let flux = distribution.flux();
                if flux > 0.0 { std::f64::consts::PI * distribution.peak() / flux } else { 0.0 }
            }
        }
    }

    /// A box around all places that it passes.
    pub(super) fn bounds(&self) -> Bounds {
        match self {
            Self::Triangle { steps, .. } => Bounds::around(steps.iter().flatten().map(|corner| corner.as_dvec3())),
            Self::Sphere { steps, .. } => {
                steps.iter().fold(Bounds::EMPTY, |bounds, sphere| bounds.union(sphere.bounds()))
            }
            Self::Point(point) => {
                let (places, radius) = point.path.reach(point.position, point.interval);
                let places = Bounds::around(places.into_iter().map(|place| place - point.centre));
                Bounds { min: places.min - radius, max: places.max + radius }
            }
        }
    }

    /// A cone around its normals at all times.
    pub(super) fn cone(&self) -> Cone {
        match self {
            Self::Point(point) => point.cone(),
            Self::Sphere { .. } => Cone::ALL,
            Self::Triangle { steps, .. } => {
                // Between two moments the normal is a combination, with weights above 0, of three cross products of sides.
                let sides = |step: &[Vec3; 3]| {
                    let [a, b, c] = step.map(Vec3::as_dvec3);
                    [b - a, c - a]
                };
                let normals = steps.windows(2).flat_map(|pair| {
                    let ([a, b], [c, d]) = (sides(&pair[0]), sides(&pair[1]));
                    [a.cross(b), a.cross(d) + c.cross(b), c.cross(d)]
                });
                let cones = normals.map(|normal| normal.try_normalize().map_or(Cone::ALL, Cone::along));
                let all = cones.reduce(Cone::union).unwrap_or(Cone::ALL);
                // A cone of more than a right angle holds no combinations.
                if all.angle < 1.5 { all } else { Cone::ALL }
            }
        }
    }

    /// Samples a point from which light leaves at time 0.
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> super::Departure {
        let nowhere = super::Departure { point: crate::math::HitPoint::new(self.centre(), 0.0), normal: None };
        self.at(0.0).map_or(nowhere, |start| start.sample_departure(u))
    }
}
