//! Points of the unit square with a density that is bilinear between given values: what light from an image is sampled by.

use super::Distribution1D;
use crate::{Cancel, Result};

/// A density over [0, 1)^2 that is bilinear between values at points of a grid, as an image of the sphere by longitude and latitude has
/// them.
///
/// Columns lie at the centres of texels and go around: after the last one comes the first. Rows lie at the centres of texels too; beyond
/// the first and the last, at y = 0 and y = 1, the density is 0.
///
/// The cell between four points is chosen in proportion to its integral, first by its row and then by its column, and the point in it
/// by inverting the bilinear function, so that the density is exactly that of the points that come. The order of numbers is kept:
/// points that are spread evenly stay so.
#[derive(Clone, Debug)]
pub struct BilinearGrid {
    columns: usize,
    /// Densities at the points, row by row, without the rows at y = 0 and y = 1.
    values: Vec<f32>,
    rows: Distribution1D,
    /// The cells of each row; `None` where all of them are 0.
    cells: Vec<Option<Distribution1D>>,
}

/// A sampled point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSample {
    /// x to the right, y down, in [0, 1).
    pub at: [f32; 2],
    /// The density with which the point comes, per area of the unit square.
    pub pdf: f32,
}

/// A point between four points of the grid.
struct Place {
    columns: [usize; 2],
    /// Rows of cells; row 0 lies above the first row of points.
    row: usize,
    /// Shares of the right and of the lower point.
    shares: [f32; 2],
}

impl BilinearGrid {
    /// The density in proportion to these values >= 0, row by row, `columns` in each. `None` where all are 0, one is not a number from 0
    /// on, or single precision does not hold their ratio to the mean.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn new(columns: usize, mut values: Vec<f32>, cancel: &Cancel) -> Result<Option<Self>> {
        if columns == 0 || values.is_empty() || !values.len().is_multiple_of(columns) {
            return Ok(None);
        }
        let points = values.len() / columns;
        let mut cells = Vec::with_capacity(points + 1);
        let mut masses = Vec::with_capacity(points + 1);
        let mut row = Vec::with_capacity(columns);
        for y in 0..=points {
            let [upper, lower] = [y.checked_sub(1), (y < points).then_some(y)]
                .map(|point| point.map(|point| &values[point * columns..][..columns]));
            let column = |x: usize| {
                let of = |row: Option<&[f32]>| row.map_or(0.0, |row| f64::from(row[x % columns]));
                of(upper) + of(lower)
            };
            row.clear();
            row.extend((0..columns).map(|x| 0.25 * (column(x) + column(x + 1))));
            let height = if y == 0 || y == points { 0.5 } else { 1.0 } / points as f64;
            let distribution = Distribution1D::cancellable(&row, cancel)?;
            masses.push(distribution.as_ref().map_or(0.0, |it| it.total() * height / columns as f64));
            cells.push(distribution);
        }
        if values.iter().any(|value| !(value.is_finite() && *value >= 0.0)) {
            return Ok(None);
        }
        let Some(rows) = Distribution1D::cancellable(&masses, cancel)? else { return Ok(None) };
        for value in &mut values {
            *value = (f64::from(*value) / rows.total()) as f32;
        }
        let holds = values.iter().all(|value| value.is_finite());
        Ok(holds.then_some(Self { columns, values, rows, cells }))
    }

    /// Columns and rows of points.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.points()]
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        // A number and a place of a guide for each cell.
        self.values.len() * (size_of::<f32>() + size_of::<f64>() + size_of::<u32>())
    }

    fn points(&self) -> usize {
        self.values.len() / self.columns
    }

    /// A point; `u` uniform in [0, 1)^2.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> GridSample {
        let (row, _, v) = self.rows.sample(u[1]);
        // Rows of no light are never chosen.
        let Some(cells) = &self.cells[row] else { return GridSample { at: [0.0; 2], pdf: 0.0 } };
        let (column, _, u) = cells.sample(u[0]);
        let [[a, b], [c, d]] = self.corners([column, (column + 1) % self.columns], row);
        let t = linear(v, a + b, c + d);
        let (left, right) = (a + t * (c - a), b + t * (d - b));
        let s = linear(u, left, right);
        let points = self.points() as f32;
        let y = if row == 0 { 0.5 * t } else { row as f32 - 0.5 + if row == self.points() { 0.5 * t } else { t } };
        let x = (column as f32 + 0.5 + s) / self.columns as f32;
        let x = if x >= 1.0 { x - 1.0 } else { x };
        GridSample { at: [x, (y / points).min(1.0_f32.next_down())], pdf: left + s * (right - left) }
    }

    /// The density of a point of the unit square.
    #[inline]
    pub fn pdf(&self, at: [f32; 2]) -> f32 {
        let Place { columns, row, shares: [s, t] } = self.place(at);
        let [[a, b], [c, d]] = self.corners(columns, row);
        let (left, right) = (a + t * (c - a), b + t * (d - b));
        left + s * (right - left)
    }

    fn place(&self, [x, y]: [f32; 2]) -> Place {
        let points = self.points();
        let x = x * self.columns as f32 - 0.5;
        let column = x.floor();
        let columns = [0, 1].map(|i| (column as i64 + i).rem_euclid(self.columns as i64) as usize);
        let y = (y * points as f32 + 0.5).clamp(0.5, points as f32 + 0.5);
        let row = (y as usize).min(points);
        let t = if row == 0 {
            2.0 * y - 1.0
        } else if row == points {
            2.0 * (y - points as f32)
        } else {
            y - row as f32
        };
        Place { columns, row, shares: [x - column, t.min(1.0)] }
    }

    /// The densities at the corners of a cell: above, and below.
    #[inline]
    fn corners(&self, columns: [usize; 2], row: usize) -> [[f32; 2]; 2] {
        let of = |point: Option<usize>| match point {
            Some(point) if point < self.points() => columns.map(|column| self.values[point * self.columns + column]),
            _ => [0.0; 2],
        };
        [of(row.checked_sub(1)), of(Some(row))]
    }
}

