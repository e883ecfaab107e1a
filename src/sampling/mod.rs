//! Random and low-discrepancy numbers, warps to distributions with their densities, pixel filters.
//!
//! Every number in [0, 1) is strictly below 1. Warps state what they return and the density of it.

mod any;
mod bilinear;
mod cone;
mod distribution;
mod filter;
pub mod mis;
mod pattern;
mod piecewise_linear;
mod rng;
mod sobol;
mod spherical_triangle;
pub mod warps;

pub use any::AnySampler;
pub use bilinear::{BilinearGrid, GridSample};
pub use cone::DirectionCone;
pub use distribution::Distribution1D;
pub use filter::Filter;
pub(crate) use pattern::square_side;
pub use pattern::{Pattern, PatternSampler};
pub use piecewise_linear::PiecewiseLinear;
pub use rng::Rng;
pub(crate) use rng::{hash, mix};
pub use sobol::SobolSampler;
pub(crate) use spherical_triangle::solid_angle;
pub use spherical_triangle::{SphericalTriangle, triangle_solid_angle};

/// A source of sample points: one for each worker. Its state is a pure function of (seed, pixel, sample index), so that
/// any sample can be replayed alone and no result depends on the number of threads.
pub trait Sampler {
    /// Starts sample `sample` of pixel `pixel` (a linear index) at its first dimensions.
    fn start(&mut self, pixel: u32, sample: u32);

    /// The position in the pixel, in [0, 1)^2; the normally distributed pattern may leave the pixel. Repeated calls
    /// within a sample return the same position, which is independent of the results of `next_2d` and `next_4d`.
    fn pixel_2d(&mut self) -> [f32; 2];

    /// The next two dimensions, in [0, 1)^2.
    fn next_2d(&mut self) -> [f32; 2];

    /// The next four dimensions, in [0, 1)^4.
    fn next_4d(&mut self) -> [f32; 4];
}
