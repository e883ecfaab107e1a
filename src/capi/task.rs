//! Renders: on the calling thread, or as tasks that are polled, awaited and cancelled.

use std::ffi::c_char;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::boundary::{
    Header, Inside, Object, UserData, boundary, catch, give, is_inside, lock, need, object, on, peek, read_sized,
    release, share, take_status, write_sized,
};
use super::device::etd_device;
use super::film::etd_film;
use super::read;
use super::scene::{Progress, etd_scene};
use super::status::{ETD_CANCELLED, ETD_DEVICE, ETD_INVALID_HANDLE, ETD_OK, ETD_RUNNING, Failure, Result, etd_status};
use super::types::{
    ETD_ENDED_CANCELLED, ETD_ENDED_ERROR, ETD_ENDED_SAMPLES, ETD_ENDED_TIME, ETD_LOG_WARNING, ETD_PHASE_BUILD,
    ETD_PHASE_END, ETD_PHASE_RENDER, etd_phase, etd_progress, etd_render_options, etd_summary,
};
use crate::Cancel;
use crate::desc::IntegratorDesc;
use crate::output::summary_attributes;
use crate::render::{Ended, Render, RenderSettings, Summary};

/// Share of the progress that building a scene takes.
const BUILD_SHARE: f64 = 0.1;

/// A film gets a new image in the middle of a pass only when the last one is as old as this.
const IMAGE_INTERVAL: Duration = Duration::from_secs(1);

/// And when making images takes no more than one part in this of the time.
const IMAGE_COST: u32 = 50;

/// A started render.
pub struct etd_task {
    header: Header,
    /// The host's references. The last one that is given back is waited for while the object is still whole: functions
    /// of the host that run meanwhile may use their handle.
    references: AtomicUsize,
    work: Arc<Work>,
}
object!(etd_task, b"EtTa", "task");

/// A render: what it needs, how far it is, and how it ended.
struct Work {
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
    /// What it is known by on the threads that work for it.
    fn address(&self) -> usize {
        std::ptr::from_ref(self).addr()
    }

    fn is_calling_us(&self) -> bool {
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
    fn run(self: &Arc<Self>, resumes: bool) -> Result {
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
            let told: Progress = Some(Arc::new(move |fraction: f64| {
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

    /// Asks the current run to end. One that nobody has begun ends here.
    fn cancel(&self) {
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
    fn wait(&self, limit: Option<Duration>) -> Option<Result> {
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

/// Everything of a render that can be refused before it begins; the film is taken.
///
/// # Safety
/// Handles must be NULL or such objects; `options` as for [`read_sized`].
unsafe fn prepare(
    scene: &Arc<etd_scene>,
    film: *mut etd_film,
    options: *const etd_render_options,
) -> Result<Arc<Work>> {
    // SAFETY: by the contract.
    let (film, options) = unsafe {
        let film = share(film.cast_const())?;
        let options =
            if options.is_null() { read::render_out(&scene.desc().render) } else { read_sized(options, "options")? };
        (film, options)
    };
    if !Arc::ptr_eq(film.device(), &scene.device) {
        return Err(Failure::argument("the film is of another device than the scene"));
    }
    let cancel = Cancel::new();
    let work = Work {
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
    work.settings(&cancel)?.desc.check()?;
    work.film.begin()?;
    Ok(Arc::new(work))
}

fn none_yet(phase: etd_phase) -> etd_progress {
    etd_progress {
        struct_size: size_of::<etd_progress>(),
        fraction: 0.0,
        elapsed: 0.0,
        rays: 0,
        samples_done: 0,
        samples_total: 0,
        phase,
        images: 0,
    }
}

/// Renders a scene to a film and returns when it is done; builds the scene first where it has changed.
///
/// The film must be of the scene's device. `options`: NULL for the scene's own settings. Returns `ETD_CANCELLED` if the progress callback stopped it; the film then
/// holds what was done. Errors: `ETD_INVALID_OPERATION` while the film is being rendered to, and all that
/// `etd_scene_commit` has. The image depends on scene, resolution and options alone, not on threads. Thread-safe: several
/// renders, of one scene too, may run at once, each to a film of its own.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render(
    scene: *mut etd_scene,
    film: *mut etd_film,
    options: *const etd_render_options,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(scene, |scene| {
            let work = prepare(scene, film, options)?;
            work.run(false)
        })
    }
}

/// Begins to render a scene to a film and returns at once; building the scene is part of the task.
///
/// As `etd_render`, on a thread of its own (with a host's executor: as a piece of work of it). On `ETD_OK` `*out_task` is
/// one reference. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render_start(
    scene: *mut etd_scene,
    film: *mut etd_film,
    options: *const etd_render_options,
    out_task: *mut *mut etd_task,
) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(scene, |scene| {
            need(out_task, "out_task")?;
            let work = prepare(scene, film, options)?;
            let header = Header::new::<etd_task>(scene.device.callbacks());
            start(&work, 0, false)?;
            give(Arc::new(etd_task { header, references: AtomicUsize::new(1), work }), out_task);
            Ok(())
        })
    }
}

/// Has a run of the work done somewhere else.
fn start(work: &Arc<Work>, run: u64, resumes: bool) -> Result {
    // What the host has queued and not run must keep nothing alive.
    let own = Arc::downgrade(work);
    let begun = work.scene.device.start(Box::new(move || {
        let Some(own) = own.upgrade() else { return };
        if own.begin(run) {
            let outcome = own.run(resumes);
            own.finish(outcome);
        }
    }));
    match begun {
        Ok(thread) => {
            let mut state = lock(&work.state);
            if let (Some(thread), true) = (thread, state.run == run) {
                state.thread = Some((run, thread));
            }
            Ok(())
        }
        Err(error) => {
            let failure = Failure::new(ETD_DEVICE, format!("no thread could be started for the task: {error}"));
            if work.begin(run) {
                work.film.end(None);
                let mut state = lock(&work.state);
                state.outcome = Some(Err(failure.clone()));
                state.is_over = true;
                drop(state);
                work.ended.notify_all();
            }
            Err(failure)
        }
    }
}

/// How far a task is: `ETD_RUNNING`, or how it ended (`ETD_OK`, `ETD_CANCELLED`, an error whose message is this thread's
/// last then).
///
/// `out_progress`: NULL, or filled. Never waits. Thread-safe.
///
/// # Safety
/// Pointers must be NULL or point to what they say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_poll(task: *mut etd_task, out_progress: *mut etd_progress) -> etd_status {
    let mut running = false;
    // SAFETY: passed on.
    let status = unsafe {
        on(task, |task| {
            let (progress, outcome) = {
                let state = lock(&task.work.state);
                (state.progress, state.outcome.clone())
            };
            if !out_progress.is_null() {
                write_sized(out_progress, "out_progress", progress)?;
            }
            running = outcome.is_none();
            outcome.unwrap_or(Ok(()))
        })
    };
    if running && status == ETD_OK { ETD_RUNNING } else { status }
}

/// Waits until a task has ended, for `seconds` at most (below 0: without a limit), and says as `etd_task_poll` how.
///
/// When it has returned something else than `ETD_RUNNING`, none of the task's functions is called any more.
/// `ETD_INVALID_OPERATION` inside one of these. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_wait(task: *mut etd_task, seconds: f64) -> etd_status {
    let mut running = false;
    // SAFETY: passed on.
    let status = unsafe {
        on(task, |task| {
            if task.work.is_calling_us() {
                return Err(Failure::operation("a function that the task calls cannot wait for the task"));
            }
            if seconds.is_nan() {
                return Err(Failure::argument("seconds is NaN"));
            }
            let limit = (seconds >= 0.0).then(|| Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
            let outcome = task.work.wait(limit);
            running = outcome.is_none();
            outcome.unwrap_or(Ok(()))
        })
    };
    if running && status == ETD_OK { ETD_RUNNING } else { status }
}

/// Asks a task to end soon, in whatever phase it is, and returns at once. It ends with `ETD_CANCELLED`, unless it was done
/// already. One that no thread has begun yet ends here, and its `finished` is called here. Thread-safe, also inside the task's own functions.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_cancel(task: *mut etd_task) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(task, |task| {
            task.work.cancel();
            Ok(())
        })
    }
}

