//! Samplers: ranges, stratification, independence, convergence, determinism.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod stats;
}

use std::collections::HashSet;

use common::stats::{SIGNIFICANCE, chi_square, mean_and_error, sidak, z_test};
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
