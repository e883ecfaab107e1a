//! The plain types of the interface: enumerations, options, records.
//!
//! Structures that may grow begin with their own size; zero bytes in a field mean its default, so that a structure from an
//! older header stays valid. Enumerations come in as numbers and are checked: a Rust enumeration with a value it does not
//! have would be undefined behaviour.

use std::ffi::{c_char, c_void};

use super::boundary::Versioned;
use super::status::{etd_error, etd_status};

/// Numbers of enumerations that come from C, called by the enumeration's own name in the header.
mod numbers {
    /// The enumeration of this name, as a number.
    pub type EtdUsage = u32;
    /// The enumeration of this name, as a number.
    pub type EtdCameraType = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFovAxis = u32;
    /// The enumeration of this name, as a number.
    pub type EtdBsdf = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPositionFormat = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSharing = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSampler = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFilter = u32;
    /// The enumeration of this name, as a number.
    pub type EtdIntegrator = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPhotonKernel = u32;
    /// The enumeration of this name, as a number.
    pub type EtdPhotonSharing = u32;
    /// The enumeration of this name, as a number.
    pub type EtdCacheSource = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSwitch = u32;
    /// The enumeration of this name, as a number.
    pub type EtdRadiositySolver = u32;
    /// The enumeration of this name, as a number.
    pub type EtdErrorMeasure = u32;
    /// The enumeration of this name, as a number.
    pub type EtdLayer = u32;
    /// The enumeration of this name, as a number.
    pub type EtdFormat = u32;
    /// The enumeration of this name, as a number.
    pub type EtdToneMap = u32;
    /// The enumeration of this name, as a number.
    pub type EtdText = u32;
    /// The enumeration of this name, as a number.
    pub type EtdAtlasLayout = u32;
    /// The enumeration of this name, as a number.
    pub type EtdSide = u32;
}
pub use numbers::*;

pub use {
    etd_atlas_layout::*, etd_bsdf::*, etd_cache_source::*, etd_camera_type::*, etd_ended::*, etd_error_measure::*,
    etd_filter::*, etd_format::*, etd_fov_axis::*, etd_integrator::*, etd_layer::*, etd_log_level::*, etd_phase::*,
    etd_photon_kernel::*, etd_photon_sharing::*, etd_position_format::*, etd_radiosity_solver::*, etd_sampler::*,
    etd_sharing::*, etd_side::*, etd_switch::*, etd_text::*, etd_tone_map::*, etd_usage::*,
};

/// Stands for "no material", "no surface", "no mesh".
pub const ETD_NONE: u32 = 0xffff_ffff;

/// How much a message matters.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_log_level {
    /// What a user should know: something was left out, or will take long, or is biased.
    ETD_LOG_WARNING = 0,
    /// What was decided and how long it took.
    ETD_LOG_INFO = 1,
}

/// Told warnings and decisions. `message` is UTF-8 and lives during the call.
///
/// Called on whichever thread has something to say, several at once where several threads work. It must not unwind (throw),
/// and may make any call that does not wait for the work that called it.
pub type etd_log_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, level: etd_log_level, message: *const c_char)>;

/// Told every failing call on an object of the device, on the thread of the call, before it returns. As `etd_log_fn`; a
/// call that fails inside it is not reported again.
pub type etd_error_fn =
    Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status, message: *const c_char)>;

/// A piece of work for the host's executor: to be called once with its argument, on any thread, at any time, be it after
/// everything was released: then it finds nothing to do.
pub type etd_work_fn = Option<unsafe extern "C" fn(argument: *mut c_void)>;

/// Takes a piece of work for the host's own threads, and returns without waiting for it.
///
/// Called on the thread of a render, once for each helper and pass. The host must call `work(argument)` exactly once;
/// running it late, or in the calling thread, does no harm. It must not unwind.
pub type etd_submit_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, work: etd_work_fn, argument: *mut c_void)>;

/// Called when memory that was shared with a mesh is no longer read. Exactly once, on any thread, perhaps in the middle of
/// another call; it may make no calls of this library.
pub type etd_release_fn = Option<unsafe extern "C" fn(user_data: *mut c_void)>;

/// Told how far work has come; return 0 to go on and anything else to cancel.
///
/// Called about ten times a second and after each pass, never twice at once for one piece of work: on the calling thread
/// by `etd_render` and by what makes and bakes light maps, on the task's own thread by `etd_render_start`, on one of the
/// building threads while a scene is built.
/// It must not unwind; it may map and copy the film, and must not wait for the work that called it.
pub type etd_progress_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, progress: *const etd_progress) -> i32>;

/// Told once that a task has ended, and how, on the task's thread, before `etd_task_wait` returns. As `etd_progress_fn`.
pub type etd_finished_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status)>;

