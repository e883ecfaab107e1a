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
//! let image = Image { width: 2, height: 1, rgb: vec![0.18; 6], ..Image::default() };
//! output::write(&image, &path, &WriteOptions::default())?;
//! assert_eq!(output::read(&path)?, image);
//! # Ok(())
//! # }
//! ```

mod attributes;
mod bake;
pub mod cryptomatte;
mod metrics;
mod photons;
mod tone;

use std::path::Path;
use std::thread;

use crate::image::{Image, Layer, check_image, exr, pfm, png};
use crate::math::DVec3;
use crate::room::check_room;
use crate::spectrum::Primaries;
use crate::{Error, ErrorKind, Result, replace};

pub use crate::image::{Attribute, Format, MAX_PIXELS, read};
pub use attributes::{spectral_attributes, spectral_layer, summary_attributes};
pub use bake::{VertexValues, light_map_image, write_atlas, write_vertices};
pub use metrics::{Metrics, REL_MSE_EPSILON, compare};
pub use photons::{PhotonFormat, check_photon_target, write_photons};
pub use tone::{ToneMap, to_srgb8};

/// Most threads that write one image.
const MAX_THREADS: usize = 64;

/// How [`write()`] writes. The defaults are an sRGB picture of the plain values, clamped, without comments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// How radiance becomes brightness in a PNG. Float formats keep radiance.
    pub tone_map: ToneMap,
    /// Factor 2^exposure before the tone map, in stops within [-64, 64]. PNG only.
    pub exposure: f32,
    /// The primaries of the colours of an EXR or PFM, and of the layer `albedo`; other layers, such as `variance`, stay those of Rec. 709. A
    /// PNG is always sRGB.
    pub primaries: Primaries,
    /// Free text for the `comments` attribute of an EXR, UTF-8; empty for none.
    pub comments: String,
    /// Further attributes of an EXR by name, such as [`summary_attributes`]; those that are not finite are left out.
    pub attributes: Vec<(String, Attribute)>,
    /// Threads that compress an EXR or make the values of a PNG, the calling one among them, 64 at most; 0 means one per core. The
    /// others have ended when the image is written. The file does not depend on it.
    pub threads: usize,
}

/// Memory that writing takes for each value of an image: as the file has it, and what it is made from.
const ENCODED_BYTES: usize = 8;

/// Memory that writing takes besides.
const ENCODER_BYTES: usize = 1 << 20;

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
    // The colours in other primaries, the channels apart, blocks of them and what they are compressed to.
    let values = image.layers.iter().map(|layer| layer.data.len()).sum::<usize>() + image.rgb.len();
    check_room(ENCODED_BYTES * values + ENCODER_BYTES)?;
    tone::check_exposure(options.exposure)?;
    let threads = match options.threads {
        0 => thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    }
    .min(MAX_THREADS);
    let converted = match (options.primaries, format) {
        (Primaries::Rec709, _) | (_, Format::Png) => None,
        (primaries, _) => Some(in_primaries(image, primaries)),
    };
    let image = converted.as_ref().unwrap_or(image);
    replace::replace(path, "the image", |file| match format {
        Format::Exr => {
            let heading = exr::Heading {
                comments: &options.comments,
                attributes: &options.attributes,
                primaries: options.primaries,
            };
            exr::encode(image, &heading, threads, file)
        }
        Format::Pfm => pfm::encode(image, file),
        Format::Png => {
            let pixels = tone::to_srgb8_by(threads, image, options.tone_map, options.exposure)?;
            png::encode(&pixels, [image.width, image.height], file)
        }
    })
}

/// The image with its colours in these primaries.
fn in_primaries(image: &Image, primaries: Primaries) -> Image {
    let matrix = primaries.from_rec_709();
    let convert = |colors: &mut Vec<f32>| {
        for color in colors.chunks_exact_mut(3) {
            let seen = DVec3::new(color[0].into(), color[1].into(), color[2].into());
            color.copy_from_slice(&(matrix * seen).as_vec3().to_array());
        }
    };
    let mut image = image.clone();
    convert(&mut image.rgb);
    let is_color = |layer: &&mut Layer| ["albedo", "emission", "direct", "indirect"].contains(&layer.name.as_str());
    image.layers.iter_mut().filter(is_color).for_each(|layer| convert(&mut layer.data));
    image
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
