//! The numbers after the header of a PLY file, one after the other, whatever their encoding.

use std::io::{self, BufRead, ErrorKind};

use super::ply_header::{Encoding, Property, Scalar};
use super::{LINE_LIMIT, is_number, read_line, shortened};

/// Why a number cannot be had.
#[derive(Debug)]
pub(super) enum Trouble {
    /// The file ends.
    End,
    /// The file cannot be read.
    Io(io::Error),
    /// What is there is something else.
    Bad(String),
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        if error.kind() == ErrorKind::UnexpectedEof { Self::End } else { Self::Io(error) }
    }
}

/// Reads the numbers of elements. In a text file each element has a line.
pub(super) struct Values<R> {
    pub reader: R,
    encoding: Encoding,
    text: Vec<u8>,
    /// Where in `text` the next word begins.
    at: usize,
    /// One-based number of the line, 0 in a binary file.
    pub line: usize,
    /// The number of lines with more values than their elements have.
    pub longer_lines: usize,
}

impl<R: BufRead> Values<R> {
    /// Reads after a header of so many lines.
    pub fn new(reader: R, encoding: Encoding, lines: usize) -> Self {
        let line = if encoding == Encoding::Text { lines } else { 0 };
        Self { reader, encoding, text: Vec::new(), at: 0, line, longer_lines: 0 }
    }

    /// Begins an element.
    pub fn begin(&mut self) -> Result<(), Trouble> {
        if self.encoding != Encoding::Text {
            return Ok(());
        }
        loop {
            let fits = read_line(&mut self.reader, &mut self.text)?;
            if self.text.is_empty() {
                return Err(Trouble::End);
            }
            self.line += 1;
            if !fits {
                return Err(Trouble::Bad(format!("the line is longer than {LINE_LIMIT} bytes")));
            }
            self.at = 0;
            if !self.text.trim_ascii().is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends an element.
    pub fn end(&mut self) {
        let rest = self.text.get(self.at..).unwrap_or_default();
        if self.encoding == Encoding::Text && !rest.trim_ascii().is_empty() {
            self.longer_lines += 1;
        }
    }

    /// The next number, which is finite.
    pub fn number(&mut self, kind: Scalar) -> Result<f64, Trouble> {
        let value = match self.encoding {
            Encoding::Text => return text_number(self.word()?, kind),
            Encoding::LittleEndian => {
                let bytes = self.bytes(kind)?;
                binary(kind, bytes)
            }
            Encoding::BigEndian => {
                let mut bytes = self.bytes(kind)?;
                bytes[..kind.size()].reverse();
                binary(kind, bytes)
            }
        };
        if value.is_finite() { Ok(value) } else { Err(Trouble::Bad(format!("{value} is not a finite number"))) }
    }

    /// Leaves out the value of a property.
    pub fn skip(&mut self, property: &Property) -> Result<(), Trouble> {
        let count = match property.count {
            None => 1,
            Some(kind) => self.count(kind)?,
        };
        for _ in 0..count {
            if self.encoding == Encoding::Text {
                self.word()?;
            } else {
                self.bytes(property.kind)?;
            }
        }
        Ok(())
    }

    /// The count of a list.
    pub fn count(&mut self, kind: Scalar) -> Result<u64, Trouble> {
        let count = self.number(kind)?;
        if count < 0.0 {
            return Err(Trouble::Bad(format!("{count} is not the length of a list")));
        }
        Ok(count as u64)
    }

    /// Whether there is more in the file.
    pub fn has_more(&mut self) -> io::Result<bool> {
        let rest = self.reader.fill_buf()?;
        Ok(if self.encoding == Encoding::Text { !rest.trim_ascii().is_empty() } else { !rest.is_empty() })
    }

    fn bytes(&mut self, kind: Scalar) -> Result<[u8; 8], Trouble> {
        let mut bytes = [0; 8];
        self.reader.read_exact(&mut bytes[..kind.size()])?;
        Ok(bytes)
    }

    fn word(&mut self) -> Result<&[u8], Trouble> {
        let rest = &self.text[self.at..];
        let begin = rest.iter().position(|byte| !byte.is_ascii_whitespace());
        let begin = begin.ok_or_else(|| Trouble::Bad("the line has no more values".to_owned()))?;
        let length = rest[begin..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - begin);
        let start = self.at + begin;
        self.at = start + length;
        Ok(&self.text[start..start + length])
    }
}

fn text_number(word: &[u8], kind: Scalar) -> Result<f64, Trouble> {
    let word = String::from_utf8_lossy(word);
    if !is_number(&word) {
        return Err(Trouble::Bad(format!("'{}' is not a finite number", shortened(&word))));
    }
    let value: f64 = word.parse().unwrap_or(0.0);
    if kind == Scalar::F32 {
        // The type of the number decides, as in a binary file.
        let rounded = value as f32;
        if rounded.is_finite() {
            return Ok(rounded.into());
        }
        return Err(Trouble::Bad(format!("'{}' is beyond single precision", shortened(&word))));
    }
    match kind.range() {
        Some([low, high]) if value.fract() != 0.0 || !(low..=high).contains(&value) => {
            Err(Trouble::Bad(format!("'{}' is not a whole number from {low} to {high}", shortened(&word))))
        }
        _ => Ok(value),
    }
}

/// The number in the first bytes, of little endian.
fn binary(kind: Scalar, bytes: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = bytes;
    match kind {
        Scalar::I8 => i8::from_le_bytes([a]).into(),
        Scalar::U8 => a.into(),
        Scalar::I16 => i16::from_le_bytes([a, b]).into(),
        Scalar::U16 => u16::from_le_bytes([a, b]).into(),
        Scalar::I32 => i32::from_le_bytes([a, b, c, d]).into(),
        Scalar::U32 => u32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F32 => f32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F64 => f64::from_le_bytes(bytes),
    }
}
