//! The state of a render that a call or a task does: its input, its progress and its outcome. `task` has the handles.

use std::ops::ControlFlow;
use std::ptr;
use std::sync::{Arc, Condvar, Mutex, PoisonError, Weak};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::boundary::{ActiveWork, Object, UserData, catch, is_active, lock, read_sized, share};
use super::checkpoint::{Held, Parts, resumed_film};
use super::device::etd_device;
use super::film::etd_film;
use super::float_state::in_host_state;
use super::progress::{BUILD_FRACTION, BuildReport, Pace, initial_progress};
use super::read;
use super::scene::etd_scene;
use super::status::{ETD_CANCELLED, ETD_DEVICE, ETD_IO, ETD_OK, Failure, Result};
use super::types::{
    ETD_ENDED_CANCELLED, ETD_ENDED_ERROR, ETD_ENDED_SAMPLES, ETD_ENDED_TIME, ETD_LOG_WARNING, ETD_PHASE_BUILD,
    ETD_PHASE_END, ETD_PHASE_RENDER, etd_progress, etd_render_options, etd_summary,
};
use crate::Cancel;
use crate::desc::{IntegratorDesc, SceneDesc};
use crate::output::summary_attributes;
use crate::render::{Ended, Render, RenderSettings, Summary};

/// A film gets a new image in the middle of a pass only if its last image is at least this old.
const IMAGE_INTERVAL: Duration = Duration::from_millis(200);

/// A film gets a new image in the middle of a pass only after this many times the duration of making the last image. An image
/// takes time for the pixels that have changed, so this bounds little more than the time of the first two.
const IMAGE_COST: u32 = 4;

/// A render that a call or a task does: its input, its progress and its outcome.
pub(super) struct RenderWork {
    scene: Arc<etd_scene>,
    film: Arc<etd_film>,
    /// The resolution of the film when the work was prepared, which is that of the render.
    resolution: [u32; 2],
    options: etd_render_options,
    user_data: UserData,
    state: Mutex<WorkState>,
    ended: Condvar,
    /// What the options say about parts of the picture and about checkpoints.
    parts: Parts,
    /// The state from which the render goes on, until the render has taken it over.
    held: Mutex<Option<Held>>,
    /// The render, which is kept so that it can be resumed, and what it is a render of.
    render: Mutex<Option<(Render, Weak<SceneDesc>)>>,
}

// SAFETY: the pointers in `options` are functions and `user_data`, which the library does not dereference.
unsafe impl Send for RenderWork {}
// SAFETY: as for `Send`.
unsafe impl Sync for RenderWork {}

struct WorkState {
    /// The token of the current run.
    cancel: Cancel,
    progress: etd_progress,
    /// Which reports the host gets.
    pace: Pace,
    /// Number of the current run. Each resumption is a new run.
    run: u64,
    /// The outcome of the previous run, for threads that still wait for that run.
    previous_outcome: Option<Result>,
    /// Whether a thread has begun the current run, or a cancel has ended it before that.
    has_begun: bool,
    /// The outcome of the current run; `None` while it runs.
    outcome: Option<Result>,
    /// The last run of which the host has heard how it ended.
    told: Option<u64>,
    /// Whether the current run has ended and no function of the host is called any more.
    is_over: bool,
    /// Whether the render is complete, so that there is nothing to resume.
    is_complete: bool,
    /// The thread of a run and the number of the run, where the run has a thread of its own.
    thread: Option<(u64, JoinHandle<()>)>,
}

/// How a run ended.
pub(super) struct End {
    /// Number of the run.
    pub run: u64,
    pub outcome: Result,
}

