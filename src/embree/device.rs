//! The device: threads, memory and errors of all scenes built with it.

use std::ffi::{CStr, c_char, c_void};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::{Charge, MemoryBudget, sys};
use crate::room::check_room;
use crate::{Cancel, Error, ErrorKind, Result};

/// The oldest supported Embree, in the form of `RTC_VERSION`.
const MIN_VERSION: isize = 40300;

/// Interval at which a build that waits for another one checks for cancellation.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Options of a [`Device`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// Threads that build a scene, the calling one included; 0 means one for each core this process may use.
    pub threads: usize,
    /// Bytes that Embree may hold for all scenes of the device together; a build that needs more fails with
    /// [`ErrorKind::OutOfMemory`]. Vertex and index buffers belong to the caller and are not counted.
    pub memory_limit: Option<usize>,
    /// A memory allowance that the device shares with others; it holds in addition to `memory_limit`. Memory that
    /// Embree takes for the device is charged to it, and so are vertices, indices and normals of each
    /// [`crate::scene::Scene`] built with the device.
    pub budget: Option<MemoryBudget>,
}

/// A handle to Embree. Cloning it is cheap and gives the same device; scenes keep their device alive.
///
/// Threads: a build runs on the calling thread and on at most `threads - 1` of the process's TBB workers; this number
/// holds for each device separately. A large build of a device with several threads runs on another thread in place of
/// the calling one, so that a cancelled caller need not wait. (Embree's own setting `threads` applies to the whole
/// process: it limits all other users of TBB, and the largest of all devices wins. It is not set here.)
#[derive(Clone)]
pub struct Device {
    pub(super) inner: Arc<DeviceInner>,
}

pub(super) struct DeviceInner {
    pub(super) raw: sys::RTCDevice,
    threads: usize,
    monitor: Box<DeviceMonitor>,
    /// Whether a thread creates geometry or builds. Only one does at a time, so that an error can be attributed to its
    /// call.
    is_busy: Mutex<bool>,
    /// Notified when that thread has finished.
    access_released: Condvar,
    /// Number of builds on threads of their own.
    detached_builds: Mutex<usize>,
    /// Notified when one of these builds ends.
    detached_build_ended: Condvar,
}

// SAFETY: Embree's device calls are thread-safe ("Embree is thread-safe except where noted"; the exceptions concern one
// scene or one geometry, which `SceneBuilder` owns alone). `DeviceMonitor` is shared through atomics and a mutex.
unsafe impl Send for DeviceInner {}
// SAFETY: as for `Send`.
unsafe impl Sync for DeviceInner {}

/// Data that Embree's callbacks write to.
struct DeviceMonitor {
    current: AtomicIsize,
    peak: AtomicIsize,
    limit: isize,
    budget: Option<MemoryBudget>,
    error: Mutex<Option<(sys::RTCError, String)>>,
}

impl DeviceInner {
    /// Version of the Embree library found at run time: major, minor, patch.
    pub(super) fn version(&self) -> [u32; 3] {
        // SAFETY: `raw` is a device as long as `self` is there.
        let version = unsafe { sys::rtcGetDeviceProperty(self.raw, sys::RTC_DEVICE_PROPERTY_VERSION) } as u32;
        [version / 10_000, version / 100 % 100, version % 100]
    }
}

/// The widest instructions of this processor among those that Embree has code for, by which it chooses. The last bits of hits depend on
/// them.
pub(crate) fn instruction_set() -> &'static CStr {
    #[cfg(target_arch = "x86_64")]
    {
        let has_avx512 = std::is_x86_feature_detected!("avx512f")
            && std::is_x86_feature_detected!("avx512dq")
            && std::is_x86_feature_detected!("avx512cd")
            && std::is_x86_feature_detected!("avx512bw")
            && std::is_x86_feature_detected!("avx512vl");
        let has_avx2 = std::is_x86_feature_detected!("avx2")
            && std::is_x86_feature_detected!("fma")
            && std::is_x86_feature_detected!("bmi1")
            && std::is_x86_feature_detected!("bmi2")
            && std::is_x86_feature_detected!("lzcnt");
        if has_avx512 {
            c"AVX-512"
        } else if has_avx2 {
            c"AVX2"
        } else if std::is_x86_feature_detected!("avx") {
            c"AVX"
        } else if std::is_x86_feature_detected!("sse4.2") {
            c"SSE4.2"
        } else {
            c"SSE2"
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        c"its instructions"
    }
}

