//! Mattes: coverages against closed forms and against pictures, names, ranks, and what is refused.

use std::ops::ControlFlow;
use std::path::Path;

use crate::desc::{self, CropDesc, FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc};
use crate::output::{self, WriteOptions, cryptomatte};
use crate::render::{MatteKind, MatteSettings, Mattes, Render, RenderSettings, Workers};
use crate::scene::{BuildOptions, Scene};
use crate::{Cancel, ErrorKind, Result};

/// A view along -z of a square of side 8, in pixels of side 8 / `side`, with `more` at the top of the scene.
fn scene(side: u32, more: &str) -> SceneDesc {
    let text = format!(
        r#"{{"etendue": 1, "camera": {{"type": "orthographic", "origin": [0, 0, 9], "lookAt": [0, 0, 0], "width": 8, "shutter": {{"close": 1}}}},
            "materials": [{{"name": "white", "type": "diffuse", "color": [0.5, 0.5, 0.5]}},
                          {{"name": "veil", "type": "black", "opacity": 0.25}}], {more}}}"#
    );
    let mut scene = desc::parse(&text, Path::new("."), None).unwrap_or_else(|error| panic!("{error}"));
    scene.render = RenderDesc {
        resolution: [side; 2],
        samples: 1024,
        filter: FilterDesc::Box,
        integrator: IntegratorDesc::Direct,
        ..RenderDesc::default()
    };
    scene
}

/// An upright rectangle between these corners.
fn rectangle([left, bottom, right, top]: [f64; 4], z: f64, more: &str) -> String {
    format!(
        r#"{{"geometry": "quad", "vertex-1": [{left}, {bottom}, {z}], "vertex-2": [{right}, {bottom}, {z}],
            "vertex-3": [{right}, {top}, {z}], "vertex-4": [{left}, {top}, {z}], {more}}}"#
    )
}

fn settings(desc: &SceneDesc) -> MatteSettings {
    MatteSettings { desc: desc.render.clone(), threads: 1, ..MatteSettings::default() }
}

fn traced(desc: &SceneDesc, settings: &MatteSettings) -> Result<Mattes> {
    let scene = Scene::build(desc, &BuildOptions { threads: 1, ..BuildOptions::default() })?;
    Mattes::trace(&scene, desc, settings, &mut |_| ControlFlow::Continue(()))
}

/// The share of a pixel in which a name is seen.
fn coverage(mattes: &Mattes, kind: MatteKind, name: &str, [x, y]: [u32; 2]) -> f64 {
    let number = mattes.names(kind).iter().position(|it| it == name).expect(name) as u32;
    let share = mattes.pixel(kind, x, y).iter().find(|share| share.name == number);
    share.map_or(0.0, |share| f64::from(share.samples) / f64::from(mattes.samples()))
}

fn near(found: f64, expected: f64, error: f64) {
    assert!((found - expected).abs() < error, "{found} is not {expected} to {error}");
}

#[test]
fn coverages_sum_to_the_area_that_is_seen() {
    let ball = r#""surfaces": [{"geometry": "sphere", "origin": [0.1, 0.05, 0], "radius": 2, "material": "white"}]"#;
    let mut desc = scene(32, ball);
    desc.render.samples = 64;
    for filter in [FilterDesc::Box, FilterDesc::Gaussian { sigma: 0.5 }] {
        desc.render.filter = filter;
        let mattes = traced(&desc, &settings(&desc)).unwrap();
        let pixels = || (0..32).flat_map(|y| (0..32).map(move |x| [x, y]));
        for (kind, name) in [(MatteKind::Object, "surfaces[0]"), (MatteKind::Material, "white")] {
            let sum: f64 = pixels().map(|pixel| coverage(&mattes, kind, name, pixel)).sum();
            near(sum / 16.0, 4.0 * std::f64::consts::PI, 0.04);
        }
        assert!(mattes.pixel(MatteKind::Object, 0, 0).is_empty(), "nothing is seen there");
    }
}

