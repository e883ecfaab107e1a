//! Lamps as photons see them: irradiance from maps against closed forms, dark sides, and many lamps at once.

use std::f64::consts::PI;

use super::{build, fixed, map, runs, seeded, shot, unseen};
use crate::common::scenes::{add, box_inside, point_light};
use crate::lights::{polygon_factor, sphere_factor};
use crate::record::{Case, Entry, Within};
use crate::transport::{ball, grey, mesh, parallelogram, pick};
use etendue::desc::{BsdfDesc, KernelDesc, SceneDesc, ShapeDesc};
use etendue::integrator::photon::MapKind;
use etendue::math::{DVec3, Vec3};
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M42", title: "photons under lamps", run: factors },
        Entry { id: "M46", title: "dark sides of lamps", run: sides },
        Entry { id: "M47", title: "photons of many lamps", run: many },
    ]
}

/// A white receiver around the origin, facing up, and lamps of radiance 1; nothing else.
fn receiver(half: f64, lamps: Vec<ShapeDesc>) -> SceneDesc {
    let shape = parallelogram(DVec3::new(-half, 0.0, half), DVec3::X * (2.0 * half), DVec3::Z * (-2.0 * half));
    let mut surfaces = vec![(shape, grey(1.0), None)];
    surfaces.extend(lamps.into_iter().map(|lamp| (lamp, BsdfDesc::Black, Some(Rgb::ONE))));
    unseen(surfaces)
}

/// Configuration factor of a receiver at a point, facing up.
type Factor = Box<dyn Fn(DVec3) -> f64>;

/// Power that falls on upper sides.
fn facing_up(scene: &Scene, seed: u64, paths: u32) -> f64 {
    let photons = shot(scene, &seeded(seed), MapKind::Direct, paths).photons;
    photons.iter().filter(|photon| photon.normal.get().y > 0.5).map(|photon| f64::from(photon.power[0])).sum()
}

fn factors(case: &mut Case) {
    // Power on a small receiver over its area: no kernel in it. Off the middle of it to the second order of its size.
    let half = 0.1;
    let paths = case.count(1 << 16, 1 << 18) as u32;
    let above = |x: [f64; 2], z: [f64; 2], y: f64| {
        [(x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1])].map(|(x, z)| DVec3::new(x, y, z))
    };
    let square = above([-1.0, 1.0], [-1.0, 1.0], 1.0);
    let aside = above([0.5, 1.5], [0.2, 1.0], 0.8);
    let upright = [(0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)].map(|(y, z)| DVec3::new(-0.8, y, z));
    let mut lamps: Vec<(&str, ShapeDesc, Factor)> = Vec::new();
    for (name, polygon) in [("square above", square), ("rectangle aside", aside), ("upright square", upright)] {
        lamps.push((name, ShapeDesc::Quad(polygon), Box::new(move |p| polygon_factor(p, DVec3::Y, &polygon))));
    }
    for (name, centre, radius) in
        [("sphere above", DVec3::Y, 0.5), ("sphere aside, half below", DVec3::new(1.0, 0.0, 0.0), 0.5)]
    {
        let factor = move |p: DVec3| {
            let to = centre - p;
            sphere_factor(radius / to.length(), (to.y / to.length()).clamp(-1.0, 1.0).acos())
        };
        lamps.push((name, ball(centre, radius), Box::new(factor)));
    }
    for (name, lamp, factor) in lamps {
        let scene = build(&receiver(half, vec![lamp]));
        let found = runs(|seed| facing_up(&scene, seed, paths) / (4.0 * half * half));
        // Mean over the receiver, by midpoints.
        let steps = 16;
        let at = |i: i32| half * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
        let sum: f64 = (0..steps * steps).map(|i| factor(DVec3::new(at(i % steps), 0.0, at(i / steps)))).sum();
        let exact = PI * sum / f64::from(steps * steps);
        case.mean(name, found, exact, pick(case, 4e-2, 2e-2));
    }
    for distance in [1e-2, 1.0, 1e3] {
        let mut desc = receiver(half * distance, Vec::new());
        desc.lights.push(point_light(DVec3::new(0.6, 0.8, 0.0) * distance, (distance * distance) as f32));
        let scene = build(&desc);
        let area = (2.0 * half * distance).powi(2);
        let found = runs(|seed| facing_up(&scene, seed, paths) / area);
        // The mean of cos / d² over the receiver, by midpoints.
        let steps = 16;
        let at = |i: i32| half * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
        let one = |i: i32| {
            let to = DVec3::new(0.6 - at(i % steps), 0.8, at(i / steps));
            to.y / to.length().powi(3)
        };
        let exact = (0..steps * steps).map(one).sum::<f64>() / f64::from(steps * steps);
        case.mean(format!("point light, distance {distance}"), found, exact, pick(case, 4e-2, 2e-2));
    }
}

