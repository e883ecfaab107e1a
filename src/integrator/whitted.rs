//! Whitted's ray tracing: direct light, perfect mirrors and glass (Section 1.4 of the report).
//!
//! Glass is followed both ways as long as both ways carry enough; a branch that carries little is chosen by chance instead,
//! with the weight that keeps the mean, so no weight threshold cuts any light. Diffuse surfaces scatter light once:
//! indirect diffuse light and caustics are missing by design.
//!
//! `"integrator": { "type": "whitted" }`, with `shadowRays` (1) and `maxDepth` (none).
//!
//! Source: Whitted 1980, "An Improved Illumination Model for Shaded Display".

use super::light::Vertex;
use super::path::roulette;
use super::{FirstHit, Integrator, Tracer};
use crate::bsdf::Bsdf;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// A branch that would carry less than this is not split off.
const SMALLEST_BRANCH: f32 = 1.0 / 64.0;

/// Branches that can wait at a time. Each split leaves at least [`SMALLEST_BRANCH`] to both sides, and the stronger one
/// is followed first.
const WAITING: usize = 64;

/// Whitted's ray tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whitted {
    /// Greatest number of surface hits on a path, counting the first visible one. `None` cuts nothing.
    pub max_depth: Option<u32>,
    /// Light samples per hit, >= 1.
    pub shadow_rays: u32,
}

/// A ray still to be followed.
#[derive(Clone, Copy)]
struct Branch {
    ray: Ray,
    throughput: Rgb,
    /// As in path tracing: undoes the radiance scaling of refraction.
    eta2: f32,
    depth: u32,
}

impl Integrator for Whitted {
    #[inline]
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        let max_depth = self.max_depth.unwrap_or(u32::MAX);
        let start = Branch { ray, throughput: Rgb::ONE, eta2: 1.0, depth: 1 };
        let mut waiting = [start; WAITING];
        let mut count = 1;
        let mut radiance = Rgb::ZERO;
        while count > 0 {
            count -= 1;
            let branch = waiting[count];
            let Some(hit) = tracer.intersect(&branch.ray) else { continue };
            let vertex = Vertex::new(scene, &branch.ray, &hit);
            if branch.depth == 1 {
                first(vertex.first_hit());
            }
            radiance += branch.throughput * vertex.emitted(scene, None, 0);
            let bsdf = &vertex.material.bsdf;
            if bsdf.is_black() {
                continue;
            }
            if !bsdf.is_delta() {
                radiance += branch.throughput * self.direct_light(scene, &vertex, sampler, tracer);
                continue;
            }
            if branch.depth >= max_depth {
                continue;
            }

            // Both ways through glass, where both carry enough and there is room.
            if let Bsdf::Dielectric(dielectric) = bsdf
                && count + 2 <= WAITING
            {
                let (reflectance, reflected, refracted) = dielectric.branches(vertex.wo);
                let carried = branch.throughput.max_element() * branch.eta2;
                if let Some((refracted, eta)) = refracted
                    && carried * reflectance.min(1.0 - reflectance) >= SMALLEST_BRANCH
                {
                    let transmittance = (1.0 - reflectance) / (eta * eta);
                    for (wi, weight, eta) in [(reflected, reflectance, 1.0), (refracted, transmittance, eta)] {
                        if let Some(ray) = vertex.leave_local(wi) {
                            waiting[count] = Branch {
                                ray,
                                throughput: branch.throughput * weight,
                                eta2: branch.eta2 * eta * eta,
                                depth: branch.depth + 1,
                            };
                            count += 1;
                        }
                    }
                    continue;
                }
            }

            // One way: a mirror's only one, or one of glass's by chance.
            let u = sampler.next_4d();
            let Some(bounce) = vertex.sample_bounce(u) else { continue };
            let throughput = branch.throughput * bounce.weight;
            let eta2 = branch.eta2 * bounce.eta * bounce.eta;
            // Branches that were split off carry little from the start; only what is lost from there on is gambled with.
            let survival = roulette(throughput.max_element() * eta2 / SMALLEST_BRANCH, branch.depth);
            if u[3] < survival {
                let throughput = if survival < 1.0 { throughput / survival } else { throughput };
                waiting[count] = Branch { ray: bounce.ray, throughput, eta2, depth: branch.depth + 1 };
                count += 1;
            }
        }
        radiance
    }
}

impl Whitted {
    /// Light from the emitters, scattered once, by light samples and one Bsdf sample together.
    #[inline]
    fn direct_light<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        vertex: &Vertex,
        sampler: &mut S,
        tracer: &mut T,
    ) -> Rgb {
        if scene.emitters().is_dark() {
            return Rgb::ZERO;
        }
        let mut radiance = Rgb::ZERO;
        for _ in 0..self.shadow_rays {
            radiance += vertex.sample_light(scene, sampler.next_4d(), self.shadow_rays, tracer);
        }
        if let Some(bounce) = vertex.sample_bounce(sampler.next_4d())
            && let Some(hit) = tracer.intersect(&bounce.ray)
        {
            let from = bounce.pdf.map(|pdf| (vertex.receiver(), pdf));
            radiance += bounce.weight * Vertex::new(scene, &bounce.ray, &hit).emitted(scene, from, self.shadow_rays);
        }
        radiance
    }
}
