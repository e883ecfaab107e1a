//! Surfaces that are near to each other: thin walls and shells, contact, corners.

use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DVec3, Ray, Vec3};
use etendue::sampling::Rng;
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

use super::instances::ball_mesh;
use super::spawn::{GREY, LIST, TREE, Tally, away, build, met, random_direction, shoot, signed, walk};
use crate::common::scenes::{Job, add, box_inside, camera, point_light, render, render_scene, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "S23", title: "two opaque sheets, light behind", run: thin_walls },
        Entry { id: "S23a", title: "thin shells", run: shells },
        Entry { id: "S24", title: "black cube resting on a plane", run: resting_cube },
        Entry { id: "S24a", title: "touching and cutting spheres", run: touching },
        Entry { id: "S25", title: "concave corners of a closed room", run: corners },
    ]
}

/// A square of half the side `half`, tilted a little, `z` along its normal but for the tilt.
fn sheet(half: f64, z: f64) -> ShapeDesc {
    let corner = |x: f64, y: f64| DVec3::new(half * x, half * y, z + half * (0.31 * x + 0.17 * y));
    ShapeDesc::Quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
}

fn thin_walls(case: &mut Case) {
    let size = case.count(32, 128) as u32;
    for (what, half, gap, exponents) in [
        ("10^-4 of the size apart", 1.0, 1e-4, -6..=6),
        ("10^-6 of the size apart", 1.0, 1e-6, -6..=6),
        ("10^-1 apart at a size of 10^3", 1e3, 1e-1, 0..=0),
        ("10^-7 of the size apart", 1e3, 1e-4, -6..=6),
    ] {
        let (mut lit, mut tried) = (0, 0);
        for exponent in exponents {
            let scale = 10_f64.powi(exponent);
            let eye = DVec3::new(0.0, 0.0, scale);
            let sheets = [0.0, -gap * scale].map(|z| (sheet(half * scale, z), GREY, None));
            let mut desc = scene(camera(eye, DVec3::ZERO, 60.0), sheets.to_vec());
            desc.lights.push(point_light(scale * DVec3::new(0.1, 0.2, -1.0), (scale * scale) as f32));
            // Light between them too: it must not get out.
            desc.lights.push(point_light(scale * DVec3::new(0.05, 0.0, 0.0155 - 0.5 * gap), (scale * scale) as f32));
            let (image, _) = render(&desc, &Job { resolution: [size; 2], samples: 8, ..Job::default() });
            lit += image.rgb.iter().filter(|&&value| value != 0.0).count() as u64;
            tried += image.rgb.len() as u64;
        }
        case.never(format!("{what}: values that are not 0"), lit, tried);
    }
}

fn shells(case: &mut Case) {
    let mut rng = Rng::new(23, 0);
    let ball = |radius| ShapeDesc::Sphere { centre: DVec3::ZERO, radius };
    let mesh = ShapeDesc::Mesh { mesh: 0, smooth: false };
    for (what, inner, thickness) in [
        ("sphere in sphere, 10^-4", ball(1.0 - 1e-4), 1e-4),
        ("sphere in sphere, 10^-6", ball(1.0 - 1e-6), 1e-6),
        ("mesh in sphere, 10^-4", mesh, 1e-4),
        ("mesh in sphere, 10^-6", mesh, 1e-6),
    ] {
        let (mut walked, mut through) = (Tally::default(), Tally::default());
        for exponent in [-6, -3, 0, 3, 6] {
            let scale = 10_f64.powi(exponent);
            // The origin of the scene's frame is two radii away.
            let eye = DVec3::new(1.0, 1.0, 2.0) * scale;
            let mut desc = scene(camera(eye, DVec3::ZERO, 60.0), vec![(ball(1.0), GREY, None), (inner, GREY, None)]);
            desc.meshes.push(ball_mesh(60, 100).into());
            let shrink = if matches!(inner, ShapeDesc::Mesh { .. }) { 1.0 - thickness } else { 1.0 };
            desc.surfaces[0].transform = DAffine3::from_scale(DVec3::splat(scale));
            desc.surfaces[1].transform = DAffine3::from_scale(DVec3::splat(scale * shrink));
            for listed in [LIST, TREE] {
                let scene = build(&desc, listed);
                for _ in 0..case.count(50, 2000) {
                    // In the shell, nearer to its outer side: the mesh is inside of its sphere.
                    let direction = random_direction(&mut rng);
                    let origin = scene.to_scene((1.0 - 0.5 * thickness) * scale * direction);
                    let ray = Ray::new(origin, random_direction(&mut rng).as_vec3a());
                    walked.add(walk(&scene, ray, 30, &mut rng, |surface, is_back| is_back == (surface == 0)));
                    // And in the ball.
                    let ray = Ray::new(scene.to_scene(0.5 * scale * direction), direction.as_vec3a());
                    through.add(walk(&scene, ray, 10, &mut rng, |surface, is_back| surface == 1 && is_back));
                }
            }
        }
        case.never(format!("{what}: rays that left the shell"), walked.bad, walked.rays);
        case.never(format!("{what}: rays that left the inside"), through.bad, through.rays);
    }
}

