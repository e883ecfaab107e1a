//! A render: what it needs, how far it is, and how it ended. Whoever has its handle is `task`'s concern.

use std::ops::ControlFlow;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::boundary::{Inside, Object, UserData, catch, is_inside, lock, read_sized, share};
use super::device::etd_device;
use super::film::etd_film;
use super::progress::{BUILD_SHARE, BuildReport, none_yet};
use super::read;
use super::scene::etd_scene;
use super::status::{ETD_CANCELLED, ETD_DEVICE, ETD_OK, Failure, Result};
use super::types::{
    ETD_ENDED_CANCELLED, ETD_ENDED_ERROR, ETD_ENDED_SAMPLES, ETD_ENDED_TIME, ETD_LOG_WARNING, ETD_PHASE_BUILD,
    ETD_PHASE_END, ETD_PHASE_RENDER, etd_progress, etd_render_options, etd_summary,
};
use crate::Cancel;
use crate::desc::IntegratorDesc;
use crate::output::summary_attributes;
use crate::render::{Ended, Render, RenderSettings, Summary};

/// A film gets a new image in the middle of a pass only when the last one is as old as this.
const IMAGE_INTERVAL: Duration = Duration::from_secs(1);

/// And when making images takes no more than one part in this of the time.
const IMAGE_COST: u32 = 50;

/// A render: what it needs, how far it is, and how it ended.
pub(super) struct Work {
    scene: Arc<etd_scene>,
    film: Arc<etd_film>,
    options: etd_render_options,
    user_data: UserData,
    state: Mutex<State>,
    ended: Condvar,
    /// Kept so that it can go on.
    render: Mutex<Option<Render>>,
}

// SAFETY: the pointers in `options` are functions, and `user_data`, which is the host's to look at.
unsafe impl Send for Work {}
// SAFETY: as for `Send`.
unsafe impl Sync for Work {}

struct State {
    cancel: Cancel,
    progress: etd_progress,
    /// Counts starts.
    run: u64,
    /// How the run before this one ended, for whoever still waits for that.
    before: Option<Result>,
    /// Whether somebody has taken on the current run: its thread, or whoever cancelled it before that.
    has_begun: bool,
    /// How it ended; `None` while it runs.
    outcome: Option<Result>,
    /// Whether the host was told, and nothing of it is called any more.
    is_over: bool,
    /// Whether every pixel has what was asked for: there is nothing to go on with.
    is_complete: bool,
    /// The thread of a run, where that is one of its own.
    thread: Option<(u64, JoinHandle<()>)>,
}

impl Work {
    /// Everything of a render that can be refused before it begins; the film is taken.
    ///
    /// # Safety
    /// Handles must be NULL or such objects; `options` as for [`read_sized`].
    pub unsafe fn prepare(
        scene: &Arc<etd_scene>,
        film: *mut etd_film,
        options: *const etd_render_options,
    ) -> Result<Arc<Self>> {
        // SAFETY: by the contract.
        let (film, options) = unsafe {
            let film = share(film.cast_const())?;
            let options = if options.is_null() {
                read::render_out(&scene.desc().render)
            } else {
                read_sized(options, "options")?
            };
            (film, options)
        };
        if !Arc::ptr_eq(film.device(), &scene.device) {
            return Err(Failure::argument("the film is of another device than the scene"));
        }
        let cancel = Cancel::new();
        let work = Self {
            user_data: UserData(options.user_data),
            scene: Arc::clone(scene),
            film,
            options,
            state: Mutex::new(State {
                cancel: cancel.clone(),
                progress: none_yet(ETD_PHASE_BUILD),
                run: 0,
                before: None,
                has_begun: false,
                outcome: None,
                is_over: false,
                is_complete: false,
                thread: None,
            }),
            ended: Condvar::new(),
            render: Mutex::new(None),
        };
        // Options that no render could have are refused here.
        work.settings(&cancel)?;
        work.film.begin()?;
        Ok(Arc::new(work))
    }

    /// What it is known by on the threads that work for it.
    fn address(&self) -> usize {
        std::ptr::from_ref(self).addr()
    }

    pub fn is_calling_us(&self) -> bool {
        is_inside(self.address())
    }

