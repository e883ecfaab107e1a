//! Light samples and Bsdf samples, alone and combined, must agree.

use etendue::bsdf::{Bsdf, Model as _, TransportMode};
use etendue::desc::{BsdfDesc, RenderDesc, ShapeDesc};
use etendue::math::{DVec3, Frame, Ray, Vec3};
use etendue::sampling::{Sampler, SobolSampler, mis};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{INTEGRATORS, ceiling, lit, sphere_factor};
use crate::common::scenes::{camera, mean_and_error, render_scene, scene};
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L48", title: "combined sampling", run: plates },
        Entry { id: "L48b", title: "weights", run: weights },
        Entry { id: "L48c", title: "number of shadow rays", run: shadow_rays },
        Entry { id: "L48d", title: "specular hits on lights", run: specular },
    ]
}

/// Radii of four spherical lights at distance 1.
const RADII: [f64; 4] = [0.03, 0.1, 0.3, 0.9];

/// How light and Bsdf samples are weighed: what the other density counts for.
pub(super) type Weight = fn(f32, f32) -> f32;

fn plates(case: &mut Case) {
    let tilt = 0.4_f64;
    for radius in RADII {
        let centre = DVec3::new(tilt.sin(), 0.0, tilt.cos());
        // Of equal power.
        let radiance = (0.01 / (radius * radius)) as f32;
        let desc = scene(
            camera(DVec3::ZERO, DVec3::Z, 10.0),
            vec![(ShapeDesc::Sphere { centre, radius }, BsdfDesc::Black, Some(Rgb::splat(radiance)))],
        );
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        for (name, bsdf) in [
            ("Lambert", BsdfDesc::Lambert { albedo: Rgb::ONE }),
            ("qualitative 0.5", BsdfDesc::OrenNayarQualitative { albedo: Rgb::ONE, sigma: 0.5 }),
            ("Fujii 1", BsdfDesc::OrenNayar { albedo: Rgb::ONE, roughness: 1.0 }),
        ] {
            let bsdf = Bsdf::new(&bsdf);
            let estimate = |light: Weight, scattering: Weight, size: u64| {
                let values = direct(&scene, &bsdf, light, scattering, size as u32);
                stats::mean_and_error(&values)
            };
            let size = case.count(2048, 16_384);
            let light_only = estimate(|_, _| 1.0, |_, _| 0.0, size);
            // A ball this small is hardly ever met by chance.
            let (many, rough) = if radius < 0.1 { (case.count(1 << 15, 1 << 18), 5e-2) } else { (8 * size, 1e-2) };
            let results = [
                ("Bsdf samples", estimate(|_, _| 0.0, |_, _| 1.0, many), if case.is_full() { 1e-2 } else { rough }),
                ("balance heuristic", estimate(mis::balance_heuristic, mis::balance_heuristic, size), 1e-3),
                ("power heuristic", estimate(mis::power_heuristic, mis::power_heuristic, size), 1e-3),
            ];
            if name == "Lambert" {
                let exact = f64::from(radiance) * sphere_factor(radius, tilt);
                case.mean(format!("{name}, radius {radius}: light samples"), light_only, exact, 1e-3);
                for (technique, found, tolerance) in results {
                    case.mean(format!("{name}, radius {radius}: {technique}"), found, exact, tolerance);
                }
            } else {
                for (technique, found, tolerance) in results {
                    let what = format!("{name}, radius {radius}: {technique}, light");
                    case.equal_means(what, found, light_only, tolerance);
                }
            }
        }
    }
}

/// Radiance that a surface around the origin with normal z sends along (sin 30°, 0, cos 30°), of each replicate.
pub(super) fn direct(scene: &Scene, bsdf: &Bsdf, light: Weight, scattering: Weight, size: u32) -> Vec<f64> {
    let frame = Frame::from_normal(Vec3::Z);
    let wo = frame.to_local(Vec3::new(0.5, 0.0, 0.75_f32.sqrt()));
    let p = scene.to_scene(DVec3::ZERO);
    let mut sampler = SobolSampler::new(48, size);
    let mut value = |i| {
        sampler.start(0, i);
        let mut radiance = 0.0;
        if let Some(sample) = scene.emitters().sample(p, sampler.next_4d()) {
            let wi = frame.to_local(sample.wi);
            let (f, pdf) = bsdf.f_pdf(wo, wi, TransportMode::Radiance);
            let weight = light(sample.pdf, pdf);
            radiance += f64::from(f.r() * sample.radiance.r() * wi.z.abs() * weight / sample.pdf);
        }
        let [a, b, c, _] = sampler.next_4d();
        if let Some(sample) = bsdf.sample(wo, [a, b, c], TransportMode::Radiance) {
            let ray = Ray::new(p, frame.to_world(sample.wi));
            if let Some(hit) = scene.intersect(&ray) {
                let surface = scene.interaction(&ray, &hit);
                let emitter = surface.emitter.expect("the only surface shines");
                let le = scene.emitters().le(emitter, surface.ng, -ray.direction, surface.point.p);
                let pdf = scene.emitters().pdf(emitter, p, surface.point.p);
                radiance += f64::from(sample.weight.r() * le.r() * scattering(sample.pdf, pdf));
            }
        }
        radiance
    };
    let replicate = |r: u32| (r * size..(r + 1) * size).map(&mut value).sum::<f64>() / f64::from(size);
    (0..super::REPLICATES).map(replicate).collect()
}