impl Device {
    /// Opens Embree.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`]; [`ErrorKind::Device`] if Embree refuses (an unsupported processor, for one), or if the library found at run time
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
            // SAFETY: with a null device, Embree returns the error of this thread's failed device creation.
            let code = unsafe { sys::rtcGetDeviceError(raw) };
            let kind = if code == sys::RTC_ERROR_OUT_OF_MEMORY { ErrorKind::OutOfMemory } else { ErrorKind::Device };
            return Err(Error::new(kind, format!("Embree does not start: {}", describe(code))));
        }
        let limit = options.memory_limit.map_or(isize::MAX, |bytes| isize::try_from(bytes).unwrap_or(isize::MAX));
        let monitor = Box::new(DeviceMonitor {
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
            is_busy: Mutex::new(false),
            access_released: Condvar::new(),
            detached_builds: Mutex::new(0),
            detached_build_ended: Condvar::new(),
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

    /// Version of the Embree library found at run time: major, minor, patch.
    pub fn version(&self) -> [u32; 3] {
        self.inner.version()
    }

    /// Threads that build a scene.
    pub fn threads(&self) -> usize {
        self.inner.threads
    }

    /// Waits until no cancelled build is running any more: a few tens of milliseconds at most for each million
    /// primitives. Callers need it where no thread of the device may be left.
    pub fn wait_idle(&self) {
        let mut detached_builds = lock(&self.inner.detached_builds);
        while *detached_builds > 0 {
            detached_builds =
                self.inner.detached_build_ended.wait(detached_builds).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Bytes Embree holds for the scenes of this device now.
    pub fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes()
    }

    /// The allowance that the device shares with others, if it has one.
    pub fn budget(&self) -> Option<&MemoryBudget> {
        self.inner.monitor.budget.as_ref()
    }

    /// Charges bytes of a scene's geometry to the shared allowance, and fails where the process cannot have as many.
    pub(crate) fn charge(&self, bytes: usize) -> Result<Option<Charge>> {
        let charge = self.budget().map(|budget| budget.try_charge(bytes)).transpose()?;
        check_room(bytes)?;
        Ok(charge)
    }

    /// The most bytes that Embree ever held for this device.
    pub fn peak_memory_bytes(&self) -> usize {
        usize::try_from(self.inner.monitor.peak.load(Ordering::Relaxed)).unwrap_or(0)
    }
}

/// A build on a thread of its own, which is counted until this is dropped.
pub(super) struct DetachedBuild(Arc<DeviceInner>);

impl DetachedBuild {
    pub(super) fn new(device: &Arc<DeviceInner>) -> Self {
        *lock(&device.detached_builds) += 1;
        Self(Arc::clone(device))
    }
}

impl Drop for DetachedBuild {
    fn drop(&mut self) {
        *lock(&self.0.detached_builds) -= 1;
        self.0.detached_build_ended.notify_all();
    }
}

impl DeviceInner {
    pub(super) fn threads(&self) -> usize {
        self.threads
    }

    pub(super) fn memory_bytes(&self) -> usize {
        usize::try_from(self.monitor.current.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// Waits for exclusive access to the device; ends with an error if cancelled.
    fn exclusive_access(&self, cancel: &Cancel) -> Result<ExclusiveAccess<'_>> {
        let mut taken = lock(&self.is_busy);
        while *taken {
            cancel.check()?;
            taken = self.access_released.wait_timeout(taken, POLL_INTERVAL).unwrap_or_else(PoisonError::into_inner).0;
        }
        *taken = true;
        Ok(ExclusiveAccess(self))
    }

    /// Runs Embree calls that may fail and converts Embree's error, if there is one. `cancel` ends the wait for other
    /// threads that do the same, with [`ErrorKind::Cancelled`].
    pub(super) fn guarded<R>(&self, cancel: &Cancel, calls: impl FnOnce() -> R) -> Result<R> {
        let _access = self.exclusive_access(cancel)?;
        *lock(&self.monitor.error) = None;
        let value = calls();
        // The callback has stored the message; the thread's own error slot is cleared so that it is not read later by
        // mistake.
        // SAFETY: the device is alive as long as `self`.
        let code = unsafe { sys::rtcGetDeviceError(self.raw) };
        let error = lock(&self.monitor.error).take();
        match error {
            Some((code, message)) => Err(to_error(code, &message)),
            None if code != sys::RTC_ERROR_NONE => Err(to_error(code, "")),
            None => Ok(value),
        }
    }
}

/// Exclusive access for creating geometry and building, until dropped.
struct ExclusiveAccess<'a>(&'a DeviceInner);

impl Drop for ExclusiveAccess<'_> {
    fn drop(&mut self) {
        *lock(&self.0.is_busy) = false;
        self.0.access_released.notify_one();
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
        // Embree releases the rest of its memory without calling the monitor.
        if let Some(budget) = &self.monitor.budget {
            budget.release(self.memory_bytes());
        }
    }
}

/// Processors this process may run on, not counting limits on processor time, which TBB does not know of.
fn processors() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed:")).unwrap_or_default();
    mask.chars().filter_map(|digit| digit.to_digit(16)).map(|bits| bits.count_ones() as usize).sum()
}

/// Locks a mutex even if a thread panicked while it held the lock: the guarded value is only replaced as a whole.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether the library found at run time is compatible with the header; both versions in the form of `RTC_VERSION`.
fn check_version(library: isize, header: isize) -> Result<()> {
    let show = |version: isize| format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100);
    let fits = library >= MIN_VERSION && library / 10_000 == header / 10_000 && library / 100 >= header / 100;
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
    // SAFETY: `data` is the `DeviceMonitor` set in `Device::new`, which outlives the device.
    let monitor = unsafe { &*data.cast_const().cast::<DeviceMonitor>() };
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
    let monitor = unsafe { &*data.cast_const().cast::<DeviceMonitor>() };
    let now = monitor.current.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
    let amount = bytes.unsigned_abs();
    let allowed = match &monitor.budget {
        // The device's own limit is checked first, so that a refused request is not taken from the shared allowance.
        _ if bytes > 0 && now > monitor.limit && !post => false,
        None => bytes <= 0 || now <= monitor.limit,
        Some(budget) if bytes < 0 => {
            budget.release(amount);
            true
        }
        Some(budget) if post => budget.force_take(amount) && now <= monitor.limit,
        Some(budget) => budget.try_take(amount),
    };
    if !allowed {
        // Memory that is refused beforehand is never allocated, so Embree never reports its release either.
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
