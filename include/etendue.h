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
#define ETD_DEVICE_OPTIONS_INIT {sizeof(etd_device_options), 0, ETD_LOG_ALL, 0, NULL, NULL, NULL, NULL}
#define ETD_SCENE_OPTIONS_INIT {sizeof(etd_scene_options), ETD_USAGE_STATIC, 0, NULL, NULL, NULL, NULL}
#define ETD_CAMERA_INIT \
    {sizeof(etd_camera), ETD_CAMERA_PERSPECTIVE, ETD_FOV_HORIZONTAL, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90, 0, 0, \
     ETD_FOCUS_LOOK_AT, 0, 0, {0, 0, 0}, 0, 0, {0, 0}, 0}
#define ETD_MATERIAL_INIT \
    {sizeof(etd_material), ETD_BSDF_LAMBERT, {0.5f, 0.5f, 0.5f}, 0, 0, 1.5f, 1, 0, 0, {0, 0, 0}, 0, 0, 0, \
     ETD_DISTRIBUTION_GGX, ETD_MASKING_SMITH, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}, 0, 0, 0.5f, NULL, 1, \
     {0, 0, 0}, 0, {0, 0, 0, 0}, {0, 0, 0, 0}, 0, 0, 0}
#define ETD_PRINCIPLED_INIT \
    {sizeof(etd_principled), 1, {0.8f, 0.8f, 0.8f}, 0, 0, 1, {1, 1, 1}, 0.3f, 0, 0, 1.5f, 0, {1, 1, 1}, 0, {1, 1, 1}, 0, 0, \
     1.6f, 1, 0, {1, 1, 1}, 0.5f, 0, 0, 0}
#define ETD_MESH_INIT \
    {sizeof(etd_mesh), NULL, 0, 0, 0, NULL, 0, 0, NULL, 0, NULL, 0, ETD_POSITION_FLOAT3, ETD_COPY, NULL, NULL, NULL, \
     NULL, 0, NULL, 0, 0, NULL, 0}
#define ETD_SHAPE_INIT \
    {sizeof(etd_shape), ETD_SHAPE_NONE, ETD_NONE, 0, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, \
     {0, 0, 0}, {0, 0, 0}, 0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}}
#define ETD_MESH_INFO_INIT {sizeof(etd_mesh_info), 0, 0, 0, 0}
#define ETD_TEXTURE_INIT \
    {sizeof(etd_texture), ETD_TEXTURE_IMAGE, ETD_COLOR_SPACE_BY_USE, NULL, NULL, 0, 0, 0, 0, ETD_TEXEL_UINT8, ETD_COPY, \
     ETD_TEXTURE_FILTER_BILINEAR, NULL, NULL, ETD_WRAP_REPEAT, ETD_WRAP_REPEAT, {{0, 0, 0}, {1, 1, 1}}, 0.1f, 1, 4, \
     ETD_COORDINATES_UV, {1, 1, 1}, 0, {0, 0, 0}, 0, 0}
#define ETD_TEXTURE_BINDING_INIT {sizeof(etd_texture_binding), ETD_NONE, ETD_CHANNEL_DEFAULT, 1, 0}
#define ETD_ENVIRONMENT_MAP_INIT {sizeof(etd_environment_map), ETD_NONE, ETD_SKY_LATLONG, {1, 1, 1}, 0, {0, 1, 0}, 0}
#define ETD_BACKPLATE_INIT {sizeof(etd_backplate), ETD_NONE, {1, 1, 1}}
#define ETD_DISTANT_LIGHT_INIT {sizeof(etd_distant_light), {0, 1, 0}, {1, 1, 1}, 0, 0}
#define ETD_SKY_INIT {sizeof(etd_sky), 12, 0, {1, 1, 1}, {0, 0, 0}, 0, 0, {0, 1, 0}, {0, 1, 0}, {0, 0, 0, 0, 0}, 0, 0.533, 0, 0}
#define ETD_SPOT_LIGHT_INIT {sizeof(etd_spot_light), {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 45, 0}
#define ETD_WEB_LIGHT_INIT \
    {sizeof(etd_web_light), NULL, NULL, 0, {0, 0, 0}, {0, -1, 0}, {1, 0, 0}, {1, 1, 1}, 0}
#define ETD_SURFACE_WEB_INIT {sizeof(etd_surface_web), NULL, NULL, 0, {1, 0, 0}, 0}
#define ETD_SPECTRUM_INIT {sizeof(etd_spectrum), ETD_SPECTRUM_SAMPLES, ETD_ILLUMINANT_A, 0, NULL, 0}
#define ETD_SHUTTER_INIT {sizeof(etd_shutter), 0, 0, NULL, 0}
#define ETD_MOTION_KEY_INIT \
    {0, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}, 0, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}
#define ETD_SURFACE_INIT {sizeof(etd_surface), ETD_NONE, {0, 0, 0}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 0}
#define ETD_RENDER_OPTIONS_INIT \
    {sizeof(etd_render_options), ETD_INTEGRATOR_PATH, ETD_SAMPLER_SOBOL, ETD_FILTER_BOX, {0, 0}, 64, 0, 1, 0, 0, 0, \
     NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_PHOTON_KERNEL_DEFAULT, 0, ETD_PHOTON_SHARING_POWER, \
     ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, 0, 0, ETD_CACHE_SOURCE_PATHS, ETD_SWITCH_DEFAULT, ETD_ERROR_RELMSE, ETD_SWITCH_DEFAULT, \
     0, 0, 0, 0, ETD_RADIOSITY_SOLVER_GATHER, ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, \
     ETD_ROULETTE_OWN, 0, 0, 0, 0, {0, 0}, {0, 0}, ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, 0, NULL, 0, NULL, \
     0, ETD_SWITCH_DEFAULT}
#define ETD_PROGRESS_INIT {sizeof(etd_progress), 0, 0, 0, 0, 0, ETD_PHASE_BUILD, 0}
#define ETD_SUMMARY_INIT {sizeof(etd_summary), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_ENDED_SAMPLES, ETD_INTEGRATOR_PATH}
#define ETD_FILM_OPTIONS_INIT {sizeof(etd_film_options), 0, 0, 0, 0}
#define ETD_MAP_INIT {sizeof(etd_map), NULL, 0, 0, 0, 0, 0}
#define ETD_IMAGE_OPTIONS_INIT {sizeof(etd_image_options), ETD_FORMAT_FLOAT, ETD_TONE_MAP_CLAMP, 0, 0, NULL, ETD_PRIMARIES_REC709, 0}
#define ETD_ATLAS_OPTIONS_INIT {sizeof(etd_atlas_options), 0, 0, 0, 0, ETD_ATLAS_LAYOUT_AUTO, 0, 0, NULL, NULL}
#define ETD_ATLAS_INFO_INIT {sizeof(etd_atlas_info), 0, 0, 0, 0, 0, 0, 0, 0}
#define ETD_BAKE_TARGET_INIT {sizeof(etd_bake_target), NULL, NULL, 0, 0, 0, ETD_SIDE_FRONT, 0}
#define ETD_RAY_QUERY_INIT \
    {sizeof(etd_ray_query), 0, 0, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, \
     NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0}
#define ETD_DEVICE_INFO_INIT {sizeof(etd_device_info), 0, 0, 0, 0, NULL, 0}
#define ETD_SCENE_INFO_INIT {sizeof(etd_scene_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, 0, 0, 0}


/**
 * The result of a call. Values are grouped by the cause of the error. A value never changes its meaning.
 */
enum etd_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The call succeeded.
     */
    ETD_OK = 0,
    /**
     * Not an error: the task is still running.
     */
    ETD_RUNNING = 1,
    /**
     * An argument is NULL, out of its range, not finite, or the number of no element. The call changed nothing.
     */
    ETD_INVALID_ARGUMENT = 100,
    /**
     * The pointer is a handle of another kind than was expected, or points to readable memory that is no handle. A handle
     * whose last reference was released is not recognised: to pass it is undefined behaviour, as for any freed memory. There
     * is one exception: while the last reference to a task is being released, the task still exists, and calls with its
     * handle in the task's callbacks are refused with this status.
     */
    ETD_INVALID_HANDLE = 101,
    /**
     * The call does not fit the state of the object: a film that is being rendered to, a scene that was not built, a
     * callback that waits for the very work that called it.
     */
    ETD_INVALID_OPERATION = 102,
    /**
     * The scene holds a value that cannot be rendered; the message names file, line and JSON path. Or the saved film is none, or damaged.
     */
    ETD_INVALID_SCENE = 200,
    /**
     * The request is valid, but this version does not support it.
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
     * There is not enough memory, or the device's memory limit was reached.
     */
    ETD_OUT_OF_MEMORY = 301,
    /**
     * The work was cancelled, by `etd_task_cancel` or by a callback.
     */
    ETD_CANCELLED = 400,
    /**
     * A fault in this library; please report it.
     */
    ETD_INTERNAL = 500,
    /**
     * The library panicked, which is a fault in it; please report it. The process may continue. The objects of the call can
     * only be released from now on.
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
 * The importance of a message.
 */
enum etd_log_level
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * A warning for the user, such as about parts of a file that are ignored, or about a bias.
     */
    ETD_LOG_WARNING = 0,
    /**
     * Information about decisions and their durations.
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
 * A phase of work.
 */
enum etd_phase
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The scene is being read or built, or a light map is being laid out.
     */
    ETD_PHASE_BUILD = 0,
    /**
     * Samples are being taken.
     */
    ETD_PHASE_RENDER = 1,
    /**
     * The work has ended.
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
 * The reason why a render ended.
 */
enum etd_ended
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Every pixel has all its samples.
     */
    ETD_ENDED_SAMPLES = 0,
    /**
     * The time limit was reached.
     */
    ETD_ENDED_TIME = 1,
    /**
     * The target error was reached.
     */
    ETD_ENDED_ERROR = 2,
    /**
     * The render was cancelled.
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
 * How the geometry of a scene is stored.
 */
enum etd_usage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * All geometry is in one hierarchy where possible, which is fastest to trace. At the first change of geometry after a
     * build, the scene becomes dynamic.
     */
    ETD_USAGE_STATIC = 0,
    /**
     * Every larger mesh has a hierarchy of its own, and so have single triangles and single shapes where they are many, so that the others
     * are not rebuilt when a surface is added, moved or removed.
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
 * The projection of a camera.
 */
enum etd_camera_type
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * A pinhole at `origin`, or a thin lens around it.
     */
    ETD_CAMERA_PERSPECTIVE = 0,
    /**
     * The report's camera: `origin` is the centre of a view plane, the eye lies behind it, and the length of `up` scales
     * the plane.
     */
    ETD_CAMERA_VIEW_PLANE = 1,
    /**
     * Parallel rays from the plane through `origin`; what is behind the plane is not seen.
     */
    ETD_CAMERA_ORTHOGRAPHIC = 2,
    /**
     * All directions: longitude across the width, latitude across the height. `fov_deg` is not read.
     */
    ETD_CAMERA_SPHERICAL = 3,
    /**
     * The mantle of an upright cylinder around the eye: `fov_deg` in (0, 360] across the width, and as high as pixels that are square
     * at the horizon make it.
     */
    ETD_CAMERA_CYLINDRICAL = 4,
    /**
     * A circle by the equisolid projection, black beyond: `fov_deg` in (0, 360] across the circle, which spans `fov_axis`.
     */
    ETD_CAMERA_FISHEYE = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_camera_type etd_camera_type;
#else
typedef uint32_t etd_camera_type;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The side of the image that a camera's field of view spans, or the `size` of an orthographic one.
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
     * The height; perspective and orthographic cameras only.
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
 * Where the lens of a camera is in focus.
 */
enum etd_focus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * On the plane through `look_at` across the view direction.
     */
    ETD_FOCUS_LOOK_AT = 0,
    /**
     * On the plane at `focus_distance` from `origin`.
     */
    ETD_FOCUS_DISTANCE = 1,
    /**
     * On the plane through `focus_at`.
     */
    ETD_FOCUS_POINT = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_focus etd_focus;
#else
typedef uint32_t etd_focus;
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
     * A surface that absorbs all light.
     */
    ETD_BSDF_BLACK = 0,
    /**
     * Lambert's model, with `color`.
     */
    ETD_BSDF_LAMBERT = 1,
    /**
     * Fujii's improved Oren-Nayar model, with `color` and `roughness`.
     */
    ETD_BSDF_OREN_NAYAR = 2,
    /**
     * Oren and Nayar's qualitative model, with `color` and `sigma_deg`.
     */
    ETD_BSDF_OREN_NAYAR_QUALITATIVE = 3,
    /**
     * A perfect mirror, with `color`.
     */
    ETD_BSDF_MIRROR = 4,
    /**
     * A smooth dielectric such as clear glass, with `ior` and `exterior_ior`.
     */
    ETD_BSDF_DIELECTRIC = 5,
    /**
     * Portsmouth, Kutz and Hill's energy-preserving rough diffuse model (EON), with `color` and `roughness`.
     */
    ETD_BSDF_EON = 6,
    /**
     * A thin sheet that scatters light diffusely on both sides: `color` is the share that it reflects and `transmittance` the
     * share that it transmits. Both sum to 1 at most per channel.
     */
    ETD_BSDF_DIFFUSE_TRANSMISSION = 7,
    /**
     * Fibres that stand up from a surface (Estevez and Kulla 2017), with `color` and `roughness`. A roughness of 0 means 0.5.
     */
    ETD_BSDF_SHEEN = 8,
    /**
     * A metal, smooth or rough: `eta` and `k`, or `color` and `edge_tint`, and the facets.
     */
    ETD_BSDF_CONDUCTOR = 9,
    /**
     * A rough dielectric such as frosted glass, with `ior`, `exterior_ior` and the facets.
     */
    ETD_BSDF_ROUGH_DIELECTRIC = 10,
    /**
     * A thin sheet of clear or tinted glass, smooth or rough, with `ior`, `exterior_ior`, `transmittance` and the facets.
     */
    ETD_BSDF_THIN_DIELECTRIC = 11,
    /**
     * A diffuse surface of albedo `color` under a clear coat, such as plastic, with `ior` and `exterior_ior` of the coat and
     * the coat's facets. `single_scattering` is ignored.
     */
    ETD_BSDF_COATED_DIFFUSE = 12,
    /**
     * One model with the parameters of OpenPBR, which are in `principled`.
     */
    ETD_BSDF_PRINCIPLED = 13,
    /**
     * A sum of the materials `first` and `second`, with `weight`.
     */
    ETD_BSDF_MIX = 14,
    /**
     * The material `first` on the normal's side of a surface and `second` on the other side. Neither may transmit light.
     */
    ETD_BSDF_TWO_SIDED = 15,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_bsdf etd_bsdf;
#else
typedef uint32_t etd_bsdf;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How the slopes of facets are distributed.
 */
enum etd_distribution
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Trowbridge and Reitz's distribution (GGX), which has long tails.
     */
    ETD_DISTRIBUTION_GGX = 0,
    /**
     * Beckmann's: a normal distribution of slopes.
     */
    ETD_DISTRIBUTION_BECKMANN = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_distribution etd_distribution;
#else
typedef uint32_t etd_distribution;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Which facets hide others.
 */
enum etd_masking
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Smith's, correlated by height.
     */
    ETD_MASKING_SMITH = 0,
    /**
     * Smith's, for the two directions apart.
     */
    ETD_MASKING_SMITH_SEPARABLE = 1,
    /**
     * Torrance and Sparrow's long symmetric grooves. Light that they scatter more than once is left out.
     */
    ETD_MASKING_V_CAVITY = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_masking etd_masking;
#else
typedef uint32_t etd_masking;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The format of an array of positions.
 */
enum etd_position_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Three values of type `float`.
     */
    ETD_POSITION_FLOAT3 = 0,
    /**
     * Three values of type `double`, which are always copied.
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
 * Whether the arrays of a mesh are copied or shared.
 */
enum etd_sharing
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The arrays are copied during the call.
     */
    ETD_COPY = 0,
    /**
     * The arrays are read in place. They must neither change nor be freed until `release` is called. Positions must be of type
     * `float`, and 16 bytes must be readable from the last position on. A mesh that emits light is copied when it is built.
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
 * The positions of the samples of a pixel.
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
 * The pixel filter, which weighs the samples of a pixel.
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
     * Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds; the irradiance cache where a bias is allowed.
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
 * The weight of a photon as a function of its distance d from the point of a density estimate, within the radius r.
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
     * The same weight for all photons.
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
 * How the photons are divided between the emitters.
 */
enum etd_photon_sharing
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Photons are divided by the emitters' power, so that all photons carry nearly the same power.
     */
    ETD_PHOTON_SHARING_POWER = 0,
    /**
     * Photons are divided by the emitters' area, as in the report. Point lights have no area.
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
 * The source of the light that the gather rays of an irradiance cache find.
 */
enum etd_cache_source
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Gather rays continue as paths. The only bias is that of the interpolation.
     */
    ETD_CACHE_SOURCE_PATHS = 0,
    /**
     * Gather rays read the global photon map. This is faster and has the bias of the map.
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
     * In each iteration, every element gathers light from all others.
     */
    ETD_RADIOSITY_SOLVER_GATHER = 0,
    /**
     * In each step, the patch with most unshot light distributes it: progressive refinement (Cohen et al. 1988).
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
 * A setting that is on, off, or left to its default.
 */
enum etd_switch
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The default of the field.
     */
    ETD_SWITCH_DEFAULT = 0,
    /**
     * On.
     */
    ETD_SWITCH_ON = 1,
    /**
     * Off.
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
 * The survival probability by which Russian roulette ends paths. The choice changes noise and time, never the expected image.
 */
enum etd_roulette
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The library's own probability: a path survives in proportion to the throughput that it still carries.
     */
    ETD_ROULETTE_OWN = 0,
    /**
     * The probability that the material states (`reflectionRate` in files, `etd_material.survival`). At materials that state
     * none, the library's own probability is used.
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
 * A measure of the error of an image.
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
     * Error of displayed values: root of the mean squared error in levels of 255, after clamping to [0, 1] and the sRGB curve.
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
 * Which messages a log callback receives.
 */
enum etd_log_choice
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * All messages.
     */
    ETD_LOG_ALL = 0,
    /**
     * Warnings alone.
     */
    ETD_LOG_WARNINGS_ONLY = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_log_choice etd_log_choice;
#else
typedef uint32_t etd_log_choice;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A layer of a film. The values are bits, whose combination names the layers that a film keeps.
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
     * Albedo at the first hit, in [0, 1]: 3 channels; 0 where rays hit nothing.
     */
    ETD_LAYER_ALBEDO = 2,
    /**
     * Shading normal at the first hit, towards the camera, in world axes: 3 channels. It is a mean over samples, and thus not of
     * unit length at edges; 0 where rays hit nothing.
     */
    ETD_LAYER_NORMAL = 4,
    /**
     * Distance of the first hit from the eye along the view direction: 1 channel; infinite where rays hit nothing.
     */
    ETD_LAYER_DEPTH = 8,
    /**
     * Number of the pixel's samples: 1 channel.
     */
    ETD_LAYER_SAMPLES = 16,
    /**
     * Variance of the pixel's mean: 3 channels; NaN while there are too few samples for an estimate.
     */
    ETD_LAYER_VARIANCE = 32,
    /**
     * Standard error of the pixel's mean, which is the square root of the variance: 3 channels.
     */
    ETD_LAYER_STANDARD_ERROR = 64,
    /**
     * Alpha in the colour layer: the fraction of samples that hit a surface. Without this bit, alpha is 1. It is not an image of
     * its own.
     */
    ETD_LAYER_ALPHA = 128,
    /**
     * Estimated bias of the pixel's mean by photon maps, the excess over the true value: 3 channels. With maps that are built
     * once (photon, photon_direct, irradiance_cache), only the bias of caustics is included. It is 0 without maps.
     */
    ETD_LAYER_BIAS = 256,
    /**
     * Light that emitters send to the camera without being scattered on its way, [W m^-2 sr^-1]: 3 channels. The sum of this layer and
     * the next two is the colour. Only the integrators path and direct, and auto, which is path for such a film, count how often light
     * is scattered: a render by another one ends with `ETD_UNSUPPORTED`. Its pixels share no hits, and it has no light paths.
     */
    ETD_LAYER_EMISSION = 512,
    /**
     * Light that was scattered once, by the surface that the camera sees, [W m^-2 sr^-1]: 3 channels. Mirrors and glass scatter, too.
     */
    ETD_LAYER_DIRECT = 1024,
    /**
     * Light that was scattered more than once, [W m^-2 sr^-1]: 3 channels. Like the colour, parts may be below 0 with wavelengths and with
     * filters that are; where there is no indirect light, rounding may leave some that is hardly any.
     */
    ETD_LAYER_INDIRECT = 2048,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_layer etd_layer;
#else
typedef uint32_t etd_layer;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The format of pixels in the host's memory.
 */
enum etd_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * One float for each channel of the layer.
     */
    ETD_FORMAT_FLOAT = 0,
    /**
     * Three floats; for the colour only.
     */
    ETD_FORMAT_RGB_FLOAT = 1,
    /**
     * Three bytes, sRGB; for the colour only.
     */
    ETD_FORMAT_RGB8 = 2,
    /**
     * Four bytes, sRGB with linear alpha; for the colour only.
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
 * The tone map, from radiance to displayed values.
 */
