//! What a host is told of work that has no object of its own.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use super::boundary::UserData;
use super::scene::Progress;
use super::types::{ETD_PHASE_BUILD, etd_phase, etd_progress, etd_progress_fn};
use crate::Cancel;

/// Share of the progress that building a scene takes.
pub(super) const BUILD_SHARE: f64 = 0.1;

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

/// Tells a host how far a piece of work is, and stops the work where the host says so. Clones are of the same work.
#[derive(Clone)]
pub(super) struct Reporter {
    function: etd_progress_fn,
    user_data: UserData,
    start: Instant,
    cancel: Cancel,
    /// Bits of the largest share told, which is not negative: they are in the order of the numbers.
    told: Arc<AtomicU64>,
    /// What this part of the work is of the whole.
    from: f64,
    to: f64,
}

impl Reporter {
    /// Of work that begins now. `user_data`: what the function is to be given.
    pub fn new(function: etd_progress_fn, user_data: UserData) -> Self {
        let (cancel, told) = (Cancel::new(), Arc::new(AtomicU64::new(0)));
        Self { function, user_data, start: Instant::now(), cancel, told, from: 0.0, to: 1.0 }
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

    /// Tells that so much of this part is done; whether to go on.
    pub fn tell(&self, fraction: f64, report: etd_progress) -> ControlFlow<()> {
        let Some(function) = self.function else { return ControlFlow::Continue(()) };
        let fraction = self.at(fraction);
        let before = self.told.fetch_max(fraction.to_bits(), Ordering::Relaxed);
        let fraction = fraction.max(f64::from_bits(before));
        let report = etd_progress { fraction, elapsed: self.start.elapsed().as_secs_f64(), ..report };
        // SAFETY: the host gave the function for this; the report lives during the call.
        if unsafe { function(self.user_data.0, &raw const report) } == 0 {
            return ControlFlow::Continue(());
        }
        self.cancel.cancel();
        ControlFlow::Break(())
    }

    /// What a build of a scene tells as this part of the work.
    pub fn build(&self) -> Progress {
        self.function?;
        let own = self.clone();
        Some(Arc::new(move |fraction| {
            // The build asks the token.
            let _ = own.tell(fraction, none_yet(ETD_PHASE_BUILD));
        }))
    }
}
