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
//! [`SceneDesc::save`] writes a description as a scene file, whatever it was made from.
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
//! scene.set_emission(tube, Some(Rgb::ONE))?;
//! assert!(scene.set_emission(tube, Some(Rgb::splat(-1.0))).is_err());
//! # Ok::<(), etendue::Error>(())
//! ```

mod area_web;
mod area_web_keys;
mod backplate;
mod backplate_keys;
mod builder;
mod camera;
mod camera_check;
mod camera_keys;
mod dispersion;
mod distant;
mod edit;
mod edit_textures;
mod environment;
mod file;
mod filter;
mod framing;
mod gltf;
mod grid;
mod grid_keys;
mod group;
mod group_keys;
mod hosek_wilkie;
mod index;
mod integrator;
mod json;
mod light;
mod light_keys;
mod material;
mod material_check;
mod material_keys;
mod material_spectra;
mod mcrt;
mod mesh_file;
mod mesh_files;
mod microfacets;
mod motion;
mod motion_keys;
mod native;
mod numbers;
mod object;
mod params;
mod photometric;
mod photon;
mod photon_keys;
mod principled;
mod quadric;
mod radiosity;
mod radiosity_keys;
mod read;
mod render;
mod render_block;
mod render_keys;
mod render_write;
mod save;
mod scene;
mod scene_file;
#[cfg(feature = "schema")]
mod schema;
mod shape;
mod shared_mesh;
mod sky_keys;
mod spectrum;
mod spectrum_edit;
mod spectrum_file;
mod spectrum_keys;
mod sun;
mod surface;
mod surfaces;
mod texture;
mod texture_check;
mod texture_keys;
mod thin_film;
mod transform;
mod validate;
mod warnings;
mod white_balance;

pub use area_web::AreaWebDesc;
pub use backplate::BackplateDesc;
pub use camera::{CameraDesc, FilmDesc, FocusDesc, FovAxis, LensDesc, MAX_BLADES, Panorama, PanoramaDesc};
pub(crate) use camera::{PIXEL_ASPECTS, SHIFTS};
pub use dispersion::{Dispersion, GLASSES, Glass, LINE_D, SELLMEIER_TERMS};
pub use distant::DistantLightDesc;
pub use edit::SurfaceLook;
pub use environment::{
    EnvironmentDesc, EnvironmentMapDesc, FormulaSkyDesc, MAX_PORTALS, PortalDesc, SkyDesc, SkyProjection,
};
pub(crate) use file::{check_regular, open as open_file};
pub use grid::{GridDesc, GridPoints, MAX_GRID_POINTS, PlaneGridDesc};
pub use grid_keys::{load_grids, parse_grids};
pub use group::{GroupDesc, MAX_PLACED_SURFACES, PlacementDesc};
pub use hosek_wilkie::HosekWilkieDesc;
pub use index::SceneIndex;
pub use integrator::{
    Bias, IntegratorDesc, IntegratorInfo, LobeSupport, LobeUse, MapRenewal, PhotonMethod, Preparation, SampleOrder,
};
#[cfg(feature = "capi")]
pub(crate) use json::below;
pub(crate) use json::elided;
pub use light::{LightDistribution, PointLightDesc, SpotDesc, WebDesc};
pub(crate) use material::Body;
pub use material::{BsdfDesc, MaterialDesc, MediumDesc};
pub use mesh_file::{MeshFile, ReadMesh};
pub use microfacets::{ConductorDesc, Distribution, METALS, Masking, Metal, MicrofacetsDesc};
pub use motion::{
    KeyPlace, MAX_MOTION_KEYS, MAX_SHUTTER_CURVE, MeshStep, MotionDesc, MotionKey, SceneMotion, ShutterDesc,
};
pub use object::{HostMesh, MeshDesc, ShapeDesc, SurfaceDesc};
pub use photon::{
    CacheDesc, CacheSource, KernelDesc, MAX_GATHER_RAYS, MAX_NEIGHBOURS, MAX_PHOTON_MEMORY, MAX_PHOTONS, PhotonDesc,
    PhotonSharing, RADII,
};
pub use principled::PrincipledDesc;
pub(crate) use principled::weighted_eta;
pub use radiosity::{MAX_RADIOSITY_ITERATIONS, MAX_RADIOSITY_MEMORY, RadiosityDesc, RadiositySolver};
pub(crate) use radiosity_keys::check_radiosity;
pub use read::{LoadOptions, apply_params, apply_render, load, load_params, load_with, parse, parse_gltf, parse_with};
pub use render::{CropDesc, FilterDesc, MAX_PIXELS, MAX_SHADOW_RAYS, RenderDesc, RouletteDesc, SamplerDesc};
pub use scene::{Dialect, SceneDesc};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use shared_mesh::SharedMesh;
pub use spectrum::{LightSpectrum, MOST_SPECTRUM_SAMPLES, SpectrumDesc, SpectrumKey, StandardIlluminant};
pub use spectrum_edit::SpectrumTarget;
pub use sun::sun_direction;
pub(crate) use surfaces::{BlockFacts, SurfaceBlock};
pub use surfaces::{SurfaceIter, SurfaceIterMut, Surfaces};
pub(crate) use texture::Parameter;
pub use texture::{
    ImageTextureDesc, Projection, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource,
};
pub use thin_film::{THICKEST_FILM, ThinFilmDesc};
pub(crate) use white_balance::chromaticity as white_of;
