//! Where light ends on a surface, and where shadow rays end on a light.

use std::collections::HashMap;
use std::f64::consts::PI;

use etendue::camera::Camera;
use etendue::desc::{BsdfDesc, ConductorDesc, IntegratorDesc, MicrofacetsDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DQuat, DVec3, EulerRot, Ray, Vec3};
use etendue::sampling::Rng;
use etendue::scene::{Scene, SurfaceInteraction};
use etendue::spectrum::Rgb;

use super::instances::ball_mesh;
use super::spawn::{LIST, away, build, random_direction, signed};
use crate::common::scenes::{Job, add, box_inside, camera, mean_and_error, point_light, render, render_scene, scene};
use crate::record::{Case, Entry, Within};
use crate::transport::pick;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "S26", title: "terminator", run: terminator },
        Entry { id: "S26a", title: "terminator of a ball of facets", run: facets },
        Entry { id: "S26b", title: "shadow rays onto far, oblique lights", run: oblique_light },
        Entry { id: "S26c", title: "inside and outside of glass", run: glass },
        Entry { id: "S26d", title: "smooth white meshes in a furnace", run: smooth_furnace },
    ]
}

const WHITE: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::ONE };

fn terminator(case: &mut Case) {
    let light = DVec3::new(0.0, 3.0, 0.0);
    for cos in [0.1, 0.01, 0.001] {
        for exponent in [-6, 0, 6] {
            let scale = 10_f64.powi(exponent);
            // Where the unit sphere around the origin sees the light under this angle: at height h it is d away with
            // d^2 = 10 - 6 h, and (3 h - 1) / d = cos.
            let (a, b, c) = (9.0, -6.0 + 6.0 * cos * cos, 1.0 - 10.0 * cos * cos);
            let height: f64 = (-b + f64::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
            let p = DVec3::new((1.0 - height * height).sqrt(), height, 0.0);
            let ball = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: scale };
            let mut desc = scene(camera(scale * 2.0 * p, scale * p, 1e-4), vec![(ball, WHITE, None)]);
            desc.lights.push(point_light(scale * light, (scale * scale) as f32));
            let (image, _) =
                render(&desc, &Job { resolution: [8; 2], samples: 16, max_depth: Some(1), ..Job::default() });
            let mean = image.mean()[0];
            let expected = cos / (PI * (light - p).length_squared());
            case.exact(format!("cos {cos}, size 10^{exponent}"), mean, expected, Within::Relative(1e-3));
        }
    }
}

