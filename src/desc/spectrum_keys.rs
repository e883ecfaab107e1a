//! Spectra of scene files: reads and writes them.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::save::raw;
use super::{SpectrumDesc, SpectrumKey, StandardIlluminant};
use crate::{Error, Result};

/// A spectrum that is no list of samples; one of the keys says what it is.
#[derive(serde::Deserialize, serde::Serialize, Default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct SpectrumObject {
    /// Temperature of a black body in kelvin, in [500, 1000000].
    #[serde(skip_serializing_if = "Option::is_none")]
    black_body: Option<f64>,
    /// Correlated colour temperature of a phase of daylight in kelvin, in [4000, 25000].
    #[serde(skip_serializing_if = "Option::is_none")]
    daylight: Option<f64>,
    /// A file of two columns, wavelength in nm and value, relative to the scene file's folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// Values >= 0 at regular wavelengths: the first is at `from`, and each next one `step` later.
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<Vec<f64>>,
    /// With `values`: the first wavelength, nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<f64>,
    /// With `values`: the distance between two wavelengths, nm, above 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
}

/// A spectrum: the name of an illuminant, pairs of wavelength in nm and value, or an object.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum Spectrum {
    /// An illuminant of the CIE, of luminance 1.
    Name(IlluminantName),
    /// Pairs of wavelength, nm, in growing order, and value >= 0.
    Samples(Vec<[f64; 2]>),
    /// A black body, daylight, a file or regular samples.
    Object(SpectrumObject),
}

/// The names of illuminants.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum IlluminantName {
    /// Tungsten.
    A,
    /// Daylight of about 5003 K.
    D50,
    /// Daylight of about 5503 K.
    D55,
    /// Daylight of about 6504 K.
    D65,
    /// Daylight of about 7504 K.
    D75,
    /// The same power at all wavelengths.
    E,
    /// A fluorescent lamp of about 6430 K, of a broad band.
    FL1,
    /// A fluorescent lamp of about 4230 K, of a broad band.
    FL2,
    /// A fluorescent lamp of about 3450 K, of a broad band.
    FL3,
    /// A fluorescent lamp of about 2940 K, of a broad band.
    FL4,
    /// A fluorescent lamp of about 6350 K, of a broad band.
    FL5,
    /// A fluorescent lamp of about 4150 K, of a broad band.
    FL6,
    /// A fluorescent lamp of about 6500 K, of several bands.
    FL7,
    /// A fluorescent lamp of about 5000 K, of several bands.
    FL8,
    /// A fluorescent lamp of about 4150 K, of several bands.
    FL9,
    /// A fluorescent lamp of about 5000 K, of three narrow bands.
    FL10,
    /// A fluorescent lamp of about 4000 K, of three narrow bands.
    FL11,
    /// A fluorescent lamp of about 3000 K, of three narrow bands.
    FL12,
}

