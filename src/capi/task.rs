//! Calls that render: on the calling thread, or as tasks that hosts poll, wait for and cancel.

use std::ffi::c_char;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::boundary::{Header, Object, boundary, give, need, object, on, peek, release, take_status, write_sized};
use super::film::etd_film;
use super::scene::etd_scene;
use super::status::{ETD_INVALID_HANDLE, ETD_OK, ETD_RUNNING, Failure, Result, etd_status};
use super::types::{etd_progress, etd_render_options};
use super::work::{End, RenderWork};

/// A started render.
pub struct etd_task {
    header: Header,
    /// Number of the host's references. The release of the last one waits for the end of the task while the object still
    /// exists, since functions of the host that run meanwhile may use the handle.
    references: AtomicUsize,
    work: Arc<RenderWork>,
}
object!(etd_task, b"EtTa", "task");

/// Renders a scene to a film and returns when the render has ended. A scene that has changed is built first.
///
/// The film must be of the scene's device. `options`: NULL for the scene's own settings. If the progress callback stops the
/// render, the call returns `ETD_CANCELLED`, and the film holds the samples that were taken. Errors: `ETD_INVALID_OPERATION`
/// while another render uses the film, and the errors of `etd_scene_commit`. The image depends only on the scene, the
/// resolution and the options, and not on threads. Thread-safe: several renders, also of one scene, may run at the same time,
/// each to a film of its own.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render(
    scene: *mut etd_scene,
    film: *mut etd_film,
    options: *const etd_render_options,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let work = RenderWork::prepare(scene, film, options)?;
            work.run(false)
        })
    }
}

/// Starts a task that renders a scene to a film, and returns at once. The task builds the scene first if it has changed.
///
/// The task does what `etd_render` does, on a thread of its own, or on the host's executor where the device has one. On
/// `ETD_OK`, `*out_task` is one reference. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_render_start(
    scene: *mut etd_scene,
    film: *mut etd_film,
    options: *const etd_render_options,
    out_task: *mut *mut etd_task,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_task, "out_task")?;
            let work = RenderWork::prepare(scene, film, options)?;
            let header = Header::new::<etd_task>(scene.device.callbacks());
            work.start(0, false)?;
            give(Arc::new(etd_task { header, references: AtomicUsize::new(1), work }), out_task);
            Ok(())
        })
    }
}

/// Returns the state of a task: `ETD_RUNNING`, or how the task ended, which is `ETD_OK`, `ETD_CANCELLED` or an error. The
/// message of an error becomes this thread's last one. The device's `error` function and `etd_task_status` hear of it from the first
/// call that returns it.
///
/// `out_progress`: receives the progress, unless it is NULL. The call never waits. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_poll(task: *mut etd_task, out_progress: *mut etd_progress) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on_outcome(task, |task| {
            let (progress, end) = task.work.progress_and_end();
            if !out_progress.is_null() {
                write_sized(out_progress, "out_progress", progress)?;
            }
            Ok(end)
        })
    }
}

/// Waits until a task has ended, for `seconds` at most (below 0: without a limit), and returns the same as `etd_task_poll`.
///
/// Once this call has returned anything but `ETD_RUNNING`, the task calls none of its callbacks any more. Inside one of these
/// callbacks, the call returns `ETD_INVALID_OPERATION`. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_wait(task: *mut etd_task, seconds: f64) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on_outcome(task, |task| {
            if task.work.is_active_here() {
                return Err(Failure::operation("a function that the task calls cannot wait for the task"));
            }
            if seconds.is_nan() {
                return Err(Failure::argument("seconds is NaN"));
            }
            let limit = (seconds >= 0.0).then(|| Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
            Ok(task.work.wait(limit))
        })
    }
}

/// Runs a call that says how a task ended, as `ask` finds out; `None` while it runs. The task and the host's `error` function hear once
/// for each run that it failed. Later calls make the failure their thread's last error and no more.
///
/// # Safety
/// `task` must be NULL or a task.
unsafe fn on_outcome(task: *const etd_task, ask: impl FnOnce(&Arc<etd_task>) -> Result<Option<End>>) -> etd_status {
    let (mut is_running, mut known) = (false, None);
    // SAFETY: the caller keeps this function's contract.
    let status = unsafe {
        on(task, |task| match ask(task)? {
            None => {
                is_running = true;
                Ok(())
            }
            Some(End { run, outcome: Err(failure) }) if !task.work.is_news(run) => {
                known = Some(failure);
                Ok(())
            }
            Some(End { outcome, .. }) => outcome,
        })
    };
    match known {
        Some(failure) => boundary(None, || Err(failure)),
        None if is_running && status == ETD_OK => ETD_RUNNING,
        None => status,
    }
}

/// Asks a task to end soon, in any phase, and returns at once. The task ends with `ETD_CANCELLED`, unless it has already
/// ended. A task that no thread has begun yet ends during this call, which then calls `finished`. Thread-safe, also inside the
/// task's callbacks.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_cancel(task: *mut etd_task) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(task, |task| {
            task.work.cancel();
            Ok(())
        })
    }
}

/// Resumes a task that was cancelled or that its time limit has ended. The result is the same image as without an
/// interruption.
///
/// The task continues with the scene that it began with. If the task was cancelled before that scene was built, it continues
/// with the scene as described now. The time limit begins anew. For a complete task, the call does nothing. It returns
/// `ETD_INVALID_OPERATION` while the task runs, after an error, and inside the task's callbacks. If another render has used
/// the film meanwhile, the film shows the image of this task again; a film that was resized meanwhile is `ETD_INVALID_OPERATION`. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_resume(task: *mut etd_task) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(task, |task| {
            if task.work.is_active_here() {
                return Err(Failure::operation("a function that the task calls cannot resume the task"));
            }
            task.work.resume()
        })
    }
}

/// Adds a reference to a task. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_retain(task: *mut etd_task) -> etd_status {
    let count = |count: usize| (count > 0).then(|| count + 1);
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(task, |task| {
            let counted = task.references.fetch_update(Ordering::Relaxed, Ordering::Relaxed, count);
            counted.map(|_| ()).map_err(|_| Failure::new(ETD_INVALID_HANDLE, "the task was released"))
        })
    }
}

/// Releases a reference to a task; NULL is allowed. The release of the last reference cancels a task that still runs and waits
/// for its end. The task's callbacks may use the handle until then, and are not called afterwards. Inside one of these
/// callbacks, the call cancels the task without waiting. Thread-safe.
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
        // SAFETY: the caller keeps this function's contract.
        let it = unsafe { peek(task) }?;
        let count = |count: usize| count.checked_sub(1);
        let before = it.references.fetch_update(Ordering::AcqRel, Ordering::Relaxed, count);
        is_last = before.map_err(|_| Failure::new(ETD_INVALID_HANDLE, "the task was released"))? == 1;
        if is_last {
            it.work.cancel();
            // After this call, the host may free the data of its callbacks. A callback of the task cannot wait for its own end.
            if !it.work.is_active_here() {
                it.work.wait(None);
            }
        }
        Ok(())
    });
    if is_last {
        // SAFETY: all references of the host together own the one reference that `give` handed out.
        unsafe { release(task) }
    }
}

/// Takes the first failure of a call on this task since the last time that it was taken: returns its status, or `ETD_OK` if
/// there was none, and forgets the failure.
/// `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
///
/// # Safety
/// `task` must be NULL or a task, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_task_status(task: *mut etd_task, message: *mut c_char, capacity: usize) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { take_status(task, message, capacity) }
}
