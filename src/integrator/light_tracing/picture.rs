//! The light that light paths bring to the pixels of a film.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use super::{LightPaths, Start, is_of_chain};
use crate::control::Parallel;
use crate::error::Result;
use crate::film::Film;
use crate::integrator::mirrored::{MOST_MIRRORS, is_looked_at};
use crate::integrator::tracer::{SceneTracer, Tracer};
use crate::integrator::vertex::Vertex;
use crate::integrator::walk::roulette;
use crate::math::{Ray, Vec3};
use crate::room::filled;
use crate::sampling::{Filter, Sampler, SobolSampler};
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

/// Number of light paths that a worker traces one after another.
pub const PATHS_A_BLOCK: u32 = 1 << 12;

/// Number of light paths that are traced side by side.
const WAVE: usize = 256;

/// Most pictures, times their pixels, that are in memory at the same time, if there is more than one.
const MOST_PIXELS: u64 = 1 << 24;

/// Most splats that are in memory at the same time, if light paths arrive once. Few arrive more often.
const MOST_SPLATS: usize = 1 << 20;

/// A path that carries this fraction of what it began with survives with certainty.
const CERTAIN_FRACTION: f32 = 0.5;

/// The pictures that light paths make of consecutive samples.
#[derive(Clone, Debug, Default)]
pub struct LightPictures {
    /// Index of the first sample.
    from: u32,
    /// For each sample the light of each pixel of the film, row by row.
    pictures: Arc<Vec<Vec<Rgb>>>,
}

/// Light for a pixel of the film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splat {
    pub pixel: u32,
    pub light: Rgb,
}

/// What a block of light paths brings.
#[derive(Default)]
pub(crate) struct Splats {
    pub splats: Vec<Splat>,
    pub rays: u64,
}

/// Where splats go: a film as a part of its picture, and the filter of its pixels.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    pub origin: [u32; 2],
    pub resolution: [u32; 2],
    pub filter: Filter,
}

impl Target {
    /// The target for a film.
    pub fn of(film: &Film, filter: &Filter) -> Self {
        Self { origin: film.origin(), resolution: film.options().resolution, filter: filter.clone() }
    }

    /// The greatest number of pixels that see a film position.
    fn most_pixels(&self) -> usize {
        let side = (2.0 * self.filter.radius()).ceil() as usize;
        (side * side).max(1)
    }

    /// Calls `add` with each pixel that sees a film position, and the weight with which it does.
    #[inline]
    fn each_pixel(&self, [x, y]: [f32; 2], mut add: impl FnMut(u32, f32)) {
        let radius = self.filter.radius();
        let ([left, top], [width, height]) = (self.origin, self.resolution);
        // Pixel i has its middle at i + 1/2, and sees what lies less than the radius from there. All is computed in the picture, whatever part
        // of it the film is.
        let range = |at: f32, from: u32, size: u32| {
            let first = (at - radius - 0.5).ceil().max(from as f32);
            let end = (at + radius - 0.5).ceil().min((from + size) as f32).max(0.0);
            first as u32..end as u32
        };
        for row in range(y, top, height) {
            for column in range(x, left, width) {
                let weight = self.filter.evaluate(x - (column as f32 + 0.5), y - (row as f32 + 0.5));
                if weight != 0.0 {
                    add((row - top) * width + (column - left), weight);
                }
            }
        }
    }
}

/// A light path between two hits.
struct LightWalk {
    ray: Ray,
    /// Radiance times what the specular surfaces let through, over the density of the start.
    carried: Rgb,
    /// Brightness of what was carried at first.
    reference: f32,
    /// Density of the start times the square of the refraction index where the path is, over that where it began.
    density: f32,
    depth: u32,
    /// Whether it has met one or two flat mirrors that light samples look into, and nothing else.
    is_mirrored: bool,
    /// Its number in the wave.
    number: u32,
}

impl LightWalk {
    fn new(start: Start, number: u32) -> Self {
        let Start { ray, density, radiance } = start;
        let carried = radiance * density.recip();
        Self { ray, carried, reference: carried.max_element(), density, depth: 0, is_mirrored: false, number }
    }
}

/// A connection of a light path with the camera that nothing occludes.
pub(crate) struct Connection {
    shadow: Ray,
    /// The film position, in pixels of the picture.
    pub place: [f32; 2],
    /// What arrives there, over the density of the light path alone.
    pub light: Rgb,
    /// Density of the light path times the number of light paths.
    pub density: f32,
    /// Density with which paths from the camera find the place, over the cosine of the light there, and density of the direction by
    /// the Bsdf (sr^-1).
    pub seen: f32,
    pub pdf: f32,
    /// The place, the unit normal on the side of the camera, and the direction that the light comes from.
    pub at: [Vec3; 3],
}

