/* Étendue: physically based rendering for programs that link a renderer.
 *
 * Generated from the library's sources; changes made here are lost.
 *
 * Objects. A device has threads and a memory limit; a scene is described, then built; a film holds the image; a task is a
 * render that was started; an atlas lays out a light map. Each is held by a pointer with one reference, which its
 * etd_..._release gives back; what an object needs of another it keeps alive itself, so they may be released in any order.
 * A handle must not be used after the release of its last reference: its memory is freed, and calls cannot tell.
 *
 * Results. Every call that can fail returns an etd_status, changes nothing when it fails, and writes its outputs only on
 * success. Why it failed is kept for the thread (etd_last_error_message) and for the object (etd_scene_status and its
 * like, which keep the first failure).
 *
 * Threads. Every function may be called from any thread at any time, unless it says otherwise. There is no state of the
 * process: no global thread pool, no signal handler, no locale, no output (but the trace of a panic, which is a fault of the
 * library, on stderr), and two devices know nothing of each other.
 *
 * Structures that begin with struct_size must be set up with their ETD_..._INIT, so that they may grow in later versions.
 * Fields that hold an enumeration are numbers, so that a wrong one is an error and not undefined behaviour.
 *
 * Units: lengths in scene units, right-handed frames, angles in degrees where a name ends in _deg, radiance
 * [W m^-2 sr^-1], colours linear with Rec. 709 primaries. Text is UTF-8.
 *
 * A tour with examples: docs/c-api.md. In C++: etendue.hpp.
 */

#ifndef ETENDUE_H
#define ETENDUE_H

#include <stddef.h>
#include <stdint.h>

/** Version of this header. Libraries of the same major version (of the same minor version before 1.0) work with
 * programs that were built with it; `etd_version` tells the library's. */
#define ETD_VERSION_MAJOR 0
#define ETD_VERSION_MINOR 1
#define ETD_VERSION_PATCH 0
#define ETD_VERSION 100
#define ETD_VERSION_STRING "0.1.0"

/** Stands for no material, no surface. */
#define ETD_NONE UINT32_MAX

/** Defaults of the structures, to be changed field by field. */
#define ETD_ERROR_INIT {sizeof(etd_error), ETD_OK, 0, NULL, NULL, NULL}
#define ETD_DEVICE_OPTIONS_INIT {sizeof(etd_device_options), 0, 0, 0, NULL, NULL, NULL, NULL}
#define ETD_SCENE_OPTIONS_INIT {sizeof(etd_scene_options), ETD_USAGE_STATIC, 0, NULL, NULL}
#define ETD_CAMERA_INIT \
    {sizeof(etd_camera), ETD_CAMERA_PERSPECTIVE, ETD_FOV_HORIZONTAL, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90}
#define ETD_MATERIAL_INIT {sizeof(etd_material), ETD_BSDF_LAMBERT, {0.5f, 0.5f, 0.5f}, 0, 0, 1.5f, 1, 0, 0}
#define ETD_MESH_INIT \
    {sizeof(etd_mesh), NULL, 0, 0, 0, NULL, 0, 0, NULL, 0, NULL, 0, ETD_POSITION_FLOAT3, ETD_COPY, NULL, NULL, NULL}
#define ETD_SURFACE_INIT {sizeof(etd_surface), ETD_NONE, {0, 0, 0}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}
#define ETD_RENDER_OPTIONS_INIT \
    {sizeof(etd_render_options), ETD_INTEGRATOR_PATH, ETD_SAMPLER_SOBOL, ETD_FILTER_BOX, {0, 0}, 64, 0, 1, 0, 0, 0, \
     NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_PHOTON_KERNEL_DEFAULT, 0, ETD_PHOTON_SHARING_POWER, \
     ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, 0, 0, ETD_CACHE_SOURCE_PATHS, 0, ETD_ERROR_RELMSE, ETD_SWITCH_DEFAULT, \
     0, 0, 0, 0, ETD_RADIOSITY_SOLVER_GATHER, ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, \
     ETD_ROULETTE_OWN}
#define ETD_PROGRESS_INIT {sizeof(etd_progress), 0, 0, 0, 0, 0, ETD_PHASE_BUILD, 0}
#define ETD_SUMMARY_INIT {sizeof(etd_summary), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_ENDED_SAMPLES, 0}
#define ETD_FILM_OPTIONS_INIT {sizeof(etd_film_options), 0, 0, 0, 0}
#define ETD_MAP_INIT {sizeof(etd_map), NULL, 0, 0, 0, 0, 0}
#define ETD_IMAGE_OPTIONS_INIT {sizeof(etd_image_options), ETD_FORMAT_FLOAT, ETD_TONE_MAP_CLAMP, 0, 0, NULL}
#define ETD_ATLAS_OPTIONS_INIT {sizeof(etd_atlas_options), 0, 0, 0, 0, ETD_ATLAS_LAYOUT_AUTO, 0, 0, NULL, NULL}
#define ETD_ATLAS_INFO_INIT {sizeof(etd_atlas_info), 0, 0, 0, 0, 0, 0, 0, 0}
#define ETD_BAKE_TARGET_INIT {sizeof(etd_bake_target), NULL, NULL, 0, 0, 0, ETD_SIDE_FRONT, 0}
#define ETD_SCENE_INFO_INIT {sizeof(etd_scene_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, 0}


/**
 * What a call came to. Values are grouped by who can mend it, never change and are never used again for something else.
 */
enum etd_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It is done.
     */
    ETD_OK = 0,
    /**
     * Not an error: the task is still running.
     */
    ETD_RUNNING = 1,
    /**
     * An argument is NULL, out of its range, not finite, or an index of nothing. The call changed nothing.
     */
    ETD_INVALID_ARGUMENT = 100,
    /**
     * The pointer is a handle of another kind than was expected, or points to readable memory that is no handle. A handle whose
     * last reference was given back is not recognised: passing it is undefined behaviour, as for any freed memory. Only a task
     * whose last reference is being given back, and whose memory is thus still there, is refused with this in its callbacks.
     */
    ETD_INVALID_HANDLE = 101,
    /**
     * The call does not fit the state of the object: a film that is being rendered to, a scene that was not built, a
     * callback that waits for the very work that called it.
     */
    ETD_INVALID_OPERATION = 102,
    /**
     * The scene holds a value that cannot be rendered; the message names file, line and JSON path.
     */
    ETD_INVALID_SCENE = 200,
    /**
     * Well formed, but this version does not do it.
     */
    ETD_UNSUPPORTED = 201,
    /**
     * A file could not be read or written.
     */
    ETD_IO = 202,
    /**
     * Embree is missing, of the wrong version, or failed; or no thread could be started.
     */
    ETD_DEVICE = 300,
    /**
     * There is no memory, or the device's limit was reached.
     */
    ETD_OUT_OF_MEMORY = 301,
    /**
     * Cancelled, by `etd_task_cancel` or by a callback.
     */
    ETD_CANCELLED = 400,
    /**
     * A broken promise of this library; please report it.
     */
    ETD_INTERNAL = 500,
    /**
     * The library panicked. The process is unharmed, and the objects of the call can only be released from now on.
     */
    ETD_PANIC = 501,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_status etd_status;
#else
typedef uint32_t etd_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How much a message matters.
 */
enum etd_log_level
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * What a user should know: something was left out, or will take long, or is biased.
     */
    ETD_LOG_WARNING = 0,
    /**
     * What was decided and how long it took.
     */
    ETD_LOG_INFO = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_log_level etd_log_level;
#else
typedef uint32_t etd_log_level;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What work is at.
 */
enum etd_phase
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The scene is being built, or a light map laid out.
     */
    ETD_PHASE_BUILD = 0,
    /**
     * The film is being filled.
     */
    ETD_PHASE_RENDER = 1,
    /**
     * It has ended.
     */
    ETD_PHASE_END = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_phase etd_phase;
#else
typedef uint32_t etd_phase;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What ended a render.
 */
enum etd_ended
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Every pixel has its samples.
     */
    ETD_ENDED_SAMPLES = 0,
    /**
     * The time limit.
     */
    ETD_ENDED_TIME = 1,
    /**
     * The error is as small as was asked for.
     */
    ETD_ENDED_ERROR = 2,
    /**
     * It was cancelled.
     */
    ETD_ENDED_CANCELLED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_ended etd_ended;
#else
typedef uint32_t etd_ended;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a scene's geometry is kept.
 */
enum etd_usage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * As one piece where possible: fastest to trace. At the first change of geometry after it was built it becomes
     * dynamic by itself.
     */
    ETD_USAGE_STATIC = 0,
    /**
     * Every larger mesh has a hierarchy of its own, so that adding, moving or removing something touches nothing else.
     */
    ETD_USAGE_DYNAMIC = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_usage etd_usage;
#else
typedef uint32_t etd_usage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a camera projects.
 */
enum etd_camera_type
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * A pinhole at `origin`.
     */
    ETD_CAMERA_PERSPECTIVE = 0,
    /**
     * The report's camera: `origin` is the centre of a view plane, the eye lies behind it, and the length of `up` scales
     * the plane.
     */
    ETD_CAMERA_VIEW_PLANE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_camera_type etd_camera_type;
#else
typedef uint32_t etd_camera_type;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The side of the image that a camera's field of view spans.
 */
enum etd_fov_axis
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The width.
     */
    ETD_FOV_HORIZONTAL = 0,
    /**
     * The height; perspective cameras only.
     */
    ETD_FOV_VERTICAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_fov_axis etd_fov_axis;
#else
typedef uint32_t etd_fov_axis;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a surface scatters light.
 */
