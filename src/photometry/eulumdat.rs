//! Files of EULUMDAT, which have a number or a name in each line.
//!
//! Source: Stockmar 1990, "EULUMDAT, ein Leuchtendatenformat für den europäischen Beleuchtungsplaner", Licht 90.

use std::borrow::Cow;

use super::text::{Parsed, Table, angle, check_size, count, intensity, lines, number, positive, refuse};
use super::{MOST_ANGLES, Planes, Web};

/// Most sets of lamps.
const MOST_SETS: usize = 20;

/// The lines before those of the lamps: numbers from 1 on.
const KIND: usize = 2;
const SYMMETRY: usize = 3;
const PLANES: usize = 4;
const ANGLES: usize = 6;
const DIRECT_SHARE: usize = 22;
const OUTPUT_RATIO: usize = 23;
const FACTOR: usize = 24;
const SETS: usize = 26;

/// Lines of a set of lamps, and of the ratios for rooms.
const LINES_OF_SET: usize = 6;
const ROOMS: usize = 10;

struct Lines<'a>(Vec<Cow<'a, str>>);

impl Lines<'_> {
    /// The text of a line from 1 on.
    fn text(&self, line: usize, what: &str) -> Parsed<String> {
        match self.0.get(line - 1) {
            // Some programs write numbers as their country does.
            Some(text) => Ok(text.trim().replace(',', ".")),
            None => refuse(self.0.len(), format!("the file ends before {what} in line {line}")),
        }
    }

    fn number(&self, line: usize, what: &str) -> Parsed<f64> {
        number(line, &self.text(line, what)?, what)
    }

    fn count(&self, line: usize, what: &str, least: usize, most: usize) -> Parsed<usize> {
        count(line, &self.text(line, what)?, what, least, most)
    }
}

/// Reads a file.
pub(super) fn read(text: &[u8]) -> Parsed<Web> {
    let lines = Lines(lines(text)?);
    lines.count(KIND, "kind of luminaire", 0, 3)?;
    let symmetry = lines.count(SYMMETRY, "symmetry", 0, 4)?;
    let planes = lines.count(PLANES, "number of planes", 1, MOST_ANGLES)?;
    let rows = lines.count(ANGLES, "number of angles in a plane", 2, MOST_ANGLES)?;
    check_size(ANGLES, planes, rows)?;
    for (line, what) in [(DIRECT_SHARE, "downward share of the flux"), (OUTPUT_RATIO, "light output ratio")] {
        let percent = lines.number(line, what)?;
        if percent < 0.0 {
            return refuse(line, format!("{percent} % is no {what}, expected a number of 0 or more"));
        }
    }
    let output_ratio = lines.number(OUTPUT_RATIO, "light output ratio")? / 100.0;
    let factor = positive(FACTOR, lines.number(FACTOR, "factor on the intensities")?, "factor on the intensities")?;
    let sets = lines.count(SETS, "number of sets of lamps", 1, MOST_SETS)?;
    // The sets are alternatives, of which the first one is taken. Where its number of lamps is negative, its flux is that of the
    // luminaire.
    let lamps = lines.number(SETS + 1, "number of lamps")?;
    let flux_line = SETS + 3;
    let flux =
        positive(flux_line, lines.number(flux_line, "luminous flux of the lamps")?, "luminous flux of the lamps")?;
    let scale = factor * flux / 1000.0;
    let stated = if lamps < 0.0 { Some(flux) } else { (output_ratio > 0.0).then_some(flux * output_ratio) };

    let mut line = SETS + 1 + LINES_OF_SET * sets + ROOMS;
    let mut angles = |count: usize, range: [f64; 2], what: &str| -> Parsed<Vec<f64>> {
        let mut angles = Vec::new();
        for _ in 0..count {
            let value = lines.number(line, what)?;
            angles.push(angle(line, value, angles.last().copied(), range, what)?);
            line += 1;
        }
        Ok(angles)
    };
    let all_planes = angles(planes, [0.0, 360.0], "angle of a plane")?;
    let polars = angles(rows, [0.0, 180.0], "angle in a plane")?;
    let kept = kept(symmetry, &all_planes)?;
    let mut intensities = Vec::new();
    for _ in 0..kept.len() {
        let mut plane = Vec::new();
        for _ in 0..rows {
            plane.push(intensity(line, lines.number(line, "intensity")?, scale)?);
            line += 1;
        }
        intensities.push(plane);
    }
    let table = Table { planes: kept, intensities };
    let table = match symmetry {
        0 | 1 => table.close(),
        4 => table.mirror().mirror(),
        _ => table.mirror(),
    };
    let radians = |angles: &[f64]| angles.iter().map(|angle| angle.to_radians()).collect();
    Ok(Web::new(Planes::C, radians(&table.planes), radians(&polars), table.intensities.concat(), stated))
}

/// The planes whose intensities are in the file, ascending.
fn kept(symmetry: usize, planes: &[f64]) -> Parsed<Vec<f64>> {
    let count = planes.len();
    let within = |ends: [f64; 2], kept: Vec<f64>| {
        let found = [kept[0], kept[kept.len() - 1]];
        if found == ends && kept.len() > 1 {
            return Ok(kept);
        }
        let message = format!(
            "the symmetry {symmetry} with {count} planes leaves those from {} to {} degrees, expected from {} to {}",
            found[0], found[1], ends[0], ends[1]
        );
        refuse(SYMMETRY, message)
    };
    match symmetry {
        0 => Ok(planes.to_vec()),
        1 => Ok(planes[..1].to_vec()),
        2 => within([0.0, 180.0], planes[..(count / 2 + 1).min(count)].to_vec()),
        3 => {
            // From C = 270 over 0 to 90 degrees.
            let first = 3 * count / 4;
            let after = (first..first + count / 2 + 1).map(|plane| match planes.get(plane) {
                Some(angle) => angle - 360.0,
                None => planes[(plane - count) % count],
            });
            within([-90.0, 90.0], after.collect())
        }
        _ => within([0.0, 90.0], planes[..(count / 4 + 1).min(count)].to_vec()),
    }
}
