//! glTF files as scenes: each feature beside the scene that says the same in the native format, and broken files.

mod common;
#[path = "gltf/file.rs"]
mod file;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use common::scenes::render_scene;
use etendue::ErrorKind;
use etendue::desc::{self, CameraDesc, FovAxis, LightDistribution, LoadOptions, MaterialDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DMat3, DQuat, DVec3};
use etendue::scene::{BuildOptions, Scene};
use file::*;
use proptest::prelude::*;
use serde_json::{Value, json};

/// The corners of a surface's triangles in the world.
fn corners(scene: &SceneDesc, surface: usize) -> Vec<[DVec3; 3]> {
    let surface = &scene.surfaces[surface];
    let ShapeDesc::Mesh { mesh, .. } = surface.shape else { panic!("expected a mesh") };
    let (mesh, to_world) = (&scene.meshes[mesh], surface.to_world());
    let corner = |vertex: u32| to_world.transform_point3(mesh.positions[vertex as usize]);
    mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect()
}

fn mesh_of(scene: &SceneDesc, surface: usize) -> &Arc<desc::MeshDesc> {
    let ShapeDesc::Mesh { mesh, .. } = scene.surfaces[surface].shape else { panic!("expected a mesh") };
    &scene.meshes[mesh]
}

#[track_caller]
fn near(found: DVec3, expected: [f64; 3]) {
    let expected = DVec3::from_array(expected);
    assert!((found - expected).length() < 1e-6, "{found}, expected {expected}");
}

/// The only warning.
#[track_caller]
fn one_warning(scene: &SceneDesc) -> &str {
    assert_eq!(scene.warnings.len(), 1, "{:#?}", scene.warnings);
    &scene.warnings[0]
}

/// Five points of which strips and fans make three triangles.
const POINTS: [f32; 15] = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 2.0, 0.0, 0.0];

#[test]
fn strips_fans_and_indices_of_every_size_are_triangles() {
    let load = |mode: u32, indices: Option<(u32, &[i64])>| {
        let mut file = File::new();
        let positions = file.floats(3, &POINTS);
        let mut primitive = json!({"attributes": {"POSITION": positions}, "mode": mode});
        if let Some((kind, indices)) = indices {
            primitive["indices"] = json!(file.whole(kind, 1, indices));
        }
        file.push("meshes", json!({"primitives": [primitive]}));
        file.push("nodes", json!({"mesh": 0}));
        file.load().map(|scene| (mesh_of(&scene, 0).triangles.clone(), scene))
    };
    let strip: Vec<[u32; 3]> = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4]];
    for kind in [UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT] {
        let list: Vec<i64> = strip.iter().flatten().map(|index| i64::from(*index)).collect();
        assert_eq!(load(4, Some((kind, &list))).unwrap().0, strip, "{kind}");
        assert_eq!(load(5, Some((kind, &[0, 1, 2, 3, 4]))).unwrap().0, strip, "{kind}");
        assert_eq!(load(6, Some((kind, &[4, 3, 2, 1]))).unwrap().0, [[3, 2, 4], [2, 1, 4]], "{kind}");
    }
    assert_eq!(load(5, None).unwrap().0, strip);
    assert_eq!(load(6, None).unwrap().0, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    // The corners that make no triangle are named.
    let (triangles, scene) = load(4, None).unwrap();
    assert_eq!(triangles, [[0, 1, 2]]);
    assert!(one_warning(&scene).starts_with("the corners after the last whole triangle"), "{:?}", scene.warnings);
    // All triangles of a strip show the same side.
    let (_, scene) = load(5, None).unwrap();
    for [a, b, c] in corners(&scene, 0) {
        assert!((b - a).cross(c - a).z < 0.0);
    }
    for (mode, what) in [(0, "points"), (1, "lines"), (2, "lines"), (3, "lines")] {
        let error = load(mode, None).unwrap_err();
        assert!(
            error.to_string().contains(&format!("no surface that can be drawn ({what} are not drawn: meshes[0]")),
            "{error}"
        );
    }
}

