//! Photometric webs of surfaces in the native format.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::builder::Builder;
use super::json::join;
use super::numbers::{unless, unless_color};
use super::photometric::{LightKeys, Unit};
use super::{AreaWebDesc, validate};
use crate::math::DVec3;
use crate::photometry::LUMENS_PER_WATT;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// A photometric web of a flat surface, a file of IES LM-63 or EULUMDAT. Its axis, gamma = 0, is the surface's normal.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct AreaWeb {
    /// Name of the file, relative to the scene file.
    file: String,
    /// The direction of C = 0, in the frame that `transform` starts from; its part along the surface counts. Default [1, 0, 0].
    c0: Option<[f64; 3]>,
    /// Times `intensity`: a factor on the intensities of the file. Default [1, 1, 1].
    color: Option<[f64; 3]>,
    /// Factor on `color`; with a `unit` the luminous quantity, above 0, to whose luminance `color` is scaled. Default 1; required with a `unit`.
    intensity: Option<f64>,
    /// Unit of `intensity`: "W": a factor, or "lm" of the lamp. Default "W".
    unit: Option<Unit>,
    /// Colour temperature in kelvin, in [1000, 15000], in place of `color`: that of a Planckian radiator, of luminance 1.
    temperature: Option<f64>,
    /// Degrees by which the luminaire is tilted from straight down, for files with factors of tilted lamps. Default 0.
    tilt: Option<f64>,
}

impl AreaWeb {
    /// The web, and the factor on it that is the emission of its surface. The file is read at its first use.
    pub fn resolve(&self, path: &str, builder: &mut Builder<'_>) -> Result<(AreaWebDesc, Rgb)> {
        let default = AreaWebDesc::new(builder.web_file(&join(path, "file"), &self.file)?);
        let web = AreaWebDesc {
            c0: self.c0.map_or(default.c0, DVec3::from_array),
            tilt_deg: self.tilt.unwrap_or(default.tilt_deg),
            ..default
        };
        let flux = web.web.flux() * web.tilt_factor();
        if self.unit == Some(Unit::Lumen) && flux <= 0.0 {
            return Err(Error::invalid(join(path, "unit"), "the file is of a dark lamp, which no factor makes shine"));
        }
        let Self { color, intensity, temperature, unit, .. } = *self;
        let keys = LightKeys { color, intensity, temperature, unit, spectrum: None };
        let (color, factor) = keys.resolve(path, Some([1.0; 3]), &[(Unit::Lumen, flux / LUMENS_PER_WATT)])?;
        let factor = validate::intensity(&join(path, "intensity"), factor)?;
        Ok((web, validate::emission(&join(path, "color"), color, factor)?))
    }

    /// The keys of a web in this file. `c0` is its direction of C = 0 in the frame that is written.
    pub fn write(web: &AreaWebDesc, c0: DVec3, factor: Rgb, file: &str) -> Self {
        let default = AreaWebDesc::new(Arc::clone(&web.web));
        Self {
            file: file.to_owned(),
            c0: (c0 != default.c0).then_some(c0.to_array()),
            color: unless_color(factor, Rgb::ONE),
            intensity: None,
            unit: None,
            temperature: None,
            tilt: unless(web.tilt_deg, default.tilt_deg),
        }
    }
}
