//! The paths of several groups, traced side by side up to their ends.

use super::connect::Connections;
use super::kept::KeptVertex;
use super::paths::{Arrival, At, First, Paths, Second};
use crate::bsdf::Model;
use crate::integrator::aim::Aims;
use crate::integrator::mirrored::{Folded, Way, unoccluded_by_mirrors};
use crate::integrator::tracer::Tracer;
use crate::integrator::vertex::Vertex;
use crate::integrator::walk::{Limits, Walk};
use crate::integrator::wave::Sample;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// Where a path is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Before the first vertex.
    ToFirst,
    /// Between the first vertex and the second.
    ToSecond,
    /// After a bounce at the second vertex that may be shared, before the next hit.
    ToThird,
    /// What the path finds from here on is reflected at the second vertex by its bounce, or is the path's own.
    Beyond,
    /// An aimed path before its first hit.
    Aimed,
    /// An aimed path that has met nothing but perfectly specular surfaces.
    AimedChain,
}

/// A ray from a first vertex towards a perfectly specular surface, its weight, which is f |cos| over the densities by which it and the path's
/// own bounce find the direction, and the sum of these densities (sr^-1). `None` where nothing is scattered.
#[inline]
fn aim<C: Spectrum>(vertex: &Vertex<'_, C>, aims: &Aims, u: [f32; 4]) -> Option<(Ray, C, f32)> {
    let (wi, pdf) = aims.sample(vertex.surface.point.p, vertex.facing(), u[0], [u[1], u[2]])?;
    let (ray, weight) = vertex.leave_towards(wi)?;
    let own = vertex.bsdf.pdf(vertex.wo, vertex.to_local(wi));
    let pdf = pdf + own;
    let weight = weight / pdf;
    weight.is_finite().then_some((ray, weight, pdf))
}

/// The paths of some groups. The memory is kept from wave to wave, so that later waves do not allocate.
#[derive(Default)]
pub struct Groups<C: Spectrum = Rgb> {
    walks: Vec<Walk<C>>,
    stages: Vec<Stage>,
    paths: Paths<C>,
    /// Indices of the active paths, and their rays.
    active: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Aimed paths that begin, and their rays.
    aimed: Vec<(u32, Ray)>,
    shadows: Vec<Ray>,
    arrivals: Vec<Arrival<C>>,
    /// Ways to lamps by flat mirrors, and what they bring if they are clear.
    ways: Vec<(Folded, Arrival<C>)>,
    clear: Vec<bool>,
    connections: Connections<C>,
}

impl<C: Spectrum> std::fmt::Debug for Groups<C> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Groups").field("paths", &self.walks.len()).finish_non_exhaustive()
    }
}