/// A square of two triangles with normals and texture coordinates, in all the ways that accessors allow.
#[test]
fn attributes_are_read_from_every_layout() {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
    let normals = [0.0_f32, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let uvs = [0.0_f32, 0.0, 1.0, 0.0, 1.0, 1.0];
    let load = |file: &mut File, attributes: Value| {
        file.push("meshes", json!({"primitives": [{"attributes": attributes}]}));
        file.push("nodes", json!({"mesh": 0}));
        file.load().unwrap()
    };
    let mut plain = File::new();
    let [p, n, t] = [plain.floats(3, &positions), plain.floats(3, &normals), plain.floats(2, &uvs)];
    let plain = load(&mut plain, json!({"POSITION": p, "NORMAL": n, "TEXCOORD_0": t}));
    let expected = mesh_of(&plain, 0);
    assert_eq!(expected.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert!(matches!(plain.surfaces[0].shape, ShapeDesc::Mesh { smooth: true, .. }));
    let same = |scene: &SceneDesc| {
        let mesh = mesh_of(scene, 0);
        assert_eq!(
            (&mesh.positions, &mesh.normals, &mesh.uvs),
            (&expected.positions, &expected.normals, &expected.uvs)
        );
    };

    // Interleaved, with an offset.
    let mut file = File::new();
    let rows = (0..3).flat_map(|i| [&positions[3 * i..3 * i + 3], &normals[3 * i..3 * i + 3], &uvs[2 * i..2 * i + 2]]);
    let bytes: Vec<u8> = rows.flatten().flat_map(|value| value.to_le_bytes()).collect();
    let view = file.view(&bytes);
    file.root["bufferViews"][view]["byteStride"] = json!(32);
    for (offset, kind) in [(0, "VEC3"), (12, "VEC3"), (24, "VEC2")] {
        file.push(
            "accessors",
            json!({"bufferView": view, "byteOffset": offset, "componentType": FLOAT, "count": 3, "type": kind}),
        );
    }
    same(&load(&mut file, json!({"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2})));

    // Normalised integers.
    let mut file = File::new();
    file.root["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let p = file.whole(UNSIGNED_SHORT, 3, &[0, 0, 0, 65535, 0, 0, 65535, 65535, 0]);
    let n = file.whole(BYTE, 3, &[0, 0, 127, 0, 0, 127, 0, 0, 127]);
    let t = file.whole(UNSIGNED_BYTE, 2, &[0, 0, 255, 0, 255, 255]);
    for accessor in [p, n, t] {
        file.root["accessors"][accessor]["normalized"] = json!(true);
    }
    same(&load(&mut file, json!({"POSITION": p, "NORMAL": n, "TEXCOORD_0": t})));

    // Zeros, some of which are changed; and values, some of which are changed.
    let mut file = File::new();
    let [p, n] = [file.floats(3, &[0.0, 0.0, 0.0, 9.0, 9.0, 9.0, 1.0, 1.0, 0.0]), file.floats(3, &normals)];
    let (one, values) =
        (file.view(&1_u16.to_le_bytes()), file.view(&[1.0_f32, 0.0, 0.0].map(f32::to_le_bytes).concat()));
    file.root["accessors"][p]["sparse"] = json!({
        "count": 1, "indices": {"bufferView": one, "componentType": UNSIGNED_SHORT}, "values": {"bufferView": values},
    });
    let (indices, values) = (file.view(&[1, 2]), file.view(&[1.0_f32, 0.0, 1.0, 1.0].map(f32::to_le_bytes).concat()));
    let t = file.push("accessors", json!({"componentType": FLOAT, "count": 3, "type": "VEC2", "sparse": {
        "count": 2, "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE}, "values": {"bufferView": values}}}));
    same(&load(&mut file, json!({"POSITION": p, "NORMAL": n, "TEXCOORD_0": t})));

    // Without normals, faces are flat. What is left out is named once.
    let mut file = File::triangle();
    file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_1"] = json!(0);
    file.root["meshes"][0]["primitives"][0]["attributes"]["_MINE"] = json!(0);
    let scene = file.load().unwrap();
    assert!(matches!(scene.surfaces[0].shape, ShapeDesc::Mesh { smooth: false, .. }));
    assert_eq!(one_warning(&scene), "the attribute COLOR_1 is left out: meshes[0].primitives[0]");
}

#[test]
fn nodes_place_one_mesh_many_times() {
    let mut file = File::triangle();
    let half = 0.5_f64.sqrt();
    file.root["nodes"] = json!([
        {"mesh": 0, "children": [1, 2]},
        {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 3, 4], "children": [3]},
        {"mesh": 0, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1]},
        {"mesh": 0, "scale": [-1, 1, 1]},
        {"mesh": 0},
    ]);
    let scene = file.load().unwrap();
    // The last node is in no scene.
    let paths: Vec<_> = scene.surfaces.iter().map(|surface| surface.path.as_str()).collect();
    let expected = ["nodes[0]", "nodes[1]", "nodes[3]", "nodes[2]"].map(|node| format!("{node}.primitives[0]"));
    assert_eq!(paths, expected);
    assert_eq!(scene.meshes.len(), 1, "one mesh for all");
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, 3.0, 4.0),
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
        DVec3::new(1.0, 2.0, 3.0),
    );
    assert!(scene.surfaces[1].transform.abs_diff_eq(place, 1e-12));
    assert!(scene.surfaces[3].transform.abs_diff_eq(place, 1e-12));
    assert!(scene.surfaces[2].transform.abs_diff_eq(place * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)), 1e-12));

    // Instances.
    let mut file = File::triangle();
    let translations = file.floats(3, &[0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
    let rotations = file.whole(BYTE, 4, &[0, 0, 0, 127, 127, 0, 0, 0]);
    file.root["accessors"][rotations]["normalized"] = json!(true);
    let scales = file.floats(3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    file.root["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    file.root["nodes"][0] = json!({"mesh": 0, "translation": [1, 0, 0], "extensions": {"EXT_mesh_gpu_instancing": {
        "attributes": {"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales}}}});
    let scene = file.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.surfaces.len()), (1, 2));
    assert_eq!(scene.surfaces[1].path, "nodes[0].instances[1].primitives[0]");
    near(corners(&scene, 0)[0][2], [1.0, 1.0, 0.0]);
    near(corners(&scene, 1)[0][2], [1.0, -2.0, 5.0]);

    // Scales of zero: a plane is drawn, a line is not.
    let mut file = File::triangle();
    file.root["nodes"] = json!([
        {"mesh": 0, "scale": [2, 2, 0], "translation": [0, 0, 7], "children": [1, 2]},
        {"mesh": 0, "scale": [1, 0, 1]},
        {"mesh": 0, "scale": [0, 0, 0]},
    ]);
    let scene = file.load().unwrap();
    assert_eq!(scene.surfaces.len(), 1);
    near(corners(&scene, 0)[0][1], [2.0, 0.0, 7.0]);
    assert_eq!(one_warning(&scene), "nodes that are scaled to a line or a point are not drawn: nodes[1], nodes[2]");
}

/// No recursion overflows, and no hierarchy that is none is followed.
#[test]
fn hierarchies_are_trees_of_any_depth() {
    let mut file = File::triangle();
    let depth = 100_000;
    let mut nodes: Vec<Value> = (0..depth).map(|i| json!({"translation": [0.25, 0, 0], "children": [i + 1]})).collect();
    nodes.push(json!({"mesh": 0}));
    file.root["nodes"] = json!(nodes);
    near(corners(&file.load().unwrap(), 0)[0][0], [0.25 * f64::from(depth), 0.0, 0.0]);

    for (nodes, expected) in [
        (json!([{"children": [1]}, {"children": [0], "mesh": 0}]), "nodes[0]: the node is its own ancestor"),
        (json!([{"mesh": 0}, {"children": [1], "name": "a"}]), "nodes[1] ('a'): the node is its own ancestor"),
        (
            json!([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}]),
            "nodes[1].children[0]: nodes[2] is a child of nodes[0] too",
        ),
        (json!([{"children": [1, 1]}, {"mesh": 0}]), "nodes[0].children[1]: nodes[1] is a child of nodes[0] too"),
        (json!([{"children": [9]}]), "nodes[0].children[0]: there is no nodes[9], expected an index below 1"),
        (json!([{"mesh": 0}, {"children": [0]}]), "scenes[0].nodes[0]: nodes[0] is a child of nodes[1]"),
    ] {
        file.root["nodes"] = nodes;
        let error = file.load().unwrap_err();
        assert!(error.to_string().contains(expected), "{error}\nnot {expected}");
    }

    // Several scenes, and none.
    let mut file = File::triangle();
    file.push("nodes", json!({"mesh": 0, "translation": [0, 0, 1]}));
    file.root["scenes"] = json!([{"nodes": [0]}, {"nodes": [1], "name": "second"}]);
    file.root["scene"] = json!(1);
    let scene = file.load().unwrap();
    near(corners(&scene, 0)[0][0], [0.0, 0.0, 1.0]);
    assert_eq!(one_warning(&scene), "scenes[1] is drawn; others are left out: scenes[0]");
    file.root["scene"] = Value::Null;
    assert_eq!(one_warning(&file.load().unwrap()), "scenes[0] is drawn; others are left out: scenes[1] ('second')");
    file.root["scenes"] = json!([]);
    assert_eq!(file.load().unwrap().surfaces.len(), 2);

    // Surfaces have the name of their node, or that of its mesh.
    file.root["nodes"][0]["name"] = json!("a node");
    file.root["nodes"][1]["name"] = json!("");
    file.root["meshes"][0]["name"] = json!("a mesh");
    let names: Vec<_> = file.load().unwrap().surfaces.into_iter().map(|it| it.name).collect();
    assert_eq!(names, ["a node", "a mesh"]);
}

#[test]
fn cameras_see_what_the_file_says() {
    let mut file = File::triangle();
    file.root["cameras"] = json!([
        {"type": "orthographic", "name": "flat", "orthographic": {"xmag": 2.5, "ymag": 1.25, "zfar": 2, "znear": 1}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1}},
        {"type": "perspective", "name": "far", "perspective": {"yfov": 0.25, "znear": 0.1}},
        {"type": "perspective", "name": "nowhere", "perspective": {"yfov": 0.25, "znear": 0.1}},
    ]);
    let half = 0.5_f64.sqrt();
    file.root["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3]},
        {"camera": 0, "translation": [1, -2, 3], "scale": [2, 2, 2]},
        {"camera": 1, "translation": [4, 0, 0], "rotation": [0, half, 0, half], "scale": [3, 3, 3]},
        {"camera": 2, "translation": [0, 0, 20]},
    ]);
    let of = |camera: Option<&str>| {
        file.load_with(&LoadOptions { camera: camera.map(str::to_owned), ..LoadOptions::default() })
    };
    let scene = of(Some("1")).unwrap();
    let CameraDesc::Perspective { eye, look_at, up, fov_deg, fov_axis, .. } = scene.camera else { panic!("a pinhole") };
    near(eye, [4.0, 0.0, 0.0]);
    near((look_at - eye).normalize(), [-1.0, 0.0, 0.0]);
    near(up, [0.0, 1.0, 0.0]);
    assert_eq!((fov_deg, fov_axis), (0.5_f64.to_degrees(), FovAxis::Vertical));
    assert_eq!(scene.render.resolution, [384, 256]);
    let scene = of(None).unwrap();
    let CameraDesc::Orthographic { eye, look_at, up, size, axis, .. } = scene.camera else { panic!("parallel rays") };
    near(eye, [1.0, -2.0, 3.0]);
    near(look_at - eye, [0.0, 0.0, -3.0]);
    near(up, [0.0, 1.0, 0.0]);
    assert_eq!((size, axis, scene.render.resolution), (2.5, FovAxis::Vertical, [512, 256]));
    let said = scene.warnings.join("\n");
    let others = "cameras[1], cameras[2] ('far')";
    assert!(said.contains(&format!("cameras[0] ('flat') is taken; the scene has other cameras: {others}")), "{said}");
    for chosen in ["far", "2"] {
        let CameraDesc::Perspective { eye, .. } = of(Some(chosen)).unwrap().camera else { panic!("a pinhole") };
        near(eye, [0.0, 0.0, 20.0]);
    }
    for (chosen, expected) in [
        ("nowhere", "cameras[3] ('nowhere'): no node of the scene has this camera"),
        ("4", "cameras: there is no cameras[4], the file has 4"),
        ("fare", "cameras: none of cameras is named 'fare'; did you mean 'far'?"),
    ] {
        let error = of(Some(chosen)).unwrap_err().to_string();
        assert!(error.starts_with(expected) || error.contains(expected), "{error}");
    }
    for (camera, expected) in [
        (json!({"type": "orthographic"}), "cameras[0]: missing key `orthographic`"),
        (json!({"type": "orthographic", "orthographic": {"xmag": 1}}), "cameras[0].orthographic: missing key `ymag`"),
        (
            json!({"type": "orthographic", "orthographic": {"xmag": -1, "ymag": 1}}),
            "cameras[0].orthographic.xmag: -1 is no half of what an image spans",
        ),
        (
            json!({"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 0}}),
            "cameras[0].perspective.aspectRatio: 0 is no ratio of width and height",
        ),
        (json!({"type": "fisheye"}), "cameras[0].type: 'fisheye' is not supported"),
    ] {
        let mut file = File::triangle();
        file.root["cameras"] = json!([camera]);
        file.root["nodes"] = json!([{"mesh": 0, "children": [1]}, {"camera": 0}]);
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    // Without a camera, all of the scene is seen: every corner is within the angle around the middle.
    for translation in [json!([0, 0, 0]), json!([1000, -2000, 50])] {
        let mut file = File::triangle();
        file.root["nodes"][0]["translation"] = translation;
        let scene = file.load().unwrap();
        let CameraDesc::Perspective { eye, look_at, fov_deg, .. } = scene.camera else { panic!("a pinhole") };
        for corner in corners(&scene, 0)[0] {
            let angle = (corner - eye).angle_between(look_at - eye).to_degrees();
            assert!(angle < 0.5 * fov_deg, "{angle}");
        }
        assert!((eye - look_at).cmpgt(DVec3::ZERO).all());
    }
}

#[test]
fn lights_are_converted_or_named() {
    let mut file = File::triangle();
    file.root["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 1366, "color": [1, 0.5, 0]},
        {"type": "spot", "spot": {"outerConeAngle": 1.0, "innerConeAngle": 0.5}, "intensity": 683},
        {"type": "directional", "name": "sun", "intensity": 2049, "color": [1, 0.5, 0]},
        {"type": "point", "range": 3},
        {"type": "area"},
    ]}});
    let node =
        |light: u32| json!({"extensions": {"KHR_lights_punctual": {"light": light}}, "translation": [0, 0, light + 1]});
    file.root["nodes"] = json!([{"mesh": 0, "children": [1, 2, 3, 4]}, node(0), node(1), node(2), node(3)]);
    let scene = file.load().unwrap();
    assert_eq!((scene.lights.len(), scene.distant_lights.len()), (3, 1));
    let sun = &scene.distant_lights[0];
    assert_eq!((sun.irradiance, sun.angle_deg), (etendue::spectrum::Rgb::new(3.0, 1.5, 0.0), 0.0));
    near(sun.towards, [0.0, 0.0, 1.0]);
    near(scene.lights[0].position, [0.0, 0.0, 1.0]);
    assert_eq!(scene.lights[0].intensity.to_array(), [2.0, 1.0, 0.0]);
    assert_eq!(scene.lights[0].distribution, LightDistribution::Even);
    near(scene.lights[1].position, [0.0, 0.0, 2.0]);
    assert_eq!(scene.lights[1].intensity.to_array(), [1.0; 3]);
    let LightDistribution::Spot(spot) = &scene.lights[1].distribution else { panic!("a spot light") };
    near(spot.direction, [0.0, 0.0, -1.0]);
    assert_eq!([spot.outer_deg, spot.inner_deg], [1.0_f64.to_degrees(), 0.5_f64.to_degrees()]);
    let said = scene.warnings.join("\n");
    let lights = "extensions.KHR_lights_punctual.lights";
    assert!(!said.contains("not drawn"), "{said}");
    assert!(said.contains(&format!("`range` is left out of {lights}[3]")), "{said}");
    assert!(!said.contains("no light"), "{said}");
    file.root["nodes"][1] = node(4);
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains(&format!("{lights}[4].type: unknown type 'area'")), "{error}");
    file.root["nodes"][1] = node(5);
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("nodes[1].extensions.KHR_lights_punctual.light: there is no"), "{error}");
    assert!(is_under_a_sky(&File::triangle().load().unwrap()));
}

fn is_under_a_sky(scene: &SceneDesc) -> bool {
    scene.warnings.is_empty()
        && scene.environment.as_ref().is_some_and(|sky| sky.radiance == etendue::spectrum::Rgb::ONE)
}

/// A material of the native format, with the materials before it.
fn native(materials: &[Value]) -> Vec<MaterialDesc> {
    let named = materials.iter().enumerate().map(|(i, material)| {
        let mut material = material.clone();
        material["name"] = json!(format!("part {i}"));
        material
    });
    let scene = json!({"etendue": 1, "camera": {}, "materials": named.collect::<Vec<_>>()}).to_string();
    desc::parse(&scene, Path::new(""), None).expect("materials").materials
}

/// Every row of the table in docs/gltf.md.
#[test]
fn materials_become_what_the_table_says() {
    let principled = |more: Value| {
        let mut it = json!({"type": "principled", "base_color": [1, 1, 1], "base_metalness": 1, "specular_roughness": 1,
            "coat_ior": 1.5, "coat_darkening": 0});
        it.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        it
    };
    let with = |name: &str, keys: Value| json!({"extensions": {name: keys}});
    // Widths of facets for a roughness of 0.5 and a strength of 0.6.
    let (along, across) = (0.25 + 0.75 * 0.36, 0.25_f64);
    let share = across / along;
    let turned = (along / (2.0 / (1.0 + share * share)).sqrt()).sqrt();
    let cases = [
        (json!({}), vec![principled(json!({}))]),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 0.5], "metallicFactor": 0, "roughnessFactor": 0.5}}),
            vec![principled(json!({"base_color": [0.5, 0.25, 0.125], "base_metalness": 0, "specular_roughness": 0.5}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}, "alphaMode": "BLEND"}),
            vec![principled(json!({"opacity": 0.5}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}, "alphaMode": "MASK"}),
            vec![principled(json!({}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}, "alphaMode": "MASK", "alphaCutoff": 0.6}),
            vec![principled(json!({"opacity": 0}))],
        ),
        (
            json!({"emissiveFactor": [1, 0.5, 0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}}),
            vec![principled(json!({"emission": [4, 2, 0]}))],
        ),
        (with("KHR_materials_ior", json!({"ior": 1.25})), vec![principled(json!({"specular_ior": 1.25}))]),
        (with("KHR_materials_ior", json!({"ior": 0})), vec![principled(json!({"specular_ior": 100}))]),
        (
            with("KHR_materials_specular", json!({"specularFactor": 0.5, "specularColorFactor": [0.5, 0.5, 0.5]})),
            vec![principled(json!({"specular_weight": 0.25}))],
        ),
        (
            with("KHR_materials_specular", json!({"specularColorFactor": [4, 4, 4]})),
            // Four times the reflectance at normal incidence: 0.16.
            vec![principled(json!({"specular_ior": 1.4 / 0.6}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0},
                "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75}}}),
            vec![principled(json!({"base_color": [0.5, 1, 1], "base_metalness": 0, "transmission_weight": 0.75,
                "transmission_color": [0.5, 1, 1], "thin_walled": true}))],
        ),
        (
            with("KHR_materials_clearcoat", json!({"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25})),
            vec![principled(json!({"coat_weight": 0.5, "coat_roughness": 0.25}))],
        ),
        (
            with("KHR_materials_sheen", json!({"sheenColorFactor": [0.5, 0.25, 0], "sheenRoughnessFactor": 0.75})),
            vec![principled(json!({"fuzz_weight": 0.5, "fuzz_color": [1, 0.5, 0], "fuzz_roughness": 0.75}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"roughnessFactor": 0.5}, "extensions": {"KHR_materials_anisotropy":
                {"anisotropyStrength": 0.6, "anisotropyRotation": std::f64::consts::FRAC_PI_2}}}),
            vec![principled(json!({"specular_roughness": turned, "specular_roughness_anisotropy": 1.0 - share,
                "specular_rotation": 90}))],
        ),
        (
            json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}, "extensions": {"KHR_materials_unlit": {}}}),
            vec![json!({"type": "black", "emission": [0.5, 1, 1]})],
        ),
        (
            with(
                "KHR_materials_diffuse_transmission",
                json!({"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [1, 0.5, 0]}),
            ),
            vec![
                principled(json!({})),
                json!({"type": "diffuse-transmission", "color": [0, 0, 0], "transmittance": [1, 0.5, 0]}),
                json!({"type": "mix", "materials": ["part 0", "part 1"], "weight": 0.25}),
            ],
        ),
        // A dielectric: its diffuse colour, less what is reflected.
        (
            with(
                "KHR_materials_pbrSpecularGlossiness",
                json!({"diffuseFactor": [0.48, 0.24, 0.12, 1], "specularFactor": [0, 0, 0], "glossinessFactor": 0.75}),
            ),
            vec![principled(
                json!({"base_color": [0.5, 0.25, 0.125], "base_metalness": 0, "specular_roughness": 0.25}),
            )],
        ),
        // A metal: its specular colour.
        (
            with(
                "KHR_materials_pbrSpecularGlossiness",
                json!({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.5, 0.25]}),
            ),
            vec![principled(json!({"base_color": [1, 0.5, 0.25], "specular_roughness": 0}))],
        ),
    ];
    for (material, expected) in cases {
        let mut file = File::triangle();
        file.root["materials"] = json!([material]);
        file.root["meshes"][0]["primitives"][0]["material"] = json!(0);
        let scene = file.load().unwrap_or_else(|error| panic!("{material}: {error}"));
        let expected = native(&expected);
        assert_eq!(scene.materials.len(), expected.len(), "{material}");
        for (found, expected) in scene.materials.iter().zip(&expected) {
            let close = format!("{:?}", found.bsdf) == format!("{:?}", expected.bsdf) || nearly(found, expected);
            assert!(close, "{material}: {:#?}\nnot {:#?}", found.bsdf, expected.bsdf);
            assert_eq!((found.opacity, found.emission), (expected.opacity, expected.emission), "{material}");
        }
        let unlit = scene.materials.iter().any(|it| it.emission.is_some());
        assert!(unlit && scene.warnings.is_empty() || is_under_a_sky(&scene), "{material}: {:?}", scene.warnings);
    }

    // A body that absorbs.
    let mut file = File::triangle();
    file.root["materials"] = json!([{"name": "glass", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
        "alphaMode": "BLEND", "extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.25, 1, 1]}}}]);
    file.root["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = file.load().unwrap();
    let absorption = scene.materials[0].medium.expect("a medium").absorption.to_array();
    assert!((absorption[0] - 4.0_f32.ln() / 2.0).abs() < 1e-6 && absorption[1..] == [0.0, 0.0], "{absorption:?}");
    assert_eq!(scene.find_material("glass"), Some(0));

    // Numbers out of range, and what is not drawn, are named.
    let mut file = File::triangle();
    file.root["materials"] = json!([{"pbrMetallicRoughness": {"metallicFactor": 2, "baseColorTexture": {"index": 0}},
        "emissiveFactor": [1, 1, 1], "doubleSided": true, "alphaMode": "BLEND",
        "extensions": {"KHR_materials_iridescence": {}, "KHR_materials_dispersion": {}}}]);
    file.root["textures"] = json!([{"source": 0}]);
    file.root["images"] = json!([{"uri": "a.png"}]);
    let said = file.load().unwrap().warnings.join("\n");
    for expected in [
        "textures whose image is not read are not drawn: materials[0].pbrMetallicRoughness.baseColorTexture",
        "images are not read: /nowhere/a.png: images[0].uri: cannot open the file",
        "in range are used: materials[0].pbrMetallicRoughness.metallicFactor (2)",
        "iridescence is not drawn: materials[0]",
        "dispersion is not drawn: materials[0]",
        "light is emitted on the front alone of double-sided materials: materials[0]",
    ] {
        assert!(said.contains(expected), "{said}\nwithout {expected}");
    }
}

/// Whether all numbers of two materials are the same but for rounding.
fn nearly(a: &MaterialDesc, b: &MaterialDesc) -> bool {
    let parts = |it: &MaterialDesc| format!("{:?}", it.bsdf).replace([',', '(', ')', '{', '}', '[', ']', ':'], " ");
    let (a, b) = (parts(a), parts(b));
    let (a, b): (Vec<_>, Vec<_>) = (a.split_whitespace().collect(), b.split_whitespace().collect());
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => (a - b).abs() < 1e-6 * (1.0 + b.abs()),
            _ => *a == b,
        })
}

/// A strip that a skin bends, and a triangle that morphs.
#[test]
fn meshes_are_deformed() {
    let mut file = File::triangle();
    let raised = file.floats(3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let moved = file.floats(3, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    file.root["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": raised}, {"POSITION": moved}]);
    near(corners(&file.load().unwrap(), 0)[0][0], [0.0, 0.0, 0.0]);
    file.root["meshes"][0]["weights"] = json!([0.5, 2]);
    near(corners(&file.load().unwrap(), 0)[0][0], [2.0, 0.0, 0.5]);
    file.root["nodes"][0]["weights"] = json!([1, 0]);
    near(corners(&file.load().unwrap(), 0)[0][0], [0.0, 0.0, 1.0]);
    // An animation of both weights.
    let times = file.floats(1, &[1.0, 3.0]);
    let weights = file.floats(1, &[0.0, 0.0, 4.0, 8.0]);
    file.root["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": times, "output": weights}]}]);
    near(corners(&file.at(1.5).unwrap(), 0)[0][0], [2.0, 0.0, 1.0]);
    near(corners(&file.load().unwrap(), 0)[0][0], [0.0, 0.0, 1.0]);

    // Two joints, of which the second is turned by a right angle about x and moved up; the node itself does not count.
    let mut file = File::triangle();
    let normals = file.floats(3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let joints = file.whole(UNSIGNED_BYTE, 4, &[0, 1, 0, 0, 0, 1, 9, 0, 0, 1, 0, 0]);
    let weights = file.floats(4, &[1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0]);
    let half = 0.5_f64.sqrt();
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut down = identity;
    down[14] = -1.0;
    let inverse = file.floats(16, &[identity, down].concat());
    file.root["nodes"] = json!([
        {"children": [1, 2, 3]},
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {},
        {"translation": [0, 0, 3], "rotation": [half, 0, 0, half]},
    ]);
    file.root["skins"] = json!([{"joints": [2, 3], "inverseBindMatrices": inverse}]);
    let attributes = &mut file.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    attributes["NORMAL"] = json!(normals);
    let scene = file.load().unwrap();
    let [a, b, c] = corners(&scene, 0)[0];
    // The second joint takes (x, y, z) to (x, -(z - 1), y + 3).
    near(a, [0.0, 0.0, 0.0]);
    near(b, [1.0, 0.5, 1.5]);
    near(c, [0.0, 1.0, 4.0]);
    let normals = mesh_of(&scene, 0).normals.iter().map(|normal| DVec3::from_array(normal.map(f64::from)));
    let normals: Vec<_> = normals.collect();
    near(normals[0], [0.0, 0.0, 1.0]);
    near(normals[2], [0.0, -1.0, 0.0]);
    // A joint that is not there may only pad.
    file.root["skins"][0]["joints"] = json!([2]);
    let error = file.load().unwrap_err().to_string();
    assert!(
        error.contains("meshes[0].primitives[0].attributes.JOINTS_0: element 1 names joint 1, expected one below 1"),
        "{error}"
    );
}

