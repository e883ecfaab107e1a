//! What single scattering loses by direction: integrated once for a material, and stored as a table.
//!
//! Light that one facet reflects onto another is not in the models of single scattering, which are therefore too dark. What
//! is missing, 1 - E(w), is what [`MissingEnergy`] stores, and models give it back as Kulla and Conty do.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use super::super::memo::memo;
use super::albedo::{FacetShares, albedo, direction};
use super::{Distribution, Masking, Microfacets};
use crate::math::Vec3;

/// Places of a table along the angle to the normal.
const PLACES: usize = 48;

/// Rows of a table along the azimuth, for facets of two widths.
const ROWS: usize = 32;

/// Azimuths at which the albedo is integrated; the rows hold the series through these values.
const AZIMUTHS: usize = 16;

type Row = [f32; PLACES];

/// What single scattering loses in each direction, 1 - E(w): a function of the angle to the normal, and of the azimuth for
/// facets of two widths.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingEnergy {
    scale: Scale,
    values: Values,
    mean: f32,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    /// Facets of one width.
    OneWidth(Row),
    /// Facets of two widths. The row of the direction (x, y, z) in the facets' frame is at k |y| / (|x| + k |y|), where k is
    /// the given number.
    TwoWidths(Arc<[Row; ROWS]>, f32),
}

/// Where in a row a cosine is found.
///
/// Albedos change at angles over the horizon as small as the slopes of the facets, and as fast next to the critical angle of
/// total reflection. The place is asinh(sqrt(mu / 2 alpha)) + asinh(2 (mu - critical) / alpha) / 2, up to a linear function;
/// the second term is left out where there is no total reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    /// 1 / (2 alpha).
    horizon: f32,
    /// Cosine of the critical angle.
    critical: f32,
    /// 2 / alpha, or 0 without total reflection.
    around: f32,
    offset: f32,
    scale: f32,
}

impl Scale {
    /// `width` is the facets' alpha, `critical` the cosine of the critical angle or 0.
    fn new(width: f32, critical: f32) -> Self {
        let around = if critical > 0.0 { 2.0 / width.min(1.0) } else { 0.0 };
        let mut made = Self { horizon: 0.5 / width, critical, around, offset: 0.0, scale: 1.0 };
        made.offset = made.place(0.0);
        made.scale = (PLACES - 1) as f32 / made.place(1.0);
        made
    }

    /// The place of a cosine in [0, 1], from 0 to the last.
    #[inline]
    fn place(&self, mu: f32) -> f32 {
        // asinh(x) = ln(x + sqrt(1 + x^2)) for x >= 0; a single logarithm is enough for twice the sum.
        let spread = |x: f32| x + (1.0 + x * x).sqrt();
        let horizon = spread((mu * self.horizon).sqrt());
        let from_critical = (mu - self.critical) * self.around;
        let around = spread(from_critical.abs());
        let product = horizon * horizon * if from_critical < 0.0 { 1.0 / around } else { around };
        (product.ln() - self.offset) * self.scale
    }

