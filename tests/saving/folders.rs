//! What is in the folder after a scene was written, or was not.

use std::fs;
use std::path::Path;

use etendue::ErrorKind;
use etendue::desc::{self, BsdfDesc, CameraDesc, FilmDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceLook};
use etendue::math::{DAffine3, DVec3};
use etendue::spectrum::Rgb;

use super::everything;
use super::same::assert_same;

/// All files below a folder, with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.push((format!("{}/", path.display()), Vec::new()));
            found.extend(contents(&path));
        } else {
            found.push((path.display().to_string(), fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn a_scene_replaces_an_earlier_one_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    let scene = everything::scene();
    scene.save(&path).unwrap();
    let first = contents(folder.path());
    let files = SceneDesc::files_folder(&path);
    assert_eq!(files, folder.path().join("scene.files"));
    // 16 images, the meshes but the removed one, and a photometric web.
    assert_eq!(fs::read_dir(&files).unwrap().count(), 16 + 4 + 1);
    // The same scene gives the same files.
    scene.save(&path).unwrap();
    assert!(contents(folder.path()) == first, "the same scene gives other files");
    // What is not of an earlier scene stays.
    fs::write(files.join("notes.txt"), "mine").unwrap();
    fs::write(files.join("mesh-0.ply"), "mine").unwrap();
    let mut changed = scene.clone();
    let mesh = changed.find_mesh("with all").unwrap();
    let positions = vec![DVec3::X, DVec3::Y, DVec3::Z];
    changed.set_mesh(mesh, MeshDesc { positions, triangles: vec![[0, 1, 2]], ..MeshDesc::default() }).unwrap();
    changed.save(&path).unwrap();
    assert_eq!(fs::read_dir(&files).unwrap().count(), 16 + 4 + 1 + 2);
    assert_same(&changed, &desc::load(&path, None).unwrap(), "changed");
    // A scene is written over itself.
    let read = desc::load(&path, None).unwrap();
    read.save(&path).unwrap();
    assert_same(&changed, &desc::load(&path, None).unwrap(), "changed");
    // One without any files.
    SceneDesc::default().save(&path).unwrap();
    let mut left: Vec<_> = fs::read_dir(&files).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["mesh-0.ply", "notes.txt"]);
    fs::remove_file(files.join("notes.txt")).unwrap();
    fs::remove_file(files.join("mesh-0.ply")).unwrap();
    scene.save(&path).unwrap();
    SceneDesc::default().save(&path).unwrap();
    assert!(!files.exists(), "the folder is left");
}

#[test]
fn what_cannot_be_written_is_refused_and_leaves_everything_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    let scene = everything::scene();
    let assert_refused = |scene: &SceneDesc, path: &Path, kind: ErrorKind, what: &str| {
        let before = contents(folder.path());
        let error = scene.save(path).unwrap_err();
        assert_eq!(error.kind(), kind, "{error}");
        assert!(error.to_string().contains(what), "'{what}' is not in: {error}");
        assert!(error.to_string().contains(folder.path().to_str().unwrap()), "{error}");
        assert!(contents(folder.path()) == before, "files are left after: {error}");
    };
    for once_more in [false, true] {
        let name = |name: &str| folder.path().join(name);
        for wrong in ["scene.glb", "scene.ply", "scene", "scene.JSON"] {
            assert_refused(&scene, &name(wrong), ErrorKind::Unsupported, "ends in .json");
        }
        assert_refused(&scene, &name("no/scene.json"), ErrorKind::Io, "cannot write the scene into its folder");
        let changed = |change: &dyn Fn(&mut SceneDesc)| {
            let mut scene = scene.clone();
            change(&mut scene);
            scene
        };
        type Change = (&'static str, fn(&mut SceneDesc));
        let changes: [Change; 9] = [
            ("camera.lookAt", |scene| {
                scene.camera = CameraDesc::Perspective {
                    eye: DVec3::X,
                    look_at: DVec3::X,
                    up: DVec3::Y,
                    fov_deg: 40.0,
                    fov_axis: Default::default(),
                    film: FilmDesc::default(),
                }
            }),
            ("render.samples", |scene| scene.render.samples = 0),
            ("lights[0].origin[1]", |scene| scene.lights[0].position.y = f64::NAN),
            ("materials[0].color[0]", |scene| {
                scene.materials[0].bsdf = BsdfDesc::Lambert { albedo: Rgb::splat(f32::NAN) }
            }),
            ("surfaces[0].radius", |scene| {
                scene.surfaces[0].shape = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: f64::INFINITY }
            }),
            ("surfaces[0]: there is no material", |scene| scene.surfaces[0].material = Some(9999)),
            ("surfaces[0]: there is no mesh 2", |scene| {
                scene.surfaces[0].shape = ShapeDesc::Mesh { mesh: 2, smooth: false }
            }),
            ("surfaces[0]: the transform", |scene| scene.surfaces[0].transform.translation.x = f64::NAN),
            ("surfaces[0].normal: the normal has the length 1.0000005", |scene| {
                scene.surfaces[0].shape =
                    ShapeDesc::Disk { centre: DVec3::ZERO, normal: DVec3::Y * 1.000_000_5, radius: 1.0 }
            }),
        ];
        for (what, change) in changes {
            assert_refused(&changed(&change), &path, ErrorKind::InvalidScene, what);
        }
        // A float image that is a colour in one place and none in another has no colour space in a file.
        let mut ambiguous = scene.clone();
        let number = ambiguous.find_texture("image 4").unwrap();
        let mut texture = (*ambiguous.textures[number]).clone();
        if let etendue::desc::TextureSource::Image(it) = &mut texture.source {
            (it.color_space, it.suggested_space) = (None, etendue::texture::ColorSpace::Srgb);
        }
        ambiguous.set_texture(number, texture).unwrap();
        assert_refused(&ambiguous, &path, ErrorKind::InvalidScene, "textures[3].colorSpace");
        if !once_more {
            // The folder's name is taken.
            fs::write(name("scene.files"), "mine").unwrap();
            assert_refused(&scene, &path, ErrorKind::Io, "the name is taken by something else");
            fs::remove_file(name("scene.files")).unwrap();
            // What it leads to may be the files of another scene.
            fs::create_dir(name("other.files")).unwrap();
            std::os::unix::fs::symlink(name("other.files"), name("scene.files")).unwrap();
            assert_refused(&scene, &path, ErrorKind::Io, "is a symbolic link");
            fs::remove_file(name("scene.files")).unwrap();
            // Again, with a scene that must stay.
            scene.save(&path).unwrap();
        }
    }
}

/// Arrays of a host become a mesh of the description, and surfaces that share a mesh share it in the file.
#[test]
fn meshes_are_written_once() {
    let mut scene = everything::scene();
    let mesh = scene.find_mesh("of a host").unwrap();
    for x in 0..3 {
        let transform = DAffine3::from_translation(DVec3::X * f64::from(x));
        let look = SurfaceLook { material: Some(0), transform, ..SurfaceLook::default() };
        scene.add_surface(ShapeDesc::Mesh { mesh, smooth: true }, DAffine3::IDENTITY, look).unwrap();
    }
    let again = super::same::saved(&scene);
    assert_same(&scene, &again, "with a host's mesh");
    assert_eq!(again.find_mesh("of a host"), Some(mesh - 1));
    assert_eq!(again.meshes.len(), scene.meshes.len() - 1);
}
