//! A thousand reflections one after another: light guides, and mirrors that face each other.

use super::rays::{Choices, PATH, REFRACT, Random, Recorder, angle, follow, line};
use super::refraction::slab_transmittance;
use super::{MESH, glass, measure, mesh, mirror, parallelogram, pick, plane, turned};
use crate::common::scenes::{Job, camera, scene};
use crate::record::{Case, Entry, Within};
use etendue::desc::{BsdfDesc, IntegratorDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::integrator::{Integrator, SceneTracer, Whitted};
use etendue::math::{DAffine3, DQuat, DVec3, EulerRot, Ray, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R67", title: "light guide, 1000 total reflections", run: guide },
        Entry { id: "R67b", title: "light through a long guide", run: transmission },
        Entry { id: "R67c", title: "round light guide", run: rod },
        Entry { id: "R68", title: "mirrors facing each other", run: facing },
        Entry { id: "R68b", title: "corner reflector", run: corner },
    ]
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// A bar of this cross-section (corners around the z axis) from z = 0 to `length`, of so many pieces, normals outwards.
fn bar(section: &[(f64, f64)], length: f64, pieces: u32) -> MeshDesc {
    let sides = section.len() as u32;
    let mut positions = Vec::new();
    for piece in 0..=pieces {
        let z = length * f64::from(piece) / f64::from(pieces);
        positions.extend(section.iter().map(|&(x, y)| DVec3::new(x, y, z)));
    }
    let mut triangles = Vec::new();
    for piece in 0..pieces {
        for side in 0..sides {
            let [a, b] = [piece * sides + side, piece * sides + (side + 1) % sides];
            triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
        }
    }
    let last = pieces * sides;
    for corner in 1..sides - 1 {
        triangles.push([0, corner, corner + 1]);
        triangles.push([last, last + corner, last + corner + 1]);
    }
    turned(mesh(positions, triangles), DVec3::Z * (0.5 * length), false)
}

const SQUARE: [(f64, f64); 4] = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];

/// Where a point that travels between walls at -0.5 and 0.5 is, from its place without them, and whether it goes backwards.
fn folded(x: f64) -> (f64, bool) {
    let cell = (x + 0.5).floor();
    let inside = x - cell;
    if cell.rem_euclid(2.0) == 0.0 { (inside, false) } else { (-inside, true) }
}

fn guide(case: &mut Case) {
    // From the middle of one end, inside the glass, to the other: the walls fold a straight line.
    let direction = DVec3::new(0.5, 0.4, (1.0_f64 - 0.41).sqrt());
    let length = 854.0;
    for (name, pieces) in [("pieces of 1", 854), ("one piece", 1)] {
        let eye = DVec3::new(0.05, 0.02, 0.25);
        let sky = plane(DVec3::Z * (length + 1.0), DVec3::NEG_Z, 100.0);
        let mut desc = scene(
            camera(eye, DVec3::Z * 9.0, 40.0),
            vec![(MESH, glass(1.5, 1.0), None), (sky, BsdfDesc::Black, Some(Rgb::ONE))],
        );
        desc.meshes.push(bar(&SQUARE, length, pieces).into());
        let scene = build(&desc);

        let travelled = (length - eye.z) / direction.z;
        let straight = eye + travelled * direction;
        let (x, x_back) = folded(straight.x);
        let (y, y_back) = folded(straight.y);
        let reflections = (straight.x + 0.5).floor() + (straight.y + 0.5).floor();
        let rays = follow(&scene, (eye, direction), &[REFRACT], 1100);
        // One ray to each wall, one to the end, one out of it.
        case.exact(format!("{name}: reflections"), rays.len() as f64 - 2.0, reflections, Within::Absolute(0.0));
        let (origin, out) = line(&scene, &rays[rays.len() - 1]);
        let off = (origin - DVec3::new(x, y, length)).length() / travelled;
        if pieces == 1 {
            case.known("each reflection moves the ray by a millionth of the triangle's extent along the normal");
        }
        case.exact(format!("{name}: exit point / way travelled"), off, 0.0, Within::Absolute(1e-5));
        let side = |sine: f64, back: bool| if back { -1.5 * sine } else { 1.5 * sine };
        let [sx, sy] = [side(direction.x, x_back), side(direction.y, y_back)];
        let expected = DVec3::new(sx, sy, (1.0 - sx * sx - sy * sy).sqrt());
        case.exact(format!("{name}: exit direction, rad"), angle(out, expected), 0.0, Within::Absolute(2e-5));

        let mut tracer = SceneTracer::new(&scene);
        let ray = Ray::new(scene.to_scene(eye), direction.as_vec3a());
        let got = PATH.radiance(&scene, ray, &mut Choices::new(&[REFRACT]), &mut tracer, &mut |_| {});
        case.exact(format!("{name}: radiance inside, n² L"), f64::from(got.r()), 2.25, Within::Relative(1e-6));
    }
    // Guides of other sections, randomly lit from within: what total reflection holds stays inside.
    let hexagon: Vec<(f64, f64)> =
        (0..6).map(|i| (f64::from(i) * std::f64::consts::TAU / 6.0 + 0.1).sin_cos()).collect();
    for (name, section) in [("triangle", vec![(-1.0, -0.6), (1.0, -0.6), (0.1, 1.1)]), ("hexagon", hexagon)] {
        let eye = DVec3::new(0.05, 0.02, 1.0);
        let mut desc = scene(camera(eye, DVec3::Z * 9.0, 40.0), vec![(MESH, glass(1.5, 1.0), None)]);
        desc.meshes.push(bar(&section, 1e4, 10_000).into());
        let scene = build(&desc);
        let mut rng = Rng::new(3, 0);
        let tries = case.count(40, 4000);
        let (mut lost, mut reflections) = (0, 0);
        for _ in 0..tries {
            // Along the guide enough that every wall is met beyond its critical angle.
            let [sin, phi] = rng.next_2d().map(f64::from);
            let (sin, phi) = (0.3 + 0.36 * sin, phi * std::f64::consts::TAU);
            let direction = DVec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin * sin).sqrt());
            let rays = follow(&scene, (eye, direction), &[REFRACT], 1001);
            reflections += rays.len() as u64 - 1;
            let outside = line(&scene, &rays[rays.len() - 1]).0;
            lost += u64::from(rays.len() < 1001 && outside.z < 1e4 - 1e-2);
        }
        // Where a wall meets another at a sharp angle, a ray may start behind that.
        case.rarely(format!("{name}: lost through a wall, 1000 reflections"), lost, reflections, 1e-6);
    }
}

