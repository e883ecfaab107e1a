//! Rendering: passes, tiles, threads, progress, cancelling.
//!
//! ```no_run
//! use std::ops::ControlFlow;
//! use etendue::render::{Render, RenderSettings};
//! use etendue::scene::{BuildOptions, Scene};
//!
//! let desc = etendue::desc::load("scenes/room.json".as_ref(), None)?;
//! let scene = Scene::build(&desc, &BuildOptions::default())?;
//! let mut render = Render::new(&scene, RenderSettings { desc: desc.render, ..RenderSettings::default() })?;
//! let summary = render.run(&mut |_| ControlFlow::Continue(()))?;
//! println!("{} samples per pixel in {:?}", summary.samples, summary.elapsed);
//! # Ok::<(), etendue::Error>(())
//! ```

mod pass;
mod schedule;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use crate::camera::Camera;
use crate::desc::{FilterDesc, MAX_PIXELS, MAX_SHADOW_RAYS, RenderDesc, SamplerDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::{Film, FilmOptions, Image};
use crate::sampling::Filter;
use crate::scene::Scene;
use schedule::Schedule;

pub use schedule::MOST_SAMPLES;

/// How often the caller hears of progress within a pass.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Most worker threads of a render.
pub const MAX_THREADS: usize = 1024;

/// What to render, and with how much effort.
#[derive(Clone, Debug, Default)]
pub struct RenderSettings {
    /// Resolution, samples, sampler, filter, integrator, seed.
    pub desc: RenderDesc,
    /// Worker threads, of a pool of its own; 0 means one per core. The image does not depend on it.
    pub threads: usize,
    /// Ends after this time, when the pixels that are being worked on are done, even if samples are left. For time alone
    /// to count, ask for [`MOST_SAMPLES`].
    pub time_limit: Option<Duration>,
    /// Keeps albedo, normal and depth of the first hit.
    pub auxiliary: bool,
}

/// How far a render has come.
pub struct Progress<'a> {
    /// Share of the work or of the time limit that is done, in [0, 1]; only grows.
    pub fraction: f64,
    /// Samples per pixel that are complete.
    pub samples_done: u32,
    /// Samples per pixel to reach.
    pub samples_total: u32,
    /// Rays so far.
    pub rays: u64,
    /// Time since [`Render::run`] began.
    pub elapsed: Duration,
    /// The image as it is after a pass; `None` in the middle of one.
    pub image: Option<&'a dyn Fn() -> Image>,
}

/// What a render came to.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Time that [`Render::run`] took.
    pub elapsed: Duration,
    /// Complete samples per pixel.
    pub samples: u32,
    /// Rays traced, closest-hit and shadow rays together.
    pub rays: u64,
    /// Estimated relative error (see [`Film::relative_error`]), where there are enough samples to tell.
    pub relative_error: Option<f64>,
    /// Whether the caller stopped it before the end.
    pub stopped: bool,
    /// Samples that were NaN or infinite and were left out.
    pub non_finite: u64,
    /// What a user should know: a bias that was asked for, samples left out.
    pub notes: Vec<String>,
}

/// A render of a scene: its film, and the threads that fill it.
pub struct Render<'s> {
    scene: &'s Scene,
    settings: RenderSettings,
    camera: Camera,
    filter: Filter,
    film: Film,
    pool: rayon::ThreadPool,
    samples: u32,
    rays: u64,
    stopped: bool,
}

impl<'s> Render<'s> {
    /// Prepares a render: checks the settings, allocates the film, starts the threads.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for settings that make no image, `OutOfMemory` for a film that does not fit.
    pub fn new(scene: &'s Scene, settings: RenderSettings) -> Result<Self> {
        let desc = &settings.desc;
        let [width, height] = desc.resolution;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MAX_PIXELS {
            return Err(Error::invalid(
                "render.resolution",
                format!("{width} x {height} pixels; an image has between 1 and {MAX_PIXELS}"),
            ));
        }
        if desc.samples == 0 || desc.max_depth == Some(0) {
            return Err(Error::invalid("render", "samples and maxDepth must be at least 1"));
        }
        if !(1..=MAX_SHADOW_RAYS).contains(&desc.shadow_rays) {
            let message = format!("{} light samples per hit; expected 1 to {MAX_SHADOW_RAYS}", desc.shadow_rays);
            return Err(Error::invalid("render.shadowRays", message));
        }
        if settings.threads > MAX_THREADS {
            let message = format!("{} threads; expected at most {MAX_THREADS}", settings.threads);
            return Err(Error::invalid("threads", message));
        }
        check_filter(&desc.filter)?;
        let camera = Camera::new(scene.camera(), desc.resolution, scene.centre())?;
        // The normally distributed pattern is a pixel filter by itself.
        let filter_desc = if desc.sampler == SamplerDesc::Gaussian { FilterDesc::Box } else { desc.filter };
        let film = Film::new(FilmOptions {
            resolution: desc.resolution,
            auxiliary: settings.auxiliary,
            replicate_size: schedule::replicate_size(&settings),
            weighted: matches!(filter_desc, FilterDesc::Mitchell { .. }),
        })?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(settings.threads)
            .thread_name(|number| format!("etendue-{number}"))
            .build()
            .map_err(|error| Error::new(ErrorKind::Device, "the worker threads could not be started").because(error))?;
        let filter = Filter::new(&filter_desc);
        Ok(Self { scene, settings, camera, filter, film, pool, samples: 0, rays: 0, stopped: false })
    }

