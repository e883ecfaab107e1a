//! Estimates beside edges, in corners and at thin walls: no dark seams, no leaks.

use super::{METHODS, RUNS, add_mesh, build, grey_mean, images, method, over};
use crate::common::scenes::{add, box_inside, camera, scene};
use crate::record::{Case, Entry};
use crate::transport::{ball, grey, mirror, parallelogram, pick};
use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M64e", title: "corners of an emitting room", run: corners },
        Entry { id: "M64f", title: "leaks through thin walls", run: leaks },
    ]
}

const MIN: DVec3 = DVec3::new(-1.0, -0.8, -1.5);
const MAX: DVec3 = DVec3::new(1.2, 1.0, 0.9);
const EYE: DVec3 = DVec3::new(0.3, -0.2, 0.1);
const TARGET: DVec3 = DVec3::new(-1.0, -0.8, -1.5);

/// The room of the furnaces, with a mirror ball that makes caustics of its light, seen towards a corner.
fn furnace(albedo: f32) -> SceneDesc {
    let object = (ball(DVec3::new(0.6, 0.5, -1.0), 0.3), mirror(1.0), None);
    let mut desc = scene(camera(EYE, TARGET, 70.0), vec![object]);
    add_mesh(&mut desc, box_inside(MIN, MAX), grey(albedo), Some(Rgb::ONE));
    desc
}

/// For each pixel of a square image, how far from the nearest edge of the room its middle is.
fn distances(side: u32) -> Vec<f64> {
    let forward = (TARGET - EYE).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let half = 35.0_f64.to_radians().tan();
    (0..side * side)
        .map(|i| {
            let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.0;
            let direction = forward + half * (at(i % side) * right - at(i / side) * up);
            let to_wall = |axis: usize| {
                let wall = if direction[axis] > 0.0 { MAX[axis] } else { MIN[axis] };
                (wall - EYE[axis]) / direction[axis]
            };
            let p = EYE + direction * (0..3).map(to_wall).fold(f64::INFINITY, f64::min);
            let mut gaps = [0, 1, 2].map(|axis| (p[axis] - MIN[axis]).min(MAX[axis] - p[axis]));
            gaps.sort_by(f64::total_cmp);
            // The nearest wall is that which the point is on.
            gaps[1]
        })
        .collect()
}

