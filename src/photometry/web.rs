//! The intensities of a lamp by direction: bilinear between the angles of a file, with its integral and its sampling in closed form.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{LampTilt, WebFormat};
use crate::math::DVec3;

/// The axis about which the planes of a file turn. Directions are in the frame of the lamp: x towards C = 0, y towards C = 90 degrees,
/// z along the lamp's axis, gamma = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planes {
    /// Type C: about the lamp's axis. The azimuth is C, the polar angle gamma.
    C,
    /// Type B: about the axis towards C = 0. The azimuth is the vertical angle B, and the polar angle is 90 degrees minus the
    /// horizontal angle.
    B,
    /// Type A: about the axis towards C = 90 degrees. The azimuth is the horizontal angle A, and the polar angle is 90 degrees minus the
    /// vertical angle.
    A,
}

/// A photometric web: luminous intensities \[cd\] over a grid of polar angles and azimuths. What is outside of the grid is dark.
#[derive(Clone, Debug)]
pub struct Web {
    planes: Planes,
    /// Radians, ascending; the last one is no more than a full turn beyond the first one.
    azimuths: Vec<f64>,
    /// Radians, ascending, in [0, pi].
    polars: Vec<f64>,
    /// Intensities of each azimuth, all polar angles of one after those of another.
    candela: Vec<f64>,
    /// For each polar angle, the integral over the azimuths up to each, all azimuths of one after those of another.
    around: Vec<f64>,
    /// The luminous flux up to each polar angle \[lm\].
    flux_up_to: Vec<f64>,
    peak: f64,
    /// The luminous flux that the file states \[lm\].
    stated: Option<f64>,
    /// Factors by tilts of the lamp, where the file has them.
    pub(super) tilt: Option<LampTilt>,
    /// The contents of the file, with the factors of tilts that were in a file of their own.
    pub(super) text: Box<[u8]>,
    pub(super) format: WebFormat,
}

/// Webs of the same text are the same. Sides of webs have no text, and are told apart by their grids.
impl PartialEq for Web {
    fn eq(&self, other: &Self) -> bool {
        let is_same = || self.format == other.format && self.text == other.text;
        let grids = || self.polars == other.polars && self.candela == other.candela;
        std::ptr::eq(self, other) || (is_same() && (!self.text.is_empty() || grids()))
    }
}

/// A polar angle this close to the horizon is the horizon \[radians\].
const ON_HORIZON: f64 = 1e-9;

/// The integral of (a + b t) sin(start + t) over t from 0 to `width`.
///
/// Where the width is small, the terms are series: their closed forms are differences of nearly equal numbers there.
fn linear_times_sine(start: f64, width: f64, a: f64, b: f64) -> f64 {
    let (sin, cos) = start.sin_cos();
    let even = 2.0 * (0.5 * width).sin() * (start + 0.5 * width).sin();
    let w2 = width * width;
    let (along, across) = if width < 0.02 {
        (width * w2 * (1.0 / 3.0 - w2 * (1.0 / 30.0 - w2 / 840.0)), w2 * (0.5 - w2 * (0.125 - w2 / 144.0)))
    } else {
        let (sin_w, cos_w) = width.sin_cos();
        (sin_w - width * cos_w, cos_w - 1.0 + width * sin_w)
    };
    a * even + b * (cos * along + sin * across)
}

