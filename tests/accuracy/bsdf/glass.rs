//! Radiance scaling at refraction: what an eye under water or in glass sees.

use etendue::bsdf::{BsdfSample, Dielectric, Model as _, TransportMode};
use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::spectrum::Rgb;

use crate::common::scenes::{Job, box_inside, camera, mean_and_error, render, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "B40", title: "radiance scaling of refraction", run: half_space },
        Entry { id: "B40b", title: "nested glass in a furnace", run: nested },
    ]
}

const GLASS: BsdfDesc = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };

/// n^2 (1 - F) for n = 1.5 by the angle in the glass, in degrees.
const SEEN: [(f64, f64); 8] = [
    (0.0, 2.16),
    (10.0, 2.25 * (1.0 - 0.0400829591551)),
    (30.0, 2.25 * (1.0 - 0.0551901672954)),
    (40.0, 2.25 * (1.0 - 0.245291204287)),
    (41.0, 2.25 * (1.0 - 0.379751265962)),
    (42.0, 0.0),
    (60.0, 0.0),
    (89.0, 0.0),
];

/// A horizontal square that faces down.
fn facing_down(size: f64, z: f64) -> ShapeDesc {
    let corner = |x: f64, y: f64| DVec3::new(size * x, size * y, z);
    ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)])
}

fn half_space(case: &mut Case) {
    // Both branches and their weights, without a choice.
    let dielectric = Dielectric::new(1.5, 1.0);
    for (theta, exact) in SEEN {
        let (sin, cos) = theta.to_radians().sin_cos();
        let wo = Vec3::new(sin as f32, 0.0, -cos as f32);
        let (reflectance, _, refracted) = dielectric.branches(wo);
        let seen = refracted.map_or(0.0, |(_, eta)| (1.0 - f64::from(reflectance)) / f64::from(eta).powi(2));
        case.exact(format!("{theta}°: n² (1 - F) of the branches"), seen, exact, Within::Absolute(1e-5));
    }
    // The eye one unit under a surface of glass, under a bright sky.
    let [up, down] = [1.0, -1.0].map(|side: f64| {
        let corner = |x: f64, y: f64| DVec3::new(1e3 * x * side, 1e3 * y, 0.0);
        ShapeDesc::Quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    });
    let inverse = BsdfDesc::Dielectric { ior: 1.0, exterior_ior: 1.5 };
    let samples = case.count(1024, 65_536) as u32;
    for (name, surface, bsdf) in [("normals up", up, GLASS), ("normals down", down, inverse)] {
        for (theta, exact) in SEEN {
            let (sin, cos) = theta.to_radians().sin_cos();
            let eye = DVec3::new(0.0, 0.0, -1.0);
            let mut desc = scene(
                camera(eye, eye + DVec3::new(sin, 0.0, cos), 0.01),
                vec![(surface, bsdf, None), (facing_down(1e5, 1.0), BsdfDesc::Black, Some(Rgb::ONE))],
            );
            for (integrator, whose) in [(IntegratorDesc::Path, "path"), (IntegratorDesc::Whitted, "Whitted")] {
                // Whitted's tree follows both branches: what is left is noise of the footprint.
                let samples = if whose == "path" { samples } else { samples / 16 };
                desc.render.integrator = integrator;
                let (image, _) = render(&desc, &Job { resolution: [8, 8], samples, integrator, ..Job::default() });
                let (mean, error) = mean_and_error(&image);
                let what = format!("{theta}°, {whose}, {name}");
                if exact == 0.0 {
                    case.exact(what, mean, 0.0, Within::Absolute(0.0));
                } else {
                    // 2e-7 of F at 41°, where it is steep, by the directions' rounding.
                    case.mean(what, (mean, error.hypot(1e-5 * exact)), exact, 3e-3);
                }
            }
        }
    }
    // There and back the factors cancel.
    let tries = case.count(20_000, 1_000_000);
    let mut rng = Rng::new(40, 0);
    let mut worst = 0.0_f64;
    for (ior, exterior) in [(1.5_f32, 1.0_f32), (1.333, 1.0), (2.417, 1.0), (1.0, 1.333), (1.333, 1.5), (1000.0, 1.0)] {
        let dielectric = Dielectric::new(ior, exterior);
        for _ in 0..tries / 6 {
            let there: BsdfSample = dielectric
                .sample(warps::uniform_sphere(rng.next_2d()), [0.0, 0.0, 1.0_f32.next_down()], TransportMode::Radiance)
                .unwrap();
            let back: BsdfSample =
                dielectric.sample(there.wi, [0.0, 0.0, 1.0_f32.next_down()], TransportMode::Radiance).unwrap();
            if there.eta != 1.0 && back.eta != 1.0 {
                worst = worst.max((f64::from(there.weight.r()) * f64::from(back.weight.r()) - 1.0).abs());
            }
        }
    }
    case.at_most("weight in times weight out, off 1", worst, 5e-7);
}

/// Balls of glass inside one another in a bright room.
fn onion(eye: DVec3, layers: &[(f64, f32, f32)]) -> SceneDesc {
    let mut surfaces = vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Black, Some(Rgb::ONE))];
    surfaces.extend(layers.iter().map(|&(radius, ior, exterior_ior)| {
        let ball = ShapeDesc::Sphere { centre: DVec3::ZERO, radius };
        (ball, BsdfDesc::Dielectric { ior, exterior_ior }, None)
    }));
    let mut desc = scene(camera(eye, DVec3::new(0.0, 0.1, -1.0), 60.0), surfaces);
    desc.meshes.push(box_inside(DVec3::splat(-5.0), DVec3::splat(5.0)).into());
    desc
}

fn nested(case: &mut Case) {
    // Outer radius, index inside and outside of each layer.
    let one = [(1.0, 1.5, 1.0)];
    let three = [(1.0, 1.333, 1.0), (0.8, 1.5, 1.333), (0.5, 2.417, 1.5)];
    let bubble = [(1.0, 1.5, 1.0), (0.9, 1.0, 1.5)];
    let samples = case.count(64, 4096) as u32;
    for (name, layers, eye, exact) in [
        ("one ball, from outside", &one[..], DVec3::new(0.0, 0.0, 3.0), 1.0),
        ("three balls, from outside", &three, DVec3::new(0.0, 0.0, 3.0), 1.0),
        ("bubble, from outside", &bubble, DVec3::new(0.0, 0.0, 3.0), 1.0),
        ("one ball, from inside", &one, DVec3::new(0.0, 0.0, 0.1), 2.25),
        ("three balls, from inside", &three, DVec3::new(0.0, 0.0, 0.05), f64::from(2.417_f32).powi(2)),
        ("bubble, from inside", &bubble, DVec3::new(0.0, 0.0, 0.3), 1.0),
    ] {
        for (integrator, whose) in [(IntegratorDesc::Path, "path"), (IntegratorDesc::Whitted, "Whitted")] {
            let desc = onion(eye, layers);
            let (image, _) = render(&desc, &Job { resolution: [16, 16], samples, integrator, ..Job::default() });
            let furthest = image.rgb.iter().fold(exact, |furthest: f64, &value| {
                let value = f64::from(value);
                if (value - exact).abs() > (furthest - exact).abs() { value } else { furthest }
            });
            // No weight varies until roulette begins, after 64 bounces: few paths are trapped in a ball for so long.
            let (mean, _) = mean_and_error(&image);
            case.exact(format!("{name}, {whose}: mean"), mean, exact, Within::Relative(1e-5));
            case.exact(format!("{name}, {whose}: worst pixel"), furthest, exact, Within::Relative(1e-3));
        }
    }
}
