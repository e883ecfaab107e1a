//! Files of spectra: two columns, the wavelength in nanometres and the value.
//!
//! Columns are separated by blanks, tabs, commas or semicolons, as `.spd` and `.csv` files have them. Lines that are empty or begin with
//! `#` or `;` are comments, and lines before the first number may be a heading.

use std::io::Read as _;
use std::path::Path;

use super::open_file;
use super::spectrum::MOST_SPECTRUM_SAMPLES;
use crate::{Error, Result};

/// Size of the largest file, bytes.
const SIZE_LIMIT: u64 = 1 << 24;

/// Reads the samples of a file. What they are is checked later.
pub(super) fn read(file: &Path, path: &str) -> Result<Vec<[f64; 2]>> {
    let io = |error| Error::io(file, "cannot read the spectrum", error).at(path);
    let mut bytes = Vec::new();
    let open = open_file(file, SIZE_LIMIT).map_err(|error| error.at(path))?;
    open.take(SIZE_LIMIT + 1).read_to_end(&mut bytes).map_err(io)?;
    parse(&bytes).map_err(|(line, message)| Error::invalid(path, message).in_file(Some(file), line))
}

/// The samples of a text; or the line, from 1, and what is wrong there.
fn parse(bytes: &[u8]) -> Result<Vec<[f64; 2]>, (usize, String)> {
    let text = String::from_utf8_lossy(bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut samples = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with(['#', ';']) {
            continue;
        }
        let wrong = |message: String| Err((number + 1, message));
        let words: Vec<&str> = line
            .split([' ', '\t', ',', ';'])
            .map(|word| word.trim_matches('"'))
            .filter(|word| !word.is_empty())
            .collect();
        let numbers: Vec<f64> = words.iter().map_while(|word| word.parse().ok()).collect();
        let is_heading = samples.is_empty() && numbers.is_empty();
        match numbers[..] {
            [nanometres, value] if words.len() == 2 => samples.push([nanometres, value]),
            _ if is_heading => {}
            _ => {
                let shown: String = line.chars().take(40).collect();
                return wrong(format!("the line is '{shown}', expected a wavelength in nm and one value"));
            }
        }
        if samples.len() > MOST_SPECTRUM_SAMPLES {
            return wrong(format!("there are more samples than {MOST_SPECTRUM_SAMPLES}"));
        }
    }
    if samples.is_empty() {
        return Err((0, "there are no samples, expected lines of a wavelength in nm and a value".to_owned()));
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_columns_are_read_however_they_are_separated() {
        let expected = vec![[400.0, 0.5], [500.5, 1.25e-3]];
        for text in [
            "400 0.5\n500.5 1.25e-3",
            "# made by hand\r\nwavelength,value\r\n400,0.5\r\n500.5,0.00125\r\n",
            "\u{feff}nm;W\n; comment\n400;0.5\n\n500.5 ; 0.00125",
            "\"400\"\t\"0.5\"\n  500.5\t0.00125  ",
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, line) in [
            ("400 0.5\n410\n", 2),
            ("400 0.5 7\n", 1),
            ("400 0.5\nfive 7\n", 2),
            ("nothing here\n", 0),
            ("", 0),
            ("400 0.5\n410 0,5\n", 2),
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap_err().0, line, "{text:?}");
        }
        let text = "400.5 1\n".repeat(MOST_SPECTRUM_SAMPLES + 1);
        assert_eq!(parse(text.as_bytes()).unwrap_err().0, MOST_SPECTRUM_SAMPLES + 1);
    }
}
