//! How a scene is built.

use std::sync::Arc;

use crate::Cancel;
use crate::embree::Device;

/// How to build a scene; nothing here changes an image, but for rounding.
#[derive(Clone, Default)]
pub struct BuildOptions {
    /// Threads for Embree's builds; 0 means one per core. Not used where a device is given.
    pub threads: usize,
    /// Embree's device; `None` opens one for the scene. [`Scene::rebuild`](super::Scene::rebuild) stays with the one that the scene has.
    pub device: Option<Device>,
    /// Whether geometry will be changed, added or removed later: larger meshes then get hierarchies of their own, so that
    /// [`Scene::rebuild`](super::Scene::rebuild) touches only what changed, at some cost for each ray.
    pub dynamic: bool,
    /// Stops the build with [`crate::ErrorKind::Cancelled`].
    pub cancel: Cancel,
    /// Told the finished fraction, which only grows, from one thread at a time; must not use the device.
    pub progress: Option<Arc<dyn Fn(f64) + Send + Sync>>,
    /// Fixes how many analytic shapes may be tested in a list before Embree; more become user geometry. `None` lets the
    /// library choose. For measurements.
    pub listed_shapes: Option<usize>,
}
