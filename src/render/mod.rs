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
mod crew;
mod non_finite;
mod pass;
mod schedule;
mod workers;

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use crate::Cancel;
use crate::camera::Camera;
use crate::desc::{FilterDesc, IntegratorDesc, MAX_PIXELS, MAX_SHADOW_RAYS, RenderDesc, SamplerDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::{ErrorEstimate, ErrorMeasure, Film, FilmOptions, Image, SampleCounts, TILE};
use crate::integrator::photon::{Choice, Gather, Plan, choose};
use crate::integrator::radiosity::{Radiosity, RadiosityPicture};
use crate::integrator::{Irradiance, Path, Sites};
use crate::sampling::Filter;
use crate::scene::Scene;
use adaptive::{LEAST_PIXELS, PILOT, Stage};
use crew::Crew;
use pass::Pass;
use schedule::Schedule;

pub use non_finite::NonFiniteSample;
pub use schedule::MOST_SAMPLES;
pub use workers::{MAX_THREADS, Workers};

/// What share of a render a radiosity solution counts as. What it will take is not known before, nor what a sample does.
const SOLUTION_SHARE: f64 = 0.5;

/// Pixels to a row of a film of irradiance: as many as a tile has.
pub const IRRADIANCE_WIDTH: u32 = TILE;

/// What to render, and with how much effort.
#[derive(Clone, Debug, Default)]
pub struct RenderSettings {
    /// Resolution, samples, sampler, filter, integrator, seed.
    pub desc: RenderDesc,
    /// Worker threads, of a pool of its own; 0 means one per core. The image does not depend on it. Not looked at where
    /// `workers` are given.
    pub threads: usize,
    /// Who does the work, where it is not a pool of its own.
    pub workers: Option<Workers>,
    /// Ends after this time, when the samples that are being taken are done, even if others are left. For time alone
    /// to count, ask for [`MOST_SAMPLES`].
    pub time_limit: Option<Duration>,
    /// Ends when the estimated error is no larger than this, by a margin of a quarter of the estimate's standard error: not
    /// before 32 samples, and not while few pixels have most of the error. Decided between passes.
    pub target_error: Option<f64>,
    /// What `target_error` is of: relMSE if nothing is said. Adaptive samples go where it is largest.
    pub error_measure: ErrorMeasure,
    /// Whether pixels with more error get more samples; `samples` of `desc` is the mean over pixels then. `None`: where an
    /// error is aimed at. Patterns that are planned for their number of samples (all samplers but `Sobol` and `Random`)
    /// and photon maps that are made anew for each pass need the same number for each pixel, and have it; a note says so.
    pub adaptive: Option<bool>,
    /// Stops the render soon, from any thread.
    pub cancel: Cancel,
    /// Keeps albedo, normal and depth of the first hit.
    pub auxiliary: bool,
}

/// How far a render has come.
pub struct Progress<'a> {
    /// Share of the work or of the time limit that is done, in [0, 1]; only grows. Where an error is aimed at, of the samples
    /// that it is expected to take, once there is an estimate.
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

/// What ended a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ended {
    /// Every pixel has its samples.
    #[default]
    Samples,
    /// The time limit.
    Time,
    /// The error is as small as was asked for.
    Error,
    /// The caller: [`Cancel`], or a report that was answered with `Break`.
    Cancelled,
}

/// What a render came to.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Time that [`Render::run`] took.
    pub elapsed: Duration,
    /// Complete samples per pixel; the mean over pixels where they differ.
    pub samples: u32,
    /// Samples of pixels as they are, those of an unfinished pass too; `None` after a cancel.
    pub sample_counts: Option<SampleCounts>,
    /// Whether pixels with more error got more samples.
    pub adaptive: bool,
    /// Rays traced, closest-hit and shadow rays together.
    pub rays: u64,
    /// Estimated relMSE (see [`Film::rel_mse`]), where there are enough samples to tell and nobody who cancelled is kept
    /// waiting for it.
    pub rel_mse: Option<ErrorEstimate>,
    /// Estimated error of what a screen shows (see [`Film::display_error`]), likewise.
    pub display_error: Option<ErrorEstimate>,
    /// What ended it.
    pub ended: Ended,
    /// Whether the caller stopped it before the end.
    pub stopped: bool,
    /// Samples that were NaN or infinite and were left out.
    pub non_finite: u64,
    /// The first few of them, and where they became so.
    pub non_finite_samples: Vec<NonFiniteSample>,
    /// What a user should know: a bias that was asked for, samples left out, an error that rests on few pixels.
    pub notes: Vec<String>,
}