/// How a device works.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_device_options {
    /// `sizeof(etd_device_options)`.
    pub struct_size: usize,
    /// Threads that render and build. 0: one for each core. 1: no thread of its own, everything is done by the thread that
    /// calls (a started task has one, as something must run it). Else so many, in a pool that belongs to the device.
    /// With `submit`: how many threads the host offers, the calling one included.
    pub threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Bytes that hierarchies, placed geometry and films of this device may take together; 0: no limit. Descriptions
    /// (copies of the host's arrays among them) and memory of the host are not counted.
    pub memory_limit: u64,
    /// Told warnings and decisions; may be NULL.
    pub log: etd_log_fn,
    /// Told failing calls; may be NULL.
    pub error: etd_error_fn,
    /// The host's executor; NULL: the device has threads of its own.
    pub submit: etd_submit_fn,
    /// Given back to the three functions. They may be called until the device and everything made with it is released.
    pub user_data: *mut c_void,
}

/// How a scene's geometry is kept.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_usage {
    /// As one piece where possible: fastest to trace. At the first change of geometry after it was built it becomes
    /// dynamic by itself.
    ETD_USAGE_STATIC = 0,
    /// Every larger mesh has a hierarchy of its own, so that adding, moving or removing something touches nothing else.
    ETD_USAGE_DYNAMIC = 1,
}

/// How a scene is made.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_options {
    /// `sizeof(etd_scene_options)`.
    pub struct_size: usize,
    /// An `etd_usage`.
    pub usage: EtdUsage,
    /// Must be 0.
    pub reserved: u32,
    /// The folder in which a scene from text looks for mesh files; NULL: the current one.
    pub base_dir: *const c_char,
    /// A parameter file of the report's renderer that overrides the scene's own settings; NULL: none.
    pub params_file: *const c_char,
}

/// How a camera projects.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_camera_type {
    /// A pinhole at `origin`.
    ETD_CAMERA_PERSPECTIVE = 0,
    /// The report's camera: `origin` is the centre of a view plane, the eye lies behind it, and the length of `up` scales
    /// the plane.
    ETD_CAMERA_VIEW_PLANE = 1,
}

/// The side of the image that a camera's field of view spans.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_fov_axis {
    /// The width.
    ETD_FOV_HORIZONTAL = 0,
    /// The height; perspective cameras only.
    ETD_FOV_VERTICAL = 1,
}

/// Where a scene is seen from: world frame, right-handed, lengths in scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_camera {
    /// `sizeof(etd_camera)`.
    pub struct_size: usize,
    /// An `etd_camera_type`.
    pub projection: EtdCameraType,
    /// An `etd_fov_axis`.
    pub fov_axis: EtdFovAxis,
    /// The eye, or the centre of the view plane.
    pub origin: [f64; 3],
    /// A point in the middle of the image, other than `origin`.
    pub look_at: [f64; 3],
    /// Upwards in the image, not parallel to the view; any length.
    pub up: [f64; 3],
    /// Full angle of view, degrees, between 0 and 180.
    pub fov_deg: f64,
}

/// How a surface scatters light.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_bsdf {
    /// Absorbs everything.
    ETD_BSDF_BLACK = 0,
    /// Lambert, by `color`.
    ETD_BSDF_LAMBERT = 1,
    /// Fujii's improved Oren-Nayar, by `color` and `roughness`.
    ETD_BSDF_OREN_NAYAR = 2,
    /// Oren and Nayar's qualitative model, by `color` and `sigma_deg`.
    ETD_BSDF_OREN_NAYAR_QUALITATIVE = 3,
    /// A perfect mirror, by `color`.
    ETD_BSDF_MIRROR = 4,
    /// Smooth clear glass, by `ior` and `exterior_ior`.
    ETD_BSDF_DIELECTRIC = 5,
}

/// A material. Fields that its model does not use are not looked at.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_material {
    /// `sizeof(etd_material)`.
    pub struct_size: usize,
    /// An `etd_bsdf`.
    pub bsdf: EtdBsdf,
    /// Albedo or reflectance, linear, [0, 1] per channel.
    pub color: [f32; 3],
    /// Fujii's sigma', in [0, 1].
    pub roughness: f32,
    /// Standard deviation of the facets' slope angle, degrees, in [0, 90].
    pub sigma_deg: f32,
    /// Index of refraction on the side opposite to the normal, > 0.
    pub ior: f32,
    /// Index of refraction on the normal's side, > 0; 0 means 1.
    pub exterior_ior: f32,
    /// Survival probability of Russian roulette at this material, in (0, 1]; 0: the library chooses. It changes noise and
    /// time, never the image.
    pub survival: f32,
    /// Must be 0.
    pub reserved: u32,
}

/// What numbers an array of positions holds.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_position_format {
    /// Three `float`.
    ETD_POSITION_FLOAT3 = 0,
    /// Three `double`; always copied.
    ETD_POSITION_DOUBLE3 = 1,
}

