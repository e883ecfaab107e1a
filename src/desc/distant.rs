//! Light from one direction of infinity.

use super::edit::none_such;
use super::json::join;
use super::{SceneDesc, SpectrumDesc, spectrum_edit, validate};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// Light that comes from one direction of infinity, such as that of the sun: parallel, or of a disk of even radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct DistantLightDesc {
    /// JSON path, for messages.
    pub path: String,
    /// The direction towards the light, of any length but 0.
    pub towards: DVec3,
    /// Irradiance of a surface across the light [W m^-2], each channel >= 0.
    pub irradiance: Rgb,
    /// Angular diameter of the disk, degrees in [0, 180]; 0: parallel light. That of the sun is about 0.533.
    pub angle_deg: f64,
    /// Whether camera rays that meet nothing show the disk. Mirrors and glass show it in any case; parallel light is never seen.
    pub visible: bool,
    /// The shape of the spectrum, of which renders in wavelengths get the luminance of `irradiance`; `None` for the smooth spectrum of the
    /// colour times that of D65.
    pub spectrum: Option<SpectrumDesc>,
}

impl DistantLightDesc {
    /// Parallel light.
    pub fn parallel(towards: DVec3, irradiance: Rgb) -> Self {
        Self { path: String::new(), towards, irradiance, angle_deg: 0.0, visible: true, spectrum: None }
    }

    /// The checked light, with the colour of its spectrum.
    fn dressed(self) -> Result<Self> {
        self.check()?;
        let irradiance = spectrum_edit::dressed(&self.path, self.spectrum.as_ref(), self.irradiance)?;
        Ok(Self { irradiance, ..self })
    }

    pub(super) fn check(&self) -> Result<()> {
        let path = &self.path;
        validate::direction(&join(path, "sun"), self.towards)?;
        validate::emission(&join(path, "color"), self.irradiance.to_f64(), 1.0)?;
        let angle = validate::number(&join(path, "angle"), self.angle_deg)?;
        if !(0.0..=180.0).contains(&angle) {
            return Err(Error::invalid(
                join(path, "angle"),
                format!("{angle} is out of range, expected 0 to 180 degrees"),
            ));
        }
        let sine = (0.5 * angle.to_radians()).sin();
        if sine > 0.0 && !Rgb::from_f64(self.irradiance.to_f64() / (sine * sine)).is_finite() {
            let message = format!("{angle} is too small for this irradiance: the radiance is beyond single precision");
            return Err(Error::invalid(join(path, "angle"), message));
        }
        Ok(())
    }
}

impl SceneDesc {
    /// Adds distant light and returns its number among them. Its `path` is not read.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `distant[..]`: `.sun` for no direction, `.color[..]` or `.angle`.
    pub fn add_distant_light(&mut self, light: DistantLightDesc) -> Result<usize> {
        let light = DistantLightDesc { path: format!("distant[{}]", self.distant_lights.len()), ..light };
        let light = light.dressed()?;
        self.distant_lights.push(light);
        Ok(self.distant_lights.len() - 1)
    }

    /// Changes distant light. An irradiance of zero switches it off.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_distant_light`], and an error for a number that no light has.
    pub fn set_distant_light(&mut self, number: usize, light: DistantLightDesc) -> Result<()> {
        let count = self.distant_lights.len();
        let Some(known) = self.distant_lights.get_mut(number) else {
            return Err(none_such(&format!("distant[{number}]"), "distant light", number, count));
        };
        let light = DistantLightDesc { path: known.path.clone(), ..light };
        *known = light.dressed()?;
        Ok(())
    }
}
