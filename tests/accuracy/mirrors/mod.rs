//! Lamps that light samples find in flat mirrors: what is known in closed form, and the same mirrors where light samples do not look.

use std::f64::consts::PI;

use etendue::desc::{
    BsdfDesc, ConductorDesc, DistantLightDesc, MicrofacetsDesc, RenderDesc, SceneDesc, ShapeDesc, TextureKey,
};
use etendue::math::{DAffine3, DVec3};
use etendue::spectrum::Rgb;

use crate::common::scenes::{box_inside, camera, scene};
use crate::light_paths::{
    Panel, build, equal_means, means, measure, mirrored_lamp_parts, mirrored_lamp_scene, rectangle, settings,
    vary_by_nothing,
};
use crate::record::{Case, Entry};
use crate::transport::{MESH, ball, grey, mirror, parallelogram, pick, plane, turned};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "F1", title: "a lamp in a flat mirror, in closed form", run: lamp_in_a_mirror },
        Entry { id: "F2", title: "a ball and the sun in a tilted mirror, in closed form", run: ball_and_sun },
        Entry { id: "F3", title: "a ball in a corner of two mirrors, in closed form", run: corner },
        Entry { id: "F4", title: "mirrors that light samples look into, and others", run: with_and_without },
    ]
}

fn paths(samples: u64) -> RenderDesc {
    RenderDesc { light_paths: Some(false), ..settings(samples) }
}

/// A floor whose only light is that of a lamp in a mirror.
fn lamp_in_a_mirror(case: &mut Case) {
    let expected = mirrored_lamp_parts();
    let desc = paths(case.count(128, 2048));
    let shared = RenderDesc { reuse: Some(true), ..desc.clone() };
    let ways = [
        ("paths by themselves", desc.clone(), 0.75),
        ("shared hits", shared.clone(), 0.75),
        ("beside light paths", RenderDesc { light_paths: Some(true), ..desc.clone() }, 0.75),
        ("shared hits beside light paths", RenderDesc { light_paths: Some(true), ..shared.clone() }, 0.75),
        ("three light samples at the first hit", RenderDesc { first_shadow_rays: Some(3), ..desc.clone() }, 0.75),
        ("three light samples, shared hits", RenderDesc { first_shadow_rays: Some(3), ..shared.clone() }, 0.75),
        ("wavelengths", RenderDesc { spectral: true, ..desc.clone() }, 0.75),
        ("a greatest depth", RenderDesc { max_depth: Some(3), ..shared }, 0.75),
        ("a dark mirror", desc, 0.2),
    ];
    for (what, desc, reflectance) in ways {
        let scene = build(&mirrored_lamp_scene(reflectance, Panel::Plain));
        let found = measure(&scene, &desc, case.count(16, 24), 1);
        means(case, what, found, expected.map(|expected| f64::from(reflectance) * expected), pick(case, 6e-3, 3e-3));
    }
}

/// The floor around the origin, before a tilted square mirror with sides of 2 `half`.
fn tilted(half: f64, mut bodies: Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)>) -> SceneDesc {
    bodies.push((rectangle(0.0, 0.0, [0.2, 0.2], true), grey(DARK), None));
    bodies.push((plane(MIDDLE, normal(), half), mirror(0.75), None));
    scene(camera(DVec3::new(0.0, 2.0, 0.4), DVec3::ZERO, 1e-4), bodies)
}

/// Albedo of a floor whose light does not come back to it.
const DARK: f32 = 1e-6;

/// A place of the mirror.
const MIDDLE: DVec3 = DVec3::new(1.75, 1.9, 0.0);

fn normal() -> DVec3 {
    DVec3::new(-0.96, -0.28, 0.0)
}