#[test]
fn animations_are_seen_at_a_time() {
    let with = |path: &str, interpolation: Option<&str>, components: usize, values: &[f32]| {
        let mut file = File::triangle();
        let times = file.floats(1, &[1.0, 3.0]);
        let values = file.floats(components, values);
        file.root["animations"] = json!([{"name": "walk", "channels": [{"sampler": 0, "target": {"node": 0, "path": path}},
            {"sampler": 0, "target": {"path": "translation"}}],
            "samplers": [{"input": times, "output": values, "interpolation": interpolation}]}]);
        file
    };
    let at = |file: &File, time: f64| file.at(time).unwrap().surfaces[0].transform;
    let line = with("translation", None, 3, &[0.0, 0.0, 0.0, 2.0, 4.0, 0.0]);
    for (time, expected) in [(0.0, [0.0; 3]), (1.5, [0.5, 1.0, 0.0]), (3.0, [2.0, 4.0, 0.0]), (9.0, [2.0, 4.0, 0.0])] {
        near(at(&line, time).translation, expected);
    }
    let step = with("scale", Some("STEP"), 3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    near(at(&step, 2.9).matrix3.x_axis, [1.0, 0.0, 0.0]);
    near(at(&step, 3.0).matrix3.x_axis, [2.0, 0.0, 0.0]);
    // A spline of value 0 with slope 1 and value 2 with slope 0 over two seconds: at the middle 1 + 2/8.
    let spline = [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0; 3], [2.0, 0.0, 0.0], [0.0; 3]].concat();
    near(at(&with("translation", Some("CUBICSPLINE"), 3, &spline), 2.0).translation, [1.25, 0.0, 0.0]);
    // A turn by 120 degrees about z, written with the opposite sign: the shorter way is taken.
    let turn = DQuat::from_rotation_z(120.0_f64.to_radians()).to_array().map(|part| -part as f32);
    let turning = with("rotation", Some("LINEAR"), 4, &[[0.0, 0.0, 0.0, 1.0], turn].concat());
    let expected = DMat3::from_rotation_z(30.0_f64.to_radians());
    let found = at(&turning, 1.5).matrix3;
    assert!(found.abs_diff_eq(expected, 1e-6), "{found}");

    let chosen = |name: &str| {
        let animation = Some(name.to_owned());
        line.load_with(&LoadOptions { time: Some(1.5), animation, ..LoadOptions::default() })
    };
    near(chosen("walk").unwrap().surfaces[0].transform.translation, [0.5, 1.0, 0.0]);
    let error = chosen("run").unwrap_err().to_string();
    assert!(error.contains("animations: none of animations is named 'run'"), "{error}");
    let mut two = line.clone();
    two.push("animations", json!({"name": "run"}));
    assert!(
        two.at(0.0).unwrap().warnings[0].contains("animations[0] is drawn; others are left out: animations[1] ('run')")
    );
    assert!(File::triangle().at(0.0).unwrap().warnings[0].contains("the file has no animation"));
    assert!(line.at(f64::NAN).unwrap_err().to_string().contains("a time of NaN"));
    for (file, expected) in [
        (with("translation", None, 3, &[0.0; 9]), "animations[0].samplers[0].output: 3 elements for 2 keyframes"),
        (with("rotation", None, 4, &[0.0; 8]), "animations[0].samplers[0].output: [0, 0, 0, 0] is no rotation"),
        (with("colour", None, 3, &[0.0; 6]), "animations[0].channels[0].target.path: unknown name 'colour'"),
        (with("scale", Some("EASE"), 3, &[0.0; 6]), "animations[0].samplers[0].interpolation: unknown name 'EASE'"),
        (
            with("scale", None, 4, &[0.0; 8]),
            "animations[0].samplers[0].output: accessors[2] is of type VEC4, expected VEC3",
        ),
    ] {
        let error = file.at(2.0).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot {expected}");
    }
}

