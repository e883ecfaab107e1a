//! Descriptions that are written as scene files and read again: the same description, and the same image bit for bit.

#[path = "../common/mod.rs"]
mod common;
mod everything;
#[path = "../gltf/file.rs"]
#[allow(dead_code)]
mod file;
mod folders;
mod random;
mod same;

use std::path::{Path, PathBuf};

use common::scenes::{Job, render};
use common::snippets::{data_dir, snippets};
use etendue::desc::{self, BackplateDesc, KeyPlace, LoadOptions, MotionDesc, MotionKey, SceneDesc};
use etendue::math::{DAffine3, DVec3};
use etendue::spectrum::Rgb;
use same::{assert_same, saved};
use serde_json::json;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = folder.read_dir().expect("the folder of scenes").map(|entry| entry.expect("an entry").path());
    entries.filter(|path| path.extension().is_some_and(|extension| extension == "json")).collect()
}

#[test]
fn scenes_of_the_repository_come_back() {
    let mut count = 0;
    for path in scenes() {
        match desc::load(&path, None) {
            Ok(scene) => {
                assert_same(&scene, &saved(&scene), &path.display().to_string());
                count += 1;
            }
            Err(error) if path.ends_with("million.json") => eprintln!("SKIPPED: {error} (`make meshes` makes it)"),
            Err(error) => panic!("{error}"),
        }
    }
    assert!(count >= 9, "{count} scenes");
}

/// The document has an example of every kind of element, and of every key of `render`.
#[test]
fn examples_of_the_document_come_back() {
    let mut count = 0;
    for (kind, snippet, text) in snippets() {
        if kind != "params" {
            let scene = desc::parse(&text, &data_dir(), None).unwrap_or_else(|error| panic!("{error}: {snippet}"));
            assert_same(&scene, &saved(&scene), &snippet);
            count += 1;
        }
    }
    assert!(count > 50, "{count} examples");
}

/// Placements are written as such where nothing of them was changed but their names and their motion, and as surfaces otherwise.
#[test]
fn placements_of_groups_come_back() {
    let mut scene = everything::scene();
    scene.motion.surfaces.clear();
    // Webs, lamps, quadrics and meshes are among them.
    let surfaces: Vec<usize> = (0..scene.surfaces.len()).filter(|number| !scene.surfaces[*number].hidden).collect();
    let thirds: Vec<usize> = surfaces.iter().copied().step_by(3).collect();
    let all = scene.add_group("", &surfaces).unwrap();
    let some = scene.add_group("some", &thirds).unwrap();
    let moved = |x: f64| DAffine3::from_translation(DVec3::new(x, 1.0 / 3.0, 0.0)) * DAffine3::from_rotation_y(0.1 * x);
    let placed = [all, some, all, some, some, some, all].map(|group| (group, scene.placements.len()));
    let placed: Vec<usize> = placed
        .into_iter()
        .enumerate()
        .map(|(i, (group, _))| scene.place_group(group, moved(100.0 * i as f64)).unwrap())
        .collect();
    let first = |scene: &SceneDesc, i: usize| scene.placements[placed[i]].surfaces.start;
    // One has another material, one a name, one moves, one was removed, and one has surfaces with two names.
    let surface = first(&scene, 2);
    let other = (scene.surfaces[surface].material.unwrap() + 1) % 3;
    scene.set_surface_material(surface, Some(other)).unwrap();
    for surface in scene.placements[placed[3]].surfaces.clone() {
        scene.set_surface_name(surface, "one").unwrap();
    }
    let key = |time: f64, x: f64| MotionKey { time, place: KeyPlace::Matrix(moved(x)) };
    let motion = MotionDesc { keys: vec![key(0.0, 0.0), key(1.0, 0.2)] };
    scene.set_placement_motion(placed[4], Some(motion.clone())).unwrap();
    scene.remove_placement(placed[5]).unwrap();
    scene.set_surface_name(first(&scene, 6), "other").unwrap();
    let again = saved(&scene);
    assert_same(&scene, &again, "groups");
    assert_same(&again, &saved(&again), "groups, twice");
    assert_eq!(again.fingerprint().unwrap(), saved(&again).fingerprint().unwrap());
    assert_eq!(again.groups.len(), 2);
    assert_eq!(again.find_group("some"), Some(some));
    let kept: Vec<_> = again.placements.iter().map(|it| (it.group, it.transform)).collect();
    let expected = [0, 1, 3, 4].map(|i| (scene.placements[placed[i]].group, moved(100.0 * f64::from(i as u8))));
    assert_eq!(kept, expected);
    let named = &again.placements[2].surfaces;
    assert!(again.surfaces.range(named.clone()).unwrap().all(|surface| surface.name == "one"));
    let moving: Vec<usize> = again.motion.surfaces.keys().copied().collect();
    assert_eq!(moving, again.placements[3].surfaces.clone().collect::<Vec<_>>());
    // Names of surfaces are none of the fingerprint, in groups too.
    let before = scene.fingerprint().unwrap();
    for surface in scene.placements[placed[0]].surfaces.clone() {
        scene.set_surface_name(surface, "renamed").unwrap();
    }
    assert_eq!(scene.fingerprint().unwrap(), before);
}

