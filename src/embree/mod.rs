//! The only room that talks to Embree: which primitive does a ray meet first, and does it meet any.
//!
//! [`Device`] is the library's own handle, [`SceneBuilder`] collects geometry, [`SceneBuilder::commit`] turns it into
//! an immutable [`Scene`] that any number of threads may query at once. Coordinates are single precision, in the frame
//! and unit of the scene; `t` counts in lengths of the ray's direction.
//!
//! ```
//! use etendue::embree::{Device, DeviceOptions, SceneBuilder, SceneOptions, TriangleMesh};
//! use etendue::math::{Ray, Vec3};
//!
//! let device = Device::new(&DeviceOptions::default())?;
//! let mut builder = SceneBuilder::new(&device, SceneOptions::default())?;
//! let corners = vec![[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]];
//! builder.add_triangles(TriangleMesh::new(corners, vec![[0, 1, 2]])?)?;
//! let scene = builder.commit(None)?;
//!
//! let hit = scene.intersect(&Ray::new(Vec3::new(0.25, 0.25, 0.0), Vec3::Z)).expect("the triangle is in the way");
//! // Its division is an estimate with one step of Newton's, whose last digit differs among processors.
//! assert!(hit.prim == 0 && (hit.t - 2.0).abs() < 1e-6);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! # What cannot be written
//!
//! A scene answers queries only once it is built, and is fixed from then on:
//!
//! ```compile_fail,E0599
//! # use etendue::{embree::*, math::{Ray, Vec3}};
//! # let device = Device::new(&DeviceOptions::default())?;
//! let builder = SceneBuilder::new(&device, SceneOptions::default())?;
//! builder.intersect(&Ray::new(Vec3::ZERO, Vec3::Z)); // no such method before commit
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! ```compile_fail,E0382
//! # use etendue::embree::*;
//! # let device = Device::new(&DeviceOptions::default())?;
//! let mut builder = SceneBuilder::new(&device, SceneOptions::default())?;
//! let scene = builder.commit(None)?;
//! builder.add_spheres(vec![[0.0, 0.0, 0.0, 1.0]])?; // the builder is gone
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! ```compile_fail,E0599
//! # use etendue::embree::*;
//! # let device = Device::new(&DeviceOptions::default())?;
//! let scene = SceneBuilder::new(&device, SceneOptions::default())?.commit(None)?;
//! scene.add_spheres(vec![[0.0, 0.0, 0.0, 1.0]])?; // a built scene takes nothing more
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! A buffer that a scene may read cannot be changed, and geometry cannot borrow what may go away:
//!
//! ```compile_fail,E0599
//! # use etendue::embree::*;
//! let mut vertices = VertexBuffer::new(vec![[0.0; 3]])?;
//! *vertices.get_mut(0) = [1.0; 3]; // read only
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! ```compile_fail,E0597
//! # use etendue::{embree::*, math::Ray};
//! # use std::sync::Arc;
//! struct Borrowing<'a>(&'a [f32]);
//! # impl UserGeometry for Borrowing<'static> {
//! #     fn len(&self) -> usize { 1 }
//! #     fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) { ([0.0; 3], [1.0; 3]) }
//! #     fn intersect(&self, _: usize, _: &Ray) -> Option<UserHit> { None }
//! # }
//! # let device = Device::new(&DeviceOptions::default())?;
//! let mut builder = SceneBuilder::new(&device, SceneOptions::default())?;
//! let radii = [1.0_f32];
//! builder.add_user(Arc::new(Borrowing(&radii)))?; // does not live long enough
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! Nor can geometry that is not safe to use from several threads be traced:
//!
//! ```compile_fail,E0277
//! # use etendue::{embree::*, math::Ray};
//! struct Counting(std::cell::Cell<u32>);
//! impl UserGeometry for Counting {
//!     // `Cell` is not `Sync`
//! #     fn len(&self) -> usize { 1 }
//! #     fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) { ([0.0; 3], [1.0; 3]) }
//! #     fn intersect(&self, _: usize, _: &Ray) -> Option<UserHit> { None }
//! }
//! ```
//!
//! Source: Wald et al. 2014, "Embree: A Kernel Framework for Efficient CPU Ray Tracing".
#![allow(unsafe_code)]

mod budget;
mod builder;
mod commit;
mod device;
mod mesh;
mod packet;
mod ray;
mod scene;
#[allow(clippy::undocumented_unsafe_blocks)]
mod sys;
mod user;
mod width;

pub use budget::{Charge, MemoryBudget};
pub use builder::{BuildQuality, GeometryId, SceneBuilder, SceneOptions};
pub(crate) use device::instruction_set;
pub use device::{Device, DeviceOptions};
pub use mesh::{MAX_COORDINATE, MAX_TIME_STEPS, TriangleMesh, VertexBuffer};
pub use packet::PACKET;
pub use ray::Hit;
pub use scene::{Features, Scene};
pub use user::{UserGeometry, UserHit};
