//! Options for building a scene.

use std::sync::Arc;

use crate::Cancel;
use crate::embree::Device;

/// Options for building a scene. None of them changes an image, except for rounding.
#[derive(Clone, Default)]
pub struct BuildOptions {
    /// Number of threads for Embree's builds; 0 means one per core. It is not used where a device is given.
    pub threads: usize,
    /// Embree's device; `None` opens one for the scene. [`Scene::rebuild`](super::Scene::rebuild) keeps the device that
    /// the scene has.
    pub device: Option<Device>,
    /// Whether geometry will be changed, added or removed later. If so, larger meshes get hierarchies of their own, and
    /// so do many single triangles and shapes, so that [`Scene::rebuild`](super::Scene::rebuild) rebuilds only the parts that changed, at some cost for each ray.
    pub dynamic: bool,
    /// Stops the build with [`crate::ErrorKind::Cancelled`].
    pub cancel: Cancel,
    /// Called with the finished fraction, which only grows, from one thread at a time. The function must not use the
    /// device.
    pub progress: Option<Arc<dyn Fn(f64) + Send + Sync>>,
    /// The greatest number of analytic shapes that are tested in a list before Embree; more shapes become user
    /// geometry. `None` lets the library choose. The option is for measurements.
    pub listed_shapes: Option<usize>,
}
