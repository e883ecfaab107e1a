//! Statistical tests: conditions that a measured value satisfies if the code is correct.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Probability of a false alarm for a whole family of tests.
pub const SIGNIFICANCE: f64 = 0.01;

/// Significance of one of `tests` independent tests so that all together raise a false alarm with probability `alpha`.
///
/// Source: Sidak 1967.
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    -((-alpha).ln_1p() / tests as f64).exp_m1()
}

/// Two-sided p-value of a mean with a known standard error.
pub fn z_test(mean: f64, standard_error: f64, exact: f64) -> f64 {
    let z = (mean - exact).abs() / standard_error;
    match Normal::standard().sf(z) {
        p if p.is_nan() => 0.0,
        p => 2.0 * p,
    }
}

/// Two-sided p-value of a mean whose standard error is known from `runs` runs only.
pub fn t_test((mean, standard_error): (f64, f64), exact: f64, runs: u32) -> f64 {
    let t = (mean - exact).abs() / standard_error;
    let p = StudentsT::new(0.0, 1.0, f64::from(runs.max(2) - 1)).map_or(0.0, |distribution| 2.0 * distribution.sf(t));
    if p.is_nan() { 0.0 } else { p }
}

/// p-value of Pearson's chi-square test. Cells with fewer than five expected counts are pooled. A count where none is
/// expected gives 0.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(observed.len(), expected.len());
    let (mut statistic, mut cells) = (0.0, 0_usize);
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    let mut add = |observed: f64, expected: f64| {
        statistic += (observed - expected) * (observed - expected) / expected;
        cells += 1;
    };
    for (&observed, &expected) in observed.iter().zip(expected) {
        if expected <= 0.0 {
            if observed > 0 {
                return 0.0;
            }
        } else if expected < 5.0 {
            pooled_observed += observed as f64;
            pooled_expected += expected;
            if pooled_expected >= 5.0 {
                add(pooled_observed, pooled_expected);
                (pooled_observed, pooled_expected) = (0.0, 0.0);
            }
        } else {
            add(observed as f64, expected);
        }
    }
    if pooled_expected > 0.0 {
        add(pooled_observed, pooled_expected);
    }
    let freedom = (cells.max(2) - 1) as f64;
    ChiSquared::new(freedom).map_or(0.0, |distribution| distribution.sf(statistic))
}

/// Mean and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Slope of the least-squares line through (ln x, ln y).
pub fn log_log_slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (mx, my) = logs.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let (xy, xx) =
        logs.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mx) * (y - my), xx + (x - mx) * (x - mx)));
    xy / xx
}

/// Result of a comparison of samples with their density.
#[derive(Debug)]
pub struct DensityCheck {
    /// Integral of the density over the whole domain.
    pub integral: f64,
    /// p-value of the samples given the density.
    pub p_value: f64,
    /// Share of the draws that gave nothing, which the integral falls short of 1 by.
    pub rejected: f64,
    /// Largest relative difference, in magnitude, between the density at a sample and the density that the sampler
    /// itself reported.
    pub mismatch: f64,
}

impl DensityCheck {
    /// Whether the density integrates to 1, agrees with the sampler's own, and explains the samples.
    pub fn passes(&self, significance: f64) -> bool {
        self.rejected == 0.0
            && (self.integral - 1.0).abs() < 1e-3
            && self.mismatch < 1e-5
            && self.p_value > significance
    }
}

