//! Settings of photon maps and of the irradiance cache.

/// Most photons of one map: 32 bytes each, 16 GiB.
pub const MAX_PHOTONS: u32 = 1 << 29;

/// Most nearest neighbours of a density estimate.
pub const MAX_NEIGHBOURS: u32 = 1 << 16;

/// Radii of density estimates that single precision can square, scene units.
pub const RADII: [f64; 2] = [1e-18, 1e18];

/// Most rays of a final gather: more cost time that more samples per pixel would spend better.
pub const MAX_GATHER_RAYS: u32 = 1 << 10;

/// Most memory that photon maps can be given (MiB).
pub const MAX_PHOTON_MEMORY: u32 = 1 << 20;

/// How photons are shot, stored and gathered. What a method does not use has no effect on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonDesc {
    /// Light paths of the map (of each pass, where maps are made anew), from 1 to [`MAX_PHOTONS`]; `None`: as many as the
    /// method does best with.
    pub count: Option<u32>,
    /// Radius of a density estimate, scene units, within [`RADII`]; where it shrinks, the first one. `None`: 0.1 for
    /// [`super::IntegratorDesc::PhotonDirect`] as in the report, else from what a pixel sees.
    pub radius: Option<f64>,
    /// Fewer photons than this within the radius are no estimate for [`super::IntegratorDesc::PhotonDirect`], which then
    /// sends shadow rays; from 1 to [`MAX_PHOTONS`].
    pub min_photons: u32,
    /// Light paths of the caustic map, as `count`.
    pub caustic_count: Option<u32>,
    /// Radius of caustics, as `radius`.
    pub caustic_radius: Option<f64>,
    /// So many nearest photons make an estimate, those beyond the radius left out, from 2 to [`MAX_NEIGHBOURS`]; 0: all
    /// within the radius, as always with the report's map and with [`super::IntegratorDesc::Ppm`] by default; `None`: all
    /// within a radius that each pixel has of its own, from what it meets first.
    pub neighbours: Option<u32>,
    /// How photons weigh by their distance; `None`: a cone for the report's map, Epanechnikov's kernel for all others.
    pub kernel: Option<KernelDesc>,
    /// Of the progressive methods: the share of photons kept as radii shrink, in (0, 1). Knaus and Zwicker 2011, Eq. 18.
    pub alpha: f64,
    /// How emitters share the photons.
    pub sharing: PhotonSharing,
    /// Whether caustic photons are aimed at the specular surfaces.
    pub guided: bool,
    /// Whether the caustic map of [`super::IntegratorDesc::Caustic`] is made anew for every pass, with a shrinking radius.
    pub progressive: bool,
    /// Rays of a final gather, from 1 to [`MAX_GATHER_RAYS`].
    pub gather_rays: u32,
    /// Most memory of all maps at a time (MiB), from 1 to [`MAX_PHOTON_MEMORY`].
    pub memory: u32,
}

impl Default for PhotonDesc {
    fn default() -> Self {
        Self {
            count: None,
            radius: None,
            min_photons: 10,
            caustic_count: None,
            caustic_radius: None,
            neighbours: None,
            kernel: None,
            alpha: 2.0 / 3.0,
            sharing: PhotonSharing::Power,
            guided: true,
            progressive: true,
            gather_rays: 1,
            memory: 4096,
        }
    }
}

/// How photons weigh by their distance d from where the density is asked for, within the radius r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KernelDesc {
    /// All the same.
    Flat,
    /// 1 - d / (k r), the report's cone filter.
    Cone {
        /// k, >= 1.
        k: f32,
    },
    /// 1 - d^2 / r^2.
    Epanechnikov,
}

/// How emitters share the photons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotonSharing {
    /// By their power, so that all photons carry nearly the same.
    #[default]
    Power,
    /// By their area, as in the report. Points have none.
    Area,
}

/// How the irradiance cache is filled and read.
#[derive(Clone, Debug, PartialEq)]
pub struct CacheDesc {
    /// Greatest error that Ward's estimate allows where records are interpolated, in (0, 10].
    pub error: f64,
    /// Rays of a record's final gather, from 16 to 2^20.
    pub rays: u32,
    /// Smallest distance at which records are worth keeping apart, in pixels as seen by the camera, in
    /// (0, 1000]; at most a quarter of the greatest.
    pub min_spacing: f64,
    /// Greatest distance over which a record is used, as a share of the scene's extent, in (0, 1].
    pub max_spacing: f64,
    /// What the gather's rays bring back.
    pub source: CacheSource,
}

impl Default for CacheDesc {
    fn default() -> Self {
        Self { error: 0.25, rays: 512, min_spacing: 3.0, max_spacing: 0.1, source: CacheSource::Paths }
    }
}

/// Where the light of a cache's gather rays comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CacheSource {
    /// Paths: no bias but the interpolation's.
    #[default]
    Paths,
    /// The global photon map: faster, with its bias.
    Photons,
}