enum etd_bsdf
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Absorbs everything.
     */
    ETD_BSDF_BLACK = 0,
    /**
     * Lambert, by `color`.
     */
    ETD_BSDF_LAMBERT = 1,
    /**
     * Fujii's improved Oren-Nayar, by `color` and `roughness`.
     */
    ETD_BSDF_OREN_NAYAR = 2,
    /**
     * Oren and Nayar's qualitative model, by `color` and `sigma_deg`.
     */
    ETD_BSDF_OREN_NAYAR_QUALITATIVE = 3,
    /**
     * A perfect mirror, by `color`.
     */
    ETD_BSDF_MIRROR = 4,
    /**
     * Smooth clear glass, by `ior` and `exterior_ior`.
     */
    ETD_BSDF_DIELECTRIC = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_bsdf etd_bsdf;
#else
typedef uint32_t etd_bsdf;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What numbers an array of positions holds.
 */
enum etd_position_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Three `float`.
     */
    ETD_POSITION_FLOAT3 = 0,
    /**
     * Three `double`; always copied.
     */
    ETD_POSITION_DOUBLE3 = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_position_format etd_position_format;
#else
typedef uint32_t etd_position_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Who keeps the arrays of a mesh.
 */
enum etd_sharing
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * They are copied during the call.
     */
    ETD_COPY = 0,
    /**
     * They are read in place, and must neither change nor go away until `release` is called. Positions must be `float`,
     * and 16 bytes readable from the last one on. A mesh that emits light is copied nevertheless when it is built.
     */
    ETD_SHARE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_sharing etd_sharing;
#else
typedef uint32_t etd_sharing;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How samples of a pixel are placed.
 */
enum etd_sampler
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Owen-scrambled Sobol' points.
     */
    ETD_SAMPLER_SOBOL = 0,
    /**
     * Independent random numbers.
     */
    ETD_SAMPLER_RANDOM = 1,
    /**
     * One random position in each of n x n cells.
     */
    ETD_SAMPLER_JITTERED = 2,
    /**
     * The centres of n x n cells.
     */
    ETD_SAMPLER_GRID = 3,
    /**
     * Normally distributed around the pixel's centre.
     */
    ETD_SAMPLER_GAUSSIAN = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_sampler etd_sampler;
#else
typedef uint32_t etd_sampler;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How samples weigh in a pixel.
 */
enum etd_filter
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * One pixel wide.
     */
    ETD_FILTER_BOX = 0,
    /**
     * Triangle, radius 1 pixel.
     */
    ETD_FILTER_TENT = 1,
    /**
     * Gaussian; first parameter: standard deviation in pixels, above 0 and up to 16 (0 means 0.5).
     */
    ETD_FILTER_GAUSSIAN = 2,
    /**
     * Blackman-Harris window, radius 2 pixels.
     */
    ETD_FILTER_BLACKMAN_HARRIS = 3,
    /**
     * Mitchell-Netravali; parameters B and C in [0, 1], usually 1/3 each.
     */
    ETD_FILTER_MITCHELL = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_filter etd_filter;
#else
typedef uint32_t etd_filter;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A light transport algorithm.
 */
enum etd_integrator
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Path tracing: all light, by paths from the camera.
     */
    ETD_INTEGRATOR_PATH = 0,
    /**
     * Direct light, perfect mirrors and glass; no diffuse interreflection.
     */
    ETD_INTEGRATOR_WHITTED = 1,
    /**
     * Emission and light scattered once.
     */
    ETD_INTEGRATOR_DIRECT = 2,
    /**
     * The report's photon map: direct light from photons, where no shadow photon is among them.
     */
    ETD_INTEGRATOR_PHOTON_DIRECT = 3,
    /**
     * Path tracing, with caustics from a photon map.
     */
    ETD_INTEGRATOR_CAUSTIC = 4,
    /**
     * A global and a caustic photon map, with final gathering.
     */
    ETD_INTEGRATOR_PHOTON = 5,
    /**
     * All light, with indirect diffuse light interpolated between final gathers.
     */
    ETD_INTEGRATOR_IRRADIANCE_CACHE = 6,
    /**
     * Progressive photon mapping: a new map every pass, with one shrinking radius.
     */
    ETD_INTEGRATOR_PPM = 7,
    /**
     * Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel.
     */
    ETD_INTEGRATOR_SPPM = 8,
    /**
     * Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds.
     */
    ETD_INTEGRATOR_AUTO = 9,
    /**
     * The diffuse scene solved as a whole, for every view of it.
     */
    ETD_INTEGRATOR_RADIOSITY = 10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_integrator etd_integrator;
#else
typedef uint32_t etd_integrator;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How photons weigh by their distance d within the radius r of a density estimate.
 */
enum etd_photon_kernel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * A cone for `ETD_INTEGRATOR_PHOTON_DIRECT`, Epanechnikov's kernel for all others.
     */
    ETD_PHOTON_KERNEL_DEFAULT = 0,
    /**
     * All the same.
     */
    ETD_PHOTON_KERNEL_FLAT = 1,
    /**
     * 1 - d / (k r), by `photon_kernel_k`.
     */
    ETD_PHOTON_KERNEL_CONE = 2,
    /**
     * 1 - d^2 / r^2.
     */
    ETD_PHOTON_KERNEL_EPANECHNIKOV = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_photon_kernel etd_photon_kernel;
#else
typedef uint32_t etd_photon_kernel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How emitters share the photons.
 */
enum etd_photon_sharing
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * By their power, so that all photons carry nearly the same.
     */
    ETD_PHOTON_SHARING_POWER = 0,
    /**
     * By their area, as in the report. Points have none.
     */
    ETD_PHOTON_SHARING_AREA = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_photon_sharing etd_photon_sharing;
#else
typedef uint32_t etd_photon_sharing;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the gather's rays of an irradiance cache bring back.
 */
enum etd_cache_source
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The light of paths: no bias but the interpolation's.
     */
    ETD_CACHE_SOURCE_PATHS = 0,
    /**
     * The light of the global photon map: faster, with its bias.
     */
    ETD_CACHE_SOURCE_PHOTONS = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_cache_source etd_cache_source;
#else
typedef uint32_t etd_cache_source;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a radiosity system is solved.
 */
enum etd_radiosity_solver
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Every element gathers from all others, again and again.
     */
    ETD_RADIOSITY_SOLVER_GATHER = 0,
    /**
     * The patch that has most light left shoots it: progressive refinement.
     */
    ETD_RADIOSITY_SOLVER_SHOOT = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_radiosity_solver etd_radiosity_solver;
#else
typedef uint32_t etd_radiosity_solver;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Whether something is done.
 */
enum etd_switch
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * As the field's default says.
     */
    ETD_SWITCH_DEFAULT = 0,
    /**
     * It is done.
     */
    ETD_SWITCH_ON = 1,
    /**
     * It is not done.
     */
    ETD_SWITCH_OFF = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_switch etd_switch;
#else
typedef uint32_t etd_switch;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Which survival probability Russian roulette ends paths by. The choice changes noise and time, never the expected image.
 */
enum etd_roulette
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The library's own: a path survives in proportion to the throughput that it still carries.
     */
    ETD_ROULETTE_OWN = 0,
    /**
     * The one that the scene states for the material (`reflectionRate` in files, `etd_material.survival`), where it does.
     */
    ETD_ROULETTE_FILE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_roulette etd_roulette;
#else
typedef uint32_t etd_roulette;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the error of an image is measured by.
 */
enum etd_error_measure
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * relMSE: the mean over pixels and channels of squared error / (mean^2 + e), with e = 1 % of the squared mean of the
     * image.
     */
    ETD_ERROR_RELMSE = 0,
    /**
     * As a screen shows it: root of the mean squared error in levels of 255, after clamping to [0, 1] and the sRGB curve.
     */
    ETD_ERROR_DISPLAY = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_error_measure etd_error_measure;
#else
typedef uint32_t etd_error_measure;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * An image of a film. Layers are bits: together they say which ones a film keeps.
 */
enum etd_layer
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Radiance, linear Rec. 709 [W m^-2 sr^-1], with alpha: 4 channels. Always kept.
     */
    ETD_LAYER_COLOR = 1,
    /**
     * Albedo at the first hit: 3 channels.
     */
    ETD_LAYER_ALBEDO = 2,
    /**
     * Shading normal at the first hit, facing the camera, world axes: 3 channels, a mean, so not of unit length at edges.
     */
    ETD_LAYER_NORMAL = 4,
    /**
     * Distance of the first hit from the eye along the view direction: 1 channel; infinite where nothing was hit.
     */
    ETD_LAYER_DEPTH = 8,
    /**
     * Samples of the pixel: 1 channel.
     */
    ETD_LAYER_SAMPLES = 16,
    /**
     * Variance of the pixel's mean: 3 channels; NaN while there are too few samples to tell.
     */
    ETD_LAYER_VARIANCE = 32,
    /**
     * Standard error of the pixel's mean, the root of the variance: 3 channels.
     */
    ETD_LAYER_STANDARD_ERROR = 64,
    /**
     * Not an image of its own: alpha of the colour is the share of samples that met a surface. Without it, alpha is 1.
     */
    ETD_LAYER_ALPHA = 128,
    /**
     * Estimated bias of the pixel's mean by photon maps, 3 channels: what is there is too large by so much. With maps that
     * are made once (photon, photon_direct, irradiance_cache) only that of caustics; 0 without maps.
     */
    ETD_LAYER_BIAS = 256,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_layer etd_layer;
#else
typedef uint32_t etd_layer;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How pixels are laid out in the host's memory.
 */
enum etd_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Floats, as many as the layer has channels.
     */
    ETD_FORMAT_FLOAT = 0,
    /**
     * Three floats; of the colour only.
     */
    ETD_FORMAT_RGB_FLOAT = 1,
    /**
     * Three bytes, sRGB; of the colour only.
     */
    ETD_FORMAT_RGB8 = 2,
    /**
     * Four bytes, sRGB with linear alpha; of the colour only.
     */
    ETD_FORMAT_RGBA8 = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_format etd_format;
