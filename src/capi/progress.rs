//! Progress callbacks of calls that return when their work is done.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use super::boundary::UserData;
use super::types::{ETD_PHASE_BUILD, etd_phase, etd_progress, etd_progress_fn};
use crate::Cancel;

/// Share of the progress that building a scene takes.
pub(super) const BUILD_SHARE: f64 = 0.1;

/// What the build of a scene is given to tell its finished share to.
pub(super) type BuildReport = Option<Arc<dyn Fn(f64) + Send + Sync>>;

/// Nothing is done yet.
pub(super) fn none_yet(phase: etd_phase) -> etd_progress {
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

/// A progress callback of the host, and the token that it cancels by its answer. Clones are of the same work.
#[derive(Clone)]
pub(super) struct HostProgress {
    function: etd_progress_fn,
    user_data: UserData,
    start: Instant,
    cancel: Cancel,
    /// What this part of the work is of the whole.
    from: f64,
    to: f64,
}

impl HostProgress {
    /// Of work that begins now. `user_data`: what the function is to be given.
    pub fn new(function: etd_progress_fn, user_data: UserData) -> Self {
        Self { function, user_data, start: Instant::now(), cancel: Cancel::new(), from: 0.0, to: 1.0 }
    }

    /// What stops the work once the host has said so.
    pub fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// For the part of this one that lies between these shares of it.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self { from: self.at(from), to: self.at(to), ..self.clone() }
    }

    fn at(&self, fraction: f64) -> f64 {
        (self.from + (self.to - self.from) * fraction).clamp(0.0, 1.0)
    }

    /// Tells that so much of this part is done, which must only grow; returns whether to go on.
    pub fn tell(&self, fraction: f64, report: etd_progress) -> ControlFlow<()> {
        let Some(function) = self.function else { return ControlFlow::Continue(()) };
        let fraction = self.at(fraction);
        let report = etd_progress { fraction, elapsed: self.start.elapsed().as_secs_f64(), ..report };
        // SAFETY: the host gave the function for this; the report lives during the call.
        if unsafe { function(self.user_data.0, &raw const report) } == 0 {
            return ControlFlow::Continue(());
        }
        self.cancel.cancel();
        ControlFlow::Break(())
    }

    /// What a build of a scene tells as this part of the work.
    pub fn build(&self) -> BuildReport {
        self.function?;
        let own = self.clone();
        Some(Arc::new(move |fraction| {
            // The build asks the token.
            let _ = own.tell(fraction, none_yet(ETD_PHASE_BUILD));
        }))
    }
}
