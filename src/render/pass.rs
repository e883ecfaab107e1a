//! One pass: some samples for every pixel, tile by tile, in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::non_finite::Suspects;
use super::workers::Work;
use super::{Method, Render};
use crate::Cancel;
use crate::camera::Camera;
use crate::desc::{RenderDesc, SamplerDesc};
use crate::film::{Film, PixelPhotonState, REPLICATES, TILE};
use crate::integrator::{Direct, Integrator, Irradiance, Path, Sample, Tracer, Wave, Whitted};
use crate::math::Ray;
use crate::sampling::{Filter, Pattern, PatternSampler, Sampler, SobolSampler};
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

/// Samples that are taken together: enough to fill packets when most paths have ended, few enough to stay in the nearest caches.
const WAVE: usize = 128;

/// Samples of those that are taken one after another between two looks at the clock and two additions to the film.
const IN_A_ROW: usize = 16;

/// Everything the workers of a pass share.
pub(super) struct Pass {
    scene: Scene,
    camera: Camera,
    filter: Filter,
    desc: Arc<RenderDesc>,
    method: Method,
    /// Samples that each pixel is to have afterwards. It goes on from those it has, so that a render that was stopped in
    /// the middle of a pass can be resumed.
    samples: u32,
    /// The same of each pixel, row by row, where they differ.
    pub goals: Option<Vec<u32>>,
    film: Arc<Film>,
    deadline: Option<Instant>,
    cancel: Cancel,
    pub stop: AtomicBool,
    pub rays: AtomicU64,
    /// Samples that were NaN or infinite.
    pub non_finite: Mutex<Suspects>,
    /// The tile that is taken next.
    next: AtomicUsize,
    tiles_done: AtomicUsize,
    /// A sample to take once more instead.
    again: Option<Again>,
}

/// A sample that is taken once more.
struct Again {
    pixel: [u32; 2],
    sample: u32,
    limit: u64,
    replayed: Mutex<Replayed>,
}

/// What taking a sample once more showed.
#[derive(Default)]
pub(super) struct Replayed {
    pub radiance: Rgb,
    /// Rays that it asked for.
    pub rays: u64,
    /// The last ray and what it met, if it was not a shadow ray.
    pub last: Option<(Ray, Hit)>,
}

/// Traces, counts, and once the pass is stopped finds nothing more, so that the longest path soon ends.
struct PassTracer<'p> {
    scene: &'p Scene,
    pass: &'p Pass,
    rays: u64,
    /// The last ray that is answered; no limit but in a replay.
    limit: u64,
}

impl<'p> PassTracer<'p> {
    fn new(pass: &'p Pass) -> Self {
        let limit = pass.again.as_ref().map_or(u64::MAX, |again| again.limit);
        Self { scene: &pass.scene, pass, rays: 0, limit }
    }
}

/// What the last ray of a replay meets, and none after it, nor any of a pass that is stopped.
///
/// Takes copies: if it was given the tracer or the ray where they are, both would be kept in memory for its sake, which
/// costs 5 % of all rays a second.
#[cold]
#[inline(never)]
fn intersect_at_end(pass: &Pass, ray: Ray, number: u64) -> Option<Hit> {
    let again = pass.again.as_ref().filter(|again| number <= again.limit && !pass.is_stopped())?;
    let hit = pass.scene.intersect(&ray)?;
    again.replayed.lock().unwrap_or_else(PoisonError::into_inner).last = Some((ray, hit));
    Some(hit)
}

impl Tracer for PassTracer<'_> {
    #[inline(always)]
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        if self.pass.is_stopped() | (self.rays >= self.limit) {
            return intersect_at_end(self.pass, *ray, self.rays);
        }
        self.scene.intersect(ray)
    }

    #[inline]
    fn unoccluded(&mut self, ray: &Ray) -> bool {
        self.rays += 1;
        !self.pass.is_stopped() && self.scene.unoccluded(ray)
    }

    #[inline]
    fn intersect_many(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let before = self.rays;
        self.rays += rays.len() as u64;
        if self.pass.is_stopped() | (self.rays >= self.limit) {
            for (number, (ray, hit)) in (before + 1..).zip(rays.iter().zip(hits)) {
                *hit = intersect_at_end(self.pass, *ray, number);
            }
        } else {
            self.scene.intersect_many(rays, hits);
        }
    }

    #[inline]
    fn unoccluded_many(&mut self, rays: &[Ray], clear: &mut [bool]) {
        self.rays += rays.len() as u64;
        if self.pass.is_stopped() {
            clear.fill(false);
        } else {
            self.scene.unoccluded_many(rays, clear);
        }
    }
}