/// Lamps that are far enough away from the floor for their irradiance to be that of their middles.
fn ball_and_sun(case: &mut Case) {
    let image = |p: DVec3| p - 2.0 * (p - MIDDLE).dot(normal()) * normal();
    let turned = |w: DVec3| w - 2.0 * w.dot(normal()) * normal();
    // Irradiance by a ball of radiance 1 that is above the horizon.
    let by_ball = |p: DVec3, radius: f64| PI * radius * radius * p.y / p.length().powi(3);
    let (p, radius) = (DVec3::new(-1.0, 3.0, -0.9), 0.3);
    let lamp = |radiance: f32| (ball(p, radius), BsdfDesc::Black, Some(Rgb::splat(radiance)));
    let by_lamp = by_ball(p, radius) + 0.75 * by_ball(image(p), radius);
    let towards = DVec3::new(-0.95, 0.25, 0.1).normalize();
    let by_sun = towards.y + 0.75 * turned(towards).y;
    let mut sun = tilted(1.2, vec![]);
    let disk = DistantLightDesc {
        path: String::new(),
        towards,
        irradiance: Rgb::ONE,
        angle_deg: 6.0,
        visible: true,
        spectrum: None,
    };
    sun.add_distant_light(disk.clone()).expect("a light of the test");
    let mut both = tilted(1.2, vec![lamp(0.5)]);
    both.add_distant_light(disk).expect("a light of the test");
    // More lamps than are chosen by power alone.
    let row = (0..7).map(|i| DVec3::new(-1.0, 3.0, 0.9 - 0.3 * f64::from(i)));
    let by_row = row.clone().map(|p| by_ball(p, 0.1) + 0.75 * by_ball(image(p), 0.1)).sum();
    let many = row.map(|p| (ball(p, 0.1), BsdfDesc::Black, Some(Rgb::ONE))).collect();
    let scenes = [
        ("a ball", tilted(1.2, vec![lamp(1.0)]), by_lamp),
        ("a sun", sun, by_sun),
        ("both", both, 0.5 * by_lamp + by_sun),
        ("seven balls", tilted(1.2, many), by_row),
    ];
    for (name, desc, exact) in scenes {
        let scene = build(&desc);
        for reuse in [false, true] {
            let desc = RenderDesc { reuse: Some(reuse), ..paths(case.count(64, 1024)) };
            let found = measure(&scene, &desc, case.count(16, 24), 1);
            let what = format!("{name}{}", if reuse { ", shared hits" } else { "" });
            means(case, &what, found, [f64::from(DARK) / PI * exact; 5], pick(case, 4e-3, 2e-3));
        }
    }
    // Corners so far away are known to a few thousandths in single precision, and so is the mirror.
    let found = measure(&build(&tilted(2e4, vec![lamp(1.0)])), &paths(case.count(64, 1024)), case.count(16, 24), 1);
    let exact = f64::from(DARK) / PI * by_lamp;
    case.biased_mean("a ball in a mirror as large as a city", found[4], exact, (5e-4, pick(case, 4e-3, 2e-3)));
}

/// Two mirrors at a right angle show a ball three times, once by way of both: one half of it in one order and one in the other. The ball is so
/// large that bounces find it as well.
fn corner(case: &mut Case) {
    let (p, side, far, radius) = (DVec3::new(-1.0, 2.0, 1.0), 2.0, 60.0, 0.8_f64);
    let mut bodies = vec![
        (rectangle(0.0, 0.0, [0.2, 0.2], true), grey(DARK), None),
        (parallelogram(DVec3::new(side, -far, -side), 2.0 * far * DVec3::Y, far * DVec3::Z), mirror(0.75), None),
        (parallelogram(DVec3::new(side, -far, -side), -far * DVec3::X, 2.0 * far * DVec3::Y), mirror(0.5), None),
    ];
    bodies.push((ball(p, radius), BsdfDesc::Black, Some(Rgb::ONE)));
    let (in_x, in_z) = (2.0 * side - p.x, -2.0 * side - p.z);
    let images = [
        (p, 1.0),
        (DVec3::new(in_x, p.y, p.z), 0.75),
        (DVec3::new(p.x, p.y, in_z), 0.5),
        (DVec3::new(in_x, p.y, in_z), 0.375),
    ];
    let by_ball = |p: DVec3| PI * radius * radius * p.y / p.length().powi(3);
    let exact: f64 = images.into_iter().map(|(image, reflectance)| reflectance * by_ball(image)).sum();
    let scene = build(&scene(camera(DVec3::new(0.0, 2.0, 0.4), DVec3::ZERO, 1e-4), bodies));
    for (what, reuse) in [("paths by themselves", false), ("shared hits", true)] {
        let desc = RenderDesc { reuse: Some(reuse), ..paths(case.count(64, 1024)) };
        let found = measure(&scene, &desc, case.count(16, 24), 1);
        means(case, what, found, [f64::from(DARK) / PI * exact; 5], pick(case, 6e-3, 3e-3));
    }
}

