//! Files of IES LM-63, of 1986, 1991, 1995, 2002 and 2019.
//!
//! Sources: ANSI/IES LM-63-19, "Approved Method: IES Standard File Format for the Electronic Transfer of Photometric Data and Related
//! Information"; CIE 121:1996, "The Photometry and Goniophotometry of Luminaires", for the three kinds of planes.

use std::borrow::Cow;
use std::path::Path;

use super::text::{Parsed, Table, angle, check_size, count, intensity, lines, number, positive, refuse, shown};
use super::{LampPosition, LampTilt, MOST_ANGLES, Planes, Web};

/// Most pairs of angles and factors that a lamp's tilt may have.
const MOST_TILTS: usize = 1000;

/// The largest factor of a tilt.
const BRIGHTEST_TILT: f64 = 1e6;

/// Whether a file is of this format: it says so in its first line, has a line of the tilt, or is called so.
pub(super) fn is_ies(text: &[u8], file: Option<&Path>) -> bool {
    let starts = |line: &[u8], with: &[u8]| {
        line.trim_ascii_start().get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with))
    };
    starts(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text), b"IES")
        || text.split(|&byte| byte == b'\n' || byte == b'\r').any(|line| starts(line, b"TILT="))
        || file.and_then(Path::extension).is_some_and(|extension| extension.eq_ignore_ascii_case("ies"))
}

/// The numbers of the lines after that of the tilt, separated by blanks, commas and ends of lines.
struct Numbers<'a> {
    lines: &'a [Cow<'a, str>],
    /// Number of the line that is being read, from 0 on.
    line: usize,
    rest: &'a str,
}

impl<'a> Numbers<'a> {
    fn after(lines: &'a [Cow<'a, str>], line: usize) -> Self {
        Self { lines, line, rest: "" }
    }

    fn of_all(lines: &'a [Cow<'a, str>]) -> Self {
        Self { lines, line: 0, rest: &lines[0] }
    }

    fn next(&mut self, what: &str) -> Parsed<(usize, &'a str)> {
        let separates = |c: char| c.is_ascii_whitespace() || c == ',';
        loop {
            self.rest = self.rest.trim_start_matches(separates);
            if !self.rest.is_empty() {
                let end = self.rest.find(separates).unwrap_or(self.rest.len());
                let (word, rest) = self.rest.split_at(end);
                self.rest = rest;
                return Ok((self.line + 1, word));
            }
            if self.line + 1 >= self.lines.len() {
                return refuse(self.lines.len(), format!("the file ends before {what}"));
            }
            self.line += 1;
            self.rest = &self.lines[self.line];
        }
    }

    fn number(&mut self, what: &str) -> Parsed<(usize, f64)> {
        let (line, word) = self.next(what)?;
        Ok((line, number(line, word, what)?))
    }

    fn count(&mut self, what: &str, least: usize, most: usize) -> Parsed<(usize, usize)> {
        let (line, word) = self.next(what)?;
        Ok((line, count(line, word, what, least, most)?))
    }

    fn positive(&mut self, what: &str) -> Parsed<f64> {
        let (line, value) = self.number(what)?;
        positive(line, value, what)
    }

    fn angles(&mut self, count: usize, range: [f64; 2], what: &str) -> Parsed<(usize, Vec<f64>)> {
        let mut angles = Vec::new();
        let mut at = 0;
        for _ in 0..count {
            let (line, value) = self.number(what)?;
            angles.push(angle(line, value, angles.last().copied(), range, what)?);
            at = line;
        }
        Ok((at, angles))
    }
}

