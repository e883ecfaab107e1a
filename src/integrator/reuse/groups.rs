//! The paths of several groups, traced side by side up to their ends.

use super::connect::Connections;
use super::kept::KeptVertex;
use crate::bsdf::{Bsdf, Model};
use crate::desc::MAX_SHADOW_RAYS;
use crate::emitter::Receiver;
use crate::integrator::aim::Aims;
use crate::integrator::tracer::Tracer;
use crate::integrator::vertex::{LightSample, Vertex};
use crate::integrator::walk::{Limits, Walk};
use crate::integrator::wave::Sample;
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::sampling::mis::balance_heuristic;
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

/// The first vertex of a path that is not perfectly specular.
#[derive(Clone, Copy, Debug)]
pub(super) struct First<C: Spectrum> {
    pub vertex: KeptVertex<C>,
    /// Throughput of the path up to the vertex.
    pub throughput: C,
    /// Number of hits up to the vertex, itself included.
    pub depth: u32,
    /// Density of the path's next direction (sr^-1), and the probability with which the path survived its bounce; `None` where it
    /// goes on by a perfectly specular lobe, or ends.
    pub left: Option<(f32, f32)>,
}

/// The second vertex of a path, with the light that arrives there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Second<C: Spectrum> {
    pub vertex: KeptVertex<C>,
    /// Throughput of the path up to the vertex.
    pub weight: C,
    /// Radiance that the path brings besides what the vertex scatters.
    pub own: C,
    /// What light samples bring, where the Bsdf is constant: radiance that is reflected into all directions.
    pub reflected: C,
    /// The light samples, where it is not, and the light that is emitted at the next hit: ranges of [`Paths::lights`].
    pub lights: LightRange,
    pub emissions: LightRange,
    /// The path's next direction (local frame) and its density (sr^-1); `None` where the path ends or goes on as its own.
    pub bounce: Option<(Vec3, f32)>,
    /// Where the Bsdf is constant, the light that is emitted at the next hit, weighted against light samples, over the survival of the
    /// bounce.
    pub emitted: C,
    /// As what light samples see the vertex.
    receiver: Receiver,
    /// The light that the next hit reflects, over the same.
    pub beyond: C,
}

/// Light that arrives at a second vertex from an emitter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light<C: Spectrum> {
    /// The direction that the light comes from, local frame.
    pub wi: Vec3,
    /// Radiance times |cos|.
    pub light: C,
    /// Density of the direction by light samples, times their number (sr^-1).
    pub pdf: f32,
    /// Whether no Bsdf sample finds the light.
    pub alone: bool,
}

/// A range of [`Paths::lights`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LightRange {
    begin: u32,
    end: u32,
}

impl LightRange {
    #[inline]
    pub fn of<C: Spectrum>(self, lights: &[Light<C>]) -> &[Light<C>] {
        &lights[self.begin as usize..self.end as usize]
    }

    #[inline]
    pub fn is_empty(self) -> bool {
        self.begin == self.end
    }

    /// Adds a light. All lights of a range are added one after the other.
    #[inline]
    fn push<C: Spectrum>(&mut self, lights: &mut Vec<Light<C>>, light: Light<C>) {
        if self.is_empty() {
            self.begin = lights.len() as u32;
        }
        lights.push(light);
        self.end = lights.len() as u32;
    }
}

/// The vertices of paths that groups share.
#[derive(Debug, Default)]
pub(super) struct Paths<C: Spectrum> {
    pub firsts: Vec<Option<First<C>>>,
    pub seconds: Vec<Option<Second<C>>>,
    pub lights: Vec<Light<C>>,
    /// Scattering functions that materials have at one point only.
    pub bsdfs: Vec<Bsdf<C>>,
}

impl<C: Spectrum> Paths<C> {
    /// Keeps a Bsdf where the vertex, which was kept before, has one of its own.
    #[inline]
    fn keep_bsdf(&mut self, vertex: &KeptVertex<C>, bsdf: Option<Bsdf<C>>) {
        if vertex.has_own_bsdf() {
            self.bsdfs.extend(bsdf);
        }
    }

    /// The weight of a path whose second vertex is perfectly specular, against an aimed path that might have met it in this direction.
    #[inline]
    fn weight_against_aims(&self, path: usize, aims: &Aims, direction: Vec3) -> f32 {
        match &self.firsts[path] {
            Some(First { vertex, left: Some((pdf, _)), .. }) if !aims.is_empty() => {
                balance_heuristic(*pdf, aims.pdf(vertex.point.p, vertex.facing, direction))
            }
            _ => 1.0,
        }
    }

