//! Rooms whose every bounce is known in closed form: spheres, and planes without an end. Unlike furnaces they see a wrong
//! direction or a wrong distance.

use std::f64::consts::PI;

use super::{Known, ball, converges, grey, measure, parallelogram, pick, plane};
use crate::common::scenes::{Job, camera, point_light, scene};
use crate::record::{Case, Entry};
use etendue::desc::{BsdfDesc, IntegratorDesc, SamplerDesc, SceneDesc, ShapeDesc};
use etendue::math::{Bounds, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R56", title: "integrating sphere", run: integrating_sphere },
        Entry { id: "R56b", title: "spherical cavity", run: cavity },
        Entry { id: "R58", title: "point light between infinite planes", run: planes },
        Entry { id: "R58b", title: "infinite plates, one of them shining", run: plates },
    ]
}

/// Degrees: so narrow that what varies across the image does so by less than a millionth.
const POINT: f64 = 0.1;

/// A job that looks at one point.
fn point_job(samples: u64) -> Job {
    Job { resolution: [16, 16], samples: samples as u32, ..Job::default() }
}

/// A diffuse sphere around the origin with a point light in it, and its reflected radiance at a point of the wall:
/// rho E / pi + rho^2 Phi / (4 pi^2 R^2 (1 - rho)), E being direct. Every other share of the light is even.
pub fn sphere_with_light(radius: f64, albedo: f32, intensity: f32, light: DVec3, point: DVec3) -> (SceneDesc, f64) {
    let mut desc =
        scene(camera(DVec3::new(-0.1, 0.3, 0.2), point, POINT), vec![(ball(DVec3::ZERO, radius), grey(albedo), None)]);
    desc.lights.push(point_light(light, intensity));
    let (rho, i) = (f64::from(albedo), f64::from(intensity));
    let to_light = light - point;
    let direct = i * -to_light.normalize().dot(point / radius) / to_light.length_squared();
    let exact = rho * direct / PI + rho * rho * 4.0 * PI * i / (4.0 * PI * PI * radius * radius * (1.0 - rho));
    (desc, exact)
}

fn integrating_sphere(case: &mut Case) {
    let tolerance = pick(case, 5e-3, 3e-4);
    let offset = DVec3::X * 0.8;
    for (what, radius, albedo, intensity, light, point, stated) in [
        ("light in the centre", 1.0, 0.5, std::f32::consts::PI, DVec3::ZERO, DVec3::Z, 1.0),
        ("eccentric light, nearest point", 2.0, 0.7, 5.0, offset, DVec3::X * 2.0, 1.423_552_546_54),
        ("eccentric light, farthest point", 2.0, 0.7, 5.0, offset, DVec3::X * -2.0, 0.791_985_312_053),
        ("eccentric light, side", 2.0, 0.7, 5.0, offset, DVec3::Y * 2.0, 0.872_814_060_219),
    ] {
        let (desc, exact) = sphere_with_light(radius, albedo, intensity, light, point);
        assert!((exact / stated - 1.0).abs() < 1e-6, "{what}: {exact}");
        case.mean(what, measure(&desc, &point_job(case.count(64, 4096))), exact, tolerance);
        if what.ends_with("side") {
            converges(case, "integrating sphere", &desc, (Known::EachPixel, exact));
        }
    }
    // What the integrators leave out is left out of the sum as well.
    let (desc, all) = sphere_with_light(2.0, 0.7, 5.0, offset, DVec3::Y * 2.0);
    let rho = f64::from(0.7_f32);
    let direct = all - rho * rho * 5.0 / (PI * 4.0 * (1.0 - rho));
    for integrator in [IntegratorDesc::Direct, IntegratorDesc::Whitted] {
        let job = Job { integrator, ..point_job(4) };
        case.mean(format!("{integrator:?}: direct light alone"), measure(&desc, &job), direct, 1e-5);
    }
    for (sampler, name) in [(SamplerDesc::Random, "random"), (SamplerDesc::Jittered, "jittered")] {
        let job = point_job(case.count(64, 4096));
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let (image, _) =
            crate::common::scenes::render_scene(&scene, etendue::desc::RenderDesc { sampler, ..job.desc() });
        let got = crate::common::scenes::mean_and_error(&image);
        case.mean(format!("side, {name} samples"), got, all, pick(case, 5e-3, 1e-3));
    }
}

