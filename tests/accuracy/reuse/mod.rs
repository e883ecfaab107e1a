//! Second hits that neighbouring pixels share, and more light samples at their first hits: what is known in closed form, and what paths by themselves find.
//!
//! Errors of pixels depend on each other here, so that those of means come from renders of several seeds.

use std::f64::consts::PI;

use etendue::desc::{BsdfDesc, CropDesc, RenderDesc, SceneDesc, ShapeDesc, TextureKey};
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use crate::arithmetic::repeat::load;
use crate::common::scenes::{box_inside, camera, mean_and_error as pixels, point_light, render_scene, scene};
use crate::common::stats::mean_and_error;
use crate::light_paths::vary_by_nothing;
use crate::lights::{ceiling, lit};
use crate::record::{Case, Entry, Within};
use crate::transport::rooms::{FLOOR_IRRADIANCE, floor_and_ceiling, sphere_with_light};
use crate::transport::{MESH, ball, grey, mirror, parallelogram, pick};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "U1", title: "shared hits in rooms known in closed form", run: closed_forms },
        Entry { id: "U2", title: "shared hits in furnaces", run: furnaces },
        Entry { id: "U3", title: "shared hits against paths by themselves", run: against_paths },
        Entry { id: "U4", title: "lamps in mirrors, by aimed rays", run: lamps_in_mirrors },
        Entry { id: "U5", title: "more light samples at the first hit", run: first_light_samples },
    ]
}

