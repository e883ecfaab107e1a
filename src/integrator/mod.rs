//! Light transport: from a ray to the radiance that arrives along it.
//!
//! An [`Integrator`] is compiled once per kind of sampler and tracer, so that nothing is dispatched per ray. It sees no
//! film, no file and no thread.

mod direct;
mod irradiance;
pub mod irradiance_cache;
mod light;
mod path;
pub mod photon;
pub mod radiosity;
mod wave;
mod whitted;

pub use direct::Direct;
pub use irradiance::{Irradiance, Piece, Sites};
pub use path::Path;
pub use wave::{Sample, Wave};
pub use whitted::Whitted;

use crate::film::PixelPhotonState;
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

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

/// A light transport algorithm.
pub trait Integrator: Sync {
    /// An estimate of the radiance [W m^-2 sr^-1] that arrives at the ray's origin against its direction (unit length).
    ///
    /// `first` is told the first hit, if there is one. Unbiased unless a depth limit was asked for.
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb;

    /// The same, for integrators that remember something of each pixel.
    #[inline(always)]
    fn radiance_of_pixel<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
        _gathering: Option<&mut PixelPhotonState>,
    ) -> Rgb {
        self.radiance(scene, ray, sampler, tracer, first)
    }

    /// Whether several samples at once are faster than one after another. Not for what remembers something of each pixel.
    const IN_WAVES: bool = false;

    /// The radiance of several samples, each as [`Integrator::radiance`] would estimate it.
    #[inline(always)]
    fn radiance_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S>],
        _wave: &mut Wave,
        tracer: &mut T,
    ) {
        for Sample { ray, sampler, radiance, first } in samples {
            *first = None;
            *radiance = self.radiance(scene, *ray, sampler, tracer, &mut |hit| *first = Some(hit));
        }
    }
}
