//! The device: threads, memory and errors of everything built with it.

use std::ffi::{CStr, c_char, c_void};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::{Charge, MemoryBudget, sys};
use crate::{Cancel, Error, ErrorKind, Result};

/// The oldest Embree that will do, in the form of `RTC_VERSION`.
const OLDEST: isize = 40300;

/// How long a build that waits for another one sleeps before it looks whether it was cancelled meanwhile.
const PATIENCE: Duration = Duration::from_millis(2);

/// How a [`Device`] builds scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// Threads that build a scene, the calling one included; 0 means one for each core this process may use.
    pub threads: usize,
    /// Bytes that Embree may hold for all scenes of the device together; a build that needs more fails with
    /// [`ErrorKind::OutOfMemory`]. Vertex and index buffers belong to the caller and are not counted.
    pub memory_limit: Option<usize>,
    /// An allowance that the device shares with others; holds beside `memory_limit`. What Embree takes for the device is
    /// charged to it, and so are vertices, indices and normals of each [`crate::scene::Scene`] built with the device.
    pub budget: Option<MemoryBudget>,
}

/// A handle to Embree. Cloning it is cheap and gives the same device; scenes keep their device alive.
///
/// Threads: a build is done by the calling thread (or, if it is large and there are several, one in its place, so that a
/// cancelled caller need not wait) and by at most `threads - 1` of the process's TBB workers, and the number holds for each
/// device by itself. (Embree's own setting `threads` is one for the whole process: it limits
/// everything else that uses TBB, and the largest of all devices wins. It is left alone here.)
#[derive(Clone)]
pub struct Device {
    pub(super) inner: Arc<DeviceInner>,
}

pub(super) struct DeviceInner {
    pub(super) raw: sys::RTCDevice,
    threads: usize,
    monitor: Box<Monitor>,
    /// Whether somebody creates geometry or builds: one at a time, so that an error can be told to belong to that call.
    turn: Mutex<bool>,
    /// Told when a turn ends.
    turn_ended: Condvar,
    /// Builds on threads of their own.
    builds: Mutex<usize>,
    /// Told when one of these ends.
    build_ended: Condvar,
}

// SAFETY: Embree's device calls are thread-safe ("Embree is thread-safe except where noted"; the exceptions concern one
// scene or one geometry, which `SceneBuilder` owns alone). `Monitor` is shared through atomics and a mutex.
unsafe impl Send for DeviceInner {}
// SAFETY: as for `Send`.
unsafe impl Sync for DeviceInner {}

/// What Embree's callbacks write to.
struct Monitor {
    current: AtomicIsize,
    peak: AtomicIsize,
    limit: isize,
    budget: Option<MemoryBudget>,
    error: Mutex<Option<(sys::RTCError, String)>>,
}