/// Lets a task that was cancelled, or ended by its time limit, go on from where it stopped, with the scene that it began
/// with (as it is now, if it was cancelled before the scene was built) and its time limit anew. It comes to the same image
/// as one that was never interrupted.
///
/// A task that is complete stays so. `ETD_INVALID_OPERATION` while it runs, after an error, and inside its own functions. Another render
/// to the same film in between is not undone: the film then shows this task's image again. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_resume(task: *mut etd_task) -> etd_status {
    // SAFETY: passed on.
    unsafe {
        on(task, |task| {
            let work = &task.work;
            if work.is_calling_us() {
                return Err(Failure::operation("a function that the task calls cannot resume the task"));
            }
            let (run, thread) = {
                // It may have ended and be telling so.
                let is_telling = |state: &mut State| state.outcome.is_some() && !state.is_over;
                let state = work.ended.wait_while(lock(&work.state), is_telling);
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
                work.film.begin()?;
                state.run += 1;
                state.has_begun = false;
                state.before = state.outcome.take();
                state.is_over = false;
                state.cancel = Cancel::new();
                state.progress = none_yet(ETD_PHASE_RENDER);
                (state.run, state.thread.take())
            };
            // Whoever waits for the run before this one has waited long enough.
            work.ended.notify_all();
            if let Some((_, thread)) = thread {
                let _ = thread.join();
            }
            start(work, run, true)
        })
    }
}

/// One more reference to a task. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_retain(task: *mut etd_task) -> etd_status {
    let count = |count: usize| (count > 0).then(|| count + 1);
    // SAFETY: passed on.
    unsafe {
        on(task, |task| {
            let counted = task.references.fetch_update(Ordering::Relaxed, Ordering::Relaxed, count);
            counted.map(|_| ()).map_err(|_| Failure::new(ETD_INVALID_HANDLE, "the task was released"))
        })
    }
}

/// Gives back one reference to a task; NULL is fine. With the last one a task that still runs is cancelled and waited
/// for, so that none of its functions is called afterwards; these may use the handle until then. (Inside one of them it is
/// only cancelled.) Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_release(task: *mut etd_task) {
    if task.is_null() {
        return;
    }
    let mut is_last = false;
    boundary(None, || {
        // SAFETY: passed on.
        let it = unsafe { peek(task) }?;
        let count = |count: usize| count.checked_sub(1);
        let before = it.references.fetch_update(Ordering::AcqRel, Ordering::Relaxed, count);
        is_last = before.map_err(|_| Failure::new(ETD_INVALID_HANDLE, "the task was released"))? == 1;
        if is_last {
            it.work.cancel();
            // The host may free what its functions use after this; inside one of them there is nothing to wait for.
            if !it.work.is_calling_us() {
                it.work.wait(None);
            }
        }
        Ok(())
    });
    if is_last {
        // SAFETY: the last reference of the host stands for the one that `give` handed out.
        unsafe { release(task) }
    }
}

/// The first failure of a call on this task since this was last asked, and forgets it; `ETD_OK` if there was none.
/// `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_status(task: *mut etd_task, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: passed on.
    unsafe { take_status(task, message, capacity) }
}
