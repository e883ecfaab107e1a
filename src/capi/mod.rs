//! The C interface, which `include/etendue.h` declares. It uses the public interface of the crate, and no other module uses
//! it.
//!
//! `tests/header.rs` generates the header from this module, and the comments become the reference manual. `boundary` checks
//! pointers and handles and catches panics. `status` has the status values and the last error of each thread, which
//! `last_error` returns to the host. `progress` has progress callbacks, and `types` the plain structures. Each kind of object
//! has a file of its own. A `task` is the handle of a started render, whose state is in `work`.
//!
//! Objects are [`std::sync::Arc`]s whose pointers the host holds. An object keeps the objects that it needs alive, so the host
//! may release objects in any order. Every function may be called from any thread. Where two calls would conflict, a lock
//! makes them wait or a status refuses one of them. No lock is held while a function of the host is called.
#![allow(unsafe_code, non_camel_case_types)]

mod bake;
mod boundary;
mod camera;
mod checkpoint;
mod describe;
mod device;
mod environment;
mod film;
mod film_output;
mod film_size;
mod float_state;
mod group;
mod host_rays;
mod last_error;
mod light;
mod lighting;
mod material;
mod mattes;
mod mesh;
mod motion;
mod progress;
mod query;
mod ray_columns;
mod read;
mod scene;
mod shape;
mod sharing;
mod sky;
mod spectrum;
mod status;
mod surface;
mod task;
mod texture;
mod types;
mod work;

pub use bake::*;
pub use checkpoint::*;
pub use describe::*;
pub use device::*;
pub use environment::*;
pub use film::*;
pub use film_output::*;
pub use film_size::*;
pub use group::*;
pub use last_error::*;
pub use light::*;
pub use lighting::*;
pub use material::*;
pub use mattes::*;
pub use mesh::*;
pub use motion::*;
pub use query::*;
pub use scene::*;
pub use shape::*;
pub use sky::*;
pub use spectrum::*;
pub use status::*;
pub use surface::*;
pub use task::*;
pub use texture::*;
pub use types::*;