/// The same pixels as the native scene, from each kind of file.
#[test]
fn every_container_gives_the_picture_of_the_native_scene() {
    let mut file = File::triangle();
    file.root["materials"] =
        json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": 0}}]);
    file.root["meshes"][0]["primitives"][0]["material"] = json!(0);
    file.root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 68300}]}});
    file.root["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1, "znear": 0.1}}]);
    file.root["nodes"] = json!([
        {"mesh": 0, "scale": [-1, 1, 1], "children": [1, 2]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 0, 1]},
        {"camera": 0, "translation": [0.3, 0.3, 4]},
    ]);
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let embedded = write("embedded.gltf", file.text().as_bytes());
    let binary = write("binary.GLB", &file.binary());
    write("data of it.bin", &file.bytes);
    file.root["buffers"] = json!([{"uri": "data%20of%20it.bin", "byteLength": file.bytes.len()}]);
    let beside = write("beside.gltf", file.text().as_bytes());
    let native = json!({"etendue": 1,
        "camera": {"origin": [-0.3, 0.3, 4], "lookAt": [-0.3, 0.3, 0], "up": [0, 1, 0], "fieldOfView": 0.5_f64.to_degrees(),
            "fieldOfViewAxis": "vertical"},
        "lights": [{"type": "point", "origin": [0, 0, 1], "color": [1, 1, 1], "intensity": 100}],
        "materials": [{"name": "m", "type": "principled", "base_color": [0.8, 0.4, 0.2], "specular_roughness": 1}],
        "surfaces": [{"geometry": "mesh", "material": "m", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
            "triangles": [[0, 1, 2]], "transform": {"scale": [-1, 1, 1]}}],
    });
    let native = desc::parse(&native.to_string(), Path::new(""), None).expect("a scene");
    let picture = |mut scene: SceneDesc| {
        scene.render.resolution = [16, 16];
        scene.render.samples = 4;
        let built = Scene::build(&scene, &BuildOptions::default()).expect("a scene");
        render_scene(&built, scene.render).0
    };
    let expected = picture(native);
    assert!(expected.mean().iter().all(|channel| *channel > 0.01));
    for path in [embedded, binary, beside] {
        let scene = desc::load(&path, None).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let found = picture(scene);
        let pixels = (0..256).map(|i| (i % 16, i / 16)).flat_map(|(x, y)| {
            let pairs = found.pixel(x, y).into_iter().zip(expected.pixel(x, y));
            pairs.map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
        });
        let difference = pixels.fold(0.0, f32::max);
        assert!(difference < 1e-4, "{}: {difference}", path.display());
    }
    let scene = desc::load(&folder.path().join("beside.gltf"), None).unwrap();
    assert_eq!(scene.files, [folder.path().join("data of it.bin")]);

    // Choices are for glTF files alone.
    let path = write("scene.json", b"{}");
    let options = LoadOptions { time: Some(1.0), ..LoadOptions::default() };
    let error = desc::load_with(&path, None, &options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
}

