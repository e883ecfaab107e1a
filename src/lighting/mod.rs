//! Lighting design: illuminance \[lx\] and luminance \[cd m^-2\] at given points, and the figures that designers read from them.
//!
//! A [`Calculation`] finds the light at the points of a grid ([`GridDesc`]) with the passes, replicates, budgets and threads
//! of any other render: by unbiased paths, so that mirrors and glass count, or by a radiosity solution where the settings'
//! integrator is radiosity. Each value has a standard error. [`Measured::statistics`] gives mean, least, greatest and
//! uniformity; [`exterior_illuminance`] is what daylight factors refer to.
//!
//! Illuminance is the luminance-weighted irradiance (weights of Rec. 709) times [`LUMENS_PER_WATT`], so that a lamp of 683 lm
//! is one of 1 W. Photometric webs and the photometric keys of scene files use the same number, which therefore has no
//! influence on values in lux of lamps that are given in lumens or candela.
//!
//! ```
//! use std::ops::ControlFlow;
//! use etendue::desc::{GridDesc, GridPoints};
//! use etendue::lighting::{Calculation, target_of};
//! use etendue::math::DVec3;
//! use etendue::render::RenderSettings;
//! use etendue::scene::{BuildOptions, Scene};
//!
//! let desc = etendue::desc::load("scenes/cornell.json".as_ref(), None)?;
//! let scene = Scene::build(&desc, &BuildOptions::default())?;
//! let points = GridPoints::Points { points: vec![DVec3::new(278.0, 100.0, 280.0)], normals: vec![DVec3::Y] };
//! let grid = GridDesc { name: "middle".to_owned(), points };
//! let mut settings = RenderSettings { target_error: Some(target_of(0.05)), ..RenderSettings::default() };
//! settings.desc.samples = 4096;
//! let mut calculation = Calculation::new(&scene, &grid, settings)?;
//! calculation.run(&mut |_| ControlFlow::Continue(()))?;
//! let measured = calculation.measured();
//! assert!(measured.values[0] > 10.0 * measured.standard_errors[0]);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! Sources: CIE S 017 (the quantities); CIE 171:2006 (the test cases, `docs/photometry.md`); EN 12464-1 (uniformity).

mod daylight;

pub use daylight::{daylight_only, exterior_illuminance};

use std::ops::ControlFlow;

use crate::Cancel;
use crate::desc::GridDesc;
use crate::error::Result;
use crate::integrator::{Probe, ProbeQuantity, Probes};
use crate::math::DVec3;
use crate::photometry::LUMENS_PER_WATT;
use crate::render::{Progress, Render, RenderSettings, Summary};
use crate::room::{check_room, collected};
use crate::scene::Scene;

/// The target error of render settings, a relMSE, that asks for this relative standard error: the root of the mean square over
/// the points of a grid. Points that are much darker than the grid's mean count with their error over a tenth of the mean.
pub fn target_of(relative_error: f64) -> f64 {
    relative_error * relative_error
}

/// A calculation of the light at the points of a grid.
pub struct Calculation {
    render: Render,
    count: usize,
}

/// Illuminance \[lx\] or luminance \[cd m^-2\] of the points of a grid, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The values; 0 where there is no sample yet.
    pub values: Vec<f64>,
    /// Their standard errors; NaN where there are fewer than four samples.
    pub standard_errors: Vec<f64>,
}

/// Figures of a grid, in the unit of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The mean over the points.
    pub mean: f64,
    /// The standard error of the mean.
    pub mean_error: f64,
    /// The least value. Of values with noise it is too low by about their standard error.
    pub min: f64,
    /// The greatest value, which noise makes too high likewise.
    pub max: f64,
    /// Uniformity U0: least value over mean; NaN where all values are 0.
    pub uniformity: f64,
    /// The greatest standard error of a value over that value; NaN where a value has no standard error, or where a value is
    /// 0 and has one.
    pub worst_relative_error: f64,
}

/// Memory of a point while a calculation begins or its results are read.
const BYTES_A_POINT: usize = size_of::<[DVec3; 2]>() + size_of::<Probe>() + 2 * Probes::BYTES_A_POINT;

impl Calculation {
    /// Prepares to find the light at the points of a grid.
    ///
    /// Resolution, filter and auxiliary layers of the settings are not used. `desc.integrator` may be radiosity; any other
    /// one means path tracing. Of illuminance, `max_depth` counts the point itself as the first hit: 1 is direct light
    /// alone. For a relative error that is aimed at, see [`target_of`]. Results depend on scene, grid, `desc.samples`, target
    /// error, seed and sampler alone, not on threads.
    ///
    /// # Errors
    /// Those of [`GridDesc::check`], with paths from `grid` on, and of [`Render::probes`].
    pub fn new(scene: &Scene, grid: &GridDesc, settings: RenderSettings) -> Result<Self> {
        grid.check("grid")?;
        let quantity = if grid.is_luminance() { ProbeQuantity::Radiance } else { ProbeQuantity::Irradiance };
        let count = grid.count();
        // The points as they are described, as probes and as the render has them; later there are the results in their place.
        check_room(count.saturating_mul(BYTES_A_POINT))?;
        let probe = |[position, direction]: [DVec3; 2]| Probe { position, direction };
        let probes = collected(grid.places().into_iter().map(probe), count)?;
        Ok(Self { render: Render::probes(scene, settings, &probes, quantity)?, count: probes.len() })
    }

