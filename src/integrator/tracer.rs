//! What an integrator uses while it follows a path: ray queries, random numbers and the scene.

use crate::math::{Ray, Vec3};
use crate::scene::{Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// Answers ray queries: the scene itself, or a wrapper that also counts or records rays.
pub trait Tracer {
    /// The nearest surface along the ray.
    fn intersect(&mut self, ray: &Ray) -> Option<Hit>;

    /// Whether no surface lies in the ray's segment.
    fn unoccluded(&mut self, ray: &Ray) -> bool;

    /// The nearest surface along each of the rays, as [`Tracer::intersect`] would find it. `hits` has the length of `rays`,
    /// and every element is written.
    #[inline]
    fn intersect_many(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.intersect(ray));
    }

    /// Whether no surface lies in the segment of each of the rays, as [`Tracer::unoccluded`] would answer. `clear` has the
    /// length of `rays`, and every element is written.
    #[inline]
    fn unoccluded_many(&mut self, rays: &[Ray], clear: &mut [bool]) {
        rays.iter().zip(clear).for_each(|(ray, clear)| *clear = self.unoccluded(ray));
    }
}

/// Traces rays in a scene and counts them.
#[derive(Clone, Copy, Debug)]
pub struct SceneTracer<'s> {
    pub(crate) scene: &'s Scene,
    /// Number of rays traced so far.
    pub rays: u64,
}

impl<'s> SceneTracer<'s> {
    /// Creates a tracer whose count is 0.
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

/// The first hit of a camera ray, for the auxiliary layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Albedo at the hit.
    pub albedo: Rgb,
    /// Shading normal, facing the camera.
    pub normal: Vec3,
    /// Position of the hit, scene frame.
    pub p: Vec3,
}

/// What an integrator works with while it follows one path.
#[derive(Debug)]
pub struct Context<'a, S, T, C: Spectrum = Rgb> {
    /// The scene.
    pub scene: &'a Scene,
    /// Random numbers of the path, at the first dimensions after those of its ray.
    pub sampler: &'a mut S,
    /// Answers the path's ray queries.
    pub tracer: &'a mut T,
    /// The wavelengths that the path carries.
    pub wavelengths: C::Wavelengths,
}
