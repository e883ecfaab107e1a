//! Eye paths that end in photon maps, or that photon maps complement.
//!
//! One loop serves all methods, which differ in settings that are chosen when the integrator is made:
//!
//! - the report's map gives direct light where no shadow photon is near; the path continues for all other light;
//! - the caustic map gives light that came by mirrors and glass only, at every diffuse hit; emission that a path reaches by
//!   mirrors and glass after a diffuse bounce then does not count, since the map contains the same light;
//! - the map of indirect light ends a path at its first diffuse hit, where shadow rays give direct light (progressive
//!   methods); the global map ends a path one diffuse bounce later (final gathering).
//!
//! Maps are queried only where the surface covers the kernel's disk (see [`super::coverage`]); elsewhere the path continues
//! as in path tracing.
//!
//! Maps hold the light of diffuse lobes. The other lobes of a surface are followed beside them ([`super::division`]).

use std::cell::RefCell;
use std::sync::Arc;

use super::super::aim::Aims;
use super::super::irradiance_cache::IrradianceCache;
use super::super::media::arrive;
use super::super::vertex::Vertex;
use super::super::walk::{Limits, Walk};
use super::super::{Context, FirstHit, Tracer, Transport};
use super::coverage::DiskCoverage;
use super::cut_disk::CutDisk;
use super::division::{Division, PARTS, choose_part};
use super::estimate::{Estimate, MapQuery, direct, radiance};
use super::{Nearest, PhotonMap};
use crate::bsdf::{Model as _, Parts};
use crate::film::{PixelPhotonState, ShrinkingRadius};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, PathMedia, Scene};
use crate::spectrum::{Rgb, Sensor, Spectrum};

/// A photon map and the parameters of its queries.
#[derive(Clone, Debug)]
pub(super) struct MapLayer<C: Spectrum = Rgb> {
    pub map: Arc<PhotonMap<C>>,
    pub query: MapQuery,
    /// Greatest radius with which pixels that have their own radii begin.
    pub widest: f32,
}

/// How paths end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathEnd {
    /// Paths end only by Russian roulette or absorption.
    Never,
    /// Paths end in the map of indirect light, at the first diffuse hit.
    AtOnce,
    /// Paths end in the global map, after a diffuse bounce.
    AfterGather,
    /// Paths end in the irradiance cache, at the first diffuse hit.
    AtCache,
}

/// How radii shrink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shrinking {
    /// All radii shrink in the same way, or not at all.
    Together,
    /// Each pixel's radius shrinks by the photons that the pixel's estimates find.
    ByPixel {
        /// Share of the photons that each pass keeps.
        alpha: f32,
        /// Number of photons that the first radius of a caustic estimate holds.
        first: u32,
    },
}

/// Path tracing with photon maps.
#[derive(Clone, Debug)]
pub struct Gather<C: Spectrum = Rgb> {
    pub(super) direct: Option<MapLayer<C>>,
    pub(super) caustic: Option<MapLayer<C>>,
    /// The map of indirect light or of all light, as `ends` requires.
    pub(super) diffuse: Option<MapLayer<C>>,
    pub(super) cache: Option<Arc<IrradianceCache>>,
    /// The caustic map beyond the first diffuse hit, with fewer photons and a wider radius: sharpness is not visible there,
    /// and a bright caustic may hold half of all photons.
    pub(super) later_caustic: Option<MapLayer<C>>,
    /// Where the surface covers the kernel's disk.
    pub(super) coverage: DiskCoverage,
    /// Which lobes are gathered, and which ones count as delta lobes.
    pub(super) division: Arc<Division<C>>,
    pub(super) ends: PathEnd,
    pub(super) shrinking: Shrinking,
    /// Index of the pass to which the maps belong.
    pub(super) pass: u32,
    /// The moment of that pass, which its photons and the paths that query them share; `None` where nothing but the camera moves.
    pub(super) moment: Option<f32>,
    /// The wavelengths of that pass, which its photons and the paths that query them share.
    pub(super) wavelengths: C::Wavelengths,
    /// What the film's channels are.
    pub(super) sensor: Sensor,
    pub(super) max_depth: u32,
    pub(super) shadow_rays: u32,
    pub(super) min_photons: u32,
    pub(super) gather_rays: u32,
    /// The specular parts at which paths aim rays, where these rays replace the caustic map.
    pub(super) aims: Option<Aims>,
}

