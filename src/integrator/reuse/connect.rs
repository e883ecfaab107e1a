//! Connections of all first vertices of a group with all its second vertices.

use std::ops::Range;

use super::GROUP;
use super::paths::{First, Light, Paths, Second};
use crate::bsdf::Bsdf;
use crate::integrator::tracer::Tracer;
use crate::math::{Ray, Vec3};
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// A connection of a first vertex with a second one.
#[derive(Clone, Copy, Debug)]
struct Connection<C: Spectrum> {
    /// Number of the path of the first vertex.
    path: u32,
    /// Whether anything is between them.
    is_clear: bool,
    /// Density with which the first vertex would have sampled the second, by area (length^-2).
    density: f32,
    /// Throughput from the second vertex to the camera: f |cos| |cos'| over the squared distance, times that of the first vertex.
    weight: C,
    /// The direction from the second vertex to the first, in the local frame of the second.
    wo: Vec3,
}

/// The connections of one group. The memory is kept from group to group.
#[derive(Debug, Default)]
pub(super) struct Connections<C: Spectrum> {
    connections: Vec<Connection<C>>,
    /// For each second vertex that brings light: its path, and the end of its connections.
    ends: Vec<(u32, u32)>,
    shadows: Vec<Ray>,
    clear: Vec<bool>,
}

impl<C: Spectrum> Connections<C> {
    /// Connects the vertices of the paths in `group`. `add` receives the number of each path that gets light, and the light. `is_limited`:
    /// whether paths have a greatest depth, so that a second vertex brings more or fewer bounces than one of another depth.
    #[inline(always)]
    pub fn connect<T: Tracer>(
        &mut self,
        scene: &Scene,
        paths: &Paths<C>,
        (group, is_limited): (Range<usize>, bool),
        tracer: &mut T,
        mut add: impl FnMut(usize, C),
    ) {
        let Self { connections, ends, shadows, clear } = self;
        connections.clear();
        ends.clear();
        shadows.clear();
        // The most that a group can have, so that no later group allocates.
        connections.reserve(GROUP * GROUP);
        ends.reserve(GROUP);
        shadows.reserve(GROUP * GROUP);
        clear.reserve((GROUP * GROUP).saturating_sub(clear.len()));
        for path in group.clone() {
            let (Some(second), Some(first)) = (&paths.seconds[path], &paths.firsts[path]) else { continue };
            if !second.brings_light() {
                continue;
            }
            let Some(own) = Connection::of_path(path, first, second) else { continue };
            // What is not finite is its own path's alone, which is then found and reported; so is what is so far away that its density vanishes.
            if !second.is_finite(paths) || !own.is_finite() || own.density <= 0.0 {
                add(path, second.weight * second.scattered_alone(scene, paths));
                continue;
            }
            connections.push(own);
            for other in group.clone().filter(|other| *other != path) {
                let Some(from) = &paths.firsts[other] else { continue };
                if is_limited && from.depth != first.depth {
                    continue;
                }
                if let Some((connection, shadow)) = Connection::between(scene, &paths.bsdfs, other, from, second) {
                    connections.push(connection);
                    shadows.push(shadow);
                }
            }
            ends.push((path as u32, connections.len() as u32));
        }
        clear.resize(shadows.len(), false);
        tracer.unoccluded_many(shadows, clear);

        let (mut begin, mut found) = (0, clear.iter());
        for (path, end) in &*ends {
            let (path, connections) = (*path as usize, &mut connections[begin..*end as usize]);
            begin = *end as usize;
            for other in &mut connections[1..] {
                other.is_clear = found.next().is_some_and(|clear| *clear);
            }
            let (Some(second), Some(first)) = (&paths.seconds[path], &paths.firsts[path]) else { continue };
            let survival = first.left.map_or(1.0, |(_, survival)| survival);
            second.scatter(scene, paths, connections, survival, &mut add);
        }
    }
}

impl<C: Spectrum> Connection<C> {
    /// The connection that a path has made itself. `None` where it did not sample its second vertex.
    #[inline]
    fn of_path(path: usize, first: &First<C>, second: &Second<C>) -> Option<Self> {
        let (pdf, survival) = first.left?;
        let d = first.vertex.point.p - second.vertex.point.p;
        let density = pdf * second.vertex.area_by_solid_angle(d).recip();
        // The throughput holds the survival already, by which what the second vertex scatters is divided.
        let weight = second.weight * (density * survival);
        Some(Self { path: path as u32, is_clear: true, density, weight, wo: second.vertex.wo })
    }

    /// The connection of a second vertex with the first vertex of another path, and the segment that must be clear; `None` where no light
    /// is scattered that way.
    #[inline]
    fn between(
        scene: &Scene,
        bsdfs: &[Bsdf<C>],
        path: usize,
        first: &First<C>,
        second: &Second<C>,
    ) -> Option<(Self, Ray)> {
        let d = first.vertex.point.p - second.vertex.point.p;
        let w = d.normalize();
        let wo = second.vertex.seen_from(w)?;
        let wi = first.vertex.consistent(-w)?;
        let (f, pdf) = first.vertex.f_pdf(scene, bsdfs, first.vertex.wo, wi);
        // Solid angle at the first vertex by area at the second.
        let angle = second.vertex.area_by_solid_angle(d).recip();
        let weight = first.throughput * f * (wi.z.abs() * angle);
        let connection = Self { path: path as u32, is_clear: false, density: pdf * angle, weight, wo };
        // Points that lie too close for their distance to be known are not connected.
        (pdf > 0.0 && connection.is_finite()).then(|| (connection, second.vertex.segment_to(&first.vertex, w)))
    }

