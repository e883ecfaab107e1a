//! Settings of radiosity, their keys in the `render` block, and the limits on their numbers.

use serde::Deserialize;

use super::json::{Whole, join};
use super::render::Render;
use super::validate;
use crate::Result;

/// Most iterations of a radiosity solution, or bodies that shoot.
pub const MAX_RADIOSITY_ITERATIONS: u32 = 1 << 24;

/// Most memory that a radiosity solution can be given (MiB).
pub const MAX_RADIOSITY_MEMORY: u32 = 1 << 20;

/// How a radiosity solution is made and shown. What is not radiosity is not affected by it.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiosityDesc {
    /// Elements whose longest side is no longer than this are not divided any more, scene units, > 0; `None`: a 64th of the
    /// extent of the scene.
    pub element_size: Option<f64>,
    /// What one link between elements may be wrong by, in thousandths of all irradiance: both in the root of the mean square
    /// over surfaces; in (0, 1000]. Smaller means more elements and more links.
    pub error: f64,
    /// Iterations: gathered ones are bounces of light, shot ones bodies that shoot, up to [`MAX_RADIOSITY_ITERATIONS`]; `None`:
    /// until what is left is below `tolerance`. 0 shows the light sources alone.
    pub iterations: Option<u32>,
    /// Share of the solution that may be left to iterate for, in (0, 1).
    pub tolerance: f64,
    /// How the system is solved.
    pub solver: RadiositySolver,
    /// Whether a solution that was stopped by `iterations` is shown with the mean of the light that was not yet distributed:
    /// for previews.
    pub ambient: bool,
    /// Whether pictures take indirect light from one ray into the solution at what the camera sees, and direct light from light
    /// samples, instead of interpolating the solution.
    pub final_gather: bool,
    /// Most memory of elements and links (MiB), from 1 to [`MAX_RADIOSITY_MEMORY`].
    pub memory: u32,
}

impl Default for RadiosityDesc {
    fn default() -> Self {
        Self {
            element_size: None,
            error: 1.0,
            iterations: None,
            tolerance: 1e-4,
            solver: RadiositySolver::Gather,
            ambient: false,
            final_gather: false,
            memory: 1024,
        }
    }
}

/// How a radiosity system is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RadiositySolver {
    /// Every element gathers from all others, again and again.
    #[default]
    Gather,
    /// The body that has most light left shoots it: progressive refinement (Cohen et al. 1988).
    Shoot,
}

/// How a radiosity system is solved, in a file.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Solver {
    /// Every element gathers from all others, again and again.
    Gather,
    /// The body that has most light left shoots it.
    Shoot,
}

/// Reads the settings of radiosity. Settings that the block does not contain keep their values from `base`.
pub(super) fn radiosity(block: &Render<'_>, path: &str, base: &RadiosityDesc) -> Result<RadiosityDesc> {
    let at = |key: &str| join(path, key);
    let iterations = match block.radiosity_iterations {
        None => base.iterations,
        Some(None) => None,
        Some(Some(count)) => Some(iterations(&at("radiosityIterations"), count)?),
    };
    let radiosity = RadiosityDesc {
        element_size: block.radiosity_element_size.or(base.element_size),
        error: block.radiosity_error.unwrap_or(base.error),
        iterations,
        tolerance: block.radiosity_tolerance.unwrap_or(base.tolerance),
        solver: block.radiosity_solver.map_or(base.solver, |solver| match solver {
            Solver::Gather => RadiositySolver::Gather,
            Solver::Shoot => RadiositySolver::Shoot,
        }),
        ambient: block.radiosity_ambient.unwrap_or(base.ambient),
        final_gather: block.radiosity_final_gather.unwrap_or(base.final_gather),
        memory: match block.radiosity_memory {
            Some(memory) => memory_limit(&at("radiosityMemory"), memory)?,
            None => base.memory,
        },
    };
    check_radiosity(path, &radiosity)?;
    Ok(radiosity)
}

/// Checks that the format could have given these numbers. `path` is the path of the block.
pub(crate) fn check_radiosity(path: &str, radiosity: &RadiosityDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    if let Some(size) = radiosity.element_size {
        validate::length(&at("radiosityElementSize"), size, "a length")?;
    }
    validate::up_to(&at("radiosityError"), radiosity.error, 1000.0)?;
    validate::share(&at("radiosityTolerance"), radiosity.tolerance)?;
    if let Some(count) = radiosity.iterations {
        iterations(&at("radiosityIterations"), Whole(count.into()))?;
    }
    memory_limit(&at("radiosityMemory"), Whole(radiosity.memory.into())).map(|_| ())
}

fn iterations(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 0, MAX_RADIOSITY_ITERATIONS.into())
}

fn memory_limit(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, MAX_RADIOSITY_MEMORY.into())
}
