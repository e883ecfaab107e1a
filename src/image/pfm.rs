//! Portable float map: a text header of three tokens, then raw floats, bottom row first.

use std::io::{BufRead, Read, Write};

use super::check::{check_size, damaged};
use super::pixels::Image;
use crate::room::with_room;
use crate::{Error, ErrorKind, Result};

/// Longest accepted token of a header: a float in full decimal notation fits.
const MAX_TOKEN: usize = 64;

/// Colour, little-endian (that is what the sign of the scale says).
pub(crate) fn encode(image: &Image, file: &mut impl Write) -> Result<()> {
    let failed =
        |error: std::io::Error| Error::new(ErrorKind::Io, format!("cannot write the image: {error}")).because(error);
    write!(file, "PF\n{} {}\n-1.0\n", image.width, image.height).map_err(failed)?;
    let mut bytes = Vec::with_capacity(12 * image.width as usize);
    for row in image.rgb.chunks_exact(3 * image.width as usize).rev() {
        bytes.clear();
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        file.write_all(&bytes).map_err(failed)?;
    }
    Ok(())
}

/// Grey or colour, either byte order. Memory grows with the file's contents, not with the size in its header.
pub(super) fn decode(mut reader: impl BufRead) -> Result<Image> {
    let channels = match token(&mut reader)?.as_str() {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err(damaged("it does not begin with 'PF' or 'Pf' as a PFM does")),
    };
    let mut length = |what: &str| {
        let text = token(&mut reader)?;
        text.parse::<u64>().map_err(|_| damaged(format!("its {what} is '{text}'")))
    };
    let (width, height) = (length("width")?, length("height")?);
    let (width, height) = check_size(width, height)?;
    let text = token(&mut reader)?;
    let scale = text.parse::<f32>().ok().filter(|scale| scale.is_finite() && *scale != 0.0);
    let scale = scale.ok_or_else(|| damaged(format!("its scale is '{text}'")))?;

    let pixels = width as usize * height as usize;
    let expected = 4 * channels * pixels;
    let mut bytes = Vec::new();
    reader.take(expected as u64).read_to_end(&mut bytes).map_err(|error| match error.kind() {
        std::io::ErrorKind::OutOfMemory => {
            Error::new(ErrorKind::OutOfMemory, format!("no room for {expected} bytes")).because(error)
        }
        _ => damaged(error),
    })?;
    if bytes.len() != expected {
        return Err(damaged(format!("it ends after {} of {expected} bytes of pixels", bytes.len())));
    }

    let from_bytes = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    // A factor of 1 is left out and not multiplied by, so that every bit of a NaN is kept too.
    let factor = Some(scale.abs()).filter(|factor| *factor != 1.0);
    let mut rgb = with_room(3 * pixels)?;
    for row in bytes.chunks_exact(4 * channels * width as usize).rev() {
        for value in row.chunks_exact(4) {
            let value = from_bytes([value[0], value[1], value[2], value[3]]);
            let value = factor.map_or(value, |factor| value * factor);
            rgb.extend(std::iter::repeat_n(value, 3 / channels));
        }
    }
    Ok(Image { width, height, rgb, ..Image::default() })
}

/// The next word of the header and the one white space character that ends it.
fn token(reader: &mut impl BufRead) -> Result<String> {
    let mut token = String::new();
    for byte in reader.by_ref().bytes() {
        match byte.map_err(damaged)? {
            byte if byte.is_ascii_whitespace() && token.is_empty() => {}
            byte if byte.is_ascii_whitespace() => return Ok(token),
            byte if byte.is_ascii_graphic() && token.len() < MAX_TOKEN => token.push(char::from(byte)),
            _ => return Err(damaged("its header is not that of a PFM")),
        }
    }
    Err(damaged("it ends within its header"))
}
