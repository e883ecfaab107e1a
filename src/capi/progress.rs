//! Progress callbacks of calls that return when their work is done.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use super::boundary::UserData;
use super::float_state::in_host_state;
use super::types::{ETD_PHASE_BUILD, etd_phase, etd_progress, etd_progress_fn};
use crate::Cancel;

/// Fraction of the progress that building a scene counts for.
pub(super) const BUILD_FRACTION: f64 = 0.1;

/// The callback of a scene's build, which receives the fraction of the build that is done.
pub(super) type BuildReport = Option<Arc<dyn Fn(f64) + Send + Sync>>;

/// A progress report at the beginning of a phase.
pub(super) fn initial_progress(phase: etd_phase) -> etd_progress {
    etd_progress {
        struct_size: size_of::<etd_progress>(),
        fraction: 0.0,
        elapsed: 0.0,
        rays: 0,
        samples_done: 0,
        samples_total: 0,
        phase,
        images: 0,
    }
}

/// A progress callback of the host, with the token that is cancelled if the callback asks to stop. All clones belong to the
/// same work.
#[derive(Clone)]
pub(super) struct HostProgress {
    function: etd_progress_fn,
    user_data: UserData,
    start: Instant,
    cancel: Cancel,
    /// Begin and end of this part, as fractions of the whole work.
    from: f64,
    to: f64,
}

impl HostProgress {
    /// For work that begins now. `user_data` is passed to the function.
    pub fn new(function: etd_progress_fn, user_data: UserData) -> Self {
        Self { function, user_data, start: Instant::now(), cancel: Cancel::new(), from: 0.0, to: 1.0 }
    }

    /// The token that is cancelled once the host has asked to stop.
    pub fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// Progress of a part of this work, between two fractions of it.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self { from: self.at(from), to: self.at(to), ..self.clone() }
    }

    fn at(&self, fraction: f64) -> f64 {
        (self.from + (self.to - self.from) * fraction).clamp(0.0, 1.0)
    }

    /// Reports the fraction of this part that is done, which must not fall. Returns whether the work is to continue.
    pub fn report(&self, fraction: f64, report: etd_progress) -> ControlFlow<()> {
        let Some(function) = self.function else { return ControlFlow::Continue(()) };
        let fraction = self.at(fraction);
        let report = etd_progress { fraction, elapsed: self.start.elapsed().as_secs_f64(), ..report };
        // SAFETY: the host provided the function for these calls; the report lives during the call.
        if in_host_state(|| unsafe { function(self.user_data.0, &raw const report) }) == 0 {
            return ControlFlow::Continue(());
        }
        self.cancel.cancel();
        ControlFlow::Break(())
    }

    /// The callback of a scene's build that is this part of the work.
    pub fn build(&self) -> BuildReport {
        self.function?;
        let own = self.clone();
        Some(Arc::new(move |fraction| {
            // The build itself checks the token.
            let _ = own.report(fraction, initial_progress(ETD_PHASE_BUILD));
        }))
    }
}
