//! The keys of light from infinity in scene files of the native format.

use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::environment::check_portals;
use super::json::join;
use super::numbers::{unless, unless_color};
use super::photometric::{LightKeys, Unit};
use super::save::{self, Names};
use super::{
    DistantLightDesc, EnvironmentDesc, EnvironmentMapDesc, FormulaSkyDesc, HosekWilkieDesc, PortalDesc, SkyDesc,
    SkyProjection, numbers, spectrum_keys, sun_direction, texture_check, validate,
};
use crate::emitter::{SUN_DIAMETER_DEG, SkyFormula};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// Light from infinity, the same from all directions or by a texture. A scene has one environment at most.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Environment {
    #[serde(rename = "type")]
    _type: EnvironmentTag,
    /// Times `intensity`: radiance, W/(m^2 sr) per channel; with a texture a factor on it. Required without a texture. Default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", or "cd/m2"; with a texture that of its value 1. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: radiance, W/(m^2 sr nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
    /// Name of a texture over longitude and latitude, which varies the radiance.
    texture: Option<String>,
    /// With a texture: how the directions lie in its image. Default "latlong".
    projection: Option<ProjectionTag>,
    /// With a texture: the direction that is up in it. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// With a texture: degrees by which it is turned about `up`, counter-clockwise as seen from above. Default 0.
    rotation: Option<f64>,
    /// Whether camera rays that meet nothing show it. Default true.
    visible: Option<bool>,
    /// Openings through which it comes into rooms, each of three or four corners. They make it found sooner there.
    portals: Option<Vec<Vec<[f64; 3]>>>,
}

/// How the directions of a sky lie in an image.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "lowercase")]
enum ProjectionTag {
    /// By longitude and latitude.
    LatLong,
    /// The unfolded faces of an octahedron.
    Octahedral,
    /// The six faces of a cube, one under another.
    Cube,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum EnvironmentTag {
    Environment,
}

/// Light from one direction of infinity: parallel, or of a disk such as the sun's.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Distant {
    #[serde(rename = "type")]
    _type: DistantTag,
    /// Times `intensity`: irradiance of a surface across the light, W/m^2 per channel. Required, or `temperature`, or a `unit`.
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", or "lx" of a surface across the light. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// The spectrum, in place of `color`: irradiance of a surface across the light, W/(m^2 nm); with a `unit`, or with a `color`, whose luminance counts then, its shape alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
    spectrum: Option<Box<RawValue>>,
    /// The direction towards the light. Required, or `sunAt`.
    sun: Option<[f64; 3]>,
    /// Place and time that say where the sun stands, in place of `sun`.
    sun_at: Option<SunAt>,
    /// Angular diameter of the disk, degrees in [0, 180]. Default 0: parallel light.
    angle: Option<f64>,
    /// With `sunAt`: the direction of the zenith. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// Whether camera rays that meet nothing show the disk. Default true.
    visible: Option<bool>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum DistantTag {
    Distant,
}

/// A sky by a formula of the angles to the zenith and to the sun. It is the scene's environment, of which there is one at most.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct FormulaSky {
    #[serde(rename = "type")]
    _type: SkyTag,
    /// Type of the CIE's general sky, 1 to 15: 1 is the overcast sky, 5 an even one, 12 the clear one. Required, or `perez`, or `turbidity`.
    cie: Option<u32>,
    /// The numbers a to e of the formula of Perez and others, in place of `cie`.
    perez: Option<[f64; 5]>,
    /// The clear sky of Hosek and Wilkie, with its sun, in place of `cie`: how hazy the air is, in [1, 10]. It has radiance of its own.
    turbidity: Option<f64>,
    /// Times `intensity`: what `scale` says. Required, or `temperature`, or a `unit`. With a `turbidity` a factor on the radiance of sky and sun, default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", "cd/m2" at the zenith, or "lx" of a horizontal surface by the sky. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// What `color` is: radiance at the zenith, W/(m^2 sr) per channel, or the irradiance of a horizontal surface by the sky, W/m^2 per channel. Default "zenith"; with the unit "lx" it is "horizontal".
    scale: Option<ScaleTag>,
    /// The direction towards the sun. Required where the formula asks for the sun, or `sunAt`.
    sun: Option<[f64; 3]>,
    /// Place and time that say where the sun stands, in place of `sun`.
    sun_at: Option<SunAt>,
    /// The direction of the zenith. Default [0, 1, 0].
    up: Option<[f64; 3]>,
    /// The share of the light that the ground sends back from below the horizon, in [0, 1] per channel. With a `turbidity` the sky knows it too. Default 0.
    ground: Option<[f64; 3]>,
    /// With a `turbidity`: whether there is the disk of the sun. Default true.
    disk: Option<bool>,
    /// With a `turbidity`: angular diameter of the disk, degrees in [0, 180]; 0 is parallel light. Its irradiance stays the same. Default 0.533.
    angle: Option<f64>,
    /// Whether camera rays that meet nothing show it. Default true.
    visible: Option<bool>,
    /// Openings through which it comes into rooms, each of three or four corners. They make it found sooner there.
    portals: Option<Vec<Vec<[f64; 3]>>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum SkyTag {
    Sky,
}

/// What the colour of a sky is.
#[derive(Clone, Copy, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ScaleTag {
    /// The radiance at the zenith.
    Zenith,
    /// The irradiance of a horizontal surface.
    Horizontal,
}

