//! Building a hierarchy, so that whoever waits for it can be told to stop.

use std::any::Any;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::device::{Building, lock};
use super::scene::{Kept, Scene, SceneInner};
use super::sys;
use super::user::panic_text;
use super::width::PacketWidth;
use crate::{Cancel, Error, ErrorKind, Result};

/// From so many primitives on, the beginning of a build, in which Embree asks nobody whether to go on, may take longer
/// than a cancelled caller should wait: 30 to 50 ms for a million triangles on two threads.
const LONG_BUILD: usize = 100_000;

/// How long a cancelled build is given to notice before its caller leaves it to itself.
const PATIENCE: Duration = Duration::from_millis(4);

/// How often the caller of a long build looks whether it was cancelled.
const LOOK: Duration = Duration::from_millis(1);

type Report<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// Builds the hierarchy of a scene that is complete.
pub(super) fn commit(inner: SceneInner, cancel: &Cancel, progress: Option<Report>) -> Result<Scene> {
    // SAFETY: only the lifetime changes; `Watch::close` below takes the reference away before this function is left.
    let report = progress.map(|report| unsafe { std::mem::transmute::<Report, Report<'static>>(report) });
    let watch = Arc::new(Watch {
        cancel: cancel.clone(),
        state: Mutex::new(State { report, last: None, stop: false, panic: None }),
    });
    let closing = Closing(&watch);
    let primitives: usize = inner.kept.iter().map(Kept::primitives).sum();
    // A device of one thread has none to spare.
    let outcome = if primitives < LONG_BUILD || inner.device.threads() < 2 {
        build(inner, &watch)
    } else {
        build_aside(inner, &watch)
    };
    drop(closing);
    // What the callback did is told rather than what Embree made of it.
    let state = lock(&watch.state);
    if let Some(message) = &state.panic {
        return Err(Error::new(ErrorKind::Internal, format!("the progress callback panicked: {message}")));
    }
    if state.stop {
        return Err(cancelled());
    }
    outcome
}

fn cancelled() -> Error {
    Error::new(ErrorKind::Cancelled, "the build was cancelled")
}

/// Builds on another thread, which is left to itself if it does not hear.
fn build_aside(inner: SceneInner, watch: &Arc<Watch>) -> Result<Scene> {
    let building = Building::new(&inner.device);
    let (sender, receiver) = mpsc::channel();
    let own = Arc::clone(watch);
    std::thread::Builder::new()
        .name("etendue-build".to_owned())
        .spawn(move || {
            // Nobody may be waiting any more; then all of it is given back here.
            let _ = sender.send(build(inner, &own));
            drop(building);
        })
        .map_err(|error| Error::new(ErrorKind::Device, "no thread could be started for a build").because(error))?;
    let mut deaf_since = None;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(outcome) => return outcome,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::new(ErrorKind::Internal, "the building thread panicked"));
            }
            Err(RecvTimeoutError::Timeout) if watch.is_stopped() => {
                let since = *deaf_since.get_or_insert_with(Instant::now);
                if since.elapsed() >= PATIENCE {
                    return Err(cancelled());
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Has Embree build.
fn build(mut inner: SceneInner, watch: &Arc<Watch>) -> Result<Scene> {
    let device = Arc::clone(&inner.device);
    let raw = inner.raw;
    let mut grown = 0;
    device.guarded(&watch.cancel, || {
        let before = device.memory_bytes();
        // SAFETY: the scene is alive and no other thread has it. `watch` lives to the end of this function, and the
        // callback is removed before that. Joining is what makes Embree build within the device's own number of threads.
        // Nobody else ever joins: two who do and a build that fails would both release its exception.
        unsafe {
            let data = Arc::as_ptr(watch).cast_mut().cast();
            sys::rtcSetSceneProgressMonitorFunction(raw, Some(on_progress), data);
            sys::rtcJoinCommitScene(raw);
            sys::rtcSetSceneProgressMonitorFunction(raw, None, std::ptr::null_mut());
        }
        grown = device.memory_bytes().saturating_sub(before);
    })?;
    watch.advance(1.0);
    inner.bvh_bytes = grown;
    inner.mask = inner.features.mask();
    if !inner.features.user && !inner.features.spheres {
        inner.width = PacketWidth::of(device.raw);
    }
    inner.kept.shrink_to_fit();
    Ok(Scene { inner: Arc::new(inner) })
}

/// Who is told how far a build is, and what came of it.
struct Watch {
    cancel: Cancel,
    state: Mutex<State>,
}

struct State {
    /// The caller's function, for as long as the caller is there.
    report: Option<Report<'static>>,
    last: Option<f64>,
    stop: bool,
    panic: Option<String>,
}

impl Watch {
    fn is_stopped(&self) -> bool {
        self.cancel.is_cancelled() || lock(&self.state).stop
    }

    /// Reports `fraction` if it is news; false to stop.
    fn advance(&self, fraction: f64) -> bool {
        let mut state = lock(&self.state);
        state.stop |= self.cancel.is_cancelled();
        if state.stop {
            return false;
        }
        let Some(report) = state.report else { return true };
        let fraction = fraction.clamp(0.0, 1.0);
        if state.last.is_some_and(|last| fraction <= last) {
            return true;
        }
        state.last = Some(fraction);
        match catch_unwind(AssertUnwindSafe(|| report(fraction))) {
            Ok(go_on) => state.stop = !go_on,
            Err(payload) => {
                state.panic = Some(message_of(payload));
                state.stop = true;
            }
        }
        !state.stop
    }
}

fn message_of(payload: Box<dyn Any + Send>) -> String {
    let text = panic_text(&*payload);
    // Dropping a payload may panic in turn; leaking it cannot.
    std::mem::forget(payload);
    text
}

/// Takes the caller's function away, waiting for a call of it that is under way. A build that goes on is to stop.
struct Closing<'w>(&'w Watch);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        let mut state = lock(&self.0.state);
        state.report = None;
        state.stop |= self.0.cancel.is_cancelled();
    }
}

unsafe extern "C" fn on_progress(data: *mut c_void, fraction: f64) -> bool {
    // SAFETY: `data` is the `Watch` of the `build` that is under way.
    let watch = unsafe { &*data.cast_const().cast::<Watch>() };
    // NaN comes from a scene without primitives.
    watch.advance(if fraction.is_nan() { 0.0 } else { fraction })
}
