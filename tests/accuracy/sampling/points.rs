//! How evenly the points of a pixel lie: elementary intervals, discrepancy, and indices near the end of their range.

use std::collections::HashSet;

use etendue::sampling::{Pattern, PatternSampler, SobolSampler};

use super::numbers;
use crate::record::{Case, Entry, Within};
use crate::stats::{chi_square, mean_and_error};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "P49", title: "Elementary intervals", run: elementary_intervals },
        Entry { id: "P50", title: "Discrepancy", run: discrepancy },
        Entry { id: "P53b", title: "Sample indices", run: indices },
    ]
}

/// Dimensions of the first sixteen pairs: the position and fifteen pairs of the sets.
const DIMENSIONS: usize = 32;

/// Seeds and pixels with large and small bits.
fn places(count: u64) -> impl Iterator<Item = (u64, u32)> {
    let corners = [(0, 0), (1, 0), (0, 1), (u64::MAX, u32::MAX), (1 << 40, 65_536)];
    let more = (0..).map(|i: u64| (i * 0x9e37_79b9, (i as u32).wrapping_mul(2_654_435_761)));
    corners.into_iter().chain(more).take(count as usize)
}

/// Boxes of volume 2^t / N in which there are not exactly 2^t of the N points, over all shapes.
fn uneven_boxes(points: &[[f32; 2]], t: u32) -> u64 {
    let k = points.len().trailing_zeros() - t.min(points.len().trailing_zeros());
    let mut bad = 0;
    let mut counts = vec![0_u32; 1 << k];
    for split in 0..=k {
        counts.fill(0);
        for [x, y] in points {
            let column = (x * (1_u32 << split) as f32) as usize;
            let row = (y * (1_u32 << (k - split)) as f32) as usize;
            counts[column << (k - split) | row] += 1;
        }
        bad += counts.iter().filter(|&&count| count != 1 << t).count() as u64;
    }
    bad
}

fn elementary_intervals(case: &mut Case) {
    let (mut single, mut net, mut boxes, mut intervals) = (0, 0, 0_u64, 0_u64);
    // The quality of each pair of dimensions: the least t with which it is a (t, 10, 2)-net everywhere.
    let mut quality = [0; DIMENSIONS / 2];
    for (seed, pixel) in places(case.count(8, 100)) {
        let mut sampler = SobolSampler::new(seed, u32::MAX);
        for k in 2..=10_u32 {
            // Any aligned block of points, also past the 2^16 of one scramble.
            for block in [0, 3, 1 << 17] {
                let n = 1_u32 << k;
                let points: Vec<[f32; DIMENSIONS]> =
                    (block * n..(block + 1) * n).map(|sample| numbers(&mut sampler, pixel, sample)).collect();
                for d in 0..DIMENSIONS {
                    let mut seen = vec![false; n as usize];
                    points.iter().for_each(|p| seen[(p[d] * n as f32) as usize] = true);
                    single += seen.iter().filter(|seen| !**seen).count() as u64;
                    intervals += u64::from(n);
                }
                let pair = |d: usize| -> Vec<[f32; 2]> { points.iter().map(|p| [p[2 * d], p[2 * d + 1]]).collect() };
                net += uneven_boxes(&pair(0), 0);
                boxes += u64::from(n) * u64::from(k + 1);
                if k == 10 && block == 0 {
                    for (d, quality) in quality.iter_mut().enumerate() {
                        let pair = pair(d);
                        *quality = (*quality..).find(|&t| uneven_boxes(&pair, t) == 0).expect("t = 10 fits anything");
                    }
                }
            }
        }
    }
    case.never("Sobol', each of 32 dimensions: 1/N without a point", single, intervals);
    case.never("Sobol', position in the pixel: box without one point", net, boxes);
    // Later dimensions of a Sobol' sequence come from polynomials of higher degree, and promise less in pairs.
    let worst = quality.iter().copied().max().unwrap_or(0);
    case.at_most("Sobol', 16 pairs: t of the (t,10,2)-net", f64::from(worst), 5.0);

    let (mut bad, mut tried) = (0, 0);
    for (seed, pixel) in places(case.count(8, 100)) {
        for pattern in [Pattern::Jittered, Pattern::Grid] {
            for side in [1_u32, 2, 4, 7, 32] {
                let n = side * side;
                let mut sampler = PatternSampler::new(pattern, seed, n);
                let starts: Vec<f32> = (0..side).map(|cell| cell as f32 / side as f32).collect();
                for pass in 0..2 {
                    let mut seen = vec![false; n as usize];
                    for sample in pass * n..(pass + 1) * n {
                        let [x, y] = numbers::<2>(&mut sampler, pixel, sample)
                            .map(|x| starts.partition_point(|start| *start <= x) - 1);
                        seen[x * side as usize + y] = true;
                    }
                    bad += seen.iter().filter(|seen| !**seen).count() as u64;
                    tried += u64::from(n);
                }
            }
        }
    }
    case.never("jittered and grid: cell without a point", bad, tried);
    // With all its digits, an index is still below 1.
    let mut sampler = SobolSampler::new(1, u32::MAX);
    let [x, y] = numbers(&mut sampler, 0, u32::MAX);
    case.holds("Sobol', point 2^32 - 1: below 1", "yes", format!("{x}, {y}"), x < 1.0 && y < 1.0);
}

