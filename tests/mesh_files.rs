//! Mesh files of all formats and encodings: the same mesh whichever way it is written, and one clear error for what is broken.

mod common;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use common::scenes::{Job, render_scene};
use etendue::desc::{self, BsdfDesc, LoadOptions, MeshDesc, SceneDesc, ShapeDesc, SurfaceLook};
use etendue::math::DAffine3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Cancel, Error, ErrorKind};
use proptest::prelude::*;
use serde_json::json;

fn file(name: &str, content: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a file");
    (folder, path)
}

/// The mesh of a file of this name and content, and the warnings.
fn load(name: &str, content: &[u8]) -> Result<(MeshDesc, Vec<String>), Error> {
    let (_folder, path) = file(name, content);
    let mut scene = SceneDesc::default();
    let number = scene.add_mesh_file("mesh", &path)?;
    Ok((scene.meshes[number].as_ref().clone(), scene.warnings))
}

/// What is said of a file that is refused.
fn refusal(name: &str, content: &[u8]) -> String {
    match load(name, content) {
        Ok((mesh, _)) => {
            panic!("{name} was read as {} triangles: {}", mesh.triangles.len(), String::from_utf8_lossy(content))
        }
        Err(error) => {
            assert_eq!(error.kind(), ErrorKind::InvalidScene, "{error}");
            assert!(error.location().file.as_ref().is_some_and(|file| file.ends_with(name)), "{error}");
            let line = error.location().line;
            if line == 0 { error.message().to_owned() } else { format!("{line}: {}", error.message()) }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// A writer of PLY, which has nothing from the reader.
struct Ply {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Ply {
    fn new(encoding: Encoding, header: &str) -> Self {
        let name = match encoding {
            Encoding::Text => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        Self { encoding, bytes: format!("ply\nformat {name} 1.0\ncomment {header}end_header\n").into_bytes() }
    }

    fn put(&mut self, text: &str, little: &[u8]) {
        match self.encoding {
            Encoding::Text => self.bytes.extend(format!("{text} ").bytes()),
            Encoding::Little => self.bytes.extend(little),
            Encoding::Big => self.bytes.extend(little.iter().rev()),
        }
    }

    fn f32(&mut self, value: f32) {
        self.put(&value.to_string(), &value.to_le_bytes());
    }

    fn f64(&mut self, value: f64) {
        self.put(&value.to_string(), &value.to_le_bytes());
    }

    fn u8(&mut self, value: u8) {
        self.put(&value.to_string(), &[value]);
    }

    fn i16(&mut self, value: i16) {
        self.put(&value.to_string(), &value.to_le_bytes());
    }

    fn i32(&mut self, value: i32) {
        self.put(&value.to_string(), &value.to_le_bytes());
    }

    fn end(&mut self) {
        if self.encoding == Encoding::Text {
            self.bytes.push(b'\n');
        }
    }
}

/// Vertices with normals and texture coordinates, and polygons.
#[derive(Clone, Debug)]
struct Model {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    faces: Vec<Vec<usize>>,
}

impl Model {
    fn cube() -> Self {
        let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f32 * 2.0 - 1.0);
        let positions: Vec<[f32; 3]> = (0..8).map(corner).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Self {
            normals: positions.clone(),
            uvs: positions.iter().map(|[x, y, z]| [0.5 * x + 0.25 * z, 0.5 * y]).collect(),
            positions,
            faces: faces.into_iter().map(Vec::from).collect(),
        }
    }

    fn obj(&self) -> Vec<u8> {
        let mut text = String::new();
        for [x, y, z] in &self.positions {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for [x, y, z] in &self.normals {
            writeln!(text, "vn {x} {y} {z}").unwrap();
        }
        for [u, v] in &self.uvs {
            writeln!(text, "vt {u} {v}").unwrap();
        }
        for face in &self.faces {
            let corners: Vec<String> = face.iter().map(|i| format!("{0}/{0}/{0}", i + 1)).collect();
            writeln!(text, "f {}", corners.join(" ")).unwrap();
        }
        text.into_bytes()
    }

    fn ply(&self, encoding: Encoding, uv: [&str; 2], corners: &str) -> Vec<u8> {
        let mut ply = Ply::new(
            encoding,
            &format!(
                "a model\nelement vertex {}\nproperty double x\nproperty float32 y\nproperty float z\nproperty uchar red\n\
                 property float nx\nproperty float ny\nproperty double nz\nproperty float {}\nproperty float {}\n\
                 element face {}\nproperty list short int {corners}\nproperty list uchar float texcoord\n\
                 element edge 1\nproperty int vertex1\n",
                self.positions.len(),
                uv[0],
                uv[1],
                self.faces.len()
            ),
        );
        for ((position, normal), uv) in self.positions.iter().zip(&self.normals).zip(&self.uvs) {
            ply.f64(position[0].into());
            ply.f32(position[1]);
            ply.f32(position[2]);
            ply.u8(200);
            ply.f32(normal[0]);
            ply.f32(normal[1]);
            ply.f64(normal[2].into());
            uv.iter().for_each(|value| ply.f32(*value));
            ply.end();
        }
        for face in &self.faces {
            ply.i16(face.len() as i16);
            face.iter().for_each(|corner| ply.i32(*corner as i32));
            ply.u8(2);
            ply.f32(f32::NAN);
            ply.f32(0.5);
            ply.end();
        }
        ply.i32(-7);
        ply.end();
        ply.bytes
    }

    fn triangles(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        let fan = |face: &Vec<usize>| {
            let face = face.clone();
            (2..face.len()).map(move |i| [face[0], face[i - 1], face[i]])
        };
        self.faces.iter().flat_map(fan).map(|triangle| triangle.map(|i| self.positions[i]))
    }

    fn stl_text(&self) -> Vec<u8> {
        let mut text = "solid a model\n".to_owned();
        for triangle in self.triangles() {
            text += " facet normal 0 0 nan\n  outer loop\n";
            for [x, y, z] in triangle {
                writeln!(text, "   vertex {x:e} {y:e} {z:e}").unwrap();
            }
            text += "  endloop\n endfacet\n";
        }
        text += "endsolid a model\n";
        text.into_bytes()
    }

    fn stl_binary(&self, header: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes[..header.len()].copy_from_slice(header);
        bytes.extend((self.triangles().count() as u32).to_le_bytes());
        for triangle in self.triangles() {
            bytes.extend([0; 12]);
            bytes.extend(triangle.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    /// The files of this model that hold all of it.
    fn whole(&self) -> Vec<(String, &'static str, Vec<u8>)> {
        let names = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
        let mut files = vec![("OBJ".to_owned(), "m.obj", self.obj())];
        for encoding in [Encoding::Text, Encoding::Little, Encoding::Big] {
            for (i, uv) in names.into_iter().enumerate() {
                let corners = ["vertex_indices", "vertex_index"][i % 2];
                files.push((format!("PLY {encoding:?} {uv:?}"), "m.ply", self.ply(encoding, uv, corners)));
            }
        }
        files
    }
}

/// Bits of the position, the normal and the texture coordinate of a corner.
type Corner = ([u32; 3], Option<[u32; 3]>, Option<[u32; 2]>);

/// All that a triangle's corners are, whatever the numbers of vertices.
fn corners(mesh: &MeshDesc) -> Vec<Corner> {
    let of = |vertex: u32| {
        let vertex = vertex as usize;
        let position = mesh.positions[vertex].as_vec3().to_array().map(f32::to_bits);
        (
            position,
            mesh.normals.get(vertex).map(|n| n.map(f32::to_bits)),
            mesh.uvs.get(vertex).map(|uv| uv.map(f32::to_bits)),
        )
    };
    mesh.triangles.iter().flatten().map(|vertex| of(*vertex)).collect()
}

/// A picture of a mesh in front of a lamp, bit by bit.
fn picture(mesh: MeshDesc, smooth: bool) -> Vec<u32> {
    let mut scene = SceneDesc::default();
    let material = scene.add_material("", BsdfDesc::Lambert { albedo: Rgb::splat(0.5) }, None).unwrap();
    let mesh = scene.add_mesh(MeshDesc { name: String::new(), ..mesh }).unwrap();
    let look = SurfaceLook { material: Some(material), ..SurfaceLook::default() };
    scene.add_surface(ShapeDesc::Mesh { mesh, smooth }, DAffine3::IDENTITY, look).unwrap();
    scene.add_point_light([1.0, 4.0, 5.0].into(), Rgb::splat(50.0)).unwrap();
    let camera = json!({"etendue": 1, "camera": {"origin": [3, 2, 4], "lookAt": [0, 0, 0], "fieldOfView": 40}});
    scene.camera = desc::parse(&camera.to_string(), Path::new(""), None).unwrap().camera;
    let built = Scene::build(&scene, &BuildOptions::default()).unwrap();
    let (image, _) = render_scene(&built, Job { resolution: [24, 24], samples: 4, ..Job::default() }.desc());
    assert!(image.rgb.iter().any(|value| *value > 0.01));
    image.rgb.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn all_encodings_hold_the_same_mesh() {
    let model = Model::cube();
    let (whole, _) = load("m.obj", &model.obj()).unwrap();
    let (expected, image) = (corners(&whole), picture(whole.clone(), true));
    assert_eq!(whole.triangles.len(), 12);
    for (what, name, bytes) in model.whole() {
        let (mesh, warnings) = load(name, &bytes).unwrap();
        assert_eq!(corners(&mesh), expected, "{what}");
        assert_eq!(picture(mesh, true), image, "{what}");
        let notes: Vec<&str> = warnings.iter().map(|warning| warning.split(": ").nth(2).unwrap()).collect();
        if name == "m.ply" {
            let red = "properties of each vertex that are not used";
            let texcoord = "properties of each face that are not used";
            assert_eq!(notes, [red, texcoord, "1 elements that are not used"], "{what}");
            assert!(warnings[0].ends_with(": red") && warnings[1].ends_with(": texcoord"), "{warnings:?}");
        } else {
            assert!(notes.is_empty(), "{warnings:?}");
        }
    }
    // STL has triangles alone.
    let bare = MeshDesc { normals: Vec::new(), uvs: Vec::new(), ..whole };
    let (expected, image) = (corners(&bare), picture(bare, false));
    let long = b"solid as a name, which text has too, in a header of eighty bytes of a binary fil";
    for bytes in [model.stl_text(), model.stl_binary(b"binary"), model.stl_binary(long)] {
        let (mesh, warnings) = load("m.StL", &bytes).unwrap();
        assert_eq!((mesh.positions.len(), warnings), (8, vec![]), "equal vertices are joined");
        assert_eq!(corners(&mesh), expected);
        assert_eq!(picture(mesh, false), image);
    }
}

#[test]
fn files_without_an_extension_are_told_by_their_content() {
    let model = Model::cube();
    let contents = model.whole().into_iter().map(|(_, _, bytes)| bytes);
    for bytes in contents.chain([model.stl_text(), model.stl_binary(b""), model.stl_binary(b"solid ")]) {
        for name in ["mesh", "mesh.dat"] {
            assert_eq!(load(name, &bytes).unwrap().0.triangles.len(), 12);
        }
    }
    assert_eq!(load("M.PLY", &model.ply(Encoding::Big, ["s", "t"], "vertex_index")).unwrap().0.triangles.len(), 12);
}

#[test]
fn files_are_named_wherever_a_mesh_file_is() {
    let model = Model::cube();
    let (folder, path) = file("m.ply", &model.ply(Encoding::Little, ["s", "t"], "vertex_indices"));
    std::fs::write(folder.path().join("m.stl"), model.stl_text()).unwrap();
    let surface = |mesh: serde_json::Value| {
        let mut surface = json!({"geometry": "mesh", "material": "m"});
        surface.as_object_mut().unwrap().extend(mesh.as_object().unwrap().clone());
        surface
    };
    let of = |surfaces: serde_json::Value| {
        json!({"etendue": 1, "camera": {}, "meshes": [{"name": "shared", "file": "m.stl"}],
            "materials": [{"name": "m", "type": "diffuse", "color": [1, 1, 1]}], "surfaces": surfaces})
        .to_string()
    };
    let scene = of(json!([surface(json!({"mesh": "shared"})), surface(json!({"file": "m.ply"}))]));
    let scene = desc::parse(&scene, folder.path(), None).unwrap();
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.triangles.len()).collect::<Vec<_>>(), [12, 12]);
    assert_eq!(scene.files, [folder.path().join("m.stl"), path.clone()]);
    assert!(scene.warnings[0].starts_with("surfaces[1].file: ") && scene.warnings[0].contains("m.ply: properties"));
    // Their materials cannot be asked for.
    let parts = of(json!([{"geometry": "mesh", "file": "m.ply", "materials": "from-file"}]));
    let error = desc::parse(&parts, folder.path(), None).unwrap_err();
    assert!(error.to_string().ends_with("a PLY file names no materials, expected a Wavefront OBJ file"), "{error}");
    let error = SceneDesc::default().add_file_surfaces(&path, false, DAffine3::IDENTITY).unwrap_err();
    assert!(error.message().contains("names no materials"), "{error}");
}

/// Integers and the numbers of OBJ files have sRGB's curve, fractions of PLY files are linear light.
#[test]
fn colors_of_vertices_are_read() {
    let header = |kind: &str, alpha: &str| {
        TRIANGLE.replace(
            "element face",
            &format!("property {kind} red\nproperty {kind} green\nproperty {kind} blue\n{alpha}element face"),
        )
    };
    let near = |mesh: &MeshDesc, expected: [[f32; 4]; 3]| {
        assert_eq!(mesh.colors.len(), 3);
        for (found, expected) in mesh.colors.iter().flatten().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-6, "{:?}, not {expected:?}", mesh.colors);
        }
    };
    // The linear value of 128 / 255 by IEC 61966-2-1.
    let middle = 0.215_860_5;
    let (mesh, notes) = load(
        "m.ply",
        &ply(
            &header("uchar", "property uchar alpha\n"),
            "0 0 0 255 0 128 255\n1 0 0 0 128 0 0\n0 1 0 0 0 0 51\n3 0 1 2\n",
        ),
    )
    .unwrap();
    near(&mesh, [[1.0, 0.0, middle, 1.0], [0.0, middle, 0.0, 0.0], [0.0, 0.0, 0.0, 0.2]]);
    assert_eq!(notes, [""; 0]);
    let rest = "0 0 0 2 0 0.5\n1 0 0 -1 0.25 0\n0 1 0 0 0 0\n3 0 1 2\n";
    let (mesh, _) = load("m.ply", &ply(&header("float", ""), rest)).unwrap();
    near(&mesh, [[2.0, 0.0, 0.5, 1.0], [0.0, 0.25, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]]);
    let coded = 128.0 / 255.0;
    let of_obj = [[1.0, 0.0, middle, 1.0], [1.0, 1.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
    let obj = format!("v 0 0 0 1 0 {coded}\nv 2 0 0 2\nv 0 1 0 0 0 0\nf 1 2 3\n");
    let (mesh, notes) = load("m.obj", obj.as_bytes()).unwrap();
    near(&mesh, of_obj);
    assert_eq!(mesh.positions[1].to_array(), [1.0, 0.0, 0.0], "a weight divides");
    assert!(notes[0].ends_with("only some vertices have colours; the others are white"), "{notes:?}");
    let (mesh, notes) = load("m.obj", b"v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert!(mesh.colors.is_empty() && notes[0].ends_with("only some vertices have colours; none is used"), "{notes:?}");
    let folder = tempfile::tempdir().unwrap();
    // As scenes by themselves they are shown, and what is saved is read again.
    for (name, bytes) in [("n.obj", obj.into_bytes()), ("n.ply", ply(&header("float", ""), rest))] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let scene = desc::load(&path, None).unwrap();
        assert!(scene.textures[0].vertex_colors);
        let built = Scene::build(&scene, &BuildOptions::default()).unwrap();
        let render = Job { resolution: [32, 32], samples: 4, ..Job::default() }.desc();
        let (image, _) = render_scene(&built, render.clone());
        // Towards the first vertex red and blue, and no green.
        let is_red = |pixel: [f32; 3]| pixel[0] > 0.2 && pixel[1] < 0.5 * pixel[0];
        assert!((0..1024).any(|i| is_red(image.pixel(i % 32, i / 32))), "{name}");
        let saved = folder.path().join("saved.json");
        scene.save(&saved).unwrap();
        let again = desc::load(&saved, None).unwrap();
        let (same, _) = render_scene(&Scene::build(&again, &BuildOptions::default()).unwrap(), render);
        assert_eq!(image.rgb, same.rgb, "{name}");
    }
}

const TRIANGLE: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n";

fn ply(header: &str, rest: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{header}{rest}").into_bytes()
}

#[test]
fn broken_text_is_refused_with_its_place() {
    let ok = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(load("m.ply", &ply(TRIANGLE, ok)).is_ok());
    // Numbers as other programs write them, blank lines, and ends of lines.
    let (mesh, _) =
        load("m.ply", &ply(&TRIANGLE.replace('\n', " \r\n"), "\n-.5 1. +2e-1\r\n 1\t0 0\n\n0 1 0\n3 0 1 2")).unwrap();
    assert_eq!(mesh.positions[0].to_array(), [-0.5, 1.0, 0.2_f32.into()]);
    for (content, message) in [
        ("", "4: the header has 3 elements 'vertex', for which the file is too short: 0 bytes"),
        ("0 0 0\n1 0 0\n0 1 0\n", "the header has 1 elements 'face'"),
        ("0 0 0\n1 0 0\n0 1 0\n    ", "the file ends in face 0, expected 1 of them"),
        ("0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, z: the line has no more values"),
        ("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, y: 'nan' is not a finite number"),
        ("0 0 0\n1 -inf 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, y: '-inf' is not a finite number"),
        ("0 0 0\n1 1e999 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, y: '1e999' is not a finite number"),
        ("0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, y: '1e39' is beyond single precision"),
        ("0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "11: vertex 1, y: 'x' is not a finite number"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "13: face 0 refers to vertex 3, but there are 3"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "13: face 0, vertex_indices: -1 is not the index of a vertex"),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 9999999999\n",
            "'9999999999' is not a whole number from -2147483648 to 2147483647",
        ),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", "'1.5' is not a whole number"),
        ("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "13: face 0, vertex_indices: the line has no more values"),
        ("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "'-3' is not a whole number from 0 to 255"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n", "none of the faces has three different corners (3 corners)"),
        ("0 0 0\n1 0 0\n0 1 0\n0\n\n", "the file holds no faces, only 3 vertices"),
    ] {
        let found = refusal("m.ply", &ply(TRIANGLE, content));
        assert!(found.contains(message.trim_start_matches("4: ")), "{content:?}: {found}");
    }
    let (_, warnings) = load("m.ply", &ply(&format!("Created by hand\n{TRIANGLE}"), ok)).unwrap();
    assert!(warnings[0].ends_with("line 3 of the header means nothing; it is left out"), "{warnings:?}");
    let double = ply(&TRIANGLE.replace("float y", "double y"), "0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n");
    assert_eq!(refusal("m.ply", &double), "11: vertex 1: the position [1.0, 1e39, 0.0] is beyond single precision");
    for (header, message) in [
        ("end_header\n", "the file holds no faces, only 0 vertices"),
        ("element vertex 3\n", "the file ends inside the header, expected end_header"),
        ("element vertex -3\nend_header\n", "3: '-3' is not a number of elements 'vertex'"),
        ("element vertex 4000000000\nproperty float x\nend_header\n", "the header has 4000000000 elements 'vertex'"),
        (
            "element vertex 100000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            "too short: 0 bytes",
        ),
        ("element vertex 99999999999999999999999999\nend_header\n", "is not a number of elements"),
        ("element vertex 3\nend_header\n", "the header has 3 elements 'vertex' without any property"),
        ("element other 4000000000\nend_header\n", "the header has 4000000000 elements 'other' without any property"),
        ("element vertex 1\nproperty float x\nproperty float y\nend_header\n1 1 1\n", "no property z of vertices"),
        ("element vertex 1\nelement vertex 1\nend_header\n", "4: the element 'vertex' is given twice"),
        (
            "element vertex 1\nproperty float x\nproperty float x\nend_header\n",
            "the element 'vertex' has the property 'x' twice",
        ),
        ("property float x\nend_header\n", "3: the property 'x' comes before any element"),
        ("element vertex 1\nproperty real x\nend_header\n", "'real' of the property 'x' is no type"),
        (
            "element vertex 1\nproperty list float int x\nend_header\n",
            "the count of the list 'x' is not of an integer type",
        ),
        (
            "element vertex 1\nproperty list int int x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
            "the property x of vertices is a list",
        ),
        ("element face 1\nproperty int flags\nend_header\n1\n", "no list vertex_indices or vertex_index of each face"),
        (
            "element face 1\nproperty list int float vertex_index\nend_header\n1 1\n",
            "vertex_index of each face is not a list of integers",
        ),
        ("format ascii 1.0\nend_header\n", "3: the format is given twice"),
        ("element vertex 1\nhello\nend_header\n", "4: 'hello' is no line of a PLY header"),
    ] {
        let found = refusal("m.ply", &ply(header, ""));
        assert!(found.contains(message), "{header:?}: {found}");
    }
    for (content, message) in [
        ("", "the file ends inside the header"),
        ("ply", "the file ends inside the header"),
        ("plyx\n", "1: the file does not begin with 'ply'"),
        ("ply\nend_header\n", "2: the header has no line 'format'"),
        ("ply\nformat ascii 2.0\nend_header\n", "2: the file is of version '2.0', expected 1.0"),
        ("ply\nformat xml 1.0\nend_header\n", "2: unknown format 'xml'"),
        ("ply\rformat ascii 1.0\rend_header\relement", "1: lines end with a carriage return alone"),
    ] {
        let found = refusal("m.ply", content.as_bytes());
        assert!(found.contains(message), "{content:?}: {found}");
    }
    let long = format!("ply\nformat ascii 1.0\ncomment {}\n", "x".repeat(2 << 20));
    assert!(refusal("m.ply", long.as_bytes()).contains("3: the header is longer than 1048576 bytes"));
}

#[test]
fn broken_binary_files_are_refused() {
    let model = Model::cube();
    for encoding in [Encoding::Little, Encoding::Big] {
        let whole = model.ply(encoding, ["s", "t"], "vertex_indices");
        let header = whole.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
        for end in 0..whole.len() {
            let found = refusal("m.ply", &whole[..end]);
            let expected = if end < header { "header" } else { "the file" };
            assert!(found.contains(expected), "{end}: {found}");
        }
        let mut bad = whole.clone();
        let nan = if encoding == Encoding::Big { f64::NAN.to_be_bytes() } else { f64::NAN.to_le_bytes() };
        bad[header..header + 8].copy_from_slice(&nan);
        assert_eq!(refusal("m.ply", &bad), "vertex 0, x: NaN is not a finite number");
        let mut longer = whole;
        longer.push(0);
        let (_, warnings) = load("m.ply", &longer).unwrap();
        assert!(warnings[3].ends_with("there is more after the last element; it is left out"), "{warnings:?}");
    }
    // A list that claims more than there is.
    let header =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint uchar vertex_index\nend_header\n";
    let mut list = header.as_bytes().to_vec();
    list.extend(u32::MAX.to_le_bytes());
    assert!(refusal("m.ply", &list).contains("the file has more than 134217728 corners"));
    list.truncate(header.len());
    list.extend(1_000_000_u32.to_le_bytes());
    assert!(refusal("m.ply", &list).contains("the file ends in face 0, expected 1 of them"));

    let whole = model.stl_binary(b"");
    for end in 0..whole.len() {
        let found = refusal("m.stl", &whole[..end]);
        let expected = if end < 84 { "is too short for a binary STL file" } else { "says that it has 12 triangles" };
        assert!(found.contains(expected), "{end}: {found}");
    }
    let mut bad = whole.clone();
    bad[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(refusal("m.stl", &bad).contains("triangle 1: the vertex [inf, "));
    let mut more = whole.clone();
    more[84 + 48] = 1;
    more.extend([1; 9]);
    let (_, warnings) = load("m.stl", &more).unwrap();
    assert!(warnings[0].ends_with("1 triangles have attributes (colours), which are not used"), "{warnings:?}");
    assert!(warnings[1].ends_with("9 bytes after the last triangle left out"), "{warnings:?}");
    let mut none = whole[..84].to_vec();
    none[80..].fill(0);
    assert!(refusal("m.stl", &none).contains("the file holds no triangles"));
}

#[test]
fn broken_stl_text_is_refused_with_its_line() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let upper = format!("SOLID\n{}\nENDSOLID", facet.to_ascii_uppercase().replace('\n', " "));
    let (mesh, warnings) = load("m.stl", upper.as_bytes()).unwrap();
    assert_eq!((mesh.triangles, warnings), (vec![[0, 1, 2]], vec![]));
    let two = format!("solid a facet\n{facet}endsolid\nsolid b\n{facet}");
    let (mesh, warnings) = load("m.stl", two.as_bytes()).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2, 3));
    assert!(warnings[0].ends_with("2 solids become one mesh"), "{warnings:?}");
    assert!(warnings[1].ends_with("the file ends without endsolid; it may not be complete"), "{warnings:?}");
    for (from, to, message) in [
        ("vertex 1 0 0", "vertex 1 0", "5: a vertex of facet 0 has no z"),
        ("vertex 1 0 0", "vertex 1 nan 0", "5: facet 0: 'nan' is not a finite number"),
        ("vertex 1 0 0", "vertex 1 0x1 0", "5: facet 0: '0x1' is not a finite number"),
        ("vertex 1 0 0", "vertex 1 0 1e39", "facet 0: the vertex [1.0, 0.0, inf] has the number inf"),
        ("vertex 1 0 0\n", "", "7: facet 0 has 2 vertices, expected 3"),
        ("vertex 1 0 0", "vertex 1 0 0\nvertex 1 0 0", "7: facet 0 has more than 3 vertices"),
        ("endfacet\n", "", "the file ends in facet 0"),
        (
            "outer loop",
            "inner loop",
            "3: 'inner' is not expected here, expected outer loop, vertex, endloop or endfacet",
        ),
        ("facet normal 0 0 1", "facet normal 0 0", "2: facet 0 has no normal"),
        ("vertex 0 1 0", "vertex 0 0 0", "none of the 1 triangles has three different corners"),
        (facet, "", "the file holds no triangles"),
        (facet, "v 1 2 3", "2: 'v' is not expected here, expected solid, facet or endsolid"),
    ] {
        let text = format!("solid a\n{facet}").replace(from, to);
        let found = refusal("m.stl", text.as_bytes());
        assert!(found.contains(message), "{text}: {found}");
    }
    let long = format!("solid {}", "x".repeat(17 << 20));
    assert!(refusal("m.stl", long.as_bytes()).contains("1: the line is longer than 16777216 bytes"));
}

/// A byte order mark is skipped; what is no text of lines is refused by its cause.
#[test]
fn obj_files_begin_and_end_their_lines_in_other_ways() {
    let plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (expected, _) = load("m.obj", plain.as_bytes()).unwrap();
    for text in [format!("\u{feff}{plain}"), plain.replace('\n', "\r\n"), format!("# a\rcomm\0ent\n{plain}")] {
        let (mesh, _) = load("m.obj", text.as_bytes()).unwrap();
        assert_eq!(
            (mesh.positions, mesh.triangles),
            (expected.positions.clone(), expected.triangles.clone()),
            "{text:?}"
        );
    }
    let old = plain.replace('\n', "\r");
    let wide = |order: fn(u16) -> [u8; 2]| plain.encode_utf16().flat_map(order).collect::<Vec<u8>>();
    for (bytes, message) in [
        (old.clone().into_bytes(), "1: the line holds a carriage return (CR)"),
        (format!("# a comment\r{old}").into_bytes(), "1: the line holds a carriage return (CR)"),
        (b"v 0 0 0\nv 1 0 0\rv 0 1 0\nf 1 2 3\n".to_vec(), "2: the line holds a carriage return (CR)"),
        (b"v 0 0 0\nv 1 0 0\0\nv 0 1 0\nf 1 2 3\n".to_vec(), "2: the line holds a NUL byte"),
        (wide(u16::to_le_bytes), "1: the line holds a NUL byte"),
        ([b"\xfe\xff".to_vec(), wide(u16::to_be_bytes)].concat(), "1: the line holds a NUL byte"),
    ] {
        let found = refusal("m.obj", &bytes);
        assert!(found.starts_with(message), "{:?}: {found}", String::from_utf8_lossy(&bytes));
    }
}

/// A shared mesh may keep what is left out otherwise, and is then another mesh than that of the same file without.
#[test]
fn degenerate_triangles_are_kept_where_a_scene_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = TRIANGLE.replace("face 1", "face 3").replace("vertex 3", "vertex 4");
    std::fs::write(folder.path().join("m.ply"), ply(&file, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 1 1 2\n3 0 1 2\n2 0 1\n"))
        .unwrap();
    std::fs::write(folder.path().join("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let read = |meshes: &str| {
        let text = format!("{{\"etendue\": 1, \"camera\": {{}}, \"meshes\": [{meshes}]}}");
        desc::parse(&text, folder.path(), None)
    };
    let scene = read(
        r#"{"name": "all", "file": "m.ply", "keepDegenerate": true}, {"name": "some", "file": "m.ply"},
           {"name": "again", "file": "m.ply", "keepDegenerate": false}, {"name": "too", "file": "m.ply", "keepDegenerate": true}"#,
    )
    .unwrap();
    let triangles: Vec<_> = scene.meshes.iter().map(|mesh| mesh.triangles.clone()).collect();
    assert_eq!(triangles, [vec![[1, 1, 2], [0, 1, 2]], vec![[0, 1, 2]]]);
    assert_eq!(["all", "some", "again", "too"].map(|name| scene.find_mesh(name)), [0, 1, 1, 0].map(Some));
    let counts: Vec<_> = scene.warnings.iter().map(|warning| warning.rsplit(": ").next().unwrap()).collect();
    let left_out = |count: usize| format!("{count} faces with fewer than 3 different corners left out");
    assert_eq!(counts, [left_out(1), left_out(2)]);
    for (mesh, message) in [
        (
            r#"{"name": "m", "file": "m.obj", "keepDegenerate": true}"#,
            "degenerate triangles are kept of PLY files alone",
        ),
        (
            r#"{"name": "m", "positions": [[0, 0, 0]], "triangles": [[0, 0, 0]], "keepDegenerate": true}"#,
            "meshes[0].keepDegenerate: only a mesh in a file has this key",
        ),
    ] {
        let error = read(mesh).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn degenerate_polygons_are_left_out_and_counted() {
    let header = TRIANGLE.replace("face 1", "face 4").replace("vertex 3", "vertex 4");
    let content = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n3 1 1 2\n4 0 1 2 3\n5 0 1 1 2 3 9\n";
    let (mesh, warnings) = load("m.ply", &ply(&header, content)).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3]]);
    assert!(warnings[0].ends_with("2 faces with fewer than 3 different corners left out"), "{warnings:?}");
    assert!(warnings[1].ends_with("1 lines have more values than the header says; these are left out"), "{warnings:?}");
}

#[test]
fn strips_become_triangles_of_one_side() {
    let header = "element tristrips 1\nproperty list int int vertex_indices\nelement vertex 5\nproperty float x\n\
        property float y\nproperty float z\nend_header\n";
    let (mesh, _) = load("m.ply", &ply(header, "9 0 1 2 3 4 -1 2 1 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n")).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [2, 1, 0]]);
    let found = refusal("m.ply", &ply(header, "3 0 1 -2\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n"));
    assert!(found.contains("tristrips 0, vertex_indices: -2 is not the index of a vertex"), "{found}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Any polygons are the same in all encodings.
    #[test]
    fn any_model_is_the_same_in_all_encodings(
        positions in prop::collection::vec(prop::array::uniform3(-1e3_f32..1e3), 3..12),
        faces in prop::collection::vec(prop::collection::vec(any::<prop::sample::Index>(), 3..7), 1..8),
    ) {
        let count = positions.len();
        let distinct = |face: Vec<prop::sample::Index>| {
            let mut corners: Vec<usize> = face.into_iter().map(|corner| corner.index(count)).collect();
            let mut seen = std::collections::HashSet::new();
            corners.retain(|corner| seen.insert(*corner));
            corners
        };
        let mut faces: Vec<Vec<usize>> = faces.into_iter().map(distinct).filter(|face| face.len() > 2).collect();
        faces.push(vec![0, 1, 2]);
        let uvs = positions.iter().map(|[x, y, _]| [*x, *y]).collect();
        let model = Model { normals: positions.clone(), uvs, positions, faces };
        let (expected, _) = load("m.obj", &model.obj()).unwrap();
        let expected = corners(&expected);
        for (what, name, bytes) in model.whole() {
            let (mesh, _) = load(name, &bytes).unwrap();
            prop_assert!(corners(&mesh) == expected, "{}", what);
        }
    }

    /// Files with any changed bytes are read or refused.
    #[test]
    fn changed_files_are_read_or_refused(
        which in 0_usize..6,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        end in any::<prop::sample::Index>(),
    ) {
        let model = Model::cube();
        let (name, mut bytes) = match which {
            0 => ("m.ply", model.ply(Encoding::Text, ["s", "t"], "vertex_indices")),
            1 => ("m.ply", model.ply(Encoding::Little, ["s", "t"], "vertex_indices")),
            2 => ("m.ply", model.ply(Encoding::Big, ["s", "t"], "vertex_indices")),
            3 => ("m.stl", model.stl_text()),
            4 => ("m.stl", model.stl_binary(b"")),
            _ => ("mesh", model.stl_binary(b"solid")),
        };
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if end.index(4) == 0 {
            bytes.truncate(end.index(bytes.len()));
        }
        if let Ok((mesh, _)) = load(name, &bytes) {
            prop_assert!(mesh.triangles.iter().flatten().all(|vertex| (*vertex as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().all(|position| position.is_finite()));
        }
    }
}

/// A scene by itself is seen as a whole, under a sky where it has no light.
#[test]
fn meshes_are_scenes_by_themselves() {
    let model = Model::cube();
    let mut shifted = model.clone();
    shifted.positions.iter_mut().for_each(|[x, y, z]| (*x, *y, *z) = (3.0 * *x + 1e4, 3.0 * *y - 7.0, 3.0 * *z + 50.0));
    for (name, bytes) in [
        ("m.ply", shifted.ply(Encoding::Little, ["s", "t"], "vertex_indices")),
        ("m.OBJ", shifted.obj()),
        ("m.stl", shifted.stl_binary(b"")),
    ] {
        let (_folder, path) = file(name, &bytes);
        let mut scene = desc::load(&path, None).unwrap();
        assert_eq!((scene.file.as_ref(), scene.files.as_slice()), (Some(&path), &[path.clone()][..]));
        assert_eq!(scene.environment.as_ref().map(|environment| environment.radiance), Some(Rgb::ONE));
        assert!(matches!(scene.surfaces[0].shape, ShapeDesc::Mesh { smooth, .. } if smooth == (name != "m.stl")));
        scene.render = Job { resolution: [32, 32], samples: 4, ..Job::default() }.desc();
        let built = Scene::build(&scene, &BuildOptions::default()).unwrap();
        let info = built.info();
        // What is up in the file is up in the scene.
        let up = built.info().bounds.centre();
        let expected = if name == "m.stl" { [1e4, 50.0, 7.0] } else { [1e4, -7.0, 50.0] };
        assert!((up - etendue::math::DVec3::from_array(expected)).length() < 1e-3, "{name}: {up}");
        assert_eq!(info.infinite_emitters, 1);
        // All of it is in the picture: there is sky on every side, and it fills more than a quarter.
        let (image, _) = render_scene(&built, scene.render.clone());
        let is_sky = |x: usize, y: usize| image.rgb[3 * (32 * y + x)] > 0.999;
        assert!((0..32).all(|i| is_sky(i, 0) && is_sky(i, 31) && is_sky(0, i) && is_sky(31, i)), "{name}");
        let covered = (0..1024).filter(|i| !is_sky(i % 32, i / 32)).count();
        assert!(covered > 256, "{name}: {covered}");
    }
    // A lamp needs no sky, and a file's own materials are used. What glows by no more than the sky is no lamp.
    let obj = [b"mtllib m.mtl\nusemtl lamp\n".to_vec(), model.obj()].concat();
    let (folder, path) = file("m.obj", &obj);
    std::fs::write(folder.path().join("m.mtl"), "newmtl lamp\nKd 0.5 0 0\nKe 4 4 4\n").unwrap();
    let scene = desc::load(&path, None).unwrap();
    assert_eq!((scene.environment, scene.materials[0].emission), (None, Some(Rgb::splat(4.0))));
    std::fs::write(folder.path().join("m.mtl"), "newmtl display\nKd 0.5 0 0\nKe 1 0.2 0\nnewmtl lamp\nKe 0 1 0\n")
        .unwrap();
    let scene = desc::load(&path, None).unwrap();
    assert_eq!(scene.materials[0].emission, Some(Rgb::new(0.0, 1.0, 0.0)));
    assert_eq!(scene.environment.map(|environment| environment.radiance), Some(Rgb::ONE));
    // Errors and warnings name the file once.
    let (_folder, path) = file("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n");
    let scene = desc::load(&path, None).unwrap();
    assert!(scene.warnings.iter().all(|warning| warning.starts_with(&*path.to_string_lossy())), "{:?}", scene.warnings);
    let (_folder, path) = file("m.stl", b"solid a\n");
    let error = desc::load(&path, None).unwrap_err().to_string();
    assert_eq!(error, format!("{}: the file holds no triangles; is it an STL file?", path.display()));
    let missing = desc::load(Path::new("/no/such.ply"), None).unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::Io);
}

/// All files of these formats below a folder.
fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path
            .extension()
            .is_some_and(|end| ["obj", "ply", "stl"].iter().any(|known| end.eq_ignore_ascii_case(known)))
        {
            found.push(path);
        }
    }
}

/// Files of other programs, from Debian's package assimp-testmodels: read and rendered, or refused with one sentence. The pictures
/// are written to `mesh-files.png` in the tests' own folder, in the order of the table.
#[test]
fn files_of_other_programs_are_read_or_refused() {
    const SIDE: usize = 48;
    const COLUMNS: usize = 8;
    let folder = Path::new("/usr/share/assimp/models");
    if !folder.is_dir() {
        eprintln!("SKIPPED: {} is not there (package assimp-testmodels)", folder.display());
        return;
    }
    let mut files = Vec::new();
    collect(folder, &mut files);
    files.sort();
    let (mut pictures, mut refused, mut unseen) = (Vec::new(), Vec::new(), Vec::new());
    let mut counts = std::collections::BTreeMap::new();
    for path in &files {
        let name = path.strip_prefix(folder).unwrap().display();
        let format = path.extension().unwrap().to_str().unwrap().to_ascii_uppercase();
        let count: &mut [usize; 2] = counts.entry(format).or_default();
        match desc::load(path, None) {
            Ok(mut scene) => {
                scene.render = Job { resolution: [SIDE as u32; 2], samples: 16, ..Job::default() }.desc();
                let built = Scene::build(&scene, &BuildOptions::default()).unwrap();
                let (image, summary) = render_scene(&built, scene.render.clone());
                assert_eq!(summary.non_finite, 0, "{name}");
                let seen = image.rgb.iter().filter(|value| (**value - 1.0).abs() > 0.02).count();
                if seen < 20 {
                    println!("    cannot be seen: {:?}", built.warnings());
                    unseen.push(name.to_string());
                }
                let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
                let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
                let (materials, warnings) = (scene.materials.len(), scene.warnings.len());
                println!(
                    "{name:42} {vertices:6} vertices {triangles:6} triangles {materials:3} materials {warnings:3} warnings"
                );
                scene.warnings.iter().for_each(|warning| println!("    {warning}"));
                pictures.push(image.rgb);
                count[0] += 1;
            }
            Err(error) => {
                println!("{name:42} {error}");
                let message = error.to_string();
                assert!(
                    message.contains(&*path.with_extension("").to_string_lossy()) && !message.contains('\n'),
                    "{message}"
                );
                let why = REFUSED.iter().find(|(known, _)| name.to_string() == *known).map_or("", |(_, why)| why);
                assert!(message.contains(why), "{message}; expected: {why}");
                refused.push(name.to_string());
                count[1] += 1;
            }
        }
    }
    for (format, [read, refused]) in &counts {
        println!("{format}: {read} read, {refused} refused");
    }
    let rows = pictures.len().div_ceil(COLUMNS);
    let mut sheet = vec![0.0; 3 * SIDE * COLUMNS * SIDE * rows];
    for (i, picture) in pictures.iter().enumerate() {
        for (y, row) in picture.chunks_exact(3 * SIDE).enumerate() {
            let at = 3 * SIDE * ((i / COLUMNS * SIDE + y) * COLUMNS + i % COLUMNS);
            sheet[at..at + row.len()].copy_from_slice(row);
        }
    }
    let levels: Vec<u8> = sheet.iter().map(|value| (value.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8).collect();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mesh-files.png");
    let size = [(SIDE * COLUMNS) as u32, (SIDE * rows) as u32];
    image::save_buffer(&target, &levels, size[0], size[1], image::ColorType::Rgb8).unwrap();
    println!("{}", target.display());
    let expected: Vec<&str> = REFUSED.iter().map(|(name, _)| *name).collect();
    assert_eq!(refused, expected);
    assert_eq!(unseen, UNSEEN);
}

/// Files that hold no faces, or that are broken, and why.
const REFUSED: &[(&str, &str)] = &[
    ("OBJ/box_UTF16BE.obj", "the line holds a NUL byte"),
    ("OBJ/number_formats.obj", "'3.1+e2' is not a finite number"),
    ("OBJ/point_cloud.obj", "the file holds no faces"),
    ("OBJ/testline.obj", "the file holds no faces"),
    ("OBJ/testpoints.obj", "the file holds no faces"),
    ("PLY/issue623.ply", "vertex 0, vertex_indices: the line has no more values"),
    ("PLY/points.ply", "the file holds no faces, only 4 vertices"),
    ("PLY/pond.0.ply", "for which the file is too short"),
    ("invalid/empty.obj", "the file holds no faces"),
    ("invalid/empty.ply", "the file ends inside the header"),
    ("invalid/malformed.obj", "'0' has the index 0, indices start at 1"),
];

/// Files of which nothing can be seen: white before a white sky.
const UNSEEN: &[&str] = &["OBJ/regr_3429812.obj"];

/// Reads the scene that a file is, or that a JSON text in its folder is, and stops once the fraction `stop` is done. Returns the fractions
/// that were told.
fn watched(path: &Path, stop: f64) -> (etendue::Result<SceneDesc>, Vec<f64>) {
    watched_by(stop, |options| desc::load_with(path, None, options))
}

/// Reads, and stops once the fraction `stop` is done. Returns the fractions that were told.
fn watched_by<R>(stop: f64, read: impl FnOnce(&LoadOptions) -> R) -> (R, Vec<f64>) {
    let told = Arc::new(Mutex::new(Vec::new()));
    let cancel = Cancel::new();
    let progress = {
        let (told, cancel) = (Arc::clone(&told), cancel.clone());
        move |fraction: f64| {
            told.lock().expect("no panic").push(fraction);
            if fraction >= stop {
                cancel.cancel();
            }
        }
    };
    let options = LoadOptions { cancel, progress: Some(Arc::new(progress)), ..LoadOptions::default() };
    let outcome = read(&options);
    let told = told.lock().expect("no panic").clone();
    (outcome, told)
}

#[test]
fn reading_of_a_mesh_is_watched_and_stopped() {
    let count = 60_000;
    let mut obj = String::new();
    let mut stl = "solid\n".to_owned();
    let mut ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {count}\n\
         property list uchar int vertex_indices\nend_header\n",
        3 * count
    );
    let mut binary = vec![0_u8; 80];
    binary.extend((count as u32).to_le_bytes());
    for i in 0..count {
        let x = i as f32 * 0.25;
        let corners = [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
        stl += "facet normal 1 0 0\nouter loop\n";
        for [x, y, z] in corners {
            writeln!(obj, "v {x} {y} {z}").expect("a string");
            writeln!(ply, "{x} {y} {z}").expect("a string");
            writeln!(stl, "vertex {x} {y} {z}").expect("a string");
        }
        stl += "endloop\nendfacet\n";
        writeln!(obj, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3).expect("a string");
        binary.extend([0_u8; 12]);
        binary.extend(corners.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
        binary.extend([0_u8; 2]);
    }
    (0..count).for_each(|i| writeln!(ply, "3 {} {} {}", 3 * i, 3 * i + 1, 3 * i + 2).expect("a string"));
    stl += "endsolid\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let files: [(&str, &[u8]); 4] =
        [("a.obj", obj.as_bytes()), ("a.ply", ply.as_bytes()), ("a.stl", stl.as_bytes()), ("b.stl", &binary)];
    let mut surfaces = Vec::new();
    for (name, content) in files {
        std::fs::write(path(name), content).expect("a file");
        surfaces.push(json!({"geometry": "mesh", "file": name, "material": "grey"}));
    }
    // One is named twice.
    surfaces.push(json!({"geometry": "mesh", "file": "a.obj", "material": "grey"}));
    let scene = json!({
        "etendue": 1,
        "camera": {"origin": [0, 0, 9], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60},
        "materials": [{"name": "grey", "type": "diffuse", "color": [0.5, 0.5, 0.5]}],
        "surfaces": surfaces
    });
    std::fs::write(path("scene.json"), scene.to_string()).expect("a file");
    for name in ["a.obj", "a.ply", "a.stl", "b.stl", "scene.json"] {
        let (scene, told) = watched(&path(name), 2.0);
        let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scene.meshes.iter().map(|mesh| mesh.triangles.len()).max(), Some(count), "{name}");
        assert!(told.is_sorted() && told.last() == Some(&1.0), "{name}: {told:?}");
        let steps = [&[0.0][..], &told].concat();
        let widest = steps.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(told.len() >= 12 && widest < 0.1, "{name}: {told:?}");
        for stop in [0.01, 0.3, 0.8] {
            let (scene, told) = watched(&path(name), stop);
            let error = scene.err().unwrap_or_else(|| panic!("{name} was read to the end"));
            assert_eq!(error.kind(), ErrorKind::Cancelled, "{name}: {error}");
            assert!(told.last().is_some_and(|last| *last < stop + 0.1), "{name}: {told:?}");
        }
    }
    for name in ["a.obj", "a.ply", "a.stl", "b.stl"] {
        let mut scene = SceneDesc::default();
        // At once, in the middle, and when all is read but not yet added.
        for stop in [0.0, 0.5, 1.0] {
            let (added, told) = watched_by(stop, |options| scene.add_mesh_file_with("mesh", &path(name), options));
            assert_eq!(added.unwrap_err().kind(), ErrorKind::Cancelled, "{name}");
            assert!(told.last().is_some_and(|last| *last < stop + 0.1), "{name}: {told:?}");
            assert!(scene.meshes.is_empty() && scene.files.is_empty() && scene.find_mesh("mesh").is_none(), "{name}");
        }
        let (added, told) = watched_by(2.0, |options| scene.add_mesh_file_with("mesh", &path(name), options));
        assert_eq!((added.unwrap(), scene.meshes[0].triangles.len()), (0, count), "{name}");
        let steps = [&[0.0][..], &told].concat();
        let widest = steps.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(told.is_sorted() && told.last() == Some(&1.0) && widest < 0.1, "{name}: {told:?}");
        let choice = LoadOptions { time: Some(0.0), ..LoadOptions::default() };
        let refused = scene.add_mesh_file_with("", &path(name), &choice).unwrap_err();
        assert_eq!((refused.kind(), scene.meshes.len()), (ErrorKind::Unsupported, 1), "{name}");
    }
}
