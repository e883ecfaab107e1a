//! The device: its threads, its memory limit, and the host's functions for messages.

use std::ffi::{c_char, c_void};
use std::sync::Arc;
use std::thread::JoinHandle;

use super::boundary::{
    Callbacks, Header, Object, UserData, boundary, catch, give, need, object, on, peek, read_sized, release, retain,
    take_status, write_sized,
};
use super::float_state::in_host_state;
use super::read::enumeration;
use super::status::{ETD_INVALID_ARGUMENT, Failure, etd_status};
use super::types::{
    ETD_LOG_ALL, ETD_LOG_INFO, ETD_LOG_WARNING, ETD_LOG_WARNINGS_ONLY, Enumeration as _, etd_device_info,
    etd_device_options, etd_work_fn,
};
use crate::embree::{Device, DeviceOptions, MemoryBudget, instruction_set};
use crate::render::{MAX_THREADS, Workers};

/// A device: threads, a memory limit, and the functions that receive messages. Devices are independent of each other.
pub struct etd_device {
    header: Header,
    pub(super) workers: Workers,
    pub(super) budget: MemoryBudget,
    /// Number of threads that build Embree's hierarchies.
    pub(super) build_threads: usize,
    /// Bytes; 0 for none.
    memory_limit: u64,
    submit: Submit,
}

/// The executor of jobs that must not run on the calling thread.
enum Submit {
    Thread,
    Host(Box<dyn Fn(Job) + Send + Sync>),
}

type Job = Box<dyn FnOnce() + Send>;

type SubmitFn = unsafe extern "C" fn(*mut c_void, etd_work_fn, *mut c_void);
object!(etd_device, b"EtDv", "device");

impl etd_device {
    pub(super) fn callbacks(&self) -> &Arc<Callbacks> {
        &self.header.callbacks
    }

    /// Starts a job on a thread of its own, whose handle is returned, or on the host's executor.
    pub(super) fn start(&self, job: Job) -> std::io::Result<Option<JoinHandle<()>>> {
        match &self.submit {
            Submit::Thread => std::thread::Builder::new().name("etendue-task".to_owned()).spawn(job).map(Some),
            Submit::Host(submit) => {
                submit(job);
                Ok(None)
            }
        }
    }
}

/// Returns the version of the linked library as 10000 * major + 100 * minor + patch, for comparison with `ETD_VERSION`.
/// Thread-safe.
#[unsafe(no_mangle)]
pub extern "C" fn etd_version() -> u32 {
    let part = |text: &str| text.parse::<u32>().unwrap_or(0);
    10_000 * part(env!("CARGO_PKG_VERSION_MAJOR"))
        + 100 * part(env!("CARGO_PKG_VERSION_MINOR"))
        + part(env!("CARGO_PKG_VERSION_PATCH"))
}

/// Returns the version of the linked library as text, such as "0.1.0". The string is static. Thread-safe.
#[unsafe(no_mangle)]
pub extern "C" fn etd_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Makes a device and starts its threads.
///
/// `options`: NULL for the defaults of `ETD_DEVICE_OPTIONS_INIT`. On `ETD_OK`, `*out_device` is one reference, to be released
/// with `etd_device_release`. Errors: `ETD_INVALID_ARGUMENT` for more than 1024 threads, `ETD_DEVICE` if no thread
/// could be started. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type; the functions in `options` must behave as the documentation of
/// their types says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_new(
    options: *const etd_device_options,
    out_device: *mut *mut etd_device,
) -> etd_status {
    boundary(None, || {
        need(out_device, "out_device")?;
        let defaults = etd_device_options {
            struct_size: size_of::<etd_device_options>(),
            threads: 0,
            log_choice: ETD_LOG_ALL.number(),
            memory_limit: 0,
            log: None,
            error: None,
            submit: None,
            user_data: std::ptr::null_mut(),
        };
        // SAFETY: the caller keeps this function's contract.
        let options = if options.is_null() { defaults } else { unsafe { read_sized(options, "options") }? };
        let least = match enumeration("options.log_choice", options.log_choice)? {
            ETD_LOG_ALL => ETD_LOG_INFO,
            ETD_LOG_WARNINGS_ONLY => ETD_LOG_WARNING,
        };
        let threads = options.threads as usize;
        if threads > MAX_THREADS {
            let message = format!("options.threads is {threads}, expected at most {MAX_THREADS}");
            return Err(Failure::new(ETD_INVALID_ARGUMENT, message));
        }
        let user_data = UserData(options.user_data);
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let (workers, build_threads, submit) = match (options.submit, threads) {
            (Some(submit), threads) => {
                let threads = if threads == 0 { cores } else { threads };
                let to_host = move |job: Job| submit_to_host(submit, user_data, job);
                // Embree cannot build on the host's executor, so builds use one thread.
                (Workers::host(threads, to_host), 1, Submit::Host(Box::new(to_host)))
            }
            (None, 1) => (Workers::calling_thread(), 1, Submit::Thread),
            (None, threads) => (Workers::pool(threads)?, if threads == 0 { cores } else { threads }, Submit::Thread),
        };
        let callbacks = Arc::new(Callbacks { log: options.log, least, error: options.error, user_data });
        let limit = usize::try_from(options.memory_limit).unwrap_or(usize::MAX);
        let device = etd_device {
            header: Header::new::<etd_device>(&callbacks),
            workers,
            budget: MemoryBudget::new(if limit == 0 { usize::MAX } else { limit }),
            build_threads,
            memory_limit: options.memory_limit,
            submit,
        };
        callbacks.log(ETD_LOG_INFO, &format!("etendue {}", env!("CARGO_PKG_VERSION")));
        give(Arc::new(device), out_device);
        Ok(())
    })
}

