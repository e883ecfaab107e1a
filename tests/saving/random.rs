//! Shapes in random places, whose numbers have all their digits.

use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc, SurfaceLook};
use etendue::math::{DAffine3, DQuat, DVec3};
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;

use super::same::{assert_same, saved};

#[test]
fn shapes_in_random_places_come_back() {
    let mut rng = Rng::new(7, 0);
    let mut number = || f64::from(rng.next_f32()) * 0.987_654_321_012_345 + 1e-9;
    let mut scene = SceneDesc::default();
    let grey = Some(scene.add_material("grey", BsdfDesc::Lambert { albedo: Rgb::splat(0.5) }, None).unwrap());
    for _ in 0..300 {
        let mut vector = || DVec3::new(number() - 0.5, number() - 0.5, number() - 0.5);
        let (origin, axis, turn, moved) = (vector(), vector(), vector(), vector());
        let (radius, height) = (number(), number());
        let transform = DAffine3::from_scale_rotation_translation(
            DVec3::new(number(), -number(), number()),
            DQuat::from_scaled_axis(6.0 * turn),
            moved,
        );
        for shape in [
            ShapeDesc::disk(origin, axis, radius),
            ShapeDesc::cylinder(origin, axis, radius, height),
            ShapeDesc::cone(origin, axis, radius, height),
            ShapeDesc::paraboloid(origin, axis, radius, height),
            ShapeDesc::ellipsoid(origin, axis.abs() + DVec3::splat(0.1)),
        ] {
            let (shape, local) = shape.unwrap();
            scene
                .add_surface(shape, local, SurfaceLook { material: grey, transform, ..SurfaceLook::default() })
                .unwrap();
        }
    }
    assert_same(&scene, &saved(&scene), "random shapes");
}
