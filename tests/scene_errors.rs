//! Broken scene files: every one gives an error that says where and what, and none stops the program.

mod common;

use std::path::Path;

use etendue::ErrorKind;
use etendue::bsdf::{Model as _, TransportMode};
use etendue::desc::{self, BsdfDesc, SceneDesc, ShapeDesc};
use etendue::spectrum::Rgb;
use proptest::prelude::*;
use serde_json::Value;

#[test]
fn every_malformed_scene_is_refused_with_its_line_path_and_reason() {
    let mut wrong = Vec::new();
    let list = common::malformed::malformed();
    for (name, text, expected) in &list {
        match desc::parse(text, Path::new(""), None) {
            Ok(_) => wrong.push(format!("{name}: accepted")),
            Err(error) => {
                let said = error.to_string();
                if !said.starts_with(&format!("line {expected}")) {
                    let said: String = said.chars().take(300).collect();
                    wrong.push(format!("{name}:\n    said     {said}\n    expected line {expected}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), list.len(), wrong.join("\n"));
    assert!(list.len() >= 200, "{} cases", list.len());
}

/// What reading must do with any text at all: give a scene whose numbers are in order, or an error that says something.
fn accepted(text: &str) -> bool {
    match desc::parse(text, &common::snippets::data_dir(), Some(Path::new("scene.json"))) {
        Ok(scene) => {
            check(&scene, text);
            true
        }
        Err(error) => {
            assert!(!error.message().trim().is_empty(), "no message for {text}");
            assert!(error.location().file.is_some(), "no file: {error} for {text}");
            assert!(error.location().line >= 1 || error.kind() == ErrorKind::Io, "no line: {error} for {text}");
            assert!(error.message().len() < 1000, "a long message: {error}");
            false
        }
    }
}

/// The promises of a `SceneDesc` that a scene may be built on.
fn check(scene: &SceneDesc, text: &str) {
    let single = |value: f64| (value as f32).is_finite();
    let render = &scene.render;
    assert!(render.samples >= 1 && render.shadow_rays >= 1 && render.max_depth != Some(0), "{text}");
    assert!(render.resolution.iter().all(|side| *side >= 1), "{text}");
    for material in &scene.materials {
        let unit = |colour: Rgb| colour.min_element() >= 0.0 && colour.max_element() <= 1.0;
        let fine = match material.bsdf {
            BsdfDesc::Black => true,
            BsdfDesc::Lambert { albedo } => unit(albedo),
            BsdfDesc::OrenNayarQualitative { albedo, sigma } => unit(albedo) && sigma >= 0.0,
            BsdfDesc::OrenNayar { albedo, roughness } => unit(albedo) && (0.0..=1.0).contains(&roughness),
            BsdfDesc::Mirror { reflectance } => unit(reflectance),
            BsdfDesc::Dielectric { ior, exterior_ior } => ior > 0.0 && exterior_ior > 0.0 && ior.is_finite(),
            // What a Bsdf needs of the others is more than a line: it is finite wherever it is asked.
            ref other => {
                let bsdf = etendue::bsdf::Bsdf::of_materials(other, &scene.materials);
                let wo = etendue::math::Vec3::new(0.6, 0.0, 0.8);
                bsdf.albedo().is_finite() && bsdf.f(wo, wo, TransportMode::Radiance).is_finite()
            }
        };
        assert!(fine && material.survival.is_none_or(|rate| rate > 0.0 && rate <= 1.0), "{material:?} from {text}");
    }
    for light in &scene.lights {
        assert!(light.intensity.is_finite() && light.intensity.min_element() >= 0.0, "{text}");
        assert!(light.position.to_array().into_iter().all(single), "{text}");
    }
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        assert!(
            !mesh.triangles.is_empty() && mesh.triangles.as_flattened().iter().all(|index| (*index as usize) < count)
        );
        assert!(mesh.positions.iter().all(|p| p.to_array().into_iter().all(single)), "{text}");
        assert!(mesh.normals.is_empty() || mesh.normals.len() == count, "{text}");
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count, "{text}");
    }
    for surface in &scene.surfaces {
        assert!(surface.material.is_none_or(|material| material < scene.materials.len()), "{text}");
        assert!(surface.to_world().is_finite() && surface.to_world().inverse().is_finite(), "{text}");
        assert!(
            surface.emission.is_none_or(|radiance| radiance.is_finite() && radiance.min_element() >= 0.0),
            "{text}"
        );
        match surface.shape {
            ShapeDesc::Sphere { radius, .. } => assert!(radius > 0.0 && single(radius), "{text}"),
            ShapeDesc::Disk { normal, radius, .. } => {
                assert!(radius > 0.0 && (normal.length() - 1.0).abs() < 1e-9, "{text}");
            }
            ShapeDesc::Mesh { mesh, .. } => assert!(mesh < scene.meshes.len(), "{text}"),
            ShapeDesc::Quadric { coefficients, clip } => {
                assert!(coefficients.iter().all(|c| c.is_finite()) && !clip.is_empty(), "{text}");
                assert!(clip.min.is_finite() && clip.max.is_finite(), "{text}");
            }
            ShapeDesc::Triangle(v) => assert!(v.iter().all(|p| p.is_finite()), "{text}"),
            ShapeDesc::Quad(v) => assert!(v.iter().all(|p| p.is_finite()), "{text}"),
        }
    }
}

/// A small generator of random numbers (Vigna's splitmix64), so that a failure can be repeated from its seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }
}

fn seeds() -> Vec<String> {
    let snippets = common::snippets::snippets();
    snippets.into_iter().filter(|(kind, ..)| kind != "params").map(|(.., text)| text).collect()
}

#[test]
fn random_changes_of_bytes_give_a_scene_or_an_error() {
    let pieces = [
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "\"",
        "\\",
        "null",
        "true",
        "-",
        "1e999",
        "1e39",
        "-0",
        "1e-320",
        "\u{0}",
        "é",
        "\u{feff}",
        "[[[[",
        "\"material\": ",
        "99999999999999999999",
        "0.1",
        "\n",
    ];
    let (mut tried, mut read) = (0, 0);
    for (i, seed) in seeds().iter().enumerate() {
        let mut random = Random(i as u64);
        for _ in 0..150 {
            let mut bytes = seed.clone().into_bytes();
            for _ in 0..=random.below(3) {
                let at = random.below(bytes.len());
                match random.below(10) {
                    // Another digit, so that many changes leave JSON behind them.
                    0..5 => {
                        if let Some(digit) = bytes[at..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                            *digit = b'0' + random.below(10) as u8;
                        }
                    }
                    5 => bytes[at] = (random.next() & 0x7f) as u8,
                    6 => bytes.truncate(at),
                    7 => drop(bytes.drain(at..(at + random.below(20)).min(bytes.len()))),
                    8 => drop(bytes.splice(at..at, random.pick(&pieces).bytes())),
                    _ => {
                        let from = random.below(bytes.len());
                        let copy = bytes[from..(from + random.below(60)).min(bytes.len())].to_vec();
                        drop(bytes.splice(at..at, copy));
                    }
                }
                if bytes.is_empty() {
                    break;
                }
            }
            tried += 1;
            read += usize::from(accepted(&String::from_utf8_lossy(&bytes)));
        }
    }
    // Both ways out must have been taken often, or the changes are too weak or too strong to test anything.
    assert!(tried > 4000 && read * 50 > tried && read * 2 < tried, "{read} of {tried} read");
}

#[test]
fn random_changes_of_structure_give_a_scene_or_an_error() {
    let values: Vec<Value> = [
        "null",
        "true",
        "0",
        "-1",
        "1",
        "2.5",
        "1e38",
        "-3e38",
        "1e300",
        "1e-50",
        "\"\"",
        "\"white\"",
        "\"sphere\"",
        "\"mesh\"",
        "[]",
        "{}",
        "[0, 0, 0]",
        "[1, 2]",
        "[[0, 0, 0]]",
        "[1e30, -1e30, 1e30]",
        "{\"type\": \"area\"}",
        "18446744073709551615",
    ]
    .iter()
    .map(|text| serde_json::from_str(text).unwrap())
    .collect();
    let (mut tried, mut read) = (0, 0);
    for (i, seed) in seeds().iter().enumerate() {
        let whole: Value = serde_json::from_str(seed).unwrap();
        let mut random = Random(1000 + i as u64);
        for _ in 0..150 {
            let mut scene = whole.clone();
            for _ in 0..=random.below(2) {
                change(&mut scene, &mut random, &values);
            }
            tried += 1;
            read += usize::from(accepted(&scene.to_string()));
        }
    }
    assert!(tried > 4000 && read * 50 > tried && read * 2 < tried, "{read} of {tried} read");
}

/// Walks down at random and replaces, removes, renames, copies or scales what it finds there.
fn change(value: &mut Value, random: &mut Random, values: &[Value]) {
    match value {
        Value::Object(map) if !map.is_empty() && random.below(8) > 0 => {
            let keys: Vec<String> = map.keys().cloned().collect();
            let key = random.pick(&keys);
            match random.below(12) {
                0 => drop(map.remove(key)),
                1 => {
                    let moved = map.remove(key).unwrap();
                    map.insert(random.pick(&["radius", "origin", "typ", "file", "emission"]).to_string(), moved);
                }
                _ => change(&mut map[key], random, values),
            }
        }
        Value::Array(list) if !list.is_empty() && random.below(8) > 0 => {
            let at = random.below(list.len());
            match random.below(10) {
                0 => drop(list.remove(at)),
                1 => {
                    let copy = list[at].clone();
                    list.insert(at, copy);
                }
                _ => change(&mut list[at], random, values),
            }
        }
        Value::Number(number) if random.below(2) > 0 => {
            let factor = *random.pick(&[0.0, -1.0, 1e-30, 1e30, 1.5, 1e-310]);
            *value = Value::from(number.as_f64().unwrap_or(1.0) * factor);
        }
        _ => *value = random.pick(values).clone(),
    }
}

/// Any JSON at all, a few levels deep.
fn any_json() -> impl Strategy<Value = Value> {
    let words = "etendue|camera|lights|materials|surfaces|geometry|sphere|mesh|material|[a-z\"\\\\\u{0}-\u{1f}é]{0,6}";
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        words.prop_map(Value::from),
    ];
    leaf.prop_recursive(4, 40, 6, move |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
            proptest::collection::hash_map(words, inner, 0..6)
                .prop_map(|members| Value::from(members.into_iter().collect::<serde_json::Map<_, _>>())),
        ]
    })
}

