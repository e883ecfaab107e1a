//! How a scene is rendered, how far that is, and what it came to.

use std::ffi::{c_char, c_void};

use super::numbers::{
    EtdCacheSource, EtdErrorMeasure, EtdFilter, EtdIntegrator, EtdPhotonKernel, EtdPhotonSharing, EtdRadiositySolver,
    EtdRoulette, EtdSampler, EtdSwitch,
};
use crate::capi::film::etd_film;
use crate::capi::status::etd_status;
pub use {
    etd_cache_source::*, etd_ended::*, etd_error_measure::*, etd_filter::*, etd_integrator::*, etd_phase::*,
    etd_photon_kernel::*, etd_photon_sharing::*, etd_radiosity_solver::*, etd_roulette::*, etd_sampler::*,
    etd_switch::*,
};

/// The positions of the samples of a pixel.
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

/// The pixel filter, which weighs the samples of a pixel.
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
    /// Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds; the irradiance cache where a bias is allowed.
    ETD_INTEGRATOR_AUTO = 9,
    /// The diffuse scene solved as a whole, for every view of it.
    ETD_INTEGRATOR_RADIOSITY = 10,
}

/// The weight of a photon as a function of its distance d from the point of a density estimate, within the radius r.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_photon_kernel {
    /// A cone for `ETD_INTEGRATOR_PHOTON_DIRECT`, Epanechnikov's kernel for all others.
    ETD_PHOTON_KERNEL_DEFAULT = 0,
    /// The same weight for all photons.
    ETD_PHOTON_KERNEL_FLAT = 1,
    /// 1 - d / (k r), by `photon_kernel_k`.
    ETD_PHOTON_KERNEL_CONE = 2,
    /// 1 - d^2 / r^2.
    ETD_PHOTON_KERNEL_EPANECHNIKOV = 3,
}

/// How the photons are divided between the emitters.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_photon_sharing {
    /// Photons are divided by the emitters' power, so that all photons carry nearly the same power.
    ETD_PHOTON_SHARING_POWER = 0,
    /// Photons are divided by the emitters' area, as in the report. Point lights have no area.
    ETD_PHOTON_SHARING_AREA = 1,
}

/// The source of the light that the gather rays of an irradiance cache find.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_cache_source {
    /// Gather rays continue as paths. The only bias is that of the interpolation.
    ETD_CACHE_SOURCE_PATHS = 0,
    /// Gather rays read the global photon map. This is faster and has the bias of the map.
    ETD_CACHE_SOURCE_PHOTONS = 1,
}

/// How a radiosity system is solved.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_radiosity_solver {
    /// In each iteration, every element gathers light from all others.
    ETD_RADIOSITY_SOLVER_GATHER = 0,
    /// In each step, the patch with most unshot light distributes it: progressive refinement (Cohen et al. 1988).
    ETD_RADIOSITY_SOLVER_SHOOT = 1,
}

/// A setting that is on, off, or left to its default.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_switch {
    /// The default of the field.
    ETD_SWITCH_DEFAULT = 0,
    /// On.
    ETD_SWITCH_ON = 1,
    /// Off.
    ETD_SWITCH_OFF = 2,
}

/// The survival probability by which Russian roulette ends paths. The choice changes noise and time, never the expected image.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_roulette {
    /// The library's own probability: a path survives in proportion to the throughput that it still carries.
    ETD_ROULETTE_OWN = 0,
    /// The probability that the material states (`reflectionRate` in files, `etd_material.survival`). At materials that state
    /// none, the library's own probability is used.
    ETD_ROULETTE_FILE = 1,
}

/// A measure of the error of an image.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_error_measure {
    /// relMSE: the mean over pixels and channels of squared error / (mean^2 + e), with e = 1 % of the squared mean of the
    /// image.
    ETD_ERROR_RELMSE = 0,
    /// Error of displayed values: root of the mean squared error in levels of 255, after clamping to [0, 1] and the sRGB curve.
    ETD_ERROR_DISPLAY = 1,
}

