//! Radiosity: form factors and solutions where they are known, what it does with what it cannot do, and that nothing depends
//! on threads.

mod common;

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::sync::Arc;

use common::scenes::{add, box_inside, camera, point_light};
use etendue::desc::{
    BsdfDesc, DistantLightDesc, IntegratorDesc, LightDistribution, MaterialDesc, MeshDesc, PointLightDesc,
    RadiosityDesc, RadiositySolver, RenderDesc, SceneDesc, ShapeDesc, SpotDesc,
};
use etendue::integrator::radiosity::Radiosity;
use etendue::integrator::radiosity::form_factor::{point_to_polygon, polygon_to_polygon};
use etendue::math::{Bounds, DVec3, Ray};
use etendue::render::{Render, RenderSettings};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Alone, Cancel, ErrorKind};

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).unwrap()
}

fn solve(desc: &SceneDesc, radiosity: &RadiosityDesc) -> Radiosity {
    let solution = Radiosity::solve(&build(desc), radiosity, &mut Alone::default()).unwrap();
    println!("{}", solution.notes().join("\n"));
    solution
}

fn lambert(albedo: f32) -> BsdfDesc {
    BsdfDesc::Lambert { albedo: Rgb::splat(albedo) }
}

/// A mesh of one material that emits, alone.
fn furnace(mesh: MeshDesc, albedo: f32, emission: Option<f32>) -> SceneDesc {
    let mut desc = SceneDesc { camera: camera(DVec3::ZERO, DVec3::X, 60.0), ..SceneDesc::default() };
    desc.meshes.push(Arc::new(mesh));
    add(&mut desc, 0, ShapeDesc::Mesh { mesh: 0, smooth: false }, lambert(albedo), emission.map(Rgb::splat));
    desc
}

// Form factors.

fn quad(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> [DVec3; 4] {
    let [corner, u, v] = [corner, u, v].map(DVec3::from_array);
    [corner, corner + u, corner + u + v, corner + v]
}

fn polygon_area(corners: &[DVec3]) -> f64 {
    let sum: DVec3 = (1..corners.len() - 1).map(|i| (corners[i] - corners[0]).cross(corners[i + 1] - corners[0])).sum();
    0.5 * sum.length()
}

#[test]
fn form_factors_of_the_catalogue() {
    let floor = |x: f64, y: f64| quad([0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0]);
    let ceiling = |x: f64, y: f64, z: f64| quad([0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0]);
    // Stands on the floor's edge x = 0 and looks along x.
    let wall = |y: f64, z: f64| quad([0.0; 3], [0.0, y, 0.0], [0.0, 0.0, z]);
    // Sides of a groove of 60 degrees: a piece of one and all of the other, ten thousand times as long.
    let up = [0.5, 0.0, 0.75_f64.sqrt()];
    let cases = [
        (floor(1.0, 1.0), ceiling(1.0, 1.0, 1.0), 0.199_824_895_698_387_4),
        (floor(1.0, 1.0), wall(1.0, 1.0), 0.200_043_776_075_403_2),
        (floor(1.0, 1.0), ceiling(1.0, 1.0, 0.1), 0.826_994_522_397),
        (floor(1.0, 1.0), ceiling(1.0, 1.0, 10.0), 0.003_162_056_838_76),
        (floor(2.0, 1.0), ceiling(2.0, 1.0, 0.5), 0.508_988_669_041),
        (floor(1.0, 1.0), wall(1.0, 2.0), 0.232_852_602_795),
        (floor(2.0, 1.0), wall(1.0, 1.0), 0.116_426_301_398),
        (floor(1.0, 1.0), quad([0.0, -5000.0, 0.0], [0.0, 1e4, 0.0], up), 0.5),
    ];
    for (i, (from, to, expected)) in cases.into_iter().enumerate() {
        let factor = polygon_to_polygon(&from, &to, 1e-7);
        assert!((factor - expected).abs() < 1e-5, "case {i}: {factor} and not {expected}");
        let reverse = polygon_to_polygon(&to, &from, 1e-9);
        let exchange = [polygon_area(&from) * factor, polygon_area(&to) * reverse];
        assert!((exchange[0] - exchange[1]).abs() < 1e-5 * exchange[0].max(0.1), "case {i} reversed: {exchange:?}");
    }
    let closure = 4.0 * polygon_to_polygon(&floor(1.0, 1.0), &wall(1.0, 1.0), 1e-7)
        + polygon_to_polygon(&floor(1.0, 1.0), &ceiling(1.0, 1.0, 1.0), 1e-7);
    assert!((closure - 1.0).abs() < 1e-5, "{closure}");
}

/// Discs, as polygons of the same area: off by the square of the step, 1e-5 here.
#[test]
fn form_factors_of_discs() {
    const SIDES: u32 = 256;
    let disc = |radius: f64, z: f64, turns: f64| -> Vec<DVec3> {
        let step = TAU / f64::from(SIDES);
        let reach = radius * (step / step.sin()).sqrt();
        let at = |i: u32| {
            let angle = turns * step * f64::from(i);
            DVec3::new(reach * angle.cos(), reach * angle.sin(), z)
        };
        (0..SIDES).map(at).collect()
    };
    for (radius, height, expected) in [(1.0, 1.0, 0.381_966_011_250), (2.0, 1.5, 0.601_653_344_388)] {
        let factor = polygon_to_polygon(&disc(1.0, 0.0, 1.0), &disc(radius, height, -1.0), 1e-6);
        assert!((factor - expected).abs() < 2e-5, "{factor} and not {expected}");
    }
}

/// From any point, over all directions: the sides of a tetrahedron, as narrow as can be, sum to 1.
#[test]
fn a_point_sees_all_of_what_is_around_it() {
    let mut rng = Rng::new(5, 7);
    let mut random = || DVec3::from_array(std::array::from_fn(|_| f64::from(rng.next_f32()) - 0.5));
    for case in 0..2000 {
        let flat = 10.0_f64.powi(-(case % 4));
        let corners: [DVec3; 4] = std::array::from_fn(|_| random() * DVec3::new(1.0, 1.0, flat));
        let volume = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]).abs();
        if volume < 1e-3 * flat {
            continue;
        }
        // Close to a side, to an edge, to a corner, or anywhere.
        let mut weights = (random() + 0.5).to_array();
        for weight in weights.iter_mut().take(case as usize % 4) {
            *weight *= 1e-4;
        }
        let total = 1.0 + weights.iter().sum::<f64>();
        let p = (corners[0] + (0..3).map(|i| weights[i] * corners[i + 1]).sum::<DVec3>()) / total;
        let n = random().normalize();
        let sum: f64 = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]
            .iter()
            .map(|side| point_to_polygon(p, n, &side.map(|i| corners[i])))
            .sum();
        assert!((sum - 1.0).abs() < 1e-6, "{case}: {sum} at {p} in {corners:?}");
    }
}

