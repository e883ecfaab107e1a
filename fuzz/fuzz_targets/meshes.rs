//! Any bytes as a mesh file of a format that the first byte chooses: they are refused with a message, or are a scene by themselves.

#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use etendue::desc;
use libfuzzer_sys::fuzz_target;

/// A file for each extension, in memory where the system has a place for that. The last one has none of a known format.
fn file(kind: u8) -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
        let folder = folder.join(format!("etendue-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    });
    folder.join(["m.ply", "m.stl", "m.obj", "m"][usize::from(kind % 4)])
}

fuzz_target!(|data: &[u8]| {
    let Some((kind, content)) = data.split_first() else { return };
    let path = file(*kind);
    std::fs::write(&path, content).expect("a file");
    let scene = if kind % 4 == 3 {
        let mut scene = desc::SceneDesc::default();
        scene.add_mesh_file("", &path).map(|_| scene)
    } else {
        desc::load(&path, None)
    };
    match scene {
        Ok(scene) => {
            assert!(scene.meshes.iter().any(|mesh| !mesh.triangles.is_empty()));
            for mesh in &scene.meshes {
                let count = mesh.positions.len();
                assert!(mesh.triangles.iter().flatten().all(|vertex| (*vertex as usize) < count));
                assert!(mesh.positions.iter().all(|position| position.as_vec3().is_finite()));
                assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
                assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
                assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
                assert!(mesh.colors.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
            }
        }
        Err(error) => {
            assert!(error.kind() != etendue::ErrorKind::Internal, "{error}");
            assert!(!error.message().is_empty() && error.message().len() < 2000, "{error}");
        }
    }
});