/// A number in [0, 1] whose density goes linearly from `a` to `b` (>= 0, not both 0); `u` uniform in [0, 1).
#[inline]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    // Scaled, so that squares neither overflow nor vanish.
    let most = a.max(b);
    let (a, b) = (a / most, b / most);
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    (u * (a + b) / (a + root)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;

    fn grid(columns: usize, values: &[f32]) -> Option<BilinearGrid> {
        BilinearGrid::new(columns, values.to_vec(), &Cancel::new()).unwrap()
    }

    /// The integral of the density over a box by midpoints.
    fn integral(grid: &BilinearGrid, [low, high]: [[f64; 2]; 2]) -> f64 {
        const STEPS: usize = 240;
        let mut sum = 0.0;
        for y in 0..STEPS {
            for x in 0..STEPS {
                let at = [x, y].map(|i| (i as f64 + 0.5) / STEPS as f64);
                let at = [0, 1].map(|i| (low[i] + at[i] * (high[i] - low[i])) as f32);
                sum += f64::from(grid.pdf(at));
            }
        }
        sum * (high[0] - low[0]) * (high[1] - low[1]) / (STEPS * STEPS) as f64
    }

    const CASES: [(usize, &[f32]); 5] = [
        (1, &[1.0]),
        (2, &[1.0, 0.0]),
        (4, &[0.0, 0.0, 0.0, 0.0, 0.0, 1000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.1, 0.2, 0.3, 7.0, 7.0, 7.0]),
        (5, &[1e-30, 0.0, 1e-30, 2e-30, 5e-30]),
    ];

    #[test]
    fn densities_integrate_to_one_and_are_those_of_the_samples() {
        for (columns, values) in CASES {
            let grid = grid(columns, values).unwrap();
            let all = integral(&grid, [[0.0; 2], [1.0; 2]]);
            assert!((all - 1.0).abs() < 1e-4, "{values:?}: {all}");
            // Counts in boxes that no cell is aligned with.
            const SIDE: usize = 7;
            const COUNT: usize = 1 << 18;
            let mut counts = [[0_usize; SIDE]; SIDE];
            let mut rng = Rng::new(5, 1);
            for _ in 0..COUNT {
                let GridSample { at, pdf } = grid.sample([rng.next_f32(), rng.next_f32()]);
                assert!(at.iter().all(|x| (0.0..1.0).contains(x)), "{at:?}");
                let again = grid.pdf(at);
                assert!((again - pdf).abs() <= 1e-4 * pdf.max(1.0), "{values:?} at {at:?}: {pdf} and {again}");
                let [x, y] = at.map(|x| (x * SIDE as f32) as usize);
                counts[y][x] += 1;
            }
            for (y, row) in counts.iter().enumerate() {
                for (x, count) in row.iter().enumerate() {
                    let low = [x, y].map(|i| i as f64 / SIDE as f64);
                    let expected = integral(&grid, [low, low.map(|x| x + 1.0 / SIDE as f64)]);
                    let share = *count as f64 / COUNT as f64;
                    let error = (expected.max(1e-6) / COUNT as f64).sqrt();
                    assert!((share - expected).abs() < 5.0 * error + 2e-5, "{values:?}: {share}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn a_lone_value_is_a_tent_across_the_seam() {
        let grid = grid(4, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        // Base of two texels by two: the peak is 4 / (2/4 * 2/3).
        let peak = grid.pdf([0.125, 0.5]);
        assert!((peak - 12.0).abs() < 1e-4, "{peak}");
        assert!((grid.pdf([0.0, 0.5]) - 6.0).abs() < 1e-4 && (grid.pdf([1.0_f32.next_down(), 0.5]) - 6.0).abs() < 1e-4);
        assert_eq!(grid.pdf([0.5, 0.5]), 0.0);
    }

    #[test]
    fn what_cannot_be_a_density_is_none() {
        for values in [[0.0; 4], [1.0, -1.0, 1.0, 1.0], [f32::NAN; 4], [f32::INFINITY, 0.0, 0.0, 0.0]] {
            assert!(grid(2, &values).is_none(), "{values:?}");
        }
        assert!(grid(3, &[1.0; 4]).is_none() && grid(0, &[]).is_none());
        assert!(grid(2, &[f32::MAX, 0.0, 0.0, f32::MAX]).is_some());
    }
}
