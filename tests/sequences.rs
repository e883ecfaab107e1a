//! Samplers: ranges, stratification, independence, convergence, determinism.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod stats;
}

use std::collections::HashSet;

use common::stats::{SIGNIFICANCE, chi_square, log_log_slope, mean_and_error, sidak, z_test};
use etendue::sampling::{Pattern, PatternSampler, Sampler, SobolSampler};

const PATTERNS: [Pattern; 4] = [Pattern::Random, Pattern::Jittered, Pattern::Grid, Pattern::Gaussian];

/// The numbers of one sample: position, then sets of four, then a pair.
fn numbers(sampler: &mut impl Sampler, pixel: u32, sample: u32, sets: usize) -> Vec<f32> {
    sampler.start(pixel, sample);
    let mut numbers = sampler.pixel_2d().to_vec();
    for _ in 0..sets {
        numbers.extend(sampler.next_4d());
    }
    numbers.extend(sampler.next_2d());
    numbers
}

/// The state is a function of (seed, pixel, sample) alone.
fn assert_deterministic(mut sampler: impl Sampler + Clone) {
    let mut other = sampler.clone();
    let order: Vec<(u32, u32)> = (0..20).flat_map(|pixel| (0..50).map(move |sample| (pixel, sample))).collect();
    let forwards: Vec<_> = order.iter().map(|&(p, s)| numbers(&mut sampler, p, s, 8)).collect();
    let mut backwards: Vec<_> = order.iter().rev().map(|&(p, s)| numbers(&mut other, p, s, 8)).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    assert_eq!(numbers(&mut sampler, 3, 7, 8), numbers(&mut sampler, 3, 7, 8));
    // The position is apart from the rest, asked for or not, once or twice.
    sampler.start(3, 7);
    let first = sampler.next_4d();
    let position = sampler.pixel_2d();
    assert_eq!(
        (position, sampler.next_4d()),
        (sampler.pixel_2d(), {
            let all = numbers(&mut other, 3, 7, 8);
            assert_eq!(first, all[2..6]);
            [all[6], all[7], all[8], all[9]]
        })
    );
    let distinct: HashSet<Vec<u32>> = forwards.iter().map(|n| n.iter().map(|x| x.to_bits()).collect()).collect();
    assert_eq!(distinct.len(), order.len(), "no sample repeats another");
}

#[test]
fn samples_are_a_function_of_seed_pixel_and_index() {
    assert_deterministic(SobolSampler::new(1, 16));
    assert_deterministic(SobolSampler::new(1, u32::MAX));
    for pattern in PATTERNS {
        assert_deterministic(PatternSampler::new(pattern, 1, 64));
    }
    let (mut a, mut b) = (SobolSampler::new(1, 16), SobolSampler::new(2, 16));
    assert_ne!(numbers(&mut a, 0, 0, 2), numbers(&mut b, 0, 0, 2));
}

#[test]
fn numbers_are_in_range_everywhere() {
    let check = |sampler: &mut dyn FnMut(u32, u32) -> Vec<f32>, skip: usize| {
        for pixel in [0, 1, 65_537, u32::MAX] {
            for sample in (0..2000).chain([65_535, 65_536, 1 << 24, u32::MAX]) {
                assert!(sampler(pixel, sample)[skip..].iter().all(|x| (0.0..1.0).contains(x)), "{pixel} {sample}");
            }
        }
    };
    for size in [0, 1, 7, 64, 1 << 20, u32::MAX] {
        let mut sampler = SobolSampler::new(u64::MAX, size);
        check(&mut |pixel, sample| numbers(&mut sampler, pixel, sample, 80), 0);
    }
    for pattern in PATTERNS {
        for samples in [0, 1, 5, 64, u32::MAX] {
            let mut sampler = PatternSampler::new(pattern, 0, samples);
            let skip = if pattern == Pattern::Gaussian { 2 } else { 0 };
            check(&mut |pixel, sample| numbers(&mut sampler, pixel, sample, 20), skip);
        }
    }
}

/// Whether each of the 2^k elementary intervals of every shape holds exactly one point.
fn is_net(points: &[[f32; 2]]) -> bool {
    let k = points.len().trailing_zeros();
    (0..=k).all(|split| {
        let (nx, ny) = (1_usize << split, 1_usize << (k - split));
        let mut seen = vec![false; nx * ny];
        points.iter().all(|p| {
            let cell = (p[0] * nx as f32) as usize * ny + (p[1] * ny as f32) as usize;
            !std::mem::replace(&mut seen[cell], true)
        })
    })
}

