//! Photon mapping: light paths from the emitters, maps of what they leave, and eye paths that read them.
//!
//! `emit` begins light paths, `trace` follows them and keeps photons, `map` puts them in order; `gather` follows eye paths,
//! `estimate` asks maps, `coverage` and `cut` know where a disk is whole and what is left of one that is not; `plan` says which
//! maps a method wants and when, `radius` how wide estimates are; `choose` which method a scene.
//!
//! Right where light reaches diffuse surfaces by mirrors and glass from small lights, and where it is smooth; wrong in the
//! open, where most photons leave the scene, and for glossy surfaces (none yet). All estimates have a bias, which shrinks
//! with the square of the radius; that of the progressive methods (`caustic`, `ppm`, `sppm`) vanishes as passes go on.
//!
//! `"integrator": "caustic"` and so on, with the keys of `docs/scene-format.md`.
//!
//! Sources: Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, *Realistic Image Synthesis Using Photon
//! Mapping*; Hachisuka, Ogaki, Jensen 2008, "Progressive Photon Mapping"; Hachisuka and Jensen 2009, "Stochastic Progressive
//! Photon Mapping"; Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach"; Hachisuka, Jarosz,
//! Jensen 2010, "A Progressive Error Estimation Framework for Photon Density Estimation".

mod aim;
mod choose;
mod coverage;
mod cut_disk;
mod draw;
mod emit;
mod estimate;
mod gather;
mod map;
mod order;
mod plan;
mod radius;
mod record;
mod trace;

pub use choose::{Choice, choose};
pub use draw::{DrawSettings, colour, draw};
pub(in crate::integrator) use emit::{Aim, Emission};
pub use estimate::{Kernel, MapQuery, irradiance};
pub use gather::Gather;
pub use map::{Nearest, PhotonMap};
pub use plan::Plan;
pub use radius::shrunk;
pub use record::{Octahedral, Photon};
pub use trace::{MapKind, PhotonBatch, PhotonJob, Tally, shoot, shoot_in};
