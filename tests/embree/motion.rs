//! Geometry that moves during the shutter interval: deforming meshes, moving instances and moving user geometry.

use std::sync::Arc;

use etendue::ErrorKind;
use etendue::embree::{
    Hit, MAX_TIME_STEPS, Scene, SceneBuilder, SceneOptions, TriangleMesh, UserGeometry, UserHit, VertexBuffer,
};
use etendue::math::{DAffine3, DQuat, DVec3, Ray, Vec3};

use super::reference::{Random, Ray64, triangle};
use super::{device, mesh_scene};

fn buffer(vertices: &[DVec3]) -> Arc<VertexBuffer> {
    let vertices = vertices.iter().map(|v| v.as_vec3a().to_array()).collect();
    Arc::new(VertexBuffer::new(vertices).expect("finite vertices"))
}

/// Loose triangles around the origin.
fn triangles(random: &mut Random, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for _ in 0..count {
        let p = random.in_cube(1.0);
        vertices.extend([0; 3].map(|_| p + random.in_cube(0.3)));
    }
    (vertices, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

fn rays(random: &mut Random, count: usize) -> Vec<Ray> {
    let mut ray = || {
        let origin = 2.0 * random.on_sphere();
        let ray = Ray::new(origin.as_vec3a(), (random.in_cube(0.8) - origin).as_vec3a());
        ray.at_time(random.unit() as f32)
    };
    (0..count).map(|_| ray()).collect()
}

/// Whether the hit of a ray is the first of the triangles at these corners, which are those of the ray's moment.
fn agrees(hit: Option<Hit>, ray: &Ray, corners: &[[DVec3; 3]]) -> Option<bool> {
    let exact = Ray64::from(ray);
    let crossings: Vec<_> = corners.iter().map(|&corners| triangle(corners, &exact)).collect();
    // Rays past an edge so closely that rounding decides are left out.
    if crossings.iter().any(|crossing| crossing.hit.is_none()) {
        return None;
    }
    let hits = crossings.iter().enumerate().filter(|(_, crossing)| crossing.hit == Some(true));
    let first = hits.min_by(|a, b| a.1.t.total_cmp(&b.1.t));
    Some(match (first, hit) {
        (None, None) => true,
        (Some((number, crossing)), Some(hit)) => {
            (crossing.t - f64::from(hit.t)).abs() < 1e-5 && number == hit.prim as usize
        }
        _ => false,
    })
}

/// Compares every query of a scene with the triangles that stand at a ray's moment.
fn compare(scene: &Scene, random: &mut Random, corners: impl Fn(f64) -> Vec<[DVec3; 3]>) {
    assert!(scene.features().motion);
    let rays = rays(random, 4000);
    let mut together = vec![None; rays.len()];
    scene.intersect_many(&rays, |i| rays[i].tfar, |i, hit| together[i] = Some(hit));
    let mut blocked = vec![false; rays.len()];
    scene.occluded_many(&rays, |i| blocked[i] = true);
    let (mut hits, mut compared) = (0, 0);
    for ((ray, together), blocked) in rays.iter().zip(together).zip(blocked) {
        let hit = scene.intersect(ray);
        assert_eq!(together, hit, "{ray:?}");
        assert_eq!((blocked, scene.occluded(ray)), (hit.is_some(), hit.is_some()), "{ray:?}");
        let Some(agrees) = agrees(hit, ray, &corners(f64::from(ray.time))) else { continue };
        assert!(agrees, "{ray:?}: {hit:?}");
        compared += 1;
        hits += usize::from(hit.is_some());
    }
    assert!(compared > 3500 && hits > 500, "{compared} compared, {hits} hits");
}

/// What stands between moments that are evenly spaced from 0 to 1.
fn between<T: Copy>(steps: &[T], time: f64, lerp: impl Fn(T, T, f64) -> T) -> T {
    let scaled = time * (steps.len() - 1) as f64;
    let step = (scaled as usize).min(steps.len() - 2);
    lerp(steps[step], steps[step + 1], scaled - step as f64)
}

#[test]
fn a_deforming_mesh_is_where_its_vertices_are_at_the_time_of_the_ray() {
    let (device, mut random) = (device(), Random(31));
    for steps in [2, 3, 5, MAX_TIME_STEPS] {
        let (first, indices) = triangles(&mut random, 40);
        let steps: Vec<Vec<DVec3>> = (0..steps)
            .map(|step| {
                let shift = if step == 0 { DVec3::ZERO } else { random.in_cube(0.5) };
                first.iter().map(|&p| (p + shift + random.in_cube(0.1)).as_vec3a().as_dvec3()).collect()
            })
            .collect();
        let buffers: Vec<_> = steps.iter().map(|vertices| buffer(vertices)).collect();
        let mesh = TriangleMesh::deforming(&buffers, indices.clone()).expect("a mesh");
        assert_eq!(mesh.time_steps(), steps.len());
        let robust = |robust| SceneOptions { robust, ..SceneOptions::default() };
        for options in [robust(true), robust(false)] {
            compare(&mesh_scene(&device, options, &mesh), &mut random, |time| {
                let numbers: Vec<usize> = (0..steps.len()).collect();
                let at = |corner: u32| {
                    let places: Vec<DVec3> = numbers.iter().map(|&step| steps[step][corner as usize]).collect();
                    between(&places, time, |a, b, weight| a.lerp(b, weight))
                };
                indices.iter().map(|triangle| triangle.map(at)).collect()
            });
        }
    }
}

#[test]
fn a_moving_instance_is_where_its_transform_is_at_the_time_of_the_ray() {
    let (device, mut random) = (device(), Random(32));
    let (vertices, indices) = triangles(&mut random, 40);
    let vertices: Vec<DVec3> = vertices.iter().map(|p| p.as_vec3a().as_dvec3()).collect();
    let mesh = TriangleMesh::shared(buffer(&vertices), indices.clone()).expect("a mesh");
    let child = mesh_scene(&device, SceneOptions::default(), &mesh);
    for count in [2, 4] {
        let steps: Vec<DAffine3> = (0..count)
            .map(|step| {
                let turn = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.4 * f64::from(step));
                let transform = DAffine3::from_scale_rotation_translation(
                    DVec3::splat(1.0) + 0.2 * random.in_cube(1.0),
                    turn,
                    random.in_cube(0.4),
                );
                DAffine3::from_cols_array(&transform.to_cols_array().map(|x| f64::from(x as f32)))
            })
            .collect();
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).expect("a scene");
        builder.add_moving_instance(&child, &steps).expect("an instance");
        let scene = builder.commit(None).expect("a build");
        compare(&scene, &mut random, |time| {
            let transform = between(&steps, time, blend);
            let at = |corner: u32| transform.transform_point3(vertices[corner as usize]);
            indices.iter().map(|triangle| triangle.map(at)).collect()
        });
    }
}