/// Compares samples with a density on a rectangle of `nx` x `ny` cells.
///
/// `draw` returns a point and the density with which it was drawn, or NaN for a draw that gave nothing; `density` is integrated over each cell by the
/// midpoint rule, with more points where it varies around the cell.
pub fn check_density(
    (nx, ny): (usize, usize),
    (x_range, y_range): ((f64, f64), (f64, f64)),
    draws: usize,
    mut draw: impl FnMut() -> (f64, f64, f64),
    density: impl Fn(f64, f64) -> f64,
) -> DensityCheck {
    let (dx, dy) = ((x_range.1 - x_range.0) / nx as f64, (y_range.1 - y_range.0) / ny as f64);
    let mut observed = vec![0_u64; nx * ny];
    let mut mismatch = 0.0_f64;
    let mut rejected = 0_u64;
    for _ in 0..draws {
        let (x, y, reported) = draw();
        if x.is_nan() {
            rejected += 1;
            continue;
        }
        let i = (((x - x_range.0) / dx) as usize).min(nx - 1);
        let j = (((y - y_range.0) / dy) as usize).min(ny - 1);
        observed[i * ny + j] += 1;
        let found = density(x, y);
        // Rounding may carry a sample across an edge of the support; the counts decide about that.
        if found > 0.0 {
            mismatch = mismatch.max((found / reported - 1.0).abs());
        }
    }
    let at = |x: f64, y: f64| density(x_range.0 + x * dx, y_range.0 + y * dy);
    let coarse: Vec<_> =
        (0..nx * ny).map(|cell| midpoints(&at, ((cell / ny) as f64, (cell % ny) as f64), 1.0, (6, 7))).collect();
    let mut expected = Vec::with_capacity(nx * ny);
    for i in 0..nx {
        for j in 0..ny {
            // An edge of the support may pass between the midpoints of a cell; then a neighbour shows it.
            let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
            for row in i.saturating_sub(1)..(i + 2).min(nx) {
                for cell in &coarse[row * ny + j.saturating_sub(1)..row * ny + (j + 2).min(ny)] {
                    (low, high) = (low.min(cell.1), high.max(cell.2));
                }
            }
            let corner = (i as f64, j as f64);
            let mean = if low == 0.0 && high > 0.0 {
                // A bulge of the edge between all points holds less than this.
                mean_at_edge(&at, corner, 1.0, 3).max(1e-4 * high)
            } else if high > 1.1 * low {
                midpoints(&at, corner, 1.0, (8, 9)).0
            } else {
                coarse[i * ny + j].0
            };
            expected.push(mean * dx * dy * draws as f64);
        }
    }
    let integral = expected.iter().sum::<f64>() / draws as f64;
    let rejected = rejected as f64 / draws as f64;
    DensityCheck { integral, rejected, p_value: chi_square(&observed, &expected), mismatch }
}

/// Mean, least and greatest density over m x n midpoints of a square with the given corner and side. Different numbers
/// along both axes, so that no diagonal edge of a support meets midpoints along its whole length.
fn midpoints(
    density: &impl Fn(f64, f64) -> f64,
    corner: (f64, f64),
    side: f64,
    (m, n): (usize, usize),
) -> (f64, f64, f64) {
    let (mut sum, mut low, mut high) = (0.0, f64::INFINITY, 0.0_f64);
    for k in 0..m * n {
        let x = corner.0 + side * ((k / n) as f64 + 0.5) / m as f64;
        let y = corner.1 + side * ((k % n) as f64 + 0.5) / n as f64;
        let value = density(x, y);
        sum += value;
        low = low.min(value);
        high = high.max(value);
    }
    (sum / (m * n) as f64, low, high)
}

/// Mean density of a square that an edge of the support may cross: its quarters, and again those quarters of them that the
/// edge is seen to cross, `depth` times more. Points on the border of a quarter count too, so that a thin strip along it is
/// seen.
fn mean_at_edge(density: &impl Fn(f64, f64) -> f64, corner: (f64, f64), side: f64, depth: u32) -> f64 {
    let half = side / 2.0;
    let mut sum = 0.0;
    for (u, v) in [(0.0, 0.0), (0.0, half), (half, 0.0), (half, half)] {
        let corner = (corner.0 + u, corner.1 + v);
        let (mean, low, high) = midpoints(density, corner, half, (4, 5));
        let is_crossed = || {
            let inside = (0..16).map(|k| {
                let t = f64::from(k % 4) / 4.0 * half;
                let (x, y) = [(t, 0.0), (half, t), (half - t, half), (0.0, half - t)][k as usize / 4];
                density(corner.0 + x, corner.1 + y) > 0.0
            });
            let inside = inside.filter(|&is| is).count() + usize::from(low > 0.0) + usize::from(high > 0.0);
            inside != 0 && inside != 18
        };
        sum += if depth > 0 && is_crossed() { mean_at_edge(density, corner, half, depth - 1) } else { mean };
    }
    sum / 4.0
}

/// [`check_density`] over all directions in (cos theta, phi), where densities per solid angle need no factor. 80 x 160
/// cells.
pub fn check_directions(
    draws: usize,
    mut draw: impl FnMut() -> ([f32; 3], f32),
    density: impl Fn([f32; 3]) -> f32,
) -> DensityCheck {
    use std::f64::consts::PI;
    check_density(
        (80, 160),
        ((-1.0, 1.0), (-PI, PI)),
        draws,
        || {
            let (w, pdf) = draw();
            (f64::from(w[2]), f64::from(w[1]).atan2(f64::from(w[0])), f64::from(pdf))
        },
        |z, phi| {
            let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
            f64::from(density([(sin * phi.cos()) as f32, (sin * phi.sin()) as f32, z as f32]))
        },
    )
}