/// Mean of the pixels for which this holds.
fn part(image: &Image, wanted: &[bool]) -> f64 {
    let pixels = image.rgb.chunks_exact(3).zip(wanted).filter(|(_, wanted)| **wanted);
    let values: Vec<f64> = pixels.map(|(rgb, _)| f64::from(rgb[0])).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

fn corners(case: &mut Case) {
    let side = 32;
    let radius = pick(case, 0.3, 0.2);
    let distances = distances(side);
    let near: Vec<bool> = distances.iter().map(|d| *d < radius).collect();
    let middle: Vec<bool> = distances.iter().map(|d| *d > 2.0 * radius).collect();
    assert!(near.iter().filter(|near| **near).count() > 100 && middle.iter().filter(|far| **far).count() > 100);
    let runs = RUNS / 2;
    for albedo in pick(case, &[0.5_f32][..], &[0.5, 0.9]) {
        let scene = build(&furnace(*albedo));
        let exact = 1.0 / (1.0 - f64::from(*albedo));
        for integrator in METHODS {
            let paths = case.count(1 << 12, 1 << 14) as u32;
            let desc = method(integrator, side, case.count(4, 16) as u32, (paths, radius));
            let found = images(&scene, &desc, runs);
            let tolerance = pick(case, 1e-2, 6e-3);
            let what = format!("albedo {albedo}, {}", integrator.name());
            case.mean(
                format!("{what}: within a radius of an edge"),
                over(&found, |i| part(i, &near)),
                exact,
                tolerance,
            );
            case.mean(format!("{what}: away from edges"), over(&found, |i| part(i, &middle)), exact, tolerance);
        }
    }
}

/// A room in two halves, one of which is lit; the wall between them is two sheets this far apart, with a hole or without.
fn halves(gap: f64, open: bool) -> SceneDesc {
    let (min, max) = (DVec3::splat(-1.0), DVec3::splat(1.0));
    let mut desc = scene(camera(DVec3::new(-0.8, 0.3, 0.6), DVec3::new(0.0, -0.7, -0.2), 80.0), Vec::new());
    add_mesh(&mut desc, box_inside(min, max), grey(0.7), None);
    // The hole is above; the sheets reach into the walls.
    let (low, high) = (-1.1, if open { 0.6 } else { 1.1 });
    for (x, flip) in [(0.5 * gap, false), (-0.5 * gap, true)] {
        let (u, v) = (DVec3::Y * (high - low), DVec3::Z * 2.2);
        let (u, v) = if flip { (v, u) } else { (u, v) };
        let number = desc.surfaces.len();
        add(&mut desc, number, parallelogram(DVec3::new(x, low, -1.1), u, v), grey(0.7), None);
    }
    let lamp = parallelogram(DVec3::new(0.3, 0.98, -0.3), DVec3::X * 0.6, DVec3::Z * 0.6);
    let number = desc.surfaces.len();
    add(&mut desc, number, lamp, BsdfDesc::Black, Some(Rgb::splat(5.0)));
    // Something to make caustics, against the wall.
    let ball: ShapeDesc = ball(DVec3::new(0.3, -0.6, 0.0), 0.25);
    add(&mut desc, number + 1, ball, mirror(0.9), None);
    desc
}

fn leaks(case: &mut Case) {
    let radius = pick(case, 0.2, 0.15);
    let paths = case.count(1 << 14, 1 << 15) as u32;
    for gap in [2e-3, 2e-4] {
        let scene = build(&halves(gap, false));
        for integrator in METHODS {
            for neighbours in [None, Some(50)] {
                let mut desc = method(integrator, 48, case.count(4, 8) as u32, (paths, radius));
                desc.photons.neighbours = neighbours;
                let image = &images(&scene, &desc, 1)[0];
                let lit = image.rgb.iter().filter(|value| **value != 0.0).count() as u64;
                let how = neighbours.map_or(String::new(), |k| format!(", {k} nearest"));
                let what = format!("wall of {:e} room widths, {}{how}: dark side lit", gap / 2.0, integrator.name());
                case.never(what, lit, image.rgb.len() as u64);
            }
        }
    }
    // With a hole in the wall above, the dark side is as bright as paths say, the floor beside the wall too.
    let scene = build(&halves(2e-3, true));
    let half = |image: &Image| {
        // Of the image, which shows the floor along the wall below.
        let rows = image.rgb.len() / 2;
        image.rgb[rows..].iter().map(|value| f64::from(*value)).sum::<f64>() / rows as f64
    };
    let samples = case.count(8, 32) as u32;
    let runs = RUNS / 2;
    let path = images(&scene, &method(IntegratorDesc::Path, 32, 4 * samples, (1, radius)), runs);
    for integrator in METHODS {
        let paths = case.count(1 << 12, 1 << 14) as u32;
        let found = images(&scene, &method(integrator, 32, samples, (paths, radius)), runs);
        let tolerance = pick(case, 2e-2, 1e-2);
        let (a, b) = (over(&found, half), over(&path, half));
        // The light falls off over the size of the room: at a tenth of it, by less than a hundredth within a disk.
        let what = format!("wall with a hole, {}: floor beside it", integrator.name());
        case.biased_mean(what, (a.0, a.1.hypot(b.1)), b.0, (1e-2, tolerance));
        let (a, b) = (over(&found, grey_mean), over(&path, grey_mean));
        let what = format!("wall with a hole, {}: dark side", integrator.name());
        case.biased_mean(what, (a.0, a.1.hypot(b.1)), b.0, (5e-3, tolerance));
    }
}
