//! Reads images as textures, in the precision in which they are stored.

use std::io::{BufRead, BufReader, Cursor, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use exr::image::{FlatImage, FlatSamples};
use half::f16;
use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};

use super::texels::{ColorSpace, TexelImage, Texels, check_size};
use crate::{Error, ErrorKind, Result};

/// Size of the largest image file, 4 GiB.
const SIZE_LIMIT: u64 = 4 << 30;

/// Bytes that a decoder may take for itself: an image of the most texels with four channels of 32 bits.
const DECODER_LIMIT: u64 = 16 * super::texels::MOST_TEXELS;

/// The names that formats have in messages.
const FORMATS: &str = "PNG, JPEG, TGA, BMP, WebP, TIFF, Radiance HDR, OpenEXR";

/// Reads an image file, and the colour space that its format suggests: that of sRGB for integers, linear light for floating point.
///
/// # Errors
/// [`ErrorKind::Io`] or [`ErrorKind::Unsupported`], with the file. An image of more than 2^28 texels is refused before it is decoded.
pub fn read_image(path: &Path) -> Result<(TexelImage, ColorSpace)> {
    let file = crate::desc::open_file(path, SIZE_LIMIT)?;
    let size = file.metadata().map_err(|error| Error::io(path, "cannot read the image", error))?.len();
    let extension = path.extension().and_then(|extension| extension.to_str());
    decode(BufReader::new(file), size, extension).map_err(|error| error.in_file(Some(path), 0))
}

/// Most images that are decoded at a time.
const MOST_READERS: usize = 16;

/// Reads image files as [`read_image`] does, several at a time, by as many threads as the machine has processors. After an error no
/// further file is begun; what was not read is `None`.
pub(crate) fn read_images(paths: &[PathBuf]) -> Vec<Option<Result<(TexelImage, ColorSpace)>>> {
    let read: Vec<OnceLock<_>> = paths.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some((path, place)) = paths.iter().zip(&read).nth(next.fetch_add(1, Ordering::Relaxed)) {
            let image = read_image(path);
            if image.is_err() {
                next.store(paths.len(), Ordering::Relaxed);
            }
            let _ = place.set(image);
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(paths.len()).min(MOST_READERS);
    thread::scope(|scope| {
        for _ in 1..threads {
            // A thread that the system does not give is done without.
            let _ = thread::Builder::new().name("etendue-image".to_owned()).spawn_scoped(scope, work);
        }
        work();
    });
    read.into_iter().map(OnceLock::into_inner).collect()
}

/// Reads an image from bytes of one of the formats that [`read_image`] reads. `extension`, without a dot, is needed for TGA alone, which
/// has no mark of its own.
///
/// # Errors
/// Those of [`read_image`], without a file.
pub fn read_image_bytes(bytes: &[u8], extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    decode(Cursor::new(bytes), bytes.len() as u64, extension)
}

fn decode(mut reader: impl BufRead + Seek, size: u64, extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    let start = reader.fill_buf().map_err(|error| unreadable(&error))?;
    if start.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let parts = crate::image::decode_exr_parts(reader, size)?;
        return Ok((from_exr(parts)?, ColorSpace::Linear));
    }
    // Decoders check what they read; should one fail in another way all the same, it must not end the program.
    catch_unwind(AssertUnwindSafe(|| with_library(reader, extension)))
        .unwrap_or_else(|_| Err(unreadable(&"its decoder failed")))
}

