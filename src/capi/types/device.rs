//! Options of devices, and the types of the host's functions that the library calls.

use std::ffi::{c_char, c_void};

use super::numbers::EtdLogChoice;
use crate::capi::status::etd_status;
pub use {etd_log_choice::*, etd_log_level::*};

/// The importance of a message.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_log_level {
    /// A warning for the user, such as about parts of a file that are ignored, or about a bias.
    ETD_LOG_WARNING = 0,
    /// Information about decisions and their durations.
    ETD_LOG_INFO = 1,
}

/// Which messages a log callback receives.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_log_choice {
    /// All messages.
    ETD_LOG_ALL = 0,
    /// Warnings alone.
    ETD_LOG_WARNINGS_ONLY = 1,
}

/// A log callback, which receives warnings and information. `message` is UTF-8 and valid during the call.
///
/// Any thread may call it, and several threads may call it at the same time. It must not unwind (throw). It may make any call
/// that does not wait for the work that called it.
pub type etd_log_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, level: etd_log_level, message: *const c_char)>;

/// An error callback, which receives every failing call on an object of the device, on the thread of the call and before the
/// call returns. The rules of `etd_log_fn` apply. Calls that fail inside the callback are not reported.
pub type etd_error_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status, message: *const c_char)>;

/// A job for the host's executor. The host calls it once with its argument, on any thread and at any time. A job that is called
/// after everything was released does nothing.
pub type etd_work_fn = Option<unsafe extern "C" fn(argument: *mut c_void)>;

/// A function of the host that submits a job to the host's executor, and returns without waiting for the job.
///
/// The thread of a render calls it, once for each helper and pass, and as often for other work that threads share, such as the
/// estimate of errors at the end. The host must call `work(argument)` exactly once. The job may run late or on the calling
/// thread. The function must not unwind.
pub type etd_submit_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, work: etd_work_fn, argument: *mut c_void)>;

/// A release callback, which is called once memory that was shared with a mesh is no longer read. It is called exactly once, on
/// any thread, possibly during another call. It must not call this library.
pub type etd_release_fn = Option<unsafe extern "C" fn(user_data: *mut c_void)>;

/// Options of a device.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_device_options {
    /// `sizeof(etd_device_options)`.
    pub struct_size: usize,
    /// Number of threads that render and build, in a pool of the device; 0 means one for each core. With 1, the device has no
    /// threads, and all work runs on the calling thread; only a started task gets a thread. With `submit`: the number of
    /// threads of the host, including the calling thread.
    pub threads: u32,
    /// An `etd_log_choice`: which messages `log` receives. All by default.
    pub log_choice: EtdLogChoice,
    /// Memory limit in bytes for all hierarchies, placed geometry and films of this device; 0: no limit. Descriptions, which
    /// include copies of the host's arrays, and memory of the host do not count.
    pub memory_limit: u64,
    /// Log callback; may be NULL.
    pub log: etd_log_fn,
    /// Error callback; may be NULL.
    pub error: etd_error_fn,
    /// The host's executor; NULL for threads of the device.
    pub submit: etd_submit_fn,
    /// Passed to the three functions. They may be called until the device and all objects made with it are released.
    pub user_data: *mut c_void,
}

/// What a device is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_device_info {
    /// `sizeof(etd_device_info)`.
    pub struct_size: usize,
    /// Number of threads that render, including the calling thread where that takes a part.
    pub threads: u32,
    /// Number of threads that build hierarchies.
    pub build_threads: u32,
    /// Version of the Embree library that runs, as 10000 * major + 100 * minor + patch.
    pub embree_version: u32,
    /// 0.
    pub reserved: u32,
    /// The largest instruction set of the processor among those that Embree and the library choose between: "AVX-512", "AVX2", "AVX",
    /// "SSE4.2" or "SSE2" on x86-64. The string is static.
    pub instruction_set: *const c_char,
    /// The memory limit of the device in bytes; 0: none.
    pub memory_limit: u64,
}

enumerations! {
    etd_log_choice: ETD_LOG_ALL, ETD_LOG_WARNINGS_ONLY;
}

versioned! {
    etd_device_options, user_data;
    etd_device_info, memory_limit;
}