/// Options of a render. The render ends when the first of its limits on samples, time and error is reached.
///
/// The fields from `photon_radius` on are settings of photon maps, the irradiance cache and radiosity. Only the integrators that
/// docs/scene-format.md names use them. In all of these fields, 0 stands for the default.
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
    /// Number of samples per pixel, 2^31 at most. With 0, only `time_limit` and `target_error` end the render, and one of them
    /// must be set.
    pub samples: u32,
    /// Greatest number of surface hits on a path, counting the first visible one; 0: no limit. A limit darkens the image.
    pub max_depth: u32,
    /// Number of light samples at each hit, from 1 to 1024; 0 means 1.
    pub shadow_rays: u32,
    /// Seed of all random numbers. The same seed gives the same image on any number of threads.
    pub seed: u64,
    /// Time limit in seconds, > 0; 0: no limit. It ends the render, with its estimates of errors, in the middle of a pass, and of
    /// shooting photons for it. One sample per pixel is always taken, with the photon maps or the irradiance cache that it needs; a
    /// render that takes longer than its limit for that logs a warning. A radiosity solution is less accurate where time is short,
    /// which is logged as well; its first links, a fixed number of iterations, and that of a share of the picture take the time that
    /// they take.
    pub time_limit: f64,
    /// Target error in the measure `error_measure`, > 0; 0: none. It is reached when the estimated error plus a quarter of the
    /// estimate's standard error is at most the target, but not before 32 samples per pixel, and not while few pixels have most
    /// of the error.
    pub target_error: f64,
    /// Progress callback; may be NULL.
    pub progress: etd_progress_fn,
    /// Callback for the end of a task; may be NULL. `etd_render` does not call it.
    pub finished: etd_finished_fn,
    /// Passed to the two functions.
    pub user_data: *mut c_void,

    /// Radius of a density estimate, scene units, 1e-18 to 1e18; where the radius shrinks, this is the first one. 0 means 0.1 for
    /// `ETD_INTEGRATOR_PHOTON_DIRECT`, and otherwise a radius from the extent that a pixel sees.
    pub photon_radius: f64,
    /// Radius of density estimates in the caustic map, with the range and default of `photon_radius`.
    pub caustic_radius: f64,
    /// Share of the photons that progressive methods keep as radii shrink, above 0 and below 1; 0 means 2/3.
    pub photon_alpha: f64,
    /// Greatest error of Ward's estimate at which records of the irradiance cache are interpolated, up to 10; 0 means 0.25.
    pub cache_error: f64,
    /// Smallest distance over which a record is used, in pixels as seen by the camera, up to 1000; 0 means 3.
    pub cache_min_spacing: f64,
    /// Greatest distance over which a record is used, as a share of the scene's extent, up to 1; 0 means 0.1.
    pub cache_max_spacing: f64,
    /// Number of light paths of a photon map (of each pass, where maps are built for every pass), 2^29 at most; 0: the integrator
    /// chooses.
    pub photon_count: u32,
    /// Number of light paths of the caustic map, with the range and default of `photon_count`.
    pub caustic_count: u32,
    /// Smallest number of photons within the radius that makes an estimate for `ETD_INTEGRATOR_PHOTON_DIRECT`, which sends shadow
    /// rays where there are fewer; 0 means 10.
    pub min_photons: u32,
    /// Number of nearest photons that make an estimate, without those beyond the radius, 2 to 65536. With `UINT32_MAX`, all photons
    /// within the radius make the estimate. With 0, all photons within a radius make it, where each pixel has its own radius.
    pub photon_neighbours: u32,
    /// An `etd_photon_kernel`.
    pub photon_kernel: EtdPhotonKernel,
    /// Parameter k of `ETD_PHOTON_KERNEL_CONE`, 1 or more; 0 means 1.
    pub photon_kernel_k: f32,
    /// An `etd_photon_sharing`.
    pub photon_sharing: EtdPhotonSharing,
    /// An `etd_switch`: whether caustic photons are aimed at the specular surfaces. On by default.
    pub photons_guided: EtdSwitch,
    /// An `etd_switch`: whether the map of `ETD_INTEGRATOR_CAUSTIC` is built anew for every pass, with a shrinking radius. On by
    /// default.
    pub photons_progressive: EtdSwitch,
    /// Number of rays of a final gather, 1024 at most; 0 means 1.
    pub gather_rays: u32,
    /// Memory limit of all maps that exist at a time, MiB, 2^20 at most; 0 means 4096.
    pub photon_memory: u32,
    /// Number of rays of an irradiance record's final gather, from 16 to 2^20; 0 means 512.
    pub cache_rays: u32,
    /// An `etd_cache_source`.
    pub cache_source: EtdCacheSource,
    /// An `etd_switch`: whether paths carry wavelengths instead of three channels. Colours become smooth spectra, lights those times
    /// D65, and glass with a dispersion disperses light; the film has the colours that the standard observer sees. Off by default.
    pub spectral: EtdSwitch,
    /// An `etd_error_measure`: the measure of `target_error`, in which adaptive sampling reduces the error.
    pub error_measure: EtdErrorMeasure,
    /// An `etd_switch`: whether pixels with larger errors get more samples; `samples` is then the mean over pixels. On by default
    /// if `target_error` is set and `reuse` is not on. It needs the sampler `ETD_SAMPLER_SOBOL` or `ETD_SAMPLER_RANDOM`, and an
    /// integrator that does not build photon maps for each pass. Otherwise all pixels get the same number of samples, and the log
    /// callback receives a warning.
    pub adaptive: EtdSwitch,

    /// Smallest element of `ETD_INTEGRATOR_RADIOSITY`, to which this and the fields up to `radiosity_memory` belong: elements whose
    /// longest side is at most this long are not subdivided, scene units, 1e-18 to 1e18; 0 means a 64th of the extent of the
    /// scene.
    pub radiosity_element_size: f64,
    /// Greatest error of one link between elements, in thousandths of all irradiance, up to 1000; 0 means 1.
    pub radiosity_error: f64,
    /// Fraction of the solution that may be missing when the iteration ends, below 1; 0 means 0.0001.
    pub radiosity_tolerance: f64,
    /// Number of iterations, 2^24 at most: bounces of light, or patches that shoot. With `UINT32_MAX`, there are none, and the image
    /// shows the light sources alone. With 0, the iteration ends at `radiosity_tolerance`.
    pub radiosity_iterations: u32,
    /// An `etd_radiosity_solver`.
    pub radiosity_solver: EtdRadiositySolver,
    /// An `etd_switch`: whether the image of a solution that `radiosity_iterations` has ended includes the mean of the light that
    /// was not yet distributed. Off by default.
    pub radiosity_ambient: EtdSwitch,
    /// An `etd_switch`: whether images take direct light from light samples and indirect light from a ray into the solution,
    /// instead of interpolating the solution. Off by default.
    pub radiosity_final_gather: EtdSwitch,
    /// Memory limit of elements and links, MiB, 2^20 at most; 0 means 1024.
    pub radiosity_memory: u32,
    /// An `etd_roulette`, for every integrator that follows paths.
    pub roulette: EtdRoulette,
    /// Width of the picture in pixels, where the film is a rectangle of it and not all: 0, or with `picture_height` 2^26 pixels at
    /// most. The pixels have the values that they have in the whole picture, except where adaptive sampling, a target error or a
    /// time limit look at all pixels of the film. Renders of irradiance and of points ignore this and the next three fields.
    pub picture_width: u32,
    /// Height of the picture in pixels; 0 with a `picture_width` of 0.
    pub picture_height: u32,
    /// Column of the picture that is the film's first, from 0. The film ends inside the picture.
    pub crop_left: u32,
    /// Row of the picture that is the film's first, from 0 at the top. The film ends inside the picture.
    pub crop_top: u32,
    /// Chromaticity, x and y of CIE 1931, of the light under which white surfaces are grey in the picture; 0, 0: that of D65. Light maps and
    /// light at given points have no white.
    pub white_balance: [f64; 2],
    /// First and last wavelength, nm, of three adjacent bands of equal width, from 360 to 830 and 0.3 apart or more: with `spectral` on, the
    /// channels of the film are then the mean spectral radiance over each band, W m^-2 sr^-1 nm^-1, and `white_balance` does not
    /// apply. 0, 0: the colours that the standard observer sees.
    pub sensor_bands: [f64; 2],
    /// An `etd_switch`: whether pixels in groups of 16 share the second hits of their paths, by `ETD_INTEGRATOR_PATH` alone. Most
    /// scenes take less time to the same error so, and the picture stays unbiased, but the errors of neighbouring pixels, within squares of
    /// 8 x 8, are correlated. On is refused with `spectral`, with `adaptive` on, for light maps and light at given points, and for scenes in which
    /// something moves, is not opaque, or has media that absorb or have priorities, and for films of emitted, direct or indirect light. By
    /// default, a pilot of a long render says, where it is not refused.
    pub reuse: EtdSwitch,
    /// An `etd_switch`: whether light paths, from lamps by way of mirrors and glass to what the camera sees, find caustics beside the paths
    /// from the camera, by `ETD_INTEGRATOR_PATH` alone. The picture stays unbiased. On is refused where `reuse` is, and with `max_depth`, the
    /// filter `ETD_FILTER_MITCHELL`, filters that reach farther than 4 pixels, the sampler `ETD_SAMPLER_GAUSSIAN`, textures that the
    /// footprint of a ray filters, and cameras that are not in perspective or have a lens. By default, a pilot of a long render says, where
    /// it is not refused.
    pub light_paths: EtdSwitch,

    /// Part of the picture that is rendered, from 1 to `share_count`, where several renders, of any processes and machines, each do one;
    /// 0 with a `share_count` of 0. `etd_film_merge` makes the picture of all parts. Adaptive sampling and `target_error` look at the whole
    /// picture and are refused.
    pub share_number: u32,
    /// Number of parts, 2^16 at most; 0: the whole picture, or with `resume` the part that was begun. This and the fields below are for
    /// pictures: light maps and light at given points refuse them.
    pub share_count: u32,
    /// File to which the state of the render is written every `checkpoint_seconds` and when it ends, for whatever reason, UTF-8; NULL: none.
    /// It is replaced in one step each time. `etd_film_load` reads it. The text is read during the call that begins the render. Where the last
    /// state cannot be written, the render is done all the same and then fails with `ETD_IO`.
    pub checkpoint_file: *const c_char,
    /// Seconds from one writing of `checkpoint_file` to the next, > 0; 0 means 60.
    pub checkpoint_seconds: f64,
    /// Film whose render goes on, also the film that is rendered to; NULL: the render begins anew. The result is that of one render
    /// without interruption, to the last bit. Scene and options must be those of that render, and are `ETD_UNSUPPORTED` with what differs
    /// otherwise; these may differ: `samples` with the samplers Sobol and random, `time_limit`, `target_error`, `checkpoint_file`, and what
    /// options leave to their default. The film is reserved until the render has taken over its state or its task is released, and stays as it is.
    pub resume: *const etd_film,

    /// Light samples, from 1 to 1024, at the hits that the camera sees itself or by way of perfectly specular surfaces alone, by
    /// `ETD_INTEGRATOR_PATH` alone; refused with others, for light maps and light at given points. 0: as many as at other hits, or up to
    /// eight times as many where a pilot of a long render says that it pays.
    pub first_shadow_rays: u32,
    /// An `etd_switch`: whether `ETD_INTEGRATOR_AUTO` may choose the irradiance cache, whose bias error estimates do not know. A pilot of a
    /// long render without `target_error` then measures its bias, noise and time, and it is taken where the whole error times the time
    /// is least. On is refused with other integrators, for light maps and light at given points. Off by default.
    pub allow_bias: EtdSwitch,
}

