//! Light transport: from a ray to the radiance that arrives along it.
//!
//! An [`Integrator`] is compiled once per kind of sampler and tracer, so that nothing is dispatched per ray. It sees no
//! film, no file and no thread.

mod direct;
mod irradiance;
pub mod irradiance_cache;
mod path;
pub mod photon;
pub mod radiosity;
mod support;
mod vertex;
mod walk;
mod wave;
mod whitted;

pub use direct::Direct;
pub use irradiance::{Irradiance, Piece, Sites};
pub use path::Path;
pub use support::check_lobes;
pub use wave::{Sample, Wave};
pub use whitted::Whitted;

use crate::film::PixelPhotonState;
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
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

/// A light transport algorithm over paths that carry `C`: three channels, or some wavelengths.
pub trait Transport<C: Spectrum>: Sync {
    /// An estimate of the radiance [W m^-2 sr^-1] that arrives at the ray's origin against its direction (unit length).
    ///
    /// `first` is told the first hit, if there is one. Unbiased unless a depth limit was asked for.
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C;

    /// The same, for integrators that remember something of each pixel.
    #[inline(always)]
    fn li_of_pixel<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
        _memory: Option<&mut PixelPhotonState>,
    ) -> C {
        self.li(ray, context, first)
    }

    /// Whether several samples at once are faster than one after another. Not for what remembers something of each pixel.
    const IN_WAVES: bool = false;

    /// The radiance of several samples, each as [`Transport::li`] would estimate it.
    #[inline(always)]
    fn li_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        _wave: &mut Wave<C>,
        tracer: &mut T,
    ) {
        for Sample { ray, sampler, radiance, wavelengths, first } in samples {
            *first = None;
            let mut context = Context { scene, sampler, tracer, wavelengths: *wavelengths };
            *radiance = self.li(*ray, &mut context, &mut |hit| *first = Some(hit));
        }
    }

    /// The wavelengths of a path, drawn before it begins. Methods whose maps have wavelengths of their own give those.
    #[inline(always)]
    fn wavelengths<S: Sampler>(&self, sampler: &mut S) -> C::Wavelengths {
        C::sample_wavelengths(|| sampler.next_4d()[0])
    }
}

/// A light transport algorithm in RGB, by one call.
pub trait Integrator: Transport<Rgb> {
    /// An estimate of the radiance [W m^-2 sr^-1] that arrives at the ray's origin against its direction (unit length).
    ///
    /// `first` is told the first hit, if there is one. Unbiased unless a depth limit was asked for.
    #[inline(always)]
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        self.li(ray, &mut Context { scene, sampler, tracer, wavelengths: () }, first)
    }

    /// The same for several samples, as [`Transport::li_of_many`].
    #[inline(always)]
    fn radiance_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S>],
        wave: &mut Wave,
        tracer: &mut T,
    ) {
        self.li_of_many(scene, samples, wave, tracer);
    }
}

impl<I: Transport<Rgb>> Integrator for I {}
