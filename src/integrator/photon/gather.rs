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
use super::super::vertex::Vertex;
use super::super::walk::{Limits, Walk};
use super::super::{Context, FirstHit, Tracer, Transport};
use super::aim::Aims;
use super::coverage::DiskCoverage;
use super::cut_disk::CutDisk;
use super::estimate::{Estimate, MapQuery, direct, radiance};
use super::{Nearest, PhotonMap};
use crate::bsdf::{Lobes, Model as _};
use crate::film::{PixelPhotonState, ShrinkingRadius};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene};
use crate::spectrum::{Rgb, Spectrum};

/// A map and how it is asked.
#[derive(Clone, Debug)]
pub(super) struct MapLayer<C: Spectrum = Rgb> {
    pub map: Arc<PhotonMap<C>>,
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
pub struct Gather<C: Spectrum = Rgb> {
    pub(super) direct: Option<MapLayer<C>>,
    pub(super) caustic: Option<MapLayer<C>>,
    /// Of indirect light, or of all of it, by `ends`.
    pub(super) diffuse: Option<MapLayer<C>>,
    pub(super) cache: Option<Arc<IrradianceCache>>,
    /// Caustics beyond the first diffuse hit: fewer photons over a wider radius. Nobody sees how sharp they are there, and
    /// a bright caustic may hold half of all photons.
    pub(super) later_caustic: Option<MapLayer<C>>,
    /// Where disks are whole.
    pub(super) coverage: DiskCoverage,
    pub(super) ends: PathEnd,
    pub(super) shrinking: Shrinking,
    /// Number of the pass that the maps are of.
    pub(super) pass: u32,
    /// The wavelengths of that pass, of its photons and of the paths that query them.
    pub(super) wavelengths: C::Wavelengths,
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

/// An eye path on its way.
#[derive(Clone, Copy)]
struct EyePath<C: Spectrum> {
    walk: Walk<C>,
    ray: Ray,
    /// Diffuse hits so far.
    diffuse: u32,
    /// Length of the path since the last diffuse hit.
    since_diffuse: f32,
    /// Whether light found by mirrors and glass only counts from here on: no map has given it yet.
    counts_caustics: bool,
}

impl<C: Spectrum> EyePath<C> {
    fn new(ray: Ray) -> Self {
        Self { walk: Walk::new(None), ray, diffuse: 0, since_diffuse: 0.0, counts_caustics: true }
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

impl<C: Spectrum> Transport<C> for Gather<C> {
    fn li<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
    ) -> C {
        self.li_of_pixel(ray, context, first, None)
    }

    fn li_of_pixel<S: Sampler, T: Tracer>(
        &self,
        ray: Ray,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
        gathering: Option<&mut PixelPhotonState>,
    ) -> C {
        let mut feedback = PixelFeedback { gathering, bias: C::ZERO };
        let radiance = self.follow(EyePath::new(ray), context, first, &mut feedback);
        if let Some(gathering) = feedback.gathering {
            gathering.add_bias(self.pass, feedback.bias.to_rgb(&self.wavelengths));
        }
        radiance
    }

    fn wavelengths<S: Sampler>(&self, _: &mut S) -> C::Wavelengths {
        self.wavelengths
    }
}

/// What estimates tell the pixel.
struct PixelFeedback<'g, C> {
    gathering: Option<&'g mut PixelPhotonState>,
    bias: C,
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
        (path.walk.depth, path.diffuse, path.counts_caustics) = (1, 1, false);
        let tracer = &mut FirstHitDistance { tracer, first: &mut distance };
        let mut feedback = PixelFeedback { gathering: None, bias: Rgb::ZERO };
        let mut context = Context { scene, sampler, tracer, wavelengths: () };
        let radiance = self.follow(path, &mut context, &mut |_| {}, &mut feedback);
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
}

impl<C: Spectrum> Gather<C> {
    fn limits(&self) -> Limits {
        Limits { max_depth: self.max_depth, ..Limits::new(self.shadow_rays) }
    }

