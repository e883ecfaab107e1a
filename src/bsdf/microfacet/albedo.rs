//! Directional albedos of rough surfaces, integrated once for a material and stored as short series.
//!
//! Light that one facet reflects onto another is not in the models of single scattering, which are therefore too dark. What
//! is missing, 1 - E(w), is what [`MissingEnergy`] stores, and models give it back as Kulla and Conty do.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use super::{Distribution, Masking, Microfacets};
use crate::math::Vec3;

/// Terms of a series in the cosine.
const TERMS: usize = 24;

/// Terms of a series in the azimuth, for facets of two widths.
const TURNS: usize = 8;

/// A function of the cosine in [0, 1] to the normal, as a Chebyshev series.
///
/// The series is in sqrt(mu (1 + c) / (mu + c)), where c is twice the facets' width: albedos change at angles over the horizon
/// as small as the slopes of the facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlbedoCurve {
    coefficients: [f32; TERMS],
    warp: f32,
}

impl AlbedoCurve {
    /// The curve through the values of `f` at the nodes of the series. `width` is the facets' alpha.
    pub fn new(width: f32, f: impl Fn(f64) -> f64) -> Self {
        let warp = f64::from(2.0 * width);
        let n = TERMS as f64;
        let angle = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / n;
        let values: [f64; TERMS] = std::array::from_fn(|k| {
            let x = 0.5 * (angle(k).cos() + 1.0);
            f(x * x * warp / (1.0 + warp - x * x))
        });
        let coefficients = std::array::from_fn(|j| {
            let sum: f64 = values.iter().enumerate().map(|(k, value)| value * (j as f64 * angle(k)).cos()).sum();
            (sum * if j == 0 { 1.0 } else { 2.0 } / n) as f32
        });
        Self { coefficients, warp: warp as f32 }
    }

    /// 0 everywhere.
    pub const fn zero() -> Self {
        Self { coefficients: [0.0; TERMS], warp: 1.0 }
    }

    /// The value at this cosine, in [0, 1].
    #[inline]
    pub fn at(&self, mu: f32) -> f32 {
        let x = (mu * (1.0 + self.warp) / (mu + self.warp)).sqrt();
        clenshaw(&self.coefficients, 2.0 * x - 1.0).clamp(0.0, 1.0)
    }

    /// The mean over directions of a hemisphere weighed by their cosines.
    pub fn mean(&self) -> f32 {
        average(|mu| f64::from(self.at(mu as f32))) as f32
    }
}

/// Sum of a Chebyshev series at x in [-1, 1].
#[inline]
fn clenshaw<const N: usize>(coefficients: &[f32; N], x: f32) -> f32 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for c in coefficients[1..].iter().rev() {
        (b1, b2) = (2.0 * x * b1 - b2 + c, b1);
    }
    x * b1 - b2 + coefficients[0]
}

/// The mean of a function of the cosine over the directions of a hemisphere, weighed by their cosines: 2 times the integral
/// of f(mu) mu.
pub fn average(f: impl Fn(f64) -> f64) -> f64 {
    // In t with mu = t^2, since albedos change most near the horizon.
    GAUSS.iter().map(|(t, weight)| weight * 4.0 * t * t * t * f(t * t)).sum()
}

/// Nodes in [0, 1] and weights of Gauss and Legendre's rule.
static GAUSS: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss(96));

/// Nodes for the other number that chooses a facet.
const ACROSS: usize = 40;

