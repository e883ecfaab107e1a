//! The path loop: it advances a path vertex by vertex, with light samples, Bsdf samples and Russian roulette.
//!
//! Path tracing, local illumination, light maps and the eye paths of all photon methods share this loop.
//!
//! Source: Arvo and Kirk 1990, "Particle Transport and Image Synthesis" (roulette).

use super::aim::Aims;
use super::light_tracing::{LightPaths, is_of_chain};
use super::media::{arrive, left_after};
use super::mirrored::{self, MOST_MIRRORS, Way};
use super::tracer::{Context, FirstHit, Tracer};
use super::vertex::{Bounce, PreviousBounce, Vertex, escaped};
use crate::desc::MAX_SHADOW_RAYS;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{FlatMirrors, Hit, PathMedia, Scene};
use crate::spectrum::Spectrum;

/// From this bounce on no path survives with certainty, so that every path ends, even among perfect mirrors. Light guides
/// and mirrors that face each other show a thousand reflections without noise.
const CERTAIN_BOUNCES: u32 = 1024;

/// From this bounce on the survival probabilities that materials state are replaced by the library's own.
const OWN_SURVIVAL_BOUNCES: u32 = 64;

/// A path that still carries this fraction of its throughput after the first hit survives with certainty, where its limits state no other.
/// Time to equal error in the report's room is the same with 1/2 and with 1.
const CERTAIN_FRACTION: f32 = 0.5;

/// Where paths end, and how many light samples are taken at each hit.
#[derive(Clone, Copy)]
pub(super) struct Limits<'l> {
    /// Greatest number of hits.
    pub max_depth: u32,
    /// Light samples at a hit, >= 1.
    pub shadow_rays: u32,
    /// The same for hits that the camera sees itself or by way of perfectly specular surfaces alone.
    pub first_shadow_rays: u32,
    /// Whether a specular surface at the last allowed hit still shows the lights it reflects or refracts.
    pub mirrors_see_lights: bool,
    /// The bounce that the first ray comes from.
    pub previous: PreviousBounce,
    /// Light paths that find caustics beside the path, where a render has them.
    pub light_paths: Option<&'l LightPaths>,
    /// Flat mirrors in which light samples look for lamps.
    pub mirrors: Option<&'l FlatMirrors>,
    /// Fraction of its throughput after the first hit with which a path survives for certain; and after a second hit that is shared.
    pub certain_fraction: f32,
    pub certain_fraction_shared: f32,
}

impl Limits<'_> {
    /// Limits for paths that only absorption and Russian roulette end.
    #[inline(always)]
    pub fn new(shadow_rays: u32) -> Self {
        Self {
            max_depth: u32::MAX,
            shadow_rays,
            first_shadow_rays: shadow_rays,
            mirrors_see_lights: false,
            previous: None,
            light_paths: None,
            mirrors: None,
            certain_fraction: CERTAIN_FRACTION,
            certain_fraction_shared: CERTAIN_FRACTION,
        }
    }

    /// The most light samples that a hit has, of those that a description may ask for.
    #[inline]
    pub fn most_shadow_rays(&self) -> usize {
        self.shadow_rays.max(self.first_shadow_rays).min(MAX_SHADOW_RAYS) as usize
    }
}

/// The state of a path between two hits.
#[derive(Clone, Copy)]
pub(super) struct Walk<C: Spectrum> {
    /// Radiance found so far.
    pub radiance: C,
    pub throughput: C,
    /// The last bounce; `None` where a light sample could not have sampled its direction.
    pub previous: PreviousBounce,
    /// Compensates the radiance scaling of refraction in Russian roulette, so that paths inside glass are not ended more
    /// often.
    eta2: f32,
    /// Density of the path in the sense of [`LightPaths::density`], times the square of the refraction index where it is over that where
    /// it left the vertex that the camera sees, as long as light paths may find it: after that vertex it has met nothing but perfectly
    /// specular surfaces. Else 0.
    density: f32,
    /// Throughput at which a path survives with certainty: a fraction of the throughput after the first hit, so that
    /// indirect light on a dark wall has the same relative noise as on a white one.
    roulette_reference: f32,
    /// Whether the path has left a surface by other than a perfectly specular lobe.
    is_scattered: bool,
    /// Number of perfectly specular surfaces that the path has met since its last bounce that has a density.
    mirrors_met: u32,
    /// Whether the path goes on with its first wavelength alone.
    pub alone: C::Alone,
    /// Number of hits so far, including the current one.
    pub depth: u32,
}