    /// Notes how far it is and tells the host.
    fn report(&self, cancel: &Cancel, change: impl FnOnce(&mut etd_progress)) {
        let progress = {
            let mut state = lock(&self.state);
            let before = state.progress.fraction;
            change(&mut state.progress);
            state.progress.fraction = state.progress.fraction.max(before);
            state.progress
        };
        if let Some(tell) = self.options.progress {
            let _inside = Inside::enter(self.address());
            // SAFETY: the host gave the function for this; the report lives during the call.
            if unsafe { tell(self.user_data.0, &raw const progress) } != 0 {
                cancel.cancel();
            }
        }
    }

    /// Builds and renders on this thread. The film has been taken; it is given back here.
    pub fn run(self: &Arc<Self>, resumes: bool) -> Result {
        // Any function of the host that is called from here on, a log function too, is one that this work calls.
        let _inside = Inside::enter(self.address());
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
            let told_cancel = cancel.clone();
            let told: BuildReport = Some(Arc::new(move |fraction: f64| {
                if let Some(work) = work.upgrade() {
                    work.report(&told_cancel, |progress| {
                        progress.phase = ETD_PHASE_BUILD;
                        progress.fraction = BUILD_SHARE * fraction;
                        progress.elapsed = start.elapsed().as_secs_f64();
                    });
                }
            }));
            let (scene, time) = self.scene.build(cancel, told)?;
            build_time = time;
            let settings = self.settings(cancel)?;
            // Of the scene's own integrator they were told with the scene.
            let is_own = self.scene.desc().render.integrator == IntegratorDesc::Radiosity;
            if settings.desc.integrator == IntegratorDesc::Radiosity && !is_own {
                let callbacks = self.scene.device.callbacks();
                scene.info().not_diffuse.iter().for_each(|warning| callbacks.log(ETD_LOG_WARNING, warning));
            }
            *slot = Some(Render::new(&scene, settings)?);
        }
        let Some(render) = slot.as_mut() else { return Ok(()) };
        render.set_cancel(cancel.clone());
        let sums = Arc::clone(render.film());
        self.film.set_sums(&sums);
        let built = if build_time.is_zero() { 0.0 } else { BUILD_SHARE };
        let mut last_image = Instant::now();
        let mut image_cost = Duration::ZERO;
        let mut failure = None;
        let summary = render.run(&mut |progress| {
            let is_due = progress.image.is_some() || last_image.elapsed() > IMAGE_INTERVAL.max(IMAGE_COST * image_cost);
            if is_due {
                let begin = Instant::now();
                failure = self.film.publish(&sums, progress.samples_done, cancel).err();
                last_image = Instant::now();
                image_cost = last_image - begin;
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
        // What was done of a pass that was cut short. Whoever cancelled does not wait for that.
        if cancel.is_cancelled() || !self.film.publish(&sums, summary.samples, cancel)? {
            self.film.publish_later(&sums, summary.samples);
        }
        for note in &summary.notes {
            self.scene.header().callbacks.log(ETD_LOG_WARNING, note);
        }
        if matches!(summary.ended, Ended::Samples | Ended::Error) {
            lock(&self.state).is_complete = true;
            // The scene is needed no more, nor are arrays that it shares.
            *slot = None;
        }
        *out_summary = Some(summary_out(&summary, build_time, cancel.is_cancelled() && summary.stopped));
        self.film.set_attributes(summary_attributes(&summary));
        Ok(())
    }

    fn settings(&self, cancel: &Cancel) -> Result<RenderSettings> {
        let settings = settings_of(&self.options, self.film.resolution, &self.scene.device, cancel)?;
        Ok(RenderSettings { auxiliary: self.film.keeps_first_hits(), ..settings })
    }

    /// Takes on a run, unless it is over already or somebody else has.
    fn begin(&self, run: u64) -> bool {
        let mut state = lock(&self.state);
        let is_mine = state.run == run && !state.has_begun;
        state.has_begun |= is_mine;
        is_mine
    }

    /// Notes the end and tells everybody.
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
            let _inside = Inside::enter(self.address());
            // SAFETY: the host gave the function for this.
            unsafe { finished(self.user_data.0, status) }
        }
        lock(&self.state).is_over = true;
        self.ended.notify_all();
    }