/// A square of 2 x 2 texels as an image file.
fn four_texels(format: image::ImageFormat) -> Vec<u8> {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 128], [0, 0, 255, 255], [255, 255, 0, 0]];
    let texel = |x: u32, y: u32| image::Rgba(texels[(2 * y + x) as usize]);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_fn(2, 2, texel).write_to(&mut bytes, format).expect("an image");
    bytes.into_inner()
}

/// A square with the given texture coordinates and material, whose texture is the first image.
fn textured(uvs: &[[f32; 2]; 4], material: &Value) -> File {
    let mut file = File::new();
    let positions = file.floats(3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let uvs = file.floats(2, uvs.as_flattened());
    let indices = file.whole(UNSIGNED_BYTE, 1, &[0, 1, 2, 0, 2, 3]);
    let image = file.view(&four_texels(image::ImageFormat::Png));
    file.push("images", json!({"bufferView": image, "mimeType": "image/png"}));
    file.push("samplers", json!({"magFilter": 9728, "wrapS": 10497, "wrapT": 33071}));
    file.push("textures", json!({"source": 0, "sampler": 0}));
    file.push("materials", material.clone());
    file.push(
        "meshes",
        json!({"primitives": [{"indices": indices, "material": 0,
        "attributes": {"POSITION": positions, "TEXCOORD_0": uvs}}]}),
    );
    file.push("nodes", json!({"mesh": 0}));
    file.root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 68300}]}});
    file.push("nodes", json!({"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0.5, 0.5, 3]}));
    file.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.35, "aspectRatio": 1, "znear": 0.1}}));
    file.push("nodes", json!({"camera": 0, "translation": [0.5, 0.5, 3]}));
    file.root["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    file
}

/// The colours of the quarters of the square: top left, top right, bottom left, bottom right.
fn quarters(scene: &SceneDesc) -> [[f32; 3]; 4] {
    let mut scene = scene.clone();
    scene.render.resolution = [16, 16];
    scene.render.samples = 16;
    let built = Scene::build(&scene, &BuildOptions::default()).expect("a scene");
    let image = render_scene(&built, scene.render).0;
    [[5, 5], [10, 5], [5, 10], [10, 10]].map(|[x, y]| image.pixel(x, y))
}

/// The base colour is the product of factor, texture and colours of vertices, which are linear; alpha is an opacity where it may be.
#[test]
fn colors_of_vertices_are_factors_on_the_base_color() {
    let gltf = |colors: Option<&[i64]>, material: &Value| {
        let mut file = textured(&UPRIGHT, material);
        if let Some(colors) = colors {
            let accessor = file.whole(UNSIGNED_BYTE, 4, colors);
            file.root["accessors"][accessor]["normalized"] = json!(true);
            file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(accessor);
        }
        file
    };
    let even = |color: [i64; 4]| color.repeat(4);
    let plain = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1]}});
    let scene = gltf(Some(&even([255, 51, 102, 255])), &plain).load().unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    let expected = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.5, 0.1, 0.2, 1]}});
    let without = quarters(&gltf(None, &expected).load().unwrap());
    let near = |found: [[f32; 3]; 4], expected: [[f32; 3]; 4]| {
        for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-3 * expected.abs().max(1e-3), "{found}, not {expected}");
        }
    };
    near(quarters(&scene), without);
    // On a texture. Another primitive of the material, without colours, is white.
    let with_texture = |factor: [f64; 4]| json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": factor, "baseColorTexture": {"index": 0}}});
    let mut file = gltf(Some(&even([51, 255, 102, 0])), &with_texture([1.0; 4]));
    near(quarters(&file.load().unwrap()), quarters(&gltf(None, &with_texture([0.2, 1.0, 0.4, 1.0])).load().unwrap()));
    let white = json!({"indices": 2, "material": 0, "attributes": {"POSITION": 0, "TEXCOORD_0": 1}});
    file.root["meshes"][0]["primitives"].as_array_mut().unwrap().insert(0, white);
    file.root["meshes"][0]["primitives"].as_array_mut().unwrap().pop();
    file.push("meshes", json!({"primitives": [{"material": 0, "attributes": {"POSITION": 0, "COLOR_0": 3}}]}));
    near(quarters(&file.load().unwrap()), quarters(&gltf(None, &with_texture([1.0; 4])).load().unwrap()));
    // A mask of the alpha of vertices: the left half is there.
    let mask = json!({"pbrMetallicRoughness": {"metallicFactor": 0}, "alphaMode": "MASK", "doubleSided": true});
    let colors: Vec<i64> = [255, 0, 0, 255].into_iter().flat_map(|alpha| [255, 255, 255, alpha]).collect();
    let [top_left, top_right, ..] = quarters(&gltf(Some(&colors), &mask).load().unwrap());
    assert!(top_left[1] > 0.1 && top_right[1] == 0.0, "{top_left:?} {top_right:?}");
    // Colours without alpha make no surface transparent.
    let mut file = gltf(None, &json!({"alphaMode": "BLEND"}));
    let opaque = file.floats(3, &[0.5; 12]);
    file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(opaque);
    let keys: Vec<_> = file.load().unwrap().materials[0].textures.iter().map(|binding| binding.key).collect();
    assert_eq!(keys, [desc::TextureKey::BaseColor]);
    // Unlit surfaces cannot shine by colours of vertices. Wrong types and numbers are named.
    let unlit = json!({"extensions": {"KHR_materials_unlit": {}}});
    let scene = gltf(Some(&even([255, 0, 0, 255])), &unlit).load().unwrap();
    assert!(one_warning(&scene).contains("have colours of vertices, are diffuse"), "{:?}", scene.warnings);
    let mut file = gltf(Some(&even([255, 0, 0, 255])), &plain);
    file.root["accessors"][3]["normalized"] = json!(false);
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("attributes.COLOR_0: accessors[3] is of UNSIGNED_BYTE"), "{error}");
    let mut file = gltf(None, &plain);
    let beyond = file.floats(3, &[1.5, -1.0, 0.0].repeat(4));
    file.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(beyond);
    let scene = file.load().unwrap();
    assert!(one_warning(&scene).starts_with("colours of vertices are out of range"), "{:?}", scene.warnings);
    assert_eq!(mesh_of(&scene, 0).colors, [[1.0, 0.0, 0.0, 1.0]; 4]);
}

/// Which of the four texels a pixel shows: the numbers of those in the file.
fn texel([r, g, b]: [f32; 3]) -> u32 {
    let most = r.max(g).max(b);
    match [r, g, b].map(|channel| channel > 0.5 * most) {
        [true, false, false] => 0,
        [false, true, false] => 1,
        [false, false, true] => 2,
        [true, true, false] => 3,
        other => panic!("{other:?} of {r} {g} {b}"),
    }
}

const UPRIGHT: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

