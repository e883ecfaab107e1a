//! Reads images as textures, in the precision in which they are stored.

use std::borrow::Cow;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;

use exr::image::{FlatImage, FlatSamples};
use half::f16;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::texels::{ColorSpace, TexelImage, Texels, check_size};
use crate::control::{Cancel, WorkProgress};
use crate::room::{check_room, collected};
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
    ImageSource::File(path.into()).read(&WorkProgress::new(&Cancel::new()))
}

/// An image and the colour space that its format suggests.
pub(crate) type ReadImage = (TexelImage, ColorSpace);

/// Where the bytes of an image are.
#[derive(Clone, Debug)]
pub(crate) enum ImageSource<'a> {
    /// In a file.
    File(Cow<'a, Path>),
    /// Here, with the extension of a file's name, if there was one.
    Bytes(Cow<'a, [u8]>, Option<String>),
}

impl ImageSource<'_> {
    /// Number of bytes; 0 where there is no such file, of which the error says more when it is read.
    fn size(&self) -> u64 {
        match self {
            Self::File(path) => path.metadata().map_or(0, |it| it.len()),
            Self::Bytes(bytes, _) => bytes.len() as u64,
        }
    }

    /// Number of texels as the header says it; 0 where it cannot be read, and of OpenEXR files.
    fn texels(&self) -> u64 {
        let of = |size: Option<[u32; 2]>| size.map_or(0, |[width, height]| u64::from(width) * u64::from(height));
        of(match self {
            Self::File(path) => {
                let extension = path.extension().and_then(|extension| extension.to_str());
                crate::desc::open_file(path, SIZE_LIMIT)
                    .ok()
                    .and_then(|file| dimensions(BufReader::new(file), extension))
            }
            Self::Bytes(bytes, extension) => dimensions(Cursor::new(bytes), extension.as_deref()),
        })
    }

    /// Reads the image. Each byte that the decoder has taken is a unit of the work.
    pub fn read(&self, work: &WorkProgress<'_>) -> Result<ReadImage> {
        match self {
            Self::File(path) => {
                let file = crate::desc::open_file(path, SIZE_LIMIT)?;
                let size = file.metadata().map_err(|error| Error::io(path, "cannot read the image", error))?.len();
                let extension = path.extension().and_then(|extension| extension.to_str());
                let reader = Watched::new(BufReader::new(file), work);
                decode(reader, size, extension).map_err(|error| error.in_file(Some(path), 0))
            }
            Self::Bytes(bytes, extension) => {
                decode(Watched::new(Cursor::new(bytes), work), bytes.len() as u64, extension.as_deref())
            }
        }
    }
}

/// Most images that are decoded at a time.
const MOST_READERS: usize = 16;

/// How images are read together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReadingTogether {
    /// No image is begun with which there would be more texels, nor any after it. Where this is a limit, headers are read before.
    pub most_texels: u64,
    /// Whether no further image is begun after an error.
    pub stops_at_error: bool,
}

