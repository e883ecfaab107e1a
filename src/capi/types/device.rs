//! Devices, and the functions of the host that they and their work call.

use std::ffi::{c_char, c_void};

use crate::capi::status::etd_status;
pub use etd_log_level::*;

/// How much a message matters.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_log_level {
    /// What a user should know: something was left out, or will take long, or is biased.
    ETD_LOG_WARNING = 0,
    /// What was decided and how long it took.
    ETD_LOG_INFO = 1,
}

/// Told warnings and decisions. `message` is UTF-8 and lives during the call.
///
/// Called on whichever thread has something to say, several at once where several threads work. It must not unwind (throw),
/// and may make any call that does not wait for the work that called it.
pub type etd_log_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, level: etd_log_level, message: *const c_char)>;

/// Told every failing call on an object of the device, on the thread of the call, before it returns. As `etd_log_fn`; a
/// call that fails inside it is not reported again.
pub type etd_error_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status, message: *const c_char)>;

/// A piece of work for the host's executor: to be called once with its argument, on any thread, at any time, be it after
/// everything was released: then it finds nothing to do.
pub type etd_work_fn = Option<unsafe extern "C" fn(argument: *mut c_void)>;

/// Takes a piece of work for the host's own threads, and returns without waiting for it.
///
/// Called on the thread of a render, once for each helper and pass. The host must call `work(argument)` exactly once;
/// running it late, or in the calling thread, does no harm. It must not unwind.
pub type etd_submit_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, work: etd_work_fn, argument: *mut c_void)>;

/// Called when memory that was shared with a mesh is no longer read. Exactly once, on any thread, perhaps in the middle of
/// another call; it may make no calls of this library.
pub type etd_release_fn = Option<unsafe extern "C" fn(user_data: *mut c_void)>;

/// How a device works.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_device_options {
    /// `sizeof(etd_device_options)`.
    pub struct_size: usize,
    /// Threads that render and build. 0: one for each core. 1: no thread of its own, everything is done by the thread that
    /// calls (a started task has one, as something must run it). Else so many, in a pool that belongs to the device.
    /// With `submit`: how many threads the host offers, the calling one included.
    pub threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Bytes that hierarchies, placed geometry and films of this device may take together; 0: no limit. Descriptions
    /// (copies of the host's arrays among them) and memory of the host are not counted.
    pub memory_limit: u64,
    /// Told warnings and decisions; may be NULL.
    pub log: etd_log_fn,
    /// Told failing calls; may be NULL.
    pub error: etd_error_fn,
    /// The host's executor; NULL: the device has threads of its own.
    pub submit: etd_submit_fn,
    /// Given back to the three functions. They may be called until the device and everything made with it is released.
    pub user_data: *mut c_void,
}

versioned! {
    etd_device_options, user_data;
}