fn weights(case: &mut Case) {
    let values = [0.0, 1e-45, 1e-30, 1e-3, 0.3, 1.0, 7.0, 1e20, 3e38, f32::INFINITY];
    for (name, heuristic) in [("balance", mis::balance_heuristic as Weight), ("power", mis::power_heuristic)] {
        let (mut worst, mut bad) = (0.0_f64, 0);
        for a in values {
            for b in values {
                let (one, other) = (heuristic(a, b), heuristic(b, a));
                bad += u64::from(!(0.0..=1.0).contains(&one) || (a == 0.0 && one != 0.0));
                if a > 0.0 || b > 0.0 {
                    worst = worst.max((f64::from(one) + f64::from(other) - 1.0).abs());
                }
            }
        }
        case.at_most(format!("{name}: sum off 1, densities 0 to infinity"), worst, 1e-6);
        case.never(format!("{name}: outside [0, 1]"), bad, 100);
        case.exact(format!("{name}: no other technique"), f64::from(heuristic(3.0, 0.0)), 1.0, Within::Absolute(0.0));
        case.exact(
            format!("{name}: certain other"),
            f64::from(heuristic(3.0, f32::INFINITY)),
            0.0,
            Within::Absolute(0.0),
        );
    }
    case.exact("balance: 3 against 1", f64::from(mis::balance_heuristic(3.0, 1.0)), 0.75, Within::Ulps(1.0));
    case.exact("power: 3 against 1", f64::from(mis::power_heuristic(3.0, 1.0)), 0.9, Within::Ulps(1.0));
}

fn shadow_rays(case: &mut Case) {
    let samples = case.count(1024, 8192) as u32;
    let (sin, cos) = 1.1_f64.sin_cos();
    for (what, light, exact) in [
        ("large", ceiling([-1.0, 1.0], [-1.0, 1.0], 1.0), 0.554126423980),
        ("near", ceiling([-5.0, 5.0], [-5.0, 5.0], 1e-2), 1.0 - 3.27323933e-6),
        ("small", ShapeDesc::Sphere { centre: DVec3::new(sin, 0.0, cos), radius: 0.01 }, 1e-4 * cos),
    ] {
        let eye = if what == "near" { 5e-3 } else { 0.5 };
        let scene = Scene::build(&lit(eye, 1e-3, vec![light]), &BuildOptions::default()).expect("a scene of the test");
        for (name, integrator) in INTEGRATORS {
            for shadow_rays in [1, 4, 8] {
                let desc = RenderDesc {
                    resolution: [8, 8],
                    samples,
                    integrator,
                    shadow_rays,
                    seed: 48,
                    ..RenderDesc::default()
                };
                let (image, _) = render_scene(&scene, desc);
                let row = format!("{what}, {name}, {shadow_rays} shadow rays");
                case.mean(row, mean_and_error(&image), exact, 1e-3);
            }
        }
    }
}

fn specular(case: &mut Case) {
    // No light sample could have made what a mirror or glass shows: it counts in full, without noise.
    let mirror = BsdfDesc::Mirror { reflectance: Rgb::splat(0.75) };
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.5 };
    let receiver = super::quad([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
    let eye = DVec3::new(0.0, -0.5, 0.5);
    for (what, bsdf, z, exact) in [("mirror", mirror, 1.0_f64, 0.75), ("glass of equal index", glass, -0.5, 1.0)] {
        for (size, half) in [("large", 10.0), ("small", 0.05)] {
            // Below the receiver the order of the corners has to be the other way round.
            let (x, y) = ([-half, half], [z.abs() - half, z.abs() + half]);
            let light = if z > 0.0 { ceiling(x, y, z) } else { ceiling([x[1], x[0]], y, z) };
            let desc = scene(
                camera(eye, DVec3::ZERO, 0.1),
                vec![(receiver, bsdf, None), (light, BsdfDesc::Black, Some(Rgb::ONE))],
            );
            let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
            for (name, integrator) in INTEGRATORS {
                let desc = RenderDesc { resolution: [8, 8], samples: 64, integrator, ..RenderDesc::default() };
                let (image, _) = render_scene(&scene, desc);
                let furthest =
                    image.rgb.iter().fold(0.0_f64, |most, &value| most.max((f64::from(value) - exact).abs()));
                case.at_most(format!("{what}, {size} light, {name}: worst pixel off"), furthest, 1e-6);
            }
        }
    }
}