/// Shapes with names keep them: a file of people stays one of people.
#[test]
fn names_of_quadrics_stay() {
    let scene = desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/quadrics.json"), None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    scene.save(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let before = std::fs::read_to_string(scene.file.as_ref().expect("its file")).unwrap();
    for name in ["cylinder", "cone", "paraboloid", "ellipsoid", "disk", "sphere"] {
        let count = |text: &str| text.matches(&format!("\"geometry\": \"{name}\"")).count();
        assert_eq!(count(&text), count(&before), "{name}: {text}");
    }
    assert!(text.lines().all(|line| line.len() < 140), "lines are long: {text}");
}

/// A file needs a material or an emission of every surface, and a lamp without a material that is switched off has neither.
#[test]
fn surfaces_without_a_material_come_back() {
    let camera = r#""camera": {"origin": [0, 0, 5], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60}"#;
    let disk = |x: i32| {
        format!(
            r#"{{"geometry": "disk", "origin": [{x}, 0, 0], "normal": [0, 0, 1], "radius": 0.5, "emission": [1, 2, 3]}}"#
        )
    };
    let text = format!(r#"{{"etendue": 1, {camera}, "surfaces": [{}, {}]}}"#, disk(0), disk(1));
    let mut scene = desc::parse(&text, &data_dir(), None).unwrap();
    scene.set_emission(1, None).unwrap();
    let again = saved(&scene);
    assert_eq!((again.materials.len(), again.surfaces[0].material, again.surfaces[1].material), (0, None, None));
    assert_eq!(again.surfaces[1].emission, None);
    assert_same(&scene, &again, "without a material");
}

#[test]
fn every_model_texture_shape_and_setting_comes_back() {
    let scene = everything::scene();
    everything::assert_complete(&scene);
    let again = saved(&scene);
    assert_same(&scene, &again, "everything");
    // What has been read once has a form of its own, which is written in the same way.
    assert_same(&again, &saved(&again), "everything, twice");
    for sky in everything::skies() {
        let scene = SceneDesc { environment: Some(sky), ..SceneDesc::default() };
        assert_same(&scene, &saved(&scene), "sky");
    }
    for backplate in [BackplateDesc::even(Rgb::ONE), BackplateDesc::even(Rgb::new(0.1, 0.0, 7.0))] {
        let scene = SceneDesc { backplate: Some(backplate), ..SceneDesc::default() };
        assert_same(&scene, &saved(&scene), "backplate");
    }
    for camera in everything::cameras() {
        let scene = SceneDesc { camera, ..SceneDesc::default() };
        assert_same(&scene, &saved(&scene), "camera");
    }
    for render in everything::settings() {
        let scene = SceneDesc { render, ..SceneDesc::default() };
        assert_same(&scene, &saved(&scene), "render");
    }
}

fn assert_same_image(scene: &SceneDesc, what: &str) {
    let job = Job { resolution: [20, 16], samples: 4, ..Job::default() };
    let [before, after] = [scene, &saved(scene)].map(|scene| render(scene, &job).0);
    let bits = |image: &etendue::film::Image| image.rgb.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert!(bits(&before) == bits(&after), "{what}: the images differ");
    let first = before.rgb[0];
    assert!(before.rgb.iter().any(|value| *value != first), "{what}: the image shows nothing");
}

#[test]
fn images_are_the_same_bit_for_bit() {
    for name in ["scenes/textures.json", "scenes/materials.json", "scenes/quadrics.json", "scenes/caustic-glass.json"] {
        assert_same_image(&desc::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(name), None).unwrap(), name);
    }
    assert_same_image(&desc::load(&data_dir().join("parts.obj"), None).unwrap(), "parts.obj");
    let everything = SceneDesc { render: Job::default().desc(), ..everything::scene() };
    assert_same_image(&everything, "everything");
}