/// Who keeps the arrays of a mesh.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_sharing {
    /// They are copied during the call.
    ETD_COPY = 0,
    /// They are read in place, and must neither change nor go away until `release` is called. Positions must be `float`,
    /// and 16 bytes readable from the last one on. A mesh that emits light is copied nevertheless when it is built.
    ETD_SHARE = 1,
}

/// A triangle mesh in arrays of the host.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_mesh {
    /// `sizeof(etd_mesh)`.
    pub struct_size: usize,
    /// One position for each vertex, the mesh's own frame.
    pub positions: *const c_void,
    /// Bytes from one position to the next; 0: they lie close together.
    pub position_stride: usize,
    /// Bytes that can be read from `positions` on; 0: up to the end of the last stride. Only looked at with `ETD_SHARE`.
    pub position_bytes: usize,
    /// Number of vertices, at least 1 and below 2^32 - 1.
    pub vertex_count: usize,
    /// Three vertex numbers for each triangle, counter-clockwise seen from outside.
    pub indices: *const u32,
    /// Bytes from one triangle's numbers to the next; 0: they lie close together.
    pub index_stride: usize,
    /// Number of triangles, at least 1 and below 2^32 - 1.
    pub triangle_count: usize,
    /// One normal for each vertex, any length; NULL: none.
    pub normals: *const f32,
    /// Bytes from one normal to the next; 0: they lie close together.
    pub normal_stride: usize,
    /// One texture coordinate for each vertex; NULL: none.
    pub uvs: *const f32,
    /// Bytes from one texture coordinate to the next; 0: they lie close together.
    pub uv_stride: usize,
    /// An `etd_position_format`.
    pub position_format: EtdPositionFormat,
    /// An `etd_sharing`.
    pub sharing: EtdSharing,
    /// With `ETD_SHARE`: told once that the arrays are no longer read; may be NULL. Not called if the call fails.
    pub release: etd_release_fn,
    /// Given to `release`.
    pub user_data: *mut c_void,
    /// A name to find it by, unique among meshes; NULL: none.
    pub name: *const c_char,
}

/// Everything about a surface but its shape.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_surface {
    /// `sizeof(etd_surface)`.
    pub struct_size: usize,
    /// Number of its material; `ETD_NONE` for a surface that emits light and reflects none.
    pub material: u32,
    /// Emitted radiance on the normal's side [W m^-2 sr^-1]; all zero: it does not emit. Quadrics and disks cannot.
    pub emission: [f32; 3],
    /// Object to world, three rows of four (the last column translates); all zero: none.
    pub transform: [f64; 12],
}

/// How samples of a pixel are placed.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_sampler {
    /// Owen-scrambled Sobol' points.
    ETD_SAMPLER_SOBOL = 0,
    /// Independent random numbers.
    ETD_SAMPLER_RANDOM = 1,
    /// One random position in each of n x n cells.
    ETD_SAMPLER_JITTERED = 2,
    /// The centres of n x n cells.
    ETD_SAMPLER_GRID = 3,
    /// Normally distributed around the pixel's centre.
    ETD_SAMPLER_GAUSSIAN = 4,
}

/// How samples weigh in a pixel.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_filter {
    /// One pixel wide.
    ETD_FILTER_BOX = 0,
    /// Triangle, radius 1 pixel.
    ETD_FILTER_TENT = 1,
    /// Gaussian; first parameter: standard deviation in pixels, above 0 and up to 16 (0 means 0.5).
    ETD_FILTER_GAUSSIAN = 2,
    /// Blackman-Harris window, radius 2 pixels.
    ETD_FILTER_BLACKMAN_HARRIS = 3,
    /// Mitchell-Netravali; parameters B and C in [0, 1], usually 1/3 each.
    ETD_FILTER_MITCHELL = 4,
}

/// A light transport algorithm.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_integrator {
    /// Path tracing: everything.
    ETD_INTEGRATOR_PATH = 0,
    /// Whitted's: direct light, mirrors and glass.
    ETD_INTEGRATOR_WHITTED = 1,
    /// Emission and light scattered once.
    ETD_INTEGRATOR_DIRECT = 2,
    /// The report's photon map: direct light from photons, where no shadow photon is among them.
    ETD_INTEGRATOR_PHOTON_DIRECT = 3,
    /// Path tracing, with caustics from a photon map.
    ETD_INTEGRATOR_CAUSTIC = 4,
    /// A global and a caustic photon map, with final gathering.
    ETD_INTEGRATOR_PHOTON = 5,
    /// Indirect diffuse light interpolated between final gathers.
    ETD_INTEGRATOR_IRRADIANCE_CACHE = 6,
    /// Progressive photon mapping: a new map every pass, with one shrinking radius.
    ETD_INTEGRATOR_PPM = 7,
    /// Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel.
    ETD_INTEGRATOR_SPPM = 8,
    /// Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds.
    ETD_INTEGRATOR_AUTO = 9,
    /// Radiosity: the diffuse scene solved as a whole, for every view of it.
    ETD_INTEGRATOR_RADIOSITY = 10,
}