thread_local! {
    static NEAREST: RefCell<Nearest> = RefCell::default();
}

/// The state of an eye path between two hits.
#[derive(Clone, Copy)]
struct EyePath<C: Spectrum> {
    walk: Walk<C>,
    ray: Ray,
    /// The media that the path is in.
    media: Option<PathMedia>,
    /// Number of diffuse hits so far.
    diffuse: u32,
    /// Length of the path since the last diffuse hit.
    since_diffuse: f32,
    /// Whether emission reached by mirrors and glass only counts from here on, because no map has contributed it yet.
    counts_caustics: bool,
}

impl<C: Spectrum> EyePath<C> {
    fn new(ray: Ray, media: Option<PathMedia>) -> Self {
        Self { walk: Walk::new(None), ray, media, diffuse: 0, since_diffuse: 0.0, counts_caustics: true }
    }
}

/// Records the distance to the first hit.
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
    type Memory = ();

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
        let radiance = self.follow(EyePath::new(ray, context.scene.media_at(&ray)), context, first, &mut feedback);
        if let Some(gathering) = feedback.gathering {
            gathering.add_bias(self.pass, feedback.bias.to_film(&self.wavelengths, self.sensor));
        }
        radiance
    }

    fn moment(&self) -> Option<f32> {
        self.moment
    }

    fn wavelengths<S: Sampler>(&self, _: &mut S, _: Sensor) -> C::Wavelengths {
        self.wavelengths
    }
}

/// The statistics that estimates report to the pixel.
struct PixelFeedback<'g, C> {
    gathering: Option<&'g mut PixelPhotonState>,
    bias: C,
}

impl Gather {
    /// Radiance [W m^-2 sr^-1] that arrives at a diffuse surface along a ray that leaves the surface in `media`, and the distance to
    /// the ray's first hit, infinite for a miss. The radiance excludes light that comes straight from the emitters, and
    /// light that comes from the emitters by mirrors and glass only.
    ///
    /// Together with direct light and caustics, this is all light, each contribution once.
    pub(in crate::integrator) fn incident<S: Sampler, T: Tracer>(
        &self,
        scene: &Scene,
        ray: Ray,
        media: Option<PathMedia>,
        sampler: &mut S,
        tracer: &mut T,
    ) -> (Rgb, f32) {
        let mut distance = f32::INFINITY;
        let mut path = EyePath::new(ray, media);
        (path.walk.depth, path.diffuse, path.counts_caustics) = (1, 1, false);
        let tracer = &mut FirstHitDistance { tracer, first: &mut distance };
        let mut feedback = PixelFeedback { gathering: None, bias: Rgb::ZERO };
        let mut context = Context { scene, sampler, tracer, wavelengths: () };
        let radiance = self.follow(path, &mut context, &mut |_| {}, &mut feedback);
        (radiance, distance)
    }

    /// The same integrator with paths that end only by Russian roulette or absorption: the estimate of `Gather::incident`
    /// is then unbiased as in path tracing, except for caustics.
    #[must_use]
    pub fn unaided(&self) -> Self {
        Self { cache: None, diffuse: None, ends: PathEnd::Never, ..self.clone() }
    }

    /// The same integrator with paths that end where the cache can be interpolated.
    #[must_use]
    pub fn ending_at(&self, cache: Arc<IrradianceCache>) -> Self {
        Self { cache: Some(cache), diffuse: None, ends: PathEnd::AtCache, ..self.clone() }
    }
}