/// A sample of a pixel that is being taken.
struct Job {
    pixel: [u32; 2],
    /// Its number in the tile.
    index: usize,
    sample: u32,
    /// From the pixel's middle, as the filter draws it, in pixels, and the weight of that.
    offset: [f32; 2],
    weight: f32,
    /// What the pixel remembers: a copy, as the sample may be stopped in the middle. Such samples are taken one at a time.
    gathering: Option<PixelPhotonState>,
}

/// What a worker takes at once.
struct Batch<S> {
    jobs: Vec<Job>,
    /// One for each job, and perhaps more.
    samples: Vec<Sample<S>>,
    wave: Wave,
    /// How many there may be now. Few at first, so that a pass that is stopped again and again gets on.
    most: usize,
}

impl<S: Clone> Batch<S> {
    /// An empty one for batches of so many.
    fn new(sampler: &S, most: usize) -> Self {
        Self {
            jobs: Vec::with_capacity(most),
            samples: vec![Sample::new(sampler.clone()); most],
            wave: Wave::default(),
            most: 1,
        }
    }
}

/// What the samples of a pixel are samples of.
trait Subject: Sync {
    /// How many are best taken at once; one where a sample needs to know what the pixel's last one left.
    fn together(&self, pass: &Pass) -> usize;

    /// Takes the samples of all jobs.
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S>, tracer: &mut T);
}

/// Radiance as the camera sees it.
struct View<'i, I>(&'i I);

impl<I: Integrator> Subject for View<'_, I> {
    /// The paths of a wave, or as many as send the shadow rays of one.
    fn together(&self, pass: &Pass) -> usize {
        match (I::IN_WAVES, pass.film.options().gathering) {
            (true, _) => (WAVE / pass.desc.shadow_rays.max(1) as usize).max(1),
            (false, true) => 1,
            (false, false) => IN_A_ROW,
        }
    }

    #[inline(always)]
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S>, tracer: &mut T) {
        let Batch { jobs, samples, wave, .. } = batch;
        let samples = &mut samples[..jobs.len()];
        for (job, sample) in jobs.iter().zip(samples.iter_mut()) {
            let [x, y] = job.pixel;
            sample.ray = pass.camera.ray(x as f32 + 0.5 + job.offset[0], y as f32 + 0.5 + job.offset[1]);
        }
        if I::IN_WAVES {
            self.0.radiance_of_many(&pass.scene, samples, wave, tracer);
        } else {
            for (job, Sample { ray, sampler, radiance, first }) in jobs.iter_mut().zip(samples) {
                *first = None;
                let first = &mut |hit| *first = Some(hit);
                let gathering = job.gathering.as_mut();
                *radiance = self.0.radiance_of_pixel(&pass.scene, *ray, sampler, tracer, first, gathering);
            }
        }
    }
}

/// Irradiance of sites, numbered as the film's pixels are.
impl Subject for Irradiance {
    fn together(&self, _pass: &Pass) -> usize {
        IN_A_ROW
    }

    #[inline(always)]
    fn take<S: Sampler, T: Tracer>(&self, pass: &Pass, batch: &mut Batch<S>, tracer: &mut T) {
        for (job, sample) in batch.jobs.iter().zip(&mut batch.samples) {
            let [x, y] = job.pixel;
            let site = (y * pass.film.options().resolution[0] + x) as usize;
            let place = job.offset.map(|offset| offset + 0.5);
            sample.radiance = self.estimate(&pass.scene, site, place, &mut sample.sampler, tracer);
        }
    }
}