#[test]
fn polygons_without_area_see_nothing() {
    let square = quad([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let line = [DVec3::Z, DVec3::Z + DVec3::X, DVec3::Z + 2.0 * DVec3::X];
    assert_eq!(polygon_to_polygon(&square, &line, 1e-6), 0.0);
    assert_eq!(polygon_to_polygon(&line, &square, 1e-6), 0.0);
    assert_eq!(polygon_to_polygon(&[], &square, 1e-6), 0.0);
    assert_eq!(point_to_polygon(DVec3::ZERO, DVec3::Z, &[]), 0.0);
    // Behind.
    assert_eq!(point_to_polygon(DVec3::Z, DVec3::Z, &square), 0.0);
    assert_eq!(polygon_to_polygon(&square, &square, 1e-6), 0.0);
}

// Rooms with known light: docs/accuracy.md has more of them.

/// A tessellated unit sphere, seen from inside: `rings` from pole to pole.
fn sphere_inside(rings: u32, radius: f64) -> MeshDesc {
    let columns = 2 * rings;
    let at = |i: u32, j: u32| {
        let (sin, cos) = (PI * f64::from(i) / f64::from(rings)).sin_cos();
        let (y, x) = (TAU * f64::from(j % columns) / f64::from(columns)).sin_cos();
        radius * DVec3::new(sin * x, sin * y, cos)
    };
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..columns {
            let first = positions.len() as u32;
            positions.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            if i > 0 {
                triangles.push([first, first + 3, first + 2]);
            }
            if i + 1 < rings {
                triangles.push([first, first + 2, first + 1]);
            }
        }
    }
    // Normals inwards.
    for triangle in &mut triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        if (b - a).cross(c - a).dot(a + b + c) > 0.0 {
            triangle.swap(1, 2);
        }
    }
    MeshDesc { name: "sphere".into(), positions, triangles, ..MeshDesc::default() }
}

/// In an empty room all that a point light sends is absorbed.
#[test]
fn power_in_an_empty_room() {
    for (albedo, tolerance) in [(1e-4, 1e-5), (0.6, 1e-3)] {
        let mut desc = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), albedo, None);
        desc.lights.push(point_light(DVec3::new(0.3, 0.2, 0.4), 2.0));
        let solution = solve(&desc, &RadiosityDesc { error: 0.6, ..RadiosityDesc::default() });
        let summary = solution.summary();
        let balance = f64::from(summary.absorbed.r() / summary.emitted.r());
        println!("albedo {albedo}: absorbed {balance}");
        assert!((balance - 1.0).abs() < tolerance, "{albedo}: {balance}");
    }
}

