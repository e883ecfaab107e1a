//! Descriptions of lights without a surface.

use std::f64::consts::PI;
use std::sync::Arc;

use super::edit::none_such;
use super::{SceneDesc, SpectrumDesc, validate};
use crate::Result;
use crate::math::DVec3;
use crate::photometry::Web;
use crate::spectrum::Rgb;

/// A point light.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLightDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Position of the light in the world frame.
    pub position: DVec3,
    /// Radiant intensity [W sr^-1] where the distribution is 1, >= 0; with a web a factor on its candela over 683 lm/W.
    pub intensity: Rgb,
    /// How the radiant intensity varies by direction.
    pub distribution: LightDistribution,
    /// The shape of the spectrum, of which renders in wavelengths get the luminance of `intensity`; `None` for the smooth spectrum of the
    /// colour times that of D65.
    pub spectrum: Option<SpectrumDesc>,
}

/// How the radiant intensity of a point varies by direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LightDistribution {
    /// Not at all.
    #[default]
    Even,
    /// A cone of light.
    Spot(SpotDesc),
    /// A measured lamp.
    Web(WebDesc),
}

/// A photometric web, and how it is turned.
#[derive(Clone, Debug, PartialEq)]
pub struct WebDesc {
    /// The intensities.
    pub web: Arc<Web>,
    /// The lamp's axis, gamma = 0, of any length but 0.
    pub direction: DVec3,
    /// The direction of C = 0, of any length but 0. Its part across `direction` counts; where there is none, some direction across is
    /// taken. C grows counter-clockwise as seen along the axis.
    pub c0: DVec3,
    /// Degrees by which the luminaire is tilted from straight down, where it was measured. It chooses the factor of files that have some
    /// for tilted lamps ([`Web::tilt_factor`]), and turns nothing: `direction` says where the lamp points. A lamp that moves keeps it.
    pub tilt_deg: f64,
}

impl WebDesc {
    /// The factor on the intensities by the lamp's tilt, 0 beyond the angles that the file has.
    pub fn tilt_factor(&self) -> f64 {
        self.web.tilt_factor(self.tilt_deg).unwrap_or(0.0)
    }

    /// A lamp that hangs, with C = 0 towards +x.
    pub fn new(web: Arc<Web>) -> Self {
        Self { web, direction: DVec3::NEG_Y, c0: DVec3::X, tilt_deg: 0.0 }
    }
}

/// A cone of light with a soft edge: the factor on the radiant intensity is 1 up to the inner angle from the axis, 0 from the outer
/// angle on, and between them ((cos a - cos outer) / (cos inner - cos outer))^2, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotDesc {
    /// The axis, away from the light, of any length but 0.
    pub direction: DVec3,
    /// Degrees between the axis and the directions from which on there is no light, in [[`SpotDesc::NARROWEST`], 180].
    pub outer_deg: f64,
    /// Degrees between the axis and the directions up to which the light is full, in [0, `outer_deg`].
    pub inner_deg: f64,
}

impl SpotDesc {
    /// The least outer angle in degrees. Directions of single precision could not tell the edge of a narrower cone.
    pub const NARROWEST: f64 = 0.01;

    /// The integral of the factor over all directions \[sr\]: the flux of the light over its intensity along the axis.
    pub fn solid_angle(&self) -> f64 {
        let [inner, outer] = [self.inner_deg, self.outer_deg].map(|degrees| degrees.to_radians());
        // As squares of sines of half the angles, which keep the digits of narrow cones.
        let share = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
        2.0 * PI * (share(inner) + (share(outer) - share(inner)) / 3.0)
    }

    /// The angles that files of glTF do not have to give: 45 degrees, of which none has the full light.
    pub fn new(direction: DVec3) -> Self {
        Self { direction, outer_deg: 45.0, inner_deg: 0.0 }
    }
}

impl PointLightDesc {
    /// A point light of this radiant intensity [W sr^-1] in all directions.
    pub fn even(position: DVec3, intensity: Rgb) -> Self {
        Self { path: String::new(), position, intensity, distribution: LightDistribution::Even, spectrum: None }
    }
}

impl SceneDesc {
    /// Adds a point light and returns its number. `intensity` is radiant intensity [W sr^-1], each channel >= 0, the same in all
    /// directions.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `lights[..].origin[..]` or `lights[..].color[..]`.
    pub fn add_point_light(&mut self, position: DVec3, intensity: Rgb) -> Result<usize> {
        self.add_light_desc(PointLightDesc::even(position, intensity))
    }

    /// Moves a point light and changes its intensity; what it has for a distribution stays. An intensity of zero switches the light
    /// off.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_point_light`], and an error for a number that no light has.
    pub fn set_point_light(&mut self, light: usize, position: DVec3, intensity: Rgb) -> Result<()> {
        let mut edited = PointLightDesc::even(position, intensity);
        if let Some(known) = self.lights.get(light) {
            (edited.distribution, edited.spectrum) = (known.distribution.clone(), known.spectrum.clone());
        }
        self.set_light_desc(light, edited)
    }

    /// Adds a point light with its distribution and returns its number. The path of the description is not read.
    ///
    /// # Errors
    /// Those of [`Self::add_point_light`], and [`crate::ErrorKind::InvalidScene`] at `lights[..].direction`, `.outerConeAngle`,
    /// `.innerConeAngle`, `.c0` or `.tilt`.
    pub fn add_light_desc(&mut self, light: PointLightDesc) -> Result<usize> {
        let path = format!("lights[{}]", self.lights.len());
        self.lights.push(validate::light(PointLightDesc { path, ..light })?);
        Ok(self.lights.len() - 1)
    }

    /// Replaces a point light and its distribution. The light of a file keeps its path.
    ///
    /// # Errors
    /// Those of [`Self::add_light_desc`], and an error for a number that no light has.
    pub fn set_light_desc(&mut self, light: usize, value: PointLightDesc) -> Result<()> {
        let count = self.lights.len();
        let Some(known) = self.lights.get_mut(light) else {
            return Err(none_such(&format!("lights[{light}]"), "point light", light, count));
        };
        *known = validate::light(PointLightDesc { path: known.path.clone(), ..value })?;
        Ok(())
    }
}
