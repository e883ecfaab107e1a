//! Photometric webs: how a measured lamp shines, from files of IES LM-63 and EULUMDAT; and colours by temperature.
//!
//! A file has luminous intensities \[cd\] over a grid of angles, between which [`Web`] interpolates. Files are text that anyone may have
//! written, so each number is checked, and messages name its line. What symmetry leaves out of a file is filled in when it is read.

mod eulumdat;
mod ies;
mod planck;
mod text;
mod tilt;
mod web;

pub use planck::{TEMPERATURES, of_luminance_one, planckian};
pub use tilt::{LampPosition, LampTilt};
pub use web::{Planes, Web};

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use crate::desc::check_regular;
use crate::{Error, ErrorKind, Result};
use text::Refusal;

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WebFormat {
    /// IES LM-63.
    Ies,
    /// EULUMDAT.
    Eulumdat,
}

impl WebFormat {
    /// The extension of names of such files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Ies => "ies",
            Self::Eulumdat => "ldt",
        }
    }
}

/// The luminous efficacy by which candela become watts per steradian \[lm/W\]: that of 555 nm, which the candela is defined by. A lamp is
/// given the same radiant intensity in all channels, whose luminance times this is the intensity of its file.
pub const LUMENS_PER_WATT: f64 = 683.0;

/// Size of the largest file that is read, bytes.
const SIZE_LIMIT: u64 = 1 << 26;

/// Size of the largest file of factors of tilts, bytes.
const TILT_SIZE_LIMIT: u64 = 1 << 20;

/// Most angles of a file, and most intensities.
const MOST_ANGLES: usize = 1_000_000;

impl Web {
    /// Reads a file of IES LM-63 or EULUMDAT, which is told apart by its contents.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] for a file that cannot be read; [`ErrorKind::InvalidScene`] for contents that are of neither format or wrong,
    /// with the line; [`ErrorKind::Unsupported`] for a file that is larger than what is read.
    pub fn read(file: &Path) -> Result<Self> {
        let io = |error| Error::io(file, "cannot read the photometric web", error);
        let mut bytes = Vec::new();
        check_regular(file).map_err(io)?;
        File::open(file).and_then(|it| it.take(SIZE_LIMIT + 1).read_to_end(&mut bytes)).map_err(io)?;
        Self::parse_named(&bytes, Some(file)).map_err(|error| error.in_file(Some(file), 0))
    }

    /// Reads the contents of such a file.
    ///
    /// # Errors
    /// Those of [`Web::read`] but for reading.
    pub fn parse(text: &[u8]) -> Result<Self> {
        Self::parse_named(text, None)
    }

    fn parse_named(text: &[u8], file: Option<&Path>) -> Result<Self> {
        if text.len() as u64 > SIZE_LIMIT {
            let message = format!("a photometric web of more than {SIZE_LIMIT} bytes is not read");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let refused = |Refusal { line, message }| Error::new(ErrorKind::InvalidScene, message).in_file(file, line);
        if !ies::is_ies(text, file) {
            let mut web = eulumdat::read(text).map_err(refused)?;
            (web.text, web.format) = (text.into(), WebFormat::Eulumdat);
            return Ok(web);
        }
        let tilt = match (file, ies::tilt_file(text)) {
            (Some(file), Some((line, name))) => Some((line, read_tilt(file, line, &name)?)),
            _ => None,
        };
        let mut web = ies::read(text, tilt.as_ref().map(|(_, tilt)| tilt.clone())).map_err(refused)?;
        web.format = WebFormat::Ies;
        web.text = match tilt {
            Some((line, tilt)) => ies::with_tilt(text, line, &tilt).into(),
            None => text.into(),
        };
        Ok(web)
    }
}

/// Reads the factors of tilted lamps from the file that line `line` of a web names, relative to the web's folder.
fn read_tilt(web: &Path, line: usize, name: &str) -> Result<LampTilt> {
    let file = web.with_file_name(name);
    if name.contains('\0') || web.file_name().is_none() || file == web {
        let message = "TILT= names no file of factors, expected another file's name, NONE or INCLUDE";
        return Err(Error::new(ErrorKind::InvalidScene, message).in_file(Some(web), line));
    }
    let mut bytes = Vec::new();
    let opened = check_regular(&file).and_then(|()| File::open(&file));
    opened.and_then(|it| it.take(TILT_SIZE_LIMIT + 1).read_to_end(&mut bytes)).map_err(|error| {
        let io = Error::io(&file, "cannot read the factors of tilted lamps", error);
        Error::new(io.kind(), format!("TILT={}: {}", text::shown(name), io.message())).in_file(Some(web), line)
    })?;
    if bytes.len() as u64 > TILT_SIZE_LIMIT {
        let message = format!("factors of tilted lamps in a file of more than {TILT_SIZE_LIMIT} bytes are not read");
        return Err(Error::new(ErrorKind::Unsupported, message).in_file(Some(&file), 0));
    }
    let refused = |Refusal { line, message }| Error::new(ErrorKind::InvalidScene, message).in_file(Some(&file), line);
    ies::read_tilt(&bytes).map_err(refused)
}
