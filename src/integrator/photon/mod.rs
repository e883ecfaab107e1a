//! Photon maps.

mod emit;
mod map;
mod record;
mod trace;

pub use map::{Nearest, PhotonMap};
pub use record::{Octahedral, Photon};
pub use trace::{Job, MapKind, Shot, Tally, shoot};
