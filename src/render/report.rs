//! Progress reports and the summary of a render.

use std::time::Duration;

use super::Render;
use super::adaptive::PILOT;
use super::method::Method;
use super::pilot::Size;
use super::replay::NonFiniteSample;
use super::ways::why_no_cache;
use crate::desc::{Bias, FilterDesc, IntegratorDesc, SamplerDesc};
use crate::film::{ErrorEstimate, ErrorMeasure, Estimates, Image, SampleCounts};

/// Smallest number of pixels for a note that few pixels have most of the error, as they always have in smaller images.
const MIN_PIXELS_FOR_TAIL_NOTE: u64 = 64;

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

impl Render {
    /// The bias of the image that error estimates do not include, if there is any.
    fn bias_outside_estimates(&self) -> Option<&'static str> {
        match self.integrator().info().bias {
            Bias::Biased(what) => Some(what),
            Bias::Unbiased | Bias::Consistent(_) | Bias::OfChoice => self.desc.max_depth.map(|_| "paths that are cut"),
        }
    }

    /// Why a choice of paths has left out the irradiance cache, where the user may want to know.
    fn note_on_bias(&self) -> Option<String> {
        let is_open = self.desc.integrator == IntegratorDesc::Auto && self.integrator() == IntegratorDesc::Path;
        let why = self.comparison.err().filter(|_| is_open)?;
        // Where a bias is not allowed, nothing is said unless allowing it would change something.
        let is_of_use = self.desc.allow_bias
            || self.found.is_some()
                && Size::of(&self.settings).is_some_and(Size::is_large)
                && why_no_cache(&self.scene, &self.settings, self.integrator()).is_none();
        is_of_use.then(|| format!("no pilot compared the irradiance cache with paths: {why}"))
    }

    /// What a user should know of a render that ended so, but of its errors.
    fn notes(&self, ended: Ended) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(choice) = &self.choice {
            notes.push(format!("auto chose {}: {}", choice.integrator.name(), choice.why));
        }
        notes.extend(self.note_on_bias());
        if let Some(found) = self.found.as_ref().filter(|found| found.shares()) {
            notes.push(format!(
                "pixels shared hits: a pilot expected the same error in {:.1} times less time",
                found.sharing
            ));
        }
        if let Some(found) = self.found.as_ref().filter(|found| found.traces_light()) {
            let times = if found.light < 10.0 { format!("{:.1}", found.light) } else { "more than 10".to_owned() };
            notes.push(format!(
                "light paths found caustics: a pilot expected the same error in {times} times less time"
            ));
        }
        if self.found.as_ref().is_some_and(|found| found.first_shadow_rays > 1) {
            let count = self.first_shadow_rays;
            notes.push(format!(
                "what the camera sees had {count} light samples for each path, as a pilot expected to pay"
            ));
        }
        notes.extend(self.plan.iter().flat_map(|plan| plan.notes().iter().cloned()));
        notes.extend(self.radiosity.iter().flat_map(|solution| solution.notes().iter().cloned()));
        if let Some(depth) = self.settings.desc.max_depth.filter(|_| self.integrator().info().cut_by_max_depth) {
            notes.push(format!("paths were cut after {depth} hits (maxDepth): the image is too dark"));
        }
        if self.settings.desc.sampler == SamplerDesc::Gaussian && self.settings.desc.filter != FilterDesc::Box {
            notes.push("the gaussian pattern is a pixel filter by itself: the filter was not used".to_owned());
        }
        if let Some(bias) = self.bias_outside_estimates().filter(|_| self.settings.target_error.is_some()) {
            notes.push(format!("the error that ended or judged the render does not know the bias of {bias}"));
        }
        if let Err(why) = self.adaptive {
            notes.push(format!("all pixels had the same number of samples: {why}"));
        }
        let is_asked_for = self.settings.adaptive == Some(true) && self.adaptive == Ok(true);
        if is_asked_for && self.stage.is_none() && ended != Ended::Cancelled {
            notes
                .push(format!("all pixels had the same number of samples: the first {PILOT} are too few to choose by"));
        }
        if self.non_finite > 0 {
            let first =
                self.non_finite_samples.first().map(|first| format!("; the first: {first}")).unwrap_or_default();
            notes.push(format!("{} samples were NaN or infinite and count as black{first}", self.non_finite));
        }
        notes
    }

    /// The summary of a run that took this time and ended so.
    pub(super) fn summary(&self, elapsed: Duration, ended: Ended) -> Summary {
        let mut notes = self.notes(ended);
        // The picture is not lost with its error.
        let Estimates { rel_mse, display, counts } = self.estimates(&ErrorMeasure::ALL).unwrap_or_default();
        let pixels = self.film.options().resolution.map(u64::from).into_iter().product::<u64>();
        if pixels >= MIN_PIXELS_FOR_TAIL_NOTE && rel_mse.is_some_and(|error| error.is_heavy_tailed()) {
            notes.push(
                "the estimated relMSE rests on few pixels, which rare bright paths have met: it may be off by far"
                    .to_owned(),
            );
        }
        Summary {
            elapsed,
            samples: self.samples,
            // They need no memory.
            sample_counts: counts.or_else(|| self.film.counts_unless(&self.settings.cancel)),
            integrator: match self.integrator() {
                IntegratorDesc::Radiosity => IntegratorDesc::Radiosity,
                _ if self.method.is_of_places() => IntegratorDesc::Path,
                integrator => integrator,
            },
            adaptive: self.stage.is_some(),
            reuse: matches!(self.method, Method::Reuse(_)),
            light_paths: self.light_paths.is_some(),
            first_shadow_rays: self.first_shadow_rays,
            rays: self.rays,
            rel_mse,
            display_error: display,
            ended,
            stopped: ended == Ended::Cancelled,
            non_finite: self.non_finite,
            non_finite_samples: self.non_finite_samples.clone(),
            notes,
            checkpoint_failure: None,
        }
    }
}