fn transmission(case: &mut Case) {
    // Whatever enters an end of a square guide of n² > 2 is held, so that the guide passes what a slab does. At 60° and
    // across the diagonal more or less, it is reflected about a thousand times.
    let degrees = 60.0_f64;
    let exact = slab_transmittance(degrees);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let target = DVec3::new(0.03, 0.02, 0.0);
    let eye = target - 0.1 * DVec3::new(0.8 * sin, 0.6 * sin, cos);
    let sky = plane(DVec3::Z * 1011.0, DVec3::NEG_Z, 500.0);
    let mut desc =
        scene(camera(eye, target, 0.1), vec![(MESH, glass(1.5, 1.0), None), (sky, BsdfDesc::Black, Some(Rgb::ONE))]);
    desc.meshes.push(bar(&SQUARE, 1010.0, 1010).into());
    let (samples, side) = (case.count(1, 12) as u32, pick(case, 16, 32));
    let job = Job { resolution: [side, side], samples: 4 * samples, ..Job::default() };
    case.mean("path, 60°", measure(&desc, &job), exact, pick(case, 2e-2, 2e-3));
    let job = Job { resolution: [8, 8], samples: case.count(4, 32) as u32, ..job };
    let job = Job { integrator: IntegratorDesc::Whitted, ..job };
    case.mean("Whitted, 60°", measure(&desc, &job), exact, pick(case, 1e-2, 1e-3));
}

fn rod(case: &mut Case) {
    // Around its axis a rod keeps the direction along it and the angular momentum of a ray.
    let (tube, local) = ShapeDesc::cylinder(DVec3::ZERO, DVec3::Z, 1.0, 1e4).expect("a tube");
    let eye = DVec3::new(0.3, 0.1, 1.0);
    let end =
        |z: f64, normal: DVec3| (ShapeDesc::disk(DVec3::Z * z, normal, 1.0).expect("a disk").0, glass(1.5, 1.0), None);
    let mut desc = scene(
        camera(eye, DVec3::Z * 9.0, 40.0),
        vec![(tube, glass(1.5, 1.0), None), end(0.0, DVec3::NEG_Z), end(1e4, DVec3::Z)],
    );
    desc.surfaces[0].local = local;
    let scene = build(&desc);
    let mut rng = Rng::new(9, 0);
    let tries = case.count(40, 4000);
    let (mut lost, mut reflections) = (0, 0);
    let (mut along, mut around) = (0.0_f64, 0.0_f64);
    for _ in 0..tries {
        let [sin, phi] = rng.next_2d().map(f64::from);
        let (sin, phi) = (0.3 + 0.36 * sin, phi * std::f64::consts::TAU);
        let direction = DVec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin * sin).sqrt());
        let rays = follow(&scene, (eye, direction), &[REFRACT], 1001);
        let momentum = |p: DVec3, d: DVec3| p.x * d.y - p.y * d.x;
        reflections += rays.len() as u64 - 1;
        lost += u64::from(rays.len() < 1001);
        let (p, d) = line(&scene, &rays[rays.len() - 1]);
        along = along.max((d.z - direction.z).abs());
        around = around.max((momentum(p, d) - momentum(eye, direction)).abs());
    }
    case.never("lost through the wall, 1000 reflections", lost, reflections);
    case.exact("direction along the axis, drift", along, 0.0, Within::Absolute(1e-5));
    case.exact("angular momentum, drift", around, 0.0, Within::Absolute(1e-4));
}

