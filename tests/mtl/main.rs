//! Materials of Wavefront OBJ files: what the keys of their libraries become, and how meshes are divided by them.

#[path = "../common/mod.rs"]
mod common;
mod maps;

use std::path::Path;

use common::scenes::{Job, render_scene};
use etendue::desc::{self, MaterialDesc, SceneDesc, ShapeDesc};
use etendue::math::DAffine3;
use etendue::scene::{BuildOptions, Scene};
use etendue::{Error, ErrorKind};
use proptest::prelude::*;
use serde_json::{Value, json};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder with `m.obj` and `m.mtl`.
fn folder(obj: &[u8], mtl: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("m.obj"), obj).expect("a file");
    std::fs::write(folder.path().join("m.mtl"), mtl).expect("a file");
    folder
}

fn scene_of(surfaces: &Value) -> String {
    json!({"etendue": 1, "camera": {"origin": [0, 1, 3], "lookAt": [0, 1, 0]}, "surfaces": surfaces}).to_string()
}

fn from_file(file: &str) -> Value {
    json!({"geometry": "mesh", "file": file, "materials": "from-file"})
}

fn load(obj: &[u8], mtl: &[u8]) -> Result<SceneDesc, Error> {
    desc::parse(&scene_of(&json!([from_file("m.obj")])), folder(obj, mtl).path(), None)
}

/// The scene of a triangle with the material `m` of a library.
fn of_library(mtl: &str) -> SceneDesc {
    let obj = format!("mtllib m.mtl\nusemtl m\n{TRIANGLE}");
    load(obj.as_bytes(), format!("newmtl m\n{mtl}").as_bytes()).expect("a scene")
}

/// Blender writes materials without a name so.
#[test]
fn a_material_may_have_no_name() {
    let obj = format!("mtllib m.mtl\nusemtl \n{TRIANGLE}");
    let scene = load(obj.as_bytes(), b"newmtl \nKd 0.25 0.5 0.75\n").expect("a scene");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.materials[0].bsdf, of_library("Kd 0.25 0.5 0.75").materials[0].bsdf);
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

fn ns(exponent: f64) -> f64 {
    // The width of facets, and its root.
    (2.0 / (exponent + 2.0)).sqrt().sqrt()
}

fn principled(more: &Value) -> Value {
    let mut it = json!({"type": "principled"});
    it.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    it
}

