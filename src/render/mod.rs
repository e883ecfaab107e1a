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

mod adaptive;
mod checkpoint;
mod crew;
mod maps;
mod mattes;
mod method;
mod order;
mod pass;
mod pilot;
mod places;
mod preparation;
mod replay;
mod report;
mod schedule;
mod settings;
mod share;
#[cfg(test)]
mod tests;
mod ways;
mod worker_pool;
mod workers;

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use crate::Cancel;
use crate::camera::{Camera, MovingCamera};
use crate::control::{Alone, PROGRESS_INTERVAL};
use crate::desc::{FilterDesc, IntegratorDesc, Preparation, RenderDesc, SamplerDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::{ErrorEstimate, ErrorMeasure, Estimates, Film, FilmOptions, Image, Placement, REPLICATES};
use crate::integrator::Path;
use crate::integrator::light_tracing::{LightPaths, LightPictures};
use crate::integrator::photon::{Choice, Plan, choose};
use crate::integrator::radiosity::{Radiosity, Steps};
use crate::integrator::reuse::PathReuse;
use crate::integrator::{check_light_parts, check_support, check_wavelengths, no_wavelengths};
use crate::sampling::{AnySampler, Filter, Pattern, PatternSampler, SobolSampler};
use crate::scene::Scene;
use crate::spectrum::{Sensor, white_balance};
use adaptive::{MIN_PIXELS, PILOT, Stage};
use checkpoint::{Header, Keeper};
use maps::Maps;
use method::Method;
use pass::{Light, Pass, PassInput};
use pilot::Found;
use schedule::Schedule;
use share::Tiles;
use ways::{Decision, Undecided, Wanted};
use worker_pool::WorkerPool;

pub use checkpoint::{Checkpoint, CheckpointPlan};
pub use crew::{Crew, Event, Link, help};
pub use mattes::{MAX_MATTE_LEVELS, MatteKind, MatteSettings, MatteShare, Mattes};
pub use places::IRRADIANCE_WIDTH;
pub use replay::NonFiniteSample;
pub use report::{Ended, Progress, Summary};
pub use schedule::MOST_SAMPLES;
pub use settings::RenderSettings;
pub use share::{MAX_SHARES, Share};
pub use workers::{MAX_THREADS, Workers};

/// Fraction of a render that its radiosity solution counts for in progress reports. The times of the solution and of a sample
/// are not known in advance.
const SOLUTION_FRACTION: f64 = 0.5;

/// Fraction of a time limit after which it is found out how long the estimates of errors will take. Pixels of unknown mean take
/// longest, and become fewer.
const TIME_BEFORE_ERRORS: f64 = 0.25;

/// Where the film of a render lies in its picture; `None` where it is the picture and has square pixels.
fn placement(desc: &RenderDesc, pixel_aspect: f64) -> Option<Placement> {
    if desc.crop.is_none() && pixel_aspect == 1.0 {
        return None;
    }
    let origin = desc.crop.map_or([0; 2], |crop| [crop.left, crop.top]);
    Some(Placement { origin, picture: desc.resolution, pixel_aspect: pixel_aspect as f32 })
}

/// The pixel filter of a render. The normally distributed pattern is itself a filter.
fn filter_of(desc: &RenderDesc) -> FilterDesc {
    if desc.sampler == SamplerDesc::Gaussian { FilterDesc::Box } else { desc.filter }
}

/// The same, to be sampled.
fn pixel_filter(desc: &RenderDesc) -> Filter {
    Filter::new(&filter_of(desc))
}

/// The sampler of the pixels of a render, of which `share` samples one after another belong to one replicate.
fn pixel_sampler(desc: &RenderDesc, share: u32) -> AnySampler {
    let pattern = match desc.sampler {
        SamplerDesc::Sobol => {
            return AnySampler::Sobol(SobolSampler::new(desc.seed, share).in_turn(REPLICATES as u32));
        }
        SamplerDesc::Random => Pattern::Random,
        SamplerDesc::Jittered => Pattern::Jittered,
        SamplerDesc::Grid => Pattern::Grid,
        SamplerDesc::Gaussian => Pattern::Gaussian,
    };
    AnySampler::Pattern(PatternSampler::new(pattern, desc.seed, desc.samples))
}

/// A render of a scene: the film, the integrator and the workers.
pub struct Render {
    scene: Scene,
    settings: RenderSettings,
    desc: Arc<RenderDesc>,
    camera: Camera,
    moving_camera: Option<Arc<MovingCamera>>,
    filter: Filter,
    film: Arc<Film>,
    workers: Workers,
    /// The integrator that was chosen for the scene, where the settings ask for a choice.
    choice: Option<Choice>,
    /// The plan of the photon maps, where the integrator uses them.
    plan: Option<Maps>,
    /// The plan of an irradiance cache that a pilot may choose in place of paths, until that is settled.
    cache: Option<Plan>,
    /// Whether a pilot compares the irradiance cache with paths, and why not.
    comparison: std::result::Result<(), &'static str>,
    /// The radiosity solution, once it is made, where the integrator is radiosity.
    radiosity: Option<Arc<Radiosity>>,
    /// Where it is to end, where the render goes on as it began or as others do.
    solution: Option<Steps>,
    /// The integrator of the current pass.
    method: Method,
    /// What a pilot is to say, until it has.
    undecided: Option<Undecided>,
    /// Light paths, where the render has them, and what they bring to the samples of the next pass.
    light_paths: Option<LightPaths>,
    /// Number of light samples at the hits that the camera sees, where the render traces paths.
    first_shadow_rays: u32,
    light_pictures: Option<LightPictures>,
    /// What the pilot found.
    found: Option<Found>,
    /// Number of complete samples per pixel.
    samples: u32,
    /// Number of samples per pixel at which the next decision is made.
    decision: u32,
    /// The goals of the pixels until the next decision, where the pixels have different goals.
    stage: Option<Arc<Stage>>,
    /// How long the errors of the film will take at the end, where a time limit asks for it and once it is known.
    time_of_errors: Option<Duration>,
    /// Whether the render is adaptive. The error says why it is not, where the settings ask for adaptive sampling.
    adaptive: std::result::Result<bool, &'static str>,
    rays: u64,
    /// Number of rays that the render had traced when it went on from a checkpoint.
    earlier_rays: u64,
    non_finite: u64,
    non_finite_samples: Vec<NonFiniteSample>,
    /// What a checkpoint says about the render, as it was before the first sample.
    header: Header,
}

impl Render {
    /// Prepares a render: checks the settings, makes the film, and starts the threads if the settings name no workers. The
    /// render shares the scene, which stays in memory as long as the render.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for settings that make no image, `OutOfMemory` for a film that does not fit.
    pub fn new(scene: &Scene, settings: RenderSettings) -> Result<Self> {
        Self::with_method(scene, settings, None)
    }

    fn with_method(scene: &Scene, settings: RenderSettings, method: Option<Method>) -> Result<Self> {
        let desc = &settings.desc;
        // A host may have set numbers that the reader of files would refuse.
        desc.check()?;
        if settings.target_error.is_some_and(|target| !(target > 0.0 && target.is_finite())) {
            let message = format!("{:?}; expected a finite number above 0", settings.target_error.unwrap_or_default());
            return Err(Error::invalid("targetError", message));
        }
        // A render of irradiance does not use the camera, and the film's resolution is no image size.
        let is_of_places = method.is_some();
        let seen = if is_of_places { [1, 1] } else { desc.resolution };
        let camera = Camera::new(scene.camera(), seen, scene.centre())?;
        let moving_camera = scene.moving_camera(seen)?.map(Arc::new);
        let choice = (desc.integrator.info().preparation == Preparation::Choice).then(|| choose(scene));
        let choice = choice.map(|choice| if settings.light_parts { choice.for_light_parts() } else { choice });
        let integrator = choice.as_ref().map_or(desc.integrator, |choice| choice.integrator);
        settings.check_sensor()?;
        if desc.spectral {
            match &method {
                None => check_wavelengths(integrator, desc)?,
                Some(method) => no_wavelengths(method.place_name())?,
            }
        }
        let wanted = Wanted::of(scene, &settings, integrator, method.as_ref().map(Method::place_name))?;
        match method {
            None => {
                check_support(scene, integrator)?;
                if settings.light_parts {
                    check_light_parts(integrator)?;
                }
            }
            Some(_) if scene.has_moving_world() => {
                let message = "something moves while the shutter is open, which light at given points does not show; expected a \
                    shutter that closes as it opens";
                return Err(Error::new(ErrorKind::Unsupported, message));
            }
            Some(_) => {}
        }
        let method = method.unwrap_or_else(|| Method::new(integrator));
        let filter = pixel_filter(desc);
        let scene = scene.with_roulette(desc.roulette);
        let path = Path::new(desc.max_depth, desc.shadow_rays);
        let reuse = || PathReuse::new(&scene, path);
        let method = if wanted.reuse == Decision::Yes { Method::Reuse(reuse()) } else { method };
        let light_paths = match wanted.light_paths {
            Decision::No => None,
            Decision::Yes | Decision::ByPilot => LightPaths::new(&scene, &camera, desc.resolution),
        };
        let shared = Arc::new(desc.clone());
        let cache = wanted.cache.is_ok().then(|| Maps::cache_alone(&scene, &camera, &shared)).flatten();
        let comparison = match wanted.cache {
            Ok(()) if cache.is_none() => Err("the cache needs photon maps for caustics"),
            comparison => comparison,
        };
        let wanted = Wanted { cache: comparison, ..wanted };
        let undecided = Undecided::new(&wanted, reuse, light_paths.as_ref());
        let light_paths = light_paths.filter(|_| wanted.light_paths == Decision::Yes);
        let plan = match integrator.info().preparation {
            Preparation::PhotonMaps(..) => Some(Maps::new(&scene, &camera, &shared, integrator, settings.sensor)?),
            Preparation::Nothing | Preparation::RadiositySolution | Preparation::Choice => None,
        };
        let pass_samples = plan.as_ref().and_then(Maps::samples_a_pass);
        let film = Film::new(FilmOptions {
            resolution: desc.film_size(),
            placement: placement(desc, if is_of_places { 1.0 } else { scene.camera().pixel_aspect() }),
            auxiliary: settings.auxiliary,
            light_parts: settings.light_parts,
            share: pass_samples.unwrap_or(1),
            weighted: matches!(filter_of(desc), FilterDesc::Mitchell { .. }),
            gathering: plan.as_ref().is_some_and(Maps::remembers),
        })?;
        let pixels = desc.film_size().map(u64::from).into_iter().product::<u64>();
        let adaptive = match (
            settings.adaptive.unwrap_or(settings.target_error.is_some() && !wanted.is_settled_for_all_pixels()),
            desc.sampler,
        ) {
            (false, _) => Ok(false),
            (true, _) if pass_samples.is_some() => Err("the photon maps of a pass are for all pixels"),
            (true, _) if pixels < MIN_PIXELS => Err("the image is too small for a choice among pixels"),
            (true, SamplerDesc::Sobol | SamplerDesc::Random) => Ok(true),
            (true, _) => Err("the sampler's pattern is planned for its number of samples"),
        };
        settings.check_parts(is_of_places.then(|| method.place_name()), adaptive == Ok(true))?;
        let header = checkpoint::begin(film.options(), &shared, &settings, adaptive == Ok(true), &scene)?;
        let workers = settings.own_workers()?;
        Ok(Self {
            light_paths,
            first_shadow_rays: wanted.first_shadow_rays.unwrap_or(desc.shadow_rays),
            light_pictures: None,
            scene,
            desc: shared,
            settings,
            camera,
            moving_camera,
            filter,
            film: Arc::new(film),
            workers,
            choice,
            plan,
            cache,
            comparison,
            radiosity: None,
            solution: None,
            method,
            undecided,
            found: None,
            samples: 0,
            decision: 0,
            stage: None,
            time_of_errors: None,
            adaptive,
            rays: 0,
            earlier_rays: 0,
            non_finite: 0,
            non_finite_samples: Vec::new(),
            header,
        })
    }

    /// Renders until all samples are taken, the time limit or the target error is reached, or the caller stops the render.
    ///
    /// `progress` is called on the calling thread, between passes and about ten times a second. Its answer `Break` stops the
    /// render as [`Cancel`] does, without completing the samples in progress. All earlier samples stay in the film. Another
    /// call of this function continues the render, with the same result as a render that was not stopped.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Internal`] if a worker or a shape's intersection test panicked.
    pub fn run(&mut self, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Summary> {
        self.run_by(None, progress)
    }

    /// [`Render::run`], with the help of other processes. The film has the same bits, except where time ends the render. With a crew,
    /// samples per pixel are added in larger passes, so that progress reports with images come less often.
    ///
    /// # Errors
    /// As for [`Render::run`]; [`ErrorKind::Unsupported`] for light maps and for light at given points. A helper that is lost or cannot
    /// help is no error, but a note of the summary.
    pub fn run_with(
        &mut self,
        crew: &mut Crew,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Summary> {
        crew.begin(&self.checkpoint()?, self.workers.threads())?;
        self.run_by(Some(crew), progress)
    }

    fn run_by(
        &mut self,
        mut crew: Option<&mut Crew>,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Summary> {
        let start = Instant::now();
        let is_first_run = self.samples == 0;
        let mut passes = 0;
        let mut schedule = Schedule::new(&self.settings, self.film.options().share, self.adaptive == Ok(true));
        schedule.set_time_limit(self.time_of_samples());
        if self.wants_solution() {
            schedule.preparation = SOLUTION_FRACTION;
        }
        if crew.is_some() {
            schedule.send_pixels(self.film.options());
        }
        let mut keeper = self.settings.checkpoint.clone().map(Keeper::new);
        let ended = loop {
            // An estimate that cannot change the end is left out.
            if let Some(ended) = schedule.ended(self.samples, start.elapsed(), None) {
                break ended;
            }
            let error = self.error_to_compare(&schedule)?;
            if let Some(ended) = schedule.ended(self.samples, start.elapsed(), error) {
                break ended;
            }
            // This check comes after the one for the end, so that a render that is cancelled with its last sample counts as
            // finished. It comes before decisions, which must not rest on an error estimate that was cancelled.
            if self.settings.cancel.is_cancelled() {
                break Ended::Cancelled;
            }
            if self.samples >= self.decision && !self.decide(&mut schedule, error)? {
                break Ended::Cancelled;
            }
            let mut count = schedule.next_pass(self.samples, start.elapsed(), self.decision);
            if let Some(samples) = self.plan.as_ref().and_then(Maps::samples_a_pass) {
                // A pass ends where the next photon maps are needed.
                count = count.min(samples - self.samples % samples);
            }
            if self.light_paths.is_some() || self.undecided.is_some() {
                count = count.min(LightPictures::most_samples(&self.film));
            }
            // All prepare it at the same time, but for what a pilot or the time says.
            let is_open = self.undecided.is_some() || self.has_open_solution();
            if let Some(crew) = crew.as_deref_mut().filter(|_| !is_open) {
                crew.begin_pass(self.samples, self.samples + count, self.ways());
            }
            if let Some(ended) = self.prepare(&schedule, start, progress)? {
                break ended;
            }
            if let Some(crew) = crew.as_deref_mut().filter(|_| is_open) {
                crew.begin_pass(self.samples, self.samples + count, self.ways());
            }
            if let Some(ended) = self.trace_light(count, &schedule, start, progress)? {
                break ended;
            }
            if let Some(ended) = self.pass(count, &schedule, start, keeper.as_mut(), crew.as_deref_mut(), progress)? {
                break ended;
            }
            self.samples += count;
            if let Some(keeper) = &mut keeper {
                keeper.keep(|| self.state(), false);
            }
            passes += 1;
            self.leave_time_for_errors(&mut schedule, start.elapsed());
            let image = || self.film.develop();
            let done = f64::from(self.samples);
            let report = schedule.progress(self.samples, done, self.rays, start.elapsed(), Some(&image));
            if progress(&report).is_break() {
                let error = self.error_to_compare(&schedule).unwrap_or_default();
                break schedule.ended(self.samples, start.elapsed(), error).unwrap_or(Ended::Cancelled);
            }
        };
        // An intersection test of a shape that panicked inside Embree's callback counted as a miss. Here it becomes an error.
        if let Some(kernel) = self.scene.kernel() {
            kernel.check()?;
        }
        if let Some(keeper) = &mut keeper {
            keeper.keep(|| self.state(), true);
        }
        let mut summary = self.summary(start.elapsed(), ended);
        summary.notes.extend(crew.into_iter().flat_map(|crew| crew.end_run()));
        summary.checkpoint_failure = keeper.and_then(|keeper| keeper.failure).map(|error| error.to_string());
        if ended == Ended::Time && is_first_run && passes == 1 && self.samples == 1 {
            summary.notes.push(
                "the time limit ended the render after the first sample of each pixel, which it does not apply to"
                    .to_owned(),
            );
        }
        Ok(summary)
    }

    /// The current error estimate, where there is a target error and a decision is due.
    fn error_to_compare(&self, schedule: &Schedule) -> Result<Option<ErrorEstimate>> {
        let measure = schedule.measure_to_estimate(self.samples).filter(|_| self.samples >= self.decision);
        let Some(measure) = measure else { return Ok(None) };
        let found = unless_cancelled(self.estimates(&[measure]))?.unwrap_or_default();
        let error = found.of(measure);
        // A scene without light is black without error.
        let is_black = error.is_none() && self.scene.emitters().is_dark();
        Ok(if is_black { Some(ErrorEstimate { value: 0.0, standard_error: 0.0 }) } else { error })
    }

    /// Decides the number of samples until the next decision, and the goals of the pixels. Returns `false`, and decides
    /// nothing, if the render was cancelled meanwhile.
    fn decide(&mut self, schedule: &mut Schedule, error: Option<ErrorEstimate>) -> Result<bool> {
        let next = schedule.next_decision(self.samples, error);
        if self.adaptive == Ok(true) && self.samples >= PILOT {
            let (measure, seed) = (self.settings.error_measure, self.desc.seed);
            let span = [self.samples, next];
            let stage = |parallel: &mut WorkerPool| Stage::new(&self.film, measure, span, seed, parallel);
            let stage = unless_cancelled(self.workers.without_limit(&self.settings.cancel, stage))?;
            let Some(stage) = stage else { return Ok(false) };
            self.stage = Some(Arc::new(stage));
        }
        self.decision = next;
        Ok(true)
    }

    /// When time ends a run that began at `start`; never before every pixel has one sample.
    fn deadline(&self, start: Instant) -> Option<Instant> {
        let limit = self.time_of_samples().filter(|_| self.samples > 0)?;
        start.checked_add(limit)
    }

    /// The time limit without what the estimates of errors have of it: a quarter at most.
    fn time_of_samples(&self) -> Option<Duration> {
        let limit = self.settings.time_limit?;
        Some(limit - self.time_of_errors.unwrap_or_default().min(limit / 4))
    }

    /// Finds once, when a part of the time is over, how long the estimates of the errors will take that end the render.
    fn leave_time_for_errors(&mut self, schedule: &mut Schedule, elapsed: Duration) {
        let is_due = |limit: Duration| elapsed >= limit.mul_f64(TIME_BEFORE_ERRORS);
        if self.time_of_errors.is_none() && self.settings.time_limit.is_some_and(is_due) {
            let (threads, cancel) = (self.workers.threads(), &self.settings.cancel);
            // What fails here, as by a lack of memory, may be there at the end.
            self.time_of_errors = self.film.time_of_estimates(&ErrorMeasure::ALL, threads, cancel).ok().flatten();
            schedule.set_time_limit(self.time_of_samples());
        }
    }

    /// Estimates of the film's errors in these measures.
    fn estimates(&self, measures: &[ErrorMeasure]) -> Result<Estimates> {
        let cancel = &self.settings.cancel;
        // In a process that was forked from that of the threads, what is rendered already has its errors all the same.
        match self.workers.are_there() {
            true => self.workers.without_limit(cancel, |parallel| self.film.estimates(measures, parallel)),
            false => self.film.estimates(measures, &mut Alone(cancel.clone())),
        }
    }

    /// Sets the token that stops the next [`Render::run`]. A render that was cancelled continues only with a new token.
    pub fn set_cancel(&mut self, cancel: Cancel) {
        self.settings.cancel = cancel;
    }

    /// The film. Any thread may develop it at any time.
    pub fn film(&self) -> &Arc<Film> {
        &self.film
    }

    /// Develops the current image.
    pub fn image(&self) -> Image {
        self.film.develop()
    }

    /// Whether the film has colours of a picture, which a white balance adapts.
    fn has_white(&self) -> bool {
        !self.method.is_of_places() && self.settings.sensor == Sensor::Observer
    }

    /// The input of the next pass.
    fn pass_input(&self) -> PassInput {
        PassInput {
            scene: self.scene.clone(),
            camera: self.camera,
            has_rim: self.camera.has_rim() && !self.method.is_of_places(),
            sensor: self.settings.sensor,
            white_balance: self.desc.white_balance.filter(|_| self.has_white()).and_then(white_balance),
            moving_camera: self.moving_camera.clone(),
            filter: self.filter.clone(),
            desc: Arc::clone(&self.desc),
            method: self.method.clone(),
            film: Arc::clone(&self.film),
            first_shadow_rays: self.first_shadow_rays,
            light: self
                .light_paths
                .clone()
                .zip(self.light_pictures.clone())
                .map(|(paths, pictures)| Light { paths, pictures }),
        }
    }

    /// Renders one pass over all tiles. Returns the reason if the render ended before the pass was complete.
    fn pass(
        &mut self,
        count: u32,
        schedule: &Schedule,
        start: Instant,
        mut keeper: Option<&mut Keeper>,
        mut crew: Option<&mut Crew>,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        let deadline = self.deadline(start);
        let input = self.pass_input();
        let mut pass = Pass::new(input.clone(), self.samples + count, deadline, self.settings.cancel.clone());
        pass.goals = self.stage.as_ref().map(|stage| stage.goals(self.samples + count));
        pass.tiles = Tiles::of(&self.film, self.settings.share);
        let (samples, rays_before) = (self.samples, self.rays);
        let (state, earlier_rays) = (keeper.is_some().then(|| self.state()), self.earlier_rays);
        pass.is_shared = crew.is_some();
        let mut is_stopped_by_callback = false;
        let mut last = Instant::now();
        let pass = self.workers.run(pass, &mut |pass| {
            if let Some(crew) = &mut crew {
                crew.serve(pass);
                if last.elapsed() < PROGRESS_INTERVAL {
                    return;
                }
                last = Instant::now();
            }
            let done = f64::from(samples) + pass.fraction() * f64::from(count);
            let rays = rays_before + pass.rays.load(Ordering::Relaxed);
            let report = schedule.progress(samples, done, rays, start.elapsed(), None);
            if progress(&report).is_break() {
                is_stopped_by_callback = true;
                pass.stop.store(true, Ordering::Relaxed);
            }
            // Each pixel has some of the pass's samples or none of them; a render that is resumed adds those that are missing.
            if let (Some(keeper), Some(state)) = (&mut keeper, &state) {
                keeper.keep(|| state.with_rays(earlier_rays + rays), false);
            }
        })?;
        self.rays += pass.rays.load(Ordering::Relaxed);
        let non_finite = std::mem::take(&mut *pass.non_finite.lock().unwrap_or_else(PoisonError::into_inner));
        self.non_finite += non_finite.count;
        let explained = non_finite.explain(&self.scene, self.non_finite_samples.len(), |pixel, sample, limit| {
            Pass::replay(input.clone(), pixel, sample, limit)
        });
        self.non_finite_samples.extend(explained);
        if let Some(crew) = crew {
            crew.end_pass();
            self.non_finite = self.film.non_finite();
            if !pass.is_complete() && !pass.is_stopped() {
                // Some of the tiles were with helpers that were lost. Those that are complete take no time.
                crew.begin_pass(self.samples, self.samples + count, self.ways());
                return self.pass(count, schedule, start, keeper, Some(crew), progress);
            }
        }
        if pass.is_complete() {
            return Ok(None);
        }
        let is_cancelled = is_stopped_by_callback || self.settings.cancel.is_cancelled();
        Ok(Some(if is_cancelled { Ended::Cancelled } else { Ended::Time }))
    }

    /// The integrator of the render: the chosen one where the settings ask for a choice.
    fn integrator(&self) -> IntegratorDesc {
        self.choice.as_ref().map_or(self.desc.integrator, |choice| choice.integrator)
    }
}

/// What work gave, or `None` where it was cancelled.
fn unless_cancelled<R>(done: Result<R>) -> Result<Option<R>> {
    match done {
        Err(error) if error.kind() == ErrorKind::Cancelled => Ok(None),
        done => done.map(Some),
    }
}

/// Does `work` with the workers that a render with these settings would use. `progress` is called on the calling thread, at
/// least about ten times a second, with the fraction of the work that is done. Its answer `Break` stops the work.
///
/// # Errors
/// The errors of `work`, and [`ErrorKind::Cancelled`] if the work was stopped, for which the time limit is a reason too.
pub(crate) fn with_workers<R>(
    settings: &RenderSettings,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    work: impl FnOnce(&mut WorkerPool) -> Result<R>,
) -> Result<R> {
    let workers = settings.own_workers()?;
    let deadline = settings.time_limit.and_then(|limit| Instant::now().checked_add(limit));
    let mut callback = |fraction| progress(fraction).is_break();
    work(&mut WorkerPool::new(&workers, &settings.cancel, deadline, &mut callback))
}
