//! Rays along axes, with signed zeros, with denormals, and rays that are no rays.

use etendue::embree::{Scene, SceneOptions, TriangleMesh};
use etendue::math::{Ray, Vec3};

use crate::{device, mesh_scene, rounded};

/// A cube from -1 to 1; triangles 2i and 2i + 1 lie on face i: -x, +x, -y, +y, -z, +z.
fn cube() -> Scene {
    let vertices =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| if bit == 0 { -1.0 } else { 1.0 })).collect();
    let face = |a, b, c, d| [[a, b, c], [a, c, d]];
    let faces =
        [face(0, 4, 6, 2), face(1, 3, 7, 5), face(0, 1, 5, 4), face(2, 6, 7, 3), face(0, 2, 3, 1), face(4, 5, 7, 6)];
    let mesh = TriangleMesh::new(vertices, faces.concat()).unwrap();
    mesh_scene(&device(), SceneOptions::default(), &mesh)
}

#[test]
fn axis_aligned_rays_with_zeros_of_both_signs() {
    let scene = cube();
    let zeros = [0.0, -0.0, f32::MIN_POSITIVE / 4.0, -f32::MIN_POSITIVE / 4.0];
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            for a in zeros {
                for b in zeros {
                    let mut direction = [0.0; 3];
                    direction[axis] = sign;
                    direction[(axis + 1) % 3] = a;
                    direction[(axis + 2) % 3] = b;
                    for origin in [[0.25, -0.125, 0.5], [0.0; 3], [-0.0; 3]] {
                        let ray = Ray::new(Vec3::from(origin), Vec3::from(direction));
                        let hit = scene.intersect(&ray).unwrap_or_else(|| panic!("{ray:?}"));
                        let face = 2 * axis + usize::from(sign > 0.0);
                        assert_eq!(hit.prim as usize / 2, face, "{ray:?}");
                        assert_eq!(rounded(hit.t), 1.0 - sign * origin[axis], "{ray:?}");
                        assert!(scene.occluded(&ray));
                    }
                }
            }
        }
    }
}

#[test]
fn rays_that_are_no_rays_meet_nothing() {
    let scene = cube();
    let good = Ray::new(Vec3::ZERO, Vec3::X);
    assert!(scene.intersect(&good).is_some());
    let mut bad = Vec::new();
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut ray = good;
            ray.origin[axis] = x;
            bad.push(ray);
            let mut ray = good;
            ray.direction[axis] = x;
            bad.push(ray);
        }
    }
    bad.push(Ray { direction: Vec3::ZERO, ..good });
    bad.push(Ray { direction: -Vec3::ZERO, ..good });
    bad.push(Ray { tnear: f32::NAN, ..good });
    bad.push(Ray { tfar: f32::NAN, ..good });
    bad.push(Ray { tnear: -1.0, ..good });
    bad.push(Ray { tnear: 3.0, tfar: 2.0, ..good });
    bad.push(Ray { tfar: -1.0, ..good });
    bad.push(Ray { tfar: f32::NEG_INFINITY, ..good });
    for ray in bad {
        assert_eq!(scene.intersect(&ray), None, "{ray:?}");
        assert!(!scene.occluded(&ray), "{ray:?}");
    }
}

#[test]
fn large_finite_coordinates_are_rays() {
    let scene = cube();
    // Sums of such components overflow; each of them is finite, and so the ray is one, even if it meets nothing.
    let ray = Ray::new(Vec3::splat(3e38), Vec3::splat(3e38));
    assert!(ray.is_valid());
    assert_eq!(scene.intersect(&ray), None);
    let ray = Ray::new(Vec3::new(-1e12, 0.25, 0.5), Vec3::X);
    assert!(scene.intersect(&ray).is_some());
}

#[test]
fn the_interval_is_kept() {
    let scene = cube();
    let ray = Ray::new(Vec3::new(-3.0, 0.25, 0.5), Vec3::X);
    for (tnear, tfar, expected) in [
        (0.0, 10.0, Some(2.0)),
        (0.0, 1.75, None),
        (2.25, 10.0, Some(4.0)),
        (2.25, 3.75, None),
        (4.25, f32::INFINITY, None),
    ] {
        let ray = Ray { tnear, tfar, ..ray };
        assert_eq!(scene.intersect(&ray).map(|h| rounded(h.t)), expected, "{tnear} to {tfar}");
        assert_eq!(scene.occluded(&ray), expected.is_some(), "{tnear} to {tfar}");
    }
}

#[test]
fn denormal_arithmetic_is_as_before_after_a_build() {
    let _scene = cube();
    let tiny = std::hint::black_box(f32::MIN_POSITIVE);
    let half = std::hint::black_box(0.5_f32);
    assert!(tiny * half > 0.0, "a build left denormals flushed to zero");
}