/// Facets of a smoothly shaded ball under a point light: none that the light reaches under a cosine above 0.02 is all black,
/// and where it is below the face's horizon there is no light.
fn facets(case: &mut Case) {
    let size = case.count(256, 1024) as u32;
    for rings in [16, 60] {
        let (mut black, mut facets, mut leaks, mut behind) = (0, 0, 0, 0);
        for exponent in [-6, 0, 6] {
            let scale = 10_f64.powi(exponent);
            let mesh = ShapeDesc::Mesh { mesh: 0, smooth: true };
            let mut desc =
                scene(camera(scale * DVec3::new(0.5, 0.7, 4.0), DVec3::ZERO, 30.0), vec![(mesh, WHITE, None)]);
            desc.meshes.push(ball_mesh(rings, 2 * rings).into());
            desc.surfaces[0].transform = DAffine3::from_scale(DVec3::splat(scale));
            let light = scale * DVec3::new(6.0, 2.0, 0.5);
            desc.lights.push(point_light(light, (scale * scale) as f32));
            let scene = build(&desc, LIST);
            let job = Job { resolution: [size; 2], samples: 1, integrator: IntegratorDesc::Direct, ..Job::default() };
            let image = render_scene(&scene, job.desc()).0;
            let view = Camera::new(&desc.camera, [size; 2], scene.centre()).expect("a camera of the test");
            // Pixels whose filter sees one facet only.
            let at = |x: f32, y: f32| {
                let ray = view.ray(x, y);
                scene.intersect(&ray).map(|hit| scene.interaction(&ray, &hit))
            };
            let mut lit: HashMap<[u32; 3], bool> = HashMap::new();
            for y in (2..size - 2).step_by(2) {
                for x in (2..size - 2).step_by(2) {
                    let [centre_x, centre_y] = [x as f32 + 0.5, y as f32 + 0.5];
                    let Some(middle) = at(centre_x, centre_y) else { continue };
                    let around = [(-2.0, -2.0), (2.0, -2.0), (-2.0, 2.0), (2.0, 2.0)];
                    let same = |seen: SurfaceInteraction| seen.ng == middle.ng;
                    if !around.iter().all(|(dx, dy)| at(centre_x + dx, centre_y + dy).is_some_and(same)) {
                        continue;
                    }
                    let value = image.rgb[3 * (y * size + x) as usize];
                    let to_light = (scene.to_scene(light) - middle.point.p).normalize();
                    let cos = middle.ng.dot(to_light);
                    if cos > 0.02 {
                        *lit.entry(middle.ng.to_array().map(f32::to_bits)).or_default() |= value > 0.0;
                    } else if cos < -0.01 {
                        // A facet is flat, so that the cosine changes little over it; a light six radii away.
                        behind += 1;
                        leaks += u64::from(value > 0.0);
                    }
                }
            }
            facets += lit.len() as u64;
            black += lit.values().filter(|lit| !**lit).count() as u64;
        }
        case.never(format!("{rings} rings: black facets"), black, facets);
        case.never(format!("{rings} rings: pixels with light from behind"), leaks, behind);
    }
}

/// What interpolated normals lose: little, less on a finer mesh, and nothing is gained.
fn smooth_furnace(case: &mut Case) {
    let metal = |roughness| BsdfDesc::Conductor {
        conductor: ConductorDesc::Reflectance { normal: Rgb::ONE, edge: Rgb::ONE },
        microfacets: MicrofacetsDesc::rough(roughness),
    };
    let models = [
        ("Lambert", WHITE),
        ("mirror", BsdfDesc::Mirror { reflectance: Rgb::ONE }),
        ("metal 0.3", metal(0.3)),
        ("metal 0.7", metal(0.7)),
    ];
    for (name, bsdf) in models {
        for (rings, most) in [(8, 1.5e-2), (16, 5e-3), (60, 5e-4)] {
            let mesh = |mesh, smooth| ShapeDesc::Mesh { mesh, smooth };
            let surfaces = vec![(mesh(0, true), bsdf, None), (mesh(1, false), BsdfDesc::Black, Some(Rgb::ONE))];
            let mut desc = scene(camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 23.0), surfaces);
            desc.meshes.push(ball_mesh(rings, 2 * rings).into());
            desc.meshes.push(box_inside(DVec3::splat(-10.0), DVec3::splat(10.0)).into());
            let samples = case.count(64, 1024) as u32;
            let (image, _) = render(&desc, &Job { resolution: [64; 2], samples, ..Job::default() });
            let (mean, error) = mean_and_error(&image);
            case.at_most(format!("{name}, {rings} rings: gained beyond 4 s"), mean - 1.0 - 4.0 * error, 1e-4);
            case.at_most(format!("{name}, {rings} rings: lost beyond 4 s"), 1.0 - mean - 4.0 * error, most);
            case.at_most(format!("{name}, {rings} rings: standard error"), error, pick(case, 2e-3, 5e-4));
        }
    }
}

