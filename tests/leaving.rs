//! Rays that leave a surface do not meet it again, at any scale and under any transform; nor do they pass through.

mod common;

use common::scenes::{Job, camera, point_light, render, scene};
use etendue::desc::{BsdfDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::math::{Bounds, DAffine3, DQuat, DVec3, Ray, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};

const GREY: BsdfDesc = BsdfDesc::Lambert { albedo: Vec3::splat(0.5) };

fn random_point(rng: &mut Rng) -> DVec3 {
    let [x, y, z, _] = rng.next_4d().map(|u| 2.0 * f64::from(u) - 1.0);
    DVec3::new(x, y, z)
}

/// Shoots at the scene's only surface from around, then away from each hit on both sides of it; returns (hits, rays
/// that met a flat surface again or, on a convex closed one, met it again from outside).
fn rehits(scene: &Scene, middle: Vec3, reach: f32, rng: &mut Rng, hits: usize) -> (usize, usize) {
    let (mut found, mut again) = (0, 0);
    for _ in 0..100 * hits {
        if found == hits {
            break;
        }
        let [a, b, c, d] = rng.next_4d();
        let origin = middle + 3.0 * reach * warps::uniform_sphere([a, b]);
        let aim = middle + 0.7 * reach * warps::uniform_sphere([c, d]);
        let ray = Ray::new(origin, (aim - origin).normalize());
        let Some(hit) = scene.intersect(&ray) else { continue };
        found += 1;
        let surface = scene.interaction(&ray, &hit);
        let outside = if surface.ng.dot(ray.direction) < 0.0 { surface.ng } else { -surface.ng };
        let frame = etendue::math::Frame::from_normal(outside);
        for _ in 0..100 {
            let away = frame.to_world(warps::uniform_hemisphere(rng.next_2d()));
            let leaving = Ray::new(surface.point.offset(outside), away);
            again += usize::from(scene.intersect(&leaving).is_some());
        }
    }
    (found, again)
}

fn build(desc: &SceneDesc, listed: usize) -> Scene {
    Scene::build(desc, &BuildOptions { threads: 1, listed_shapes: Some(listed), ..BuildOptions::default() })
        .expect("a scene of the test")
}

fn single(shape: ShapeDesc, transform: DAffine3, eye: DVec3, look_at: DVec3) -> SceneDesc {
    let mut desc = scene(camera(eye, look_at, 60.0), vec![(shape, GREY, None)]);
    desc.surfaces[0].transform = transform;
    desc
}

#[test]
fn triangles_of_every_size() {
    let mut rng = Rng::new(1, 0);
    let (mut total, mut bad) = (0, 0);
    for exponent in [-8, -6, -3, 0, 3, 6, 8] {
        let scale = 10_f64.powi(exponent);
        for _ in 0..40 {
            let corners: [DVec3; 3] = std::array::from_fn(|_| scale * random_point(&mut rng));
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            // The camera, and with it the frame's origin, somewhere else in the scene: coordinates are not small.
            let desc = single(ShapeDesc::Triangle(corners), DAffine3::IDENTITY, corners[0] * 1.5, middle);
            let scene = build(&desc, 8);
            let (hits, again) = rehits(&scene, scene.to_scene(middle), 0.3 * scale as f32, &mut rng, 100);
            total += 100 * hits;
            bad += again;
        }
    }
    println!("{bad} of {total} rays met the triangle they left");
    assert!(total > 500_000);
    assert_eq!(bad, 0);
}

#[test]
fn analytic_shapes_in_list_and_tree() {
    let mut rng = Rng::new(2, 0);
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let ellipsoid =
        ShapeDesc::Quadric { coefficients: [1.0, 4.0, 2.0, 0.3, 0.0, 0.1, 0.0, 0.0, 0.0, -1.0], clip: everywhere };
    let ball = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 };
    let disk = ShapeDesc::Disk { centre: DVec3::ZERO, normal: DVec3::new(0.6, 0.0, 0.8), radius: 1.0 };
    for shape in [ball, ellipsoid, disk] {
        for listed in [0, 8] {
            for exponent in [-6, -2, 0, 2, 6] {
                let scale = 10_f64.powi(exponent);
                let transform = DAffine3::from_scale_rotation_translation(
                    DVec3::splat(scale),
                    DQuat::from_euler(etendue::math::EulerRot::XYZ, 0.3, 1.0, 2.0),
                    10.0 * scale * random_point(&mut rng),
                );
                let middle = transform.translation;
                let desc = single(shape, transform, middle + DVec3::splat(3.0 * scale), middle);
                let scene = build(&desc, listed);
                let (hits, again) = rehits(&scene, scene.to_scene(middle), scale as f32, &mut rng, 2000);
                assert!(hits > 1000, "{hits} hits");
                assert_eq!(again, 0, "{shape:?} at scale {scale}, listed {listed}: {again} of {} rays", 100 * hits);
            }
        }
    }
}

