//! Form factors of polygons: the fraction of the light leaving one that reaches the other, without occlusion.
//!
//! From a point, the factor is Lambert's closed form in double precision, for the part of the polygon above the
//! horizon. Between two polygons, the factor is the mean of the point's factor over one of them, by adaptive
//! quadrature. The inner integral is exact, so that shared edges, where the kernel 1 / r^2 has a pole, only leave a
//! bounded function with a kink.
//!
//! Sources: Lambert 1760, *Photometria*; Baum, Rushmeier, Winget 1989, "Improving Radiosity Solutions Through the Use
//! of Analytically Determined Form-Factors"; Radon 1948 (the rule of seven points).

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use crate::math::DVec3;

/// Fraction of a hemisphere's cosine-weighted directions at `p` with unit normal `n` that meet a flat convex polygon:
/// the irradiance from a polygon of radiosity 1, on whichever side of it `p` is. The part below the horizon does not
/// count.
///
/// `corners` in order around the edge, of any number from 3. For `p` on the polygon itself or on its edge the value is
/// one of the limits there.
pub fn point_to_polygon(p: DVec3, n: DVec3, corners: &[DVec3]) -> f64 {
    let Some(&last) = corners.last() else { return 0.0 };
    let mut outline = Outline::<false>::begin(p, n, last);
    corners.iter().for_each(|&corner| outline.go_to(corner));
    outline.end().abs().min(1.0)
}

/// Lambert's sum over the edges of an outline, which needs not be flat, for its part above the horizon of a point.
///
/// An outline that `WINDS` may go around more than half of the horizon below it, as that of a wall does which surrounds the point. Its part below
/// is followed along the horizon; the ends of that part alone do not tell which way it went.
pub(super) struct Outline<const WINDS: bool> {
    p: DVec3,
    n: DVec3,
    /// Vector from the point to the corner that was reached, and its height.
    at: (DVec3, f64),
    sum: f64,
    /// Where the outline went below the horizon and has not come back, unless it winds.
    exit: Option<DVec3>,
    /// Where it came up for the first time, if it began below, unless it winds.
    entry: Option<DVec3>,
    /// Whether it was ever above, if it winds.
    is_above: bool,
}

impl<const WINDS: bool> Outline<WINDS> {
    /// Begins at a corner, for a point `p` with unit normal `n`.
    #[inline]
    pub fn begin(p: DVec3, n: DVec3, corner: DVec3) -> Self {
        let at = corner - p;
        Self { p, n, at: (at, at.dot(n)), sum: 0.0, exit: None, entry: None, is_above: false }
    }

    fn go_winding(&mut self, a: DVec3, b: DVec3, [height_a, height_b]: [f64; 2]) {
        let n = self.n;
        let crossing = || a + (height_a / (height_a - height_b)) * (b - a);
        let level = |at: DVec3, height: f64| at - height * n;
        self.is_above |= height_a > 0.0 || height_b > 0.0;
        self.sum += match (height_a > 0.0, height_b > 0.0) {
            (true, true) => edge(a, b, n),
            (true, false) => edge(a, crossing(), n) + edge(crossing(), level(b, height_b), n),
            (false, true) => edge(level(a, height_a), crossing(), n) + edge(crossing(), b, n),
            (false, false) => edge(level(a, height_a), level(b, height_b), n),
        };
    }

    /// Goes to the next corner along a straight edge.
    #[inline]
    pub fn go_to(&mut self, corner: DVec3) {
        let (n, (a, height_a)) = (self.n, self.at);
        let b = corner - self.p;
        let height_b = b.dot(n);
        if WINDS {
            self.go_winding(a, b, [height_a, height_b]);
            self.at = (b, height_b);
            return;
        }
        let crossing = || a + (height_a / (height_a - height_b)) * (b - a);
        match (height_a > 0.0, height_b > 0.0) {
            (true, true) => self.sum += edge(a, b, n),
            (true, false) => {
                let crossing = crossing();
                self.sum += edge(a, crossing, n);
                self.exit = Some(crossing);
            }
            (false, true) => {
                let crossing = crossing();
                self.sum += edge(crossing, b, n);
                match self.exit.take() {
                    // The edge along the horizon.
                    Some(exit) => self.sum += edge(exit, crossing, n),
                    None => self.entry = Some(crossing),
                }
            }
            (false, false) => {}
        }
        self.at = (b, height_b);
    }

