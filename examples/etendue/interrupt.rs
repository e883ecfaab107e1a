//! Handling of SIGINT (Ctrl-C), SIGTERM and SIGHUP: the first signal requests a stop, the second ends the program.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::Failure;

/// Exit code of a run that was interrupted: 128 + SIGINT, as shells have it.
pub const EXIT_CODE: u8 = 130;

/// Whether there are results to write, so that the first signal only requests a stop.
static RENDERING: AtomicBool = AtomicBool::new(false);

/// Whether a signal has arrived while rendering.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the signal handlers. Until [`begin`], a signal ends the program at once.
pub fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if !RENDERING.load(Ordering::SeqCst) || REQUESTED.swap(true, Ordering::SeqCst) {
            process::exit(i32::from(EXIT_CODE));
        }
    })
    .map_err(|error| Failure::running(format!("cannot handle signals: {error}")))
}

/// From here on the first signal is only recorded.
pub fn begin() {
    RENDERING.store(true, Ordering::SeqCst);
}

/// Whether a signal has requested a stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
