//! PNG: 8-bit sRGB out; 8- or 16-bit sRGB in.

use std::io::{BufRead, Seek, Write};

use ::image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, Limits};

use super::check::{MAX_PIXELS, check_size, damaged};
use super::pixels::Image;
use crate::spectrum::srgb_decode;
use crate::{Error, ErrorKind, Result};

/// Writes `[height][width][3]` sRGB bytes.
pub(crate) fn encode(pixels: &[u8], [width, height]: [u32; 2], file: &mut impl Write) -> Result<()> {
    // Most of an image with few samples is noise, which no method compresses. For images with many samples, stronger
    // compression would gain a hundredth in five times the time.
    PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive)
        .write_image(pixels, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| Error::new(ErrorKind::Io, format!("cannot write the image: {error}")).because(error))
}

/// Writes `[height][width][channels]` numbers of 8 or 16 bits, the latter in the machine's order of bytes.
pub(crate) fn encode_texels(
    bytes: &[u8],
    [width, height]: [u32; 2],
    channels: u32,
    bits: u32,
    file: &mut impl Write,
) -> Result<()> {
    let kind = match (channels, bits) {
        (1, 8) => ExtendedColorType::L8,
        (2, 8) => ExtendedColorType::La8,
        (3, 8) => ExtendedColorType::Rgb8,
        (_, 8) => ExtendedColorType::Rgba8,
        (1, _) => ExtendedColorType::L16,
        (2, _) => ExtendedColorType::La16,
        (3, _) => ExtendedColorType::Rgb16,
        (_, _) => ExtendedColorType::Rgba16,
    };
    PngEncoder::new_with_quality(file, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, kind)
        .map_err(|error| Error::new(ErrorKind::Io, format!("cannot write the image: {error}")).because(error))
}

/// Reads any PNG as linear colour without alpha.
pub(super) fn decode(reader: impl BufRead + Seek) -> Result<Image> {
    let mut limits = Limits::no_limits();
    // The largest image that is read, with 16 bits of four channels, and memory for the decoder.
    limits.max_alloc = Some(8 * MAX_PIXELS + (1 << 24));
    let decoder = PngDecoder::with_limits(reader, limits).map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(u64::from(width), u64::from(height))?;
    let picture = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    let rgb = match picture {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let decode = |&code: &u16| srgb_decode(f32::from(code) / 65535.0);
            picture.into_rgb16().as_raw().iter().map(decode).collect()
        }
        _ => {
            let linear: [f32; 256] = std::array::from_fn(|code| srgb_decode(code as f32 / 255.0));
            picture.into_rgb8().as_raw().iter().map(|&code| linear[usize::from(code)]).collect()
        }
    };
    Ok(Image { width, height, rgb, ..Image::default() })
}

fn unreadable(error: ImageError) -> Error {
    match error {
        ImageError::Limits(error) => {
            Error::new(ErrorKind::Unsupported, format!("too large to be read: {error}")).because(error)
        }
        error => damaged(&error).because(error),
    }
}