/// A number of any size, or a small one.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("JSON has no others", |x| x.is_finite()), -2.0..2.0]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn any_text_gives_a_scene_or_an_error(text in "\\PC{0,200}") {
        accepted(&text);
    }

    #[test]
    fn any_json_gives_a_scene_or_an_error(value in any_json()) {
        accepted(&value.to_string());
    }

    #[test]
    fn any_surface_gives_a_scene_or_an_error(
        kind in "sphere|triangle|quad|mesh|quadric|cylinder|cone|disk|ellipsoid|paraboloid",
        numbers in proptest::array::uniform10(any_number()),
        scale in any_number(),
    ) {
        let [a, b, c, d, e, f, g, h, i, j] = numbers.map(Value::from);
        let vector = |x: &Value, y: &Value, z: &Value| Value::from(vec![x.clone(), y.clone(), z.clone()]);
        let all = serde_json::json!({
            "origin": vector(&a, &b, &c), "base": vector(&b, &c, &d), "axis": vector(&e, &f, &g),
            "normal": vector(&f, &g, &h),
            "radius": h, "height": i, "radii": vector(&h, &i, &j), "apex": vector(&a, &c, &e),
            "vertex-1": vector(&a, &b, &c), "vertex-2": vector(&d, &e, &f), "vertex-3": vector(&g, &h, &i),
            "vertex-4": vector(&j, &a, &b), "coefficients": [a, b, c, d, e, f, g, h, i, j],
            "positions": [vector(&a, &b, &c)], "triangles": [[0, 0, 0]],
        });
        let keys: &[&str] = match kind.as_str() {
            "sphere" => &["origin", "radius"],
            "triangle" => &["vertex-1", "vertex-2", "vertex-3"],
            "quad" => &["vertex-1", "vertex-2", "vertex-3", "vertex-4"],
            "mesh" => &["positions", "triangles"],
            "quadric" => &["coefficients"],
            "cylinder" | "cone" => &["base", "axis", "radius", "height"],
            "disk" => &["origin", "normal", "radius"],
            "ellipsoid" => &["origin", "radii"],
            _ => &["apex", "axis", "radius", "height"],
        };
        let mut surface = serde_json::json!({"geometry": kind, "material": "m", "transform": {"scale": scale}});
        for key in keys {
            surface[*key] = all[*key].clone();
        }
        accepted(&serde_json::json!({
            "etendue": 1, "camera": {}, "materials": [{"name": "m", "type": "black"}], "surfaces": [surface],
        }).to_string());
    }
}

