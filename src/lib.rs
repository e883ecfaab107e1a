//! Étendue: physically based rendering for programs that link a renderer.
//!
//! ```
//! use std::ops::ControlFlow;
//! use etendue::render::{Render, RenderSettings};
//! use etendue::scene::{BuildOptions, Scene};
//!
//! let mut desc = etendue::desc::load("scenes/cornell.json".as_ref(), None)?;
//! desc.render.resolution = [32, 32];
//! desc.render.samples = 4;
//! let scene = Scene::build(&desc, &BuildOptions::default())?;
//! let mut render = Render::new(&scene, RenderSettings { desc: desc.render, ..RenderSettings::default() })?;
//! render.run(&mut |_| ControlFlow::Continue(()))?;
//! assert!(render.image().mean()[0] > 0.1);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! Light flows one way through the rooms of this crate:
//!
//! - description: [`desc`] reads scene files into plain data;
//! - scene: [`scene`] builds what rays can ask, from [`shape`], [`bsdf`], [`emitter`], [`camera`] and [`embree`];
//! - integrator: [`integrator`] turns a ray into radiance, with numbers from [`sampling`];
//! - film: [`film`] keeps sums and errors; [`render`] fills it with all threads;
//! - results: [`bake`] finds the irradiance of surfaces, [`lighting`] lux and candela at given points;
//! - output: [`output`] writes and compares images.
//!
//! Units: radiance W m^-2 sr^-1, lengths in scene units, angles in radians unless a name says degrees; colours are
//! scene-linear with Rec. 709 primaries.
#![deny(unsafe_code, missing_docs, unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

pub mod bake;
pub mod bsdf;
pub mod buffer;
pub mod camera;
#[cfg(feature = "capi")]
pub mod capi;
mod control;
pub mod desc;
pub mod embree;
pub mod emitter;
mod error;
pub mod film;
mod image;
pub mod integrator;
pub mod lighting;
pub mod math;
pub mod output;
pub mod photometry;
pub mod render;
mod replace;
mod room;
mod rows;
pub mod sampling;
pub mod scene;
pub mod shape;
pub mod spectrum;
pub mod texture;

pub use control::{Alone, Cancel, Parallel};
pub use error::{Error, ErrorKind, Location, Result};

/// The README's example compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
