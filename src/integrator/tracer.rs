//! What an integrator asks while it follows a path: rays, random numbers, the scene.

use crate::math::{Ray, Vec3};
use crate::scene::{Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// Answers rays: the scene itself, or something that also counts or records them.
pub trait Tracer {
    /// The nearest surface along the ray.
    fn intersect(&mut self, ray: &Ray) -> Option<Hit>;

    /// Whether nothing lies in the ray's segment.
    fn unoccluded(&mut self, ray: &Ray) -> bool;

    /// The nearest surface along each of the rays; what [`Tracer::intersect`] would answer. `hits` has the length of `rays`, and
    /// all of it is written.
    #[inline]
    fn intersect_many(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.intersect(ray));
    }

    /// Whether nothing lies in the segment of each of the rays; what [`Tracer::unoccluded`] would answer. `clear` has the length
    /// of `rays`, and all of it is written.
    #[inline]
    fn unoccluded_many(&mut self, rays: &[Ray], clear: &mut [bool]) {
        rays.iter().zip(clear).for_each(|(ray, clear)| *clear = self.unoccluded(ray));
    }
}

/// Traces in a scene and counts the rays.
#[derive(Clone, Copy, Debug)]
pub struct SceneTracer<'s> {
    pub(crate) scene: &'s Scene,
    /// Rays so far.
    pub rays: u64,
}

impl<'s> SceneTracer<'s> {
    /// A tracer that has counted nothing yet.
    pub fn new(scene: &'s Scene) -> Self {
        Self { scene, rays: 0 }
    }
}

impl Tracer for SceneTracer<'_> {
    #[inline]
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        self.scene.intersect(ray)
    }

    #[inline]
    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays += 1;
        self.scene.unoccluded(ray)
    }

    #[inline]
    fn intersect_many(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.rays += rays.len() as u64;
        self.scene.intersect_many(rays, hits);
    }

    #[inline]
    fn unoccluded_many(&mut self, rays: &[Ray], clear: &mut [bool]) {
        self.rays += rays.len() as u64;
        self.scene.unoccluded_many(rays, clear);
    }
}

/// What a camera ray met first, for the auxiliary layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Albedo there.
    pub albedo: Rgb,
    /// Shading normal, facing the camera.
    pub normal: Vec3,
    /// The point, scene frame.
    pub p: Vec3,
}

/// What an integrator works with while it follows one path.
#[derive(Debug)]
pub struct Context<'a, S, T, C: Spectrum = Rgb> {
    /// The scene.
    pub scene: &'a Scene,
    /// Random numbers of the path, at the first dimensions after those of its ray.
    pub sampler: &'a mut S,
    /// What answers rays.
    pub tracer: &'a mut T,
    /// The wavelengths that the path carries.
    pub wavelengths: C::Wavelengths,
}
