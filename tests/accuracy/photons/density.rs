//! Density estimates: kernels, the nearest photons, and the bias of a disk of finite size.

use std::f64::consts::PI;

use super::{asked, build, fixed, map, runs, seeded, shot, unseen};
use crate::common::scenes::point_light;
use crate::lights::{polygon_factor, sphere_factor};
use crate::record::{Case, Entry, Within};
use crate::stats;
use crate::transport::{ball, grey, parallelogram, pick};
use etendue::Cancel;
use etendue::desc::{BsdfDesc, KernelDesc, ShapeDesc};
use etendue::integrator::photon::{Kernel, MapKind, MapQuery, Photon, PhotonMap};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M64", title: "kernels", run: kernels },
        Entry { id: "M64b", title: "uniform photons, the k nearest", run: nearest },
        Entry { id: "M64c", title: "bias of a disk's size", run: bias },
        Entry { id: "M64d", title: "lamps over a floor", run: lamps },
    ]
}

/// Kernels with their names, and the mean of the squared distance over the kernel in squared radii.
const KERNELS: [(&str, KernelDesc, f64); 5] = [
    ("flat", KernelDesc::Flat, 0.5),
    ("cone, k 1", KernelDesc::Cone { k: 1.0 }, 0.3),
    ("cone, k 1.1", KernelDesc::Cone { k: 1.1 }, 0.5 * (1.0 - 0.8 / 1.1) / (1.0 - 2.0 / 3.3)),
    ("cone, k 2", KernelDesc::Cone { k: 2.0 }, 0.5 * (1.0 - 0.8 / 2.0) / (1.0 - 2.0 / 6.0)),
    ("Epanechnikov", KernelDesc::Epanechnikov, 1.0 / 3.0),
];

fn kernels(case: &mut Case) {
    for (name, desc, _) in KERNELS {
        let kernel = Kernel::new(desc);
        for radius in [1e-6_f32, 0.3, 1e6] {
            // By midpoints of the squared distance, in which a uniform density is uniform.
            let steps = 1 << 16;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let q = (f64::from(i) + 0.5) / f64::from(steps);
                    f64::from(kernel.density(q as f32 * radius * radius, radius))
                })
                .sum::<f64>();
            let integral = sum / f64::from(steps) * PI * f64::from(radius).powi(2);
            case.exact(format!("{name}, radius {radius:e}: integral"), integral, 1.0, Within::Relative(1e-5));
        }
        let beyond = kernel.density(1.0, 1.0) + kernel.density(1.0001, 1.0) + kernel.density(f32::INFINITY, 1.0);
        case.exact(format!("{name}: beyond the radius"), beyond.into(), 0.0, Within::Absolute(0.0));
        let worst = (1..=8)
            .map(|i| {
                let share = f64::from(i) / 8.0;
                let steps = 1 << 14;
                let inside: f64 = (0..steps)
                    .map(|j| {
                        f64::from(kernel.density(((f64::from(j) + 0.5) / f64::from(steps) * share * share) as f32, 1.0))
                    })
                    .sum();
                let exact = inside / f64::from(steps) * share * share * PI;
                (f64::from(kernel.mass(share as f32)) - exact).abs()
            })
            .fold(0.0, f64::max);
        case.at_most(format!("{name}: worst part of the integral"), worst, 1e-5);
    }
    // The cone's normalisation, 1 - 2 / (3 k), by its value in the middle.
    for (k, exact) in [(1.0, 1.0 / 3.0), (1.1, 0.393_939_393_939), (2.0, 2.0 / 3.0)] {
        let middle = f64::from(Kernel::new(KernelDesc::Cone { k }).density(0.0, 1.0));
        case.exact(format!("normalisation of the cone, k {k}"), 1.0 / (PI * middle), exact, Within::Relative(3e-7));
    }
}

/// Photons of this power in these places of the plane y = 0, seen from above.
fn plane_map(places: impl Iterator<Item = (f64, f64)>, power: f64) -> PhotonMap {
    let one = |(x, z): (f64, f64)| {
        Photon::new(Vec3::new(x as f32, 0.0, z as f32), Vec3::Y, Vec3::Y, Rgb::splat(power as f32))
    };
    PhotonMap::build(places.map(one).collect(), &Cancel::new()).expect("nothing stops it")
}

/// Photons in the unit square that make an irradiance of 1.
const SQUARE: u32 = 20_000;