/// Submits a job to the host's executor, as a function and its argument.
fn submit_to_host(submit: SubmitFn, user_data: UserData, job: Job) {
    unsafe extern "C" fn work(argument: *mut c_void) {
        if argument.is_null() {
            return;
        }
        // SAFETY: `argument` came from `Box::into_raw` below, and the host passes it to this function exactly once.
        let job = unsafe { Box::from_raw(argument.cast::<Job>()) };
        // The job itself reports its panics. A panic must not unwind into the host.
        let _ = catch(|| {
            job();
            Ok(())
        });
    }

    let argument = Box::into_raw(Box::new(job)).cast::<c_void>();
    // SAFETY: the host provided the function for these calls.
    in_host_state(|| unsafe { submit(user_data.0, Some(work), argument) });
}

/// Adds a reference to a device. Thread-safe.
///
/// # Safety
/// `device` must be NULL or a device.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_retain(device: *mut etd_device) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { retain(device) }
}

/// Releases a reference to a device; NULL is allowed. Objects that were made with a device keep it alive. Thread-safe.
///
/// # Safety
/// `device` must be NULL or a device of which the caller has a reference.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_release(device: *mut etd_device) {
    // SAFETY: the caller keeps this function's contract.
    unsafe { release(device) }
}

/// Takes the first failure of a call on this device since the last time that it was taken: returns its status, or `ETD_OK` if
/// there was none, and forgets the failure.
///
/// A host may thus make many calls and check once. `message`: receives the message, at most `capacity` bytes including the
/// zero byte, unless it is NULL. Thread-safe.
///
/// # Safety
/// `device` must be NULL or a device, and `capacity` bytes writable at `message` unless it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_status(
    device: *mut etd_device,
    message: *mut c_char,
    capacity: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { take_status(device, message, capacity) }
}

/// Returns the number of bytes that hierarchies, placed geometry and films of the device take now, and the greatest number
/// that they have taken. Either pointer may be NULL. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_memory(
    device: *const etd_device,
    out_used: *mut u64,
    out_peak: *mut u64,
) -> etd_status {
    boundary(None, || {
        // SAFETY: the caller keeps this function's contract.
        let device = unsafe { peek(device) }?;
        for (out, bytes) in [(out_used, device.budget.used()), (out_peak, device.budget.peak())] {
            if !out.is_null() {
                need(out, "the counter")?;
                // SAFETY: the caller keeps this function's contract.
                unsafe { out.write(bytes as u64) }
            }
        }
        Ok(())
    })
}

/// Returns what a device is: its threads, and what it runs on. Errors: `ETD_DEVICE` if Embree does not start. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, whose `struct_size` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_device_get_info(device: *const etd_device, out_info: *mut etd_device_info) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(device, |device| {
            need(out_info, "out_info")?;
            let [major, minor, patch] =
                Device::new(&DeviceOptions { threads: 1, ..DeviceOptions::default() })?.version();
            let info = etd_device_info {
                struct_size: size_of::<etd_device_info>(),
                threads: device.workers.threads() as u32,
                build_threads: device.build_threads as u32,
                embree_version: 10_000 * major + 100 * minor + patch,
                reserved: 0,
                instruction_set: instruction_set().as_ptr(),
                memory_limit: device.memory_limit,
            };
            write_sized(out_info, "out_info", info)
        })
    }
}