/// Square of the L2-star discrepancy. Source: Warnock 1972.
fn discrepancy2(points: &[[f32; 2]]) -> f64 {
    let n = points.len() as f64;
    let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
    let single: f64 = points.iter().map(|[x, y]| 0.25 * (1.0 - x * x) * (1.0 - y * y)).sum();
    let pairs: f64 =
        points.iter().flat_map(|a| points.iter().map(move |b| (1.0 - a[0].max(b[0])) * (1.0 - a[1].max(b[1])))).sum();
    1.0 / 9.0 - 2.0 / n * single + pairs / (n * n)
}

/// Expected square of the L2-star discrepancy of a (0,m,2)-net in base 2 after Owen's scrambling.
///
/// Each point alone is uniform, so only pairs matter. Two points that share the first r digits of a coordinate, and not the
/// next, have 1 - max of 1/2 - 2^-(r+2) there on average, independently of the other coordinate. By the net's definition,
/// of the pairs of distinct points, N (2^(m-a-b) - 1) share a digits of one and b of the other coordinate, or none if
/// a + b > m.
fn scrambled_net(m: i32) -> f64 {
    let n = f64::from(1 << m);
    let sharing = |a: i32, b: i32| if a + b > m { 0.0 } else { n * (f64::from(1 << (m - a - b)) - 1.0) };
    let mean = |r: i32| 0.5 - 0.25 * (-f64::from(r)).exp2();
    let mut pairs = 0.0;
    for a in 0..=m {
        for b in 0..=m {
            let exactly = sharing(a, b) - sharing(a + 1, b) - sharing(a, b + 1) + sharing(a + 1, b + 1);
            pairs += exactly * mean(a) * mean(b);
        }
    }
    1.0 / 9.0 - 2.0 / 9.0 + 0.25 / n + pairs / (n * n)
}

