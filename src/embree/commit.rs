//! Builds a hierarchy in such a way that a caller who waits for it can be cancelled.

use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::device::{DetachedBuild, lock};
use super::scene::{Features, GeometryData, Scene, SceneInner};
use super::sys;
use super::user::panic_text;
use super::width::PacketWidth;
use crate::room::check_room;
use crate::{Cancel, Error, ErrorKind, Result};

/// Builds with at least this many primitives run on another thread. Embree does not call the progress monitor at the
/// beginning of a build, which may take longer than a cancelled caller should wait: 30 to 50 ms for a million triangles
/// on two threads.
const LONG_BUILD: usize = 100_000;

/// Time that a cancelled build has to stop before its caller returns without it.
const CANCEL_GRACE: Duration = Duration::from_millis(4);

/// Interval at which the caller of a long build checks for cancellation.
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// Memory that a build takes at least for each primitive.
const BYTES_A_PRIMITIVE: usize = 64;

/// Memory for Embree's tasks. Where they begin without any, TBB waits for ever instead of failing.
const BYTES_OF_TASKS: usize = 4 << 20;

/// The same for each of its threads: a stack, and what an allocator keeps for a thread.
const BYTES_OF_A_THREAD: usize = 32 << 20;

type ProgressCallback<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// Builds the hierarchy of a scene that is complete.
pub(super) fn commit(inner: SceneInner, cancel: &Cancel, progress: Option<ProgressCallback>) -> Result<Scene> {
    // SAFETY: only the lifetime changes; `BuildMonitor::close` below takes the reference away before this function is
    // left.
    let callback = progress
        .map(|callback| unsafe { std::mem::transmute::<ProgressCallback, ProgressCallback<'static>>(callback) });
    let monitor = Arc::new(BuildMonitor {
        cancel: cancel.clone(),
        progress_state: Mutex::new(ProgressState { callback, last: None, stop: false, panic: None }),
    });
    let detach = DetachCallback(&monitor);
    let primitives: usize = inner.data.iter().map(GeometryData::primitives).sum();
    // A device with one thread has no other thread for the build.
    let outcome = if primitives < LONG_BUILD || inner.device.threads() < 2 {
        build(inner, &monitor)
    } else {
        build_on_thread(inner, &monitor)
    };
    drop(detach);
    // Errors of the callback take precedence over the error that Embree reports because of them.
    let progress_state = lock(&monitor.progress_state);
    if let Some(message) = &progress_state.panic {
        return Err(Error::new(ErrorKind::Internal, format!("the progress callback panicked: {message}")));
    }
    if progress_state.stop {
        return Err(cancelled());
    }
    outcome
}

fn cancelled() -> Error {
    Error::new(ErrorKind::Cancelled, "the build was cancelled")
}

/// Builds on another thread, which is detached if it does not stop in time after a cancellation.
fn build_on_thread(inner: SceneInner, monitor: &Arc<BuildMonitor>) -> Result<Scene> {
    let running = DetachedBuild::new(&inner.device);
    let (sender, receiver) = mpsc::channel();
    let own = Arc::clone(monitor);
    std::thread::Builder::new()
        .name("etendue-build".to_owned())
        .spawn(move || {
            // If the caller has already returned, the scene is released here.
            let _ = sender.send(build(inner, &own));
            drop(running);
        })
        .map_err(|error| Error::new(ErrorKind::Device, "no thread could be started for a build").because(error))?;
    let mut cancelled_since = None;
    loop {
        match receiver.recv_timeout(POLL_INTERVAL) {
            Ok(outcome) => return outcome,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::new(ErrorKind::Internal, "the building thread panicked"));
            }
            Err(RecvTimeoutError::Timeout) if monitor.is_stopped() => {
                let since = *cancelled_since.get_or_insert_with(Instant::now);
                if since.elapsed() >= CANCEL_GRACE {
                    return Err(cancelled());
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Runs Embree's build.
fn build(mut inner: SceneInner, monitor: &Arc<BuildMonitor>) -> Result<Scene> {
    let device = Arc::clone(&inner.device);
    let raw = inner.raw;
    let mut bvh_bytes = 0;
    let primitives: usize = inner.data.iter().map(GeometryData::primitives).sum();
    let of_threads = BYTES_OF_A_THREAD.saturating_mul(device.threads() - 1).saturating_add(BYTES_OF_TASKS);
    check_room(BYTES_A_PRIMITIVE.saturating_mul(primitives).saturating_add(of_threads))?;
    device.guarded(&monitor.cancel, || {
        let before = device.memory_bytes();
        // SAFETY: the scene is alive and no other thread has it. `monitor` lives to the end of this function, and the
        // callback is removed before that. Joining is what makes Embree build within the device's own number of
        // threads. No other thread ever joins: if two threads joined and the build failed, both would release its exception.
        unsafe {
            let data = Arc::as_ptr(monitor).cast_mut().cast();
            sys::rtcSetSceneProgressMonitorFunction(raw, Some(on_progress), data);
            sys::rtcJoinCommitScene(raw);
            sys::rtcSetSceneProgressMonitorFunction(raw, None, std::ptr::null_mut());
        }
        bvh_bytes = device.memory_bytes().saturating_sub(before);
    })?;
    monitor.advance(1.0);
    inner.bvh_bytes = bvh_bytes;
    inner.mask = inner.features.mask();
    // In packets Embree inverts the transforms of moving instances by other operations than for single rays, so that
    // answers would differ in their last bits.
    let Features { spheres, user, instances, motion, .. } = inner.features;
    if !(user || spheres || instances && motion) {
        inner.width = PacketWidth::of(device.raw);
    }
    inner.data.shrink_to_fit();
    Ok(Scene { inner: Arc::new(inner) })
}

/// Cancellation and progress callback of a build, and their outcome.
struct BuildMonitor {
    cancel: Cancel,
    progress_state: Mutex<ProgressState>,
}

struct ProgressState {
    /// The caller's callback, which is present as long as the caller waits.
    callback: Option<ProgressCallback<'static>>,
    last: Option<f64>,
    stop: bool,
    panic: Option<String>,
}

impl BuildMonitor {
    fn is_stopped(&self) -> bool {
        self.cancel.is_cancelled() || lock(&self.progress_state).stop
    }

    /// Reports `fraction` if it is larger than the last one; returns false if the build must stop.
    fn advance(&self, fraction: f64) -> bool {
        let mut progress_state = lock(&self.progress_state);
        progress_state.stop |= self.cancel.is_cancelled();
        if progress_state.stop {
            return false;
        }
        let Some(callback) = progress_state.callback else { return true };
        let fraction = fraction.clamp(0.0, 1.0);
        if progress_state.last.is_some_and(|last| fraction <= last) {
            return true;
        }
        progress_state.last = Some(fraction);
        match catch_unwind(AssertUnwindSafe(|| callback(fraction))) {
            Ok(go_on) => progress_state.stop = !go_on,
            Err(payload) => {
                progress_state.panic = Some(message_of(payload));
                progress_state.stop = true;
            }
        }
        !progress_state.stop
    }
}

fn message_of(payload: Box<dyn Any + Send>) -> String {
    let text = panic_text(&*payload);
    // Dropping a payload may panic in turn; leaking it cannot.
    std::mem::forget(payload);
    text
}

/// Detaches the caller's callback when dropped, after any call of it has ended, and stops a cancelled build.
struct DetachCallback<'w>(&'w BuildMonitor);

impl Drop for DetachCallback<'_> {
    fn drop(&mut self) {
        let mut progress_state = lock(&self.0.progress_state);
        progress_state.callback = None;
        progress_state.stop |= self.0.cancel.is_cancelled();
    }
}

unsafe extern "C" fn on_progress(data: *mut c_void, fraction: f64) -> bool {
    // SAFETY: `data` is the `BuildMonitor` of the `build` that is under way.
    let monitor = unsafe { &*data.cast_const().cast::<BuildMonitor>() };
    // NaN comes from a scene without primitives.
    monitor.advance(if fraction.is_nan() { 0.0 } else { fraction })
}
