//! Texels that a triangle covers, and the covered part of each.

use super::chart::bounds;
use super::mesh_uvs::doubled_area;
use super::overlap::PlanarTriangle;
use crate::Result;
use crate::control::WorkProgress;

/// Most corners of a triangle clipped to a texel.
const MAX_CORNERS: usize = 8;

/// Covered parts smaller than this do not count: they are rounding errors where a side runs along a row of texels. For
/// triangles smaller than a texel, this is a fraction of the triangle's area.
const MIN_AREA: f64 = 1e-9;

/// A triangle with less area in the map is rasterized as a right triangle with legs of this length, because double
/// precision cannot clip its shape.
const SPECK_AREA: f64 = 1e-15;
const SPECK_LEG: f64 = 1e-6;

/// The triangle that is rasterized in place of a given one, so that even the smallest has a texel. It is the given
/// triangle, unless that is a speck; a speck becomes a triangle that can be clipped, in the texel of its first corner.
///
/// `triangle`: in texels. `end`: upper limits of its coordinates, whole numbers of texels.
pub(super) fn rasterizable(triangle: PlanarTriangle, end: [f64; 2]) -> PlanarTriangle {
    // The comparison is written so that a triangle with NaN is a speck.
    if 0.5 * doubled_area(&triangle).abs() >= SPECK_AREA {
        return triangle;
    }
    let [x, y] = [0, 1].map(|axis| {
        let texel = triangle[0][axis].floor().min(end[axis] - 1.0);
        triangle[0][axis].clamp(texel, texel + 1.0 - SPECK_LEG)
    });
    [[x, y], [x + SPECK_LEG, y], [x, y + SPECK_LEG]]
}

/// A convex polygon.
#[derive(Clone, Copy)]
pub(super) struct Polygon {
    corners: [[f64; 2]; MAX_CORNERS],
    count: usize,
    /// Area below which parts do not count.
    least: f64,
}

impl Polygon {
    fn new(triangle: &PlanarTriangle) -> Self {
        let mut corners = [[0.0; 2]; MAX_CORNERS];
        corners[..3].copy_from_slice(triangle);
        Self { corners, count: 3, least: MIN_AREA * (0.5 * doubled_area(triangle).abs()).min(1.0) }
    }

    pub(super) fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.count]
    }

    /// The part of the polygon above (`sign` 1) or below (-1) a value of a coordinate.
    ///
    /// Source: Sutherland and Hodgman 1974, "Reentrant Polygon Clipping".
    fn clipped(&self, axis: usize, value: f64, sign: f64) -> Self {
        let mut clipped = Self { corners: [[0.0; 2]; MAX_CORNERS], count: 0, least: self.least };
        let mut add = |corner: [f64; 2]| {
            if clipped.count < MAX_CORNERS {
                clipped.corners[clipped.count] = corner;
                clipped.count += 1;
            }
        };
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (da, db) = (sign * (a[axis] - value), sign * (b[axis] - value));
            if da >= 0.0 {
                add(a);
            }
            if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
                let t = da / (da - db);
                let mut corner = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                corner[axis] = value;
                add(corner);
            }
        }
        clipped
    }

    /// The polygon as a fan of triangles, with the area of each (> 0) [texels].
    pub(super) fn fan(&self) -> impl Iterator<Item = (PlanarTriangle, f64)> + '_ {
        (2..self.count).filter_map(|i| {
            let part = [self.corners[0], self.corners[i - 1], self.corners[i]];
            let area = 0.5 * doubled_area(&part).abs();
            (area > self.least).then_some((part, area))
        })
    }
}

/// Calls `visit` with each texel (column, row) that a triangle covers partly, and the covered part; rows in order, and
/// columns in order in each row.
///
/// `triangle`: in texels, at coordinates >= 0 and below 2^31.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`].
pub(super) fn for_each_texel(
    triangle: &PlanarTriangle,
    progress: &WorkProgress,
    mut visit: impl FnMut([u32; 2], &Polygon),
) -> Result<()> {
    let whole = Polygon::new(triangle);
    let [[_, low], [_, high]] = bounds(triangle.iter().copied());
    for row in low as u32..=high as u32 {
        progress.check()?;
        let strip = whole.clipped(1, f64::from(row), 1.0).clipped(1, f64::from(row) + 1.0, -1.0);
        if strip.count < 3 {
            continue;
        }
        let [[left, _], [right, _]] = bounds(strip.corners().iter().copied());
        for column in left as u32..=right as u32 {
            let part = strip.clipped(0, f64::from(column), 1.0).clipped(0, f64::from(column) + 1.0, -1.0);
            if part.count >= 3 && part.fan().next().is_some() {
                visit([column, row], &part);
            }
        }
    }
    Ok(())
}

/// Barycentric weights of a triangle's second and third corner at a point of it.
pub(super) fn weights(triangle: &PlanarTriangle, p: [f64; 2]) -> [f32; 2] {
    let [a, b, c] = triangle;
    let whole = doubled_area(triangle);
    let b1 = doubled_area(&[*a, p, *c]) / whole;
    let b2 = doubled_area(&[*a, *b, p]) / whole;
    let (b1, b2) = (b1.clamp(0.0, 1.0), b2.clamp(0.0, 1.0));
    let sum = (b1 + b2).max(1.0);
    [(b1 / sum) as f32, (b2 / sum) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cancel;
    use crate::sampling::Rng;

    #[test]
    fn parts_add_up_to_the_triangle() {
        let mut rng = Rng::new(8, 0);
        for size in [0.3, 3.0, 40.0] {
            for _ in 0..200 {
                let mut corner = || [0.0; 2].map(|_| f64::from(rng.next_f32()) * size + 1.0);
                let triangle = [corner(), corner(), corner()];
                let mut sum = 0.0;
                for_each_texel(&triangle, &WorkProgress::new(&Cancel::new()), |[x, y], part| {
                    for (fan, area) in part.fan() {
                        sum += area;
                        for p in fan {
                            assert!((f64::from(x)..=f64::from(x) + 1.0).contains(&p[0]), "{p:?} is not in {x}");
                            assert!((f64::from(y)..=f64::from(y) + 1.0).contains(&p[1]), "{p:?} is not in {y}");
                            // The weights reproduce the point.
                            let [b1, b2] = weights(&triangle, p).map(f64::from);
                            let again = [0, 1].map(|i| {
                                let [a, b, c] = triangle.map(|corner| corner[i]);
                                a + b1 * (b - a) + b2 * (c - a)
                            });
                            let off = (again[0] - p[0]).hypot(again[1] - p[1]);
                            assert!(off < 1e-5 * size, "{again:?} and {p:?}");
                        }
                    }
                })
                .unwrap();
                let area = 0.5 * doubled_area(&triangle).abs();
                assert!((sum - area).abs() < 1e-6 * size * size, "{sum} of {area}");
            }
        }
    }

    #[test]
    fn texels_beside_a_side_are_not_covered() {
        let mut found = Vec::new();
        let triangle = [[1.0, 1.0], [3.0, 1.0], [1.0, 3.0]];
        for_each_texel(&triangle, &WorkProgress::new(&Cancel::new()), |texel, _| found.push(texel)).unwrap();
        assert_eq!(found, [[1, 1], [2, 1], [1, 2]]);
    }
}