/// A place on the earth and a time.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct SunAt {
    /// Degrees north of the equator, in [-90, 90].
    latitude: f64,
    /// Degrees east of Greenwich, in [-360, 360].
    longitude: f64,
    /// The time in UTC, such as "2026-06-21T10:30:00Z", from 1970 on.
    time: String,
    /// The direction of north, which is turned to be horizontal. Default [0, 0, -1].
    north: Option<[f64; 3]>,
}

/// Writes an environment, whose numbers have been checked.
pub(super) fn write_environment(environment: &EnvironmentDesc, names: &Names) -> Result<Box<RawValue>> {
    match &environment.sky {
        SkyDesc::Formula(sky) => return write_sky(environment, sky),
        SkyDesc::HosekWilkie(sky) => return write_hosek_wilkie(environment, sky),
        SkyDesc::Even | SkyDesc::Map(_) => {}
    }
    let map = environment.map();
    save::raw(&Environment {
        _type: EnvironmentTag::Environment,
        color: Some(numbers::color(environment.radiance)),
        intensity: None,
        unit: None,
        temperature: None,
        spectrum: environment.spectrum.as_ref().map(spectrum_keys::write).transpose()?,
        texture: map.map(|map| names.textures[map.texture].clone()),
        projection: map.and_then(|map| match map.projection {
            SkyProjection::LatLong => None,
            SkyProjection::Octahedral => Some(ProjectionTag::Octahedral),
            SkyProjection::Cube => Some(ProjectionTag::Cube),
        }),
        up: map.filter(|map| map.up != DVec3::Y).map(|map| map.up.to_array()),
        rotation: map.and_then(|map| unless(map.rotation_deg, 0.0)),
        visible: (!environment.visible).then_some(false),
        portals: write_portals(environment),
    })
}

fn write_portals(environment: &EnvironmentDesc) -> Option<Vec<Vec<[f64; 3]>>> {
    let corners = |portal: &PortalDesc| portal.corners.iter().map(DVec3::to_array).collect();
    let portals: Vec<_> = environment.portals.iter().map(corners).collect();
    (!portals.is_empty()).then_some(portals)
}

fn portals(given: Option<Vec<Vec<[f64; 3]>>>) -> Vec<PortalDesc> {
    let portal = |corners: Vec<[f64; 3]>| PortalDesc { corners: corners.into_iter().map(DVec3::from_array).collect() };
    given.unwrap_or_default().into_iter().map(portal).collect()
}

