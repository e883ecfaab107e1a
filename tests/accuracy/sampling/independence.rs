//! Samples of different pixels and runs know nothing of each other; and errors fall as fast as the points' evenness
//! promises.

use std::f64::consts::FRAC_PI_4;

use etendue::sampling::{Pattern, PatternSampler, Sampler, SobolSampler};
use statrs::distribution::{ContinuousCDF, Normal};

use super::numbers;
use crate::record::{Case, Entry, Within};
use crate::stats::{chi_square, log_log_slope};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "P51", title: "Uniform in all pairs", run: uniform },
        Entry { id: "P51b", title: "Pixels and runs uncorrelated", run: uncorrelated },
        Entry { id: "P51c", title: "Speed of convergence", run: convergence },
    ]
}

/// The position and four sets.
const DIMENSIONS: usize = 18;

type Point = [f32; DIMENSIONS];

/// Worst p-values of 16 x 16 counts over the pairs of the first 16 dimensions, for too uneven and for too even ones, and how
/// many of either there are.
fn pairs(points: &[Point], counted: impl Fn(usize, usize) -> bool) -> (f64, f64, usize) {
    let (mut uneven, mut even, mut tests) = (1.0_f64, 1.0_f64, 0);
    for d in 0..16 {
        for e in (0..d).filter(|&e| counted(d, e)) {
            let mut counts = [0_u64; 256];
            for point in points {
                counts[(point[d] * 16.0) as usize * 16 + (point[e] * 16.0) as usize] += 1;
            }
            let p = chi_square(&counts, &[points.len() as f64 / 256.0; 256]);
            (uneven, even, tests) = (uneven.min(p), even.min(1.0 - p), tests + 1);
        }
    }
    (uneven, even, tests)
}

fn uniform(case: &mut Case) {
    // One sample of each pixel, seed or replicate: points of one net would be too even, and these must not be.
    let n = case.count(20_000, 1_000_000) as u32;
    let mut sobol = SobolSampler::new(51, 64);
    let mut random = PatternSampler::new(Pattern::Random, 51, 64);
    let mut jittered = PatternSampler::new(Pattern::Jittered, 51, 64);
    let sets: [(&str, Vec<Point>); 5] = [
        ("Sobol', one sample of each pixel", (0..n).map(|i| numbers(&mut sobol, i, 11)).collect()),
        ("Sobol', one sample of each replicate", (0..n).map(|i| numbers(&mut sobol, 5, 64 * i + 7)).collect()),
        ("Sobol', one sample of each seed", {
            (0..n).map(|i| numbers(&mut SobolSampler::new(u64::from(i), 64), 3, 2)).collect()
        }),
        ("random, all samples of a pixel", (0..n).map(|i| numbers(&mut random, 5, i)).collect()),
        ("jittered, one sample of each pixel", (0..n).map(|i| numbers(&mut jittered, i, 11)).collect()),
    ];
    for (name, points) in &sets {
        let (uneven, even, tests) = pairs(points, |_, _| true);
        case.p_value(format!("{name}: 120 pairs, too uneven"), uneven, 2 * sets.len() * tests);
        case.p_value(format!("{name}: too even"), even, 2 * sets.len() * tests);
    }
    let ones = sets.iter().flat_map(|(_, points)| points).flatten().filter(|x| !(0.0..1.0).contains(*x)).count();
    case.never("numbers outside [0, 1)", ones as u64, 5 * u64::from(n) * DIMENSIONS as u64);
    // Means to many digits: a number in [0, 1) that is a multiple of 2^-24 has a mean of 1/2 - 2^-25.
    let worst = sets.iter().flat_map(|(_, points)| (0..DIMENSIONS).map(|d| mean_off(points, d))).fold(0.0, f64::max);
    case.at_most("largest of 90 means, off 1/2, in standard errors", worst, 4.0);
}