fn discrepancy(case: &mut Case) {
    let seeds = case.count(200, 4000) as u32;
    // The formula itself, on a net without scrambling: (i/N, radical inverse of i).
    let hammersley: Vec<[f32; 2]> =
        (0..64_u32).map(|i| [i as f32 / 64.0, (i.reverse_bits() >> 8) as f32 / 16_777_216.0]).collect();
    case.exact(
        "Warnock's formula, Hammersley, N = 64",
        discrepancy2(&hammersley).sqrt(),
        0.0212051081663,
        Within::Relative(1e-6),
    );

    for m in [4, 6, 8] {
        let n = 1_u32 << m;
        let squares = |first: &mut dyn FnMut(u32, u32) -> [f32; 2]| -> (f64, f64) {
            let squares: Vec<f64> = (0..seeds)
                .map(|pixel| discrepancy2(&(0..n).map(|sample| first(pixel, sample)).collect::<Vec<_>>()))
                .collect();
            mean_and_error(&squares)
        };
        let mut sobol = SobolSampler::new(49, n);
        let found = squares(&mut |pixel, sample| numbers(&mut sobol, pixel, sample));
        case.mean(format!("Sobol', mean square of D*, N = {n}"), found, scrambled_net(m), 0.1);
        let random = (0.25 - 1.0 / 9.0) / f64::from(n);
        let ratio = (random / found.0).sqrt();
        let hammersley = [0.0692908389619, 0.0212051081663, 0.00627723139740][m as usize / 2 - 2];
        case.at_most(format!("Sobol', RMS of D* over Hammersley's, N = {n}"), found.0.sqrt() / hammersley, 1.0);
        case.at_most(
            format!("Sobol', RMS of D* over random points', N = {n}"),
            1.0 / ratio,
            [0.5, 0.4, 0.25][m as usize / 2 - 2],
        );

        let mut pattern = PatternSampler::new(Pattern::Random, 50, n);
        let found = squares(&mut |pixel, sample| numbers(&mut pattern, pixel, sample));
        case.mean(format!("random, mean square of D*, N = {n}"), found, random, 0.1);
    }
}

fn indices(case: &mut Case) {
    let pixels = case.count(20_000, 1_000_000) as u32;
    let mut worst = 1.0_f64;
    let mut tests = 0;
    // The last indices: of a replicate of 16, of one open replicate, and of patterns.
    let late = [1_000_000_000, (1 << 30) - 1, 1 << 31, u32::MAX - 1, u32::MAX];
    let mut check = |sampler: &mut dyn FnMut(u32, u32) -> [f32; 6], start: usize| {
        for sample in late {
            let mut counts = [[0_u64; 64]; 3];
            for pixel in 0..pixels {
                let point = sampler(pixel, sample);
                for pair in start..3 {
                    let [x, y] = [point[2 * pair], point[2 * pair + 1]].map(|x| (x * 8.0) as usize);
                    counts[pair][8 * x + y] += 1;
                }
            }
            for counts in &counts[start..] {
                worst = worst.min(chi_square(counts, &[f64::from(pixels) / 64.0; 64]));
                tests += 1;
            }
        }
    };
    for size in [16, u32::MAX] {
        let mut sampler = SobolSampler::new(7, size);
        check(&mut |pixel, sample| numbers(&mut sampler, pixel, sample), 0);
    }
    for (pattern, samples, start) in [
        (Pattern::Random, 64, 0),
        (Pattern::Jittered, 64, 0),
        (Pattern::Jittered, 1 << 30, 0),
        (Pattern::Gaussian, 64, 1),
    ] {
        let mut sampler = PatternSampler::new(pattern, 7, samples);
        check(&mut |pixel, sample| numbers(&mut sampler, pixel, sample), start);
    }
    case.p_value("samples from 10^9 to 2^32 - 1: uniform", worst, tests);

    // Replicates and blocks beyond 16 and 24 bits: no two are one.
    let mut repeated = 0;
    let mut tried = 0;
    for size in [1, 16, 1 << 16, u32::MAX] {
        let mut sampler = SobolSampler::new(7, size);
        let mut seen = HashSet::new();
        for power in 0..32 {
            for near in 0..case.count(100, 2000) as u32 {
                let sample = (1_u32 << power).wrapping_sub(50).wrapping_add(near);
                let bits: [u32; 6] = numbers::<6>(&mut sampler, 3, sample).map(f32::to_bits);
                seen.insert((sample, bits));
                tried += 1;
            }
        }
        let samples: HashSet<u32> = seen.iter().map(|(sample, _)| *sample).collect();
        let points: HashSet<[u32; 6]> = seen.iter().map(|(_, bits)| *bits).collect();
        repeated += (samples.len() - points.len()) as u64;
    }
    case.never("Sobol', samples around each power of 2: repeated", repeated, tried);
}