enum etd_tone_map
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Clamps to [0, 1]: radiance of 1 and more is white.
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
     * Information about what was built and decided, one line for each item.
     */
    ETD_TEXT_INFO = 0,
    /**
     * Warnings from reading and building, one line for each.
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
 * The source of a mesh's layout in a light map.
 */
enum etd_atlas_layout
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The mesh's own texture coordinates where they can be a layout: in [0, 1], without overlaps, and with an area for every
     * triangle. Other meshes get charts, and the log callback receives a warning for each mesh with unsuitable coordinates.
     */
    ETD_ATLAS_LAYOUT_AUTO = 0,
    /**
     * Charts for all meshes; texture coordinates are ignored.
     */
    ETD_ATLAS_LAYOUT_CHARTS = 1,
    /**
     * The mesh's own texture coordinates. It is an error if they cannot be a layout.
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
     * The side of the normal.
     */
    ETD_SIDE_FRONT = 0,
    /**
     * The side opposite to the normal.
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
 * What a surface is.
 */
enum etd_shape_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nothing: the surface was removed.
     */
    ETD_SHAPE_NONE = 0,
    /**
     * A triangle.
     */
    ETD_SHAPE_TRIANGLE = 1,
    /**
     * A flat convex quadrilateral.
     */
    ETD_SHAPE_QUAD = 2,
    /**
     * A mesh.
     */
    ETD_SHAPE_MESH = 3,
    /**
     * A sphere, or an ellipsoid by its transform.
     */
    ETD_SHAPE_SPHERE = 4,
    /**
     * A flat round disk.
     */
    ETD_SHAPE_DISK = 5,
    /**
     * A part of a quadric: also a cylinder, a cone and a paraboloid.
     */
    ETD_SHAPE_QUADRIC = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_shape_kind etd_shape_kind;
#else
typedef uint32_t etd_shape_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What a texture shows.
 */
enum etd_texture_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * An image, from a file or from memory.
     */
    ETD_TEXTURE_IMAGE = 0,
    /**
     * Squares (cubes in space) of side 1, in turns.
     */
    ETD_TEXTURE_CHECKER = 1,
    /**
     * Lines of the second colour along the edges of squares of side 1.
     */
    ETD_TEXTURE_GRID = 2,
    /**
     * From the first colour at 0 to the second at 1 along the first coordinate.
     */
    ETD_TEXTURE_GRADIENT = 3,
    /**
     * Perlin's noise, summed over octaves.
     */
    ETD_TEXTURE_NOISE = 4,
    /**
     * Its magnitude, summed over octaves.
     */
    ETD_TEXTURE_TURBULENCE = 5,
    /**
     * Veins across the first coordinate.
     */
    ETD_TEXTURE_MARBLE = 6,
    /**
     * Rings around the second axis of space.
     */
    ETD_TEXTURE_WOOD = 7,
    /**
     * White and opaque, times the colours of the vertices of meshes (`etd_mesh.colors`).
     */
    ETD_TEXTURE_VERTEX_COLORS = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_texture_kind etd_texture_kind;
#else
typedef uint32_t etd_texture_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The number format of texels.
 */
enum etd_texel_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * `uint8_t`; 255 is 1.
     */
    ETD_TEXEL_UINT8 = 0,
    /**
     * `uint16_t`; 65535 is 1.
     */
    ETD_TEXEL_UINT16 = 1,
    /**
     * Half precision (IEEE 754 binary16), 2 bytes.
     */
    ETD_TEXEL_HALF = 2,
    /**
     * `float`.
     */
    ETD_TEXEL_FLOAT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_texel_format etd_texel_format;
#else
typedef uint32_t etd_texel_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the numbers of an image mean.
 */
enum etd_color_space
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * For colours, sRGB where texels are integers and linear light where they are floating-point numbers; for all else,
     * numbers as they are.
     */
    ETD_COLOR_SPACE_BY_USE = 0,
    /**
     * Colours with the curve of sRGB. Opacity is linear.
     */
    ETD_COLOR_SPACE_SRGB = 1,
    /**
     * Colours in linear light.
     */
    ETD_COLOR_SPACE_LINEAR = 2,
    /**
     * No colours, but numbers as they are.
     */
    ETD_COLOR_SPACE_RAW = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_color_space etd_color_space;
#else
typedef uint32_t etd_color_space;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What lies beyond the edges of an image.
 */
enum etd_wrap
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The image again.
     */
    ETD_WRAP_REPEAT = 0,
    /**
     * The image in a mirror.
     */
    ETD_WRAP_MIRROR = 1,
    /**
     * The texels of the edge.
     */
    ETD_WRAP_CLAMP = 2,
    /**
     * Black, without opacity.
     */
    ETD_WRAP_BLACK = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_wrap etd_wrap;
#else
typedef uint32_t etd_wrap;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Where a texture lies.
 */
enum etd_coordinates
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * On the surface, by its texture coordinates.
     */
    ETD_COORDINATES_UV = 0,
    /**
     * In world space; patterns only.
     */
    ETD_COORDINATES_SPACE = 1,
    /**
     * On the surface, by the world's coordinates from the side of a box that the face looks to, in scene units.
     */
    ETD_COORDINATES_BOX = 2,
    /**
     * On the surface, by the world's coordinates along the x axis: u is -z, v is y.
     */
    ETD_COORDINATES_PLANAR_X = 3,
    /**
     * On the surface, by the world's coordinates from above: u is x, v is -z.
     */
    ETD_COORDINATES_PLANAR_Y = 4,
    /**
     * On the surface, by the world's coordinates along the z axis: u is x, v is y.
     */
    ETD_COORDINATES_PLANAR_Z = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_coordinates etd_coordinates;
#else
typedef uint32_t etd_coordinates;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How an image is filtered.
 */
enum etd_texture_filter
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Linear between the four nearest texels: no bias.
     */
    ETD_TEXTURE_FILTER_BILINEAR = 0,
    /**
     * The nearest texel.
     */
    ETD_TEXTURE_FILTER_NEAREST = 1,
    /**
     * Smaller images for smaller pixels; blurs.
     */
    ETD_TEXTURE_FILTER_MIP = 2,
    /**
     * A Gaussian over the ellipse that a pixel covers.
     */
    ETD_TEXTURE_FILTER_EWA = 3,
    /**
     * One texel drawn from that Gaussian.
     */
    ETD_TEXTURE_FILTER_STOCHASTIC = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_texture_filter etd_texture_filter;
#else
typedef uint32_t etd_texture_filter;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Which number of a texture a parameter takes.
 */
enum etd_texture_channel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Colours take red, green and blue; an opacity takes the texture's opacity if it has one; other numbers take red.
     */
    ETD_CHANNEL_DEFAULT = 0,
    /**
     * Red.
     */
    ETD_CHANNEL_RED = 1,
    /**
     * Green.
     */
    ETD_CHANNEL_GREEN = 2,
    /**
     * Blue.
     */
    ETD_CHANNEL_BLUE = 3,
    /**
     * Opacity.
     */
    ETD_CHANNEL_ALPHA = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_texture_channel etd_texture_channel;
#else
typedef uint32_t etd_texture_channel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How the directions of a sky lie in an image, whose own frame has y up.
 */
enum etd_sky_projection
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * By longitude and latitude: seen from within, the middle of the image is towards -z, its right half towards +x and its upper
     * edge around +y.
     */
    ETD_SKY_LATLONG = 0,
    /**
     * The faces of an octahedron in a square image: +y in the middle, -y at the four corners, +x in the middle of the right edge
     * and -z in that of the upper edge.
     */
    ETD_SKY_OCTAHEDRAL = 1,
    /**
     * Six squares one under another: the faces +x, -x, +y, -y, +z and -z of a cube, each as OpenGL, Vulkan and Direct3D have it.
     */
    ETD_SKY_CUBE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_sky_projection etd_sky_projection;
#else
typedef uint32_t etd_sky_projection;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What is measured at a point.
 */
enum etd_quantity
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Illuminance, lx, of a small plane, whose normal is the direction.
     */
    ETD_QUANTITY_ILLUMINANCE = 0,
    /**
     * Luminance [cd m^-2] of what is seen from the point in the direction.
     */
    ETD_QUANTITY_LUMINANCE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_quantity etd_quantity;
#else
typedef uint32_t etd_quantity;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What the names of mattes are of.
 */
enum etd_matte_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Objects: surfaces by their names, or by their JSON paths, such as `surfaces[3]`, where they have none.
     */
    ETD_MATTE_OBJECT = 0,
    /**
     * Materials: by their names, or by their JSON paths. A surface without a material is not seen.
     */
    ETD_MATTE_MATERIAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_matte_kind etd_matte_kind;
#else
typedef uint32_t etd_matte_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What says how a spectrum is.
 */
enum etd_spectrum_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Samples of wavelength and value.
     */
    ETD_SPECTRUM_SAMPLES = 0,
    /**
     * An illuminant of the CIE.
     */
    ETD_SPECTRUM_ILLUMINANT = 1,
    /**
     * A phase of daylight by its temperature.
     */
    ETD_SPECTRUM_DAYLIGHT = 2,
    /**
     * A black body by its temperature.
     */
    ETD_SPECTRUM_BLACK_BODY = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_spectrum_kind etd_spectrum_kind;
#else
typedef uint32_t etd_spectrum_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Illuminants of CIE 015:2018 and, of fluorescent lamps, CIE 15:2004.
 */
enum etd_illuminant
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Tungsten.
     */
    ETD_ILLUMINANT_A = 0,
    /**
     * Daylight of about 5003 K.
     */
    ETD_ILLUMINANT_D50 = 1,
    /**
     * Daylight of about 5503 K.
     */
    ETD_ILLUMINANT_D55 = 2,
    /**
     * Daylight of about 6504 K, the white of Rec. 709.
     */
    ETD_ILLUMINANT_D65 = 3,
    /**
     * Daylight of about 7504 K.
     */
    ETD_ILLUMINANT_D75 = 4,
    /**
     * The same power at all wavelengths.
     */
    ETD_ILLUMINANT_E = 5,
    /**
     * A fluorescent lamp of about 6430 K, of a broad band.
     */
    ETD_ILLUMINANT_FL1 = 6,
    /**
     * A fluorescent lamp of about 4230 K, of a broad band.
     */
    ETD_ILLUMINANT_FL2 = 7,
    /**
     * A fluorescent lamp of about 3450 K, of a broad band.
     */
    ETD_ILLUMINANT_FL3 = 8,
    /**
     * A fluorescent lamp of about 2940 K, of a broad band.
     */
    ETD_ILLUMINANT_FL4 = 9,
    /**
     * A fluorescent lamp of about 6350 K, of a broad band.
     */
    ETD_ILLUMINANT_FL5 = 10,
    /**
     * A fluorescent lamp of about 4150 K, of a broad band.
     */
    ETD_ILLUMINANT_FL6 = 11,
    /**
     * A fluorescent lamp of about 6500 K, of several bands.
     */
    ETD_ILLUMINANT_FL7 = 12,
    /**
     * A fluorescent lamp of about 5000 K, of several bands.
     */
    ETD_ILLUMINANT_FL8 = 13,
    /**
     * A fluorescent lamp of about 4150 K, of several bands.
     */
    ETD_ILLUMINANT_FL9 = 14,
    /**
     * A fluorescent lamp of about 5000 K, of three narrow bands.
     */
    ETD_ILLUMINANT_FL10 = 15,
    /**
     * A fluorescent lamp of about 4000 K, of three narrow bands.
     */
    ETD_ILLUMINANT_FL11 = 16,
    /**
     * A fluorescent lamp of about 3000 K, of three narrow bands.
     */
    ETD_ILLUMINANT_FL12 = 17,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_illuminant etd_illuminant;
#else
typedef uint32_t etd_illuminant;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What can have a spectrum of its own.
 */
enum etd_spectrum_target
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The emission of a surface.
     */
    ETD_SPECTRUM_OF_SURFACE = 0,
    /**
     * A point light of any kind.
     */
    ETD_SPECTRUM_OF_POINT_LIGHT = 1,
    /**
     * A distant light.
     */
    ETD_SPECTRUM_OF_DISTANT_LIGHT = 2,
    /**
     * The environment, whose number is 0, unless it is a sky by a formula.
     */
    ETD_SPECTRUM_OF_ENVIRONMENT = 3,
    /**
     * Of a material: what a diffuse or reflective one, fibres or a sheet that transmits diffusely reflect, in [0, 1].
     */
    ETD_SPECTRUM_OF_COLOR = 4,
    /**
     * Of a material: what a sheet that transmits diffusely lets through, in [0, 1].
     */
    ETD_SPECTRUM_OF_TRANSMITTANCE = 5,
    /**
     * Of a material: what a conductor reflects at normal incidence, in [0, 1].
     */
    ETD_SPECTRUM_OF_REFLECTANCE = 6,
    /**
     * Of a material: index of refraction of a conductor, above 0.
     */
    ETD_SPECTRUM_OF_ETA = 7,
    /**
     * Of a material: extinction coefficient of a conductor.
     */
    ETD_SPECTRUM_OF_K = 8,
    /**
     * Of a material: absorption coefficient inside a refractive body [1 / scene unit].
     */
    ETD_SPECTRUM_OF_ABSORPTION = 9,
    /**
     * Of a material: emitted radiance.
     */
    ETD_SPECTRUM_OF_EMISSION = 10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_spectrum_target etd_spectrum_target;
#else
typedef uint32_t etd_spectrum_target;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The primaries of linear colours in a file.
 */
enum etd_primaries
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Rec. 709, white D65.
     */
    ETD_PRIMARIES_REC709 = 0,
    /**
     * Rec. 2020, white D65.
     */
    ETD_PRIMARIES_REC2020 = 1,
    /**
     * ACEScg, to whose white colours are adapted from D65.
     */
    ETD_PRIMARIES_ACESCG = 2,
    /**
     * Tristimulus values of CIE 1931; Y is the luminance.
     */
    ETD_PRIMARIES_XYZ = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum etd_primaries etd_primaries;
#else
typedef uint32_t etd_primaries;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The layout of a light map, and the scene for which it was made.
 */
typedef struct etd_atlas etd_atlas;

/**
 * A device: threads, a memory limit, and the functions that receive messages. Devices are independent of each other.
 */
typedef struct etd_device etd_device;

/**
 * A film: its resolution, its layers and its newest image.
 */
typedef struct etd_film etd_film;

/**
 * A scene: its description by the host, and the scene that was last built from it.
 */
typedef struct etd_scene etd_scene;

/**
 * A started render.
 */
typedef struct etd_task etd_task;

/**
 * The last error of a thread: why its last failing call failed.
 */
typedef struct etd_error {
    /**
     * `sizeof(etd_error)`, set by the caller (`ETD_ERROR_INIT`).
     */
    size_t struct_size;
    /**
     * The status that the call returned.
     */
    etd_status status;
    /**
     * Line in `file`, counted from 1; 0 if it is not known.
     */
    uint32_t line;
    /**
     * The whole message, which begins with file, line and JSON path. UTF-8, never NULL. This pointer and the two below are
     * valid until the next failing call on this thread.
     */
    const char *message;
    /**
     * The file that the error is about; empty if it is about no file.
     */
    const char *file;
    /**
     * JSON path such as `surfaces[3].radius`, also for scenes that calls describe; empty if there is none.
     */
    const char *json_path;
} etd_error;

/**
 * A log callback, which receives warnings and information. `message` is UTF-8 and valid during the call.
 *
 * Any thread may call it, and several threads may call it at the same time. It must not unwind (throw). It may make any call
 * that does not wait for the work that called it.
 */
typedef void (*etd_log_fn)(void *user_data, etd_log_level level, const char *message);

/**
 * An error callback, which receives every failing call on an object of the device, on the thread of the call and before the
 * call returns. The rules of `etd_log_fn` apply. Calls that fail inside the callback are not reported.
 */
typedef void (*etd_error_fn)(void *user_data, etd_status status, const char *message);

/**
 * A job for the host's executor. The host calls it once with its argument, on any thread and at any time. A job that is called
 * after everything was released does nothing.
 */
typedef void (*etd_work_fn)(void *argument);

/**
 * A function of the host that submits a job to the host's executor, and returns without waiting for the job.
 *
 * The thread of a render calls it, once for each helper and pass, and as often for other work that threads share, such as the
 * estimate of errors at the end. The host must call `work(argument)` exactly once. The job may run late or on the calling
 * thread. The function must not unwind.
 */
typedef void (*etd_submit_fn)(void *user_data, etd_work_fn work, void *argument);

/**
 * Options of a device.
 */
typedef struct etd_device_options {
    /**
     * `sizeof(etd_device_options)`.
     */
    size_t struct_size;
    /**
     * Number of threads that render and build, in a pool of the device; 0 means one for each core. With 1, the device has no
     * threads, and all work runs on the calling thread; only a started task gets a thread. With `submit`: the number of
     * threads of the host, including the calling thread.
     */
    uint32_t threads;
    /**
     * An `etd_log_choice`: which messages `log` receives. All by default.
     */
    etd_log_choice log_choice;
    /**
     * Memory limit in bytes for all hierarchies, placed geometry and films of this device; 0: no limit. Descriptions, which
     * include copies of the host's arrays, and memory of the host do not count.
     */
    uint64_t memory_limit;
    /**
     * Log callback; may be NULL.
     */
    etd_log_fn log;
    /**
     * Error callback; may be NULL.
     */
    etd_error_fn error;
    /**
     * The host's executor; NULL for threads of the device.
     */
    etd_submit_fn submit;
    /**
     * Passed to the three functions. They may be called until the device and all objects made with it are released.
     */
    void *user_data;
} etd_device_options;

/**
 * What a device is.
 */
typedef struct etd_device_info {
    /**
     * `sizeof(etd_device_info)`.
     */
    size_t struct_size;
    /**
     * Number of threads that render, including the calling thread where that takes a part.
     */
    uint32_t threads;
    /**
     * Number of threads that build hierarchies.
     */
    uint32_t build_threads;
    /**
     * Version of the Embree library that runs, as 10000 * major + 100 * minor + patch.
     */
    uint32_t embree_version;
    /**
     * 0.
     */
    uint32_t reserved;
    /**
     * The largest instruction set of the processor among those that Embree and the library choose between: "AVX-512", "AVX2", "AVX",
     * "SSE4.2" or "SSE2" on x86-64. The string is static.
     */
    const char *instruction_set;
    /**
     * The memory limit of the device in bytes; 0: none.
     */
    uint64_t memory_limit;
} etd_device_info;

/**
 * The progress of work.
 */
typedef struct etd_progress {
    /**
     * `sizeof(etd_progress)`.
     */
    size_t struct_size;
    /**
     * Fraction of the work, or of the time limit, that is done, in [0, 1]. It never falls.
     */
    double fraction;
    /**
     * Seconds since the work began.
     */
    double elapsed;
    /**
     * Number of rays traced so far.
     */
    uint64_t rays;
    /**
     * Number of complete samples per pixel.
     */
    uint32_t samples_done;
    /**
     * Greatest number of samples per pixel, at which the render ends.
     */
    uint32_t samples_total;
    /**
     * The current phase.
     */
    etd_phase phase;
    /**
     * Number of images that the film got so far. When it grows, a host may map the film again.
     */
    uint32_t images;
} etd_progress;

/**
 * A progress callback. It returns 0 to continue, and anything else to cancel.
 *
 * It is called about ten times a second and after each pass, and never from two threads at the same time for the same work.
 * `etd_render` and the calls that make and bake light maps call it on the calling thread, tasks on their own thread, reading and
 * builds of a scene on one of the reading or building threads. It must not unwind. It may map and copy the film, and must not wait for the work
 * that called it.
 */
typedef int32_t (*etd_progress_fn)(void *user_data, const struct etd_progress *progress);

/**
 * Options of a scene.
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
     * The folder to which paths of mesh files in a scene from text are relative; NULL: the current folder.
     */
    const char *base_dir;
    /**
     * A parameter file of the report's renderer that overrides the scene's own settings; NULL: none.
     */
    const char *params_file;
    /**
     * Progress callback of the calls that read a scene; may be NULL. It receives the fraction of the bytes of mesh
     * files and images that are read, on one of the reading threads, and cancels the reading if it returns anything but 0.
     */
    etd_progress_fn progress;
    /**
     * Passed to the callback.
     */
    void *user_data;
} etd_scene_options;

/**
 * Information about a built scene.
 */