/// How photons weigh by their distance d within the radius r of a density estimate.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_photon_kernel {
    /// A cone for `ETD_INTEGRATOR_PHOTON_DIRECT`, Epanechnikov's kernel for all others.
    ETD_PHOTON_KERNEL_DEFAULT = 0,
    /// All the same.
    ETD_PHOTON_KERNEL_FLAT = 1,
    /// 1 - d / (k r), by `photon_kernel_k`.
    ETD_PHOTON_KERNEL_CONE = 2,
    /// 1 - d^2 / r^2.
    ETD_PHOTON_KERNEL_EPANECHNIKOV = 3,
}

/// How emitters share the photons.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_photon_sharing {
    /// By their power, so that all photons carry nearly the same.
    ETD_PHOTON_SHARING_POWER = 0,
    /// By their area, as in the report. Points have none.
    ETD_PHOTON_SHARING_AREA = 1,
}

/// What the gather's rays of an irradiance cache bring back.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_cache_source {
    /// The light of paths: no bias but the interpolation's.
    ETD_CACHE_SOURCE_PATHS = 0,
    /// The light of the global photon map: faster, with its bias.
    ETD_CACHE_SOURCE_PHOTONS = 1,
}

/// How a radiosity system is solved.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_radiosity_solver {
    /// Every element gathers from all others, again and again.
    ETD_RADIOSITY_SOLVER_GATHER = 0,
    /// The patch that has most light left shoots it: progressive refinement.
    ETD_RADIOSITY_SOLVER_SHOOT = 1,
}

/// Whether something is done.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_switch {
    /// As the field's default says.
    ETD_SWITCH_DEFAULT = 0,
    /// It is done.
    ETD_SWITCH_ON = 1,
    /// It is not done.
    ETD_SWITCH_OFF = 2,
}

/// What the error of an image is measured by.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_error_measure {
    /// relMSE: the mean over pixels and channels of squared error / (mean^2 + e), with e = 1 % of the squared mean of the
    /// image.
    ETD_ERROR_RELMSE = 0,
    /// As a screen shows it: root of the mean squared error in levels of 255, after clamping to [0, 1] and the sRGB curve.
    ETD_ERROR_DISPLAY = 1,
}