    fn follow<S: Sampler, T: Tracer>(
        &self,
        mut path: EyePath<C>,
        context: &mut Context<'_, S, T, C>,
        first: &mut impl FnMut(FirstHit),
        feedback: &mut PixelFeedback<'_, C>,
    ) -> C {
        let limits = self.limits();
        loop {
            // What came from a light by mirrors and glass to a diffuse surface is in a map.
            let sees_lights = path.counts_caustics || path.walk.previous.is_some();
            let Some(hit) = context.tracer.intersect(&path.ray) else {
                if sees_lights {
                    path.walk.escape(context.scene, &path.ray, &limits, &context.wavelengths);
                }
                return path.walk.radiance;
            };
            path.since_diffuse += hit.t;
            path.walk.depth += 1;
            let vertex = Vertex::new(context.scene, &path.ray, &hit, context.wavelengths);
            if path.walk.depth == 1 {
                first(vertex.first_hit());
            }
            // Light that the surface itself sends.
            if sees_lights {
                let emitted = vertex.emitted(context.scene, path.walk.previous, self.shadow_rays);
                path.walk.radiance += path.walk.throughput * emitted;
            }
            if path.walk.depth > self.max_depth || vertex.bsdf.is_black() {
                return path.walk.radiance;
            }
            let lobes = vertex.bsdf.lobes();
            let mut rays = 1;
            let counted_caustics = path.counts_caustics;
            if lobes.have_diffuse() {
                path.diffuse += 1;
                path.counts_caustics = false;
                let (sent_back, is_over) = self.diffuse(&vertex, &path, context, feedback);
                path.walk.radiance += path.walk.throughput * sent_back;
                if let Some(aims) = &self.aims {
                    path.walk.radiance += self.aimed_caustic(aims, &vertex, &path, context);
                }
                if is_over {
                    return path.walk.radiance;
                }
                if path.diffuse == 1 && self.ends == PathEnd::AfterGather {
                    rays = self.gather_rays;
                }
                path.since_diffuse = 0.0;
            } else if lobes.intersects(Lobes::GLOSSY) {
                // No map holds what comes to a glossy surface: light samples and the bounce find all of it.
                path.counts_caustics = true;
                if !context.scene.emitters().is_dark() {
                    for _ in 0..self.shadow_rays {
                        let light = vertex.sample_light(context, self.shadow_rays, false);
                        path.walk.radiance += path.walk.throughput * light;
                    }
                }
            }
            let one = if rays > 1 { path.walk.split(rays) } else { path.walk };
            for _ in 1..rays {
                let mut branch = EyePath { walk: one, ..path };
                if self.bounce(&vertex, &mut branch, counted_caustics, context.sampler, &limits) {
                    path.walk.radiance += self.follow(branch, context, first, feedback);
                }
            }
            path.walk = one.having_brought(path.walk.radiance);
            if !self.bounce(&vertex, &mut path, counted_caustics, context.sampler, &limits) {
                return path.walk.radiance;
            }
        }
    }

    /// One sample of the light that comes to a surface by mirrors and glass only and is sent back along the path.
    fn aimed_caustic<S: Sampler, T: Tracer>(
        &self,
        aims: &Aims,
        vertex: &Vertex<C>,
        path: &EyePath<C>,
        context: &mut Context<'_, S, T, C>,
    ) -> C {
        let [choice, u, v, _] = context.sampler.next_4d();
        let Some((wi, pdf)) = aims.sample(vertex.surface.point.p, vertex.facing(), choice, [u, v]) else {
            return C::ZERO;
        };
        let Some((ray, f_cos)) = vertex.leave_towards(wi) else { return C::ZERO };
        let mut branch = EyePath { walk: path.walk.branch(f_cos / pdf), ray, ..*path };
        let limits = self.limits();
        for way in 0.. {
            let Some(hit) = context.tracer.intersect(&branch.ray) else {
                if way > 0 {
                    branch.walk.escape(context.scene, &branch.ray, &limits, &context.wavelengths);
                }
                break;
            };
            branch.walk.depth = branch.walk.depth.saturating_add(1);
            let vertex = Vertex::new(context.scene, &branch.ray, &hit, context.wavelengths);
            if way > 0 {
                let emitted = vertex.emitted(context.scene, None, 1);
                branch.walk.radiance += branch.walk.throughput * emitted;
            }
            if branch.walk.depth > self.max_depth
                || !vertex.bsdf.lobes().have_specular()
                || !self.bounce(&vertex, &mut branch, true, context.sampler, &limits)
            {
                break;
            }
        }
        branch.walk.radiance
    }

