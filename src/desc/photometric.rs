//! Light in photometric units: lumens, candela, lux and candela per square metre, and colours by temperature.
//!
//! A description holds radiometric numbers only. What a file says in photometric units becomes such numbers when it is read: the
//! colour is scaled to luminance 1, and the luminous quantity is divided by [`LUMENS_PER_WATT`]. Files that are written have
//! the radiometric numbers, which are read back as the same bits.

use serde::{Deserialize, Serialize};

use super::json::join;
use super::{SpectrumDesc, validate};
use crate::math::DVec3;
use crate::photometry::{LUMENS_PER_WATT, TEMPERATURES, of_luminance_one, planckian};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The unit of a light's `intensity`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
pub(super) enum Unit {
    /// None: a factor on radiometric channels.
    #[serde(rename = "W")]
    Watt,
    /// Luminous intensity.
    #[serde(rename = "cd")]
    Candela,
    /// Luminous flux.
    #[serde(rename = "lm")]
    Lumen,
    /// Illuminance.
    #[serde(rename = "lx")]
    Lux,
    /// Luminance.
    #[serde(rename = "cd/m2")]
    CandelaPerArea,
}

impl Unit {
    fn name(self) -> &'static str {
        match self {
            Self::Watt => "W",
            Self::Candela => "cd",
            Self::Lumen => "lm",
            Self::Lux => "lx",
            Self::CandelaPerArea => "cd/m2",
        }
    }
}

/// The keys that say how much light there is, and of which colour.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightKeys<'a> {
    pub color: Option<[f64; 3]>,
    pub intensity: Option<f64>,
    pub temperature: Option<f64>,
    pub unit: Option<Unit>,
    pub spectrum: Option<&'a SpectrumDesc>,
}

impl LightKeys<'_> {
    /// The light's colour and the factor on it, whose product is the light's radiometric quantity per channel.
    ///
    /// `default`: the colour where the file gives none, if it need not give one. `units`: the photometric units of this kind of
    /// light, each with the quantity in them that is 1 lm/sr, 1 lm/m^2 or 1 lm/(m^2 sr).
    pub fn resolve(&self, path: &str, default: Option<[f64; 3]>, units: &[(Unit, f64)]) -> Result<([f64; 3], f64)> {
        let unit = self.unit.filter(|unit| *unit != Unit::Watt);
        let spectrum = self.spectrum.map(|spectrum| spectrum.light(&join(path, "spectrum"))).transpose()?;
        let color = match (self.color, self.temperature) {
            (_, Some(_)) if spectrum.is_some() => {
                let message = "`spectrum` says the colour already, expected one of both";
                return Err(Error::invalid(join(path, "temperature"), message));
            }
            (stated, _) if let Some(spectrum) = &spectrum => {
                let stated = stated.map(|color| {
                    validate::emission(&join(path, "color"), color, 1.0).map(|_| DVec3::from_array(color))
                });
                spectrum.dress(stated.transpose()?).to_array()
            }
            (Some(_), Some(_)) => {
                let message = "`color` says the colour already, expected one of both";
                return Err(Error::invalid(join(path, "temperature"), message));
            }
            (None, Some(kelvin)) => of_temperature(&join(path, "temperature"), kelvin)?.to_array(),
            (Some(color), None) => color,
            (None, None) if unit.is_some() => [1.0; 3],
            (None, None) => default.ok_or_else(|| Error::invalid(path, "missing key `color`, or `temperature`"))?,
        };
        let Some(unit) = unit else { return Ok((color, self.intensity.unwrap_or(1.0))) };
        let Some((_, per_lumen)) = units.iter().find(|(known, _)| *known == unit) else {
            let known: Vec<&str> = units.iter().map(|(unit, _)| unit.name()).collect();
            let message =
                format!("'{}' is no unit of this light, expected one of W, {}", unit.name(), known.join(", "));
            return Err(Error::invalid(join(path, "unit"), message));
        };
        let Some(value) = self.intensity else {
            return Err(Error::invalid(path, format!("missing key `intensity`, in {}", unit.name())));
        };
        let value = validate::positive(&join(path, "intensity"), value)?;
        // A colour that is no light at all is refused by its own check.
        let color = validate::emission(&join(path, "color"), color, 1.0).map(|_| DVec3::from_array(color))?;
        let Some(color) = of_luminance_one(color) else {
            let message = format!("{:?} is black and has no colour that {} could have", color.to_array(), unit.name());
            return Err(Error::invalid(join(path, "color"), message));
        };
        Ok((color.to_array(), value / (per_lumen * LUMENS_PER_WATT)))
    }
}

/// The emission of a surface or a material [W m^-2 sr^-1], from radiance or from luminance \[cd m^-2\] and temperature \[K\].
pub(super) fn emission(
    path: &str,
    radiance: Option<[f64; 3]>,
    luminance: Option<f64>,
    temperature: Option<f64>,
    spectrum: Option<&SpectrumDesc>,
) -> Result<Option<Rgb>> {
    if let Some(spectrum) = spectrum {
        let light = spectrum.light(&join(path, "spectrum"))?;
        if temperature.is_some() {
            let message = "`spectrum` says the colour already, expected one of both";
            return Err(Error::invalid(join(path, "temperature"), message));
        }
        let stated = emission(path, radiance, luminance, None, None)?;
        return validate::emission(&join(path, "spectrum"), light.dress(stated.map(Rgb::to_f64)), 1.0).map(Some);
    }
    let Some(value) = luminance else {
        if temperature.is_some() {
            return Err(Error::invalid(join(path, "temperature"), "is used with `luminance` only"));
        }
        return radiance.map(|radiance| validate::emission(&join(path, "emission"), radiance, 1.0)).transpose();
    };
    let at = join(path, "luminance");
    if radiance.is_some() {
        return Err(Error::invalid(at, "`emission` says the light already, expected one of both"));
    }
    let value = validate::positive(&at, value)?;
    let color = match temperature {
        Some(kelvin) => of_temperature(&join(path, "temperature"), kelvin)?,
        None => DVec3::ONE,
    };
    validate::emission(&at, color, value / LUMENS_PER_WATT).map(Some)
}

fn of_temperature(path: &str, kelvin: f64) -> Result<DVec3> {
    let [low, high] = TEMPERATURES;
    planckian(kelvin).ok_or_else(|| {
        Error::invalid(path, format!("{kelvin} is out of range, expected a temperature from {low} to {high} kelvin"))
    })
}
