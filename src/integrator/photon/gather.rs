//! Eye paths that end in, or are helped by, photon maps.
//!
//! One loop serves all methods; what they differ in is decided when they are made:
//!
//! - the report's map gives direct light, where no shadow photon is near; the path goes on for the rest;
//! - the caustic map gives light that came by mirrors and glass only, at every diffuse hit; a path that finds a light by
//!   way of them after a diffuse bounce then counts for nothing, since it would be the same light twice;
//! - the map of indirect light ends a path at its first diffuse hit, and direct light comes from shadow rays (progressive
//!   methods); the global map ends it one diffuse bounce later (final gathering).
//!
//! Where a map's disk is not whole (see [`super::whole`]), the path goes on as path tracing does.

use std::cell::RefCell;
use std::sync::Arc;

use super::super::irradiance_cache::IrradianceCache;
use super::super::light::Vertex;
use super::super::path::{CERTAIN_SHARE, OWN_SURVIVAL_BOUNCES, roulette};
use super::super::{FirstHit, Integrator, Tracer};
use super::aim::Aims;
use super::cut::Cut;
use super::estimate::{Asked, Estimate, direct, radiance};
use super::whole::Whole;
use super::{Nearest, PhotonMap};
use crate::emitter::Receiver;
use crate::film::{Gathering, ShrinkingRadius};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

/// A map and how it is asked.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub map: Arc<PhotonMap>,
    pub asked: Asked,
    /// The radius that pixels with radii of their own begin with at most.
    pub widest: f32,
}

/// What ends a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ends {
    /// Nothing but chance.
    Never,
    /// The map of indirect light, at the first diffuse hit.
    AtOnce,
    /// The global map, after a diffuse bounce.
    AfterGather,
    /// The irradiance cache, at the first diffuse hit.
    AtCache,
}

/// How radii shrink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shrinking {
    /// All in the same way, or not at all.
    Together,
    /// Each pixel's by what it meets.
    ByPixel {
        /// Share of photons that is kept.
        alpha: f32,
        /// Photons that the first radius of a caustic holds.
        first: u32,
    },
}

/// Path tracing with photon maps.
#[derive(Clone, Debug)]
pub struct Gather {
    pub(super) direct: Option<Layer>,
    pub(super) caustic: Option<Layer>,
    /// Of indirect light, or of all of it, by `ends`.
    pub(super) diffuse: Option<Layer>,
    pub(super) cache: Option<Arc<IrradianceCache>>,
    /// Caustics beyond the first diffuse hit: fewer photons over a wider radius. Nobody sees how sharp they are there, and
    /// a bright caustic may hold half of all photons.
    pub(super) later_caustic: Option<Layer>,
    /// Where disks are whole.
    pub(super) whole: Whole,
    pub(super) ends: Ends,
    pub(super) shrinking: Shrinking,
    /// Number of the pass that the maps are of.
    pub(super) pass: u32,
    pub(super) max_depth: u32,
    pub(super) shadow_rays: u32,
    pub(super) min_photons: u32,
    pub(super) gather_rays: u32,
    /// Where light that comes by mirrors and glass only is looked for by the paths themselves, instead of in a map.
    pub(super) aims: Option<Aims>,
}

thread_local! {
    static NEAREST: RefCell<Nearest> = RefCell::default();
}

/// A path on its way.
#[derive(Clone, Copy)]
struct State {
    ray: Ray,
    throughput: Rgb,
    /// Undoes the radiance scaling of refraction for the roulette.
    eta2: f32,
    /// The last bounce's receiver and density, where a light sample could have made it as well.
    bounced: Option<(Receiver, f32)>,
    worth_following: f32,
    depth: u32,
    /// Diffuse hits so far.
    diffuse: u32,
    /// Length of the way since the last diffuse hit.
    way: f32,
    /// Whether light found by mirrors and glass only counts from here on.
    sees_caustics: bool,
}

impl State {
    fn new(ray: Ray) -> Self {
        Self {
            ray,
            throughput: Rgb::ONE,
            eta2: 1.0,
            bounced: None,
            worth_following: 1.0,
            depth: 1,
            diffuse: 0,
            way: 0.0,
            sees_caustics: true,
        }
    }

    /// One of so many paths that go on together.
    fn share(&mut self, paths: u32) {
        self.throughput /= paths as f32;
        self.worth_following /= paths as f32;
    }
}

/// Notes how far the first ray went.
struct Watched<'a, T> {
    tracer: &'a mut T,
    first: &'a mut f32,
}