fn sides(case: &mut Case) {
    let paths = case.count(1 << 14, 1 << 20) as u32;
    let up = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| DVec3::new(x, 1.0, z));
    let block = || {
        let inwards = box_inside(DVec3::new(-0.5, 0.5, -0.5), DVec3::new(0.5, 1.5, 0.5));
        let triangles = inwards.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        mesh(inwards.positions, triangles)
    };
    for (name, shape) in [("triangle", ShapeDesc::Triangle([up[0], up[1], up[2]])), ("quad", ShapeDesc::Quad(up))] {
        // It shines up, away from the floor.
        let scene = build(&receiver(10.0, vec![shape]));
        let tally = shot(&scene, &seeded(1), MapKind::Global, paths).tally;
        case.never(format!("{name}: photons behind it"), tally.stored, tally.paths);
        case.exact(format!("{name}: escaped"), tally.escaped.x, tally.emitted.x, Within::Absolute(0.0));
    }
    for (name, is_ball) in [("sphere", true), ("mesh", false)] {
        // A diffuse ball inside it gets nothing, the floor some.
        let mut desc = unseen(vec![(ball(DVec3::Y, 0.2), grey(1.0), None)]);
        let shape = if is_ball { ball(DVec3::Y, 0.5) } else { ShapeDesc::Mesh { mesh: 0, smooth: false } };
        if !is_ball {
            desc.meshes.push(block().into());
        }
        add(&mut desc, 1, shape, grey(0.5), Some(Rgb::ONE));
        let scene = build(&desc);
        let tally = shot(&scene, &seeded(1), MapKind::Global, paths).tally;
        case.never(format!("{name}: photons inside it"), tally.stored, tally.paths);
    }
}

fn many(case: &mut Case) {
    let paths = case.count(1 << 15, 1 << 17) as u32;
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, z)| DVec3::new(x, 1.0, z));
    let exact = PI * polygon_factor(DVec3::ZERO, DVec3::Y, &square);
    let radius = 0.15;
    let under = |desc: &SceneDesc| {
        let scene = build(desc);
        runs(|seed| {
            let map = map(shot(&scene, &seeded(seed), MapKind::Direct, paths));
            fixed(&map, scene.to_scene(DVec3::ZERO), Vec3::Y, KernelDesc::Flat, radius)
        })
    };
    let tolerance = pick(case, 2e-2, 1e-2);
    let piece = |i: u16, side: u16| {
        let (step, x, z) = (2.0 / f64::from(side), f64::from(i % side), f64::from(i / side));
        parallelogram(DVec3::new(x * step - 1.0, 1.0, z * step - 1.0), DVec3::X * step, DVec3::Z * step)
    };
    let pieces = |side: u16| receiver(2.0, (0..side * side).map(|i| piece(i, side)).collect());
    for side in [1, 3, 32] {
        let found = under(&pieces(side));
        case.biased_mean(format!("{} pieces", side * side), found, exact, (2e-3, tolerance));
    }
    // One of a thousand is a million times as bright: all light of it, and none of it twice.
    let mut desc = pieces(32);
    desc.surfaces[500].emission = Some(Rgb::splat(1e6));
    let ShapeDesc::Quad(bright) = desc.surfaces[500].shape else { unreachable!("all are quads") };
    let strong = PI * 1e6 * polygon_factor(DVec3::ZERO, DVec3::Y, &bright);
    let rest = exact - PI * polygon_factor(DVec3::ZERO, DVec3::Y, &bright);
    // A disk of 0.15 under a small lamp at height 1, whose light falls off as the cosine's fourth power.
    case.biased_mean(
        "1024 pieces, one a million times as bright",
        under(&desc),
        strong + rest,
        (0.15 * 0.15, tolerance),
    );
}