/// Renders of this many seeds: their mean and its standard error, by the mean over channels.
fn measure(scene: &Scene, desc: &RenderDesc, seeds: u64, first: u64) -> (f64, f64) {
    let means: Vec<f64> = (0..seeds)
        .map(|seed| {
            let (image, _) = render_scene(scene, RenderDesc { seed: first + seed, ..desc.clone() });
            image.mean().iter().sum::<f64>() / 3.0
        })
        .collect();
    mean_and_error(&means)
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn settings(samples: u64) -> RenderDesc {
    RenderDesc { resolution: [16, 16], samples: samples as u32, reuse: Some(true), ..RenderDesc::default() }
}

/// The same scene seen so widely that the first hits of a group are far from each other, in all directions.
fn widely(desc: &SceneDesc, degrees: f64) -> SceneDesc {
    let mut desc = desc.clone();
    if let etendue::desc::CameraDesc::Perspective { fov_deg, .. } = &mut desc.camera {
        *fov_deg = degrees;
    }
    desc
}

fn closed_forms(case: &mut Case) {
    let seeds = case.count(16, 32);
    let tolerance = pick(case, 4e-3, 1e-3);
    // In a sphere, what is reflected once or more often is even: the mean of a wide picture is a closed form but for direct light,
    // which a light in the centre makes even as well.
    for (what, albedo, offset, degrees) in [
        ("sphere, a point", 0.7_f32, 0.8, 0.1),
        ("sphere, 100 degrees", 0.7, 0.0, 100.0),
        ("bright sphere, 100 degrees", 0.9, 0.0, 100.0),
    ] {
        let (desc, exact) = sphere_with_light(2.0, albedo, 5.0, DVec3::X * offset, DVec3::Y * 2.0);
        let scene = build(&widely(&desc, degrees));
        case.mean(what, measure(&scene, &settings(case.count(16, 128)), seeds, 1), exact, tolerance);
    }
    for (rho, r, irradiance) in [FLOOR_IRRADIANCE[1], FLOOR_IRRADIANCE[2]] {
        let scene = build(&floor_and_ceiling(rho, r));
        let exact = f64::from(rho) / PI * irradiance;
        let found = measure(&scene, &settings(case.count(32, 256)), seeds, 1);
        case.mean(format!("floor and ceiling, distance {r}"), found, exact, pick(case, 8e-3, 2e-3));
    }
    // Two walls at a corner, of which one shines, seen where distances between them fall to 0.
    let wall = parallelogram(DVec3::new(-9.0, 0.0, 0.0), DVec3::X * 18.0, DVec3::Y);
    let shining = parallelogram(DVec3::new(-9.0, 0.0, 0.0), DVec3::Z, DVec3::X * 18.0);
    let view = camera(DVec3::new(0.3, 0.4, 1.0), DVec3::ZERO, 40.0);
    let scene = build(&scene(view, vec![(wall, grey(0.8), None), (shining, grey(0.5), Some(Rgb::ONE))]));
    // Each wall by itself: what one gains, the other loses.
    for (what, top) in [("the dark wall at a corner", 0), ("the shining wall at a corner", 8)] {
        let crop = Some(CropDesc { left: 0, top, width: 16, height: 8 });
        let shared = RenderDesc { crop, ..settings(case.count(64, 512)) };
        let alone = RenderDesc { reuse: Some(false), samples: 2 * shared.samples, ..shared.clone() };
        let expected = measure(&scene, &alone, seeds, 1000);
        case.equal_means(what, measure(&scene, &shared, seeds, 1), expected, tolerance);
    }
}

/// Closed rooms in which radiance is 1 everywhere: what a wall does not reflect, it emits.
fn furnaces(case: &mut Case) {
    let seeds = case.count(16, 32);
    // Walls that scatter by direction, since they let light out as well.
    let leaking = BsdfDesc::DiffuseTransmission { reflectance: Rgb::splat(0.7), transmittance: Rgb::splat(0.2) };
    let view = camera(DVec3::new(0.1, -0.2, 0.9), DVec3::new(0.0, 0.0, -1.0), 90.0);
    let mut desc = scene(view, vec![(MESH, leaking, Some(Rgb::splat(0.3)))]);
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    let found = measure(&build(&desc), &settings(case.count(64, 512)), seeds, 1);
    case.mean("walls that let light out", found, 1.0, pick(case, 2e-3, 6e-4));
    let room = |albedo: f32, bodies: Vec<(ShapeDesc, BsdfDesc)>| {
        let walls = (MESH, grey(albedo), Some(Rgb::splat(1.0 - albedo)));
        let bodies = bodies.into_iter().map(|(shape, bsdf)| (shape, bsdf, None));
        let view = camera(DVec3::new(0.1, -0.2, 0.9), DVec3::new(0.0, 0.0, -1.0), 90.0);
        let mut desc = scene(view, std::iter::once(walls).chain(bodies).collect());
        desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
        build(&desc)
    };
    let sheet =
        |x: f64, z: f64| parallelogram(DVec3::new(x - 0.4, -0.5, z), DVec3::X * 0.8, DVec3::new(0.0, 1.0, -0.3));
    let through = BsdfDesc::DiffuseTransmission { reflectance: Rgb::splat(0.4), transmittance: Rgb::splat(0.6) };
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    for (what, albedo, bodies) in [
        ("walls of 0.8", 0.8, Vec::new()),
        (
            "mirror and glass among walls of 0.7",
            0.7,
            vec![
                (ball(DVec3::new(-0.4, 0.0, -0.3), 0.35), mirror(1.0)),
                (ball(DVec3::new(0.4, -0.1, -0.3), 0.35), glass),
            ],
        ),
        (
            "white bodies among walls of 0.5",
            0.5,
            vec![
                (ball(DVec3::new(-0.4, 0.0, -0.3), 0.35), grey(1.0)),
                (ball(DVec3::new(0.4, -0.1, -0.3), 0.35), grey(1.0)),
            ],
        ),
        ("sheets that let light through", 0.5, vec![(sheet(-0.45, -0.3), through), (sheet(0.45, -0.2), through)]),
    ] {
        let scene = room(albedo, bodies);
        case.mean(what, measure(&scene, &settings(case.count(32, 256)), seeds, 1), 1.0, pick(case, 4e-3, 1e-3));
    }
}

/// A patch whose only light is that of a lamp which it sees in a mirror.
fn lamps_in_mirrors(case: &mut Case) {
    let rectangle = |x: f64, y: f64, half: [f64; 2], up: bool| {
        let [u, v] = [DVec3::X * (2.0 * half[0]), DVec3::Z * (2.0 * half[1])];
        let corner = DVec3::new(x - half[0], y, -half[1]);
        if up { parallelogram(corner, v, u) } else { parallelogram(corner, u, v) }
    };
    let radiance = 2.0_f64;
    // Where a texture may vary the mirror, light samples do not find the lamp as well.
    for (what, mirror_half, is_textured) in [
        ("a mirror little larger than the lamp in it", 0.3, false),
        ("a larger mirror", 0.4, false),
        ("one with a texture", 0.3, true),
    ] {
        // The lamp shines upwards, at a mirror at 1; its image is at 1.5.
        let patch = rectangle(0.0, 0.0, [0.002, 0.002], true);
        let lamp = rectangle(1.2, 0.5, [0.2, 0.2], true);
        let reflector = rectangle(0.8, 1.0, [mirror_half; 2], false);
        let view = camera(DVec3::new(-0.3, 0.2, 0.1), DVec3::ZERO, 0.1);
        let mut desc = scene(
            view,
            vec![
                (patch, grey(0.5), None),
                (reflector, mirror(0.75), None),
                (lamp, BsdfDesc::Black, Some(Rgb::splat(radiance as f32))),
            ],
        );
        if is_textured {
            vary_by_nothing(&mut desc, 1, TextureKey::Color);
        }
        // Irradiance by the polygon's sides (Lambert 1760).
        let corners =
            [[1.0, -0.2], [1.0, 0.2], [1.4, 0.2], [1.4, -0.2]].map(|[x, z]| DVec3::new(x, 1.5, z).normalize());
        let side = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            a.angle_between(b) * a.cross(b).normalize().y
        };
        let irradiance = 0.75 * radiance * 0.5 * (0..4).map(side).sum::<f64>().abs();
        let found = measure(&build(&desc), &settings(case.count(64, 512)), case.count(16, 32), 1);
        case.mean(what, found, 0.5 / PI * irradiance, pick(case, 6e-3, 1.6e-3));
    }
}

