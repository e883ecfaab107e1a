//! How a scene is rendered, how far that is, and what it came to.

use std::ffi::c_void;

use super::numbers::{
    EtdCacheSource, EtdErrorMeasure, EtdFilter, EtdIntegrator, EtdPhotonKernel, EtdPhotonSharing, EtdRadiositySolver,
    EtdRoulette, EtdSampler, EtdSwitch,
};
use crate::capi::status::etd_status;
pub use {
    etd_cache_source::*, etd_ended::*, etd_error_measure::*, etd_filter::*, etd_integrator::*, etd_phase::*,
    etd_photon_kernel::*, etd_photon_sharing::*, etd_radiosity_solver::*, etd_roulette::*, etd_sampler::*,
    etd_switch::*,
};

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
    /// Path tracing: all light, by paths from the camera.
    ETD_INTEGRATOR_PATH = 0,
    /// Direct light, perfect mirrors and glass; no diffuse interreflection.
    ETD_INTEGRATOR_WHITTED = 1,
    /// Emission and light scattered once.
    ETD_INTEGRATOR_DIRECT = 2,
    /// The report's photon map: direct light from photons, where no shadow photon is among them.
    ETD_INTEGRATOR_PHOTON_DIRECT = 3,
    /// Path tracing, with caustics from a photon map.
    ETD_INTEGRATOR_CAUSTIC = 4,
    /// A global and a caustic photon map, with final gathering.
    ETD_INTEGRATOR_PHOTON = 5,
    /// All light, with indirect diffuse light interpolated between final gathers.
    ETD_INTEGRATOR_IRRADIANCE_CACHE = 6,
    /// Progressive photon mapping: a new map every pass, with one shrinking radius.
    ETD_INTEGRATOR_PPM = 7,
    /// Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel.
    ETD_INTEGRATOR_SPPM = 8,
    /// Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds.
    ETD_INTEGRATOR_AUTO = 9,
    /// The diffuse scene solved as a whole, for every view of it.
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

/// Which survival probability Russian roulette ends paths by. The choice changes noise and time, never the expected image.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_roulette {
    /// The library's own: a path survives in proportion to the throughput that it still carries.
    ETD_ROULETTE_OWN = 0,
    /// The one that the scene states for the material (`reflectionRate` in files, `etd_material.survival`), where it does.
    ETD_ROULETTE_FILE = 1,
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
    /// below by a quarter of the estimate's standard error, with 32 samples at least, and not while few pixels have most of it.
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
    /// Of every integrator that follows paths: an `etd_roulette`.
    pub roulette: EtdRoulette,
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

/// Told how far work has come; return 0 to go on and anything else to cancel.
///
/// Called about ten times a second and after each pass, never twice at once for one piece of work: on the calling thread
/// by `etd_render` and by what makes and bakes light maps, on the task's own thread by `etd_render_start`, on one of the
/// building threads while a scene is built.
/// It must not unwind; it may map and copy the film, and must not wait for the work that called it.
pub type etd_progress_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, progress: *const etd_progress) -> i32>;

/// Told once that a task has ended, and how, on the task's thread, before `etd_task_wait` returns. As `etd_progress_fn`.
pub type etd_finished_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status)>;

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

enumerations! {
    etd_sampler: ETD_SAMPLER_SOBOL, ETD_SAMPLER_RANDOM, ETD_SAMPLER_JITTERED, ETD_SAMPLER_GRID, ETD_SAMPLER_GAUSSIAN;
    etd_filter: ETD_FILTER_BOX, ETD_FILTER_TENT, ETD_FILTER_GAUSSIAN, ETD_FILTER_BLACKMAN_HARRIS, ETD_FILTER_MITCHELL;
    etd_photon_kernel:
        ETD_PHOTON_KERNEL_DEFAULT, ETD_PHOTON_KERNEL_FLAT, ETD_PHOTON_KERNEL_CONE, ETD_PHOTON_KERNEL_EPANECHNIKOV;
    etd_photon_sharing: ETD_PHOTON_SHARING_POWER, ETD_PHOTON_SHARING_AREA;
    etd_cache_source: ETD_CACHE_SOURCE_PATHS, ETD_CACHE_SOURCE_PHOTONS;
    etd_radiosity_solver: ETD_RADIOSITY_SOLVER_GATHER, ETD_RADIOSITY_SOLVER_SHOOT;
    etd_switch: ETD_SWITCH_DEFAULT, ETD_SWITCH_ON, ETD_SWITCH_OFF;
    etd_roulette: ETD_ROULETTE_OWN, ETD_ROULETTE_FILE;
    etd_error_measure: ETD_ERROR_RELMSE, ETD_ERROR_DISPLAY;
}

versioned! {
    etd_render_options, user_data;
    etd_progress, images;
    etd_summary, cancelled;
}
