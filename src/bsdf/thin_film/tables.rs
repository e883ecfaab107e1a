//! The tables of films, which are worked out once for films that are alike.

use std::sync::Arc;

use super::Observed;
use crate::bsdf::memo::memo;

/// What a table depends on, as bits of numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// The lower and the higher index of two dielectrics; index and thickness of the film.
    Dielectric([u64; 4]),
    /// n and k of a metal per channel; index and thickness of the film.
    Metal([u32; 3], [u32; 3], [u64; 2]),
    /// n and k of a metal by nanometres; index and thickness of the film.
    MeasuredMetal(Box<[u32]>, [u64; 2]),
}

memo!(
    /// Tables of 8 kB.
    TABLES: Key => Arc<Observed>, 256
);

/// The table of a reflectance by cosine and wavelength \[nm\], of a film of this optical thickness \[nm\].
pub fn table(key: Key, path: f64, reflectance: impl Fn(f64, f64) -> f64) -> Arc<Observed> {
    TABLES.get(&key, || Arc::new(Observed::new(path, reflectance)))
}