/// A convex mesh (a tessellated ball, outward winding), used twice so that it is instanced.
fn ball_mesh(rings: u32, sectors: u32) -> MeshDesc {
    let mut mesh = MeshDesc { name: "ball".into(), path: "meshes[0]".into(), ..MeshDesc::default() };
    for ring in 0..=rings {
        for sector in 0..sectors {
            let theta = f64::from(ring) / f64::from(rings) * std::f64::consts::PI;
            let phi = f64::from(sector) / f64::from(sectors) * std::f64::consts::TAU;
            mesh.positions.push(DVec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()));
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let next = (sector + 1) % sectors;
            let [a, b] = [ring * sectors + sector, ring * sectors + next];
            let [c, d] = [a + sectors, b + sectors];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh
}

#[test]
fn instances_under_any_transform() {
    let mut rng = Rng::new(3, 0);
    let mesh = ball_mesh(60, 100);
    for (number, scale) in
        [DVec3::ONE, DVec3::new(1.0, 1e3, 1e-1), DVec3::new(-1.0, 1.0, 1.0), DVec3::splat(1e-5)].into_iter().enumerate()
    {
        let rotation = DQuat::from_euler(etendue::math::EulerRot::XYZ, 0.5, 1.1, 2.2);
        let stretch = scale.abs().max_element();
        let place =
            |t: DVec3| DAffine3::from_rotation_translation(rotation, 20.0 * stretch * t) * DAffine3::from_scale(scale);
        let middle = DVec3::ZERO;
        let shape = ShapeDesc::Mesh { mesh: 0, smooth: false };
        let mut desc = scene(
            camera(middle + DVec3::splat(3.0 * stretch), middle, 60.0),
            vec![(shape, GREY, None), (shape, GREY, None)],
        );
        desc.meshes.push(mesh.clone().into());
        desc.surfaces[0].transform = place(DVec3::ZERO);
        desc.surfaces[1].transform = place(DVec3::X * 1e3);
        let scene = build(&desc, 8);
        assert_eq!(scene.info().instances, 2, "transform {number}");

        // Normals point outwards, whatever the handedness.
        let (mut hits, mut outwards, mut again) = (0, 0, 0);
        for _ in 0..4000 {
            let [a, b] = rng.next_2d();
            let direction = warps::uniform_sphere([a, b]).as_dvec3();
            let target = desc.surfaces[0].to_world().transform_point3(0.5 * direction);
            let origin = desc.surfaces[0].to_world().transform_point3(4.0 * direction);
            let ray = Ray::new(scene.to_scene(origin), (target - origin).normalize().as_vec3a());
            let Some(hit) = scene.intersect(&ray) else { continue };
            hits += 1;
            let surface = scene.interaction(&ray, &hit);
            outwards += usize::from(surface.ng.dot(ray.direction) < 0.0);
            let frame = etendue::math::Frame::from_normal(surface.ng);
            for _ in 0..20 {
                let away = frame.to_world(warps::uniform_hemisphere(rng.next_2d()));
                // A convex body is left for good; only the far second ball may be met.
                let leaving = Ray { tfar: 10.0 * stretch as f32, ..Ray::new(surface.point.offset(surface.ng), away) };
                again += usize::from(scene.intersect(&leaving).is_some());
            }
        }
        println!("transform {number}: {hits} hits, {again} of {} rays met the ball again", 20 * hits);
        assert!(hits > 3900, "transform {number}: {hits} hits of 4000");
        assert_eq!(outwards, hits, "transform {number}");
        assert!(again * 100_000 <= 20 * hits, "transform {number}: {again} of {}", 20 * hits);
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    // A plane tilted by 30 degrees under a point light: intensity grows with the square of the scale.
    let image = |exponent: i32| {
        let scale = f64::from(exponent).exp2();
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        let corner = |x: f64, y: f64| scale * DVec3::new(x, y * cos, y * sin);
        let plane = ShapeDesc::Quad([corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)]);
        let mut desc = scene(camera(scale * DVec3::new(0.2, 0.1, 3.0), DVec3::ZERO, 40.0), vec![(plane, GREY, None)]);
        desc.lights.push(point_light(scale * DVec3::new(0.0, -0.5, 0.866), (scale * scale) as f32));
        render(&desc, &Job { resolution: [48, 48], samples: 4, ..Job::default() }).0
    };
    let reference = image(0);
    assert!(reference.rgb.iter().all(|&value| value > 0.0), "acne");
    for exponent in [-20, -10, 10, 20] {
        assert!(image(exponent).rgb == reference.rgb, "another picture at scale 2^{exponent}");
    }
}

#[test]
fn thin_walls_do_not_leak() {
    // Two opaque sheets 1e-4 apart, light on the far side: nothing comes through, not even at the scale of 1e3.
    for scale in [1e-3, 1.0, 1e3] {
        let sheet = |z: f64| {
            let corner = |x: f64, y: f64| scale * DVec3::new(x, y, z + 0.31 * x + 0.17 * y);
            ShapeDesc::Quad([corner(-1e3, -1e3), corner(1e3, -1e3), corner(1e3, 1e3), corner(-1e3, 1e3)])
        };
        let eye = scale * DVec3::new(0.0, 0.0, 1.0);
        let mut desc =
            scene(camera(eye, DVec3::ZERO, 80.0), vec![(sheet(0.0), GREY, None), (sheet(-1e-4), GREY, None)]);
        desc.lights.push(point_light(scale * DVec3::new(0.1, 0.2, -1.0), (scale * scale) as f32));
        let (image, _) = render(&desc, &Job { resolution: [64, 64], samples: 16, ..Job::default() });
        assert!(image.rgb.iter().all(|&value| value == 0.0), "scale {scale}: light behind two sheets");
    }
}

#[test]
fn list_and_tree_agree_at_every_scale() {
    // A ball between a lamp and the floor: its shadow must not depend on where it is tested, nor on the scale.
    let image = |exponent: i32, listed: usize| {
        let scale = f64::from(exponent).exp2();
        let corner = |x: f64, z: f64, y: f64| scale * DVec3::new(x, y, z);
        let floor = [corner(-2.0, -2.0, 0.0), corner(-2.0, 2.0, 0.0), corner(2.0, 2.0, 0.0), corner(2.0, -2.0, 0.0)];
        let ball = ShapeDesc::Sphere { centre: scale * DVec3::new(0.1, 1.0, 0.0), radius: 0.5 * scale };
        let eye = scale * DVec3::new(0.0, 2.0, 3.0);
        let mut desc =
            scene(camera(eye, DVec3::ZERO, 60.0), vec![(ShapeDesc::Quad(floor), GREY, None), (ball, GREY, None)]);
        desc.lights.push(point_light(scale * DVec3::new(0.0, 3.0, 0.5), (scale * scale) as f32));
        let scene = build(&desc, listed);
        let job = Job { resolution: [32, 32], samples: 4, ..Job::default() };
        common::scenes::render_scene(&scene, job.desc()).0.rgb
    };
    let reference = image(0, 8);
    for exponent in [-25, 0, 29, 33] {
        let (list, tree) = (image(exponent, 8), image(exponent, 0));
        assert!(list == tree, "list and tree differ at scale 2^{exponent}");
        assert!(list == reference, "another picture at scale 2^{exponent}");
    }
}