/// A mesh that deforms within an instance that turns and stretches: its points move along parabolas.
#[test]
fn a_deforming_mesh_moves_with_its_instance() {
    let (device, mut random) = (device(), Random(33));
    let (first, indices) = triangles(&mut random, 40);
    let exact = |p: DVec3| p.as_vec3a().as_dvec3();
    let steps: Vec<Vec<DVec3>> =
        (0..3).map(|_| first.iter().map(|&p| exact(p + random.in_cube(0.2))).collect()).collect();
    let buffers: Vec<_> = steps.iter().map(|vertices| buffer(vertices)).collect();
    let mesh = TriangleMesh::deforming(&buffers, indices.clone()).expect("a mesh");
    let child = mesh_scene(&device, SceneOptions::default(), &mesh);
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(1.6, 0.7, 1.1),
        DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.3),
        DVec3::new(0.3, -0.2, 0.1),
    );
    let transforms = [DAffine3::IDENTITY, turned]
        .map(|transform| DAffine3::from_cols_array(&transform.to_cols_array().map(|x| f64::from(x as f32))));
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).expect("a scene");
    builder.add_moving_instance(&child, &transforms).expect("an instance");
    let scene = builder.commit(None).expect("a build");
    compare(&scene, &mut random, |time| {
        let transform = between(&transforms, time, blend);
        let at = |corner: u32| {
            let places = [0, 1, 2].map(|step: usize| steps[step][corner as usize]);
            transform.transform_point3(between(&places, time, |a, b, weight| a.lerp(b, weight)))
        };
        indices.iter().map(|triangle| triangle.map(at)).collect()
    });
}