/// Case 56: L = rho E / pi + rho^2 Phi / (4 pi^2 R^2 (1 - rho)) at any place of a sphere with a point light inside, as
/// irradiance: E + rho Phi / (4 pi R^2 (1 - rho)). In directions spread evenly: the relative error's mean, root mean square and largest
/// value. The area of the triangles is 0.25 % below that of the ball with 36 rings, and so its light is brighter.
#[test]
fn integrating_sphere() {
    let (radius, albedo, intensity, light) = (2.0, 0.7, 5.0, DVec3::new(0.8, 0.0, 0.0));
    let mut errors = Vec::new();
    for rings in [12, 36] {
        let mut desc = furnace(sphere_inside(rings, radius), albedo as f32, None);
        desc.lights.push(point_light(light, intensity as f32));
        let settings = RadiosityDesc { element_size: Some(10.0), error: 1.0, ..RadiosityDesc::default() };
        let solution = solve(&desc, &settings);
        let scene = build(&desc);
        let mut found = Vec::new();
        for k in 0..400 {
            let (z, phi) = (1.0 - (2.0 * f64::from(k) + 1.0) / 400.0, 2.399_963 * f64::from(k));
            let r = (1.0 - z * z).sqrt();
            let p = radius * DVec3::new(r * phi.cos(), r * phi.sin(), z);
            let ray = Ray::new(scene.to_scene(DVec3::ZERO), (p / radius).as_vec3a());
            let hit = scene.intersect(&ray).unwrap();
            let at = scene.interaction(&ray, &hit);
            let e = f64::from(solution.irradiance(&hit, at.point.p, true).r());
            let to_light = light - p;
            let direct = intensity * to_light.dot(-p).abs() / (radius * to_light.length().powi(3));
            let expected = direct + albedo * 4.0 * PI * intensity / (4.0 * PI * radius * radius * (1.0 - albedo));
            found.push(e / expected - 1.0);
        }
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        let root = (found.iter().map(|error| error * error).sum::<f64>() / found.len() as f64).sqrt();
        let worst = found.iter().fold(0.0, |worst: f64, error| worst.max(error.abs()));
        println!("{rings} rings: mean {mean:.5}, root mean square {root:.5}, worst {worst:.5}");
        errors.push([mean, root, worst]);
    }
    // 2 * 36 * 72 triangles are 5000, less those at the poles.
    let [coarse, fine] = [errors[0], errors[1]];
    assert!((fine[0] - 0.0025).abs() < 0.001 && fine[1] < 0.01 && fine[2] < 0.04, "{errors:?}");
    assert!(fine[1] < 0.6 * coarse[1], "{errors:?}");
}

/// Inside a ball every point sees the whole ball equally, so that light that was reflected is the same everywhere:
/// E = I rho / (r^2 (1 - rho)) for a point light of intensity I. The solution has large and small elements beside each other.
#[test]
fn a_ball_loses_no_light() {
    for (albedo, light) in [(0.8, DVec3::ZERO), (0.97, DVec3::new(0.3, 0.2, 0.1))] {
        let mut desc = SceneDesc { camera: camera(DVec3::ZERO, DVec3::X, 60.0), ..SceneDesc::default() };
        add(&mut desc, 0, ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 }, lambert(albedo as f32), None);
        desc.lights.push(point_light(light, 1.0));
        let solution = solve(&desc, &RadiosityDesc { element_size: Some(0.2), ..RadiosityDesc::default() });
        let lost = solution.summary().lost().unwrap();
        assert!(lost.abs() < 5e-3, "albedo {albedo}, light at {light}: {lost} is lost");
        let scene = build(&desc);
        let reflected = albedo / (1.0 - albedo);
        // All around, in directions spread evenly.
        for k in 0..50 {
            let (z, phi) = (1.0 - (2.0 * f64::from(k) + 1.0) / 50.0, 2.399_963 * f64::from(k));
            let r = (1.0 - z * z).sqrt();
            let direction = DVec3::new(r * phi.cos(), r * phi.sin(), z);
            let hit = scene.intersect(&Ray::new(etendue::math::Vec3::ZERO, direction.as_vec3a())).unwrap();
            let way = light - direction;
            let direct = way.dot(-direction) / way.length().powi(3);
            let found = f64::from(solution.irradiance(&hit, direction.as_vec3a(), false).r()) - direct;
            let error = found / reflected - 1.0;
            assert!(error.abs() < 0.04, "albedo {albedo}, light at {light}, towards {direction}: {error}");
        }
    }
}

/// Closed rooms of so many triangles that clusters take part, whose links by themselves lose a tenth of the light. The box has outer sides
/// that nothing lights.
#[test]
fn rooms_of_many_triangles_lose_no_light() {
    let mut ellipsoid = sphere_inside(18, 1.0);
    ellipsoid.positions.iter_mut().for_each(|p| *p *= DVec3::new(2.0, 1.0, 0.7));
    for (name, mesh, albedo) in [("ellipsoid", ellipsoid, 0.97), ("box", box_of_squares(15), 0.8)] {
        let mut desc = furnace(mesh, albedo, None);
        desc.lights.push(point_light(DVec3::new(0.1, 0.2, 0.15), 10.0));
        let solution = solve(&desc, &RadiosityDesc { error: 2.0, ..RadiosityDesc::default() });
        let lost = solution.summary().lost().unwrap();
        println!("{name}: {lost}");
        assert!(lost.abs() < 0.01, "{name}: {lost} is lost");
    }
}

/// A dark room of many triangles: what dark walls would bring is left out, and the lamp does not make up for it.
#[test]
fn dark_rooms_make_no_light() {
    let albedo = 0.02;
    let mut desc = furnace(box_of_squares(15), albedo as f32, None);
    let lamp = quad([-0.3, 0.8, -0.3], [0.6, 0.0, 0.0], [0.0, 0.0, 0.6]);
    add(&mut desc, 1, ShapeDesc::Quad(lamp), BsdfDesc::Black, Some(Rgb::splat(5.0)));
    let summary = *solve(&desc, &RadiosityDesc { error: 3.0, ..RadiosityDesc::default() }).summary();
    let lost = summary.lost().unwrap();
    println!("{lost}");
    // The lamp is black and absorbs what comes back to it, of which little does.
    assert!(lost.abs() < 0.01, "{lost}");
}