/// Every row of the table in docs/materials.md.
#[test]
fn keys_become_what_the_table_says() {
    let plastic = |roughness: f64, more: Value| {
        let mut it = principled(&json!({"base_color": [0.6, 0.5, 0.4], "specular_roughness": roughness}));
        it.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        it
    };
    let metal =
        |colour: [f64; 3], roughness: f64| json!({"type": "conductor", "reflectance": colour, "roughness": roughness});
    let kd = "Kd 0.6 0.5 0.4\n";
    let with = |rest: &str| format!("{kd}{rest}");
    let cases: Vec<(String, Vec<Value>)> = vec![
        // Diffuse surfaces.
        (kd.into(), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4]})]),
        ("Kd 0.25".into(), vec![json!({"type": "diffuse", "color": [0.25, 0.25, 0.25]})]),
        ("illum 2".into(), vec![json!({"type": "diffuse", "color": [0.8, 0.8, 0.8]})]),
        (with("Ks 0 0 0\nNs 50"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4]})]),
        (with("Ks 0.5 0.5 0.5\nillum 1"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4]})]),
        // Highlights over a diffuse surface.
        (with("Ks 0.5 0.25 0.1\nNs 98\nillum 2"), vec![plastic(ns(98.0), json!({"specular_weight": 0.5}))]),
        (with("Ks 0.5 0.5 0.5"), vec![plastic(0.3, json!({"specular_weight": 0.5}))]),
        (with("Ks 1 1 1\nNs 0\nNi 1.3"), vec![plastic(1.0, json!({"specular_ior": 1.3}))]),
        (with("Ks 0.5 0.5 0.5\nNi 1\nillum 5"), vec![plastic(0.0, json!({}))]),
        // Metals.
        ("Ks 0.9 0.6 0.2\nNs 30".into(), vec![metal([0.9, 0.6, 0.2], ns(30.0))]),
        ("Kd 0 0 0\nKs 0.9 0.6 0.2\nillum 3".into(), vec![metal([0.9, 0.6, 0.2], 0.0)]),
        (
            "Kd 0.25 0 0\nKs 0.5 0.25 0\nillum 3\nNs 6".into(),
            vec![
                json!({"type": "diffuse", "color": [0.75, 0, 0]}),
                metal([0.75, 0.375, 0.0], ns(6.0)),
                json!({"type": "mix", "materials": ["part 0", "part 1"], "weight": 2.0 / 3.0}),
            ],
        ),
        (
            "Kd 1 0.5 0\nKs 1 0.25 0\nillum 8".into(),
            vec![
                json!({"type": "diffuse", "color": [1, 0.5, 0]}),
                metal([1.0, 0.25, 0.0], 0.0),
                json!({"type": "mix", "materials": ["part 0", "part 1"], "weight": 0.5}),
            ],
        ),
        // Glass.
        (with("illum 7\nNi 1.33\nd 0.2\nNs 10"), vec![json!({"type": "refractive", "refractionIndex": 1.33})]),
        (with("illum 6\nNi 1.0"), vec![json!({"type": "refractive", "refractionIndex": 1.5})]),
        (
            with("illum 7\nNi 1.4\nTf 1 0.5 0.25"),
            vec![principled(&json!({"specular_roughness": 0, "specular_ior": 1.4, "transmission_weight": 1,
                "transmission_color": [1, 0.5, 0.25]}))],
        ),
        (
            with("illum 4\nNi 1.6\nTf 0.9 0.8 0.7"),
            vec![json!({"type": "thin-refractive", "refractionIndex": 1.6, "transmittance": [0.9, 0.8, 0.7]})],
        ),
        (with("illum 9"), vec![json!({"type": "thin-refractive", "refractionIndex": 1.5})]),
        // Opacity.
        (with("illum 9\nd 0.25"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "opacity": 0.25})]),
        (with("d 0.25\nTf 1 1 1"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "opacity": 0.25})]),
        (with("Tr 0.25"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "opacity": 0.75})]),
        (with("Tr 0.25\nd 1"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4]})]),
        // Emission.
        (with("Ke 3 2 1"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "emission": [3, 2, 1]})]),
        (with("Ke 0 0 0\nd 0.5"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "opacity": 0.5})]),
        (with("Ke 3 2 1\nd 0.5"), vec![json!({"type": "diffuse", "color": [0.6, 0.5, 0.4], "emission": [3, 2, 1]})]),
        // The physical extension.
        (with("Pr 0.45"), vec![plastic(0.45, json!({}))]),
        (with("Pm 1\nNs 98"), vec![plastic(ns(98.0), json!({"base_metalness": 1}))]),
        ("Ps 0.5\nNi 1.4".into(), vec![principled(&json!({"fuzz_weight": 0.5, "specular_ior": 1.4}))]),
        (
            with("Pr 0.2\nPm 0.25\nPs 0.5\nPc 0.75\nPcr 0.125\naniso 0.5\nanisor 0.25\nKs 0.1 0.1 0.1\nillum 2\nd 0.5"),
            vec![plastic(
                0.2,
                json!({"base_metalness": 0.25, "fuzz_weight": 0.5, "coat_weight": 0.75,
                "coat_roughness": 0.125, "specular_roughness_anisotropy": 0.5, "specular_rotation": 90, "opacity": 0.5}),
            )],
        ),
        (
            with("Pr 0.2\nillum 9\nTf 1 0.5 1\nNi 1.2"),
            vec![plastic(
                0.2,
                json!({"transmission_weight": 1, "transmission_color": [1, 0.5, 1], "specular_ior": 1.2}),
            )],
        ),
    ];
    for (mtl, materials) in cases {
        let (found, expected) = (of_library(&mtl).materials, native(&materials));
        let content = |it: &MaterialDesc| MaterialDesc { name: String::new(), path: String::new(), ..it.clone() };
        let [found, expected] = [found, expected].map(|all| all.iter().map(content).collect::<Vec<_>>());
        assert_eq!(found, expected, "{mtl}");
    }
}