/// A phase of work.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_phase {
    /// The scene is being read or built, or a light map is being laid out.
    ETD_PHASE_BUILD = 0,
    /// Samples are being taken.
    ETD_PHASE_RENDER = 1,
    /// The work has ended.
    ETD_PHASE_END = 2,
}

/// A progress callback. It returns 0 to continue, and anything else to cancel.
///
/// It is called about ten times a second and after each pass, and never from two threads at the same time for the same work.
/// `etd_render` and the calls that make and bake light maps call it on the calling thread, tasks on their own thread, reading and
/// builds of a scene on one of the reading or building threads. It must not unwind. It may map and copy the film, and must not wait for the work
/// that called it.
pub type etd_progress_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, progress: *const etd_progress) -> i32>;

/// A callback for the end of a task, which receives how the task ended. It is called once, on the task's thread and before
/// `etd_task_wait` returns. The rules of `etd_progress_fn` apply.
pub type etd_finished_fn = Option<unsafe extern "C" fn(user_data: *mut c_void, status: etd_status)>;

/// The progress of work.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_progress {
    /// `sizeof(etd_progress)`.
    pub struct_size: usize,
    /// Fraction of the work, or of the time limit, that is done, in [0, 1]. It never falls.
    pub fraction: f64,
    /// Seconds since the work began.
    pub elapsed: f64,
    /// Number of rays traced so far.
    pub rays: u64,
    /// Number of complete samples per pixel.
    pub samples_done: u32,
    /// Greatest number of samples per pixel, at which the render ends.
    pub samples_total: u32,
    /// The current phase.
    pub phase: etd_phase,
    /// Number of images that the film got so far. When it grows, a host may map the film again.
    pub images: u32,
}

