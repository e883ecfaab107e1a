//! Distributions and filters: that samples follow the densities they claim. Tests of the samplers are in `sequences.rs`;
//! more about both, and about warps and triangles seen from a point, in `accuracy/`.

mod common {
    // Each test program uses its own part.
    #[allow(dead_code)]
    pub mod stats;
}

use common::stats::{SIGNIFICANCE, chi_square, sidak};
use etendue::desc::FilterDesc;
use etendue::sampling::{Distribution1D, Filter, Rng};

/// Numbers at the ends and in the middle of the unit square.
fn corner_numbers() -> Vec<[f32; 2]> {
    let values = [0.0, f32::MIN_POSITIVE, 0.25, 0.5_f32.next_down(), 0.5, 0.75, 1.0_f32.next_down()];
    values.iter().flat_map(|&a| values.map(|b| [a, b])).collect()
}

// ---- discrete choice ----

#[test]
fn indices_are_chosen_in_proportion_to_weights() {
    let many: Vec<f64> = (0..1000).map(|i| if i % 7 == 0 { 0.0 } else { f64::from(i).sqrt() }).collect();
    let cases: Vec<Vec<f64>> = vec![
        vec![1.0],
        vec![0.0, 3.0, 0.0, 0.0, 1.0, 0.0],
        vec![1e-30, 2e-30, 1e-30],
        vec![1e300, 1.0, 1e300],
        vec![1.0; 333],
        many,
    ];
    for (i, weights) in cases.iter().enumerate() {
        let distribution = Distribution1D::new(weights).unwrap();
        let total: f64 = weights.iter().sum();
        assert_eq!((distribution.len(), distribution.total()), (weights.len(), total));
        let mut rng = Rng::new(11, i as u64);
        let (mut counts, mut remapped_counts) = (vec![0_u64; weights.len()], vec![0_u64; 16]);
        let draws = 200_000;
        for _ in 0..draws {
            let (index, pmf, remapped) = distribution.sample(rng.next_f32());
            counts[index] += 1;
            remapped_counts[(remapped * 16.0) as usize] += 1;
            assert!((0.0..1.0).contains(&remapped));
            assert_eq!(pmf, distribution.pmf(index));
            assert!((f64::from(pmf) / (weights[index] / total) - 1.0).abs() < 1e-6);
        }
        for u in [0.0, 0.25, 0.5, 0.75, 1.0_f32.next_down(), 1.0, -1.0] {
            assert!(weights[distribution.sample(u).0] > 0.0, "{weights:?} at {u}");
        }
        let expected: Vec<f64> = weights.iter().map(|w| w / total * f64::from(draws)).collect();
        let significance = sidak(SIGNIFICANCE, 2 * cases.len());
        assert!(weights.len() == 1 || chi_square(&counts, &expected) > significance, "{i}");
        assert!(chi_square(&remapped_counts, &[f64::from(draws) / 16.0; 16]) > significance, "{i}");
        assert_eq!(distribution.pmf(weights.len()), 0.0);
    }
}

#[test]
fn weights_without_a_distribution_are_refused() {
    for bad in [&[][..], &[0.0, 0.0], &[1.0, -1.0], &[f64::NAN], &[f64::INFINITY], &[f64::MAX, f64::MAX]] {
        assert!(Distribution1D::new(bad).is_none(), "{bad:?}");
    }
}

// ---- filters ----

fn filters() -> Vec<(FilterDesc, f64)> {
    // With the largest value of the filter along one axis, for the tolerance of the tabulated density.
    let mitchell = |b, c| FilterDesc::Mitchell { b, c };
    vec![
        (FilterDesc::Box, 1.0),
        (FilterDesc::Tent, 1.0),
        (FilterDesc::Gaussian { sigma: 0.5 }, 0.8),
        (FilterDesc::Gaussian { sigma: 0.2 }, 2.0),
        (FilterDesc::BlackmanHarris, 0.7),
        (mitchell(1.0 / 3.0, 1.0 / 3.0), 0.9),
        (mitchell(0.0, 0.5), 1.0),
        (mitchell(1.0, 0.0), 0.7),
    ]
}

#[test]
fn tabulated_filters_are_as_exact_as_stated() {
    for (desc, peak) in filters() {
        let filter = Filter::new(&desc);
        let centre = f64::from(filter.evaluate(0.0, 0.0)).sqrt();
        let magnitude = f64::from(filter.sample([0.5, 0.5]).1.abs()).sqrt();
        // du / dx of the inverse is the density that is really drawn from.
        let h = 2.0_f32.powi(-12);
        for k in 1..1000 {
            let u = k as f32 / 1000.0;
            let (a, b) = (filter.sample([u - h, 0.5]).0[0], filter.sample([u + h, 0.5]).0[0]);
            let drawn = 2.0 * f64::from(h) / (f64::from(b) - f64::from(a)) * magnitude;
            let exact = f64::from(filter.evaluate(filter.sample([u, 0.5]).0[0], 0.0)).abs() / centre;
            if exact > 0.2 * peak {
                // What remains is the difference quotient's own error: rounding of x and curvature.
                assert!((drawn - exact).abs() < 2e-3 * peak, "{desc:?} at {u}: {drawn} for {exact}");
            }
        }
        // The cumulative distribution at fixed points tells the density's error without differences.
        let n = 200_000;
        let (r, mut cumulative) = (f64::from(filter.radius()), 0.0);
        let dx = 2.0 * r / f64::from(n);
        let mut k = 1;
        for i in 0..n {
            let x = (f64::from(i) + 0.5) * dx - r;
            cumulative += f64::from(filter.evaluate(x as f32, 0.0)).abs() / centre * dx / magnitude;
            if cumulative >= f64::from(k) / 64.0 && k < 64 {
                let drawn = f64::from(filter.sample([k as f32 / 64.0, 0.5]).0[0]);
                let density = f64::from(filter.evaluate(x as f32, 0.0)).abs() / centre / magnitude;
                let off = (drawn - x).abs() * density;
                assert!(off < 1e-5 + dx * density, "{desc:?}: quantile {k} at {drawn} for {x}");
                k += 1;
            }
        }
        assert_eq!(k, 64, "{desc:?}");
    }
}

#[test]
fn filter_samples_stay_inside_for_any_number() {
    for (desc, _) in filters() {
        let filter = Filter::new(&desc);
        for u in corner_numbers() {
            let ([x, y], weight) = filter.sample(u);
            assert!(x.abs() <= filter.radius() && y.abs() <= filter.radius() && weight.is_finite(), "{desc:?} {u:?}");
        }
        // A position outside the pixel is kept by the box and clamped by the others.
        let ([x, _], _) = filter.sample([1.7, 0.5]);
        assert!(if desc == FilterDesc::Box { (x - 1.2).abs() < 1e-6 } else { x.abs() <= filter.radius() });
    }
}
