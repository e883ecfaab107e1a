//! The description of a scene: plain data in double precision, with names resolved and nothing built.
//!
//! Every way of describing a scene (a native JSON file, one of the report's files, calls from a host) produces one
//! [`SceneDesc`], from which `Scene::build` starts. [`load`] reads a file and [`parse`] reads a string;
//! `docs/scene-format.md` describes the format.
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
//! Everything that a file can describe can also be described by calls, with the same checks:
//! [`SceneDesc::add_material`], [`SceneDesc::add_surface`] and so on, with shapes from [`ShapeDesc::sphere`] and the
//! other constructors.
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

/// A whole scene and its render settings.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// The file from which the scene was read, for messages.
    pub file: Option<PathBuf>,
    /// The mesh files that were read.
    pub files: Vec<PathBuf>,
    /// The dialect by whose rules the scene was read.
    pub dialect: Dialect,
    /// The camera.
    pub camera: CameraDesc,
    /// Lights without a surface. Area lights are surfaces with an emission.
    pub lights: Vec<PointLightDesc>,
    /// Materials, named by index from surfaces.
    pub materials: Vec<MaterialDesc>,
    /// Meshes, named by index from surfaces. One mesh may be used many times. A mesh that is the same `Arc` in the
    /// description of an edited scene is not built again.
    pub meshes: Vec<Arc<MeshDesc>>,
    /// Surfaces that rays can hit.
    pub surfaces: Vec<SurfaceDesc>,
    /// Render settings, such as resolution, samples and integrator.
    pub render: RenderDesc,
    /// Warnings about the text that was read, such as unknown keys of a report scene or a second definition of a name.
    pub warnings: Vec<String>,
    /// The index by which the calls find elements. A description that is put together by hand has the default index.
    pub index: SceneIndex,
}

/// The rules by which a scene file was read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// A native scene, with `"etendue": 1`.
    #[default]
    Native,
    /// A file of the 2017 report's renderer, `mcrt`.
    Mcrt,
}

/// The side of the image that the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    #[default]
    Horizontal,
    /// The height.
    Vertical,
}

/// A camera. Lengths are in scene units, the frame is right-handed, and angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraDesc {
    /// A pinhole at `eye`.
    Perspective {
        /// Eye point.
        eye: DVec3,
        /// A point that is seen in the middle of the image.
        look_at: DVec3,
        /// The direction that is up in the image. It has any length and is not parallel to the view direction.
        up: DVec3,
        /// Full angle across `fov_axis` in degrees, in (0, 180).
        fov_deg: f64,
        /// The side that `fov_deg` spans.
        fov_axis: FovAxis,
    },
    /// The report's camera: a view plane with the eye behind it. Surfaces between the eye and the plane are not seen.
    ///
    /// With w = normalize(look_at - centre), u = w x up (not normalised) and aspect A, the plane is |u| sqrt(A) wide
    /// and |u| / sqrt(A) high on each side of its centre, and the eye |u| sqrt(A) / tan(fov / 2) behind it.
    ViewPlane {
        /// Centre of the view plane.
        centre: DVec3,
        /// A point that is seen in the middle of the image.
        look_at: DVec3,
        /// The direction that is up in the image. Its length scales the plane.
        up: DVec3,
        /// Full horizontal angle in degrees, in (0, 180).
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
    /// Position of the light in the world frame.
    pub position: DVec3,
    /// Radiant intensity [W sr^-1], the same in all directions, >= 0.
    pub intensity: Rgb,
}

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// The material's name.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// The scattering model and its parameters.
    pub bsdf: BsdfDesc,
    /// The survival probability of Russian roulette at this material in (0, 1], where the scene states one (the
    /// report's `reflectionRate`). Paths use it only with [`RouletteDesc::File`]. It changes noise and time, never the
    /// image.
    pub survival: Option<f32>,
}

/// A scattering model and its parameters. Reflectances are in [0, 1] per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfDesc {
    /// A surface that absorbs all light.
    Black,
    /// Lambert's model.
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
    /// Fujii's improved Oren-Nayar model.
    OrenNayar {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Fujii's roughness sigma' in [0, 1], which is not an angle.
        roughness: f32,
    },
    /// Perfect mirror.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
    },
    /// A smooth dielectric, which reflects by Fresnel's equations and refracts by Snell's law.
    Dielectric {
        /// Index of refraction on the side opposite to the normal, > 0.
        ior: f32,
        /// Index of refraction on the normal's side, > 0; 1 unless the object is inside another dielectric.
        exterior_ior: f32,
    },
}

/// Number of pixels of the largest image that is rendered. The film takes a hundred bytes for each pixel.
pub const MAX_PIXELS: u64 = 1 << 26;

/// Greatest number of light samples per hit. More samples cannot be interrupted, and their time is better spent on more
/// samples per pixel.
pub const MAX_SHADOW_RAYS: u32 = 1 << 10;

/// Render settings.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDesc {
    /// Width and height in pixels, each >= 1.
    pub resolution: [u32; 2],
    /// Samples per pixel, >= 1. Grid and jittered patterns round the number up to the next square.
    pub samples: u32,
    /// The sampler, which places the samples of a pixel.
    pub sampler: SamplerDesc,
    /// The pixel filter, which weighs the samples of a pixel.
    pub filter: FilterDesc,
    /// The light transport algorithm.
    pub integrator: IntegratorDesc,
    /// Greatest number of surface hits on a path, counting the first visible one; `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Light samples per hit, from 1 to [`MAX_SHADOW_RAYS`].
    pub shadow_rays: u32,
    /// The survival probability by which Russian roulette ends paths.
    pub roulette: RouletteDesc,
    /// Settings of photon maps.
    pub photons: PhotonDesc,
    /// Settings of the irradiance cache.
    pub cache: CacheDesc,
    /// Settings of radiosity.
    pub radiosity: RadiosityDesc,
    /// Seed of all random numbers.
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

/// The positions of the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerDesc {
    /// Owen-scrambled Sobol' points, in every dimension.
    #[default]
    Sobol,
    /// Independent random numbers.
    Random,
    /// The pixel is divided into n x n cells, and each cell has one random position.
    Jittered,
    /// The pixel is divided into n x n cells, and the positions are the cell centres.
    Grid,
    /// Positions are normally distributed around the pixel's centre with a standard deviation of half a pixel (the
    /// report's Figure 11). Some positions lie outside the pixel.
    Gaussian,
}

/// A pixel filter. Lengths are in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FilterDesc {
    /// Box filter, one pixel wide.
    #[default]
    Box,
    /// Triangle filter, radius 1.
    Tent,
    /// Gaussian of this standard deviation, truncated at three standard deviations.
    Gaussian {
        /// Standard deviation in pixels, > 0.
        sigma: f32,
    },
    /// Blackman-Harris window, radius 2.
    BlackmanHarris,
    /// Mitchell-Netravali, radius 2.
    Mitchell {
        /// The parameter B.
        b: f32,
        /// The parameter C.
        c: f32,
    },
}

/// The survival probability by which Russian roulette ends paths. The choice changes noise and time, never the expected
/// image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RouletteDesc {
    /// The library's own probability: a path survives in proportion to the throughput that it still carries.
    #[default]
    Own,
    /// The probability that the material states ([`MaterialDesc::survival`]), for the first 64 hits of a path. At
    /// materials that state none, the library's own probability is used. A probability below the albedo makes the noise
    /// of bright closed scenes grow without bound.
    File,
}

impl RouletteDesc {
    /// All values.
    pub const ALL: [Self; 2] = [Self::Own, Self::File];

    /// The value's name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::File => "file",
        }
    }
}
