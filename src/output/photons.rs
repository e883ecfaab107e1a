//! Photons in a file: CSV for tables and scripts, PLY for programs that show point clouds.

use std::fmt;
use std::io::Write;
use std::path::Path;

use crate::replace::{self, Target};

use crate::integrator::photon::{Photon, colour};
use crate::math::DVec3;
use crate::spectrum::srgb_encode;
use crate::{Error, ErrorKind, Result};

/// A kind of file for photons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PhotonFormat {
    /// Comma-separated values, one photon a line after the line `x,y,z,nx,ny,nz,wx,wy,wz,r,g,b,shadow`: where it is, the
    /// surface's normal on the side it came from, the direction towards where it came from, its power (W), and 1 for a
    /// shadow photon, else 0.
    Csv,
    /// PLY, binary, little-endian, a vertex for each photon: `double x, y, z`, `float nx, ny, nz`, `uchar red, green, blue`
    /// (sRGB, the colour of its power at full brightness; black for a shadow photon), `float power_r, power_g, power_b` (W),
    /// `uchar shadow` (1 for a shadow photon, else 0).
    Ply,
}

impl PhotonFormat {
    /// The format that the extension of `path` names, in any case; `None` for any other.
    pub fn from_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_string_lossy().to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }
}

/// Writes photons to `path` in the format of its extension; an existing file is replaced in one step.
///
/// `centre` is [`crate::scene::Scene::centre`] of the photons' scene, because the file has world coordinates. In a CSV
/// they have nine digits of the distance from the centre, and more where distances are small.
///
/// # Errors
/// [`ErrorKind::Unsupported`] for an unknown extension, [`ErrorKind::Io`] for any error of the file system; then an
/// existing file is unchanged.
pub fn write_photons(photons: &[Photon], centre: DVec3, path: &Path) -> Result<()> {
    let format = format_of(path)?;
    replace::replace(path, WHAT, |file| {
        match format {
            PhotonFormat::Csv => csv(photons, centre, file),
            PhotonFormat::Ply => ply(photons, centre, file),
        }
        .map_err(|error| Error::new(ErrorKind::Io, format!("cannot write {WHAT}: {error}")).because(error))
    })
}

/// Whether [`write_photons`] could write to `path` now, without doing so.
///
/// # Errors
/// As [`write_photons`].
pub fn check_photon_target(path: &Path) -> Result<PhotonFormat> {
    let format = format_of(path)?;
    replace::check(path, WHAT)?;
    Ok(format)
}

const WHAT: &str = "the photons";

fn format_of(path: &Path) -> Result<PhotonFormat> {
    PhotonFormat::from_path(path).ok_or_else(|| {
        let message = "the name's extension is no format for photons: use .csv or .ply";
        Error::new(ErrorKind::Unsupported, message).in_file(Some(path), 0)
    })
}

/// Position of a photon in the world.
fn world(photon: &Photon, centre: DVec3) -> [f64; 3] {
    (photon.position().as_dvec3() + centre).to_array()
}

fn csv(photons: &[Photon], centre: DVec3, file: &mut Target) -> std::io::Result<()> {
    writeln!(file, "x,y,z,nx,ny,nz,wx,wy,wz,r,g,b,shadow")?;
    for photon in photons {
        for (value, local) in world(photon, centre).into_iter().zip(photon.p) {
            write!(file, "{},", Coordinate { value, local })?;
        }
        for value in photon.normal.get().to_array().into_iter().chain(photon.wi.get().to_array()) {
            write!(file, "{value:.6},")?;
        }
        for value in photon.power {
            write!(file, "{value:e},")?;
        }
        writeln!(file, "{}", u8::from(photon.is_shadow()))?;
    }
    Ok(())
}

/// A world coordinate with as many digits as the scene's own frame has.
struct Coordinate {
    value: f64,
    /// In the scene frame, single precision.
    local: f32,
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, local } = self;
        if *local == 0.0 {
            return write!(f, "{value:?}");
        }
        match 8 - local.abs().log10().floor() as i32 {
            decimals @ 0..=17 => write!(f, "{value:.*}", decimals as usize),
            _ => write!(f, "{value:e}"),
        }
    }
}

fn ply(photons: &[Photon], centre: DVec3, file: &mut Target) -> std::io::Result<()> {
    writeln!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment photons, made by etendue {}",
        env!("CARGO_PKG_VERSION")
    )?;
    writeln!(file, "element vertex {}", photons.len())?;
    for (kind, names) in [
        ("double", ["x", "y", "z"]),
        ("float", ["nx", "ny", "nz"]),
        ("uchar", ["red", "green", "blue"]),
        ("float", ["power_r", "power_g", "power_b"]),
    ] {
        for name in names {
            writeln!(file, "property {kind} {name}")?;
        }
    }
    writeln!(file, "property uchar shadow\nend_header")?;
    for photon in photons {
        for value in world(photon, centre) {
            file.write_all(&value.to_le_bytes())?;
        }
        for value in photon.normal.get().to_array() {
            file.write_all(&value.to_le_bytes())?;
        }
        file.write_all(&colour(photon).map(|value| (255.0 * srgb_encode(value)).round() as u8))?;
        for value in photon.power {
            file.write_all(&value.to_le_bytes())?;
        }
        file.write_all(&[u8::from(photon.is_shadow())])?;
    }
    Ok(())
}
