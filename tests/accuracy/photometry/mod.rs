//! Lighting calculations against closed forms and quadrature: geometries after CIE 171:2006, section 5.
//!
//! Every expected value is computed here; none is taken from the report, some of whose tables are wrong (Ashdown's errata). The
//! world has z up, one unit is a metre, and materials are black where they do not have to reflect.

mod interiors;
mod openings;
mod units;

use std::f64::consts::PI;
use std::ops::ControlFlow;

use etendue::desc::{BsdfDesc, GridDesc, GridPoints, IntegratorDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::lighting::{Calculation, Measured};
use etendue::math::DVec3;
use etendue::render::RenderSettings;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use crate::common::scenes::{camera, scene};
use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [interiors::cases(), openings::cases(), units::cases()].into_iter().flatten().collect()
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// A scene of shapes with their materials and emitted radiance.
fn of(surfaces: Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)>) -> SceneDesc {
    scene(camera(DVec3::new(0.1, 0.2, 50.0), DVec3::ZERO, 1.0), surfaces)
}

fn point([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

fn quad(corners: [[f64; 3]; 4]) -> ShapeDesc {
    ShapeDesc::Quad(corners.map(point))
}

/// A horizontal rectangle that faces upwards, or downwards.
fn level(x: [f64; 2], y: [f64; 2], z: f64, upwards: bool) -> ShapeDesc {
    let corners = [[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]];
    let [a, b, c, d] = corners;
    quad(if upwards { corners } else { [a, d, c, b] })
}

/// Light of this many lumens, candela, lux or candela per square metre, in white channels.
fn white(luminous: f64) -> Rgb {
    Rgb::splat((luminous / 683.0) as f32)
}

fn settings(samples: u32, integrator: IntegratorDesc) -> RenderSettings {
    RenderSettings {
        desc: RenderDesc { samples, integrator, ..RenderDesc::default() },
        threads: 2,
        ..RenderSettings::default()
    }
}

/// How many calculations of different seeds a value is the mean of: eight replicates alone give standard errors that are too small
/// by a half once in twenty times, and four times as many hardly ever do.
const SEEDS: u64 = 4;

/// What is measured with these settings, whose samples are those of all seeds together.
fn run(scene: &Scene, points: GridPoints, settings: RenderSettings) -> Measured {
    let grid = GridDesc { name: "points".to_owned(), points };
    let mut mean = Measured::default();
    for seed in 1..=SEEDS {
        let samples = settings.desc.samples.div_ceil(SEEDS as u32);
        let desc = RenderDesc { samples, seed, ..settings.desc.clone() };
        let settings = RenderSettings { desc, ..settings.clone() };
        let mut calculation = Calculation::new(scene, &grid, settings).expect("a grid of the test");
        calculation.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
        let Measured { values, standard_errors } = calculation.measured();
        mean.values.resize(values.len(), 0.0);
        mean.standard_errors.resize(values.len(), 0.0);
        mean.values.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / SEEDS as f64);
        mean.standard_errors
            .iter_mut()
            .zip(standard_errors)
            .for_each(|(sum, error)| *sum = sum.hypot(error / SEEDS as f64));
    }
    mean
}

/// Illuminance at points with normals.
fn illuminance(scene: &Scene, places: &[(DVec3, DVec3)], samples: u32, integrator: IntegratorDesc) -> Measured {
    let (points, normals) = places.iter().copied().unzip();
    run(scene, GridPoints::Points { points, normals }, settings(samples, integrator))
}

/// A value with its standard error.
fn value(measured: &Measured, number: usize) -> (f64, f64) {
    (measured.values[number], measured.standard_errors[number])
}

/// Points and weights of the Gauss-Legendre rule on [0, 1]: roots of the Legendre polynomial, by Newton's method.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for k in 2..=count {
            let k = k as f64;
            (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
        }
        let slope = count as f64 * (x * here - before) / (x * x - 1.0);
        (here, slope)
    };
    let rule = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
        for _ in 0..50 {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let (_, slope) = legendre(x);
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(rule).collect()
}

/// The inner sides of a box: points and normals, each with its share of the area of the side.
fn walls(min: DVec3, max: DVec3, count: usize) -> Vec<([DVec3; 2], f64)> {
    let (rule, mut all) = (gauss(count), Vec::new());
    for axis in 0..3 {
        let [s, t] = [(axis + 1) % 3, (axis + 2) % 3];
        let size = max - min;
        for (side, inwards) in [(min[axis], 1.0), (max[axis], -1.0)] {
            for &(u, weight_u) in &rule {
                for &(v, weight_v) in &rule {
                    let (mut p, mut n) = (DVec3::ZERO, DVec3::ZERO);
                    (p[axis], p[s], p[t]) = (side, min[s] + u * size[s], min[t] + v * size[t]);
                    n[axis] = inwards;
                    all.push(([p, n], weight_u * weight_v * size[s] * size[t]));
                }
            }
        }
    }
    all
}