/// Reads images as [`read_image`] does, several at a time, by as many threads as the machine has processors. They are begun in their
/// order; what was not read is `None`. The bytes of all images are units of the work.
///
/// # Errors
/// [`ErrorKind::Cancelled`] once the work was stopped.
pub(crate) fn read_images(
    images: &[ImageSource<'_>],
    how: ReadingTogether,
    work: &WorkProgress<'_>,
) -> Result<Vec<Option<Result<ReadImage>>>> {
    work.expect(images.iter().map(ImageSource::size).sum::<u64>() as f64);
    let read: Vec<OnceLock<_>> = images.iter().map(|_| OnceLock::new()).collect();
    let (next, texels) = (AtomicUsize::new(0), AtomicU64::new(0));
    let stop = || next.store(images.len(), Ordering::Relaxed);
    let run = || {
        let is_full = |own: u64| texels.fetch_add(own, Ordering::Relaxed).saturating_add(own) > how.most_texels;
        while let Some((source, place)) = images.iter().zip(&read).nth(next.fetch_add(1, Ordering::Relaxed)) {
            let known = if how.most_texels == u64::MAX { 0 } else { source.texels() };
            if is_full(known) {
                return stop();
            }
            let image = source.read(work);
            match &image {
                Ok((image, _)) => {
                    let own = u64::from(image.width()) * u64::from(image.height());
                    if is_full(own.saturating_sub(known)) {
                        stop();
                    }
                }
                Err(_) if how.stops_at_error || work.check().is_err() => stop(),
                Err(_) => {}
            }
            let _ = place.set(image);
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(images.len()).min(MOST_READERS);
    thread::scope(|scope| {
        for _ in 1..threads {
            // A thread that the system does not give is done without.
            let _ = thread::Builder::new().name("etendue-image".to_owned()).spawn_scoped(scope, run);
        }
        run();
    });
    work.check()?;
    Ok(read.into_iter().map(OnceLock::into_inner).collect())
}

/// A reader that counts what is taken from it as work, and fails once the work was stopped.
struct Watched<'a, 'p, R> {
    inner: R,
    work: &'a WorkProgress<'p>,
    /// Bytes that are not yet counted.
    taken: usize,
}

/// Bytes between two looks at the work.
const WATCHED_BLOCK: usize = 1 << 16;

impl<'a, 'p, R> Watched<'a, 'p, R> {
    fn new(inner: R, work: &'a WorkProgress<'p>) -> Self {
        Self { inner, work, taken: 0 }
    }

    fn count(&mut self, bytes: usize) {
        self.taken += bytes;
        if self.taken >= WATCHED_BLOCK {
            self.work.spend(std::mem::take(&mut self.taken));
        }
    }
}

impl<R> Drop for Watched<'_, '_, R> {
    fn drop(&mut self) {
        self.work.spend(self.taken);
    }
}

impl<R: BufRead> Read for Watched<'_, '_, R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let from = self.fill_buf()?;
        let count = from.len().min(to.len());
        to[..count].copy_from_slice(&from[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Watched<'_, '_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.work.check().map_err(io::Error::other)?;
        let bytes = self.inner.fill_buf()?;
        Ok(&bytes[..bytes.len().min(WATCHED_BLOCK)])
    }

    fn consume(&mut self, count: usize) {
        self.inner.consume(count);
        self.count(count);
    }
}

impl<R: Seek> Seek for Watched<'_, '_, R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

/// Reads an image from bytes of one of the formats that [`read_image`] reads. `extension`, without a dot, is needed for TGA alone, which
/// has no mark of its own.
///
/// # Errors
/// Those of [`read_image`], without a file.
pub fn read_image_bytes(bytes: &[u8], extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    ImageSource::Bytes(Cow::Borrowed(bytes), extension.map(str::to_owned)).read(&WorkProgress::new(&Cancel::new()))
}

fn decode(mut reader: impl BufRead + Seek, size: u64, extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    let start = reader.fill_buf().map_err(|error| unreadable(&error))?;
    if start.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let parts = crate::image::decode_exr_parts(reader, size)?;
        return Ok((from_exr(parts)?, ColorSpace::Linear));
    }
    let is_rgbe = start.starts_with(RGBE);
    // Decoders check what they read; should one fail in another way all the same, it must not end the program.
    catch_unwind(AssertUnwindSafe(|| if is_rgbe { rgbe(reader) } else { with_library(reader, extension) }))
        .unwrap_or_else(|_| Err(unreadable(&"its decoder failed")))
}

/// Columns and rows of an image, by its header.
fn dimensions(mut reader: impl BufRead + Seek, extension: Option<&str>) -> Option<[u32; 2]> {
    let is_rgbe = reader.fill_buf().ok()?.starts_with(RGBE);
    let read = || match is_rgbe {
        true => Some(HdrDecoder::new_nonstrict(reader).ok()?.dimensions().into()),
        false => Some(guessed(reader, extension).ok()?.into_dimensions().ok()?.into()),
    };
    catch_unwind(AssertUnwindSafe(read)).ok().flatten()
}

/// How Radiance HDR files of several programs begin; the usual beginning is "#?RADIANCE", which the library knows.
const RGBE: &[u8] = b"#?RGBE";

fn rgbe(reader: impl BufRead + Seek) -> Result<(TexelImage, ColorSpace)> {
    with_decoder(HdrDecoder::new_nonstrict(reader).map_err(|error| unreadable(&error))?)
}

/// A reader of the format that the bytes say, or the name.
fn guessed<R: BufRead + Seek>(reader: R, extension: Option<&str>) -> Result<ImageReader<R>> {
    let mut reader = ImageReader::new(reader).with_guessed_format().map_err(|error| unreadable(&error))?;
    if reader.format().is_none()
        && let Some(format) = extension.and_then(ImageFormat::from_extension)
    {
        reader.set_format(format);
    }
    Ok(reader)
}

fn with_library(reader: impl BufRead + Seek, extension: Option<&str>) -> Result<(TexelImage, ColorSpace)> {
    let mut reader = guessed(reader, extension)?;
    if reader.format().is_none() {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("not an image that is read, expected one of {FORMATS}"),
        ));
    }
    reader.limits(limits());
    with_decoder(reader.into_decoder().map_err(|error| unreadable(&error))?)
}

fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_alloc = Some(DECODER_LIMIT);
    limits
}

fn with_decoder(mut decoder: impl ImageDecoder) -> Result<(TexelImage, ColorSpace)> {
    decoder.set_limits(limits()).map_err(|error| unreadable(&error))?;
    let (width, height) = decoder.dimensions();
    check_size(width, height).map_err(|message| Error::new(ErrorKind::Unsupported, message))?;
    // The library ends the process where there is no room. Some of its decoders hold all of an image beside the one they return.
    check_room(usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX).saturating_mul(2))?;
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
            Some(planes) => {
                let values = (0..texels).flat_map(|i| planes.iter().map(move |plane| plane[i]));
                Texels::F16(collected(values, texels * planes.len())?.into())
            }
            None => {
                let values =
                    (0..texels).flat_map(|i| all.iter().map(move |plane| plane.value_by_flat_index(i).to_f32()));
                Texels::F32(collected(values, texels * all.len())?.into())
            }
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
    // Decoders print lists of numbers that a file holds.
    Error::new(ErrorKind::Io, format!("not a readable image: {}", crate::desc::elided(&reason.to_string())))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::{Arc, Mutex};

    use super::super::write_image;
    use super::*;

    #[test]
    fn radiance_files_begin_in_two_ways() {
        // Two texels without runs: mantissas and a common exponent, 2^(e - 136).
        let body = b"\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x00\x00\x80\x88";
        for head in ["#?RADIANCE", "#?RGBE"] {
            let bytes: Vec<u8> = head.bytes().chain(*body).collect();
            let (image, space) = read_image_bytes(&bytes, None).unwrap();
            assert_eq!(space, ColorSpace::Linear);
            let Texels::F32(texels) = image.texels() else { panic!("{head}") };
            let found: Vec<f32> = (0..6).map(|i| texels.get(i)).collect();
            assert_eq!(found, [1.0, 0.5, 0.25, 0.0, 0.0, 128.0], "{head}");
            assert_eq!(dimensions(Cursor::new(&bytes), None), Some([2, 1]), "{head}");
            // A file that ends in its header, and one that ends in its texels.
            for end in [8, 20, bytes.len() - 1] {
                assert!(read_image_bytes(&bytes[..end], None).is_err(), "{head} {end}");
            }
        }
    }

    fn files(folder: &Path, count: usize) -> Vec<PathBuf> {
        (0..count).map(|i| folder.join(format!("{i}.png"))).collect()
    }

    fn written(folder: &Path, count: usize, size: u32) -> Vec<PathBuf> {
        let paths = files(folder, count);
        for (i, path) in paths.iter().enumerate() {
            let mut state = i as u32;
            let texels = (0..3 * size * size).map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            });
            let image = TexelImage::new(size, size, 3, Texels::U8(texels.collect())).unwrap();
            crate::replace::replace(path, "the image", |file| write_image(&image, file)).unwrap();
        }
        paths
    }

    const ALL: ReadingTogether = ReadingTogether { most_texels: u64::MAX, stops_at_error: true };

    fn together(
        paths: &[PathBuf],
        how: ReadingTogether,
        work: &WorkProgress<'_>,
    ) -> Result<Vec<Option<Result<ReadImage>>>> {
        let sources: Vec<_> = paths.iter().map(|path| ImageSource::File(path.into())).collect();
        read_images(&sources, how, work)
    }

    #[test]
    fn images_that_are_read_together_are_those_that_are_read_alone() {
        let folder = tempfile::tempdir().unwrap();
        let paths = written(folder.path(), 40, 2);
        let progress = Arc::new(Mutex::new(vec![0.0]));
        let list = Arc::clone(&progress);
        let cancel = Cancel::new();
        let work = WorkProgress::by_steps(&cancel, Some(Arc::new(move |fraction| list.lock().unwrap().push(fraction))));
        let all = together(&paths, ALL, &work).unwrap();
        assert_eq!(all.len(), paths.len());
        for (path, read) in paths.iter().zip(all) {
            assert_eq!(read.unwrap().unwrap(), read_image(path).unwrap(), "{}", path.display());
        }
        // Other work may follow, so that only the end of all is told as 1.
        assert!(progress.lock().unwrap().last().is_some_and(|last| (0.99..1.0).contains(last)));
        work.finish();
        let progress = progress.lock().unwrap();
        assert!(progress.len() > 20 && progress.is_sorted() && progress.last() == Some(&1.0), "{progress:?}");
        assert!(together(&[], ALL, &work).unwrap().is_empty());
    }

    #[test]
    fn no_image_is_begun_after_one_that_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let paths = files(folder.path(), 1000);
        let cancel = Cancel::new();
        let work = WorkProgress::new(&cancel);
        let read = together(&paths, ALL, &work).unwrap();
        assert!(read[0].as_ref().unwrap().is_err());
        assert!(read.iter().flatten().count() <= MOST_READERS);
        let read = together(&paths, ReadingTogether { stops_at_error: false, ..ALL }, &work).unwrap();
        assert!(read.iter().flatten().count() == paths.len());
    }

    #[test]
    fn no_image_is_begun_after_the_greatest_number_of_texels() {
        let folder = tempfile::tempdir().unwrap();
        let paths = written(folder.path(), 60, 2);
        let cancel = Cancel::new();
        let read = together(&paths, ReadingTogether { most_texels: 5 * 4, ..ALL }, &WorkProgress::new(&cancel));
        let read = read.unwrap();
        assert_eq!(read.iter().flatten().count(), 5);
    }

    #[test]
    fn reasons_are_of_bounded_length() {
        let message = unreadable(&"1, ".repeat(100_000)).message().to_owned();
        assert!(message.len() < 1000 && message.starts_with("not a readable image: 1, "), "{message}");
    }

    /// An image is left before its end: after a part of its bytes.
    #[test]
    fn cancelling_stops_within_an_image() {
        let folder = tempfile::tempdir().unwrap();
        let paths = written(folder.path(), 1, 600);
        let cancel = Cancel::new();
        let last = Arc::new(Mutex::new(0.0));
        let (reported, token) = (Arc::clone(&last), cancel.clone());
        let report = move |fraction: f64| {
            *reported.lock().unwrap() = fraction;
            if fraction > 0.2 {
                token.cancel();
            }
        };
        let work = WorkProgress::by_steps(&cancel, Some(Arc::new(report)));
        let error = together(&paths, ALL, &work).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled);
        assert!(*last.lock().unwrap() < 0.5, "{last:?}");
    }
}
