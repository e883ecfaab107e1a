//! Radiosity under skies, under the sun, and with points that shine unevenly.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use etendue::Cancel;
use etendue::bake::{Atlas, AtlasOptions, Bake, by_radiosity};
use etendue::desc::{
    DistantLightDesc, EnvironmentDesc, FormulaSkyDesc, IntegratorDesc, LightDistribution, PointLightDesc,
    RadiosityDesc, RadiositySolver, RenderDesc, SceneDesc, ShapeDesc, SkyDesc, SpotDesc,
};
use etendue::emitter::SkyFormula;
use etendue::integrator::Piece;
use etendue::integrator::radiosity::Radiosity;
use etendue::math::DVec3;
use etendue::render::RenderSettings;
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

use super::{build, solve};
use crate::common::scenes::{Job, camera, mean_and_error, render_scene, scene};
use crate::lights::polygon_factor;
use crate::lights::sky::received;
use crate::lights::webs::{EFFICACY, in_lamp, uneven, uneven_web, web_light};
use crate::record::{Case, Entry, Within};
use crate::transport::{MESH, ball, ball_mesh, grey, mesh, parallelogram, pick, turned};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "Q61", title: "under an even sky", run: even },
        Entry { id: "Q62", title: "under skies by formula", run: formulas },
        Entry { id: "Q63", title: "in the sun", run: sun },
        Entry { id: "Q64", title: "points that shine unevenly", run: points },
        Entry { id: "Q65", title: "room with a window", run: window },
    ]
}

/// A material that reflects next to nothing: black surfaces have no elements.
const DARK: f32 = 1e-5;

/// Surfaces that the camera does not see.
fn surfaces(list: Vec<(ShapeDesc, f32)>) -> SceneDesc {
    let view = camera(DVec3::new(0.0, 90.0, 0.0), DVec3::new(0.0, 99.0, 0.0), 30.0);
    scene(view, list.into_iter().map(|(shape, albedo)| (shape, grey(albedo), None)).collect())
}

/// A square floor around the origin whose normal is y.
fn floor(half: f64) -> ShapeDesc {
    parallelogram(DVec3::new(-half, 0.0, half), DVec3::X * (2.0 * half), DVec3::Z * (-2.0 * half))
}

/// The surfaces in a sky of radiance 1.
fn in_sky(mut desc: SceneDesc) -> SceneDesc {
    desc.set_environment(Some(Rgb::ONE)).expect("a sky of the test");
    desc
}

/// Power that a side of a surface gets, of one channel, and its area.
fn power(solution: &Radiosity, surface: u32, front: bool) -> [f64; 2] {
    let mesh = solution.mesh(Some(surface), front);
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let area = 0.5 * (b - a).cross(c - a).length();
        let mean = corners.map(|corner| f64::from(mesh.irradiance[corner as usize].g())).iter().sum::<f64>() / 3.0;
        [area * mean, area]
    };
    mesh.triangles.iter().map(of).fold([0.0; 2], |[power, area], of| [power + of[0], area + of[1]])
}

fn mean(solution: &Radiosity, surface: u32, front: bool) -> f64 {
    let [power, area] = power(solution, surface, front);
    power / area
}

fn solved(desc: &SceneDesc, error: f64) -> Radiosity {
    solve(&build(desc), &RadiosityDesc { error, ..RadiosityDesc::default() })
}

/// Of all values the farthest from 1.
fn farthest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(1.0, |worst: f64, value| if (value - 1.0).abs() > (worst - 1.0).abs() { value } else { worst })
}

fn even(case: &mut Case) {
    // What is convex reflects nothing onto itself.
    let desc = in_sky(surfaces(vec![(ball(DVec3::new(3.0, 9.0, 1.0), 1.5), 0.7)]));
    let solution = solved(&desc, 1.0);
    let lit = solution.mesh(None, true).irradiance;
    case.exact(
        "a ball, worst vertex",
        farthest(lit.iter().map(|e| f64::from(e.g()) / PI)),
        1.0,
        Within::Relative(1e-5),
    );
    let summary = solution.summary();
    let arrives = f64::from(summary.emitted.g()) / (PI * 4.0 * PI * 1.5 * 1.5);
    case.exact("a ball, power that arrives", arrives, 1.0, Within::Relative(1e-3));
    let solution = solved(&in_sky(surfaces(vec![(floor(1.0), 0.5)])), 1.0);
    for front in [true, false] {
        let lit = solution.mesh(None, front).irradiance;
        let what = format!("a floor, worst vertex, front {front}");
        case.exact(what, farthest(lit.iter().map(|e| f64::from(e.g()) / PI)), 1.0, Within::Relative(1e-5));
    }
    picture(case);
    bowl(case);
    pit(case);
}

