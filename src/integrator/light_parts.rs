//! Paths that keep apart the light that emitters send to the camera, the light that was scattered once, and the rest.
//!
//! The parts are those of the same paths, so that their sum is the picture: scattering by any surface counts, by mirrors and glass as
//! well as by walls. What passes a surface that is not there for it was not scattered.

use super::walk::{Limits, trace};
use super::wave::{Sample, Wave};
use super::{Context, Direct, FirstHit, Path, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// Path tracing or local illumination that fills [`Sample::parts`].
#[derive(Clone, Copy)]
pub struct LightParts {
    limits: Limits<'static>,
    /// Whether light samples look for lamps in flat mirrors.
    in_mirrors: bool,
}

impl LightParts {
    fn limits<'s>(&self, scene: &'s Scene) -> Limits<'s> {
        Limits { mirrors: scene.flat_mirrors().filter(|_| self.in_mirrors), ..self.limits }
    }
}

impl From<Path> for LightParts {
    fn from(path: Path) -> Self {
        Self { limits: path.limits(), in_mirrors: true }
    }
}

impl From<Direct> for LightParts {
    fn from(direct: Direct) -> Self {
        Self { limits: direct.limits(), in_mirrors: false }
    }
}

impl<C: Spectrum> Transport<C> for LightParts {
    type Memory = Wave<C>;

    /// A path by itself, whose parts nobody asks for.
    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        trace(ray, context.scene.media_at(&ray), context, first, &self.limits(context.scene))
    }

    const IN_WAVES: bool = true;

    #[inline(always)]
    fn li_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        _ends: &[usize],
        wave: &mut Wave<C>,
        tracer: &mut T,
    ) {
        wave.trace_in_parts(scene, samples, tracer, &self.limits(scene));
    }
}
