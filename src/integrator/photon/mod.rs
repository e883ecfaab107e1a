//! Photon mapping: light paths from the emitters, maps of the photons that they store, and eye paths that query the maps.
//!
//! `emit` samples the first rays of light paths, `trace` follows light paths and stores photons, and `map` builds photon
//! maps. `division` says which lobes maps hold and which ones paths follow. `gather` follows eye paths and `estimate`
//! queries maps; `coverage` tests where the surface covers a kernel's disk, and `cut_disk` measures what is left of a
//! disk that is cut off. `plan` decides which maps a method needs and when, `radius` how wide estimates are, and `choose`
//! which method suits a scene.
//!
//! Photon mapping suits scenes where light reaches diffuse surfaces by mirrors and glass from small lights, and scenes with
//! smooth indirect light. It does not suit open scenes, where most photons leave the scene, or glossy surfaces, where no
//! photons are stored. All estimates are biased, and the bias shrinks with the square of the radius; that of the progressive
//! methods (`caustic`, `ppm`, `sppm`) vanishes as passes go on.
//!
//! `"integrator": "caustic"` and so on, with the keys of `docs/scene-format.md`.
//!
//! Sources: Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, *Realistic Image Synthesis Using Photon
//! Mapping*; Hachisuka, Ogaki, Jensen 2008, "Progressive Photon Mapping"; Hachisuka and Jensen 2009, "Stochastic Progressive
//! Photon Mapping"; Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach"; Hachisuka, Jarosz,
//! Jensen 2010, "A Progressive Error Estimation Framework for Photon Density Estimation".

mod choose;
pub(crate) mod coverage;
mod cut_disk;
mod division;
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
pub use division::NARROW;
pub use draw::{DrawSettings, colour, draw};
pub(in crate::integrator) use emit::{Aim, Emission};
pub use estimate::{Kernel, MapQuery, irradiance};
pub use gather::Gather;
pub use map::{Nearest, PhotonMap};
pub use plan::{Plan, PlanState};
pub use radius::shrunk;
pub use record::{Octahedral, Photon};
pub use trace::{MapKind, PhotonBatch, PhotonJob, Tally, shoot, shoot_in};
