//! Random and contrived rays against every primitive in double precision.

use etendue::embree::{BuildQuality, Hit, Scene, SceneBuilder, SceneOptions, TriangleMesh};
use etendue::math::{DAffine3, DMat3, DQuat, DVec3, Ray, Vec3};

use crate::reference::{Crossing, Random, Ray64, Tally, triangle};
use crate::{device, mesh_scene};

fn to_f32(p: DVec3) -> [f32; 3] {
    p.as_vec3a().to_array()
}

fn soup(corners: impl Iterator<Item = [DVec3; 3]>) -> TriangleMesh {
    let vertices: Vec<[f32; 3]> = corners.flatten().map(to_f32).collect();
    let indices = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(vertices, indices).expect("a soup")
}

/// Triangles of all sizes, every which way.
fn random_soup(random: &mut Random, count: usize, size: f64) -> TriangleMesh {
    soup((0..count).map(|_| {
        let centre = random.in_cube(1.0);
        let size = size * random.range(0.1, 1.0);
        [(); 3].map(|()| centre + random.in_cube(size))
    }))
}

/// Triangles a million times longer than wide.
fn needles(random: &mut Random, count: usize) -> TriangleMesh {
    soup((0..count).map(|_| {
        let (start, along) = (random.in_cube(1.0), random.on_sphere());
        let width = random.on_sphere() * 10.0_f64.powf(random.range(-6.0, -2.0));
        [start, start + along * random.range(0.5, 3.0), start + width]
    }))
}

/// A closed mesh: a sphere of `rings` by `sectors`, moved off the origin and bumpy.
fn bumpy_sphere(rings: usize, sectors: usize, centre: DVec3) -> TriangleMesh {
    let mut vertices = vec![to_f32(centre + DVec3::Z)];
    for ring in 1..rings {
        let theta = std::f64::consts::PI * ring as f64 / rings as f64;
        for sector in 0..sectors {
            let phi = std::f64::consts::TAU * sector as f64 / sectors as f64;
            let r = 1.0 + 0.1 * (5.0 * phi).sin() * theta.sin();
            let direction = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            vertices.push(to_f32(centre + r * direction));
        }
    }
    vertices.push(to_f32(centre - DVec3::Z));
    let last = vertices.len() as u32 - 1;
    let at = |ring: usize, sector: usize| (1 + (ring - 1) * sectors + sector % sectors) as u32;
    let mut indices = Vec::new();
    for s in 0..sectors {
        indices.push([0, at(1, s), at(1, s + 1)]);
        indices.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
        for ring in 1..rings - 1 {
            indices.push([at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)]);
            indices.push([at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)]);
        }
    }
    TriangleMesh::new(vertices, indices).expect("a sphere")
}

fn corners(mesh: &TriangleMesh) -> Vec<[DVec3; 3]> {
    let at = |i: u32| Vec3::from(mesh.vertices().get(i as usize)).as_dvec3();
    mesh.indices().iter().map(|t| t.map(at)).collect()
}

/// Rays from around the scene in all manners: free, at points inside triangles, at edges, at corners, and grazing.
fn aim(random: &mut Random, triangles: &[[DVec3; 3]], centre: DVec3) -> Ray {
    let origin = centre + random.in_cube(3.0);
    let [a, b, c] = triangles[random.below(triangles.len())];
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let inside = a + (b - a) * u + (c - a) * v;
    let (origin, target) = match random.below(6) {
        0 => (origin, origin + random.on_sphere()),
        1 => (origin, inside),
        2 => (origin, a + (b - a) * u),
        3 => (origin, a),
        // Grazing: from a point a millionth to a tenth off the plane.
        4 => {
            let n = (b - a).cross(c - a).normalize_or_zero();
            let start = inside + (b - a).normalize_or_zero() * 2.0 + n * 10.0_f64.powf(random.range(-6.0, -1.0));
            (start, inside)
        }
        // From a surface, as a bounced ray starts.
        _ => (inside, inside + random.on_sphere()),
    };
    // Directions of any length that is sensible.
    let direction = (target - origin) * 10.0_f64.powf(random.range(-2.0, 2.0));
    let mut ray = Ray::new(origin.as_vec3a(), direction.as_vec3a());
    if random.below(4) == 0 {
        let reach = 4.0 / f64::from(ray.direction.length());
        ray.tnear = (random.unit() * 0.5 * reach) as f32;
        ray.tfar = ray.tnear + (random.unit() * reach) as f32;
    }
    ray
}

/// Traces `rays` rays and holds each answer, of all three queries, against the exact test of each triangle.
fn compare(name: &str, scene: &Scene, mesh: &TriangleMesh, rays: usize, seed: u64) -> Tally {
    let triangles = corners(mesh);
    let middle = triangles.iter().flatten().copied().sum::<DVec3>() / (3 * triangles.len()) as f64;
    let mut random = Random(seed);
    let mut tally = Tally::default();
    let mut crossings: Vec<Crossing> = Vec::with_capacity(triangles.len());
    for _ in 0..rays {
        let ray = aim(&mut random, &triangles, middle);
        if !ray.is_valid() {
            continue;
        }
        let exact = Ray64::from(&ray);
        crossings.clear();
        crossings.extend(triangles.iter().map(|&t| triangle(t, &exact)));
        let hit = scene.intersect(&ray);
        tally.check(&crossings, hit.map(|h| (h.t, h.prim as usize)), &ray);
        let expect_any = crossings.iter().any(|c| c.hit == Some(true));
        let allow_any = crossings.iter().any(|c| c.hit != Some(false));
        let occluded = scene.occluded(&ray);
        assert!(occluded || !expect_any, "shadow ray missed: {ray:?}");
        assert!(!occluded || allow_any, "shadow ray hit nothing: {ray:?}");
        if let Some(hit) = hit {
            check_attributes(&hit, &triangles[hit.prim as usize], &ray);
        }
    }
    tally.report(name);
    tally
}