/// The project's scenes: means over the picture, and over its upper left quarter.
fn against_paths(case: &mut Case) {
    let seeds = case.count(8, 16);
    let scenes = [
        ("cornell.json", 1e-2, 2.5e-3),
        ("colour-bleeding.json", 5e-3, 1.3e-3),
        ("room.json", 8e-3, 2e-3),
        ("materials.json", 1.2e-2, 3e-3),
        ("mirrors-and-glass.json", 2e-2, 5e-3),
        ("quadrics.json", 1e-2, 2.5e-3),
        ("smooth-mesh.json", 5e-3, 1.3e-3),
    ];
    for (name, quick, full) in scenes {
        let scene = build(&load(name));
        let desc = RenderDesc { resolution: [32, 32], ..settings(case.count(16, 512)) };
        let alone = RenderDesc { reuse: Some(false), samples: 2 * desc.samples, ..desc.clone() };
        let expected = measure(&scene, &alone, seeds, 1000);
        case.equal_means(name, measure(&scene, &desc, seeds, 1), expected, pick(case, quick, full));
    }
    // With a greatest depth, what is seen in a mirror has fewer bounces left, and must not have those of its neighbours: two mirrors that
    // show each other and then a dark corner.
    let crop = Some(CropDesc { left: 1, top: 3, width: 1, height: 1 });
    let dark = RenderDesc { crop, max_depth: Some(3), ..settings(case.count(64, 512)) };
    let (image, _) = render_scene(&build(&load("mirrors.json")), dark);
    case.exact("a pixel behind mirrors at its greatest depth", image.mean()[0], 0.0, Within::Absolute(0.0));
    // A lamp near a corner, by which most of its light comes.
    let mut desc =
        scene(camera(DVec3::new(0.0, 0.0, 0.9), DVec3::new(0.0, -0.5, -1.0), 80.0), vec![(MESH, grey(0.8), None)]);
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(0.9, 0.85, -0.8), 1.0));
    let scene = build(&desc);
    let desc = settings(case.count(64, 512));
    let alone = RenderDesc { reuse: Some(false), samples: 2 * desc.samples, ..desc.clone() };
    let expected = measure(&scene, &alone, seeds, 1000);
    let found = measure(&scene, &desc, seeds, 1);
    case.equal_means("a lamp in a corner", found, expected, pick(case, 1.5e-2, 4e-3));
}

/// Weights have to know how many light samples there were where a path comes from.
fn first_light_samples(case: &mut Case) {
    let (samples, tolerance) = (case.count(512, 8192) as u32, pick(case, 1e-3, 3e-4));
    for (what, lamp, exact) in [
        ("a large lamp", ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), 0.554126423980),
        ("a near lamp", ceiling([-5.0, 5.0], [-5.0, 5.0], 1e-2), 1.0 - 3.27323933e-6),
    ] {
        let scene = build(&lit(if what == "a near lamp" { 5e-3 } else { 0.5 }, 1e-3, vec![lamp]));
        for (first, shadow_rays) in [(4, 1), (1, 4), (3, 2)] {
            let first_shadow_rays = Some(first);
            let resolution = [8, 8];
            let desc =
                RenderDesc { resolution, samples, shadow_rays, first_shadow_rays, seed: 49, ..RenderDesc::default() };
            let found = pixels(&render_scene(&scene, desc).0);
            case.mean(format!("{what}, {first} first, then {shadow_rays}"), found, exact, tolerance);
        }
    }
    let (seeds, samples) = (case.count(8, 16), case.count(16, 512));
    for (name, quick, full) in
        [("room.json", 8e-3, 2e-3), ("mirrors-and-glass.json", 2e-2, 5e-3), ("smooth-mesh.json", 5e-3, 1.3e-3)]
    {
        let scene = build(&load(name));
        let desc = RenderDesc { resolution: [32, 32], ..settings(samples) };
        let alone = RenderDesc { reuse: Some(false), samples: 2 * desc.samples, ..desc.clone() };
        let expected = measure(&scene, &alone, seeds, 1000);
        for (reuse, first, shadow_rays) in [(false, 4, 1), (true, 4, 1), (true, 1, 2)] {
            let first_shadow_rays = Some(first);
            let desc = RenderDesc { reuse: Some(reuse), first_shadow_rays, shadow_rays, ..desc.clone() };
            let found = measure(&scene, &desc, seeds, 2000);
            let shared = if reuse { ", shared hits" } else { "" };
            let what = format!("{name}, {first} first, then {shadow_rays}{shared}");
            case.equal_means(what, found, expected, pick(case, quick, full));
        }
    }
}