fn gauss(n: usize) -> Vec<(f64, f64)> {
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..8 {
            let (mut p0, mut p1) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
            }
            slope = n as f64 * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// The mean of `f` over the facets that are seen from `wo`.
///
/// Slopes of facets are unbounded at an end of the unit square of random numbers, where the rule's points are densest.
fn over_visible_normals(facets: &Microfacets, wo: Vec3, f: impl Fn(Vec3) -> f64) -> f64 {
    let mut sum = 0.0;
    // Turned normals are as many on either side of the plane of incidence only where widths are equal.
    let half = if facets.is_anisotropic() { 1.0 } else { 0.5 };
    for (t, weight) in GAUSS.iter() {
        for i in 0..ACROSS {
            // A function of the angle is periodic, and midpoints are as good as any rule.
            let (s, turn) = ((i as f64 + 0.5) / ACROSS as f64, 1.0 / ACROSS as f64);
            let (u, density) = match facets.distribution {
                Distribution::Ggx => ([half * s, 1.0 - t * t], 2.0 * t),
                Distribution::Beckmann => {
                    let ends = |x: f64| {
                        (
                            0.5 - 0.5 * (std::f64::consts::PI * x).cos(),
                            std::f64::consts::FRAC_PI_2 * (std::f64::consts::PI * x).sin(),
                        )
                    };
                    let ((a, da), (b, db)) = (ends(*t), ends(s));
                    ([a, b], da * db)
                }
            };
            let m = facets.visible_normal(wo, &mut [u[0] as f32, u[1] as f32, 0.5]);
            sum += weight * turn * density * f(m);
        }
    }
    sum
}

/// What a facet with its normal at this cosine to the light reflects and transmits, and the index of refraction of the far
/// side over that of the near side where it transmits.
pub struct FacetShares {
    /// Share that is reflected.
    pub reflected: f64,
    /// Share that is transmitted, and the relative index.
    pub transmitted: Option<(f64, f64)>,
}

/// The share of the light from `wo` that leaves the surface again after a single facet. `shares` says what a facet does.
fn albedo(facets: &Microfacets, wo: Vec3, shares: impl Fn(f64) -> FacetShares) -> f64 {
    let seen = f64::from(1.0 / (1.0 + facets.lambda(wo)));
    over_visible_normals(facets, wo, |m| {
        let cos = wo.dot(m);
        if cos <= 0.0 {
            return 0.0;
        }
        let shares = shares(f64::from(cos));
        let mut sum = 0.0;
        let wi = 2.0 * cos * m - wo;
        if wi.z > 0.0 {
            sum += shares.reflected * f64::from(facets.g2_reflection(wo, wi, m)) / seen;
        }
        if let Some((transmitted, eta)) = shares.transmitted
            && let Some(wi) = super::super::local::refract_about(wo, m, eta)
            && wi.z < 0.0
        {
            let mirrored = Vec3::new(wi.x, wi.y, -wi.z);
            sum += transmitted * f64::from(facets.g2_transmission(wo, mirrored, m)) / seen;
        }
        sum
    })
}

/// The direction at this cosine in the facets' own frame, turned by `phi`.
fn direction(facets: &Microfacets, mu: f64, phi: f64) -> Vec3 {
    let sin = (1.0 - mu * mu).max(0.0).sqrt();
    facets.out_of_facets(Vec3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, mu.max(1e-7) as f32))
}

/// What single scattering loses in each direction, 1 - E(w): nothing, a function of the angle to the normal, or of the
/// azimuth too.
#[derive(Clone, Debug, PartialEq)]
pub enum MissingEnergy {
    /// Facets of one width.
    Isotropic {
        /// 1 - E by the cosine.
        curve: AlbedoCurve,
        /// Its mean, weighed by the cosine.
        mean: f32,
    },
    /// Facets of two widths.
    Anisotropic(Arc<AnisotropicMissing>),
}

/// See [`MissingEnergy::Anisotropic`].
#[derive(Debug, PartialEq)]
pub struct AnisotropicMissing {
    /// Curves whose values are the coefficients of a Chebyshev series in cos(2 phi).
    curves: [AlbedoCurve; TURNS],
    mean: f32,
}

/// What is asked of a rough surface, as a key: distribution, masking, widths, and the bits of the index of refraction.
type Key = (Distribution, Masking, [u32; 2], u64, bool);

/// Series that were integrated before, by the parameters they depend on. Emptied when full.
static KNOWN: LazyLock<Mutex<HashMap<Key, MissingEnergy>>> = LazyLock::new(Mutex::default);

/// Most series that are remembered, of 100 bytes each.
const MOST_KNOWN: usize = 4096;

