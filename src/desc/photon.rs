//! Settings of photon maps and of the irradiance cache.

/// Greatest number of photons of one map. A photon takes 32 bytes, so this is 16 GiB.
pub const MAX_PHOTONS: u32 = 1 << 29;

/// Greatest number of nearest neighbours of a density estimate.
pub const MAX_NEIGHBOURS: u32 = 1 << 16;

/// Range of the radii of density estimates whose squares single precision can represent, in scene units.
pub const RADII: [f64; 2] = [1e-18, 1e18];

/// Greatest number of rays of a final gather. The time of more rays is better spent on more samples per pixel.
pub const MAX_GATHER_RAYS: u32 = 1 << 10;

/// Greatest memory limit that photon maps can be given (MiB).
pub const MAX_PHOTON_MEMORY: u32 = 1 << 20;

/// How photons are emitted, stored and gathered. Settings that a method does not use have no effect on it.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonDesc {
    /// Number of light paths of the map (of each pass, where maps are built for every pass), from 1 to [`MAX_PHOTONS`].
    /// With `None` the method chooses the number that suits it best.
    pub count: Option<u32>,
    /// Radius of a density estimate in scene units, within [`RADII`]; where the radius shrinks, this is the first one.
    /// With `None` it is 0.1 for [`super::IntegratorDesc::PhotonDirect`], as in the report, and otherwise it is derived
    /// from the extent that a pixel sees.
    pub radius: Option<f64>,
    /// Smallest number of photons within the radius that makes an estimate for [`super::IntegratorDesc::PhotonDirect`],
    /// which sends shadow rays where there are fewer; from 1 to [`MAX_PHOTONS`].
    pub min_photons: u32,
    /// Number of light paths of the caustic map, with the same range and default as `count`.
    pub caustic_count: Option<u32>,
    /// Radius of density estimates in the caustic map, with the same range and default as `radius`.
    pub caustic_radius: Option<f64>,
    /// Number of nearest photons that make an estimate, without those beyond the radius, from 2 to [`MAX_NEIGHBOURS`].
    /// With 0 all photons within the radius make the estimate, as always with the report's map and by default with
    /// [`super::IntegratorDesc::Ppm`]. With `None` all photons within a radius make the estimate, where each pixel has
    /// its own radius, which is derived from its first hits.
    pub neighbours: Option<u32>,
    /// The kernel that weighs photons by their distance. With `None` it is a cone for the report's map and
    /// Epanechnikov's kernel for all others.
    pub kernel: Option<KernelDesc>,
    /// The share of photons that progressive methods keep as radii shrink, in (0, 1). Source: Knaus and Zwicker 2011,
    /// Eq. 18.
    pub alpha: f64,
    /// How the photons are divided between the emitters.
    pub sharing: PhotonSharing,
    /// Whether caustic photons are aimed at the specular surfaces.
    pub guided: bool,
    /// Whether the caustic map of [`super::IntegratorDesc::Caustic`] is built anew for every pass, with a shrinking
    /// radius.
    pub progressive: bool,
    /// Number of rays of a final gather, from 1 to [`MAX_GATHER_RAYS`].
    pub gather_rays: u32,
    /// Memory limit of all maps that exist at a time (MiB), from 1 to [`MAX_PHOTON_MEMORY`].
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

/// The weight of a photon as a function of its distance d from the point of the density estimate, within the radius r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KernelDesc {
    /// All photons have the same weight.
    Flat,
    /// The weight is 1 - d / (k r), the report's cone filter.
    Cone {
        /// The parameter k, >= 1.
        k: f32,
    },
    /// The weight is 1 - d^2 / r^2.
    Epanechnikov,
}

/// How the photons are divided between the emitters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotonSharing {
    /// Photons are divided by the emitters' power, so that all photons carry nearly the same power.
    #[default]
    Power,
    /// Photons are divided by the emitters' area, as in the report. Point lights have no area.
    Area,
}

/// How the irradiance cache is filled and interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct CacheDesc {
    /// Greatest error of Ward's estimate at which records are interpolated, in (0, 10].
    pub error: f64,
    /// Number of rays of a record's final gather, from 16 to 2^20.
    pub rays: u32,
    /// Smallest distance over which a record is used, in pixels as seen by the camera, in (0, 1000]; it is limited to a
    /// quarter of the greatest distance, `max_spacing`.
    pub min_spacing: f64,
    /// Greatest distance over which a record is used, as a share of the scene's extent, in (0, 1].
    pub max_spacing: f64,
    /// The source of the light that the gather rays find.
    pub source: CacheSource,
}

impl Default for CacheDesc {
    fn default() -> Self {
        Self { error: 0.25, rays: 512, min_spacing: 3.0, max_spacing: 0.1, source: CacheSource::Paths }
    }
}

/// The source of the light that the gather rays of a cache find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CacheSource {
    /// Gather rays continue as paths. The only bias is that of the interpolation.
    #[default]
    Paths,
    /// Gather rays read the global photon map. This is faster and has the bias of the map.
    Photons,
}