/// The inside of a cube from -1 to 1, each side of `count` x `count` squares.
fn box_of_squares(count: u32) -> MeshDesc {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let at = |i: u32, j: u32| {
            let [u, v] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(count) - 1.0);
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
            DVec3::from(p)
        };
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let first = positions.len() as u32;
            positions.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            // Normals inwards.
            let order = if side < 0.0 { [1, 2, 3] } else { [3, 2, 1] };
            let [a, b, c] = order.map(|k| first + k);
            triangles.extend([[first, a, b], [first, b, c]]);
        }
    }
    MeshDesc { name: "box".into(), positions, triangles, ..MeshDesc::default() }
}

/// Closed rooms of curved walls and flat lids: at an albedo of 0.97 what links lose or make a bounce is lost or made 33 times.
#[test]
fn curved_rooms_lose_no_light() {
    let disk = |y: f64, radius: f64, up: DVec3| ShapeDesc::disk(DVec3::Y * y, up, radius);
    let below = Bounds { min: DVec3::new(-2.0, -0.6, -2.0), max: DVec3::splat(2.0) };
    let ball = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    let rooms = [
        ("ellipsoid", vec![ShapeDesc::ellipsoid(DVec3::ZERO, DVec3::new(1.0, 0.6, 1.4))]),
        (
            "tube with lids",
            vec![
                ShapeDesc::cylinder(-DVec3::Y, DVec3::Y, 1.0, 2.0),
                disk(-1.0, 1.0, DVec3::Y),
                disk(1.0, 1.0, -DVec3::Y),
            ],
        ),
        ("part of a ball with a lid", vec![ShapeDesc::quadric(ball, Some(below)), disk(-0.6, 0.8, DVec3::Y)]),
    ];
    for (name, shapes) in rooms {
        let mut desc = SceneDesc { camera: camera(DVec3::ZERO, DVec3::X, 60.0), ..SceneDesc::default() };
        for (number, shape) in shapes.into_iter().enumerate() {
            let (shape, local) = shape.unwrap();
            add(&mut desc, number, shape, lambert(0.97), None);
            desc.surfaces[number].local = local;
        }
        desc.lights.push(point_light(DVec3::new(0.3, 0.2, 0.1), 1.0));
        let settings = RadiosityDesc { element_size: Some(0.5), error: 3.0, ..RadiosityDesc::default() };
        let lost = solve(&desc, &settings).summary().lost().unwrap();
        assert!(lost.abs() < 0.015, "{name}: {lost} is lost");
    }
}

/// A closed box with a point light inside, on one side of walls that reflect differently on the other: its mean irradiance is
/// Phi / (A (1 - rho)) with the albedo of the inside alone, and pictures of it are as bright as paths make them.
#[test]
fn walls_of_two_albedos() {
    let coarse = RadiosityDesc { error: 2.0, ..RadiosityDesc::default() };
    let rough = BsdfDesc::OrenNayar { albedo: Rgb::splat(0.8), roughness: 0.7 };
    let alone = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, None);
    let mean_irradiance = |desc: &SceneDesc, front: bool| {
        let mesh = solve(desc, &coarse).mesh(Some(0), front);
        let (mut sum, mut area) = (0.0, 0.0);
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
            let own = 0.5 * (b - a).cross(c - a).length();
            let mean = corners.iter().map(|&i| f64::from(mesh.irradiance[i as usize].r())).sum::<f64>() / 3.0;
            (sum, area) = (sum + own * mean, area + own);
        }
        sum / area
    };
    let room = |walls: Option<[BsdfDesc; 2]>, is_front: bool| {
        let mut desc = alone.clone();
        desc.camera = camera(DVec3::new(0.9, 0.8, 0.9), DVec3::new(-0.3, -0.2, -0.4), 80.0);
        desc.lights.push(point_light(DVec3::new(0.3, 0.2, 0.4), 2.0));
        if !is_front {
            let mut mesh = (*desc.meshes[0]).clone();
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            desc.meshes = vec![Arc::new(mesh)];
        }
        if let Some([front, back]) = walls {
            for (number, bsdf) in [(1, front), (2, back)] {
                let name = format!("wall {number}");
                desc.materials.insert(number - 1, MaterialDesc { name, bsdf, ..MaterialDesc::default() });
            }
            desc.materials[2].bsdf = BsdfDesc::TwoSided { front: 0, back: 1 };
            desc.surfaces[0].material = Some(2);
        }
        desc
    };
    for is_front in [true, false] {
        for (name, inside, outside, albedo) in [
            ("bright inside", lambert(0.8), lambert(0.1), Some(0.8)),
            ("dark inside", lambert(0.1), lambert(0.8), Some(0.1)),
            ("black outside", lambert(0.8), BsdfDesc::Black, Some(0.8)),
            ("rough inside", rough, lambert(0.1), None),
        ] {
            // What these are for is no different from behind.
            if !is_front && ["black outside", "rough inside"].contains(&name) {
                continue;
            }
            let desc = room(Some(if is_front { [inside, outside] } else { [outside, inside] }), is_front);
            let mean = mean_irradiance(&desc, is_front);
            let expected = match albedo {
                Some(albedo) => 4.0 * PI * 2.0 / (24.0 * (1.0 - albedo)),
                None => {
                    let mut whole = room(None, is_front);
                    whole.materials[0].bsdf = inside;
                    mean_irradiance(&whole, is_front)
                }
            };
            let scene = build(&desc);
            let base = RenderDesc { resolution: [24, 24], samples: 256, ..RenderDesc::default() };
            let brightness = |integrator| {
                let desc = RenderDesc { integrator, radiosity: coarse.clone(), ..base.clone() };
                let rgb = picture(&scene, desc, 2);
                rgb.iter().map(|v| f64::from(*v)).sum::<f64>() / rgb.len() as f64
            };
            let [seen, paths] = [IntegratorDesc::Radiosity, IntegratorDesc::Path].map(brightness);
            println!("{name}, front {is_front}: {mean:.4} of {expected:.4}, picture {seen:.4}, by paths {paths:.4}");
            assert!((mean / expected - 1.0).abs() < 5e-3, "{name}, front {is_front}: {mean} and not {expected}");
            // A rough wall sends more light back towards the lamp, which a mean albedo does not know.
            let allowed = if albedo.is_some() { 0.01 } else { 0.05 };
            assert!((seen / paths - 1.0).abs() < allowed, "{name}, front {is_front}: {seen}, by paths {paths}");
        }
    }
}
// Light that comes straight.

