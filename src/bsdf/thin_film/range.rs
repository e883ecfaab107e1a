//! The reflectance of films of one index and any thickness within a range, in three channels.

use std::f64::consts::FRAC_PI_2;

use super::Stack;
use super::observed::nodes;
use crate::bsdf::microfacet::average_of;
use crate::math::DVec3;
use crate::spectrum::{Rgb, VISIBLE};

/// Number of cosines, whose square roots are at equal distances from 0 to 1: towards grazing incidence fringes are closer.
const COSINES: usize = 193;

/// Numbers of cosines on this side of the critical angle of a film and beyond it, for films thinner than what is in front of them.
const ABOUT_CRITICAL: [usize; 2] = [385, 97];

/// Number of thicknesses for each fringe of the shortest wavelength.
const PER_FRINGE: f64 = 32.0;

/// Optical thickness \[nm\] above which the channels see no fringes any more, for which these are too narrow.
const WASHED_OUT: f64 = 6_000.0;

/// Greatest number of thicknesses above that, and how much wider apart they are if that is enough.
const COARSE: (f64, f64) = (64.0, 16.0);

/// Optical thicknesses \[nm\] up to which films share wavelengths of the quadrature.
const SHARED: [f64; 4] = [1_600.0, 3_200.0, WASHED_OUT, f64::INFINITY];

/// The cosines of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cosines {
    /// Squares of numbers at equal distances.
    Squares,
    /// Of a film that reflects everything beyond its critical angle, but for waves that reach its other face: at equal distances of
    /// q = sqrt(cos^2 - critical^2), in which fringes are as wide at all angles, and beyond of the arc cosine of cos / critical.
    Critical {
        /// The square of the critical cosine.
        squared: f64,
    },
}

impl Cosines {
    /// Numbers of the samples of its parts.
    fn counts(self) -> [usize; 2] {
        match self {
            Self::Squares => [COSINES, 0],
            Self::Critical { .. } => ABOUT_CRITICAL,
        }
    }

    /// The cosine of a sample.
    fn at(self, part: usize, i: usize) -> f64 {
        let place = i as f64 / (self.counts()[part] - 1) as f64;
        match (self, part) {
            (Self::Squares, _) => place * place,
            (Self::Critical { squared }, 0) => (squared + place * place * (1.0 - squared)).sqrt(),
            (Self::Critical { squared }, _) => squared.sqrt() * (FRAC_PI_2 * place).cos().max(0.0),
        }
    }

    /// The part that a cosine is in, and its place among the samples.
    fn place(self, cos: f64) -> (usize, f64) {
        let (part, place) = match self {
            Self::Squares => (0, cos.sqrt()),
            Self::Critical { squared } if cos * cos >= squared => (0, ((cos * cos - squared) / (1.0 - squared)).sqrt()),
            Self::Critical { squared } => (1, (cos / squared.sqrt()).min(1.0).acos() / FRAC_PI_2),
        };
        (part, place * (self.counts()[part] - 1) as f64)
    }
}

/// A reflectance by the thickness and the cosine of the angle of incidence, between whose samples cubic polynomials run.
///
/// As [`super::Observed`] for every thickness of the range. The error is below 2e-3 at cosines above 0.15, with the same exceptions.
/// Below, films between thinner media change so fast with the thickness that it can be 1e-2, and at a cosine of 0.005 anything.
#[derive(Debug, PartialEq)]
pub struct ObservedRange {
    /// The least thickness, the one from which on they are coarse, and the distances of both kinds \[nm\].
    from: f64,
    knee: f64,
    steps: [f64; 2],
    cosines: Cosines,
    /// Rows of the samples of all cosines, one for each thickness.
    values: Box<[Rgb]>,
    /// The mean of each row for light from all sides.
    means: Box<[Rgb]>,
}

/// The place of a sample below a place, and the weights of the four samples from the one before it on (Catmull and Rom 1974, "A
/// Class of Local Interpolating Splines").
fn cubic(place: f64, last: usize) -> (usize, [f32; 4]) {
    let lower = (place.max(0.0) as usize).min(last - 1);
    let t = (place - lower as f64) as f32;
    let [t2, t3] = [t * t, t * t * t];
    (lower, [t2 - 0.5 * (t + t3), 1.0 - 2.5 * t2 + 1.5 * t3, 0.5 * t + 2.0 * t2 - 1.5 * t3, 0.5 * (t3 - t2)])
}