impl MissingEnergy {
    /// 1 - E of these facets. `index` is the index of refraction that the shares depend on, 0 where they depend on none, and
    /// `transmits` whether they transmit: both distinguish what is remembered.
    pub fn new(facets: &Microfacets, (index, transmits): (f64, bool), shares: impl Fn(f64) -> FacetShares) -> Self {
        // The angle by which facets are turned does not matter here.
        let facets = Microfacets { turn: [1.0, 0.0], ..*facets };
        let key = (facets.distribution, facets.masking, facets.alpha.map(f32::to_bits), index.to_bits(), transmits);
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known().get(&key) {
            return found.clone();
        }
        let missing = |mu: f64, phi: f64| (1.0 - albedo(&facets, direction(&facets, mu, phi), &shares)).max(0.0);
        let width = 0.5 * (facets.alpha[0] + facets.alpha[1]);
        let made = if facets.is_anisotropic() {
            let n = TURNS as f64;
            let angle = |j: usize| std::f64::consts::PI * (j as f64 + 0.5) / n;
            let samples: Vec<AlbedoCurve> =
                (0..TURNS).map(|j| AlbedoCurve::new(width, |mu| missing(mu, 0.5 * angle(j)))).collect();
            let curves = std::array::from_fn(|k| {
                let coefficients = std::array::from_fn(|i| {
                    let sum: f64 = samples
                        .iter()
                        .enumerate()
                        .map(|(j, curve)| f64::from(curve.coefficients[i]) * (k as f64 * angle(j)).cos())
                        .sum();
                    (sum * if k == 0 { 1.0 } else { 2.0 } / n) as f32
                });
                AlbedoCurve { coefficients, warp: samples[0].warp }
            });
            // The mean over azimuths of a series in cos(2 phi) is its first coefficient.
            let mean = average(|mu| f64::from(curves[0].at(mu as f32))) as f32;
            Self::Anisotropic(Arc::new(AnisotropicMissing { curves, mean }))
        } else {
            let curve = AlbedoCurve::new(width, |mu| missing(mu, 0.0));
            Self::Isotropic { mean: curve.mean(), curve }
        };
        let mut known = known();
        if known.len() >= MOST_KNOWN {
            known.clear();
        }
        known.insert(key, made.clone());
        made
    }

    /// 1 - E of a direction of the local frame of the facets; the sign of its cosine does not matter.
    #[inline]
    pub fn at(&self, facets: &Microfacets, w: Vec3) -> f32 {
        match self {
            Self::Isotropic { curve, .. } => curve.at(w.z.abs()),
            Self::Anisotropic(it) => {
                let own = facets.in_facets(w);
                let (x2, y2) = (own.x * own.x, own.y * own.y);
                let sum = x2 + y2;
                let cos2 = if sum > 0.0 { (x2 - y2) / sum } else { 0.0 };
                let warp = it.curves[0].warp;
                let mu = w.z.abs();
                let x = 2.0 * (mu * (1.0 + warp) / (mu + warp)).sqrt() - 1.0;
                let turns: [f32; TURNS] = std::array::from_fn(|k| clenshaw(&it.curves[k].coefficients, x));
                clenshaw(&turns, cos2).clamp(0.0, 1.0)
            }
        }
    }

    /// The mean of 1 - E over the hemisphere, weighed by the cosine.
    #[inline]
    pub fn mean(&self) -> f32 {
        match self {
            Self::Isotropic { mean, .. } => *mean,
            Self::Anisotropic(it) => it.mean,
        }
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
            let found = albedo(&facets, direction(&facets, mu, 0.0), white);
            assert!((found - expected).abs() < 3e-4, "alpha {alpha}, cosine {mu}: {found} and not {expected}");
            let missing = MissingEnergy::new(&facets, (0.0, false), white);
            let found = 1.0 - f64::from(missing.at(&facets, direction(&facets, mu, 0.0)));
            assert!((found - expected).abs() < 5e-4, "series, alpha {alpha}, cosine {mu}: {found} and not {expected}");
        }
    }
}
