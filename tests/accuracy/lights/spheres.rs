//! Spherical lights against their closed form, from touching to far away.

use etendue::desc::ShapeDesc;
use etendue::emitter::EmitterSet;
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Sampler, SobolSampler};

use super::{aim, convergence, irradiance, lit, rendered, sphere_factor, sphere_light, tilted};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L43", title: "sphere light, sine 1/2", run: tilts },
        Entry { id: "L43b", title: "sphere light, touching to far", run: extremes },
        Entry { id: "L43c", title: "on and in a sphere light", run: on_the_surface },
        Entry { id: "L43d", title: "sphere light in renders", run: renders },
    ]
}

/// Angle off the receiver's normal in degrees, and the factor.
const TILTS: [(f64, f64); 5] =
    [(0.0, 0.25), (60.0, 0.125), (80.0, 0.0546958164455), (90.0, 0.0288344428112), (100.0, 0.0112837720288)];

fn tilts(case: &mut Case) {
    let towards = DVec3::new(0.36, 0.48, 0.8);
    for (degrees, exact) in TILTS {
        let formula = sphere_factor(0.5, degrees.to_radians());
        case.exact(format!("{degrees}°: formula"), formula, exact, Within::Relative(1e-9));
        let normal = tilted(towards, degrees);
        for distance in [1e-4, 1.0, 1e4] {
            let set = EmitterSet::new(vec![sphere_light(distance * towards, 0.5 * distance)]);
            let found = irradiance(case, &set, Vec3::ZERO, normal);
            case.mean(format!("{degrees}°, distance {distance:e}"), found, exact, 1e-3);
        }
    }
    let set = EmitterSet::new(vec![sphere_light(towards, 0.5)]);
    convergence(case, "sine 1/2 at 80°", &set, Vec3::ZERO, tilted(towards, 80.0), TILTS[2].1);
}

/// A name, the radius, and the distance from the surface.
const EXTREMES: [(&str, f64, f64); 9] = [
    ("sine 1e-4", 1.0, 1e4),
    ("sine 1e-6", 1e-6, 1.0),
    ("sine 1e-8", 1e-8, 1.0),
    ("1e-4 of it above", 1.0, 1e-4),
    ("1e-6 of it above", 1.0, 1e-6),
    ("1 above radius 1e4", 1e4, 1.0),
    ("1 above radius 1e6", 1e6, 1.0),
    ("1e-3 above radius 1e3", 1e3, 1e-3),
    ("1000 above radius 1e6", 1e6, 1e3),
];

fn extremes(case: &mut Case) {
    let towards = DVec3::new(0.36, 0.48, 0.8);
    let p = Vec3::new(0.1, -0.2, 0.05);
    for (name, radius, height) in EXTREMES {
        let distance = radius + height;
        let centre = p.as_dvec3() + distance * towards;
        let set = EmitterSet::new(vec![sphere_light(centre, radius)]);
        // The receiver's place is what single precision holds; so is the distance from it.
        let exact_distance = (centre - p.as_dvec3()).length();
        for degrees in [0.0, 60.0, 89.0] {
            let sin = (radius / exact_distance).min(1.0);
            let exact = sphere_factor(sin, f64::to_radians(degrees));
            let normal = tilted((centre - p.as_dvec3()) / exact_distance, degrees);
            case.mean(format!("{name}, {degrees}°"), irradiance(case, &set, p, normal), exact, 1e-3);
        }
        // The shadow ray goes where the direction does, but for the rounding of its end.
        let mut sampler = SobolSampler::new(43, u32::MAX);
        let mut furthest = 0.0_f64;
        for i in 0..case.count(2_000, 1_000_000) {
            sampler.start(1, i as u32);
            if let Some(sample) = set.sample(p, sampler.next_4d()) {
                furthest = furthest.max(aim(p, sample.wi, sample.target));
            }
        }
        case.at_most(format!("{name}: shadow ray off the direction, rad"), furthest, 1e-5_f64.max(1e-6 / height));
    }
}

fn on_the_surface(case: &mut Case) {
    let tries = case.count(2_000, 1_000_000);
    let mut sampler = SobolSampler::new(43, u32::MAX);
    let set = EmitterSet::new(vec![sphere_light(DVec3::new(0.5, 0.0, 0.0), 1.0)]);
    for (what, distances) in
        [("at the centre and inside", [0.0, 0.5, 0.999]), ("on the surface, an ulp inside", [1.0, 1.0, 1.0 - 1.2e-7])]
    {
        let (mut lit, mut bad) = (0, 0);
        for distance in distances {
            let p = Vec3::new(0.5 - distance, 0.0, 0.0);
            for i in 0..tries {
                sampler.start(0, i as u32);
                let u = sampler.next_4d();
                // Light that may come from the surface itself comes along it.
                if let Some(sample) = set.sample(p, u) {
                    lit += u64::from(distance < 1.0 || sample.wi.x > 1e-3);
                    bad += u64::from(!(sample.pdf > 0.0 && sample.pdf.is_finite() && sample.wi.is_finite()));
                }
                let density = set.pdf(0, p, p + Vec3::X);
                bad += u64::from(density.is_nan() || density < 0.0);
            }
        }
        case.never(format!("{what}: light"), lit, 3 * tries);
        case.never(format!("{what}: no number"), bad, 6 * tries);
    }
}

fn renders(case: &mut Case) {
    for (degrees, exact) in TILTS {
        let (sin, cos) = degrees.to_radians().sin_cos();
        for distance in [1e-3, 1.0, 1e3] {
            let centre = distance * DVec3::new(sin, 0.0, cos);
            let desc = lit(0.1 * distance, 1e-3 * distance, vec![ShapeDesc::Sphere { centre, radius: 0.5 * distance }]);
            rendered(case, &format!("{degrees}°, distance {distance:e}"), &desc, exact, 1e-3);
        }
    }
}
