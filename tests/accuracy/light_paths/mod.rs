//! Light paths to the camera: what is known in closed form, and what paths from the camera find by themselves.
//!
//! Where a fault would move light from one part of the picture to another, parts are compared. Errors come from renders of several seeds.

use std::f64::consts::PI;

use etendue::camera::Camera;
use etendue::desc::{self, BsdfDesc, CropDesc, FilterDesc, RenderDesc, SceneDesc, ShapeDesc, TextureDesc, TextureKey};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use crate::arithmetic::repeat::load;
use crate::common::scenes::{box_inside, camera, render_scene, scene};
use crate::common::stats::mean_and_error;
use crate::record::{Case, Entry};
use crate::textures::row_texture;
use crate::textures::scenes::vary;
use crate::transport::{MESH, ball, glass, grey, mirror, parallelogram, pick};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "E1", title: "light from a mirror on a floor, in closed form", run: mirrored_lamp },
        Entry { id: "E2", title: "light paths in furnaces", run: furnaces },
        Entry { id: "E3", title: "light paths against paths from the camera alone", run: against_paths },
        Entry { id: "E4", title: "filters and films of light paths", run: films },
    ]
}

/// The parts of a picture, and how exact their means are to be in tolerances.
const PARTS: [(&str, f64); 5] =
    [("upper left", 1.0), ("upper right", 1.0), ("lower left", 1.0), ("lower right", 1.0), ("all of it", 0.5)];

/// Means over the parts of a picture, by the mean over channels.
fn parts(image: &Image) -> [f64; 5] {
    let [width, height] = [image.width, image.height].map(|side| side as usize);
    let mean = |quarter: usize| {
        let (left, top) = (quarter % 2 * (width / 2), quarter / 2 * (height / 2));
        let mut sum = 0.0;
        for y in top..top + height / 2 {
            for x in left..left + width / 2 {
                sum += image.rgb[3 * (y * width + x)..][..3].iter().map(|value| f64::from(*value)).sum::<f64>();
            }
        }
        sum / (3 * (width / 2) * (height / 2)) as f64
    };
    let [a, b, c, d] = [0, 1, 2, 3].map(mean);
    [a, b, c, d, 0.25 * (a + b + c + d)]
}

/// Renders of this many seeds: for each part the mean and its standard error.
pub fn measure(scene: &Scene, desc: &RenderDesc, seeds: u64, first: u64) -> [(f64, f64); 5] {
    let found: Vec<[f64; 5]> = (0..seeds)
        .map(|seed| parts(&render_scene(scene, RenderDesc { seed: first + seed, ..desc.clone() }).0))
        .collect();
    std::array::from_fn(|part| mean_and_error(&found.iter().map(|found| found[part]).collect::<Vec<_>>()))
}

/// Compares the means of the parts with numbers known exactly.
pub fn means(case: &mut Case, what: &str, found: [(f64, f64); 5], exact: [f64; 5], tolerance: f64) {
    for ((found, exact), (part, share)) in found.into_iter().zip(exact).zip(PARTS) {
        case.mean(format!("{what}, {part}"), found, exact, share * tolerance);
    }
}

/// The same with means that were measured as well.
pub fn equal_means(case: &mut Case, what: &str, found: [(f64, f64); 5], expected: [(f64, f64); 5], tolerance: f64) {
    for ((found, expected), (part, share)) in found.into_iter().zip(expected).zip(PARTS) {
        case.equal_means(format!("{what}, {part}"), found, expected, share * tolerance);
    }
}

pub fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

pub fn settings(samples: u64) -> RenderDesc {
    RenderDesc { resolution: [16, 16], samples: samples as u32, light_paths: Some(true), ..RenderDesc::default() }
}

/// Albedo of a floor.
const FLOOR: f32 = 1e-4;

pub fn rectangle(x: f64, y: f64, half: [f64; 2], up: bool) -> ShapeDesc {
    let [u, v] = [DVec3::X * (2.0 * half[0]), DVec3::Z * (2.0 * half[1])];
    let corner = DVec3::new(x - half[0], y, -half[1]);
    if up { parallelogram(corner, v, u) } else { parallelogram(corner, u, v) }
}

/// Whether light samples look for lamps in a flat mirror.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    Plain,
    /// Its reflectance varies, as far as anybody knows, so that they do not.
    Textured,
}

/// Lets a parameter of a material vary, by a texture that is 1 everywhere.
pub fn vary_by_nothing(desc: &mut SceneDesc, material: usize, key: TextureKey) {
    vary(desc, material, key, TextureDesc { name: format!("nothing {material}"), ..row_texture(&[1.0]) });
}

