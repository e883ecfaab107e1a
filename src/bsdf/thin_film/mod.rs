//! Films so thin that light which is reflected by their two faces interferes: soap, oil, oxides on metals, coats of lenses.
//!
//! What one film reflects is exact by [`Stack`]; [`FilmedInterface`] is a film between dielectrics, [`FilmedMetal`] one on a metal.
//! Paths that carry wavelengths get the reflectance at each of theirs. In three channels it is the mean that a sensor sees under D65
//! ([`Observed`]), which is worked out when a scene is built.

mod airy;
mod complex;
mod interface;
mod metal;
mod metal_index;
mod observed;
mod tables;
#[cfg(test)]
mod tests;

use airy::Stack;
pub use interface::{FilmedInterface, Shares};
pub use metal::FilmedMetal;
use metal_index::complex_index_at;
use observed::Observed;
