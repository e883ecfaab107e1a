//! Materials in the form that shading uses.

use super::SurfaceInteraction;
use crate::bsdf::{Bsdf, Lobes, Model as _};
use crate::spectrum::{Rgb, Spectrum};

/// A material whose constants are precomputed. At a hit, [`Material::at`] returns the Bsdf of the surface there.
///
/// A material that is the same all over its surfaces stores its [`Bsdf`] when the scene is built, and every query
/// returns a copy of that Bsdf.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    pub(super) bsdf: Bsdf,
    /// Probability with which a path survives a bounce at this material, where Russian roulette uses the probability
    /// that the scene states.
    pub survival: Option<f32>,
}

impl Material {
    /// Makes a material that is the same everywhere, and at which paths end by the library's own roulette.
    pub fn uniform(bsdf: Bsdf) -> Self {
        Self { bsdf, survival: None }
    }

    /// Returns the Bsdf of this material at a hit, in the channels of a path.
    #[inline(always)]
    pub fn at<C: Spectrum>(&self, _interaction: &SurfaceInteraction, wavelengths: &C::Wavelengths) -> Bsdf<C> {
        self.bsdf.in_spectrum(wavelengths)
    }

    /// All lobes that the material has anywhere. There are none where the material is black everywhere.
    pub fn lobes(&self) -> Lobes {
        if self.bsdf.is_black() { Lobes::empty() } else { self.bsdf.lobes() }
    }

    /// The Bsdf whose colours are the means over the surface, for solvers that have one value for each element.
    pub fn mean(&self) -> &Bsdf {
        &self.bsdf
    }

    /// The share of the irradiance that the diffuse lobes reflect at a hit, as a colour. Other lobes give 0.
    pub fn diffuse_albedo(&self, _interaction: &SurfaceInteraction) -> Rgb {
        if self.bsdf.lobes().have_diffuse() { self.bsdf.albedo() } else { Rgb::ZERO }
    }
}