impl RenderWork {
    /// Checks all that can be refused before a render begins, and reserves the film.
    ///
    /// # Safety
    /// `film` must be NULL or a film. For `options`, the contract of [`read_sized`] holds.
    pub unsafe fn prepare(
        scene: &Arc<etd_scene>,
        film: *mut etd_film,
        options: *const etd_render_options,
    ) -> Result<Arc<Self>> {
        // SAFETY: the caller keeps this function's contract.
        let (film, options, parts, resumed) = unsafe {
            let film = share(film.cast_const())?;
            let options = if options.is_null() {
                read::render_out(&scene.desc().render)
            } else {
                read_sized(options, "options")?
            };
            (film, options, Parts::read(&options)?, resumed_film(&options)?)
        };
        // The host's text and film are not looked at again.
        let options = etd_render_options { checkpoint_file: ptr::null(), resume: ptr::null(), ..options };
        if !Arc::ptr_eq(film.device(), &scene.device) {
            return Err(Failure::argument("the film is of another device than the scene"));
        }
        let cancel = Cancel::new();
        let work = Self {
            user_data: UserData(options.user_data),
            scene: Arc::clone(scene),
            resolution: film.resolution(),
            film,
            options,
            state: Mutex::new(WorkState {
                cancel: cancel.clone(),
                progress: initial_progress(ETD_PHASE_BUILD),
                pace: Pace::default(),
                run: 0,
                previous_outcome: None,
                has_begun: false,
                outcome: None,
                told: None,
                is_over: false,
                is_complete: false,
                thread: None,
            }),
            ended: Condvar::new(),
            parts,
            held: Mutex::new(None),
            render: Mutex::new(None),
        };
        // Invalid options are refused here.
        work.settings(&cancel)?;
        let (own, other): (Vec<_>, Vec<_>) = resumed.iter().partition(|film| Arc::ptr_eq(film, &work.film));
        let mut held = other.first().map(|film| Held::of(film)).transpose()?;
        work.film.begin(work.resolution)?;
        if !own.is_empty() {
            match Held::of_reserved(&work.film) {
                Ok(state) => held = Some(state),
                Err(failure) => {
                    work.film.end(None);
                    return Err(failure);
                }
            }
        }
        *lock(&work.held) = held;
        Ok(Arc::new(work))
    }

    /// The address that identifies this work in [`ActiveWork`].
    fn address(&self) -> usize {
        std::ptr::from_ref(self).addr()
    }

    /// Whether this thread does the work, or runs a function of the host that the work has called.
    pub fn is_active_here(&self) -> bool {
        is_active(self.address())
    }

    /// Changes the progress report and calls the host's progress callback, if that is due.
    fn report(&self, cancel: &Cancel, change: impl FnOnce(&mut etd_progress)) {
        let (progress, is_due) = {
            let mut state = lock(&self.state);
            let before = state.progress.fraction;
            change(&mut state.progress);
            state.progress.fraction = state.progress.fraction.max(before);
            let progress = state.progress;
            (progress, state.pace.is_due(&progress))
        };
        if let Some(callback) = self.options.progress.filter(|_| is_due) {
            let _active = ActiveWork::enter(self.address());
            // SAFETY: the host provided the function for these calls; the report lives during the call.
            if in_host_state(|| unsafe { callback(self.user_data.0, &raw const progress) }) != 0 {
                cancel.cancel();
            }
        }
    }

    /// Builds the scene and renders on this thread, and releases the film, which was reserved before.
    pub fn run(self: &Arc<Self>, resumes: bool) -> Result {
        // From here on, this work calls functions of the host, including the log function.
        let _active = ActiveWork::enter(self.address());
        let cancel = lock(&self.state).cancel.clone();
        let mut summary = None;
        let outcome = catch(|| self.build_and_render(resumes, &cancel, &mut summary));
        self.film.end(summary);
        match outcome {
            Ok(()) if summary.is_some_and(|summary| summary.cancelled != 0) => {
                Err(Failure::new(ETD_CANCELLED, "the render was cancelled; the film holds what was done"))
            }
            other => other,
        }
    }