    /// The fraction of the hemisphere's cosine-weighted directions that the outline encloses, once it has come back to where it began:
    /// negative where its corners run clockwise, seen from the point.
    #[inline]
    pub fn end(self) -> f64 {
        if WINDS && !self.is_above {
            return 0.0;
        }
        let along_horizon = match (self.exit, self.entry) {
            (Some(exit), Some(entry)) => edge(exit, entry, self.n),
            _ => 0.0,
        };
        // Seen along the normal, angles grow the other way.
        -(self.sum + along_horizon) / TAU
    }
}

/// The term of one edge: its angle, times the cosine between `n` and the normal of the plane through the edge and the
/// point.
#[inline]
fn edge(a: DVec3, b: DVec3, n: DVec3) -> f64 {
    let cross = a.cross(b);
    let sine = cross.length();
    if sine > 0.0 { angle(sine, a.dot(b)) * (cross.dot(n) / sine) } else { 0.0 }
}

/// The angle in [0, pi] whose sine and cosine are proportional to the arguments; `sine` is at least 0 and not both are
/// 0. It equals `sine.atan2(cosine)` up to four times the rounding error of that function, and it is faster: `atan2`
/// took half of a solution's time.
///
/// Source: Moshier 1989, *Methods and Programs for Mathematical Functions* (Cephes, `atan.c`).
#[inline]
fn angle(sine: f64, cosine: f64) -> f64 {
    let adjacent = cosine.abs();
    let is_steep = sine > adjacent;
    let ratio = if is_steep { adjacent / sine } else { sine / adjacent };
    let (t, base) = if ratio > 0.66 { ((ratio - 1.0) / (ratio + 1.0), FRAC_PI_4) } else { (ratio, 0.0) };
    let z = t * t;
    let above = (((-8.750_608_600_031_904e-1 * z - 1.615_753_718_733_365e1) * z - 7.500_855_792_314_705e1) * z
        - 1.228_866_684_490_136_2e2)
        * z
        - 6.485_021_904_942_025e1;
    let below = ((((z + 2.485_846_490_142_306_3e1) * z + 1.650_270_098_316_988_5e2) * z + 4.328_810_604_912_902_7e2)
        * z
        + 4.853_903_996_359_137e2)
        * z
        + 1.945_506_571_482_614e2;
    let acute = base + (t + t * (z * above / below));
    let acute = if is_steep { FRAC_PI_2 - acute } else { acute };
    if cosine < 0.0 { PI - acute } else { acute }
}

/// The factor of [`point_to_polygon`] for the front of a polygon with unit normal `facing`: 0 for a point behind it.
#[inline]
pub(super) fn point_to_front(p: DVec3, n: DVec3, corners: &[DVec3], facing: DVec3) -> f64 {
    if (p - corners[0]).dot(facing) > 0.0 { point_to_polygon(p, n, corners) } else { 0.0 }
}

/// The form factor F12 of two flat convex polygons, on the sides from which their corners run counter-clockwise: the
/// fraction of the light leaving `from` that reaches `to`.
///
/// `tolerance`: absolute error of the result. The function evaluates [`point_to_polygon`] at most about ten thousand
/// times; polygons without area have factor 0.
pub fn polygon_to_polygon(from: &[DVec3], to: &[DVec3], tolerance: f64) -> f64 {
    let (Some((n, area)), Some((facing, other))) = (plane(from), plane(to)) else { return 0.0 };
    // The integral over the smaller polygon includes all visible parts of the larger one; the other order might miss
    // some.
    if area <= other {
        mean_over(from, area, &|p| point_to_front(p, n, to, facing), tolerance)
    } else {
        let scale = other / area;
        scale * mean_over(to, other, &|p| point_to_front(p, facing, from, n), tolerance / scale)
    }
}

/// Mean of `f` over a polygon with this area.
fn mean_over(polygon: &[DVec3], area: f64, f: &impl Fn(DVec3) -> f64, tolerance: f64) -> f64 {
    let fan = (2..polygon.len()).map(|i| [polygon[0], polygon[i - 1], polygon[i]]);
    fan.map(|t| triangle_area(&t) / area * mean(f, &t, tolerance, MAX_HALVINGS)).sum()
}