    /// Goes on until samples or time are used up, the target error is reached, or the callback stops it; see
    /// [`Render::run`]. "Pixels" are points here.
    ///
    /// # Errors
    /// As for [`Render::run`].
    pub fn run(&mut self, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Summary> {
        self.render.run(progress)
    }

    /// What stops the next [`Calculation::run`].
    pub fn set_cancel(&mut self, cancel: Cancel) {
        self.render.set_cancel(cancel);
    }

    /// The same as [`Calculation::measured`], with an error where there is no memory for the results.
    ///
    /// # Errors
    /// [`ErrorKind::OutOfMemory`](crate::ErrorKind::OutOfMemory).
    pub fn try_measured(&self) -> Result<Measured> {
        check_room(self.count.saturating_mul(BYTES_A_POINT))?;
        Ok(self.measured())
    }

    /// The present results.
    pub fn measured(&self) -> Measured {
        let luminances = self.render.film().luminances();
        let found = luminances.iter().take(self.count);
        Measured {
            values: found.clone().map(|[mean, _]| LUMENS_PER_WATT * mean).collect(),
            standard_errors: found.map(|[_, variance]| LUMENS_PER_WATT * variance.sqrt()).collect(),
        }
    }
}

impl Measured {
    /// The figures of these values; `None` where there are none.
    pub fn statistics(&self) -> Option<Statistics> {
        if self.values.is_empty() {
            return None;
        }
        let count = self.values.len() as f64;
        let mean = self.values.iter().sum::<f64>() / count;
        // Samples of different points are independent.
        let mean_error = self.standard_errors.iter().map(|error| error * error).sum::<f64>().sqrt() / count;
        let min = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let relative = |(value, error): (&f64, &f64)| if *error == 0.0 { 0.0 } else { error / value };
        let errors = self.values.iter().zip(&self.standard_errors).map(relative);
        // A maximum that keeps NaN.
        let worst = errors.fold(0.0, |worst: f64, error| if worst.is_nan() || error <= worst { worst } else { error });
        let worst_relative_error = if worst.is_finite() { worst } else { f64::NAN };
        Some(Statistics { mean, mean_error, min, max, uniformity: min / mean, worst_relative_error })
    }

    /// The same values over a reference with its standard error, such as the exterior illuminance: daylight factors as
    /// fractions.
    #[must_use]
    pub fn relative_to(&self, (reference, reference_error): (f64, f64)) -> Self {
        let share = (reference_error / reference).powi(2);
        let error = |(value, error): (&f64, &f64)| (error * error + value * value * share).sqrt() / reference;
        Self {
            values: self.values.iter().map(|value| value / reference).collect(),
            standard_errors: self.values.iter().zip(&self.standard_errors).map(error).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_values() {
        let measured = Measured { values: vec![300.0, 500.0, 400.0], standard_errors: vec![3.0, 4.0, 0.0] };
        let Statistics { mean, mean_error, min, max, uniformity, worst_relative_error } =
            measured.statistics().unwrap();
        assert_eq!((mean, min, max, uniformity), (400.0, 300.0, 500.0, 0.75));
        assert!((mean_error - 5.0 / 3.0).abs() < 1e-12 && (worst_relative_error - 0.01).abs() < 1e-12);
        assert_eq!(Measured::default().statistics(), None);
        let dark = Measured { values: vec![0.0; 2], standard_errors: vec![0.0; 2] }.statistics().unwrap();
        assert!(dark.uniformity.is_nan() && dark.worst_relative_error == 0.0);
        for error in [1.0, f64::NAN] {
            let unknown = Measured { values: vec![0.0, 1.0], standard_errors: vec![error, 0.1] }.statistics().unwrap();
            assert!(unknown.worst_relative_error.is_nan());
        }
    }

    #[test]
    fn factors_have_the_errors_of_both() {
        let measured = Measured { values: vec![200.0], standard_errors: vec![6.0] };
        let factor = measured.relative_to((10_000.0, 400.0));
        assert!((factor.values[0] - 0.02).abs() < 1e-15);
        assert!((factor.standard_errors[0] - 0.02 * 0.05).abs() < 1e-12, "3 % and 4 % are 5 %");
    }
}
