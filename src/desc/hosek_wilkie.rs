//! The clear sky of Hosek and Wilkie, with its sun.

use super::environment::y_to;
use super::json::join;
use super::{DistantLightDesc, EnvironmentDesc, SkyDesc, validate};
use crate::emitter::{HosekWilkieSky, SUN_DIAMETER_DEG, solar_irradiance};
use crate::math::{DMat3, DVec3};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The clear sky of Hosek and Wilkie (2012) over a ground, with the disk of its sun (2013). It has radiance of its own, on which that of
/// the environment is a factor: linear Rec. 709 in W m^-2 sr^-1, whose luminance is 683 lm/W times the weighted sum of its channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HosekWilkieDesc {
    /// How hazy the air is, in [1, 10]: 1 is pure air, 2 very clear, 3 clear, 6 warm and moist, 10 hazy.
    pub turbidity: f64,
    /// The direction towards the sun, of any length but 0 and not below the horizon.
    pub sun: DVec3,
    /// The direction of the zenith, of any length but 0.
    pub up: DVec3,
    /// Albedo of the ground, [0, 1] per channel. The sky is brighter over a bright ground, and from below the horizon the ground sends
    /// back evenly this share of what the sky, and the sun where its disk is shown, give it.
    pub ground: Rgb,
    /// Angular diameter of the disk of the sun, degrees in [0, 180], 0 for parallel light; the irradiance is that of the real sun in any
    /// case. `None`: the sky alone.
    pub disk_deg: Option<f64>,
}

impl HosekWilkieDesc {
    /// A sky with +y up over a black ground, with the disk of the sun.
    pub fn new(turbidity: f64, sun: DVec3) -> Self {
        Self { turbidity, sun, up: DVec3::Y, ground: Rgb::ZERO, disk_deg: Some(SUN_DIAMETER_DEG) }
    }

    /// From the frame of the sky, with y up, to the world.
    pub fn to_world(&self) -> DMat3 {
        DMat3::from_quat(y_to(self.up))
    }

    /// The unit direction to the sun in the frame of the sky.
    fn local_sun(&self) -> DVec3 {
        (self.to_world().transpose() * self.sun).normalize_or(DVec3::Y)
    }

    /// The irradiance [W m^-2] of a surface across the light of the sun, by the model alone; 0 without the disk.
    pub fn sun_irradiance(&self) -> DVec3 {
        let elevation = self.local_sun().y.clamp(0.0, 1.0).asin();
        self.disk_deg.map_or(DVec3::ZERO, |_| solar_irradiance(self.turbidity, elevation))
    }

    /// The sky, of which the environment has this radiance.
    pub(crate) fn model(&self, factor: Rgb) -> HosekWilkieSky {
        let sun = self.local_sun();
        let mut sky = HosekWilkieSky::new(self.turbidity, sun, self.ground, factor);
        sky.light_ground(self.ground, factor.to_f64() * self.sun_irradiance() * sun.y.max(0.0));
        sky
    }

    /// Checks the sky of an environment that has this path and radiance.
    pub(super) fn check(&self, path: &str, factor: Rgb) -> Result<()> {
        validate::within(&join(path, "turbidity"), self.turbidity, 1.0, 10.0)?;
        let up = validate::direction(&join(path, "up"), self.up)?;
        let sun = validate::direction(&join(path, "sun"), self.sun)?;
        // On the horizon, rounding may put it under it.
        if sun.dot(up) < -1e-9 {
            let below = -sun.dot(up).max(-1.0).asin().to_degrees();
            let message = format!("the sun is {below:.3} degrees below the horizon, where the sky has no formula");
            return Err(Error::invalid(join(path, "sun"), message));
        }
        validate::reflectance(&join(path, "ground"), self.ground.to_f64())?;
        let sky = HosekWilkieSky::new(self.turbidity, self.local_sun(), self.ground, factor);
        // The ground is not brighter than what shines on it.
        let most = sky.bound() + factor.to_f64() * self.sun_irradiance();
        if !Rgb::from_f64(most).is_finite() {
            let message = format!("{:?} times the sky is beyond single precision", factor.to_array());
            return Err(Error::invalid(join(path, "color"), message));
        }
        match self.light(path.to_owned(), factor) {
            Some(sun) => sun.check(),
            None => Ok(()),
        }
    }

    /// The light of the sun, in the terms of distant light.
    fn light(&self, path: String, factor: Rgb) -> Option<DistantLightDesc> {
        let irradiance = Rgb::from_f64(factor.to_f64() * self.sun_irradiance());
        let light = DistantLightDesc::parallel(self.sun, irradiance);
        self.disk_deg.map(|angle_deg| DistantLightDesc { path, angle_deg, ..light })
    }
}

impl EnvironmentDesc {
    /// The sun that its sky has, as distant light beside those of the scene. `None` for skies without; the sun of hazy air at the horizon
    /// may have an irradiance of 0.
    pub fn sun(&self) -> Option<DistantLightDesc> {
        let SkyDesc::HosekWilkie(sky) = &self.sky else { return None };
        let light = sky.light(self.path.clone(), self.radiance)?;
        Some(DistantLightDesc { visible: self.visible, ..light })
    }
}

impl SkyDesc {
    /// The same sky without a sun of its own.
    pub fn without_sun(self) -> Self {
        match self {
            Self::HosekWilkie(sky) => Self::HosekWilkie(HosekWilkieDesc { disk_deg: None, ..sky }),
            other => other,
        }
    }
}