    /// Has a run of the work done somewhere else.
    pub fn start(self: &Arc<Self>, run: u64, resumes: bool) -> Result {
        // What the host has queued and not run must keep nothing alive.
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

    /// Goes on where the last run was stopped, if it was and anything is left; not from inside a function that it calls.
    pub fn resume(self: &Arc<Self>) -> Result {
        let (run, thread) = {
            // It may have ended and be telling so.
            let is_telling = |state: &mut State| state.outcome.is_some() && !state.is_over;
            let state = self.ended.wait_while(lock(&self.state), is_telling);
            let mut state = state.unwrap_or_else(PoisonError::into_inner);
            match &state.outcome {
                Some(Err(failure)) if failure.status != ETD_CANCELLED => {
                    return Err(Failure::operation(format!("the task has failed: {}", failure.message)));
                }
                // There is nothing left to do.
                Some(_) if state.is_complete => return Ok(()),
                Some(_) => {}
                None => return Err(Failure::operation("the task is still running")),
            }
            self.film.begin()?;
            state.run += 1;
            state.has_begun = false;
            state.before = state.outcome.take();
            state.is_over = false;
            state.cancel = Cancel::new();
            state.progress = none_yet(ETD_PHASE_RENDER);
            (state.run, state.thread.take())
        };
        // Whoever waits for the run before this one has waited long enough.
        self.ended.notify_all();
        if let Some((_, thread)) = thread {
            let _ = thread.join();
        }
        self.start(run, true)
    }

    /// How far it is, and how it ended if it has.
    pub fn so_far(&self) -> (etd_progress, Option<Result>) {
        let state = lock(&self.state);
        (state.progress, state.outcome.clone())
    }

    /// Asks the current run to end. One that nobody has begun ends here.
    pub fn cancel(&self) {
        let run = {
            let state = lock(&self.state);
            state.cancel.cancel();
            state.run
        };
        if self.begin(run) {
            let _inside = Inside::enter(self.address());
            self.film.end(None);
            self.finish(Err(Failure::new(ETD_CANCELLED, "the task was cancelled before it had begun")));
        }
    }

    /// Waits until the run that is going on now is over, for so long; how it ended, or `None`.
    pub fn wait(&self, limit: Option<Duration>) -> Option<Result> {
        let state = lock(&self.state);
        let run = state.run;
        let goes_on = |state: &mut State| state.run == run && !state.is_over;
        let mut state = match limit {
            None => self.ended.wait_while(state, goes_on).unwrap_or_else(PoisonError::into_inner),
            Some(limit) => {
                self.ended.wait_timeout_while(state, limit, goes_on).unwrap_or_else(PoisonError::into_inner).0
            }
        };
        let outcome = match state.run - run {
            0 if state.is_over => state.outcome.clone(),
            0 => None,
            // It was resumed meanwhile.
            _ => state.before.clone(),
        };
        let thread = match (&outcome, &state.thread) {
            (Some(_), Some((of, _))) if *of == run => state.thread.take(),
            _ => None,
        };
        drop(state);
        // It has nothing left to do; a host that ends now should not find it still ending.
        if let Some((_, thread)) = thread {
            let _ = thread.join();
        }
        outcome
    }
}

/// What a render's options ask for.
pub(super) fn settings_of(
    it: &etd_render_options,
    resolution: [u32; 2],
    device: &etd_device,
    cancel: &Cancel,
) -> Result<RenderSettings> {
    let seconds = |limit: f64| Duration::try_from_secs_f64(limit).unwrap_or(Duration::MAX);
    Ok(RenderSettings {
        desc: read::render(it, resolution)?,
        workers: Some(device.workers.clone()),
        time_limit: (it.time_limit > 0.0).then(|| seconds(it.time_limit)),
        target_error: (it.target_error > 0.0).then_some(it.target_error),
        error_measure: read::error_measure(it)?,
        adaptive: read::adaptive(it)?,
        cancel: cancel.clone(),
        ..RenderSettings::default()
    })
}

/// What a render came to, for the host.
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
        reserved: 0,
    }
}