/// The irradiance a quad lamp gives is Lambert's, and a point light's falls by the square of the distance: at many places.
#[test]
fn direct_light() {
    let mut desc = SceneDesc { camera: camera(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO, 60.0), ..SceneDesc::default() };
    let floor = quad([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]);
    let lamp = quad([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    add(&mut desc, 0, ShapeDesc::Quad(floor), lambert(0.5), None);
    add(&mut desc, 1, ShapeDesc::Quad(lamp), BsdfDesc::Black, Some(Rgb::splat(3.0)));
    let position = DVec3::new(-2.0, 1.0, 1.0);
    desc.lights.push(point_light(position, 2.0));
    let solution = solve(&desc, &RadiosityDesc { error: 0.5, element_size: Some(0.1), ..RadiosityDesc::default() });
    let (mut squares, mut all) = (0.0, 0.0);
    for i in 0..20 {
        for half in 0..2 {
            let b = [f64::from(i) / 20.0 * 0.9 + 0.04, f64::from((7 * i) % 20) / 20.0];
            let b = [b[0], b[1] * (1.0 - b[0])];
            let corners = if half == 0 { [floor[0], floor[1], floor[2]] } else { [floor[0], floor[2], floor[3]] };
            let p = corners[0] + b[0] * (corners[1] - corners[0]) + b[1] * (corners[2] - corners[0]);
            let e = solution.irradiance_on(0, half, b.map(|b| b as f32), DVec3::ZERO, true).unwrap();
            let way = position - p;
            let expected = 3.0 * PI * point_to_polygon(p, DVec3::Y, &lamp) + 2.0 * way.y / way.length().powi(3);
            squares += (f64::from(e.r()) - expected).powi(2);
            all += expected.powi(2);
            assert_eq!(solution.irradiance_on(0, half, b.map(|b| b as f32), DVec3::ZERO, false), Some(Rgb::ZERO));
        }
    }
    let error = (squares / all).sqrt();
    println!("relative RMS error {error:.4}");
    assert!(error < 0.01, "{error}");
}

/// A lamp in the form of a ball: E = pi L (r / d)^2 below its middle, as if its area was where its elements are.
#[test]
fn ball_lamp() {
    let mut desc = SceneDesc { camera: camera(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO, 60.0), ..SceneDesc::default() };
    let floor = quad([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
    add(&mut desc, 0, ShapeDesc::Quad(floor), lambert(0.0), None);
    desc.materials[0].bsdf = lambert(1e-3);
    let ball = ShapeDesc::Sphere { centre: DVec3::new(0.0, 1.5, 0.0), radius: 0.5 };
    add(&mut desc, 1, ball, BsdfDesc::Black, Some(Rgb::ONE));
    let solution = solve(&desc, &RadiosityDesc { error: 0.1, element_size: Some(0.05), ..RadiosityDesc::default() });
    let e = solution.irradiance_on(0, 0, [0.0, 0.5], DVec3::ZERO, true).unwrap().r();
    let expected = PI / 9.0;
    assert!((f64::from(e) / expected - 1.0).abs() < 0.01, "{e} and not {expected}");
}

// Whole rooms, many surfaces.

/// A closed room with a lamp and, in it, balls of many triangles: all that is emitted is absorbed.
fn room_with_balls(rings: u32, balls: u32) -> SceneDesc {
    let mut desc = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.6, None);
    let lamp = quad([-0.3, 0.99, -0.3], [0.6, 0.0, 0.0], [0.0, 0.0, 0.6]);
    add(&mut desc, 1, ShapeDesc::Quad(lamp), BsdfDesc::Black, Some(Rgb::splat(5.0)));
    let mut ball = sphere_inside(rings, 1.0);
    ball.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    desc.meshes.push(Arc::new(ball));
    for i in 0..balls {
        let number = desc.surfaces.len();
        add(&mut desc, number, ShapeDesc::Mesh { mesh: 1, smooth: false }, lambert(0.5), None);
        let angle = TAU * f64::from(i) / f64::from(balls);
        let place = DVec3::new(0.55 * angle.cos(), -0.6, 0.55 * angle.sin());
        desc.surfaces[number].transform =
            etendue::math::DAffine3::from_scale_rotation_translation(DVec3::splat(0.25), Default::default(), place);
    }
    desc
}

fn picture(scene: &Scene, desc: RenderDesc, threads: usize) -> Vec<f32> {
    picture_and_notes(scene, desc, threads).0
}

/// Path tracing whose pixels share hits, which is as good with a few times fewer samples, and that no pilot chooses for.
fn shared(desc: &RenderDesc) -> RenderDesc {
    RenderDesc { reuse: Some(true), light_paths: Some(false), ..desc.clone() }
}

fn picture_and_notes(scene: &Scene, desc: RenderDesc, threads: usize) -> (Vec<f32>, Vec<String>) {
    let settings = RenderSettings { desc, threads, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(summary.non_finite, 0);
    assert!(summary.notes.iter().any(|note| note.starts_with("radiosity:")) || summary.notes.is_empty());
    (render.image().rgb, summary.notes)
}

fn rel_mse(a: &[f32], reference: &[f32]) -> f64 {
    let mean = reference.iter().map(|&x| f64::from(x)).sum::<f64>() / reference.len() as f64;
    let one =
        |(a, r): (&f32, &f32)| (f64::from(*a) - f64::from(*r)).powi(2) / (f64::from(*r).powi(2) + 0.01 * mean * mean);
    a.iter().zip(reference).map(one).sum::<f64>() / a.len() as f64
}

/// However wide walls are, only the spot that a light is near to is divided finely: by a first idea of brightness from the middle of
/// the walls, there were twenty times as many elements.
#[test]
fn a_spot_between_wide_walls() {
    let mut desc = SceneDesc { camera: camera(DVec3::Y * 0.5, DVec3::ZERO, 60.0), ..SceneDesc::default() };
    let floor = quad([-500.0, 0.0, -500.0], [0.0, 0.0, 1000.0], [1000.0, 0.0, 0.0]);
    let ceiling = quad([-500.0, 1.0, -500.0], [1000.0, 0.0, 0.0], [0.0, 0.0, 1000.0]);
    add(&mut desc, 0, ShapeDesc::Quad(floor), lambert(0.5), None);
    add(&mut desc, 1, ShapeDesc::Quad(ceiling), lambert(0.5), None);
    desc.lights.push(point_light(DVec3::Y * 0.5, 1.0));
    let solution = solve(&desc, &RadiosityDesc { error: 5.0, element_size: Some(0.2), ..RadiosityDesc::default() });
    assert!((200..3000).contains(&solution.summary().elements), "{:?}", solution.summary());
}

/// Light of any brightness: all of it in proportion, with no square of it that is too large or too small for its type.
#[test]
fn bright_and_dark_light() {
    let room = |radiance: f32| {
        let mesh = box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
        let mut desc = furnace(mesh, 0.5, None);
        let lamp = quad([-0.2, 0.8, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]);
        add(&mut desc, 1, ShapeDesc::Quad(lamp), BsdfDesc::Black, Some(Rgb::splat(radiance)));
        solve(&desc, &RadiosityDesc { error: 5.0, ..RadiosityDesc::default() }).mesh(Some(0), true).irradiance
    };
    let usual = room(1.0);
    assert!(usual.len() > 50 && usual.iter().any(|e| e.r() > 0.05));
    for power in [-80, 80] {
        let factor = 2.0_f32.powi(power);
        let other: Vec<Rgb> = room(factor).into_iter().map(|e| e / factor).collect();
        assert_eq!(other, usual, "times 2^{power}");
    }
}

/// Clusters: against the path tracer, and all light is accounted for.
#[test]
fn many_triangles() {
    let mut desc = room_with_balls(12, 4);
    desc.camera = camera(DVec3::new(0.0, 0.1, 0.97), DVec3::new(0.0, -0.3, 0.0), 90.0);
    let scene = build(&desc);
    let fine = RadiosityDesc { error: 0.3, ..RadiosityDesc::default() };
    let base = RenderDesc { resolution: [36, 36], samples: 256, ..RenderDesc::default() };
    let reference = picture(&scene, shared(&base), 2);
    let radiosity = RenderDesc { integrator: IntegratorDesc::Radiosity, samples: 64, radiosity: fine, ..base };
    let (image, notes) = picture_and_notes(&scene, radiosity, 2);
    let error = rel_mse(&image, &reference);
    let lost = notes.iter().find_map(|note| note.split_once(" % of the light came to nothing"));
    let lost: f64 = lost.unwrap().0.rsplit(' ').next().unwrap().parse().unwrap();
    println!("relMSE {error:.2e}, lost {lost} %");
    assert!(error < 2e-3, "{error}");
    assert!(lost.abs() < 0.6, "{lost} %");
}

/// Case 60, small: the Cornell box's pictures against the path tracer's; finer elements are better, the final gather best.
#[test]
fn cornell_box() {
    let desc = etendue::desc::load(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.json").as_ref(), None).unwrap();
    let scene = build(&desc);
    let base = RenderDesc { resolution: [40, 40], samples: 1024, ..RenderDesc::default() };
    let reference = picture(&scene, shared(&base), 2);
    let one = |size: f64, error: f64, final_gather: bool| {
        let radiosity = RadiosityDesc { element_size: Some(size), error, final_gather, ..RadiosityDesc::default() };
        let samples = if final_gather { 1024 } else { 64 };
        let desc = RenderDesc { integrator: IntegratorDesc::Radiosity, samples, radiosity, ..base.clone() };
        rel_mse(&picture(&scene, desc, 2), &reference)
    };
    let errors = [one(150.0, 20.0, false), one(50.0, 5.0, false), one(15.0, 1.0, false), one(50.0, 5.0, true)];
    println!("{errors:?}");
    assert!(errors[1] < 0.7 * errors[0] && errors[2] < 0.7 * errors[1], "{errors:?}");
    assert!(errors[2] < 0.01 && errors[3] < 0.005, "{errors:?}");
}

#[test]
fn threads_change_nothing() {
    let mut desc = room_with_balls(8, 2);
    desc.lights.push(point_light(DVec3::new(0.5, 0.5, 0.5), 0.2));
    desc.camera = camera(DVec3::new(0.0, 0.1, 0.97), DVec3::new(0.0, -0.3, 0.0), 90.0);
    let scene = build(&desc);
    for (solver, final_gather) in [(RadiositySolver::Gather, false), (RadiositySolver::Shoot, true)] {
        let radiosity = RadiosityDesc { solver, final_gather, error: 20.0, ..RadiosityDesc::default() };
        let desc = RenderDesc {
            resolution: [16, 16],
            samples: 2,
            integrator: IntegratorDesc::Radiosity,
            radiosity,
            ..RenderDesc::default()
        };
        let [one, four] = [1, 4].map(|threads| picture(&scene, desc.clone(), threads));
        assert!(one == four && one.iter().any(|x| *x > 0.0));
    }
}

/// A room without a ceiling, in a sky and the sun, with a lamp that shines into a cone.
fn open_room() -> SceneDesc {
    let mut desc = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, None);
    let mut walls = (*desc.meshes[0]).clone();
    walls.triangles.retain(|corners| corners.iter().any(|&corner| walls.positions[corner as usize].y < 0.0));
    desc.meshes[0] = Arc::new(walls);
    desc.set_environment(Some(Rgb::new(0.5, 1.0, 2.0))).unwrap();
    let sun = DistantLightDesc::parallel(DVec3::new(0.3, 1.0, 0.2), Rgb::ONE);
    desc.add_distant_light(DistantLightDesc { angle_deg: 0.5, ..sun }).unwrap();
    let distribution = LightDistribution::Spot(SpotDesc::new(DVec3::new(1.0, -1.0, 0.0)));
    desc.add_light_desc(PointLightDesc { distribution, ..PointLightDesc::even(DVec3::ZERO, Rgb::ONE) }).unwrap();
    desc
}

#[test]
fn threads_change_nothing_of_sampled_light() {
    let scene = build(&open_room());
    for (solver, final_gather) in [(RadiositySolver::Gather, true), (RadiositySolver::Shoot, false)] {
        let radiosity = RadiosityDesc { solver, final_gather, error: 20.0, ..RadiosityDesc::default() };
        let (integrator, resolution) = (IntegratorDesc::Radiosity, [16, 16]);
        let desc = RenderDesc { resolution, samples: 2, integrator, radiosity, ..RenderDesc::default() };
        let [one, three] = [1, 3].map(|threads| picture(&scene, desc.clone(), threads));
        assert!(one == three && one.iter().any(|x| *x > 0.0));
    }
}

/// Sampled light is there from the first bounce on, its error is told, and its elements are within the limit of memory.
#[test]
fn sampled_light_is_solved_like_any_other() {
    let desc = open_room();
    let of = |solver, iterations| {
        let solution = solve(&desc, &RadiosityDesc { solver, iterations, error: 3.0, ..RadiosityDesc::default() });
        let mesh = solution.mesh(None, true);
        (mesh.irradiance.iter().map(|e| f64::from(e.g())).sum::<f64>() / mesh.irradiance.len() as f64, solution)
    };
    let gather = |iterations| of(RadiositySolver::Gather, iterations).0;
    assert_eq!(gather(Some(0)), 0.0);
    let [one, two, all] = [Some(1), Some(2), None].map(gather);
    assert!(one > 0.0 && two > 1.05 * one && all > 1.02 * two && all < 2.0 * one, "{one} {two} {all}");
    let (shot, solution) = of(RadiositySolver::Shoot, None);
    assert!((shot / all - 1.0).abs() < 2e-3, "{shot} {all}");
    let error = solution.summary().sampling_error;
    assert!(error > 0.0 && error < 0.02, "{error}");
    assert!(
        solution.notes()[0].contains(&format!("direct light sampled within {error:.1e}")),
        "{:?}",
        solution.notes()
    );
    let lamp = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, Some(1.0));
    let solution = solve(&lamp, &RadiosityDesc::default());
    assert!(solution.summary().sampling_error == 0.0 && !solution.notes()[0].contains("sampled"));
    let fine = RadiosityDesc { memory: 4, error: 1e-3, element_size: Some(1e-3), ..RadiosityDesc::default() };
    let error = Radiosity::solve(&build(&desc), &fine, &mut Alone::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::OutOfMemory);
    assert!(error.to_string().contains("radiosityMemory"), "{error}");
}

/// Both solvers come to the same; bounces do not decrease, and lack what a geometric series says.
#[test]
fn solvers_agree() {
    let desc = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, Some(1.0));
    let with = |solver, iterations, ambient| {
        let settings = RadiosityDesc { solver, iterations, ambient, tolerance: 1e-6, ..RadiosityDesc::default() };
        let solution = solve(&desc, &settings);
        let e = solution.irradiance_on(0, 0, [0.3, 0.3], DVec3::ZERO, true).unwrap();
        (f64::from(e.r()) / PI, *solution.summary())
    };
    for bounces in [0, 1, 4] {
        let (e, summary) = with(RadiositySolver::Gather, Some(bounces), false);
        // Irradiance by what was scattered up to so many times less one: 1 + 1/2 + ...
        let expected = 2.0 * (1.0 - 0.5_f64.powi(bounces as i32));
        assert!((e - expected).abs() < 2e-3, "{bounces}: {e} and not {expected}");
        assert_eq!(summary.iterations, bounces);
    }
    let (gathered, summary) = with(RadiositySolver::Gather, None, false);
    assert!(summary.residual < 1e-5 && summary.error_bound < 1e-5, "{summary:?}");
    let (shot, summary) = with(RadiositySolver::Shoot, None, false);
    assert!(summary.error_bound < 1e-5 && summary.iterations > 12, "{summary:?}");
    assert!((gathered - 2.0).abs() < 2e-3 && (shot - gathered).abs() < 1e-4, "{gathered} {shot}");
    // Shot once, the rest is spread: in a room that is the same everywhere that is all of it, nearly.
    let (bare, _) = with(RadiositySolver::Shoot, Some(6), false);
    let (ambient, _) = with(RadiositySolver::Shoot, Some(6), true);
    assert!(bare < 1.6 && (ambient - 2.0).abs() < 0.2, "{bare} {ambient}");
}

// What cannot be done, or need not.

#[test]
fn nothing_to_solve() {
    let dark = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, None);
    let solution = solve(&dark, &RadiosityDesc::default());
    assert!(solution.mesh(None, true).irradiance.iter().all(|e| *e == Rgb::ZERO));
    assert_eq!(solution.irradiance_on(0, 99, [0.0; 2], DVec3::ZERO, true), None);
    assert_eq!(solution.irradiance_on(7, 0, [0.0; 2], DVec3::ZERO, true), None);

    let mut mirrors = furnace(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), 0.5, None);
    mirrors.materials[0].bsdf = BsdfDesc::Mirror { reflectance: Rgb::ONE };
    mirrors.lights.push(point_light(DVec3::ZERO, 1.0));
    mirrors.render.integrator = IntegratorDesc::Radiosity;
    let solution = solve(&mirrors, &RadiosityDesc::default());
    assert!(solution.notes()[0].contains("no surface is diffuse"));
    assert_eq!(solution.summary().elements, 0);
    // Told before the first ray.
    let scene = build(&mirrors);
    let told = scene.warnings().iter().any(|w| w.contains("black, being mirrors or glass: surfaces[0] (material 0)"));
    assert!(told, "{:?}", scene.warnings());
    let empty = SceneDesc::default();
    assert_eq!(solve(&empty, &RadiosityDesc::default()).summary().elements, 0);
}

