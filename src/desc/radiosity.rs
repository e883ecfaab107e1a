//! Settings of radiosity.

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