fn nearest(case: &mut Case) {
    let maps = case.count(32, 1024);
    let grid = |i: u32| Vec3::new((i % 8) as f32 / 8.0 + 0.0625, 0.0, (i / 8) as f32 / 8.0 + 0.0625);
    let queries: Vec<(String, MapQuery, Option<u32>)> = KERNELS
        .iter()
        .filter(|(name, ..)| !name.ends_with("1.1"))
        .flat_map(|&(name, desc, _)| {
            let kernel = Kernel::new(desc);
            let nearest =
                |k| (format!("{name}, {k} nearest"), MapQuery { kernel, radius: 10.0, neighbours: Some(k) }, Some(k));
            // As many as the radius holds on the average, so that either may be the limit.
            let limited = MapQuery { kernel, radius: 0.0282, neighbours: Some(50) };
            let fixed = MapQuery { kernel, radius: 0.05, neighbours: None };
            let mut all: Vec<_> = [10, 50, 200].map(nearest).into();
            all.push((format!("{name}, 50 nearest within the radius of 50"), limited, None));
            all.push((format!("{name}, fixed radius"), fixed, None));
            all
        })
        .collect();
    let mut values = vec![Vec::new(); queries.len()];
    for number in 0..maps {
        let mut rng = Rng::new(64, number);
        let places = (0..SQUARE).map(|_| {
            let [x, z] = rng.next_2d();
            (f64::from(x), f64::from(z))
        });
        let map = plane_map(places, 1.0 / f64::from(SQUARE));
        for (values, (_, query, _)) in values.iter_mut().zip(&queries) {
            // Disks that do not overlap, so that they are independent.
            values.extend((0..64).map(|i| asked(&map, grid(i), Vec3::Y, *query)));
        }
    }
    for (values, (name, _, k)) in values.iter().zip(&queries) {
        case.mean(name, stats::mean_and_error(values), 1.0, pick(case, 1e-2, 3e-3));
        if let Some(k) = k.filter(|_| name.starts_with("flat")) {
            // Of so many photons in the square, by the distribution of the k-th nearest one's area.
            let n = f64::from(SQUARE);
            let k = f64::from(k);
            let exact = (1.0 - 1.0 / n) * (k - 1.0) / (k - 2.0) - 1.0;
            let squares: Vec<f64> = values.iter().map(|value| (value - 1.0).powi(2)).collect();
            let what = format!("{name}: variance, 1 / (k - 2)");
            case.mean(what, stats::mean_and_error(&squares), exact, pick(case, 6e-2, 1e-2));
        }
    }
    // Along an edge a whole disk's area is half empty, in a corner three quarters: what the function says it does.
    let places = (0..1_u32 << 20).map(|i| (f64::from(i % 1024) + 0.5, f64::from(i / 1024) + 0.5));
    let lattice = plane_map(places.map(|(x, z)| (x / 1024.0, z / 1024.0)), (-20_f64).exp2());
    for (what, p, exact) in [
        ("in the middle", Vec3::new(0.5, 0.0, 0.5), 1.0),
        ("at an edge", Vec3::new(0.0, 0.0, 0.5), 0.5),
        ("in a corner", Vec3::ZERO, 0.25),
    ] {
        for (name, kernel, _) in KERNELS.into_iter().filter(|(name, ..)| !name.starts_with("cone, k 1.")) {
            let got = fixed(&lattice, p, Vec3::Y, kernel, 0.1);
            case.exact(format!("a lattice of photons {what}, {name}"), got, exact, Within::Relative(3e-3));
        }
    }
    // A photon of another side, or beside the disk's plane, does not count.
    let other = |normal: Vec3| fixed(&lattice, Vec3::new(0.5, 0.0, 0.5), normal, KernelDesc::Flat, 0.1);
    case.exact("from below", other(Vec3::NEG_Y), 0.0, Within::Absolute(0.0));
    let above = fixed(&lattice, Vec3::new(0.5, 0.05, 0.5), Vec3::Y, KernelDesc::Flat, 0.1);
    case.exact("half a radius above", above, 0.0, Within::Absolute(0.0));
}

/// Irradiance of a point light of intensity 1 at height 1, this far from the point below it.
fn under_point(r: f64) -> f64 {
    (1.0 + r * r).powf(-1.5)
}