impl Connection {
    /// Weight against paths from the camera that choose the direction with this density (sr^-1).
    #[inline]
    pub fn weight(&self, pdf: f32) -> f32 {
        self.density / (self.density + self.seen * pdf)
    }
}

impl LightPictures {
    /// Traces the light paths of the samples `from..to`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`], `OutOfMemory` for pictures that do not fit.
    pub(crate) fn trace(
        scene: &Scene,
        paths: &LightPaths,
        film: &Film,
        filter: &Filter,
        (from, to, seed): (u32, u32, u64),
        parallel: &mut impl Parallel,
    ) -> Result<(Self, u64)> {
        let target = Target::of(film, filter);
        let pixels = target.resolution.map(|side| side as usize).iter().product::<usize>();
        let blocks = paths.count().div_ceil(PATHS_A_BLOCK) as usize;
        let samples = (to - from) as usize;
        let empty = || filled(Rgb::ZERO, pixels).map(Mutex::new);
        let pictures = Arc::new((0..samples).map(|_| empty()).collect::<Result<Vec<_>>>()?);
        // Some blocks at a time, so that what they bring fits into memory.
        let chunk = (MOST_SPLATS / (PATHS_A_BLOCK as usize * target.most_pixels())).max(1);
        let (mut rays, mut first) = (0, 0);
        while first < samples * blocks {
            let pieces = chunk.min(samples * blocks - first);
            let splats = {
                let (scene, paths, target, token) = (scene.clone(), paths.clone(), target.clone(), parallel.token());
                parallel.map(pieces, move |piece| {
                    if token.is_cancelled() {
                        return Splats::default();
                    }
                    let (sample, block) = (from + ((first + piece) / blocks) as u32, ((first + piece) % blocks) as u32);
                    let begin = block * PATHS_A_BLOCK;
                    let range = begin..begin.saturating_add(PATHS_A_BLOCK).min(paths.count());
                    paths.block(&scene, &target, (sample, seed), range)
                })?
            };
            rays += splats.iter().map(|splats| splats.rays).sum::<u64>();
            let (some, pictures) = (first / blocks, Arc::clone(&pictures));
            parallel.map((first + pieces).div_ceil(blocks) - some, move |sample| {
                let sample = some + sample;
                let of_sample = (sample * blocks).max(first)..((sample + 1) * blocks).min(first + pieces);
                let mut picture = pictures[sample].lock().unwrap_or_else(PoisonError::into_inner);
                // In the order of the paths, so that sums have the same bits whoever traced them.
                for splat in splats[of_sample.start - first..of_sample.end - first].iter().flat_map(|it| &it.splats) {
                    picture[splat.pixel as usize] += splat.light;
                }
            })?;
            first += pieces;
        }
        let take =
            |picture: &Mutex<Vec<Rgb>>| std::mem::take(&mut *picture.lock().unwrap_or_else(PoisonError::into_inner));
        Ok((Self { from, pictures: Arc::new(pictures.iter().map(take).collect()) }, rays))
    }

    /// Most samples whose pictures are made at the same time.
    pub fn most_samples(film: &Film) -> u32 {
        let pixels = film.options().resolution.map(u64::from).iter().product::<u64>();
        (MOST_PIXELS / pixels.max(1)).max(1) as u32
    }

    /// What light paths bring to a pixel of the film (index in row order) in the sample with this index.
    #[inline]
    pub fn light(&self, sample: u32, pixel: usize) -> Rgb {
        let picture = sample.checked_sub(self.from).and_then(|index| self.pictures.get(index as usize));
        picture.and_then(|picture| picture.get(pixel)).copied().unwrap_or(Rgb::ZERO)
    }
}

impl LightPaths {
    /// Traces some light paths of a sample, and collects what they bring to pixels.
    pub(crate) fn block(&self, scene: &Scene, target: &Target, which: (u32, u64), range: Range<u32>) -> Splats {
        let mut splats = Vec::new();
        let rays = self.connections(scene, which, range, &mut |connection| {
            let light = connection.light * connection.weight(connection.pdf + self.aimed_pdf(connection.at));
            target.each_pixel(connection.place, |pixel, weight| splats.push(Splat { pixel, light: weight * light }));
        });
        Splats { splats, rays }
    }

