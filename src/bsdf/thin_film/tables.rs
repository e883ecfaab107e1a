//! The tables of films, which are worked out once for films that are alike.

use std::sync::Arc;

use super::{FilmRange, Observed, ObservedRange, Stack};
use crate::bsdf::memo::memo;
use crate::spectrum::Rgb;

/// What a table depends on, as bits of numbers; of a film its index, and the least and the greatest thickness.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// The lower and the higher index of two dielectrics; the film.
    Dielectric([u64; 2], [u32; 3]),
    /// n and k of a metal per channel; the film.
    Metal([u32; 3], [u32; 3], [u32; 3]),
    /// n and k of a metal by nanometres; the film.
    MeasuredMetal(Box<[u32]>, [u32; 3]),
}

/// The reflectance of a film in three channels.
#[derive(Debug, PartialEq)]
pub enum Table {
    /// Of one thickness.
    One(Observed),
    /// Of any thickness within a range.
    Range(ObservedRange),
}

impl Table {
    /// The reflectance at a cosine in [0, 1], of a film of this thickness \[nm\].
    #[inline]
    pub fn at(&self, cos: f32, thickness: f32) -> Rgb {
        match self {
            Self::One(observed) => observed.at(cos),
            Self::Range(range) => range.at(cos, thickness.into()),
        }
    }

    /// The mean reflectance for light from all sides, where it is known.
    pub fn mean(&self, thickness: f32) -> Option<Rgb> {
        match self {
            Self::One(_) => None,
            Self::Range(range) => Some(range.mean(thickness.into())),
        }
    }
}

memo!(
    /// Tables of 8 kB, or of up to 9 MB for a range of thicknesses (0.7 MB for soap of up to 1000 nm).
    TABLES: Key => Arc<Table>, 256
);

/// The table of films. `front`: the index in front of them; `stack`: a film of a thickness \[nm\] at a wavelength \[nm\].
pub fn table(key: Key, film: FilmRange, front: f64, stack: impl Fn(f64, f64) -> Stack) -> Arc<Table> {
    TABLES.get(&key, || {
        let index = f64::from(film.ior);
        let [from, to] = film.thickness.map(f64::from);
        Arc::new(if from == to {
            Table::One(Observed::new(index * from, |cos, nanometres| stack(from, nanometres).reflectance(cos)))
        } else {
            Table::Range(ObservedRange::new([from, to], [index, front], |nanometres| stack(1.0, nanometres)))
        })
    })
}
