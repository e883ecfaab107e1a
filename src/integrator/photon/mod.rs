//! Photon maps.

mod cut;
mod emit;
mod estimate;
mod gather;
mod map;
mod plan;
mod order;
mod record;
mod trace;
mod whole;

pub use estimate::Kernel;
pub use gather::Gather;
pub use plan::{Plan, shrunk};
pub use map::{Nearest, PhotonMap};
pub use record::{Octahedral, Photon};
pub use trace::{Job, MapKind, Shot, Tally, shoot};
