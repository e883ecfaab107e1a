//! Thin films on surfaces.

use super::json::join;
use super::validate::{up_to, within};
use crate::Result;

/// The greatest thickness of a film \[nm\].
pub const THICKEST_FILM: f64 = 10_000.0;

/// The greatest index of refraction of a film.
const MOST: f64 = 100.0;

/// A film on the outer side of a surface, so thin that light which its two faces reflect interferes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilmDesc {
    /// Thickness \[nm\], in [0, 10 000]. A film of thickness 0 is none.
    pub thickness: f32,
    /// Index of refraction, above 0 and up to 100.
    pub ior: f32,
}

impl ThinFilmDesc {
    /// Checks the numbers of a film at this path.
    pub(super) fn check(&self, path: &str) -> Result<()> {
        within(&join(path, "thickness"), self.thickness.into(), 0.0, THICKEST_FILM)?;
        up_to(&join(path, "refractionIndex"), self.ior.into(), MOST)
    }
}