/// Light transport, ready to be asked.
#[derive(Clone)]
enum Method {
    Path,
    Whitted,
    Direct,
    Gather(Box<Gather>),
    Irradiance(Irradiance),
    Radiosity(RadiosityPicture),
}

/// A render of a scene: its film, and those who fill it.
pub struct Render {
    scene: Scene,
    settings: RenderSettings,
    desc: Arc<RenderDesc>,
    camera: Camera,
    filter: Filter,
    film: Arc<Film>,
    workers: Workers,
    /// What was chosen, where that was left to us.
    choice: Option<Choice>,
    /// Photon maps, where the integrator wants any.
    plan: Option<Plan>,
    /// The solution, where the integrator is radiosity and it has been made.
    radiosity: Option<Arc<Radiosity>>,
    /// What the pass under way is rendered with.
    method: Method,
    samples: u32,
    /// At how many samples it is decided how to go on.
    decision: u32,
    /// Where samples go until then, if not to all pixels alike.
    stage: Option<Stage>,
    /// Whether they may go to some pixels more than to others; if not although it was wanted, why.
    adaptive: std::result::Result<bool, &'static str>,
    rays: u64,
    non_finite: u64,
    non_finite_samples: Vec<NonFiniteSample>,
}

impl Render {
    /// Prepares a render: checks the settings, makes the film, starts the threads where it has its own. Keeps a share of
    /// the scene.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for settings that make no image, `OutOfMemory` for a film that does not fit.
    pub fn new(scene: &Scene, settings: RenderSettings) -> Result<Self> {
        Self::with_method(scene, settings, None)
    }