    /// The cosine at a place.
    fn cosine(&self, place: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if f64::from(self.place(middle as f32)) < place {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The first of four neighbours of a place in a table of `n`, and their weights in the cubic polynomial through them.
#[inline]
fn neighbours(place: f32, n: usize) -> (usize, [f32; 4]) {
    let second = (place as usize).clamp(1, n - 3);
    let t = place - second as f32;
    let (a, b, c) = (t + 1.0, t - 1.0, t - 2.0);
    (second - 1, [-t * b * c / 6.0, 0.5 * a * b * c, -0.5 * a * t * c, a * t * b / 6.0])
}

/// A cosine series of `n` terms through values at the angles [`node`].
fn series(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let term = |k: usize| {
        let sum: f64 = values.iter().enumerate().map(|(i, value)| value * (k as f64 * node(i, n)).cos()).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
    };
    (0..n).map(term).collect()
}

/// The sum of a cosine series.
fn sum_of(series: &[f64], angle: f64) -> f64 {
    series.iter().enumerate().map(|(k, term)| term * (k as f64 * angle).cos()).sum()
}

/// Angle number `i` of `n` in [0, pi].
fn node(i: usize, n: usize) -> f64 {
    PI * (i as f64 + 0.5) / n as f64
}

/// What is asked of a rough surface, as a key: distribution, masking, widths, and the bits of the index of refraction and of
/// the numbers of a film.
type Key = (Distribution, Masking, [u32; 2], u64, bool, [u64; 2]);

memo!(
    /// Tables that were integrated before, of 200 bytes each, or 6 kB for facets of two widths.
    KNOWN: Key => MissingEnergy, 8192
);

impl MissingEnergy {
    /// 1 - E of these facets. `index` is the index of refraction behind a facet over that in front of it, 0 where the shares
    /// depend on none, and `transmits` whether facets transmit: both distinguish what is remembered.
    pub fn new(facets: &Microfacets, (index, transmits): (f64, bool), shares: impl Fn(f64) -> FacetShares) -> Self {
        Self::of_film(facets, (index, transmits), [0; 2], shares)
    }

    /// As [`Self::new`], for facets with a film that these numbers distinguish.
    pub fn of_film(
        facets: &Microfacets,
        (index, transmits): (f64, bool),
        film: [u64; 2],
        shares: impl Fn(f64) -> FacetShares,
    ) -> Self {
        // The angle by which facets are turned does not matter here.
        let facets = Microfacets { turn: [1.0, 0.0], ..*facets };
        let key =
            (facets.distribution, facets.masking, facets.alpha.map(f32::to_bits), index.to_bits(), transmits, film);
        KNOWN.get(&key, || {
            let critical = if index > 0.0 && index < 1.0 { (1.0 - index * index).sqrt() } else { 0.0 };
            Self::integrated(&facets, critical, |mu, phi| {
                (1.0 - albedo(&facets, direction(&facets, mu, phi), critical, &shares)).max(0.0)
            })
        })
    }

    fn integrated(facets: &Microfacets, critical: f64, missing: impl Fn(f64, f64) -> f64) -> Self {
        let [ax, ay] = facets.alpha;
        let scale = Scale::new((ax * ay).sqrt(), critical as f32);
        let cosines: [f64; PLACES] = std::array::from_fn(|i| scale.cosine(i as f64));
        let row = |phi: f64| cosines.map(|mu| missing(mu, phi));
        let values = if facets.is_anisotropic() {
            // The azimuth as it is half way between the facets' own frame and the one in which widths are equal.
            let k = f64::from(ay / ax).sqrt();
            let rows: Vec<_> = (0..AZIMUTHS)
                .map(|j| {
                    let (sin, cos) = (0.5 * node(j, AZIMUTHS)).sin_cos();
                    row(sin.atan2(k * cos))
                })
                .collect();
            let around: Vec<_> =
                (0..PLACES).map(|i| series(&rows.iter().map(|row| row[i]).collect::<Vec<_>>())).collect();
            let row = |j: usize| -> Row {
                let t = j as f64 / (ROWS - 1) as f64;
                std::array::from_fn(|i| sum_of(&around[i], 2.0 * t.atan2(1.0 - t)) as f32)
            };
            Values::TwoWidths(Arc::new(std::array::from_fn(row)), k as f32)
        } else {
            Values::OneWidth(row(0.0).map(|value| value as f32))
        };
        let mut made = Self { scale, values, mean: 0.0 };
        made.mean = made.integrated_mean(facets) as f32;
        made
    }

    /// The mean over the hemisphere, weighed by the cosine.
    fn integrated_mean(&self, facets: &Microfacets) -> f64 {
        const STEPS: usize = 4;
        let azimuths = if facets.is_anisotropic() { 64 } else { 1 };
        let steps = (PLACES - 1) * STEPS;
        let (mut sum, mut whole) = (0.0, 0.0);
        let mut before = 0.0;
        for i in 0..steps {
            let end = if i + 1 == steps { 1.0 } else { self.scale.cosine((i + 1) as f64 / STEPS as f64) };
            let (mu, weight) = (0.5 * (before + end), end * end - before * before);
            for j in 0..azimuths {
                let phi = FRAC_PI_2 * (f64::from(j) + 0.5) / f64::from(azimuths);
                sum += weight * f64::from(self.at(facets, direction(facets, mu, phi)));
                whole += weight;
            }
            before = end;
        }
        sum / whole
    }

    /// 1 - E of a direction of the local frame of the facets; the sign of its cosine does not matter.
    #[inline]
    pub fn at(&self, facets: &Microfacets, w: Vec3) -> f32 {
        let (first, weights) = neighbours(self.scale.place(w.z.abs()), PLACES);
        let along = |row: &Row| -> f32 { (0..4).map(|i| weights[i] * row[first + i]).sum() };
        let value = match &self.values {
            Values::OneWidth(row) => along(row),
            Values::TwoWidths(rows, k) => {
                let own = facets.in_facets(w);
                let (x, y) = (own.x.abs(), k * own.y.abs());
                let row = if x + y > 0.0 { y / (x + y) * (ROWS - 1) as f32 } else { 0.0 };
                let (nearest, weights) = neighbours(row, ROWS);
                (0..4).map(|j| weights[j] * along(&rows[nearest + j])).sum()
            }
        };
        value.clamp(0.0, 1.0)
    }

    /// The mean of 1 - E over the hemisphere, weighed by the cosine.
    #[inline]
    pub fn mean(&self) -> f32 {
        self.mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::MicrofacetsDesc;

    #[test]
    fn albedos_of_white_facets_are_those_known() {
        // 1 - ln 2, and quadratures to nine digits.
        let known = [
            (1.0, 1.0, 0.306_852_819),
            (1.0, 0.5, 0.450_693_856),
            (1.0, 0.1, 0.760_210_473),
            (0.5, 0.5, 0.698_250_697),
            (0.25, 0.5, 0.857_263_0),
            (0.2, 1.0, 0.947_657_779),
        ];
        for (alpha, mu, expected) in known {
            let desc = MicrofacetsDesc { roughness: f32::sqrt(alpha), ..MicrofacetsDesc::default() };
            let facets = Microfacets::new(&desc).unwrap();
            let white = |_| FacetShares { reflected: 1.0, transmitted: None };
            let found = albedo(&facets, direction(&facets, mu, 0.0), 0.0, white);
            assert!((found - expected).abs() < 3e-5, "alpha {alpha}, cosine {mu}: {found} and not {expected}");
            let missing = MissingEnergy::new(&facets, (0.0, false), white);
            let found = 1.0 - f64::from(missing.at(&facets, direction(&facets, mu, 0.0)));
            assert!((found - expected).abs() < 1e-4, "series, alpha {alpha}, cosine {mu}: {found} and not {expected}");
        }
    }
}