/// How to render and when to stop: at whichever of samples, time and error is reached first.
///
/// From `photon_radius` on: settings of photon maps, the irradiance cache and radiosity, which only the integrators that use them
/// look at (docs/scene-format.md says which) and in which 0 always stands for the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_render_options {
    /// `sizeof(etd_render_options)`.
    pub struct_size: usize,
    /// An `etd_integrator`.
    pub integrator: EtdIntegrator,
    /// An `etd_sampler`.
    pub sampler: EtdSampler,
    /// An `etd_filter`.
    pub filter: EtdFilter,
    /// The filter's parameters.
    pub filter_parameters: [f32; 2],
    /// Samples for each pixel, 2^31 at most; 0: as many as time and error allow, which must then be limited.
    pub samples: u32,
    /// Greatest number of surface hits on a path, the first visible one included; 0: no limit (a limit darkens).
    pub max_depth: u32,
    /// Light samples at each hit, from 1 to 1024; 0 means 1.
    pub shadow_rays: u32,
    /// Seed of all randomness: the same seed gives the same image, on any number of threads.
    pub seed: u64,
    /// Seconds after which to stop, > 0; 0: no limit. One sample for each pixel is always taken.
    pub time_limit: f64,
    /// Estimated error at which to stop, > 0, of the kind that `error_measure` says; 0: none. It counts as reached if it is
    /// below by half a standard error of the estimate, with 32 samples at least, and not while few pixels have most of it.
    pub target_error: f64,
    /// Told progress; may be NULL.
    pub progress: etd_progress_fn,
    /// Told the end of a task; may be NULL. Not called by `etd_render`.
    pub finished: etd_finished_fn,
    /// Given to the two functions.
    pub user_data: *mut c_void,

    /// Radius of a density estimate, scene units, 1e-18 to 1e18; where it shrinks, the first one. 0: 0.1 for
    /// `ETD_INTEGRATOR_PHOTON_DIRECT`, else from what a pixel sees.
    pub photon_radius: f64,
    /// Radius of caustics, as `photon_radius`.
    pub caustic_radius: f64,
    /// Of the progressive methods: the share of photons kept as radii shrink, above 0 and below 1; 0 means 2/3.
    pub photon_alpha: f64,
    /// Greatest error that Ward's estimate allows where records of the irradiance cache are interpolated, up to 10; 0 means
    /// 0.25.
    pub cache_error: f64,
    /// Smallest distance between records, pixels as seen by the camera, up to 1000; 0 means 3.
    pub cache_min_spacing: f64,
    /// Greatest distance over which a record is used, as a share of the scene's extent, up to 1; 0 means 0.1.
    pub cache_max_spacing: f64,
    /// Light paths of a photon map (of each pass, where maps are made anew), 2^29 at most; 0: as many as the integrator
    /// does best with.
    pub photon_count: u32,
    /// Light paths of a caustic map, as `photon_count`.
    pub caustic_count: u32,
    /// Of `ETD_INTEGRATOR_PHOTON_DIRECT`: fewer photons than this within the radius are no estimate, and shadow rays are
    /// sent instead; 0 means 10.
    pub min_photons: u32,
    /// So many nearest photons make an estimate, those beyond the radius left out, 2 to 65536; `UINT32_MAX`: all within
    /// the radius; 0: within a radius of each pixel's own.
    pub photon_neighbours: u32,
    /// An `etd_photon_kernel`.
    pub photon_kernel: EtdPhotonKernel,
    /// k of the cone, 1 or more; 0 means 1. Only looked at with `ETD_PHOTON_KERNEL_CONE`.
    pub photon_kernel_k: f32,
    /// An `etd_photon_sharing`.
    pub photon_sharing: EtdPhotonSharing,
    /// An `etd_switch`: whether caustic photons are aimed at the specular surfaces; by default they are.
    pub photons_guided: EtdSwitch,
    /// An `etd_switch`: whether the map of `ETD_INTEGRATOR_CAUSTIC` is made anew for every pass, with a shrinking radius; by
    /// default it is.
    pub photons_progressive: EtdSwitch,
    /// Rays of a final gather, 1024 at most; 0 means 1.
    pub gather_rays: u32,
    /// Most memory of all maps at a time, MiB, 2^20 at most; 0 means 4096.
    pub photon_memory: u32,
    /// Rays of an irradiance record's final gather, from 16 to 2^20; 0 means 512.
    pub cache_rays: u32,
    /// An `etd_cache_source`.
    pub cache_source: EtdCacheSource,
    /// Must be 0.
    pub reserved: u32,
    /// An `etd_error_measure`: what `target_error` is of, and what adaptive samples make small.
    pub error_measure: EtdErrorMeasure,
    /// An `etd_switch`: whether pixels with more error get more samples, `samples` being their mean; by default where
    /// `target_error` is set. Only with the samplers Sobol' and random, and not where photon maps are made anew for each
    /// pass: there all pixels have the same number, and the log callback is told.
    pub adaptive: EtdSwitch,

    /// Of `ETD_INTEGRATOR_RADIOSITY`, as all that follows: elements whose longest side is no longer than this are not divided
    /// any more, scene units, 1e-18 to 1e18; 0: a 64th of the extent of the scene.
    pub radiosity_element_size: f64,
    /// What one link between elements may be wrong by, in thousandths of all irradiance, up to 1000; 0 means 1.
    pub radiosity_error: f64,
    /// Share of the solution that may be left to iterate for, below 1; 0 means 0.0001.
    pub radiosity_tolerance: f64,
    /// Iterations, 2^24 at most: bounces of light, or patches that shoot; `UINT32_MAX`: none, light sources alone; 0: until
    /// what is left is below `radiosity_tolerance`.
    pub radiosity_iterations: u32,
    /// An `etd_radiosity_solver`.
    pub radiosity_solver: EtdRadiositySolver,
    /// An `etd_switch`: whether light that was shot but not distributed yet is shown as its mean; by default it is not.
    pub radiosity_ambient: EtdSwitch,
    /// An `etd_switch`: whether pictures take direct light from light samples and indirect light from a ray into the solution,
    /// instead of interpolating it; by default they do not.
    pub radiosity_final_gather: EtdSwitch,
    /// Most memory of elements and links, MiB, 2^20 at most; 0 means 1024.
    pub radiosity_memory: u32,
    /// Must be 0.
    pub reserved_2: u32,
}

/// What work is at.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_phase {
    /// The scene is being built, or a light map laid out.
    ETD_PHASE_BUILD = 0,
    /// The film is being filled.
    ETD_PHASE_RENDER = 1,
    /// It has ended.
    ETD_PHASE_END = 2,
}

/// How far work has come.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_progress {
    /// `sizeof(etd_progress)`.
    pub struct_size: usize,
    /// Share of all the work, or of the time limit, that is done, in [0, 1]; only grows.
    pub fraction: f64,
    /// Seconds since it began.
    pub elapsed: f64,
    /// Rays so far.
    pub rays: u64,
    /// Samples for each pixel that are complete.
    pub samples_done: u32,
    /// Samples for each pixel to reach.
    pub samples_total: u32,
    /// What it is at.
    pub phase: etd_phase,
    /// How often the film got a new image so far: map it again when this grows.
    pub images: u32,
}

