//! Étendue: physically based rendering for programs that link a renderer.
//!
//! Light flows one way through the rooms of this crate: description ([`desc`]) → scene → integrator → [`film`] → output.
#![deny(unsafe_code, missing_docs, unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

pub mod bsdf;
pub mod camera;
pub mod desc;
pub mod embree;
pub mod emitter;
mod error;
pub mod film;
pub mod integrator;
pub mod math;
pub mod output;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod shape;
pub mod spectrum;

pub use error::{Error, ErrorKind, Location, Result};
