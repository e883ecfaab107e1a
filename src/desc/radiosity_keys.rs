//! Reads the settings of radiosity in the `render` block, and checks the limits on their numbers.

use super::json::{Whole, join};
use super::render_block::{Render, Solver};
use super::{MAX_RADIOSITY_ITERATIONS, MAX_RADIOSITY_MEMORY, RadiosityDesc, RadiositySolver, validate};
use crate::Result;

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