/// What absorbs nothing cannot be seen, what absorbs half sends half, and behind it is the sky.
fn picture(case: &mut Case) {
    for (albedo, exact) in [(1.0, 1.0), (0.5, 0.5)] {
        for final_gather in [false, true] {
            // Of the ball alone, and of its surroundings.
            let of = |fov_deg: f64| {
                let view = camera(DVec3::new(0.0, 0.0, 6.0), DVec3::ZERO, fov_deg);
                let desc = in_sky(scene(view, vec![(ball(DVec3::ZERO, 1.0), grey(albedo), None)]));
                let mut settings = Job { samples: 64, integrator: IntegratorDesc::Radiosity, ..Job::default() }.desc();
                settings.radiosity.final_gather = final_gather;
                render_scene(&build(&desc), settings).0
            };
            let what = format!("picture of albedo {albedo}, final gather {final_gather}");
            case.biased_mean(format!("{what}, ball"), mean_and_error(&of(8.0)), exact, (1e-4, 1e-3));
            case.exact(format!("{what}, sky"), f64::from(of(60.0).rgb[0]), 1.0, Within::Relative(1e-5));
        }
    }
}

/// The lower half of a ball: every place sees the opening and the rest of the bowl by the same shares.
fn bowl(case: &mut Case) {
    let sectors = pick(case, 24, 48);
    let whole = ball_mesh(1.0, sectors / 2, sectors);
    let lower = |t: &&[u32; 3]| t.iter().all(|&vertex| whole.positions[vertex as usize].y < 1e-9);
    let triangles: Vec<[u32; 3]> = whole.triangles.iter().filter(lower).copied().collect();
    let area: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|vertex| whole.positions[vertex as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    let opening = 0.5 * f64::from(sectors) * (2.0 * PI / f64::from(sectors)).sin();
    let share = opening / area;
    for albedo in [DARK, 0.5, 0.8] {
        let mut desc = surfaces(vec![(MESH, albedo)]);
        desc.meshes.push(Arc::new(turned(mesh(whole.positions.clone(), triangles.clone()), DVec3::ZERO, true)));
        let solution = solved(&in_sky(desc), 1.0);
        let exact = PI * share / (1.0 - f64::from(albedo) * (1.0 - share));
        if pick(case, false, albedo == 0.8) {
            case.known(
                "each bounce in a bowl of 48 sectors gives half a percent too much, at a radiosityError of 1 and of 0.3, by what small \
                 neighbouring triangles send one another",
            );
        }
        case.exact(
            format!("bowl, albedo {albedo}, mean"),
            mean(&solution, 0, true) / exact,
            1.0,
            Within::Relative(5e-3),
        );
        case.exact(
            format!("bowl, albedo {albedo}, outside"),
            mean(&solution, 0, false) / PI,
            1.0,
            Within::Relative(1e-5),
        );
    }
}

/// The five sides of a cube that is open above, each an inward parallelogram: corner and two sides.
fn sides() -> [[DVec3; 3]; 5] {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    [[DVec3::ZERO, z, x], [DVec3::ZERO, x, y], [DVec3::ZERO, y, z], [x, z, y], [z, y, x]]
}

/// A cube that is open above against Lambert's closed form, and with reflection against equations of many squares.
fn pit(case: &mut Case) {
    let solution_of = |albedo: f32, error: f64, solver: RadiositySolver| {
        let list = sides().map(|[corner, u, v]| (parallelogram(corner, u, v), albedo));
        let scene = build(&in_sky(surfaces(list.to_vec())));
        solve(&scene, &RadiosityDesc { error, solver, ..RadiosityDesc::default() })
    };
    let error = pick(case, 1.0, 0.3);
    let opening = [DVec3::Y, DVec3::ONE - DVec3::Z, DVec3::ONE, DVec3::Y + DVec3::Z];
    let solution = solution_of(DARK, error, RadiositySolver::Gather);
    let summary = solution.summary();
    for [u, v] in [[0.5, 0.5], [0.1, 0.2], [0.93, 0.5]] {
        for (surface, [corner, side, other]) in (0..).zip(sides()) {
            let p = corner + u * side + v * other;
            let exact = PI * polygon_factor(p, side.cross(other), &opening);
            let (primitive, at) = if u > v { (0, [u - v, v]) } else { (1, [u, v - u]) };
            let found = solution.irradiance_on(surface, primitive, at.map(|w| w as f32), DVec3::ZERO, true);
            let found = found.map_or(f64::NAN, |e| f64::from(e.g()));
            case.exact(format!("pit, side {surface} at {u}, {v}"), found / PI, exact / PI, Within::Absolute(0.01));
        }
    }
    for (what, surface, exact) in [("floor", 0, 0.199_824_895_698), ("wall", 1, 0.200_043_776_075)] {
        let found = mean(&solution, surface, true) / PI;
        case.exact(format!("pit, {what}"), found / exact, 1.0, Within::Relative(pick(case, 8e-3, 4e-3)));
    }
    // What comes through the opening meets a side, and the outer sides get all of the sky.
    let inside = f64::from(summary.absorbed.g()) / PI - 5.0;
    case.exact("pit, elements of all sides", inside, 1.0, Within::Relative(3e-3));
    case.holds(
        "pit, error by samples that is told",
        "between 1e-4 and 2e-2",
        format!("{:.1e}", summary.sampling_error),
        (1e-4..2e-2).contains(&summary.sampling_error),
    );
    for albedo in [0.5, 0.9] {
        let exact = equations(&opening, f64::from(albedo), pick(case, 8, 14));
        for solver in [RadiositySolver::Gather, RadiositySolver::Shoot] {
            let solution = solution_of(albedo, error, solver);
            for (what, surface) in [("floor", 0_u32), ("wall", 1)] {
                let found = mean(&solution, surface, true);
                let what = format!("pit of albedo {albedo}, {what}, {solver:?}");
                case.exact(what, found / exact[surface as usize], 1.0, Within::Relative(6e-3));
            }
        }
    }
}

/// The mean irradiance of the sides of the pit, by squares of which each is as bright everywhere.
fn equations(opening: &[DVec3; 4], albedo: f64, n: u32) -> [f64; 5] {
    let h = 1.0 / f64::from(n);
    let mut squares = Vec::new();
    for [corner, u, v] in sides() {
        for i in 0..n * n {
            let at = corner + h * (f64::from(i % n) * u + f64::from(i / n) * v);
            squares.push((at, h * u, h * v, u.cross(v)));
        }
    }
    // Gauss's two points along each side.
    let g = 0.5 - 0.5 / 3_f64.sqrt();
    let mean = |&(at, u, v, n): &(DVec3, DVec3, DVec3, DVec3), polygon: &[DVec3]| {
        let places = [[g, g], [1.0 - g, g], [g, 1.0 - g], [1.0 - g, 1.0 - g]];
        places.iter().map(|[s, t]| polygon_factor(at + *s * u + *t * v, n, polygon)).sum::<f64>() / 4.0
    };
    let count = squares.len();
    let side = |k: usize| k / (n * n) as usize;
    let mut factors = vec![0.0; count * count];
    for (k, square) in squares.iter().enumerate() {
        for (l, &(at, u, v, _)) in squares.iter().enumerate() {
            if side(k) != side(l) {
                factors[k * count + l] = mean(square, &[at, at + u, at + u + v, at + v]);
            }
        }
    }
    let direct: Vec<f64> = squares.iter().map(|square| PI * mean(square, opening)).collect();
    let mut lit = direct.clone();
    for _ in 0..200 {
        let gathered = |k: usize| (0..count).map(|l| factors[k * count + l] * lit[l]).sum::<f64>();
        lit = (0..count).map(|k| direct[k] + albedo * gathered(k)).collect();
    }
    let mut means = [0.0; 5];
    (0..count).for_each(|k| means[side(k)] += lit[k] / f64::from(n * n));
    means
}

fn formulas(case: &mut Case) {
    let up_is_z = |d: DVec3| DVec3::new(d.x, d.z, -d.y);
    for number in pick(case, vec![1, 5, 12], (1..=15).collect()) {
        let sun = DVec3::new(0.6, 0.0, 0.8);
        let formula = SkyFormula::cie(number as u32).expect("a type");
        let sky = FormulaSkyDesc { ground: Rgb::splat(0.3), ..FormulaSkyDesc::new(formula, up_is_z(sun)) };
        let wall = parallelogram(DVec3::new(9.0, 5.0, 9.0), DVec3::new(0.6, 0.0, 0.8), DVec3::Y);
        let mut desc = surfaces(vec![(floor(1.0), 0.5), (wall, 0.5)]);
        let environment = EnvironmentDesc { sky: SkyDesc::Formula(sky), ..EnvironmentDesc::even(Rgb::splat(2.0)) };
        desc.set_environment_desc(Some(environment)).expect("a sky of the test");
        // One of the two is lit alone, so that neither reflects onto the other.
        for (what, surface, front, normal) in [
            ("floor", 0, true, DVec3::Y),
            ("below the floor", 0, false, DVec3::NEG_Y),
            ("wall", 1, true, DVec3::new(-0.8, 0.0, 0.6)),
        ] {
            let mut alone = desc.clone();
            alone.surfaces.remove(1 - surface);
            let solution = solved(&alone, 1.0);
            let back = |d: DVec3| DVec3::new(d.x, -d.z, d.y);
            let exact = 2.0 * received(number, sun, back(normal), 0.3);
            let found = mean(&solution, 0, front) / exact;
            case.exact(format!("type {number}, {what}"), found, 1.0, Within::Relative(4e-3));
        }
    }
}

fn sun(case: &mut Case) {
    let towards = DVec3::new(0.48, 0.8, 0.36);
    let light =
        |degrees: f64| DistantLightDesc { angle_deg: degrees, ..DistantLightDesc::parallel(towards, Rgb::splat(3.0)) };
    for degrees in [0.0, 0.533, 20.0] {
        let normal = DVec3::new(-0.6, 0.8, 0.0);
        let tilted = parallelogram(DVec3::ZERO, DVec3::Z, DVec3::new(0.8, 0.6, 0.0));
        let mut desc = surfaces(vec![(tilted, 0.5)]);
        desc.add_distant_light(light(degrees)).expect("a light of the test");
        let solution = solved(&desc, 1.0);
        let within = if degrees == 0.0 { 1e-5 } else { 1e-3 };
        let found = mean(&solution, 0, true) / (3.0 * normal.dot(towards));
        case.exact(format!("{degrees} degrees wide, tilted plane"), found, 1.0, Within::Relative(within));
        case.exact(format!("{degrees} degrees wide, its back"), mean(&solution, 0, false), 0.0, Within::Absolute(0.0));

        // Every direction casts a shadow of the plate's area onto the floor.
        let plate = parallelogram(DVec3::new(-0.53, 0.4, 0.47), DVec3::X, DVec3::NEG_Z);
        let mut desc = surfaces(vec![(floor(2.0), DARK), (plate, DARK)]);
        desc.add_distant_light(light(degrees)).expect("a light of the test");
        let scene = build(&desc);
        for solver in [RadiositySolver::Gather, RadiositySolver::Shoot] {
            let desc = RadiosityDesc { error: pick(case, 1.0, 0.3), solver, ..RadiosityDesc::default() };
            let solution = solve(&scene, &desc);
            // The plate takes as much as it keeps from the floor.
            let of_elements = 17.0 - f64::from(solution.summary().absorbed.g()) / (3.0 * towards.y);
            let what = format!("{degrees} degrees wide, area of a shadow, elements, {solver:?}");
            case.exact(what, of_elements, 1.0, Within::Relative(4e-3));
            let [power, area] = power(&solution, 0, true);
            let shadow = area - power / (3.0 * towards.y);
            let what = format!("{degrees} degrees wide, area of a shadow, vertices, {solver:?}");
            case.exact(what, shadow, 1.0, Within::Relative(0.02));
        }
    }
}

fn points(case: &mut Case) {
    // What elements get, and what vertices say.
    let total = |desc: &SceneDesc, error: f64| {
        let solution = solved(desc, error);
        [f64::from(solution.summary().absorbed.g()), power(&solution, 0, true)[0]]
    };
    let error = pick(case, 1.0, 0.3);
    // The whole beam falls onto the floor, narrow ones onto a small part of one element.
    for (outer_deg, inner_deg) in [(50.0, 10.0), (20.0, 20.0), (5.0, 3.0), (0.3, 0.3)] {
        let direction = DVec3::new(0.2, -1.0, 0.1);
        let spot = SpotDesc { direction, outer_deg, inner_deg };
        let cosine = |degrees: f64| degrees.to_radians().cos();
        let flux = 2.0 * PI * (1.0 - cosine(inner_deg) + (cosine(inner_deg) - cosine(outer_deg)) / 3.0);
        for height in [0.02, 0.5] {
            let mut desc = surfaces(vec![(floor(1.5), DARK)]);
            let place = DVec3::new(0.137, height, -0.212);
            let distribution = LightDistribution::Spot(spot);
            let lamp = PointLightDesc { distribution, ..PointLightDesc::even(place, Rgb::splat(7.0)) };
            desc.add_light_desc(lamp).expect("a light of the test");
            let what = format!("spot of {outer_deg} degrees at {height}, on a floor");
            let [elements, vertices] = total(&desc, error).map(|power| power / (7.0 * flux));
            case.exact(format!("{what}, elements"), elements, 1.0, Within::Relative(3e-3));
            // Vertices cannot tell of what is as small as an element.
            if outer_deg * height > 9.0 {
                case.exact(format!("{what}, vertices"), vertices, 1.0, Within::Relative(0.02));
            }
        }
    }
    // Half of a spot's light is cut off by an edge through its axis.
    let spot = SpotDesc { direction: DVec3::NEG_Y, outer_deg: 30.0, inner_deg: 20.0 };
    let plate = parallelogram(DVec3::new(0.0, 0.3, 2.0), DVec3::X * 2.0, DVec3::Z * -4.0);
    let mut desc = surfaces(vec![(floor(1.5), DARK), (plate, DARK)]);
    let distribution = LightDistribution::Spot(spot);
    desc.add_light_desc(PointLightDesc { distribution, ..PointLightDesc::even(DVec3::Y, Rgb::ONE) })
        .expect("a light of the test");
    let cosine = |degrees: f64| degrees.to_radians().cos();
    let half = PI * (1.0 - cosine(20.0) + (cosine(20.0) - cosine(30.0)) / 3.0);
    let [elements, vertices] = total(&desc, error).map(|power| power / half);
    case.exact("half a spot, on a floor and a plate, elements", elements, 2.0, Within::Relative(3e-3));
    case.exact("half a spot, on a floor, vertices", vertices, 1.0, Within::Relative(0.02));

    let (axis, c0) = (DVec3::new(-0.5, -1.0, 0.1), DVec3::new(1.0, 0.5, 0.1));
    for place in [DVec3::new(0.3, 0.9, -0.2), DVec3::new(-0.6, 0.05, 0.1)] {
        let irradiance = |p: DVec3| {
            let way = p - place;
            uneven(in_lamp(axis, c0, way.normalize())) / EFFICACY * -way.y / way.length().powi(3)
        };
        let steps = 800;
        let at = |k: u32| 3.0 * (f64::from(k) + 0.5) / f64::from(steps) - 1.5;
        let onto = |i: u32| irradiance(DVec3::new(at(i % steps), 0.0, at(i / steps)));
        let exact = (0..steps * steps).map(onto).sum::<f64>() * 9.0 / f64::from(steps * steps);
        let mut desc = surfaces(vec![(floor(1.5), DARK)]);
        desc.lights.push(web_light(place, axis, c0, uneven_web()));
        let solution = solved(&desc, error);
        let found = power(&solution, 0, true)[0];
        case.exact(format!("web at {:.2}, on a floor", place.y), found / exact, 1.0, Within::Relative(3e-3));
        if place.y > 0.5 {
            for p in [DVec3::new(-0.4, 0.0, 0.3), DVec3::new(0.8, 0.0, 0.9)] {
                let [u, v] = [(p.x + 1.5) / 3.0, (1.5 - p.z) / 3.0];
                let (primitive, at) = if u > v { (0, [u - v, v]) } else { (1, [u, v - u]) };
                let found = solution.irradiance_on(0, primitive, at.map(|w| w as f32), DVec3::ZERO, true);
                let found = found.map_or(f64::NAN, |e| f64::from(e.g()));
                case.exact(
                    format!("web at {:.2}, at {p}", place.y),
                    found / irradiance(p),
                    1.0,
                    Within::Relative(0.02),
                );
            }
        }
    }
}

/// A room with a window in one wall: floor, ceiling, three walls and the four parts of the fourth, normals inwards.
fn room() -> SceneDesc {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let whole = [
        ([DVec3::ZERO, 4.0 * z, 3.0 * x], 0.4),
        ([2.5 * y, 3.0 * x, 4.0 * z], 0.8),
        ([DVec3::ZERO, 3.0 * x, 2.5 * y], 0.6),
        ([DVec3::ZERO, 2.5 * y, 4.0 * z], 0.6),
        ([3.0 * x, 4.0 * z, 2.5 * y], 0.6),
    ];
    // Of the wall at z = 4, x from, x to, y from, y to.
    let around = [[0.0, 3.0, 0.0, 0.8], [0.0, 3.0, 2.2, 2.5], [0.0, 0.6, 0.8, 2.2], [2.4, 3.0, 0.8, 2.2]];
    let part = |[left, right, bottom, top]: [f64; 4]| {
        ([DVec3::new(left, bottom, 4.0), (top - bottom) * y, (right - left) * x], 0.6)
    };
    let all = whole.into_iter().chain(around.map(part));
    surfaces(all.map(|([corner, u, v], albedo)| (parallelogram(corner, u, v), albedo)).collect())
}

/// Means of the irradiance over each surface, from a light map.
fn means(atlas: &Atlas, irradiance: &[[f32; 3]]) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; atlas.surfaces().len()];
    for (site, value) in irradiance.iter().enumerate() {
        let pieces = atlas.sites().pieces(site);
        let facet = pieces[0].facet;
        let place = atlas.surfaces().iter().position(|it| it.triangles.contains(&facet)).expect("a surface has it");
        let sum = &mut sums[place];
        // Texels at borders hold parts of a texel. The two triangles of a side have the same area.
        let part = |piece: &Piece| {
            let [a, b, c] = piece.corners.map(|corner| corner.map(f64::from));
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        let area: f64 = pieces.iter().map(part).sum();
        *sum = [sum[0] + area * f64::from(value[1]), sum[1] + area];
    }
    sums.into_iter().map(|[sum, area]| sum / area).collect()
}