    fn build_and_render(
        self: &Arc<Self>,
        resumes: bool,
        cancel: &Cancel,
        out_summary: &mut Option<etd_summary>,
    ) -> Result {
        let start = Instant::now();
        let mut slot = lock(&self.render);
        let mut build_time = Duration::ZERO;
        if !resumes || slot.is_none() {
            let work = Arc::downgrade(self);
            let build_cancel = cancel.clone();
            let report: BuildReport = Some(Arc::new(move |fraction: f64| {
                if let Some(work) = work.upgrade() {
                    work.report(&build_cancel, |progress| {
                        progress.phase = ETD_PHASE_BUILD;
                        progress.fraction = BUILD_FRACTION * fraction;
                        progress.elapsed = start.elapsed().as_secs_f64();
                    });
                }
            }));
            let (scene, time, desc) = self.scene.build_described(cancel, report)?;
            build_time = time;
            let mut held = lock(&self.held).take();
            let mut settings = self.settings(cancel)?;
            if self.parts.are_given() || held.is_some() {
                settings.fingerprint = Some(self.scene.fingerprint(&desc)?);
            }
            // If the scene's own integrator is radiosity, the build of the scene has already logged these warnings.
            let is_own = self.scene.desc().render.integrator == IntegratorDesc::Radiosity;
            if settings.desc.integrator == IntegratorDesc::Radiosity && !is_own {
                let callbacks = self.scene.device.callbacks();
                scene.info().not_diffuse.iter().for_each(|warning| callbacks.log(ETD_LOG_WARNING, warning));
            }
            let render = match held.as_mut().and_then(Held::take) {
                Some(state) => Render::resume(&scene, settings, state)?,
                None => Render::new(&scene, settings)?,
            };
            *slot = Some((render, Arc::downgrade(&desc)));
        }
        let Some((render, desc)) = slot.as_mut() else { return Ok(()) };
        render.set_cancel(cancel.clone());
        let sums = Arc::clone(render.film());
        self.film.set_sums(&sums);
        let built = if build_time.is_zero() { 0.0 } else { BUILD_FRACTION };
        // The first image is made as soon as anything is there.
        let mut last_image = None::<(Instant, Duration)>;
        let mut failure = None;
        let summary = render.run(&mut |progress| {
            let is_old = |(made, cost): (Instant, Duration)| made.elapsed() >= IMAGE_INTERVAL.max(IMAGE_COST * cost);
            if progress.image.is_some() || (last_image.is_none_or(is_old) && self.film.has_news(&sums)) {
                let begin = Instant::now();
                failure = self.film.publish(&sums, progress.samples_done, cancel).err();
                last_image = Some((Instant::now(), begin.elapsed()));
            }
            let images = self.film.images();
            self.report(cancel, |report| {
                report.phase = ETD_PHASE_RENDER;
                report.fraction = built + (1.0 - built) * progress.fraction;
                report.elapsed = start.elapsed().as_secs_f64();
                report.rays = progress.rays;
                report.samples_done = progress.samples_done;
                report.samples_total = progress.samples_total;
                report.images = images;
            });
            if failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if let Some(failure) = failure {
            return Err(failure);
        }
        self.film.keep(render.checkpoint()?, desc.clone());
        // The image of a pass that ended early. After a cancel, the image is made only when the host asks for it.
        if cancel.is_cancelled() || !self.film.publish(&sums, summary.samples, cancel)? {
            self.film.publish_later(&sums, summary.samples);
        }
        for note in &summary.notes {
            self.scene.header().callbacks.log(ETD_LOG_WARNING, note);
        }
        if matches!(summary.ended, Ended::Samples | Ended::Error) {
            lock(&self.state).is_complete = true;
            // A complete render no longer needs the scene and the arrays that the scene shares.
            *slot = None;
        }
        *out_summary = Some(summary_out(&summary, build_time, cancel.is_cancelled() && summary.stopped));
        self.film.set_attributes(summary_attributes(&summary));
        match summary.checkpoint_failure {
            Some(why) => Err(Failure::new(ETD_IO, format!("{why}; the film holds what was rendered"))),
            None => Ok(()),
        }
    }

    fn settings(&self, cancel: &Cancel) -> Result<RenderSettings> {
        let settings = settings_of(&self.options, self.resolution, &self.scene.device, cancel)?;
        let Parts { share, plan } = &self.parts;
        let (auxiliary, light_parts) = (self.film.keeps_first_hits(), self.film.keeps_light_parts());
        Ok(RenderSettings { auxiliary, light_parts, share: *share, checkpoint: plan.clone(), ..settings })
    }

    /// Marks a run as begun. Returns `false` if the run is over, or was already begun.
    fn begin(&self, run: u64) -> bool {
        let mut state = lock(&self.state);
        let is_mine = state.run == run && !state.has_begun;
        state.has_begun |= is_mine;
        is_mine
    }

    /// Stores the outcome, calls the host's `finished` callback, and wakes all threads that wait.
    fn finish(&self, outcome: Result) {
        let status = outcome.as_ref().err().map_or(ETD_OK, |failure| failure.status);
        {
            let mut state = lock(&self.state);
            state.progress.phase = ETD_PHASE_END;
            if status == ETD_OK {
                state.progress.fraction = 1.0;
            }
            state.outcome = Some(outcome);
        }
        if let Some(finished) = self.options.finished {
            let _active = ActiveWork::enter(self.address());
            // SAFETY: the host provided the function for these calls.
            in_host_state(|| unsafe { finished(self.user_data.0, status) });
        }
        lock(&self.state).is_over = true;
        self.ended.notify_all();
    }

    /// Starts a run on a thread of its own or on the host's executor.
    pub fn start(self: &Arc<Self>, run: u64, resumes: bool) -> Result {
        // A job that the host has queued and does not run keeps no object alive.
        let own = Arc::downgrade(self);
        let begun = self.scene.device.start(Box::new(move || {
            let Some(own) = own.upgrade() else { return };
            if own.begin(run) {
                let outcome = own.run(resumes);
                own.finish(outcome);
            }
        }));
        match begun {
            Ok(thread) => {
                let mut state = lock(&self.state);
                if let (Some(thread), true) = (thread, state.run == run) {
                    state.thread = Some((run, thread));
                }
                Ok(())
            }
            Err(error) => {
                let failure = Failure::new(ETD_DEVICE, format!("no thread could be started for the task: {error}"));
                if self.begin(run) {
                    self.film.end(None);
                    let mut state = lock(&self.state);
                    state.outcome = Some(Err(failure.clone()));
                    state.is_over = true;
                    drop(state);
                    self.ended.notify_all();
                }
                Err(failure)
            }
        }
    }

    /// Resumes the last run, if the run was stopped. It must not be called from a function of the host that this work calls.
    pub fn resume(self: &Arc<Self>) -> Result {
        let (run, thread) = {
            // The last run may have ended while its `finished` callback still runs.
            let is_finishing = |state: &mut WorkState| state.outcome.is_some() && !state.is_over;
            let state = self.ended.wait_while(lock(&self.state), is_finishing);
            let mut state = state.unwrap_or_else(PoisonError::into_inner);
            match &state.outcome {
                Some(Err(failure)) if failure.status != ETD_CANCELLED => {
                    return Err(Failure::operation(format!("the task has failed: {}", failure.message)));
                }
                // A complete render is not resumed.
                Some(_) if state.is_complete => return Ok(()),
                Some(_) => {}
                None => return Err(Failure::operation("the task is still running")),
            }
            self.film.begin(self.resolution)?;
            state.run += 1;
            state.has_begun = false;
            state.previous_outcome = state.outcome.take();
            state.is_over = false;
            state.cancel = Cancel::new();
            state.progress = initial_progress(ETD_PHASE_RENDER);
            state.pace = Pace::default();
            (state.run, state.thread.take())
        };
        // Threads that wait for the previous run return now.
        self.ended.notify_all();
        if let Some((_, thread)) = thread {
            let _ = thread.join();
        }
        self.start(run, true)
    }

    /// The progress, and how the current run ended if it has.
    pub fn progress_and_end(&self) -> (etd_progress, Option<End>) {
        let state = lock(&self.state);
        (state.progress, state.outcome.clone().map(|outcome| End { run: state.run, outcome }))
    }

    /// Whether the host has not heard yet how this run ended. From this call on it has.
    pub fn is_news(&self, run: u64) -> bool {
        let mut state = lock(&self.state);
        let is_news = state.told < Some(run);
        state.told = state.told.max(Some(run));
        is_news
    }

    /// Asks the current run to end. A run that no thread has begun ends here.
    pub fn cancel(&self) {
        let run = {
            let state = lock(&self.state);
            state.cancel.cancel();
            state.run
        };
        if self.begin(run) {
            let _active = ActiveWork::enter(self.address());
            self.film.end(None);
            self.finish(Err(Failure::new(ETD_CANCELLED, "the task was cancelled before it had begun")));
        }
    }

    /// Waits until the current run is over, for at most `limit`. Returns how it ended, or `None` if the run is not over.
    pub fn wait(&self, limit: Option<Duration>) -> Option<End> {
        let state = lock(&self.state);
        let run = state.run;
        let goes_on = |state: &mut WorkState| state.run == run && !state.is_over;
        let mut state = match limit {
            None => self.ended.wait_while(state, goes_on).unwrap_or_else(PoisonError::into_inner),
            Some(limit) => {
                self.ended.wait_timeout_while(state, limit, goes_on).unwrap_or_else(PoisonError::into_inner).0
            }
        };
        let outcome = match state.run - run {
            0 if state.is_over => state.outcome.clone(),
            0 => None,
            // The render was resumed meanwhile.
            _ => state.previous_outcome.clone(),
        };
        let thread = match (&outcome, &state.thread) {
            (Some(_), Some((of, _))) if *of == run => state.thread.take(),
            _ => None,
        };
        drop(state);
        // The thread is about to end. A process that exits after this call must not find the thread still running.
        if let Some((_, thread)) = thread {
            let _ = thread.join();
        }
        outcome.map(|outcome| End { run, outcome })
    }
}

/// Converts the options of a render to its settings.
pub(super) fn settings_of(
    it: &etd_render_options,
    resolution: [u32; 2],
    device: &etd_device,
    cancel: &Cancel,
) -> Result<RenderSettings> {
    let seconds = |limit: f64| Duration::try_from_secs_f64(limit).unwrap_or(Duration::MAX);
    let settings = RenderSettings {
        desc: read::render(it, resolution)?,
        workers: Some(device.workers.clone()),
        time_limit: (it.time_limit > 0.0).then(|| seconds(it.time_limit)),
        target_error: (it.target_error > 0.0).then_some(it.target_error),
        error_measure: read::error_measure(it)?,
        adaptive: read::adaptive(it)?,
        cancel: cancel.clone(),
        sensor: read::sensor(it),
        ..RenderSettings::default()
    };
    settings.check_sensor().map_err(read::in_options)?;
    Ok(settings)
}

/// Converts the summary of a render to the host's structure.
pub(super) fn summary_out(summary: &Summary, build_time: Duration, is_cancelled: bool) -> etd_summary {
    etd_summary {
        struct_size: size_of::<etd_summary>(),
        elapsed: summary.elapsed.as_secs_f64(),
        build_time: build_time.as_secs_f64(),
        rays: summary.rays,
        non_finite: summary.non_finite,
        relative_error: summary.rel_mse.map_or(f64::NAN, |error| error.value.sqrt()),
        samples: summary.samples,
        cancelled: u32::from(is_cancelled),
        rel_mse: summary.rel_mse.map_or(f64::NAN, |error| error.value),
        rel_mse_standard_error: summary.rel_mse.map_or(f64::NAN, |error| error.standard_error),
        display_error: summary.display_error.map_or(f64::NAN, |error| error.value),
        samples_min: summary.sample_counts.map_or(0, |counts| counts.min),
        samples_max: summary.sample_counts.map_or(0, |counts| counts.max),
        ended: match summary.ended {
            Ended::Samples => ETD_ENDED_SAMPLES,
            Ended::Time => ETD_ENDED_TIME,
            Ended::Error => ETD_ENDED_ERROR,
            Ended::Cancelled => ETD_ENDED_CANCELLED,
        },
        integrator: summary.integrator.c_value(),
    }
}
