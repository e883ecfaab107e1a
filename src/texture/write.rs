//! Writes images of textures in files that keep every bit: PNG for integers, OpenEXR for floating point.

use std::io::{self, Write};

use exr::image::{AnyChannel, FlatSamples};
use half::f16;

use super::texels::{TexelImage, Texels};
use crate::Result;
use crate::buffer::{Buffer, Element};
use crate::image::{encode_exr_channels, encode_png};
use crate::replace::Target;
use crate::room::with_room;

/// Most threads that compress one image.
const MAX_THREADS: usize = 8;

/// The extension of the name of the file that keeps this image: `png` or `exr`.
pub(crate) fn extension(image: &TexelImage) -> &'static str {
    match image.texels() {
        Texels::U8(_) | Texels::U16(_) => "png",
        Texels::F16(_) | Texels::F32(_) => "exr",
    }
}

/// Writes an image, from which [`super::read_image`] reads the same texels.
///
/// # Errors
/// [`ErrorKind::Io`] for anything that the file system refuses, [`ErrorKind::OutOfMemory`].
pub(crate) fn write_image(image: &TexelImage, file: &mut Target<'_>) -> Result<()> {
    let size = [image.width(), image.height()];
    match image.texels() {
        Texels::U8(values) => {
            let bytes = reserved(image.value_count(), image.without_gaps(values))?;
            encode_png(&bytes, size, image.channels(), 8, file)
        }
        Texels::U16(values) => {
            let bytes = image.without_gaps(values).flat_map(u16::to_ne_bytes);
            let bytes = reserved(2 * image.value_count(), bytes)?;
            encode_png(&bytes, size, image.channels(), 16, file)
        }
        Texels::F16(values) => channels(image, values, size, FlatSamples::F16, file),
        Texels::F32(values) => channels(image, values, size, FlatSamples::F32, file),
    }
}

/// Writes the size of an image, its kind of numbers and its texels, without any format that could be read.
pub(crate) fn put_texels(image: &TexelImage, out: &mut impl Write) -> io::Result<()> {
    write!(out, "{} {} {} ", image.width(), image.height(), image.channels())?;
    match image.texels() {
        Texels::U8(values) => image.without_gaps(values).try_for_each(|value| out.write_all(&[value])),
        Texels::U16(values) => put_all(out, "16", image.without_gaps(values).map(u16::to_le_bytes)),
        Texels::F16(values) => put_all(out, "half", image.without_gaps(values).map(f16::to_le_bytes)),
        Texels::F32(values) => put_all(out, "float", image.without_gaps(values).map(f32::to_le_bytes)),
    }
}

fn put_all<const N: usize>(
    out: &mut impl Write,
    kind: &str,
    mut values: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    out.write_all(kind.as_bytes())?;
    values.try_for_each(|value| out.write_all(&value))
}

/// Writes the channels of an image by the names that they have in OpenEXR.
fn channels<T: Element>(
    image: &TexelImage,
    values: &Buffer<T>,
    size: [u32; 2],
    samples: fn(Vec<T>) -> FlatSamples,
    file: &mut Target<'_>,
) -> Result<()> {
    let names: &[&str] = match image.channels() {
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let mut planes = Vec::new();
    for (channel, name) in names.iter().enumerate() {
        let plane = image.without_gaps(values).skip(channel).step_by(names.len());
        planes.push(AnyChannel::new(*name, samples(reserved(image.value_count() / names.len(), plane)?)));
    }
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS);
    encode_exr_channels(planes, size, threads, file)
}

/// A list whose memory is asked for, since images may be large.
fn reserved<T>(length: usize, values: impl Iterator<Item = T>) -> Result<Vec<T>> {
    let mut list = with_room(length)?;
    list.extend(values);
    Ok(list)
}

#[cfg(test)]
mod tests {
    use half::f16;

    use super::super::{ColorSpace, read_image};
    use super::*;

    #[test]
    fn every_format_and_number_of_channels_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let (width, height) = (5, 3);
        for channels in 1..=4 {
            let count = (width * height * channels) as usize;
            let numbers = || (0..count).map(|i| i as f32 * 1.7e-3 - 0.01);
            for (texels, space) in [
                (Texels::U8((0..count).map(|i| (i * 41 % 256) as u8).collect()), ColorSpace::Srgb),
                (Texels::U16((0..count).map(|i| (i * 4099 % 65536) as u16).collect()), ColorSpace::Srgb),
                (Texels::F16(numbers().map(f16::from_f32).collect()), ColorSpace::Linear),
                (Texels::F32(numbers().map(|x| x * 1e9).collect()), ColorSpace::Linear),
            ] {
                let image = TexelImage::new(width, height, channels, texels).unwrap();
                let path = folder.path().join(format!("image.{}", extension(&image)));
                crate::replace::replace(&path, "the image", |file| write_image(&image, file)).unwrap();
                assert_eq!(read_image(&path).unwrap(), (image, space), "{channels} channels");
            }
            // Rows with gaps, as hosts have them.
            let row = (width * channels + 3) as usize;
            let count = row * (height as usize - 1) + (width * channels) as usize;
            let value = |i: usize| i as f32 * 0.1;
            for (with_gaps, dense) in [
                (
                    Texels::U16((0..count).map(|i| i as u16).collect()),
                    Texels::U16(
                        (0..count).filter(|i| i % row < (width * channels) as usize).map(|i| i as u16).collect(),
                    ),
                ),
                (
                    Texels::F32((0..count).map(value).collect()),
                    Texels::F32((0..count).filter(|i| i % row < (width * channels) as usize).map(value).collect()),
                ),
            ] {
                let image = TexelImage::with_rows(width, height, channels, row, with_gaps).unwrap();
                let path = folder.path().join(format!("gaps.{}", extension(&image)));
                crate::replace::replace(&path, "the image", |file| write_image(&image, file)).unwrap();
                let expected = TexelImage::new(width, height, channels, dense).unwrap();
                assert_eq!(read_image(&path).unwrap().0, expected, "{channels} channels with gaps");
            }
        }
    }
}
