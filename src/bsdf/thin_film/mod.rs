//! Films so thin that light which is reflected by their two faces interferes: soap, oil, oxides on metals, coats of lenses.
//!
//! What one film reflects is exact by [`Stack`]; [`FilmedInterface`] is a film between dielectrics, [`FilmedMetal`] one on a metal.
//! Paths that carry wavelengths get the reflectance at each of theirs. In three channels it is the mean that a sensor sees under D65
//! ([`Observed`]), which is worked out when a scene is built; where the thickness varies over a surface, for all of its thicknesses
//! ([`ObservedRange`]).

mod airy;
mod complex;
mod interface;
mod metal;
mod metal_index;
mod observed;
mod range;
mod tables;
#[cfg(test)]
mod tests;

use airy::Stack;
pub use interface::{FilmedInterface, Shares};
pub use metal::FilmedMetal;
use metal_index::complex_index_at;
use observed::Observed;
use range::ObservedRange;

use crate::desc::ThinFilmDesc;

/// Films of one index, whose thickness is one or varies over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmRange {
    /// Index of refraction.
    pub ior: f32,
    /// The least and the greatest thickness \[nm\].
    pub thickness: [f32; 2],
}

impl FilmRange {
    /// The numbers by which tables are told apart.
    fn bits(&self) -> [u32; 3] {
        [self.ior, self.thickness[0], self.thickness[1]].map(f32::to_bits)
    }

    /// Whether the thickness varies.
    pub fn varies(&self) -> bool {
        self.thickness[0] < self.thickness[1]
    }
}

impl From<ThinFilmDesc> for FilmRange {
    fn from(film: ThinFilmDesc) -> Self {
        Self { ior: film.ior, thickness: [film.thickness; 2] }
    }
}
