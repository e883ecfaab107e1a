//! Analytic shapes that move while the shutter is open.

use super::instance_transform::lerp_steps;
use super::lower::WorldShape;
use crate::math::{Bounds, DAffine3, DVec3, ROUNDING, Ray};
use crate::shape::{Analytic, DRay, Disk, Quadric, Sphere};

/// A shape, and where it is at moments evenly spaced from time 0 to time 1. Between two of them, every point of it moves along a
/// straight line, but that spheres stay spheres.
#[derive(Debug)]
pub(super) struct MovingShape {
    body: MovingBody,
    /// From the shape's own frame to the scene, at least two.
    steps: Box<[DAffine3]>,
}

#[derive(Debug)]
enum MovingBody {
    /// At each moment.
    Sphere(Box<[Sphere]>),
    Disk {
        centre: DVec3,
        normal: DVec3,
        radius: f64,
    },
    /// As it is at time 0, and the transform of its frame to that of the shape, which is not its own where a sphere is stretched.
    Quadric(Box<Quadric>, DAffine3),
}

impl MovingShape {
    /// A shape from what it is in the scene at each moment, and the transforms of its own frame to the scene.
    pub(super) fn new(shapes: &[WorldShape], steps: &[DAffine3]) -> Self {
        let in_scene = |shape: &WorldShape| shape.in_scene(DVec3::ZERO);
        let body = match in_scene(&shapes[0]) {
            Analytic::Sphere(first) => MovingBody::Sphere(
                shapes
                    .iter()
                    .map(|shape| match in_scene(shape) {
                        Analytic::Sphere(sphere) => sphere,
                        _ => first,
                    })
                    .collect(),
            ),
            Analytic::Quadric(quadric) => {
                let own = match shapes[0] {
                    WorldShape::Quadric { to_world, .. } => steps[0].inverse() * to_world,
                    _ => DAffine3::IDENTITY,
                };
                MovingBody::Quadric(quadric, own)
            }
            Analytic::Disk(_) => match shapes[0] {
                WorldShape::Disk { centre, normal, radius, .. } => MovingBody::Disk { centre, normal, radius },
                _ => unreachable!("only a disk is one in the scene"),
            },
        };
        Self { body, steps: steps.into() }
    }

    /// Number of moments.
    pub(super) fn time_steps(&self) -> usize {
        self.steps.len()
    }

    /// The spheres at the moments, of a sphere.
    pub(super) fn spheres(&self) -> Option<&[Sphere]> {
        match &self.body {
            MovingBody::Sphere(spheres) => Some(spheres),
            _ => None,
        }
    }

    /// The transform of the shape's own frame to the scene at a time ([`Ray::time`]).
    pub(super) fn to_scene(&self, time: f32) -> DAffine3 {
        lerp_steps(&self.steps, time).0
    }

    /// The shape at a time ([`Ray::time`]).
    pub(super) fn at(&self, time: f32) -> Analytic {
        match &self.body {
            MovingBody::Sphere(spheres) => Analytic::Sphere(Sphere::between(spheres, time)),
            &MovingBody::Disk { centre, normal, radius } => {
                Analytic::Disk(Disk::new(centre, normal, radius, &self.to_scene(time)))
            }
            MovingBody::Quadric(quadric, own) => {
                Analytic::Quadric(Box::new(quadric.placed(self.to_scene(time) * *own)))
            }
        }
    }

    /// The nearest t at which a ray meets the shape at the ray's time.
    pub(super) fn intersect(&self, ray: &Ray) -> Option<f64> {
        let exact = DRay::from(ray);
        match &self.body {
            MovingBody::Sphere(spheres) => Sphere::between(spheres, ray.time).intersect(&exact),
            &MovingBody::Disk { centre, normal, radius } => {
                Disk::new(centre, normal, radius, &self.to_scene(ray.time)).intersect(&exact)
            }
            MovingBody::Quadric(quadric, own) => quadric.placed(self.to_scene(ray.time) * *own).intersect(&exact),
        }
    }

    /// A box around all places that the shape passes.
    pub(super) fn bounds(&self) -> Bounds {
        (0..self.time_steps()).fold(Bounds::EMPTY, |all, step| all.union(self.bounds_at(step)))
    }

    /// A box around the shape at one of the moments, with room for rounding where boxes are interpolated.
    pub(super) fn bounds_at(&self, step: usize) -> Bounds {
        let bounds = match &self.body {
            MovingBody::Sphere(spheres) => spheres[step].bounds(),
            &MovingBody::Disk { centre, normal, radius } => {
                Disk::new(centre, normal, radius, &self.steps[step]).bounds()
            }
            // The box of what it is at time 0 is that of its own frame, moved.
            MovingBody::Quadric(quadric, own) => quadric.own_bounds().transformed(&(self.steps[step] * *own)),
        };
        let room = 8.0 * f64::from(ROUNDING) * bounds.min.abs().max(bounds.max.abs());
        Bounds { min: bounds.min - room, max: bounds.max + room }
    }
}
