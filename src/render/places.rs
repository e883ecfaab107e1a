//! Renders of light at places: sites of surfaces, and points of space.

use std::sync::Arc;

use super::Render;
use super::adaptive::MIN_PIXELS;
use super::method::Method;
use super::settings::RenderSettings;
use crate::desc::{FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::film::TILE;
use crate::integrator::{Irradiance, Path, Probe, ProbeQuantity, Probes, Sites, check_support};
use crate::scene::Scene;

/// Number of pixels in a row of a film of irradiance: one tile.
pub const IRRADIANCE_WIDTH: u32 = TILE;

/// Most points of space that lie in one row of a film: many tiles with few points each, so that all threads have work.
const MOST_PROBES_IN_A_ROW: usize = 1 << 12;

impl Render {
    /// Prepares a render of the irradiance [W m^-2] of sites by path tracing, on the outer side of their surfaces (`front`) or
    /// on the other side.
    ///
    /// The film has one pixel for each site, row by row, and [`IRRADIANCE_WIDTH`] pixels in a row. The pixels that are left
    /// over in the last row show the first sites once more. The settings for resolution, crop, integrator, filter and auxiliary
    /// layers are ignored. The depth counts the site itself as the first hit. All samplers other than `Random` count as
    /// `Sobol`.
    ///
    /// # Errors
    /// The errors of [`Render::new`], and `InvalidScene` where there is no site.
    pub fn irradiance(scene: &Scene, settings: RenderSettings, sites: Arc<Sites>, front: bool) -> Result<Self> {
        if sites.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "there is no surface whose irradiance could be asked for"));
        }
        let rows = sites.len().div_ceil(IRRADIANCE_WIDTH as usize);
        let desc = RenderDesc {
            resolution: [IRRADIANCE_WIDTH, u32::try_from(rows).unwrap_or(u32::MAX)],
            crop: None,
            integrator: IntegratorDesc::Path,
            filter: FilterDesc::Box,
            sampler: match settings.desc.sampler {
                SamplerDesc::Random => SamplerDesc::Random,
                _ => SamplerDesc::Sobol,
            },
            ..settings.desc
        };
        let path = Path::new(desc.max_depth, desc.shadow_rays);
        let settings = RenderSettings { desc, auxiliary: false, light_parts: false, ..settings };
        Self::with_method(scene, settings, Some(Method::Irradiance(Irradiance::new(sites, path, front))))
    }

    /// Prepares a render of the light at points of space (see [`Probes`]): by a radiosity solution where the settings'
    /// integrator is radiosity, and else by path tracing.
    ///
    /// The film has one pixel for each point, in one row, or in rows of [`IRRADIANCE_WIDTH`] pixels where the points are many;
    /// pixels that are left over in the last row show the first points once more. Settings for resolution, crop, filter and
    /// auxiliary layers are ignored. For irradiance the depth counts the point itself as the first hit. All samplers other
    /// than `Random` count as `Sobol`.
    ///
    /// # Errors
    /// The errors of [`Render::new`], and `InvalidScene` where there is no point.
    pub fn probes(scene: &Scene, settings: RenderSettings, probes: &[Probe], quantity: ProbeQuantity) -> Result<Self> {
        if probes.is_empty() {
            return Err(Error::new(ErrorKind::InvalidScene, "there is no point whose light could be asked for"));
        }
        let width = if probes.len() <= MOST_PROBES_IN_A_ROW { probes.len() } else { IRRADIANCE_WIDTH as usize };
        let rows = u32::try_from(probes.len().div_ceil(width)).unwrap_or(u32::MAX);
        let integrator = match settings.desc.integrator {
            IntegratorDesc::Radiosity => IntegratorDesc::Radiosity,
            _ => IntegratorDesc::Path,
        };
        check_support(scene, integrator)?;
        let desc = RenderDesc {
            resolution: [width as u32, rows],
            crop: None,
            integrator,
            filter: FilterDesc::Box,
            sampler: match settings.desc.sampler {
                SamplerDesc::Random => SamplerDesc::Random,
                _ => SamplerDesc::Sobol,
            },
            ..settings.desc
        };
        let path = Path::new(desc.max_depth, desc.shadow_rays);
        // Few points are no image whose pixels could be chosen among, and nobody asked for that.
        let adaptive = settings.adaptive.or(((probes.len() as u64) < MIN_PIXELS).then_some(false));
        let settings = RenderSettings { desc, adaptive, auxiliary: false, light_parts: false, ..settings };
        Self::with_method(scene, settings, Some(Method::Probes(Probes::new(scene, probes, quantity, path))))
    }
}