/// A small light that is seen from far away at a grazing angle: the shadow ray ends at it, and must not take it for an
/// obstacle. The camera, and with it the origin of the scene's frame, is near the light.
fn oblique_light(case: &mut Case) {
    let distance = 1e4_f64;
    // Not along the axes, where single precision is kinder.
    let turn = DAffine3::from_quat(DQuat::from_euler(EulerRot::XYZ, 0.5, 1.1, 2.2));
    for cos in [1.0, 1e-1, 1e-2, 1e-3] {
        for (what, is_sphere, half) in [
            ("quad", false, 1e-2),
            ("quad", false, 1.0),
            ("quad", false, 30.0),
            ("sphere", true, 1e-2),
            ("sphere", true, 30.0),
        ] {
            if is_sphere && cos < 1.0 {
                // It is oblique at its rim anyway.
                continue;
            }
            let sin = f64::sqrt(1.0 - cos * cos);
            // The wall z = -distance; the light's normal is (sin, 0, -cos).
            let wall = {
                let corner = |x: f64, y: f64| DVec3::new(x, y, -distance);
                ShapeDesc::Quad([corner(-10.0, -10.0), corner(10.0, -10.0), corner(10.0, 10.0), corner(-10.0, 10.0)])
            };
            let (u, v) = (DVec3::new(cos, 0.0, sin) * half, DVec3::Y * half);
            let light = if is_sphere {
                ShapeDesc::Sphere { centre: DVec3::ZERO, radius: half }
            } else {
                ShapeDesc::Quad([-u - v, v - u, u + v, u - v])
            };
            let strength = (distance / half).powi(2);
            let surfaces = vec![(wall, WHITE, None), (light, BsdfDesc::Black, Some(Rgb::splat(strength as f32)))];
            let eye = DVec3::new(0.0, 3.0 * half, 0.0);
            let look_at = DVec3::new(0.0, 0.0, -distance);
            let [eye, look_at] = [eye, look_at].map(|p| turn.transform_point3(p));
            let mut desc = scene(camera(eye, look_at, 0.01), surfaces);
            for surface in &mut desc.surfaces {
                surface.transform = turn;
            }
            // Radiance: strength times the projected solid angle, over pi.
            let seen = if is_sphere { PI * half * half } else { 4.0 * half * half * cos };
            let expected = strength * seen / (distance * distance) / PI;
            let job = Job { resolution: [16; 2], samples: 64, integrator: IntegratorDesc::Direct, ..Job::default() };
            let found = mean_and_error(&render(&desc, &job).0);
            // An oblique quad is a little nearer at one end, which to first order evens out.
            let what = format!("{what} of half side {half}, cos {cos}");
            case.exact(what, found.0, expected, Within::Relative(1e-3));
        }
    }
}

fn refracted(d: Vec3, n: Vec3, eta: f32) -> Option<Vec3> {
    let (d, n, eta) = (d.as_dvec3(), n.as_dvec3(), f64::from(eta));
    let cos = -d.dot(n);
    let sin2 = eta * eta * (1.0 - cos * cos);
    (sin2 < 1.0).then(|| (eta * d + (eta * cos - (1.0 - sin2).sqrt()) * n).normalize().as_vec3a())
}

/// Rays that enter a body of glass, are reflected in it, and leave again: each must be met from the right side.
fn follow(scene: &Scene, ray: Ray, rng: &mut Rng, count: &mut [u64; 2]) {
    let mut ray = ray;
    let mut is_inside = false;
    for _ in 0..20 {
        let Some(hit) = scene.intersect(&ray) else {
            count[1] += u64::from(is_inside);
            return;
        };
        let hit = scene.interaction(&ray, &hit);
        let is_back = hit.ng.dot(ray.direction) > 0.0;
        count[0] += 1;
        if hit.surface != 0 {
            // The floor or the walls, from outside the glass.
            count[1] += u64::from(is_inside);
            return;
        }
        if is_back != is_inside {
            count[1] += 1;
            return;
        }
        let n = if is_back { -hit.ng } else { hit.ng };
        let through = refracted(ray.direction, n, if is_inside { 1.5 } else { 1.0 / 1.5 });
        ray = match through.filter(|_| signed(rng) < 0.3) {
            Some(direction) => {
                is_inside = !is_inside;
                Ray::new(hit.point.offset(-n), direction)
            }
            None => {
                let direction = ray.direction - 2.0 * ray.direction.dot(n) * n;
                Ray::new(hit.point.offset(n), direction.normalize())
            }
        };
    }
}

