//! The keys of a backplate in scene files of the native format.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::backplate::{self, BackplateDesc};
use super::builder::Builder;
use super::json::{self, join};
use super::numbers::unless_color;
use super::photometric::{LightKeys, Unit};
use super::save::{self, Names};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// A picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Backplate {
    /// Name of a texture, which is spread over the whole picture.
    texture: Option<String>,
    /// Times `intensity`: radiance, W/(m^2 sr) per channel; with a texture a factor on it. Required without a texture. Default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminance, above 0, to which `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W", or "cd/m2"; with a texture that of its value 1. Default "W".
    unit: Option<Unit>,
}

/// Reads a backplate, after the textures.
pub(super) fn read(raw: &RawValue, builder: &Builder<'_>) -> Result<BackplateDesc> {
    let Backplate { texture, color, intensity, unit } = json::object(raw, backplate::PATH)?;
    let default = texture.is_some().then_some([1.0; 3]);
    if (color, unit, default) == (None, None, None) {
        return Err(Error::invalid(backplate::PATH, "missing key `texture`, or `color`"));
    }
    let keys = LightKeys { color, intensity, unit, ..LightKeys::default() };
    let (color, factor) = keys.resolve(backplate::PATH, default, &[(Unit::CandelaPerArea, 1.0)])?;
    let texture = match texture {
        Some(name) => Some(builder.texture(&join(backplate::PATH, "texture"), &name)?),
        None => None,
    };
    let it = BackplateDesc { radiance: backplate::radiance(color, factor)?, texture };
    it.check(&builder.scene.textures)?;
    Ok(it)
}

/// Writes a backplate, whose numbers have been checked.
pub(super) fn write(it: &BackplateDesc, names: &Names) -> Result<Box<RawValue>> {
    let color = match it.texture {
        Some(_) => unless_color(it.radiance, Rgb::ONE),
        None => Some(super::numbers::color(it.radiance)),
    };
    let texture = it.texture.map(|texture| names.textures[texture].clone());
    save::raw(&Backplate { texture, color, intensity: None, unit: None })
}