#[test]
fn textures_lie_as_the_specification_says() {
    let plain = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}});
    let upright = textured(&UPRIGHT, &plain).load().unwrap();
    assert!(upright.warnings.is_empty(), "{:?}", upright.warnings);
    assert_eq!(quarters(&upright).map(texel), [0, 1, 2, 3]);
    // The extension gives the picture of coordinates that were changed by its formula.
    for (offset, rotation, scale) in [
        ([0.25_f32, 0.0], 0.0_f32, [0.5_f32, 1.0]),
        ([0.0, 1.0], std::f32::consts::FRAC_PI_2, [1.0, 1.0]),
        ([0.1, 0.7], 0.6, [0.8, 0.6]),
    ] {
        let (sin, cos) = rotation.sin_cos();
        let moved = UPRIGHT.map(|[u, v]| {
            let [u, v] = [scale[0] * u, scale[1] * v];
            [offset[0] + cos * u + sin * v, offset[1] - sin * u + cos * v]
        });
        let mut material = plain.clone();
        material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({"KHR_texture_transform": {"offset": offset, "rotation": rotation, "scale": scale}});
        let by_extension = quarters(&textured(&UPRIGHT, &material).load().unwrap());
        let by_coordinates = quarters(&textured(&moved, &plain).load().unwrap());
        for (a, b) in by_extension.as_flattened().iter().zip(by_coordinates.as_flattened()) {
            assert!((a - b).abs() < 0.02 * (1.0 + b), "{by_extension:?}\nnot {by_coordinates:?}");
        }
    }
    // Data URIs, WebP images by their extension, and a second set of coordinates.
    let mut file = textured(&UPRIGHT, &plain);
    let data =
        base64::Engine::encode(&base64::engine::general_purpose::STANDARD, four_texels(image::ImageFormat::WebP));
    file.root["extensionsRequired"] = json!(["EXT_texture_webp"]);
    file.push("images", json!({"uri": format!("data:image/webp;base64,{data}")}));
    file.root["textures"][0] = json!({"sampler": 0, "extensions": {"EXT_texture_webp": {"source": 1}}});
    let attributes = &mut file.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"].take();
    attributes.as_object_mut().expect("an object").remove("TEXCOORD_0");
    file.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(1);
    let scene = file.load().unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(quarters(&scene).map(texel), [0, 1, 2, 3]);
}

#[test]
fn textures_vary_what_the_specification_says() {
    use desc::TextureChannel::{Alpha, Blue, Default, Green, Red};
    use desc::TextureKey as Key;
    let info = || json!({"index": 0});
    let material = json!({
        "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": info(), "metallicRoughnessTexture": info()},
        "normalTexture": {"index": 0, "scale": 0.5}, "occlusionTexture": info(), "emissiveTexture": info(),
        "alphaMode": "BLEND",
        "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": info()},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": info(), "clearcoatRoughnessTexture": info(),
                "clearcoatNormalTexture": info()},
            "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenColorTexture": info(), "sheenRoughnessTexture": info()},
            "KHR_materials_specular": {"specularTexture": info(), "specularColorTexture": info()},
        },
    });
    let scene = textured(&UPRIGHT, &material).load().unwrap();
    let mut found: Vec<_> = scene.materials[0].textures.iter().map(|it| (it.key, it.channel, it.strength)).collect();
    found.sort_by_key(|(key, ..)| *key);
    let mut expected = vec![
        (Key::BaseColor, Default, 1.0),
        (Key::SpecularRoughness, Green, 1.0),
        (Key::BaseMetalness, Blue, 1.0),
        (Key::Normal, Default, 0.5),
        (Key::TransmissionWeight, Red, 1.0),
        (Key::TransmissionColor, Default, 1.0),
        (Key::CoatWeight, Red, 1.0),
        (Key::CoatRoughness, Green, 1.0),
        (Key::FuzzColor, Default, 1.0),
        (Key::FuzzRoughness, Alpha, 1.0),
        (Key::SpecularWeight, Alpha, 1.0),
        (Key::Opacity, Alpha, 1.0),
    ];
    expected.sort_by_key(|(key, ..)| *key);
    assert_eq!(found, expected);
    assert_eq!((scene.materials[0].opacity, scene.materials[0].emission), (0.5, None));
    // Colours and numbers are two textures of one image.
    assert_eq!(scene.textures.len(), 2);
    let said = scene.warnings.join("\n");
    for left_out in ["occlusionTexture", "clearcoatNormalTexture", "specularColorTexture"] {
        assert!(said.contains("not drawn: ") && said.contains(left_out), "{said}");
    }
    Scene::build(&scene, &BuildOptions::default()).expect("a scene");
}

/// Tangents are read where a normal map needs them, with the changes of morph targets.
#[test]
fn tangents_are_those_of_the_file() {
    let with = |is_mapped: bool| {
        let material = if is_mapped { json!({"normalTexture": {"index": 0}}) } else { json!({}) };
        let mut file = textured(&UPRIGHT, &material);
        let normals = file.floats(3, &[0.0, 0.0, 1.0].repeat(4));
        let tangents = file.floats(4, &[0.6, 0.8, 0.0, 1.0].repeat(4));
        let turned = file.floats(3, &[-0.6, 0.0, 0.0].repeat(4));
        let primitive = &mut file.root["meshes"][0]["primitives"][0];
        primitive["attributes"]["NORMAL"] = json!(normals);
        primitive["attributes"]["TANGENT"] = json!(tangents);
        primitive["targets"] = json!([{"TANGENT": turned}]);
        file.root["meshes"][0]["weights"] = json!([0.5]);
        file.load().unwrap()
    };
    let scene = with(true);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let tangents = &mesh_of(&scene, 0).tangents;
    assert!(tangents.len() == 4 && tangents.iter().all(|[x, y, z]| (x - 0.3).abs() < 1e-6 && (*y, *z) == (0.8, 0.0)));
    assert!(mesh_of(&with(false), 0).tangents.is_empty());
}

/// The images that materials use are read with progress, which may stop it; others are not read.
#[test]
fn images_are_read_with_progress() {
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "normalTexture": {"index": 1}});
    let mut file = textured(&UPRIGHT, &material);
    for uri in [json!("missing.png"), json!({"never": "read"})] {
        let number = file.push("images", json!({"uri": uri}));
        file.push("textures", json!({"source": number}));
    }
    let seen = Arc::new(Mutex::new(Vec::new()));
    let list = Arc::clone(&seen);
    let progress = move |fraction: f64| list.lock().unwrap().push(fraction);
    let options = LoadOptions { progress: Some(Arc::new(progress)), ..LoadOptions::default() };
    let scene = file.load_with(&options).unwrap();
    assert_eq!(scene.textures.len(), 1);
    let said = scene.warnings.join("\n");
    assert!(said.contains("missing.png: images[1].uri: cannot open") && !said.contains("images[2]"), "{said}");
    assert_eq!(seen.lock().unwrap().last(), Some(&1.0));
    options.cancel.cancel();
    let error = file.load_with(&options).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Cancelled);
}

/// Textures of one material may lie by different sets of coordinates.
#[test]
fn textures_lie_by_the_sets_that_they_name() {
    let sides = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let with = |uvs: &[[f32; 2]; 4], further: Option<[[f32; 2]; 4]>, sets: [u32; 2]| {
        let texture = |set: u32| json!({"index": 0, "texCoord": set});
        let material = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": texture(sets[0]),
            "metallicRoughnessTexture": texture(sets[1])}});
        let mut file = textured(uvs, &material);
        if let Some(uvs) = further {
            let uvs = file.floats(2, uvs.as_flattened());
            file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = json!(uvs);
        }
        let scene = file.load().unwrap();
        // A set that no texture uses is named.
        assert_eq!(scene.warnings.len(), usize::from(sets == [3, 3]), "{:?}", scene.warnings);
        scene
    };
    let (upright, turned) = (with(&UPRIGHT, None, [0, 0]), with(&sides, None, [0, 0]));
    let sets = |scene: &SceneDesc| {
        let set = |key| scene.textures[scene.materials[0].textured(key).unwrap().texture].mapping.uv_set();
        [set(desc::TextureKey::BaseColor), set(desc::TextureKey::SpecularRoughness)]
    };
    // The sets of a material are numbered as they come.
    for (first, further, of_file, in_scene, like) in [
        (&UPRIGHT, sides, [0, 3], [0, 1], &upright),
        (&UPRIGHT, sides, [3, 0], [0, 1], &turned),
        (&sides, UPRIGHT, [3, 3], [0, 0], &upright),
    ] {
        let scene = with(first, Some(further), of_file);
        assert_eq!(sets(&scene), in_scene);
        let colors = quarters(&scene).map(texel);
        assert_eq!(colors, quarters(like).map(texel), "{of_file:?}");
    }
    assert_ne!(quarters(&upright).map(texel), quarters(&turned).map(texel));
}

