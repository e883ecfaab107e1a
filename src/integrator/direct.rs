//! Local illumination: emission, and light scattered once (the report's Figure 1a).
//!
//! Light sampling and Bsdf sampling are combined, so large lights and mirrors are as clean as they can be; perfect mirrors
//! and glass show the light sources and nothing else.
//!
//! `"integrator": { "type": "direct" }`, with `shadowRays` (1).

use super::path::{Limits, Path, trace};
use super::wave::{Sample, Wave};
use super::{FirstHit, Integrator, Tracer};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Local illumination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direct {
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
}

impl Direct {
    fn limits(&self) -> Limits {
        let path = Path { max_depth: Some(1), shadow_rays: self.shadow_rays };
        Limits { path, mirrors_see_lights: true, from: None }
    }
}

impl Integrator for Direct {
    #[inline]
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        trace(scene, ray, sampler, tracer, first, self.limits())
    }

    const IN_WAVES: bool = true;

    #[inline(always)]
    fn radiance_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S>],
        wave: &mut Wave,
        tracer: &mut T,
    ) {
        wave.trace(scene, samples, tracer, &self.limits());
    }
}