    /// Prepares a render of irradiance [W m^-2] by path tracing: of each of these sites, on the outer side of the surface
    /// (`front`) or the other, instead of what a camera sees.
    ///
    /// The film has [`IRRADIANCE_WIDTH`] pixels a row, one for each site, row by row; pixels of the last row that are left over
    /// show the first sites once more. Of the settings resolution, integrator, filter and auxiliary layers are not looked at;
    /// depth counts the site itself as the first hit; samplers other than `Random` count as `Sobol`.
    ///
    /// # Errors
    /// As for [`Render::new`]; `InvalidScene` where there is no site.
    pub fn irradiance(scene: &Scene, settings: RenderSettings, sites: Arc<Sites>, front: bool) -> Result<Self> {
        if sites.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "there is no surface whose irradiance could be asked for"));
        }
        let rows = sites.len().div_ceil(IRRADIANCE_WIDTH as usize);
        let desc = RenderDesc {
            resolution: [IRRADIANCE_WIDTH, u32::try_from(rows).unwrap_or(u32::MAX)],
            integrator: IntegratorDesc::Path,
            filter: FilterDesc::Box,
            sampler: match settings.desc.sampler {
                SamplerDesc::Random => SamplerDesc::Random,
                _ => SamplerDesc::Sobol,
            },
            ..settings.desc
        };
        let path = Path { max_depth: desc.max_depth, shadow_rays: desc.shadow_rays };
        let settings = RenderSettings { desc, auxiliary: false, ..settings };
        Self::with_method(scene, settings, Some(Method::Irradiance(Irradiance::new(sites, path, front))))
    }

    fn with_method(scene: &Scene, settings: RenderSettings, method: Option<Method>) -> Result<Self> {
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
        if settings.target_error.is_some_and(|target| !(target > 0.0 && target.is_finite())) {
            let message = format!("{:?}; expected a finite number above 0", settings.target_error.unwrap_or_default());
            return Err(Error::invalid("targetError", message));
        }
        check_filter(&desc.filter)?;
        // Irradiance is nothing that a camera sees, and its film no image.
        let seen = if method.is_some() { [1, 1] } else { desc.resolution };
        let camera = Camera::new(scene.camera(), seen, scene.centre())?;
        // The normally distributed pattern is a pixel filter by itself.
        let filter_desc = if desc.sampler == SamplerDesc::Gaussian { FilterDesc::Box } else { desc.filter };
        let choice = (desc.integrator == IntegratorDesc::Auto).then(|| choose(scene));
        let integrator = choice.as_ref().map_or(desc.integrator, |choice| choice.integrator);
        let method = method.unwrap_or(match integrator {
            IntegratorDesc::Whitted => Method::Whitted,
            IntegratorDesc::Direct => Method::Direct,
            _ => Method::Path,
        });
        let filter = Filter::new(&filter_desc);
        let scene = scene.clone();
        let shared = Arc::new(desc.clone());
        let plan = match integrator {
            IntegratorDesc::Path | IntegratorDesc::Whitted | IntegratorDesc::Direct | IntegratorDesc::Radiosity => None,
            method => Some(Plan::new(&scene, &camera, &shared, method)?),
        };
        let pass_samples = plan.as_ref().and_then(Plan::samples_a_pass);
        let film = Film::new(FilmOptions {
            resolution: desc.resolution,
            auxiliary: settings.auxiliary,
            share: pass_samples.unwrap_or(1),
            weighted: matches!(filter_desc, FilterDesc::Mitchell { .. }),
            gathering: plan.as_ref().is_some_and(Plan::remembers),
        })?;
        let adaptive = match (settings.adaptive.unwrap_or(settings.target_error.is_some()), desc.sampler) {
            (false, _) => Ok(false),
            (true, _) if pass_samples.is_some() => Err("the photon maps of a pass are for all pixels"),
            (true, _) if pixels < LEAST_PIXELS => Err("the image is too small for a choice among pixels"),
            (true, SamplerDesc::Sobol | SamplerDesc::Random) => Ok(true),
            (true, _) => Err("the sampler's pattern is planned for its number of samples"),
        };
        let workers = match &settings.workers {
            Some(workers) => workers.clone(),
            None => Workers::pool(settings.threads)?,
        };
        Ok(Self {
            scene,
            desc: shared,
            settings,
            camera,
            filter,
            film: Arc::new(film),
            workers,
            choice,
            plan,
            radiosity: None,
            method,
            samples: 0,
            decision: 0,
            stage: None,
            adaptive,
            rays: 0,
            non_finite: 0,
            non_finite_samples: Vec::new(),
        })
    }

    /// Renders until samples, time or the caller's patience are used up.
    ///
    /// `progress` is called on the calling thread, between passes and about ten times a second; `Break` stops the render
    /// as [`Cancel`] does: in the middle of the samples that are being taken. What was sampled until then stays in the
    /// film, and another call goes on from there, with the same result as if nothing had happened.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Internal`] if a worker or a shape's intersection test panicked.
    pub fn run(&mut self, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Summary> {
        let start = Instant::now();
        let mut schedule = Schedule::new(&self.settings, self.film.options().share, self.adaptive == Ok(true));
        if self.wants_solution() {
            schedule.lead = SOLUTION_SHARE;
        }
        let ended = loop {
            let error = self.aimed_error(&schedule);
            if let Some(ended) = schedule.ended(self.samples, start.elapsed(), error) {
                break ended;
            }
            // Asked now, so that a render which the caller stopped with its last sample counts as finished; and before anything
            // is decided by an error that nobody waited for.
            if self.settings.cancel.is_cancelled() {
                break Ended::Cancelled;
            }
            if self.samples >= self.decision && !self.decide(&mut schedule, error) {
                break Ended::Cancelled;
            }
            let mut count = schedule.next_pass(self.samples, start.elapsed(), self.decision);
            if let Some(ended) = self.prepare(&schedule, start, progress)? {
                break ended;
            }
            if let Some(samples) = self.plan.as_ref().and_then(Plan::samples_a_pass) {
                // Up to where other maps are wanted.
                count = count.min(samples - self.samples % samples);
            }
            if let Some(ended) = self.pass(count, &schedule, start, progress)? {
                break ended;
            }
            self.samples += count;
            let image = || self.film.develop();
            let done = f64::from(self.samples);
            let report = schedule.progress(self.samples, done, self.rays, start.elapsed(), Some(&image));
            if progress(&report).is_break() {
                let error = self.aimed_error(&schedule);
                break schedule.ended(self.samples, start.elapsed(), error).unwrap_or(Ended::Cancelled);
            }
        };
        // A shape's test that panicked inside Embree's callback counted as a miss there; say so here.
        if let Some(kernel) = self.scene.kernel() {
            kernel.check()?;
        }
        Ok(self.summary(start.elapsed(), ended))
    }

    /// The error as it is, where one is aimed at and it is time to decide.
    fn aimed_error(&self, schedule: &Schedule) -> Option<ErrorEstimate> {
        let measure = schedule.asks(self.samples).filter(|_| self.samples >= self.decision)?;
        let error = self.film.error_unless(measure, &self.settings.cancel);
        if error.is_none() && self.scene.emitters().is_dark() {
            // It is black, and will be.
            return Some(ErrorEstimate { value: 0.0, standard_error: 0.0 });
        }
        error
    }

    /// Decides how many samples to take before it is decided again, and where; false if it was cancelled meanwhile, and
    /// then nothing is decided.
    fn decide(&mut self, schedule: &mut Schedule, error: Option<ErrorEstimate>) -> bool {
        let next = schedule.next_decision(self.samples, error);
        if self.adaptive == Ok(true) && self.samples >= PILOT {
            let (measure, seed) = (self.settings.error_measure, self.desc.seed);
            self.stage = Stage::new(&self.film, measure, [self.samples, next], seed, &self.settings.cancel);
            if self.stage.is_none() {
                return false;
            }
        }
        self.decision = next;
        true
    }

    /// What stops the next [`Render::run`]; a render that was cancelled goes on only with a new one.
    pub fn set_cancel(&mut self, cancel: Cancel) {
        self.settings.cancel = cancel;
    }

    /// The film, which any thread may develop at any time.
    pub fn film(&self) -> &Arc<Film> {
        &self.film
    }

    /// The image as it stands.
    pub fn image(&self) -> Image {
        self.film.develop()
    }

    /// Whether there is a radiosity solution to be found first.
    fn wants_solution(&self) -> bool {
        self.desc.integrator == IntegratorDesc::Radiosity && self.radiosity.is_none()
    }

    /// Makes the maps that the next samples want; what ended the render meanwhile, if anything did.
    fn prepare(
        &mut self,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        let wants_solution = self.wants_solution();
        if self.plan.is_none() && !wants_solution {
            return Ok(None);
        }
        let limit = self.settings.time_limit.filter(|_| self.samples > 0);
        let (samples, rays) = (self.samples, self.rays);
        let mut look_up = |share| {
            if wants_solution {
                schedule.prepared.set(share);
            }
            let report = schedule.progress(samples, f64::from(samples), rays, start.elapsed(), None);
            progress(&report).is_break()
        };
        let deadline = limit.and_then(|limit| start.checked_add(limit));
        let mut crew = Crew::new(&self.workers, &self.settings.cancel, deadline, &mut look_up);
        let made = match &mut self.plan {
            Some(plan) => {
                let before = plan.rays;
                let gather = plan.gather(samples, &mut crew);
                self.rays += plan.rays - before;
                gather.map(|gather| Method::Gather(Box::new(gather)))
            }
            None => Radiosity::solve(&self.scene, &self.desc.radiosity, &mut crew).map(|solution| {
                let solution = Arc::new(solution);
                self.radiosity = Some(Arc::clone(&solution));
                schedule.prepared.set(1.0);
                let (is_gather, shadow_rays) = (self.desc.radiosity.final_gather, self.desc.shadow_rays);
                Method::Radiosity(RadiosityPicture::new(&self.scene, solution, is_gather, shadow_rays))
            }),
        };
        let is_cancelled = crew.is_broken_off || self.settings.cancel.is_cancelled();
        match made {
            Ok(method) => {
                self.method = method;
                Ok(None)
            }
            Err(error) if error.kind() == ErrorKind::Cancelled => {
                Ok(Some(if is_cancelled { Ended::Cancelled } else { Ended::Time }))
            }
            Err(error) => Err(error),
        }
    }

    /// One pass over all tiles; what ended the render in the middle of it, if anything did.
    fn pass(
        &mut self,
        count: u32,
        schedule: &Schedule,
        start: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Ended>> {
        // One sample everywhere is the least that makes an image.
        let limit = self.settings.time_limit.filter(|_| self.samples > 0);
        let deadline = limit.and_then(|limit| start.checked_add(limit));
        let mut pass = Pass::new(self, self.samples + count, deadline);
        pass.goals = self.stage.as_ref().map(|stage| stage.goals(self.samples + count));
        let (samples, rays_before) = (self.samples, self.rays);
        let mut is_broken_off = false;
        let pass = self.workers.run(pass, &mut |pass| {
            let done = f64::from(samples) + pass.share() * f64::from(count);
            let rays = rays_before + pass.rays.load(Ordering::Relaxed);
            let report = schedule.progress(samples, done, rays, start.elapsed(), None);
            if progress(&report).is_break() {
                is_broken_off = true;
                pass.stop.store(true, Ordering::Relaxed);
            }
        })?;
        self.rays += pass.rays.load(Ordering::Relaxed);
        let suspects = std::mem::take(&mut *pass.non_finite.lock().unwrap_or_else(PoisonError::into_inner));
        self.non_finite += suspects.count;
        let explained = suspects.explain(self);
        self.non_finite_samples.extend(explained);
        if pass.is_complete() {
            return Ok(None);
        }
        let is_cancelled = is_broken_off || self.settings.cancel.is_cancelled();
        Ok(Some(if is_cancelled { Ended::Cancelled } else { Ended::Time }))
    }

    /// What makes the image wrong without making it noisy, if anything does.
    fn unknown_bias(&self) -> Option<&'static str> {
        match self.choice.as_ref().map_or(self.desc.integrator, |choice| choice.integrator) {
            IntegratorDesc::Whitted | IntegratorDesc::Direct => Some("of light that is scattered more often"),
            IntegratorDesc::PhotonDirect | IntegratorDesc::Photon => Some("of photon maps that are made once"),
            IntegratorDesc::IrradianceCache => Some("of the irradiance cache"),
            IntegratorDesc::Radiosity => Some("of the radiosity solution"),
            _ if self.desc.max_depth.is_some() => Some("of paths that are cut"),
            _ => None,
        }
    }

    fn summary(&self, elapsed: Duration, ended: Ended) -> Summary {
        let mut notes = Vec::new();
        if let Some(choice) = &self.choice {
            notes.push(format!("auto chose {}: {}", choice.integrator.name(), choice.why));
        }
        notes.extend(self.plan.iter().flat_map(|plan| plan.notes().iter().cloned()));
        notes.extend(self.radiosity.iter().flat_map(|solution| solution.notes().iter().cloned()));
        if let Some(depth) = self.settings.desc.max_depth.filter(|_| self.radiosity.is_none()) {
            notes.push(format!("paths were cut after {depth} hits (maxDepth): the image is too dark"));
        }
        if self.settings.desc.sampler == SamplerDesc::Gaussian && self.settings.desc.filter != FilterDesc::Box {
            notes.push("the gaussian pattern is a pixel filter by itself: the filter was not used".to_owned());
        }
        if let Some(bias) = self.unknown_bias().filter(|_| self.settings.target_error.is_some()) {
            notes.push(format!("the error that ended or judged the render does not know the bias {bias}"));
        }
        if let Err(why) = self.adaptive {
            notes.push(format!("all pixels had the same number of samples: {why}"));
        }
        let is_asked_for = self.settings.adaptive == Some(true) && self.adaptive == Ok(true);
        if is_asked_for && self.stage.is_none() && ended != Ended::Cancelled {
            notes
                .push(format!("all pixels had the same number of samples: the first {PILOT} are too few to choose by"));
        }
        let non_finite = self.non_finite;
        if non_finite > 0 {
            let first =
                self.non_finite_samples.first().map(|first| format!("; the first: {first}")).unwrap_or_default();
            notes.push(format!("{non_finite} samples were NaN or infinite and count as black{first}"));
        }
        let cancel = &self.settings.cancel;
        let rel_mse = self.film.error_unless(ErrorMeasure::RelMse, cancel);
        if rel_mse.is_some_and(|error| error.is_heavy_tailed()) {
            notes.push(
                "the estimated relMSE rests on few pixels, which rare bright paths have met: it may be off by far"
                    .to_owned(),
            );
        }
        Summary {
            elapsed,
            samples: self.samples,
            sample_counts: self.film.counts_unless(cancel),
            adaptive: self.stage.is_some(),
            rays: self.rays,
            rel_mse,
            display_error: self.film.error_unless(ErrorMeasure::Display, cancel),
            ended,
            stopped: ended == Ended::Cancelled,
            non_finite,
            non_finite_samples: self.non_finite_samples.clone(),
            notes,
        }
    }
}

/// Has work of equal pieces done by those who would do a render of these settings, until it is done, or `look_up`, asked now and then
/// on the calling thread and told what share of the work is done, answers with `Break`.
///
/// # Errors
/// Those of the work; [`ErrorKind::Cancelled`] if it was stopped, by the time limit too.
pub(crate) fn with_crew<R>(
    settings: &RenderSettings,
    look_up: &mut dyn FnMut(f64) -> ControlFlow<()>,
    work: impl FnOnce(&mut Crew) -> Result<R>,
) -> Result<R> {
    let workers = match &settings.workers {
        Some(workers) => workers.clone(),
        None => Workers::pool(settings.threads)?,
    };
    let deadline = settings.time_limit.and_then(|limit| Instant::now().checked_add(limit));
    let mut look_up = |share| look_up(share).is_break();
    work(&mut Crew::new(&workers, &settings.cancel, deadline, &mut look_up))
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