    /// Renders until samples, time or the caller's patience are used up.
    ///
    /// `progress` is called on the calling thread, between passes and about ten times a second; `Break` stops the render
    /// after the pixels that are being worked on. What was sampled until then stays in the film, and another call goes on
    /// from there, with the same result as if nothing had happened.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] if a worker or a shape's intersection test panicked.
    pub fn run(&mut self, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Summary> {
        let start = Instant::now();
        self.stopped = false;
        let schedule = Schedule::new(&self.settings);
        while let Some(count) = schedule.next_pass(self.samples, start.elapsed()) {
            let finished = self.pass(count, &schedule, start, progress)?;
            if !finished {
                break;
            }
            self.samples += count;
            let image = || self.film.develop();
            let done = f64::from(self.samples);
            let report = schedule.progress(self.samples, done, self.rays, start.elapsed(), Some(&image));
            if progress(&report).is_break() && !schedule.is_done(self.samples, start.elapsed()) {
                self.stopped = true;
                break;
            }
        }
        // A shape's test that panicked inside Embree's callback counted as a miss there; say so here.
        if let Some(kernel) = self.scene.kernel() {
            kernel.check()?;
        }
        Ok(self.summary(start.elapsed()))
    }

    /// The image as it stands.
    pub fn image(&self) -> Image {
        self.film.develop()
    }

    /// One pass over all tiles; false when it was cut short.
    fn pass(
        &mut self,
        count: u32,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<bool> {
        let stop = AtomicBool::new(false);
        let rays = AtomicU64::new(0);
        let done = AtomicU64::new(0);
        let job = pass::Pass {
            scene: self.scene,
            camera: &self.camera,
            filter: &self.filter,
            desc: &self.settings.desc,
            samples: self.samples + count,
            film: *self.film.options(),
            // One sample everywhere is the least that makes an image.
            deadline: self.settings.time_limit.filter(|_| self.samples > 0).and_then(|limit| start.checked_add(limit)),
            stop: &stop,
            rays: &rays,
            tiles_done: &done,
        };
        let mut tiles = self.film.tiles_mut();
        let tile_count = tiles.len().max(1) as f64;
        let (pool, samples, rays_before) = (&self.pool, self.samples, self.rays);
        let mut stopped = false;
        let outcome = std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            let worker = scope.spawn(move || {
                pool.install(|| job.run(&mut tiles));
                // Nobody listening any more is no fault.
                let _ = sender.send(());
            });
            while let Err(RecvTimeoutError::Timeout) = receiver.recv_timeout(PROGRESS_INTERVAL) {
                let share = done.load(Ordering::Relaxed) as f64 / tile_count * f64::from(count);
                let rays = rays_before + rays.load(Ordering::Relaxed);
                let report = schedule.progress(samples, f64::from(samples) + share, rays, start.elapsed(), None);
                if progress(&report).is_break() {
                    stopped = true;
                    stop.store(true, Ordering::Relaxed);
                }
            }
            worker.join()
        });
        self.rays += rays.load(Ordering::Relaxed);
        self.stopped |= stopped;
        if outcome.is_err() {
            return Err(Error::new(ErrorKind::Internal, "a worker thread panicked"));
        }
        Ok(!stop.load(Ordering::Relaxed))
    }

    fn summary(&self, elapsed: Duration) -> Summary {
        let mut notes = Vec::new();
        if let Some(depth) = self.settings.desc.max_depth {
            notes.push(format!("paths were cut after {depth} hits (maxDepth): the image is too dark"));
        }
        if self.settings.desc.sampler == SamplerDesc::Gaussian && self.settings.desc.filter != FilterDesc::Box {
            notes.push("the gaussian pattern is a pixel filter by itself: the filter was not used".to_owned());
        }
        let non_finite = self.film.non_finite();
        if non_finite > 0 {
            notes.push(format!("{non_finite} samples were NaN or infinite and count as black"));
        }
        Summary {
            elapsed,
            samples: self.samples,
            rays: self.rays,
            relative_error: self.film.relative_error(),
            stopped: self.stopped,
            non_finite,
            notes,
        }
    }
}

/// Parameters within which a filter is one.
fn check_filter(filter: &FilterDesc) -> Result<()> {
    let (ok, expected) = match *filter {
        FilterDesc::Gaussian { sigma } => (sigma > 0.0 && sigma <= 16.0, "a sigma above 0 and up to 16 pixels"),
        FilterDesc::Mitchell { b, c } => {
            ((0.0..=1.0).contains(&b) && (0.0..=1.0).contains(&c), "b and c between 0 and 1")
        }
        FilterDesc::Box | FilterDesc::Tent | FilterDesc::BlackmanHarris => (true, ""),
    };
    if ok { Ok(()) } else { Err(Error::invalid("render.filter", format!("{filter:?}; expected {expected}"))) }
}