#[test]
fn faces_of_a_material_become_a_surface() {
    let obj = "mtllib m.mtl\n\
        v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\n\
        vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
        g first\nusemtl one of two\nf 1/1/1 2/2/1 3/3/1 4/4/1\n\
        usemtl never used\nusemtl two\no second\nf 2/1/1 5/2/1 6/3/1\n\
        usemtl one of two\nf -7/1/1 -6/2/1 -1/3/1\n";
    let mtl = "\u{feff}# a comment\r\n\n newmtl two \r\nKd 0.5 0.5 0.5 # grey\r\nnewmtl one of two\nKd 1 0 0\nnewmtl other\nKe 9 9 9";
    let folder = folder(obj.as_bytes(), mtl.as_bytes());
    // The file is read once, however many surfaces use it.
    let mut moved = from_file("m.obj");
    (moved["transform"], moved["shading"]) = (json!({"translate": [0, 0, 2]}), json!("smooth"));
    let scene = desc::parse(&scene_of(&json!([from_file("m.obj"), moved])), folder.path(), None).unwrap();
    let names: Vec<&str> = scene.materials.iter().map(|material| material.name.rsplit(':').next().unwrap()).collect();
    assert_eq!(names, ["one of two", "two"]);
    assert_eq!((scene.meshes.len(), scene.surfaces.len(), scene.warnings.len()), (2, 4, 0));
    assert_eq!(scene.files, [folder.path().join("m.obj"), folder.path().join("m.mtl")]);
    let sizes: Vec<_> = scene.meshes.iter().map(|mesh| (mesh.triangle_count(), mesh.vertex_count())).collect();
    assert_eq!(sizes, [(3, 5), (1, 3)]);
    let corners = |mesh: usize, triangle: usize| {
        scene.meshes[mesh]
            .triangle(triangle)
            .map(|vertex| scene.meshes[mesh].position(vertex as usize).truncate().to_array())
    };
    assert_eq!(corners(0, 2), [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]]);
    assert_eq!(corners(1, 0), [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]);
    for mesh in &scene.meshes {
        assert_eq!([mesh.normals.len(), mesh.uvs.len()], [mesh.vertex_count(); 2]);
    }
    for (number, surface) in scene.surfaces.iter().enumerate() {
        let ShapeDesc::Mesh { mesh, smooth } = surface.shape else { panic!("not a mesh") };
        assert_eq!((surface.material, mesh, smooth), (Some(number % 2), number % 2, number >= 2));
        assert_eq!(surface.path, format!("surfaces[{}]", number / 2));
    }

    // The same by calls, several times.
    let mut calls = SceneDesc::default();
    let file = folder.path().join("m.obj");
    assert_eq!(calls.add_file_surfaces(&file, false, DAffine3::IDENTITY).unwrap(), 0..2);
    assert_eq!(calls.materials[0].name, format!("{}:one of two", file.display()));
    assert_eq!(calls.find_material(&calls.materials[1].name), Some(1));
    assert_eq!(
        calls.add_file_surfaces(&file, true, DAffine3::from_scale(etendue::math::DVec3::splat(2.0))).unwrap(),
        2..4
    );
    assert_eq!((calls.materials[2].name.as_str(), calls.surfaces[3].material), ("", Some(3)));
    assert_eq!(calls.surfaces[3].transform.matrix3.x_axis.x, 2.0);
    for (made, read) in calls.meshes.iter().zip(&scene.meshes) {
        assert!(made.triangles == read.triangles && made.positions == read.positions);
    }
    // A call that fails changes nothing.
    let before = format!("{calls:?}");
    let flat = DAffine3::from_scale(etendue::math::DVec3::new(1.0, 1.0, 0.0));
    let far = DAffine3::from_scale(etendue::math::DVec3::splat(2e38));
    for transform in [flat, far] {
        assert!(calls.add_file_surfaces(&file, false, transform).is_err());
    }
    assert_eq!(
        calls.add_file_surfaces(Path::new("no.obj"), false, DAffine3::IDENTITY).unwrap_err().kind(),
        ErrorKind::Io
    );
    assert_eq!(format!("{calls:?}"), before);
}

