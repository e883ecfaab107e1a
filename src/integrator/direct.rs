//! Local illumination: emission and light that is scattered exactly once (the report's Figure 1a).
//!
//! Light sampling and Bsdf sampling are combined by multiple importance sampling, so that large lights and mirrors have as
//! little noise as possible. Perfect mirrors and glass show the light sources and nothing else.
//!
//! `"integrator": { "type": "direct" }`, with `shadowRays` (1).

use super::walk::{Limits, trace};
use super::wave::{Sample, Wave};
use super::{Context, FirstHit, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// Local illumination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direct {
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
}

impl Direct {
    pub(super) fn limits(&self) -> Limits<'static> {
        Limits { max_depth: 1, mirrors_see_lights: true, ..Limits::new(self.shadow_rays) }
    }
}

impl<C: Spectrum> Transport<C> for Direct {
    type Memory = Wave<C>;

    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        trace(ray, context.scene.media_at(&ray), context, first, &self.limits())
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
        wave.trace(scene, samples, tracer, &self.limits());
    }
}