    /// Adds light that arrived without being occluded.
    #[inline]
    fn add(&mut self, arrival: &Arrival<C>, walks: &mut [Walk<C>]) {
        let Arrival { path, light, at } = *arrival;
        let second = match at {
            At::Path => None,
            _ => self.seconds[path as usize].as_mut(),
        };
        match (at, second) {
            (At::Second { wi, pdf, alone }, Some(second)) => {
                second.lights.push(&mut self.lights, Light { wi, light, pdf, alone });
            }
            (At::ConstantSecond, Some(second)) => second.reflected += light,
            _ => walks[path as usize].radiance += light,
        }
    }

    /// Takes what was emitted at the hit after the second vertex, which is the radiance that the path has brought since. `pdf`: density
    /// with which light samples would have found it (sr^-1).
    #[inline]
    fn take_emission(&mut self, path: usize, walk: &mut Walk<C>, pdf: impl FnOnce(Receiver) -> f32) {
        let emitted = std::mem::replace(&mut walk.radiance, C::ZERO);
        if emitted == C::ZERO {
            return;
        }
        let Some(second) = &mut self.seconds[path] else { return };
        match second.bounce {
            Some((wi, _)) if second.vertex.constant_f().is_none() => {
                let light = Light { wi, light: emitted * wi.z.abs(), pdf: pdf(second.receiver), alone: false };
                second.emissions.push(&mut self.lights, light);
            }
            _ => second.emitted = emitted,
        }
    }

    /// Takes what arrives from infinity at the second vertex.
    #[cold]
    #[inline(never)]
    fn take_infinite(
        &mut self,
        scene: &Scene,
        path: usize,
        ray: &Ray,
        walk: &mut Walk<C>,
        limits: &Limits,
        wavelengths: &C::Wavelengths,
    ) {
        let Some(second) = &self.seconds[path] else { return };
        if second.vertex.constant_f().is_some() {
            walk.escape(scene, ray, limits, wavelengths);
            return self.take_emission(path, walk, |_| 0.0);
        }
        let (emitters, samples) = (scene.emitters(), limits.shadow_rays as f32);
        emitters.each_infinite(ray.direction, |le, emitter| {
            walk.radiance = walk.throughput * emitters.in_spectrum::<C>(emitter, le, wavelengths);
            let pdf = |receiver| samples * emitters.pdf_infinite(emitter, receiver, ray.direction);
            self.take_emission(path, walk, pdf);
        });
    }
}

/// What an unoccluded shadow ray brings, and where.
#[derive(Clone, Copy, Debug)]
struct Arrival<C: Spectrum> {
    path: u32,
    light: C,
    at: At,
}

/// Where light arrives.
#[derive(Clone, Copy, Debug)]
enum At {
    /// At the camera: the light is the path's own.
    Path,
    /// At the first vertex, from a second vertex that reflects it into all directions.
    ConstantSecond,
    /// At the second vertex: see [`Light`].
    Second { wi: Vec3, pdf: f32, alone: bool },
}

/// A ray from a first vertex towards a perfectly specular surface, and its weight: f |cos| over the densities by which it and the path's own
/// bounce find the direction. `None` where nothing is scattered.
#[inline]
fn aim<C: Spectrum>(vertex: &Vertex<'_, C>, aims: &Aims, u: [f32; 4]) -> Option<(Ray, C)> {
    let (wi, pdf) = aims.sample(vertex.surface.point.p, vertex.facing(), u[0], [u[1], u[2]])?;
    let (ray, weight) = vertex.leave_towards(wi)?;
    let own = vertex.bsdf.pdf(vertex.wo, vertex.to_local(wi));
    let weight = weight / (pdf + own);
    weight.is_finite().then_some((ray, weight))
}

impl<C: Spectrum> Second<C> {
    /// Arrives at a second vertex.
    #[inline]
    fn new(vertex: KeptVertex<C>, receiver: Receiver, walk: &Walk<C>) -> Self {
        Self {
            vertex,
            weight: walk.throughput,
            own: walk.radiance,
            reflected: C::ZERO,
            lights: LightRange::default(),
            emissions: LightRange::default(),
            bounce: None,
            emitted: C::ZERO,
            receiver,
            beyond: C::ZERO,
        }
    }

    /// Takes light samples. `send` receives each shadow ray, the light that it brings, and where.
    #[inline(always)]
    fn light<S: Sampler>(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_, C>,
        sampler: &mut S,
        samples: u32,
        mut send: impl FnMut(Ray, C, At),
    ) {
        if scene.emitters().is_dark() {
            return;
        }
        let is_constant = self.vertex.constant_f().is_some();
        for _ in 0..samples {
            let u = sampler.next_4d();
            if let Some(sample) = vertex.sample_light(scene, u, samples, false, !is_constant) {
                if is_constant {
                    send(sample.shadow, sample.f * sample.radiance * sample.scale(), At::ConstantSecond);
                } else {
                    let LightSample { shadow, wi, radiance, pdf, alone, .. } = sample;
                    send(shadow, radiance * wi.z.abs(), At::Second { wi, pdf, alone });
                }
            }
        }
    }