fn bias(case: &mut Case) {
    // Photons of a point light at height 1 over the disk of radius 2 under it, along a spiral that turns by the golden section
    // from one to the next and is even in the cosine: hardly any noise, so that the bias shows.
    let count = case.count(1 << 21, 1 << 24) as u32;
    let least_cos = 1.0 / 5.0_f64.sqrt();
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let places = (0..count).map(|i| {
        let cos = 1.0 - (1.0 - least_cos) * (f64::from(i) + 0.5) / f64::from(count);
        let (sin, cos_phi) = (2.0 * PI * (f64::from(i) * golden).fract()).sin_cos();
        let r = (1.0 - cos * cos).sqrt() / cos;
        (r * cos_phi, r * sin)
    });
    let map = plane_map(places, 2.0 * PI * (1.0 - least_cos) / f64::from(count));
    // The flat disk under the light holds the light of a cone: known to every order.
    for radius in [0.1, 0.2, 0.3_f64] {
        let got = fixed(&map, Vec3::ZERO, Vec3::Y, KernelDesc::Flat, radius as f32);
        let exact = 2.0 * (1.0 - 1.0 / (1.0 + radius * radius).sqrt()) / (radius * radius);
        case.exact(format!("flat, under the light, radius {radius}"), got, exact, Within::Relative(2e-3));
    }
    // Elsewhere to the second order: the kernel's mean squared distance over 4, times the Laplacian.
    for (name, kernel, mean_square) in KERNELS {
        for (place, r) in [("under the light", 0.0_f64), ("1 aside", 1.0)] {
            let exact = under_point(r);
            // (1 + r²)^(-3/2): f'' + f' / r.
            let laplacian = 15.0 * r * r * (1.0 + r * r).powf(-3.5) - 6.0 * (1.0 + r * r).powf(-2.5);
            let mut points = Vec::new();
            let mut factors = [0.0; 4];
            for (place, radius) in [0.1, 0.14, 0.2, 0.2 * 2.0_f64.sqrt()].into_iter().enumerate() {
                // Around the circle of the same light.
                let around = 16;
                let mean = (0..around)
                    .map(|i| {
                        let (sin, cos) = (2.0 * PI * (f64::from(i) + 0.3) / f64::from(around)).sin_cos();
                        let p = Vec3::new((r * cos) as f32, 0.0, (r * sin) as f32);
                        fixed(&map, p, Vec3::Y, kernel, radius as f32) / f64::from(around)
                    })
                    .sum::<f64>();
                let found = mean - exact;
                factors[place] = found / (radius * radius * laplacian);
                points.push((radius, found.abs()));
            }
            let what = format!("{name}, {place}");
            let slope = stats::log_log_slope(&points);
            case.exact(format!("{what}: slope of log bias over log radius"), slope, 2.0, Within::Absolute(0.1));
            // Of two radii, the square of one twice that of the other, without the fourth order.
            let factor = 2.0 * factors[2] - factors[3];
            let within = Within::Relative(pick(case, 0.05, 0.03));
            case.exact(format!("{what}: bias over radius² and Laplacian"), factor, 0.25 * mean_square, within);
        }
    }
}

fn lamps(case: &mut Case) {
    // Direct photons of real lamps over a floor, at points of it, against the closed form.
    let floor = || (parallelogram(DVec3::new(-4.0, 0.0, 4.0), DVec3::X * 8.0, DVec3::Z * -8.0), grey(0.5), None);
    let triangle = [DVec3::new(-0.5, 2.0, -0.4), DVec3::new(0.8, 2.0, -0.3), DVec3::new(0.1, 2.0, 0.9)];
    let corners = triangle;
    let (centre, radius) = (DVec3::new(0.3, 2.0, 0.2), 0.5);
    let paths = case.count(1 << 16, 1 << 18) as u32;
    let points = [DVec3::ZERO, DVec3::X, DVec3::new(1.5, 0.0, -1.2)];
    for name in ["point light", "triangle", "sphere"] {
        let mut desc = unseen(vec![floor()]);
        match name {
            "point light" => desc.lights.push(point_light(DVec3::Y * 2.0, 1.0)),
            "triangle" => {
                crate::common::scenes::add(&mut desc, 1, ShapeDesc::Triangle(corners), BsdfDesc::Black, Some(Rgb::ONE))
            }
            _ => {
                let shape = ball(centre, radius);
                crate::common::scenes::add(&mut desc, 1, shape, BsdfDesc::Black, Some(Rgb::ONE));
            }
        }
        let scene = build(&desc);
        let exact = |p: DVec3| match name {
            "point light" => 0.25 * under_point(p.length() / 2.0),
            "triangle" => PI * polygon_factor(p, DVec3::Y, &triangle),
            _ => {
                let to = centre - p;
                PI * sphere_factor(radius / to.length(), (to.y / to.length()).acos())
            }
        };
        for p in points {
            let a = 0.15;
            // By differences; the bias of higher orders is a few hundredths of it.
            let d = 0.02;
            let laplacian =
                [DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z].map(|way| exact(p + d * way)).iter().sum::<f64>();
            let laplacian = (laplacian - 4.0 * exact(p)) / (d * d);
            let found = runs(|seed| {
                let map = map(shot(&scene, &seeded(seed), MapKind::Direct, paths));
                fixed(&map, scene.to_scene(p), Vec3::Y, KernelDesc::Flat, a as f32)
            });
            let second_order = exact(p) + a * a * laplacian / 8.0;
            let what = format!("{name}, ({}, {})", p.x, p.z);
            case.biased_mean(what, found, second_order, (1e-4, pick(case, 3e-2, 2e-2)));
        }
    }
    // A million photons and the 200 nearest: everywhere within one percent in the mean.
    let mut desc = unseen(vec![floor()]);
    desc.lights.push(point_light(DVec3::Y * 2.0, 1.0));
    let scene = build(&desc);
    let map = map(shot(&scene, &seeded(1), MapKind::Direct, 1 << 21));
    let query = MapQuery { kernel: Kernel::new(KernelDesc::Flat), radius: 1.0, neighbours: Some(200) };
    let ratios: Vec<f64> = (0..64)
        .map(|i| {
            let p = DVec3::new(f64::from(i % 8) / 3.5 - 1.0, 0.0, f64::from(i / 8) / 3.5 - 1.0);
            asked(&map, scene.to_scene(p), Vec3::Y, query) / (0.25 * under_point(p.length() / 2.0))
        })
        .collect();
    case.biased_mean("200 nearest of a million", stats::mean_and_error(&ratios), 1.0, (2e-3, 1e-2));
}
