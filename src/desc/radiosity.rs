//! Settings of radiosity.

/// Greatest number of iterations of a radiosity solution.
pub const MAX_RADIOSITY_ITERATIONS: u32 = 1 << 24;

/// Greatest memory limit that a radiosity solution can be given (MiB).
pub const MAX_RADIOSITY_MEMORY: u32 = 1 << 20;

/// How a radiosity solution is computed and shown. The settings have no effect on other integrators.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiosityDesc {
    /// Elements whose longest side is at most this long are not subdivided, scene units, > 0. `None` means a 64th of the
    /// scene's extent.
    pub element_size: Option<f64>,
    /// Greatest error of one link between elements, in thousandths of all irradiance, in (0, 1000]. Error and irradiance are both
    /// roots of the mean square over surfaces. A smaller value gives more elements and more links.
    pub error: f64,
    /// Number of iterations, up to [`MAX_RADIOSITY_ITERATIONS`]. Gathering counts bounces of light, and shooting counts bodies that
    /// shoot. With `None`, the iteration ends at `tolerance`. With 0, the image shows the light sources alone.
    pub iterations: Option<u32>,
    /// Fraction of the solution that may be missing when the iteration ends, in (0, 1).
    pub tolerance: f64,
    /// How the system is solved.
    pub solver: RadiositySolver,
    /// Whether the image of a solution that `iterations` has ended includes the mean of the light that was not yet distributed.
    /// This serves previews.
    pub ambient: bool,
    /// Whether images take direct light from light samples and indirect light from one ray into the solution at each visible
    /// point, instead of interpolating the solution.
    pub final_gather: bool,
    /// Memory limit of elements and links (MiB), from 1 to [`MAX_RADIOSITY_MEMORY`].
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
    /// In each iteration, every element gathers light from all others.
    #[default]
    Gather,
    /// In each step, the body with most unshot light distributes it: progressive refinement (Cohen et al. 1988).
    Shoot,
}
