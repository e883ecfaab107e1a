//! Factors of lamps whose light depends on how they are tilted.
//!
//! Discharge lamps give less light where they do not hang as they did when the luminaire was measured. A file of IES LM-63 says by how
//! much, in itself (`TILT=INCLUDE`) or in a file of its own, whose name it has.

use std::fmt::Write as _;

/// How a lamp sits in its luminaire, which is aimed straight down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LampPosition {
    /// Upright, its base up or down; it is tilted with the luminaire. 1 in files.
    Vertical,
    /// Level, along the axis about which the luminaire is tilted, so that it stays level. 2 in files.
    HorizontalFixed,
    /// Level, across that axis: it is tilted with the luminaire. 3 in files.
    HorizontalTilted,
}

/// By what the intensities of a luminaire are multiplied where it is tilted.
#[derive(Clone, Debug, PartialEq)]
pub struct LampTilt {
    position: LampPosition,
    /// Degrees, ascending, and the factor of each.
    factors: Vec<[f64; 2]>,
}

impl LampTilt {
    /// A table of one or more pairs of angles in degrees, ascending, and factors of 0 or more.
    pub(super) fn new(position: LampPosition, factors: Vec<[f64; 2]>) -> Self {
        Self { position, factors }
    }

    /// How the lamp sits in the luminaire.
    pub fn position(&self) -> LampPosition {
        self.position
    }

    /// The least and the largest angle in degrees by which the luminaire can be tilted for the factor to be known. A table of angles
    /// of one sign holds for both.
    pub fn range(&self) -> [f64; 2] {
        let (first, last) = (self.factors[0][0], self.factors[self.factors.len() - 1][0]);
        match self.position {
            LampPosition::HorizontalFixed => [-180.0, 180.0],
            _ if first < 0.0 => [first.min(0.0), last.max(0.0)],
            _ => [-last, last],
        }
    }

    /// The factor of a luminaire that is tilted by this angle in degrees from straight down, by linear interpolation between the angles
    /// of the table; `None` beyond them. A table without the position in which the luminaire was measured has the factor 1 there.
    pub fn factor(&self, degrees: f64) -> Option<f64> {
        let lamp = match self.position {
            LampPosition::HorizontalFixed => 0.0,
            _ if self.factors[0][0] < 0.0 => degrees,
            _ => degrees.abs(),
        };
        let after = self.factors.partition_point(|[angle, _]| *angle <= lamp);
        let measured = [0.0, 1.0];
        let below = after.checked_sub(1).map(|at| self.factors[at]);
        let above = self.factors.get(after).copied();
        let ([a, from], [b, to]) = match (below, above) {
            (Some(below), Some(above)) => (below, above),
            (Some([angle, factor]), None) if angle == lamp => return Some(factor),
            (None, Some(above)) if lamp >= 0.0 => (measured, above),
            (Some(below), None) if lamp <= 0.0 => (below, measured),
            _ => return None,
        };
        Some(from + (to - from) * (lamp - a) / (b - a))
    }

    /// The lines of a file after that of `TILT=INCLUDE`.
    pub(super) fn text(&self) -> String {
        let position = match self.position {
            LampPosition::Vertical => 1,
            LampPosition::HorizontalFixed => 2,
            LampPosition::HorizontalTilted => 3,
        };
        let mut text = format!("{position}\n{}\n", self.factors.len());
        for column in [0, 1] {
            for pair in &self.factors {
                // A line has no more than 132 characters.
                let _ = writeln!(text, "{}", pair[column]);
            }
        }
        text
    }
}
