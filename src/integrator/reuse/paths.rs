//! The vertices of paths that groups share, and the light that arrives there.

use super::kept::KeptVertex;
use crate::bsdf::Bsdf;
use crate::emitter::Receiver;
use crate::integrator::aim::Aims;
use crate::integrator::mirrored::{self, Way};
use crate::integrator::vertex::{LightSample, Vertex};
use crate::integrator::walk::{Limits, Walk};
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::sampling::mis::balance_heuristic;
use crate::scene::{FlatMirrors, Scene};
use crate::spectrum::Spectrum;

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
    pub fn keep_bsdf(&mut self, vertex: &KeptVertex<C>, bsdf: Option<Bsdf<C>>) {
        if vertex.has_own_bsdf() {
            self.bsdfs.extend(bsdf);
        }
    }

    /// The weight of a path whose second vertex is perfectly specular, against an aimed path that might have met it in this direction.
    #[inline]
    pub fn weight_against_aims(&self, path: usize, aims: &Aims, direction: Vec3) -> f32 {
        match &self.firsts[path] {
            Some(First { vertex, left: Some((pdf, _)), .. }) if !aims.is_empty() => {
                balance_heuristic(*pdf, aims.pdf(vertex.point.p, vertex.facing, direction))
            }
            _ => 1.0,
        }
    }

    /// Adds light that arrived without being occluded.
    #[inline]
    pub fn add(&mut self, arrival: &Arrival<C>, walks: &mut [Walk<C>]) {
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
    pub fn take_emission(&mut self, path: usize, walk: &mut Walk<C>, pdf: impl FnOnce(Receiver) -> f32) {
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
    pub fn take_infinite(
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
            walk.escape(scene, ray, wavelengths);
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
pub(super) struct Arrival<C: Spectrum> {
    pub path: u32,
    pub light: C,
    pub at: At,
}

/// Where light arrives.
#[derive(Clone, Copy, Debug)]
pub(super) enum At {
    /// At the camera: the light is the path's own.
    Path,
    /// At the first vertex, from a second vertex that reflects it into all directions.
    ConstantSecond,
    /// At the second vertex: see [`Light`].
    Second { wi: Vec3, pdf: f32, alone: bool },
}

impl<C: Spectrum> Second<C> {
    /// Arrives at a second vertex.
    #[inline]
    pub fn new(vertex: KeptVertex<C>, receiver: Receiver, walk: &Walk<C>) -> Self {
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
    pub fn light<S: Sampler>(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_, C>,
        sampler: &mut S,
        (samples, mirrors): (u32, Option<(&FlatMirrors, u32)>),
        mut send: impl FnMut(Way, C, At),
    ) {
        if scene.emitters().is_dark() {
            return;
        }
        let is_constant = self.vertex.constant_f().is_some();
        // Where the Bsdf is another one for each first vertex, lamps in mirrors are left to bounces.
        let mirrors = mirrors.filter(|_| is_constant);
        for _ in 0..samples {
            let u = sampler.next_4d();
            if let Some(mirrors) = mirrors
                && let Some(u) = mirrored::chosen(u)
                && let Some((way, light)) = mirrored::sample(vertex, scene, mirrors, None, u, samples)
            {
                send(Way::ByMirrors(way), light, At::ConstantSecond);
            }
            if let Some(sample) = vertex.sample_light(scene, u, samples, false, !is_constant) {
                if is_constant {
                    send(Way::Straight(sample.shadow), sample.f * sample.radiance * sample.scale(), At::ConstantSecond);
                } else {
                    let LightSample { shadow, wi, radiance, pdf, alone, .. } = sample;
                    send(Way::Straight(shadow), radiance * wi.z.abs(), At::Second { wi, pdf, alone });
                }
            }
        }
    }

    /// Samples the path's next direction, and lets the path begin again with what arrives from there. A path that is reflected
    /// perfectly goes on as its own.
    #[inline(always)]
    pub fn leave<S: Sampler>(
        &mut self,
        vertex: &Vertex<'_, C>,
        walk: &mut Walk<C>,
        sampler: &mut S,
        limits: &Limits,
    ) -> Option<Ray> {
        walk.begin_again(limits);
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
