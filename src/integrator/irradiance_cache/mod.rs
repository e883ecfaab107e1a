//! Irradiance caching: indirect light on diffuse surfaces, interpolated between few careful samples of it.

use std::sync::Arc;

use super::photon::Gather;
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::RenderDesc;
use crate::error::Result;
use crate::math::Vec3;
use crate::scene::Scene;
use crate::spectrum::Rgb;

/// Records of irradiance, and where they are.
#[derive(Debug, Default)]
pub struct IrradianceCache {}

/// What filling the cache came to.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Rays traced.
    pub rays: u64,
    /// What a user should know.
    pub notes: Vec<String>,
}

impl IrradianceCache {
    /// Fills a cache for what the camera sees. `source`: what brings back the light of gather rays.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn fill(
        scene: &Scene,
        camera: &Camera,
        desc: &Arc<RenderDesc>,
        source: &Gather,
        parallel: &mut impl Parallel,
    ) -> Result<(Self, Report)> {
        let _ = (scene, camera, desc, source);
        parallel.check()?;
        Ok((Self::default(), Report::default()))
    }

    /// Indirect irradiance [W m^-2] at `p` on the side of the unit normal `n`; `None` where no record speaks for it.
    #[inline]
    pub fn irradiance(&self, p: Vec3, n: Vec3) -> Option<Rgb> {
        let _ = (p, n);
        None
    }
}
