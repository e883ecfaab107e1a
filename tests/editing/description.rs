//! Hits in the numbers of the description.

use etendue::desc::ShapeDesc;
use etendue::math::{DAffine3, DQuat, DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, HitDescription, Scene};

use crate::options;
use crate::scenes::{Random, sheet, studio, surface};

/// The scene of one shape under a transform, and a ray onto a point of it, from the outer side.
fn hit(
    shape: ShapeDesc,
    transform: DAffine3,
    mesh: Option<etendue::desc::MeshDesc>,
    target: DVec3,
    options: &BuildOptions,
) -> HitDescription {
    let mut desc = studio(&mut Random(1));
    desc.surfaces.clear();
    desc.meshes.extend(mesh.map(std::sync::Arc::new));
    let surface = surface(&desc, shape, transform, None);
    let (to_world, local) = (surface.to_world(), surface.local);
    desc.surfaces.push(surface);
    let scene = Scene::build(&desc, options).unwrap();
    assert!(local.is_finite());
    let target = to_world.transform_point3(target);
    let from = target + DVec3::new(0.01, 0.02, 0.5);
    let ray = Ray::new(scene.to_scene(from), (target - from).normalize().as_vec3a());
    let hit = scene.intersect(&ray).expect("in the way");
    let description = scene.describe_hit(&ray, &hit);
    let interaction = scene.interaction(&ray, &hit);
    assert_eq!((description.t, description.surface, description.material), (hit.t, 0, Some(interaction.material)));
    assert_eq!((description.ng, description.ns), (interaction.ng, interaction.ns));
    description
}

fn near([x, y]: [f32; 2], expected: [f64; 2]) -> bool {
    (f64::from(x) - expected[0]).abs() < 1e-4 && (f64::from(y) - expected[1]).abs() < 1e-4
}

/// Placements whose z axis stays in front: as it is, turned, mirrored.
fn placements() -> [DAffine3; 3] {
    let turn = DQuat::from_rotation_z(0.7);
    [
        DAffine3::IDENTITY,
        DAffine3::from_scale_rotation_translation(DVec3::new(2.0, 1.5, 1.0), turn, DVec3::new(3.0, -1.0, 0.5)),
        DAffine3::from_scale_rotation_translation(DVec3::new(-1.0, 1.2, 1.0), turn, DVec3::new(0.0, 4.0, 0.0)),
    ]
}

#[test]
fn triangles_and_quads_by_the_order_of_their_vertices() {
    let options = options(false);
    let quad = [[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [-1.0, 1.0, 0.0]].map(DVec3::from_array);
    let triangle = [quad[0], quad[1], quad[3]];
    for transform in placements() {
        for (b1, b2) in [(0.2, 0.3), (0.6, 0.1), (0.05, 0.9)] {
            let blend = |[a, b, c]: [DVec3; 3]| a + b1 * (b - a) + b2 * (c - a);
            let found = hit(ShapeDesc::Triangle(triangle), transform, None, blend(triangle), &options);
            assert!(near(found.barycentric, [b1, b2]) && found.uv == found.barycentric, "{found:?}");
            assert_eq!(found.primitive, 0);
            for half in 0..2 {
                let corners = if half == 0 { [quad[0], quad[1], quad[2]] } else { [quad[0], quad[2], quad[3]] };
                let target = blend(corners);
                let found = hit(ShapeDesc::Quad(quad), transform, None, target, &options);
                assert_eq!(found.primitive, half, "{found:?}");
                assert!(near(found.barycentric, [b1, b2]), "{found:?}");
                // A rectangle: both halves are one affine map.
                assert!(near(found.uv, [(target.x + 1.0) / 3.0, (target.y + 1.0) / 2.0]), "{found:?}");
            }
        }
    }
}

#[test]
fn half_a_quad_keeps_its_number() {
    // The first half has no area.
    let quad = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]].map(DVec3::from_array);
    let target = quad[0] + 0.25 * (quad[2] - quad[0]) + 0.5 * (quad[3] - quad[0]);
    let found = hit(ShapeDesc::Quad(quad), DAffine3::IDENTITY, None, target, &options(false));
    assert_eq!(found.primitive, 1);
    assert!(near(found.barycentric, [0.25, 0.5]), "{found:?}");
}

#[test]
fn triangles_of_meshes_keep_their_numbers_and_uvs() {
    for dynamic in [false, true] {
        for n in [4, 12] {
            for with_uvs in [false, true] {
                let mut mesh = sheet(n, 0.0, with_uvs);
                // Gone: the first, some in the middle.
                for lost in [0, n, n + 1] {
                    mesh.triangles[lost] = [1, 1, 2];
                }
                for transform in placements() {
                    for number in [2 * n - 1, n + 2, 2 * n * n - 1] {
                        let corners = mesh.triangles[number].map(|corner| mesh.positions[corner as usize]);
                        let (b1, b2) = (0.2, 0.5);
                        let target = corners[0] + b1 * (corners[1] - corners[0]) + b2 * (corners[2] - corners[0]);
                        let shape = ShapeDesc::Mesh { mesh: 0, smooth: false };
                        let found = hit(shape, transform, Some(mesh.clone()), target, &options(dynamic));
                        assert_eq!(found.primitive as usize, number, "{found:?}");
                        assert!(near(found.barycentric, [b1, b2]), "{found:?}");
                        // The uvs count cells from the corner at (-1, -1).
                        let cells = [target.x, target.y].map(|x| 0.5 * (x + 1.0) * n as f64);
                        assert!(near(found.uv, if with_uvs { cells } else { [b1, b2] }), "{found:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn analytic_shapes_have_no_coordinates() {
    let shape = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 };
    for listed_shapes in [None, Some(0)] {
        let options = BuildOptions { listed_shapes, ..options(false) };
        let found = hit(shape, DAffine3::IDENTITY, None, DVec3::Z, &options);
        assert_eq!((found.primitive, found.uv, found.barycentric), (0, [0.0; 2], [0.0; 2]));
        assert!(found.ng.distance(Vec3::Z) < 0.05, "{found:?}");
    }
}

#[test]
fn rays_that_are_none_are_told_from_misses() {
    assert!(Scene::is_traceable(&Ray::new(Vec3::ZERO, Vec3::Z)));
    for (origin, direction) in
        [(Vec3::NAN, Vec3::Z), (Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, Vec3::INFINITY), (Vec3::INFINITY, Vec3::Z)]
    {
        assert!(!Scene::is_traceable(&Ray::new(origin, direction)));
    }
    assert!(!Scene::is_traceable(&Ray { tnear: -1.0, ..Ray::new(Vec3::ZERO, Vec3::Z) }));
}
