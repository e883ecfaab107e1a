//! Any bytes as the material library of a triangle with texture coordinates: they are refused with a message, or become materials of a
//! scene that builds.

#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use etendue::desc;
use etendue::scene::{BuildOptions, Scene};
use libfuzzer_sys::fuzz_target;

/// A folder, in memory where the system has a place for that, with a mesh whose library is `m.mtl`, and an image `i.png`.
fn folder() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
        let folder = folder.join(format!("etendue-fuzz-mtl-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n\
            usemtl n\nf 3/3 2/2 1/1\n";
        std::fs::write(folder.join("m.obj"), obj).expect("a file");
        // Eight bits of grey, 1 x 1.
        let image: [u8; 67] = [
            0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0, 0, 0, 0x0d, 0x49, 0x48, 0x44, 0x52, 0, 0, 0, 1, 0, 0, 0,
            1, 8, 0, 0, 0, 0, 0x3a, 0x7e, 0x9b, 0x55, 0, 0, 0, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0,
            0, 0, 0x82, 0, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0, 0, 0, 0, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
        ];
        std::fs::write(folder.join("i.png"), image).expect("a file");
        folder
    });
    folder.clone()
}

fuzz_target!(|data: &[u8]| {
    let folder = folder();
    std::fs::write(folder.join("m.mtl"), data).expect("a file");
    match desc::load(&folder.join("m.obj"), None) {
        Ok(scene) => match Scene::build(&scene, &BuildOptions::default()) {
            Ok(_) => {}
            Err(error) => assert!(error.kind() != etendue::ErrorKind::Internal, "{error}"),
        },
        Err(error) => {
            assert!(error.kind() != etendue::ErrorKind::Internal, "{error}");
            assert!(!error.message().is_empty() && error.message().len() < 2000, "{error}");
        }
    }
});
