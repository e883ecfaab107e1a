//! The key `dispersion` of glass: an Abbe number, the name of a medium, or the numbers of Sellmeier's formula.

use serde_json::value::RawValue;

use super::super::json::{self, join};
use super::super::numbers::single;
use super::super::save::raw;
use super::super::{Dispersion, GLASSES, SELLMEIER_TERMS};
use crate::{Error, Result};

/// The numbers of Sellmeier's formula n^2 = 1 + sum of strength lambda^2 / (lambda^2 - resonance), lambda in micrometres.
#[derive(serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Sellmeier {
    /// The strengths, up to four.
    strengths: Vec<f64>,
    /// The squares of the resonant wavelengths, micrometre^2, as many.
    resonances: Vec<f64>,
}

/// How the index depends on the wavelength: an Abbe number, a name, or the numbers of a formula.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum DispersionKeys {
    /// The Abbe number, above 0.
    Abbe(f64),
    /// A medium that is known by name.
    Name(GlassName),
    /// Sellmeier's formula.
    Sellmeier(Sellmeier),
}

/// The names of media whose formula is known.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum GlassName {
    /// Borosilicate crown glass of SCHOTT.
    #[schemars(rename = "N-BK7")]
    Bk7,
    /// Dense flint glass of SCHOTT.
    #[schemars(rename = "N-SF11")]
    Sf11,
    /// Fused silica.
    #[schemars(rename = "fused-silica")]
    FusedSilica,
    /// Water of 20 degrees Celsius.
    #[schemars(rename = "water")]
    Water,
    /// Diamond.
    #[schemars(rename = "diamond")]
    Diamond,
}

/// Reads the key, whose numbers are checked later.
pub(super) fn read(value: &RawValue, path: &str) -> Result<Dispersion> {
    match value.get().as_bytes().first() {
        Some(b'"') => {
            let name: String = json::value(value, path)?;
            Dispersion::by_name(&name).ok_or_else(|| {
                let names: Vec<&str> = GLASSES.iter().map(|glass| glass.name).collect();
                let hint = json::did_you_mean(&name, names.iter().copied());
                let message = format!(
                    "no medium `{}` is known, expected {}, an Abbe number or Sellmeier's formula{hint}",
                    json::elided(&name),
                    names.join(", ")
                );
                Error::invalid(path, message)
            })
        }
        Some(b'{') => {
            let Sellmeier { strengths, resonances } = json::object(value, path)?;
            let dispersion = Dispersion::Sellmeier {
                strengths: terms(&join(path, "strengths"), &strengths, strengths.len())?,
                resonances: terms(&join(path, "resonances"), &resonances, strengths.len())?,
            };
            // The index is stated by the formula, so that what is wrong with it is said here.
            dispersion.own_index().map_or(Ok(()), |index| dispersion.check(path, index))?;
            Ok(dispersion)
        }
        _ => Ok(Dispersion::Abbe(json::value::<f64>(value, path)? as f32)),
    }
}

/// Up to four numbers, with 0 for the rest.
fn terms(path: &str, numbers: &[f64], count: usize) -> Result<[f32; SELLMEIER_TERMS]> {
    if numbers.len() != count || !(1..=SELLMEIER_TERMS).contains(&count) {
        let message = format!(
            "there are {} numbers, expected 1 to {SELLMEIER_TERMS}, as many strengths as resonances",
            numbers.len()
        );
        return Err(Error::invalid(path, message));
    }
    Ok(std::array::from_fn(|i| numbers.get(i).map_or(0.0, |number| *number as f32)))
}

/// The key of a dispersion: the name of a medium where it has one.
pub(super) fn write(dispersion: &Dispersion) -> Result<Box<RawValue>> {
    if let Some(glass) = GLASSES.iter().find(|glass| glass.dispersion == *dispersion) {
        return raw(&glass.name);
    }
    match dispersion {
        Dispersion::Abbe(number) => raw(&single(*number)),
        Dispersion::Sellmeier { strengths, resonances } => {
            let [strengths, resonances] =
                [strengths, resonances].map(|numbers| numbers.iter().copied().map(single).collect());
            raw(&Sellmeier { strengths, resonances })
        }
    }
}
