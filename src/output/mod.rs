//! Image files: writes and reads [`Image`], maps it to a display, and compares two of them. Files of photons:
//! [`write_photons`]. Files of light maps: [`light_map_image`], [`write_atlas`], [`write_vertices`].
//!
//! The extension of the file's name chooses the format:
//!
//! | extension | values | layers | note |
//! |---|---|---|---|
//! | `.exr` | 32-bit float, every bit kept | all | OpenEXR, ZIP compressed; channel names: [`Format::Exr`] |
//! | `.pfm` | 32-bit float, every bit kept | none | little-endian, bottom row first |
//! | `.png` | 8-bit sRGB | none | through a [`ToneMap`] and an exposure |
//!
//! A file appears whole or not at all: it is written under another name in the same folder, flushed to the disk, and
//! renamed. A run that is killed leaves the file that was there before.
//!
//! ```
//! use etendue::film::Image;
//! use etendue::output::{self, WriteOptions};
//!
//! # fn main() -> etendue::Result<()> {
//! # let folder = tempfile::tempdir().unwrap();
//! # let path = folder.path().join("grey.pfm");
//! let image = Image { width: 2, height: 1, rgb: vec![0.18; 6], layers: Vec::new() };
//! output::write(&image, &path, &WriteOptions::default())?;
//! assert_eq!(output::read(&path)?, image);
//! # Ok(())
//! # }
//! ```

mod attributes;
mod bake;
mod exr;
mod metrics;
mod pfm;
mod photons;
mod png;
mod replace;
mod tone;

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::thread;

use crate::film::Image;
use crate::{Error, ErrorKind, Result};

pub use attributes::{Attribute, summary_attributes};
pub use bake::{VertexValues, light_map_image, write_atlas, write_vertices};
pub use metrics::{Metrics, REL_MSE_EPSILON, compare};
pub use photons::{PhotonFormat, check_photon_target, write_photons};
pub use tone::{ToneMap, to_srgb8};

/// Greatest number of pixels that [`read`] accepts: 2^28, which is 16384 x 16384.
///
/// A header of a few bytes can claim gigabytes of pixels; larger claims are refused.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Most threads that write one image.
const MAX_THREADS: usize = 64;

/// A kind of image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// OpenEXR: one part, scan lines, 32-bit float, ZIP compression (lossless).
    ///
    /// The image is `R`, `G`, `B` of the default layer, which every viewer shows first. A further layer is a group of
    /// channels with its name in front: `normal.X`, `normal.Y`, `normal.Z`; `depth.Z`; `.R`, `.G`, `.B` for any other
    /// layer of three values (`albedo.R`), and `.Y`, OpenEXR's name for a grey channel, for any other of one
    /// (`samples.Y`). The chromaticities of Rec. 709 are stated in the header.
    Exr,
    /// Portable float map, colour (`PF`).
    Pfm,
    /// PNG, 8 bits per channel, sRGB.
    Png,
}

impl Format {
    /// The format that the extension of `path` names, in any case; [`ErrorKind::Unsupported`] for any other.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let reason = match extension.as_deref() {
            Some("exr") => return Ok(Self::Exr),
            Some("pfm") => return Ok(Self::Pfm),
            Some("png") => return Ok(Self::Png),
            Some(other) => format!("no image format is known by the extension '.{other}'"),
            None => "the name has no extension to tell the image format by".to_owned(),
        };
        Err(Error::new(ErrorKind::Unsupported, format!("{reason}: use .exr, .pfm or .png")).in_file(Some(path), 0))
    }
}

/// How [`write()`] writes. The defaults are an sRGB picture of the plain values, clamped, without comments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// How radiance becomes brightness in a PNG. Float formats keep radiance.
    pub tone_map: ToneMap,
    /// Factor 2^exposure before the tone map, in stops within [-64, 64]. PNG only.
    pub exposure: f32,
    /// Free text for the `comments` attribute of an EXR, UTF-8; empty for none.
    pub comments: String,
    /// Further attributes of an EXR by name, such as [`summary_attributes`]; those that are not finite are left out.
    pub attributes: Vec<(String, Attribute)>,
    /// Threads that compress an EXR, the calling one among them, 64 at most; 0 means one per core. The others have ended
    /// when the image is written. The file does not depend on it.
    pub threads: usize,
}

/// Writes `image` to `path` in the format of its extension; an existing file is replaced in one step.
///
/// A PNG has no value for non-finite numbers: NaN becomes black and positive infinity white.
///
/// Errors: [`ErrorKind::Unsupported`] for an unknown extension or an empty image, [`ErrorKind::InvalidScene`] for an
/// exposure out of its domain, [`ErrorKind::Internal`] for an image whose slices do not fit its size, [`ErrorKind::Io`]
/// for anything the file system refuses; then the file that was there is still there, whole.
pub fn write(image: &Image, path: &Path, options: &WriteOptions) -> Result<()> {
    let format = Format::from_path(path)?;
    check_image(image).map_err(|error| error.in_file(Some(path), 0))?;
    tone::check_exposure(options.exposure)?;
    let threads = match options.threads {
        0 => thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    }
    .min(MAX_THREADS);
    replace::replace(path, "the image", |file| match format {
        Format::Exr => exr::encode(image, options, threads, file),
        Format::Pfm => pfm::encode(image, file),
        Format::Png => png::encode(image, options.tone_map, options.exposure, file),
    })
}