impl Work for Pass {
    /// Chooses integrator and sampler once; from here on nothing is dispatched.
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        let shadow_rays = self.desc.shadow_rays;
        let max_depth = self.desc.max_depth;
        match &self.method {
            Method::Path => self.with_subject(&View(&Path { max_depth, shadow_rays }), pause),
            Method::Whitted => self.with_subject(&View(&Whitted { max_depth, shadow_rays }), pause),
            Method::Direct => self.with_subject(&View(&Direct { shadow_rays }), pause),
            Method::Gather(gather) => self.with_subject(&View(&**gather), pause),
            Method::Radiosity(picture) => self.with_subject(&View(picture), pause),
            Method::Irradiance(irradiance) => self.with_subject(irradiance, pause),
        }
    }

    fn is_done(&self) -> bool {
        self.is_complete() || self.is_stopped()
    }

    fn abandon(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn shares(&self) -> usize {
        self.film.tile_count()
    }
}

impl Pass {
    /// A pass of `render` up to so many samples of each pixel, cut short at `deadline`.
    pub(super) fn new(render: &Render, samples: u32, deadline: Option<Instant>) -> Self {
        Self {
            goals: None,
            scene: render.scene.clone(),
            camera: render.camera,
            filter: render.filter.clone(),
            desc: Arc::clone(&render.desc),
            method: render.method.clone(),
            samples,
            film: Arc::clone(&render.film),
            deadline,
            cancel: render.settings.cancel.clone(),
            stop: AtomicBool::new(false),
            rays: AtomicU64::new(0),
            non_finite: Mutex::default(),
            next: AtomicUsize::new(0),
            tiles_done: AtomicUsize::new(0),
            again: None,
        }
    }

    /// Whether every pixel has its samples.
    pub(super) fn is_complete(&self) -> bool {
        self.tiles_done.load(Ordering::Acquire) == self.film.tile_count()
    }

    /// Share of the tiles that are done.
    pub(super) fn share(&self) -> f64 {
        self.tiles_done.load(Ordering::Relaxed) as f64 / self.film.tile_count().max(1) as f64
    }