/// A floor whose only light is that of a lamp which it sees in a mirror: the lamp shines upwards, at a mirror at a height of 1, and its
/// image is at 1.5.
pub fn mirrored_lamp_scene(reflectance: f32, panel: Panel) -> SceneDesc {
    let view = camera(DVec3::new(-0.3, 0.9, 0.0), DVec3::ZERO, 50.0);
    let mut desc = scene(
        view,
        vec![
            // Dark, so that next to nothing of its light comes back to it.
            (rectangle(0.0, 0.0, [9.0, 9.0], true), grey(FLOOR), None),
            (rectangle(0.8, 1.0, [0.6, 0.6], false), mirror(reflectance), None),
            (rectangle(1.3, 0.5, [0.2, 0.2], true), BsdfDesc::Black, Some(Rgb::splat(2.0))),
        ],
    );
    if panel == Panel::Textured {
        vary_by_nothing(&mut desc, 1, TextureKey::Color);
    }
    desc
}

/// Irradiance at a place of that floor in a perfect mirror, by the polygon's sides (Lambert 1760).
fn mirrored_irradiance(x: f64, z: f64) -> f64 {
    let corners =
        [[1.1, -0.2], [1.1, 0.2], [1.5, 0.2], [1.5, -0.2]].map(|[cx, cz]| DVec3::new(cx - x, 1.5, cz - z).normalize());
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        a.angle_between(b) * a.cross(b).normalize().y
    };
    2.0 * 0.5 * (0..4).map(side).sum::<f64>().abs()
}

/// Radiance of the floor at a film position.
fn floor_radiance(camera: &Camera, centre: DVec3, x: f32, y: f32) -> f64 {
    let ray = camera.ray(x, y);
    let (origin, direction) = (ray.origin.as_dvec3() + centre, ray.direction.as_dvec3());
    let p = origin - direction * (origin.y / direction.y);
    f64::from(FLOOR) / PI * mirrored_irradiance(p.x, p.z)
}

/// The picture of that floor in a perfect mirror, by quarters and as a whole.
pub fn mirrored_lamp_parts() -> [f64; 5] {
    let scene = build(&mirrored_lamp_scene(1.0, Panel::Textured));
    let camera = Camera::new(scene.camera(), [16, 16], scene.centre()).expect("a camera");
    const FINE: u32 = 8;
    let mut expected = [0.0; 5];
    for y in 0..16 * FINE {
        for x in 0..16 * FINE {
            let at = [x, y].map(|at| (at as f32 + 0.5) / FINE as f32);
            let quarter = (y / (8 * FINE) * 2 + x / (8 * FINE)) as usize;
            let value = floor_radiance(&camera, scene.centre(), at[0], at[1]) / f64::from(64 * FINE * FINE);
            expected[quarter] += value;
            expected[4] += 0.25 * value;
        }
    }
    expected
}

fn mirrored_lamp(case: &mut Case) {
    let expected = mirrored_lamp_parts();
    // Roulette ends most paths that a dark mirror reflects.
    for (what, reuse, reflectance) in
        [("paths by themselves", false, 0.75), ("shared hits", true, 0.75), ("a dark mirror", false, 0.2)]
    {
        let scene = build(&mirrored_lamp_scene(reflectance, Panel::Textured));
        let desc = RenderDesc { reuse: Some(reuse), ..settings(case.count(2048, 4096)) };
        let found = measure(&scene, &desc, case.count(16, 24), 1);
        let tolerance = if reflectance < 0.5 { pick(case, 1.2e-2, 7e-3) } else { pick(case, 8e-3, 5e-3) };
        means(case, what, found, expected.map(|expected| f64::from(reflectance) * expected), tolerance);
    }
}

/// Closed rooms in which radiance is 1 everywhere: what a wall does not reflect, it emits.
fn furnaces(case: &mut Case) {
    let seeds = case.count(16, 24);
    let room = |view, bodies: Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)>| {
        let walls = (MESH, grey(0.7), Some(Rgb::splat(0.3)));
        let mut desc = scene(view, std::iter::once(walls).chain(bodies).collect());
        desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
        build(&desc)
    };
    let bodies = vec![
        (ball(DVec3::new(-0.4, 0.0, -0.3), 0.35), mirror(1.0), None),
        (ball(DVec3::new(0.4, -0.1, -0.3), 0.35), glass(1.5, 1.0), None),
        (rectangle(0.0, -0.7, [0.3, 0.3], true), mirror(1.0), None),
    ];
    let view = camera(DVec3::new(0.1, -0.2, 0.9), DVec3::new(0.0, 0.0, -1.0), 90.0);
    let scene = room(view, bodies);
    for reuse in [false, true] {
        let desc = RenderDesc { reuse: Some(reuse), ..settings(case.count(64, 256)) };
        let found = measure(&scene, &desc, seeds, 1);
        let what = if reuse { "mirrors and glass, shared hits" } else { "mirrors and glass" };
        means(case, what, found, [1.0; 5], pick(case, 6e-3, 2.5e-3));
    }
    // Within glass, where radiance is the square of its refraction index, the camera sees a body that reflects half of the light.
    let inside = 1.5 * 1.5;
    let bodies = vec![
        (ball(DVec3::ZERO, 0.8), glass(1.5, 1.0), None),
        (ball(DVec3::new(0.0, 0.0, -0.3), 0.3), grey(0.5), Some(Rgb::splat(0.5 * inside as f32))),
    ];
    let view = camera(DVec3::new(0.0, 0.1, 0.5), DVec3::new(0.0, 0.0, -0.3), 20.0);
    let found = measure(&room(view, bodies), &settings(case.count(256, 1024)), seeds, 1);
    means(case, "within glass", found, [inside; 5], pick(case, 6e-3, 2.5e-3));
}