/// The reason why a render ended.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_ended {
    /// Every pixel has all its samples.
    ETD_ENDED_SAMPLES = 0,
    /// The time limit was reached.
    ETD_ENDED_TIME = 1,
    /// The target error was reached.
    ETD_ENDED_ERROR = 2,
    /// The render was cancelled.
    ETD_ENDED_CANCELLED = 3,
}

/// The summary of a render.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_summary {
    /// `sizeof(etd_summary)`.
    pub struct_size: usize,
    /// Seconds that the render took, without the build of the scene and the estimates of errors at its end.
    pub elapsed: f64,
    /// Seconds that the build of the scene took before the render; 0 if the scene was already built.
    pub build_time: f64,
    /// Number of rays traced, including shadow rays.
    pub rays: u64,
    /// Number of samples that were NaN or infinite and count as black. The log callback receives a warning with the place where
    /// the first of them became so.
    pub non_finite: u64,
    /// Estimated relative error of the image: the root of `rel_mse`. NaN where there are too few samples or too little memory for
    /// an estimate, and after a cancel.
    pub relative_error: f64,
    /// Number of complete samples per pixel; the mean over pixels where the numbers differ.
    pub samples: u32,
    /// 1 if the render was cancelled, else 0.
    pub cancelled: u32,
    /// Estimated relMSE (see `ETD_ERROR_RELMSE`). NaN where `relative_error` is NaN.
    pub rel_mse: f64,
    /// Standard error of `rel_mse`, estimated from the scatter over pixels.
    pub rel_mse_standard_error: f64,
    /// Estimated error of displayed values (see `ETD_ERROR_DISPLAY`), in levels of 255. NaN where `rel_mse` is NaN.
    pub display_error: f64,
    /// Smallest number of samples of any pixel; 0 after a cancel.
    pub samples_min: u32,
    /// Greatest number of samples of any pixel; 0 after a cancel.
    pub samples_max: u32,
    /// The reason why the render ended, an `etd_ended`.
    pub ended: etd_ended,
    /// An `etd_integrator`: the one that took the samples; where `ETD_INTEGRATOR_AUTO` was asked for, the one that was chosen.
    pub integrator: EtdIntegrator,
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
