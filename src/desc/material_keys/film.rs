//! The key `film` of glass and metals.

use serde_json::value::RawValue;

use super::super::numbers::single;
use super::super::save::raw;
use super::super::{ThinFilmDesc, json};
use crate::Result;

/// A thin film on the outer side.
#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct ThinFilm {
    /// Thickness in nanometres, in [0, 10000]; 0 is no film.
    thickness: f64,
    /// Index of refraction of the film, above 0 and up to 100.
    refraction_index: f64,
}

/// Reads the key, whose numbers are checked later.
pub(super) fn read(value: &RawValue, path: &str) -> Result<ThinFilmDesc> {
    let ThinFilm { thickness, refraction_index } = json::object(value, path)?;
    Ok(ThinFilmDesc { thickness: thickness as f32, ior: refraction_index as f32 })
}

/// The key of a film.
pub(super) fn write(film: &ThinFilmDesc) -> Result<Box<RawValue>> {
    raw(&ThinFilm { thickness: single(film.thickness), refraction_index: single(film.ior) })
}