/// Normal and barycentric coordinates belong to the triangle that was met.
fn check_attributes(hit: &Hit, [a, b, c]: &[DVec3; 3], ray: &Ray) {
    assert_eq!((hit.geom, hit.inst), (0, Hit::NO_INSTANCE));
    let n = (b - a).cross(c - a);
    let size = (b - a).length() * (c - a).length();
    let far = (*a - ray.origin.as_dvec3()).length() + (b - a).length() + (c - a).length();
    // Embree's edges are differences of corners as seen from the ray's origin.
    let edge_error = 1e-6 * far;
    let off = (hit.ng.as_dvec3() - n).length();
    assert!(off <= 8.0 * (1e-7 * size + edge_error * ((b - a).length() + (c - a).length())), "{n} {} {ray:?}", hit.ng);
    // Embree takes an edge function that is negative by no more than 2^-23 of the three together, and divides with an
    // estimated reciprocal.
    let slack = 4.0 * f32::EPSILON;
    assert!(hit.u >= -slack && hit.v >= -slack && hit.u + hit.v <= 1.0 + slack, "{hit:?}");
}

#[test]
fn random_soups_agree_with_double_precision() {
    let device = device();
    let mut random = Random(1);
    let mut hits = 0;
    for (round, quality) in [BuildQuality::Low, BuildQuality::Medium, BuildQuality::High].into_iter().enumerate() {
        let mesh = random_soup(&mut random, 96, 0.5);
        let scene = mesh_scene(&device, SceneOptions { quality, ..SceneOptions::default() }, &mesh);
        hits += compare("soup", &scene, &mesh, 150_000, 10 + round as u64).hits;
    }
    assert!(hits > 100_000, "the rays missed nearly everything: {hits}");
}

#[test]
fn needles_agree_with_double_precision() {
    let device = device();
    let mesh = needles(&mut Random(2), 96);
    let scene = mesh_scene(&device, SceneOptions::default(), &mesh);
    assert!(compare("needles", &scene, &mesh, 200_000, 20).hits > 20_000);
}

#[test]
fn closed_meshes_agree_with_double_precision() {
    let device = device();
    for (round, centre) in [DVec3::ZERO, DVec3::new(100.0, -40.0, 7.0)].into_iter().enumerate() {
        let mesh = bumpy_sphere(8, 12, centre);
        for compact in [false, true] {
            let scene = mesh_scene(&device, SceneOptions { compact, ..SceneOptions::default() }, &mesh);
            assert!(compare("closed", &scene, &mesh, 125_000, 30 + round as u64).hits > 50_000);
        }
    }
}

#[test]
fn instances_agree_with_double_precision() {
    let device = device();
    let mut random = Random(4);
    let mesh = random_soup(&mut random, 24, 0.5);
    let child = mesh_scene(&device, SceneOptions::default(), &mesh);
    let local = corners(&mesh);
    let transforms = [
        DAffine3::IDENTITY,
        // Mirrored.
        DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
        // Rotated, stretched and moved.
        DAffine3::from_scale_rotation_translation(
            DVec3::new(0.2, 1.5, 3.0),
            DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.1),
            DVec3::new(2.0, -1.0, 0.5),
        ),
        // Sheared, mirrored and moved.
        DAffine3::from_mat3_translation(
            DMat3::from_cols(DVec3::new(1.0, 0.3, 0.0), DVec3::new(-0.4, 0.8, 0.2), DVec3::new(0.1, 0.0, -1.2)),
            DVec3::new(-1.5, 0.5, -2.0),
        ),
    ];
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    let mut rounded = Vec::new();
    for (i, transform) in transforms.iter().enumerate() {
        let id = builder.add_instance(&child, transform).unwrap();
        assert_eq!(id.0 as usize, i);
        rounded.push(DAffine3::from_cols_array(&transform.to_cols_array().map(|x| f64::from(x as f32))));
    }
    let scene = builder.commit(None).unwrap();
    // The scene keeps what it refers to.
    drop(child);
    let world: Vec<[DVec3; 3]> =
        rounded.iter().flat_map(|m| local.iter().map(|t| t.map(|p| m.transform_point3(p)))).collect();
    let mut tally = Tally::default();
    for _ in 0..200_000 {
        let ray = aim(&mut random, &world, DVec3::ZERO);
        let exact = Ray64::from(&ray);
        let mut crossings = Vec::with_capacity(world.len());
        for transform in &rounded {
            let inside = exact.into_instance(transform);
            crossings.extend(local.iter().map(|&t| triangle(t, &inside)));
        }
        let found = scene.intersect(&ray).map(|h| (h.t, h.inst as usize * local.len() + h.prim as usize));
        tally.check(&crossings, found, &ray);
    }
    tally.report("instances");
    assert!(tally.hits > 50_000);
}
