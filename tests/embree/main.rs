//! The Embree room against plain double-precision intersection tests, and against misuse.

mod agreement;
mod build;
mod limits;
mod motion;
mod reference;
mod special_rays;
mod threads;
mod user_geometry;

use etendue::embree::{Device, DeviceOptions, Scene, SceneBuilder, SceneOptions, TriangleMesh};

/// A device with the default options.
fn device() -> Device {
    Device::new(&DeviceOptions::default()).expect("Embree starts")
}

/// A scene of one mesh.
fn mesh_scene(device: &Device, options: SceneOptions, mesh: &TriangleMesh) -> Scene {
    let mut builder = SceneBuilder::new(device, options).expect("a scene");
    builder.add_triangles(mesh.clone()).expect("a mesh");
    builder.commit(None).expect("a build")
}

/// A distance without its last bits, which depend on the processor's reciprocals.
fn rounded(t: f32) -> f32 {
    const STEPS: f32 = (1 << 20) as f32;
    (t * STEPS).round() / STEPS
}
