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
//! Where a map's disk is not whole (see [`super::coverage`]), the path goes on as path tracing does.

use std::cell::RefCell;
use std::sync::Arc;

use super::super::irradiance_cache::IrradianceCache;
use super::super::light::Vertex;
use super::super::path::{CERTAIN_FRACTION, OWN_SURVIVAL_BOUNCES, roulette};
use super::super::{FirstHit, Integrator, Tracer};
use super::aim::Aims;
use super::coverage::DiskCoverage;
use super::cut_disk::CutDisk;
use super::estimate::{Estimate, MapQuery, direct, radiance};
use super::{Nearest, PhotonMap};
use crate::emitter::Receiver;
use crate::film::{PixelPhotonState, ShrinkingRadius};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

/// A map and how it is asked.
#[derive(Clone, Debug)]
pub(super) struct MapLayer {
    pub map: Arc<PhotonMap>,
    pub query: MapQuery,
    /// The radius that pixels with radii of their own begin with at most.
    pub widest: f32,
}

/// What ends a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathEnd {
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
    pub(super) direct: Option<MapLayer>,
    pub(super) caustic: Option<MapLayer>,
    /// Of indirect light, or of all of it, by `ends`.
    pub(super) diffuse: Option<MapLayer>,
    pub(super) cache: Option<Arc<IrradianceCache>>,
    /// Caustics beyond the first diffuse hit: fewer photons over a wider radius. Nobody sees how sharp they are there, and
    /// a bright caustic may hold half of all photons.
    pub(super) later_caustic: Option<MapLayer>,
    /// Where disks are whole.
    pub(super) coverage: DiskCoverage,
    pub(super) ends: PathEnd,
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
struct EyePath {
    ray: Ray,
    throughput: Rgb,
    /// Undoes the radiance scaling of refraction for the roulette.
    eta2: f32,
    /// The last bounce's receiver and density, where a light sample could have made it as well.
    bounced: Option<(Receiver, f32)>,
    roulette_reference: f32,
    depth: u32,
    /// Diffuse hits so far.
    diffuse: u32,
    /// Length of the way since the last diffuse hit.
    since_diffuse: f32,
    /// Whether light found by mirrors and glass only counts from here on.
    counts_caustics: bool,
}

impl EyePath {
    fn new(ray: Ray) -> Self {
        Self {
            ray,
            throughput: Rgb::ONE,
            eta2: 1.0,
            bounced: None,
            roulette_reference: 1.0,
            depth: 1,
            diffuse: 0,
            since_diffuse: 0.0,
            counts_caustics: true,
        }
    }

    /// One of so many paths that go on together.
    fn share(&mut self, paths: u32) {
        self.throughput /= paths as f32;
        self.roulette_reference /= paths as f32;
    }
}

/// Notes how far the first ray went.
struct FirstHitDistance<'a, T> {
    tracer: &'a mut T,
    first: &'a mut f32,
}

impl<T: Tracer> Tracer for FirstHitDistance<'_, T> {
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
        gathering: Option<&mut PixelPhotonState>,
    ) -> Rgb {
        let start = EyePath::new(ray);
        let mut feedback = PixelFeedback { gathering, bias: Rgb::ZERO };
        let radiance = self.follow(scene, start, sampler, tracer, first, &mut feedback);
        if let Some(gathering) = feedback.gathering {
            gathering.add_bias(self.pass, feedback.bias);
        }
        radiance
    }
}

