//! One pass: some samples for every pixel, tile by tile, in parallel.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::method::Method;
use super::replay::{Replay, Replayed, Suspects};
use super::workers::SharedWork;
use crate::Cancel;
use crate::camera::Camera;
use crate::desc::{RenderDesc, SamplerDesc};
use crate::film::{Film, PixelPhotonState, PixelSample, REPLICATES, TILE};
use crate::integrator::{Context, Direct, Irradiance, Path, Sample, Tracer, Transport, Wave, Whitted};
use crate::math::Ray;
use crate::sampling::{Filter, Pattern, PatternSampler, Sampler, SobolSampler};
use crate::scene::{Hit, Scene};
use crate::spectrum::Rgb;

/// Samples that are taken together: enough to fill packets when most paths have ended, few enough to stay in the nearest caches.
const WAVE: usize = 128;

/// Samples of those that are taken one after another between two looks at the clock and two additions to the film.
const IN_A_ROW: usize = 16;

/// What all passes of a render are made of.
#[derive(Clone)]
pub(super) struct PassInput {
    pub scene: Scene,
    pub camera: Camera,
    pub filter: Filter,
    pub desc: Arc<RenderDesc>,
    pub method: Method,
    pub film: Arc<Film>,
}

/// Everything the workers of a pass share.
pub(super) struct Pass {
    input: PassInput,
    /// Samples that each pixel is to have afterwards. It goes on from those it has, so that a render that was stopped in
    /// the middle of a pass can be resumed.
    samples: u32,
    /// The same of each pixel, row by row, where they differ.
    pub goals: Option<Vec<u32>>,
    deadline: Option<Instant>,
    cancel: Cancel,
    pub stop: AtomicBool,
    pub rays: AtomicU64,
    /// Samples that were NaN or infinite.
    pub non_finite: Mutex<Suspects>,
    /// The tile that is taken next.
    next: AtomicUsize,
    tiles_done: AtomicUsize,
    /// The one sample that is taken instead, where the pass is a replay.
    replay: Option<Replay>,
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
        let limit = pass.replay.as_ref().map_or(u64::MAX, |replay| replay.limit);
        Self { scene: &pass.input.scene, pass, rays: 0, limit }
    }
}

