//! The scene as described: plain data in double precision, names resolved, nothing built.
//!
//! Every way of describing a scene (a native JSON file, one of the report's files, calls from a host) ends in one
//! [`SceneDesc`], and `Scene::build` starts from it. [`load`] reads a file, [`parse`] a string; `docs/scene-format.md`
//! describes the format.
//!
//! ```
//! let scene = etendue::desc::parse(
//!     r#"{
//!         "etendue": 1,
//!         "camera": {"origin": [0, 0, 5]},
//!         "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "emission": [1, 1, 1]}]
//!     }"#,
//!     std::path::Path::new("."), // where mesh files are
//!     None,                      // the scene's own file, for messages
//! )?;
//! assert_eq!(scene.surfaces.len(), 1);
//! # Ok::<(), etendue::Error>(())
//! ```
//!
//! All that a file can say can also be said by calls, with the same checks: [`SceneDesc::add_material`],
//! [`SceneDesc::add_surface`] and so on, with shapes from [`ShapeDesc::sphere`] and its like.
//!
//! ```
//! use etendue::desc::{BsdfDesc, CameraDesc, SceneDesc, ShapeDesc, SurfaceLook};
//! use etendue::math::{DAffine3, DVec3};
//! use etendue::spectrum::Rgb;
//!
//! let mut scene = SceneDesc::default();
//! let white = scene.add_material("white", BsdfDesc::Lambert { albedo: Rgb::splat(0.8) }, None)?;
//! scene.add_point_light(DVec3::new(0.0, 4.0, 0.0), Rgb::splat(50.0))?;
//! let (shape, local) = ShapeDesc::cylinder(DVec3::NEG_Z * 5.0, DVec3::Y, 0.5, 2.0)?;
//! let look = SurfaceLook { material: Some(white), ..SurfaceLook::default() };
//! let tube = scene.add_surface(shape, local, look)?;
//! scene.set_transform(tube, DAffine3::from_scale(DVec3::splat(2.0)))?;
//! assert!(scene.set_emission(tube, Some(Rgb::ONE)).is_err());
//! # Ok::<(), etendue::Error>(())
//! ```

mod builder;
mod edit;
mod file;
mod filter;
mod index;
mod integrator;
mod json;
mod mcrt;
mod native;
mod obj;
mod object;
mod params;
mod photon;
mod photon_keys;
mod quadric;
mod radiosity;
mod read;
mod render;
#[cfg(feature = "schema")]
mod schema;
mod shape;
mod surface;
mod transform;
mod validate;
mod warnings;

pub use edit::SurfaceLook;
pub use index::SceneIndex;
pub use integrator::{
    Bias, IntegratorDesc, IntegratorInfo, LobeSupport, LobeUse, MapRenewal, PhotonMethod, Preparation, SampleOrder,
};
pub use object::{HostMesh, MeshDesc, ShapeDesc, SurfaceDesc};
pub use photon::{
    CacheDesc, CacheSource, KernelDesc, MAX_GATHER_RAYS, MAX_NEIGHBOURS, MAX_PHOTON_MEMORY, MAX_PHOTONS, PhotonDesc,
    PhotonSharing, RADII,
};
pub(crate) use radiosity::check_radiosity;
pub use radiosity::{MAX_RADIOSITY_ITERATIONS, MAX_RADIOSITY_MEMORY, RadiosityDesc, RadiositySolver};
pub use read::{apply_params, apply_render, load, load_params, parse};
#[cfg(feature = "schema")]
pub use schema::schema;
pub(crate) use transform::similarity_scale;

use std::path::PathBuf;
use std::sync::Arc;

use crate::math::DVec3;
use crate::spectrum::Rgb;

/// A whole scene and how to render it.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// The file it was read from, for messages.
    pub file: Option<PathBuf>,
    /// The mesh files that were read.
    pub files: Vec<PathBuf>,
    /// Which rules of reading applied.
    pub dialect: Dialect,
    /// Where it is seen from.
    pub camera: CameraDesc,
    /// Lights without a surface. Area lights are surfaces with an emission.
    pub lights: Vec<PointLightDesc>,
    /// Materials, named by index from surfaces.
    pub materials: Vec<MaterialDesc>,
    /// Meshes, named by index from surfaces; one may be used many times. A mesh that is the same `Arc` in the
    /// description of an edited scene is not built again.
    pub meshes: Vec<Arc<MeshDesc>>,
    /// What there is to hit.
    pub surfaces: Vec<SurfaceDesc>,
    /// Resolution, samples, integrator.
    pub render: RenderDesc,
    /// What was read but is worth a word: unknown keys of a report scene, a second definition of a name.
    pub warnings: Vec<String>,
    /// What the calls look up. Of a description put together by hand: the default.
    pub index: SceneIndex,
}

/// The rules a scene file was read by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// `"etendue": 1`.
    #[default]
    Native,
    /// A file of the 2017 report's renderer, `mcrt`.
    Mcrt,
}

/// Which side of the image the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    #[default]
    Horizontal,
    /// The height.
    Vertical,
}

