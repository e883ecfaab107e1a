//! The status values of calls, and the last error of each thread.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::path::Path;

use crate::{Error, ErrorKind};

/// The result of a call. Values are grouped by the cause of the error. A value never changes its meaning.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_status {
    /// The call succeeded.
    ETD_OK = 0,
    /// Not an error: the task is still running.
    ETD_RUNNING = 1,

    /// An argument is NULL, out of its range, not finite, or the number of no element. The call changed nothing.
    ETD_INVALID_ARGUMENT = 100,
    /// The pointer is a handle of another kind than was expected, or points to readable memory that is no handle. A handle
    /// whose last reference was released is not recognised: to pass it is undefined behaviour, as for any freed memory. There
    /// is one exception: while the last reference to a task is being released, the task still exists, and calls with its
    /// handle in the task's callbacks are refused with this status.
    ETD_INVALID_HANDLE = 101,
    /// The call does not fit the state of the object: a film that is being rendered to, a scene that was not built, a
    /// callback that waits for the very work that called it.
    ETD_INVALID_OPERATION = 102,

    /// The scene holds a value that cannot be rendered; the message names file, line and JSON path. Or the saved film is none, or damaged.
    ETD_INVALID_SCENE = 200,
    /// The request is valid, but this version does not support it.
    ETD_UNSUPPORTED = 201,
    /// A file could not be read or written.
    ETD_IO = 202,

    /// Embree is missing, of the wrong version, or failed; or no thread could be started.
    ETD_DEVICE = 300,
    /// There is not enough memory, or the device's memory limit was reached.
    ETD_OUT_OF_MEMORY = 301,

    /// The work was cancelled, by `etd_task_cancel` or by a callback.
    ETD_CANCELLED = 400,

    /// A fault in this library; please report it.
    ETD_INTERNAL = 500,
    /// The library panicked, which is a fault in it; please report it. The process may continue. The objects of the call can
    /// only be released from now on.
    ETD_PANIC = 501,
}
pub use etd_status::*;

/// The last error of a thread: why its last failing call failed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_error {
    /// `sizeof(etd_error)`, set by the caller (`ETD_ERROR_INIT`).
    pub struct_size: usize,
    /// The status that the call returned.
    pub status: etd_status,
    /// Line in `file`, counted from 1; 0 if it is not known.
    pub line: u32,
    /// The whole message, which begins with file, line and JSON path. UTF-8, never NULL. This pointer and the two below are
    /// valid until the next failing call on this thread.
    pub message: *const c_char,
    /// The file that the error is about; empty if it is about no file.
    pub file: *const c_char,
    /// JSON path such as `surfaces[3].radius`, also for scenes that calls describe; empty if there is none.
    pub json_path: *const c_char,
}

/// The failure of a call, before it becomes a status and the thread's last error.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub status: etd_status,
    pub message: String,
    pub file: String,
    pub json_path: String,
    pub line: u32,
}

pub(super) type Result<T = (), E = Failure> = std::result::Result<T, E>;

impl Failure {
    pub fn new(status: etd_status, message: impl Into<String>) -> Self {
        Self { status, message: message.into(), file: String::new(), json_path: String::new(), line: 0 }
    }

    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(ETD_INVALID_ARGUMENT, message)
    }

    pub fn operation(message: impl Into<String>) -> Self {
        Self::new(ETD_INVALID_OPERATION, message)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match error.kind() {
            ErrorKind::InvalidScene => ETD_INVALID_SCENE,
            ErrorKind::Unsupported => ETD_UNSUPPORTED,
            ErrorKind::Io => ETD_IO,
            ErrorKind::Device => ETD_DEVICE,
            ErrorKind::OutOfMemory => ETD_OUT_OF_MEMORY,
            ErrorKind::Cancelled => ETD_CANCELLED,
            ErrorKind::Internal => ETD_INTERNAL,
        };
        let location = error.location();
        Self {
            status,
            message: error.to_string(),
            file: location.file.as_deref().map(Path::to_string_lossy).unwrap_or_default().into_owned(),
            json_path: location.json_path.clone(),
            line: u32::try_from(location.line).unwrap_or(u32::MAX),
        }
    }
}

/// The last error of a thread, with its texts as C strings.
struct LastError {
    status: etd_status,
    line: u32,
    message: CString,
    file: CString,
    json_path: CString,
}

thread_local! {
    static LAST: RefCell<Option<LastError>> = const { RefCell::new(None) };
}

/// Makes a C string of a text. The text ends at its first zero byte.
pub(super) fn c_string(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

/// Stores a failure as the last error of this thread.
pub(super) fn remember(failure: &Failure) {
    let last = LastError {
        status: failure.status,
        line: failure.line,
        message: c_string(&failure.message),
        file: c_string(&failure.file),
        json_path: c_string(&failure.json_path),
    };
    // A thread that is ending may have dropped its thread-local storage, and then the error is not stored.
    let _ = LAST.try_with(|slot| *slot.borrow_mut() = Some(last));
}

/// The last error of this thread; its status is `ETD_OK` if no call has failed.
pub(super) fn last_error() -> etd_error {
    let mut error = etd_error {
        struct_size: size_of::<etd_error>(),
        status: ETD_OK,
        line: 0,
        message: c"".as_ptr(),
        file: c"".as_ptr(),
        json_path: c"".as_ptr(),
    };
    let _ = LAST.try_with(|slot| {
        if let Some(last) = slot.borrow().as_ref() {
            error.status = last.status;
            error.line = last.line;
            error.message = last.message.as_ptr();
            error.file = last.file.as_ptr();
            error.json_path = last.json_path.as_ptr();
        }
    });
    error
}

/// Returns the message of the last call that failed on this thread, with file, line and JSON path where there are any.
///
/// The message is UTF-8, never NULL, and empty if no call has failed yet. It is valid until the next failing call on this
/// thread. Calls that succeed do not change it. Thread-safe; each thread has its own message.
#[unsafe(no_mangle)]
pub extern "C" fn etd_last_error_message() -> *const c_char {
    LAST.try_with(|slot| slot.borrow().as_ref().map_or(c"".as_ptr(), |last| last.message.as_ptr()))
        .unwrap_or(c"".as_ptr())
}