impl Device {
    /// Opens Embree.
    ///
    /// # Errors
    /// [`ErrorKind::Device`] if Embree refuses (an unsupported processor, for one), or if the library found at run time
    /// is older than 4.3, older than the header this crate was built with, or of another major version.
    pub fn new(options: &DeviceOptions) -> Result<Self> {
        let available = std::thread::available_parallelism().map_or(1, |n| n.get());
        let threads = if options.threads == 0 { available } else { options.threads.min(available) };
        // Embree builds in an arena with one slot for each processor, of which `user_threads` are kept for callers and
        // the rest for workers. One caller builds at a time, so all slots but `threads - 1` are kept for callers that
        // never come. Too large a number leaves fewer workers, never more.
        let reserved = processors().max(available) - threads + 1;
        let config = format!("user_threads={reserved},set_affinity=0,start_threads=0\0");
        // SAFETY: the string ends with a NUL and is read during the call only.
        let raw = unsafe { sys::rtcNewDevice(config.as_ptr().cast()) };
        if raw.is_null() {
            // SAFETY: a null device asks for the error of this thread's failed device creation.
            let code = unsafe { sys::rtcGetDeviceError(raw) };
            return Err(Error::new(ErrorKind::Device, format!("Embree does not start: {}", describe(code))));
        }
        let limit = options.memory_limit.map_or(isize::MAX, |bytes| isize::try_from(bytes).unwrap_or(isize::MAX));
        let monitor = Box::new(Monitor {
            current: AtomicIsize::new(0),
            peak: AtomicIsize::new(0),
            limit,
            budget: options.budget.clone(),
            error: Mutex::new(None),
        });
        // From here on dropping `inner` releases the device.
        let inner = DeviceInner {
            raw,
            threads,
            monitor,
            turn: Mutex::new(false),
            turn_ended: Condvar::new(),
            builds: Mutex::new(0),
            build_ended: Condvar::new(),
        };
        // SAFETY: `raw` is a device.
        let version = unsafe { sys::rtcGetDeviceProperty(raw, sys::RTC_DEVICE_PROPERTY_VERSION) } as isize;
        check_version(version, sys::RTC_VERSION as isize)?;
        let data = (&raw const *inner.monitor).cast_mut().cast::<c_void>();
        // SAFETY: `data` points into the box that `DeviceInner` owns, which outlives the device: every scene holds an
        // `Arc<DeviceInner>`, and `DeviceInner::drop` removes both callbacks before it releases its reference.
        unsafe {
            sys::rtcSetDeviceErrorFunction(raw, Some(on_error), data);
            sys::rtcSetDeviceMemoryMonitorFunction(raw, Some(on_memory), data);
        }
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Embree's version as the library found at run time says it: major, minor, patch.
    pub fn version(&self) -> [u32; 3] {
        // SAFETY: `raw` is a device as long as `inner` is there.
        let version = unsafe { sys::rtcGetDeviceProperty(self.inner.raw, sys::RTC_DEVICE_PROPERTY_VERSION) } as u32;
        [version / 10_000, version / 100 % 100, version % 100]
    }

    /// Threads that build a scene.
    pub fn threads(&self) -> usize {
        self.inner.threads
    }

    /// Waits until no cancelled build goes on by itself any more: a few tens of milliseconds at most for each million
    /// primitives. For whoever must know that no thread of the device is left.
    pub fn wait_idle(&self) {
        let mut builds = lock(&self.inner.builds);
        while *builds > 0 {
            builds = self.inner.build_ended.wait(builds).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Bytes Embree holds for the scenes of this device now.
    pub fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes()
    }

    /// The allowance it shares with others, where it was given one.
    pub fn budget(&self) -> Option<&MemoryBudget> {
        self.inner.monitor.budget.as_ref()
    }

    /// Charges bytes that geometry of a scene takes to the shared allowance.
    pub(crate) fn charge(&self, bytes: usize) -> Result<Option<Charge>> {
        self.budget().map(|budget| budget.try_charge(bytes)).transpose()
    }

    /// The most bytes Embree ever held for this device.
    pub fn peak_memory_bytes(&self) -> usize {
        usize::try_from(self.inner.monitor.peak.load(Ordering::Relaxed)).unwrap_or(0)
    }
}

/// A build on a thread of its own, counted until it is dropped.
pub(super) struct Building(Arc<DeviceInner>);

impl Building {
    pub(super) fn new(device: &Arc<DeviceInner>) -> Self {
        *lock(&device.builds) += 1;
        Self(Arc::clone(device))
    }
}

impl Drop for Building {
    fn drop(&mut self) {
        *lock(&self.0.builds) -= 1;
        self.0.build_ended.notify_all();
    }
}

impl DeviceInner {
    pub(super) fn threads(&self) -> usize {
        self.threads
    }

    pub(super) fn memory_bytes(&self) -> usize {
        usize::try_from(self.monitor.current.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// Waits for a turn, and no longer once it was cancelled.
    fn turn(&self, cancel: &Cancel) -> Result<Turn<'_>> {
        let mut taken = lock(&self.turn);
        while *taken {
            cancel.check()?;
            taken = self.turn_ended.wait_timeout(taken, PATIENCE).unwrap_or_else(PoisonError::into_inner).0;
        }
        *taken = true;
        Ok(Turn(self))
    }

    /// Runs calls that may fail inside Embree and turns its error, if there is one, into ours. `cancel` ends the wait for
    /// others that do the same, with [`ErrorKind::Cancelled`].
    pub(super) fn guarded<R>(&self, cancel: &Cancel, calls: impl FnOnce() -> R) -> Result<R> {
        let _turn = self.turn(cancel)?;
        *lock(&self.monitor.error) = None;
        let value = calls();
        // The callback has the message; this thread's own slot is emptied so that it cannot be read later by mistake.
        // SAFETY: `raw` is a device for as long as `self` lives.
        let code = unsafe { sys::rtcGetDeviceError(self.raw) };
        let told = lock(&self.monitor.error).take();
        match told {
            Some((code, message)) => Err(to_error(code, &message)),
            None if code != sys::RTC_ERROR_NONE => Err(to_error(code, "")),
            None => Ok(value),
        }
    }
}

/// The right to create geometry or build, until dropped.
struct Turn<'a>(&'a DeviceInner);

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        *lock(&self.0.turn) = false;
        self.0.turn_ended.notify_one();
    }
}

