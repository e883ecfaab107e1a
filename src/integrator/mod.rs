//! Light transport: from a ray to the radiance that arrives along it.
//!
//! An [`Integrator`] is compiled once for each kind of sampler and tracer, so that rays need no dynamic dispatch.
//! Integrators know no film, no file and no thread.

pub(crate) mod aim;
mod direct;
mod irradiance;
pub mod irradiance_cache;
mod light_parts;
pub mod light_tracing;
mod media;
mod mirrored;
mod path;
pub mod photon;
mod probes;
pub mod radiosity;
pub mod reuse;
mod support;
mod tracer;
mod vertex;
mod walk;
mod wave;
mod whitted;

pub use direct::Direct;
pub use irradiance::{Irradiance, Piece, Sites};
pub use light_parts::LightParts;
pub(crate) use path::LitPath;
pub use path::Path;
pub use probes::{Probe, ProbeQuantity, Probes};
pub use support::{
    check_bias, check_first_shadow_rays, check_light_parts, check_light_paths, check_reuse, check_still, check_support,
    check_wavelengths, no_choice, no_first_shadow_rays, no_light_paths, no_reuse, no_wavelengths,
};
pub use tracer::{Context, FirstHit, SceneTracer, Tracer};
pub use wave::{Sample, Wave};
pub use whitted::Whitted;

use crate::film::PixelPhotonState;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::{Rgb, Sensor, Spectrum};

/// A light transport algorithm over paths that carry `C`: three channels, or several wavelengths.
pub trait Transport<C: Spectrum>: Sync {
    /// What [`Transport::li_of_many`] keeps from call to call, so that later calls do not allocate.
    type Memory: Default;

    /// An estimate of the radiance [W m^-2 sr^-1] that arrives at the ray's origin against its direction (unit length).
    ///
    /// `first` receives the first hit, if there is one. The estimate is unbiased unless a depth limit was asked for.
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C;

    /// As [`Transport::li`], for integrators that keep state for each pixel.
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

    /// Whether estimating several samples at once is faster than one after another. Integrators that keep state for each
    /// pixel must leave this `false`.
    const IN_WAVES: bool = false;

    /// Whether the samples of neighbouring pixels are estimated together, so that each is a part of a group.
    const IN_GROUPS: bool = false;

    /// Estimates the radiance of several samples: each as by [`Transport::li`], or those of a group together. `ends`: index after the
    /// last sample of each group, where there are groups.
    #[inline(always)]
    fn li_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        _ends: &[usize],
        _memory: &mut Self::Memory,
        tracer: &mut T,
    ) {
        for Sample { ray, sampler, radiance, wavelengths, first, .. } in samples {
            *first = None;
            let mut context = Context { scene, sampler, tracer, wavelengths: *wavelengths };
            *radiance = self.li(*ray, &mut context, &mut |hit| *first = Some(hit));
        }
    }

    /// The moment of the shutter interval ([`Ray::time`]) that all samples see; `None` where each sees a moment of its own.
    #[inline(always)]
    fn moment(&self) -> Option<f32> {
        None
    }

    /// The wavelengths of a path for a sensor, drawn before the path begins. Methods whose photon maps have fixed wavelengths return
    /// those.
    #[inline(always)]
    fn wavelengths<S: Sampler>(&self, sampler: &mut S, sensor: Sensor) -> C::Wavelengths {
        C::sample_wavelengths_for(sensor, || sampler.next_4d()[0])
    }
}

/// A light transport algorithm in RGB, called without a [`Context`].
pub trait Integrator: Transport<Rgb> {
    /// An estimate of the radiance [W m^-2 sr^-1] that arrives at the ray's origin against its direction (unit length).
    ///
    /// `first` receives the first hit, if there is one. The estimate is unbiased unless a depth limit was asked for.
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

    /// Estimates the radiance of several samples, as [`Transport::li_of_many`].
    #[inline(always)]
    fn radiance_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S>],
        ends: &[usize],
        memory: &mut Self::Memory,
        tracer: &mut T,
    ) {
        self.li_of_many(scene, samples, ends, memory, tracer);
    }
}

impl<I: Transport<Rgb>> Integrator for I {}
