//! Calls about the last error of a thread.

use std::ffi::c_char;

use super::boundary::{boundary, write_sized};
use super::status::{etd_error, etd_status, last_error};

/// Returns the parts of the last error of this thread.
///
/// Fills `*out_error`, whose `struct_size` must be set, and returns `ETD_OK`; `out_error->status` is `ETD_OK` if no call
/// has failed yet. The strings are valid until the next failing call on this thread. Thread-safe.
///
/// # Safety
/// `out_error` must be NULL or point to a structure of the size in its `struct_size`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_last_error(out_error: *mut etd_error) -> etd_status {
    boundary(None, || {
        // SAFETY: the caller keeps this function's contract.
        unsafe { write_sized(out_error, "out_error", last_error()) }
    })
}

/// Returns the name of a status, such as "ETD_INVALID_SCENE", or "unknown status" for any other number. The string is
/// static. Thread-safe.
#[unsafe(no_mangle)]
pub extern "C" fn etd_status_name(status: u32) -> *const c_char {
    let name = match status {
        0 => c"ETD_OK",
        1 => c"ETD_RUNNING",
        100 => c"ETD_INVALID_ARGUMENT",
        101 => c"ETD_INVALID_HANDLE",
        102 => c"ETD_INVALID_OPERATION",
        200 => c"ETD_INVALID_SCENE",
        201 => c"ETD_UNSUPPORTED",
        202 => c"ETD_IO",
        300 => c"ETD_DEVICE",
        301 => c"ETD_OUT_OF_MEMORY",
        400 => c"ETD_CANCELLED",
        500 => c"ETD_INTERNAL",
        501 => c"ETD_PANIC",
        _ => c"unknown status",
    };
    name.as_ptr()
}