impl<C: Spectrum> Gather<C> {
    fn limits(&self) -> Limits<'_> {
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
            // A map contains the light that reaches a diffuse surface from a light by mirrors and glass only.
            let sees_lights = path.counts_caustics || path.walk.previous.is_some();
            let hit = arrive(context.scene, context.tracer, &path.ray, &mut path.media);
            path.walk.pass_media(context.scene, &path.ray, hit.as_ref(), path.media, &context.wavelengths);
            let Some(hit) = hit else {
                if sees_lights {
                    path.walk.escape(context.scene, &path.ray, &context.wavelengths);
                }
                return path.walk.radiance;
            };
            path.since_diffuse += hit.t;
            path.walk.depth += 1;
            let mut slot = None;
            let mut vertex = Vertex::new(context.scene, &path.ray, &hit, context.wavelengths, path.media, &mut slot);
            vertex.alone = path.walk.alone;
            if path.walk.depth == 1 {
                first(vertex.first_hit(context.scene));
            }
            // Emission of the surface itself.
            if sees_lights {
                let emitted = vertex.emitted(context.scene, path.walk.previous);
                path.walk.radiance += path.walk.throughput * emitted;
            }
            if path.walk.depth > self.max_depth || vertex.lobes.is_empty() {
                return path.walk.radiance;
            }
            // The parts of the surface: what is gathered, and what is followed beside it.
            let mut apart = None;
            let divided = self.division.at(&vertex, &mut apart);
            let mut slots = [None, None, None];
            let [diffuse, glossy, narrow] = divided.parts(&vertex, &mut slots);
            let mut followed = [None, glossy, narrow];
            if let Some(vertex) = diffuse {
                let gathering = EyePath { diffuse: path.diffuse + 1, counts_caustics: false, ..path };
                let (sent_back, is_over) = self.diffuse(vertex, &gathering, context, feedback);
                path.walk.radiance += path.walk.throughput * sent_back;
                if let Some(aims) = &self.aims {
                    path.walk.radiance += self.aimed_caustic(aims, vertex, &gathering, context);
                }
                let rays = match self.ends {
                    PathEnd::AfterGather if gathering.diffuse == 1 => self.gather_rays,
                    _ => 1,
                };
                if !is_over {
                    let is_whole = glossy.is_none() && narrow.is_none();
                    if rays > 1 {
                        let one = path.walk.split(rays);
                        // The last ray of a surface that has nothing else is this path itself.
                        for _ in 0..if is_whole { rays - 1 } else { rays } {
                            let mut branch = EyePath { walk: one, ..path };
                            if self.bounce(vertex, Parts::DIFFUSE, &mut branch, context, &limits) {
                                path.walk.radiance += self.follow(branch, context, first, feedback);
                            }
                        }
                        if is_whole {
                            path.walk = one.having_brought(path.walk.radiance);
                        }
                    }
                    if rays == 1 || is_whole {
                        followed[0] = diffuse;
                    }
                }
            }
            // Light samples for the lobes that are not gathered. The caustic map holds the light of narrow ones where it has been
            // gathered.
            let lit = [glossy, narrow.filter(|vertex| path.counts_caustics && vertex.finds_light_samples())];
            for vertex in lit.into_iter().flatten() {
                let mut light = C::ZERO;
                vertex.add_light_samples(&mut light, context, self.shadow_rays, false, path.walk.alone);
                path.walk.radiance += path.walk.throughput * light;
            }
            let chosen = match followed {
                [None, None, None] => None,
                [Some(_), None, None] => Some(0),
                [None, Some(_), None] => Some(1),
                [None, None, Some(_)] => Some(2),
                several => choose_part(several, context.sampler.next_4d()[0]).map(|(chosen, probability)| {
                    path.walk = path.walk.chosen(probability);
                    chosen
                }),
            };
            let Some((vertex, part)) = chosen.and_then(|chosen| Some((followed[chosen]?, PARTS[chosen]))) else {
                return path.walk.radiance;
            };
            if !self.bounce(vertex, part, &mut path, context, &limits) {
                return path.walk.radiance;
            }
        }
    }

    /// One sample of the light that reaches a surface by mirrors and glass only and is scattered back along the path.
    fn aimed_caustic<S: Sampler, T: Tracer>(
        &self,
        aims: &Aims,
        vertex: &Vertex<'_, C>,
        path: &EyePath<C>,
        context: &mut Context<'_, S, T, C>,
    ) -> C {
        let [choice, u, v, _] = context.sampler.next_4d();
        let Some((wi, pdf)) = aims.sample(vertex.surface.point.p, vertex.facing(), choice, [u, v]) else {
            return C::ZERO;
        };
        let Some((ray, f_cos)) = vertex.leave_towards(wi) else { return C::ZERO };
        let media = vertex.media_beyond(context.scene, &ray);
        let mut branch =
            EyePath { walk: path.walk.branch(f_cos / pdf, vertex.disperses_along(&ray)), ray, media, ..*path };
        let limits = self.limits();
        for way in 0.. {
            let hit = arrive(context.scene, context.tracer, &branch.ray, &mut branch.media);
            branch.walk.pass_media(context.scene, &branch.ray, hit.as_ref(), branch.media, &context.wavelengths);
            let Some(hit) = hit else {
                if way > 0 {
                    branch.walk.escape(context.scene, &branch.ray, &context.wavelengths);
                }
                break;
            };
            branch.walk.depth = branch.walk.depth.saturating_add(1);
            let mut slot = None;
            let vertex = Vertex::new(context.scene, &branch.ray, &hit, context.wavelengths, branch.media, &mut slot);
            if way > 0 {
                let emitted = vertex.emitted(context.scene, None);
                branch.walk.radiance += branch.walk.throughput * emitted;
            }
            if branch.walk.depth > self.max_depth || !vertex.lobes.have_specular() {
                break;
            }
            match branch.walk.bounce(&vertex, context.sampler, &limits) {
                Some(bounce) if bounce.pdf.is_none() => {
                    branch.media = vertex.media_beyond(context.scene, &bounce.ray);
                    branch.ray = bounce.ray;
                }
                // A lobe with a density: light samples and bounces of the path itself find what lies that way.
                _ => break,
            }
        }
        branch.walk.radiance
    }

    /// Samples the next direction by one part of a surface, of which `vertex` has the lobes; returns `false` where the path ends.
    #[inline]
    fn bounce<S: Sampler, T: Tracer>(
        &self,
        vertex: &Vertex<'_, C>,
        part: Parts,
        path: &mut EyePath<C>,
        context: &mut Context<'_, S, T, C>,
        limits: &Limits,
    ) -> bool {
        let Some(bounce) = path.walk.bounce(vertex, context.sampler, limits) else { return false };
        path.ray = bounce.ray;
        path.media = vertex.media_beyond(context.scene, &path.ray);
        if part == Parts::DIFFUSE {
            path.diffuse += 1;
            path.since_diffuse = 0.0;
            path.counts_caustics = false;
            if self.direct.is_some() {
                // A bounce must not count emission where the report's map replaces light samples.
                path.walk.previous = None;
            }
        } else if part == Parts::GLOSSY {
            // No map holds the light on glossy surfaces: light samples and the bounce find all of it.
            path.counts_caustics = true;
        } else if !path.counts_caustics {
            // The caustic map holds what lamps send by narrow lobes.
            path.walk.previous = None;
        }
        true
    }

    /// The light that a diffuse surface scatters back as far as it is known at this hit, and whether that is all light.
    #[inline]
    fn diffuse<S: Sampler, T: Tracer>(
        &self,
        vertex: &Vertex<'_, C>,
        path: &EyePath<C>,
        context: &mut Context<'_, S, T, C>,
        feedback: &mut PixelFeedback<'_, C>,
    ) -> (C, bool) {
        let p = vertex.surface.point.p;
        let facing = vertex.facing();
        let is_covered = |layer: &&MapLayer<C>| self.coverage.is_covered(p, facing, layer.query.radius);
        let is_first = path.diffuse == 1;
        // All light comes from the global map.
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
        // Records know no directions: where these matter, the path goes on.
        let cached = self.cache.as_ref().filter(|_| vertex.bsdf.is_even()).and_then(|cache| {
            let f = vertex.bsdf.mean_f(vertex.wo)?;
            let irradiance = cache.irradiance(p, vertex.facing_shading())?;
            Some(f * C::from_emission(irradiance, &context.wavelengths))
        });
        let ends = ending.is_some() || cached.is_some();
        let mut sum = cached.unwrap_or(C::ZERO);
        // Direct light from the emitters.
        let from_map = self.direct.as_ref().and_then(|layer| {
            is_covered(&layer).then(|| direct(&layer.map, vertex, layer.query, self.min_photons)).flatten()
        });
        match from_map {
            Some(light) => sum += light,
            None => {
                // Light samples have weight 1 where the path ends, or where its bounces must not count emission.
                let only_light_samples = ends || self.direct.is_some();
                vertex.add_light_samples(&mut sum, context, self.shadow_rays, only_light_samples, vertex.alone);
            }
        }
        // Light that comes by mirrors and glass only.
        if is_first && let Some(layer) = &self.caustic {
            let query = self.query(layer, is_first, false, feedback, vertex);
            let estimate = self.query_clipped(layer, query, vertex, context.tracer);
            sum += estimate.radiance;
            self.record_estimate(&estimate, path, is_first, feedback, |gathering| &mut gathering.caustic);
        }
        if !is_first && let Some(layer) = &self.later_caustic {
            // The narrow disk is used where the wide one would reach over an edge or through a wall.
            let estimate = if self.coverage.is_covered(p, facing, layer.widest) {
                query_map(layer, MapQuery { radius: layer.widest, ..layer.query }, vertex, None)
            } else {
                self.query_clipped(layer, layer.query, vertex, context.tracer)
            };
            sum += estimate.radiance;
        }
        // Indirect light.
        if let Some((layer, query)) = ending {
            let estimate = query_map(layer, query, vertex, None);
            sum += estimate.radiance;
            self.record_estimate(&estimate, path, is_first, feedback, |gathering| &mut gathering.indirect);
        }
        (sum, ends)
    }

    /// Queries the part of the disk that the surface covers; coverage is tested only where the disk holds photons.
    #[inline]
    fn query_clipped<T: Tracer>(
        &self,
        layer: &MapLayer<C>,
        query: MapQuery,
        vertex: &Vertex<'_, C>,
        tracer: &mut T,
    ) -> Estimate<C> {
        let estimate = query_map(layer, query, vertex, None);
        if estimate.count == 0 || self.coverage.is_covered(vertex.surface.point.p, vertex.facing(), query.radius) {
            return estimate;
        }
        query_map(layer, query, vertex, Some(&CutDisk::new(tracer, vertex, estimate.radius)))
    }

    /// The parameters of a query: at the first diffuse hit the pixel's own radius, where the pixel has one.
    #[inline]
    fn query(
        &self,
        layer: &MapLayer<C>,
        is_first: bool,
        is_indirect: bool,
        feedback: &mut PixelFeedback<'_, C>,
        vertex: &Vertex<'_, C>,
    ) -> MapQuery {
        let (Shrinking::ByPixel { alpha, first }, true, Some(gathering)) =
            (self.shrinking, is_first, feedback.gathering.as_deref_mut())
        else {
            return layer.query;
        };
        let radius = if is_indirect { &mut gathering.indirect } else { &mut gathering.caustic };
        let radius = radius.begin(self.pass, alpha, || {
            // Indirect light is smooth, so that one first radius suits all pixels.
            if is_indirect {
                return layer.widest;
            }
            NEAREST.with_borrow_mut(|nearest| {
                layer.map.nearest(vertex.surface.point.p, first as usize, layer.widest, nearest);
                match nearest.found() {
                    // The widest radius is taken where too few photons are found, or where all lie in one point.
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
    vertex: &Vertex<'_, C>,
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
