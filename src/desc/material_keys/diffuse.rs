//! Keys of diffuse materials, of sheets that transmit diffusely, and of fibres.

use serde::{Deserialize, Serialize};

use super::super::builder::Builder;
use super::super::json::join;
use super::super::numbers::{self, degrees, single, unless_color};
use super::super::{BsdfDesc, validate};
use super::{Kind, SharedKeys, color, keys, material, required, tags};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// How a diffuse surface scatters.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(in crate::desc) enum Brdf {
    /// The same radiance in all directions.
    #[default]
    Lambertian,
    /// Fujii's improved Oren-Nayar model, by `roughness`.
    OrenNayar,
    /// Oren and Nayar's qualitative model, by `sigmaDeg`.
    OrenNayarQualitative,
    /// Portsmouth, Kutz and Hill's energy-preserving model, by `roughness`.
    Eon,
}

material!(
    /// Scatters light in all directions.
    #[serde(rename_all = "camelCase")]
    Diffuse, Diffuse, {
    /// Albedo, [0, 1] per channel. Required, or a spectrum of it.
    color: Option<[f64; 3]>,
    /// `lambertian` (default), `oren-nayar`, `oren-nayar-qualitative` or `eon`.
    #[serde(default, deserialize_with = "crate::desc::json::name")]
    brdf: Option<Brdf>,
    /// For `oren-nayar`: Fujii's sigma', in [0, 1]; for `eon`: roughness, in [0, 1].
    roughness: Option<f64>,
    /// For `oren-nayar-qualitative`: standard deviation of the facets' slope angle, degrees, in [0, 90].
    sigma_deg: Option<f64>,
    /// Russian roulette's survival probability, above 0 and up to 1, for renders with `"roulette": "file"`. Changes noise and
    /// time, never the image.
    reflection_rate: Option<f64>,
});

material!(
    /// A thin sheet that reflects and transmits diffusely.
    DiffuseTransmission, DiffuseTransmission, {
    /// The share of the light that is reflected, [0, 1] per channel. Default [0, 0, 0].
    color: Option<[f64; 3]>,
    /// The share of the light that is transmitted, [0, 1] per channel; with `color` 1 at most. Required, or a spectrum of it.
    transmittance: Option<[f64; 3]>,
});

material!(
    /// Fibres that stand up from a surface that absorbs light.
    Sheen, Sheen, {
    /// Colour of the fibres, [0, 1] per channel. Required, or a spectrum of it.
    color: Option<[f64; 3]>,
    /// Perceptual roughness, above 0 and up to 1. Default 0.5.
    roughness: Option<f64>,
});

impl Diffuse {
    /// The keys of a diffuse material: Lambert's without a model, or another model with its one number.
    pub(super) fn of(shared: SharedKeys, albedo: Rgb, model: Option<(Brdf, f32)>, survival: Option<f32>) -> Self {
        let is_by_angle = matches!(model, Some((Brdf::OrenNayarQualitative, _)));
        let number = |by_angle: bool| model.filter(|_| is_by_angle == by_angle).map(|(_, number)| number);
        keys!(Self, tags::Diffuse::Diffuse, shared, {
            color: Some(numbers::color(albedo)),
            brdf: model.map(|(brdf, _)| brdf),
            roughness: number(false).map(single),
            sigma_deg: number(true).map(degrees),
            reflection_rate: survival.map(single),
        })
    }
}

impl DiffuseTransmission {
    /// The keys of a sheet.
    pub(super) fn of(shared: SharedKeys, reflectance: Rgb, transmittance: Rgb) -> Self {
        keys!(Self, tags::DiffuseTransmission::DiffuseTransmission, shared, {
            color: unless_color(reflectance, Rgb::ZERO),
            transmittance: Some(numbers::color(transmittance)),
        })
    }
}

impl Sheen {
    /// The keys of fibres.
    pub(super) fn of(shared: SharedKeys, color: Rgb, roughness: f32) -> Self {
        keys!(Self, tags::Sheen::Sheen, shared, {
            color: Some(numbers::color(color)),
            roughness: Some(single(roughness)),
        })
    }
}

impl Kind for Diffuse {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let at = |key: &str| join(path, key);
        let albedo = required(path, "color", self.color, self.spectra.as_ref())?;
        let brdf = self.brdf.unwrap_or_default();
        // A parameter of another model is an error, because the author was mistaken about which model is used.
        let misplaced = match brdf {
            Brdf::Lambertian => [("roughness", self.roughness), ("sigmaDeg", self.sigma_deg)],
            Brdf::OrenNayar | Brdf::Eon => [("sigmaDeg", self.sigma_deg), ("", None)],
            Brdf::OrenNayarQualitative => [("roughness", self.roughness), ("", None)],
        };
        if let Some((key, _)) = misplaced.into_iter().find(|(_, value)| value.is_some()) {
            let owner = if key == "roughness" { "'oren-nayar' or 'eon'" } else { "'oren-nayar-qualitative'" };
            return Err(Error::invalid(at(key), format!("only a material with brdf {owner} has this key")));
        }
        let needed = |key: &str, value: Option<f64>| {
            value.ok_or_else(|| Error::invalid(path, format!("missing key `{key}`, which this brdf needs")))
        };
        Ok(match brdf {
            Brdf::Lambertian => BsdfDesc::Lambert { albedo },
            Brdf::OrenNayar => {
                let roughness = needed("roughness", self.roughness)?;
                BsdfDesc::OrenNayar { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
            }
            Brdf::Eon => {
                let roughness = needed("roughness", self.roughness)?;
                BsdfDesc::Eon { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
            }
            Brdf::OrenNayarQualitative => {
                let degrees = needed("sigmaDeg", self.sigma_deg)?;
                validate::within(&at("sigmaDeg"), degrees, 0.0, 90.0)?;
                BsdfDesc::OrenNayarQualitative { albedo, sigma: degrees.to_radians() as f32 }
            }
        })
    }

    fn survival(&self, path: &str) -> Result<Option<f32>> {
        self.reflection_rate.map(|rate| validate::survival_rate(&join(path, "reflectionRate"), rate)).transpose()
    }
}

impl Kind for DiffuseTransmission {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let reflectance = color(&join(path, "color"), self.color, 0.0)?;
        let transmittance = required(path, "transmittance", self.transmittance, self.spectra.as_ref())?;
        Ok(BsdfDesc::DiffuseTransmission { reflectance, transmittance })
    }
}

impl Kind for Sheen {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let color = required(path, "color", self.color, self.spectra.as_ref())?;
        let roughness = validate::number(&join(path, "roughness"), self.roughness.unwrap_or(0.5))? as f32;
        Ok(BsdfDesc::Sheen { color, roughness })
    }
}
