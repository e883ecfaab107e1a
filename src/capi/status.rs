//! What a call came to, and why it failed.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::path::Path;

use crate::{Error, ErrorKind};

/// What a call came to. Values are grouped by who can mend it, never change and are never used again for something else.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_status {
    /// It is done.
    ETD_OK = 0,
    /// Not an error: the task is still running.
    ETD_RUNNING = 1,

    /// An argument is NULL, out of its range, not finite, or an index of nothing. The call changed nothing.
    ETD_INVALID_ARGUMENT = 100,
    /// The pointer is a handle of another kind than was expected, or points to readable memory that is no handle. A handle whose
    /// last reference was given back is not recognised: passing it is undefined behaviour, as for any freed memory. Only a task
    /// whose last reference is being given back, and whose memory is thus still there, is refused with this in its callbacks.
    ETD_INVALID_HANDLE = 101,
    /// The call does not fit the state of the object: a film that is being rendered to, a scene that was not built, a
    /// callback that waits for the very work that called it.
    ETD_INVALID_OPERATION = 102,

    /// The scene holds a value that cannot be rendered; the message names file, line and JSON path.
    ETD_INVALID_SCENE = 200,
    /// Well formed, but this version does not do it.
    ETD_UNSUPPORTED = 201,
    /// A file could not be read or written.
    ETD_IO = 202,

    /// Embree is missing, of the wrong version, or failed; or no thread could be started.
    ETD_DEVICE = 300,
    /// There is no memory, or the device's limit was reached.
    ETD_OUT_OF_MEMORY = 301,

    /// Cancelled, by `etd_task_cancel` or by a callback.
    ETD_CANCELLED = 400,

    /// A broken promise of this library; please report it.
    ETD_INTERNAL = 500,
    /// The library panicked. The process is unharmed, and the objects of the call can only be released from now on.
    ETD_PANIC = 501,
}
pub use etd_status::*;

/// Why the last failing call of a thread failed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_error {
    /// `sizeof(etd_error)`, set by the caller (`ETD_ERROR_INIT`).
    pub struct_size: usize,
    /// What that call returned.
    pub status: etd_status,
    /// One-based line in `file`; 0 where it is not known.
    pub line: u32,
    /// The whole message, with file, line and JSON path in front. UTF-8, never NULL. This pointer and the two below stay
    /// valid until the next failing call on this thread.
    pub message: *const c_char,
    /// The file it is about; empty where it is about none.
    pub file: *const c_char,
    /// JSON path such as `surfaces[3].radius`, for scenes built by calls too; empty where there is none.
    pub json_path: *const c_char,
}

/// A failed call, on its way out.
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

/// A thread's last failure, as C wants it.
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

/// A C string of any text: what follows a zero byte is left out.
pub(super) fn c_string(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

/// Keeps a failure as this thread's last.
pub(super) fn remember(failure: &Failure) {
    let last = LastError {
        status: failure.status,
        line: failure.line,
        message: c_string(&failure.message),
        file: c_string(&failure.file),
        json_path: c_string(&failure.json_path),
    };
    // A thread that is ending has no place for it any more.
    let _ = LAST.try_with(|slot| *slot.borrow_mut() = Some(last));
}

/// The last failure of this thread; of status `ETD_OK` if there was none.
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

/// The message of the last call that failed on this thread, with file, line and JSON path where there are any.
///
/// UTF-8, never NULL, empty if no call has failed yet. Valid until the next failing call on this thread. Calls that
/// succeed leave it alone. Thread-safe; each thread has its own.
#[unsafe(no_mangle)]
pub extern "C" fn etd_last_error_message() -> *const c_char {
    LAST.try_with(|slot| slot.borrow().as_ref().map_or(c"".as_ptr(), |last| last.message.as_ptr()))
        .unwrap_or(c"".as_ptr())
}