/// What ended a render.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_ended {
    /// Every pixel has its samples.
    ETD_ENDED_SAMPLES = 0,
    /// The time limit.
    ETD_ENDED_TIME = 1,
    /// The error is as small as was asked for.
    ETD_ENDED_ERROR = 2,
    /// It was cancelled.
    ETD_ENDED_CANCELLED = 3,
}

/// What the last render of a film came to.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_summary {
    /// `sizeof(etd_summary)`.
    pub struct_size: usize,
    /// Seconds that it took, without building the scene.
    pub elapsed: f64,
    /// Seconds that building the scene took before it; 0 where it was built already.
    pub build_time: f64,
    /// Rays traced, closest-hit and shadow rays together.
    pub rays: u64,
    /// Samples that were NaN or infinite and count as black. The log callback is told where the first of them became so.
    pub non_finite: u64,
    /// Estimated relative error of the image: the root of `rel_mse`. NaN where there are too few samples to tell.
    pub relative_error: f64,
    /// Samples for each pixel that are complete; the mean over pixels where they differ.
    pub samples: u32,
    /// 1 if it was cancelled, else 0.
    pub cancelled: u32,
    /// Estimated relMSE (see `ETD_ERROR_RELMSE`). NaN where there are too few samples to tell.
    pub rel_mse: f64,
    /// Standard error of `rel_mse`, from the scatter over pixels.
    pub rel_mse_standard_error: f64,
    /// Estimated error of what a screen shows (see `ETD_ERROR_DISPLAY`), levels of 255; NaN as `rel_mse`.
    pub display_error: f64,
    /// Samples of the pixel that has fewest, and of the one that has most; 0 after a cancel.
    pub samples_min: u32,
    /// See `samples_min`.
    pub samples_max: u32,
    /// What ended it.
    pub ended: etd_ended,
    /// 0.
    pub reserved: u32,
}

/// An image of a film. Layers are bits: together they say which ones a film keeps.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_layer {
    /// Radiance, linear Rec. 709 [W m^-2 sr^-1], with alpha: 4 channels. Always kept.
    ETD_LAYER_COLOR = 1,
    /// Albedo at the first hit: 3 channels.
    ETD_LAYER_ALBEDO = 2,
    /// Shading normal at the first hit, facing the camera, world axes: 3 channels, a mean, so not of unit length at edges.
    ETD_LAYER_NORMAL = 4,
    /// Distance of the first hit from the eye along the view direction: 1 channel; infinite where nothing was hit.
    ETD_LAYER_DEPTH = 8,
    /// Samples of the pixel: 1 channel.
    ETD_LAYER_SAMPLES = 16,
    /// Variance of the pixel's mean: 3 channels; NaN while there are too few samples to tell.
    ETD_LAYER_VARIANCE = 32,
    /// Standard error of the pixel's mean, the root of the variance: 3 channels.
    ETD_LAYER_STANDARD_ERROR = 64,
    /// Not an image of its own: alpha of the colour is the share of samples that met a surface. Without it, alpha is 1.
    ETD_LAYER_ALPHA = 128,
    /// Estimated bias of the pixel's mean by photon maps, 3 channels: what is there is too large by so much. With maps that
    /// are made once (photon, photon_direct, irradiance_cache) only that of caustics; 0 without maps.
    ETD_LAYER_BIAS = 256,
}

/// What a film is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_film_options {
    /// `sizeof(etd_film_options)`.
    pub struct_size: usize,
    /// Pixels in a row, >= 1.
    pub width: u32,
    /// Rows, >= 1; the film has 2^26 pixels at most.
    pub height: u32,
    /// `etd_layer` bits of what is kept besides the colour.
    pub layers: u32,
    /// Must be 0.
    pub reserved: u32,
}

/// An image in the library's memory, there to be read until `etd_film_unmap`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_map {
    /// `sizeof(etd_map)`.
    pub struct_size: usize,
    /// `[height][width][channels]`, row 0 on top, without gaps. Does not change while it is mapped.
    pub data: *const f32,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values for each pixel.
    pub channels: u32,
    /// Complete samples for each pixel when this image was made; 0 for the black one before the first pass.
    pub samples: u32,
    /// What `etd_film_unmap` knows it by.
    pub id: u64,
}

/// How pixels are laid out in the host's memory.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_format {
    /// Floats, as many as the layer has channels.
    ETD_FORMAT_FLOAT = 0,
    /// Three floats; of the colour only.
    ETD_FORMAT_RGB_FLOAT = 1,
    /// Three bytes, sRGB; of the colour only.
    ETD_FORMAT_RGB8 = 2,
    /// Four bytes, sRGB with linear alpha; of the colour only.
    ETD_FORMAT_RGBA8 = 3,
}