#[test]
fn pixels_rank_what_they_see() {
    let named = |name: &str| format!(r#""material": "white", "name": "{name}""#);
    let surfaces = [
        // One object of two surfaces, whose border is inside of pixels.
        rectangle([-4.0, -4.0, -1.75, 0.3], 0.0, &named("a")),
        rectangle([-4.0, 0.3, -1.75, 4.0], 0.0, &named("a")),
        rectangle([-1.75, -4.0, -1.1, 4.0], 0.0, &named("b")),
        rectangle([-4.0, -4.0, 3.5, 4.0], -1.0, r#""material": "white""#),
    ];
    let desc = scene(8, &format!(r#""surfaces": [{}]"#, surfaces.join(", ")));
    let mattes = traced(&desc, &settings(&desc)).unwrap();
    assert_eq!(mattes.names(MatteKind::Object), ["a", "b", "surfaces[3]"]);
    assert_eq!(mattes.names(MatteKind::Material), ["white", "veil"]);
    for y in 0..8 {
        for (kind, name, x, exact) in [
            (MatteKind::Object, "a", 1, 1.0),
            (MatteKind::Object, "a", 2, 0.25),
            (MatteKind::Object, "b", 2, 0.65),
            (MatteKind::Object, "surfaces[3]", 2, 0.1),
            (MatteKind::Object, "surfaces[3]", 4, 1.0),
            (MatteKind::Object, "surfaces[3]", 7, 0.5),
            (MatteKind::Material, "white", 2, 1.0),
            (MatteKind::Material, "white", 7, 0.5),
        ] {
            near(coverage(&mattes, kind, name, [x, y]), exact, if exact == 1.0 { 1e-9 } else { 0.004 });
        }
        let ranks: Vec<u32> = mattes.pixel(MatteKind::Object, 2, y).iter().map(|share| share.name).collect();
        assert_eq!(ranks, [1, 0, 2]);
    }
    // Fewer levels keep the largest ones, as they were.
    let few = traced(&desc, &MatteSettings { levels: 2, ..settings(&desc) }).unwrap();
    assert_eq!(few.pixel(MatteKind::Object, 2, 5), &mattes.pixel(MatteKind::Object, 2, 5)[..2]);
    assert!(few.pixel(MatteKind::Object, 8, 0).is_empty());

    // Layers of an EXR, and what a program reads in them.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mattes.exr");
    let layers = cryptomatte::layers(&mattes).unwrap();
    let options = WriteOptions { attributes: cryptomatte::attributes(&mattes).unwrap(), ..WriteOptions::default() };
    let image = crate::film::Image { width: 8, height: 8, rgb: vec![0.0; 192], layers, placement: None };
    output::write(&image, &path, &options).unwrap();
    let read = output::read(&path).unwrap();
    assert_eq!(read.layers.len(), 8);
    for layer in &image.layers {
        assert!(read.layer(&layer.name) == Some(layer), "every bit of {} is kept", layer.name);
    }
    let first = &read.layer("CryptoObject00").unwrap().data[4 * (8 * 3 + 2)..][..4];
    assert_eq!([first[0], first[2]], ["b", "a"].map(cryptomatte::id));
    near(f64::from(first[1]), 0.65, 0.004);
    near(f64::from(first[3]), 0.25, 0.004);
    let second = &read.layer("CryptoObject01").unwrap().data[4 * (8 * 3 + 2)..][..4];
    assert_eq!([second[0], second[2], second[3]], [cryptomatte::id("surfaces[3]"), 0.0, 0.0]);
    assert!(read.layer("CryptoObject02").unwrap().data.iter().all(|value| *value == 0.0));
    assert_eq!(read.layer("CryptoObject").unwrap().channels, 3);
}

#[test]
fn rays_pass_where_a_surface_is_not_there() {
    let surfaces = [
        rectangle([-4.0, -4.0, 4.0, 4.0], 0.0, r#""material": "veil""#),
        rectangle([-4.0, -4.0, 4.0, 4.0], -1.0, r#""material": "white", "name": "wall""#),
    ];
    let mut desc = scene(64, &format!(r#""surfaces": [{}]"#, surfaces.join(", ")));
    desc.render.samples = 64;
    let mattes = traced(&desc, &settings(&desc)).unwrap();
    let mean = |kind, name| {
        let pixels = (0..64).flat_map(|y| (0..64).map(move |x| [x, y]));
        pixels.map(|pixel| coverage(&mattes, kind, name, pixel)).sum::<f64>() / 4096.0
    };
    for kind in MatteKind::ALL {
        let [veil, wall] = if kind == MatteKind::Object { ["surfaces[0]", "wall"] } else { ["veil", "white"] };
        near(mean(kind, veil), 0.25, 0.003);
        near(mean(kind, wall), 0.75, 0.003);
    }
}

#[test]
fn what_moves_covers_a_pixel_for_a_part_of_the_time() {
    let moves = r#""material": "white", "name": "it", "motion": [{"time": 0}, {"time": 1, "translate": [5, 0, 0]}]"#;
    let desc = scene(8, &format!(r#""surfaces": [{}]"#, rectangle([-4.0, -4.0, -1.0, 4.0], 0.0, moves)));
    let mattes = traced(&desc, &settings(&desc)).unwrap();
    // Its left edge is at -4 + 5 t and its right one at -1 + 5 t: it covers what is between -1 and 1 for 0.6 of the time.
    let pixels: Vec<[u32; 2]> = (0..8).flat_map(|y| [[3, y], [4, y]]).collect();
    let mean = pixels.iter().map(|pixel| coverage(&mattes, MatteKind::Object, "it", *pixel)).sum::<f64>() / 16.0;
    near(mean, 0.6, 0.006);
}

/// Coverages of a lamp of radiance 1 among black things are its picture, whatever a camera sample is made of.
#[test]
fn edges_are_those_of_the_picture() {
    let lamp =
        r#""emission": [1, 1, 1], "name": "lamp", "motion": [{"time": 0}, {"time": 1, "translate": [1, 0.5, 0]}]"#;
    let surfaces =
        [rectangle([-2.0, -2.0, 1.3, 1.1], 0.0, lamp), rectangle([-1.0, -3.0, 0.4, 4.0], 1.0, r#""material": "veil""#)];
    let base = scene(20, &format!(r#""surfaces": [{}]"#, surfaces.join(", ")));
    let lens = r#""origin": [0, 0, 6], "lookAt": [0, 0, 0], "fieldOfView": 60, "lensRadius": 0.4, "focusDistance": 4"#;
    let cameras = [
        format!("{{{lens}}}"),
        format!(
            r#"{{{lens}, "shutter": {{"close": 1}}, "motion": [{{"time": 0}}, {{"time": 1, "translate": [0, 1, 0]}}]}}"#
        ),
        r#"{"type": "fisheye", "origin": [0, 0, 3], "lookAt": [0, 0, 0], "fieldOfView": 120}"#.to_owned(),
    ];
    let samplers =
        [SamplerDesc::Sobol, SamplerDesc::Random, SamplerDesc::Jittered, SamplerDesc::Grid, SamplerDesc::Gaussian];
    let mut partly = 0;
    for (camera, sampler) in cameras.iter().flat_map(|camera| samplers.map(|sampler| (camera, sampler))) {
        let text = format!(r#"{{"etendue": 1, "camera": {camera}}}"#);
        let seen = desc::parse(&text, Path::new("."), None).unwrap_or_else(|error| panic!("{error}"));
        let mut desc = SceneDesc { camera: seen.camera, ..base.clone() };
        desc.motion.camera = seen.motion.camera;
        desc.render.sampler = sampler;
        desc.render.filter = FilterDesc::Gaussian { sigma: 0.5 };
        desc.render.samples = 16;
        desc.render.resolution = [24, 20];
        desc.render.crop = Some(CropDesc { left: 3, top: 2, width: 19, height: 17 });
        desc.render.seed = 7;
        let scene = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }).unwrap();
        let settings = RenderSettings { desc: desc.render.clone(), threads: 1, ..RenderSettings::default() };
        let mut render = Render::new(&scene, settings).unwrap();
        render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        let image = render.image();
        let mattes = traced(&desc, &self::settings(&desc)).unwrap();
        assert_eq!((mattes.resolution(), mattes.placement()), ([19, 17], image.placement));
        for [x, y] in (0..17).flat_map(|y| (0..19).map(move |x| [x, y])) {
            let [picture, ..] = image.pixel(x, y).map(f64::from);
            let share = coverage(&mattes, MatteKind::Object, "lamp", [x, y]);
            assert!((picture - share).abs() < 1e-5, "{sampler:?}, {camera}, ({x}, {y}): {picture} and {share}");
            partly += usize::from(share > 0.0 && share < 1.0);
        }
        assert!(mattes.names(MatteKind::Material).contains(&"veil".to_owned()));
        assert_eq!(coverage(&mattes, MatteKind::Material, "white", [9, 9]), 0.0, "the lamp has no material");
    }
    assert!(partly > 500, "{partly} pixels have edges");
}

#[test]
fn threads_make_no_difference() {
    let balls: Vec<String> = (0..40)
        .map(|i| {
            let [x, y] = [i % 8, i / 8].map(|place| f64::from(place) - 3.5);
            format!(r#"{{"geometry": "sphere", "origin": [{x}, {y}, 0], "radius": 0.6, "material": "white"}}"#)
        })
        .collect();
    let mut desc = scene(70, &format!(r#""surfaces": [{}]"#, balls.join(", ")));
    desc.render.samples = 16;
    let one = traced(&desc, &settings(&desc)).unwrap();
    let two = traced(&desc, &MatteSettings { threads: 2, ..settings(&desc) }).unwrap();
    let calling = Workers::calling_thread();
    let third = traced(&desc, &MatteSettings { workers: Some(calling), ..settings(&desc) }).unwrap();
    assert!(one == two && one == third);
    // The first samples of more are the same.
    let first = traced(&desc, &MatteSettings { samples: Some(4), ..settings(&desc) }).unwrap();
    assert!(first.samples() == 4 && first != one);
}

#[test]
fn mattes_are_refused_and_stopped() {
    let desc = scene(256, r#""surfaces": []"#);
    let error = |settings: &MatteSettings| traced(&desc, settings).unwrap_err();
    for levels in [0, 65] {
        let refused = error(&MatteSettings { levels, ..settings(&desc) });
        assert_eq!((refused.kind(), &*refused.location().json_path), (ErrorKind::InvalidScene, "levels"));
    }
    let refused = error(&MatteSettings { samples: Some(0), ..settings(&desc) });
    assert_eq!(refused.location().json_path, "samples");
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(error(&MatteSettings { cancel, ..settings(&desc) }).kind(), ErrorKind::Cancelled);
    // In the middle of much work.
    let scene = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }).unwrap();
    for workers in [None, Some(Workers::calling_thread())] {
        let settings = MatteSettings { samples: Some(1 << 20), workers, ..settings(&desc) };
        let outcome = Mattes::trace(&scene, &desc, &settings, &mut |fraction| {
            assert!((0.0..1.0).contains(&fraction));
            ControlFlow::Break(())
        });
        assert_eq!(outcome.unwrap_err().kind(), ErrorKind::Cancelled);
    }
}