/// A white plane y = 0 with a black cube of side 1 on it.
fn cube_on_plane(scale: f64, is_mesh: bool, light: DVec3) -> SceneDesc {
    let corner = |x: f64, z: f64| scale * DVec3::new(x, 0.0, z);
    let mut plane = ShapeDesc::Quad([corner(-4.0, -4.0), corner(-4.0, 4.0), corner(4.0, 4.0), corner(4.0, -4.0)]);
    let mut desc = SceneDesc::default();
    let mut cube = box_inside(scale * DVec3::new(-0.5, 0.0, -0.5), scale * DVec3::new(0.5, 1.0, 0.5));
    for corners in &mut cube.triangles {
        corners.swap(1, 2);
    }
    desc.meshes.push(cube.into());
    if is_mesh {
        let mut mesh = box_inside(corner(-4.0, -4.0), corner(4.0, 4.0) + scale * DVec3::Y);
        mesh.triangles.retain(|corners| corners.iter().all(|&i| mesh.positions[i as usize].y == 0.0));
        desc.meshes.push(mesh.into());
        plane = ShapeDesc::Mesh { mesh: 1, smooth: false };
    }
    add(&mut desc, 0, plane, BsdfDesc::Lambert { albedo: Rgb::ONE }, None);
    add(&mut desc, 1, ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Black, None);
    desc.lights.push(point_light(scale * light, (scale * scale) as f32));
    desc.camera = camera(scale * DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, 60.0);
    desc
}

fn resting_cube(case: &mut Case) {
    let mut rng = Rng::new(24, 0);
    let light = DVec3::new(2.0, 3.0, 0.3);
    let mut lit = Tally::default();
    for exponent in [-6, -3, 0, 3, 6] {
        let scale = 10_f64.powi(exponent);
        for is_mesh in [false, true] {
            let scene = build(&cube_on_plane(scale, is_mesh, light), LIST);
            let to_light = scene.to_scene(scale * light);
            for _ in 0..case.count(400, 20_000) {
                // From below: either of the two faces that coincide may be met.
                let aim = scale * DVec3::new(0.499 * signed(&mut rng), 0.0, 0.499 * signed(&mut rng));
                let from = aim + scale * DVec3::new(signed(&mut rng), -1.0, signed(&mut rng));
                let [from, aim] = [from, aim].map(|p| scene.to_scene(p));
                let ray = Ray::new(from, (aim - from).normalize());
                let Some(hit) = scene.intersect(&ray) else { continue };
                let point = scene.interaction(&ray, &hit).point;
                let origin = point.offset(Vec3::Y);
                let shadow = Ray { tfar: 1.0, ..Ray::new(origin, to_light - origin) };
                let up = Ray::new(origin, away(Vec3::Y, &mut rng));
                lit.rays += 2;
                lit.bad += u64::from(scene.unoccluded(&shadow)) + u64::from(scene.unoccluded(&up));
            }
        }
    }
    case.never("under it: rays that get out", lit.bad, lit.rays);

    // Along the two edges of its base, 10^-3 outside, on the light's side and on the other.
    let (mut worst, mut in_shadow, mut tried) = (0.0_f64, 0, 0);
    for exponent in [-6, 0, 6] {
        let scale = 10_f64.powi(exponent);
        for along in [-0.45, -0.2, 0.0, 0.3, 0.47] {
            for side in [0.501, -0.501] {
                let p = DVec3::new(side, 0.0, along);
                let mut desc = cube_on_plane(scale, false, light);
                let view = DVec3::new(side.signum(), 1.5, 0.2);
                desc.camera = camera(scale * (p + view), scale * p, 0.001);
                let job = Job { resolution: [4; 2], samples: 4, max_depth: Some(1), ..Job::default() };
                let (image, _) = render(&desc, &job);
                if side < 0.0 {
                    tried += image.rgb.len() as u64;
                    in_shadow += image.rgb.iter().filter(|&&value| value != 0.0).count() as u64;
                    continue;
                }
                let to_light = light - p;
                let expected = to_light.normalize().y / (std::f64::consts::PI * to_light.length_squared());
                let off = |&value: &f32| (f64::from(value) / expected - 1.0).abs();
                worst = worst.max(image.rgb.iter().map(off).fold(0.0, f64::max));
            }
        }
    }
    case.at_most("10^-3 outside, towards the light: worst pixel", worst, 1e-3);
    case.never("10^-3 outside, in the shadow: lit values", in_shadow, tried);
}

