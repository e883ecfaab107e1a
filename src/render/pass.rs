//! A pass: some samples of every pixel, tile by tile, on all threads.

mod measurement;

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use measurement::{Batch, CameraRadiance, Measurement, PassTracer, SampleJob};

use super::method::Method;
use super::order::{Order, TilePlace, Wanted};
use super::pixel_sampler;
use super::replay::{NonFiniteSamples, Replay, Replayed};
use super::share::Tiles;
use super::workers::SharedWork;
use crate::Cancel;
use crate::camera::{Camera, MovingCamera};
use crate::control::PROGRESS_INTERVAL;
use crate::desc::RenderDesc;
use crate::film::{Film, PixelSample, TILE};
use crate::integrator::light_tracing::{LightPaths, LightPictures};
use crate::integrator::{Direct, LightParts, LitPath, Path, Sample, Transport, Whitted};
use crate::math::DMat3;
use crate::sampling::{AnySampler, Filter, Sampler};
use crate::scene::Scene;
use crate::spectrum::{Rgb, SampledSpectrum, Sensor, Spectrum};

/// The input that is the same for all passes of a render, but for the method.
#[derive(Clone)]
pub(super) struct PassInput {
    pub scene: Scene,
    pub camera: Camera,
    /// Whether the picture is a circle that the camera sees.
    pub has_rim: bool,
    /// What the film's channels are, where paths carry wavelengths.
    pub sensor: Sensor,
    /// What colours become by the white balance, where there is one.
    pub white_balance: Option<DMat3>,
    /// The camera at all times, where it moves.
    pub moving_camera: Option<Arc<MovingCamera>>,
    pub filter: Filter,
    pub desc: Arc<RenderDesc>,
    pub method: Method,
    pub film: Arc<Film>,
    /// Light samples at hits that the camera sees, where paths are traced.
    pub first_shadow_rays: u32,
    /// The light paths of the render, and what they bring to the samples of the pass.
    pub light: Option<Light>,
}

/// Light paths, with the pictures that they make of some samples.
#[derive(Clone)]
pub(super) struct Light {
    pub paths: LightPaths,
    pub pictures: LightPictures,
}

/// A pass, as its workers share it.
pub(super) struct Pass {
    input: PassInput,
    /// Number of samples that each pixel has after the pass. Each pixel continues from the samples that it has, so that a
    /// render that was stopped in the middle of a pass can be resumed.
    samples: u32,
    /// Number of samples that each pixel has after the pass, row by row, where the numbers differ.
    pub goals: Option<Vec<u32>>,
    deadline: Option<Instant>,
    cancel: Cancel,
    pub stop: AtomicBool,
    pub rays: AtomicU64,
    /// The samples that were NaN or infinite.
    pub non_finite: Mutex<NonFiniteSamples>,
    /// The tiles that are taken.
    pub tiles: Tiles,
    /// Place among these of the tile that a worker takes next.
    next: AtomicUsize,
    tiles_done: AtomicUsize,
    /// Number of tiles that other processes have, and of those that they had and have not brought.
    pub out: AtomicUsize,
    pub abandoned: AtomicUsize,
    /// Whether other processes take a part in it.
    pub is_shared: bool,
    /// The only sample of the pass, where the pass is a replay.
    replay: Option<Replay>,
}

impl SharedWork for Pass {
    /// Chooses the integrator once for all tiles. The code below is compiled for each pair of integrator and sampler.
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool {
        let RenderDesc { max_depth, shadow_rays, .. } = *self.input.desc;
        let first_shadow_rays = self.input.first_shadow_rays;
        let path = Path { first_shadow_rays, ..Path::new(max_depth, shadow_rays) };
        let is_spectral = self.input.desc.spectral;
        if self.input.film.options().light_parts {
            let is_direct = matches!(self.input.method, Method::Direct);
            let paths = if is_direct { Direct { shadow_rays }.into() } else { LightParts::from(path) };
            return self.in_parts(&paths, pause);
        }
        match &self.input.method {
            Method::Path if is_spectral => self.in_wavelengths(&path, pause),
            Method::Reuse(reuse) => {
                let reuse = reuse.clone().with_first_shadow_rays(first_shadow_rays);
                self.in_colours(&reuse.beside(self.light_paths()), pause)
            }
            Method::Path => self.in_colours(&LitPath { path, light_paths: self.light_paths() }, pause),
            Method::Whitted if is_spectral => self.in_wavelengths(&Whitted { max_depth, shadow_rays }, pause),
            Method::Whitted => self.in_colours(&Whitted { max_depth, shadow_rays }, pause),
            Method::Direct if is_spectral => self.in_wavelengths(&Direct { shadow_rays }, pause),
            Method::Direct => self.in_colours(&Direct { shadow_rays }, pause),
            Method::Gather(gather) => self.in_colours(&**gather, pause),
            Method::SpectralGather(gather) => self.in_wavelengths(&**gather, pause),
            Method::Radiosity(picture) => self.in_colours(picture, pause),
            Method::Irradiance(irradiance) => self.with_measurement(irradiance, pause),
            Method::Probes(probes) => self.with_measurement(probes, pause),
        }
    }

