//! What a render is to do.

use std::time::Duration;

use super::workers::Workers;
use crate::Cancel;
use crate::desc::RenderDesc;
use crate::film::ErrorMeasure;

/// What to render, and with how much effort.
#[derive(Clone, Debug, Default)]
pub struct RenderSettings {
    /// Resolution, samples, sampler, filter, integrator, seed.
    pub desc: RenderDesc,
    /// Worker threads, of a pool of its own; 0 means one per core. The image does not depend on it. Not looked at where
    /// `workers` are given.
    pub threads: usize,
    /// Who does the work, where it is not a pool of its own.
    pub workers: Option<Workers>,
    /// Ends after this time, when the samples that are being taken are done, even if others are left. For time alone
    /// to count, ask for [`MOST_SAMPLES`](super::MOST_SAMPLES).
    pub time_limit: Option<Duration>,
    /// Ends when the estimated error is no larger than this, by a margin of a quarter of the estimate's standard error: not
    /// before 32 samples, and not while few pixels have most of the error. Decided between passes.
    pub target_error: Option<f64>,
    /// What `target_error` is of: relMSE if nothing is said. Adaptive samples go where it is largest.
    pub error_measure: ErrorMeasure,
    /// Whether pixels with more error get more samples; `samples` of `desc` is the mean over pixels then. `None`: where an
    /// error is aimed at. Patterns that are planned for their number of samples (all samplers but `Sobol` and `Random`)
    /// and photon maps that are made anew for each pass need the same number for each pixel, and have it; a note says so.
    pub adaptive: Option<bool>,
    /// Stops the render soon, from any thread.
    pub cancel: Cancel,
    /// Keeps albedo, normal and depth of the first hit.
    pub auxiliary: bool,
}