/// Writes a text file as [`write()`] writes images: it appears whole or not at all.
///
/// Errors: [`ErrorKind::Io`] for anything the file system refuses.
pub fn write_text(text: &str, path: &Path) -> Result<()> {
    use std::io::Write as _;
    let failed = |error| Error::new(ErrorKind::Io, format!("cannot write the file: {error}")).because(error);
    replace::replace(path, "the file", |file| file.write_all(text.as_bytes()).map_err(failed))
}

/// Whether [`write_text`] could write to `path` now, without doing so.
pub fn check_text_target(path: &Path) -> Result<()> {
    replace::check(path, "the file")
}

/// Whether [`write()`] could write to `path` now, without doing so: known extension, a folder that exists and accepts a
/// new file, nothing but a regular file in the way.
pub fn check_target(path: &Path) -> Result<Format> {
    let format = Format::from_path(path)?;
    replace::check(path, "the image")?;
    Ok(format)
}

/// Reads an image from an `.exr`, `.pfm` or `.png` file.
///
/// PNG (8 and 16 bits, grey or colour) is decoded to scene-linear values in [0, 1]; alpha is left out. PFM may be grey
/// or colour and of either byte order; values are multiplied by the magnitude of its scale. EXR may be of any program:
/// `R`, `G`, `B` (or `Y` alone) without a layer's name make the image, from the part that has them, over the data
/// window; groups of one or three channels of the same size become layers, in the order `albedo`, `normal`, `depth`,
/// `samples`, `variance`, then by name. Deep data and subsampled channels are not supported.
///
/// Errors name the file: [`ErrorKind::Unsupported`] for an unknown extension, more than [`MAX_PIXELS`] pixels, or a
/// feature of the format that is not read; [`ErrorKind::Io`] for a file that is missing, cut short or damaged.
pub fn read(path: &Path) -> Result<Image> {
    let format = Format::from_path(path)?;
    let metadata = fs::metadata(path).map_err(|error| Error::io(path, "cannot read the image", error))?;
    if metadata.is_dir() {
        return Err(Error::new(ErrorKind::Io, "cannot read the image: it is a folder").in_file(Some(path), 0));
    }
    let file = File::open(path).map_err(|error| Error::io(path, "cannot read the image", error))?;
    let reader = BufReader::new(file);
    match format {
        Format::Exr => exr::decode(reader, metadata.len()),
        Format::Pfm => pfm::decode(reader),
        Format::Png => png::decode(reader),
    }
    .map_err(|error| error.in_file(Some(path), 0))
}

/// Refuses what no format can hold, so that the encoders may index freely.
fn check_image(image: &Image) -> Result<()> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    if pixels == 0 {
        let message = format!("an image of {} x {} pixels cannot be written", image.width, image.height);
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let broken = |what: &str, found: usize, expected: u64| {
        Error::new(ErrorKind::Internal, format!("{what} has {found} values where the image's size asks for {expected}"))
    };
    if image.rgb.len() as u64 != 3 * pixels {
        return Err(broken("the image", image.rgb.len(), 3 * pixels));
    }
    let mut names = HashSet::new();
    for layer in &image.layers {
        if !matches!(layer.channels, 1 | 3) || layer.name.is_empty() || layer.name.len() > 200 {
            let message =
                format!("layer '{}' needs a short name and 1 or 3 channels, not {}", layer.name, layer.channels);
            return Err(Error::new(ErrorKind::Internal, message));
        }
        if !names.insert(&layer.name) {
            return Err(Error::new(ErrorKind::Internal, format!("two layers are named '{}'", layer.name)));
        }
        let expected = layer.channels as u64 * pixels;
        if layer.data.len() as u64 != expected {
            return Err(broken(&format!("layer '{}'", layer.name), layer.data.len(), expected));
        }
    }
    Ok(())
}

/// Refuses sizes read from a file that are empty or beyond [`MAX_PIXELS`].
fn check_size(width: u64, height: u64) -> Result<(u32, u32)> {
    let too_large = || {
        let message = format!("{width} x {height} pixels are more than the {MAX_PIXELS} that are read");
        Error::new(ErrorKind::Unsupported, message)
    };
    if width == 0 || height == 0 {
        return Err(damaged(format!("its size is {width} x {height} pixels")));
    }
    if width.checked_mul(height).is_none_or(|pixels| pixels > MAX_PIXELS) {
        return Err(too_large());
    }
    let convert = |length: u64| u32::try_from(length).map_err(|_| too_large());
    Ok((convert(width)?, convert(height)?))
}

/// A file that is not what its extension says, or not all of it.
fn damaged(reason: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Io, format!("not a readable image: {reason}"))
}