    fn is_done(&self) -> bool {
        let ended = self.tiles_done.load(Ordering::Acquire) + self.abandoned.load(Ordering::Acquire);
        self.out.load(Ordering::Acquire) == 0 && (ended == self.tiles.count() || self.is_stopped())
    }

    fn poll_interval(&self) -> Duration {
        if self.is_shared { Duration::from_millis(1) } else { PROGRESS_INTERVAL }
    }

    fn abandon(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn shares(&self) -> usize {
        self.tiles.count()
    }
}

impl Pass {
    /// Makes a pass after which each pixel has `samples` samples. The pass ends early at `deadline` and by `cancel`.
    pub(super) fn new(input: PassInput, samples: u32, deadline: Option<Instant>, cancel: Cancel) -> Self {
        Self {
            tiles: Tiles::of(&input.film, None),
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
            out: AtomicUsize::new(0),
            abandoned: AtomicUsize::new(0),
            is_shared: false,
            replay: None,
        }
    }

    fn light_paths(&self) -> Option<LightPaths> {
        self.input.light.as_ref().map(|light| light.paths.clone())
    }

    /// Whether every pixel has all samples of the pass.
    pub(super) fn is_complete(&self) -> bool {
        self.tiles_done.load(Ordering::Acquire) == self.tiles.count()
    }

    /// Fraction of the tiles that are done.
    pub(super) fn fraction(&self) -> f64 {
        self.tiles_done.load(Ordering::Relaxed) as f64 / self.tiles.count().max(1) as f64
    }

    /// The film that is filled.
    pub(super) fn film(&self) -> &Arc<Film> {
        &self.input.film
    }

    /// The next tile, which nobody has taken before.
    #[inline]
    pub(super) fn claim(&self) -> Option<usize> {
        self.tiles.get(self.next.fetch_add(1, Ordering::Relaxed))
    }

    /// Number of tiles that nobody has taken.
    pub(super) fn left(&self) -> usize {
        self.tiles.count().saturating_sub(self.next.load(Ordering::Relaxed))
    }

    /// Counts what another process has brought: complete tiles, rays, and samples that were not finite (index, row, column).
    pub(super) fn count_done(&self, tiles: usize, rays: u64, first: &[(u32, u32, u32)]) {
        self.tiles_done.fetch_add(tiles, Ordering::Release);
        self.rays.fetch_add(rays, Ordering::Relaxed);
        first.iter().for_each(|&(sample, y, x)| self.record_non_finite([x, y], sample));
    }

    /// Index, row and column of the first samples that were not finite.
    pub(super) fn first_non_finite(&self) -> Vec<(u32, u32, u32)> {
        self.non_finite.lock().unwrap_or_else(PoisonError::into_inner).first()
    }

    /// Stops the pass at its deadline.
    pub(super) fn check_time(&self) {
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.abandon();
        }
    }