/// A glTF file with what only such files have: angles in radians, absorption of principled bodies, matrices, embedded images.
#[test]
fn a_scene_of_gltf_comes_back() {
    let mut gltf = file::File::triangle();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.3], [0.3, 0.2, 1.1]];
    let positions = gltf.floats(3, corners.as_flattened());
    let uvs = gltf.floats(2, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.7, 0.6]);
    let indices = gltf.whole(file::UNSIGNED_SHORT, 1, &[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]);
    let mut png = std::io::Cursor::new(Vec::new());
    image::GrayImage::from_fn(7, 5, |x, y| image::Luma([(37 * x + 50 * y) as u8]))
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let view = gltf.view(png.get_ref());
    gltf.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    gltf.push("textures", json!({"source": 0}));
    for (number, angle) in [0.1, 0.7, 1.1, 2.3, -2.9, 1.9].into_iter().enumerate() {
        let anisotropy = json!({"anisotropyStrength": 0.6, "anisotropyRotation": angle});
        let volume = json!({"thicknessFactor": 1.0, "attenuationDistance": 0.7, "attenuationColor": [0.3, 0.9, 0.5]});
        let transform =
            json!({"KHR_texture_transform": {"rotation": angle, "scale": [1.3, 0.7], "offset": [0.1, 0.2]}});
        let texture = json!({"index": 0, "extensions": transform});
        // Bodies that absorb light have no textures.
        let material = if number % 2 == 0 {
            json!({"pbrMetallicRoughness": {"metallicFactor": 0.0}, "extensions": {
                "KHR_materials_transmission": {"transmissionFactor": 1.0},
                "KHR_materials_volume": volume,
                "KHR_materials_anisotropy": anisotropy,
            }})
        } else {
            json!({
                "extensions": {"KHR_materials_anisotropy": anisotropy},
                "pbrMetallicRoughness": {"metallicRoughnessTexture": texture, "metallicFactor": 0.5},
            })
        };
        let material = gltf.push("materials", material);
        let attributes = json!({"POSITION": positions, "TEXCOORD_0": uvs});
        let mesh = gltf.push(
            "meshes",
            json!({"primitives": [{"attributes": attributes, "indices": indices, "material": material}]}),
        );
        let turned = [0.0, 0.0, (angle / 2.0_f64).sin(), (angle / 2.0_f64).cos()];
        let node = gltf.push(
            "nodes",
            json!({"mesh": mesh, "rotation": turned, "translation": [1.5 * number as f64, 0.3, 0.0], "scale": [1.0, -0.8, 1.2]}),
        );
        gltf.root["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    }
    let scene = gltf.load().unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert!(scene.materials.iter().any(|material| material.medium.is_some()), "no body absorbs");
    assert_eq!(scene.textures.len(), 3);
    assert_same(&scene, &saved(&scene), "glTF");
    assert_same_image(&scene, "glTF");
}

/// Files of other programs, from Debian's package assimp-testmodels.
#[test]
fn files_of_other_programs_come_back() {
    let models = Path::new("/usr/share/assimp/models");
    if !models.join("glTF2").is_dir() {
        eprintln!("SKIPPED: {} is not there (package assimp-testmodels)", models.join("glTF2").display());
        return;
    }
    for (name, time) in [
        ("glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", None),
        ("glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", None),
        ("glTF2/textureTransform/TextureTransformTest.gltf", None),
        ("glTF2/simple_skin/simple_skin.gltf", Some(0.5)),
        ("OBJ/spider.obj", None),
        ("PLY/Wuson.ply", None),
    ] {
        let options = LoadOptions { time, ..LoadOptions::default() };
        let scene = desc::load_with(&models.join(name), None, &options).unwrap();
        assert_same(&scene, &saved(&scene), name);
        assert_same_image(&scene, name);
    }
}