/// The transform between two others, element by element.
fn blend(a: DAffine3, b: DAffine3, weight: f64) -> DAffine3 {
    DAffine3 {
        matrix3: a.matrix3 * (1.0 - weight) + b.matrix3 * weight,
        translation: a.translation.lerp(b.translation, weight),
    }
}

/// Triangles too small for the kernel's barycentric weights are found anew at the time of the ray, not at time 0.
#[test]
fn weights_of_tiny_moving_triangles_are_those_of_the_moment() {
    let tiny = 1e-10;
    let corners = [DVec3::new(0.0, 0.0, 0.0), DVec3::new(tiny, 0.0, 0.0), DVec3::new(0.0, tiny, 0.0)];
    // A million times its size on the way, along its plane's normal, so that a ray at one moment meets it there.
    let steps = [0.0, 1.0].map(|z| buffer(&corners.map(|p| p + DVec3::new(0.0, 0.0, z))));
    let mesh = TriangleMesh::deforming(&steps, vec![[0, 1, 2]]).expect("a mesh");
    let scene = mesh_scene(&device(), SceneOptions::default(), &mesh);
    for time in [0.0, 0.25, 0.5, 1.0] {
        let origin = Vec3::new(0.25 * tiny as f32, 0.5 * tiny as f32, -1.0);
        let ray = Ray::new(origin, 1e-3 * Vec3::Z).at_time(time);
        let hit = scene.intersect(&ray).expect("a hit");
        assert!((hit.t * 1e-3 - (1.0 + time)).abs() < 1e-5, "{hit:?}");
        assert!((hit.u - 0.25).abs() < 1e-3 && (hit.v - 0.5).abs() < 1e-3, "{time}: {hit:?}");
    }
}

/// A sphere of radius 1/4 whose centre moves from (-1, 0, 0) to (1, 0, 0) along a parabola of height 1.
struct Thrown;

impl Thrown {
    fn centre(time: f32) -> Vec3 {
        let x = 2.0 * time - 1.0;
        Vec3::new(x, 1.0 - x * x, 0.0)
    }
}

impl UserGeometry for Thrown {
    fn len(&self) -> usize {
        1
    }

    fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) {
        unreachable!("moving geometry is asked for its boxes at all times")
    }

    fn time_steps(&self) -> usize {
        17
    }

    fn bounds_at(&self, _: usize, step: usize) -> ([f32; 3], [f32; 3]) {
        let centre = Self::centre(step as f32 / 16.0);
        // The curve rises above its chord by (1/16)^2 at most.
        let reach = Vec3::splat(0.25 + 1.0 / 256.0);
        ((centre - reach).to_array(), (centre + reach).to_array())
    }

    fn intersect(&self, _: usize, ray: &Ray) -> Option<UserHit> {
        let way = ray.origin - Self::centre(ray.time);
        let (a, b) = (ray.direction.length_squared(), way.dot(ray.direction));
        let t = (-b - (b * b - a * (way.length_squared() - 0.0625)).sqrt()) / a;
        (ray.tnear..=ray.tfar).contains(&t).then_some(UserHit { t, u: 0.0, v: 0.0, ng: way + t * ray.direction })
    }
}

#[test]
fn user_geometry_is_asked_at_the_time_of_the_ray() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).expect("a scene");
    builder.add_user(Arc::new(Thrown)).expect("geometry");
    let scene = builder.commit(None).expect("a build");
    assert!(scene.features().motion);
    for number in 0_u8..=100 {
        let time = f32::from(number) / 100.0;
        let centre = Thrown::centre(time);
        for (aside, met) in [(0.0, true), (0.24, true), (0.26, false), (1.0, false)] {
            let ray = Ray::new(centre + Vec3::new(aside, 0.0, -2.0), Vec3::Z).at_time(time);
            assert_eq!(scene.intersect(&ray).is_some(), met, "{time}, {aside}");
            assert_eq!(scene.occluded(&ray), met, "{time}, {aside}");
        }
    }
}