impl<C: Spectrum> Groups<C> {
    /// Traces the paths of all samples to their ends and connects those of each group. `ends`: index after the last sample of each
    /// group.
    #[inline(always)]
    pub(in crate::integrator) fn trace<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        ends: &[usize],
        tracer: &mut T,
        (limits, aims): (&Limits, &Aims),
    ) {
        self.prepare(samples, limits, !aims.is_empty());
        while !self.active.is_empty() {
            self.advance(scene, samples, tracer, limits, aims);
        }
        let Self { walks, paths, connections, .. } = self;
        for ((sample, walk), second) in samples.iter_mut().zip(&*walks).zip(&mut paths.seconds) {
            sample.radiance = match second {
                Some(second) if second.bounce.is_some() => {
                    second.beyond = walk.radiance;
                    second.own
                }
                _ => walk.radiance,
            };
        }
        let count = samples.len();
        for (sample, aimed) in samples.iter_mut().zip(walks.get(count..).unwrap_or_default()) {
            sample.radiance += aimed.radiance;
        }
        let is_limited = limits.max_depth != u32::MAX;
        let mut begin = 0;
        for end in ends {
            let add = |path: usize, light| samples[path].radiance += light;
            connections.connect(scene, paths, (begin..*end, is_limited), tracer, add);
            begin = *end;
        }
    }

    fn prepare<S: Sampler>(&mut self, samples: &mut [Sample<S, C>], limits: &Limits, aims: bool) {
        let count = samples.len();
        // Aimed paths come after the others.
        let most = if aims { 2 * count } else { count };
        self.walks.clear();
        self.walks.resize(most, Walk::new(limits.previous));
        self.stages.clear();
        self.stages.resize(count, Stage::ToFirst);
        self.stages.resize(most, Stage::Aimed);
        self.active.reserve(most);
        self.rays.reserve(most);
        self.aimed.clear();
        self.aimed.reserve(most);
        let Paths { firsts, seconds, lights, bsdfs } = &mut self.paths;
        firsts.clear();
        firsts.resize(count, None);
        seconds.clear();
        seconds.resize(count, None);
        self.active.clear();
        self.active.extend(0..count as u32);
        self.rays.clear();
        self.rays.extend(samples.iter().map(|sample| sample.ray));
        samples.iter_mut().for_each(|sample| sample.first = None);
        self.hits.resize(most.max(self.hits.len()), None);
        // The most that the vertices can send is reserved here, so that no later wave allocates.
        let most_shadows = most * limits.most_shadow_rays();
        self.shadows.clear();
        self.shadows.reserve(most_shadows);
        self.arrivals.clear();
        self.arrivals.reserve(most_shadows);
        self.ways.clear();
        if limits.mirrors.is_some() {
            self.ways.reserve(most_shadows);
        }
        self.clear.reserve(most_shadows.saturating_sub(self.clear.len()));
        lights.clear();
        lights.reserve(most_shadows);
        bsdfs.clear();
        bsdfs.reserve(2 * count);
    }

    /// Advances all active paths to their next vertices.
    #[inline(always)]
    fn advance<S: Sampler, T: Tracer>(
        &mut self,
        scene: &Scene,
        samples: &mut [Sample<S, C>],
        tracer: &mut T,
        limits: &Limits,
        aims: &Aims,
    ) {
        let Self { walks, stages, paths, active, rays, hits, aimed, shadows, arrivals, ways, clear, .. } = self;
        let count = samples.len();
        let hits = &mut hits[..active.len()];
        tracer.intersect_many(rays, hits);
        scene.prefetch(hits);
        shadows.clear();
        arrivals.clear();
        let mut kept = 0;
        for (i, hit) in hits.iter().enumerate() {
            let number = active[i];
            let path = number as usize;
            let Sample { sampler, first, wavelengths, .. } = &mut samples[path % count];
            let (walk, stage) = (&mut walks[path], &mut stages[path]);
            let Some(hit) = hit else {
                match stage {
                    // What the first vertex sees without mirrors is found by other samples.
                    Stage::Aimed => {}
                    Stage::ToThird => paths.take_infinite(scene, path, &rays[i], walk, limits, wavelengths),
                    _ => walk.escape(scene, &rays[i], wavelengths),
                }
                continue;
            };
            let mut slot = None;
            let vertex = Vertex::new(scene, &rays[i], hit, *wavelengths, None, &mut slot);
            if *stage == Stage::Aimed {
                // Only what the surface reflects or refracts perfectly has not been found by other samples.
                walk.depth += 1;
                let goes_on = walk.depth <= limits.max_depth && vertex.lobes.have_specular();
                let bounce = if goes_on { walk.bounce(&vertex, sampler, limits) } else { None };
                if let Some(bounce) = bounce.filter(|bounce| bounce.pdf.is_none()) {
                    *stage = Stage::AimedChain;
                    walk.keep_for_certain();
                    (active[kept], rays[kept]) = (number, bounce.ray);
                    kept += 1;
                }
                continue;
            }
            let goes_on = walk.arrive(scene, &vertex, limits, &mut |hit| *first = Some(hit));
            if *stage == Stage::ToThird {
                let samples = limits.shadow_rays as f32;
                paths.take_emission(path, walk, |receiver| samples * vertex.light_pdf(scene, receiver));
                *stage = Stage::Beyond;
            }
            if !goes_on {
                continue;
            }
            let mut send = |way, light, at| {
                let arrival = Arrival { path: number, light, at };
                match way {
                    Way::Straight(shadow) => {
                        shadows.push(shadow);
                        arrivals.push(arrival);
                    }
                    Way::ByMirrors(way) => ways.push((way, arrival)),
                }
            };
            let scatters = vertex.finds_light_samples();
            let own_bsdf = paths.bsdfs.len() as u32;
            if *stage == Stage::AimedChain && scatters {
                *stage = Stage::Beyond;
                let first = paths.firsts[path - count].map_or(C::ONE, |first| first.throughput);
                walk.end_of_chain(first, limits);
            }
            let next = if *stage == Stage::ToSecond && scatters && vertex.has_own_normal() {
                let mut second = Second::new(KeptVertex::new(scene, &vertex, own_bsdf), vertex.receiver(), walk);
                let mirrors = walk.mirrors_beside(limits);
                second.light(scene, &vertex, sampler, (limits.shadow_rays, mirrors), send);
                let next = second.leave(&vertex, walk, sampler, limits);
                if next.is_some() && second.bounce.is_none() {
                    walk.weigh(paths.weight_against_aims(path, aims, rays[i].direction));
                }
                *stage = if second.bounce.is_some() { Stage::ToThird } else { Stage::Beyond };
                paths.keep_bsdf(&second.vertex, slot.take());
                paths.seconds[path] = Some(second);
                next
            } else if *stage == Stage::ToFirst && scatters {
                let kept = KeptVertex::new(scene, &vertex, own_bsdf);
                let throughput = walk.throughput;
                let send = &mut |_: &mut C, way, light| send(way, light, At::Path);
                let before = *walk;
                let own_aims = (!aims.is_empty()).then_some(aims);
                let bounce = walk.scatter(scene, &vertex, sampler, (limits, own_aims), send);
                let left = bounce.as_ref().and_then(|bounce| Some((bounce.pdf?, bounce.survival)));
                *stage = if left.is_some() { Stage::ToSecond } else { Stage::Beyond };
                if !aims.is_empty()
                    && let Some((ray, weight, pdf)) = aim(&vertex, aims, sampler.next_4d())
                {
                    let light_paths = limits.light_paths.filter(|_| before.depth == 1);
                    let density = light_paths.map_or(0.0, |paths| paths.density(&vertex, ray.direction, pdf));
                    let previous = Some((vertex.receiver(), pdf / limits.first_shadow_rays as f32));
                    walks[count + path] = before.aimed(weight, density, previous);
                    aimed.push(((count + path) as u32, ray));
                }
                paths.keep_bsdf(&kept, slot.take());
                paths.firsts[path] = Some(First { vertex: kept, throughput, depth: before.depth, left });
                bounce.map(|bounce| bounce.ray)
            } else {
                let is_second = *stage == Stage::ToSecond;
                let send = &mut |_: &mut C, way, light| send(way, light, At::Path);
                let bounce = walk.scatter(scene, &vertex, sampler, (limits, None), send);
                if *stage == Stage::AimedChain {
                    walk.keep_for_certain();
                }
                if is_second {
                    // The light comes by a perfectly specular surface, which no other path can ask for it.
                    *stage = Stage::Beyond;
                    if bounce.as_ref().is_some_and(|bounce| bounce.pdf.is_none()) {
                        walk.weigh(paths.weight_against_aims(path, aims, rays[i].direction));
                    }
                }
                bounce.map(|bounce| bounce.ray)
            };
            if let Some(next) = next {
                (active[kept], rays[kept]) = (number, next);
                kept += 1;
            }
        }
        active.truncate(kept);
        rays.truncate(kept);
        for (number, ray) in aimed.drain(..) {
            active.push(number);
            rays.push(ray);
        }

        clear.resize(shadows.len(), false);
        tracer.unoccluded_many(shadows, clear);
        for (arrival, clear) in arrivals.iter().zip(&*clear) {
            if *clear {
                paths.add(arrival, walks);
            }
        }
        if !ways.is_empty() {
            unoccluded_by_mirrors(tracer, ways, shadows, clear, |arrival| paths.add(arrival, walks));
        }
    }
}