/// The hit of a ray of a replay, up to the last ray that is answered; none of a pass that is stopped.
///
/// Takes copies: if it was given the tracer or the ray where they are, both would be kept in memory for its sake, which
/// costs 5 % of all rays a second.
#[cold]
#[inline(never)]
fn intersect_at_end(pass: &Pass, ray: Ray, number: u64) -> Option<Hit> {
    let replay = pass.replay.as_ref().filter(|_| !pass.is_stopped())?;
    replay.intersect(&pass.input.scene, ray, number)
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
struct SampleJob {
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
    jobs: Vec<SampleJob>,
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

impl<I: Transport<Rgb>> Subject for View<'_, I> {
    /// The paths of a wave, or as many as send the shadow rays of one.
    fn together(&self, pass: &Pass) -> usize {
        match (I::IN_WAVES, pass.input.film.options().gathering) {
            (true, _) => (WAVE / pass.input.desc.shadow_rays.max(1) as usize).max(1),
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
            sample.ray = pass.input.camera.ray(x as f32 + 0.5 + job.offset[0], y as f32 + 0.5 + job.offset[1]);
        }
        if I::IN_WAVES {
            self.0.li_of_many(&pass.input.scene, samples, wave, tracer);
        } else {
            for (job, Sample { ray, sampler, radiance, first, .. }) in jobs.iter_mut().zip(samples) {
                *first = None;
                let first = &mut |hit| *first = Some(hit);
                let gathering = job.gathering.as_mut();
                let mut context = Context { scene: &pass.input.scene, sampler, tracer, wavelengths: () };
                *radiance = self.0.li_of_pixel(*ray, &mut context, first, gathering);
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
            let site = (y * pass.input.film.options().resolution[0] + x) as usize;
            let place = job.offset.map(|offset| offset + 0.5);
            sample.radiance = self.estimate(&pass.input.scene, site, place, &mut sample.sampler, tracer);
        }
    }
}

impl SharedWork for Pass {
    /// Chooses integrator and sampler once; from here on nothing is dispatched.
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        let shadow_rays = self.input.desc.shadow_rays;
        let max_depth = self.input.desc.max_depth;
        match &self.input.method {
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
        self.input.film.tile_count()
    }
}

impl Pass {
    /// A pass up to so many samples of each pixel, cut short at `deadline` and by `cancel`.
    pub(super) fn new(input: PassInput, samples: u32, deadline: Option<Instant>, cancel: Cancel) -> Self {
        Self {
            input,
            samples,
            goals: None,
            deadline,
            cancel,
            stop: AtomicBool::new(false),
            rays: AtomicU64::new(0),
            non_finite: Mutex::default(),
            next: AtomicUsize::new(0),
            tiles_done: AtomicUsize::new(0),
            replay: None,
        }
    }

    /// Whether every pixel has its samples.
    pub(super) fn is_complete(&self) -> bool {
        self.tiles_done.load(Ordering::Acquire) == self.input.film.tile_count()
    }

    /// Share of the tiles that are done.
    pub(super) fn share(&self) -> f64 {
        self.tiles_done.load(Ordering::Relaxed) as f64 / self.input.film.tile_count().max(1) as f64
    }

    #[inline]
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }

    /// Takes one sample once more, up to its ray number `limit`.
    ///
    /// A pass does it, since one more place that light transport is called from would be one more copy of it, and neither
    /// would be inlined as well.
    pub(super) fn replay(input: PassInput, pixel: [u32; 2], sample: u32, limit: u64) -> Replayed {
        let columns = input.film.options().resolution[0].div_ceil(TILE);
        let tile = pixel[1] / TILE * columns + pixel[0] / TILE;
        let pass = Self {
            replay: Some(Replay::new(pixel, sample, limit)),
            next: AtomicUsize::new(tile as usize),
            ..Self::new(input, 0, None, Cancel::new())
        };
        pass.take(&mut || false);
        pass.replay.map(Replay::into_replayed).unwrap_or_default()
    }

    fn with_subject<I: Subject>(&self, subject: &I, pause: &mut dyn FnMut() -> bool) -> bool {
        let seed = self.input.desc.seed;
        let pattern = match self.input.desc.sampler {
            SamplerDesc::Sobol => {
                let sampler = SobolSampler::new(seed, self.input.film.options().share).in_turn(REPLICATES as u32);
                return self.all_tiles(subject, &sampler, pause);
            }
            SamplerDesc::Random => Pattern::Random,
            SamplerDesc::Jittered => Pattern::Jittered,
            SamplerDesc::Grid => Pattern::Grid,
            SamplerDesc::Gaussian => Pattern::Gaussian,
        };
        self.all_tiles(subject, &PatternSampler::new(pattern, seed, self.input.desc.samples), pause)
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
            if number >= self.input.film.tile_count() {
                return true;
            }
            let mut tracer = PassTracer::new(self);
            let is_complete = self.tile(subject, &mut batch, number, &mut tracer, pause);
            self.rays.fetch_add(tracer.rays, Ordering::Relaxed);
            if is_complete {
                self.tiles_done.fetch_add(1, Ordering::Release);
            }
            if self.replay.is_some() {
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
        let [width, height] = self.input.film.options().resolution;
        let [left, top] = self.input.film.tile_origin(number);
        let (rows, columns) = match &self.replay {
            None => (top..(top + TILE).min(height), left..(left + TILE).min(width)),
            Some(Replay { pixel: [x, y], .. }) => (*y..y + 1, *x..x + 1),
        };
        let index = |[x, y]: [u32; 2]| ((y - top) * TILE + (x - left)) as usize;
        let counts = self.input.film.tile(number).counts();
        let samples = |pixel: [u32; 2]| {
            let samples = match (&self.replay, &self.goals) {
                (None, None) => counts[index(pixel)]..self.samples,
                (None, Some(goals)) => counts[index(pixel)]..goals[(pixel[1] * width + pixel[0]) as usize],
                (Some(replay), _) => replay.sample..replay.sample.saturating_add(1),
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
                let (offset, weight) = self.input.filter.sample(sampler.pixel_2d());
                let index = index(pixel);
                let remembers = self.input.film.options().gathering;
                let gathering =
                    if remembers { self.input.film.tile(number).gathering.get(index).copied() } else { None };
                batch.jobs.push(SampleJob { pixel, index, sample, offset, weight, gathering });
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
            self.add(batch, number, tracer.rays);
            batch.most = (2 * batch.most).min(batch.samples.len());
        }
    }

    /// Adds samples to their pixels, or notes what a replay asked for.
    fn add<S>(&self, batch: &Batch<S>, tile: usize, rays: u64) {
        let options = self.input.film.options();
        let mut tile = self.input.film.tile(tile);
        for (job, Sample { radiance, first, .. }) in batch.jobs.iter().zip(&batch.samples) {
            if let Some(replay) = &self.replay {
                replay.note(*radiance, rays);
                continue;
            }
            if !radiance.is_finite() {
                self.note(job.pixel, job.sample);
            }
            let first = first.as_ref().filter(|_| options.auxiliary);
            let first = first.map(|hit| (hit.albedo, hit.normal, self.input.camera.depth(hit.p)));
            let (radiance, weight, gathering) = (*radiance, job.weight, job.gathering);
            tile.add_sample(job.index, PixelSample { radiance, weight, gathering, first }, options.share);
        }
    }

    /// Notes a sample that is not finite.
    #[cold]
    #[inline(never)]
    fn note(&self, pixel: [u32; 2], sample: u32) {
        self.non_finite.lock().unwrap_or_else(PoisonError::into_inner).add(pixel, sample);
    }
}