/// A scene of a file is the one that says the same with native materials, to the last bit.
#[test]
fn pictures_of_a_file_are_those_of_native_materials() {
    let bits = |text: &str, folder: &Path| {
        let desc = desc::parse(text, folder, None).expect("a scene");
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene that builds");
        let (image, _) = render_scene(&scene, Job { resolution: [16, 16], samples: 4, ..Job::default() }.desc());
        assert!(image.rgb.iter().any(|value| *value > 1.0));
        image.rgb.iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let of_file = scene_of(&json!([from_file("parts.obj")]));
    let quad = |z: [f64; 12], more: Value| {
        let mut mesh =
            json!({"geometry": "mesh", "positions": z.as_chunks::<3>().0, "triangles": [[0, 1, 2], [0, 2, 3]]});
        mesh.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        mesh
    };
    let mut native: Value = serde_json::from_str(&scene_of(&json!([
        quad([-1.0, 0.0, -1.0, 1.0, 0.0, -1.0, 1.0, 2.0, -1.0, -1.0, 2.0, -1.0], json!({"material": "wall"})),
        quad([-0.3, 1.9, -0.5, 0.3, 1.9, -0.5, 0.3, 1.9, 0.1, -0.3, 1.9, 0.1], json!({"material": "lamp"})),
    ])))
    .expect("a scene");
    native["materials"] = json!([{"name": "wall", "type": "diffuse", "color": [0.7, 0.1, 0.1]},
        {"name": "lamp", "type": "diffuse", "color": [0, 0, 0], "emission": [4, 3.5, 3]}]);
    let data = common::snippets::data_dir();
    assert!(bits(&of_file, &data) == bits(&native.to_string(), &data));
}

#[test]
fn what_has_no_meaning_is_warned_of_once() {
    let mtl = "Ka 1 1 1\nKd 2 0.5 0.5\nKd 3 0.5 0.5\nmap_Kd -s 1 1 1 wood.png\nbump a.png\n\
        newmtl other\nKa 0 0 0\nmap_Kd other.png\nKs spectral gold.rfl 1\nd -halo 0.5\nNi 0\nNs -1\nPr 7\nnewmtl m\nKd 0 0 0\n\
        newmtl last\nillum 11\nKd xyz 1 1 1\nsharpness 60\nKd 0.5 0.5 0.5\nKe 1 1 1\nd 0.5\n";
    let obj = format!("mtllib m.mtl\nusemtl m\n{TRIANGLE}usemtl last\nf 1 2 3\n");
    let scene = load(obj.as_bytes(), format!("newmtl m\n{mtl}").as_bytes()).unwrap();
    let expected = [
        "m.mtl:2: Ka has no meaning here; it is left out",
        "m.mtl:3: Kd is out of range, expected 0 to 1; the nearest number in range is used",
        "m.mtl:10: Ks of a spectrum or in CIE XYZ has no meaning here; it is left out",
        "m.mtl:11: d -halo has no meaning here; it is left out",
        "m.mtl:12: Ni of 0 is no index of refraction; it is left out",
        "m.mtl:13: Ns is out of range, expected 0 to 1000000000; the nearest number in range is used",
        "m.mtl:14: Pr is out of range, expected 0 to 1; the nearest number in range is used",
        "m.mtl:15: newmtl 'm' is given twice; the first is used",
        "m.mtl:18: illum is out of range, expected 0 to 10; the nearest number in range is used",
        "m.mtl:19: Kd of a spectrum or in CIE XYZ has no meaning here; it is left out",
        "m.mtl:20: sharpness has no meaning here; it is left out",
        "m.mtl:5: map_Kd 'wood.png' lies on a mesh without texture coordinates; it is left out",
        "m.mtl:6: bump 'a.png' lies on a mesh without texture coordinates; it is left out",
        "last' emits light (Ke); it is opaque",
    ];
    assert_eq!(scene.warnings.len(), expected.len(), "{:#?}", scene.warnings);
    for (said, expected) in scene.warnings.iter().zip(expected) {
        assert!(said.starts_with("surfaces[0].file: ") && said.contains(expected), "{said}\nnot {expected}");
    }
    assert_eq!(scene.materials[0].bsdf, native(&[json!({"type": "diffuse", "color": [1, 0.5, 0.5]})])[0].bsdf);
    // However many keys there are, not all of them are listed.
    let many: String = (0..5000).map(|i| format!("key{i} 1\n")).collect();
    assert_eq!(of_library(&many).warnings.len(), 100);
}

/// Files whose library, or whose material, is not there are read all the same, with a grey material.
#[test]
fn faces_without_a_known_material_are_grey() {
    let obj = |head: &str| format!("{head}\n{TRIANGLE}");
    let fine = "newmtl m\nKd 1 1 1\n";
    let grey = native(&[json!({"type": "diffuse", "color": [0.8, 0.8, 0.8]})])[0].bsdf;
    let unknown = "no material named 'm' in its material libraries";
    for (obj, mtl, expected) in [
        (obj("mtllib m.mtl\nusemtl m"), "", vec![format!("m.obj:2: {unknown}; a grey")]),
        (obj("mtllib m.mtl\nusemtl m"), "newmtl M\n", vec![format!("m.obj:2: {unknown}; a grey")]),
        (
            obj("mtllib no.mtl\nusemtl m"),
            fine,
            vec!["m.obj:1: there is no material library 'no.mtl'".to_owned(), format!("m.obj:2: {unknown}")],
        ),
        (obj("mtllib\nusemtl m"), fine, vec![format!("m.obj:2: {unknown}")]),
        (obj("mtllib m.mtl\nusemtl"), fine, vec!["m.obj:2: faces have no material; a grey".to_owned()]),
        (obj("mtllib m.mtl"), fine, vec!["m.obj:5: faces have no material; a grey".to_owned()]),
        (TRIANGLE.to_owned(), fine, vec!["m.obj:4: faces have no material; a grey".to_owned()]),
    ] {
        let scene = load(obj.as_bytes(), mtl.as_bytes()).unwrap();
        assert_eq!(scene.materials.iter().map(|material| material.bsdf).collect::<Vec<_>>(), [grey], "{obj}");
        assert_eq!(scene.warnings.len(), expected.len(), "{obj}: {:#?}", scene.warnings);
        for (said, expected) in scene.warnings.iter().zip(expected) {
            assert!(said.starts_with("surfaces[0].file: ") && said.contains(&expected), "{said}\nnot {expected}");
        }
    }
    // Some faces have one, and others do not.
    let both = format!("mtllib m.mtl no.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\nf 1 3 2\nusemtl\nf 2 1 3\n");
    let scene = load(both.as_bytes(), fine.as_bytes()).unwrap();
    assert_eq!((scene.materials.len(), scene.meshes.len(), scene.warnings.len()), (2, 2, 2), "{:?}", scene.warnings);
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.triangles.len()).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn broken_libraries_are_refused_with_file_line_and_reason() {
    let obj = |head: &str| format!("{head}\n{TRIANGLE}");
    let fine = "newmtl m\nKd 1 1 1\n";
    let given = obj("mtllib m.mtl\nusemtl m");
    for (obj, mtl, expected) in [
        (given.as_str(), "newmtl m\nKd 1 x 1\n", "m.mtl:2: surfaces[0].file: Kd: 'x' is not a finite number"),
        (&given, "newmtl m\nKd 1 nan 1\n", "m.mtl:2: surfaces[0].file: Kd: 'nan' is not a finite number"),
        (&given, "newmtl m\nKd 1 1e999 1\n", "m.mtl:2: surfaces[0].file: Kd: '1e999' is not a finite number"),
        (&given, "newmtl m\nKd 1 1\n", "m.mtl:2: surfaces[0].file: Kd: a colour has three numbers, found 2"),
        (&given, "newmtl m\nKe\n", "m.mtl:2: surfaces[0].file: Ke: a colour has three numbers, found 0"),
        (&given, "newmtl m\n\nNs\n", "m.mtl:3: surfaces[0].file: Ns: a number is missing"),
        (
            &given,
            "newmtl m\nillum 2.5\n",
            "m.mtl:2: surfaces[0].file: illum: 2.5, expected a whole number from 0 to 10",
        ),
        (&given, "Kd 1 1 1\n", "m.mtl:1: surfaces[0].file: 'Kd' before the first newmtl; is it a material library?"),
    ] {
        let error = load(obj.as_bytes(), mtl.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot {expected}");
    }
    // A folder, and a file that is none.
    let error = load(obj("mtllib .\nusemtl m").as_bytes(), b"").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io, "{error}");
    let many: String = (0..65).map(|_| "mtllib m.mtl\n").collect();
    let error = load(obj(&format!("{many}usemtl m")).as_bytes(), fine.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("m.obj:65: surfaces[0].file: the file names more than 64 material libraries"), "{error}");
    let many: String = (0..=65536).map(|i| format!("newmtl {i}\n")).collect();
    let error = load(given.as_bytes(), many.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("m.mtl:65537: surfaces[0].file: the file has more than 65536 materials"), "{error}");

    // What files allow: Windows' separators, blanks in names, several libraries.
    for head in ["mtllib .\\m.mtl\nusemtl m", "mtllib m.mtl m.mtl\r\nusemtl m\r"] {
        let scene = load(obj(head).as_bytes(), fine.as_bytes()).unwrap();
        assert_eq!(scene.materials.len(), 1, "{head}");
    }

    // The keys of the surface.
    for (key, value) in
        [("material", json!("m")), ("emission", json!([1, 1, 1])), ("mesh", json!("m")), ("uvs", json!([]))]
    {
        let mut surface = from_file("m.obj");
        surface[key] = value;
        let error = desc::parse(&scene_of(&json!([surface])), Path::new(""), None).unwrap_err().to_string();
        let expected = format!("surfaces[0].{key}: the materials are those of the file");
        assert!(error.contains(&expected), "{error}");
    }
    let mut surface = from_file("m.obj");
    surface["materials"] = json!("from-files");
    let error = desc::parse(&scene_of(&json!([surface])), Path::new(""), None).unwrap_err().to_string();
    assert!(error.contains("surfaces[0].materials: unknown name"), "{error}");
    surface = json!({"geometry": "mesh", "materials": "from-file"});
    let error = desc::parse(&scene_of(&json!([surface])), Path::new(""), None).unwrap_err().to_string();
    assert!(error.contains("surfaces[0]: missing key `file`, whose materials are asked for"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// Changed bytes give a scene that builds, or an error.
    #[test]
    fn random_changes_of_a_library_give_a_scene_or_an_error(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        lines in proptest::collection::vec(
            "(newmtl|Kd|Ks|Ke|Tf|Ns|Ni|d|Tr|illum|Pr|Pm|Ps|Pc|Pcr|aniso|anisor|Ka|map_Kd) (-?[0-9]{1,2}(\\.[0-9])?(e[0-9]{1,2})? ?){0,4}",
            0..20,
        ),
    ) {
        let mut mtl = format!("newmtl m\n{}\n", lines.join("\n")).into_bytes();
        for (place, byte) in changes {
            let place = place.index(mtl.len());
            mtl[place] = byte;
        }
        let obj = format!("mtllib m.mtl\nusemtl m\n{TRIANGLE}");
        match load(obj.as_bytes(), &mtl) {
            Ok(desc) => {
                let built = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() });
                prop_assert!(built.is_ok(), "{:?}", built.err());
            }
            Err(error) => {
                prop_assert!(error.location().file.is_some() && error.message().len() < 1000, "{error}");
            }
        }
    }
}

/// Files of other programs, from Debian's package assimp-testmodels.
#[test]
fn files_of_other_programs_are_read() {
    let folder = Path::new("/usr/share/assimp/models/OBJ");
    let Ok(entries) = folder.read_dir() else {
        eprintln!("SKIPPED: {} is not there (package assimp-testmodels)", folder.display());
        return;
    };
    let (mut read, mut refused) = (0, 0);
    for path in entries.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|it| it == "obj"))
    {
        let mut scene = SceneDesc::default();
        match scene.add_file_surfaces(&path, false, DAffine3::IDENTITY) {
            Ok(surfaces) => {
                assert!(!surfaces.is_empty());
                Scene::build(&scene, &BuildOptions::default())
                    .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                read += 1;
            }
            Err(error) => {
                eprintln!("{error}");
                refused += 1;
            }
        }
    }
    eprintln!("{read} files were read, {refused} refused");
    assert!(read >= 10, "most of them can be read");
}
