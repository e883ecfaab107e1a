//! Path tracing: everything, by following light backwards.
//!
//! Unbiased: next-event estimation with multiple importance sampling at every surface that is not perfectly specular,
//! Russian roulette instead of a depth limit. A poor choice for caustics of small lights, which only chance finds.
//!
//! `"integrator": { "type": "path" }`, with `shadowRays` (1) light samples per hit and `maxDepth` (none).
//!
//! Sources: Kajiya 1986, "The Rendering Equation"; Veach 1997, chapters 8 to 10; Arvo and Kirk 1990, "Particle Transport
//! and Image Synthesis" (roulette).

use super::light::Vertex;
use super::wave::{Sample, Wave};
use super::{FirstHit, Integrator, Tracer};
use crate::emitter::Receiver;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// From this bounce on no path survives with certainty, so that it ends even among perfect mirrors. Light guides and mirrors
/// that face each other show a thousand reflections without noise.
const CERTAIN_BOUNCES: u32 = 1024;

/// From this bounce on the survival probabilities that materials state give way to the library's own.
pub(super) const OWN_SURVIVAL_BOUNCES: u32 = 64;

/// A path that still carries this share of what it had after its first hit survives with certainty. Time to equal error in
/// the report's room is the same with 1/2 and with 1.
pub(super) const CERTAIN_FRACTION: f32 = 0.5;

/// Path tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// Greatest number of surface hits, counting the first visible one; light sources that a diffuse hit sees directly do
    /// not count. `None` cuts nothing; a limit is a bias.
    pub max_depth: Option<u32>,
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
}

impl Integrator for Path {
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

impl Path {
    fn limits(&self) -> Limits {
        Limits { path: *self, mirrors_see_lights: false, from: None }
    }
}

/// Where a path ends.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub path: Path,
    /// Whether a specular surface at the last allowed hit still shows the lights it reflects or refracts.
    pub mirrors_see_lights: bool,
    /// The receiver that the ray leaves and the density of its direction, where a light sample could have made it as well.
    pub from: Option<(Receiver, f32)>,
}

/// A path on its way.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// What it has brought so far.
    pub radiance: Rgb,
    throughput: Rgb,
    /// The last bounce's receiver and density, where a light sample could have made it as well.
    bounced: Option<(Receiver, f32)>,
    /// Undoes the radiance scaling of refraction for the roulette: a path inside glass is not worth less.
    eta2: f32,
    /// What a path has to carry to survive with certainty: a share of what was left after the first hit, so that indirect
    /// light on a dark wall is as clean, against its own brightness, as on a white one.
    roulette_reference: f32,
    /// Hits so far.
    depth: u32,
}

impl Walk {
    /// Before the first hit.
    #[inline]
    pub fn new(limits: &Limits) -> Self {
        Self {
            radiance: Rgb::ZERO,
            throughput: Rgb::ONE,
            bounced: limits.from,
            eta2: 1.0,
            roulette_reference: 1.0,
            depth: 0,
        }
    }

    /// What happens at the path's next vertex: the ray that it goes on with, if it does.
    ///
    /// `light` is given shadow rays, each with the radiance that it adds if nothing is in its way, to be added to the path's in
    /// this order and before the next hit.
    #[inline(always)]
    pub fn meet<S: Sampler>(
        &mut self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        sampler: &mut S,
        limits: &Limits,
        first: &mut impl FnMut(FirstHit),
        mut light: impl FnMut(&mut Rgb, Ray, Rgb),
    ) -> Option<Ray> {
        let Path { max_depth, shadow_rays } = limits.path;
        let max_depth = max_depth.unwrap_or(u32::MAX);
        self.depth += 1;
        let depth = self.depth;
        if depth == 1 {
            first(vertex.first_hit());
        }

        // Light that the surface itself sends.
        self.radiance += self.throughput * vertex.emitted(scene, self.bounced, shadow_rays);
        let bsdf = &vertex.material.bsdf;
        if depth > max_depth || bsdf.is_black() {
            return None;
        }

        // Light that reaches it straight from an emitter.
        if !bsdf.is_delta() && !scene.emitters().is_dark() {
            for _ in 0..shadow_rays {
                if let Some((shadow, sent)) = vertex.light_sample(scene, sampler.next_4d(), shadow_rays, false) {
                    light(&mut self.radiance, shadow, self.throughput * sent);
                }
            }
        }

        // The next direction.
        let u = sampler.next_4d();
        let bounce = vertex.sample_bounce(u)?;
        if depth == max_depth && bounce.pdf.is_none() && !limits.mirrors_see_lights {
            return None;
        }
        self.throughput *= bounce.weight;
        self.eta2 *= bounce.eta * bounce.eta;
        self.bounced = bounce.pdf.map(|pdf| (vertex.receiver(), pdf));

        // Russian roulette: by the throughput that the path still carries, or by the material's probability where the render
        // uses those that the scene states. The ray after the last allowed hit only looks for a light.
        if depth < max_depth {
            let carried = self.throughput.max_element() * self.eta2;
            if carried <= 0.0 {
                return None;
            }
            if depth == 1 {
                self.roulette_reference = CERTAIN_FRACTION * carried;
            }
            let share = match vertex.material.survival {
                Some(survival) if self.bounced.is_some() && depth < OWN_SURVIVAL_BOUNCES => survival,
                _ => carried / self.roulette_reference,
            };
            let survival = roulette(share, depth);
            if survival < 1.0 {
                if u[3] >= survival {
                    return None;
                }
                self.throughput /= survival;
            }
        }
        Some(bounce.ray)
    }
}

/// One path, from the first ray to the end.
#[inline]
pub(super) fn trace<S: Sampler, T: Tracer>(
    scene: &Scene,
    mut ray: Ray,
    sampler: &mut S,
    tracer: &mut T,
    first: &mut impl FnMut(FirstHit),
    limits: Limits,
) -> Rgb {
    let mut walk = Walk::new(&limits);
    while let Some(hit) = tracer.intersect(&ray) {
        let next =
            walk.meet(scene, &Vertex::new(scene, &ray, &hit), sampler, &limits, first, |radiance, shadow, sent| {
                if tracer.unoccluded(&shadow) {
                    *radiance += sent;
                }
            });
        match next {
            Some(next) => ray = next,
            None => break,
        }
    }
    walk.radiance
}

/// Survival probability of a path that carries this share of what would be worth following, after `depth` hits.
///
/// What loses nothing reaches hit n with probability (N / n)^2 beyond N = [`CERTAIN_BOUNCES`], so that it ends after 2 N hits
/// on the average. A constant probability q instead would make weights grow faster than an albedo above sqrt(q) makes
/// paths fade, and the variance infinite: at an albedo of 0.999, with any q below 0.998.
#[inline]
pub(super) fn roulette(share: f32, depth: u32) -> f32 {
    let most = if depth < CERTAIN_BOUNCES { 1.0 } else { 1.0 - 2.0 / depth as f32 };
    share.min(most)
}