fn glass(case: &mut Case) {
    let mut rng = Rng::new(26, 0);
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let slab = |thickness: f64| box_inside(DVec3::new(-0.5, -thickness, -0.5), DVec3::new(0.5, 0.0, 0.5));
    let ball = ShapeDesc::Sphere { centre: DVec3::new(0.0, 0.25, 0.0), radius: 0.25 };
    let plate = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let floor = |y: f64| {
        let corner = |x: f64, z: f64| DVec3::new(x, y, z);
        ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)])
    };
    for (what, shape, floor, thickness) in [
        ("sphere on a plane", ball, floor(0.0), 1.0),
        ("slab 10^-4 thick", plate, floor(-0.5), 1e-4),
        ("slab 10^-5 thick", plate, floor(-0.5), 1e-5),
    ] {
        let desc = |scale: f64| {
            let mut desc = SceneDesc::default();
            add(&mut desc, 0, shape, glass, None);
            add(&mut desc, 1, floor, WHITE, None);
            let mut mesh = slab(thickness);
            for corners in &mut mesh.triangles {
                corners.swap(1, 2);
            }
            desc.meshes.push(mesh.into());
            for surface in &mut desc.surfaces {
                surface.transform = DAffine3::from_scale(DVec3::splat(scale));
            }
            desc.camera = camera(scale * DVec3::new(0.3, 0.8, 1.0), DVec3::ZERO, 50.0);
            desc
        };
        let mut count = [0, 0];
        for exponent in [-6, -3, 0, 3, 6] {
            let scale = 10_f64.powi(exponent);
            let scene = build(&desc(scale), LIST);
            for _ in 0..case.count(300, 20_000) {
                let aim = scale * DVec3::new(0.2 * signed(&mut rng), 0.0, 0.2 * signed(&mut rng));
                let up = away(Vec3::Y, &mut rng).as_dvec3();
                let from = scene.to_scene(
                    aim + scale * (0.6 * up + 1e-3 * random_direction(&mut rng)).with_y(0.6 * up.y.max(0.01)),
                );
                let ray = Ray::new(from, (scene.to_scene(aim) - from).normalize());
                follow(&scene, ray, &mut rng, &mut count);
            }
        }
        // Where the sphere touches the plane, the gap is narrower than the offset.
        let share = if thickness == 1.0 { 1e-3 } else { 0.0 };
        case.rarely(format!("{what}: met from the wrong side"), count[1], count[0], share);

        // In a room that shines evenly glass is invisible: radiance 1, whatever was refracted or reflected how often.
        let mut desc = desc(1.0);
        desc.meshes.push(box_inside(DVec3::splat(-1.3), DVec3::splat(1.3)).into());
        desc.surfaces[1].shape = ShapeDesc::Mesh { mesh: 1, smooth: false };
        desc.materials[1].bsdf = BsdfDesc::Black;
        desc.surfaces[1].emission = Some(Rgb::ONE);
        let job = Job { resolution: [64; 2], samples: case.count(128, 256) as u32, ..Job::default() };
        let (image, _) = render(&desc, &job);
        let dark = image.rgb.iter().filter(|&&value| f64::from((value - 1.0).abs()) > 0.5).count() as u64;
        case.never(format!("{what}, even light: pixels off by half"), dark, image.rgb.len() as u64);
        // What enters a slab by its edge is guided through it by thousands of reflections, and so ends by roulette: the rare
        // path that survives with all the others' weight is not among these, hence no test of the mean by its scatter.
        case.exact(format!("{what}, even light: mean"), image.mean()[0], 1.0, Within::Relative(1e-3));
    }
}
