//! The settings of a render.

use std::time::Duration;

use super::checkpoint::CheckpointPlan;
use super::share::Share;
use super::workers::Workers;
use crate::desc::RenderDesc;
use crate::film::ErrorMeasure;
use crate::spectrum::Sensor;
use crate::{Cancel, Error, ErrorKind, Result};

/// Settings of a render: what to render, and with how much effort.
#[derive(Clone, Debug, Default)]
pub struct RenderSettings {
    /// Resolution, samples, sampler, filter, integrator, seed and so on.
    pub desc: RenderDesc,
    /// Number of threads of the render's own pool; 0 means one per core. The image does not depend on it. It is ignored
    /// where `workers` are given.
    pub threads: usize,
    /// The workers of the render. With `None` the render starts a pool of its own.
    pub workers: Option<Workers>,
    /// The render ends after this time, in which its errors are estimated too, in the middle of a pass and of the photon maps for
    /// it. It does not apply before every pixel has one sample: these samples, and the photon maps or the irradiance cache that they
    /// need, take the time that they take, and a note of the summary says so. A radiosity solution is less accurate where there is no
    /// time for more, and a note says that; its first links, a fixed number of iterations, and that of a share or of light at given
    /// places take the time that they take. For a render that only time limits, set the number of samples to
    /// [`MOST_SAMPLES`](super::MOST_SAMPLES).
    pub time_limit: Option<Duration>,
    /// The target error, finite and > 0. The render ends when the estimated error plus a quarter of the estimate's standard
    /// error is at most the target error, but not before 32 samples per pixel, and not while few pixels have most of the
    /// error. The estimate is compared between passes.
    pub target_error: Option<f64>,
    /// The measure of `target_error`; relMSE by default. Adaptive sampling reduces the error in this measure.
    pub error_measure: ErrorMeasure,
    /// Whether pixels with larger errors get more samples; `samples` of `desc` is then the mean over pixels. `None` means
    /// adaptive sampling where there is a target error and `reuse` of `desc` is not `Some(true)`. All samplers but `Sobol` and `Random`,
    /// and photon maps that are built anew for each pass, need the same number of samples in each pixel. A render with them is not
    /// adaptive, and a note says so. In adaptive renders, pixels share no hits.
    pub adaptive: Option<bool>,
    /// The token that stops the render, from any thread.
    pub cancel: Cancel,
    /// Whether the film keeps albedo, normal and depth of the first hit.
    pub auxiliary: bool,
    /// Whether the film keeps apart what was emitted towards the camera and what was scattered once from what was scattered more often,
    /// as the layers `emission`, `direct` and `indirect`. With [`IntegratorDesc::Path`](crate::desc::IntegratorDesc::Path), which
    /// [`IntegratorDesc::Auto`](crate::desc::IntegratorDesc::Auto) then chooses, and `Direct`; other integrators, `reuse` and
    /// `light_paths` are refused, and no pilot chooses these two. Light maps and points have no such layers.
    pub light_parts: bool,
    /// What the channels of the film are, where `desc.spectral` says that paths carry wavelengths: the colours that the standard
    /// observer sees, or the means over three bands, to which the white balance does not apply.
    pub sensor: Sensor,
    /// Where and how often the render writes its [`Checkpoint`](super::Checkpoint); pictures only. A checkpoint that cannot be written
    /// ends no render: [`Summary::checkpoint_failure`](super::Summary::checkpoint_failure) says why.
    pub checkpoint: Option<CheckpointPlan>,
    /// The scene's [`fingerprint`](crate::desc::SceneDesc::fingerprint), which checkpoints keep, so that a render of another scene does
    /// not go on from them. Without one, that is left to the caller.
    pub fingerprint: Option<u64>,
    /// The part of the picture that is rendered, where several processes share it. Adaptive sampling and target errors, which look at
    /// the whole picture, are refused by name.
    pub share: Option<Share>,
}

impl RenderSettings {
    /// The workers that the settings name, or a pool that is started now.
    ///
    /// # Errors
    /// Those of [`Workers::pool`].
    pub(super) fn own_workers(&self) -> Result<Workers> {
        self.workers.as_ref().map_or_else(|| Workers::pool(self.threads), |workers| Ok(workers.clone()))
    }

    /// Checks what is not possible for a part of a picture, and for what is no picture but `place`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Unsupported`] with the name of what is not possible.
    pub(super) fn check_parts(&self, place: Option<&'static str>, is_adaptive: bool) -> Result<()> {
        let refuse = |message: String| Err(Error::new(ErrorKind::Unsupported, message));
        if let (Some(place), true) = (place, self.checkpoint.is_some() || self.share.is_some()) {
            return refuse(format!("{place} has no checkpoints and no shares; expected a picture"));
        }
        if self.share.is_some() && is_adaptive {
            return refuse(
                "adaptive sampling chooses among all pixels, of which a share has some; expected the same number of samples in all \
                 pixels"
                    .to_owned(),
            );
        }
        if self.share.is_some() && self.target_error.is_some() {
            return refuse(
                "a target error is one of the whole picture; expected a number of samples for a share".to_owned(),
            );
        }
        Ok(())
    }

    /// Checks the sensor.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `sensorBands` for bands that cannot be, and for bands of paths in three channels.
    pub(crate) fn check_sensor(&self) -> Result<()> {
        self.sensor.check("sensorBands")?;
        if self.sensor != Sensor::Observer && !self.desc.spectral {
            let message = "paths in three channels have no bands of wavelengths, expected `spectral` beside them";
            return Err(Error::invalid("sensorBands", message));
        }
        Ok(())
    }
}
