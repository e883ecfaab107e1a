//! PNG: 8-bit sRGB out; 8- or 16-bit sRGB in.

use std::io::{BufRead, Seek, Write};

use ::image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, Limits};

use super::check::{MAX_PIXELS, check_size, damaged};
use super::pixels::Image;
use crate::room::{check_room, with_room};
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

/// Memory that the decoder takes beside the pixels: lines, its window, and what it has read.
const DECODER_BYTES: usize = 1 << 20;

/// Reads any PNG as linear colour without alpha.
pub(super) fn decode(reader: impl BufRead + Seek) -> Result<Image> {
    let mut limits = Limits::no_limits();
    // The largest image that is read, with 16 bits of four channels, and memory for the decoder.
    limits.max_alloc = Some(8 * MAX_PIXELS + (1 << 24));
    let decoder = PngDecoder::with_limits(reader, limits).map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(u64::from(width), u64::from(height))?;
    // The decoder's library ends the process where there is no room for the pixels and for its own buffers.
    check_room(usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX).saturating_add(DECODER_BYTES))?;
    let picture = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    let wide = |code: u16| srgb_decode(f32::from(code) / 65535.0);
    let linear: [f32; 256] = std::array::from_fn(|code| srgb_decode(code as f32 / 255.0));
    let narrow = |code: u8| linear[usize::from(code)];
    let rgb = match &picture {
        DynamicImage::ImageLuma8(it) => triples::<u8, 1>(it, narrow),
        DynamicImage::ImageLumaA8(it) => triples::<u8, 2>(it, narrow),
        DynamicImage::ImageRgb8(it) => triples::<u8, 3>(it, narrow),
        DynamicImage::ImageRgba8(it) => triples::<u8, 4>(it, narrow),
        DynamicImage::ImageLuma16(it) => triples::<u16, 1>(it, wide),
        DynamicImage::ImageLumaA16(it) => triples::<u16, 2>(it, wide),
        DynamicImage::ImageRgb16(it) => triples::<u16, 3>(it, wide),
        DynamicImage::ImageRgba16(it) => triples::<u16, 4>(it, wide),
        _ => return Err(damaged("it has pixels of a kind that PNG does not have")),
    }?;
    Ok(Image { width, height, rgb, ..Image::default() })
}

/// The colours of pixels of `N` channels: grey, or red, green and blue, with or without an opacity, which is left out.
fn triples<T: Copy, const N: usize>(codes: &[T], linear: impl Fn(T) -> f32) -> Result<Vec<f32>> {
    let pixels = codes.as_chunks::<N>().0;
    let mut rgb = with_room(3 * pixels.len())?;
    for pixel in pixels {
        // Of a grey pixel the first channel is all three.
        rgb.extend([0, N / 3, 2 * (N / 3)].map(|channel| linear(pixel[channel])));
    }
    Ok(rgb)
}

fn unreadable(error: ImageError) -> Error {
    match error {
        ImageError::Limits(error) => {
            Error::new(ErrorKind::Unsupported, format!("too large to be read: {error}")).because(error)
        }
        error => damaged(&error).because(error),
    }
}