/// A time outside of the shutter interval is the nearer end, and one that is no number is the beginning.
#[test]
fn odd_times_are_moments_of_the_shutter_interval() {
    let square =
        |x: f64| buffer(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| DVec3::new(x + u, v, 0.0)));
    let indices = vec![[0, 1, 2], [0, 2, 3]];
    let moving = TriangleMesh::deforming(&[square(0.0), square(2.0)], indices.clone()).expect("a mesh");
    let still = TriangleMesh::shared(square(0.0), indices).expect("a mesh");
    let device = device();
    let (moving, still) =
        (mesh_scene(&device, SceneOptions::default(), &moving), mesh_scene(&device, SceneOptions::default(), &still));
    assert!(moving.features().motion && !still.features().motion);
    let ends = [(0.0, 0.5), (1.0, 2.5)].map(|(time, x)| (time, Ray::new(Vec3::new(x, 0.4, -1.0), Vec3::Z)));
    let odd = [
        (f32::NAN, 0.0),
        (-1.0, 0.0),
        (f32::NEG_INFINITY, 0.0),
        (-0.0, 0.0),
        (1.5, 1.0),
        (f32::INFINITY, 1.0),
        (f32::MAX, 1.0),
    ];
    for (time, meant) in odd {
        for (end, ray) in ends {
            let mut packet = [ray.at_time(time); 16].map(|ray| (ray, None));
            let rays = packet.map(|(ray, _)| ray);
            moving.intersect_many(&rays, |_| f32::INFINITY, |i, hit| packet[i].1 = Some(hit));
            let alone = moving.intersect(&rays[0]);
            assert_eq!(alone.is_some(), end == meant, "{time}");
            assert_eq!(moving.occluded(&rays[0]), end == meant, "{time}");
            assert!(packet.iter().all(|(_, hit)| *hit == alone), "{time}");
            // A scene at rest does not read the time.
            assert_eq!(still.intersect(&rays[0]), still.intersect(&ray), "{time}");
        }
    }
}

#[test]
fn motion_that_cannot_be_is_refused() {
    let device = device();
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let steps = |count: usize| vec![buffer(&corners); count];
    let refused = |steps: &[Arc<VertexBuffer>]| {
        let error = TriangleMesh::deforming(steps, vec![[0, 1, 2]]).expect_err("no mesh");
        assert_eq!(error.kind(), ErrorKind::InvalidScene);
        error.to_string()
    };
    assert!(refused(&[]).contains("0 time steps: needs 1 to 129"));
    assert!(refused(&steps(130)).contains("130 time steps"));
    let uneven = [buffer(&corners), buffer(&[DVec3::ZERO; 4])];
    assert!(refused(&uneven).contains("time step 1 has 4 vertices, but the first has 3"));
    let one = TriangleMesh::deforming(&steps(1), vec![[0, 1, 2]]).expect("a mesh at rest");
    assert!(!one.is_deforming());

    let child = mesh_scene(&device, SceneOptions::default(), &one);
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).expect("a scene");
    let mut refused = |steps: &[DAffine3]| {
        let error = builder.add_moving_instance(&child, steps).expect_err("no instance");
        assert_eq!(error.kind(), ErrorKind::InvalidScene);
        error.to_string()
    };
    let turned = |degrees: f64| DAffine3::from_rotation_z(degrees.to_radians());
    assert!(refused(&[]).contains("0 time steps"));
    assert!(refused(&[DAffine3::IDENTITY, turned(180.0)]).contains("collapses between time steps 0 and 1"));
    assert!(refused(&[DAffine3::IDENTITY, turned(90.0), turned(270.0)]).contains("between time steps 1 and 2"));
    let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    assert!(refused(&[DAffine3::IDENTITY, mirrored]).contains("collapses"));
    assert!(refused(&[DAffine3::IDENTITY, DAffine3::from_scale(DVec3::ZERO)]).contains("cannot be inverted"));
    assert!(refused(&[DAffine3::IDENTITY, DAffine3::from_translation(1e30 * DVec3::X)]).contains("cannot be inverted"));
    // Turns by less than half a circle shrink the object on its way, but do not flatten it.
    for degrees in [0.0, 90.0, 170.0, -170.0] {
        builder.add_moving_instance(&child, &[DAffine3::IDENTITY, turned(degrees)]).expect("an instance");
    }
}