/// Two mirrors at x = 0 and 1, and a lamp over the gap between x = 0.2 and 0.3, at y = 1.
fn hall(reflectance: f32) -> SceneDesc {
    let eye = DVec3::new(0.4, 0.0, 0.0);
    let lamp = parallelogram(DVec3::new(0.2, 1.0, -1.0), DVec3::X * 0.1, DVec3::Z * 2.0);
    scene(
        camera(eye, DVec3::new(1.0, 0.1, 0.0), 40.0),
        vec![
            (plane(DVec3::new(0.0, 0.5, 0.0), DVec3::X, 2.0), mirror(reflectance), None),
            (plane(DVec3::new(1.0, 0.5, 0.0), DVec3::NEG_X, 2.0), mirror(reflectance), None),
            (lamp, BsdfDesc::Black, Some(Rgb::ONE)),
        ],
    )
}

/// From the eye of the hall to the middle of the lamp's image after so many reflections.
fn to_image(reflections: u32) -> DVec3 {
    let cell = f64::from(reflections);
    let place = if reflections.is_multiple_of(2) { cell + 0.25 } else { cell + 0.75 };
    DVec3::new(place - 0.4, 1.0, 0.0)
}

fn facing(case: &mut Case) {
    let reflectance = 0.999_f32;
    let scene = build(&hall(reflectance));
    for reflections in [1, 10, 100, 1000] {
        let direction = to_image(reflections);
        let ray = Ray::new(Vec3::ZERO, direction.normalize().as_vec3a());
        let mut tracer = Recorder::new(&scene, 1100);
        let whitted = Whitted { max_depth: None, shadow_rays: 1 };
        let got = whitted.radiance(&scene, ray, &mut Choices::new(&[0.0]), &mut tracer, &mut |_| {});
        let exact = f64::from(reflectance).powi(reflections as i32);
        case.exact(format!("image {reflections}: brightness"), f64::from(got.r()), exact, Within::Relative(1e-5));
        let (origin, last) = line(&scene, &tracer.rays[tracer.rays.len() - 1]);
        let there = origin + (1.0 - origin.y) / last.y * last;
        let off = (there - DVec3::new(0.25, 1.0, 0.0)).length() / direction.length();
        case.exact(format!("image {reflections}: place / distance"), off, 0.0, Within::Absolute(1e-5));

        if reflections < 1000 {
            continue;
        }
        // Roulette takes part once half is lost.
        let tries = case.count(400, 10_000);
        let mut random = Random(Rng::new(1, 0));
        let values: Vec<f64> = (0..tries)
            .map(|_| {
                let mut tracer = SceneTracer::new(&scene);
                f64::from(PATH.radiance(&scene, ray, &mut random, &mut tracer, &mut |_| {}).r())
            })
            .collect();
        let got = crate::stats::mean_and_error(&values);
        case.mean(format!("image {reflections}: brightness by path tracing"), got, exact, pick(case, 4e-2, 8e-3));
    }
}

fn corner(case: &mut Case) {
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, 1.0, -0.7);
    let side = |u: DVec3, v: DVec3| (parallelogram(DVec3::ZERO, u, v), mirror(1.0), None);
    let far = turn * DVec3::splat(3.0);
    let mut desc = scene(
        camera(far, DVec3::ZERO, 40.0),
        vec![side(DVec3::X, DVec3::Y), side(DVec3::Y, DVec3::Z), side(DVec3::Z, DVec3::X)],
    );
    for surface in &mut desc.surfaces {
        surface.transform = DAffine3::from_quat(turn);
    }
    let scene = build(&desc);
    let mut rng = Rng::new(4, 0);
    let (mut worst, mut returned) = (0.0_f64, 0_u64);
    for _ in 0..case.count(20_000, 2_000_000) {
        let [x, y, z, _] = rng.next_4d().map(|u| 0.05 + 0.9 * f64::from(u));
        let inwards = (0.2 * warps::uniform_sphere(rng.next_2d())).as_dvec3() - DVec3::ONE;
        let start = (turn * (DVec3::new(x, y, z) - inwards), (turn * inwards).normalize());
        let rays = follow(&scene, start, &[0.0], 5);
        if rays.len() == 4 {
            returned += 1;
            worst = worst.max(angle(line(&scene, &rays[3]).1, -start.1));
        }
    }
    case.at_most("returned rays: largest angle to antiparallel, rad", worst, 1e-6);
    case.holds("rays returned after three reflections", "some thousands", format!("{returned}"), returned > 1000);
}
