//! The key `whiteBalance` of renders.

use serde_json::value::RawValue;

use super::json;
use super::save::raw;
use super::{SpectrumDesc, StandardIlluminant};
use crate::spectrum::{XYZ_FROM_REC_709, white_balance};
use crate::{Error, Result};

/// The light under which white surfaces are grey.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum WhiteBalance {
    /// An illuminant of the CIE.
    Name(super::spectrum_keys::IlluminantName),
    /// Kelvin: of a black body from 1000 on, and of daylight from 4000 to 25000.
    Temperature(f64),
    /// Chromaticity, x and y of CIE 1931.
    Chromaticity([f64; 2]),
}

/// Where black bodies give way to daylight, and the range of temperatures, K.
const TEMPERATURES: [f64; 3] = [1000.0, 4000.0, 25_000.0];

/// The chromaticity of the light of an illuminant's name, or of a temperature in kelvin: a black body's below 4000 and daylight's from there
/// on, as cameras have it. `None` for what is neither.
pub(crate) fn chromaticity(name: &str) -> Option<[f64; 2]> {
    let light = match (SpectrumDesc::by_name(name), name.parse::<f64>()) {
        (Some(known), _) => known,
        (None, Ok(kelvin)) => of_temperature(kelvin)?,
        (None, Err(_)) => return None,
    };
    of(&light)
}

fn of_temperature(kelvin: f64) -> Option<SpectrumDesc> {
    let [least, daylight, most] = TEMPERATURES;
    match kelvin {
        kelvin if (daylight..=most).contains(&kelvin) => Some(SpectrumDesc::Daylight(kelvin)),
        kelvin if (least..daylight).contains(&kelvin) => Some(SpectrumDesc::BlackBody(kelvin)),
        _ => None,
    }
}

fn of(light: &SpectrumDesc) -> Option<[f64; 2]> {
    let xyz = *XYZ_FROM_REC_709 * light.seen_color();
    let sum = xyz.element_sum();
    Some([xyz.x / sum, xyz.y / sum])
}

/// Checks a chromaticity.
pub(super) fn check(path: &str, white: [f64; 2]) -> Result<()> {
    if white_balance(white).is_some() {
        return Ok(());
    }
    let [x, y] = white;
    Err(Error::invalid(
        path,
        format!("[{x}, {y}] is no light that could be white, expected x and y such as [0.3127, 0.329]"),
    ))
}

/// Reads the key.
pub(super) fn read(value: &RawValue, path: &str) -> Result<Option<[f64; 2]>> {
    let white = match value.get().as_bytes().first() {
        Some(b'"') => {
            let name: String = json::value(value, path)?;
            let names = StandardIlluminant::ALL.map(|(name, _)| name);
            SpectrumDesc::by_name(&name).as_ref().and_then(of).ok_or_else(|| {
                let hint = json::did_you_mean(&name, names);
                let message =
                    format!("no illuminant `{}` is known, expected {}{hint}", json::elided(&name), names.join(", "));
                Error::invalid(path, message)
            })?
        }
        Some(b'[') => json::value(value, path)?,
        _ => {
            let kelvin: f64 = json::value(value, path)?;
            of_temperature(kelvin).as_ref().and_then(of).ok_or_else(|| {
                let [least, _, most] = TEMPERATURES;
                let message = format!("{kelvin} is out of range, expected a temperature from {least} to {most} kelvin");
                Error::invalid(path, message)
            })?
        }
    };
    check(path, white)?;
    Ok(Some(white))
}

/// Writes the key.
pub(super) fn write(white: Option<[f64; 2]>) -> Result<Option<Box<RawValue>>> {
    white.map(|white| raw(&white)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_temperatures_have_their_chromaticity() {
        for (name, [x, y]) in [
            ("A", [0.447_58, 0.407_45]),
            ("D50", [0.345_67, 0.358_51]),
            ("E", [0.333_31, 0.333_29]),
            ("2000", [0.5267, 0.4133]),
            ("6503.6", [0.312_72, 0.329_03]),
        ] {
            let found = chromaticity(name).unwrap();
            assert!((found[0] - x).abs() < 3e-4 && (found[1] - y).abs() < 3e-4, "{name}: {found:?}");
        }
        for none in ["", "D66", "999", "25001", "nan", "inf", "-5"] {
            assert_eq!(chromaticity(none), None, "{none}");
        }
    }
}