impl<C: Spectrum> Walk<C> {
    /// The state before the first hit.
    #[inline]
    pub fn new(previous: PreviousBounce) -> Self {
        Self {
            radiance: C::ZERO,
            throughput: C::ONE,
            previous,
            eta2: 1.0,
            density: 0.0,
            roulette_reference: 1.0,
            is_scattered: previous.is_some(),
            mirrors_met: 0,
            alone: C::Alone::default(),
            depth: 0,
        }
    }

    /// One of `paths` paths into which this path is split, with no radiance yet.
    #[inline]
    pub fn split(&self, paths: u32) -> Self {
        let mut walk = *self;
        walk.radiance = C::ZERO;
        walk.throughput /= paths as f32;
        walk.roulette_reference /= paths as f32;
        walk
    }

    /// The same path with this radiance instead of its own.
    #[inline]
    pub fn having_brought(self, radiance: C) -> Self {
        Self { radiance, ..self }
    }

    /// The same path where a choice that had this probability was made.
    #[inline]
    pub fn chosen(mut self, probability: f32) -> Self {
        self.throughput /= probability;
        self
    }

    /// A second path that continues from here with this weight, into a direction that no light sample could have chosen.
    #[inline]
    pub fn branch(&self, weight: C, disperses: bool) -> Self {
        let mut walk = Self { radiance: C::ZERO, throughput: self.throughput * weight, previous: None, ..*self };
        walk.disperse(disperses);
        walk.roulette_reference = CERTAIN_FRACTION * walk.carried();
        walk
    }

    /// Plays Russian roulette with `u` in [0, 1): the probability with which the path goes on, with the throughput that makes up for
    /// those that do not; `None` where it ends. `fraction`: see [`roulette`].
    #[inline(always)]
    fn survives(&mut self, fraction: f32, u: f32) -> Option<f32> {
        let survival = roulette(fraction, self.depth);
        if survival < 1.0 {
            if u >= survival {
                return None;
            }
            self.throughput /= survival;
        }
        Some(survival)
    }

    /// Lets the path go on with its first wavelength alone, after a bounce that sends each wavelength into another direction.
    #[inline(always)]
    fn disperse(&mut self, disperses: bool) {
        if C::HAS_WAVELENGTHS && disperses {
            self.throughput = self.throughput.keep_first(&mut self.alone);
        }
    }

    /// Throughput of the path without the radiance scaling of refraction.
    #[inline(always)]
    fn carried(&self) -> f32 {
        self.throughput.max_element() * self.eta2
    }

    /// Takes off the throughput what media absorb on the way of the path's ray to its hit, or out of the scene.
    #[inline(always)]
    pub fn pass_media(
        &mut self,
        scene: &Scene,
        ray: &Ray,
        hit: Option<&Hit>,
        media: Option<PathMedia>,
        wavelengths: &C::Wavelengths,
    ) {
        if media.is_some() {
            self.throughput *= left_after::<C>(scene, ray, hit, media, wavelengths);
        }
    }

    /// Adds the radiance from infinity after the path's ray missed the scene.
    #[inline(always)]
    pub fn escape(&mut self, scene: &Scene, ray: &Ray, wavelengths: &C::Wavelengths) {
        if scene.emitters().has_infinite() {
            let from_camera = self.depth == 0 && self.previous.is_none();
            let light = escaped::<C>(scene, ray, self.previous, from_camera, wavelengths);
            self.radiance += self.throughput * light;
        }
    }