typedef struct etd_scene_info {
    /**
     * `sizeof(etd_scene_info)`.
     */
    size_t struct_size;
    /**
     * Number of surfaces in the description, including removed ones.
     */
    uint64_t surfaces;
    /**
     * Number of materials in the description.
     */
    uint64_t materials;
    /**
     * Number of meshes in the description.
     */
    uint64_t meshes;
    /**
     * Number of point lights in the description.
     */
    uint64_t point_lights;
    /**
     * Number of triangles that are stored in the scene's own frame.
     */
    uint64_t triangles;
    /**
     * Number of instances of meshes.
     */
    uint64_t instances;
    /**
     * Number of triangles of instanced meshes; each mesh counts once.
     */
    uint64_t shared_triangles;
    /**
     * Number of spheres, disks and quadrics.
     */
    uint64_t analytic_shapes;
    /**
     * Number of emitters that light sampling uses.
     */
    uint64_t emitters;
    /**
     * Bytes of the library's vertices, indices, normals and precomputed shading data.
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
    /**
     * Number of textures that materials of surfaces use.
     */
    uint64_t textures;
    /**
     * Bytes of the images of these textures and of their smaller levels, without texels that the host keeps.
     */
    uint64_t texture_bytes;
} etd_scene_info;

/**
 * A callback for the end of a task, which receives how the task ended. It is called once, on the task's thread and before
 * `etd_task_wait` returns. The rules of `etd_progress_fn` apply.
 */
typedef void (*etd_finished_fn)(void *user_data, etd_status status);

/**
 * Options of a render. The render ends when the first of its limits on samples, time and error is reached.
 *
 * The fields from `photon_radius` on are settings of photon maps, the irradiance cache and radiosity. Only the integrators that
 * docs/scene-format.md names use them. In all of these fields, 0 stands for the default.
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
     * Number of samples per pixel, 2^31 at most. With 0, only `time_limit` and `target_error` end the render, and one of them
     * must be set.
     */
    uint32_t samples;
    /**
     * Greatest number of surface hits on a path, counting the first visible one; 0: no limit. A limit darkens the image.
     */
    uint32_t max_depth;
    /**
     * Number of light samples at each hit, from 1 to 1024; 0 means 1.
     */
    uint32_t shadow_rays;
    /**
     * Seed of all random numbers. The same seed gives the same image on any number of threads.
     */
    uint64_t seed;
    /**
     * Time limit in seconds, > 0; 0: no limit. It ends the render, with its estimates of errors, in the middle of a pass, and of
     * shooting photons for it. One sample per pixel is always taken, with the photon maps or the irradiance cache that it needs; a
     * render that takes longer than its limit for that logs a warning. A radiosity solution is less accurate where time is short,
     * which is logged as well; its first links, a fixed number of iterations, and that of a share of the picture take the time that
     * they take.
     */
    double time_limit;
    /**
     * Target error in the measure `error_measure`, > 0; 0: none. It is reached when the estimated error plus a quarter of the
     * estimate's standard error is at most the target, but not before 32 samples per pixel, and not while few pixels have most
     * of the error.
     */
    double target_error;
    /**
     * Progress callback; may be NULL.
     */
    etd_progress_fn progress;
    /**
     * Callback for the end of a task; may be NULL. `etd_render` does not call it.
     */
    etd_finished_fn finished;
    /**
     * Passed to the two functions.
     */
    void *user_data;
    /**
     * Radius of a density estimate, scene units, 1e-18 to 1e18; where the radius shrinks, this is the first one. 0 means 0.1 for
     * `ETD_INTEGRATOR_PHOTON_DIRECT`, and otherwise a radius from the extent that a pixel sees.
     */
    double photon_radius;
    /**
     * Radius of density estimates in the caustic map, with the range and default of `photon_radius`.
     */
    double caustic_radius;
    /**
     * Share of the photons that progressive methods keep as radii shrink, above 0 and below 1; 0 means 2/3.
     */
    double photon_alpha;
    /**
     * Greatest error of Ward's estimate at which records of the irradiance cache are interpolated, up to 10; 0 means 0.25.
     */
    double cache_error;
    /**
     * Smallest distance over which a record is used, in pixels as seen by the camera, up to 1000; 0 means 3.
     */
    double cache_min_spacing;
    /**
     * Greatest distance over which a record is used, as a share of the scene's extent, up to 1; 0 means 0.1.
     */
    double cache_max_spacing;
    /**
     * Number of light paths of a photon map (of each pass, where maps are built for every pass), 2^29 at most; 0: the integrator
     * chooses.
     */
    uint32_t photon_count;
    /**
     * Number of light paths of the caustic map, with the range and default of `photon_count`.
     */
    uint32_t caustic_count;
    /**
     * Smallest number of photons within the radius that makes an estimate for `ETD_INTEGRATOR_PHOTON_DIRECT`, which sends shadow
     * rays where there are fewer; 0 means 10.
     */
    uint32_t min_photons;
    /**
     * Number of nearest photons that make an estimate, without those beyond the radius, 2 to 65536. With `UINT32_MAX`, all photons
     * within the radius make the estimate. With 0, all photons within a radius make it, where each pixel has its own radius.
     */
    uint32_t photon_neighbours;
    /**
     * An `etd_photon_kernel`.
     */
    etd_photon_kernel photon_kernel;
    /**
     * Parameter k of `ETD_PHOTON_KERNEL_CONE`, 1 or more; 0 means 1.
     */
    float photon_kernel_k;
    /**
     * An `etd_photon_sharing`.
     */
    etd_photon_sharing photon_sharing;
    /**
     * An `etd_switch`: whether caustic photons are aimed at the specular surfaces. On by default.
     */
    etd_switch photons_guided;
    /**
     * An `etd_switch`: whether the map of `ETD_INTEGRATOR_CAUSTIC` is built anew for every pass, with a shrinking radius. On by
     * default.
     */
    etd_switch photons_progressive;
    /**
     * Number of rays of a final gather, 1024 at most; 0 means 1.
     */
    uint32_t gather_rays;
    /**
     * Memory limit of all maps that exist at a time, MiB, 2^20 at most; 0 means 4096.
     */
    uint32_t photon_memory;
    /**
     * Number of rays of an irradiance record's final gather, from 16 to 2^20; 0 means 512.
     */
    uint32_t cache_rays;
    /**
     * An `etd_cache_source`.
     */
    etd_cache_source cache_source;
    /**
     * An `etd_switch`: whether paths carry wavelengths instead of three channels. Colours become smooth spectra, lights those times
     * D65, and glass with a dispersion disperses light; the film has the colours that the standard observer sees. Off by default.
     */
    etd_switch spectral;
    /**
     * An `etd_error_measure`: the measure of `target_error`, in which adaptive sampling reduces the error.
     */
    etd_error_measure error_measure;
    /**
     * An `etd_switch`: whether pixels with larger errors get more samples; `samples` is then the mean over pixels. On by default
     * if `target_error` is set and `reuse` is not on. It needs the sampler `ETD_SAMPLER_SOBOL` or `ETD_SAMPLER_RANDOM`, and an
     * integrator that does not build photon maps for each pass. Otherwise all pixels get the same number of samples, and the log
     * callback receives a warning.
     */
    etd_switch adaptive;
    /**
     * Smallest element of `ETD_INTEGRATOR_RADIOSITY`, to which this and the fields up to `radiosity_memory` belong: elements whose
     * longest side is at most this long are not subdivided, scene units, 1e-18 to 1e18; 0 means a 64th of the extent of the
     * scene.
     */
    double radiosity_element_size;
    /**
     * Greatest error of one link between elements, in thousandths of all irradiance, up to 1000; 0 means 1.
     */
    double radiosity_error;
    /**
     * Fraction of the solution that may be missing when the iteration ends, below 1; 0 means 0.0001.
     */
    double radiosity_tolerance;
    /**
     * Number of iterations, 2^24 at most: bounces of light, or patches that shoot. With `UINT32_MAX`, there are none, and the image
     * shows the light sources alone. With 0, the iteration ends at `radiosity_tolerance`.
     */
    uint32_t radiosity_iterations;
    /**
     * An `etd_radiosity_solver`.
     */
    etd_radiosity_solver radiosity_solver;
    /**
     * An `etd_switch`: whether the image of a solution that `radiosity_iterations` has ended includes the mean of the light that
     * was not yet distributed. Off by default.
     */
    etd_switch radiosity_ambient;
    /**
     * An `etd_switch`: whether images take direct light from light samples and indirect light from a ray into the solution,
     * instead of interpolating the solution. Off by default.
     */
    etd_switch radiosity_final_gather;
    /**
     * Memory limit of elements and links, MiB, 2^20 at most; 0 means 1024.
     */
    uint32_t radiosity_memory;
    /**
     * An `etd_roulette`, for every integrator that follows paths.
     */
    etd_roulette roulette;
    /**
     * Width of the picture in pixels, where the film is a rectangle of it and not all: 0, or with `picture_height` 2^26 pixels at
     * most. The pixels have the values that they have in the whole picture, except where adaptive sampling, a target error or a
     * time limit look at all pixels of the film. Renders of irradiance and of points ignore this and the next three fields.
     */
    uint32_t picture_width;
    /**
     * Height of the picture in pixels; 0 with a `picture_width` of 0.
     */
    uint32_t picture_height;
    /**
     * Column of the picture that is the film's first, from 0. The film ends inside the picture.
     */
    uint32_t crop_left;
    /**
     * Row of the picture that is the film's first, from 0 at the top. The film ends inside the picture.
     */
    uint32_t crop_top;
    /**
     * Chromaticity, x and y of CIE 1931, of the light under which white surfaces are grey in the picture; 0, 0: that of D65. Light maps and
     * light at given points have no white.
     */
    double white_balance[2];
    /**
     * First and last wavelength, nm, of three adjacent bands of equal width, from 360 to 830 and 0.3 apart or more: with `spectral` on, the
     * channels of the film are then the mean spectral radiance over each band, W m^-2 sr^-1 nm^-1, and `white_balance` does not
     * apply. 0, 0: the colours that the standard observer sees.
     */
    double sensor_bands[2];
    /**
     * An `etd_switch`: whether pixels in groups of 16 share the second hits of their paths, by `ETD_INTEGRATOR_PATH` alone. Most
     * scenes take less time to the same error so, and the picture stays unbiased, but the errors of neighbouring pixels, within squares of
     * 8 x 8, are correlated. On is refused with `spectral`, with `adaptive` on, for light maps and light at given points, and for scenes in which
     * something moves, is not opaque, or has media that absorb or have priorities, and for films of emitted, direct or indirect light. By
     * default, a pilot of a long render says, where it is not refused.
     */
    etd_switch reuse;
    /**
     * An `etd_switch`: whether light paths, from lamps by way of mirrors and glass to what the camera sees, find caustics beside the paths
     * from the camera, by `ETD_INTEGRATOR_PATH` alone. The picture stays unbiased. On is refused where `reuse` is, and with `max_depth`, the
     * filter `ETD_FILTER_MITCHELL`, filters that reach farther than 4 pixels, the sampler `ETD_SAMPLER_GAUSSIAN`, textures that the
     * footprint of a ray filters, and cameras that are not in perspective or have a lens. By default, a pilot of a long render says, where
     * it is not refused.
     */
    etd_switch light_paths;
    /**
     * Part of the picture that is rendered, from 1 to `share_count`, where several renders, of any processes and machines, each do one;
     * 0 with a `share_count` of 0. `etd_film_merge` makes the picture of all parts. Adaptive sampling and `target_error` look at the whole
     * picture and are refused.
     */
    uint32_t share_number;
    /**
     * Number of parts, 2^16 at most; 0: the whole picture, or with `resume` the part that was begun. This and the fields below are for
     * pictures: light maps and light at given points refuse them.
     */
    uint32_t share_count;
    /**
     * File to which the state of the render is written every `checkpoint_seconds` and when it ends, for whatever reason, UTF-8; NULL: none.
     * It is replaced in one step each time. `etd_film_load` reads it. The text is read during the call that begins the render. Where the last
     * state cannot be written, the render is done all the same and then fails with `ETD_IO`.
     */
    const char *checkpoint_file;
    /**
     * Seconds from one writing of `checkpoint_file` to the next, > 0; 0 means 60.
     */
    double checkpoint_seconds;
    /**
     * Film whose render goes on, also the film that is rendered to; NULL: the render begins anew. The result is that of one render
     * without interruption, to the last bit. Scene and options must be those of that render, and are `ETD_UNSUPPORTED` with what differs
     * otherwise; these may differ: `samples` with the samplers Sobol and random, `time_limit`, `target_error`, `checkpoint_file`, and what
     * options leave to their default. The film is reserved until the render has taken over its state or its task is released, and stays as it is.
     */
    const struct etd_film *resume;
    /**
     * Light samples, from 1 to 1024, at the hits that the camera sees itself or by way of perfectly specular surfaces alone, by
     * `ETD_INTEGRATOR_PATH` alone; refused with others, for light maps and light at given points. 0: as many as at other hits, or up to
     * eight times as many where a pilot of a long render says that it pays.
     */
    uint32_t first_shadow_rays;
    /**
     * An `etd_switch`: whether `ETD_INTEGRATOR_AUTO` may choose the irradiance cache, whose bias error estimates do not know. A pilot of a
     * long render without `target_error` then measures its bias, noise and time, and it is taken where the whole error times the time
     * is least. On is refused with other integrators, for light maps and light at given points. Off by default.
     */
    etd_switch allow_bias;
} etd_render_options;

/**
 * A camera in the world frame, which is right-handed, with lengths in scene units.
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
     * A point that is seen in the middle of the image, or off it by `shift`, other than `origin`.
     */
    double look_at[3];
    /**
     * The direction that is up in the image, of any length and not parallel to the view direction.
     */
    double up[3];
    /**
     * Full angle of view, degrees, between 0 and 180. An orthographic camera does not read it.
     */
    double fov_deg;
    /**
     * Orthographic cameras: what the image spans across `fov_axis`, scene units, above 0. 0 for other cameras.
     */
    double size;
    /**
     * Perspective cameras: radius of the lens, scene units. 0 is a pinhole. The fields below say more of the lens; other cameras
     * have 0 in all of them.
     */
    double lens_radius;
    /**
     * An `etd_focus`.
     */
    etd_focus focus;
    /**
     * Number of sides of the aperture, a regular polygon in the circle of the lens: 3 to 32. 0 is the whole disk.
     */
    uint32_t blades;
    /**
     * `ETD_FOCUS_DISTANCE`: distance of the plane in focus along the view direction, scene units, above 0.
     */
    double focus_distance;
    /**
     * `ETD_FOCUS_POINT`: a point of the plane in focus, in front of the camera.
     */
    double focus_at[3];
    /**
     * Degrees by which the polygon is turned counter-clockwise in the image. At 0, one of its vertices is at the right.
     */
    double blade_rotation_deg;
    /**
     * Number by which the aperture's width is divided, after it is turned: 0.01 to 100. 0 means 1.
     */
    double squeeze;
    /**
     * Perspective and orthographic cameras: how far the film is moved against the view axis, to the right in widths of the image and
     * upwards in heights of the image, each -100 to 100. 0 for other cameras.
     */
    double shift[2];
    /**
     * Width of a pixel over its height, 0.01 to 100. 0 means 1; view-plane and spherical cameras have 0.
     */
    double pixel_aspect;
} etd_camera;

/**
 * The parameters of a principled material. Names and defaults, which are in the initialiser, are those of OpenPBR Surface 1.1
 * where it has them. Colours and weights are in [0, 1]; every number is used as it is, also 0.
 */
typedef struct etd_principled {
    /**
     * `sizeof(etd_principled)`.
     */
    size_t struct_size;
    /**
     * Factor on `base_color`.
     */
    float base_weight;
    /**
     * Colour of the diffuse part; reflectance of the metal at normal incidence.
     */
    float base_color[3];
    /**
     * Roughness of the diffuse part, in [0, 1].
     */
    float base_diffuse_roughness;
    /**
     * Share of metal.
     */
    float base_metalness;
    /**
     * Factor on the reflectance of the metal and, at normal incidence, of the dielectric.
     */
    float specular_weight;
    /**
     * Tint of the edge of the metal.
     */
    float specular_color[3];
    /**
     * Perceptual roughness of metal and dielectric, in [0, 1].
     */
    float specular_roughness;
    /**
     * How much narrower highlights are along one direction, in [0, 0.99].
     */
    float specular_roughness_anisotropy;
    /**
     * Angle of that direction, degrees in [-360, 360].
     */
    float specular_rotation_deg;
    /**
     * Index of refraction of the dielectric, above 0 and up to 100.
     */
    float specular_ior;
    /**
     * Share of the dielectric that light passes, instead of being scattered diffusely.
     */
    float transmission_weight;
    /**
     * Colour of what is transmitted: of light that has entered and left, or that has travelled `transmission_depth` inside.
     */
    float transmission_color[3];
    /**
     * Share of the surface that has a coat.
     */
    float coat_weight;
    /**
     * Colour of what passes the coat down and up again along the normal.
     */
    float coat_color[3];
    /**
     * Perceptual roughness of the coat, in [0, 1].
     */
    float coat_roughness;
    /**
     * Anisotropy of the coat, in [0, 0.99].
     */
    float coat_roughness_anisotropy;
    /**
     * Index of refraction of the coat, in [1, 100].
     */
    float coat_ior;
    /**
     * How much light that bounces under the coat darkens the base: 1 is the physical darkening.
     */
    float coat_darkening;
    /**
     * Share of the surface that is covered by fuzz.
     */
    float fuzz_weight;
    /**
     * Colour of the fuzz.
     */
    float fuzz_color[3];
    /**
     * Perceptual roughness of the fuzz, in (0, 1].
     */
    float fuzz_roughness;
    /**
     * 1: the surface is a thin sheet, which does not refract what it transmits (OpenPBR's `geometry_thin_walled`); 0: it is the
     * boundary of a body.
     */
    uint32_t thin_walled;
    /**
     * 0: light that facets scatter more than once is included; 1: it is left out.
     */
    uint32_t single_scattering;
    /**
     * The distance inside a body after which `transmission_color` is left [scene unit], >= 0. With 0 the colour belongs to the
     * surface. A thin sheet has no inside.
     */
    float transmission_depth;
} etd_principled;

/**
 * A material. Fields that its model does not use are ignored; `etd_bsdf` says which fields each model uses.
 *
 * The facets of a rough surface are `roughness`, `anisotropy`, `rotation_deg`, `distribution`, `masking` and
 * `single_scattering`.
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
     * Roughness in [0, 1], as in files: Fujii's sigma' for `ETD_BSDF_OREN_NAYAR`, the roughness of EON and of sheen, and for
     * facets the perceptual roughness, whose square is the width alpha of their distribution. Facets of roughness 0 are a
     * smooth surface.
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
     * Survival probability of Russian roulette at this material, in (0, 1], for renders with `ETD_ROULETTE_FILE`. With 0, the
     * library chooses the probability in these renders too. It changes noise and time, never the expected image.
     */
    float survival;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Absorption coefficient inside of a dielectric [1 / scene unit], each channel >= 0: after a distance d, exp(-absorption d)
     * of the light is left.
     */
    float absorption[3];
    /**
     * Priority of the medium inside of a dielectric. Where bodies overlap, the medium with the largest number fills the overlap;
     * among equal ones, it is the medium that a ray entered last.
     */
    uint32_t priority;
    /**
     * How much narrower facets are spread across the tangent than along it, in [0, 0.99].
     */
    float anisotropy;
    /**
     * Angle from the surface's tangent to the direction of the larger spread of facets, degrees in [-360, 360],
     * counter-clockwise about the normal.
     */
    float rotation_deg;
    /**
     * An `etd_distribution`.
     */
    etd_distribution distribution;
    /**
     * An `etd_masking`.
     */
    etd_masking masking;
    /**
     * 0: light that facets scatter more than once is included; 1: it is left out. It is always left out with
     * `ETD_MASKING_V_CAVITY`.
     */
    uint32_t single_scattering;
    /**
     * `ETD_BSDF_DIFFUSE_TRANSMISSION`: the share of the light that is transmitted, [0, 1] per channel.
     * `ETD_BSDF_THIN_DIELECTRIC`: what is left of light that crossed the sheet once along the normal, [0, 1] per channel. For
     * that model, three zeros mean clear glass, as three ones do; a sheet that lets no light through has three times -1.
     */
    float transmittance[3];
    /**
     * Index of refraction of a conductor per channel, > 0. Three zeros: the conductor is described by `color`, its reflectance
     * at normal incidence, and `edge_tint`. `etd_metal` has the indices of measured metals.
     */
    float eta[3];
    /**
     * Extinction coefficient of a conductor per channel, >= 0, used with `eta`.
     */
    float k[3];
    /**
     * Tint of the edge of a conductor that is described by `color`, [0, 1] per channel (Gulbrandsen 2014). With 1 its
     * reflectance rises steadily towards grazing angles, and with 0 it falls before it rises. Three zeros are this 0; the
     * initialiser has ones, the default of files.
     */
    float edge_tint[3];
    /**
     * `ETD_BSDF_MIX`, `ETD_BSDF_TWO_SIDED`: number of a material, which must be lower than the material's own number.
     */
    uint32_t first;
    /**
     * As `first`.
     */
    uint32_t second;
    /**
     * `ETD_BSDF_MIX`: the share of `second`, in [0, 1].
     */
    float weight;
    /**
     * `ETD_BSDF_PRINCIPLED`: the parameters, which are read during the call only; must not be NULL for this model.
     * `etd_scene_get_material` sets the pointer to NULL; `etd_scene_get_principled` returns the parameters.
     */
    const struct etd_principled *principled;
    /**
     * Probability with which a ray meets a surface of the material, in [0, 1]; other rays pass straight on. 0 means 1, and -1
     * stands for 0. A material that emits light is opaque.
     */
    float opacity;
    /**
     * Emitted radiance on the normal's side [W m^-2 sr^-1], each channel >= 0, of all surfaces of the material that have no
     * emission of their own. Three zeros: none. Quadrics and disks cannot have a material that emits.
     */
    float emission[3];
    /**
     * Abbe number (n_d - 1) / (n_F - n_C) of a dielectric, > 0: the smaller, the more its index depends on the wavelength, by
     * Cauchy's formula with `ior` at 587.56 nm. Only renders in wavelengths (`etd_render_options.spectral`) show it. 0: the same
     * index for all wavelengths.
     */
    float abbe;
    /**
     * Strengths of Sellmeier's formula n^2 = 1 + sum of strength lambda^2 / (lambda^2 - resonance) for a dielectric, lambda in
     * micrometres, in place of `abbe`; unused ones are 0. `ior` is then not read: the index is that of the formula.
     */
    float sellmeier_strengths[4];
    /**
     * Squares of the resonant wavelengths of Sellmeier's formula, micrometre^2.
     */
    float sellmeier_resonances[4];
    /**
     * Must be 0.
     */
    uint32_t reserved_1;
    /**
     * Thickness of a thin film on the outer side of a dielectric or a conductor, nanometres, in [0, 10000]. 0: no film.
     */
    float film_thickness;
    /**
     * Index of refraction of the film, above 0 and up to 100. Without a film it is not read.
     */
    float film_ior;
} etd_material;