/// Standard errors between a dimension's mean and 1/2.
fn mean_off(points: &[Point], d: usize) -> f64 {
    let n = points.len() as f64;
    let mean = points.iter().map(|point| f64::from(point[d])).sum::<f64>() / n;
    (mean - 0.5).abs() * (12.0 * n).sqrt()
}

/// Correlation coefficient of two dimensions.
fn correlation(points: &[(Point, Point)], d: usize, e: usize) -> f64 {
    let mut sums = [0.0; 3];
    for (p, q) in points {
        let (a, b) = (f64::from(p[d]) - 0.5, f64::from(q[e]) - 0.5);
        sums = [sums[0] + a * b, sums[1] + a * a, sums[2] + b * b];
    }
    sums[0] / (sums[1] * sums[2]).sqrt()
}

/// Pairs of pixels and runs that are compared.
const ROWS: usize = 11;

fn uncorrelated(case: &mut Case) {
    let n = case.count(10_000, 200_000) as u32;
    let make = |seed: u64| SobolSampler::new(seed, 16);
    let mut sobol = make(52);
    // Two samples that have no business with each other, for each i.
    let mut row = |name: &str, pair: &mut dyn FnMut(u32) -> (Point, Point)| {
        let points: Vec<(Point, Point)> = (0..n).map(pair).collect();
        let root = f64::from(n).sqrt();
        let (mut same, mut worst) = (0.0_f64, 0.0_f64);
        for d in 0..DIMENSIONS {
            same = same.max(correlation(&points, d, d).abs() * root);
            for e in 0..DIMENSIONS {
                worst = worst.max(correlation(&points, d, e).abs() * root);
            }
        }
        case.at_most(format!("{name}: largest correlation, 1/√N"), same, 4.0);
        let p = 2.0 * Normal::standard().sf(worst);
        case.p_value(format!("{name}: 324 correlations"), p, ROWS * DIMENSIONS * DIMENSIONS);
        // Dependence that is no correlation: the joint counts of a number here and the same one there.
        let mut least = 1.0_f64;
        for d in 0..DIMENSIONS {
            let mut counts = [0_u64; 256];
            for (p, q) in &points {
                counts[(p[d] * 16.0) as usize * 16 + (q[d] * 16.0) as usize] += 1;
            }
            least = least.min(chi_square(&counts, &[f64::from(n) / 256.0; 256]));
        }
        case.p_value(format!("{name}: joint counts of 18 numbers"), least, ROWS * DIMENSIONS);
    };
    // In an image of 1000 pixels a row.
    let mut neighbours = |name: &str, step: u32| {
        row(name, &mut |i| {
            (
                numbers(&mut sobol, 2 * step * (i / step) + i % step, 5),
                numbers(&mut sobol, 2 * step * (i / step) + i % step + step, 5),
            )
        });
    };
    neighbours("Sobol', next pixel", 1);
    neighbours("Sobol', pixel below", 1000);
    neighbours("Sobol', pixel below and left", 999);
    neighbours("Sobol', pixel 2^16 on", 1 << 16);
    row("Sobol', next replicate", &mut |i| (numbers(&mut sobol, i, 3), numbers(&mut sobol, i, 19)));
    row("Sobol', next seed", &mut |i| (numbers(&mut make(0), i, 3), numbers(&mut make(1), i, 3)));
    row("Sobol', seed 2^32 on", &mut |i| {
        (numbers(&mut make(u64::from(i)), 9, 3), numbers(&mut make(u64::from(i) + (1 << 32)), 9, 3))
    });
    row("Sobol', next seed, pixel before", &mut |i| (numbers(&mut make(8), i + 1, 3), numbers(&mut make(9), i, 3)));
    let pattern = |seed| PatternSampler::new(Pattern::Random, seed, 16);
    row("random, next pixel", &mut |i| (numbers(&mut pattern(1), 2 * i, 3), numbers(&mut pattern(1), 2 * i + 1, 3)));
    row("random, next sample", &mut |i| (numbers(&mut pattern(1), 4, 2 * i), numbers(&mut pattern(1), 4, 2 * i + 1)));
    row("random, next seed", &mut |i| (numbers(&mut pattern(0), i, 3), numbers(&mut pattern(1), i, 3)));
}

