//! Directional albedos of rough surfaces by quadrature, and series in the cosine.

use std::sync::LazyLock;

use super::{Distribution, Microfacets};
use crate::math::{DVec3, Vec3};

/// Terms of a series in the cosine.
const TERMS: usize = 24;

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

/// As [`average`], for three functions at once.
pub fn average_of(f: impl Fn(f64) -> DVec3) -> DVec3 {
    GAUSS.iter().map(|(t, weight)| weight * 4.0 * t * t * t * f(t * t)).sum()
}

/// Nodes in [0, 1] and weights of Gauss and Legendre's rule.
static GAUSS: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss(96));

/// As [`GAUSS`], with few nodes that are dense at both ends, where functions may be roots.
static BETWEEN: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    let nodes = gauss(16).into_iter();
    nodes.map(|(x, weight)| (x * x * (3.0 - 2.0 * x), weight * 6.0 * x * (1.0 - x))).collect()
});

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

/// An interval, cut where a function has edges.
struct Edges {
    at: [f64; 6],
    pieces: usize,
}

impl Edges {
    /// The interval is cut at the roots of these quadratic polynomials (highest coefficient first), mapped by `to`.
    fn new((low, high): (f64, f64), polynomials: [[f64; 3]; 2], to: impl Fn(f64) -> f64) -> Self {
        let (mut at, mut pieces) = ([high; 6], 1);
        at[0] = low;
        for [a, b, c] in polynomials {
            let inside = b * b - 4.0 * a * c;
            if inside <= 0.0 {
                continue;
            }
            // Without a difference of what is nearly the same.
            let sum = -0.5 * (b + inside.sqrt().copysign(b));
            for root in [sum / a, c / sum] {
                let root = to(root);
                if root > low && root < high {
                    at[pieces] = root;
                    pieces += 1;
                }
            }
        }
        at[1..pieces].sort_unstable_by(f64::total_cmp);
        Self { at, pieces }
    }

    /// Calls `f` with the nodes and weights of [`BETWEEN`] in every piece.
    fn each(&self, mut f: impl FnMut(f64, f64)) {
        for ends in self.at[..=self.pieces].windows(2) {
            let wide = ends[1] - ends[0];
            for (t, weight) in BETWEEN.iter() {
                f(ends[0] + wide * t, weight * wide);
            }
        }
    }
}