fn cavity(case: &mut Case) {
    // A sphere with a share s of its surface cut off, uniform light in the opening: inside, rho s / (1 - rho (1 - s)).
    let tolerance = pick(case, 5e-3, 5e-4);
    for (share, albedo, stated) in [(0.1, 0.8_f32, 0.285_714_285_714), (0.01, 0.95, 0.159_663_865_546)] {
        let top = 1.0 - 2.0 * share;
        let clip = Bounds { min: DVec3::splat(-2.0), max: DVec3::new(2.0, 2.0, top) };
        let wall = ShapeDesc::Quadric { coefficients: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], clip };
        // Just larger than the opening.
        let half = 1.01 * (1.0 - top * top).sqrt();
        let sky = parallelogram(DVec3::new(-half, -half, top), DVec3::Y * (2.0 * half), DVec3::X * (2.0 * half));
        let camera = camera(DVec3::new(0.2, 0.1, 0.0), DVec3::new(0.3, -0.5, -0.81), POINT);
        let desc = scene(camera, vec![(wall, grey(albedo), None), (sky, BsdfDesc::Black, Some(Rgb::ONE))]);
        let rho = f64::from(albedo);
        let exact = rho * share / (1.0 - rho * (1.0 - share));
        assert!((exact / stated - 1.0).abs() < 1e-6, "{exact}");
        let what = format!("albedo {albedo}, {share} of it open");
        case.mean(&what, measure(&desc, &point_job(case.count(128, 4096))), exact, tolerance);
        converges(case, &format!("cavity of {what}"), &desc, (Known::EachPixel, exact));
    }
}

/// Two square sheets so large that they have no end, at y = 0 and 1.
fn sheets(rho: [f32; 2], emission: Option<Rgb>) -> Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)> {
    let floor = plane(DVec3::ZERO, DVec3::Y, 500.0);
    let ceiling = plane(DVec3::Y, DVec3::NEG_Y, 500.0);
    vec![(floor, grey(rho[0]), emission), (ceiling, grey(rho[1]), None)]
}

/// A floor under a ceiling at 1, a light of intensity 1 half-way, seen at this distance from the point under it.
pub fn floor_and_ceiling(rho: f32, r: f64) -> SceneDesc {
    let mut desc =
        scene(camera(DVec3::new(r + 0.3, 0.7, 0.2), DVec3::new(r, 0.0, 0.0), POINT), sheets([rho, rho], None));
    desc.lights.push(point_light(DVec3::Y * 0.5, 1.0));
    desc
}

/// Irradiance there: (albedo, distance, value), by the Hankel transform of the exchange between the planes.
pub const FLOOR_IRRADIANCE: [(f32, f64, f64); 4] =
    [(0.5, 0.0, 4.528_129_526), (0.8, 0.0, 5.177_588_122), (0.8, 1.0, 1.108_237_669), (0.8, 3.0, 0.201_985_157_5)];

fn planes(case: &mut Case) {
    for ((rho, r, irradiance), (quick, full), tolerance) in FLOOR_IRRADIANCE
        .into_iter()
        .zip([(64, 1024), (64, 1024), (128, 4096), (512, 16384)])
        .zip([(3e-3, 3e-4), (3e-3, 3e-4), (5e-3, 1e-3), (7e-3, 2e-3)])
        .map(|((values, counts), tolerance)| (values, counts, tolerance))
    {
        let desc = floor_and_ceiling(rho, r);
        let got = measure(&desc, &point_job(case.count(quick, full)));
        let exact = f64::from(rho) / PI * irradiance;
        case.mean(format!("albedo {rho}, distance {r}"), got, exact, pick(case, tolerance.0, tolerance.1));
        if r == 1.0 {
            converges(case, "floor and ceiling at distance 1", &desc, (Known::EachPixel, exact));
        }
    }
}

fn plates(case: &mut Case) {
    // Radiosities 1 + 0.5 B2 and 0.8 B1, the first of an exitance of 1.
    let (rho, emission) = ([0.5, 0.8], Some(Rgb::splat(std::f32::consts::FRAC_1_PI)));
    let tolerance = pick(case, 4e-3, 3e-4);
    for (what, target, exact) in [("shining plate", 0.0, 5.0 / 3.0), ("the other plate", 1.0, 4.0 / 3.0)] {
        let desc = scene(camera(DVec3::Y * 0.5, DVec3::new(0.3, target, 0.1), POINT), sheets(rho, emission));
        case.mean(what, measure(&desc, &point_job(case.count(64, 4096))), exact / PI, tolerance);
        if target > 0.0 {
            converges(case, "plate before a shining one", &desc, (Known::EachPixel, exact / PI));
        }
    }
}