/// What is said about a mesh file of these bytes.
fn obj_error(bytes: &[u8]) -> String {
    obj(bytes).map(|scene| panic!("accepted: {:?}", scene.meshes)).unwrap_err().to_string()
}

fn obj(bytes: &[u8]) -> Result<SceneDesc, etendue::Error> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("m.obj"), bytes).unwrap();
    let text = "{\"etendue\": 1, \"camera\": {},\n\"surfaces\": [{\"geometry\": \"mesh\", \"file\": \"m.obj\", \
     \"emission\": [1, 1, 1]}]}";
    desc::parse(text, dir.path(), None)
}

#[test]
fn broken_mesh_files_are_refused_with_file_line_and_reason() {
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (body, expected) in [
        ("", "m.obj: surfaces[0].file: the file holds no faces"),
        ("# nothing\n", "m.obj: surfaces[0].file: the file holds no faces"),
        (three, "m.obj: surfaces[0].file: the file holds no faces"),
        ("solid cube\nfacet normal 0 0 1\n", "m.obj: surfaces[0].file: the file holds no faces"),
        ("v 0 0\n", "m.obj:1: surfaces[0].file: a position needs 3 numbers, found 2"),
        ("v 0 0 0\nv 0 zero 0\n", "m.obj:2: surfaces[0].file: 'zero' is not a finite number"),
        ("v 0 0 nan\n", "m.obj:1: surfaces[0].file: 'nan' is not a finite number"),
        ("v 0 0 inf\n", "m.obj:1: surfaces[0].file: 'inf' is not a finite number"),
        ("v 0 0 1e999\n", "m.obj:1: surfaces[0].file: '1e999' is not a finite number"),
        ("v 0 0 0 0\n", "m.obj:1: surfaces[0].file: a position with weight 0 lies at infinity"),
        ("vn 0 0\n", "m.obj:1: surfaces[0].file: a normal needs 3 numbers, found 2"),
        ("vt\n", "m.obj:1: surfaces[0].file: a texture coordinate needs 1 numbers, found 0"),
        ("v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "m.obj: surfaces[0].file: the position [1e39, 0.0, 0.0] is beyond"),
        ("v \u{7f}\u{80} 0 0\n", "m.obj:1: surfaces[0].file: "),
    ] {
        let said = obj_error(body.as_bytes());
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
    for (face, expected) in [
        ("f 1 2 4", "m.obj:4: surfaces[0].file: the face refers to vertex 4, but there are 3"),
        ("f 1 2 0", "m.obj:4: surfaces[0].file: '0' has the index 0, indices start at 1"),
        ("f 1 2 -4", "m.obj:4: surfaces[0].file: '-4' counts back 4, but there are 3"),
        ("f 1 2 -9223372036854775808", "m.obj:4: surfaces[0].file: '-9223372036854775808' counts back"),
        ("f 1 2 9223372036854775807", "m.obj:4: surfaces[0].file: the index in '9223372036854775807' is too large"),
        ("f 1 2 99999999999999999999", "m.obj:4: surfaces[0].file: '99999999999999999999' is not a corner"),
        ("f 1 2 3.5", "m.obj:4: surfaces[0].file: '3.5' is not a corner"),
        ("f 1 2 /3", "m.obj:4: surfaces[0].file: '/3' is not a corner"),
        ("f 1 2 3/1/1/1", "m.obj:4: surfaces[0].file: '3/1/1/1' is not a corner"),
        ("f 1/1 2/1 3/1", "m.obj:4: surfaces[0].file: the face refers to texture coordinate 1, but there are 0"),
        ("f 1//1 2//1 3//1", "m.obj:4: surfaces[0].file: the face refers to normal 1, but there are 0"),
        ("f 1/-9223372036854775808/ 2 3", "m.obj:4: surfaces[0].file: '1/-9223372036854775808/' counts back"),
        ("f 1 2\nf\n", "the file holds no faces"),
    ] {
        let said = obj_error(format!("{three}{face}\n").as_bytes());
        assert!(said.contains(expected), "{said}\nexpected {expected}");
    }
    // A Latin-1 comment and name, Windows line ends, a tab, colours: all fine.
    let odd = b"# gr\xfcn\r\no W\xfcrfel\r\nv\t0 0 0 1 0 0\r\nv 1 0 0 1 0 0\r\nv 0 1 0 1 0 0 # corner\r\nf 1 2 3\r\n";
    assert_eq!(obj(odd).unwrap().meshes[0].triangles.len(), 1);
    let forwards = b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    assert_eq!(obj(forwards).unwrap().meshes[0].triangles.len(), 1);
    let mixed = obj(format!("{three}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\nf 1 2\n").as_bytes()).unwrap();
    assert!(mixed.meshes[0].normals.is_empty() && mixed.meshes[0].triangles.len() == 2);
    assert!(mixed.warnings[0].contains("1 faces with fewer than 3 corners"), "{:?}", mixed.warnings);
    assert!(mixed.warnings[1].contains("only some corners have normals"), "{:?}", mixed.warnings);
    let endless = obj_error(&vec![b'v'; 20 << 20]);
    assert!(endless.contains("m.obj:1: surfaces[0].file: the line is longer"), "{endless}");
}

#[test]
fn random_changes_of_a_mesh_file_give_a_mesh_or_an_error() {
    let whole = std::fs::read(common::snippets::data_dir().join("pyramid.obj")).unwrap();
    let pieces: [&[u8]; 12] =
        [b"-", b"/", b" ", b"\n", b"\\\n", b"f ", b"v ", b"9999999999", b"\xff", b"nan", b"1e300", b"0"];
    let (mut random, mut read) = (Random(77), 0);
    for _ in 0..400 {
        let mut bytes = whole.clone();
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len());
            match random.below(3) {
                0 => bytes[at] = random.next() as u8,
                1 => drop(bytes.drain(at..(at + random.below(12)).min(bytes.len()))),
                _ => drop(bytes.splice(at..at, random.pick(&pieces).iter().copied())),
            }
        }
        match obj(&bytes) {
            Ok(scene) => {
                check(&scene, "a mesh file");
                read += 1;
            }
            Err(error) => assert!(!error.message().is_empty()),
        }
    }
    assert!((40..360).contains(&read), "{read} of 400 read");
}

