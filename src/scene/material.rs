//! Materials as shading wants them.

use super::SurfaceInteraction;
use crate::bsdf::{Bsdf, Lobes, Model as _};
use crate::spectrum::{Rgb, Spectrum};

/// A material with its constants worked out. It is asked at a hit how the surface scatters there.
///
/// One that is the same all over its surfaces holds its [`Bsdf`] from the build of the scene on, and an answer is a copy of it.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    pub(super) bsdf: Bsdf,
    /// Probability with which a path survives a bounce here, where Russian roulette uses the one that the scene states.
    pub survival: Option<f32>,
}

impl Material {
    /// A material that is the same everywhere, where paths end by the library's own roulette.
    pub fn uniform(bsdf: Bsdf) -> Self {
        Self { bsdf, survival: None }
    }

    /// How a surface of this material scatters at a hit, in the channels of a path.
    #[inline(always)]
    pub fn at<C: Spectrum>(&self, _interaction: &SurfaceInteraction, wavelengths: &C::Wavelengths) -> Bsdf<C> {
        self.bsdf.in_spectrum(wavelengths)
    }

    /// All lobes that it has anywhere; none where it is black everywhere.
    pub fn lobes(&self) -> Lobes {
        if self.bsdf.is_black() { Lobes::empty() } else { self.bsdf.lobes() }
    }

    /// The Bsdf whose colours are the means over the surface: what solvers with one value for each element take.
    pub fn mean(&self) -> &Bsdf {
        &self.bsdf
    }

    /// The share of the irradiance that its diffuse lobes send back at a hit, as a colour; 0 for other lobes.
    pub fn diffuse_albedo(&self, _interaction: &SurfaceInteraction) -> Rgb {
        if self.bsdf.lobes().have_diffuse() { self.bsdf.albedo() } else { Rgb::ZERO }
    }
}