/**
 * A point light that shines into a cone with a soft edge. The factor on its intensity is 1 up to the inner angle a from the axis, 0
 * from the outer angle on, and between them ((cos a - cos outer) / (cos inner - cos outer))^2, as in glTF.
 */
typedef struct etd_spot_light {
    /**
     * `sizeof(etd_spot_light)`.
     */
    size_t struct_size;
    /**
     * Where it is, world frame.
     */
    double position[3];
    /**
     * The axis of the cone, away from the light, of any length but 0.
     */
    double direction[3];
    /**
     * Radiant intensity along the axis [W sr^-1], each channel >= 0.
     */
    float intensity[3];
    /**
     * Degrees between the axis and the directions from which on there is no light, in [0.01, 180].
     */
    double outer_cone_deg;
    /**
     * Degrees between the axis and the directions up to which the light is full, in [0, `outer_cone_deg`].
     */
    double inner_cone_deg;
} etd_spot_light;

/**
 * A measured lamp: a point light whose intensities come from a file of IES LM-63 or EULUMDAT.
 */
typedef struct etd_web_light {
    /**
     * `sizeof(etd_web_light)`.
     */
    size_t struct_size;
    /**
     * Name of the file; NULL: `text` has its contents. `etd_scene_get_web_light` sets it to NULL.
     */
    const char *file;
    /**
     * Contents of such a file, which are read during the call; NULL: `file`. `etd_scene_get_web_light` sets it to NULL.
     */
    const void *text;
    /**
     * Size of `text` in bytes.
     */
    size_t text_bytes;
    /**
     * Where it is, world frame.
     */
    double position[3];
    /**
     * The lamp's axis, gamma = 0, of any length but 0.
     */
    double direction[3];
    /**
     * The direction of C = 0, of any length but 0, whose part across `direction` counts. C grows counter-clockwise as seen along
     * `direction`.
     */
    double c0[3];
    /**
     * Factor on the intensities, each channel >= 0. At 1, the radiant intensity [W sr^-1] is the file's candela over 683 lm/W.
     */
    float factor[3];
    /**
     * Degrees by which the luminaire is tilted from straight down, in [-180, 180] and within the tilts of the file. It chooses the
     * factor of files that have some for tilted lamps, and turns nothing.
     */
    double tilt_deg;
} etd_web_light;

/**
 * Light from infinity by a texture, or the same from all directions.
 */
typedef struct etd_environment_map {
    /**
     * `sizeof(etd_environment_map)`.
     */
    size_t struct_size;
    /**
     * Number of the texture; `ETD_NONE`: none.
     */
    uint32_t texture;
    /**
     * An `etd_sky_projection`.
     */
    etd_sky_projection projection;
    /**
     * Radiance [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one.
     */
    float radiance[3];
    /**
     * 1: camera rays do not see it, only mirrors, glass and other light do; 0: they do.
     */
    uint32_t hidden;
    /**
     * The direction that is up in the image, of any length but 0. With +z up, what is towards -z with +y up is towards +y.
     */
    double up[3];
    /**
     * Degrees by which the image is turned about `up`, counter-clockwise as seen from above.
     */
    double rotation_deg;
} etd_environment_map;

/**
 * A picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing.
 */
typedef struct etd_backplate {
    /**
     * `sizeof(etd_backplate)`.
     */
    size_t struct_size;
    /**
     * Number of the texture that is spread over the whole picture; `ETD_NONE`: none.
     */
    uint32_t texture;
    /**
     * Radiance [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one.
     */
    float radiance[3];
} etd_backplate;

/**
 * Light that comes from one direction of infinity, such as that of the sun: parallel, or of a disk of even radiance.
 */
typedef struct etd_distant_light {
    /**
     * `sizeof(etd_distant_light)`.
     */
    size_t struct_size;
    /**
     * The direction towards the light, of any length but 0.
     */
    double towards[3];
    /**
     * Irradiance of a surface across the light [W m^-2], each channel >= 0.
     */
    float irradiance[3];
    /**
     * 1: camera rays do not see the disk, only mirrors, glass and other light do; 0: they do.
     */
    uint32_t hidden;
    /**
     * Angular diameter of the disk, degrees in [0, 180]; 0: parallel light. That of the sun is about 0.533.
     */
    double angle_deg;
} etd_distant_light;

/**
 * A sky by a formula of the angles to the zenith and to the sun, over a ground. The disk of the sun is an `etd_distant_light`, or comes with
 * the sky of a `turbidity`.
 */
typedef struct etd_sky {
    /**
     * `sizeof(etd_sky)`.
     */
    size_t struct_size;
    /**
     * Type of the CIE's general sky, 1 to 15: 1 is the overcast sky, 5 an even one, 12 the clear one; 0: the formula of Perez and
     * others, with `perez`, or with `turbidity` the clear sky of Hosek and Wilkie.
     */
    uint32_t cie;
    /**
     * 0: `radiance` is that at the zenith [W m^-2 sr^-1]; 1: it is the irradiance of a horizontal surface by the sky [W m^-2].
     */
    uint32_t horizontal;
    /**
     * What `horizontal` says, each channel >= 0. With `turbidity` a factor on the sky's own radiance and on that of its sun, and
     * `horizontal` must be 0.
     */
    float radiance[3];
    /**
     * The share of the light that the ground sends back evenly from below the horizon, in [0, 1] per channel.
     */
    float ground[3];
    /**
     * 1: camera rays do not see it, only mirrors, glass and other light do; 0: they do.
     */
    uint32_t hidden;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * The direction towards the sun, above the horizon; with `turbidity` not below it. `etd_sun_direction` has it for places and times.
     */
    double sun[3];
    /**
     * The direction of the zenith.
     */
    double up[3];
    /**
     * The numbers a to e of the formula (1 + a exp(b / cos Z)) (1 + c exp(d chi) + e cos^2 chi), of the angle Z to the zenith and chi
     * to the sun. Not used with `cie` or `turbidity`.
     */
    double perez[5];
    /**
     * How hazy the air of the clear sky of Hosek and Wilkie is, in [1, 10]: 2 is very clear, 3 clear, 6 warm and moist; 0: another
     * formula. Its radiance is in W m^-2 sr^-1 per channel of linear Rec. 709, and includes what `ground` sends back to the sky.
     */
    double turbidity;
    /**
     * With `turbidity`: angular diameter of the disk of the sun, degrees in [0, 180]; 0: parallel light. The irradiance is that of the real
     * sun in any case.
     */
    double angle_deg;
    /**
     * With `turbidity`: 1: the sky alone; 0: with the disk of its sun.
     */
    uint32_t no_disk;
    /**
     * Must be 0.
     */
    uint32_t reserved_1;
} etd_sky;

/**
 * A spectrum. Illuminants and daylight as light are of luminance 1, which is 683 cd m^-2 for a radiance of 1; black bodies and samples
 * are absolute, for a radiance in W m^-2 sr^-1 nm^-1.
 */
typedef struct etd_spectrum {
    /**
     * `sizeof(etd_spectrum)`.
     */
    size_t struct_size;
    /**
     * What says how it is.
     */
    etd_spectrum_kind kind;
    /**
     * With `ETD_SPECTRUM_ILLUMINANT`: which one.
     */
    etd_illuminant illuminant;
    /**
     * Temperature in kelvin: of daylight in [4000, 25000], of a black body in [500, 1000000].
     */
    double temperature;
    /**
     * With `ETD_SPECTRUM_SAMPLES`: pairs of a wavelength, nm, in growing order, and a value of 0 or more, which are copied. Between them
     * the spectrum is linear; light is 0 outside, and everything else as at the nearest sample. `etd_scene_get_spectrum` sets it to NULL.
     */
    const double *samples;
    /**
     * Number of pairs.
     */
    size_t sample_count;
} etd_spectrum;

/**
 * The properties of a surface other than its shape.
 */
typedef struct etd_surface {
    /**
     * `sizeof(etd_surface)`.
     */
    size_t struct_size;
    /**
     * Number of the surface's material; `ETD_NONE` for a surface that emits light and reflects none.
     */
    uint32_t material;
    /**
     * Emitted radiance on the normal's side [W m^-2 sr^-1], or the factor on the surface's web where `etd_scene_set_surface_web` gave it
     * one; three zeros for a surface that does not emit. Of the quadrics, only
     * cylinders can emit.
     */
    float emission[3];
    /**
     * Transform from the object frame to the world frame, three rows of four numbers whose last column is the translation;
     * twelve zeros stand for the identity.
     */
    double transform[12];
    /**
     * If not 0, the surface emits on its other side too, with the same radiance: it must emit, and be no sphere.
     */
    uint32_t emits_both;
    /**
     * 0.
     */
    uint32_t reserved;
} etd_surface;

/**
 * The photometric web of a flat surface, from a file of IES LM-63 or EULUMDAT. The lamp's axis, gamma = 0, is the normal.
 */
typedef struct etd_surface_web {
    /**
     * `sizeof(etd_surface_web)`.
     */
    size_t struct_size;
    /**
     * Name of the file; NULL: `text` has its contents. `etd_scene_get_surface_web` sets it to NULL.
     */
    const char *file;
    /**
     * Contents of such a file, which are read during the call; NULL: `file`. `etd_scene_get_surface_web` sets it to NULL.
     */
    const void *text;
    /**
     * Size of `text` in bytes.
     */
    size_t text_bytes;
    /**
     * The direction of C = 0 in the object's frame, of any length but 0, whose part along the surface counts. C grows counter-clockwise
     * as seen along the normal.
     */
    double c0[3];
    /**
     * As `tilt_deg` of `etd_web_light`.
     */
    double tilt_deg;
} etd_surface_web;

/**
 * A release callback, which is called once memory that was shared with a mesh is no longer read. It is called exactly once, on
 * any thread, possibly during another call. It must not call this library.
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
     * One position for each vertex, in the mesh's own frame.
     */
    const void *positions;
    /**
     * Bytes from one position to the next; 0: positions without gaps.
     */
    size_t position_stride;
    /**
     * Number of readable bytes from `positions` on; 0: up to the end of the last stride. Used only with `ETD_SHARE`.
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
     * Bytes from one triangle's numbers to those of the next; 0: triangles without gaps.
     */
    size_t index_stride;
    /**
     * Number of triangles, at least 1 and below 2^32 - 1.
     */
    size_t triangle_count;
    /**
     * One normal for each vertex, of any length; NULL: none.
     */
    const float *normals;
    /**
     * Bytes from one normal to the next; 0: normals without gaps.
     */
    size_t normal_stride;
    /**
     * One texture coordinate for each vertex; NULL: none.
     */
    const float *uvs;
    /**
     * Bytes from one texture coordinate to the next; 0: coordinates without gaps.
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
     * With `ETD_SHARE`: called once the arrays are no longer read; may be NULL. It is not called if adding the mesh fails.
     */
    etd_release_fn release;
    /**
     * Passed to `release`.
     */
    void *user_data;
    /**
     * Name of the mesh, unique among meshes; NULL: none.
     */
    const char *name;
    /**
     * One colour for each vertex, for textures with `vertex_colors`: red, green and blue in linear light, each >= 0, and opacity in
     * [0, 1]; NULL: none. Colours are always copied.
     */
    const float *colors;
    /**
     * Bytes from one colour to the next; 0: colours without gaps.
     */
    size_t color_stride;
    /**
     * The sets 1, 2, ... of texture coordinates for textures with `uv_set`, each with one texture coordinate for each vertex, or
     * NULL; NULL: none. They are always copied.
     */
    const float *const *further_uvs;
    /**
     * Number of further sets, 7 at most.
     */
    uint32_t further_uv_count;
    /**
     * Bytes from one texture coordinate of a further set to the next; 0: coordinates without gaps.
     */
    size_t further_uv_stride;
    /**
     * One tangent for each vertex, of any length, for normal maps on smooth surfaces: the direction in which u grows; NULL: those of
     * MikkTSpace. They are always copied.
     */
    const float *tangents;
    /**
     * Bytes from one tangent to the next; 0: tangents of three numbers without gaps.
     */
    size_t tangent_stride;
} etd_mesh;

/**
 * The shape of a surface, in its own frame. Fields that the kind does not have are 0.
 */
typedef struct etd_shape {
    /**
     * `sizeof(etd_shape)`, set by the caller (`ETD_SHAPE_INIT`).
     */
    size_t struct_size;
    /**
     * An `etd_shape_kind`.
     */
    etd_shape_kind kind;
    /**
     * Number of the mesh; `ETD_NONE` for other kinds.
     */
    uint32_t mesh;
    /**
     * Of a mesh: 1 where the normals of its vertices are interpolated.
     */
    uint32_t smooth;
    /**
     * 0.
     */
    uint32_t reserved;
    /**
     * Three rows of four: from the shape's own frame to the one from which `etd_surface.transform` leads to the world. It is the
     * identity but for shapes that stand along an axis, such as cylinders.
     */
    double frame[12];
    /**
     * Three or four vertices of a triangle or quad.
     */
    double vertices[12];
    /**
     * Centre of a sphere or disk.
     */
    double centre[3];
    /**
     * Normal of a disk, unit length.
     */
    double normal[3];
    /**
     * Radius of a sphere or disk.
     */
    double radius;
    /**
     * The coefficients a to j of a quadric, as `etd_scene_add_quadric` takes them.
     */
    double coefficients[10];
    /**
     * Smallest corner of the box that clips a quadric; may be infinite.
     */
    double clip_min[3];
    /**
     * Largest corner.
     */
    double clip_max[3];
} etd_shape;

/**
 * What a mesh has.
 */
typedef struct etd_mesh_info {
    /**
     * `sizeof(etd_mesh_info)`, set by the caller (`ETD_MESH_INFO_INIT`).
     */
    size_t struct_size;
    /**
     * Number of vertices.
     */
    size_t vertex_count;
    /**
     * Number of triangles.
     */
    size_t triangle_count;
    /**
     * 1 where its vertices have normals.
     */
    uint32_t has_normals;
    /**
     * 1 where its vertices have texture coordinates.
     */
    uint32_t has_uvs;
} etd_mesh_info;

/**
 * A keyframe: a transform at a time, which is done to a thing after its own placement. Between two keyframes, translation and scale
 * change linearly and the rotation goes the shorter way at constant speed; before the first and after the last, nothing moves.
 * Arrays of keyframes follow one another without gaps, so this structure does not grow.
 */
typedef struct etd_motion_key {
    /**
     * The time in seconds, later than that of the keyframe before.
     */
    double time;
    /**
     * Translation, applied last.
     */
    double translation[3];
    /**
     * Rotation: a quaternion x, y, z, w of any length but 0.
     */
    double rotation[4];
    /**
     * Factors along the axes, applied first, none of them 0.
     */
    double scale[3];
    /**
     * Not 0: the transform is `matrix`, and the fields above are not read.
     */
    uint32_t use_matrix;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Three rows of four numbers, invertible. The transform is taken apart into a stretch, a rotation and a translation.
     */
    double matrix[12];
} etd_motion_key;

/**
 * When the shutter is open, in seconds. Everything is seen at one moment where it closes as it opens.
 */
typedef struct etd_shutter {
    /**
     * `sizeof(etd_shutter)`.
     */
    size_t struct_size;
    /**
     * When it opens.
     */
    double open;
    /**
     * When it closes, not before `open`.
     */
    double close;
    /**
     * How open it is at moments evenly spaced from `open` to `close`, in any unit: numbers >= 0, between which it changes linearly;
     * they are read during the call. NULL: as open all the time. `etd_scene_get_shutter` sets it to NULL.
     */
    const double *curve;
    /**
     * Number of them, 2 to 1024; 0 with NULL.
     */
    size_t curve_count;
} etd_shutter;

/**
 * A texture: an image or a pattern of two colours, and where it lies.
 */
typedef struct etd_texture {
    /**
     * `sizeof(etd_texture)`.
     */
    size_t struct_size;
    /**
     * An `etd_texture_kind`.
     */
    etd_texture_kind kind;
    /**
     * Of an image: an `etd_color_space`.
     */
    etd_color_space color_space;
    /**
     * Of an image: PNG, JPEG, TGA, BMP, WebP, TIFF, Radiance HDR or OpenEXR file, UTF-8, relative to the current folder; NULL:
     * the image is at `texels`.
     */
    const char *file;
    /**
     * Of an image without a file: the numbers, row after row from the top, channels beside each other. The lower left corner
     * of the image is at the texture coordinates (0, 0), the upper right one at (1, 1).
     */
    const void *texels;
    /**
     * Bytes from one row to the next; 0: rows without gaps.
     */
    size_t row_stride;
    /**
     * Number of columns, at least 1; the image has at most 2^28 texels.
     */
    uint32_t width;
    /**
     * Number of rows, at least 1.
     */
    uint32_t height;
    /**
     * 1: grey; 2: grey and opacity; 3: red, green and blue; 4: these and opacity.
     */
    uint32_t channels;
    /**
     * An `etd_texel_format`.
     */
    etd_texel_format texel_format;
    /**
     * An `etd_sharing`. Shared texels are read in place. They must not be freed until `release` is called, and may be written
     * to only while no build and no render of the scene runs, with `etd_scene_update_texture` afterwards.
     */
    etd_sharing sharing;
    /**
     * Of an image: an `etd_texture_filter`.
     */
    etd_texture_filter filter;
    /**
     * With `ETD_SHARE`: called once the texels are no longer read; may be NULL. It is not called if the call fails.
     */
    etd_release_fn release;
    /**
     * Passed to `release`.
     */
    void *user_data;
    /**
     * Of an image: an `etd_wrap`, to the sides.
     */
    etd_wrap wrap_u;
    /**
     * Of an image: an `etd_wrap`, up and down.
     */
    etd_wrap wrap_v;
    /**
     * Of a pattern: the two colours, [0, 1] per channel.
     */
    float colors[2][3];
    /**
     * `ETD_TEXTURE_GRID`: width of the lines, in [0, 1] of a square.
     */
    float line_width;
    /**
     * `ETD_TEXTURE_MARBLE`, `ETD_TEXTURE_WOOD`: how far veins are turned, in periods, or rings, in rings.
     */
    float turbulence;
    /**
     * Of noise, turbulence, marble and wood: number of octaves, 1 to 16; 0: 4.
     */
    uint32_t octaves;
    /**
     * An `etd_coordinates`.
     */
    etd_coordinates coordinates;
    /**
     * Factors on the coordinates, applied first; the third is used in space only. Three zeros: 1.
     */
    double scale[3];
    /**
     * Angle by which texture coordinates are then turned about (0, 0), degrees, counter-clockwise; 0 in space.
     */
    double rotation_deg;
    /**
     * Added to the coordinates at last; the third is used in space only.
     */
    double offset[3];
    /**
     * 1: the texture is multiplied by the colours of vertices, and its opacity by theirs. 0: it is not. Always 1 of
     * `ETD_TEXTURE_VERTEX_COLORS`, whatever is given. Refused for the parameters "emission", "temperature", "normal" and "bump".
     */
    uint32_t vertex_colors;
    /**
     * Of `ETD_COORDINATES_UV`: the set of texture coordinates, 0 to 7. Surfaces that lack it have the first, which is 0.
     */
    uint32_t uv_set;
} etd_texture;

/**
 * A texture of a parameter of a material. The parameter is that of the material times the texture.
 */