impl Drop for DeviceInner {
    fn drop(&mut self) {
        // SAFETY: `raw` is a device, this is its last use, and no scene is left (each holds an `Arc` of `self`).
        unsafe {
            sys::rtcSetDeviceErrorFunction(self.raw, None, std::ptr::null_mut());
            sys::rtcSetDeviceMemoryMonitorFunction(self.raw, None, std::ptr::null_mut());
            sys::rtcReleaseDevice(self.raw);
        }
        // What Embree keeps to the end of the device it gives back unseen.
        if let Some(budget) = &self.monitor.budget {
            budget.give_back(self.memory_bytes());
        }
    }
}

/// Processors this process may run on, not counting limits on processor time, which TBB does not know of.
fn processors() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed:")).unwrap_or_default();
    mask.chars().filter_map(|digit| digit.to_digit(16)).map(|bits| bits.count_ones() as usize).sum()
}

/// A lock that a panic elsewhere does not spoil: what it guards is replaced as a whole.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether the library found at run time goes with the header; both in the form of `RTC_VERSION`.
fn check_version(library: isize, header: isize) -> Result<()> {
    let show = |version: isize| format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100);
    let fits = library >= OLDEST && library / 10_000 == header / 10_000 && library / 100 >= header / 100;
    if fits {
        return Ok(());
    }
    Err(Error::new(
        ErrorKind::Device,
        format!("Embree {} was found, but this program was built for {} or a later 4.x", show(library), show(header)),
    ))
}

fn describe(code: sys::RTCError) -> &'static str {
    match code {
        sys::RTC_ERROR_NONE => "no error",
        sys::RTC_ERROR_INVALID_ARGUMENT => "invalid argument",
        sys::RTC_ERROR_INVALID_OPERATION => "invalid operation",
        sys::RTC_ERROR_OUT_OF_MEMORY => "out of memory",
        sys::RTC_ERROR_UNSUPPORTED_CPU => "this processor is not supported",
        sys::RTC_ERROR_CANCELLED => "cancelled",
        _ => "unknown error",
    }
}

fn to_error(code: sys::RTCError, message: &str) -> Error {
    let kind = match code {
        sys::RTC_ERROR_OUT_OF_MEMORY => ErrorKind::OutOfMemory,
        sys::RTC_ERROR_CANCELLED => ErrorKind::Cancelled,
        _ => ErrorKind::Device,
    };
    let text = match (kind, message) {
        (ErrorKind::OutOfMemory, _) => {
            "Embree ran out of memory, or past the limit that was set, while building".into()
        }
        (ErrorKind::Cancelled, _) => "the build was cancelled".into(),
        (_, "") => format!("Embree: {}", describe(code)),
        _ => format!("Embree: {} ({message})", describe(code)),
    };
    Error::new(kind, text)
}

unsafe extern "C" fn on_error(data: *mut c_void, code: sys::RTCError, message: *const c_char) {
    // SAFETY: `data` is the `Monitor` set in `Device::new`, which outlives the device.
    let monitor = unsafe { &*data.cast_const().cast::<Monitor>() };
    let text = if message.is_null() {
        String::new()
    } else {
        // SAFETY: Embree passes a NUL-terminated string that lives during the call.
        unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned()
    };
    // The first error is the cause, later ones follow from it.
    lock(&monitor.error).get_or_insert((code, text));
}

unsafe extern "C" fn on_memory(data: *mut c_void, bytes: isize, post: bool) -> bool {
    // SAFETY: as in `on_error`.
    let monitor = unsafe { &*data.cast_const().cast::<Monitor>() };
    let now = monitor.current.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
    let amount = bytes.unsigned_abs();
    let allowed = match &monitor.budget {
        // Its own limit first: what that refuses is not taken from the others.
        _ if bytes > 0 && now > monitor.limit && !post => false,
        None => bytes <= 0 || now <= monitor.limit,
        Some(budget) if bytes < 0 => {
            budget.give_back(amount);
            true
        }
        Some(budget) if post => budget.take_anyway(amount) && now <= monitor.limit,
        Some(budget) => budget.take(amount),
    };
    if !allowed {
        // A refusal beforehand means the memory is never taken, so it is never given back either.
        if !post {
            monitor.current.fetch_sub(bytes, Ordering::Relaxed);
        }
        return false;
    }
    monitor.peak.fetch_max(now, Ordering::Relaxed);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_that_go_together() {
        for (library, header, fits) in [
            (40303, 40303, true),
            (40400, 40303, true),
            (40300, 40303, true),
            (40203, 40200, false),
            (40303, 40400, false),
            (50000, 40303, false),
            (31300, 40303, false),
        ] {
            assert_eq!(check_version(library, header).is_ok(), fits, "library {library}, header {header}");
        }
    }
}