impl ObservedRange {
    /// The table of films from the first to the second thickness \[nm\]. `index`: that of the film, and that in front of it; `stack`:
    /// a film of 1 nm at a wavelength \[nm\].
    pub fn new([from, to]: [f64; 2], [index, front]: [f64; 2], stack: impl Fn(f64) -> Stack) -> Self {
        let fine = VISIBLE[0] / (2.0 * index * PER_FRINGE);
        let knee = (WASHED_OUT / index).clamp(from, to);
        let coarse = if knee < to { (COARSE.1 * fine).max((to - knee) / COARSE.0) } else { fine };
        let steps = [fine, coarse];
        // One more on both sides, for the polynomials of the ends.
        let [fine_rows, coarse_rows] = [(knee - from) / fine, (to - knee) / coarse].map(|count| count.ceil() as usize);
        let knee = from + fine_rows as f64 * fine;
        let rows = fine_rows + coarse_rows + 3;
        let thickness = |row: usize| {
            let beyond = row.saturating_sub(fine_rows + 1);
            from + (row - beyond) as f64 * fine - fine + beyond as f64 * coarse
        };
        let squared = (front - index) * (front + index) / (front * front);
        let cosines = if squared > 0.0 { Cosines::Critical { squared } } else { Cosines::Squares };
        let [first, second] = cosines.counts();
        let width = first + second;
        let mut values = vec![Rgb::ONE; rows * width];
        let mut sums = vec![DVec3::ZERO; rows];
        let mut start = 0;
        // Thinner films need fewer wavelengths.
        for most in SHARED {
            let end = (start..rows).find(|row| thickness(*row) * index > most).unwrap_or(rows);
            if end == start {
                continue;
            }
            let path = (thickness(end - 1) * index).max(0.0);
            let nodes: Vec<_> = nodes(path).into_iter().map(|(nm, weight)| (stack(nm), weight)).collect();
            let sums = &mut sums[start..end];
            for (part, i) in (0..first).map(|i| (0, i)).chain((0..second).map(|i| (1, i))) {
                let cos = cosines.at(part, i);
                sums.fill(DVec3::ZERO);
                for (stack, weight) in &nodes {
                    let Some(fringes) = stack.fringes(cos) else {
                        sums.iter_mut().for_each(|sum| *sum += *weight);
                        continue;
                    };
                    let mut echo = fringes.echo(thickness(start));
                    let turns = steps.map(|step| fringes.echo(step));
                    for (row, sum) in (start..).zip(sums.iter_mut()) {
                        *sum += *weight * fringes.reflectance(echo);
                        echo = echo * turns[usize::from(row > fine_rows)];
                    }
                }
                for (row, sum) in (start..).zip(sums.iter()) {
                    values[row * width + part * first + i] = Rgb::from_f64(sum.clamp(DVec3::ZERO, DVec3::ONE));
                }
            }
            start = end;
        }
        let mut table = Self { from, knee, steps, cosines, values: values.into(), means: Box::default() };
        let mean = |row: usize| Rgb::from_f64(average_of(|cos| table.in_row(row, cos as f32).to_f64()));
        table.means = (0..rows).map(mean).collect();
        table
    }

    /// The place of a thickness among the rows.
    fn place(&self, thickness: f64) -> f64 {
        let [fine, coarse] = self.steps;
        let beyond = (thickness - self.knee).max(0.0) / coarse;
        1.0 + (thickness.min(self.knee) - self.from).max(0.0) / fine + beyond
    }

    /// The reflectance at a cosine of a row.
    fn in_row(&self, row: usize, cos: f32) -> Rgb {
        let counts = self.cosines.counts();
        let (part, place) = self.cosines.place(f64::from(cos.clamp(0.0, 1.0)));
        let first = row * (counts[0] + counts[1]) + part * counts[0];
        let values = &self.values[first..first + counts[part]];
        let last = values.len() - 1;
        let (lower, weights) = cubic(place, last);
        // Beyond the ends, parabolas go on; the reflectance is an even function of q.
        let beyond = |a: Rgb, b: Rgb, c: Rgb| (a - b) * 3.0 + c;
        let before = match (lower, self.cosines) {
            (0, Cosines::Critical { .. }) => values[1],
            (0, Cosines::Squares) => beyond(values[0], values[1], values[2]),
            _ => values[lower - 1],
        };
        let after = if lower + 1 == last {
            beyond(values[last], values[last - 1], values[last - 2])
        } else {
            values[lower + 2]
        };
        before * weights[0] + values[lower] * weights[1] + values[lower + 1] * weights[2] + after * weights[3]
    }

    /// Between rows, by what each of them gives.
    fn between(&self, thickness: f64, of_row: impl Fn(usize) -> Rgb) -> Rgb {
        let rows = self.means.len();
        let (lower, weights) = cubic(self.place(thickness), rows - 1);
        let row = |i: usize| of_row((lower + i).saturating_sub(1).min(rows - 1)) * weights[i];
        (row(0) + row(1) + row(2) + row(3)).max(Rgb::ZERO).min(Rgb::ONE)
    }

    /// The reflectance of a film of this thickness \[nm\] at a cosine in [0, 1].
    pub fn at(&self, cos: f32, thickness: f64) -> Rgb {
        self.between(thickness, |row| self.in_row(row, cos))
    }

    /// Its mean for light from all sides, weighed by the cosine.
    pub fn mean(&self, thickness: f64) -> Rgb {
        self.between(thickness, |row| self.means[row])
    }
}