typedef struct etd_texture_binding {
    /**
     * `sizeof(etd_texture_binding)`.
     */
    size_t struct_size;
    /**
     * Number of the texture; `ETD_NONE`: none.
     */
    uint32_t texture;
    /**
     * An `etd_texture_channel`.
     */
    etd_texture_channel channel;
    /**
     * For the parameter "normal": factor on the slopes. For "bump": height of a 1 in the texture [scene unit]. Not used by
     * others.
     */
    float strength;
    /**
     * For the parameter "opacity", in [0, 1]: above 0, the opacity is 1 where the texture has this value or more, and 0
     * elsewhere (a mask). 0: the opacity is the texture's. 0 for others.
     */
    float cutoff;
} etd_texture_binding;

/**
 * Options of a film.
 */
typedef struct etd_film_options {
    /**
     * `sizeof(etd_film_options)`.
     */
    size_t struct_size;
    /**
     * Number of pixels in a row, >= 1.
     */
    uint32_t width;
    /**
     * Number of rows, >= 1. A film has 2^26 pixels at most.
     */
    uint32_t height;
    /**
     * `etd_layer` bits of the layers that the film keeps besides the colour.
     */
    uint32_t layers;
    /**
     * Must be 0.
     */
    uint32_t reserved;
} etd_film_options;

/**
 * An image in the library's memory, which may be read until `etd_film_unmap`.
 */
typedef struct etd_map {
    /**
     * `sizeof(etd_map)`.
     */
    size_t struct_size;
    /**
     * `[height][width][channels]`, row 0 on top, without gaps. The data do not change while they are mapped.
     */
    const float *data;
    /**
     * Number of pixels in a row.
     */
    uint32_t width;
    /**
     * Number of rows.
     */
    uint32_t height;
    /**
     * Number of values for each pixel.
     */
    uint32_t channels;
    /**
     * Number of complete samples per pixel in this image; 0 for the black image before the first pass.
     */
    uint32_t samples;
    /**
     * Number of the map, for `etd_film_unmap`.
     */
    uint64_t id;
} etd_map;

/**
 * Options for copying and writing images.
 */
typedef struct etd_image_options {
    /**
     * `sizeof(etd_image_options)`.
     */
    size_t struct_size;
    /**
     * An `etd_format`; `etd_film_write` ignores it.
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
     * If not 0, the bottom row comes first, as in OpenGL; `etd_film_write` ignores it.
     */
    uint32_t bottom_up;
    /**
     * Text for the `comments` attribute of an EXR, UTF-8; NULL: none. Only `etd_film_write` uses it.
     */
    const char *comments;
    /**
     * An `etd_primaries`: those of an EXR or PFM. Only `etd_film_write` uses it.
     */
    etd_primaries primaries;
    /**
     * 0.
     */
    uint32_t reserved;
} etd_image_options;

/**
 * The summary of a render.
 */
typedef struct etd_summary {
    /**
     * `sizeof(etd_summary)`.
     */
    size_t struct_size;
    /**
     * Seconds that the render took, without the build of the scene and the estimates of errors at its end.
     */
    double elapsed;
    /**
     * Seconds that the build of the scene took before the render; 0 if the scene was already built.
     */
    double build_time;
    /**
     * Number of rays traced, including shadow rays.
     */
    uint64_t rays;
    /**
     * Number of samples that were NaN or infinite and count as black. The log callback receives a warning with the place where
     * the first of them became so.
     */
    uint64_t non_finite;
    /**
     * Estimated relative error of the image: the root of `rel_mse`. NaN where there are too few samples or too little memory for
     * an estimate, and after a cancel.
     */
    double relative_error;
    /**
     * Number of complete samples per pixel; the mean over pixels where the numbers differ.
     */
    uint32_t samples;
    /**
     * 1 if the render was cancelled, else 0.
     */
    uint32_t cancelled;
    /**
     * Estimated relMSE (see `ETD_ERROR_RELMSE`). NaN where `relative_error` is NaN.
     */
    double rel_mse;
    /**
     * Standard error of `rel_mse`, estimated from the scatter over pixels.
     */
    double rel_mse_standard_error;
    /**
     * Estimated error of displayed values (see `ETD_ERROR_DISPLAY`), in levels of 255. NaN where `rel_mse` is NaN.
     */
    double display_error;
    /**
     * Smallest number of samples of any pixel; 0 after a cancel.
     */
    uint32_t samples_min;
    /**
     * Greatest number of samples of any pixel; 0 after a cancel.
     */
    uint32_t samples_max;
    /**
     * The reason why the render ended, an `etd_ended`.
     */
    etd_ended ended;
    /**
     * An `etd_integrator`: the one that took the samples; where `ETD_INTEGRATOR_AUTO` was asked for, the one that was chosen.
     */
    etd_integrator integrator;
} etd_summary;

/**
 * A ray segment: origin + t * direction for t in [tnear, tfar], world frame.
 */
typedef struct etd_ray {
    /**
     * Origin of the ray, where t is 0.
     */
    float origin[3];
    /**
     * Start of the segment, >= 0.
     */
    float tnear;
    /**
     * Direction of any length except zero. The length is the unit of t.
     */
    float direction[3];
    /**
     * End of the segment; may be infinite.
     */
    float tfar;
} etd_ray;

/**
 * The first hit of a ray.
 */
typedef struct etd_hit {
    /**
     * Distance in lengths of the ray's direction; infinite where the ray hits nothing. In that case, only `surface` is set
     * besides.
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
     * Number of the surface; `ETD_NONE` where the ray hits nothing.
     */
    uint32_t surface;
    /**
     * Number of the surface's material; `ETD_NONE` for a surface without one, and where the ray hits nothing.
     */
    uint32_t material;
    /**
     * Number of the triangle in its mesh, 0 or 1 in a quad, else 0.
     */
    uint32_t primitive;
} etd_hit;

/**
 * Rays to trace, and what is wanted of their hits, for `etd_scene_query`.
 *
 * Each kind of value is a column: a pointer to the value of the first ray, and the number of bytes from the value of one ray to
 * that of the next, 0 for values without gaps. Columns may be arrays of their own or members of the host's structures, as in
 * `query.ng = &hits[0].normal.x; query.ng_stride = sizeof hits[0];`. A column that is NULL is not read or not computed. Values
 * that are written may overlap nothing.
 */
typedef struct etd_ray_query {
    /**
     * `sizeof(etd_ray_query)`, set by the caller (`ETD_RAY_QUERY_INIT`).
     */
    size_t struct_size;
    /**
     * Number of rays.
     */
    size_t count;
    /**
     * Greatest number of the device's threads that trace the rays. 0 and 1 stand for the calling thread alone, which few rays
     * never leave.
     */
    uint32_t threads;
    /**
     * 0.
     */
    uint32_t reserved;
    /**
     * Three floats a ray: where its t is 0, world frame.
     */
    const float *origins;
    /**
     * Bytes from one origin to the next.
     */
    size_t origins_stride;
    /**
     * Three floats a ray: direction of any length except zero. The length is the unit of t.
     */
    const float *directions;
    /**
     * Bytes from one direction to the next.
     */
    size_t directions_stride;
    /**
     * Starts of the segments, >= 0; NULL for 0.
     */
    const float *tnear;
    /**
     * Bytes from one start to the next.
     */
    size_t tnear_stride;
    /**
     * Ends of the segments, which may be infinite; NULL for infinity.
     */
    const float *tfar;
    /**
     * Bytes from one end to the next.
     */
    size_t tfar_stride;
    /**
     * Moments in [0, 1] of the shutter interval, of a scene with motion; NULL for 0, the opening.
     */
    const float *times;
    /**
     * Bytes from one moment to the next.
     */
    size_t times_stride;
    /**
     * A byte a ray: where it is 0, the ray is not traced, and nothing is written for it. NULL for all rays.
     */
    const uint8_t *active;
    /**
     * Bytes from one ray's byte to the next.
     */
    size_t active_stride;
    /**
     * A byte a ray: 1 where anything is in the segment, otherwise 0. If nothing else is wanted, rays end at any surface, which is
     * faster than to look for the first.
     */
    uint8_t *occluded;
    /**
     * Bytes from one answer to the next.
     */
    size_t occluded_stride;
    /**
     * Distance of the first hit in lengths of the direction, infinite without a hit.
     */
    float *t;
    /**
     * Bytes from one distance to the next.
     */
    size_t t_stride;
    /**
     * Three doubles a ray: the point that is hit, world frame. It is computed on the surface, so its error does not grow with the
     * length of the ray. Without a hit 0, as all that follows unless it says otherwise.
     */
    double *positions;
    /**
     * Bytes from one position to the next.
     */
    size_t positions_stride;
    /**
     * Two floats a ray, as `etd_hit.barycentric`.
     */
    float *barycentric;
    /**
     * Bytes from one pair of weights to the next.
     */
    size_t barycentric_stride;
    /**
     * Two floats a ray, as `etd_hit.uv`.
     */
    float *uv;
    /**
     * Bytes from one pair of coordinates to the next.
     */
    size_t uv_stride;
    /**
     * Three floats a ray, as `etd_hit.ng`.
     */
    float *ng;
    /**
     * Bytes from one geometric normal to the next.
     */
    size_t ng_stride;
    /**
     * Three floats a ray, as `etd_hit.ns`.
     */
    float *ns;
    /**
     * Bytes from one shading normal to the next.
     */
    size_t ns_stride;
    /**
     * Numbers of the surfaces; `ETD_NONE` without a hit.
     */
    uint32_t *surfaces;
    /**
     * Bytes from one surface to the next.
     */
    size_t surfaces_stride;
    /**
     * Numbers of the surfaces' materials; `ETD_NONE` for a surface without one, and without a hit.
     */
    uint32_t *materials;
    /**
     * Bytes from one material to the next.
     */
    size_t materials_stride;
    /**
     * As `etd_hit.primitive`.
     */
    uint32_t *primitives;
    /**
     * Bytes from one primitive to the next.
     */
    size_t primitives_stride;
} etd_ray_query;

/**
 * Options for the layout of a light map. 0 in a field always stands for the default.
 */
typedef struct etd_atlas_options {
    /**
     * `sizeof(etd_atlas_options)`.
     */
    size_t struct_size;
    /**
     * Number of texels along each side of the square, 8192 at most; 0: as many as `texels_per_unit` needs, or 512 if that is 0
     * too.
     */
    uint32_t resolution;
    /**
     * Width of the gutter around each chart in texels, 64 at most; 0 means 2, and `UINT32_MAX` means none. Bilinear lookups
     * need a gutter of one texel.
     */
    uint32_t gutter;
    /**
     * Number of texels per scene unit; 0: as many as fit.
     */
    double texels_per_unit;
    /**
     * Greatest angle between the normals of a chart's triangles and that of its first triangle, degrees, below 90; 0 means 45.
     */
    double max_angle_deg;
    /**
     * An `etd_atlas_layout`.
     */
    etd_atlas_layout layout;
    /**
     * Memory limit of the atlas and its bakes, MiB; 0 means 4096. The device's limit also applies.
     */
    uint32_t memory;
    /**
     * Must be 0.
     */
    uint64_t reserved;
    /**
     * Progress callback; may be NULL.
     */
    etd_progress_fn progress;
    /**
     * Passed to `progress`.
     */
    void *user_data;
} etd_atlas_options;

/**
 * Size of an atlas, and the numbers of its parts.
 */
typedef struct etd_atlas_info {
    /**
     * `sizeof(etd_atlas_info)`.
     */
    size_t struct_size;
    /**
     * Number of texels in a row.
     */
    uint32_t width;
    /**
     * Number of rows.
     */
    uint32_t height;
    /**
     * Number of vertices of all surfaces.
     */
    size_t vertex_count;
    /**
     * Number of triangles of all surfaces.
     */
    size_t triangle_count;
    /**
     * Number of surfaces in the atlas.
     */
    size_t surface_count;
    /**
     * Number of charts.
     */
    size_t chart_count;
    /**
     * Number of texels that triangles cover.
     */
    size_t covered_texels;
    /**
     * Number of texels per scene unit in the plane of a chart; the mean for meshes with their own layout.
     */
    double texels_per_unit;
} etd_atlas_info;

/**
 * A corner of a light-mapped triangle.
 */
typedef struct etd_atlas_vertex {
    /**
     * Position in the world frame.
     */
    double position[3];
    /**
     * Unit normal: the shading normal of a smooth surface, and otherwise the mean of the normals of the chart's triangles at
     * the vertex.
     */
    float normal[3];
    /**
     * Position in the light map, in [0, 1]; (0, 0) is the outer corner of the first texel of row 0.
     */
    float uv[2];
    /**
     * Number of the vertex on its surface: in the mesh as it was added, or of the corner of a triangle or a quad; consecutive
     * numbers on other shapes.
     */
    uint32_t source;
} etd_atlas_vertex;

/**
 * A surface in a light map.
 */
typedef struct etd_atlas_surface {
    /**
     * Number of the surface in the scene.
     */
    uint32_t surface;
    /**
     * Number of the surface's first vertex in the atlas.
     */
    uint32_t first_vertex;
    /**
     * Number of the surface's vertices.
     */
    uint32_t vertex_count;
    /**
     * Number of the surface's first triangle in the atlas.
     */
    uint32_t first_triangle;
    /**
     * Number of the surface's triangles.
     */
    uint32_t triangle_count;
    /**
     * 1 if the mesh's own texture coordinates are the layout, else 0.
     */
    uint32_t has_own_layout;
    /**
     * If `has_own_layout` is 1: scale and offset from the mesh's (u, v) to the position in the light map, which is (u, v) times
     * the first two numbers, plus the last two. Otherwise 0.
     */
    float scale_offset[4];
} etd_atlas_surface;

/**
 * The arrays of the host that receive a bake.
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
     * Standard error of the irradiance [W m^-2], in the same layout as `irradiance`; NaN where there are too few samples for an
     * estimate. NULL if standard errors are not wanted.
     */
    float *standard_error;
    /**
     * Number of writable bytes at each of the two pointers.
     */
    size_t size;
    /**
     * Bytes from one texel or vertex to the next; 0 means 12, without gaps.
     */
    size_t stride;
    /**
     * Bytes from one row of texels to the next; 0 means rows without gaps.
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

/**
 * A point at which light is measured, world frame.
 */
typedef struct etd_measuring_point {
    /**
     * The point.
     */
    double position[3];
    /**
     * Normal of the plane, or direction that is looked into; any length except 0.
     */
    double direction[3];
} etd_measuring_point;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the message of the last call that failed on this thread, with file, line and JSON path where there are any.
 *
 * The message is UTF-8, never NULL, and empty if no call has failed yet. It is valid until the next failing call on this
 * thread. Calls that succeed do not change it. Thread-safe; each thread has its own message.
 */
const char *etd_last_error_message(void);

/**
 * Returns the parts of the last error of this thread.
 *
 * Fills `*out_error`, whose `struct_size` must be set, and returns `ETD_OK`; `out_error->status` is `ETD_OK` if no call
 * has failed yet. The strings are valid until the next failing call on this thread. Thread-safe.
 */
etd_status etd_last_error(struct etd_error *out_error);

/**
 * Returns the name of a status, such as "ETD_INVALID_SCENE", or "unknown status" for any other number. The string is
 * static. Thread-safe.
 */
const char *etd_status_name(uint32_t status);

/**
 * Returns the version of the linked library as 10000 * major + 100 * minor + patch, for comparison with `ETD_VERSION`.
 * Thread-safe.
 */
uint32_t etd_version(void);

/**
 * Returns the version of the linked library as text, such as "0.1.0". The string is static. Thread-safe.
 */
const char *etd_version_string(void);

/**
 * Makes a device and starts its threads.
 *
 * `options`: NULL for the defaults of `ETD_DEVICE_OPTIONS_INIT`. On `ETD_OK`, `*out_device` is one reference, to be released
 * with `etd_device_release`. Errors: `ETD_INVALID_ARGUMENT` for more than 1024 threads, `ETD_DEVICE` if no thread
 * could be started. Thread-safe.
 */
etd_status etd_device_new(const struct etd_device_options *options,
                          struct etd_device **out_device);

/**
 * Adds a reference to a device. Thread-safe.
 */
etd_status etd_device_retain(struct etd_device *device);

/**
 * Releases a reference to a device; NULL is allowed. Objects that were made with a device keep it alive. Thread-safe.
 */
void etd_device_release(struct etd_device *device);

/**
 * Takes the first failure of a call on this device since the last time that it was taken: returns its status, or `ETD_OK` if
 * there was none, and forgets the failure.
 *
 * A host may thus make many calls and check once. `message`: receives the message, at most `capacity` bytes including the
 * zero byte, unless it is NULL. Thread-safe.
 */
etd_status etd_device_status(struct etd_device *device,
                             char *message,
                             size_t capacity);

/**
 * Returns the number of bytes that hierarchies, placed geometry and films of the device take now, and the greatest number
 * that they have taken. Either pointer may be NULL. Thread-safe.
 */
etd_status etd_device_memory(const struct etd_device *device,
                             uint64_t *out_used,
                             uint64_t *out_peak);

/**
 * Returns what a device is: its threads, and what it runs on. Errors: `ETD_DEVICE` if Embree does not start. Thread-safe.
 */
etd_status etd_device_get_info(const struct etd_device *device,
                               struct etd_device_info *out_info);

/**
 * Makes an empty scene with the default camera, which calls then describe.
 *
 * `options`: NULL for the defaults. On `ETD_OK`, `*out_scene` is one reference. The scene keeps its device alive. Thread-safe.
 */
etd_status etd_scene_new(struct etd_device *device,
                         const struct etd_scene_options *options,
                         struct etd_scene **out_scene);

/**
 * Reads a scene from text in this library's JSON format or in that of the report's renderer.
 *
 * `json`: `json_length` bytes of UTF-8, which need not end with a zero byte. Paths of mesh files are relative to
 * `options->base_dir`. On `ETD_OK`, `*out_scene` is one reference. On an error, `*out_scene` is not changed, and the message
 * contains line and JSON path. The scene is built by `etd_scene_commit` or by the first render. Thread-safe.
 */
etd_status etd_scene_from_json(struct etd_device *device,
                               const char *json,
                               size_t json_length,
                               const struct etd_scene_options *options,
                               struct etd_scene **out_scene);

/**
 * Reads a scene from a file: of glTF 2.0 where its name ends in `.gltf` or `.glb`, otherwise JSON. Paths of mesh files are relative
 * to the file's folder, and `options->base_dir` is ignored.
 *
 * A file whose name ends in `.obj`, `.ply` or `.stl` is a scene by itself: its surfaces, seen as a whole by a camera that is
 * made for them, under an even sky where nothing in them emits a radiance above 1. All other files are read as JSON.
 *
 * Images are decoded by several threads. `options->progress` is told how far the reading of mesh files and images is, and may cancel it
 * within a file: `ETD_CANCELLED`. A program that is not to wait calls this on a thread of its own.
 *
 * `path`: UTF-8. All else is as for `etd_scene_from_json`. Thread-safe.
 */
etd_status etd_scene_from_file(struct etd_device *device,
                               const char *path,
                               const struct etd_scene_options *options,
                               struct etd_scene **out_scene);

/**
 * Adds a reference to a scene. Thread-safe.
 */
etd_status etd_scene_retain(struct etd_scene *scene);

/**
 * Releases a reference to a scene; NULL is allowed. Tasks that render a scene keep it alive. Thread-safe.
 */
void etd_scene_release(struct etd_scene *scene);

/**
 * Takes the first failure of a call on this scene since the last time that it was taken: returns its status, or `ETD_OK` if
 * there was none, and forgets the failure.
 *
 * A host may thus describe a scene by many calls and check once. `message`: receives the message, at most `capacity` bytes
 * including the zero byte, unless it is NULL. Thread-safe.
 */
etd_status etd_scene_status(struct etd_scene *scene,
                            char *message,
                            size_t capacity);

/**
 * Builds the parts of the scene that have changed since the last build. It returns at once if nothing has changed.
 *
 * Renders build the scene themselves. Ray queries use the scene as last built. Renders in progress continue with the scene
 * that they began with. `progress` may be NULL; it is called on a building thread, and cancels the build if it returns
 * anything but 0. Errors: errors of the description that only a build can find, `ETD_CANCELLED`, `ETD_OUT_OF_MEMORY`; after an
 * error, the scene as last built stays in use. Thread-safe.
 */
etd_status etd_scene_commit(struct etd_scene *scene,
                            etd_progress_fn progress,
                            void *user_data);

/**
 * Returns counts, memory and extent of the scene as last built. It is an error before the first build. Thread-safe.
 */
etd_status etd_scene_get_info(const struct etd_scene *scene, struct etd_scene_info *out_info);

/**
 * Copies a text about the scene to the caller's buffer. `text`: an `etd_text`.
 *
 * At most `capacity` bytes, including the zero byte, are written. `*out_needed` receives the size of the whole text with its
 * zero byte, unless `out_needed` is NULL. `buffer` may be NULL to get the size only. `ETD_TEXT_INFO` is an error before the
 * first build. Thread-safe.
 */
etd_status etd_scene_copy_text(const struct etd_scene *scene,
                               etd_text which,
                               char *buffer,
                               size_t capacity,
                               size_t *out_needed);

/**
 * Returns the settings of the scene's own `render` block, or the defaults where it has none. A host may change them and pass
 * them to a render. Thread-safe.
 */
