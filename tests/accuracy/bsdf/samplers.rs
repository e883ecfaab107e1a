//! That samples follow the densities they claim, by Pearson's test in cells and by the densities' integrals.

use std::f64::consts::PI;

use etendue::bsdf::{Model as _, TransportMode};
use etendue::math::Vec3;
use etendue::sampling::{Rng, warps};

use super::{diffuse_models, direction, inverses, uniform_3d};
use crate::record::{Case, Entry, Within};
use crate::stats::{DensityCheck, check_density, check_directions};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "B38", title: "samples of the models", run: models },
        Entry { id: "B38b", title: "warps", run: warps_follow_their_densities },
    ]
}

/// Worst of the checks of one sampler, as three rows.
fn rows(case: &mut Case, name: &str, checks: &[DensityCheck], tests: usize) {
    let p = checks.iter().map(|check| check.p_value).fold(1.0, f64::min);
    let further = |a: f64, b: f64| if (b - 1.0).abs() > (a - 1.0).abs() || b.is_nan() { b } else { a };
    let integral = checks.iter().map(|check| check.integral).fold(1.0, further);
    let mismatch = checks.iter().map(|check| check.mismatch).fold(0.0, f64::max);
    case.p_value(format!("{name}: chi-square in cells"), p, tests);
    case.exact(format!("{name}: integral of the density"), integral, 1.0, Within::Absolute(1e-3));
    case.at_most(format!("{name}: density asked for, off the sample's"), mismatch, 1e-5);
}

/// Incident directions; the last two graze, and look from below.
fn incident() -> [Vec3; 5] {
    let grazing = 0.05_f64.acos().to_degrees();
    [
        direction(0.0, 0.0),
        direction(30.0, 45.0),
        direction(60.0, 200.0),
        direction(grazing, 10.0),
        direction(150.0, 300.0),
    ]
}

fn models(case: &mut Case) {
    let draws = case.count(60_000, 1_000_000) as usize;
    let models = diffuse_models();
    for (i, (name, bsdf)) in models.iter().enumerate() {
        let mut worst_weight = 0.0_f64;
        let checks: Vec<_> = incident()
            .into_iter()
            .enumerate()
            .map(|(j, wo)| {
                let mut rng = Rng::new(38, (i * 100 + j) as u64);
                let draw = || {
                    let Some(sample) = bsdf.sample(wo, uniform_3d(&mut rng), TransportMode::Radiance) else {
                        return ([f32::NAN; 3], 0.0);
                    };
                    let (f, weight) =
                        (f64::from(bsdf.f(wo, sample.wi, TransportMode::Radiance).r()), f64::from(sample.weight.r()));
                    let found = f * f64::from(sample.wi.z.abs()) / f64::from(sample.pdf);
                    worst_weight = worst_weight.max((weight - found).abs() / weight);
                    (sample.wi.to_array(), sample.pdf)
                };
                check_directions(draws, draw, |wi| bsdf.pdf(wo, Vec3::from_array(wi)))
            })
            .collect();
        rows(case, name, &checks, models.len() * incident().len());
        case.at_most(format!("{name}: weight against f cos / pdf"), worst_weight, 1e-5);
    }
}

