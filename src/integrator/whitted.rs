//! Whitted's ray tracing: direct light, perfect mirrors and glass (Section 1.4 of the report).
//!
//! Both the reflected and the refracted ray of glass are followed as long as both carry enough throughput. Otherwise one of
//! them is chosen at random, with the weight that keeps the mean, so that no threshold on the throughput loses light.
//! Diffuse surfaces scatter light once: indirect diffuse light and caustics are missing by design.
//!
//! `"integrator": { "type": "whitted" }`, with `shadowRays` (1) and `maxDepth` (none).
//!
//! Source: Whitted 1980, "An Improved Illumination Model for Shaded Display".

use super::media::{arrive, left_after};
use super::vertex::{Vertex, escaped};
use super::walk::{roulette, scattered_light};
use super::{Context, FirstHit, Tracer, Transport};
use crate::bsdf::BsdfSample;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::PathMedia;
use crate::spectrum::Spectrum;

/// Least throughput of a branch that is split off.
const SMALLEST_BRANCH: f32 = 1.0 / 64.0;

/// Greatest number of branches that wait at a time. Each split leaves at least [`SMALLEST_BRANCH`] to both branches, and the
/// stronger one is followed first.
const WAITING: usize = 64;

/// Whitted's ray tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whitted {
    /// Greatest number of surface hits on a path, counting the first visible one. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
}

/// A ray that is still to be followed.
#[derive(Clone, Copy)]
struct Branch<C: Spectrum> {
    ray: Ray,
    throughput: C,
    /// Whether the branch goes on with its first wavelength alone.
    alone: C::Alone,
    /// Compensates the radiance scaling of refraction, as in path tracing.
    eta2: f32,
    depth: u32,
    /// The media in which the ray starts.
    media: Option<PathMedia>,
}

impl<C: Spectrum> Transport<C> for Whitted {
    type Memory = ();

    #[inline]
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        let max_depth = self.max_depth.unwrap_or(u32::MAX);
        let (throughput, alone) = (C::ONE, C::Alone::default());
        let start = Branch { ray, throughput, alone, eta2: 1.0, depth: 1, media: context.scene.media_at(&ray) };
        let mut waiting = [start; WAITING];
        let mut count = 1;
        let mut radiance = C::ZERO;
        while count > 0 {
            count -= 1;
            let mut branch = waiting[count];
            let hit = arrive(context.scene, context.tracer, &branch.ray, &mut branch.media);
            if branch.media.is_some() {
                let wavelengths = &context.wavelengths;
                branch.throughput *=
                    left_after::<C>(context.scene, &branch.ray, hit.as_ref(), branch.media, wavelengths);
            }
            let Some(hit) = hit else {
                let (ray, from_camera) = (&branch.ray, branch.depth == 1);
                let light = escaped::<C>(context.scene, ray, None, from_camera, &context.wavelengths);
                radiance += branch.throughput * light;
                continue;
            };
            let mut slot = None;
            let vertex = Vertex::new(context.scene, &branch.ray, &hit, context.wavelengths, branch.media, &mut slot);
            if branch.depth == 1 {
                first(vertex.first_hit(context.scene));
            }
            radiance += branch.throughput * vertex.emitted(context.scene, None);
            if vertex.lobes.is_empty() {
                continue;
            }
            if vertex.finds_light_samples() {
                if !context.scene.emitters().is_dark() {
                    radiance +=
                        branch.throughput * scattered_light(&vertex, context, 0, self.shadow_rays, branch.alone);
                }
                if !vertex.lobes.have_specular() {
                    continue;
                }
            }
            if branch.depth >= max_depth {
                continue;
            }

            // All rays are followed where there are several, all carry enough throughput and all can wait.
            let lobes = vertex.specular_lobes();
            let branches = lobes.iter().flatten().count();
            if branches > 1 && count + branches <= WAITING {
                let carried = branch.throughput.max_element() * branch.eta2;
                let share = |lobe: &BsdfSample<C>| lobe.weight.max_element() * (lobe.eta * lobe.eta);
                let least = lobes.iter().flatten().map(share).fold(f32::INFINITY, f32::min);
                if carried * least >= SMALLEST_BRANCH {
                    for lobe in lobes.into_iter().flatten() {
                        if let Some(ray) = vertex.leave_specular(&lobe) {
                            let mut alone = branch.alone;
                            let mut throughput = branch.throughput * lobe.weight;
                            if vertex.disperses(lobe.wi) {
                                throughput = throughput.keep_first(&mut alone);
                            }
                            waiting[count] = Branch {
                                ray,
                                throughput,
                                alone,
                                eta2: branch.eta2 * lobe.eta * lobe.eta,
                                depth: branch.depth + 1,
                                media: vertex.media_beyond(context.scene, &ray),
                            };
                            count += 1;
                        }
                    }
                    continue;
                }
            }

            // Otherwise a single ray is followed: a mirror's only one, or one of glass's two, chosen at random.
            let u = context.sampler.next_4d();
            let Some(bounce) = vertex.sample_bounce(u) else { continue };
            if bounce.pdf.is_some() {
                // A lobe with a density beside a delta lobe: its light is direct light.
                continue;
            }
            let mut throughput = branch.throughput * bounce.weight;
            if C::HAS_WAVELENGTHS && bounce.disperses {
                throughput = throughput.keep_first(&mut branch.alone);
            }
            let eta2 = branch.eta2 * bounce.eta * bounce.eta;
            // Branches that were split off have a low throughput from the start; the roulette depends only on what they lose
            // after it.
            let survival = roulette(throughput.max_element() * eta2 / SMALLEST_BRANCH, branch.depth);
            if u[3] < survival {
                let throughput = if survival < 1.0 { throughput / survival } else { throughput };
                let media = vertex.media_beyond(context.scene, &bounce.ray);
                let (ray, alone) = (bounce.ray, branch.alone);
                waiting[count] = Branch { ray, throughput, alone, eta2, depth: branch.depth + 1, media };
                count += 1;
            }
        }
        radiance
    }
}