/// Rays that leave a body near the point where the unit sphere around (0, 1, 0) touches it.
fn touching(case: &mut Case) {
    let mut rng = Rng::new(57, 0);
    let ball = |y: f64| ShapeDesc::Sphere { centre: DVec3::new(0.0, y, 0.0), radius: 1.0 };
    let corner = |x: f64, z: f64| 1.2 * DVec3::new(x, 0.0, z);
    let floor = ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
    // Around everything, and through the floor.
    let dome = |y: f64, radius: f64| ShapeDesc::Sphere { centre: DVec3::new(0.0, y, 0.0), radius };
    for (what, lower, dome) in
        [("two spheres", ball(-1.0), dome(0.0, 3.0)), ("sphere on a mesh", floor, dome(1.0, 1.5))]
    {
        // From the contact: at 5e-3 the gap becomes ten offsets wide.
        for (near, [low, high]) in [("at 5e-3 .. 1e-1", [5e-3_f64, 1e-1]), ("at 1e-4 .. 5e-3", [1e-4, 5e-3])] {
            let mut tally = Tally::default();
            for exponent in [-6, 0, 6] {
                let scale = 10_f64.powi(exponent);
                let surfaces = vec![(ball(1.0), GREY, None), (lower, GREY, None), (dome, GREY, None)];
                let mut desc = scene(camera(scale * DVec3::new(2.0, 1.0, 2.0), DVec3::ZERO, 60.0), surfaces);
                for surface in &mut desc.surfaces {
                    surface.transform = DAffine3::from_scale(DVec3::splat(scale));
                }
                let scene = build(&desc, if exponent == 0 { LIST } else { TREE });
                for _ in 0..case.count(150, 10_000) {
                    let radius = low * (high / low).powf(0.5 * (signed(&mut rng) + 1.0));
                    let (sin, cos) = (3.2 * signed(&mut rng)).sin_cos();
                    let gap = DVec3::new(radius * cos, 0.2 * radius * radius, radius * sin);
                    // Straight onto one of the bodies, and away from it: bodies are met from outside, the dome from inside.
                    let ray = Ray::new(scene.to_scene(scale * gap), signed(&mut rng).signum() as f32 * Vec3::Y);
                    tally.add(walk(&scene, ray, 2, &mut rng, |surface, is_back| is_back == (surface == 2)));
                }
            }
            if high > 1e-2 {
                case.never(format!("{what}, {near}: rays into a body"), tally.bad, tally.rays);
            } else {
                case.known(CONTACT).never(format!("{what}, {near}: rays into a body"), tally.bad, tally.rays);
            }
        }
    }

    // A mesh cut by a sphere: what is between them on the inside stays there.
    let mut tally = Tally::default();
    let centre = DVec3::new(0.1, 0.4, -0.2);
    let surfaces = vec![(ShapeDesc::Sphere { centre, radius: 1.0 }, GREY, None), (floor, GREY, None)];
    let scene = build(&scene(camera(DVec3::new(2.0, 1.0, 2.0), DVec3::ZERO, 60.0), surfaces), LIST);
    for _ in 0..case.count(1000, 20_000) {
        let direction = DVec3::new(signed(&mut rng), -1.0, signed(&mut rng)).normalize();
        let ray = Ray::new(scene.to_scene(centre), direction.as_vec3a());
        tally.add(walk(&scene, ray, 20, &mut rng, |surface, is_back| is_back == (surface == 0)));
    }
    case.never("sphere cut by a mesh: rays that left it", tally.bad, tally.rays);
}