#[test]
fn what_is_no_regular_file_is_refused_without_waiting() {
    let dir = tempfile::tempdir().unwrap();
    let fifo = dir.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    for (path, expected) in [
        (dir.path(), "it is a folder"),
        (&fifo, "it is not a regular file"),
        (Path::new("/dev/zero"), "it is not a regular file"),
        (&dir.path().join("none.json"), "No such file"),
    ] {
        let error = desc::load(path, None).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Io);
        assert!(error.to_string().contains(expected), "{error}");
        let text = format!(
            "{{\"etendue\": 1, \"camera\": {{}}, \"surfaces\": [\n{{\"geometry\": \"mesh\", \"emission\": [1, 1, 1],\n\
             \"file\": {path:?}}}]}}"
        );
        let error = desc::parse(&text, Path::new(""), None).unwrap_err();
        assert_eq!((error.kind(), error.location().json_path.as_str()), (ErrorKind::Io, "surfaces[0].file"));
        assert!(error.to_string().contains(expected), "{error}");
        let error = etendue::photometry::Web::read(path).unwrap_err();
        assert!(error.kind() == ErrorKind::Io && error.to_string().contains(expected), "{error}");
    }
    // Images are told apart by their names, and the factors of tilted lamps are in a file that another one names.
    let image = dir.path().join("pipe.png");
    std::fs::rename(&fifo, &image).unwrap();
    let error = etendue::output::read(&image).unwrap_err().to_string();
    assert!(error.contains("cannot read the image: it is not a regular file"), "{error}");
    let lamp = dir.path().join("lamp.ies");
    std::fs::write(&lamp, "IESNA:LM-63-2002\nTILT=pipe.png\n1 1000 1 1 1 1 1 0 0 0\n1 1 10\n0\n0\n1\n").unwrap();
    let error = etendue::photometry::Web::read(&lamp).unwrap_err().to_string();
    assert!(
        error.contains("TILT=pipe.png: cannot read the factors of tilted lamps: it is not a regular file"),
        "{error}"
    );
    let scene = dir.path().join("scene.json");
    std::fs::write(
        &scene,
        "{\"etendue\": 1, \"camera\": {}, \"surfaces\": [\n{\"geometry\": \"mesh\", \"emission\": [1, 1, 1],\n\
        \"file\": \"../x/../scene.json\"}]}"
            .replace("../x/../", "./"),
    )
    .unwrap();
    let error = desc::load(&scene, None).unwrap_err().to_string();
    assert!(error.contains("scene.json:3: surfaces[0].file: the mesh file is the scene file itself"), "{error}");
}

#[test]
fn files_that_are_too_large_are_refused_before_they_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("large.json");
    // Sparse: takes no room on the disk.
    std::fs::File::create(&path).unwrap().set_len((512 << 20) + 1).unwrap();
    let error = desc::load(&path, None).unwrap_err();
    assert!(error.kind() == ErrorKind::Io && error.message().contains("too large"), "{error}");
}

#[test]
fn text_that_is_not_utf8_is_refused_with_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.json");
    for (bytes, expected) in [
        (&b"{\"etendue\": 1,\n\"description\": \"gr\xfcn\"}"[..], "scene.json:2: byte 34 is not UTF-8"),
        (b"\xff\xfe{\0", "scene.json:1: the file is UTF-16"),
        (b"\xfe\xff\0{", "scene.json:1: the file is UTF-16"),
        (b"\xef\xbb\xbf{\n\"etendue\": 3}", "scene.json:2: etendue: the scene is of format version 3"),
    ] {
        std::fs::write(&path, bytes).unwrap();
        let error = desc::load(&path, None).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
