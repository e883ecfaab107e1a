//! Whether the errors that are reported are the errors that there are, and whether those of neighbours are independent.

use std::f64::consts::FRAC_PI_4;

use etendue::desc::{BsdfDesc, FilterDesc, MeshDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc};
use etendue::film::{Image, REPLICATES};
use etendue::math::DVec3;
use etendue::sampling::SobolSampler;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::numbers;
use crate::common::scenes::{box_inside, camera, render_scene, scene};
use crate::record::{Case, Entry, Within};
use crate::stats::{chi_square, mean_and_error};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "P51d", title: "Errors of replicates", run: replicates },
        Entry { id: "P51e", title: "Errors of pixels", run: pixels },
        Entry { id: "P51f", title: "Errors of neighbours", run: neighbours },
    ]
}

/// Writes the row about deviations in units of their estimated errors: how many of them are inside the interval that holds
/// 95 % of Student's t. `slack`: by how much the share may be off, since means of few samples are no normal numbers.
fn covered(case: &mut Case, what: &str, t: &[f64], freedom: f64, slack: f64) {
    let limit = student(freedom).inverse_cdf(0.975);
    let covered = t.iter().filter(|t| t.abs() <= limit).count() as f64 / t.len() as f64;
    case.exact(format!("{what}: inside the interval of 95 %"), covered, 0.95, Within::Absolute(slack));
}