#[test]
fn limits_and_cancelling() {
    let desc = room_with_balls(40, 4);
    let scene = build(&desc);
    let solve = |settings: RadiosityDesc, cancel| Radiosity::solve(&scene, &settings, &mut Alone(cancel)).map(|_| ());
    let small = RadiosityDesc { memory: 1, ..RadiosityDesc::default() };
    let error = solve(small, Cancel::new()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::OutOfMemory);
    assert!(error.to_string().contains("radiosityMemory"), "{error}");
    // Links that grow beyond it.
    let fine = RadiosityDesc { memory: 24, error: 1e-3, element_size: Some(1e-3), ..RadiosityDesc::default() };
    assert_eq!(solve(fine, Cancel::new()).unwrap_err().kind(), ErrorKind::OutOfMemory);
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(solve(RadiosityDesc::default(), cancel).unwrap_err().kind(), ErrorKind::Cancelled);
    for (settings, path) in [
        (RadiosityDesc { error: 0.0, ..RadiosityDesc::default() }, "render.radiosityError"),
        (RadiosityDesc { error: f64::NAN, ..RadiosityDesc::default() }, "render.radiosityError"),
        (RadiosityDesc { element_size: Some(-1.0), ..RadiosityDesc::default() }, "render.radiosityElementSize"),
        (RadiosityDesc { tolerance: 1.0, ..RadiosityDesc::default() }, "render.radiosityTolerance"),
        (RadiosityDesc { memory: 0, ..RadiosityDesc::default() }, "render.radiosityMemory"),
        (RadiosityDesc { iterations: Some(u32::MAX), ..RadiosityDesc::default() }, "render.radiosityIterations"),
    ] {
        let error = solve(settings, Cancel::new()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidScene);
        assert!(error.to_string().contains(path), "{error}");
    }
}