/// The cutoff of a mask is that of the product of the factor and the texture.
#[test]
fn masks_have_a_cutoff() {
    for (factor, cutoff, opacity, of_texture) in [
        (1.0, None, 1.0, Some(0.5)),
        (0.5, Some(0.25), 1.0, Some(0.5)),
        (0.5, Some(0.75), 0.0, None),
        (0.0, Some(0.25), 0.0, None),
        (1.0, Some(0.0), 1.0, None),
    ] {
        let mut material = json!({
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, factor], "baseColorTexture": {"index": 0}}, "alphaMode": "MASK",
        });
        if let Some(cutoff) = cutoff {
            material["alphaCutoff"] = json!(cutoff);
        }
        let scene = textured(&UPRIGHT, &material).load().unwrap();
        let it = &scene.materials[0];
        let mask = it.textured(desc::TextureKey::Opacity).map(|mask| mask.cutoff);
        assert_eq!((it.opacity, mask), (opacity, of_texture), "{material}");
        Scene::build(&scene, &BuildOptions::default()).expect("a scene");
    }
}

#[test]
fn textures_vary_emission() {
    let emission_of = |material: &Value| {
        let scene = textured(&UPRIGHT, material).load().unwrap();
        Scene::build(&scene, &BuildOptions::default()).expect("a scene");
        let it = &scene.materials[0];
        let keys: Vec<_> = it.textures.iter().map(|binding| (binding.key, binding.channel)).collect();
        (it.emission.map(|radiance| radiance.to_array()), keys, it.bsdf)
    };
    let of_texture = vec![(desc::TextureKey::Emission, desc::TextureChannel::Default)];
    let material = json!({
        "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 0.5, 1],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}},
    });
    let (emission, textures, _) = emission_of(&material);
    assert_eq!((emission, &textures), (Some([4.0, 2.0, 4.0]), &of_texture));
    // A factor of 0, the default, is dark whatever the texture.
    let (emission, textures, _) = emission_of(&json!({"emissiveTexture": {"index": 0}}));
    assert_eq!((emission, textures), (None, Vec::new()));
    // A surface that shows its texture whatever the light.
    let material = json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}},
        "extensions": {"KHR_materials_unlit": {}},
    });
    let (emission, textures, bsdf) = emission_of(&material);
    assert_eq!((emission, textures, bsdf), (Some([0.5, 1.0, 1.0]), of_texture, desc::BsdfDesc::Black));
    // Without its image, which is dark in most places, nothing shines.
    let mut file = textured(&UPRIGHT, &json!({"emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1]}));
    file.root["images"][0] = json!({"uri": "missing.png"});
    let scene = file.load().unwrap();
    assert_eq!((scene.materials[0].emission, scene.materials[0].textures.len()), (None, 0));
}

/// What is broken is one error at the element.
#[test]
fn broken_files_are_refused_at_the_element() {
    let attribute = "meshes[0].primitives[0].attributes.POSITION: ";
    let set = |pointer: &'static str, value: Value| {
        move |file: &mut File| {
            let (parent, key) = pointer.rsplit_once('/').expect("a key");
            let parent = file.root.pointer_mut(parent).expect("a parent");
            match key.parse::<usize>() {
                Ok(index) if parent.is_array() => parent[index] = value,
                _ => parent[key] = value,
            }
        }
    };
    type Change = Box<dyn FnOnce(&mut File)>;
    let cases: Vec<(Change, String)> = vec![
        (Box::new(set("/asset/version", json!("1.0"))), "asset.version: the file is of glTF version 1.0".into()),
        (Box::new(set("/asset/minVersion", json!("3.1"))), "asset.minVersion: the file is of glTF version 3.1".into()),
        (Box::new(set("/asset/version", json!(1))), "asset.version: the file is of glTF version 1, this library".into()),
        (Box::new(set("/asset", json!({}))), "asset: missing key `version`".into()),
        (Box::new(set("/scene", json!(4))), "scene: there is no scenes[4]".into()),
        (Box::new(set("/scene", json!("a"))), "scene: invalid type: string".into()),
        (Box::new(set("/nodes/0/mesh", json!(1))), "nodes[0].mesh: there is no meshes[1], expected an index below 1".into()),
        (Box::new(set("/nodes/0/mesh", json!(4_294_967_296_u64))), "nodes[0].mesh: there is no meshes[4294967296]".into()),
        (Box::new(set("/nodes/0/mesh", json!(-1))), "nodes[0].mesh: invalid value: integer `-1`, expected a whole number".into()),
        (Box::new(set("/nodes/0/rotation", json!([0, 0, 0, 0]))), "nodes[0].rotation: [0.0, 0.0, 0.0, 0.0] is no rotation".into()),
        (Box::new(set("/nodes/0/scale", json!([1e39, 1, 1]))), "nodes[0].scale[0]: 1e39 is beyond single precision".into()),
        (Box::new(set("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))), "nodes[0].matrix: its last row".into()),
        (Box::new(set("/nodes/0/skin", json!(0))), "nodes[0].skin: there is no skins[0], the file has no skins".into()),
        (Box::new(set("/meshes/0/primitives", json!([]))), "meshes[0]: missing key `primitives`".into()),
        (Box::new(set("/meshes/0/primitives/0/mode", json!(7))), "meshes[0].primitives[0].mode: 7 is no mode".into()),
        (Box::new(set("/meshes/0/primitives/0/material", json!(0))), "meshes[0].primitives[0].material: there is no materials[0]".into()),
        (Box::new(set("/meshes/0/primitives/0/attributes/POSITION", json!(5))), format!("{attribute}there is no accessors[5]")),
        (Box::new(set("/accessors/0/type", json!("VEC2"))), format!("{attribute}accessors[0] is of type VEC2, expected VEC3")),
        (Box::new(set("/accessors/0/type", json!("VEC9"))), "accessors[0].type: 'VEC9' is no type".into()),
        (Box::new(set("/accessors/0/componentType", json!(5122))), format!("{attribute}accessors[0] is of SHORT, expected FLOAT, or the")),
        (Box::new(set("/accessors/0/componentType", json!(5125))), format!("{attribute}accessors[0] is of UNSIGNED_INT, expected FLOAT")),
        (Box::new(set("/accessors/0/componentType", json!(1))), "accessors[0].componentType: 1 is no component type".into()),
        (Box::new(set("/accessors/0/count", json!(4))), "accessors[0]: 4 elements need 48 bytes from byte 0 on, bufferViews[0] has 36".into()),
        (Box::new(set("/accessors/0/count", json!(1_u64 << 60))), "the meshes of the file are too large".into()),
        (Box::new(set("/accessors/0/byteOffset", json!(2))), "accessors[0]: elements of FLOAT begin at byte 2 of the buffer, which is misaligned".into()),
        (Box::new(set("/accessors/0/byteOffset", json!(u64::MAX - 3))), "accessors[0]: 3 elements need 36 bytes".into()),
        (Box::new(set("/accessors/0/bufferView", json!(3))), "accessors[0].bufferView: there is no bufferViews[3]".into()),
        (Box::new(set("/bufferViews/0/byteLength", json!(37))), "bufferViews[0]: the view of 37 bytes from byte 0 on ends beyond buffers[0]".into()),
        (Box::new(set("/bufferViews/0/byteOffset", json!(u64::MAX))), "bufferViews[0]: the view of 36 bytes from byte".into()),
        (Box::new(set("/bufferViews/0/byteStride", json!(8))), "bufferViews[0].byteStride: its byteStride does not fit elements of 12 bytes".into()),
        (Box::new(set("/bufferViews/0/buffer", json!(1))), "bufferViews[0].buffer: there is no buffers[1]".into()),
        (Box::new(set("/buffers", json!([{"byteLength": 36}]))), "buffers[0]: the buffer has neither a uri nor".into()),
        (Box::new(set("/buffers", json!([{"uri": "gone.bin", "byteLength": 36}]))), "buffers[0].uri: cannot open the file".into()),
        (Box::new(set("/buffers", json!([{"uri": "http://a/b.bin", "byteLength": 36}]))), "buffers[0].uri: the uri is one of http:".into()),
        (Box::new(set("/buffers", json!([{"uri": "data:;base64,!!!!", "byteLength": 3}]))), "buffers[0].uri: the base64 data is broken".into()),
        (Box::new(set("/buffers", json!([{"uri": "data:;base64,AAAA", "byteLength": 36}]))), "buffers[0]: the buffer has 3 bytes, its byteLength says 36".into()),
        (Box::new(set("/buffers", json!([{"uri": "data:AAAA", "byteLength": 36}]))), "buffers[0].uri: the data URI has no comma".into()),
        (
            Box::new(|file: &mut File| file.bytes[4..8].copy_from_slice(&f32::NAN.to_le_bytes())),
            format!("{attribute}element 0 is [0.0, NaN, 0.0], expected finite numbers"),
        ),
        (
            Box::new(|file: &mut File| {
                let indices = file.whole(UNSIGNED_SHORT, 1, &[0, 1, 3]);
                file.root["meshes"][0]["primitives"][0]["indices"] = json!(indices);
            }),
            "meshes[0].primitives[0].indices: element 2 is 3, expected an index below 3".into(),
        ),
        (
            Box::new(|file: &mut File| {
                let normals = file.floats(3, &[0.0; 6]);
                file.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
            }),
            "meshes[0].primitives[0].attributes.NORMAL: 2 elements for 3 positions".into(),
        ),
        (
            Box::new(|file: &mut File| {
                file.root["accessors"][0]["sparse"] = json!({"count": 4, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}});
            }),
            "accessors[0].sparse.count: 4 of 3 elements are changed".into(),
        ),
        (
            Box::new(|file: &mut File| {
                file.root["accessors"][0] = json!({"componentType": FLOAT, "count": 20_000_000, "type": "VEC3"});
            }),
            "accessors[0]: 20000000 elements without a bufferView".into(),
        ),
        (
            Box::new(|file: &mut File| file.root["extensionsRequired"] = json!(["KHR_materials_unlit", "KHR_texture_basisu"])),
            "extensionsRequired[1]: the file requires the extension KHR_texture_basisu, which this library does not read".into(),
        ),
        (
            Box::new(|file: &mut File| {
                file.root["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}});
                file.root["accessors"][0]["bufferView"] = Value::Null;
            }),
            "meshes[0].primitives[0]: the primitive is compressed (KHR_draco_mesh_compression)".into(),
        ),
        (
            Box::new(|file: &mut File| {
                file.root["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {}});
            }),
            "accessors[0].bufferView: bufferViews[0] is compressed (meshopt)".into(),
        ),
        (Box::new(set("/nodes", json!([{}]))), "the file has no surface that can be drawn".into()),
    ];
    for (change, expected) in cases {
        let mut file = File::triangle();
        change(&mut file);
        let text = file.text();
        let error = desc::parse_gltf(
            text.as_bytes(),
            Path::new("/nowhere"),
            Some(Path::new("m.gltf")),
            &LoadOptions::default(),
        );
        let error = error.err().unwrap_or_else(|| panic!("read, expected: {expected}")).to_string();
        assert!(error.contains(&expected), "{error}\nnot {expected}");
    }
    // A file that is cut short is named.
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("cut.bin"), [0; 7]).unwrap();
    let mut file = File::triangle();
    file.root["buffers"] = json!([{"uri": "cut.bin", "byteLength": 36}]);
    let error =
        desc::parse_gltf(file.text().as_bytes(), folder.path(), None, &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("cut.bin has 7 bytes, the buffer's byteLength says 36"), "{error}");
    // Extensions that are only used are named.
    let mut file = File::triangle();
    file.root["extensionsUsed"] = json!(["KHR_materials_variants", "KHR_materials_ior"]);
    assert_eq!(one_warning(&file.load().unwrap()), "extensions that are not read: KHR_materials_variants");
}

#[test]
fn broken_containers_are_refused() {
    let binary = File::triangle().binary();
    let parse = |bytes: &[u8]| desc::parse_gltf(bytes, Path::new(""), None, &LoadOptions::default());
    parse(&binary).expect("a scene");
    // Every shorter file is refused.
    for end in 0..binary.len() {
        assert!(parse(&binary[..end]).is_err(), "{end}");
    }
    let changed = |at: usize, bytes: &[u8]| {
        let mut changed = binary.clone();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        parse(&changed).unwrap_err().to_string()
    };
    assert!(changed(4, &[1]).contains("the file is of glTF version 1"));
    assert!(changed(8, &[0xff; 4]).contains("its header says 4294967295"));
    assert!(changed(12, &[0xff; 4]).contains("a chunk is 4294967295 bytes long"));
    assert!(changed(16, b"BIN\0").contains("the first chunk of the binary file is no JSON"));
    assert!(changed(24, &[0xff]).contains("is not UTF-8"));
    assert!(
        parse(b"").is_err()
            && parse(b"[]").is_err()
            && parse(b"{}").unwrap_err().to_string().contains("missing key `asset`")
    );
}

/// A file that has most features.
fn rich() -> File {
    let mut file = File::triangle();
    let indices = file.whole(UNSIGNED_SHORT, 1, &[0, 1, 2, 2, 1, 0]);
    let joints = file.whole(UNSIGNED_BYTE, 4, &[0; 12]);
    let weights = file.floats(4, &[0.25; 12]);
    let colors = file.floats(4, &[0.5; 12]);
    let times = file.floats(1, &[0.0, 1.0]);
    let places = file.floats(3, &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    file.root["meshes"] = json!([
        {"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": colors}, "indices": indices, "material": 0, "targets": [{"POSITION": 0}]}], "weights": [0.5]},
        {"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights}, "mode": 5, "material": 1}]},
    ]);
    file.root["materials"] = json!([
        {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1}}},
        {"extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5}}, "emissiveFactor": [1, 1, 1]},
    ]);
    file.root["skins"] = json!([{"joints": [2]}]);
    file.root["animations"] = json!([{"samplers": [{"input": times, "output": places}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]}]);
    file.root["nodes"] = json!([
        {"mesh": 0, "children": [1, 2], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}},
        {"mesh": 1, "skin": 0},
        {"rotation": [0, 0, 1, 0]},
    ]);
    file
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    /// Changed bytes, of the JSON and of the numbers, give a scene, or an error at an element.
    #[test]
    fn random_changes_give_a_scene_or_an_error(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        digits in proptest::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 0..4),
        is_timed in any::<bool>(),
    ) {
        let mut bytes = rich().binary();
        for (place, digit) in digits {
            // Another number in the place of one.
            let places: Vec<usize> = (20..bytes.len()).filter(|at| bytes[*at].is_ascii_digit()).collect();
            bytes[places[place.index(places.len())]] = digit;
        }
        for (place, byte) in changes {
            let place = bytes.len() - 1 - place.index(bytes.len() / 4);
            bytes[place] = byte;
        }
        let options = LoadOptions { time: is_timed.then_some(0.5), ..LoadOptions::default() };
        match desc::parse_gltf(&bytes, Path::new("/nowhere"), Some(Path::new("m.glb")), &options) {
            Ok(desc) => {
                // Coordinates that are too large for the ray kernel are told by the scene, at the surface.
                if let Err(error) = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }) {
                    prop_assert_eq!(error.kind(), ErrorKind::InvalidScene, "{}", error);
                    prop_assert!(error.location().json_path.starts_with("nodes["), "{}", error);
                }
            }
            Err(error) => prop_assert!(error.location().file.is_some() && error.message().len() < 1000, "{error}"),
        }
    }
}