#[test]
fn positions_in_the_pixel_are_nets() {
    for seed in 0..10 {
        for pixel in [0, 1, 77, 1_000_003] {
            let mut sampler = SobolSampler::new(seed, u32::MAX);
            for k in 2..=10 {
                // Any aligned block, also past 2^16 points.
                for block in [0, 1, 5, 1 << 10, 1 << 17] {
                    let n = 1 << k;
                    let points: Vec<_> = (block * n..(block + 1) * n)
                        .map(|sample| {
                            sampler.start(pixel, sample);
                            sampler.pixel_2d()
                        })
                        .collect();
                    assert!(is_net(&points), "seed {seed}, pixel {pixel}, {n} points of block {block}");
                }
            }
        }
    }
    // Random points are none.
    let mut random = PatternSampler::new(Pattern::Random, 0, 1);
    let points: Vec<_> = (0..64)
        .map(|i| {
            random.start(0, i);
            random.pixel_2d()
        })
        .collect();
    assert!(!is_net(&points));
}

#[test]
fn every_dimension_is_stratified() {
    for size in [16, 256, 1024] {
        let mut sampler = SobolSampler::new(3, size);
        for replicate in 0..3 {
            let points: Vec<_> = (0..size).map(|i| numbers(&mut sampler, 9, replicate * size + i, 100)).collect();
            for d in 0..points[0].len() {
                let mut seen = vec![false; size as usize];
                for point in &points {
                    let cell = (point[d] * size as f32) as usize;
                    assert!(!std::mem::replace(&mut seen[cell], true), "dimension {d}, {size} points");
                }
            }
        }
    }
}

/// Correlation coefficient.
fn correlation(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
    let pairs: Vec<(f64, f64)> = pairs.map(|(a, b)| (f64::from(a) - 0.5, f64::from(b) - 0.5)).collect();
    let sums = pairs.iter().fold((0.0, 0.0, 0.0), |(ab, aa, bb), (a, b)| (ab + a * b, aa + a * a, bb + b * b));
    sums.0 / (sums.1 * sums.2).sqrt()
}

#[test]
fn pixels_and_replicates_are_uncorrelated() {
    const N: usize = 20_000;
    let mut sobol = SobolSampler::new(4, 16);
    let mut random = PatternSampler::new(Pattern::Random, 4, 16);
    let dimensions = 18;
    // Same sample of neighbouring pixels in a row and across rows, and successive replicates of a pixel.
    type Neighbour = fn(u32) -> ((u32, u32), (u32, u32));
    let neighbours: [Neighbour; 3] =
        [|i| ((2 * i, 5), (2 * i + 1, 5)), |i| ((i, 0), (i + 1_000_000, 0)), |i| ((i, 3), (i, 19))];
    for neighbour in neighbours {
        let pairs: Vec<_> = (0..N as u32)
            .map(|i| {
                let ((p, s), (q, t)) = neighbour(i);
                (numbers(&mut sobol, p, s, 4), numbers(&mut sobol, q, t, 4))
            })
            .collect();
        for d in 0..dimensions {
            for e in 0..dimensions {
                let c = correlation(pairs.iter().map(|(a, b)| (a[d], b[e])));
                // 972 coefficients: five standard errors.
                assert!(c.abs() < 5.0 / (N as f64).sqrt(), "dimensions {d}, {e}: {c}");
            }
        }
    }
    let samples: Vec<_> = (0..N as u32).map(|i| numbers(&mut random, 7, i, 4)).collect();
    for d in 0..dimensions {
        let c = correlation(samples.windows(2).map(|w| (w[0][d], w[1][(d + 1) % dimensions])));
        assert!(c.abs() < 5.0 / (N as f64).sqrt(), "dimension {d}: {c}");
    }
}

#[test]
fn single_points_fill_the_square_over_pixels() {
    // One sample of each of many pixels is an independent uniform point, in every pair of dimensions.
    const N: u32 = 100_000;
    let mut sobol = SobolSampler::new(5, 64);
    let mut random = PatternSampler::new(Pattern::Random, 5, 64);
    let first = |name: &str, sampler: &mut dyn FnMut(u32) -> Vec<f32>| {
        let points: Vec<_> = (0..N).map(sampler).collect();
        for d in 0..16 {
            for e in 0..d {
                let mut counts = vec![0_u64; 256];
                for point in &points {
                    counts[(point[d] * 16.0) as usize * 16 + (point[e] * 16.0) as usize] += 1;
                }
                let p = chi_square(&counts, &[f64::from(N) / 256.0; 256]);
                // Too even would be as wrong as too uneven.
                let significance = sidak(SIGNIFICANCE, 2 * 2 * 120);
                assert!(p > significance && p < 1.0 - significance, "{name}, dimensions {d}, {e}: p = {p}");
            }
        }
    };
    first("Sobol'", &mut |pixel| numbers(&mut sobol, pixel, 11, 4));
    first("random", &mut |pixel| numbers(&mut random, pixel, 11, 4));
}

