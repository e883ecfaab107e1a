//! Geometry with its own test: nothing lost, nothing added, no panic let through.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use etendue::ErrorKind;
use etendue::embree::{SceneBuilder, SceneOptions, UserGeometry, UserHit};
use etendue::math::{DAffine3, DMat3, DQuat, DVec3, Ray, Vec3};

use crate::device;
use crate::reference::{EPS, Random, quadric, sphere};

/// Spheres tested in double precision.
struct Spheres(Vec<(DVec3, f64)>);

impl UserGeometry for Spheres {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        let (c, r) = self.0[index];
        ((c - r).to_array().map(|x| (x as f32).next_down()), (c + r).to_array().map(|x| (x as f32).next_up()))
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        let (c, r) = self.0[index];
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (t0, t1) = sphere(c, r, o, d)?;
        let inside = |t: &f64| f64::from(ray.tnear) <= *t && *t <= f64::from(ray.tfar);
        let t = [t0, t1].into_iter().find(inside)?;
        let ng = o + d * t - c;
        Some(UserHit { t: t as f32, u: index as f32, v: r as f32, ng: ng.as_vec3a() })
    }
}

fn random_spheres(random: &mut Random, count: usize) -> Vec<(DVec3, f64)> {
    (0..count)
        .map(|_| {
            // Exact in single precision, so that Embree's spheres can be the same ones.
            let c = random.in_cube(2.0).as_vec3a().as_dvec3();
            (c, f64::from(random.range(0.01, 0.6) as f32))
        })
        .collect()
}

fn random_ray(random: &mut Random) -> Ray {
    let origin = random.in_cube(3.0);
    let direction = random.on_sphere() * 10.0_f64.powf(random.range(-2.0, 2.0));
    let mut ray = Ray::new(origin.as_vec3a(), direction.as_vec3a());
    if random.below(3) == 0 {
        let reach = 4.0 / f64::from(ray.direction.length());
        ray.tnear = (random.unit() * 0.3 * reach) as f32;
        ray.tfar = ray.tnear + (random.unit() * reach) as f32;
    }
    ray
}

/// The hierarchy only picks candidates, so the closest of all candidates must come out to the last bit.
#[test]
fn double_precision_spheres_are_found_exactly() {
    let device = device();
    let mut random = Random(6);
    let spheres = Arc::new(Spheres(random_spheres(&mut random, 64)));
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    let id = builder.add_user(Arc::clone(&spheres)).unwrap();
    let scene = builder.commit(None).unwrap();
    let mut hits = 0;
    for _ in 0..200_000 {
        let ray = random_ray(&mut random);
        let all = (0..spheres.len()).filter_map(|i| spheres.intersect(i, &ray).filter(|h| h.t <= ray.tfar));
        let nearest = all.min_by(|a, b| a.t.total_cmp(&b.t));
        let found = scene.intersect(&ray);
        assert_eq!(found.map(|h| h.t.to_bits()), nearest.map(|h| h.t.to_bits()), "{ray:?}");
        assert_eq!(scene.occluded(&ray), nearest.is_some(), "{ray:?}");
        if let (Some(hit), Some(expected)) = (found, nearest) {
            assert_eq!((hit.geom, hit.u, hit.v, hit.ng), (id.0, expected.u, expected.v, expected.ng));
            hits += 1;
        }
    }
    println!("user spheres: {hits} hits, all exact");
    assert!(hits > 10_000);
    scene.check().unwrap();
}

/// A stretched, turned and moved sphere is an ellipsoid, met where its equation says.
#[test]
fn an_instanced_sphere_is_the_quadric() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_user(Arc::new(Spheres(vec![(DVec3::ZERO, 1.0)]))).unwrap();
    let child = builder.commit(None).unwrap();
    let turned = DQuat::from_axis_angle(DVec3::new(0.0, 0.6, 0.8), 0.7);
    let moved = DVec3::new(0.5, -0.25, 1.0);
    let exact = DAffine3::from_scale_rotation_translation(DVec3::new(-0.5, 1.0, 1.75), turned, moved);
    let m = DAffine3::from_cols_array(&exact.to_cols_array().map(|x| f64::from(x as f32)));
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_instance(&child, &m).unwrap();
    let scene = builder.commit(None).unwrap();

    // |W (x - p)|^2 = 1 with W the inverse of the linear part.
    let w = m.matrix3.inverse();
    let a: DMat3 = w.transpose() * w;
    let b = -(a * m.translation);
    let c = m.translation.dot(a * m.translation) - 1.0;
    let condition = 1.75 / 0.5;
    let mut random = Random(7);
    let (mut hits, mut worst) = (0, 0.0_f64);
    for _ in 0..100_000 {
        let ray = Ray::new(random_ray(&mut random).origin, random.on_sphere().as_vec3a());
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let found = scene.intersect(&ray);
        // Moving the ray by eps moves the crossing by eps over the cosine at the surface; near the rim that is all.
        let error = 4.0 * EPS * condition * (o.length() + moved.length());
        let roots = quadric(&a, b, c, o, d);
        let expected = roots.and_then(|(t0, t1)| [t0, t1].into_iter().find(|&t| t >= 0.0));
        match (found, expected) {
            (Some(hit), Some(t)) => {
                let p = o + d * t;
                let n = (a * p + b).normalize();
                let off = (f64::from(hit.t) - t).abs() * n.dot(d).abs();
                // Past the rim, the far root or a point beside it may be met instead.
                let half = roots.map_or(0.0, |(t0, t1)| (t1 - t0) * 0.5);
                if half > 1e-2 {
                    worst = worst.max(off / error);
                    assert!(off <= error, "{} instead of {t} with {ray:?}", hit.t);
                }
                hits += 1;
            }
            (None, None) => {}
            _ => {
                // Only a line that just touches, or an origin on the surface, may be told differently.
                let (lo, ld) = (w * (o - m.translation), w * d);
                let closest = (lo - ld * (lo.dot(ld) / ld.length_squared())).length();
                let slack = 8.0 * EPS * condition * (lo.length() + 1.0);
                let undecided = (closest - 1.0).abs() < slack || (lo.length() - 1.0).abs() < slack;
                assert!(undecided, "{found:?} instead of {roots:?} with {ray:?}, {closest} from the centre");
            }
        }
    }
    println!("ellipsoid: {hits} hits, off by at most {:.2} units", worst * 4.0);
    assert!(hits > 5_000);
}