    /// Advances the path at its next vertex; returns the next ray, or `None` where the path ends.
    ///
    /// `light` receives each shadow ray with the radiance that the ray contributes if it is unoccluded. These contributions
    /// are to be added to the path's radiance in this order and before the next hit.
    #[inline(always)]
    pub fn meet<S: Sampler>(
        &mut self,
        scene: &Scene,
        vertex: &Vertex<'_, C>,
        sampler: &mut S,
        limits: &Limits,
        first: &mut impl FnMut(FirstHit),
        mut light: impl FnMut(&mut C, Way, C),
    ) -> Option<Ray> {
        if !self.arrive(scene, vertex, limits, first) {
            return None;
        }
        self.scatter(scene, vertex, sampler, (limits, None), &mut light).map(|bounce| bounce.ray)
    }

    /// Arrives at the next vertex and adds the light that its surface emits. Whether the surface also scatters light, at a depth that
    /// the limits allow.
    #[inline(always)]
    pub fn arrive(
        &mut self,
        scene: &Scene,
        vertex: &Vertex<'_, C>,
        limits: &Limits,
        first: &mut impl FnMut(FirstHit),
    ) -> bool {
        self.depth += 1;
        if self.depth == 1 {
            first(vertex.first_hit(scene));
        }
        let emitted = self.throughput * vertex.emitted(scene, self.previous);
        self.radiance += match limits.light_paths {
            Some(paths) if self.density > 0.0 && self.previous.is_none() => {
                emitted * paths.weight(self.density, scene, vertex)
            }
            _ => emitted,
        };
        self.depth <= limits.max_depth && !vertex.lobes.is_empty()
    }

    /// Number of light samples at the vertex where the path has arrived.
    #[inline(always)]
    fn shadow_rays(&self, limits: &Limits) -> u32 {
        if self.is_scattered { limits.shadow_rays } else { limits.first_shadow_rays }
    }

    /// Takes light samples at the vertex where the path has arrived, as [`Self::meet`] does, and samples its next direction. `aims`: what
    /// another ray of the vertex is aimed at.
    #[inline(always)]
    pub fn scatter<S: Sampler>(
        &mut self,
        scene: &Scene,
        vertex: &Vertex<'_, C>,
        sampler: &mut S,
        (limits, aims): (&Limits, Option<&Aims>),
        light: &mut impl FnMut(&mut C, Way, C),
    ) -> Option<Bounce<C>> {
        let shadow_rays = self.shadow_rays(limits);
        if vertex.finds_light_samples() && !scene.emitters().is_dark() {
            let mirrors = self.mirrors_beside(limits);
            for _ in 0..shadow_rays {
                let u = sampler.next_4d();
                if let Some((shadow, sent)) = vertex.light_sample(scene, u, shadow_rays, false) {
                    let sent = vertex.dispersed(&shadow, self.throughput * sent, self.alone);
                    light(&mut self.radiance, Way::Straight(shadow), sent);
                }
                if let Some(mirrors) = mirrors
                    && let Some(u) = mirrored::chosen(u)
                    && let Some((way, sent)) = mirrored::sample(vertex, scene, mirrors, aims, u, shadow_rays)
                {
                    let [to_mirror, ..] = way.rays();
                    let sent = self.throughput * sent;
                    let sent = to_mirror.map_or(sent, |ray| vertex.dispersed(&ray, sent, self.alone));
                    light(&mut self.radiance, Way::ByMirrors(way), sent);
                }
            }
        }
        self.bounce(vertex, sampler, limits)
    }