etd_status etd_scene_get_render_options(const struct etd_scene *scene,
                                        struct etd_render_options *out_options);

/**
 * Returns the size of the film that the scene's own `render` block asks for: its `crop`, or its `resolution`, or 256 x 256 where it
 * has neither. Thread-safe.
 */
etd_status etd_scene_get_resolution(const struct etd_scene *scene,
                                    uint32_t *out_width,
                                    uint32_t *out_height);

/**
 * Replaces the camera.
 *
 * Errors: `ETD_INVALID_SCENE` if view direction, up vector and angle or width of view do not define an image, or for a lens that
 * is none; `ETD_INVALID_ARGUMENT` for a field that the projection does not have. Thread-safe.
 */
etd_status etd_scene_set_camera(struct etd_scene *scene,
                                const struct etd_camera *camera);

/**
 * Returns the camera as described now. Thread-safe.
 */
etd_status etd_scene_get_camera(const struct etd_scene *scene, struct etd_camera *out_camera);

/**
 * Adds a material.
 *
 * `name`: name for `etd_scene_find_material`, unique among materials; NULL: none. `*out_material` receives the material's
 * number. Errors: `ETD_INVALID_SCENE` for a value out of its range, and for a mixture or a two-sided material of materials that
 * do not exist or come later. Thread-safe.
 */
etd_status etd_scene_add_material(struct etd_scene *scene,
                                  const char *name,
                                  const struct etd_material *material,
                                  uint32_t *out_material);

/**
 * Replaces a material, for all surfaces that have it. The change does not require geometry to be rebuilt. The material keeps its
 * textures, and loses its spectra; a model that does not have a parameter that a texture varies is an error. Thread-safe.
 */
etd_status etd_scene_set_material(struct etd_scene *scene,
                                  uint32_t material,
                                  const struct etd_material *value);

/**
 * Returns a material as described now, without the parameters of a principled material, which `etd_scene_get_principled`
 * returns. Thread-safe.
 */
etd_status etd_scene_get_material(const struct etd_scene *scene,
                                  uint32_t material,
                                  struct etd_material *out_material);

/**
 * Adds a point light, which emits equally in all directions.
 *
 * `position`: three numbers, world frame. `intensity`: three numbers, radiant intensity [W sr^-1], each >= 0.
 * `*out_light` receives the light's number among point lights. Area lights are surfaces with an emission. Thread-safe.
 */
etd_status etd_scene_add_point_light(struct etd_scene *scene,
                                     const double *position,
                                     const float *intensity,
                                     uint32_t *out_light);

/**
 * Changes the position and intensity of a point light, which keeps its cone or web if it has one; the intensity of a measured lamp is
 * its factor. An intensity of 0 switches it off. The arguments are those of
 * `etd_scene_add_point_light`. Thread-safe.
 */
etd_status etd_scene_set_point_light(struct etd_scene *scene,
                                     uint32_t light,
                                     const double *position,
                                     const float *intensity);

/**
 * Returns position and intensity of a point light as described now, three numbers each; the intensity of a measured lamp is its
 * factor. Thread-safe.
 */
etd_status etd_scene_get_point_light(const struct etd_scene *scene,
                                     uint32_t light,
                                     double *out_position,
                                     float *out_intensity);

/**
 * Adds a spot light. `*out_light` receives the light's number among point lights.
 *
 * Errors: `ETD_INVALID_SCENE` for a direction of length 0 and for angles out of their range. Thread-safe.
 */
etd_status etd_scene_add_spot_light(struct etd_scene *scene, const struct etd_spot_light *spot, uint32_t *out_light);

/**
 * Makes a point light of any kind a spot light. The errors are those of `etd_scene_add_spot_light`. Thread-safe.
 */
etd_status etd_scene_set_spot_light(struct etd_scene *scene, uint32_t light, const struct etd_spot_light *spot);

/**
 * Returns a spot light as described now. Errors: `ETD_INVALID_ARGUMENT` for a point light that is none. Thread-safe.
 */
etd_status etd_scene_get_spot_light(const struct etd_scene *scene, uint32_t light, struct etd_spot_light *out_spot);

/**
 * Adds a measured lamp. `*out_light` receives the light's number among point lights.
 *
 * Errors: `ETD_INVALID_ARGUMENT` for neither a file nor a text, or both; `ETD_IO` for a file that cannot be read; `ETD_INVALID_SCENE` for
 * contents that are of neither format or wrong, with the line, and for a direction of length 0. Thread-safe.
 */
etd_status etd_scene_add_web_light(struct etd_scene *scene,
                                   const struct etd_web_light *web,
                                   uint32_t *out_light);

/**
 * Makes a point light of any kind a measured lamp, or changes one: without a file and a text, it keeps its intensities. The errors
 * are those of `etd_scene_add_web_light`, and `ETD_INVALID_ARGUMENT` for a light that has no intensities to keep. Thread-safe.
 */
etd_status etd_scene_set_web_light(struct etd_scene *scene,
                                   uint32_t light,
                                   const struct etd_web_light *web);

/**
 * Returns how a measured lamp is turned now, without its intensities. Errors: `ETD_INVALID_ARGUMENT` for a point light that is none.
 * Thread-safe.
 */
etd_status etd_scene_get_web_light(const struct etd_scene *scene,
                                   uint32_t light,
                                   struct etd_web_light *out_web);

/**
 * Sets the light that comes from infinity, the same from all directions: a sky.
 *
 * `radiance`: three numbers, radiance [W m^-2 sr^-1], each >= 0; NULL: none. Thread-safe.
 */
etd_status etd_scene_set_environment(struct etd_scene *scene, const float *radiance);

/**
 * Returns the radiance that comes from infinity as described now, three numbers: 0 where there is no environment.
 * Thread-safe.
 */
etd_status etd_scene_get_environment(const struct etd_scene *scene, float *out_radiance);

/**
 * Sets the openings through which light from infinity comes into rooms, such as windows. They make it found sooner there, and change
 * nothing else: light that comes in elsewhere counts all the same.
 *
 * `corners`: four positions in order around the edge for each of the `count` openings, twelve numbers; for a triangle the last corner
 * is given twice. `count` 0: none. They belong to the environment: another one that is set has none. Errors: `ETD_INVALID_SCENE` for a
 * scene without an environment, for more than 256 openings or one without an area. Thread-safe.
 */
etd_status etd_scene_set_portals(struct etd_scene *scene,
                                 const double *corners,
                                 size_t count);

/**
 * Returns the openings of the environment as `etd_scene_set_portals` takes them: `out_count` receives their number, and `out_corners`,
 * where it is not NULL, twelve numbers for each of the first `capacity`. Thread-safe.
 */
etd_status etd_scene_get_portals(const struct etd_scene *scene,
                                 double *out_corners,
                                 size_t capacity,
                                 size_t *out_count);

/**
 * Sets the light that comes from infinity by a texture of all directions, or the same from all directions where `map->texture` is
 * `ETD_NONE`.
 *
 * `map`: NULL for no light from infinity. Errors: `ETD_INVALID_SCENE` if there is no such texture, if it does not have the shape of
 * the projection, is projected on surfaces or multiplied by the colours of vertices, or is an image that is scaled, turned or moved.
 * Thread-safe.
 */
etd_status etd_scene_set_environment_map(struct etd_scene *scene,
                                         const struct etd_environment_map *map);

/**
 * Returns the light that comes from infinity as described now. Without any, the radiance is 0 and the texture `ETD_NONE`.
 * Thread-safe.
 */
etd_status etd_scene_get_environment_map(const struct etd_scene *scene,
                                         struct etd_environment_map *out_map);

/**
 * Sets the picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing: mirrors and glass
 * show what comes from infinity.
 *
 * `backplate`: NULL for none. Errors: `ETD_INVALID_SCENE` for a radiance below 0, and if there is no such texture, or if it is projected
 * on surfaces or multiplied by the colours of vertices. Thread-safe.
 */
etd_status etd_scene_set_backplate(struct etd_scene *scene,
                                   const struct etd_backplate *backplate);

/**
 * Returns the picture behind everything as described now. Without any, the radiance is 0 and the texture `ETD_NONE`. Thread-safe.
 */
etd_status etd_scene_get_backplate(const struct etd_scene *scene,
                                   struct etd_backplate *out_backplate);

/**
 * Adds light that comes from one direction of infinity, such as that of the sun.
 *
 * `*out_light` receives its number among such lights. Errors: `ETD_INVALID_SCENE` for a direction of 0, an irradiance below 0 or
 * an angle beyond its range. Thread-safe.
 */
etd_status etd_scene_add_distant_light(struct etd_scene *scene,
                                       const struct etd_distant_light *value,
                                       uint32_t *out_light);

/**
 * Changes light that comes from one direction. An irradiance of 0 switches it off. Thread-safe.
 */
etd_status etd_scene_set_distant_light(struct etd_scene *scene, uint32_t light, const struct etd_distant_light *value);

/**
 * Returns light that comes from one direction as described now. Thread-safe.
 */
etd_status etd_scene_get_distant_light(const struct etd_scene *scene,
                                       uint32_t light,
                                       struct etd_distant_light *out_value);

/**
 * Sets the light that comes from infinity all around to a sky by a formula. It takes the place of that of
 * `etd_scene_set_environment` and `etd_scene_set_environment_map`.
 *
 * Errors: `ETD_INVALID_SCENE` for numbers beyond their range, a sun below the horizon and a
 * formula that gives no light; `ETD_INVALID_ARGUMENT` for a type that the CIE does not have, and for a `turbidity` beside `cie` or
 * `horizontal`. Thread-safe.
 */
etd_status etd_scene_set_sky(struct etd_scene *scene,
                             const struct etd_sky *sky);

/**
 * Returns the sky by a formula as described now. Where there is none, its radiance is 0. Thread-safe.
 */
etd_status etd_scene_get_sky(const struct etd_scene *scene, struct etd_sky *out_sky);

/**
 * Returns the direction towards the sun from a place on the earth at a time, in a world whose x is east, y up and -z north.
 *
 * `latitude_deg`: degrees north of the equator, in [-90, 90]. `longitude_deg`: degrees east of Greenwich, in [-360, 360].
 * `seconds`: since 1970-01-01 00:00 UTC; the direction is within 0.01 degrees from 1950 to 2050, without refraction. `out_direction`
 * receives three numbers, a unit vector. Errors: `ETD_INVALID_ARGUMENT` for numbers beyond their range. Thread-safe.
 */
etd_status etd_sun_direction(double latitude_deg,
                             double longitude_deg,
                             double seconds,
                             double *out_direction);

/**
 * Gives a light, an emission or a parameter of a material a spectrum of its own, or takes it away where `spectrum` is NULL, which leaves
 * the colour that the spectrum had. Renders in wavelengths use it, and others its colour. A light keeps its luminance; a surface or a
 * material without an emission gets the radiance that the spectrum says, and 1 of an illuminant.
 *
 * `number`: of the surface, light or material; 0 for the environment. `etd_scene_set_material` takes the spectra of a material away.
 *
 * Errors: `ETD_INVALID_SCENE` for samples that are no spectrum, for light that no one sees, for values out of the range of the parameter,
 * and for a parameter that the material does not have; `ETD_UNSUPPORTED` for a sky by a formula and for a shape that cannot emit.
 * Thread-safe.
 */
etd_status etd_scene_set_spectrum(struct etd_scene *scene,
                                  etd_spectrum_target target,
                                  uint32_t number,
                                  const struct etd_spectrum *spectrum);

/**
 * Returns the spectrum that a light, an emission or a parameter of a material has, without its samples, of which `sample_count` is the
 * number. Errors: `ETD_INVALID_ARGUMENT` for one that has none of its own. Thread-safe.
 */
etd_status etd_scene_get_spectrum(const struct etd_scene *scene,
                                  etd_spectrum_target target,
                                  uint32_t number,
                                  struct etd_spectrum *out_spectrum);

/**
 * Returns the parameters of a principled material as described now.
 *
 * Errors: `ETD_INVALID_ARGUMENT` for a material of another model. Thread-safe.
 */
etd_status etd_scene_get_principled(const struct etd_scene *scene,
                                    uint32_t material,
                                    struct etd_principled *out_principled);

/**
 * Returns the complex index of refraction of a measured metal, for `eta` and `k` of an `ETD_BSDF_CONDUCTOR`.
 *
 * `symbol`: Ag, Al, Au, Cr, Cu, Fe, Hg, Ir, Ni, Rh, TiN or W. `*out_eta` and `*out_k` each receive three numbers, at 650, 550
 * and 450 nm. Errors: `ETD_INVALID_ARGUMENT` for another symbol. Thread-safe.
 */
etd_status etd_metal(const char *symbol,
                     float *out_eta,
                     float *out_k);

/**
 * Adds a sphere with its normals outwards. `centre`: three numbers; `radius` > 0. A transform that stretches the sphere makes
 * it an ellipsoid, which cannot emit.
 *
 * The following holds for all calls that add a surface. `surface` contains material, emission and transform. `*out_surface`
 * receives the surface's number. Errors are `ETD_INVALID_SCENE` and `ETD_UNSUPPORTED`, with the JSON path that a file would
 * have. Thread-safe.
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
 * Adds a flat convex quadrilateral with the normal (v1 - v0) x (v2 - v0). `vertices`: four positions in order around the edge,
 * twelve numbers. Thread-safe.
 */
etd_status etd_scene_add_quad(struct etd_scene *scene,
                              const double *vertices,
                              const struct etd_surface *surface,
                              uint32_t *out_surface);

/**
 * Adds a flat round disk. `normal`: any length. Thread-safe.
 */
etd_status etd_scene_add_disk(struct etd_scene *scene,
                              const double *centre,
                              const double *normal,
                              double radius,
                              const struct etd_surface *surface,
                              uint32_t *out_surface);

/**
 * Adds a cylinder without caps, normals outwards. `base`: centre of one end; `axis`: direction to the other end, any length.
 * Thread-safe.
 */
etd_status etd_scene_add_cylinder(struct etd_scene *scene,
                                  const double *base,
                                  const double *axis,
                                  double radius,
                                  double height,
                                  const struct etd_surface *surface,
                                  uint32_t *out_surface);

/**
 * Adds a cone without its base disk, normals outwards. `base`: centre of the base; `axis`: direction to the apex, any length.
 * A cone cannot emit. Thread-safe.
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
 * into the paraboloid; `radius`: radius at `height`. A paraboloid cannot emit. Thread-safe.
 */
etd_status etd_scene_add_paraboloid(struct etd_scene *scene,
                                    const double *apex,
                                    const double *axis,
                                    double radius,
                                    double height,
                                    const struct etd_surface *surface,
                                    uint32_t *out_surface);

/**
 * Adds an ellipsoid with its axes along x, y and z, normals outwards. `radii`: three numbers > 0. An
 * ellipsoid cannot emit. Thread-safe.
 */
etd_status etd_scene_add_ellipsoid(struct etd_scene *scene,
                                   const double *centre,
                                   const double *radii,
                                   const struct etd_surface *surface,
                                   uint32_t *out_surface);

/**
 * Adds a quadric: a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0, normals along the gradient.
 *
 * `coefficients`: ten numbers, a to j. `clip_min`, `clip_max`: corners of a box that clips the quadric; both may be NULL for
 * an ellipsoid, which is bounded. A quadric cannot emit. Thread-safe.
 */
etd_status etd_scene_add_quadric(struct etd_scene *scene,
                                 const double *coefficients,
                                 const double *clip_min,
                                 const double *clip_max,
                                 const struct etd_surface *surface,
                                 uint32_t *out_surface);

/**
 * Adds a surface that uses a mesh. Any number of surfaces may use a mesh, which is stored once.
 *
 * `smooth`: if not 0, normals are interpolated between vertices; a mesh without vertex normals gets them from its faces.
 * Thread-safe.
 */
etd_status etd_scene_add_mesh_surface(struct etd_scene *scene,
                                      uint32_t mesh,
                                      uint32_t smooth,
                                      const struct etd_surface *surface,
                                      uint32_t *out_surface);

/**
 * Adds the surfaces of a Wavefront OBJ file with the materials that the file names (`usemtl`) in its material libraries
 * (`mtllib`): a mesh, a material and a surface for each material that faces have.
 *
 * `path`: UTF-8, relative to the current folder. `smooth` is as in `etd_scene_add_mesh_surface`. `transform`: three rows of four
 * numbers, invertible; NULL: the identity. `*out_first` receives the number of the first surface and `*out_count` how many
 * there are; their numbers follow one another, and `etd_scene_get_surface` returns the number of their material. A material is
 * named after the file and the library's name for it, as in `car.obj:paint`; where that name is taken, it has none.
 * Errors: `ETD_IO` for a file that cannot be read, `ETD_INVALID_SCENE` for a face without a material, for a material that no
 * library has, and for a file with invalid content. Thread-safe.
 */
etd_status etd_scene_add_file_surfaces(struct etd_scene *scene,
                                       const char *path,
                                       uint32_t smooth,
                                       const double *transform,
                                       uint32_t *out_first,
                                       uint32_t *out_count);

/**
 * Removes a surface. Its number is not used again, and the numbers of other surfaces do not change. Thread-safe.
 */
etd_status etd_scene_remove_surface(struct etd_scene *scene, uint32_t surface);

/**
 * Sets the transform of a surface from its object frame to the world frame. `transform`: three rows of four numbers,
 * invertible. It replaces the previous transform. The position that a shape was added with (such as a cylinder's base) is one
 * in the object frame, so the transform moves the whole shape. Thread-safe.
 */
etd_status etd_scene_set_transform(struct etd_scene *scene,
                                   uint32_t surface,
                                   const double *transform);

/**
 * Gives a surface another material. `ETD_NONE` is allowed for a surface that emits, which then reflects nothing. Thread-safe.
 */
etd_status etd_scene_set_surface_material(struct etd_scene *scene,
                                          uint32_t surface,
                                          uint32_t material);

/**
 * Sets the radiance that a surface emits [W m^-2 sr^-1]. `radiance`: three numbers >= 0; NULL or three zeros for a surface
 * that has no emission of its own. Thread-safe.
 */
etd_status etd_scene_set_emission(struct etd_scene *scene,
                                  uint32_t surface,
                                  const float *radiance);

/**
 * Sets whether a surface that emits does so on both of its sides (`both` is not 0), with the same radiance, or on that of its normal
 * only, which is the default. It stays so when the emission changes.
 *
 * Errors, for both sides: `ETD_INVALID_SCENE` for a surface that emits no light, neither by itself nor by its material;
 * `ETD_UNSUPPORTED` for a sphere, whose inside is closed. Thread-safe.
 */
etd_status etd_scene_set_emits_both(struct etd_scene *scene,
                                    uint32_t surface,
                                    uint32_t both);

/**
 * Names the object that a surface is, or is a part of, in mattes (`etd_scene_trace_mattes`): all surfaces of one name are one object.
 * NULL or an empty text takes the name away. `name`: UTF-8, which is copied. No picture depends on names, so nothing is built
 * again. Thread-safe.
 */
etd_status etd_scene_set_surface_name(struct etd_scene *scene,
                                      uint32_t surface,
                                      const char *name);

/**
 * Copies the name of a surface to the caller's buffer: an empty text for one that has none. `buffer`, `capacity` and `out_needed` are as
 * in `etd_scene_copy_text`. It is an error if the surface was removed. Thread-safe.
 */
etd_status etd_scene_get_surface_name(const struct etd_scene *scene,
                                      uint32_t surface,
                                      char *buffer,
                                      size_t capacity,
                                      size_t *out_needed);

/**
 * Lets a flat surface shine as a photometric web says, or evenly again where `web` is NULL. With a web, the emission of the surface is a
 * factor on the file's candela over 683 lm/W, 1 in each channel for the lamp as it was measured, and no radiance. A surface keeps its web
 * when its emission changes; without an emission of its own, the web has no effect. Without a file and a text, a surface that has a web
 * keeps its intensities.
 *
 * Errors: `ETD_UNSUPPORTED` for a shape that is not flat; `ETD_INVALID_SCENE` for a file with light beyond 90 degrees from the normal on
 * a surface that does not emit on both sides, for contents that are of neither format or wrong, with the line, and for a direction or
 * a tilt out of range; `ETD_INVALID_ARGUMENT` for both a file and a text, or neither where there are no intensities to keep; `ETD_IO` for
 * a file that cannot be read. Meshes that are not flat, motion and textures of emission are refused when the scene is built.
 * Thread-safe.
 */
etd_status etd_scene_set_surface_web(struct etd_scene *scene,
                                     uint32_t surface,
                                     const struct etd_surface_web *web);

/**
 * Returns how the photometric web of a surface is turned, without its intensities. Errors: `ETD_INVALID_ARGUMENT` for a surface that has
 * none or that was removed. Thread-safe.
 */
etd_status etd_scene_get_surface_web(const struct etd_scene *scene,
                                     uint32_t surface,
                                     struct etd_surface_web *out_web);

/**
 * Returns material, own emission and transform of a surface as described now. It is an error if the surface was removed.
 * Thread-safe.
 */
etd_status etd_scene_get_surface(const struct etd_scene *scene,
                                 uint32_t surface,
                                 struct etd_surface *out_surface);