    #[inline]
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }

    /// Takes one sample once more, its first rays only, instead of what a pass takes.
    ///
    /// A pass does it, since one more place that light transport is called from would be one more copy of it, and neither
    /// would be inlined as well.
    pub(super) fn replay(render: &Render, pixel: [u32; 2], sample: u32, limit: u64) -> Replayed {
        let columns = render.film.options().resolution[0].div_ceil(TILE);
        let tile = pixel[1] / TILE * columns + pixel[0] / TILE;
        let pass = Self {
            again: Some(Again { pixel, sample, limit, replayed: Mutex::default() }),
            next: AtomicUsize::new(tile as usize),
            cancel: Cancel::new(),
            ..Self::new(render, 0, None)
        };
        pass.take(&mut || false);
        pass.again.and_then(|again| again.replayed.into_inner().ok()).unwrap_or_default()
    }

    fn with_subject<I: Subject>(&self, subject: &I, pause: &mut dyn FnMut() -> bool) -> bool {
        let seed = self.desc.seed;
        let pattern = match self.desc.sampler {
            SamplerDesc::Sobol => {
                let sampler = SobolSampler::new(seed, self.film.options().share).in_turn(REPLICATES as u32);
                return self.all_tiles(subject, &sampler, pause);
            }
            SamplerDesc::Random => Pattern::Random,
            SamplerDesc::Jittered => Pattern::Jittered,
            SamplerDesc::Grid => Pattern::Grid,
            SamplerDesc::Gaussian => Pattern::Gaussian,
        };
        self.all_tiles(subject, &PatternSampler::new(pattern, seed, self.desc.samples), pause)
    }

    /// Takes tiles until there are none; false if it paused before that.
    fn all_tiles<I: Subject, S: Sampler + Clone>(
        &self,
        subject: &I,
        sampler: &S,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        let most = subject.together(self);
        let mut batch = Batch::new(sampler, most);
        loop {
            if self.is_stopped() {
                return true;
            }
            if pause() {
                return false;
            }
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            if number >= self.film.tile_count() {
                return true;
            }
            let mut tracer = PassTracer::new(self);
            let is_complete = self.tile(subject, &mut batch, number, &mut tracer, pause);
            self.rays.fetch_add(tracer.rays, Ordering::Relaxed);
            if is_complete {
                self.tiles_done.fetch_add(1, Ordering::Release);
            }
            if self.again.is_some() {
                return true;
            }
        }
    }

    /// All samples of one tile, unless the pass is stopped; whether they are complete. Allocates nothing but the tile, and in a
    /// worker's first batches what these need.
    fn tile<I: Subject, S: Sampler>(
        &self,
        subject: &I,
        batch: &mut Batch<S>,
        number: usize,
        tracer: &mut PassTracer,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        let [width, height] = self.film.options().resolution;
        let [left, top] = self.film.tile_origin(number);
        let (rows, columns) = match &self.again {
            None => (top..(top + TILE).min(height), left..(left + TILE).min(width)),
            Some(Again { pixel: [x, y], .. }) => (*y..y + 1, *x..x + 1),
        };
        let index = |[x, y]: [u32; 2]| ((y - top) * TILE + (x - left)) as usize;
        let counts = self.film.tile(number).counts();
        let samples = |pixel: [u32; 2]| {
            let samples = match (&self.again, &self.goals) {
                (None, None) => counts[index(pixel)]..self.samples,
                (None, Some(goals)) => counts[index(pixel)]..goals[(pixel[1] * width + pixel[0]) as usize],
                (Some(again), _) => again.sample..again.sample.saturating_add(1),
            };
            samples.map(move |sample| (pixel, sample))
        };
        let mut wanted = rows.flat_map(|y| columns.clone().map(move |x| [x, y])).flat_map(samples);
        loop {
            if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                self.abandon();
            }
            // A tile is finished before its worker gives way; but who works for itself may want to look up.
            pause();
            batch.jobs.clear();
            for (pixel, sample) in wanted.by_ref().take(batch.most) {
                let sampler = &mut batch.samples[batch.jobs.len()].sampler;
                sampler.start(pixel[1] * width + pixel[0], sample);
                let (offset, weight) = self.filter.sample(sampler.pixel_2d());
                let index = index(pixel);
                let remembers = self.film.options().gathering;
                let gathering = if remembers { self.film.tile(number).gathering.get(index).copied() } else { None };
                batch.jobs.push(Job { pixel, index, sample, offset, weight, gathering });
            }
            if batch.jobs.is_empty() {
                return true;
            }
            if self.is_stopped() {
                return false;
            }
            subject.take(self, batch, tracer);
            // Pixels go on from where they are, so stopping between any two batches is safe; one during which it was stopped may
            // have missed something, and is taken again.
            if self.is_stopped() {
                return false;
            }
            self.keep(batch, number, tracer.rays);
            batch.most = (2 * batch.most).min(batch.samples.len());
        }
    }

    /// Adds samples to their pixels.
    fn keep<S>(&self, batch: &Batch<S>, tile: usize, rays: u64) {
        let share = self.film.options().share;
        let mut tile = self.film.tile(tile);
        let tile = &mut *tile;
        for (job, Sample { radiance, first, .. }) in batch.jobs.iter().zip(&batch.samples) {
            if !radiance.is_finite() || self.again.is_some() {
                self.note(job.pixel, job.sample, *radiance, rays);
            }
            if self.again.is_some() {
                continue;
            }
            tile.pixels[job.index].add(*radiance, job.weight, share);
            if let (Some(kept), Some(gathering)) = (tile.gathering.get_mut(job.index), job.gathering) {
                *kept = gathering;
            }
            if let (Some(auxiliary), Some(hit)) = (tile.auxiliary.get_mut(job.index), first) {
                auxiliary.add(hit.albedo, hit.normal, self.camera.depth(hit.p));
            }
        }
    }

    /// Notes a sample that is not finite, or what was asked for.
    #[cold]
    #[inline(never)]
    fn note(&self, pixel: [u32; 2], sample: u32, radiance: Rgb, rays: u64) {
        match &self.again {
            None => self.non_finite.lock().unwrap_or_else(PoisonError::into_inner).add(pixel, sample),
            Some(again) => {
                let mut replayed = again.replayed.lock().unwrap_or_else(PoisonError::into_inner);
                (replayed.radiance, replayed.rays) = (radiance, rays);
            }
        }
    }
}
