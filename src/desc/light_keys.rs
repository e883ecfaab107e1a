//! Point lights of a native scene file: reads and writes them.

use std::f64::consts::PI;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::numbers::{unless, unless_color};
use super::photometric::{LightKeys, Unit};
use super::{
    LightDistribution, MotionDesc, PointLightDesc, SceneDesc, SpotDesc, WebDesc, motion_keys, numbers, save,
    spectrum_keys, validate,
};
use crate::math::DVec3;
use crate::photometry::LUMENS_PER_WATT;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// A light that shines from a point, the same in all directions.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct PointLight {
    #[serde(rename = "type")]
    _type: PointTag,
    /// Position.
    origin: [f64; 3],
    /// Times `intensity`: radiant intensity, W/sr per channel. Required, or `temperature`, or a `unit`.
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", "cd", or "lm" of all directions. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: radiant intensity, W/(sr nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
    /// Keyframes, by which the light is moved and turned from where the other keys have it. Default: it rests.
    motion: Option<Vec<motion_keys::Key>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum PointTag {
    Point,
}

/// A light that shines from a point into a cone with a soft edge.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct SpotLight {
    #[serde(rename = "type")]
    _type: SpotTag,
    /// Position.
    origin: [f64; 3],
    /// The axis of the cone, away from the light, of any length.
    direction: [f64; 3],
    /// Times `intensity`: radiant intensity along the axis, W/sr per channel. Required, or `temperature`, or a `unit`.
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", "cd" along the axis, or "lm" of the cone. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: radiant intensity, W/(sr nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
    /// Degrees between the axis and the directions from which on there is no light, in [0.01, 180]. Default 45.
    outer_cone_angle: Option<f64>,
    /// Degrees between the axis and the directions up to which the light is full, in [0, outerConeAngle]. Default 0.
    inner_cone_angle: Option<f64>,
    /// Keyframes, by which the light is moved and turned from where the other keys have it. Default: it rests.
    motion: Option<Vec<motion_keys::Key>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum SpotTag {
    Spot,
}

/// A measured lamp: a point that shines as a file of IES LM-63 or EULUMDAT says.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct WebLight {
    #[serde(rename = "type")]
    _type: WebTag,
    /// Name of the file, relative to the scene file.
    file: String,
    /// Position.
    origin: [f64; 3],
    /// The axis of the lamp, gamma = 0, of any length. Default [0, -1, 0].
    direction: Option<[f64; 3]>,
    /// The direction of C = 0, whose part across `direction` counts. Default [1, 0, 0].
    c0: Option<[f64; 3]>,
    /// Times `intensity`: a factor on the intensities of the file. Default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W": a factor, or "lm" of the lamp. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: radiant intensity, W/(sr nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
    /// Degrees by which the luminaire is tilted from straight down, for files with factors of tilted lamps. Default 0.
    tilt: Option<f64>,
    /// Keyframes, by which the light is moved and turned from where the other keys have it. Default: it rests.
    motion: Option<Vec<motion_keys::Key>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum WebTag {
    Web,
}

/// A point light, and its keyframes.
type MovingLight = (PointLightDesc, Option<Vec<motion_keys::Key>>);

/// Adds a point light with its motion.
pub(super) fn put(scene: &mut SceneDesc, path: &str, (light, motion): MovingLight) -> Result<()> {
    scene.lights.push(light);
    match motion {
        None => Ok(()),
        Some(keys) => {
            let motion = motion_keys::motion(keys, &join(path, "motion"))?;
            scene.set_light_motion(scene.lights.len() - 1, Some(motion))
        }
    }
}