/// How radiance becomes brightness.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_tone_map {
    /// Radiance 1 is white, and so is everything above.
    ETD_TONE_MAP_CLAMP = 0,
    /// Divides by the largest value of the image.
    ETD_TONE_MAP_MAXIMUM = 1,
    /// x / (1 + x).
    ETD_TONE_MAP_REINHARD = 2,
    /// A curve with a toe and a shoulder (Narkowicz's fit to ACES).
    ETD_TONE_MAP_ACES = 3,
}

/// How pixels are copied or written.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_image_options {
    /// `sizeof(etd_image_options)`.
    pub struct_size: usize,
    /// An `etd_format`; not looked at by `etd_film_write`.
    pub format: EtdFormat,
    /// An `etd_tone_map`, for 8-bit formats and PNG.
    pub tone_map: EtdToneMap,
    /// Stops, in [-64, 64]: a factor of 2^exposure before the tone map, for 8-bit formats and PNG.
    pub exposure: f32,
    /// Not 0: the bottom row comes first, as OpenGL wants it; not looked at by `etd_film_write`.
    pub bottom_up: u32,
    /// Free text for the `comments` attribute of an EXR, UTF-8; NULL: none. Only `etd_film_write` looks at it.
    pub comments: *const c_char,
}

/// A ray segment: origin + t * direction for t in [tnear, tfar], world frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_ray {
    /// Where t is 0.
    pub origin: [f32; 3],
    /// Start of the segment, >= 0.
    pub tnear: f32,
    /// Any length that is not zero; t counts in this length.
    pub direction: [f32; 3],
    /// End of the segment; may be infinite.
    pub tfar: f32,
}

/// What a ray met first.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_hit {
    /// Distance in lengths of the ray's direction; infinite where nothing was met, and then nothing else is set but
    /// `surface`.
    pub t: f32,
    /// Weights of the triangle's second and third vertex; 0 on other shapes.
    pub barycentric: [f32; 2],
    /// Texture coordinates: the mesh's where it has any, else the barycentric ones (over the whole of a quad); 0 on other
    /// shapes.
    pub uv: [f32; 2],
    /// Geometric normal, unit length, on the outer side.
    pub ng: [f32; 3],
    /// Shading normal, unit length, on the outer side; the geometric one where shading is flat.
    pub ns: [f32; 3],
    /// Number of the surface; `ETD_NONE` where nothing was met.
    pub surface: u32,
    /// Number of its material.
    pub material: u32,
    /// Number of the triangle in its mesh, 0 or 1 in a quad, else 0.
    pub primitive: u32,
}

/// What a built scene holds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_info {
    /// `sizeof(etd_scene_info)`.
    pub struct_size: usize,
    /// Surfaces described, removed ones included.
    pub surfaces: u64,
    /// Materials described.
    pub materials: u64,
    /// Meshes described.
    pub meshes: u64,
    /// Point lights described.
    pub point_lights: u64,
    /// Triangles that are kept in the scene's own frame.
    pub triangles: u64,
    /// Instances of meshes.
    pub instances: u64,
    /// Triangles of the instanced meshes, each mesh counted once.
    pub shared_triangles: u64,
    /// Spheres, disks and quadrics.
    pub analytic_shapes: u64,
    /// Emitters that can be sampled.
    pub emitters: u64,
    /// Bytes of vertices, indices and normals that belong to the library.
    pub geometry_bytes: u64,
    /// Bytes of Embree's hierarchies.
    pub hierarchy_bytes: u64,
    /// Smallest corner of the box around all surfaces, world frame.
    pub bounds_min: [f64; 3],
    /// Largest corner.
    pub bounds_max: [f64; 3],
    /// Seconds that the last build took.
    pub build_time: f64,
}

/// A text about a scene.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_text {
    /// What was built and decided, a line each.
    ETD_TEXT_INFO = 0,
    /// Warnings from reading and building, a line each.
    ETD_TEXT_WARNINGS = 1,
}

/// Where the layout of a mesh in a light map comes from.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_atlas_layout {
    /// The mesh's own texture coordinates where they are fit for it (in [0, 1], without overlaps, every triangle with an area), else
    /// charts; the log callback is told of those that are not.
    ETD_ATLAS_LAYOUT_AUTO = 0,
    /// Charts, whatever coordinates a mesh has.
    ETD_ATLAS_LAYOUT_CHARTS = 1,
    /// The mesh's own texture coordinates; an error where they are not fit for it.
    ETD_ATLAS_LAYOUT_OWN = 2,
}