/// A warp to directions, its density and its inverse.
type DirectionWarp =
    (&'static str, Box<dyn Fn([f32; 2]) -> Vec3>, Box<dyn Fn(Vec3) -> f32>, Box<dyn Fn(Vec3) -> [f32; 2]>);

fn direction_warps() -> Vec<DirectionWarp> {
    let cone = |name, omc: f32| -> DirectionWarp {
        (
            name,
            Box::new(move |u| warps::uniform_cone(u, omc)),
            Box::new(move |w| if 1.0 - w.z <= omc { warps::uniform_cone_pdf(omc) } else { 0.0 }),
            Box::new(move |w| inverses::uniform_cone_inverse(w, omc)),
        )
    };
    vec![
        (
            "cosine hemisphere",
            Box::new(warps::cosine_hemisphere),
            Box::new(|w| warps::cosine_hemisphere_pdf(w.z)),
            Box::new(inverses::cosine_hemisphere_inverse),
        ),
        (
            "hemisphere",
            Box::new(warps::uniform_hemisphere),
            Box::new(|w| if w.z >= 0.0 { warps::uniform_hemisphere_pdf() } else { 0.0 }),
            Box::new(inverses::uniform_hemisphere_inverse),
        ),
        (
            "sphere",
            Box::new(warps::uniform_sphere),
            Box::new(|_| warps::uniform_sphere_pdf()),
            Box::new(inverses::uniform_sphere_inverse),
        ),
        cone("cone of 37°", 0.2),
        cone("cone of 73°", 0.7),
        cone("cone of 127°", 1.6),
    ]
}

/// Numbers at which warps have seams, corners and poles.
fn corner_numbers() -> Vec<[f32; 2]> {
    let values = [0.0, f32::MIN_POSITIVE, 0.25, 0.5_f32.next_down(), 0.5, 0.75, 1.0_f32.next_down()];
    values.iter().flat_map(|&a| values.map(|b| [a, b])).collect()
}

fn warps_follow_their_densities(case: &mut Case) {
    let draws = case.count(60_000, 1_000_000) as usize;
    let warps = direction_warps();
    let tests = warps.len() + 2;
    for (i, (name, warp, pdf, inverse)) in warps.iter().enumerate() {
        let mut rng = Rng::new(38, 1000 + i as u64);
        let draw = || {
            let w = warp(rng.next_2d());
            (w.to_array(), pdf(w))
        };
        let check = check_directions(draws, draw, |w| pdf(Vec3::from_array(w)));
        rows(case, name, &[check], tests);

        let (mut length, mut back, mut low) = (0.0_f32, 0.0_f32, 0);
        let numbers = corner_numbers().into_iter().chain((0..draws / 8).map(|_| rng.next_2d()));
        let is_hemisphere = name.ends_with("hemisphere");
        for u in numbers {
            let w = warp(u);
            length = length.max((w.length() - 1.0).abs());
            low += u64::from(is_hemisphere && w.z <= 0.0);
            // The square's edges fold onto one another where the angle wraps or the pole is.
            if u.iter().all(|x| (1e-3..0.999).contains(x)) {
                let found = inverse(w);
                back = back.max((found[0] - u[0]).abs()).max((found[1] - u[1]).abs());
            }
        }
        case.at_most(format!("{name}: length off 1"), f64::from(length), 3e-7);
        case.at_most(format!("{name}: there and back"), f64::from(back), 3e-5);
        if is_hemisphere {
            case.never(format!("{name}: directions in the plane"), low, draws as u64 / 8);
        }
    }

    let mut rng = Rng::new(38, 2000);
    let draw = || {
        let [x, y] = warps::uniform_disk(rng.next_2d());
        (f64::from(x), f64::from(y), f64::from(warps::uniform_disk_pdf()))
    };
    let inside = |x: f64, y: f64| if x * x + y * y <= 1.0 { f64::from(warps::uniform_disk_pdf()) } else { 0.0 };
    let check = check_density((50, 50), ((-1.0, 1.0), (-1.0, 1.0)), draws, draw, inside);
    rows(case, "disc", &[check], tests);
    let mut rng = Rng::new(38, 2001);
    let draw = || {
        let [b0, b1, _] = warps::uniform_triangle(rng.next_2d());
        (f64::from(b0), f64::from(b1), 2.0)
    };
    let below = |x: f64, y: f64| if x + y <= 1.0 { 2.0 } else { 0.0 };
    let check = check_density((50, 50), ((0.0, 1.0), (0.0, 1.0)), draws, draw, below);
    rows(case, "triangle", &[check], tests);
    let (mut bad, mut back) = (0, 0.0_f32);
    for u in corner_numbers().into_iter().chain((0..draws / 8).map(|_| rng.next_2d())) {
        let p = warps::uniform_disk(u);
        let b = warps::uniform_triangle(u);
        let fine = p[0].hypot(p[1]) <= 1.0
            && b.iter().all(|x| (0.0..=1.0).contains(x))
            && (b.iter().sum::<f32>() - 1.0).abs() < 2e-7;
        bad += u64::from(!fine);
        for found in [inverses::uniform_disk_inverse(p), inverses::uniform_triangle_inverse(b)] {
            back = back.max((found[0] - u[0]).abs()).max((found[1] - u[1]).abs());
        }
    }
    case.never("disc and triangle: points outside", bad, draws as u64 / 8);
    case.at_most("disc and triangle: there and back", f64::from(back), 1e-6);

    // A ball of radius 1 at distance 1e5, where 1 - cos in single precision would be 0.
    let omc = warps::one_minus_cos_from_sin2(1e-10);
    let solid_angle = f64::from(omc) * 2.0 * PI;
    case.exact("cone of sine 1e-5: solid angle", solid_angle, 3.14159265367e-10, Within::Relative(1e-6));
    let density = 1.0 / f64::from(warps::uniform_cone_pdf(omc));
    case.exact("cone of sine 1e-5: one over the density", density, 3.14159265367e-10, Within::Relative(1e-6));
    let mut worst = 0.0_f64;
    for _ in 0..draws / 8 {
        let u = rng.next_2d();
        let w = warps::uniform_cone(u, omc);
        let sin2 = f64::from(w.x).powi(2) + f64::from(w.y).powi(2);
        let back = f64::from(inverses::uniform_cone_inverse(w, omc)[0] - u[0]).abs();
        worst = worst.max((sin2 / 1e-10 - f64::from(u[0])).abs()).max(back);
    }
    case.at_most("cone of sine 1e-5: sin² against the number drawn", worst, 1e-5);
}