/// What estimates tell the pixel.
struct PixelFeedback<'g> {
    gathering: Option<&'g mut PixelPhotonState>,
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
        let mut path = EyePath::new(ray);
        (path.depth, path.diffuse, path.counts_caustics) = (2, 1, false);
        let mut tracer = FirstHitDistance { tracer, first: &mut distance };
        let mut feedback = PixelFeedback { gathering: None, bias: Rgb::ZERO };
        let radiance = self.follow(scene, path, sampler, &mut tracer, &mut |_| {}, &mut feedback);
        (radiance, distance)
    }

    /// The same whose paths end by chance only: what [`Gather::incident`] brings back is then as unbiased as path tracing,
    /// but for caustics.
    #[must_use]
    pub fn unaided(&self) -> Self {
        Self { cache: None, diffuse: None, ends: PathEnd::Never, ..self.clone() }
    }

    /// The same whose paths end where the cache answers.
    #[must_use]
    pub fn ending_at(&self, cache: Arc<IrradianceCache>) -> Self {
        Self { cache: Some(cache), diffuse: None, ends: PathEnd::AtCache, ..self.clone() }
    }

    fn follow<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        mut path: EyePath,
        sampler: &mut S,
        tracer: &mut T,
        first: &mut impl FnMut(FirstHit),
        feedback: &mut PixelFeedback,
    ) -> Rgb {
        let mut radiance = Rgb::ZERO;
        loop {
            let Some(hit) = tracer.intersect(&path.ray) else { return radiance };
            path.since_diffuse += hit.t;
            let vertex = Vertex::new(scene, &path.ray, &hit);
            if path.depth == 1 {
                first(vertex.first_hit());
            }
            // Light that the surface itself sends; what came by mirrors and glass to a diffuse surface is in a map.
            if path.counts_caustics || path.bounced.is_some() {
                radiance += path.throughput * vertex.emitted(scene, path.bounced, self.shadow_rays);
            }
            let bsdf = &vertex.material.bsdf;
            if path.depth > self.max_depth || bsdf.is_black() {
                return radiance;
            }
            let mut rays = 1;
            if !bsdf.is_delta() {
                path.diffuse += 1;
                path.counts_caustics = false;
                let (sent_back, is_over) = self.diffuse(scene, &vertex, &path, sampler, tracer, feedback);
                radiance += path.throughput * sent_back;
                if let Some(aims) = &self.aims {
                    radiance += self.aimed_caustic(scene, aims, &vertex, path, sampler, tracer);
                }
                if is_over {
                    return radiance;
                }
                if path.diffuse == 1 && self.ends == PathEnd::AfterGather {
                    rays = self.gather_rays;
                }
                path.since_diffuse = 0.0;
            }
            for _ in 1..rays {
                let mut branch = path;
                branch.share(rays);
                if self.bounce(&vertex, &mut branch, sampler) {
                    radiance += self.follow(scene, branch, sampler, tracer, first, feedback);
                }
            }
            path.share(rays);
            if !self.bounce(&vertex, &mut path, sampler) {
                return radiance;
            }
        }
    }

    /// One sample of the light that comes to a surface by mirrors and glass only and is sent back along the path.
    fn aimed_caustic<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        aims: &Aims,
        vertex: &Vertex,
        mut path: EyePath,
        sampler: &mut S,
        tracer: &mut T,
    ) -> Rgb {
        let [choice, u, v, _] = sampler.next_4d();
        let Some((wi, pdf)) = aims.sample(vertex.surface.point.p, vertex.facing(), choice, [u, v]) else {
            return Rgb::ZERO;
        };
        let Some((ray, f_cos)) = vertex.leave_towards(wi) else { return Rgb::ZERO };
        path.throughput *= f_cos / pdf;
        (path.ray, path.bounced) = (ray, None);
        path.roulette_reference = CERTAIN_FRACTION * path.throughput.max_element() * path.eta2;
        path.depth = path.depth.saturating_add(1);
        let mut radiance = Rgb::ZERO;
        for since_diffuse in 0.. {
            let Some(hit) = tracer.intersect(&path.ray) else { break };
            let vertex = Vertex::new(scene, &path.ray, &hit);
            if since_diffuse > 0 {
                radiance += path.throughput * vertex.emitted(scene, None, 1);
            }
            if path.depth > self.max_depth
                || !vertex.material.bsdf.is_delta()
                || !self.bounce(&vertex, &mut path, sampler)
            {
                break;
            }
        }
        radiance
    }

    /// The next direction; false where the path ends.
    #[inline]
    fn bounce<S: Sampler>(&self, vertex: &Vertex, path: &mut EyePath, sampler: &mut S) -> bool {
        let u = sampler.next_4d();
        let Some(bounce) = vertex.sample_bounce(u) else { return false };
        let is_last = path.depth == self.max_depth;
        if is_last && bounce.pdf.is_none() {
            return false;
        }
        path.throughput *= bounce.weight;
        path.eta2 *= bounce.eta * bounce.eta;
        // Where the report's map stands for light samples, no bounce may find a light.
        let counts = self.direct.is_none();
        path.bounced = bounce.pdf.filter(|_| counts).map(|pdf| (vertex.receiver(), pdf));
        path.ray = bounce.ray;
        if !is_last {
            let carried = path.throughput.max_element() * path.eta2;
            if carried <= 0.0 {
                return false;
            }
            if path.depth == 1 {
                path.roulette_reference = CERTAIN_FRACTION * carried;
            }
            let share = match vertex.material.survival {
                Some(survival) if bounce.pdf.is_some() && path.depth < OWN_SURVIVAL_BOUNCES => survival,
                _ => carried / path.roulette_reference,
            };
            let survival = roulette(share, path.depth);
            if survival < 1.0 {
                if u[3] >= survival {
                    return false;
                }
                path.throughput /= survival;
            }
        }
        path.depth += 1;
        true
    }

    /// What a diffuse surface sends back of the light that is known here, and whether that is all of it.
    #[inline]
    fn diffuse<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        vertex: &Vertex,
        path: &EyePath,
        sampler: &mut S,
        tracer: &mut T,
        feedback: &mut PixelFeedback,
    ) -> (Rgb, bool) {
        let p = vertex.surface.point.p;
        let facing = vertex.facing();
        let is_covered = |layer: &&MapLayer| self.coverage.is_covered(p, facing, layer.query.radius);
        let is_first = path.diffuse == 1;
        // All light from one map.
        if self.ends == PathEnd::AfterGather
            && !is_first
            && let Some(layer) =
                self.diffuse.as_ref().filter(|layer| path.since_diffuse > layer.query.radius).filter(is_covered)
        {
            return (query_map(layer, layer.query, vertex, None).radiance, true);
        }
        let ending = match self.ends {
            PathEnd::AtOnce => self.diffuse.as_ref(),
            _ => None,
        };
        let ending = ending.map(|layer| (layer, self.query(layer, is_first, true, feedback, vertex)));
        let ending = ending.filter(|(_, query)| self.coverage.is_covered(p, facing, query.radius));
        let cached = self.cache.as_ref().and_then(|cache| {
            let f = vertex.material.bsdf.mean_f(vertex.wo)?;
            Some(f * cache.irradiance(p, vertex.facing_shading())?)
        });
        let ends = ending.is_some() || cached.is_some();
        let mut sum = cached.unwrap_or(Rgb::ZERO);
        // Straight from the emitters.
        let from_map = self.direct.as_ref().and_then(|layer| {
            is_covered(&layer).then(|| direct(&layer.map, vertex, layer.query, self.min_photons)).flatten()
        });
        match from_map {
            Some(light) => sum += light,
            None if scene.emitters().is_dark() => {}
            None => {
                // A path that ends here, or whose bounces may not find lights, leaves all of it to the light samples.
                let only_light_samples = ends || self.direct.is_some();
                for _ in 0..self.shadow_rays {
                    let u = sampler.next_4d();
                    sum += vertex.sample_light_as(scene, u, self.shadow_rays, only_light_samples, tracer);
                }
            }
        }
        // By mirrors and glass.
        if is_first && let Some(layer) = &self.caustic {
            let query = self.query(layer, is_first, false, feedback, vertex);
            let estimate = self.query_clipped(layer, query, vertex, tracer);
            sum += estimate.radiance;
            self.record_estimate(&estimate, path, is_first, feedback, |gathering| &mut gathering.caustic);
        }
        if !is_first && let Some(layer) = &self.later_caustic {
            // A narrow disk where the wide one would reach over an edge or through a wall.
            let estimate = if self.coverage.is_covered(p, facing, layer.widest) {
                query_map(layer, MapQuery { radius: layer.widest, ..layer.query }, vertex, None)
            } else {
                self.query_clipped(layer, layer.query, vertex, tracer)
            };
            sum += estimate.radiance;
        }
        // Scattered before.
        if let Some((layer, query)) = ending {
            let estimate = query_map(layer, query, vertex, None);
            sum += estimate.radiance;
            self.record_estimate(&estimate, path, is_first, feedback, |gathering| &mut gathering.indirect);
        }
        (sum, ends)
    }

    /// Asks on as much of the disk as there is; whether it is whole is looked at only where there are photons.
    #[inline]
    fn query_clipped<T: Tracer>(&self, layer: &MapLayer, query: MapQuery, vertex: &Vertex, tracer: &mut T) -> Estimate {
        let estimate = query_map(layer, query, vertex, None);
        if estimate.count == 0 || self.coverage.is_covered(vertex.surface.point.p, vertex.facing(), query.radius) {
            return estimate;
        }
        query_map(layer, query, vertex, Some(&CutDisk::new(tracer, vertex, estimate.radius)))
    }

    /// With which radius a map is asked: the pixel's own at the first diffuse hit, where it has one.
    #[inline]
    fn query(
        &self,
        layer: &MapLayer,
        is_first: bool,
        is_indirect: bool,
        feedback: &mut PixelFeedback,
        vertex: &Vertex,
    ) -> MapQuery {
        let (Shrinking::ByPixel { alpha, first }, true, Some(gathering)) =
            (self.shrinking, is_first, feedback.gathering.as_deref_mut())
        else {
            return layer.query;
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
        MapQuery { radius, neighbours: None, ..layer.query }
    }

    #[inline]
    fn record_estimate(
        &self,
        estimate: &Estimate,
        path: &EyePath,
        is_first: bool,
        feedback: &mut PixelFeedback,
        radius: impl Fn(&mut PixelPhotonState) -> &mut ShrinkingRadius,
    ) {
        let Some(gathering) = feedback.gathering.as_deref_mut() else { return };
        feedback.bias += path.throughput * estimate.bias();
        if is_first && self.shrinking != Shrinking::Together {
            radius(gathering).add_estimate(estimate.count);
        }
    }
}

#[inline]
fn query_map(layer: &MapLayer, query: MapQuery, vertex: &Vertex, cut: Option<&CutDisk>) -> Estimate {
    let estimate = |nearest: &mut Nearest| match cut {
        None => radiance(&layer.map, vertex, query, |_| true, nearest),
        Some(cut) => {
            let mut estimate = radiance(&layer.map, vertex, query, |p| cut.holds(p), nearest);
            let share = cut.share(query.kernel, estimate.radius);
            estimate.radiance /= share;
            estimate.narrow /= cut.share(query.kernel, estimate.radius * std::f32::consts::FRAC_1_SQRT_2);
            estimate
        }
    };
    if query.neighbours.is_some() { NEAREST.with_borrow_mut(estimate) } else { estimate(&mut Nearest::default()) }
}
