//! The C interface: what `include/etendue.h` declares. Nothing in the crate uses it; it uses everything public.
//!
//! The header is generated from this module by `tests/header.rs` and reads as the manual. In here: `boundary` is the
//! border (pointers, panics, handles), `status` what came of a call, `last_error` how a host asks for it, `progress` what the host is told before, `types` the plain
//! structures, and one file for each kind of object. A `task` is the handle, and `work` what it is for.
//!
//! Objects are [`std::sync::Arc`]s whose pointer the host holds: what one needs of another it keeps itself, so they may be
//! released in any order. Every function may be called from any thread; where two calls would disturb each other, locks
//! or a status keep them apart. No lock is held while a function of the host is called.
#![allow(unsafe_code, non_camel_case_types)]

mod bake;
mod boundary;
mod describe;
mod device;
mod film;
mod last_error;
mod mesh;
mod progress;
mod query;
mod read;
mod scene;
mod status;
mod surface;
mod task;
mod types;
mod work;

pub use bake::*;
pub use describe::*;
pub use device::*;
pub use film::*;
pub use last_error::*;
pub use mesh::*;
pub use query::*;
pub use scene::*;
pub use status::*;
pub use surface::*;
pub use task::*;
pub use types::*;