/**
 * Returns the number of the material with a name. Thread-safe.
 */
etd_status etd_scene_find_material(const struct etd_scene *scene, const char *name, uint32_t *out_material);

/**
 * Returns the number of the mesh with a name. Thread-safe.
 */
etd_status etd_scene_find_mesh(const struct etd_scene *scene, const char *name, uint32_t *out_mesh);

/**
 * Returns the number of the surface with a JSON path, such as `surfaces[3]` or, for an area light, `lights[0]`. Thread-safe.
 */
etd_status etd_scene_find_surface(const struct etd_scene *scene,
                                  const char *json_path,
                                  uint32_t *out_surface);

/**
 * Adds a mesh from arrays. `*out_mesh` receives its number, for `etd_scene_add_mesh_surface`.
 *
 * Errors: `ETD_INVALID_ARGUMENT` for sizes, strides or pointers that are not possible, `ETD_INVALID_SCENE` for a number that
 * is not finite or an index without a vertex, with its place. Triangles without area are allowed. Thread-safe.
 */
etd_status etd_scene_add_mesh(struct etd_scene *scene,
                              const struct etd_mesh *mesh,
                              uint32_t *out_mesh);

/**
 * Adds a mesh from a Wavefront OBJ, PLY or STL file, told apart by the name's extension or else by the content. `name`: name for `etd_scene_find_mesh`, unique among meshes; NULL: none. `path`:
 * UTF-8, relative to the current folder. `*out_mesh` receives the mesh's number. Other calls on the scene do not wait while the file is
 * read. `etd_scene_add_mesh_file_with_progress` says how far it is. Thread-safe.
 */
etd_status etd_scene_add_mesh_file(struct etd_scene *scene,
                                   const char *name,
                                   const char *path,
                                   uint32_t *out_mesh);

/**
 * Adds a mesh from a file as `etd_scene_add_mesh_file` does, and says meanwhile how far the reading is.
 *
 * `progress` is called on the calling thread, with the fraction of the file's bytes that are read and with 1 before the mesh is added,
 * and cancels the reading if it returns anything but 0; NULL: none. It may call the library, on this scene too. `user_data` is passed to
 * it. A file that is as good as read may go on for a while after a cancel: of an OBJ file, what is put together after its last byte.
 * Errors: those of `etd_scene_add_mesh_file`, and `ETD_CANCELLED`, after which the scene is as it was. Thread-safe.
 */
etd_status etd_scene_add_mesh_file_with_progress(struct etd_scene *scene,
                                                 const char *name,
                                                 const char *path,
                                                 etd_progress_fn progress,
                                                 void *user_data,
                                                 uint32_t *out_mesh);

/**
 * Adds a mesh that another scene has, without a copy: both scenes read the same arrays, and an array of the host's memory (`ETD_SHARE`)
 * is released once, when neither scene and no build or render reads it any more.
 *
 * Steps in which the mesh deforms come along. Later changes of the mesh in one scene, by `etd_scene_set_mesh`,
 * `etd_scene_set_mesh_steps` or `etd_scene_remove_mesh`, are none in the other. The scenes build hierarchies, and the vertices that they
 * place, each for itself, which their devices' memory limits count. The devices may be different ones. `source` may be `scene` itself,
 * for the same mesh with other steps; for more surfaces of a mesh, `etd_scene_add_mesh_surface` is enough. Messages about the arrays
 * name the mesh as the first scene does. `name`: name for `etd_scene_find_mesh` in `scene`, unique among its meshes; NULL: none.
 * `*out_mesh` receives the number of the mesh in `scene`. Errors: `ETD_INVALID_ARGUMENT` for a number that no mesh of `source` has,
 * `ETD_INVALID_SCENE` for a mesh that was removed and for a name that is taken. Thread-safe.
 */
etd_status etd_scene_add_mesh_from(struct etd_scene *scene,
                                   const char *name,
                                   const struct etd_scene *source,
                                   uint32_t source_mesh,
                                   uint32_t *out_mesh);

/**
 * Replaces the arrays of a mesh, for all surfaces that use it. Arrays that were shared before are released once no build and
 * no render reads them any more. The `name` in `value` is ignored. Thread-safe.
 */
etd_status etd_scene_set_mesh(struct etd_scene *scene,
                              uint32_t mesh,
                              const struct etd_mesh *value);

/**
 * Removes a mesh that no surface and no group uses any more, and frees its memory. Its number is not used again. Thread-safe.
 */
etd_status etd_scene_remove_mesh(struct etd_scene *scene,
                                 uint32_t mesh);

/**
 * Returns what a surface is, as described now. Surfaces are numbered from 0; `etd_scene_info.surfaces` says how many there are. A surface
 * that was removed has the kind `ETD_SHAPE_NONE`. Material and transform: `etd_scene_get_surface`. Thread-safe.
 */
etd_status etd_scene_get_shape(const struct etd_scene *scene,
                               uint32_t surface,
                               struct etd_shape *out_shape);

/**
 * Returns what a mesh has, as described now. Meshes are numbered from 0; `etd_scene_info.meshes` says how many there are. Thread-safe.
 */
etd_status etd_scene_get_mesh(const struct etd_scene *scene,
                              uint32_t mesh,
                              struct etd_mesh_info *out_info);

/**
 * Copies the arrays of a mesh, as described now, into memory of the host.
 *
 * `vertex_count`, `triangle_count`: those of `etd_scene_get_mesh`; if the mesh has other numbers by now, nothing is written.
 * `positions`: three doubles for each vertex. `normals`: three floats for each vertex. `uvs`: two floats for each vertex. `indices`:
 * three numbers of vertices for each triangle. Each of them may be NULL. Error: `ETD_INVALID_ARGUMENT` also for normals or texture coordinates
 * that the mesh does not have. Thread-safe.
 */
etd_status etd_scene_copy_mesh(const struct etd_scene *scene,
                               uint32_t mesh,
                               size_t vertex_count,
                               size_t triangle_count,
                               double *positions,
                               float *normals,
                               float *uvs,
                               uint32_t *indices);

/**
 * Makes a group of copies of surfaces, as they are at this moment, to be placed as often as wanted. The frame of the group is the world's.
 * The surfaces themselves stay what they are; those that were only made for the group can be removed.
 *
 * `name`: UTF-8, not the name of another group; NULL or an empty text: none. `surfaces`: `count` numbers of surfaces, at least one. `*out_group`
 * receives the number of the group. No picture depends on a group that is not placed. Errors: `ETD_INVALID_SCENE` for a name that is
 * taken and for a surface that was removed; `ETD_UNSUPPORTED` for a surface that moves by keyframes. Thread-safe.
 */
etd_status etd_scene_add_group(struct etd_scene *scene,
                               const char *name,
                               const uint32_t *surfaces,
                               size_t count,
                               uint32_t *out_group);

/**
 * Places a group: adds a copy of each of its surfaces. Each is a surface like any other, with a number of its own, and can be changed and removed
 * by itself.
 *
 * `transform`: from the group's frame to the world, three rows of four numbers, invertible; NULL: the identity. `*out_placement` receives the
 * number of the placement, and `*out_first_surface` that of the first of its surfaces, which follow one another in the order of the
 * group's; it may be NULL. Memory and time to build grow with the number of surfaces. The triangles of meshes, and the hierarchy over all
 * meshes of a group, are shared between its placements where they are many (docs/c-api.md). Errors: those of
 * `etd_scene_set_transform`; `ETD_INVALID_SCENE` for a group that was removed; `ETD_UNSUPPORTED` where scene and groups would have more than
 * 4194304 surfaces, removed ones among them. Thread-safe.
 */
etd_status etd_scene_place_group(struct etd_scene *scene,
                                 uint32_t group,
                                 const double *transform,
                                 uint32_t *out_placement,
                                 uint32_t *out_first_surface);

/**
 * Moves a placement as a whole. `transform`: from the group's frame to the world, three rows of four numbers, invertible. It replaces the
 * previous one. Surfaces of the placement that were moved by themselves come back to their places in the group. Thread-safe.
 */
etd_status etd_scene_set_placement_transform(struct etd_scene *scene,
                                             uint32_t placement,
                                             const double *transform);

/**
 * Sets the keyframes of a placement, which move all of its surfaces after their transforms. 0 of them: it rests. The errors are those of
 * `etd_scene_set_surface_motion`. Thread-safe.
 */
etd_status etd_scene_set_placement_motion(struct etd_scene *scene,
                                          uint32_t placement,
                                          const struct etd_motion_key *keys,
                                          size_t count);

/**
 * Removes a placement with its surfaces. Its number and those of its surfaces are not used again, and no other number changes. Thread-safe.
 */
etd_status etd_scene_remove_placement(struct etd_scene *scene,
                                      uint32_t placement);

/**
 * Removes a group that is placed nowhere any more, and frees what it keeps. Its number is not used again. Errors: `ETD_INVALID_SCENE` while
 * it is placed, and for a group that was removed. Thread-safe.
 */
etd_status etd_scene_remove_group(struct etd_scene *scene,
                                  uint32_t group);

/**
 * Returns which group is placed, the number of the first of its surfaces here, how many there are, and the placement's transform as
 * described now: three rows of four numbers. Each of the four may be NULL. It is an error if the placement was removed. Thread-safe.
 */
etd_status etd_scene_get_placement(const struct etd_scene *scene,
                                   uint32_t placement,
                                   uint32_t *out_group,
                                   uint32_t *out_first_surface,
                                   uint32_t *out_surface_count,
                                   double *out_transform);

/**
 * Returns the number of the group with a name. Thread-safe.
 */
etd_status etd_scene_find_group(const struct etd_scene *scene, const char *name, uint32_t *out_group);

/**
 * Sets when the shutter is open. Errors: `ETD_INVALID_SCENE` for one that closes before it opens, and for a curve with a number below 0
 * or without one above it. Thread-safe.
 */
etd_status etd_scene_set_shutter(struct etd_scene *scene,
                                 const struct etd_shutter *shutter);

/**
 * Returns when the shutter is open as described now, without the numbers of its curve. Thread-safe.
 */
etd_status etd_scene_get_shutter(const struct etd_scene *scene, struct etd_shutter *out_shutter);

/**
 * Sets the keyframes of the camera, which move it from where `etd_scene_set_camera` has it and keep lengths. 0 of them: it rests.
 * Errors: `ETD_INVALID_SCENE` for keyframes out of order, numbers out of range, and a camera that is stretched or mirrored. Thread-safe.
 */
etd_status etd_scene_set_camera_motion(struct etd_scene *scene,
                                       const struct etd_motion_key *keys,
                                       size_t count);

/**
 * Sets the keyframes of a surface, which move it after its transform. 0 of them: it rests. The errors are those of
 * `etd_scene_set_camera_motion`, and `ETD_INVALID_SCENE` for a surface that is flattened between two keyframes. A surface whose emission
 * a texture varies cannot move; the build refuses it with `ETD_UNSUPPORTED`. Thread-safe.
 */
etd_status etd_scene_set_surface_motion(struct etd_scene *scene,
                                        uint32_t surface,
                                        const struct etd_motion_key *keys,
                                        size_t count);

/**
 * Sets the keyframes of a point light of any kind, which move it and turn the direction in which it shines. 0 of them: it rests. The
 * errors are those of `etd_scene_set_camera_motion`. Thread-safe.
 */
etd_status etd_scene_set_light_motion(struct etd_scene *scene,
                                      uint32_t light,
                                      const struct etd_motion_key *keys,
                                      size_t count);

/**
 * Sets the vertices of a mesh at some moments, between which they move along straight lines. 0 of them: the mesh does not deform.
 *
 * `times`: `count` times in seconds, each later than the one before. `positions`: for each of them three numbers for each vertex of the
 * mesh, one moment after another. `normals`: the same for normals, or NULL, where smooth surfaces have those of their faces. The arrays
 * are copied. Errors: `ETD_INVALID_SCENE` for times out of order and numbers out of range, `ETD_UNSUPPORTED` for a mesh that is read in
 * the host's memory (`ETD_SHARE`). `etd_scene_set_mesh` removes the moments. Thread-safe.
 */
etd_status etd_scene_set_mesh_steps(struct etd_scene *scene,
                                    uint32_t mesh,
                                    const double *times,
                                    size_t count,
                                    const double *positions,
                                    const float *normals);

/**
 * Adds a texture, which materials may then use (`etd_scene_set_material_texture`).
 *
 * `name`: name for `etd_scene_find_texture`, unique among textures; NULL: none. `*out_texture` receives the texture's number.
 * Errors: `ETD_INVALID_ARGUMENT` for sizes, strides or pointers that are not possible, `ETD_IO` and `ETD_UNSUPPORTED` for a
 * file, `ETD_INVALID_SCENE` for a number out of range or a texel that is not finite. Thread-safe.
 */
etd_status etd_scene_add_texture(struct etd_scene *scene,
                                 const char *name,
                                 const struct etd_texture *texture,
                                 uint32_t *out_texture);

/**
 * Replaces a texture, for all materials that use it. Only this texture is prepared again in the next build. Texels that were
 * shared before are released once no build and no render reads them any more. Thread-safe.
 */
etd_status etd_scene_set_texture(struct etd_scene *scene,
                                 uint32_t texture,
                                 const struct etd_texture *value);

/**
 * Takes note that the host has changed texels that it shares with this texture. Only this texture is prepared again in the
 * next build. Errors: `ETD_INVALID_SCENE` for a pattern, and for a texel that is not finite. Thread-safe.
 */
etd_status etd_scene_update_texture(struct etd_scene *scene,
                                    uint32_t texture);

/**
 * Returns a texture as described now. `file`, `texels`, `release` and `user_data` are NULL; size, channels and format are
 * those of the image. Thread-safe.
 */
etd_status etd_scene_get_texture(const struct etd_scene *scene,
                                 uint32_t texture,
                                 struct etd_texture *out_texture);

/**
 * Returns the number of the texture with a name. Thread-safe.
 */
etd_status etd_scene_find_texture(const struct etd_scene *scene, const char *name, uint32_t *out_texture);

/**
 * Sets the texture of one parameter of a material, or removes it.
 *
 * `parameter`: the name that scene files use in a material's `textures`, such as "color", "roughness", "base_color",
 * "opacity", "emission", "normal". `binding`: NULL, or a texture of `ETD_NONE`, for none. Errors: `ETD_INVALID_SCENE` for a parameter that
 * the material does not have. `etd_scene_set_material` keeps the textures of a material. Thread-safe.
 */
etd_status etd_scene_set_material_texture(struct etd_scene *scene,
                                          uint32_t material,
                                          const char *parameter,
                                          const struct etd_texture_binding *binding);

/**
 * Returns the texture of one parameter of a material as described now: `ETD_NONE` where it has none. `parameter`: as for
 * `etd_scene_set_material_texture`. Thread-safe.
 */
etd_status etd_scene_get_material_texture(const struct etd_scene *scene,
                                          uint32_t material,
                                          const char *parameter,
                                          struct etd_texture_binding *out_binding);

/**
 * Makes a film. The film is black and has no samples.
 *
 * `options` must contain the resolution. Any number of renders may use the film, one at a time. On `ETD_OK`, `*out_film` is
 * one reference. Errors: `ETD_INVALID_ARGUMENT` for a resolution out of range or a layer that does not exist,
 * `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit. A film takes 240 to 560 bytes for each pixel of its tiles
 * of 16 x 16 pixels, which count as a whole. Mapped images beyond the second do not count. Thread-safe.
 */
etd_status etd_film_new(struct etd_device *device,
                        const struct etd_film_options *options,
                        struct etd_film **out_film);

/**
 * Adds a reference to a film. Thread-safe.
 */
etd_status etd_film_retain(struct etd_film *film);

/**
 * Releases a reference to a film; NULL is allowed. Tasks that render to a film keep it alive. The release of the last
 * reference ends all maps of the film. Thread-safe.
 */
void etd_film_release(struct etd_film *film);

/**
 * Takes the first failure of a call on this film since the last time that it was taken: returns its status, or `ETD_OK` if
 * there was none, and forgets the failure.
 * `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
 */
etd_status etd_film_status(struct etd_film *film,
                           char *message,
                           size_t capacity);

/**
 * Maps a layer of the newest image for reading: `*out_map` receives a pointer to it.
 *
 * The call is allowed while a render uses the film. The image is then that of the last complete pass, or, during a long pass,
 * that of a moment in it. A mapped image does not change. After a cancelled render, the first call develops the image; at any
 * other time nothing is copied. Each map must be ended by one call of `etd_film_unmap`. `layer`: one `etd_layer` that the film
 * keeps. Thread-safe.
 */
etd_status etd_film_map(struct etd_film *film,
                        etd_layer layer,
                        struct etd_map *out_map);

/**
 * Ends a map. The memory at `map->data` may not be read any more, and `map->data` becomes NULL. Error:
 * `ETD_INVALID_OPERATION` for a map that was ended before. Thread-safe.
 */
etd_status etd_film_unmap(struct etd_film *film, struct etd_map *map);

/**
 * Copies a layer of the newest image to the host's memory.
 *
 * `layer`: one `etd_layer` that the film keeps. `options`: format, tone map, exposure and order of rows; NULL for floats with
 * the top row first. `pixels`: receives the image, `size` bytes. `row_stride`: bytes from one row to the next; 0 for rows
 * without gaps. Errors: `ETD_INVALID_ARGUMENT` for a stride smaller than a row, a size smaller than the image, floats that are
 * not aligned, or a format that the layer does not have. Thread-safe.
 */
etd_status etd_film_copy(const struct etd_film *film,
                         etd_layer layer,
                         const struct etd_image_options *options,
                         void *pixels,
                         size_t size,
                         size_t row_stride);

/**
 * Writes the current image of a film to a file: `.png` (8-bit sRGB), `.exr` (float, with layers) or `.pfm` (float).
 *
 * An EXR contains the layers `samples` and `variance`, and, if the film keeps any of them, albedo,
 * normal and depth, or emission, direct and indirect light; by progressive photon methods also `bias`. Its header
 * contains the summary of the render (`relMSE`, `relMSEStandardError`, `displayError`, `samplesPerPixel`, `rays`, `ended`). A
 * file at `path` is replaced in one step, so that no incomplete file ever appears there. `path`: UTF-8. `options`: NULL for a
 * clamped sRGB picture without comments. Errors: `ETD_IO`, `ETD_UNSUPPORTED` for another extension, `ETD_INVALID_OPERATION`
 * before the first render. Thread-safe.
 */
etd_status etd_film_write(const struct etd_film *film,
                          const char *path,
                          const struct etd_image_options *options);

/**
 * Returns the summary of the last render to this film that has ended, or of a film that was loaded or merged. Error:
 * `ETD_INVALID_OPERATION` before the first one. Thread-safe.
 */
etd_status etd_film_get_summary(const struct etd_film *film, struct etd_summary *out_summary);

/**
 * Gives a film another resolution. The film is then as `etd_film_new` makes it: black, without samples, state and summary. It
 * keeps its handle and its layers.
 *
 * Mapped images stay as they are until they are unmapped; they do not count for the device's memory limit. A task that was cancelled or
 * cut short cannot be resumed while the film has another resolution than when the task was begun, and keeps its samples,
 * which do not count either, until it is released. `images` of `etd_progress` goes on
 * counting with the next image that is rendered; the black one is not counted. Errors, after all of which the film is as
 * it was: `ETD_INVALID_ARGUMENT` for a resolution out of range, `ETD_INVALID_OPERATION` while a render uses the film and while it is
 * saved, merged or gone on from, `ETD_OUT_OF_MEMORY` if the film would exceed the device's memory limit. Thread-safe.
 */
etd_status etd_film_resize(struct etd_film *film,
                           uint32_t width,
                           uint32_t height);

/**
 * Saves the state of the last render to a film, so that `etd_film_load` can read it on any machine: all sums of all pixels, the layers,
 * the estimated errors, and what further samples depend on.
 *
 * A file at `path` is replaced in one step, and stays as it is on an error. A render that was cancelled may be saved, and one that is
 * done. The film is reserved meanwhile: a render to it is refused. So that nobody goes on with another scene, the state knows its scene
 * by a fingerprint. That of a render without `share_count`, `checkpoint_file` and `resume` is made now, of the scene as it was
 * rendered. `path`: UTF-8. Errors: `ETD_IO`; `ETD_INVALID_OPERATION` before the first render, while a render uses the film, and where the
 * fingerprint is still to be made of a scene that was edited or released since. Thread-safe.
 */
etd_status etd_film_save(const struct etd_film *film,
                         const char *path);

/**
 * Saves the state of the last render to a film in the host's memory, with the bytes that `etd_film_save` writes to a file.
 *
 * `buffer`: receives the bytes, `capacity` at most; NULL to ask for their number alone. `out_size`: receives their number, unless it is
 * NULL. Errors: `ETD_INVALID_ARGUMENT` for a buffer that is too small, of which nothing is written, and those of `etd_film_save`.
 * Thread-safe.
 */
etd_status etd_film_save_memory(const struct etd_film *film,
                                void *buffer,
                                size_t capacity,
                                size_t *out_size);