/// The number of the line of the tilt, from 0 on. Keywords before it are of any number, and the first file formats have any text in
/// their place.
fn line_of_tilt(lines: &[Cow<'_, str>]) -> Option<usize> {
    lines.iter().position(|line| line.trim_start().get(..5).is_some_and(|start| start.eq_ignore_ascii_case("TILT=")))
}

/// The name of the file that has the factors of tilts, and the number of the line that names it, from 1 on; `None` where there is none.
pub(super) fn tilt_file(text: &[u8]) -> Option<(usize, String)> {
    let lines = lines(text).ok()?;
    let line = line_of_tilt(&lines)?;
    let name = lines[line].trim_start()[5..].trim();
    let is_word = ["", "NONE", "INCLUDE"].iter().any(|word| name.eq_ignore_ascii_case(word));
    (!is_word).then(|| (line + 1, name.to_owned()))
}

/// Reads a file of factors of tilts.
pub(super) fn read_tilt(text: &[u8]) -> Parsed<LampTilt> {
    let lines = lines(text)?;
    tilt(&mut Numbers::of_all(&lines))
}

/// A file in which the name of the file of factors is replaced by these factors.
pub(super) fn with_tilt(text: &[u8], line: usize, tilt: &LampTilt) -> Vec<u8> {
    let end = if text.contains(&b'\n') { b'\n' } else { b'\r' };
    let mut whole = Vec::with_capacity(text.len());
    for (number, piece) in text.split_inclusive(|&byte| byte == end).enumerate() {
        if number + 1 == line {
            let lines = format!("TILT=INCLUDE\n{}", tilt.text());
            whole.extend(lines.bytes().map(|byte| if byte == b'\n' { end } else { byte }));
        } else {
            whole.extend_from_slice(piece);
        }
    }
    whole
}

/// Reads a file, with the factors of tilts where they are in a file of their own.
pub(super) fn read(text: &[u8], of_file: Option<LampTilt>) -> Parsed<Web> {
    let lines = lines(text)?;
    let Some(tilt_line) = line_of_tilt(&lines) else {
        return refuse(lines.len(), "there is no line that begins with TILT=, expected TILT=NONE or TILT=INCLUDE");
    };
    // What came to be the kind of the file in 1995 was a factor before.
    let first = lines[0].trim().to_ascii_uppercase();
    let has_lamp_factor =
        !first.starts_with("IES") || first.starts_with("IESNA91") || first.starts_with("IESNA:LM-63-1991");
    let mut numbers = Numbers::after(&lines, tilt_line);
    let kind = lines[tilt_line].trim_start()[5..].trim();
    let tilt = match kind.to_ascii_uppercase().as_str() {
        "NONE" => None,
        "INCLUDE" => Some(tilt(&mut numbers)?),
        _ if of_file.is_some() => of_file,
        _ => {
            let message = format!(
                "TILT={}: the factors of tilted lamps are in a file of their own, which a text in memory has not; expected \
                 TILT=NONE or TILT=INCLUDE",
                shown(kind)
            );
            return refuse(tilt_line + 1, message);
        }
    };
    let (_, lamps) = numbers.count("number of lamps", 1, MOST_ANGLES)?;
    let (line, lumens) = numbers.number("luminous flux of a lamp")?;
    if lumens < 0.0 && lumens != -1.0 {
        return refuse(line, format!("{lumens} lumens for each lamp, expected a flux, or -1 for absolute intensities"));
    }
    let mut factor = numbers.positive("factor on the intensities")?;
    let (_, rows) = numbers.count("number of vertical angles", 2, MOST_ANGLES)?;
    let (line, planes) = numbers.count("number of horizontal angles", 1, MOST_ANGLES)?;
    check_size(line, planes, rows)?;
    let (_, kind) = numbers.count("photometric type", 1, 3)?;
    numbers.count("type of units", 1, 2)?;
    for what in ["width", "length", "height"] {
        // Negative for round luminaires.
        numbers.number(what)?;
    }
    factor *= numbers.positive("factor of the ballast")?;
    let (line, lamp_factor) = numbers.number("factor of ballast and lamp, or kind of the file")?;
    if has_lamp_factor {
        factor *= positive(line, lamp_factor, "factor of ballast and lamp")?;
    }
    numbers.number("input power")?;

    let is_type_c = kind == 1;
    let vertical = if is_type_c { [0.0, 180.0] } else { [-90.0, 90.0] };
    let horizontal = if is_type_c { [0.0, 360.0] } else { [-90.0, 90.0] };
    let (_, rows) = numbers.angles(rows, vertical, "vertical angle")?;
    let (line, planes) = numbers.angles(planes, horizontal, "horizontal angle")?;
    let mut intensities = Vec::new();
    for _ in 0..planes.len() {
        let mut plane = Vec::new();
        for _ in 0..rows.len() {
            let (line, value) = numbers.number("intensity")?;
            plane.push(intensity(line, value, factor)?);
        }
        intensities.push(plane);
    }
    let stated = (lumens > 0.0).then_some(lamps as f64 * lumens);
    let table = Table { planes, intensities };
    let mut web = match kind {
        1 => web(Planes::C, whole_turn(line, table)?, &rows, stated),
        2 => {
            // The planes turn about a horizontal axis: the vertical angle is that of the plane.
            let table = both_sides(line, table)?;
            let count = rows.len();
            let turned = (0..count).map(|row| table.intensities.iter().rev().map(|plane| plane[row]).collect());
            let polars: Vec<f64> = table.planes.iter().rev().map(|angle| 90.0 - angle).collect();
            web(Planes::B, Table { intensities: turned.collect(), planes: rows }, &polars, stated)
        }
        _ => {
            let mut table = both_sides(line, table)?;
            table.intensities.iter_mut().for_each(|plane| plane.reverse());
            let polars: Vec<f64> = rows.iter().rev().map(|angle| 90.0 - angle).collect();
            web(Planes::A, table, &polars, stated)
        }
    };
    web.tilt = tilt;
    Ok(web)
}

/// Reads the factors of a lamp that is tilted: all angles, then the factor of each.
fn tilt(numbers: &mut Numbers<'_>) -> Parsed<LampTilt> {
    let (_, position) = numbers.count("position of the lamp in the luminaire", 1, 3)?;
    let position = match position {
        1 => LampPosition::Vertical,
        2 => LampPosition::HorizontalFixed,
        _ => LampPosition::HorizontalTilted,
    };
    let (_, pairs) = numbers.count("number of tilts", 1, MOST_TILTS)?;
    let (_, angles) = numbers.angles(pairs, [-180.0, 180.0], "angle of a tilt")?;
    let mut factors = Vec::new();
    for angle in angles {
        let (line, factor) = numbers.number("factor of a tilt")?;
        if !(0.0..=BRIGHTEST_TILT).contains(&factor) {
            let message = format!("{factor} is no factor of a tilt, expected a number in [0, {BRIGHTEST_TILT:e}]");
            return refuse(line, message);
        }
        factors.push([angle, factor]);
    }
    Ok(LampTilt::new(position, factors))
}

/// Fills in what symmetry leaves out of the planes of type C.
fn whole_turn(line: usize, table: Table) -> Parsed<Table> {
    let (first, last) = (table.planes[0], table.planes[table.planes.len() - 1]);
    if table.planes.len() == 1 {
        return Ok(table.close());
    }
    match (first, last) {
        (0.0, 90.0) => Ok(table.mirror().mirror()),
        (0.0, 180.0) | (90.0, 270.0) => Ok(table.mirror()),
        (0.0, last) if last > 180.0 => Ok(table.close()),
        _ => {
            let message = format!(
                "the horizontal angles go from {first} to {last} degrees, expected from 0 to 0, 90, 180 or 360, or from 90 to 270"
            );
            refuse(line, message)
        }
    }
}

/// Fills in the other side of horizontal angles of types A and B that begin at 0.
fn both_sides(line: usize, mut table: Table) -> Parsed<Table> {
    match table.planes[0] {
        0.0 if table.planes.len() > 1 => {
            table.planes.iter_mut().for_each(|angle| *angle = -*angle);
            table.planes.reverse();
            table.intensities.reverse();
            Ok(table.mirror())
        }
        first if first < 0.0 && table.planes.len() > 1 => Ok(table),
        first => {
            let last = table.planes[table.planes.len() - 1];
            let message =
                format!("the horizontal angles go from {first} to {last} degrees, expected from 0 or -90 to 90");
            refuse(line, message)
        }
    }
}

fn web(planes: Planes, table: Table, polars: &[f64], stated: Option<f64>) -> Web {
    let radians = |angles: &[f64]| angles.iter().map(|angle| angle.to_radians()).collect();
    Web::new(planes, radians(&table.planes), radians(polars), table.intensities.concat(), stated)
}
