//! Formats of image files, and reading them.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::pixels::Image;
use super::{exr, pfm, png};
use crate::desc::check_regular;
use crate::{Error, ErrorKind, Result};

/// A kind of image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// OpenEXR: one part, scan lines, 32-bit float, ZIP compression (lossless).
    ///
    /// The image is `R`, `G`, `B` of the default layer, which every viewer shows first. A further layer is a group of
    /// channels with its name in front: `normal.X`, `normal.Y`, `normal.Z`; `depth.Z`; `.R`, `.G`, `.B` for any other
    /// layer of three values (`albedo.R`), and `.Y`, OpenEXR's name for a grey channel, for any other of one
    /// (`samples.Y`). A layer of one value whose name begins with `S0.` is a channel by that name: a band of a spectrum
    /// ([`spectral_layer`](crate::output::spectral_layer)). The chromaticities of Rec. 709 are stated in the header. An image with a
    /// [`Placement`](crate::film::Placement) has the picture as its display window and itself as its data window, and the aspect of
    /// its pixels.
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

/// Reads an image from an `.exr`, `.pfm` or `.png` file.
///
/// PNG (8 and 16 bits, grey or colour) is decoded to scene-linear values in [0, 1]; alpha is left out. PFM may be grey
/// or colour and of either byte order; values are multiplied by the magnitude of its scale. EXR may be of any program:
/// `R`, `G`, `B` (or `Y` alone) without a layer's name make the image, from the part that has them, over the data
/// window; groups of one or three channels of the same size become layers, in the order `albedo`, `normal`, `depth`,
/// `samples`, `variance`, then by name. Deep data, subsampled channels and the compression HTJ2K are not supported.
///
/// Errors name the file: [`ErrorKind::Unsupported`] for an unknown extension, more than [`MAX_PIXELS`](super::MAX_PIXELS) pixels, or a
/// feature of the format that is not read; [`ErrorKind::Io`] for a file that is missing, cut short or damaged.
pub fn read(path: &Path) -> Result<Image> {
    let format = Format::from_path(path)?;
    let failed = |error| Error::io(path, "cannot read the image", error);
    check_regular(path).map_err(failed)?;
    let file = File::open(path).map_err(failed)?;
    let size = file.metadata().map_err(failed)?.len();
    let reader = BufReader::new(file);
    match format {
        Format::Exr => exr::decode(reader, size),
        Format::Pfm => pfm::decode(reader),
        Format::Png => png::decode(reader),
    }
    .map_err(|error| error.in_file(Some(path), 0))
}