/// Reads a point light.
pub(super) fn point(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<MovingLight> {
    let light: PointLight = json::object(raw, path)?;
    let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
    let PointLight { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
    let (color, factor) = keys.resolve(path, None, &[(Unit::Candela, 1.0), (Unit::Lumen, 4.0 * PI)])?;
    let even = validate::point_light(path, light.origin, color, factor)?;
    Ok((PointLightDesc { spectrum, ..even }, light.motion))
}

/// Reads a spot light.
pub(super) fn spot(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<MovingLight> {
    let light: SpotLight = json::object(raw, path)?;
    let default = SpotDesc::new(DVec3::from_array(light.direction));
    let spot = SpotDesc {
        outer_deg: light.outer_cone_angle.unwrap_or(default.outer_deg),
        inner_deg: light.inner_cone_angle.unwrap_or(default.inner_deg),
        ..default
    };
    validate::spot(path, &spot)?;
    let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
    let SpotLight { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
    let (color, factor) = keys.resolve(path, None, &[(Unit::Candela, 1.0), (Unit::Lumen, spot.solid_angle())])?;
    let even = validate::point_light(path, light.origin, color, factor)?;
    Ok((PointLightDesc { distribution: LightDistribution::Spot(spot), spectrum, ..even }, light.motion))
}

/// Reads a measured lamp. The file is read at its first use.
pub(super) fn web(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<MovingLight> {
    let light: WebLight = json::object(raw, path)?;
    let default = WebDesc::new(builder.web_file(&join(path, "file"), &light.file)?);
    let web = WebDesc {
        direction: light.direction.map_or(default.direction, DVec3::from_array),
        c0: light.c0.map_or(default.c0, DVec3::from_array),
        tilt_deg: light.tilt.unwrap_or(default.tilt_deg),
        ..default
    };
    validate::web(path, &web, Rgb::ZERO)?;
    let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
    let WebLight { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
    let flux = web.web.flux() * web.tilt_factor();
    if unit == Some(Unit::Lumen) && flux <= 0.0 {
        return Err(Error::invalid(join(path, "unit"), "the file is of a dark lamp, which no factor makes shine"));
    }
    // A factor of 1 is the flux of the file as the lamp is tilted, so a unit is one lumen per watt less.
    let (color, factor) = keys.resolve(path, Some([1.0; 3]), &[(Unit::Lumen, flux / LUMENS_PER_WATT)])?;
    let even = validate::point_light(path, light.origin, color, factor)?;
    validate::web(path, &web, even.intensity)?;
    Ok((PointLightDesc { distribution: LightDistribution::Web(web), spectrum, ..even }, light.motion))
}

/// Writes a point light, whose numbers have been checked. `file` is the name of the file of its web, where it has one.
pub(super) fn write(light: &PointLightDesc, file: &str, motion: Option<&MotionDesc>) -> Result<Box<RawValue>> {
    let (origin, color) = (light.position.to_array(), numbers::color(light.intensity));
    let motion = motion.map(motion_keys::write_motion);
    let spectrum = light.spectrum.as_ref().map(spectrum_keys::write).transpose()?;
    match &light.distribution {
        LightDistribution::Even => save::raw(&PointLight {
            _type: PointTag::Point,
            origin,
            color: Some(color),
            intensity: None,
            unit: None,
            temperature: None,
            spectrum,
            motion,
        }),
        LightDistribution::Spot(spot) => {
            let default = SpotDesc::new(spot.direction);
            save::raw(&SpotLight {
                _type: SpotTag::Spot,
                origin,
                direction: spot.direction.to_array(),
                color: Some(color),
                intensity: None,
                unit: None,
                temperature: None,
                spectrum,
                outer_cone_angle: unless(spot.outer_deg, default.outer_deg),
                inner_cone_angle: unless(spot.inner_deg, default.inner_deg),
                motion,
            })
        }
        LightDistribution::Web(web) => {
            let default = WebDesc::new(Arc::clone(&web.web));
            save::raw(&WebLight {
                _type: WebTag::Web,
                file: file.to_owned(),
                origin,
                direction: (web.direction != default.direction).then_some(web.direction.to_array()),
                c0: (web.c0 != default.c0).then_some(web.c0.to_array()),
                tilt: unless(web.tilt_deg, default.tilt_deg),
                color: unless_color(light.intensity, Rgb::ONE),
                intensity: None,
                unit: None,
                temperature: None,
                spectrum,
                motion,
            })
        }
    }
}