/// A side of a surface.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_side {
    /// The one that the normal is on.
    ETD_SIDE_FRONT = 0,
    /// The other one.
    ETD_SIDE_BACK = 1,
}

/// How a light map is laid out. 0 always stands for the default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_options {
    /// `sizeof(etd_atlas_options)`.
    pub struct_size: usize,
    /// Texels along the sides of the square, 8192 at most; 0: as many as `texels_per_unit` needs, or 512.
    pub resolution: u32,
    /// Texels around each chart that are its own, 64 at most; 0 means 2, `UINT32_MAX` none. One is what bilinear lookups need.
    pub gutter: u32,
    /// Texels for a unit of length; 0: as many as fit.
    pub texels_per_unit: f64,
    /// How far the normals of a chart's triangles may be from the first one's, degrees, below 90; 0 means 45.
    pub max_angle_deg: f64,
    /// An `etd_atlas_layout`.
    pub layout: EtdAtlasLayout,
    /// Most memory that the atlas and its bakes may take, MiB; 0 means 4096. The device's limit holds beside it.
    pub memory: u32,
    /// Must be 0.
    pub reserved: u64,
    /// Told how far it is; may be NULL.
    pub progress: etd_progress_fn,
    /// Given to `progress`.
    pub user_data: *mut c_void,
}

/// How large an atlas is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_info {
    /// `sizeof(etd_atlas_info)`.
    pub struct_size: usize,
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Vertices of all surfaces.
    pub vertex_count: usize,
    /// Triangles of all surfaces.
    pub triangle_count: usize,
    /// Surfaces that are there.
    pub surface_count: usize,
    /// Charts.
    pub chart_count: usize,
    /// Texels that triangles cover.
    pub covered_texels: usize,
    /// Texels for a unit of length, along the plane of a chart; for meshes with their own layout, on the mean.
    pub texels_per_unit: f64,
}

/// A corner of a light-mapped triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_vertex {
    /// World frame.
    pub position: [f64; 3],
    /// Unit normal: the shading normal of a smooth surface, else the mean of the chart's triangles there.
    pub normal: [f32; 3],
    /// Its place in the light map, in [0, 1]: (0, 0) is the outer corner of the first texel of row 0.
    pub uv: [f32; 2],
    /// Its number in the mesh as it was given; of a triangle or a quad that of the corner; running on other shapes.
    pub source: u32,
}

/// A surface in a light map.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_atlas_surface {
    /// Its number in the scene.
    pub surface: u32,
    /// Its first vertex.
    pub first_vertex: u32,
    /// How many it has.
    pub vertex_count: u32,
    /// Its first triangle.
    pub first_triangle: u32,
    /// How many it has.
    pub triangle_count: u32,
    /// 1 if the mesh's own texture coordinates are the layout, else 0.
    pub has_own_layout: u32,
    /// Then (u, v) of the mesh times the first two, plus the others, is the place in the light map; else 0.
    pub scale_offset: [f32; 4],
}

/// Where baked light goes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_bake_target {
    /// `sizeof(etd_bake_target)`.
    pub struct_size: usize,
    /// Three floats for each texel or vertex: irradiance [W m^-2], linear Rec. 709.
    pub irradiance: *mut f32,
    /// Three floats for each: its standard error [W m^-2], NaN where there are too few samples to tell; laid out as `irradiance`.
    /// NULL: not wanted.
    pub standard_error: *mut f32,
    /// Bytes that may be written from each of the two pointers on.
    pub size: usize,
    /// Bytes from one texel or vertex to the next; 0: they lie close together (12).
    pub stride: usize,
    /// Bytes from one row of texels to the next; 0: they lie close together.
    pub row_stride: usize,
    /// An `etd_side`.
    pub side: EtdSide,
    /// Must be 0.
    pub reserved: u32,
}

macro_rules! versioned {
    ($($type:ty, $last:ident;)*) => {$(
        // SAFETY: `repr(C)`, begins with `struct_size: usize`, and consists of numbers, pointers and `Option`s of
        // functions, for which zero bytes are a value. (Enumerations in it have a variant of value 0.)
        unsafe impl Versioned for $type {
            const SMALLEST: usize = std::mem::offset_of!($type, $last);
        }
    )*};
}
// The field after the first version's last one, or that last one itself: a structure must reach as far.
versioned! {
    etd_error, json_path;
    etd_device_options, user_data;
    etd_scene_options, params_file;
    etd_camera, fov_deg;
    etd_material, reserved;
    etd_mesh, name;
    etd_surface, transform;
    etd_render_options, user_data;
    etd_progress, images;
    etd_summary, cancelled;
    etd_film_options, reserved;
    etd_map, id;
    etd_image_options, comments;
    etd_scene_info, build_time;
    etd_atlas_options, reserved;
    etd_atlas_info, texels_per_unit;
    etd_bake_target, reserved;
}