/// The same for their whole distribution.
fn distributed(case: &mut Case, what: &str, t: &[f64], freedom: f64) {
    const BINS: usize = 20;
    let mut counts = [0_u64; BINS];
    for t in t {
        counts[((student(freedom).cdf(*t) * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let p = chi_square(&counts, &[t.len() as f64 / BINS as f64; BINS]);
    case.p_value(format!("{what}: counts in 20 bins of t"), p, 4);
}

fn student(freedom: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, freedom).expect("degrees of freedom above 0")
}

fn replicates(case: &mut Case) {
    const REPLICATES: u32 = 16;
    const SIZE: u32 = 32;
    // Integral of exp(-x^2) over [0, 1].
    const GAUSS: f64 = 0.746_824_132_812_427;
    let count = case.count(2000, 50_000) as u32;
    type Integrand = fn(&[f32; 6]) -> f64;
    let integrands: [(&str, Integrand, f64); 3] = [
        ("disc", |x| f64::from(u8::from(x[0].hypot(x[3]) < 1.0)), FRAC_PI_4),
        ("exp(-x²) over the pixel", |x| (-f64::from(x[0]).powi(2) - f64::from(x[1]).powi(2)).exp(), GAUSS.powi(2)),
        ("exp(-x²) across sets", |x| (-f64::from(x[1]).powi(2) - f64::from(x[5]).powi(2)).exp(), GAUSS.powi(2)),
    ];
    for (number, (name, f, exact)) in integrands.into_iter().enumerate() {
        let mut sampler = SobolSampler::new(7, SIZE);
        let (mut means, mut t) = (Vec::new(), Vec::new());
        for pixel in 0..count {
            let replicates: Vec<f64> = (0..REPLICATES)
                .map(|r| {
                    let samples = r * SIZE..(r + 1) * SIZE;
                    samples.map(|sample| f(&numbers(&mut sampler, pixel, sample))).sum::<f64>() / f64::from(SIZE)
                })
                .collect();
            let (mean, error) = mean_and_error(&replicates);
            means.push(mean);
            t.push((mean - exact) / error);
        }
        case.mean(format!("{name}: mean"), mean_and_error(&means), exact, 1e-3);
        covered(case, name, &t, f64::from(REPLICATES - 1), 0.015);
        // What counts whole samples has few different means, and that of few dimensions of many is a little skewed.
        if number == 1 {
            distributed(case, name, &t, f64::from(REPLICATES - 1));
        }
    }
}

/// A closed grey box with a lamp under its ceiling, seen so that the lamp is out of sight.
fn room() -> Scene {
    let grey = |albedo| BsdfDesc::Lambert { albedo: Rgb::splat(albedo) };
    let mut desc: SceneDesc = scene(
        camera(DVec3::new(0.0, -0.2, 0.9), DVec3::new(0.0, -0.6, -1.0), 50.0),
        vec![
            (ShapeDesc::Mesh { mesh: 0, smooth: false }, grey(0.6), None),
            (ShapeDesc::Mesh { mesh: 1, smooth: false }, grey(0.0), Some(Rgb::splat(4.0))),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    let positions = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 0.9, z)).to_vec();
    let lamp = MeshDesc {
        name: "lamp".into(),
        path: "meshes[1]".into(),
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshDesc::default()
    };
    desc.meshes.push(lamp.into());
    Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test")
}

/// Renders that differ in the seed.
fn renders(scene: &Scene, desc: &RenderDesc, seeds: u64) -> Vec<Image> {
    (0..seeds).map(|seed| render_scene(scene, RenderDesc { seed, ..desc.clone() }).0).collect()
}

fn pixels(case: &mut Case) {
    let scene = room();
    let seeds = case.count(60, 800);
    for (name, sampler, filter) in [
        ("Sobol', box", SamplerDesc::Sobol, FilterDesc::Box),
        ("Sobol', Blackman-Harris", SamplerDesc::Sobol, FilterDesc::BlackmanHarris),
        ("random, box", SamplerDesc::Random, FilterDesc::Box),
    ] {
        let desc = RenderDesc { resolution: [8, 8], samples: 64, sampler, filter, ..RenderDesc::default() };
        let images = renders(&scene, &desc, seeds);
        let n = seeds as f64;
        let mut t = Vec::new();
        // The exact values are not known, but the mean of the other renders is close to them.
        let mut whole = Vec::new();
        for pixel in 0..64 {
            let value = |image: &Image| f64::from(image.rgb[3 * pixel]);
            let sum: f64 = images.iter().map(value).sum();
            for image in &images {
                let variance = f64::from(image.layer("variance").expect("always there").data[3 * pixel]);
                let others = (sum - value(image)) / (n - 1.0);
                t.push((value(image) - others) / (variance * n / (n - 1.0)).sqrt());
            }
        }
        let total: f64 = images.iter().map(|image| image.mean()[0]).sum();
        for image in &images {
            let (mean, error) = crate::common::scenes::mean_and_error(image);
            let others = (total - image.mean()[0]) / (n - 1.0);
            whole.push((mean - others) / (error * (n / (n - 1.0)).sqrt()));
        }
        covered(case, &format!("{name}, pixels"), &t, REPLICATES as f64 - 1.0, 0.015);
        // The variance of a mean over 64 pixels has so many degrees of freedom that t is nearly normal.
        distributed(case, &format!("{name}, image"), &whole, 350.0);
    }
}

fn neighbours(case: &mut Case) {
    let scene = room();
    let seeds = case.count(32, 400);
    for (name, sampler, filter) in [
        ("Sobol', box", SamplerDesc::Sobol, FilterDesc::Box),
        ("Sobol', Blackman-Harris", SamplerDesc::Sobol, FilterDesc::BlackmanHarris),
        ("random, tent", SamplerDesc::Random, FilterDesc::Tent),
        ("jittered, Mitchell", SamplerDesc::Jittered, FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
    ] {
        let desc = RenderDesc { resolution: [40, 36], samples: 4, sampler, filter, ..RenderDesc::default() };
        let images = renders(&scene, &desc, seeds);
        let n = seeds as f64;
        // What each pixel is off its mean over the seeds, in units of its own deviation.
        let pixels = images[0].rgb.len() / 3;
        let mut off = vec![vec![0.0; pixels]; images.len()];
        for pixel in 0..pixels {
            let values: Vec<f64> = images.iter().map(|image| f64::from(image.rgb[3 * pixel])).collect();
            let (mean, error) = mean_and_error(&values);
            for (off, value) in off.iter_mut().zip(values) {
                off[pixel] = (value - mean) / (error * n.sqrt());
            }
        }
        let [width, height] = desc.resolution.map(|n| n as usize);
        for (direction, dx, dy) in [("right", 1, 0), ("below", 0, 1), ("below and right", 1, 1)] {
            let (mut sum, mut pairs) = (0.0, 0.0);
            for off in &off {
                for y in 0..height - dy {
                    for x in 0..width - dx {
                        sum += off[y * width + x] * off[(y + dy) * width + x + dx];
                        pairs += 1.0;
                    }
                }
            }
            let correlation: f64 = sum / pairs;
            case.at_most(format!("{name}: {direction}, 1/√N"), correlation.abs() * pairs.sqrt(), 4.0);
        }
        // Runs whose seeds follow one another.
        let (mut sum, mut pairs) = (0.0, 0.0);
        for pair in off.windows(2) {
            sum += pair[0].iter().zip(&pair[1]).map(|(a, b)| a * b).sum::<f64>();
            pairs += pixels as f64;
        }
        // Around a mean over n seeds two of them have a correlation of -1/(n - 1).
        let correlation = sum / pairs + 1.0 / (n - 1.0);
        case.at_most(format!("{name}: next seed, 1/√N"), correlation.abs() * pairs.sqrt(), 4.0);
    }
}