/// Why rays near a contact enter the other body.
const CONTACT: &str = "nearer to the contact than the square root of the offset, the gap is narrower than the offset";

fn corners(case: &mut Case) {
    let mut rng = Rng::new(25, 0);
    let escape = |scene: &Scene, aim: DVec3, rays: u64, rng: &mut Rng| {
        let mut escaped = Tally::default();
        let from = scene.to_scene(aim + DVec3::new(0.3, 0.4, 0.2));
        // Around the edge: the floor or the wall may be met.
        let Some(point) = shoot(scene, from, scene.to_scene(aim), 0) else {
            (escaped.rays, escaped.bad) = (1, 1);
            return escaped;
        };
        for _ in 0..rays {
            let ray = Ray::new(point.point.offset(point.ng), away(point.ng, rng));
            escaped.rays += 1;
            escaped.bad += u64::from(met(scene, &ray).is_none());
        }
        escaped
    };
    for (what, min, eye) in [
        ("unit room, eye in it", DVec3::ZERO, DVec3::new(0.6, 0.5, 0.4)),
        ("unit room, eye in the corner", DVec3::ZERO, DVec3::new(1e-3, 1e-3, 1e-3)),
        ("unit room a million off", DVec3::splat(1e6), DVec3::splat(1e6) + 0.5),
    ] {
        let mut desc =
            scene(camera(eye, eye + DVec3::X, 60.0), vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, GREY, None)]);
        desc.meshes.push(box_inside(min, min + 1.0).into());
        let scene = build(&desc, LIST);
        let (mut edge, mut closer, mut corner) = (Tally::default(), Tally::default(), Tally::default());
        let points = case.count(200, 3400);
        for _ in 0..points {
            let along = 0.25 * (signed(&mut rng) + 1.0);
            edge.add(escape(&scene, min + DVec3::new(along, 0.0, 1e-6), case.count(150, 1000), &mut rng));
            closer.add(escape(&scene, min + DVec3::new(along, 0.0, 1e-7), case.count(50, 300), &mut rng));
            corner.add(escape(&scene, min + DVec3::new(1e-6, 0.0, 1e-6), case.count(50, 300), &mut rng));
        }
        case.never(format!("{what}, 10^-6 from an edge: escaped"), edge.bad, edge.rays);
        case.never(format!("{what}, 10^-7 from an edge: escaped"), closer.bad, closer.rays);
        case.never(format!("{what}, 10^-6 from a corner: escaped"), corner.bad, corner.rays);
    }
    // A closed room with a lamp outside: every pixel is black.
    let mut desc = scene(
        camera(DVec3::splat(0.5), DVec3::ZERO, 100.0),
        vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Lambert { albedo: Rgb::splat(0.9) }, None)],
    );
    desc.meshes.push(box_inside(DVec3::ZERO, DVec3::ONE).into());
    desc.lights.push(point_light(DVec3::new(-0.2, -0.3, -0.1), 1.0));
    let size = case.count(32, 128) as u32;
    let (image, _) =
        render_scene(&build(&desc, LIST), Job { resolution: [size; 2], samples: 16, ..Job::default() }.desc());
    let lit = image.rgb.iter().filter(|&&value| value != 0.0).count() as u64;
    case.never("closed room, lamp outside: lit values", lit, image.rgb.len() as u64);
}