    /// Traces some light paths of a sample, and calls `add` with each connection with the camera. Returns the number of rays.
    pub(crate) fn connections(
        &self,
        scene: &Scene,
        (sample, seed): (u32, u64),
        range: Range<u32>,
        add: &mut dyn FnMut(&Connection),
    ) -> u64 {
        let mut tracer = SceneTracer::new(scene);
        let mut samplers = vec![SobolSampler::new(seed, u32::MAX); WAVE];
        let mut walks: Vec<LightWalk> = Vec::with_capacity(WAVE);
        let (mut rays, mut hits) = (Vec::with_capacity(WAVE), vec![None::<Hit>; WAVE]);
        let (mut connections, mut shadows, mut clear) = (Vec::<Connection>::new(), Vec::new(), Vec::new());
        let mut from = range.start;
        while from < range.end {
            let count = (range.end - from).min(WAVE as u32);
            walks.clear();
            for number in 0..count {
                let sampler = &mut samplers[number as usize];
                sampler.start(sample, from + number);
                let (u, d) = (sampler.next_4d(), sampler.next_4d());
                walks.extend(self.start(scene, u, d).map(|start| LightWalk::new(start, number)));
            }
            from += count;
            connections.clear();
            while !walks.is_empty() {
                rays.clear();
                rays.extend(walks.iter().map(|walk| walk.ray));
                let hits = &mut hits[..rays.len()];
                tracer.intersect_many(&rays, hits);
                let mut hits = hits.iter();
                walks.retain_mut(|walk| {
                    let Some(Some(hit)) = hits.next() else { return false };
                    let sampler = &mut samplers[walk.number as usize];
                    self.advance(scene, walk, hit, sampler, &mut connections)
                });
            }
            shadows.clear();
            shadows.extend(connections.iter().map(|connection| connection.shadow));
            clear.clear();
            clear.resize(shadows.len(), false);
            tracer.unoccluded_many(&shadows, &mut clear);
            connections.iter().zip(&clear).filter(|(_, clear)| **clear).for_each(|(connection, _)| add(connection));
        }
        tracer.rays
    }

    /// Connects a light path with the camera at its next hit, and lets it go on from there by a perfectly specular lobe. Whether it does.
    #[inline]
    fn advance(
        &self,
        scene: &Scene,
        walk: &mut LightWalk,
        hit: &Hit,
        sampler: &mut SobolSampler,
        connections: &mut Vec<Connection>,
    ) -> bool {
        let mut slot = None;
        let vertex = Vertex::<Rgb>::of_light_path(scene, &walk.ray, hit, (), None, &mut slot);
        walk.depth += 1;
        // What light samples find beside paths from the camera is theirs.
        if walk.depth > 1 && !walk.is_mirrored && vertex.finds_light_samples() {
            connections.extend(self.connect(scene, walk, hit, vertex.surface.point.p));
        }
        if !vertex.lobes.have_specular() || !is_of_chain(&vertex, walk.depth) {
            return false;
        }
        let u = sampler.next_4d();
        let Some(bounce) = vertex.sample_bounce(u).filter(|bounce| bounce.pdf.is_none()) else { return false };
        let may_be = walk.depth <= MOST_MIRRORS && (walk.depth == 1 || walk.is_mirrored);
        walk.is_mirrored = may_be && is_looked_at(scene, &vertex);
        walk.carried *= bounce.weight * vertex.shading_adjoint(bounce.ray.direction);
        walk.density *= bounce.eta * bounce.eta;
        let left = walk.carried.max_element();
        let survival = roulette(left / (CERTAIN_FRACTION * walk.reference), walk.depth);
        if survival.is_nan() || survival <= 0.0 || u[3] >= survival {
            return false;
        }
        if survival < 1.0 {
            walk.carried /= survival;
        }
        walk.ray = bounce.ray;
        true
    }

    /// The connection of a light path with the camera from where it has arrived; `None` where the camera sees nothing of it.
    #[inline]
    fn connect(&self, scene: &Scene, walk: &LightWalk, hit: &Hit, p: Vec3) -> Option<Connection> {
        let camera = &self.camera;
        let place = camera.film_position(p)?;
        // As a ray of the camera meets it, so that normals are those that paths from the camera see.
        let to = p - camera.eye();
        let distance = to.length();
        let ray = Ray::new(camera.eye(), to / distance);
        let hit = hit.at_distance(distance);
        let mut slot = None;
        let vertex = Vertex::<Rgb>::new(scene, &ray, &hit, (), None, &mut slot);
        let wi = -walk.ray.direction;
        let local = vertex.consistent(wi)?;
        let (f, pdf) = vertex.f_pdf(local);
        if f == Rgb::ZERO {
            return None;
        }
        let cosine = vertex.surface.ng.dot(wi).abs();
        let seen = self.seen_density(vertex.surface.point.p, vertex.surface.ng) / cosine;
        let light = walk.carried * f * (seen * local.z.abs());
        let shadow = vertex.surface.point.leave_to(vertex.facing(), camera.eye());
        let at = [vertex.surface.point.p, vertex.facing(), wi];
        Some(Connection { shadow, place, light, density: walk.density, seen, pdf, at })
    }
}
