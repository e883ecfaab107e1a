//! Materials whose parameters have spectra of their own.

use super::json::join;
use super::{BsdfDesc, ConductorDesc, MaterialDesc, MediumDesc, SpectrumDesc, SpectrumKey, TextureKey, validate};
use crate::math::DVec3;
use crate::spectrum::{Illuminant, Rgb, SmoothSpectrum, SpectralCurve, rec_709, tristimulus};
use crate::{Error, Result};

/// Checks the spectra of a material, and sets the parameters of its model that have some to what they are in three channels.
pub(super) fn apply(material: &mut MaterialDesc) -> Result<()> {
    let base = join(&material.path, "spectra");
    let spectra = std::mem::take(&mut material.spectra);
    let has = |key: SpectrumKey| spectra.iter().any(|(known, _)| *known == key);
    for (number, (key, spectrum)) in spectra.iter().enumerate() {
        let path = join(&base, key.name());
        if spectra[..number].iter().any(|(before, _)| before == key) {
            return Err(Error::invalid(path, "the parameter has another spectrum, expected one"));
        }
        spectrum.check(&path)?;
        let share = || {
            let curve = spectrum.curve(&path)?;
            if let Some(most) = spectrum.values().find(|value| *value > 1.0) {
                return Err(Error::invalid(&path, format!("{most} is out of range, expected values from 0 to 1")));
            }
            Ok(Rgb::from_f64(curve.reflected_color()).max(Rgb::ZERO).min(Rgb::ONE))
        };
        // An index at the wavelengths of the channels, as those of known metals are stated.
        let at_channels = |least: f32| {
            let curve = spectrum.curve(&path)?;
            if let Some(wrong) = spectrum.values().find(|value| !(f64::from(least)..=1e6).contains(value)) {
                let least = if least > 0.0 { "above 0" } else { "of 0 or more" };
                let message = format!("{wrong} is out of range, expected values {least} and up to 1000000");
                return Err(Error::invalid(&path, message));
            }
            Ok(Rgb::from_array([650.0, 550.0, 450.0].map(|nanometres| curve.at(nanometres))))
        };
        match (key, &mut material.bsdf) {
            (
                SpectrumKey::Color,
                BsdfDesc::Lambert { albedo: color }
                | BsdfDesc::OrenNayar { albedo: color, .. }
                | BsdfDesc::OrenNayarQualitative { albedo: color, .. }
                | BsdfDesc::Eon { albedo: color, .. }
                | BsdfDesc::Mirror { reflectance: color }
                | BsdfDesc::Sheen { color, .. }
                | BsdfDesc::DiffuseTransmission { reflectance: color, .. },
            )
            | (SpectrumKey::Transmittance, BsdfDesc::DiffuseTransmission { transmittance: color, .. }) => {
                *color = share()?
            }
            (SpectrumKey::Reflectance, BsdfDesc::Conductor { conductor, .. })
                if !has(SpectrumKey::Eta) && !has(SpectrumKey::K) =>
            {
                let (edge, _) = other_halves(conductor);
                *conductor = ConductorDesc::Reflectance { normal: share()?, edge };
            }
            (SpectrumKey::Eta, BsdfDesc::Conductor { conductor, .. }) if !has(SpectrumKey::Reflectance) => {
                let (_, [_, k]) = other_halves(conductor);
                *conductor = ConductorDesc::Index { eta: at_channels(f32::MIN_POSITIVE)?, k };
            }
            (SpectrumKey::K, BsdfDesc::Conductor { conductor, .. }) if !has(SpectrumKey::Reflectance) => {
                let (_, [eta, _]) = other_halves(conductor);
                *conductor = ConductorDesc::Index { eta, k: at_channels(0.0)? };
            }
            (SpectrumKey::Absorption, BsdfDesc::Dielectric { .. } | BsdfDesc::RoughDielectric { .. }) => {
                let curve = spectrum.curve(&path)?;
                let medium = material.medium.unwrap_or_default();
                let absorption = Rgb::from_f64(absorption_color(&curve));
                material.medium = Some(MediumDesc { absorption, ..medium });
            }
            (SpectrumKey::Emission, _) => {
                let stated = material.emission.map(Rgb::to_f64);
                let emission = spectrum.light(&path)?.dress(stated);
                material.emission = Some(validate::emission(&path, emission, 1.0)?);
            }
            _ => {
                let message = match key {
                    SpectrumKey::Eta | SpectrumKey::K => {
                        "only a conductor has an index by the wavelength, without a spectrum of `reflectance`"
                    }
                    SpectrumKey::Reflectance => {
                        "only a conductor has a reflectance by the wavelength, without spectra of `eta` and `k`"
                    }
                    SpectrumKey::Absorption => "only a refractive material has an absorption by the wavelength",
                    SpectrumKey::Transmittance => {
                        "only a sheet that transmits diffusely has a transmittance by the wavelength"
                    }
                    SpectrumKey::Color | SpectrumKey::Emission => {
                        "only a diffuse or reflective material, a sheet that transmits diffusely and fibres have a colour by the wavelength"
                    }
                };
                return Err(Error::invalid(path, message));
            }
        }
        let textured = match key {
            SpectrumKey::Color => Some(TextureKey::Color),
            SpectrumKey::Transmittance => Some(TextureKey::Transmittance),
            SpectrumKey::Reflectance if material.textured(TextureKey::EdgeTint).is_some() => Some(TextureKey::EdgeTint),
            SpectrumKey::Reflectance => Some(TextureKey::Reflectance),
            _ => None,
        };
        if let Some(texture) = textured.filter(|key| material.textured(*key).is_some()) {
            let message = format!("a texture varies `{}`, expected either a texture or a spectrum", texture.name());
            return Err(Error::invalid(path, message));
        }
    }
    if let BsdfDesc::DiffuseTransmission { reflectance, transmittance } = &mut material.bsdf {
        check_sheet(&spectra, [*reflectance, *transmittance], &base)?;
        // In three channels, colours outside of Rec. 709 may sum to more than the spectra do.
        let sums = (*reflectance + *transmittance).max(Rgb::ONE);
        (*reflectance, *transmittance) = (*reflectance / sums, *transmittance / sums);
    }
    material.spectra = spectra;
    Ok(())
}