/// Relative RMSE of the mean of `f` over the first `n` samples of many pixels.
fn rmse(sampler: &mut impl Sampler, n: u32, exact: f64, f: impl Fn(&[f32]) -> f64) -> f64 {
    const PIXELS: u32 = 128;
    let squared = (0..PIXELS).map(|pixel| {
        let sum: f64 = (0..n).map(|sample| f(&numbers(sampler, pixel, sample, 3))).sum();
        (sum / f64::from(n) / exact - 1.0).powi(2)
    });
    (squared.sum::<f64>() / f64::from(PIXELS)).sqrt()
}

#[test]
fn errors_fall_as_fast_as_they_should() {
    // Integral of exp(-x^2) over [0, 1].
    const GAUSS: f64 = 0.746_824_132_812_427;
    let gauss = |d: &'static [usize]| move |x: &[f32]| (-d.iter().map(|&i| f64::from(x[i]).powi(2)).sum::<f64>()).exp();
    let disc = |x: f32, y: f32| f64::from(u8::from(x.hypot(y) < 1.0));
    type Integrand = Box<dyn Fn(&[f32]) -> f64>;
    // The position is dimensions 0 and 1, the sets follow. Greatest slope for Sobol' points.
    let integrands: [(&str, Integrand, f64, f64); 7] = [
        ("Gaussian over the pixel", Box::new(gauss(&[0, 1])), GAUSS.powi(2), -1.2),
        ("Gaussian in one set", Box::new(gauss(&[2, 3, 4, 5])), GAUSS.powi(4), -0.9),
        ("Gaussian across sets", Box::new(gauss(&[0, 4, 9, 12])), GAUSS.powi(4), -0.8),
        ("sum of all", Box::new(|x| x[..14].iter().map(|&v| f64::from(v)).sum()), 7.0, -1.3),
        ("disc in the pixel", Box::new(move |x| disc(x[0], x[1])), std::f64::consts::FRAC_PI_4, -0.65),
        ("disc across sets", Box::new(move |x| disc(x[1], x[6])), std::f64::consts::FRAC_PI_4, -0.6),
        ("step", Box::new(|x| f64::from(u8::from(x[0] + 0.5 * x[1] < 0.7))), 0.45, -0.6),
    ];
    for (name, f, exact, greatest) in &integrands {
        let mut sobol = SobolSampler::new(6, u32::MAX);
        let mut random = PatternSampler::new(Pattern::Random, 6, 1);
        let sizes = [16, 64, 256, 1024];
        let sobol: Vec<_> = sizes.iter().map(|&n| (f64::from(n), rmse(&mut sobol, n, *exact, f))).collect();
        let random: Vec<_> = sizes.iter().map(|&n| (f64::from(n), rmse(&mut random, n, *exact, f))).collect();
        let (slope, random_slope) = (log_log_slope(&sobol), log_log_slope(&random));
        assert!(slope < *greatest, "{name}: slope {slope}, {sobol:?}");
        assert!((random_slope + 0.5).abs() < 0.06, "{name}: slope of random points {random_slope}, {random:?}");
        // Never worse than random points, and better where it counts.
        assert!(sobol[3].1 < 0.5 * random[3].1, "{name}: {sobol:?}, {random:?}");
    }
}

#[test]
fn the_scatter_of_replicates_tells_the_error_of_their_mean() {
    const REPLICATES: u32 = 16;
    const SIZE: u32 = 32;
    const PIXELS: u32 = 2000;
    let exact = std::f64::consts::FRAC_PI_4;
    let mut sampler = SobolSampler::new(7, SIZE);
    let (mut means, mut squares) = (Vec::new(), Vec::new());
    for pixel in 0..PIXELS {
        let replicates: Vec<f64> = (0..REPLICATES)
            .map(|r| {
                let hits = (r * SIZE..(r + 1) * SIZE).filter(|&sample| {
                    let x = numbers(&mut sampler, pixel, sample, 1);
                    x[0].hypot(x[3]) < 1.0
                });
                hits.count() as f64 / f64::from(SIZE)
            })
            .collect();
        let (mean, error) = mean_and_error(&replicates);
        means.push(mean);
        squares.push(((mean - exact) / error).powi(2));
    }
    let (mean, error) = mean_and_error(&means);
    assert!(z_test(mean, error, exact) > SIGNIFICANCE, "unbiased: {mean} +- {error}");
    // (mean - exact) / error follows Student's t with 15 degrees of freedom, whose variance is 15 / 13.
    let (variance, error) = mean_and_error(&squares);
    assert!(z_test(variance, error, 15.0 / 13.0) > 1e-3, "calibrated: {variance} +- {error} for {}", 15.0 / 13.0);
}