#else
typedef uint32_t etd_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How radiance becomes brightness.
 */
enum etd_tone_map
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Radiance 1 is white, and so is everything above.
     */
    ETD_TONE_MAP_CLAMP = 0,
    /**
     * Divides by the largest value of the image.
     */
    ETD_TONE_MAP_MAXIMUM = 1,
    /**
     * x / (1 + x).
     */
    ETD_TONE_MAP_REINHARD = 2,
    /**
     * A curve with a toe and a shoulder (Narkowicz's fit to ACES).
     */
    ETD_TONE_MAP_ACES = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_tone_map etd_tone_map;
#else
typedef uint32_t etd_tone_map;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A text about a scene.
 */
enum etd_text
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * What was built and decided, a line each.
     */
    ETD_TEXT_INFO = 0,
    /**
     * Warnings from reading and building, a line each.
     */
    ETD_TEXT_WARNINGS = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_text etd_text;
#else
typedef uint32_t etd_text;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Where the layout of a mesh in a light map comes from.
 */
enum etd_atlas_layout
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The mesh's own texture coordinates where they are fit for it (in [0, 1], without overlaps, every triangle with an area), else
     * charts; the log callback is told of those that are not.
     */
    ETD_ATLAS_LAYOUT_AUTO = 0,
    /**
     * Charts, whatever coordinates a mesh has.
     */
    ETD_ATLAS_LAYOUT_CHARTS = 1,
    /**
     * The mesh's own texture coordinates; an error where they are not fit for it.
     */
    ETD_ATLAS_LAYOUT_OWN = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_atlas_layout etd_atlas_layout;
#else
typedef uint32_t etd_atlas_layout;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A side of a surface.
 */
enum etd_side
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The one that the normal is on.
     */
    ETD_SIDE_FRONT = 0,
    /**
     * The other one.
     */
    ETD_SIDE_BACK = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_side etd_side;
#else
typedef uint32_t etd_side;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The layout of a light map, and the scene that it is of, as it was built then.
 */
typedef struct etd_atlas etd_atlas;

/**
 * Threads, a memory limit, and the functions that messages go to. Devices do not know of each other.
 */
typedef struct etd_device etd_device;

/**
 * A film: its resolution and layers, and the image that was made last.
 */
typedef struct etd_film etd_film;

/**
 * A scene: what the host describes, and what was built of it.
 */
typedef struct etd_scene etd_scene;

/**
 * A started render.
 */
typedef struct etd_task etd_task;

/**
 * Why the last failing call of a thread failed.
 */
typedef struct etd_error {
    /**
     * `sizeof(etd_error)`, set by the caller (`ETD_ERROR_INIT`).
     */
    size_t struct_size;
    /**
     * What that call returned.
     */
    etd_status status;
    /**
     * One-based line in `file`; 0 where it is not known.
     */
    uint32_t line;
    /**
     * The whole message, with file, line and JSON path in front. UTF-8, never NULL. This pointer and the two below stay
     * valid until the next failing call on this thread.
     */
    const char *message;
    /**
     * The file it is about; empty where it is about none.
     */
    const char *file;
    /**
     * JSON path such as `surfaces[3].radius`, for scenes built by calls too; empty where there is none.
     */
    const char *json_path;
} etd_error;

/**
 * Told warnings and decisions. `message` is UTF-8 and lives during the call.
 *
 * Called on whichever thread has something to say, several at once where several threads work. It must not unwind (throw),
 * and may make any call that does not wait for the work that called it.
 */
typedef void (*etd_log_fn)(void *user_data, etd_log_level level, const char *message);

/**
 * Told every failing call on an object of the device, on the thread of the call, before it returns. As `etd_log_fn`; a
 * call that fails inside it is not reported again.
 */
typedef void (*etd_error_fn)(void *user_data, etd_status status, const char *message);

/**
 * A piece of work for the host's executor: to be called once with its argument, on any thread, at any time, be it after
 * everything was released: then it finds nothing to do.
 */
typedef void (*etd_work_fn)(void *argument);

/**
 * Takes a piece of work for the host's own threads, and returns without waiting for it.
 *
 * Called on the thread of a render, once for each helper and pass. The host must call `work(argument)` exactly once;
 * running it late, or in the calling thread, does no harm. It must not unwind.
 */
typedef void (*etd_submit_fn)(void *user_data, etd_work_fn work, void *argument);

/**
 * How a device works.
 */
