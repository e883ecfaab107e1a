//! Output for the user on standard output and standard error.

use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::Arc;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::Failure;

/// Writes a line on standard error. A closed standard error is not a failure.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// A warning, on standard error.
pub fn warn(message: impl Display) {
    say(&format!("warning: {message}"));
}

/// Writes text on standard output. A reader that stops reading (`| head`) is not a failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match writeln!(stdout, "{text}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::running(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// A progress bar on standard error, hidden where that is not a terminal or the user wants quiet.
pub struct Bar(ProgressBar);

impl Bar {
    /// Steps of the bar from start to end.
    const STEPS: u64 = 1000;

    /// A bar at its start.
    pub fn new(quiet: bool) -> Self {
        if quiet || !io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new(Self::STEPS);
        if let Ok(style) = ProgressStyle::with_template("{bar:32} {percent:>3}%  {msg}") {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// Shows that the fraction `fraction` in [0, 1] of the work is done.
    pub fn show(&self, fraction: f64, message: String) {
        if !self.0.is_hidden() {
            self.0.set_position((fraction.clamp(0.0, 1.0) * Self::STEPS as f64) as u64);
            self.0.set_message(message);
        }
    }
}

/// A progress bar for the images of a scene that is read, as long as they are.
pub fn reading_images(quiet: bool) -> Arc<dyn Fn(f64) + Send + Sync> {
    let bar = Bar::new(quiet);
    Arc::new(move |fraction| match fraction {
        ..1.0 => bar.show(fraction, "reading images".to_owned()),
        _ => bar.0.finish_and_clear(),
    })
}

impl Drop for Bar {
    /// Clears the line for the next message.
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Remaining time at a constant pace, for the progress bar; empty where it is not known yet.
pub fn time_left(fraction: f64, elapsed: Duration) -> String {
    let left = elapsed.as_secs_f64() * (1.0 - fraction) / fraction;
    if fraction > 0.0 && left.is_finite() && left >= 0.0 { format!(", {} left", duration(left)) } else { String::new() }
}

/// Seconds in readable form: `0.52 s`, `12.3 s`, `3 min 05 s`, `2 h 07 min`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match seconds {
        ..9.995 => format!("{seconds:.2} s"),
        ..59.95 => format!("{seconds:.1} s"),
        ..3599.5 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// Million rays per second, or a word where no time has passed.
pub fn ray_rate(rays: u64, elapsed: Duration) -> String {
    let rate = rays as f64 / elapsed.as_secs_f64() * 1e-6;
    if rate.is_finite() { format!("{rate:.2} Mrays/s") } else { "- Mrays/s".to_owned() }
}

/// Peak memory of this process so far [bytes], where the system reports it (Linux).
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}