/**
 * Reads a film that `etd_film_save`, a render with `checkpoint_file`, or the command line has written. It may be mapped, copied, written
 * as an image, saved, merged, and given to a render as the state to go on from.
 *
 * `options`: NULL for a film without layers besides the colour. Otherwise width and height are those of the file or both 0, and the layers
 * are kept as by `etd_film_new`. Any bytes may be read: those of no film, cut, or changed anywhere are refused, and take no more memory
 * than the film that they name. The summary of the film has the numbers of samples and rays and the errors; its times are 0, and it
 * says `ETD_ENDED_SAMPLES`. On `ETD_OK`, `*out_film` is one reference. Errors: `ETD_IO` for a file that cannot be read,
 * `ETD_INVALID_SCENE` for one that is damaged or no film, `ETD_UNSUPPORTED` for another version of the format, another size, and layers of
 * first hits that the file does not keep, `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit; all name the file.
 * Thread-safe.
 */
etd_status etd_film_load(struct etd_device *device,
                         const char *path,
                         const struct etd_film_options *options,
                         struct etd_film **out_film);

/**
 * Reads a film from memory, as `etd_film_load` does from a file. `bytes`: `size` of them. Thread-safe.
 */
etd_status etd_film_load_memory(struct etd_device *device,
                                const void *bytes,
                                size_t size,
                                const struct etd_film_options *options,
                                struct etd_film **out_film);

/**
 * Makes the film of a whole picture from those of all its parts, in any order: what one render would have come to, to the last bit.
 *
 * `films`: `count` films, rendered here with `share_number` and `share_count` or loaded; they stay as they are. The new film is of
 * the device of the first of them and keeps its layers. Parts that were stopped have fewer samples; a render with the new film as
 * `resume` makes up for what is missing. Its summary is as that of a film that was loaded. On `ETD_OK`, `*out_film` is one reference.
 * Errors: `ETD_INVALID_ARGUMENT` for parts that are missing or given twice, and for a film that is no part, `ETD_UNSUPPORTED` for parts
 * of different renders with what differs, `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit, and those of
 * `etd_film_save`. Thread-safe.
 */
etd_status etd_film_merge(struct etd_film *const *films,
                          size_t count,
                          struct etd_film **out_film);

/**
 * Returns the number of pixels in a row of a film and its number of rows. Thread-safe.
 */
etd_status etd_film_get_resolution(const struct etd_film *film, uint32_t *out_width, uint32_t *out_height);

/**
 * Returns which part of the picture the last render to a film was of, as `share_number` and `share_count` of its options; 0 and 0 for
 * all of it. Error: `ETD_INVALID_OPERATION` before the first render and while a render uses the film. Thread-safe.
 */
etd_status etd_film_get_share(const struct etd_film *film,
                              uint32_t *out_number,
                              uint32_t *out_count);

/**
 * Renders a scene to a film and returns when the render has ended. A scene that has changed is built first.
 *
 * The film must be of the scene's device. `options`: NULL for the scene's own settings. If the progress callback stops the
 * render, the call returns `ETD_CANCELLED`, and the film holds the samples that were taken. Errors: `ETD_INVALID_OPERATION`
 * while another render uses the film, and the errors of `etd_scene_commit`. The image depends only on the scene, the
 * resolution and the options, and not on threads. Thread-safe: several renders, also of one scene, may run at the same time,
 * each to a film of its own.
 */
etd_status etd_render(struct etd_scene *scene,
                      struct etd_film *film,
                      const struct etd_render_options *options);

/**
 * Starts a task that renders a scene to a film, and returns at once. The task builds the scene first if it has changed.
 *
 * The task does what `etd_render` does, on a thread of its own, or on the host's executor where the device has one. On
 * `ETD_OK`, `*out_task` is one reference. Thread-safe.
 */
etd_status etd_render_start(struct etd_scene *scene,
                            struct etd_film *film,
                            const struct etd_render_options *options,
                            struct etd_task **out_task);

/**
 * Returns the state of a task: `ETD_RUNNING`, or how the task ended, which is `ETD_OK`, `ETD_CANCELLED` or an error. The
 * message of an error becomes this thread's last one. The device's `error` function and `etd_task_status` hear of it from the first
 * call that returns it.
 *
 * `out_progress`: receives the progress, unless it is NULL. The call never waits. Thread-safe.
 */
etd_status etd_task_poll(struct etd_task *task,
                         struct etd_progress *out_progress);

/**
 * Waits until a task has ended, for `seconds` at most (below 0: without a limit), and returns the same as `etd_task_poll`.
 *
 * Once this call has returned anything but `ETD_RUNNING`, the task calls none of its callbacks any more. Inside one of these
 * callbacks, the call returns `ETD_INVALID_OPERATION`. Thread-safe.
 */
etd_status etd_task_wait(struct etd_task *task,
                         double seconds);

/**
 * Asks a task to end soon, in any phase, and returns at once. The task ends with `ETD_CANCELLED`, unless it has already
 * ended. A task that no thread has begun yet ends during this call, which then calls `finished`. Thread-safe, also inside the
 * task's callbacks.
 */
etd_status etd_task_cancel(struct etd_task *task);

/**
 * Resumes a task that was cancelled or that its time limit has ended. The result is the same image as without an
 * interruption.
 *
 * The task continues with the scene that it began with. If the task was cancelled before that scene was built, it continues
 * with the scene as described now. The time limit begins anew. For a complete task, the call does nothing. It returns
 * `ETD_INVALID_OPERATION` while the task runs, after an error, and inside the task's callbacks. If another render has used
 * the film meanwhile, the film shows the image of this task again; a film that was resized meanwhile is `ETD_INVALID_OPERATION`. Thread-safe.
 */
etd_status etd_task_resume(struct etd_task *task);

/**
 * Adds a reference to a task. Thread-safe.
 */
etd_status etd_task_retain(struct etd_task *task);

/**
 * Releases a reference to a task; NULL is allowed. The release of the last reference cancels a task that still runs and waits
 * for its end. The task's callbacks may use the handle until then, and are not called afterwards. Inside one of these
 * callbacks, the call cancels the task without waiting. Thread-safe.
 */
void etd_task_release(struct etd_task *task);

/**
 * Takes the first failure of a call on this task since the last time that it was taken: returns its status, or `ETD_OK` if
 * there was none, and forgets the failure.
 * `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
 */
etd_status etd_task_status(struct etd_task *task,
                           char *message,
                           size_t capacity);

/**
 * Finds the first hit of each of `count` rays, in the scene as last built.
 *
 * `hits`: receives one hit for each ray, in the order of the rays. Rays that cannot be traced hit nothing: those with NaN or
 * infinity in origin or direction, a zero direction, or a negative or NaN interval. All other rays are still traced, and the
 * call then returns `ETD_INVALID_ARGUMENT` with a message about the first ray that cannot be traced. Error:
 * `ETD_INVALID_OPERATION` before the first build. Many rays in a call are faster than a call for each. The call traces all rays on
 * the calling thread. Any number of threads may call it at the same time; `etd_scene_query` uses several threads by itself, and
 * computes only what is wanted. Thread-safe.
 */
etd_status etd_scene_intersect(const struct etd_scene *scene,
                               const struct etd_ray *rays,
                               size_t count,
                               struct etd_hit *hits);

/**
 * Finds for each of `count` rays whether anything lies in its segment, in the scene as last built.
 *
 * `occluded`: receives one byte for each ray, 1 or 0. Rays, errors and threads are as for `etd_scene_intersect`. Thread-safe.
 */
etd_status etd_scene_occluded(const struct etd_scene *scene,
                              const struct etd_ray *rays,
                              size_t count,
                              uint8_t *occluded);

/**
 * Traces the rays of a query in the scene as last built, and writes what it wants of their hits.
 *
 * Only what is wanted is computed: numbers of surfaces, for example, need no data of the triangle that was hit. Results are the
 * same for any number of threads, and those of `etd_scene_intersect`. Rays that cannot be traced are as there; one at a time outside
 * [0, 1] cannot be traced either. Several threads are shared with the renders of the device, with which they take turns; in a process
 * that was forked from the device's there is only the calling thread. Errors:
 * `ETD_INVALID_OPERATION` before the first build, `ETD_INVALID_ARGUMENT` for a column that is not aligned or has a wrong stride, and
 * for rays without origins or directions. Thread-safe.
 */
etd_status etd_scene_query(const struct etd_scene *scene,
                           const struct etd_ray_query *query);

/**
 * Makes the rays that the camera of the scene as last built sends through the pixels of a film of `width` x `height`.
 *
 * With `etd_scene_query` they give images that a film does not keep, at the cost of a ray a pixel: numbers of surfaces, materials and
 * triangles, positions, texture coordinates. `offset`: place in the pixel from its top left corner, two floats in [0, 1]; NULL for the
 * middle. `rays`: receives `width` * `height` rays, row by row from the top, of unit direction and without an end. Rays of a lens go
 * through its middle, and a camera that moves is where it is as the shutter opens. A pixel that shows nothing, beside the circle of a
 * fisheye, has a ray that ends where it begins. Origins are rounded to single precision. Errors: `ETD_INVALID_OPERATION` before the
 * first build, `ETD_INVALID_ARGUMENT` for a resolution or an offset out of range, `ETD_INVALID_SCENE` where the camera makes no image
 * of this shape. Thread-safe.
 */
etd_status etd_scene_camera_rays(const struct etd_scene *scene,
                                 uint32_t width,
                                 uint32_t height,
                                 const float *offset,
                                 struct etd_ray *rays);

/**
 * Makes an atlas: lays out all surfaces of a scene in one square light map. A scene that has changed is built first.
 *
 * `options`: NULL for the defaults of `ETD_ATLAS_OPTIONS_INIT`. On `ETD_OK`, `*out_atlas` is one reference. The atlas keeps the
 * scene as it is now, and later bakes use that scene. The same scene gives the same layout. The log callback receives a
 * warning for each mesh whose own texture coordinates could not be used. Errors: `ETD_CANCELLED` if the progress callback
 * stopped the call; `ETD_INVALID_ARGUMENT` for options out of their range; `ETD_INVALID_SCENE` for a scene without a surface,
 * for charts that do not fit, and for texture coordinates that cannot be a layout although the options require them;
 * `ETD_OUT_OF_MEMORY`; the errors of `etd_scene_commit`. Thread-safe.
 */
etd_status etd_atlas_new(struct etd_scene *scene,
                         const struct etd_atlas_options *options,
                         struct etd_atlas **out_atlas);

/**
 * Adds a reference to an atlas. Thread-safe.
 */
etd_status etd_atlas_retain(struct etd_atlas *atlas);

/**
 * Releases a reference to an atlas; NULL is allowed. Thread-safe.
 */
void etd_atlas_release(struct etd_atlas *atlas);

/**
 * Takes the first failure of a call on this atlas since the last time that it was taken: returns its status, or `ETD_OK` if
 * there was none, and forgets the failure.
 * `message`: receives the message, at most `capacity` bytes including the zero byte, unless it is NULL. Thread-safe.
 */
etd_status etd_atlas_status(struct etd_atlas *atlas,
                            char *message,
                            size_t capacity);

/**
 * Returns the size of an atlas and its numbers of vertices, triangles, surfaces and charts. Thread-safe.
 */
etd_status etd_atlas_get_info(const struct etd_atlas *atlas, struct etd_atlas_info *out_info);

/**
 * Copies the vertices of an atlas, surface by surface. A vertex on a seam is there once for each chart.
 *
 * `*out_needed` receives the number of vertices, unless `out_needed` is NULL. `vertices` may be NULL to get the number only.
 * Error: `ETD_INVALID_ARGUMENT` for a capacity below the number. Thread-safe.
 */
etd_status etd_atlas_copy_vertices(const struct etd_atlas *atlas,
                                   struct etd_atlas_vertex *vertices,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Copies three vertex numbers for each triangle of an atlas, counter-clockwise seen from outside. Triangles come surface by
 * surface, in the order of the scene. Triangles without an area are left out; `etd_atlas_copy_primitives` says which triangles
 * are there.
 *
 * `capacity` and `*out_needed` are numbers of indices, three for each triangle. All else is as for `etd_atlas_copy_vertices`.
 * Thread-safe.
 */
etd_status etd_atlas_copy_indices(const struct etd_atlas *atlas,
                                  uint32_t *indices,
                                  size_t capacity,
                                  size_t *out_needed);

/**
 * Copies for each triangle of an atlas its number on its surface: on a mesh the number of the triangle in the mesh, on a quad 0
 * or 1, on other shapes consecutive numbers. All else is as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_primitives(const struct etd_atlas *atlas,
                                     uint32_t *primitives,
                                     size_t capacity,
                                     size_t *out_needed);

/**
 * Copies the surfaces of an atlas, in the order of their numbers. Removed surfaces and surfaces without an area are left out.
 * All else is as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_surfaces(const struct etd_atlas *atlas,
                                   struct etd_atlas_surface *surfaces,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Copies for each texel of an atlas the fraction of its area that triangles cover, `[height][width]`, row 0 at v = 0. It is 0 in
 * gutters and outside of charts. All else is as for `etd_atlas_copy_vertices`. Thread-safe.
 */
etd_status etd_atlas_copy_coverage(const struct etd_atlas *atlas,
                                   float *coverage,
                                   size_t capacity,
                                   size_t *out_needed);

/**
 * Bakes the light map of an atlas, irradiance [W m^-2], to the host's array, and returns when the bake has ended.
 *
 * `options`: NULL for the scene's own settings. With `ETD_INTEGRATOR_RADIOSITY`, irradiance comes from a radiosity solution, whose
 * elements are as small as texels unless the options contain a size; it has no samples, and standard errors are NaN. All other
 * integrators mean path tracing. The filter and `finished` are ignored, the depth counts the texel as the first hit, and
 * "pixels" in the documentation of options means texels. `target`: receives three floats for each texel, `[height][width]`, row 0
 * at v = 0, and in the same layout the standard errors if `standard_error` is not NULL. `out_summary`: receives the summary,
 * unless it is NULL. Texels in the gutter of a chart get the values of the nearest covered texel of the chart, and texels beyond
 * gutters get 0.
 *
 * The bake uses the scene for which the atlas was made. The result depends only on the atlas and the options, and not on
 * threads. Errors: `ETD_CANCELLED` if the progress callback stopped the bake; with path tracing, the arrays then contain the
 * result of the samples so far, and with radiosity, they are unchanged; `ETD_INVALID_ARGUMENT` for a target that cannot hold the
 * map; `ETD_OUT_OF_MEMORY` for a radiosity solution larger than `radiosity_memory`. Thread-safe.
 */
etd_status etd_atlas_bake(struct etd_atlas *atlas,
                          const struct etd_render_options *options,
                          const struct etd_bake_target *target,
                          struct etd_summary *out_summary);

/**
 * Bakes the vertices of one surface, irradiance [W m^-2], to the host's array. A scene that has changed is built first.
 *
 * `surface`: number of the surface. `target`: receives three floats for each vertex: all vertices of a mesh in their order, or
 * the corners of a triangle or a quad. The value of a vertex is the mean irradiance over the part of the surface that is nearest
 * to the vertex, a third of each triangle around it; it is 0 for a vertex of no triangle. `target->row_stride` is ignored. All
 * else is as for `etd_atlas_bake`. Errors: `ETD_INVALID_ARGUMENT` for a number of a removed surface, of a surface without
 * vertices or of no surface, and for a target that cannot hold the vertices. Thread-safe.
 */
etd_status etd_scene_bake_vertices(struct etd_scene *scene,
                                   uint32_t surface,
                                   const struct etd_render_options *options,
                                   const struct etd_bake_target *target,
                                   struct etd_summary *out_summary);

/**
 * Measures light at points, and returns when the values are there: illuminance, lx, of small planes, or luminance [cd m^-2] of
 * views. A scene that has changed is built first.
 *
 * `quantity`: an `etd_quantity`. `points`: `count` points, 1 to 1,048,576, each with the normal of its plane or with the direction
 * that is looked into. Points need no surface; a point on a surface is lit as the side of its normal is. `options`: NULL for the
 * scene's own settings. With `ETD_INTEGRATOR_RADIOSITY` the light is that of a radiosity solution, gathered at each point; all
 * other integrators mean path tracing. The filter and `finished` are ignored, the depth counts a point of illuminance as the first
 * hit, and "pixels" in the documentation of options means points. `target_error` is a relMSE: the square of the relative standard
 * error that is wanted. `out_values`: receives `count` numbers. `out_standard_errors`: receives their standard errors, NaN where
 * there are too few samples, unless it is NULL. `out_summary`: receives the summary, unless it is NULL.
 *
 * One watt is 683 lumens: docs/photometry.md. The result depends only on the scene, the points and the options, and not on
 * threads. Errors: `ETD_CANCELLED` if the progress callback stopped it; the arrays then contain the result of the samples so far;
 * `ETD_INVALID_ARGUMENT` for another quantity; `ETD_INVALID_SCENE` for numbers of points out of range, points beyond single precision, and directions of
 * length 0; `ETD_UNSUPPORTED` for a scene that radiosity does not take; the errors of `etd_scene_commit`. Thread-safe.
 */
etd_status etd_scene_measure(struct etd_scene *scene,
                             etd_quantity quantity,
                             const struct etd_measuring_point *points,
                             size_t count,
                             const struct etd_render_options *options,
                             double *out_values,
                             double *out_standard_errors,
                             struct etd_summary *out_summary);

/**
 * The illuminance, lx, of a horizontal plane under the unobstructed sky of a scene, to which daylight factors refer. Surfaces, lamps
 * and distant light such as the sun's disk do not count.
 *
 * `out_illuminance`: receives the illuminance. `out_standard_error`: receives its standard error, unless it is NULL. Errors:
 * `ETD_INVALID_SCENE` for a scene without an environment or with a black one. Thread-safe.
 */
etd_status etd_scene_exterior_illuminance(struct etd_scene *scene,
                                          double *out_illuminance,
                                          double *out_standard_error);

/**
 * Returns light that is given in photometric units as the radiometric channels that lights and surfaces take: luminous intensity, cd,
 * as radiant intensity [W sr^-1], illuminance, lx, as irradiance [W m^-2], luminance [cd m^-2] as radiance [W m^-2 sr^-1].
 *
 * `value`: the luminous quantity, > 0. With a `solid_angle` > 0, `value` is a luminous flux, lm, that is spread over it, and the
 * result is radiant intensity: 4 pi for a point light, 2 pi ((1 - cos inner) + (cos inner - cos outer) / 3) for a spot light, and
 * pi times the area for the radiance of a surface; 0 otherwise. `temperature`: colour temperature of a Planckian radiator in kelvin,
 * in [1000, 15000]; 0: the colour is `color`, three numbers >= 0 that are scaled to the luminance; NULL: white. `out_color` receives
 * three numbers, whose luminance is `value` over 683 lm/W. Errors: `ETD_INVALID_ARGUMENT` for numbers out of their range, for a colour
 * without luminance, for both a colour and a temperature, and for light beyond single precision. Thread-safe.
 */
etd_status etd_photometric_color(double value,
                                 double solid_angle,
                                 double temperature,
                                 const float *color,
                                 float *out_color);

/**
 * Traces mattes: which objects or materials each pixel of a picture sees, and in which share of its samples. A scene that has changed
 * is built first.
 *
 * They cost one ray for each camera sample. The samples are those of a render with the same options to a film of `width` x `height`
 * pixels, so that edges match those of its picture; light, time limit, target error and `finished` are ignored, and `samples` must not
 * be 0. What is seen is the first surface that a ray meets: rays pass where an opacity lets them, and mirrors and glass are what is seen.
 * Samples that meet nothing belong to no name, and the coverages of a pixel then sum to less than 1. Each sample counts once, also
 * where `filter` has weights below 0.
 *
 * `options`: NULL for the scene's own settings. `kind`: an `etd_matte_kind`. `levels`: number of names that a pixel keeps, those of the
 * largest coverage, 1 to 64. `out_ids`: receives `[height][width][levels]` identifiers by falling coverage, row 0 on top, 0 where there
 * is no further name: `etd_matte_id` of the names, as the pixels and the manifest of a Cryptomatte have them. `out_coverages`: receives
 * the same number of coverages, in [0, 1].
 *
 * The result depends only on the scene, the options and the size, and not on threads. Errors: `ETD_CANCELLED` if the progress callback
 * stopped it; `ETD_INVALID_ARGUMENT` for a kind, levels, samples or a size out of range and for options about parts of a picture and
 * checkpoints; the errors of `etd_scene_commit`; the arrays are then unchanged. Thread-safe.
 */
etd_status etd_scene_trace_mattes(struct etd_scene *scene,
                                  uint32_t width,
                                  uint32_t height,
                                  const struct etd_render_options *options,
                                  etd_matte_kind kind,
                                  uint32_t levels,
                                  uint32_t *out_ids,
                                  float *out_coverages);

/**
 * Returns the identifier of a name in mattes: the bits of the float that a Cryptomatte has for it, never 0. `name`: UTF-8. Thread-safe.
 */
etd_status etd_matte_id(const char *name,
                        uint32_t *out_id);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ETENDUE_H */