impl Web {
    /// A web of ascending angles in radians with the intensities of each azimuth in a row. There are two azimuths and two polar angles
    /// at least, and all intensities are finite and not negative.
    pub(super) fn new(
        planes: Planes,
        azimuths: Vec<f64>,
        polars: Vec<f64>,
        candela: Vec<f64>,
        stated: Option<f64>,
    ) -> Self {
        let (columns, rows) = (azimuths.len(), polars.len());
        let mut around = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            let mut sum = 0.0;
            around.push(sum);
            for column in 1..columns {
                let mean = 0.5 * (candela[(column - 1) * rows + row] + candela[column * rows + row]);
                sum += mean * (azimuths[column] - azimuths[column - 1]);
                around.push(sum);
            }
        }
        let (flux_up_to, text, format) = (vec![0.0; rows], Box::default(), WebFormat::Ies);
        let (tilt, peak) = (None, 0.0);
        let mut web = Self { planes, azimuths, polars, candela, around, flux_up_to, peak, stated, tilt, text, format };
        for row in 1..rows {
            let width = web.polars[row] - web.polars[row - 1];
            web.flux_up_to[row] = web.flux_up_to[row - 1] + web.flux_between(row - 1, width);
        }
        web.peak = web.candela.iter().fold(0.0, |most, &value| most.max(value));
        web
    }

    /// The whole integral over the azimuths at a polar angle of the grid.
    fn all_around(&self, row: usize) -> f64 {
        self.around[(row + 1) * self.azimuths.len() - 1]
    }

    /// The luminous flux \[lm\] from a polar angle of the grid to `width` beyond it, which is no farther than the next one.
    fn flux_between(&self, row: usize, width: f64) -> f64 {
        let step = self.polars[row + 1] - self.polars[row];
        let (here, next) = (self.all_around(row), self.all_around(row + 1));
        linear_times_sine(self.polars[row], width, here, (next - here) / step)
    }

    /// The luminous flux \[lm\]: the integral of the interpolated intensities over the sphere.
    pub fn flux(&self) -> f64 {
        self.flux_up_to[self.flux_up_to.len() - 1]
    }

    /// The largest intensity \[cd\].
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The luminous flux that the file states \[lm\], of its lamps or of the luminaire; `None` where it states none.
    pub fn stated_flux(&self) -> Option<f64> {
        self.stated
    }

    /// The factors by which the intensities are multiplied where the lamp is tilted, where the file has some.
    pub fn tilt(&self) -> Option<&LampTilt> {
        self.tilt.as_ref()
    }

    /// The factor on the intensities of a luminaire that is tilted by this angle in degrees from where it was measured; 1 where the file
    /// has no factors, and `None` beyond the angles that it has.
    pub fn tilt_factor(&self, degrees: f64) -> Option<f64> {
        self.tilt.as_ref().map_or(Some(1.0), |tilt| tilt.factor(degrees))
    }

    /// The contents of the file, with the factors of tilted lamps that are in another.
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// The format of the file.
    pub fn format(&self) -> WebFormat {
        self.format
    }

    /// The axis about which the planes of the file turn.
    pub fn planes(&self) -> Planes {
        self.planes
    }

    /// The largest polar angle with light in radians, from the lamp's axis: pi where the planes do not turn about it.
    pub fn reach(&self) -> f64 {
        if self.planes != Planes::C {
            return PI;
        }
        let last = self.polars.len() - 1;
        let lit = (0..=last).rev().find(|&row| self.all_around(row) > 0.0).unwrap_or(0);
        self.polars[(lit + 1).min(last)]
    }

    /// The web of the light on one side of the plane across the lamp's axis: the side to which the axis points, `front`, or the other
    /// one. It has the same intensities there, and none elsewhere; `None` where no light goes to that side.
    ///
    /// A polar angle is put in where the grid passes the horizon, at which it has what is interpolated there, so that intensities, flux
    /// and sampling stay exact. Planes of types B and A have no angles beyond the horizon.
    pub fn side(&self, front: bool) -> Option<Self> {
        let rows = self.polars.len();
        let is_within = |polar: f64| {
            if self.planes != Planes::C {
                front
            } else if front {
                polar <= FRAC_PI_2 + ON_HORIZON
            } else {
                polar >= FRAC_PI_2 - ON_HORIZON
            }
        };
        // Each polar angle of the side, with the row before it and the share of the row after that.
        let mut kept: Vec<(f64, usize, f64)> = Vec::new();
        for row in 0..rows {
            let polar = self.polars[row];
            if row > 0 && is_within(polar) != is_within(self.polars[row - 1]) {
                let before = self.polars[row - 1];
                let share = (FRAC_PI_2 - before) / (polar - before);
                // A row on the horizon belongs to both sides, and needs none beside it.
                let is_between = (FRAC_PI_2 - before).min(polar - FRAC_PI_2) > ON_HORIZON;
                kept.extend(is_between.then_some((FRAC_PI_2, row - 1, share)));
            }
            kept.extend(is_within(polar).then_some((polar, row, 0.0)));
        }
        if kept.len() < 2 {
            return None;
        }
        let polars = kept.iter().map(|(polar, ..)| *polar).collect();
        let mut candela = Vec::with_capacity(self.azimuths.len() * kept.len());
        for plane in self.candela.chunks_exact(rows) {
            let value = |&(_, row, share): &(f64, usize, f64)| match share > 0.0 {
                true => plane[row] + share * (plane[row + 1] - plane[row]),
                false => plane[row],
            };
            candela.extend(kept.iter().map(value));
        }
        let side = Self::new(self.planes, self.azimuths.clone(), polars, candela, None);
        (side.flux() > 0.0).then_some(side)
    }

    /// The intensity \[cd\] in a direction of the lamp's frame, of any length but 0.
    pub fn candela(&self, direction: DVec3) -> f64 {
        let [x, y, z] = self.to_grid(direction);
        let polar = x.hypot(y).atan2(z);
        // A direction on the edge of the grid may have been rounded out of it.
        const EDGE: f64 = 1e-6;
        let (first, last) = (self.polars[0], self.polars[self.polars.len() - 1]);
        if polar < first - EDGE || polar > last + EDGE {
            return 0.0;
        }
        let start = self.azimuths[0];
        let mut azimuth = start + (y.atan2(x) - start).rem_euclid(TAU);
        let end = self.azimuths[self.azimuths.len() - 1];
        if azimuth > end {
            // Less than a turn is known.
            if azimuth < end + EDGE {
                azimuth = end;
            } else if azimuth > start + TAU - EDGE {
                azimuth = start;
            } else {
                return 0.0;
            }
        }
        let (row, t) = place(&self.polars, polar);
        let (column, s) = place(&self.azimuths, azimuth);
        let at = |column: usize, row: usize| self.candela[column * self.polars.len() + row];
        let of = |column: usize| at(column, row) + t * (at(column, row + 1) - at(column, row));
        of(column) + s * (of(column + 1) - of(column))
    }

    /// A unit direction of the lamp's frame with a density in proportion to the intensity, by inversion; `u` is uniform in [0, 1)^2.
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let wanted = u[0] * self.flux();
        let rows = self.polars.len();
        let row = self.flux_up_to[1..rows - 1].partition_point(|&flux| flux <= wanted);
        let width = self.width_of(row, wanted - self.flux_up_to[row]);
        let t = width / (self.polars[row + 1] - self.polars[row]);
        // The running integral over the azimuths is linear between two polar angles.
        let columns = self.azimuths.len();
        let [here, next] = [row, row + 1].map(|row| &self.around[row * columns..(row + 1) * columns]);
        let up_to = |column: usize| here[column] + t * (next[column] - here[column]);
        let wanted = u[1] * up_to(columns - 1);
        let (mut low, mut high) = (0, columns - 1);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if up_to(middle) <= wanted { low = middle } else { high = middle }
        }
        let at = |column: usize, row: usize| self.candela[column * rows + row];
        let value = |column: usize| at(column, row) + t * (at(column, row + 1) - at(column, row));
        let step = self.azimuths[low + 1] - self.azimuths[low];
        let share = within_linear(value(low), value(low + 1), (wanted - up_to(low)) / step);
        let (sin_azimuth, cos_azimuth) = (self.azimuths[low] + share * step).sin_cos();
        let (sin, cos) = (self.polars[row] + width).sin_cos();
        self.direction_of([sin * cos_azimuth, sin * sin_azimuth, cos])
    }

    /// How far beyond a polar angle of the grid its light is `flux`: a root between two bounds, by Newton's steps where they stay
    /// between them and by halves elsewhere.
    fn width_of(&self, row: usize, flux: f64) -> f64 {
        let step = self.polars[row + 1] - self.polars[row];
        let (here, next) = (self.all_around(row), self.all_around(row + 1));
        let (mut low, mut high) = (0.0, step);
        let mut width = 0.5 * step;
        // Sixty halves alone would do.
        for _ in 0..60 {
            let off = self.flux_between(row, width) - flux;
            if off > 0.0 {
                high = width
            } else {
                low = width
            }
            let slope = (here + (next - here) * width / step) * (self.polars[row] + width).sin();
            let newton = width - off / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - width).abs();
            width = next;
            if moved <= 1e-14 * step {
                break;
            }
        }
        width
    }

    /// Components of a direction of the lamp's frame along the azimuths 0 and 90 degrees and the pole of the grid.
    fn to_grid(&self, d: DVec3) -> [f64; 3] {
        match self.planes {
            Planes::C => [d.x, d.y, d.z],
            Planes::B => [d.z, d.y, d.x],
            Planes::A => [d.z, d.x, d.y],
        }
    }

    /// The direction of these components.
    fn direction_of(&self, [a, b, pole]: [f64; 3]) -> DVec3 {
        match self.planes {
            Planes::C => DVec3::new(a, b, pole),
            Planes::B => DVec3::new(pole, b, a),
            Planes::A => DVec3::new(b, pole, a),
        }
    }
}

/// The interval of ascending numbers that holds `x`, and where `x` lies in it, in [0, 1].
fn place(numbers: &[f64], x: f64) -> (usize, f64) {
    let at = numbers[1..numbers.len() - 1].partition_point(|&number| number <= x);
    (at, ((x - numbers[at]) / (numbers[at + 1] - numbers[at])).clamp(0.0, 1.0))
}

/// The share s at which the integral of a linear function from `a` to `b` over [0, s] is `area`.
fn within_linear(a: f64, b: f64, area: f64) -> f64 {
    let root = (a * a + 2.0 * (b - a) * area).max(0.0).sqrt();
    let share = 2.0 * area / (a + root);
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}