impl<T: Tracer> Tracer for Watched<'_, T> {
    #[inline]
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        let hit = self.tracer.intersect(ray);
        if self.first.is_infinite()
            && let Some(hit) = &hit
        {
            *self.first = hit.t;
        }
        hit
    }

    #[inline]
    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.tracer.unoccluded(ray)
    }
}

impl Integrator for Gather {
    fn radiance<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
    ) -> Rgb {
        self.radiance_of_pixel(scene, ray, sampler, tracer, first, None)
    }

    fn radiance_of_pixel<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
        gathering: Option<&mut Gathering>,
    ) -> Rgb {
        let start = State::new(ray);
        let mut told = Told { gathering, bias: Rgb::ZERO };
        let radiance = self.follow(scene, start, sampler, tracer, first, &mut told);
        if let Some(gathering) = told.gathering {
            gathering.add_bias(self.pass, told.bias);
        }
        radiance
    }
}

/// What estimates tell the pixel.
struct Told<'g> {
    gathering: Option<&'g mut Gathering>,
    bias: Rgb,
}

impl Gather {
    /// Radiance [W m^-2 sr^-1] that arrives at a diffuse surface along a ray that leaves it, without what comes straight
    /// from the emitters or from them by mirrors and glass only; and the distance to what the ray meets, infinite for
    /// nothing.
    ///
    /// Together with direct light and caustics it is all light, each once.
    pub fn incident<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &mut S,
        tracer: &mut T,
    ) -> (Rgb, f32) {
        let mut distance = f32::INFINITY;
        let mut state = State::new(ray);
        (state.depth, state.diffuse, state.sees_caustics) = (2, 1, false);
        let mut tracer = Watched { tracer, first: &mut distance };
        let mut told = Told { gathering: None, bias: Rgb::ZERO };
        let radiance = self.follow(scene, state, sampler, &mut tracer, &mut |_| {}, &mut told);
        (radiance, distance)
    }

    /// The same whose paths end by chance only: what [`Gather::incident`] brings back is then as unbiased as path tracing,
    /// but for caustics.
    #[must_use]
    pub fn unaided(&self) -> Self {
        Self { cache: None, diffuse: None, ends: Ends::Never, ..self.clone() }
    }

    /// The same whose paths end where the cache answers.
    #[must_use]
    pub fn ending_at(&self, cache: Arc<IrradianceCache>) -> Self {
        Self { cache: Some(cache), diffuse: None, ends: Ends::AtCache, ..self.clone() }
    }

    fn follow<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        mut state: State,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
        told: &mut Told,
    ) -> Rgb {
        let mut radiance = Rgb::ZERO;
        loop {
            let Some(hit) = tracer.intersect(&state.ray) else { return radiance };
            state.way += hit.t;
            let vertex = Vertex::new(scene, &state.ray, &hit);
            if state.depth == 1 {
                first(vertex.first_hit());
            }
            // Light that the surface itself sends; what came by mirrors and glass to a diffuse surface is in a map.
            if state.sees_caustics || state.bounced.is_some() {
                radiance += state.throughput * vertex.emitted(scene, state.bounced, self.shadow_rays);
            }
            let bsdf = &vertex.material.bsdf;
            if state.depth > self.max_depth || bsdf.is_black() {
                return radiance;
            }
            let mut rays = 1;
            if !bsdf.is_delta() {
                state.diffuse += 1;
                state.sees_caustics = false;
                let (sent_back, is_over) = self.diffuse(scene, &vertex, &state, sampler, tracer, told);
                radiance += state.throughput * sent_back;
                if let Some(aims) = &self.aims {
                    radiance += self.reflected(scene, aims, &vertex, state, sampler, tracer);
                }
                if is_over {
                    return radiance;
                }
                if state.diffuse == 1 && self.ends == Ends::AfterGather {
                    rays = self.gather_rays;
                }
                state.way = 0.0;
            }
            for _ in 1..rays {
                let mut branch = state;
                branch.share(rays);
                if self.bounce(&vertex, &mut branch, sampler) {
                    radiance += self.follow(scene, branch, sampler, tracer, first, told);
                }
            }
            state.share(rays);
            if !self.bounce(&vertex, &mut state, sampler) {
                return radiance;
            }
        }
    }

    /// One sample of the light that comes to a surface by mirrors and glass only and is sent back along the path.
    fn reflected<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        aims: &Aims,
        vertex: &Vertex,
        mut state: State,
        sampler: &mut S,
        tracer: &mut T,
    ) -> Rgb {
        let [choice, u, v, _] = sampler.next_4d();
        let Some((wi, pdf)) = aims.sample(vertex.surface.point.p, vertex.facing(), choice, [u, v]) else {
            return Rgb::ZERO;
        };
        let Some((ray, f_cos)) = vertex.leave_towards(wi) else { return Rgb::ZERO };
        state.throughput *= f_cos / pdf;
        (state.ray, state.bounced) = (ray, None);
        state.worth_following = CERTAIN_SHARE * state.throughput.max_element() * state.eta2;
        state.depth = state.depth.saturating_add(1);
        let mut radiance = Rgb::ZERO;
        for way in 0.. {
            let Some(hit) = tracer.intersect(&state.ray) else { break };
            let vertex = Vertex::new(scene, &state.ray, &hit);
            if way > 0 {
                radiance += state.throughput * vertex.emitted(scene, None, 1);
            }
            if state.depth > self.max_depth
                || !vertex.material.bsdf.is_delta()
                || !self.bounce(&vertex, &mut state, sampler)
            {
                break;
            }
        }
        radiance
    }

    /// The next direction; false where the path ends.
    #[inline]
    fn bounce<S: Sampler>(&self, vertex: &Vertex, state: &mut State, sampler: &mut S) -> bool {
        let u = sampler.next_4d();
        let Some(bounce) = vertex.sample_bounce(u) else { return false };
        let is_last = state.depth == self.max_depth;
        if is_last && bounce.pdf.is_none() {
            return false;
        }
        state.throughput *= bounce.weight;
        state.eta2 *= bounce.eta * bounce.eta;
        // Where the report's map stands for light samples, no bounce may find a light.
        let counts = self.direct.is_none();
        state.bounced = bounce.pdf.filter(|_| counts).map(|pdf| (vertex.receiver(), pdf));
        state.ray = bounce.ray;
        if !is_last {
            let carried = state.throughput.max_element() * state.eta2;
            if carried <= 0.0 {
                return false;
            }
            if state.depth == 1 {
                state.worth_following = CERTAIN_SHARE * carried;
            }
            let share = match vertex.material.survival {
                Some(survival) if bounce.pdf.is_some() && state.depth < OWN_SURVIVAL_BOUNCES => survival,
                _ => carried / state.worth_following,
            };
            let survival = roulette(share, state.depth);
            if survival < 1.0 {
                if u[3] >= survival {
                    return false;
                }
                state.throughput /= survival;
            }
        }
        state.depth += 1;
        true
    }

    /// What a diffuse surface sends back of the light that is known here, and whether that is all of it.
    #[inline]
    fn diffuse<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        vertex: &Vertex,
        state: &State,
        sampler: &mut S,
        tracer: &mut T,
        told: &mut Told,
    ) -> (Rgb, bool) {
        let p = vertex.surface.point.p;
        let facing = vertex.facing();
        let is_whole = |layer: &&Layer| self.whole.is_whole(p, facing, layer.asked.radius);
        let is_first = state.diffuse == 1;
        // All light from one map.
        if self.ends == Ends::AfterGather
            && !is_first
            && let Some(layer) = self.diffuse.as_ref().filter(|layer| state.way > layer.asked.radius).filter(is_whole)
        {
            return (ask(layer, layer.asked, vertex, None).radiance, true);
        }
        let ending = match self.ends {
            Ends::AtOnce => self.diffuse.as_ref(),
            _ => None,
        };
        let ending = ending.map(|layer| (layer, self.asked(layer, is_first, true, told, vertex)));
        let ending = ending.filter(|(_, asked)| self.whole.is_whole(p, facing, asked.radius));
        let cached = self.cache.as_ref().and_then(|cache| {
            let f = vertex.material.bsdf.mean_f(vertex.wo)?;
            Some(f * cache.irradiance(p, vertex.facing_shading())?)
        });
        let ends = ending.is_some() || cached.is_some();
        let mut sum = cached.unwrap_or(Rgb::ZERO);
        // Straight from the emitters.
        let from_map = self.direct.as_ref().and_then(|layer| {
            is_whole(&layer).then(|| direct(&layer.map, vertex, layer.asked, self.min_photons)).flatten()
        });
        match from_map {
            Some(light) => sum += light,
            None if scene.emitters().is_dark() => {}
            None => {
                // A path that ends here, or whose bounces may not find lights, leaves all of it to the light samples.
                let is_alone = ends || self.direct.is_some();
                for _ in 0..self.shadow_rays {
                    let u = sampler.next_4d();
                    sum += vertex.sample_light_as(scene, u, self.shadow_rays, is_alone, tracer);
                }
            }
        }
        // By mirrors and glass.
        if is_first && let Some(layer) = &self.caustic {
            let asked = self.asked(layer, is_first, false, told, vertex);
            let estimate = self.ask_cut(layer, asked, vertex, tracer);
            sum += estimate.radiance;
            self.tell(&estimate, state, is_first, told, |gathering| &mut gathering.caustic);
        }
        if !is_first && let Some(layer) = &self.later_caustic {
            // A narrow disk where the wide one would reach over an edge or through a wall.
            let estimate = if self.whole.is_whole(p, facing, layer.widest) {
                ask(layer, Asked { radius: layer.widest, ..layer.asked }, vertex, None)
            } else {
                self.ask_cut(layer, layer.asked, vertex, tracer)
            };
            sum += estimate.radiance;
        }
        // Scattered before.
        if let Some((layer, asked)) = ending {
            let estimate = ask(layer, asked, vertex, None);
            sum += estimate.radiance;
            self.tell(&estimate, state, is_first, told, |gathering| &mut gathering.indirect);
        }
        (sum, ends)
    }

    /// Asks on as much of the disk as there is; whether it is whole is looked at only where there are photons.
    #[inline]
    fn ask_cut<T: Tracer>(&self, layer: &Layer, asked: Asked, vertex: &Vertex, tracer: &mut T) -> Estimate {
        let estimate = ask(layer, asked, vertex, None);
        if estimate.count == 0 || self.whole.is_whole(vertex.surface.point.p, vertex.facing(), asked.radius) {
            return estimate;
        }
        ask(layer, asked, vertex, Some(&Cut::new(tracer, vertex, estimate.radius)))
    }

    /// With which radius a map is asked: the pixel's own at the first diffuse hit, where it has one.
    #[inline]
    fn asked(&self, layer: &Layer, is_first: bool, is_indirect: bool, told: &mut Told, vertex: &Vertex) -> Asked {
        let (Shrinking::ByPixel { alpha, first }, true, Some(gathering)) =
            (self.shrinking, is_first, told.gathering.as_deref_mut())
        else {
            return layer.asked;
        };
        let radius = if is_indirect { &mut gathering.indirect } else { &mut gathering.caustic };
        let radius = radius.begin(self.pass, alpha, || {
            // Indirect light is smooth: one radius does for all to begin with.
            if is_indirect {
                return layer.widest;
            }
            NEAREST.with_borrow_mut(|nearest| {
                layer.map.nearest(vertex.surface.point.p, first as usize, layer.widest, nearest);
                match nearest.found() {
                    // Fewer than asked for, or all in one point: as wide as it may be.
                    found if found.len() < first as usize => layer.widest,
                    [.., (distance2, _)] if *distance2 > 0.0 => distance2.sqrt(),
                    _ => layer.widest,
                }
            })
        });
        Asked { radius, neighbours: None, ..layer.asked }
    }

    #[inline]
    fn tell(
        &self,
        estimate: &Estimate,
        state: &State,
        is_first: bool,
        told: &mut Told,
        radius: impl Fn(&mut Gathering) -> &mut ShrinkingRadius,
    ) {
        let Some(gathering) = told.gathering.as_deref_mut() else { return };
        told.bias += state.throughput * estimate.bias();
        if is_first && self.shrinking != Shrinking::Together {
            radius(gathering).note(estimate.count);
        }
    }
}

#[inline]
fn ask(layer: &Layer, asked: Asked, vertex: &Vertex, cut: Option<&Cut>) -> Estimate {
    let estimate = |nearest: &mut Nearest| match cut {
        None => radiance(&layer.map, vertex, asked, |_| true, nearest),
        Some(cut) => {
            let mut estimate = radiance(&layer.map, vertex, asked, |p| cut.holds(p), nearest);
            let share = cut.share(asked.kernel, estimate.radius);
            estimate.radiance /= share;
            estimate.narrow /= cut.share(asked.kernel, estimate.radius * std::f32::consts::FRAC_1_SQRT_2);
            estimate
        }
    };
    if asked.neighbours.is_some() { NEAREST.with_borrow_mut(estimate) } else { estimate(&mut Nearest::default()) }
}