#[test]
fn any_number_of_first_samples_is_unbiased() {
    // Over many pixels, the mean of the first n positions lies in the centre, whatever n.
    for n in [1, 2, 3, 5, 7, 12] {
        for axis in 0..2 {
            let mut sobol = SobolSampler::new(8, u32::MAX);
            let mut patterns: Vec<_> = PATTERNS.iter().map(|&p| PatternSampler::new(p, 8, 16)).collect();
            let check = |name: String, position: &mut dyn FnMut(u32, u32) -> [f32; 2]| {
                let means: Vec<f64> = (0..4000)
                    .map(|pixel| (0..n).map(|i| f64::from(position(pixel, i)[axis])).sum::<f64>() / f64::from(n))
                    .collect();
                let (mean, error) = mean_and_error(&means);
                let p = z_test(mean, error, 0.5);
                assert!(p > sidak(SIGNIFICANCE, 60), "{name}, first {n}, axis {axis}: {mean} +- {error}");
            };
            check("Sobol'".into(), &mut |pixel, i| {
                sobol.start(pixel, i);
                sobol.pixel_2d()
            });
            for (sampler, pattern) in patterns.iter_mut().zip(PATTERNS) {
                check(format!("{pattern:?}"), &mut |pixel, i| {
                    sampler.start(pixel, i);
                    sampler.pixel_2d()
                });
            }
        }
    }
}

#[test]
fn jittered_and_grid_positions_visit_each_cell_once_a_pass() {
    // 10 samples need 4 x 4 cells.
    for (samples, side) in [(1_u32, 1_u32), (4, 2), (10, 4), (16, 4), (100, 10), (1024, 32)] {
        for pattern in [Pattern::Jittered, Pattern::Grid] {
            let mut sampler = PatternSampler::new(pattern, 9, samples);
            for pixel in [0, 5] {
                let mut orders = Vec::new();
                for pass in 0..3 {
                    let cells: Vec<(u32, u32)> = (0..side * side)
                        .map(|i| {
                            sampler.start(pixel, pass * side * side + i);
                            let [x, y] = sampler.pixel_2d();
                            if pattern == Pattern::Grid {
                                for v in [x, y] {
                                    let cell = v * side as f32;
                                    assert!((cell.fract() - 0.5).abs() < 1e-5);
                                }
                            }
                            ((x * side as f32) as u32, (y * side as f32) as u32)
                        })
                        .collect();
                    let distinct: HashSet<_> = cells.iter().collect();
                    assert_eq!(distinct.len(), cells.len(), "{pattern:?}, {samples} samples, pass {pass}");
                    orders.push(cells);
                }
                if side > 2 {
                    assert_ne!(orders[0], orders[1]);
                }
            }
        }
    }
}

#[test]
fn cells_are_visited_in_random_order() {
    // Which cell comes first, second, ... is uniform over pixels.
    let mut sampler = PatternSampler::new(Pattern::Grid, 10, 25);
    let pixels = 20_000;
    for sample in [0, 1, 12, 24] {
        let mut counts = vec![0_u64; 25];
        for pixel in 0..pixels {
            sampler.start(pixel, sample);
            let [x, y] = sampler.pixel_2d();
            counts[(x * 5.0) as usize * 5 + (y * 5.0) as usize] += 1;
        }
        let p = chi_square(&counts, &[f64::from(pixels) / 25.0; 25]);
        assert!(p > sidak(SIGNIFICANCE, 4), "sample {sample}: p = {p}");
    }
}

#[test]
fn the_normal_pattern_has_half_a_pixel_of_deviation() {
    let mut sampler = PatternSampler::new(Pattern::Gaussian, 11, 1);
    let positions: Vec<[f32; 2]> = (0..100_000)
        .map(|sample| {
            sampler.start(3, sample);
            sampler.pixel_2d()
        })
        .collect();
    for axis in 0..2 {
        let offsets: Vec<f64> = positions.iter().map(|p| (f64::from(p[axis]) - 0.5) / 0.5).collect();
        for (power, moment) in [(1, 0.0), (2, 1.0), (3, 0.0), (4, 3.0)] {
            let powers: Vec<f64> = offsets.iter().map(|x| x.powi(power)).collect();
            let (mean, error) = mean_and_error(&powers);
            assert!(z_test(mean, error, moment) > sidak(SIGNIFICANCE, 8), "moment {power}: {mean} +- {error}");
        }
        // Beyond one standard deviation is outside the pixel: 31.73 %.
        let outside = positions.iter().filter(|p| !(0.0..1.0).contains(&p[axis])).count() as f64 / 1e5;
        assert!((outside - 0.3173).abs() < 0.006, "{outside}");
    }
}
