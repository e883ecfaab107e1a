//! Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP): the first asks to stop, the second ends the program.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::Failure;

/// Exit code of a run that was interrupted: 128 + SIGINT, as shells have it.
pub const EXIT_CODE: u8 = 130;

/// There is something worth writing, so that the first signal only asks.
static RENDERING: AtomicBool = AtomicBool::new(false);

/// A signal has come while rendering.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes over the signals. Until [`begin`], one of them ends the program at once.
pub fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if !RENDERING.load(Ordering::SeqCst) || REQUESTED.swap(true, Ordering::SeqCst) {
            process::exit(i32::from(EXIT_CODE));
        }
    })
    .map_err(|error| Failure::running(format!("cannot handle signals: {error}")))
}

/// From here on the first signal is only noted.
pub fn begin() {
    RENDERING.store(true, Ordering::SeqCst);
}

/// Whether a signal has asked to stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