    /// Samples the path's next direction, and lets the path begin again with what arrives from there. A path that is reflected
    /// perfectly goes on as its own.
    #[inline(always)]
    fn leave<S: Sampler>(
        &mut self,
        vertex: &Vertex<'_, C>,
        walk: &mut Walk<C>,
        sampler: &mut S,
        limits: &Limits,
    ) -> Option<Ray> {
        walk.begin_again();
        let bounce = walk.bounce(vertex, sampler, limits);
        match &bounce {
            Some(bounce) if let Some(pdf) = bounce.pdf => {
                self.bounce = Some((vertex.to_local(bounce.ray.direction), pdf));
                walk.begin_again_after(bounce.survival);
                if self.vertex.constant_f().is_none() {
                    // What the next hit emits is weighted for each first vertex by itself.
                    walk.previous = None;
                }
            }
            _ => walk.resume(self.own, self.weight),
        }
        bounce.map(|bounce| bounce.ray)
    }
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
        let most_shadows = most * limits.shadow_rays.min(MAX_SHADOW_RAYS) as usize;
        self.shadows.clear();
        self.shadows.reserve(most_shadows);
        self.arrivals.clear();
        self.arrivals.reserve(most_shadows);
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
        let Self { walks, stages, paths, active, rays, hits, aimed, shadows, arrivals, clear, .. } = self;
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
                if *stage == Stage::Aimed {
                } else if *stage == Stage::ToThird {
                    paths.take_infinite(scene, path, &rays[i], walk, limits, wavelengths);
                } else {
                    walk.escape(scene, &rays[i], limits, wavelengths);
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
            let mut send = |shadow, light, at| {
                shadows.push(shadow);
                arrivals.push(Arrival { path: number, light, at });
            };
            let scatters = vertex.finds_light_samples();
            let own_bsdf = paths.bsdfs.len() as u32;
            if *stage == Stage::AimedChain && scatters {
                *stage = Stage::Beyond;
                walk.end_of_chain(paths.firsts[path - count].map_or(C::ONE, |first| first.throughput));
            }
            let next = if *stage == Stage::ToSecond && scatters && vertex.has_own_normal() {
                let mut second = Second::new(KeptVertex::new(scene, &vertex, own_bsdf), vertex.receiver(), walk);
                second.light(scene, &vertex, sampler, limits.shadow_rays, send);
                let next = second.leave(&vertex, walk, sampler, limits);
                if next.is_some() && second.bounce.is_none() {
                    walk.throughput *= paths.weight_against_aims(path, aims, rays[i].direction);
                }
                *stage = if second.bounce.is_some() { Stage::ToThird } else { Stage::Beyond };
                paths.keep_bsdf(&second.vertex, slot.take());
                paths.seconds[path] = Some(second);
                next
            } else if *stage == Stage::ToFirst && scatters {
                let kept = KeptVertex::new(scene, &vertex, own_bsdf);
                let throughput = walk.throughput;
                let send = &mut |_: &mut C, shadow, light| send(shadow, light, At::Path);
                let before = *walk;
                let bounce = walk.scatter(scene, &vertex, sampler, limits, send);
                let left = bounce.as_ref().and_then(|bounce| Some((bounce.pdf?, bounce.survival)));
                *stage = if left.is_some() { Stage::ToSecond } else { Stage::Beyond };
                if !aims.is_empty()
                    && let Some((ray, weight)) = aim(&vertex, aims, sampler.next_4d())
                {
                    walks[count + path] = before.aimed(weight);
                    aimed.push(((count + path) as u32, ray));
                }
                paths.keep_bsdf(&kept, slot.take());
                paths.firsts[path] = Some(First { vertex: kept, throughput, depth: before.depth, left });
                bounce.map(|bounce| bounce.ray)
            } else {
                let is_second = *stage == Stage::ToSecond;
                let send = &mut |_: &mut C, shadow, light| send(shadow, light, At::Path);
                let bounce = walk.scatter(scene, &vertex, sampler, limits, send);
                if *stage == Stage::AimedChain {
                    walk.keep_for_certain();
                }
                if is_second {
                    // The light comes by a perfectly specular surface, which no other path can ask for it.
                    *stage = Stage::Beyond;
                    if bounce.as_ref().is_some_and(|bounce| bounce.pdf.is_none()) {
                        walk.throughput *= paths.weight_against_aims(path, aims, rays[i].direction);
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
    }
}
