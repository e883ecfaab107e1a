//! Progress reports and the summary of a render.

use std::time::Duration;

use super::replay::NonFiniteSample;
use crate::desc::IntegratorDesc;
use crate::film::{ErrorEstimate, Image, SampleCounts};

/// A progress report of a render.
pub struct Progress<'a> {
    /// Fraction of the render that is done, in [0, 1]: of the samples, or of the time limit where that is nearer. With a target
    /// error, the fraction refers to the number of samples at which the target is expected to be reached, once there is an
    /// estimate. The fraction never falls.
    pub fraction: f64,
    /// Number of complete samples per pixel.
    pub samples_done: u32,
    /// Greatest number of samples per pixel, at which the render ends.
    pub samples_total: u32,
    /// Number of rays traced so far.
    pub rays: u64,
    /// Time since [`Render::run`](super::Render::run) began.
    pub elapsed: Duration,
    /// Develops the current image, where the report comes after a pass; `None` in the middle of a pass.
    pub image: Option<&'a dyn Fn() -> Image>,
}

/// The reason why a render ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ended {
    /// Every pixel has all its samples.
    #[default]
    Samples,
    /// The time limit was reached.
    Time,
    /// The target error was reached.
    Error,
    /// The caller stopped the render, by [`Cancel`](crate::Cancel) or by answering a progress report with `Break`.
    Cancelled,
}

/// The summary of a render.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Time that [`Render::run`](super::Render::run) took, but for the estimates of errors at its end.
    pub elapsed: Duration,
    /// Number of complete samples per pixel; the mean over pixels where the numbers differ.
    pub samples: u32,
    /// Numbers of samples over all pixels, including those of an unfinished pass; `None` after the render's
    /// [`Cancel`](crate::Cancel) was used.
    pub sample_counts: Option<SampleCounts>,
    /// The integrator that took the samples: where [`IntegratorDesc::Auto`] was asked for, the one that was chosen.
    pub integrator: IntegratorDesc,
    /// Whether pixels with larger errors got more samples.
    pub adaptive: bool,
    /// Whether pixels in groups shared the second hits of their paths (see [`RenderDesc::reuse`](crate::desc::RenderDesc::reuse)).
    pub reuse: bool,
    /// Whether light paths were traced to the camera (see [`RenderDesc::light_paths`](crate::desc::RenderDesc::light_paths)).
    pub light_paths: bool,
    /// Number of light samples at the hits that the camera sees, by path tracing (see
    /// [`RenderDesc::first_shadow_rays`](crate::desc::RenderDesc::first_shadow_rays)).
    pub first_shadow_rays: u32,
    /// Number of rays traced, including shadow rays.
    pub rays: u64,
    /// Estimated relMSE (see [`Film::rel_mse`](crate::film::Film::rel_mse)). It is `None` where there are too few samples or too
    /// little memory for an estimate, and after the render's [`Cancel`](crate::Cancel) was used.
    pub rel_mse: Option<ErrorEstimate>,
    /// Estimated error of displayed values (see [`Film::display_error`](crate::film::Film::display_error)), under the same
    /// conditions.
    pub display_error: Option<ErrorEstimate>,
    /// The reason why the render ended.
    pub ended: Ended,
    /// Whether the caller stopped the render before its end.
    pub stopped: bool,
    /// Number of samples that were NaN or infinite and count as black.
    pub non_finite: u64,
    /// The first few samples that were NaN or infinite, and where on their paths they became so.
    pub non_finite_samples: Vec<NonFiniteSample>,
    /// Notes for the user, such as a bias that the settings imply, samples that count as black, or an error estimate that
    /// rests on few pixels.
    pub notes: Vec<String>,
    /// Why the last checkpoint of [`RenderSettings::checkpoint`](super::RenderSettings::checkpoint) could not be written; `None` where it
    /// was written. The file then still has the one before.
    pub checkpoint_failure: Option<String>,
}
