//! Path tracing: global illumination by paths that start at the camera.
//!
//! The estimate is unbiased: it takes next-event estimation with multiple importance sampling at every surface that is not
//! perfectly specular, and Russian roulette instead of a depth limit. Path tracing is a poor choice for caustics of small
//! lights, since paths hit such lights only by chance.
//!
//! `"integrator": { "type": "path" }`, with `shadowRays` (1) light samples per hit, `firstShadowRays` at hits that the camera sees, and
//! `maxDepth` (none).
//!
//! Sources: Kajiya 1986, "The Rendering Equation"; Veach 1997, chapters 8 to 10; Arvo and Kirk 1990, "Particle Transport
//! and Image Synthesis" (roulette).

use super::light_tracing::LightPaths;
use super::walk::{Limits, trace};
use super::wave::{Sample, Wave};
use super::{Context, FirstHit, Tracer, Transport};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::{Rgb, Spectrum};

/// Path tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// Greatest number of surface hits, counting the first visible one. Light sources that a diffuse hit sees directly do
    /// not count. `None` sets no limit; a limit makes the estimate biased.
    pub max_depth: Option<u32>,
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
    /// The same for hits that the camera sees itself or by way of perfectly specular surfaces alone, >= 1.
    pub first_shadow_rays: u32,
}

impl Path {
    /// Path tracing with the same number of light samples at all hits.
    pub const fn new(max_depth: Option<u32>, shadow_rays: u32) -> Self {
        Self { max_depth, shadow_rays, first_shadow_rays: shadow_rays }
    }

    pub(super) fn limits(&self) -> Limits<'static> {
        Limits {
            max_depth: self.max_depth.unwrap_or(u32::MAX),
            first_shadow_rays: self.first_shadow_rays,
            ..Limits::new(self.shadow_rays)
        }
    }

    /// The same with the flat mirrors of a scene.
    pub(super) fn limits_in<'s>(&self, scene: &'s Scene) -> Limits<'s> {
        Limits { mirrors: scene.flat_mirrors(), ..self.limits() }
    }
}

impl<C: Spectrum> Transport<C> for Path {
    type Memory = Wave<C>;

    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        trace(ray, context.scene.media_at(&ray), context, first, &self.limits_in(context.scene))
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
        wave.trace(scene, samples, tracer, &self.limits_in(scene));
    }
}

/// Path tracing in three channels, beside light paths where a render has them.
#[derive(Clone, Debug)]
pub(crate) struct LitPath {
    pub path: Path,
    pub light_paths: Option<LightPaths>,
}

impl Transport<Rgb> for LitPath {
    type Memory = Wave<Rgb>;

    /// A path by itself.
    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, Rgb>,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        self.path.li(ray, context, first)
    }

    const IN_WAVES: bool = true;

    #[inline(always)]
    fn li_of_many<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        samples: &mut [Sample<S, Rgb>],
        _ends: &[usize],
        wave: &mut Wave<Rgb>,
        tracer: &mut T,
    ) {
        let limits = Limits { light_paths: self.light_paths.as_ref(), ..self.path.limits_in(scene) };
        wave.trace(scene, samples, tracer, &limits);
    }
}