typedef struct etd_device_options {
    /**
     * `sizeof(etd_device_options)`.
     */
    size_t struct_size;
    /**
     * Threads that render and build. 0: one for each core. 1: no thread of its own, everything is done by the thread that
     * calls (a started task has one, as something must run it). Else so many, in a pool that belongs to the device.
     * With `submit`: how many threads the host offers, the calling one included.
     */
    uint32_t threads;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Bytes that hierarchies, placed geometry and films of this device may take together; 0: no limit. Descriptions
     * (copies of the host's arrays among them) and memory of the host are not counted.
     */
    uint64_t memory_limit;
    /**
     * Told warnings and decisions; may be NULL.
     */
    etd_log_fn log;
    /**
     * Told failing calls; may be NULL.
     */
    etd_error_fn error;
    /**
     * The host's executor; NULL: the device has threads of its own.
     */
    etd_submit_fn submit;
    /**
     * Given back to the three functions. They may be called until the device and everything made with it is released.
     */
    void *user_data;
} etd_device_options;

/**
 * How a scene is made.
 */
typedef struct etd_scene_options {
    /**
     * `sizeof(etd_scene_options)`.
     */
    size_t struct_size;
    /**
     * An `etd_usage`.
     */
    etd_usage usage;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * The folder in which a scene from text looks for mesh files; NULL: the current one.
     */
    const char *base_dir;
    /**
     * A parameter file of the report's renderer that overrides the scene's own settings; NULL: none.
     */
    const char *params_file;
} etd_scene_options;

/**
 * How far work has come.
 */
typedef struct etd_progress {
    /**
     * `sizeof(etd_progress)`.
     */
    size_t struct_size;
    /**
     * Share of all the work, or of the time limit, that is done, in [0, 1]; only grows.
     */
    double fraction;
    /**
     * Seconds since it began.
     */
    double elapsed;
    /**
     * Rays so far.
     */
    uint64_t rays;
    /**
     * Samples for each pixel that are complete.
     */
    uint32_t samples_done;
    /**
     * Samples for each pixel to reach.
     */
    uint32_t samples_total;
    /**
     * What it is at.
     */
    etd_phase phase;
    /**
     * How often the film got a new image so far: map it again when this grows.
     */
    uint32_t images;
} etd_progress;

/**
 * Told how far work has come; return 0 to go on and anything else to cancel.
 *
 * Called about ten times a second and after each pass, never twice at once for one piece of work: on the calling thread
 * by `etd_render` and by what makes and bakes light maps, on the task's own thread by `etd_render_start`, on one of the
 * building threads while a scene is built.
 * It must not unwind; it may map and copy the film, and must not wait for the work that called it.
 */
typedef int32_t (*etd_progress_fn)(void *user_data, const struct etd_progress *progress);

/**
 * What a built scene holds.
 */
typedef struct etd_scene_info {
    /**
     * `sizeof(etd_scene_info)`.
     */
    size_t struct_size;
    /**
     * Surfaces described, removed ones included.
     */
    uint64_t surfaces;
    /**
     * Materials described.
     */
    uint64_t materials;
    /**
     * Meshes described.
     */
    uint64_t meshes;
    /**
     * Point lights described.
     */
    uint64_t point_lights;
    /**
     * Triangles that are kept in the scene's own frame.
     */
    uint64_t triangles;
    /**
     * Instances of meshes.
     */
    uint64_t instances;
    /**
     * Triangles of the instanced meshes, each mesh counted once.
     */
    uint64_t shared_triangles;
    /**
     * Spheres, disks and quadrics.
     */
    uint64_t analytic_shapes;
    /**
     * Emitters that can be sampled.
     */
    uint64_t emitters;
    /**
     * Bytes of vertices, indices and normals that belong to the library, and of what is kept ready for shading.
     */
    uint64_t geometry_bytes;
    /**
     * Bytes of Embree's hierarchies.
     */
    uint64_t hierarchy_bytes;
    /**
     * Smallest corner of the box around all surfaces, world frame.
     */
    double bounds_min[3];
    /**
     * Largest corner.
     */
    double bounds_max[3];
    /**
     * Seconds that the last build took.
     */
    double build_time;
} etd_scene_info;

/**
 * Told once that a task has ended, and how, on the task's thread, before `etd_task_wait` returns. As `etd_progress_fn`.
 */
typedef void (*etd_finished_fn)(void *user_data, etd_status status);

/**
 * How to render and when to stop: at whichever of samples, time and error is reached first.
 *
 * From `photon_radius` on: settings of photon maps, the irradiance cache and radiosity, which only the integrators that use them
 * look at (docs/scene-format.md says which) and in which 0 always stands for the default.
 */
typedef struct etd_render_options {
    /**
     * `sizeof(etd_render_options)`.
     */
    size_t struct_size;
    /**
     * An `etd_integrator`.
     */
    etd_integrator integrator;
    /**
     * An `etd_sampler`.
     */
    etd_sampler sampler;
    /**
     * An `etd_filter`.
     */
    etd_filter filter;
    /**
     * The filter's parameters.
     */
    float filter_parameters[2];
    /**
     * Samples for each pixel, 2^31 at most; 0: as many as time and error allow, which must then be limited.
     */
    uint32_t samples;
    /**
     * Greatest number of surface hits on a path, the first visible one included; 0: no limit (a limit darkens).
     */
    uint32_t max_depth;
    /**
     * Light samples at each hit, from 1 to 1024; 0 means 1.
     */
    uint32_t shadow_rays;
    /**
     * Seed of all randomness: the same seed gives the same image, on any number of threads.
     */
    uint64_t seed;
    /**
     * Seconds after which to stop, > 0; 0: no limit. One sample for each pixel is always taken.
     */
    double time_limit;
    /**
     * Estimated error at which to stop, > 0, of the kind that `error_measure` says; 0: none. It counts as reached if it is
     * below by a quarter of the estimate's standard error, with 32 samples at least, and not while few pixels have most of it.
     */
    double target_error;
    /**
     * Told progress; may be NULL.
     */
    etd_progress_fn progress;
    /**
     * Told the end of a task; may be NULL. Not called by `etd_render`.
     */
    etd_finished_fn finished;
    /**
     * Given to the two functions.
     */
    void *user_data;
    /**
     * Radius of a density estimate, scene units, 1e-18 to 1e18; where it shrinks, the first one. 0: 0.1 for
     * `ETD_INTEGRATOR_PHOTON_DIRECT`, else from what a pixel sees.
     */
    double photon_radius;
    /**
     * Radius of caustics, as `photon_radius`.
     */
    double caustic_radius;
    /**
     * Of the progressive methods: the share of photons kept as radii shrink, above 0 and below 1; 0 means 2/3.
     */
    double photon_alpha;
    /**
     * Greatest error that Ward's estimate allows where records of the irradiance cache are interpolated, up to 10; 0 means
     * 0.25.
     */
    double cache_error;
    /**
     * Smallest distance between records, pixels as seen by the camera, up to 1000; 0 means 3.
     */
    double cache_min_spacing;
    /**
     * Greatest distance over which a record is used, as a share of the scene's extent, up to 1; 0 means 0.1.
     */
    double cache_max_spacing;
    /**
     * Light paths of a photon map (of each pass, where maps are made anew), 2^29 at most; 0: as many as the integrator
     * does best with.
     */
    uint32_t photon_count;
    /**
     * Light paths of a caustic map, as `photon_count`.
     */
    uint32_t caustic_count;
    /**
     * Of `ETD_INTEGRATOR_PHOTON_DIRECT`: fewer photons than this within the radius are no estimate, and shadow rays are
     * sent instead; 0 means 10.
     */
    uint32_t min_photons;
    /**
     * So many nearest photons make an estimate, those beyond the radius left out, 2 to 65536; `UINT32_MAX`: all within
     * the radius; 0: within a radius of each pixel's own.
     */
    uint32_t photon_neighbours;
    /**
     * An `etd_photon_kernel`.
     */
    etd_photon_kernel photon_kernel;
    /**
     * k of the cone, 1 or more; 0 means 1. Only looked at with `ETD_PHOTON_KERNEL_CONE`.
     */
    float photon_kernel_k;
    /**
     * An `etd_photon_sharing`.
     */
    etd_photon_sharing photon_sharing;
    /**
     * An `etd_switch`: whether caustic photons are aimed at the specular surfaces; by default they are.
     */
    etd_switch photons_guided;
    /**
     * An `etd_switch`: whether the map of `ETD_INTEGRATOR_CAUSTIC` is made anew for every pass, with a shrinking radius; by
     * default it is.
     */
    etd_switch photons_progressive;
    /**
     * Rays of a final gather, 1024 at most; 0 means 1.
     */
    uint32_t gather_rays;
    /**
     * Most memory of all maps at a time, MiB, 2^20 at most; 0 means 4096.
     */
    uint32_t photon_memory;
    /**
     * Rays of an irradiance record's final gather, from 16 to 2^20; 0 means 512.
     */
    uint32_t cache_rays;
    /**
     * An `etd_cache_source`.
     */
    etd_cache_source cache_source;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * An `etd_error_measure`: what `target_error` is of, and what adaptive samples make small.
     */
    etd_error_measure error_measure;
    /**
     * An `etd_switch`: whether pixels with more error get more samples, `samples` being their mean; by default where
     * `target_error` is set. Only with the samplers Sobol' and random, and not where photon maps are made anew for each
     * pass: there all pixels have the same number, and the log callback is told.
     */
    etd_switch adaptive;
    /**
     * Of `ETD_INTEGRATOR_RADIOSITY`, as all that follows: elements whose longest side is no longer than this are not divided
     * any more, scene units, 1e-18 to 1e18; 0: a 64th of the extent of the scene.
     */
    double radiosity_element_size;
    /**
     * What one link between elements may be wrong by, in thousandths of all irradiance, up to 1000; 0 means 1.
     */
    double radiosity_error;
    /**
     * Share of the solution that may be left to iterate for, below 1; 0 means 0.0001.
     */
    double radiosity_tolerance;
    /**
     * Iterations, 2^24 at most: bounces of light, or patches that shoot; `UINT32_MAX`: none, light sources alone; 0: until
     * what is left is below `radiosity_tolerance`.
     */
    uint32_t radiosity_iterations;
    /**
     * An `etd_radiosity_solver`.
     */
    etd_radiosity_solver radiosity_solver;
    /**
     * An `etd_switch`: whether light that was shot but not distributed yet is shown as its mean; by default it is not.
     */
    etd_switch radiosity_ambient;
    /**
     * An `etd_switch`: whether pictures take direct light from light samples and indirect light from a ray into the solution,
     * instead of interpolating it; by default they do not.
     */
    etd_switch radiosity_final_gather;
    /**
     * Most memory of elements and links, MiB, 2^20 at most; 0 means 1024.
     */
    uint32_t radiosity_memory;
    /**
     * Of every integrator that follows paths: an `etd_roulette`.
     */
    etd_roulette roulette;
} etd_render_options;

/**
 * Where a scene is seen from: world frame, right-handed, lengths in scene units.
 */
typedef struct etd_camera {
    /**
     * `sizeof(etd_camera)`.
     */
    size_t struct_size;
    /**
     * An `etd_camera_type`.
     */
    etd_camera_type projection;
    /**
     * An `etd_fov_axis`.
     */
    etd_fov_axis fov_axis;
    /**
     * The eye, or the centre of the view plane.
     */
    double origin[3];
    /**
     * A point in the middle of the image, other than `origin`.
     */
    double look_at[3];
    /**
     * Upwards in the image, not parallel to the view; any length.
     */
    double up[3];
    /**
     * Full angle of view, degrees, between 0 and 180.
     */
    double fov_deg;
} etd_camera;

/**
 * A material. Fields that its model does not use are not looked at.
 */
typedef struct etd_material {
    /**
     * `sizeof(etd_material)`.
     */
    size_t struct_size;
    /**
     * An `etd_bsdf`.
     */
    etd_bsdf bsdf;
    /**
     * Albedo or reflectance, linear, [0, 1] per channel.
     */
    float color[3];
    /**
     * Fujii's sigma', in [0, 1].
     */
    float roughness;
    /**
     * Standard deviation of the facets' slope angle, degrees, in [0, 90].
     */
    float sigma_deg;
    /**
     * Index of refraction on the side opposite to the normal, > 0.
     */
    float ior;
    /**
     * Index of refraction on the normal's side, > 0; 0 means 1.
     */
    float exterior_ior;
    /**
     * Survival probability of Russian roulette at this material, in (0, 1], for renders with `ETD_ROULETTE_FILE`; 0: the
     * library chooses in these too. It changes noise and time, never the image.
     */
    float survival;
    /**
     * Must be 0.
     */
    uint32_t reserved;
} etd_material;

/**
 * Everything about a surface but its shape.
 */
typedef struct etd_surface {
    /**
     * `sizeof(etd_surface)`.
     */
    size_t struct_size;
    /**
     * Number of its material; `ETD_NONE` for a surface that emits light and reflects none.
     */
    uint32_t material;
    /**
     * Emitted radiance on the normal's side [W m^-2 sr^-1]; all zero: it does not emit. Quadrics and disks cannot.
     */
    float emission[3];
    /**
     * Object to world, three rows of four (the last column translates); all zero: none.
     */
    double transform[12];
} etd_surface;

/**
 * Called when memory that was shared with a mesh is no longer read. Exactly once, on any thread, perhaps in the middle of
 * another call; it may make no calls of this library.
 */
typedef void (*etd_release_fn)(void *user_data);

/**
 * A triangle mesh in arrays of the host.
 */
typedef struct etd_mesh {
    /**
     * `sizeof(etd_mesh)`.
     */
    size_t struct_size;
    /**
     * One position for each vertex, the mesh's own frame.
     */
    const void *positions;
    /**
     * Bytes from one position to the next; 0: they lie close together.
     */
    size_t position_stride;
    /**
     * Bytes that can be read from `positions` on; 0: up to the end of the last stride. Only looked at with `ETD_SHARE`.
     */
    size_t position_bytes;
    /**
     * Number of vertices, at least 1 and below 2^32 - 1.
     */
    size_t vertex_count;
    /**
     * Three vertex numbers for each triangle, counter-clockwise seen from outside.
     */
    const uint32_t *indices;
    /**
     * Bytes from one triangle's numbers to the next; 0: they lie close together.
     */
    size_t index_stride;
    /**
     * Number of triangles, at least 1 and below 2^32 - 1.
     */
    size_t triangle_count;
    /**
     * One normal for each vertex, any length; NULL: none.
     */
    const float *normals;
    /**
     * Bytes from one normal to the next; 0: they lie close together.
     */
    size_t normal_stride;
    /**
     * One texture coordinate for each vertex; NULL: none.
     */
    const float *uvs;
    /**
     * Bytes from one texture coordinate to the next; 0: they lie close together.
     */
    size_t uv_stride;
    /**
     * An `etd_position_format`.
     */
    etd_position_format position_format;
    /**
     * An `etd_sharing`.
     */
    etd_sharing sharing;
    /**
     * With `ETD_SHARE`: told once that the arrays are no longer read; may be NULL. Not called if the call fails.
     */
    etd_release_fn release;
    /**
     * Given to `release`.
     */
    void *user_data;
    /**
     * A name to find it by, unique among meshes; NULL: none.
     */
    const char *name;
} etd_mesh;

/**
 * What a film is.
 */
typedef struct etd_film_options {
    /**
     * `sizeof(etd_film_options)`.
     */
    size_t struct_size;
    /**
     * Pixels in a row, >= 1.
     */
    uint32_t width;
    /**
     * Rows, >= 1; the film has 2^26 pixels at most.
     */
    uint32_t height;
    /**
     * `etd_layer` bits of what is kept besides the colour.
     */
    uint32_t layers;
    /**
     * Must be 0.
     */
    uint32_t reserved;
} etd_film_options;

/**
 * An image in the library's memory, there to be read until `etd_film_unmap`.
 */
typedef struct etd_map {
    /**
     * `sizeof(etd_map)`.
     */
    size_t struct_size;
    /**
     * `[height][width][channels]`, row 0 on top, without gaps. Does not change while it is mapped.
     */
    const float *data;
    /**
     * Pixels in a row.
     */
    uint32_t width;
    /**
     * Rows.
     */
    uint32_t height;
    /**
     * Values for each pixel.
     */
    uint32_t channels;
    /**
     * Complete samples for each pixel when this image was made; 0 for the black one before the first pass.
     */
    uint32_t samples;
    /**
     * What `etd_film_unmap` knows it by.
     */
    uint64_t id;
} etd_map;

/**
 * How pixels are copied or written.
 */
typedef struct etd_image_options {
    /**
     * `sizeof(etd_image_options)`.
     */
    size_t struct_size;
    /**
     * An `etd_format`; not looked at by `etd_film_write`.
     */
    etd_format format;
    /**
     * An `etd_tone_map`, for 8-bit formats and PNG.
     */
    etd_tone_map tone_map;
    /**
     * Stops, in [-64, 64]: a factor of 2^exposure before the tone map, for 8-bit formats and PNG.
     */
    float exposure;
    /**
     * Not 0: the bottom row comes first, as OpenGL wants it; not looked at by `etd_film_write`.
     */
    uint32_t bottom_up;
    /**
     * Free text for the `comments` attribute of an EXR, UTF-8; NULL: none. Only `etd_film_write` looks at it.
     */
    const char *comments;
} etd_image_options;

/**
 * What the last render of a film came to.
 */
typedef struct etd_summary {
    /**
     * `sizeof(etd_summary)`.
     */
    size_t struct_size;
    /**
     * Seconds that it took, without building the scene.
     */
    double elapsed;
    /**
     * Seconds that building the scene took before it; 0 where it was built already.
     */
    double build_time;
    /**
     * Rays traced, closest-hit and shadow rays together.
     */
    uint64_t rays;
    /**
     * Samples that were NaN or infinite and count as black. The log callback is told where the first of them became so.
     */
    uint64_t non_finite;
    /**
     * Estimated relative error of the image: the root of `rel_mse`. NaN where there are too few samples to tell.
     */
    double relative_error;
    /**
     * Samples for each pixel that are complete; the mean over pixels where they differ.
     */
    uint32_t samples;
    /**
     * 1 if it was cancelled, else 0.
     */
    uint32_t cancelled;
    /**
     * Estimated relMSE (see `ETD_ERROR_RELMSE`). NaN where there are too few samples to tell.
     */
    double rel_mse;
    /**
     * Standard error of `rel_mse`, from the scatter over pixels.
     */
    double rel_mse_standard_error;
    /**
     * Estimated error of what a screen shows (see `ETD_ERROR_DISPLAY`), levels of 255; NaN as `rel_mse`.
     */
    double display_error;
    /**
     * Samples of the pixel that has fewest, and of the one that has most; 0 after a cancel.
     */
    uint32_t samples_min;
    /**
     * See `samples_min`.
     */
    uint32_t samples_max;
    /**
     * What ended it.
     */
    etd_ended ended;
    /**
     * 0.
     */
    uint32_t reserved;
} etd_summary;

/**
 * A ray segment: origin + t * direction for t in [tnear, tfar], world frame.
 */
typedef struct etd_ray {
    /**
     * Where t is 0.
     */
    float origin[3];
    /**
     * Start of the segment, >= 0.
     */
    float tnear;
    /**
     * Any length that is not zero; t counts in this length.
     */
    float direction[3];
    /**
     * End of the segment; may be infinite.
     */
    float tfar;
} etd_ray;

/**
 * What a ray met first.
 */
typedef struct etd_hit {
    /**
     * Distance in lengths of the ray's direction; infinite where nothing was met, and then nothing else is set but
     * `surface`.
     */
    float t;
    /**
     * Weights of the triangle's second and third vertex; 0 on other shapes.
     */
    float barycentric[2];
    /**
     * Texture coordinates: the mesh's where it has any, else the barycentric ones (over the whole of a quad); 0 on other
     * shapes.
     */
    float uv[2];
    /**
     * Geometric normal, unit length, on the outer side.
     */
    float ng[3];
    /**
     * Shading normal, unit length, on the outer side; the geometric one where shading is flat.
     */
    float ns[3];
    /**
     * Number of the surface; `ETD_NONE` where nothing was met.
     */
    uint32_t surface;
    /**
     * Number of its material.
     */
    uint32_t material;
    /**
     * Number of the triangle in its mesh, 0 or 1 in a quad, else 0.
     */
    uint32_t primitive;
} etd_hit;

/**
 * How a light map is laid out. 0 always stands for the default.
 */
typedef struct etd_atlas_options {
    /**
     * `sizeof(etd_atlas_options)`.
     */
    size_t struct_size;
    /**
     * Texels along the sides of the square, 8192 at most; 0: as many as `texels_per_unit` needs, or 512.
     */
    uint32_t resolution;
    /**
     * Texels around each chart that are its own, 64 at most; 0 means 2, `UINT32_MAX` none. One is what bilinear lookups need.
     */
    uint32_t gutter;
    /**
     * Texels for a unit of length; 0: as many as fit.
     */
    double texels_per_unit;
    /**
     * How far the normals of a chart's triangles may be from the first one's, degrees, below 90; 0 means 45.
     */
    double max_angle_deg;
    /**
     * An `etd_atlas_layout`.
     */
    etd_atlas_layout layout;
    /**
     * Most memory that the atlas and its bakes may take, MiB; 0 means 4096. The device's limit holds beside it.
     */
    uint32_t memory;
    /**
     * Must be 0.
     */
    uint64_t reserved;
    /**
     * Told how far it is; may be NULL.
     */
    etd_progress_fn progress;
    /**
     * Given to `progress`.
     */
    void *user_data;
} etd_atlas_options;

/**
 * How large an atlas is.
 */
typedef struct etd_atlas_info {
    /**
     * `sizeof(etd_atlas_info)`.
     */
    size_t struct_size;
    /**
     * Texels in a row.
     */
    uint32_t width;
    /**
     * Rows.
     */
    uint32_t height;
    /**
     * Vertices of all surfaces.
     */
    size_t vertex_count;
    /**
     * Triangles of all surfaces.
     */
    size_t triangle_count;
    /**
     * Surfaces that are there.
     */
    size_t surface_count;
    /**
     * Charts.
     */
    size_t chart_count;
    /**
     * Texels that triangles cover.
     */
    size_t covered_texels;
    /**
     * Texels for a unit of length, along the plane of a chart; for meshes with their own layout, on the mean.
     */
    double texels_per_unit;
} etd_atlas_info;

/**
 * A corner of a light-mapped triangle.
 */
typedef struct etd_atlas_vertex {
    /**
     * World frame.
     */
    double position[3];
    /**
     * Unit normal: the shading normal of a smooth surface, else the mean of the chart's triangles there.
     */
    float normal[3];
    /**
     * Its place in the light map, in [0, 1]: (0, 0) is the outer corner of the first texel of row 0.
     */
    float uv[2];
    /**
     * Its number in the mesh as it was given; of a triangle or a quad that of the corner; running on other shapes.
     */
    uint32_t source;
} etd_atlas_vertex;

/**
 * A surface in a light map.
 */
typedef struct etd_atlas_surface {
    /**
     * Its number in the scene.
     */
    uint32_t surface;
    /**
     * Its first vertex.
     */
    uint32_t first_vertex;
    /**
     * How many it has.
     */
    uint32_t vertex_count;
    /**
     * Its first triangle.
     */
    uint32_t first_triangle;
    /**
     * How many it has.
     */
    uint32_t triangle_count;
    /**
     * 1 if the mesh's own texture coordinates are the layout, else 0.
     */
    uint32_t has_own_layout;
    /**
     * Then (u, v) of the mesh times the first two, plus the others, is the place in the light map; else 0.
     */
    float scale_offset[4];
} etd_atlas_surface;

/**
 * Where baked light goes.
 */
typedef struct etd_bake_target {
    /**
     * `sizeof(etd_bake_target)`.
     */
    size_t struct_size;
    /**
     * Three floats for each texel or vertex: irradiance [W m^-2], linear Rec. 709.
     */
    float *irradiance;
    /**
     * Three floats for each: its standard error [W m^-2], NaN where there are too few samples to tell; laid out as `irradiance`.
     * NULL: not wanted.
     */
    float *standard_error;
    /**
     * Bytes that may be written from each of the two pointers on.
     */
    size_t size;
    /**
     * Bytes from one texel or vertex to the next; 0: they lie close together (12).
     */
    size_t stride;
    /**
     * Bytes from one row of texels to the next; 0: they lie close together.
     */
    size_t row_stride;
    /**
     * An `etd_side`.
     */
    etd_side side;
    /**
     * Must be 0.
     */
    uint32_t reserved;
} etd_bake_target;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The message of the last call that failed on this thread, with file, line and JSON path where there are any.
 *
 * UTF-8, never NULL, empty if no call has failed yet. Valid until the next failing call on this thread. Calls that
 * succeed leave it alone. Thread-safe; each thread has its own.
 */
const char *etd_last_error_message(void);

/**
 * The parts of the last failure of this thread.
 *
 * Fills `*out_error`, whose `struct_size` must be set, and returns `ETD_OK`; `out_error->status` is `ETD_OK` if no call
 * has failed yet. The strings are valid until the next failing call on this thread. Thread-safe.
 */
etd_status etd_last_error(struct etd_error *out_error);

/**
 * The name of a status, such as "ETD_INVALID_SCENE"; "unknown status" for any other number. Static. Thread-safe.
 */
const char *etd_status_name(uint32_t status);

/**
 * The version of the library that is linked, as 10000 * major + 100 * minor + patch. Compare with `ETD_VERSION`.
 * Thread-safe.
 */
uint32_t etd_version(void);

/**
 * The same as text, such as "0.1.0". Static. Thread-safe.
 */
const char *etd_version_string(void);

/**
 * Makes a device and starts its threads.
 *
 * `options`: NULL for the defaults of `ETD_DEVICE_OPTIONS_INIT`. On `ETD_OK` `*out_device` is one reference, to be given
 * back with `etd_device_release`. Errors: `ETD_INVALID_ARGUMENT` for more than 1024 threads, `ETD_DEVICE` if no thread
 * could be started. Thread-safe.
 */
etd_status etd_device_new(const struct etd_device_options *options,
                          struct etd_device **out_device);

/**
 * One more reference to a device. Thread-safe.
 */
etd_status etd_device_retain(struct etd_device *device);

/**
 * Gives back one reference to a device; NULL is fine. What was made with it keeps it alive. Thread-safe.
 */
void etd_device_release(struct etd_device *device);

/**
 * The first failure of a call on this device since this was last asked, and forgets it; `ETD_OK` if there was none.
 *
 * So that a host may make many calls and look once. `message`: where its message goes (at most `capacity` bytes with the
 * zero byte), or NULL. Thread-safe.
 */
etd_status etd_device_status(struct etd_device *device,
                             char *message,
                             size_t capacity);

/**
 * Bytes that hierarchies, placed geometry and films of the device take now, and the most they ever took. Either pointer may be NULL.
 * Thread-safe.
 */
etd_status etd_device_memory(const struct etd_device *device,
                             uint64_t *out_used,
                             uint64_t *out_peak);

/**
 * Makes an empty scene with the default camera, to be described by calls.
 *
 * `options`: NULL for defaults; `base_dir` is for mesh files. On `ETD_OK` `*out_scene` is one reference. The scene keeps
 * its device alive. Thread-safe.
 */
etd_status etd_scene_new(struct etd_device *device,
                         const struct etd_scene_options *options,
                         struct etd_scene **out_scene);

/**
 * Reads a scene from text: this library's JSON format, or that of the report's renderer.
 *
 * `json`: `json_length` bytes of UTF-8, no zero byte needed. Mesh files are looked for in `options->base_dir`. On
 * `ETD_OK` `*out_scene` is one reference; on failure it is untouched, and the message says line and JSON path. Nothing
 * is built yet: `etd_scene_commit` does, or the first render. Thread-safe.
 */
etd_status etd_scene_from_json(struct etd_device *device,
                               const char *json,
                               size_t json_length,
                               const struct etd_scene_options *options,
                               struct etd_scene **out_scene);

/**
 * Reads a scene from a file; mesh files are looked for in its folder (`options->base_dir` is not looked at).
 *
 * As `etd_scene_from_json` in all else. `path`: UTF-8. Thread-safe.
 */
etd_status etd_scene_from_file(struct etd_device *device,
                               const char *path,
                               const struct etd_scene_options *options,
                               struct etd_scene **out_scene);

/**
 * One more reference to a scene. Thread-safe.
 */
etd_status etd_scene_retain(struct etd_scene *scene);

/**
 * Gives back one reference to a scene; NULL is fine. Tasks that render it keep it alive. Thread-safe.
 */
void etd_scene_release(struct etd_scene *scene);

/**
 * The first failure of a call on this scene since this was last asked, and forgets it; `ETD_OK` if there was none.
 *
 * So that a scene may be described by many calls and checked once. `message`: where its message goes (at most `capacity`
 * bytes with the zero byte), or NULL. Thread-safe.
 */
etd_status etd_scene_status(struct etd_scene *scene,
                            char *message,
                            size_t capacity);

/**
 * Builds what was described since the last time, and only that; returns at once if there is nothing new.
 *
 * Renders do this by themselves; ray queries see the scene as it was last built. Renders that are under way go on with
 * the scene they began with. `progress` may be NULL; it is called on a building thread, and cancels if it returns
 * anything but 0. Errors: those of the description that only show when it is built, `ETD_CANCELLED`,
 * `ETD_OUT_OF_MEMORY`; what was built before stays in use then. Thread-safe.
 */
etd_status etd_scene_commit(struct etd_scene *scene, etd_progress_fn progress, void *user_data);

/**
 * What was built: counts, memory, extent. An error before the first build. Thread-safe.
 */
etd_status etd_scene_get_info(const struct etd_scene *scene, struct etd_scene_info *out_info);

/**
 * Copies a text about the scene, an `etd_text`, into the caller's buffer.
 *
 * At most `capacity` bytes with the zero byte are written. `*out_needed`, unless NULL, is the size that holds it all;
 * `buffer` may be NULL to ask for that alone. `ETD_TEXT_INFO` is an error before the first build. Thread-safe.
 */
etd_status etd_scene_copy_text(const struct etd_scene *scene,
                               etd_text which,
                               char *buffer,
                               size_t capacity,
                               size_t *out_needed);

/**
 * The settings that the scene's own `render` block asks for (the defaults where it has none), to be changed and given to
 * a render. Thread-safe.
 */
etd_status etd_scene_get_render_options(const struct etd_scene *scene,
                                        struct etd_render_options *out_options);

/**
 * The resolution that the scene's own `render` block asks for, 256 x 256 where it has none. Thread-safe.
 */
etd_status etd_scene_get_resolution(const struct etd_scene *scene, uint32_t *out_width, uint32_t *out_height);

/**
 * Replaces the camera.
 *
 * Errors: `ETD_INVALID_SCENE` if view direction, up vector and angle make no image. Thread-safe.
 */
etd_status etd_scene_set_camera(struct etd_scene *scene, const struct etd_camera *camera);

/**
 * The camera as it is described now. Thread-safe.
 */
etd_status etd_scene_get_camera(const struct etd_scene *scene, struct etd_camera *out_camera);

/**
 * Adds a material.
 *
 * `name`: unique among materials, to find it by; NULL: none. `*out_material` is its number. Errors:
 * `ETD_INVALID_SCENE` for a value out of its domain. Thread-safe.
 */
etd_status etd_scene_add_material(struct etd_scene *scene,
                                  const char *name,
                                  const struct etd_material *material,
                                  uint32_t *out_material);

/**
 * Replaces a material; every surface that has it changes. No geometry is touched. Thread-safe.
 */
etd_status etd_scene_set_material(struct etd_scene *scene, uint32_t material, const struct etd_material *value);

/**
 * A material as it is described now. Thread-safe.
 */
etd_status etd_scene_get_material(const struct etd_scene *scene, uint32_t material, struct etd_material *out_material);

/**
 * Adds a light that shines from a point, the same in all directions.
 *
 * `position`: three numbers, world frame. `intensity`: three numbers, radiant intensity [W sr^-1], each >= 0.
 * `*out_light` is its number among point lights. Lights with an area are surfaces with an emission. Thread-safe.
 */
etd_status etd_scene_add_point_light(struct etd_scene *scene,
                                     const double *position,
                                     const float *intensity,
                                     uint32_t *out_light);

/**
 * Moves and recolours a point light; no intensity switches it off. Arguments as for `etd_scene_add_point_light`.
 * Thread-safe.
 */
etd_status etd_scene_set_point_light(struct etd_scene *scene,
                                     uint32_t light,
                                     const double *position,
                                     const float *intensity);

/**
 * A point light as it is described now: three numbers each. Thread-safe.
 */
etd_status etd_scene_get_point_light(const struct etd_scene *scene,
                                     uint32_t light,
                                     double *out_position,
                                     float *out_intensity);

/**
 * Adds a sphere with its normals outwards. `centre`: three numbers; `radius` > 0. Under a transform that stretches it,
 * it is an ellipsoid, which cannot emit.
 *
 * As all that add a surface: `surface` says material, emission and transform; `*out_surface` is the surface's number;
 * errors are `ETD_INVALID_SCENE` and `ETD_UNSUPPORTED` with the JSON path that a file would have. Thread-safe.
 */
etd_status etd_scene_add_sphere(struct etd_scene *scene,
                                const double *centre,
                                double radius,
                                const struct etd_surface *surface,
                                uint32_t *out_surface);

/**
 * Adds a triangle with normal (v1 - v0) x (v2 - v0). `vertices`: three positions, nine numbers. Thread-safe.
 */
etd_status etd_scene_add_triangle(struct etd_scene *scene,
                                  const double *vertices,
                                  const struct etd_surface *surface,
                                  uint32_t *out_surface);

/**
 * Adds a flat convex quadrilateral, vertices in order around its edge, with the normal of its first three.
 * `vertices`: four positions, twelve numbers. Thread-safe.
 */
etd_status etd_scene_add_quad(struct etd_scene *scene,
                              const double *vertices,
                              const struct etd_surface *surface,
                              uint32_t *out_surface);

/**
 * Adds a flat round disk. `normal`: any length. Cannot emit. Thread-safe.
 */
etd_status etd_scene_add_disk(struct etd_scene *scene,
                              const double *centre,
                              const double *normal,
                              double radius,
                              const struct etd_surface *surface,
                              uint32_t *out_surface);

/**
 * Adds a tube without caps, normals outwards. `base`: centre of one end; `axis`: direction to the other, any length.
 * Cannot emit. Thread-safe.
 */
etd_status etd_scene_add_cylinder(struct etd_scene *scene,
                                  const double *base,
                                  const double *axis,
                                  double radius,
                                  double height,
                                  const struct etd_surface *surface,
                                  uint32_t *out_surface);

/**
 * Adds a cone without its base disk, normals outwards. `base`: centre of the base; `axis`: direction to the apex.
 * Cannot emit. Thread-safe.
 */
etd_status etd_scene_add_cone(struct etd_scene *scene,
                              const double *base,
                              const double *axis,
                              double radius,
                              double height,
                              const struct etd_surface *surface,
                              uint32_t *out_surface);

/**
 * Adds a paraboloid of revolution, open at its wide end, normals away from its axis. `axis`: direction from the apex
 * into the bowl; `radius`: that at `height`. Cannot emit. Thread-safe.
 */
etd_status etd_scene_add_paraboloid(struct etd_scene *scene,
                                    const double *apex,
                                    const double *axis,
                                    double radius,
                                    double height,
                                    const struct etd_surface *surface,
                                    uint32_t *out_surface);

/**
 * Adds an ellipsoid with its axes along x, y and z, normals outwards. `radii`: three numbers > 0. Cannot emit.
 * Thread-safe.
 */
etd_status etd_scene_add_ellipsoid(struct etd_scene *scene,
                                   const double *centre,
                                   const double *radii,
                                   const struct etd_surface *surface,
                                   uint32_t *out_surface);

/**
 * Adds a quadric: a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0, normals along the gradient.
 *
 * `coefficients`: ten numbers, a to j. `clip_min`, `clip_max`: only what lies inside this box is there; both NULL for an
 * ellipsoid, which ends by itself. Cannot emit. Thread-safe.
 */
etd_status etd_scene_add_quadric(struct etd_scene *scene,
                                 const double *coefficients,
                                 const double *clip_min,
                                 const double *clip_max,
                                 const struct etd_surface *surface,
                                 uint32_t *out_surface);

/**
 * Adds a use of a mesh; one mesh may be used many times, and is kept once.
 *
 * `smooth`: not 0 interpolates the vertex normals (made from the faces where the mesh has none). Thread-safe.
 */
etd_status etd_scene_add_mesh_surface(struct etd_scene *scene,
                                      uint32_t mesh,
                                      uint32_t smooth,
                                      const struct etd_surface *surface,
                                      uint32_t *out_surface);

/**
 * Removes a surface. Its number is not used again, and every other keeps its own. Thread-safe.
 */
etd_status etd_scene_remove_surface(struct etd_scene *scene, uint32_t surface);

/**
 * Places a surface. `transform`: object to world, three rows of four numbers, not flattening; it replaces the one there
 * was. Of a shape with a place of its own (a cylinder's base, say) it moves the whole. Thread-safe.
 */
etd_status etd_scene_set_transform(struct etd_scene *scene, uint32_t surface, const double *transform);

/**
 * Gives a surface another material; `ETD_NONE` for one that emits and reflects nothing. Thread-safe.
 */
etd_status etd_scene_set_surface_material(struct etd_scene *scene, uint32_t surface, uint32_t material);

/**
 * Changes what a surface emits [W m^-2 sr^-1]. `radiance`: three numbers >= 0; all zero, or NULL: it emits nothing.
 * Thread-safe.
 */
etd_status etd_scene_set_emission(struct etd_scene *scene, uint32_t surface, const float *radiance);

/**
 * Material, emission and transform of a surface as they are described now; an error if it was removed. Thread-safe.
 */
etd_status etd_scene_get_surface(const struct etd_scene *scene, uint32_t surface, struct etd_surface *out_surface);

/**
 * The number of the material of this name. Thread-safe.
 */
etd_status etd_scene_find_material(const struct etd_scene *scene, const char *name, uint32_t *out_material);

/**
 * The number of the mesh of this name. Thread-safe.
 */
etd_status etd_scene_find_mesh(const struct etd_scene *scene, const char *name, uint32_t *out_mesh);

/**
 * The number of the surface with this JSON path, such as `surfaces[3]` or, for an area light, `lights[0]`. Thread-safe.
 */
etd_status etd_scene_find_surface(const struct etd_scene *scene, const char *json_path, uint32_t *out_surface);

/**
 * Adds a mesh from arrays; surfaces use it with `etd_scene_add_mesh_surface`. `*out_mesh` is its number.
 *
 * Errors: `ETD_INVALID_ARGUMENT` for arrays that cannot be read as they are said to be, `ETD_INVALID_SCENE` for a number
 * that is not finite or an index of no vertex, with its place. Triangles without area may be present. Thread-safe.
 */
etd_status etd_scene_add_mesh(struct etd_scene *scene,
                              const struct etd_mesh *mesh,
                              uint32_t *out_mesh);

/**
 * Adds a mesh from a Wavefront OBJ file. `name`: unique among meshes, to find it by; NULL: none. `path`: UTF-8, from the
 * current folder. Thread-safe.
 */
etd_status etd_scene_add_mesh_file(struct etd_scene *scene,
                                   const char *name,
                                   const char *path,
                                   uint32_t *out_mesh);

/**
 * Replaces a mesh by other arrays, wherever it is used; arrays that were shared for it are released when no build and no
 * render reads them any more. `name` in `value` is not looked at. Thread-safe.
 */
etd_status etd_scene_set_mesh(struct etd_scene *scene,
                              uint32_t mesh,
                              const struct etd_mesh *value);

/**
 * Removes a mesh that no surface uses any more, and gives back its memory. Its number is not used again. Thread-safe.
 */
etd_status etd_scene_remove_mesh(struct etd_scene *scene, uint32_t mesh);

/**
 * Makes a film, black and of no sample.
 *
 * `options` must say its resolution. Renders may fill it again and again, one at a time. On `ETD_OK` `*out_film` is one
 * reference. Errors: `ETD_INVALID_ARGUMENT` for a resolution or layers that do not exist, `ETD_OUT_OF_MEMORY` past the
 * device's limit (a film takes about 150 bytes a pixel, in whole tiles of 16 x 16; images that are mapped
 * beyond two are not counted). Thread-safe.
 */
etd_status etd_film_new(struct etd_device *device, const struct etd_film_options *options, struct etd_film **out_film);

/**
 * One more reference to a film. Thread-safe.
 */
etd_status etd_film_retain(struct etd_film *film);

/**
 * Gives back one reference to a film; NULL is fine. Tasks that fill it keep it alive; what is still mapped goes away with
 * the last reference. Thread-safe.
 */
void etd_film_release(struct etd_film *film);

/**
 * The first failure of a call on this film since this was last asked, and forgets it; `ETD_OK` if there was none.
 * `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
 */
etd_status etd_film_status(struct etd_film *film, char *message, size_t capacity);

/**
 * Maps a layer of the newest image: `*out_map` points to it.
 *
 * It may be called while the film is being rendered to; the image is then that of the last complete pass (or, in the
 * middle of a long one, of a moment in it), and does not change while it is mapped. After a render was cancelled the first
 * call makes its image; at any other time nothing is copied. Each map is ended by one
 * `etd_film_unmap`. `layer`: one `etd_layer` that the film keeps. Thread-safe.
 */
etd_status etd_film_map(struct etd_film *film,
                        etd_layer layer,
                        struct etd_map *out_map);

/**
 * Ends a map: `map->data` may not be read any more, and is set to NULL. `ETD_INVALID_OPERATION` if it was ended before.
 * Thread-safe.
 */
etd_status etd_film_unmap(struct etd_film *film, struct etd_map *map);

/**
 * Copies a layer of the newest image into the host's memory.
 *
 * `layer`: one `etd_layer` that the film keeps. `options`: NULL for floats, top row first; format, tone map and exposure
 * otherwise. `pixels`: `size` bytes. `row_stride`: bytes from one row to the next, 0 for rows close together. Errors:
 * `ETD_INVALID_ARGUMENT` for a stride below a row, a size below the image, floats that are not aligned, or a format that
 * the layer does not have. Thread-safe.
 */
etd_status etd_film_copy(const struct etd_film *film,
                         etd_layer layer,
                         const struct etd_image_options *options,
                         void *pixels,
                         size_t size,
                         size_t row_stride);

/**
 * Writes the film as it stands to a file: `.png` (8-bit sRGB), `.exr` (float, with layers) or `.pfm` (float).
 *
 * An EXR holds the layers `samples` and `variance`, and albedo, normal and depth where the film keeps any of these, and in
 * its header what the render came to (`relMSE`, `relMSEStandardError`, `displayError`, `samplesPerPixel`, `rays`, `ended`). The
 * file appears whole or not at all. `path`: UTF-8. `options`: NULL for a clamped sRGB picture without comments. Errors:
 * `ETD_IO`, `ETD_UNSUPPORTED` for another extension, `ETD_INVALID_OPERATION` before the first render. Thread-safe.
 */
etd_status etd_film_write(const struct etd_film *film,
                          const char *path,
                          const struct etd_image_options *options);

/**
 * What the last render that ended on this film came to; `ETD_INVALID_OPERATION` before the first. Thread-safe.
 */
etd_status etd_film_get_summary(const struct etd_film *film, struct etd_summary *out_summary);

/**
 * Renders a scene to a film and returns when it is done; builds the scene first where it has changed.
 *
 * The film must be of the scene's device. `options`: NULL for the scene's own settings. Returns `ETD_CANCELLED` if the progress callback stopped it; the film then
 * holds what was done. Errors: `ETD_INVALID_OPERATION` while the film is being rendered to, and all that
 * `etd_scene_commit` has. The image depends on scene, resolution and options alone, not on threads. Thread-safe: several
 * renders, of one scene too, may run at once, each to a film of its own.
 */
etd_status etd_render(struct etd_scene *scene,
                      struct etd_film *film,
                      const struct etd_render_options *options);

/**
 * Begins to render a scene to a film and returns at once; building the scene is part of the task.
 *
 * As `etd_render`, on a thread of its own (with a host's executor: as a piece of work of it). On `ETD_OK` `*out_task` is
 * one reference. Thread-safe.
 */
etd_status etd_render_start(struct etd_scene *scene,
                            struct etd_film *film,
                            const struct etd_render_options *options,
                            struct etd_task **out_task);

/**
 * How far a task is: `ETD_RUNNING`, or how it ended (`ETD_OK`, `ETD_CANCELLED`, an error whose message is this thread's
 * last then).
 *
 * `out_progress`: NULL, or filled. Never waits. Thread-safe.
 */
etd_status etd_task_poll(struct etd_task *task, struct etd_progress *out_progress);

/**
 * Waits until a task has ended, for `seconds` at most (below 0: without a limit), and says as `etd_task_poll` how.
 *
 * When it has returned something else than `ETD_RUNNING`, none of the task's functions is called any more.
 * `ETD_INVALID_OPERATION` inside one of these. Thread-safe.
 */
etd_status etd_task_wait(struct etd_task *task, double seconds);

/**
 * Asks a task to end soon, in whatever phase it is, and returns at once. It ends with `ETD_CANCELLED`, unless it was done
 * already. One that no thread has begun yet ends here, and its `finished` is called here. Thread-safe, also inside the task's own functions.
 */
etd_status etd_task_cancel(struct etd_task *task);

/**
 * Lets a task that was cancelled, or ended by its time limit, go on from where it stopped, with the scene that it began
 * with (as it is now, if it was cancelled before the scene was built) and its time limit anew. It comes to the same image
 * as one that was never interrupted.
 *
 * A task that is complete stays so. `ETD_INVALID_OPERATION` while it runs, after an error, and inside its own functions. Another render
 * to the same film in between is not undone: the film then shows this task's image again. Thread-safe.
 */
etd_status etd_task_resume(struct etd_task *task);

/**
 * One more reference to a task. Thread-safe.
 */
etd_status etd_task_retain(struct etd_task *task);

/**
 * Gives back one reference to a task; NULL is fine. With the last one a task that still runs is cancelled and waited
 * for, so that none of its functions is called afterwards; these may use the handle until then. (Inside one of them it is
 * only cancelled.) Thread-safe.
 */
void etd_task_release(struct etd_task *task);

/**
 * The first failure of a call on this task since this was last asked, and forgets it; `ETD_OK` if there was none.
 * `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
 */
etd_status etd_task_status(struct etd_task *task, char *message, size_t capacity);

/**
 * Finds what each of `count` rays meets first, in the scene as it was last built.
 *
 * `hits`: one for each ray, in order. A ray that cannot be traced (NaN, infinity in origin or direction, no direction, a
 * negative or NaN interval) meets nothing; all others are answered, and then `ETD_INVALID_ARGUMENT` names the first such
 * ray. `ETD_INVALID_OPERATION` before the first build. Everything is done on the calling thread, and any number of
 * threads may ask at once: share out large batches over your own. Thread-safe.
 */
etd_status etd_scene_intersect(const struct etd_scene *scene,
                               const struct etd_ray *rays,
                               size_t count,
                               struct etd_hit *hits);

/**
 * Finds for each of `count` rays whether anything is in its segment, in the scene as it was last built.
 *
 * `occluded`: one byte for each ray, 1 or 0. All else as for `etd_scene_intersect`. Thread-safe.
 */
etd_status etd_scene_occluded(const struct etd_scene *scene,
                              const struct etd_ray *rays,
                              size_t count,
                              uint8_t *occluded);

/**
 * Lays out all surfaces of a scene in one square light map; builds the scene first where it has changed.
 *
 * `options`: NULL for the defaults of `ETD_ATLAS_OPTIONS_INIT`. On `ETD_OK` `*out_atlas` is one reference; it keeps the scene as
 * it is now, and what is baked later is of that. The same scene gives the same layout. The log callback is told of meshes whose
 * own texture coordinates could not be used. Errors: `ETD_CANCELLED` if the progress callback stopped it; `ETD_INVALID_SCENE` for
 * a scene without a surface, options out of their range, charts that do not fit, and texture coordinates that are no layout where
 * these are asked for; `ETD_OUT_OF_MEMORY`; all that `etd_scene_commit` has. Thread-safe.
 */
etd_status etd_atlas_new(struct etd_scene *scene,
                         const struct etd_atlas_options *options,
                         struct etd_atlas **out_atlas);

/**
 * One more reference to an atlas. Thread-safe.
 */
etd_status etd_atlas_retain(struct etd_atlas *atlas);

/**
 * Gives back one reference to an atlas; NULL is fine. Thread-safe.
 */
void etd_atlas_release(struct etd_atlas *atlas);

/**
 * The first failure of a call on this atlas since this was last asked, and forgets it; `ETD_OK` if there was none.
 * `message`: where its message goes (at most `capacity` bytes with the zero byte), or NULL. Thread-safe.
 */
etd_status etd_atlas_status(struct etd_atlas *atlas, char *message, size_t capacity);

/**
 * How large an atlas is, and how many of everything it has. Thread-safe.
 */
etd_status etd_atlas_get_info(const struct etd_atlas *atlas, struct etd_atlas_info *out_info);

/**
 * Copies the vertices of an atlas, those of a surface together; one on the seam of two charts is there for each.
 *
 * `*out_needed`, unless NULL, is their number; `vertices` may be NULL to ask for that alone. `ETD_INVALID_ARGUMENT` for a capacity
 * below it. Thread-safe.
 */
etd_status etd_atlas_copy_vertices(const struct etd_atlas *atlas,
                                   struct etd_atlas_vertex *vertices,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Copies three vertex numbers for each triangle of an atlas, counter-clockwise seen from outside, those of a surface together and
 * in the order in which they were given. Triangles without an area are left out: `etd_atlas_copy_primitives` says which are there.
 *
 * `capacity` and `*out_needed` count numbers, three times the triangles. All else as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_indices(const struct etd_atlas *atlas,
                                  uint32_t *indices,
                                  size_t capacity,
                                  size_t *out_needed);

/**
 * Copies for each triangle of an atlas its number in its mesh as it was given; 0 or 1 for the half of a quad; running on other
 * shapes. All else as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_primitives(const struct etd_atlas *atlas,
                                     uint32_t *primitives,
                                     size_t capacity,
                                     size_t *out_needed);

/**
 * Copies what an atlas has of each surface, in the order of their numbers; removed surfaces and those without an area are missing.
 * All else as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_surfaces(const struct etd_atlas *atlas,
                                   struct etd_atlas_surface *surfaces,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Copies for each texel of an atlas the share that triangles cover, `[height][width]`, row 0 at v = 0; 0 for padding and for what
 * belongs to no chart. All else as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_coverage(const struct etd_atlas *atlas,
                                   float *coverage,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Bakes the light map of an atlas into the host's array: irradiance [W m^-2], seams padded.
 *
 * `options`: NULL for the scene's own settings. `ETD_INTEGRATOR_RADIOSITY` takes it from a radiosity solution (elements as small as
 * texels unless a size is given; no samples, NaN for standard errors), any other integrator means path tracing. Filter and
 * `finished` are not looked at, depth counts the texel as the first hit, and "pixels" are texels here. `target`: three floats for
 * each texel, `[height][width]`, row 0 at v = 0; with the standard error likewise, if it is asked for. `out_summary`: NULL, or
 * filled. Texels that no triangle covers have the values of the nearest one of their chart, and are 0 beyond the gutter.
 *
 * Returns when it is done. What is baked is the scene as it was when the atlas was made, and depends on atlas and options alone, not
 * on threads. Errors: `ETD_CANCELLED` if the progress callback stopped it: the arrays then hold what was done by paths, and what they
 * held before by radiosity; `ETD_INVALID_ARGUMENT` for a target that cannot hold the map; `ETD_OUT_OF_MEMORY` for a radiosity
 * solution beyond `radiosity_memory`. Thread-safe.
 */
etd_status etd_atlas_bake(struct etd_atlas *atlas,
                          const struct etd_render_options *options,
                          const struct etd_bake_target *target,
                          struct etd_summary *out_summary);

/**
 * Bakes the vertices of one surface into the host's array: irradiance [W m^-2]; builds the scene first where it has
 * changed.
 *
 * `surface`: number of the surface. `target`: three floats for each vertex; of a mesh for all its vertices in their order, of a
 * triangle or a quad for the corners. A vertex has the mean irradiance of the part of the surface that is nearest to it (of each
 * triangle around it a third); one of no triangle has 0. `target->row_stride` is not looked at. All else as for
 * `etd_atlas_bake`. Errors: `ETD_INVALID_ARGUMENT` for a number of no surface with vertices of its own, be it removed, and for a
 * target that cannot hold them. Thread-safe.
 */
etd_status etd_scene_bake_vertices(struct etd_scene *scene,
                                   uint32_t surface,
                                   const struct etd_render_options *options,
                                   const struct etd_bake_target *target,
                                   struct etd_summary *out_summary);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ETENDUE_H */
