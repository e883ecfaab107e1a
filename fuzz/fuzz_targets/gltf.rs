//! Any bytes as a glTF file, text or binary: they are refused with a message, or they become a scene that builds.

#![no_main]

use std::path::Path;
use std::sync::OnceLock;

use etendue::ErrorKind;
use etendue::desc::{self, LoadOptions};
use etendue::embree::{Device, DeviceOptions};
use etendue::scene::{BuildOptions, Scene};
use libfuzzer_sys::fuzz_target;

/// One device for all runs: threads are not what is tested here.
fn device() -> Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    let make = || Device::new(&DeviceOptions { threads: 1, ..DeviceOptions::default() }).expect("a device");
    DEVICE.get_or_init(make).clone()
}

fuzz_target!(|data: &[u8]| {
    // The first byte chooses whether an animation is seen.
    let Some((choice, bytes)) = data.split_first() else { return };
    let options = LoadOptions { time: (choice & 1 == 1).then_some(0.5), ..LoadOptions::default() };
    // No file is to be found: what is tested is the text.
    match desc::parse_gltf(bytes, Path::new("/nowhere"), None, &options) {
        Err(error) => {
            assert!(!error.message().is_empty());
            assert_ne!(error.kind(), ErrorKind::Internal, "{error}");
        }
        // A short file may ask for millions of instances; what is tested is that nothing breaks.
        Ok(scene) if scene.surfaces.len() > 1000 || scene.meshes.iter().any(|mesh| mesh.triangles.len() > 1000) => {}
        Ok(scene) => {
            let options = BuildOptions { threads: 1, device: Some(device()), ..BuildOptions::default() };
            if let Err(error) = Scene::build(&scene, &options) {
                assert_ne!(error.kind(), ErrorKind::Internal, "{error}");
            }
        }
    }
});