    /// The flat mirrors in which light samples look for lamps at the vertex where the path has arrived, and how many of them its bounce
    /// may meet on the way.
    #[inline(always)]
    pub fn mirrors_beside<'l>(&self, limits: &Limits<'l>) -> Option<(&'l FlatMirrors, u32)> {
        let mirrors = limits.mirrors?;
        let left = limits.max_depth.saturating_sub(self.depth);
        (left > 1).then(|| (mirrors, left - 1))
    }

    /// The bounce that led to the flat mirror where the path has arrived, as seen in the mirror: a light sample there may have looked for a
    /// lamp this way.
    #[cold]
    #[inline(never)]
    fn mirrored(&self, vertex: &Vertex<'_, C>, limits: &Limits) -> PreviousBounce {
        let (mirrors, previous) = (limits.mirrors?, self.previous?);
        let met = self.mirrors_met + 1;
        if met <= MOST_MIRRORS { mirrored::previous(vertex, mirrors, previous, met) } else { None }
    }

    /// Forgets what the path has brought and carried so far: from here on its radiance is what arrives here, at a hit that is shared.
    #[inline]
    pub fn begin_again(&mut self, limits: &Limits) {
        self.radiance = C::ZERO;
        self.throughput = C::ONE;
        self.eta2 = 1.0;
        self.roulette_reference = limits.certain_fraction_shared;
    }

    /// Forgets what the path has brought, and what it carries but for the survival of its last bounce. Roulette goes on as if it
    /// carried what it did.
    #[inline]
    pub fn begin_again_after(&mut self, survival: f32) {
        let carried = self.carried();
        self.radiance = C::ZERO;
        self.throughput = C::ONE / survival;
        self.roulette_reference *= self.carried() / carried;
    }

    /// A path that leaves this one at its vertex with this weight, this density in the sense of [`LightPaths::density`] and no radiance
    /// yet, and that roulette does not end before [`Self::end_of_chain`].
    #[inline]
    pub fn aimed(&self, weight: C, density: f32, previous: PreviousBounce) -> Self {
        let mut walk = self.branch(weight, false);
        walk.density = density;
        walk.previous = previous;
        walk.is_scattered = true;
        walk.mirrors_met = 0;
        walk.eta2 = 1.0;
        walk.keep_for_certain();
        walk
    }

    /// Gives the path this weight against others that find the same with the rest of the density.
    #[inline]
    pub fn weigh(&mut self, weight: f32) {
        self.throughput *= weight;
        self.density /= weight;
        if let Some((_, pdf)) = &mut self.previous {
            *pdf /= weight;
        }
    }

    /// Lets the path survive the next bounce.
    #[inline]
    pub fn keep_for_certain(&mut self) {
        self.roulette_reference = CERTAIN_FRACTION * self.carried();
    }

    /// Plays roulette from here on as a path that carried this after its first hit.
    #[inline]
    pub fn end_of_chain(&mut self, first: C, limits: &Limits) {
        self.roulette_reference = limits.certain_fraction * first.max_element();
    }

    /// Goes on as a path that has brought this radiance and carries this times what it does, with the same roulette.
    #[inline]
    pub fn resume(&mut self, radiance: C, weight: C) {
        let carried = self.carried();
        self.radiance = radiance;
        self.throughput *= weight;
        self.roulette_reference *= self.carried() / carried;
    }

    /// Samples the next direction and plays Russian roulette; `None` where the path ends.
    #[inline(always)]
    pub fn bounce<S: Sampler>(
        &mut self,
        vertex: &Vertex<'_, C>,
        sampler: &mut S,
        limits: &Limits,
    ) -> Option<Bounce<C>> {
        let u = sampler.next_4d();
        let mut bounce = vertex.sample_bounce(u)?;
        let depth = self.depth;
        if depth == limits.max_depth && bounce.pdf.is_none() && !limits.mirrors_see_lights {
            return None;
        }
        self.throughput *= bounce.weight;
        self.disperse(bounce.disperses);
        self.eta2 *= bounce.eta * bounce.eta;
        self.previous = match bounce.pdf {
            Some(pdf) => Some((vertex.receiver(), pdf / self.shadow_rays(limits) as f32)),
            None if limits.mirrors.is_some() => self.mirrored(vertex, limits),
            None => None,
        };
        self.mirrors_met = if bounce.pdf.is_none() { self.mirrors_met + 1 } else { 0 };
        self.is_scattered |= bounce.pdf.is_some();
        self.density = match (bounce.pdf, limits.light_paths) {
            (None, _) if is_of_chain(vertex, depth - 1) => self.density * (bounce.eta * bounce.eta),
            (Some(pdf), Some(paths)) if depth == 1 => paths.density(vertex, bounce.ray.direction, pdf),
            _ => 0.0,
        };

        // Russian roulette takes the survival probability that the scene sets for the surface, or else the throughput. The
        // ray after the last allowed hit only looks for a light, so it needs no roulette.
        if depth < limits.max_depth {
            let carried = self.carried();
            if carried <= 0.0 {
                return None;
            }
            if depth == 1 {
                self.roulette_reference = limits.certain_fraction * carried;
            }
            let fraction = match vertex.survival {
                Some(survival) if bounce.pdf.is_some() && depth < OWN_SURVIVAL_BOUNCES => survival,
                _ => carried / self.roulette_reference,
            };
            bounce.survival = self.survives(fraction, u[3])?;
        }
        Some(bounce)
    }
}

