//! Photon maps.

mod map;
mod order;
mod record;

pub use map::{Nearest, PhotonMap};
pub use record::{Octahedral, Photon};