/// The mean of `f` over the facets that are seen from `wo`, which is in the facets' frame. `f` may have edges where facets
/// begin to reflect totally, at the cosine `critical` (0 if they do not), and where they reflect along the horizon.
///
/// In the stretched frame slopes p towards `wo` and q across have the density max(0, cos + sin p) times exp(-p^2 - q^2) for
/// Beckmann's facets, (1 + p^2 + q^2)^-2 for Trowbridge and Reitz's; all up to a factor. For each p, the edges lie at roots q
/// of quadratic equations, and `f` is smooth between them.
fn over_visible_normals(facets: &Microfacets, wo: Vec3, critical: f64, f: impl Fn(Vec3) -> f64) -> f64 {
    use std::f64::consts::FRAC_PI_2;
    let [ax, ay] = facets.alpha.map(f64::from);
    let wo = wo.as_dvec3();
    let stretched = DVec3::new(ax * wo.x, ay * wo.y, wo.z);
    let length = stretched.length();
    let (sin, cos) = (stretched.x.hypot(stretched.y) / length, stretched.z / length);
    let (c, s) = if sin > 0.0 { (stretched.x / (length * sin), stretched.y / (length * sin)) } else { (1.0, 0.0) };
    let is_ggx = facets.distribution == Distribution::Ggx;
    // 1 + the squared slope is square q^2 + mixed p q + 1 + rest p^2. With N = length (cos + sin p) it is (N / critical)^2 and
    // 2 N / cos(wo) at the edges; the equation has one root q at the lowest and highest p of an edge.
    let square = ax * ax * s * s + ay * ay * c * c;
    let mixed = 2.0 * c * s * (ay * ay - ax * ax);
    let rest = ax * ax * c * c + ay * ay * s * s;
    let level = if critical > 0.0 { (length / critical).powi(2) } else { 0.0 };
    let below = 0.25 * mixed * mixed - square * rest;
    // p = tan a.
    let outer = Edges::new(
        (-cos.min(1.0).asin(), FRAC_PI_2),
        [
            [below + square * level * sin * sin, 2.0 * square * level * cos * sin, square * (level * cos * cos - 1.0)],
            [below, 2.0 * square * length * sin / wo.z, square],
        ],
        f64::atan,
    );
    let (mut sum, mut whole) = (0.0, 0.0);
    outer.each(|a, weight| {
        let (sine, cosine) = a.sin_cos();
        let cosine = cosine.max(1e-15);
        let p = sine / cosine;
        let seen = (cos + sin * p).max(0.0);
        // Across, the slope is q = root y / sqrt(1 - y^2).
        let (root, density) = match facets.distribution {
            Distribution::Ggx => (1.0 / cosine, seen * cosine),
            Distribution::Beckmann => (1.0, seen * (-p * p).exp() / (cosine * cosine)),
        };
        let weight = weight * density;
        let (linear, rest) = (mixed * p, 1.0 + rest * p * p);
        let inner = Edges::new(
            // Where widths are equal, both halves are alike.
            (if facets.is_anisotropic() { -1.0 } else { 0.0 }, 1.0),
            [[square, linear, rest - level * seen * seen], [square, linear, rest - 2.0 * length * seen / wo.z]],
            |q| q / root.hypot(q),
        );
        inner.each(|y, part| {
            let below = ((1.0 - y) * (1.0 + y)).max(1e-30);
            let root_below = below.sqrt();
            let across = y / root_below;
            let density =
                weight * part * if is_ggx { root_below } else { (-across * across).exp() / (below * root_below) };
            if density > 0.0 {
                let q = root * across;
                let m = DVec3::new(ax * (c * p - s * q), ay * (s * p + c * q), 1.0).normalize();
                sum += density * f(m.as_vec3a());
                whole += density;
            }
        });
    });
    sum / whole
}

/// What a facet with its normal at this cosine to the light reflects and transmits, and the index of refraction of the far
/// side over that of the near side where it transmits.
pub struct FacetShares {
    /// Share that is reflected.
    pub reflected: f64,
    /// Share that is transmitted, and the relative index.
    pub transmitted: Option<(f64, f64)>,
}

/// The share of the light from `wo` that leaves the surface again after a single facet. `shares` says what a facet does, and
/// `critical` is the cosine at which it begins to reflect totally (0 if it does not). The facets are not turned.
pub(super) fn albedo(facets: &Microfacets, wo: Vec3, critical: f64, shares: impl Fn(f64) -> FacetShares) -> f64 {
    let seen = f64::from(1.0 / (1.0 + facets.lambda(wo)));
    over_visible_normals(facets, wo, critical, |m| {
        let cos = wo.dot(m);
        if cos <= 0.0 {
            return 0.0;
        }
        let shares = shares(f64::from(cos));
        let mut sum = 0.0;
        let wi = 2.0 * cos * m - wo;
        if wi.z > 0.0 {
            sum += shares.reflected * f64::from(facets.reflection_masking(wo, wi, m).1) / seen;
        }
        if let Some((transmitted, eta)) = shares.transmitted
            && let Some(wi) = super::super::local::refract_about(wo, m, eta)
            && wi.z < 0.0
        {
            let mirrored = Vec3::new(wi.x, wi.y, -wi.z);
            sum += transmitted * f64::from(facets.transmission_masking(wo, mirrored, m).1) / seen;
        }
        sum
    })
}

/// The direction at this cosine in the facets' own frame, turned by `phi`.
pub(super) fn direction(facets: &Microfacets, mu: f64, phi: f64) -> Vec3 {
    let sin = (1.0 - mu * mu).max(0.0).sqrt();
    facets.out_of_facets(Vec3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, mu.max(1e-7) as f32))
}
