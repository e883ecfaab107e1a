//! Lines and numbers of a text, with the places of what is wrong in it.

use std::borrow::Cow;

use super::MOST_ANGLES;

/// Degrees by which angles have to ascend.
const NARROWEST: f64 = 1e-6;

/// The largest intensity \[cd\].
const BRIGHTEST: f64 = 1e12;

/// Why a text is refused, and the line, from 1 on; 0 where no line is at fault.
#[derive(Debug)]
pub(super) struct Refusal {
    pub line: usize,
    pub message: String,
}

pub(super) type Parsed<T> = std::result::Result<T, Refusal>;

pub(super) fn refuse<T>(line: usize, message: impl Into<String>) -> Parsed<T> {
    Err(Refusal { line, message: message.into() })
}

/// The lines of a text. Old files are in many encodings; what is not UTF-8 stands in names, which are not read.
pub(super) fn lines(text: &[u8]) -> Parsed<Vec<Cow<'_, str>>> {
    if text.iter().all(u8::is_ascii_whitespace) {
        return refuse(0, "the file is empty, expected a photometric web");
    }
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    // Lines end with CR LF as a rule, and with CR alone in files of old Macintoshes.
    let is_old = !text.contains(&b'\n');
    let mut lines = Vec::new();
    for (number, line) in text.split(|&byte| byte == b'\n' || (is_old && byte == b'\r')).enumerate() {
        // Control-Z marked the end of texts once.
        let line = line.split(|&byte| byte == 0x1a).next().unwrap_or_default();
        if line.contains(&0) {
            return refuse(number + 1, "not a text, expected a photometric web of IES LM-63 or EULUMDAT");
        }
        lines.push(String::from_utf8_lossy(line.strip_suffix(b"\r").unwrap_or(line)));
    }
    // What is after the end of the last line is no line.
    while lines.len() > 1 && lines.last().is_some_and(|line| line.is_empty()) {
        lines.pop();
    }
    Ok(lines)
}

/// A text as it is shown in messages.
pub(super) fn shown(text: &str) -> String {
    let text = text.trim();
    let short: String = text.chars().filter(|c| !c.is_control()).take(40).collect();
    if short.len() < text.len() { format!("{short}...") } else { short }
}

/// Reads a number.
pub(super) fn number(line: usize, text: &str, what: &str) -> Parsed<f64> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value.abs() <= 1e30 => Ok(value),
        _ => refuse(line, format!("'{}' is no {what}, expected a number", shown(text))),
    }
}

/// Reads a whole number in `least..=most`.
pub(super) fn count(line: usize, text: &str, what: &str, least: usize, most: usize) -> Parsed<usize> {
    let value = number(line, text, what)?;
    if value.fract() != 0.0 || value < least as f64 || value > most as f64 {
        return refuse(line, format!("{value} is no {what}, expected a whole number in [{least}, {most}]"));
    }
    Ok(value as usize)
}

/// Checks that so many intensities may be read.
pub(super) fn check_size(line: usize, planes: usize, angles: usize) -> Parsed<()> {
    if planes.saturating_mul(angles) > MOST_ANGLES {
        let message =
            format!("{planes} planes of {angles} angles are more than the {MOST_ANGLES} intensities that are read");
        return refuse(line, message);
    }
    Ok(())
}

/// Checks an angle in degrees: in `low..=high`, and above the one before.
pub(super) fn angle(line: usize, value: f64, before: Option<f64>, [low, high]: [f64; 2], what: &str) -> Parsed<f64> {
    if !(low..=high).contains(&value) {
        return refuse(line, format!("{value} degrees are no {what}, expected an angle in [{low}, {high}]"));
    }
    match before {
        Some(before) if value - before < NARROWEST => {
            refuse(line, format!("the {what} {value} comes after {before}, expected ascending angles"))
        }
        _ => Ok(value),
    }
}

/// Checks an intensity and multiplies it by the file's factors.
pub(super) fn intensity(line: usize, value: f64, factor: f64) -> Parsed<f64> {
    if value < 0.0 {
        return refuse(line, format!("an intensity of {value} is negative, expected a number of 0 or more"));
    }
    let candela = factor * value;
    if candela <= BRIGHTEST {
        return Ok(candela);
    }
    refuse(line, format!("an intensity of {candela:e} cd is out of range, expected up to {BRIGHTEST:e} cd"))
}

/// Checks a factor or a flux.
pub(super) fn positive(line: usize, value: f64, what: &str) -> Parsed<f64> {
    if value > 0.0 { Ok(value) } else { refuse(line, format!("{value} is no {what}, expected a number above 0")) }
}

/// A table of planes: their angles in degrees, ascending, and the intensities of each.
pub(super) struct Table {
    pub planes: Vec<f64>,
    pub intensities: Vec<Vec<f64>>,
}

impl Table {
    /// Adds the mirror images of the planes beyond the last one.
    pub fn mirror(mut self) -> Self {
        let count = self.planes.len();
        let last = self.planes[count - 1];
        for plane in (0..count - 1).rev() {
            self.planes.push(2.0 * last - self.planes[plane]);
            self.intensities.push(self.intensities[plane].clone());
        }
        self
    }

    /// Adds the first plane once more, a turn after itself, where the planes end before that.
    pub fn close(mut self) -> Self {
        let (first, last) = (self.planes[0], self.planes[self.planes.len() - 1]);
        if last < first + 360.0 {
            self.planes.push(first + 360.0);
            self.intensities.push(self.intensities[0].clone());
        }
        self
    }
}
