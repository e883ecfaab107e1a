//! Progress callbacks of calls that return when their work is done.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use super::boundary::{UserData, lock};
use super::float_state::in_host_state;
use super::types::{ETD_PHASE_BUILD, etd_phase, etd_progress, etd_progress_fn};
use crate::Cancel;
use crate::control::PROGRESS_INTERVAL;

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

/// Lets about ten reports a second through, and those with which a phase or an image begins or the work ends.
#[derive(Debug, Default)]
pub(super) struct Pace(Option<etd_progress>);

impl Pace {
    /// Whether this report is due, at the time that it says itself.
    pub fn is_due(&mut self, report: &etd_progress) -> bool {
        let is_due = self.0.is_none_or(|last| {
            report.elapsed >= last.elapsed + PROGRESS_INTERVAL.as_secs_f64()
                || report.phase != last.phase
                || report.images != last.images
                || (report.fraction >= 1.0 && last.fraction < 1.0)
        });
        if is_due {
            self.0 = Some(*report);
        }
        is_due
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
        let pace = Mutex::new(Pace::default());
        Some(Arc::new(move |fraction| {
            let elapsed = own.start.elapsed().as_secs_f64();
            let report = etd_progress { fraction, elapsed, ..initial_progress(ETD_PHASE_BUILD) };
            let is_due = lock(&pace).is_due(&report);
            if is_due {
                // The build itself checks the token.
                let _ = own.report(fraction, report);
            }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::types::ETD_PHASE_RENDER;

    #[test]
    fn ten_reports_a_second_are_let_through() {
        let mut pace = Pace::default();
        let steps = (0..=512_u32).map(|step| etd_progress {
            fraction: f64::from(step) / 512.0,
            elapsed: f64::from(step) / 512.0,
            ..initial_progress(ETD_PHASE_BUILD)
        });
        let told: Vec<f64> = steps.filter(|report| pace.is_due(report)).map(|report| report.fraction).collect();
        assert_eq!((told.len(), told[0], told[told.len() - 1]), (11, 0.0, 1.0), "{told:?}");

        let report = etd_progress { elapsed: 1.0, fraction: 0.0, ..initial_progress(ETD_PHASE_RENDER) };
        assert!(pace.is_due(&report), "another phase");
        assert!(!pace.is_due(&report), "the same again");
        let report = etd_progress { images: 1, ..report };
        assert!(pace.is_due(&report), "another image");
        assert!(!pace.is_due(&etd_progress { elapsed: 1.09, ..report }));
        assert!(pace.is_due(&etd_progress { elapsed: 1.1, ..report }));
    }
}