/// A room with two mirrors in a corner, in which light samples look for lamps or do not.
fn room(panel: Panel, floor: BsdfDesc) -> SceneDesc {
    let view = camera(DVec3::new(-0.6, 0.1, 0.8), DVec3::new(0.2, -0.3, -0.4), 70.0);
    let walls = [
        (DVec3::new(-1.0, 0.0, 0.0), DVec3::X),
        (DVec3::new(0.0, 1.0, 0.0), -DVec3::Y),
        (DVec3::new(0.0, 0.0, 1.0), -DVec3::Z),
    ];
    let mut bodies = vec![(plane(-DVec3::Y, DVec3::Y, 1.0), floor, None)];
    bodies.extend(walls.map(|(middle, normal)| (plane(middle, normal, 1.0), grey(0.6), None)));
    let lamps = [(-0.5, 0.99, 0.1), (0.4, 0.99, 0.5), (0.2, 0.99, -0.6)];
    bodies.extend(lamps.map(|(x, y, z)| {
        (parallelogram(DVec3::new(x, y, z), 0.2 * DVec3::X, 0.3 * DVec3::Z), grey(0.3), Some(Rgb::new(4.0, 3.0, 2.0)))
    }));
    bodies.push((ball(DVec3::new(-0.3, -0.8, -0.2), 0.2), BsdfDesc::Black, Some(Rgb::ONE)));
    bodies.push((ball(DVec3::new(0.4, -0.7, 0.2), 0.3), mirror(0.8), None));
    // More planes than light samples look into, of which some are parallel.
    let box_of_mirrors = turned(box_inside(DVec3::splat(-0.15), DVec3::splat(0.15)), DVec3::ZERO, false);
    bodies.push((MESH, mirror(0.9), None));
    let first = bodies.len();
    bodies.push((plane(DVec3::X, -DVec3::X, 1.0), mirror(0.9), None));
    bodies.push((plane(-DVec3::Z, DVec3::Z, 1.0), metal(0.0), None));
    let mut desc = scene(view, bodies);
    desc.meshes.push(box_of_mirrors.into());
    desc.surfaces.get_mut(first - 1).expect("the box").transform =
        DAffine3::from_translation(DVec3::new(0.5, -0.85, -0.5)) * DAffine3::from_rotation_y(0.4);
    if panel == Panel::Textured {
        vary_by_nothing(&mut desc, first - 1, TextureKey::Color);
        vary_by_nothing(&mut desc, first, TextureKey::Color);
        vary_by_nothing(&mut desc, first + 1, TextureKey::Reflectance);
    }
    desc
}

fn metal(roughness: f32) -> BsdfDesc {
    BsdfDesc::Conductor {
        conductor: ConductorDesc::Reflectance { normal: Rgb::new(0.9, 0.6, 0.3), edge: Rgb::ONE },
        microfacets: MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() },
    }
}

fn with_and_without(case: &mut Case) {
    let desc = RenderDesc { resolution: [16, 16], ..paths(case.count(80, 256)) };
    let seeds = case.count(8, 12);
    let coat = BsdfDesc::CoatedDiffuse {
        albedo: Rgb::splat(0.5),
        ior: 1.5,
        exterior_ior: 1.0,
        microfacets: MicrofacetsDesc::default(),
    };
    let floors = [("a matte floor", grey(0.5)), ("a glossy floor", metal(0.4)), ("a coated floor", coat)];
    for (name, floor) in floors {
        let [with, without] = [Panel::Plain, Panel::Textured].map(|panel| build(&room(panel, floor)));
        let mut ways = vec![
            ("", desc.clone()),
            (", up to three hits", RenderDesc { max_depth: Some(3), ..desc.clone() }),
            (", up to four hits", RenderDesc { max_depth: Some(4), ..desc.clone() }),
        ];
        if case.is_full() {
            let light_paths = RenderDesc { light_paths: Some(true), first_shadow_rays: Some(2), ..desc.clone() };
            ways.push((", beside light paths", light_paths));
            ways.push((", wavelengths", RenderDesc { spectral: true, ..desc.clone() }));
        }
        for (way, desc) in ways {
            let expected = measure(&without, &RenderDesc { reuse: Some(!desc.spectral), ..desc.clone() }, seeds, 1000);
            for reuse in [false, true] {
                if reuse && desc.spectral {
                    continue;
                }
                let found = measure(&with, &RenderDesc { reuse: Some(reuse), ..desc.clone() }, seeds, 1);
                let what = format!("{name}{way}{}", if reuse { ", shared hits" } else { "" });
                equal_means(case, &what, found, expected, pick(case, 3e-2, 2e-2));
            }
        }
    }
}