fn with_library(reader: impl BufRead + Seek, extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    let mut reader = ImageReader::new(reader).with_guessed_format().map_err(|error| unreadable(&error))?;
    if reader.format().is_none()
        && let Some(format) = extension.and_then(ImageFormat::from_extension)
    {
        reader.set_format(format);
    }
    if reader.format().is_none() {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("not an image that is read, expected one of {FORMATS}"),
        ));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODER_LIMIT);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| unreadable(&error))?;
    let (width, height) = decoder.dimensions();
    check_size(width, height).map_err(|message| Error::new(ErrorKind::Unsupported, message))?;
    let image = DynamicImage::from_decoder(decoder).map_err(|error| unreadable(&error))?;
    let (channels, texels, space) = match image {
        DynamicImage::ImageLuma8(it) => (1, Texels::U8(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageLumaA8(it) => (2, Texels::U8(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageRgb8(it) => (3, Texels::U8(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageRgba8(it) => (4, Texels::U8(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageLuma16(it) => (1, Texels::U16(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageLumaA16(it) => (2, Texels::U16(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageRgb16(it) => (3, Texels::U16(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageRgba16(it) => (4, Texels::U16(it.into_raw().into()), ColorSpace::Srgb),
        DynamicImage::ImageRgb32F(it) => (3, Texels::F32(it.into_raw().into()), ColorSpace::Linear),
        DynamicImage::ImageRgba32F(it) => (4, Texels::F32(it.into_raw().into()), ColorSpace::Linear),
        _ => return Err(Error::new(ErrorKind::Unsupported, "the image has texels of a kind that is not read")),
    };
    made(width, height, channels, texels).map(|image| (image, space))
}

/// The first part of a file that has colours: R, G, B, or Y, or a single channel of any name; with A where it has one.
fn from_exr(file: FlatImage) -> Result<TexelImage> {
    let mut found = Vec::new();
    for part in file.layer_data {
        let names: Vec<String> = part
            .channel_data
            .list
            .iter()
            .map(|channel| String::from_utf8_lossy(channel.name.as_slice()).into_owned())
            .collect();
        let index = |name: &str| names.iter().position(|own| own == name);
        let color = match [index("R"), index("G"), index("B")] {
            [Some(r), Some(g), Some(b)] => vec![r, g, b],
            _ => match index("Y").or((names.len() == 1).then_some(0)) {
                Some(grey) => vec![grey],
                None => {
                    found.extend(names);
                    continue;
                }
            },
        };
        let planes: Vec<usize> = color.into_iter().chain(index("A").filter(|_| names.len() > 1)).collect();
        let all: Vec<&FlatSamples> = planes.iter().map(|&plane| &part.channel_data.list[plane].sample_data).collect();
        let texels = part.size.area();
        let halves: Option<Vec<&Vec<f16>>> = all
            .iter()
            .map(|samples| match samples {
                FlatSamples::F16(values) => Some(values),
                _ => None,
            })
            .collect();
        let values = match halves {
            Some(planes) => Texels::F16((0..texels).flat_map(|i| planes.iter().map(move |plane| plane[i])).collect()),
            None => Texels::F32(
                (0..texels).flat_map(|i| all.iter().map(move |plane| plane.value_by_flat_index(i).to_f32())).collect(),
            ),
        };
        let size = [part.size.width(), part.size.height()].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        return made(size[0], size[1], planes.len() as u32, values);
    }
    found.truncate(8);
    let message = format!("the image has no channels R, G, B or Y of its own, but {}", found.join(", "));
    Err(Error::new(ErrorKind::Unsupported, message))
}

fn made(width: u32, height: u32, channels: u32, texels: Texels) -> Result<TexelImage> {
    TexelImage::new(width, height, channels, texels).map_err(|message| Error::new(ErrorKind::Unsupported, message))
}

fn unreadable(reason: &dyn std::fmt::Display) -> Error {
    Error::new(ErrorKind::Io, format!("not a readable image: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::super::write_image;
    use super::*;

    #[test]
    fn images_that_are_read_together_are_those_that_are_read_alone() {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<PathBuf> = (0..40).map(|i| folder.path().join(format!("{i}.png"))).collect();
        for (i, path) in paths.iter().enumerate() {
            let texels = Texels::U8(vec![i as u8; 12].into());
            let image = TexelImage::new(2, 2, 3, texels).unwrap();
            crate::replace::replace(path, "the image", |file| write_image(&image, file)).unwrap();
        }
        let all = read_images(&paths);
        assert_eq!(all.len(), paths.len());
        for (path, read) in paths.iter().zip(all) {
            assert_eq!(read.unwrap().unwrap(), read_image(path).unwrap(), "{}", path.display());
        }
        assert!(read_images(&[]).is_empty());
    }

    #[test]
    fn no_image_is_begun_after_one_that_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<PathBuf> = (0..1000).map(|i| folder.path().join(format!("{i}.png"))).collect();
        let read = read_images(&paths);
        assert!(read[0].as_ref().unwrap().is_err());
        assert!(read.iter().flatten().count() <= MOST_READERS);
    }
}