/// Traces one path from its first ray, which starts in `media`, to its end.
#[inline]
pub(super) fn trace<C: Spectrum, S: Sampler, T: Tracer>(
    ray: Ray,
    mut media: Option<PathMedia>,
    context: &mut Context<'_, S, T, C>,
    first: &mut impl FnMut(FirstHit),
    limits: &Limits,
) -> C {
    let mut walk = Walk::new(limits.previous);
    let (mut next, mut mirrored) = (Some(ray), C::ZERO);
    while let Some(ray) = next {
        let hit = arrive(context.scene, context.tracer, &ray, &mut media);
        walk.pass_media(context.scene, &ray, hit.as_ref(), media, &context.wavelengths);
        let Some(hit) = hit else {
            walk.escape(context.scene, &ray, &context.wavelengths);
            break;
        };
        let mut slot = None;
        let vertex = Vertex::new(context.scene, &ray, &hit, context.wavelengths, media, &mut slot);
        let Context { scene, sampler, tracer, .. } = context;
        next = walk.meet(scene, &vertex, *sampler, limits, first, |radiance, way, sent| match way {
            Way::Straight(shadow) => {
                if let Some(sent) = vertex.unoccluded(scene, *tracer, &shadow, sent) {
                    *radiance += sent;
                }
            }
            // There are no media where light samples look for lamps in mirrors.
            Way::ByMirrors(way) => {
                if way.rays().iter().flatten().all(|ray| tracer.unoccluded(ray)) {
                    mirrored += sent;
                }
            }
        });
        if let Some(next) = &next {
            media = vertex.media_beyond(scene, next);
        }
    }
    walk.radiance + mirrored
}

/// Light that a vertex scatters back along the path, by light samples combined with one path of up to `max_depth` hits that
/// begins with a Bsdf sample; 0 hits are light from the emitters alone. The emission of the vertex itself and the light of
/// delta lobes are not included. `alone` says whether the path has its first wavelength alone; what the vertex then disperses
/// is at that wavelength only, and paths of several hits must not disperse once more.
#[inline]
pub(super) fn scattered_light<C: Spectrum, S: Sampler, T: Tracer>(
    vertex: &Vertex<'_, C>,
    context: &mut Context<'_, S, T, C>,
    max_depth: u32,
    shadow_rays: u32,
    alone: C::Alone,
) -> C {
    let mut radiance = C::ZERO;
    vertex.add_light_samples(&mut radiance, context, shadow_rays, false, alone);
    let bounce = vertex.sample_bounce(context.sampler.next_4d());
    if let Some(bounce) = bounce.filter(|bounce| bounce.pdf.is_some()) {
        let previous = bounce.pdf.map(|pdf| (vertex.receiver(), pdf / shadow_rays as f32));
        let limits = Limits { max_depth, previous, ..Limits::new(shadow_rays) };
        let media = vertex.media_beyond(context.scene, &bounce.ray);
        let mut weight = bounce.weight;
        if C::HAS_WAVELENGTHS && bounce.disperses {
            weight = weight.keep_first(&mut { alone });
        }
        radiance += weight * trace(bounce.ray, media, context, &mut |_| {}, &limits);
    }
    radiance
}

/// Survival probability of a path that carries this fraction of its reference, after `depth` hits.
///
/// A path without losses reaches hit n with probability (N / n)^2 beyond N = [`CERTAIN_BOUNCES`], so that it ends after 2 N
/// hits on the average. A constant survival probability q would make the variance infinite where the albedo exceeds sqrt(q),
/// because weights would then grow faster than the throughput falls: at an albedo of 0.999, this happens for any q below
/// 0.998.
#[inline]
pub(super) fn roulette(fraction: f32, depth: u32) -> f32 {
    let most = if depth < CERTAIN_BOUNCES { 1.0 } else { 1.0 - 2.0 / depth as f32 };
    fraction.min(most)
}