/// Embree's own sphere works in single precision: its error grows with the distance from the ray's origin.
#[test]
fn embree_spheres_agree_within_their_precision() {
    let device = device();
    let mut random = Random(8);
    let spheres = random_spheres(&mut random, 64);
    let data: Vec<[f32; 4]> = spheres.iter().map(|(c, r)| [c.x as f32, c.y as f32, c.z as f32, *r as f32]).collect();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_spheres(data).unwrap();
    let scene = builder.commit(None).unwrap();
    let (mut hits, mut differ, mut worst) = (0, 0, 0.0_f64);
    for _ in 0..200_000 {
        // From outside: Embree's sphere is for opaque points and differs from within.
        let origin = random.on_sphere() * 8.0;
        let ray = Ray::new(origin.as_vec3a(), (random.in_cube(2.0) - origin).normalize().as_vec3a());
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let exact = spheres
            .iter()
            .enumerate()
            .filter_map(|(i, &(c, r))| sphere(c, r, o, d).map(|(t0, t1)| (i, t0, (t1 - t0) * 0.5)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match (scene.intersect(&ray), exact) {
            (Some(hit), Some((i, t, half))) if hit.prim as usize == i => {
                // |oc|^2 - r^2 cancels: eps |oc|^2 over the half chord, the derivative of the root.
                let distance = (spheres[i].0 - o).length();
                worst = worst.max((f64::from(hit.t) - t).abs() / (EPS * distance * distance / half));
                hits += 1;
            }
            (None, None) => {}
            _ => differ += 1,
        }
    }
    println!("Embree spheres: {hits} hits, {differ} differ, t off by at most {worst:.2} units of eps d^2 / half chord");
    assert!(hits > 50_000);
    assert!(worst <= 8.0, "{worst}");
    // Rays that pass a rim within rounding: a band of width eps d / r around each disc.
    assert!(differ <= hits / 2_000, "{differ} of {hits}");
}

/// Spheres of which one cannot be tested.
struct Panicking {
    inner: Spheres,
    calls: AtomicUsize,
}

impl UserGeometry for Panicking {
    fn len(&self) -> usize {
        self.inner.len()
    }

    fn bounds(&self, index: usize) -> ([f32; 3], [f32; 3]) {
        self.inner.bounds(index)
    }

    fn intersect(&self, index: usize, ray: &Ray) -> Option<UserHit> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        assert!(index != 0, "sphere 0 cannot be tested");
        self.inner.intersect(index, ray)
    }
}

#[test]
fn a_panic_in_user_geometry_is_a_miss_and_is_reported() {
    let device = device();
    let line = vec![(DVec3::new(0.0, 0.0, 3.0), 1.0), (DVec3::new(0.0, 0.0, 6.0), 1.0)];
    let geometry = Arc::new(Panicking { inner: Spheres(line), calls: AtomicUsize::new(0) });
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_user(Arc::clone(&geometry)).unwrap();
    let child = builder.commit(None).unwrap();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_instance(&child, &DAffine3::IDENTITY).unwrap();
    let parent = builder.commit(None).unwrap();
    child.check().unwrap();
    parent.check().unwrap();
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    let hit = child.intersect(&ray).expect("the second sphere");
    assert_eq!((hit.prim, hit.t), (1, 5.0));
    assert!(child.occluded(&ray));
    assert!(parent.intersect(&ray).is_some_and(|h| h.prim == 1 && h.inst == 0));
    assert!(geometry.calls.load(Ordering::Relaxed) >= 4);
    // The flag stays, and shows through instances.
    for scene in [&child, &parent] {
        let error = scene.check().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Internal);
        assert!(error.message().contains("sphere 0 cannot be tested"), "{error}");
    }
}

/// Answers that make no sense.
struct Nonsense(f32);

impl UserGeometry for Nonsense {
    fn len(&self) -> usize {
        1
    }

    fn bounds(&self, _: usize) -> ([f32; 3], [f32; 3]) {
        ([-1.0; 3], [1.0; 3])
    }

    fn intersect(&self, _: usize, _: &Ray) -> Option<UserHit> {
        Some(UserHit { t: self.0, u: 0.0, v: 0.0, ng: Vec3::Z })
    }
}

#[test]
fn a_distance_outside_the_ray_is_a_miss() {
    let device = device();
    for t in [f32::NAN, -1.0, 0.5, 9.5, f32::INFINITY, f32::NEG_INFINITY] {
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_user(Arc::new(Nonsense(t))).unwrap();
        let scene = builder.commit(None).unwrap();
        let ray = Ray { tnear: 1.0, tfar: 9.0, ..Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z) };
        assert_eq!(scene.intersect(&ray), None, "t = {t}");
        assert!(!scene.occluded(&ray), "t = {t}");
    }
}
