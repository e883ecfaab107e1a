//! Light that arrives directly, against closed forms.
//!
//! A white Lambert surface under a light of radiance 1 that fills the configuration factor F of its hemisphere has the
//! radiance F. Factors: Lambert's polygon formula, and Howell's catalogue for the sphere.

mod common;

use std::f64::consts::PI;

use common::scenes::{Job, camera, mean_and_error, point_light, render, scene};
use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::math::{DVec3, Vec3};

const WHITE: BsdfDesc = BsdfDesc::Lambert { albedo: Vec3::ONE };

fn point([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A receiver around the origin with normal z, seen from `eye` above it, and shapes that shine with radiance 1.
fn lit(eye: f64, size: f64, lights: Vec<ShapeDesc>) -> SceneDesc {
    let receiver =
        ShapeDesc::Quad([[-size, -size, 0.0], [size, -size, 0.0], [size, size, 0.0], [-size, size, 0.0]].map(point));
    let mut surfaces = vec![(receiver, WHITE, None)];
    surfaces.extend(lights.into_iter().map(|light| (light, BsdfDesc::Black, Some(Vec3::ONE))));
    scene(camera(DVec3::new(0.0, 0.0, eye), DVec3::ZERO, 0.02), surfaces)
}

/// |mean - exact| within 4 standard errors and `tolerance`, the error small enough to prove it.
fn check(what: &str, desc: &SceneDesc, exact: f64, tolerance: f64) {
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
        let (image, _) = render(desc, &Job { resolution: [8, 8], samples: 8192, integrator, ..Job::default() });
        let (mean, error) = mean_and_error(&image);
        println!("{what}, {integrator:?}: {mean:.9e} +- {error:.1e}, exact {exact:.9e}");
        assert!(error <= tolerance * exact, "{what}, {integrator:?}: {mean} +- {error} proves nothing");
        // One part in a million is left to single precision where the estimate has no variance.
        let allowed = (4.0 * error + 1e-6 * exact).min(3.0 * tolerance * exact + 1e-6 * exact);
        assert!((mean - exact).abs() <= allowed, "{what}, {integrator:?}: {mean} +- {error} instead of {exact}");
    }
}

/// A quad whose normal, by the order of its corners, points down or to -x: towards the receiver.
fn quad(corners: [[f64; 3]; 4]) -> ShapeDesc {
    ShapeDesc::Quad(corners.map(point))
}

fn ceiling(x: [f64; 2], y: [f64; 2], z: f64) -> ShapeDesc {
    quad([[x[0], y[0], z], [x[0], y[1], z], [x[1], y[1], z], [x[1], y[0], z]])
}

#[test]
fn polygons() {
    let upright = quad([[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]);
    let triangle = ShapeDesc::Triangle([[0.0, 0.0, 2.0], [0.0, 1.0, 2.0], [3.0, 0.0, 2.0]].map(point));
    for (what, light, exact) in [
        ("above the centre of 2 x 2", ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), 0.554_126_423_980),
        ("above a corner of 1 x 1", ceiling([0.0, 1.0], [0.0, 1.0], 1.0), 0.138_531_605_995),
        ("triangle", triangle, 0.071_732_284_170_3),
        ("upright, half under the horizon", upright, 0.111_468_394_005),
        ("tiny and far", ceiling([-5e-4, 5e-4], [-5e-4, 5e-4], 100.0), 3.183_098_861_73e-11),
    ] {
        check(what, &lit(0.5, 1e-3, vec![light]), exact, 1e-3);
    }
}

#[test]
fn polygon_that_almost_touches() {
    let above = ceiling([-5.0, 5.0], [-5.0, 5.0], 1e-4);
    check("10 x 10 at 1e-4", &lit(5e-5, 1e-6, vec![above]), 1.0 - 3.273e-10, 5e-4);
    let beside = ceiling([1e-3, 10.001], [-5.0, 5.0], 1e-4);
    check("1e-3 outside its edge", &lit(5e-5, 1e-6, vec![beside]), 0.002_481_404_785_33, 2e-3);
}

#[test]
fn spheres() {
    // Radius over distance 1/2, under angles from the normal up to below the horizon.
    for (degrees, exact) in [
        (0.0_f64, 0.25),
        (60.0, 0.125),
        (80.0, 0.054_695_816_445_5),
        (90.0, 0.028_834_442_811_2),
        (100.0, 0.011_283_772_028_8),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        for distance in [1e-3, 1.0, 1e3] {
            let centre = distance * DVec3::new(sin, 0.0, cos);
            let light = ShapeDesc::Sphere { centre, radius: 0.5 * distance };
            let desc = lit(0.1 * distance, 1e-3 * distance, vec![light]);
            check(&format!("sphere at {degrees} degrees, distance {distance}"), &desc, exact, 5e-4);
        }
    }
}

#[test]
fn points() {
    for distance in [1e-3, 1.0, 1e4] {
        let mut desc = lit(0.1 * distance, 1e-3 * distance, vec![]);
        let direction = DVec3::new(0.6, 0.0, 0.8);
        desc.lights.push(point_light(distance * direction, (distance * distance) as f32));
        // No variance but for the footprint: an exact test.
        let (image, _) = render(&desc, &Job { resolution: [4, 4], samples: 64, ..Job::default() });
        let exact = 0.8 / PI;
        for &value in &image.rgb {
            assert!((f64::from(value) / exact - 1.0).abs() < 1e-4, "{value} instead of {exact} at {distance}");
        }
        let mean = image.mean()[0];
        assert!((mean / exact - 1.0).abs() < 2e-6, "{mean} instead of {exact} at {distance}");
    }
}

#[test]
fn the_back_of_a_light_is_dark() {
    // The same square, its corners the other way round: it shines upwards.
    let away = quad([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
        let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
        let (image, _) = render(&lit(0.5, 1e-3, vec![away]), &job);
        assert!(image.rgb.iter().all(|&value| value == 0.0), "light from behind");
        // Seen directly: black from below, 1 from above.
        let mut desc = lit(0.5, 1e-3, vec![away]);
        for (eye, radiance) in [(0.5, 0.0), (1.5, 1.0)] {
            desc.camera = camera(DVec3::new(0.3, 0.1, eye), DVec3::new(0.3, 0.1, 1.0), 1.0);
            let (image, _) = render(&desc, &job);
            assert!(image.rgb.iter().all(|&value| value == radiance), "from {eye}");
        }
    }
}

#[test]
fn many_lights_are_one() {
    // The 2 x 2 square in 1000 pieces.
    let side = |i: usize| f64::from(u32::try_from(i).unwrap());
    let small = |i: usize| {
        let (x, y) = (side(i % 40) / 20.0 - 1.0, side(i / 40) / 12.5 - 1.0);
        ceiling([x, x + 0.05], [y, y + 0.08], 1.0)
    };
    let desc = lit(0.5, 1e-3, (0..1000).map(small).collect());
    check("1000 tiles of the 2 x 2 square", &desc, 0.554_126_423_980, 5e-4);
}

#[test]
fn a_dim_light_beside_a_bright_one_out_of_sight() {
    // The bright one has all but 10^-9 of the power and lies below the receiver.
    let mut desc = lit(0.1, 1e-3, vec![]);
    desc.lights.push(point_light(DVec3::new(0.0, 0.0, 1.0), 1.0));
    desc.lights.push(point_light(DVec3::new(0.0, 0.0, -1.0), 1e9));
    check("dim beside bright", &desc, 1.0 / PI, 2e-3);
}
