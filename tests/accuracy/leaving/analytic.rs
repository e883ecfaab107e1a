//! Spheres, disks and quadrics under any affine transform, in the list and in the tree.

use etendue::desc::ShapeDesc;
use etendue::math::{Bounds, DAffine3, DMat3, DQuat, DVec3, EulerRot};
use etendue::sampling::Rng;

use super::spawn::{
    LIST, TREE, Tally, build, offset, random_direction, random_point, random_power, shoot, signed, single,
};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "S22d", title: "rays spawned on analytic shapes", run: analytic_shapes }]
}

fn random_turn(rng: &mut Rng) -> DMat3 {
    let [x, y, z] = [signed(rng), signed(rng), signed(rng)].map(|angle| 3.0 * angle);
    DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, x, y, z))
}

fn analytic_shapes(case: &mut Case) {
    let mut rng = Rng::new(2, 0);
    let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    let ellipsoid =
        ShapeDesc::Quadric { coefficients: [1.0, 4.0, 2.0, 0.3, 0.0, 0.1, 0.0, 0.0, 0.0, -1.0], clip: everywhere };
    let ball = ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 };
    let disk = ShapeDesc::Disk { centre: DVec3::ZERO, normal: DVec3::new(0.6, 0.0, 0.8), radius: 1.0 };
    for (shape, what, is_closed) in [(ball, "sphere", true), (ellipsoid, "ellipsoid", true), (disk, "disk", false)] {
        for (place, stretch) in [("similar", 1.0), ("affine", 10.0)] {
            let (mut rays, mut nearer, mut inside) = (Tally::default(), Tally::with_bound_times(0.0), Tally::default());
            let mut largest = 0.0_f64;
            for number in 0..case.count(200, 2000) {
                let size = random_power(&mut rng, -6.0, 6.0);
                let axes = DVec3::new(1.0, stretch, 1.0 / stretch) * DVec3::new(signed(&mut rng).signum(), 1.0, 1.0);
                let matrix = size * random_turn(&mut rng) * DMat3::from_diagonal(axes) * random_turn(&mut rng);
                let transform = DAffine3::from_mat3_translation(matrix, 10.0 * size * random_point(&mut rng));
                let middle = transform.translation;
                let away = size * stretch * random_power(&mut rng, 0.5, 3.0);
                let desc = single(shape, transform, middle + away * random_direction(&mut rng), middle);
                let scene = build(&desc, if number % 2 == 0 { LIST } else { TREE });
                for _ in 0..10 {
                    let direction = random_direction(&mut rng);
                    let from = transform.transform_point3(4.0 * direction);
                    let aim = transform.transform_point3(0.7 * random_direction(&mut rng));
                    let Some(point) = shoot(&scene, scene.to_scene(from), scene.to_scene(aim), 0) else { continue };
                    largest = largest.max(offset(&point, point.ng) / (away + size * stretch));
                    rays.leave(&scene, &point, point.ng, f32::INFINITY, 20, &mut rng);
                    nearer.leave(&scene, &point, point.ng, f32::INFINITY, 2, &mut rng);
                    if is_closed {
                        inside.enter(&scene, &point, 20, &mut rng);
                    } else {
                        rays.leave(&scene, &point, -point.ng, f32::INFINITY, 20, &mut rng);
                    }
                }
            }
            let what = format!("{what}, {place}");
            case.never(format!("{what}: met again"), rays.bad, rays.rays);
            if is_closed {
                case.rarely(format!("{what}: light leaks in"), inside.bad, inside.rays, 1e-4);
            }
            case.at_most(format!("{what}: offset / distance"), largest, 1e-6);
            let Tally { rays, bad, .. } = nearer;
            case.holds(format!("{what}, no offset"), "some met again", format!("{bad} of {rays}"), bad > 0);
        }
    }
}