/// What of a conductor's description a spectrum of the other parameter keeps: the tint of the edge; and n and k. 1 for what it does not
/// say.
fn other_halves(conductor: &ConductorDesc) -> (Rgb, [Rgb; 2]) {
    match *conductor {
        ConductorDesc::Reflectance { edge, .. } => (edge, [Rgb::ONE; 2]),
        ConductorDesc::Index { eta, k } => (Rgb::ONE, [eta, k]),
    }
}

/// Checks that a sheet with these colours, of which some have spectra, scatters no more light of any wavelength than it gets.
fn check_sheet(spectra: &[(SpectrumKey, SpectrumDesc)], colors: [Rgb; 2], path: &str) -> Result<()> {
    let share = |key: SpectrumKey, color: Rgb| match spectra.iter().find(|(known, _)| *known == key) {
        Some((_, spectrum)) => spectrum.curve(path),
        // Beside a spectrum, a colour is the smooth reflectance that paths in wavelengths take it for.
        None => {
            let smooth = SmoothSpectrum::of_color(color);
            Ok(SpectralCurve::of(|nanometres| f64::from(smooth.at(nanometres as f32))))
        }
    };
    let shares = [share(SpectrumKey::Color, colors[0])?, share(SpectrumKey::Transmittance, colors[1])?];
    let sums = shares[0].values().iter().zip(shares[1].values()).map(|(r, t)| r + t);
    let most = sums.fold(0.0_f32, f32::max);
    if most > 1.0 + 1e-3 {
        let message =
            format!("what is reflected and what is transmitted sum to {most} at some wavelength, expected 1 at most");
        return Err(Error::invalid(path, message));
    }
    Ok(())
}

/// The absorption coefficients in three channels of a coefficient by the wavelength: of D65 that has gone as far as is absorbed by a factor
/// e in the mean, they leave the same colour.
fn absorption_color(curve: &SpectralCurve) -> DVec3 {
    let d65 = |nanometres: f64| Illuminant::D65.power(nanometres);
    let white = tristimulus(d65).y;
    let at = |nanometres: f64| f64::from(curve.at(nanometres as f32));
    let mean = tristimulus(|nanometres| d65(nanometres) * at(nanometres)).y / white;
    if mean <= 0.0 {
        return DVec3::ZERO;
    }
    let left = rec_709(|nanometres| d65(nanometres) * (-at(nanometres) / mean).exp()) / white;
    // A colour outside of Rec. 709 would take an infinite coefficient or a negative one.
    DVec3::from_array(left.to_array().map(|left| -left.clamp(1e-9, 1.0).ln() * mean))
}