    /// The next direction; false where the path ends. `counted_caustics`: whether the path counted them before this vertex, which
    /// holds on through its delta lobes, whose light is in no map of this vertex.
    #[inline]
    fn bounce<S: Sampler>(
        &self,
        vertex: &Vertex<C>,
        path: &mut EyePath<C>,
        counted_caustics: bool,
        sampler: &mut S,
        limits: &Limits,
    ) -> bool {
        let Some(bounce) = path.walk.bounce(vertex, sampler, limits) else { return false };
        path.ray = bounce.ray;
        if bounce.pdf.is_none() {
            path.counts_caustics = counted_caustics;
        } else if self.direct.is_some() && vertex.bsdf.lobes().have_diffuse() {
            // Where the report's map stands for light samples, no bounce may find a light.
            path.walk.previous = None;
        }
        true
    }

    /// What a diffuse surface sends back of the light that is known here, and whether that is all of it.
    #[inline]
    fn diffuse<S: Sampler, T: Tracer>(
        &self,
        vertex: &Vertex<C>,
        path: &EyePath<C>,
        context: &mut Context<'_, S, T, C>,
        feedback: &mut PixelFeedback<'_, C>,
    ) -> (C, bool) {
        let p = vertex.surface.point.p;
        let facing = vertex.facing();
        let is_covered = |layer: &&MapLayer<C>| self.coverage.is_covered(p, facing, layer.query.radius);
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
            let f = vertex.bsdf.mean_f(vertex.wo)?;
            let irradiance = cache.irradiance(p, vertex.facing_shading())?;
            Some(f * C::from_emission(irradiance, &context.wavelengths))
        });
        let ends = ending.is_some() || cached.is_some();
        let mut sum = cached.unwrap_or(C::ZERO);
        // Straight from the emitters.
        let from_map = self.direct.as_ref().and_then(|layer| {
            is_covered(&layer).then(|| direct(&layer.map, vertex, layer.query, self.min_photons)).flatten()
        });
        match from_map {
            Some(light) => sum += light,
            None if context.scene.emitters().is_dark() => {}
            None => {
                // A path that ends here, or whose bounces may not find lights, leaves all of it to the light samples.
                let only_light_samples = ends || self.direct.is_some();
                for _ in 0..self.shadow_rays {
                    sum += vertex.sample_light(context, self.shadow_rays, only_light_samples);
                }
            }
        }
        // By mirrors and glass.
        if is_first && let Some(layer) = &self.caustic {
            let query = self.query(layer, is_first, false, feedback, vertex);
            let estimate = self.query_clipped(layer, query, vertex, context.tracer);
            sum += estimate.radiance;
            self.record_estimate(&estimate, path, is_first, feedback, |gathering| &mut gathering.caustic);
        }
        if !is_first && let Some(layer) = &self.later_caustic {
            // A narrow disk where the wide one would reach over an edge or through a wall.
            let estimate = if self.coverage.is_covered(p, facing, layer.widest) {
                query_map(layer, MapQuery { radius: layer.widest, ..layer.query }, vertex, None)
            } else {
                self.query_clipped(layer, layer.query, vertex, context.tracer)
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
    fn query_clipped<T: Tracer>(
        &self,
        layer: &MapLayer<C>,
        query: MapQuery,
        vertex: &Vertex<C>,
        tracer: &mut T,
    ) -> Estimate<C> {
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
        layer: &MapLayer<C>,
        is_first: bool,
        is_indirect: bool,
        feedback: &mut PixelFeedback<'_, C>,
        vertex: &Vertex<C>,
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
        estimate: &Estimate<C>,
        path: &EyePath<C>,
        is_first: bool,
        feedback: &mut PixelFeedback<'_, C>,
        radius: impl Fn(&mut PixelPhotonState) -> &mut ShrinkingRadius,
    ) {
        let Some(gathering) = feedback.gathering.as_deref_mut() else { return };
        feedback.bias += path.walk.throughput * estimate.bias();
        if is_first && self.shrinking != Shrinking::Together {
            radius(gathering).add_estimate(estimate.count);
        }
    }
}

#[inline]
fn query_map<C: Spectrum>(
    layer: &MapLayer<C>,
    query: MapQuery,
    vertex: &Vertex<C>,
    cut: Option<&CutDisk>,
) -> Estimate<C> {
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