fn window(case: &mut Case) {
    type Light = (&'static str, fn(&mut SceneDesc));
    let lights: [Light; 2] = [
        ("sun and sky", |desc| {
            let towards = DVec3::new(0.2, 0.5, 0.8);
            let sun = DistantLightDesc { angle_deg: 0.533, ..DistantLightDesc::parallel(towards, Rgb::splat(3.0)) };
            desc.add_distant_light(sun).expect("a light of the test");
            desc.set_environment(Some(Rgb::ONE)).expect("a sky of the test");
        }),
        ("spot through the window", |desc| {
            let spot = SpotDesc { direction: DVec3::new(0.0, -0.4, -1.0), outer_deg: 25.0, inner_deg: 5.0 };
            let distribution = LightDistribution::Spot(spot);
            let lamp = PointLightDesc::even(DVec3::new(1.4, 2.5, 5.5), Rgb::splat(9.0));
            desc.add_light_desc(PointLightDesc { distribution, ..lamp }).expect("a light of the test");
        }),
    ];
    for (what, add) in lights {
        let mut desc = room();
        add(&mut desc);
        let scene = build(&desc);
        let options = AtlasOptions { resolution: Some(64), ..AtlasOptions::default() };
        let atlas = Atlas::new(&scene, &options, &Cancel::new()).expect("an atlas of the test");
        let paths = by_paths(case, &scene, &atlas);
        let mut settings = RenderSettings { threads: 2, ..RenderSettings::default() };
        settings.desc.radiosity.error = pick(case, 0.3, 0.1);
        let go = &mut |_| ControlFlow::Continue(());
        let (baked, solution) = by_radiosity(&scene, atlas.sites(), &settings, None, true, go).expect("it fits");
        let solved = means(&atlas, &baked.irradiance);
        for (surface, name) in ["floor", "ceiling", "back wall", "left wall", "right wall"].into_iter().enumerate() {
            let texels = format!("{what}, light map of the {name}");
            case.exact(texels, solved[surface] / paths[surface], 1.0, Within::Relative(0.01));
            let of_elements = mean(&solution, surface as u32, true);
            let elements = format!("{what}, elements of the {name}");
            case.exact(elements, of_elements / paths[surface], 1.0, Within::Relative(0.01));
        }
        let all = |means: &[f64]| means[0] * 12.0 + means[1] * 12.0 + means[2] * 7.5 + (means[3] + means[4]) * 10.0;
        case.exact(format!("{what}, all of the room"), all(&solved) / all(&paths), 1.0, Within::Relative(5e-3));
    }
}

fn by_paths(case: &Case, scene: &Scene, atlas: &Atlas) -> Vec<f64> {
    let desc = RenderDesc { samples: case.count(256, 4096) as u32, seed: 5, ..RenderDesc::default() };
    let settings = RenderSettings { desc, threads: 2, ..RenderSettings::default() };
    let mut bake = Bake::new(scene, atlas.sites(), settings, true).expect("settings of the test");
    bake.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    means(atlas, &bake.irradiance().irradiance)
}