    #[inline]
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.cancel.is_cancelled()
    }

    /// Takes all samples on the calling thread. Returns the number of rays.
    pub(super) fn into_rays(self) -> u64 {
        self.take(&mut || false);
        self.rays.into_inner()
    }

    /// Takes one sample once more, up to its ray number `limit`.
    ///
    /// A replay is a pass, because a second call of the light transport code would make a second copy of that code, and the
    /// compiler would inline both copies less.
    pub(super) fn replay(input: PassInput, pixel: [u32; 2], sample: u32, limit: u64) -> Replayed {
        let columns = input.film.options().resolution[0].div_ceil(TILE);
        let [left, top] = input.film.origin();
        let pixel = [pixel[0] - left, pixel[1] - top];
        let tile = pixel[1] / TILE * columns + pixel[0] / TILE;
        let pass = Self {
            replay: Some(Replay::new(pixel, sample, limit)),
            tiles: Tiles::single(&input.film, tile as usize),
            ..Self::new(input, 0, None, Cancel::new())
        };
        pass.take(&mut || false);
        pass.replay.map(Replay::into_replayed).unwrap_or_default()
    }

    /// Takes the samples of an integrator whose paths carry colours.
    #[inline(always)]
    fn in_colours<I: Transport<Rgb>>(&self, integrator: &I, pause: &mut dyn FnMut() -> bool) -> bool {
        self.with_measurement(&CameraRadiance::<_, Rgb>::new(integrator), pause)
    }

    /// Takes the samples of paths that keep parts of the light apart.
    #[cold]
    #[inline(never)]
    fn in_parts(&self, paths: &LightParts, pause: &mut dyn FnMut() -> bool) -> bool {
        let sampler = self.sampler();
        if self.input.desc.spectral {
            self.all_tiles(&CameraRadiance::<_, SampledSpectrum>::new(paths), &sampler, pause)
        } else {
            self.all_tiles(&CameraRadiance::<_, Rgb>::new(paths), &sampler, pause)
        }
    }

    /// Takes the samples of an integrator whose paths carry wavelengths.
    ///
    /// The code is compiled for one type of sampler, because that for wavelengths is as large as that for colours.
    #[inline(never)]
    fn in_wavelengths<I: Transport<SampledSpectrum>>(&self, integrator: &I, pause: &mut dyn FnMut() -> bool) -> bool {
        self.all_tiles(&CameraRadiance::<_, SampledSpectrum>::new(integrator), &self.sampler(), pause)
    }

    fn with_measurement<M: Measurement>(&self, measurement: &M, pause: &mut dyn FnMut() -> bool) -> bool {
        match self.sampler() {
            AnySampler::Sobol(sampler) => self.all_tiles(measurement, &sampler, pause),
            AnySampler::Pattern(sampler) => self.all_tiles(measurement, &sampler, pause),
        }
    }

    fn sampler(&self) -> AnySampler {
        pixel_sampler(&self.input.desc, self.input.film.options().share)
    }

    /// Takes tiles until none is left, or until `pause` returns `true`. Returns whether no tile is left.
    fn all_tiles<M: Measurement, S: Sampler + Clone>(
        &self,
        measurement: &M,
        sampler: &S,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        let mut batch = Batch::new(sampler, measurement.batch_size(self), measurement.group_size());
        loop {
            if self.is_stopped() {
                return true;
            }
            if pause() {
                return false;
            }
            let Some(number) = self.claim() else { return true };
            let mut tracer = PassTracer::new(self);
            let is_complete = self.tile(measurement, &mut batch, number, &mut tracer, pause);
            self.rays.fetch_add(tracer.rays, Ordering::Relaxed);
            if is_complete {
                self.tiles_done.fetch_add(1, Ordering::Release);
            }
            if self.replay.is_some() {
                return true;
            }
        }
    }

    /// Takes all samples of one tile, unless the pass is stopped, and returns whether the tile is complete. It allocates
    /// memory only for the tile, and for the first batches of a worker.
    fn tile<M: Measurement, S: Sampler>(
        &self,
        measurement: &M,
        batch: &mut Batch<S, M>,
        number: usize,
        tracer: &mut PassTracer,
        pause: &mut dyn FnMut() -> bool,
    ) -> bool {
        let [width, height] = self.input.film.options().resolution;
        let [left, top] = self.input.film.tile_origin(number);
        // Samples depend on where a pixel is in the picture, so that a part of it shows what the whole does.
        let (origin, picture_width) = (self.input.film.origin(), self.input.film.picture_width());
        let place = TilePlace {
            origin: [left + origin[0], top + origin[1]],
            size: [width - left, height - top].map(|size| size.min(TILE)),
            picture: self.input.desc.resolution,
        };
        let counts = self.input.film.tile(number).counts();
        let wants = |index: usize| match (&self.replay, &self.goals) {
            (None, None) => counts[index]..self.samples,
            (None, Some(goals)) => {
                let [x, y] = [index as u32 % TILE, index as u32 / TILE];
                counts[index]..goals[((top + y) * width + left + x) as usize]
            }
            (Some(replay), _) if replay.is_of(index) => replay.sample..replay.sample.saturating_add(1),
            _ => 0..0,
        };
        let mut order = match batch.group {
            1 => Order::of_pixels(place),
            _ => Order::of_groups(place, self.input.desc.seed),
        };
        loop {
            self.check_time();
            // The calling thread reports progress in `pause`. A worker completes its tile even where `pause` returns true.
            pause();
            batch.jobs.clear();
            batch.ends.clear();
            let remembers = self.input.film.options().gathering;
            let Batch { jobs, ends, samples, limit, group, .. } = &mut *batch;
            while jobs.len() + *group <= *limit {
                let has_group = order.next_group(wants, |Wanted { pixel, index, sample }| {
                    let sampler = &mut samples[jobs.len()].sampler;
                    sampler.start(pixel[1] * picture_width + pixel[0], sample);
                    let (offset, weight) = self.input.filter.sample(sampler.pixel_2d());
                    let gathering = match index {
                        Some(index) if remembers => self.input.film.tile(number).gathering.get(index).copied(),
                        _ => None,
                    };
                    jobs.push(SampleJob { pixel, index, sample, offset, weight, time: 0.0, gathering });
                });
                if !has_group {
                    break;
                }
                ends.push(jobs.len());
            }
            if batch.jobs.is_empty() {
                return true;
            }
            if self.is_stopped() {
                return false;
            }
            measurement.take(self, batch, tracer);
            // Rays of a batch during which the pass was stopped may have missed surfaces. Such a batch is not added to the film.
            // The next pass takes it again, since each pixel continues from the samples that it has.
            if self.is_stopped() {
                return false;
            }
            self.add(batch, number, tracer.rays);
            batch.limit = (2 * batch.limit).min(batch.samples.len());
        }
    }

    /// Adds samples to their pixels, or records the result of a replay.
    fn add<S, M: Measurement>(&self, batch: &Batch<S, M>, tile: usize, rays: u64) {
        let options = self.input.film.options();
        let origin = self.input.film.origin();
        let mut tile = self.input.film.tile(tile);
        for (job, Sample { radiance, wavelengths, first, parts, .. }) in batch.jobs.iter().zip(&batch.samples) {
            let Some(index) = job.index else { continue };
            let is_blind = self.input.has_rim && !self.sees(job);
            let mut radiance = if is_blind { Rgb::ZERO } else { radiance.to_film(wavelengths, self.input.sensor) };
            if let Some(light) = &self.input.light {
                let [x, y] = [0, 1].map(|axis| job.pixel[axis] - origin[axis]);
                radiance += light.pictures.light(job.sample, (y * options.resolution[0] + x) as usize);
            }
            radiance = self.white_balanced(radiance);
            let parts = if options.light_parts && !is_blind {
                parts.map(|part| self.white_balanced(part.to_film(wavelengths, self.input.sensor)))
            } else {
                [Rgb::ZERO; 2]
            };
            if let Some(replay) = &self.replay {
                if replay.is_of(index) {
                    replay.record(radiance, rays);
                }
                continue;
            }
            if !radiance.is_finite() {
                self.record_non_finite(job.pixel, job.sample);
            }
            let first = first.as_ref().filter(|_| options.auxiliary && !is_blind);
            let depth = |p| match &self.input.moving_camera {
                None => self.input.camera.depth(p),
                Some(moving) => moving.at(job.time).depth(p),
            };
            let first = first.map(|hit| (hit.albedo, hit.normal, depth(hit.p)));
            let (weight, gathering) = (job.weight, job.gathering);
            tile.add_sample(index, PixelSample { radiance, weight, gathering, first, parts }, options.share);
        }
    }

    #[inline]
    fn white_balanced(&self, radiance: Rgb) -> Rgb {
        self.input.white_balance.as_ref().map_or(radiance, |white| Rgb::from_f64(*white * radiance.to_f64()))
    }

    /// Whether the camera sees anything at a sample's place of the film.
    #[cold]
    #[inline(never)]
    fn sees(&self, job: &SampleJob) -> bool {
        let [x, y] = job.place();
        self.input.camera.sees(x, y)
    }

    /// Records a sample that is NaN or infinite.
    #[cold]
    #[inline(never)]
    fn record_non_finite(&self, pixel: [u32; 2], sample: u32) {
        self.non_finite.lock().unwrap_or_else(PoisonError::into_inner).add(pixel, sample);
    }
}