/// Relative RMSE of the mean of `f` over the first `n` samples of a number of pixels.
fn rmse(sampler: &mut impl Sampler, n: u32, pixels: u32, exact: f64, f: &dyn Fn(&Point) -> f64) -> f64 {
    let squared = (0..pixels).map(|pixel| {
        let sum: f64 = (0..n).map(|sample| f(&numbers(sampler, pixel, sample))).sum();
        (sum / f64::from(n) / exact - 1.0).powi(2)
    });
    (squared.sum::<f64>() / f64::from(pixels)).sqrt()
}

fn convergence(case: &mut Case) {
    // Integral of exp(-x^2) over [0, 1].
    const GAUSS: f64 = 0.746_824_132_812_427;
    let gauss = |d: &'static [usize]| move |x: &Point| (-d.iter().map(|&i| f64::from(x[i]).powi(2)).sum::<f64>()).exp();
    let disc = |d: usize, e: usize| move |x: &Point| f64::from(u8::from(x[d].hypot(x[e]) < 1.0));
    // A step whose area is 0.45.
    let step = |d: usize, e: usize| move |x: &Point| f64::from(u8::from(x[d] + 0.5 * x[e] < 0.7));
    type Integrand = Box<dyn Fn(&Point) -> f64>;
    // The position is dimensions 0 and 1, the sets follow. What is wanted are slopes of -0.7 for the smooth function and -0.5
    // for the others; what these points give is more.
    let integrands: [(&str, Integrand, f64, f64); 7] = [
        ("exp(-x²) over the pixel", Box::new(gauss(&[0, 1])), GAUSS.powi(2), -1.2),
        ("exp(-x²) in one set", Box::new(gauss(&[2, 3, 4, 5])), GAUSS.powi(4), -0.9),
        ("exp(-x²) across sets", Box::new(gauss(&[0, 4, 9, 12])), GAUSS.powi(4), -0.8),
        ("sum of 14 dimensions", Box::new(|x| x[..14].iter().map(|&v| f64::from(v)).sum()), 7.0, -1.3),
        ("disc in the pixel", Box::new(disc(0, 1)), FRAC_PI_4, -0.65),
        ("disc across sets", Box::new(disc(1, 6)), FRAC_PI_4, -0.6),
        ("step across the pixel", Box::new(step(0, 1)), 0.45, -0.6),
    ];
    let pixels = case.count(96, 1000) as u32;
    let sizes = [16, 64, 256, 1024];
    for (name, f, exact, greatest) in &integrands {
        let slope = |errors: &[f64; 4]| {
            log_log_slope(&sizes.iter().zip(errors).map(|(&n, &error)| (f64::from(n), error)).collect::<Vec<_>>())
        };
        let sobol = sizes.map(|n| rmse(&mut SobolSampler::new(6, u32::MAX), n, pixels, *exact, f));
        case.at_most(format!("Sobol', {name}: slope"), slope(&sobol), *greatest);
        let random = sizes.map(|n| rmse(&mut PatternSampler::new(Pattern::Random, 6, n), n, pixels, *exact, f));
        case.exact(format!("random, {name}: slope"), slope(&random), -0.5, Within::Absolute(0.06));
        case.at_most(format!("{name}: error of Sobol' over random, 1024"), sobol[3] / random[3], 0.5);
    }
    // Cells of area 1/N: the error of a smooth function falls as 1/N, that of an edge as N^(-3/4).
    for (number, name, wanted) in [(0, "exp(-x²) over the pixel", -1.0), (4, "disc in the pixel", -0.75)] {
        let (_, f, exact, _) = &integrands[number];
        let points = sizes
            .map(|n| (f64::from(n), rmse(&mut PatternSampler::new(Pattern::Jittered, 6, n), n, pixels, *exact, f)));
        case.exact(format!("jittered, {name}: slope"), log_log_slope(&points), wanted, Within::Absolute(0.06));
    }
}