/// Reads an environment.
pub(super) fn environment(light: Environment, path: &str, builder: &mut Builder<'_>) -> Result<EnvironmentDesc> {
    let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
    let Environment { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
    let default = light.texture.is_some().then_some([1.0; 3]);
    if (color, temperature, unit, default) == (None, None, None, None) && spectrum.is_none() {
        return Err(Error::invalid(path, "missing key `color`, or `texture`"));
    }
    let (color, factor) = keys.resolve(path, default, &[(Unit::CandelaPerArea, 1.0)])?;
    let even = validate::environment(path, color, factor)?;
    let sky = match light.texture {
        Some(name) => {
            let texture = builder.texture(&join(path, "texture"), &name)?;
            let up = light.up.map_or(DVec3::Y, DVec3::from_array);
            let projection = match light.projection {
                None | Some(ProjectionTag::LatLong) => SkyProjection::LatLong,
                Some(ProjectionTag::Octahedral) => SkyProjection::Octahedral,
                Some(ProjectionTag::Cube) => SkyProjection::Cube,
            };
            SkyDesc::Map(EnvironmentMapDesc { texture, projection, up, rotation_deg: light.rotation.unwrap_or(0.0) })
        }
        None => {
            let directed = [
                ("up", light.up.is_some()),
                ("rotation", light.rotation.is_some()),
                ("projection", light.projection.is_some()),
            ];
            if let Some((key, _)) = directed.into_iter().find(|(_, given)| *given) {
                let message = "an even sky looks the same from all sides, expected a `texture` with it";
                return Err(Error::invalid(join(path, key), message));
            }
            SkyDesc::Even
        }
    };
    let portals = portals(light.portals);
    let environment = EnvironmentDesc { sky, spectrum, visible: light.visible.unwrap_or(true), portals, ..even };
    check_portals(&environment)?;
    texture_check::environment(&environment, &builder.scene.textures)?;
    Ok(environment)
}

/// Writes distant light, whose numbers have been checked.
pub(super) fn write_distant(light: &DistantLightDesc) -> Result<Box<RawValue>> {
    save::raw(&Distant {
        _type: DistantTag::Distant,
        color: Some(numbers::color(light.irradiance)),
        intensity: None,
        unit: None,
        temperature: None,
        spectrum: light.spectrum.as_ref().map(spectrum_keys::write).transpose()?,
        sun: Some(light.towards.to_array()),
        sun_at: None,
        angle: unless(light.angle_deg, 0.0),
        up: None,
        visible: (!light.visible).then_some(false),
    })
}

fn write_sky(environment: &EnvironmentDesc, sky: &FormulaSkyDesc) -> Result<Box<RawValue>> {
    let cie = sky.formula.cie_number();
    save::raw(&FormulaSky {
        _type: SkyTag::Sky,
        cie,
        perez: cie.is_none().then_some(sky.formula.numbers),
        turbidity: None,
        color: Some(numbers::color(environment.radiance)),
        intensity: None,
        unit: None,
        temperature: None,
        scale: sky.is_horizontal.then_some(ScaleTag::Horizontal),
        sun: Some(sky.sun.to_array()),
        sun_at: None,
        up: (sky.up != DVec3::Y).then(|| sky.up.to_array()),
        ground: unless_color(sky.ground, Rgb::ZERO),
        disk: None,
        angle: None,
        visible: (!environment.visible).then_some(false),
        portals: write_portals(environment),
    })
}

fn write_hosek_wilkie(environment: &EnvironmentDesc, sky: &HosekWilkieDesc) -> Result<Box<RawValue>> {
    save::raw(&FormulaSky {
        _type: SkyTag::Sky,
        cie: None,
        perez: None,
        turbidity: Some(sky.turbidity),
        color: unless_color(environment.radiance, Rgb::ONE),
        intensity: None,
        unit: None,
        temperature: None,
        scale: None,
        sun: Some(sky.sun.to_array()),
        sun_at: None,
        up: (sky.up != DVec3::Y).then(|| sky.up.to_array()),
        ground: unless_color(sky.ground, Rgb::ZERO),
        disk: sky.disk_deg.is_none().then_some(false),
        angle: sky.disk_deg.and_then(|angle| unless(angle, SUN_DIAMETER_DEG)),
        visible: (!environment.visible).then_some(false),
        portals: write_portals(environment),
    })
}

/// Reads distant light.
pub(super) fn distant(light: Distant, path: &str, builder: &mut Builder<'_>) -> Result<DistantLightDesc> {
    let spectrum = spectrum_keys::read_some(light.spectrum.as_deref(), path, builder)?;
    let Distant { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: spectrum.as_ref() };
    let (color, factor) = keys.resolve(path, None, &[(Unit::Lux, 1.0)])?;
    let factor = validate::intensity(&join(path, "intensity"), factor)?;
    let irradiance = validate::emission(&join(path, "color"), color, factor)?;
    if light.up.is_some() && light.sun_at.is_none() {
        return Err(Error::invalid(join(path, "up"), "is used with `sunAt` only"));
    }
    let up = zenith(path, light.up)?;
    let Some(towards) = towards(path, light.sun, light.sun_at.as_ref(), up)? else {
        return Err(Error::invalid(path, "missing key `sun`, or `sunAt`"));
    };
    let angle_deg = light.angle.unwrap_or(0.0);
    let visible = light.visible.unwrap_or(true);
    let light = DistantLightDesc { path: path.to_owned(), towards, irradiance, angle_deg, visible, spectrum };
    light.check()?;
    Ok(light)
}

/// Reads a sky by a formula.
pub(super) fn sky(light: FormulaSky, path: &str) -> Result<EnvironmentDesc> {
    if let Some(turbidity) = light.turbidity {
        return hosek_wilkie(light, turbidity, path);
    }
    for (key, given) in [("disk", light.disk.is_some()), ("angle", light.angle.is_some())] {
        if given {
            return Err(Error::invalid(
                join(path, key),
                "is used with `turbidity` only: other skies have no sun in them",
            ));
        }
    }
    let formula = match (light.cie, light.perez) {
        (Some(number), None) => SkyFormula::cie(number).ok_or_else(|| {
            Error::invalid(join(path, "cie"), format!("{number} is out of range, expected a whole number from 1 to 15"))
        })?,
        (None, Some(numbers)) => SkyFormula { numbers, is_cie: false },
        (Some(_), Some(_)) => {
            return Err(Error::invalid(join(path, "perez"), "`cie` says the formula already, expected one of both"));
        }
        (None, None) => return Err(Error::invalid(path, "missing key `cie`, or `perez`, or `turbidity`")),
    };
    let FormulaSky { color, intensity, temperature, unit, .. } = light;
    let keys = LightKeys { color, intensity, temperature, unit, spectrum: None };
    // Luminance is that of the zenith and illuminance that of the horizontal, whether or not the scale says so too.
    let (scale, units) = match (light.scale, unit) {
        (None, Some(Unit::Lux)) => (ScaleTag::Horizontal, (Unit::Lux, 1.0)),
        (None | Some(ScaleTag::Zenith), _) => (ScaleTag::Zenith, (Unit::CandelaPerArea, 1.0)),
        (Some(ScaleTag::Horizontal), _) => (ScaleTag::Horizontal, (Unit::Lux, 1.0)),
    };
    let (color, factor) = keys.resolve(path, None, &[units])?;
    let even = validate::environment(path, color, factor)?;
    let up = zenith(path, light.up)?;
    let sun = match towards(path, light.sun, light.sun_at.as_ref(), up)? {
        Some(sun) => sun,
        None if formula.asks_sun() => return Err(Error::invalid(path, "missing key `sun`, or `sunAt`")),
        None => up,
    };
    let ground = validate::reflectance(&join(path, "ground"), light.ground.unwrap_or_default())?;
    let is_horizontal = scale == ScaleTag::Horizontal;
    let sky = FormulaSkyDesc { formula, sun, up, is_horizontal, ground };
    validate::formula_sky(path, &sky, even.radiance)?;
    let (visible, portals) = (light.visible.unwrap_or(true), portals(light.portals));
    let environment = EnvironmentDesc { sky: SkyDesc::Formula(sky), visible, portals, ..even };
    check_portals(&environment)?;
    Ok(environment)
}

/// Reads the clear sky of Hosek and Wilkie.
fn hosek_wilkie(light: FormulaSky, turbidity: f64, path: &str) -> Result<EnvironmentDesc> {
    for (key, given) in [("cie", light.cie.is_some()), ("perez", light.perez.is_some())] {
        if given {
            let message = "`turbidity` says the formula already, expected one of both";
            return Err(Error::invalid(join(path, key), message));
        }
    }
    let scaled = [("unit", light.unit.is_some()), ("scale", light.scale.is_some())];
    for (key, given) in scaled.into_iter().chain([("temperature", light.temperature.is_some())]) {
        if given {
            let message =
                "with `turbidity` the sky has radiance of its own, expected `color` and `intensity` only, as factors";
            return Err(Error::invalid(join(path, key), message));
        }
    }
    let even = validate::environment(path, light.color.unwrap_or([1.0; 3]), light.intensity.unwrap_or(1.0))?;
    let up = zenith(path, light.up)?;
    let Some(sun) = towards(path, light.sun, light.sun_at.as_ref(), up)? else {
        return Err(Error::invalid(path, "missing key `sun`, or `sunAt`"));
    };
    if light.angle.is_some() && light.disk == Some(false) {
        return Err(Error::invalid(join(path, "angle"), "is the diameter of a disk that `disk` leaves out"));
    }
    let ground = validate::reflectance(&join(path, "ground"), light.ground.unwrap_or_default())?;
    let disk_deg = light.disk.unwrap_or(true).then(|| light.angle.unwrap_or(SUN_DIAMETER_DEG));
    let sky = HosekWilkieDesc { turbidity, sun, up, ground, disk_deg };
    sky.check(path, even.radiance)?;
    let (visible, portals) = (light.visible.unwrap_or(true), portals(light.portals));
    let environment = EnvironmentDesc { sky: SkyDesc::HosekWilkie(sky), visible, portals, ..even };
    check_portals(&environment)?;
    Ok(environment)
}

/// The direction that a key says is up.
fn zenith(path: &str, up: Option<[f64; 3]>) -> Result<DVec3> {
    let Some(up) = up else { return Ok(DVec3::Y) };
    validate::direction(&join(path, "up"), up)?;
    Ok(DVec3::from_array(up))
}

/// The direction towards the sun, by itself or by place and time.
fn towards(path: &str, sun: Option<[f64; 3]>, at: Option<&SunAt>, up: DVec3) -> Result<Option<DVec3>> {
    let Some(at) = at else { return Ok(sun.map(DVec3::from_array)) };
    let path = join(path, "sunAt");
    if sun.is_some() {
        return Err(Error::invalid(path, "`sun` says the direction already, expected one of both"));
    }
    let within = |key: &str, value: f64, most: f64| {
        let message = || format!("{value} is out of range, expected {} to {most} degrees", -most);
        if value.abs() <= most { Ok(value) } else { Err(Error::invalid(join(&path, key), message())) }
    };
    let (latitude, longitude) = (within("latitude", at.latitude, 90.0)?, within("longitude", at.longitude, 360.0)?);
    let time =
        humantime::parse_rfc3339(&at.time).ok().and_then(|time| time.duration_since(SystemTime::UNIX_EPOCH).ok());
    let Some(time) = time else {
        let given: String = at.time.chars().take(40).collect();
        let message =
            format!("'{given}' is no time in UTC, expected one such as \"2026-06-21T10:30:00Z\", from 1970 on");
        return Err(Error::invalid(join(&path, "time"), message));
    };
    let up = up.normalize();
    let north = match at.north {
        Some(north) => validate::direction(&join(&path, "north"), north)?,
        None => DVec3::NEG_Z,
    };
    let level = north - north.dot(up) * up;
    if level.length() < 1e-6 {
        let message = "is parallel to `up`, expected a direction on the horizon";
        return Err(Error::invalid(join(&path, "north"), message));
    }
    let north = level.normalize();
    let [east, northwards, upwards] = sun_direction(latitude, longitude, time.as_secs_f64()).to_array();
    if upwards <= 0.0 {
        let message = format!("the sun is {:.1} degrees below the horizon then", -upwards.asin().to_degrees());
        return Err(Error::invalid(join(&path, "time"), message));
    }
    Ok(Some(east * north.cross(up) + northwards * north + upwards * up))
}