/// A camera. Lengths in scene units, right-handed, angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraDesc {
    /// A pinhole at `eye`.
    Perspective {
        /// Eye point.
        eye: DVec3,
        /// A point in the middle of the image.
        look_at: DVec3,
        /// Upwards in the image; any length, not parallel to the view.
        up: DVec3,
        /// Full angle across `fov_axis`, degrees, in (0, 180).
        fov_deg: f64,
        /// The side that `fov_deg` spans.
        fov_axis: FovAxis,
    },
    /// The report's camera: a view plane with the eye behind it; what lies between eye and plane is not seen.
    ///
    /// With w = normalize(look_at - centre), u = w x up (not normalised) and aspect A, the plane is |u| sqrt(A) wide
    /// and |u| / sqrt(A) high on each side of its centre, and the eye |u| sqrt(A) / tan(fov / 2) behind it.
    ViewPlane {
        /// Centre of the view plane.
        centre: DVec3,
        /// A point in the middle of the image.
        look_at: DVec3,
        /// Upwards; its length scales the plane.
        up: DVec3,
        /// Full horizontal angle, degrees, in (0, 180).
        fov_deg: f64,
    },
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self::Perspective {
            eye: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_deg: 90.0,
            fov_axis: FovAxis::Horizontal,
        }
    }
}

/// A point light.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLightDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Where it is.
    pub position: DVec3,
    /// Radiant intensity [W sr^-1], the same in all directions, >= 0.
    pub intensity: Rgb,
}

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// Its name.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// How it scatters.
    pub bsdf: BsdfDesc,
    /// Russian roulette's survival probability at this material in (0, 1], where the scene states one (the report's
    /// `reflectionRate`). Paths use it only with [`RouletteDesc::File`]. It changes noise and time, never the image.
    pub survival: Option<f32>,
}

/// A scattering model and its parameters. Reflectances in [0, 1] per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfDesc {
    /// Absorbs everything.
    Black,
    /// Lambert.
    Lambert {
        /// Albedo.
        albedo: Rgb,
    },
    /// Oren and Nayar's qualitative model (the report's equations 2 and 3).
    OrenNayarQualitative {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Standard deviation of the facets' slope angle, radians, >= 0.
        sigma: f32,
    },
    /// Fujii's improved Oren-Nayar.
    OrenNayar {
        /// Albedo of the facets.
        albedo: Rgb,
        /// sigma' in [0, 1], not an angle.
        roughness: f32,
    },
    /// Perfect mirror.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
    },
    /// Smooth dielectric: reflects and refracts by Fresnel and Snell.
    Dielectric {
        /// Index of refraction on the side opposite to the normal, > 0.
        ior: f32,
        /// Index on the normal's side, > 0; 1 unless the object is inside another dielectric.
        exterior_ior: f32,
    },
}

/// Pixels of the largest image that is rendered: the film takes a hundred bytes for each.
pub const MAX_PIXELS: u64 = 1 << 26;

/// Most light samples per hit: more cost time that more samples per pixel would spend better, and cannot be
/// interrupted.
pub const MAX_SHADOW_RAYS: u32 = 1 << 10;

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDesc {
    /// Width and height in pixels, each >= 1.
    pub resolution: [u32; 2],
    /// Samples per pixel, >= 1. Grid and jittered patterns use the next square.
    pub samples: u32,
    /// Where samples come from.
    pub sampler: SamplerDesc,
    /// How samples weigh in a pixel.
    pub filter: FilterDesc,
    /// Light transport.
    pub integrator: IntegratorDesc,
    /// Greatest number of surface hits on a path, counting the first visible one; `None` cuts nothing.
    pub max_depth: Option<u32>,
    /// Light samples per hit, from 1 to [`MAX_SHADOW_RAYS`].
    pub shadow_rays: u32,
    /// Which survival probability Russian roulette ends paths by.
    pub roulette: RouletteDesc,
    /// Photon maps.
    pub photons: PhotonDesc,
    /// Irradiance cache.
    pub cache: CacheDesc,
    /// Radiosity.
    pub radiosity: RadiosityDesc,
    /// Seed of all randomness.
    pub seed: u64,
}

impl Default for RenderDesc {
    fn default() -> Self {
        Self {
            resolution: [256, 256],
            samples: 64,
            sampler: SamplerDesc::Sobol,
            filter: FilterDesc::Box,
            integrator: IntegratorDesc::Path,
            max_depth: None,
            shadow_rays: 1,
            roulette: RouletteDesc::Own,
            photons: PhotonDesc::default(),
            cache: CacheDesc::default(),
            radiosity: RadiosityDesc::default(),
            seed: 0,
        }
    }
}

/// Where the samples of a pixel come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerDesc {
    /// Owen-scrambled Sobol' points, in every dimension.
    #[default]
    Sobol,
    /// Independent random numbers.
    Random,
    /// n x n cells, one random position in each.
    Jittered,
    /// n x n regular positions, cell centres.
    Grid,
    /// Normally distributed around the pixel's centre, standard deviation half a pixel (the report's Figure 11); some
    /// positions lie outside the pixel.
    Gaussian,
}

/// A pixel filter, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FilterDesc {
    /// One pixel wide.
    #[default]
    Box,
    /// Triangle, radius 1.
    Tent,
    /// Gaussian of this standard deviation, cut at three of them.
    Gaussian {
        /// Standard deviation, pixels, > 0.
        sigma: f32,
    },
    /// Blackman-Harris window, radius 2.
    BlackmanHarris,
    /// Mitchell-Netravali, radius 2.
    Mitchell {
        /// B.
        b: f32,
        /// C.
        c: f32,
    },
}

/// Which survival probability Russian roulette ends paths by. The choice changes noise and time, never the expected image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RouletteDesc {
    /// The library's own: a path survives in proportion to the throughput that it still carries.
    #[default]
    Own,
    /// The one that the material states ([`MaterialDesc::survival`]), for the first 64 hits of a path; the library's own at
    /// materials that state none. A probability below the albedo makes the noise of bright closed scenes grow without bound.
    File,
}

impl RouletteDesc {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Own, Self::File];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::File => "file",
        }
    }
}
