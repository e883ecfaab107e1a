//! Photon mapping: light paths from the emitters, maps of what they leave, and eye paths that read them.

mod choose;
mod cut;
mod draw;
mod emit;
mod estimate;
mod gather;
mod map;
mod order;
mod plan;
mod record;
mod trace;
mod whole;

pub use choose::{Choice, choose};
pub use draw::{DrawSettings, colour, draw};
pub use estimate::{Asked, Kernel, irradiance};
pub use gather::Gather;
pub use map::{Nearest, PhotonMap};
pub use plan::{Plan, shrunk};
pub use record::{Octahedral, Photon};
pub use trace::{Job, MapKind, Shot, Tally, shoot};
