//! What a render tells: how far it is, and what it came to.

use std::time::Duration;

use super::replay::NonFiniteSample;
use crate::film::{ErrorEstimate, Image, SampleCounts};

/// How far a render has come.
pub struct Progress<'a> {
    /// Share of the work or of the time limit that is done, in [0, 1]; only grows. Where an error is aimed at, of the samples
    /// that it is expected to take, once there is an estimate.
    pub fraction: f64,
    /// Samples per pixel that are complete.
    pub samples_done: u32,
    /// Samples per pixel to reach.
    pub samples_total: u32,
    /// Rays so far.
    pub rays: u64,
    /// Time since [`Render::run`](super::Render::run) began.
    pub elapsed: Duration,
    /// The image as it is after a pass; `None` in the middle of one.
    pub image: Option<&'a dyn Fn() -> Image>,
}

/// What ended a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ended {
    /// Every pixel has its samples.
    #[default]
    Samples,
    /// The time limit.
    Time,
    /// The error is as small as was asked for.
    Error,
    /// The caller: [`Cancel`](crate::Cancel), or a report that was answered with `Break`.
    Cancelled,
}

/// What a render came to.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Time that [`Render::run`](super::Render::run) took.
    pub elapsed: Duration,
    /// Complete samples per pixel; the mean over pixels where they differ.
    pub samples: u32,
    /// Samples of pixels as they are, those of an unfinished pass too; `None` after a cancel.
    pub sample_counts: Option<SampleCounts>,
    /// Whether pixels with more error got more samples.
    pub adaptive: bool,
    /// Rays traced, closest-hit and shadow rays together.
    pub rays: u64,
    /// Estimated relMSE (see [`Film::rel_mse`](crate::film::Film::rel_mse)), where there are enough samples to tell and nobody who cancelled is kept
    /// waiting for it.
    pub rel_mse: Option<ErrorEstimate>,
    /// Estimated error of what a screen shows (see [`Film::display_error`](crate::film::Film::display_error)), likewise.
    pub display_error: Option<ErrorEstimate>,
    /// What ended it.
    pub ended: Ended,
    /// Whether the caller stopped it before the end.
    pub stopped: bool,
    /// Samples that were NaN or infinite and were left out.
    pub non_finite: u64,
    /// The first few of them, and where they became so.
    pub non_finite_samples: Vec<NonFiniteSample>,
    /// What a user should know: a bias that was asked for, samples left out, an error that rests on few pixels.
    pub notes: Vec<String>,
}