/// All glTF files below a folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in folder.read_dir().expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|it| it == "gltf" || it == "glb") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Files of other programs, from Debian's package assimp-testmodels: each is a scene that builds, or is refused with one sentence
/// about an element of it.
#[test]
fn files_of_other_programs_are_read_or_refused() {
    let models = Path::new("/usr/share/assimp/models");
    if !models.join("glTF2").is_dir() {
        eprintln!("SKIPPED: {} is not there (package assimp-testmodels)", models.join("glTF2").display());
        return;
    }
    for (folder, least_read) in [("glTF2", 22), ("glTF", 0), ("invalid", 0)] {
        let (mut read, mut refused, mut warnings) = (0, 0, 0);
        for path in files_below(&models.join(folder)) {
            match desc::load(&path, None) {
                Ok(scene) => {
                    let built = Scene::build(&scene, &BuildOptions { threads: 1, ..BuildOptions::default() });
                    built.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                    assert_ne!(folder, "glTF", "{}: version 1 is refused", path.display());
                    eprintln!("{}: {} surfaces", path.display(), scene.surfaces.len());
                    scene.warnings.iter().for_each(|warning| eprintln!("    {warning}"));
                    (read, warnings) = (read + 1, warnings + scene.warnings.len());
                }
                Err(error) => {
                    eprintln!("{error}");
                    let text = error.to_string();
                    assert!(text.contains(path.to_str().expect("a path")) || error.kind() == ErrorKind::Io, "{text}");
                    assert!(text.len() < 1000 && !text.contains('\n'), "{text}");
                    refused += 1;
                }
            }
        }
        eprintln!("| {folder} | {read} read | {refused} refused | {warnings} warnings |");
        assert!(read >= least_read, "{folder}: fewer are read than can be");
    }
}

/// A spot light shines along its node's axis -z, whatever its scale, with the angles that glTF does not require.
#[test]
fn spot_lights_turn_with_their_nodes() {
    let mut file = File::triangle();
    file.root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}});
    let half = std::f64::consts::FRAC_1_SQRT_2;
    file.root["nodes"] = json!([{"mesh": 0, "children": [1]}, {
        "extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [-half, 0, 0, half], "scale": [3, 3, 3]}]);
    let scene = file.load().unwrap();
    let LightDistribution::Spot(spot) = &scene.lights[0].distribution else { panic!("a spot light") };
    near(spot.direction.normalize(), [0.0, -1.0, 0.0]);
    assert_eq!([spot.outer_deg, spot.inner_deg], [45.0, 0.0]);
    for (spot, expected) in [
        (json!({"outerConeAngle": 0}), "spot.outerConeAngle: 0 degrees are out of range"),
        (json!({"outerConeAngle": 0.5, "innerConeAngle": 1}), "spot.innerConeAngle: 57.2"),
    ] {
        file.root["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"] = spot;
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains(&format!("extensions.KHR_lights_punctual.lights[0].{expected}")), "{error}");
    }
    file.root["extensions"]["KHR_lights_punctual"]["lights"][0] = json!({"type": "spot"});
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("lights[0]: missing key `spot`"), "{error}");
}
