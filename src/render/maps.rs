//! The photon maps of a render, whose photons carry colours or wavelengths.

use std::sync::Arc;

use super::method::Method;
use crate::Result;
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::{IntegratorDesc, RenderDesc};
use crate::integrator::photon::{Plan, PlanState};
use crate::scene::Scene;
use crate::spectrum::{SampledSpectrum, Sensor};

/// The plan of the photon maps of a render.
pub(super) enum Maps {
    Colours(Plan),
    Wavelengths(Plan<SampledSpectrum>),
}

/// Asks whichever plan there is.
macro_rules! of_plan {
    ($maps:expr, $plan:ident => $answer:expr) => {
        match $maps {
            Maps::Colours($plan) => $answer,
            Maps::Wavelengths($plan) => $answer,
        }
    };
}

impl Maps {
    /// [`Plan::new`], in wavelengths where the settings say so.
    pub fn new(
        scene: &Scene,
        camera: &Camera,
        desc: &Arc<RenderDesc>,
        integrator: IntegratorDesc,
        sensor: Sensor,
    ) -> Result<Self> {
        Ok(if desc.spectral {
            Self::Wavelengths(Plan::in_spectrum(scene, camera, desc, integrator)?.for_sensor(sensor))
        } else {
            Self::Colours(Plan::new(scene, camera, desc, integrator)?)
        })
    }

    /// [`Plan::gather`].
    pub fn gather(&mut self, sample: u32, parallel: &mut impl Parallel) -> Result<Method> {
        Ok(match self {
            Self::Colours(plan) => Method::Gather(Box::new(plan.gather(sample, parallel)?)),
            Self::Wavelengths(plan) => Method::SpectralGather(Box::new(plan.gather_in_spectrum(sample, parallel)?)),
        })
    }

    /// The plan of an irradiance cache that paths may be compared with; `None` where it needs photon maps, or cannot be made.
    pub fn cache_alone(scene: &Scene, camera: &Camera, desc: &Arc<RenderDesc>) -> Option<Plan> {
        let plan = Plan::new(scene, camera, desc, IntegratorDesc::IrradianceCache).ok()?;
        plan.is_cache_alone().ok()?.then_some(plan)
    }

    /// [`Plan::state`].
    pub fn state(&self) -> Option<PlanState> {
        of_plan!(self, plan => plan.state())
    }

    /// [`Plan::resume`].
    pub fn resume(&mut self, state: PlanState) {
        of_plan!(self, plan => plan.resume(state));
    }

    /// [`Plan::samples_a_pass`].
    pub fn samples_a_pass(&self) -> Option<u32> {
        of_plan!(self, plan => plan.samples_a_pass())
    }

    /// [`Plan::remembers`].
    pub fn remembers(&self) -> bool {
        of_plan!(self, plan => plan.remembers())
    }

    /// [`Plan::notes`].
    pub fn notes(&self) -> &[String] {
        of_plan!(self, plan => plan.notes())
    }

    /// Number of rays traced for the maps.
    pub fn rays(&self) -> u64 {
        of_plan!(self, plan => plan.rays)
    }
}