    #[inline]
    fn is_finite(&self) -> bool {
        self.density.is_finite() && self.weight.max_element().is_finite()
    }
}

impl<C: Spectrum> Second<C> {
    /// Whether any light was found that the vertex may scatter.
    #[inline]
    fn brings_light(&self) -> bool {
        self.reflected != C::ZERO
            || !self.lights.is_empty()
            || !self.emissions.is_empty()
            || self.emitted != C::ZERO
            || self.beyond != C::ZERO
    }

    #[inline]
    fn is_finite(&self, paths: &Paths<C>) -> bool {
        let lights = self.arriving(paths).all(|light| light.light.is_finite());
        lights && [self.reflected, self.emitted, self.beyond].into_iter().all(C::is_finite)
    }

    #[inline]
    fn arriving<'p>(&self, paths: &'p Paths<C>) -> impl Iterator<Item = &'p Light<C>> {
        self.lights.of(&paths.lights).iter().chain(self.emissions.of(&paths.lights))
    }

    /// Scatters the light that arrives at the vertex over its connections, of which the path's own is the first. `survival`: the
    /// probability with which the path survived on the way to the vertex.
    #[inline]
    fn scatter(
        &self,
        scene: &Scene,
        paths: &Paths<C>,
        connections: &[Connection<C>],
        survival: f32,
        mut add: impl FnMut(usize, C),
    ) {
        let clear = || connections.iter().filter(|connection| connection.is_clear);
        let total: f32 = clear().map(|connection| connection.density).sum();
        let scale = 1.0 / (total * survival);
        if let Some(f) = self.vertex.constant_f() {
            let light = self.scattered_evenly(f);
            clear().for_each(|connection| add(connection.path as usize, connection.weight * scale * light));
            return;
        }
        let mut light = [C::ZERO; GROUP];
        let mut fs = [C::ZERO; GROUP];
        // Sets f of each connection, and returns the sum of their densities by area and direction together.
        let scattered = |wi: Vec3, fs: &mut [C; GROUP]| {
            let mut joint = 0.0;
            for (connection, f) in clear().zip(fs) {
                let pdf;
                (*f, pdf) = self.vertex.f_pdf(scene, &paths.bsdfs, connection.wo, wi);
                joint += connection.density * pdf;
            }
            joint
        };
        let mut arrive = |fs: &[C; GROUP], arriving: C, density: f32| {
            // The density comes before the light: their quotient may be beyond single precision where what is scattered is not.
            let scale = 1.0 / (density * survival);
            if scale.is_finite() {
                for (connection, (light, f)) in clear().zip(light.iter_mut().zip(fs)) {
                    *light += connection.weight * scale * *f * arriving;
                }
            }
        };
        // Light samples are taken at each of the second vertices that a first vertex might have sampled.
        let density = |light: &Light<C>, joint: f32| light.pdf * total + if light.alone { 0.0 } else { joint };
        for sample in self.lights.of(&paths.lights) {
            let joint = scattered(sample.wi, &mut fs);
            arrive(&fs, sample.light, density(sample, joint));
        }
        if let Some((wi, _)) = self.bounce {
            let joint = scattered(wi, &mut fs);
            for emission in self.emissions.of(&paths.lights) {
                arrive(&fs, emission.light, density(emission, joint));
            }
            arrive(&fs, self.beyond * wi.z.abs(), joint);
        }
        for (connection, light) in clear().zip(light) {
            add(connection.path as usize, light);
        }
    }

    /// What the vertex scatters into any direction, where f is constant.
    #[inline]
    fn scattered_evenly(&self, f: C) -> C {
        match self.bounce {
            Some((wi, pdf)) => self.reflected + f * (self.emitted + self.beyond) * (wi.z.abs() / pdf),
            None => self.reflected,
        }
    }

    /// What the vertex scatters back along its own path.
    #[cold]
    fn scattered_alone(&self, scene: &Scene, paths: &Paths<C>) -> C {
        if let Some(f) = self.vertex.constant_f() {
            return self.scattered_evenly(f);
        }
        let mut scattered = C::ZERO;
        for light in self.arriving(paths) {
            let (f, pdf) = self.vertex.f_pdf(scene, &paths.bsdfs, self.vertex.wo, light.wi);
            scattered += f * light.light * (1.0 / (light.pdf + if light.alone { 0.0 } else { pdf }));
        }
        if let Some((wi, pdf)) = self.bounce {
            let (f, _) = self.vertex.f_pdf(scene, &paths.bsdfs, self.vertex.wo, wi);
            scattered += f * self.beyond * (wi.z.abs() / pdf);
        }
        scattered
    }
}