/// The project's scenes, by quarters.
fn against_paths(case: &mut Case) {
    let seeds = case.count(8, 16);
    let scenes = [
        ("caustic.json", 1.5e-2, 6e-3),
        ("quadrics.json", 1.5e-2, 6e-3),
        ("room.json", 1.5e-2, 6e-3),
        ("materials.json", 2.5e-2, 1e-2),
        ("mirrors.json", 4e-2, 1.6e-2),
    ];
    for (name, quick, full) in scenes {
        if !case.is_full() && ["quadrics.json", "materials.json"].contains(&name) {
            continue;
        }
        compare(case, name, &build(&load(name)), seeds, pick(case, quick, full));
    }
    // Interpolated normals, which turn reflections where no face is turned.
    let text = r#"{"etendue": 1,
        "camera": {"origin": [0, 2.2, 3], "lookAt": [0, 0.2, 0], "up": [0, 1, 0], "fieldOfView": 60},
        "materials": [{"name": "mirror", "type": "reflective", "color": [0.9, 0.8, 0.7]}, {"name": "floor", "type": "diffuse", "color": [0.6, 0.6, 0.6]}],
        "surfaces": [
            {"geometry": "quad", "material": "floor", "vertex-1": [-4, 0, 4], "vertex-2": [4, 0, 4], "vertex-3": [4, 0, -4], "vertex-4": [-4, 0, -4]},
            {"geometry": "sphere", "origin": [2, 4, 2], "radius": 1.6, "emission": [9, 8, 7]},
            {"geometry": "mesh", "file": "meshes/teapot.obj", "shading": "smooth", "material": "mirror", "transform": {"scale": 0.5}}]}"#;
    let desc = desc::parse(text, concat!(env!("CARGO_MANIFEST_DIR"), "/scenes").as_ref(), None).expect("a scene");
    compare(case, "a mirror with interpolated normals", &build(&desc), seeds, pick(case, 2.5e-2, 1e-2));
}

fn compare(case: &mut Case, name: &str, scene: &Scene, seeds: u64, tolerance: f64) {
    let desc = RenderDesc { resolution: [32, 32], ..settings(case.count(64, 256)) };
    let alone = RenderDesc { light_paths: Some(false), reuse: Some(true), samples: 4 * desc.samples, ..desc.clone() };
    let expected = measure(scene, &alone, seeds, 1000);
    for reuse in [false, true] {
        let found = measure(scene, &RenderDesc { reuse: Some(reuse), ..desc.clone() }, seeds, 1);
        let what = format!("{name}{}", if reuse { ", shared hits" } else { "" });
        equal_means(case, &what, found, expected, tolerance);
    }
}

/// Filters that are wider than a pixel, films that are moved, pixels that are not square, and a part of a picture.
fn films(case: &mut Case) {
    let seeds = case.count(16, 24);
    let tolerance = pick(case, 3e-2, 1.3e-2);
    let filters = [
        ("box", FilterDesc::Box),
        ("tent", FilterDesc::Tent),
        ("gaussian", FilterDesc::Gaussian { sigma: 0.5 }),
        ("blackman-harris", FilterDesc::BlackmanHarris),
    ];
    let still = mirrored_lamp_scene(0.75, Panel::Textured);
    let mut moved = still.clone();
    if let desc::CameraDesc::Perspective { film, .. } = &mut moved.camera {
        film.shift = [0.2, -0.15];
        film.pixel_aspect = 1.5;
    }
    let mut pairs = Vec::new();
    for (name, filter) in filters {
        pairs.push((name.to_owned(), build(&still), RenderDesc { filter, ..settings(case.count(256, 1024)) }));
    }
    let wide = RenderDesc { filter: FilterDesc::Tent, ..settings(case.count(256, 1024)) };
    let crop = Some(CropDesc { left: 4, top: 6, width: 6, height: 8 });
    pairs.push(("a film that is moved, of pixels that are not square".to_owned(), build(&moved), wide.clone()));
    pairs.push((
        "a part of the picture".to_owned(),
        build(&still),
        RenderDesc { crop, samples: 4 * wide.samples, ..wide },
    ));
    for (name, scene, desc) in pairs {
        let found = measure(&scene, &desc, seeds, 1);
        let alone = RenderDesc { light_paths: Some(false), samples: 4 * desc.samples, ..desc };
        let expected = measure(&scene, &alone, seeds, 1000);
        equal_means(case, &name, found, expected, tolerance);
    }
}