/// Reads a spectrum, and checks it.
pub(super) fn read(value: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<SpectrumDesc> {
    let spectrum = match value.get().as_bytes().first() {
        Some(b'"') => {
            let name: String = json::value(value, path)?;
            SpectrumDesc::by_name(&name).ok_or_else(|| {
                let names = StandardIlluminant::ALL.map(|(name, _)| name);
                let hint = json::did_you_mean(&name, names);
                let message = format!(
                    "no illuminant `{}` is known, expected {}, samples or an object{hint}",
                    json::elided(&name),
                    names.join(", ")
                );
                Error::invalid(path, message)
            })?
        }
        Some(b'{') => object(json::object(value, path)?, path, builder)?,
        _ => SpectrumDesc::Samples(json::value::<Vec<[f64; 2]>>(value, path)?.into()),
    };
    spectrum.check(path)?;
    Ok(spectrum)
}

fn object(object: SpectrumObject, path: &str, builder: &mut Builder<'_>) -> Result<SpectrumDesc> {
    match object {
        SpectrumObject {
            black_body: Some(kelvin),
            daylight: None,
            file: None,
            values: None,
            from: None,
            step: None,
        } => SpectrumDesc::BlackBody(kelvin).checked(&join(path, "blackBody")),
        SpectrumObject {
            black_body: None,
            daylight: Some(kelvin),
            file: None,
            values: None,
            from: None,
            step: None,
        } => SpectrumDesc::Daylight(kelvin).checked(&join(path, "daylight")),
        SpectrumObject { black_body: None, daylight: None, file: Some(file), values: None, from: None, step: None } => {
            builder.spectrum_file(&join(path, "file"), &file)
        }
        SpectrumObject {
            black_body: None,
            daylight: None,
            file: None,
            values: Some(values),
            from: Some(from),
            step: Some(step),
        } => {
            let samples: Vec<[f64; 2]> =
                values.iter().enumerate().map(|(i, value)| [from + step * i as f64, *value]).collect();
            Ok(SpectrumDesc::Samples(samples.into()))
        }
        _ => {
            let message = "expected one of: `blackBody`, `daylight`, `file`, or `values` with `from` and `step`";
            Err(Error::invalid(path, message))
        }
    }
}

impl SpectrumDesc {
    fn checked(self, path: &str) -> Result<Self> {
        self.check(path).map(|()| self)
    }
}

/// Reads the spectrum of a light, where it has one.
pub(super) fn read_some(
    value: Option<&RawValue>,
    path: &str,
    builder: &mut Builder<'_>,
) -> Result<Option<SpectrumDesc>> {
    let Some(value) = value else { return Ok(None) };
    let path = join(path, "spectrum");
    let spectrum = read(value, &path, builder)?;
    if spectrum.light(&path)?.is_out_of_gamut && !builder.scene.render.spectral {
        builder.warn(&path, "the colour lies outside of Rec. 709, in three channels the light is less saturated");
    }
    Ok(Some(spectrum))
}

/// Reads the spectra of parameters of a material.
pub(super) fn of_material(
    spectra: Option<&BTreeMap<String, Box<RawValue>>>,
    path: &str,
    builder: &mut Builder<'_>,
) -> Result<Vec<(SpectrumKey, SpectrumDesc)>> {
    let path = join(path, "spectra");
    let mut found = Vec::new();
    for (name, value) in spectra.into_iter().flatten() {
        let at = join(&path, name);
        let Some((_, key)) = SpectrumKey::ALL.iter().find(|(known, _)| known == name) else {
            let names = SpectrumKey::ALL.map(|(name, _)| name);
            let hint = json::did_you_mean(name, names);
            let message =
                format!("no parameter of this name has a spectrum, expected one of {}{hint}", names.join(", "));
            return Err(Error::invalid(at, message));
        };
        found.push((*key, read(value, &at, builder)?));
    }
    found.sort_by_key(|(key, _)| *key);
    Ok(found)
}

/// Writes a spectrum. A file becomes its samples.
pub(super) fn write(spectrum: &SpectrumDesc) -> Result<Box<RawValue>> {
    match spectrum {
        SpectrumDesc::Standard(illuminant) => {
            let name =
                StandardIlluminant::ALL.iter().find(|(_, known)| known == illuminant).map_or("E", |(name, _)| *name);
            raw(&name)
        }
        SpectrumDesc::Daylight(kelvin) => raw(&SpectrumObject { daylight: Some(*kelvin), ..SpectrumObject::default() }),
        SpectrumDesc::BlackBody(kelvin) => {
            raw(&SpectrumObject { black_body: Some(*kelvin), ..SpectrumObject::default() })
        }
        SpectrumDesc::Samples(samples) => raw(&samples.to_vec()),
    }
}

/// Writes the spectra of a material.
pub(super) fn write_of_material(
    spectra: &[(SpectrumKey, SpectrumDesc)],
) -> Result<Option<BTreeMap<String, Box<RawValue>>>> {
    if spectra.is_empty() {
        return Ok(None);
    }
    let written = spectra.iter().map(|(key, spectrum)| Ok((key.name().to_owned(), write(spectrum)?)));
    written.collect::<Result<_>>().map(Some)
}
