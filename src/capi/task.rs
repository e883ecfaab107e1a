//! Renders: on the calling thread, or as tasks that are polled, awaited and cancelled.

use std::ffi::c_char;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::boundary::{Header, Object, boundary, give, need, object, on, peek, release, take_status, write_sized};
use super::film::etd_film;
use super::scene::etd_scene;
use super::status::{ETD_INVALID_HANDLE, ETD_OK, ETD_RUNNING, Failure, etd_status};
use super::types::{etd_progress, etd_render_options};
use super::work::Work;

/// A started render.
pub struct etd_task {
    header: Header,
    /// The host's references. The last one that is given back is waited for while the object is still whole: functions
    /// of the host that run meanwhile may use their handle.
    references: AtomicUsize,
    work: Arc<Work>,
}
object!(etd_task, b"EtTa", "task");

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
            let work = Work::prepare(scene, film, options)?;
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
            let work = Work::prepare(scene, film, options)?;
            let header = Header::new::<etd_task>(scene.device.callbacks());
            work.start(0, false)?;
            give(Arc::new(etd_task { header, references: AtomicUsize::new(1), work }), out_task);
            Ok(())
        })
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
            let (progress, outcome) = task.work.so_far();
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
            if task.work.is_calling_us() {
                return Err(Failure::operation("a function that the task calls cannot resume the task"));
            }
            task.work.resume()
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