pub(super) fn triangle_area(t: &[DVec3; 3]) -> f64 {
    0.5 * (t[1] - t[0]).cross(t[2] - t[0]).length()
}

/// Unit normal of a flat polygon, on the side from which its corners run counter-clockwise; `None` where the polygon
/// has no area.
pub(super) fn normal(corners: &[DVec3]) -> Option<DVec3> {
    plane(corners).map(|(normal, _)| normal)
}

/// Unit normal and area.
fn plane(corners: &[DVec3]) -> Option<(DVec3, f64)> {
    let first = *corners.first()?;
    let cross: DVec3 = corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    Some((cross.try_normalize()?, 0.5 * cross.length()))
}

/// Most levels of the adaptive quadrature.
const MAX_HALVINGS: u32 = 12;

/// Radon's rule of degree five: barycentric coordinates and weight for two groups of three points, besides the centre.
const RADON: [(f64, f64, f64); 2] = [
    (0.059_715_871_789_769_82, 0.470_142_064_105_115_1, 0.132_394_152_788_506_16),
    (0.797_426_985_353_087_2, 0.101_286_507_323_456_34, 0.125_939_180_544_827_15),
];

/// Mean of `f` over a triangle. `tolerance`: allowed absolute error. `halvings`: levels of subdivision that are left.
pub(super) fn mean(f: &impl Fn(DVec3) -> f64, triangle: &[DVec3; 3], tolerance: f64, halvings: u32) -> f64 {
    let whole = rule(f, triangle);
    refine(f, triangle, whole, tolerance, halvings)
}

fn rule(f: &impl Fn(DVec3) -> f64, triangle: &[DVec3; 3]) -> f64 {
    let (places, weights) = places(triangle);
    places.into_iter().zip(weights).map(|(p, weight)| weight * f(p)).sum()
}

/// The points of Radon's rule in a triangle, and their weights.
pub(super) fn places(&[a, b, c]: &[DVec3; 3]) -> ([DVec3; 7], [f64; 7]) {
    let [(o, p, w), (q, r, v)] = RADON;
    let at =
        |one: f64, others: f64| [one * a + others * (b + c), one * b + others * (c + a), one * c + others * (a + b)];
    let ([d, e, f], [g, h, i]) = (at(o, p), at(q, r));
    ([(a + b + c) / 3.0, d, e, f, g, h, i], [0.225, w, w, w, v, v, v])
}

fn refine(f: &impl Fn(DVec3) -> f64, triangle: &[DVec3; 3], whole: f64, tolerance: f64, halvings: u32) -> f64 {
    if halvings == 0 {
        return whole;
    }
    let parts = quarters(triangle);
    let means = parts.each_ref().map(|part| rule(f, part));
    let finer = 0.25 * means.iter().sum::<f64>();
    // The finer value is far more accurate than the difference says; larger errors remain only where the function has a
    // kink.
    if (finer - whole).abs() <= 4.0 * tolerance {
        return finer;
    }
    // The errors of the quarters are nearly independent, so each may have twice its part of the tolerance.
    0.25 * (0..4).map(|i| refine(f, &parts[i], means[i], 2.0 * tolerance, halvings - 1)).sum::<f64>()
}

/// The four triangles between the corners and the middles of the sides: those at the three corners, and the middle one.
pub(super) fn quarters(&[a, b, c]: &[DVec3; 3]) -> [[DVec3; 3]; 4] {
    let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_standard_library() {
        let mut worst = 0.0_f64;
        for i in 0..200_000 {
            // All angles, and angles close to both ends of the range.
            let exact = PI * f64::from(i) / 200_000.0;
            for turn in [exact, exact * 1e-9, exact.powi(4) / PI.powi(3)] {
                for (sine, cosine) in [(turn.sin(), turn.cos()), (1e-150 * turn.sin(), -1e-150 * turn.cos())] {
                    let expected = sine.atan2(cosine);
                    worst = worst.max((angle(sine, cosine) - expected).abs() / expected.max(f64::MIN_POSITIVE));
                }
            }
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
    }
}
