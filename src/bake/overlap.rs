//! Overlap tests between triangles of a plane.

use std::collections::HashMap;

/// A triangle of a plane.
pub(super) type PlanarTriangle = [[f64; 2]; 3];

/// A triangle that would lie in more cells than this is tested against every time instead.
const MAX_CELLS: i64 = 1024;

/// Triangles in a grid of cells, in which overlaps are found.
pub(super) struct OverlapGrid {
    cell: f64,
    /// Overlaps no deeper than this do not count, because neighbours touch and their corners are rounded.
    tolerance: f64,
    triangles: Vec<(PlanarTriangle, u32)>,
    cells: HashMap<[i64; 2], Vec<u32>>,
    large: Vec<u32>,
}

impl OverlapGrid {
    /// A grid without triangles. `cell`: about the size of most triangles.
    pub(super) fn new(cell: f64, tolerance: f64) -> Self {
        let cell = if cell > 0.0 && cell.is_finite() { cell } else { 1.0 };
        Self { cell, tolerance, triangles: Vec::new(), cells: HashMap::new(), large: Vec::new() }
    }

    /// The number of a triangle that overlaps the given one, if there is one.
    pub(super) fn find_overlap(&self, triangle: &PlanarTriangle) -> Option<u32> {
        let overlaps = |&i: &u32| overlap(&self.triangles[i as usize].0, triangle, self.tolerance);
        let found = match self.cells_of(triangle) {
            Some(cells) => {
                let mut near = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
                near.find(|i| overlaps(i)).or_else(|| self.large.iter().find(|i| overlaps(i))).copied()
            }
            None => (0..self.triangles.len() as u32).find(overlaps),
        };
        found.map(|i| self.triangles[i as usize].1)
    }

    /// Adds a triangle with this number.
    pub(super) fn add(&mut self, triangle: PlanarTriangle, number: u32) {
        let index = self.triangles.len() as u32;
        match self.cells_of(&triangle) {
            Some(cells) => {
                for cell in cells {
                    self.cells.entry(cell).or_default().push(index);
                }
            }
            None => self.large.push(index),
        }
        self.triangles.push((triangle, number));
    }

    /// The cells around a triangle, unless there are too many.
    fn cells_of(&self, triangle: &PlanarTriangle) -> Option<impl Iterator<Item = [i64; 2]> + use<>> {
        let range = |axis: usize| {
            let values = triangle.map(|corner| (corner[axis] / self.cell).floor());
            let [low, high] = [
                values.iter().copied().fold(f64::INFINITY, f64::min),
                values.into_iter().fold(f64::NEG_INFINITY, f64::max),
            ];
            (low as i64, high as i64)
        };
        let ((left, right), (bottom, top)) = (range(0), range(1));
        let count =
            right.saturating_sub(left).saturating_add(1).saturating_mul(top.saturating_sub(bottom).saturating_add(1));
        (count <= MAX_CELLS).then(|| (bottom..=top).flat_map(move |y| (left..=right).map(move |x| [x, y])))
    }
}

/// Whether two triangles overlap by more than `tolerance` in every direction: no side of either separates them.
fn overlap(a: &PlanarTriangle, b: &PlanarTriangle, tolerance: f64) -> bool {
    !separates(a, b, tolerance) && !separates(b, a, tolerance)
}

/// Whether a line along a side of `a` has all of `a` on one side and all of `b` on the other, up to `tolerance`.
fn separates(a: &PlanarTriangle, b: &PlanarTriangle, tolerance: f64) -> bool {
    (0..3).any(|i| {
        let ([x0, y0], [x1, y1], [x2, y2]) = (a[i], a[(i + 1) % 3], a[(i + 2) % 3]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = dx.hypot(dy);
        let distance = |x: f64, y: f64| (dx * (y - y0) - dy * (x - x0)) / length;
        // The third corner is on the inner side.
        let inside = distance(x2, y2).signum();
        b.iter().all(|[x, y]| inside * distance(*x, *y) <= tolerance)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_is_no_overlap() {
        let triangle: PlanarTriangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let beside: PlanarTriangle = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let across: PlanarTriangle = [[0.2, 0.2], [1.0, 1.0], [-3.0, 1.0]];
        let tip: PlanarTriangle = [[0.0, 1.0], [1.0, 2.0], [-1.0, 2.0]];
        let inside: PlanarTriangle = [[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]];
        for (other, expected) in [(beside, false), (across, true), (tip, false), (inside, true), (triangle, true)] {
            for turned in [false, true] {
                let mut other = other;
                if turned {
                    other.swap(0, 2);
                }
                assert_eq!(overlap(&triangle, &other, 1e-9), expected, "{other:?}");
                for cell in [0.05, 0.7, 100.0] {
                    let mut cover = OverlapGrid::new(cell, 1e-9);
                    cover.add(triangle, 7);
                    assert_eq!(cover.find_overlap(&other), expected.then_some(7), "{other:?} {cell}");
                }
            }
        }
    }
}
