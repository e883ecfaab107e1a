/* Wrong arguments to every function: each must be refused with the documented status, and change nothing.
 *
 * In here: NULL for every pointer, in every combination; handles of the wrong kind; structures of the wrong size;
 * enumerations without that value; numbers that are none; numbers of nothing. What goes wrong over time (states, threads,
 * callbacks) is in misuse_life.c. Every exported function occurs in the table below; abi.sh checks that.
 *
 * Usage: misuse [--quick], with few repetitions, for slow checkers. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

CHECK_MAIN;

/* What the calls of the tables are made on. */
static etd_device *device;
static etd_scene *scene;
static etd_film *film;
static etd_task *task;
static uint32_t mesh_number;

/* Memory that is no handle of any kind. */
static union {
    unsigned char bytes[4096];
    double align;
} nothing;

/* Outputs go here, so that one comparison shows whether a failing call wrote any. */
static union {
    unsigned char bytes[2048];
    double align;
    void *pointer;
} outputs, outputs_before;
static size_t outputs_used;

/* Arguments of the call that is to be made: bit n of `nulls` is for pointer n. */
static unsigned nulls;
static const void *wrong_handle;
static unsigned wrong_at;
static etd_status expected;

static void *output(size_t size) {
    void *place = outputs.bytes + outputs_used;
    outputs_used += (size + 15) / 16 * 16;
    return place;
}

static void *sized_output(size_t size) {
    void *place = output(size);
    memcpy(place, &size, sizeof size);
    return place;
}

static void forget_outputs(void) {
    memset(outputs.bytes, 0xa5, sizeof outputs.bytes);
    outputs_used = 0;
}

static void remember_outputs(void) { memcpy(&outputs_before, &outputs, sizeof outputs); }

static int outputs_are_untouched(void) { return memcmp(&outputs_before, &outputs, sizeof outputs) == 0; }

#define AT(bit, pointer) (nulls >> (bit) & 1u ? NULL : (pointer))

static void *handle(unsigned bit, void *right) {
    if (nulls >> bit & 1u) {
        return NULL;
    }
    if (wrong_handle != NULL && wrong_at == bit) {
        union {
            const void *in;
            void *out;
        } cast;
        cast.in = wrong_handle;
        return cast.out;
    }
    return right;
}

#define DEVICE(bit) ((etd_device *)handle(bit, device))
#define SCENE(bit) ((etd_scene *)handle(bit, scene))
#define FILM(bit) ((etd_film *)handle(bit, film))
#define TASK(bit) ((etd_task *)handle(bit, task))

/* Makes the call that is to be judged. */
#define CALL(call) (remember_outputs(), (call))

static const double ones[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const double triangle_vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static const double quad_vertices[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const double unit_ball[10] = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1};
static const double low[3] = {-2, -2, -2};
static const double high[3] = {2, 2, 2};
static const double up_axis[3] = {0, 1, 0};
static const double centre[3] = {0, 1, 0};
static const float grey[3] = {0.5f, 0.5f, 0.5f};
static const float small_positions[10] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
static const uint32_t small_indices[3] = {0, 1, 2};

static etd_mesh small_mesh(void) {
    etd_mesh mesh = ETD_MESH_INIT;
    mesh.positions = small_positions;
    mesh.vertex_count = 3;
    mesh.indices = small_indices;
    mesh.triangle_count = 1;
    return mesh;
}

static etd_surface matt(void) {
    etd_surface surface = ETD_SURFACE_INIT;
    surface.material = 0;
    return surface;
}

#define JSON_CAMERA "\"camera\": {\"origin\": [0, 0, 4], \"lookAt\": [0, 0, 0], \"up\": [0, 1, 0], \"fieldOfView\": 60}"
static const char one_sphere[] =
    "{\"etendue\": 1, " JSON_CAMERA ", \"surfaces\": [{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1, "
    "\"emission\": [1, 1, 1]}]}";

static int32_t go_on(void *user_data, const etd_progress *progress) {
    (void)user_data;
    return progress->fraction >= 0 && progress->fraction <= 1 ? 0 : 1;
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* One function for each function */

static etd_status n_last_error_message(void) { return CALL(etd_last_error_message()) != NULL ? ETD_OK : ETD_INTERNAL; }
static etd_status n_last_error(void) {
    etd_error *error = AT(0, sized_output(sizeof *error));
    return CALL(etd_last_error(error));
}
static etd_status n_status_name(void) { return strcmp(etd_status_name(ETD_IO), "ETD_IO") == 0 ? ETD_OK : ETD_INTERNAL; }
static etd_status n_version(void) { return etd_version() == ETD_VERSION ? ETD_OK : ETD_INTERNAL; }
static etd_status n_version_string(void) {
    return strcmp(etd_version_string(), ETD_VERSION_STRING) == 0 ? ETD_OK : ETD_INTERNAL;
}
static etd_status n_device_new(void) {
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_device **out = AT(1, output(sizeof *out));
    etd_status status;
    options.threads = 1;
    status = CALL(etd_device_new(AT(0, &options), out));
    if (status == ETD_OK) {
        etd_device_release(*out);
    }
    return status;
}
static etd_status n_device_retain(void) {
    etd_status status = CALL(etd_device_retain(DEVICE(0)));
    if (status == ETD_OK) {
        etd_device_release(device);
    }
    return status;
}
static etd_status n_device_release(void) {
    if (nulls == 0 && wrong_handle == NULL) {
        return ETD_OK;
    }
    etd_device_release(DEVICE(0));
    return wrong_handle != NULL ? ETD_INVALID_HANDLE : ETD_OK;
}
static etd_status n_device_status(void) {
    char *message = AT(1, output(64));
    etd_device_status(device, NULL, 0);
    return CALL(etd_device_status(DEVICE(0), message, 64));
}
static etd_status n_device_memory(void) {
    uint64_t *used = AT(1, output(sizeof *used));
    uint64_t *peak = AT(2, output(sizeof *peak));
    return CALL(etd_device_memory(DEVICE(0), used, peak));
}
static etd_status n_scene_new(void) {
    etd_scene_options options = ETD_SCENE_OPTIONS_INIT;
    etd_scene **out = AT(2, output(sizeof *out));
    etd_status status = CALL(etd_scene_new(DEVICE(0), AT(1, &options), out));
    if (status == ETD_OK) {
        etd_scene_release(*out);
    }
    return status;
}
static etd_status n_scene_from_json(void) {
    etd_scene_options options = ETD_SCENE_OPTIONS_INIT;
    etd_scene **out = AT(3, output(sizeof *out));
    etd_status status =
        CALL(etd_scene_from_json(DEVICE(0), AT(1, one_sphere), sizeof one_sphere - 1, AT(2, &options), out));
    if (status == ETD_OK) {
        etd_scene_release(*out);
    }
    return status;
}
static etd_status n_scene_from_file(void) {
    etd_scene_options options = ETD_SCENE_OPTIONS_INIT;
    etd_scene **out = AT(3, output(sizeof *out));
    etd_status status = CALL(etd_scene_from_file(DEVICE(0), AT(1, "misuse-scene.json"), AT(2, &options), out));
    if (status == ETD_OK) {
        etd_scene_release(*out);
    }
    return status;
}
static etd_status n_scene_retain(void) {
    etd_status status = CALL(etd_scene_retain(SCENE(0)));
    if (status == ETD_OK) {
        etd_scene_release(scene);
    }
    return status;
}
static etd_status n_scene_release(void) {
    if (nulls == 0 && wrong_handle == NULL) {
        return ETD_OK;
    }
    etd_scene_release(SCENE(0));
    return wrong_handle != NULL ? ETD_INVALID_HANDLE : ETD_OK;
}
static etd_status n_scene_status(void) {
    char *message = AT(1, output(64));
    etd_scene_status(scene, NULL, 0);
    return CALL(etd_scene_status(SCENE(0), message, 64));
}
static etd_status n_scene_commit(void) {
    return CALL(etd_scene_commit(SCENE(0), nulls & 2u ? NULL : go_on, AT(2, &nothing)));
}
static etd_status n_scene_get_info(void) {
    etd_scene_info *info = AT(1, sized_output(sizeof *info));
    return CALL(etd_scene_get_info(SCENE(0), info));
}
static etd_status n_scene_copy_text(void) {
    char *buffer = AT(1, output(64));
    size_t *needed = AT(2, output(sizeof *needed));
    if ((nulls & 7u) == 6u) {
        expected = ETD_INVALID_ARGUMENT; /* one of the two must be there */
    }
    return CALL(etd_scene_copy_text(SCENE(0), ETD_TEXT_INFO, buffer, 64, needed));
}
static etd_status n_scene_get_render_options(void) {
    etd_render_options *options = AT(1, sized_output(sizeof *options));
    return CALL(etd_scene_get_render_options(SCENE(0), options));
}
static etd_status n_scene_get_resolution(void) {
    uint32_t *width = AT(1, output(sizeof *width));
    uint32_t *height = AT(2, output(sizeof *height));
    return CALL(etd_scene_get_resolution(SCENE(0), width, height));
}
static etd_status n_scene_set_camera(void) {
    etd_camera camera = ETD_CAMERA_INIT;
    return CALL(etd_scene_set_camera(SCENE(0), AT(1, &camera)));
}
static etd_status n_scene_get_camera(void) {
    etd_camera *camera = AT(1, sized_output(sizeof *camera));
    return CALL(etd_scene_get_camera(SCENE(0), camera));
}
static etd_status n_scene_add_material(void) {
    static unsigned count;
    char name[32];
    etd_material material = ETD_MATERIAL_INIT;
    uint32_t *number = AT(3, output(sizeof *number));
    snprintf(name, sizeof name, "material %u", ++count);
    return CALL(etd_scene_add_material(SCENE(0), AT(1, name), AT(2, &material), number));
}
static etd_status n_scene_set_material(void) {
    etd_material material = ETD_MATERIAL_INIT;
    return CALL(etd_scene_set_material(SCENE(0), 0, AT(1, &material)));
}
static etd_status n_scene_get_material(void) {
    etd_material *material = AT(1, sized_output(sizeof *material));
    return CALL(etd_scene_get_material(SCENE(0), 0, material));
}
static etd_status n_scene_add_point_light(void) {
    uint32_t *number = AT(3, output(sizeof *number));
    return CALL(etd_scene_add_point_light(SCENE(0), AT(1, centre), AT(2, grey), number));
}
static etd_status n_scene_set_point_light(void) {
    return CALL(etd_scene_set_point_light(SCENE(0), 0, AT(1, centre), AT(2, grey)));
}
static etd_status n_scene_get_point_light(void) {
    double *position = AT(1, output(3 * sizeof *position));
    float *intensity = AT(2, output(3 * sizeof *intensity));
    return CALL(etd_scene_get_point_light(SCENE(0), 0, position, intensity));
}
static etd_status n_scene_add_sphere(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(3, output(sizeof *number));
    return CALL(etd_scene_add_sphere(SCENE(0), AT(1, centre), 1, AT(2, &surface), number));
}
static etd_status n_scene_add_triangle(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(3, output(sizeof *number));
    return CALL(etd_scene_add_triangle(SCENE(0), AT(1, triangle_vertices), AT(2, &surface), number));
}
static etd_status n_scene_add_quad(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(3, output(sizeof *number));
    return CALL(etd_scene_add_quad(SCENE(0), AT(1, quad_vertices), AT(2, &surface), number));
}
static etd_status n_scene_add_disk(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(4, output(sizeof *number));
    return CALL(etd_scene_add_disk(SCENE(0), AT(1, centre), AT(2, up_axis), 1, AT(3, &surface), number));
}
static etd_status n_scene_add_cylinder(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(4, output(sizeof *number));
    return CALL(etd_scene_add_cylinder(SCENE(0), AT(1, centre), AT(2, up_axis), 1, 1, AT(3, &surface), number));
}
static etd_status n_scene_add_cone(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(4, output(sizeof *number));
    return CALL(etd_scene_add_cone(SCENE(0), AT(1, centre), AT(2, up_axis), 1, 1, AT(3, &surface), number));
}
static etd_status n_scene_add_paraboloid(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(4, output(sizeof *number));
    return CALL(etd_scene_add_paraboloid(SCENE(0), AT(1, centre), AT(2, up_axis), 1, 1, AT(3, &surface), number));
}
static etd_status n_scene_add_ellipsoid(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(4, output(sizeof *number));
    return CALL(etd_scene_add_ellipsoid(SCENE(0), AT(1, centre), AT(2, high), AT(3, &surface), number));
}
static etd_status n_scene_add_quadric(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(5, output(sizeof *number));
    if ((nulls >> 2 & 1u) != (nulls >> 3 & 1u) && expected == ETD_OK) {
        expected = ETD_INVALID_ARGUMENT; /* half a box */
    }
    return CALL(
        etd_scene_add_quadric(SCENE(0), AT(1, unit_ball), AT(2, low), AT(3, high), AT(4, &surface), number));
}
static etd_status n_scene_add_mesh_surface(void) {
    etd_surface surface = matt();
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_add_mesh_surface(SCENE(0), mesh_number, 0, AT(1, &surface), number));
}
static etd_status n_scene_remove_surface(void) {
    etd_surface surface = matt();
    uint32_t number = 0;
    CHECK_OK(etd_scene_add_sphere(scene, centre, 1, &surface, &number));
    return CALL(etd_scene_remove_surface(SCENE(0), number));
}
static etd_status n_scene_set_transform(void) { return CALL(etd_scene_set_transform(SCENE(0), 1, AT(1, ones))); }
static etd_status n_scene_set_surface_material(void) {
    return CALL(etd_scene_set_surface_material(SCENE(0), 0, 0));
}
static etd_status n_scene_set_emission(void) { return CALL(etd_scene_set_emission(SCENE(0), 2, AT(1, grey))); }
static etd_status n_scene_get_surface(void) {
    etd_surface *surface = AT(1, sized_output(sizeof *surface));
    return CALL(etd_scene_get_surface(SCENE(0), 0, surface));
}
static etd_status n_scene_find_material(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_find_material(SCENE(0), AT(1, "white"), number));
}
static etd_status n_scene_find_mesh(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_find_mesh(SCENE(0), AT(1, "grid"), number));
}
static etd_status n_scene_find_surface(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_find_surface(SCENE(0), AT(1, "surfaces[0]"), number));
}
static etd_status n_scene_add_mesh(void) {
    etd_mesh mesh = small_mesh();
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_add_mesh(SCENE(0), AT(1, &mesh), number));
}
static etd_status n_scene_add_mesh_file(void) {
    uint32_t *number = AT(3, output(sizeof *number));
    static unsigned count;
    char name[32];
    snprintf(name, sizeof name, "file %u", ++count);
    return CALL(etd_scene_add_mesh_file(SCENE(0), AT(1, name), AT(2, "misuse-mesh.obj"), number));
}
static etd_status n_scene_set_mesh(void) {
    etd_mesh mesh = small_mesh();
    return CALL(etd_scene_set_mesh(SCENE(0), mesh_number, AT(1, &mesh)));
}
static etd_status n_scene_remove_mesh(void) {
    etd_mesh mesh = small_mesh();
    uint32_t number = 0;
    CHECK_OK(etd_scene_add_mesh(scene, &mesh, &number));
    return CALL(etd_scene_remove_mesh(SCENE(0), number));
}
static etd_status n_film_new(void) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film **out = AT(2, output(sizeof *out));
    etd_status status;
    options.width = options.height = 2;
    status = CALL(etd_film_new(DEVICE(0), AT(1, &options), out));
    if (status == ETD_OK) {
        etd_film_release(*out);
    }
    return status;
}
static etd_status n_film_retain(void) {
    etd_status status = CALL(etd_film_retain(FILM(0)));
    if (status == ETD_OK) {
        etd_film_release(film);
    }
    return status;
}
static etd_status n_film_release(void) {
    if (nulls == 0 && wrong_handle == NULL) {
        return ETD_OK;
    }
    etd_film_release(FILM(0));
    return wrong_handle != NULL ? ETD_INVALID_HANDLE : ETD_OK;
}
static etd_status n_film_status(void) {
    char *message = AT(1, output(64));
    etd_film_status(film, NULL, 0);
    return CALL(etd_film_status(FILM(0), message, 64));
}
static etd_status n_film_map(void) {
    etd_map *map = AT(1, sized_output(sizeof *map));
    etd_status status = CALL(etd_film_map(FILM(0), ETD_LAYER_COLOR, map));
    if (status == ETD_OK) {
        CHECK_OK(etd_film_unmap(film, map));
    }
    return status;
}
static etd_status n_film_unmap(void) {
    etd_map *map = sized_output(sizeof *map);
    etd_status status;
    CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, map));
    status = CALL(etd_film_unmap(FILM(0), AT(1, map)));
    if (status != ETD_OK) {
        etd_map same = *map;
        CHECK_OK(etd_film_unmap(film, &same));
    }
    return status;
}
static etd_status n_film_copy(void) {
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    void *pixels = AT(2, output(4 * 4 * 4 * sizeof(float)));
    return CALL(etd_film_copy(FILM(0), ETD_LAYER_COLOR, AT(1, &options), pixels, 4 * 4 * 4 * sizeof(float), 0));
}
static etd_status n_film_write(void) {
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    return CALL(etd_film_write(FILM(0), AT(1, "misuse.pfm"), AT(2, &options)));
}
static etd_status n_film_get_summary(void) {
    etd_summary *summary = AT(1, sized_output(sizeof *summary));
    return CALL(etd_film_get_summary(FILM(0), summary));
}
static etd_status n_render(void) {
    etd_render_options options = short_render(1);
    return CALL(etd_render(SCENE(0), FILM(1), AT(2, &options)));
}
static etd_status n_render_start(void) {
    etd_render_options options = short_render(1);
    etd_task **out = AT(3, output(sizeof *out));
    etd_status status = CALL(etd_render_start(SCENE(0), FILM(1), AT(2, &options), out));
    if (status == ETD_OK) {
        CHECK_OK(etd_task_wait(*out, -1));
        etd_task_release(*out);
    }
    return status;
}
static etd_status n_task_poll(void) {
    etd_progress *progress = AT(1, sized_output(sizeof *progress));
    return CALL(etd_task_poll(TASK(0), progress));
}
static etd_status n_task_wait(void) { return CALL(etd_task_wait(TASK(0), -1)); }
static etd_status n_task_cancel(void) { return CALL(etd_task_cancel(TASK(0))); }
static etd_status n_task_resume(void) {
    etd_status status = CALL(etd_task_resume(TASK(0)));
    if (status == ETD_OK) {
        CHECK_OK(etd_task_wait(task, -1));
    }
    return status;
}
static etd_status n_task_retain(void) {
    etd_status status = CALL(etd_task_retain(TASK(0)));
    if (status == ETD_OK) {
        etd_task_release(task);
    }
    return status;
}
static etd_status n_task_release(void) {
    if (nulls == 0 && wrong_handle == NULL) {
        return ETD_OK;
    }
    etd_task_release(TASK(0));
    return wrong_handle != NULL ? ETD_INVALID_HANDLE : ETD_OK;
}
static etd_status n_task_status(void) {
    char *message = AT(1, output(64));
    etd_task_status(task, NULL, 0);
    return CALL(etd_task_status(TASK(0), message, 64));
}
static etd_status n_scene_intersect(void) {
    etd_ray ray = {{0, 5, 0}, 0, {0, -1, 0}, 100};
    etd_hit *hit = AT(2, output(sizeof *hit));
    return CALL(etd_scene_intersect(SCENE(0), AT(1, &ray), 1, hit));
}
static etd_status n_scene_occluded(void) {
    etd_ray ray = {{0, 5, 0}, 0, {0, -1, 0}, 100};
    uint8_t *answer = AT(2, output(sizeof *answer));
    return CALL(etd_scene_occluded(SCENE(0), AT(1, &ray), 1, answer));
}

/* Bits: pointer n must not be NULL; pointer n is a handle. */
static const struct {
    const char *name;
    etd_status (*call)(void);
    unsigned pointers;
    unsigned needed;
    unsigned handles;
} table[] = {
    {"etd_last_error_message", n_last_error_message, 0, 0, 0},
    {"etd_last_error", n_last_error, 1, 1, 0},
    {"etd_status_name", n_status_name, 0, 0, 0},
    {"etd_version", n_version, 0, 0, 0},
    {"etd_version_string", n_version_string, 0, 0, 0},
    {"etd_device_new", n_device_new, 2, 2, 0},
    {"etd_device_retain", n_device_retain, 1, 1, 1},
    {"etd_device_release", n_device_release, 1, 0, 1},
    {"etd_device_status", n_device_status, 2, 1, 1},
    {"etd_device_memory", n_device_memory, 3, 1, 1},
    {"etd_scene_new", n_scene_new, 3, 5, 1},
    {"etd_scene_from_json", n_scene_from_json, 4, 11, 1},
    {"etd_scene_from_file", n_scene_from_file, 4, 11, 1},
    {"etd_scene_retain", n_scene_retain, 1, 1, 1},
    {"etd_scene_release", n_scene_release, 1, 0, 1},
    {"etd_scene_status", n_scene_status, 2, 1, 1},
    {"etd_scene_commit", n_scene_commit, 3, 1, 1},
    {"etd_scene_get_info", n_scene_get_info, 2, 3, 1},
    {"etd_scene_copy_text", n_scene_copy_text, 3, 1, 1},
    {"etd_scene_get_render_options", n_scene_get_render_options, 2, 3, 1},
    {"etd_scene_get_resolution", n_scene_get_resolution, 3, 7, 1},
    {"etd_scene_set_camera", n_scene_set_camera, 2, 3, 1},
    {"etd_scene_get_camera", n_scene_get_camera, 2, 3, 1},
    {"etd_scene_add_material", n_scene_add_material, 4, 13, 1},
    {"etd_scene_set_material", n_scene_set_material, 2, 3, 1},
    {"etd_scene_get_material", n_scene_get_material, 2, 3, 1},
    {"etd_scene_add_point_light", n_scene_add_point_light, 4, 15, 1},
    {"etd_scene_set_point_light", n_scene_set_point_light, 3, 7, 1},
    {"etd_scene_get_point_light", n_scene_get_point_light, 3, 7, 1},
    {"etd_scene_add_sphere", n_scene_add_sphere, 4, 15, 1},
    {"etd_scene_add_triangle", n_scene_add_triangle, 4, 15, 1},
    {"etd_scene_add_quad", n_scene_add_quad, 4, 15, 1},
    {"etd_scene_add_disk", n_scene_add_disk, 5, 31, 1},
    {"etd_scene_add_cylinder", n_scene_add_cylinder, 5, 31, 1},
    {"etd_scene_add_cone", n_scene_add_cone, 5, 31, 1},
    {"etd_scene_add_paraboloid", n_scene_add_paraboloid, 5, 31, 1},
    {"etd_scene_add_ellipsoid", n_scene_add_ellipsoid, 5, 31, 1},
    {"etd_scene_add_quadric", n_scene_add_quadric, 6, 51, 1},
    {"etd_scene_add_mesh_surface", n_scene_add_mesh_surface, 3, 7, 1},
    {"etd_scene_remove_surface", n_scene_remove_surface, 1, 1, 1},
    {"etd_scene_set_transform", n_scene_set_transform, 2, 3, 1},
    {"etd_scene_set_surface_material", n_scene_set_surface_material, 1, 1, 1},
    {"etd_scene_set_emission", n_scene_set_emission, 2, 1, 1},
    {"etd_scene_get_surface", n_scene_get_surface, 2, 3, 1},
    {"etd_scene_find_material", n_scene_find_material, 3, 7, 1},
    {"etd_scene_find_mesh", n_scene_find_mesh, 3, 7, 1},
    {"etd_scene_find_surface", n_scene_find_surface, 3, 7, 1},
    {"etd_scene_add_mesh", n_scene_add_mesh, 3, 7, 1},
    {"etd_scene_add_mesh_file", n_scene_add_mesh_file, 4, 13, 1},
    {"etd_scene_set_mesh", n_scene_set_mesh, 2, 3, 1},
    {"etd_scene_remove_mesh", n_scene_remove_mesh, 1, 1, 1},
    {"etd_film_new", n_film_new, 3, 7, 1},
    {"etd_film_retain", n_film_retain, 1, 1, 1},
    {"etd_film_release", n_film_release, 1, 0, 1},
    {"etd_film_status", n_film_status, 2, 1, 1},
    {"etd_film_map", n_film_map, 2, 3, 1},
    {"etd_film_unmap", n_film_unmap, 2, 3, 1},
    {"etd_film_copy", n_film_copy, 3, 5, 1},
    {"etd_film_write", n_film_write, 3, 3, 1},
    {"etd_film_get_summary", n_film_get_summary, 2, 3, 1},
    {"etd_render", n_render, 3, 3, 3},
    {"etd_render_start", n_render_start, 4, 11, 3},
    {"etd_task_poll", n_task_poll, 2, 1, 1},
    {"etd_task_wait", n_task_wait, 1, 1, 1},
    {"etd_task_cancel", n_task_cancel, 1, 1, 1},
    {"etd_task_resume", n_task_resume, 1, 1, 1},
    {"etd_task_retain", n_task_retain, 1, 1, 1},
    {"etd_task_release", n_task_release, 1, 0, 1},
    {"etd_task_status", n_task_status, 2, 1, 1},
    {"etd_scene_intersect", n_scene_intersect, 3, 7, 1},
    {"etd_scene_occluded", n_scene_occluded, 3, 7, 1},
};
#define TABLE_SIZE (sizeof table / sizeof table[0])

static void judge(const char *what, size_t entry) {
    etd_status got;
    char text[160];
    forget_outputs();
    remember_outputs();
    got = table[entry].call();
    snprintf(text, sizeof text, "%s, %s %#x: %s, expected %s", table[entry].name, what, nulls, etd_status_name(got),
             etd_status_name(expected));
    check_that(got == expected, __FILE__, __LINE__, text);
    if (got != ETD_OK) {
        snprintf(text, sizeof text, "%s, %s %#x: it failed and wrote to its outputs", table[entry].name, what, nulls);
        check_that(outputs_are_untouched(), __FILE__, __LINE__, text);
    }
}

/* NULL for every pointer, in every combination. */
static void pass_null(void) {
    size_t entry;
    for (entry = 0; entry < TABLE_SIZE; ++entry) {
        for (nulls = 0; nulls < 1u << table[entry].pointers; ++nulls) {
            expected = nulls & table[entry].needed ? ETD_INVALID_ARGUMENT : ETD_OK;
            judge("NULL for pointers", entry);
        }
        nulls = 0;
    }
}

/* Something else wherever a handle belongs. */
static void pass_wrong_handles(void) {
    size_t entry;
    for (entry = 0; entry < TABLE_SIZE; ++entry) {
        const void *others[6];
        int kind;
        others[0] = device;
        others[1] = scene;
        others[2] = film;
        others[3] = task;
        others[4] = &nothing;
        others[5] = nothing.bytes + 1; /* not aligned either */
        for (wrong_at = 0; wrong_at < 2; ++wrong_at) {
            const char *name = wrong_at == 0 ? table[entry].name : "etd_film_";
            if (!(table[entry].handles >> wrong_at & 1u)) {
                continue;
            }
            for (kind = 0; kind < 6; ++kind) {
                static const char *const prefixes[4] = {"etd_device_", "etd_scene_", "etd_film_", "etd_task_"};
                int makes_scene = strcmp(name, "etd_scene_new") == 0 || strncmp(name, "etd_scene_from", 14) == 0;
                int makes_film = strcmp(name, "etd_film_new") == 0;
                int renders = strncmp(name, "etd_render", 10) == 0;
                const char *right = makes_scene || makes_film ? "etd_device_" : renders ? "etd_scene_" : name;
                if (kind < 4 && strncmp(right, prefixes[kind], strlen(prefixes[kind])) == 0) {
                    continue;
                }
                wrong_handle = others[kind];
                expected = ETD_INVALID_HANDLE;
                judge("a wrong handle", entry);
                wrong_handle = NULL;
            }
        }
    }
    /* None of these has cost anybody a reference. */
    CHECK_OK(etd_device_memory(device, NULL, NULL));
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    CHECK_OK(etd_task_poll(task, NULL));
    CHECK_OK(etd_film_write(film, "misuse.pfm", NULL));
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Structures of the wrong size */

static union {
    unsigned char bytes[8192];
    size_t size;
    double align;
} structure;

#define INIT(type, value)                   \
    do {                                    \
        type initial = value;               \
        memcpy(&structure, &initial, sizeof initial); \
    } while (0)

static etd_status s_error(void) { return etd_last_error((etd_error *)(void *)&structure); }
static etd_status s_device_options(void) {
    etd_device *made = NULL;
    etd_status status;
    ((etd_device_options *)(void *)&structure)->threads = 1;
    status = etd_device_new((etd_device_options *)(void *)&structure, &made);
    CHECK((status == ETD_OK) == (made != NULL));
    etd_device_release(made);
    return status;
}
static etd_status s_scene_options(void) {
    etd_scene *made = NULL;
    etd_status status = etd_scene_new(device, (etd_scene_options *)(void *)&structure, &made);
    CHECK((status == ETD_OK) == (made != NULL));
    etd_scene_release(made);
    return status;
}
static etd_status s_film_options(void) {
    etd_film *made = NULL;
    etd_status status;
    ((etd_film_options *)(void *)&structure)->width = 2;
    ((etd_film_options *)(void *)&structure)->height = 2;
    status = etd_film_new(device, (etd_film_options *)(void *)&structure, &made);
    CHECK((status == ETD_OK) == (made != NULL));
    etd_film_release(made);
    return status;
}
static etd_status s_set_camera(void) { return etd_scene_set_camera(scene, (etd_camera *)(void *)&structure); }
static etd_status s_get_camera(void) { return etd_scene_get_camera(scene, (etd_camera *)(void *)&structure); }
static etd_status s_set_material(void) { return etd_scene_set_material(scene, 0, (etd_material *)(void *)&structure); }
static etd_status s_get_material(void) { return etd_scene_get_material(scene, 0, (etd_material *)(void *)&structure); }
static etd_status s_mesh(void) {
    etd_mesh *mesh = (etd_mesh *)(void *)&structure;
    mesh->positions = small_positions;
    mesh->vertex_count = 3;
    mesh->indices = small_indices;
    mesh->triangle_count = 1;
    return etd_scene_set_mesh(scene, mesh_number, mesh);
}
static etd_status s_set_surface(void) {
    uint32_t number;
    ((etd_surface *)(void *)&structure)->material = 0;
    return etd_scene_add_sphere(scene, centre, 1, (etd_surface *)(void *)&structure, &number);
}
static etd_status s_get_surface(void) { return etd_scene_get_surface(scene, 0, (etd_surface *)(void *)&structure); }
static etd_status s_set_render_options(void) {
    ((etd_render_options *)(void *)&structure)->samples = 1;
    return etd_render(scene, film, (etd_render_options *)(void *)&structure);
}
static etd_status s_get_render_options(void) {
    return etd_scene_get_render_options(scene, (etd_render_options *)(void *)&structure);
}
static etd_status s_progress(void) { return etd_task_poll(task, (etd_progress *)(void *)&structure); }
static etd_status s_summary(void) { return etd_film_get_summary(film, (etd_summary *)(void *)&structure); }
static etd_status s_scene_info(void) { return etd_scene_get_info(scene, (etd_scene_info *)(void *)&structure); }
static etd_status s_map(void) {
    etd_map *map = (etd_map *)(void *)&structure;
    etd_status status = etd_film_map(film, ETD_LAYER_COLOR, map);
    if (status == ETD_OK) {
        etd_map same = ETD_MAP_INIT;
        same.id = map->id;
        CHECK_OK(etd_film_unmap(film, &same));
    }
    return status;
}
static etd_status s_image_options(void) {
    float pixels[4 * 4 * 4];
    return etd_film_copy(film, ETD_LAYER_COLOR, (etd_image_options *)(void *)&structure, pixels, sizeof pixels, 0);
}

static void i_error(void) { INIT(etd_error, ETD_ERROR_INIT); }
static void i_device_options(void) { INIT(etd_device_options, ETD_DEVICE_OPTIONS_INIT); }
static void i_scene_options(void) { INIT(etd_scene_options, ETD_SCENE_OPTIONS_INIT); }
static void i_film_options(void) { INIT(etd_film_options, ETD_FILM_OPTIONS_INIT); }
static void i_camera(void) { INIT(etd_camera, ETD_CAMERA_INIT); }
static void i_material(void) { INIT(etd_material, ETD_MATERIAL_INIT); }
static void i_mesh(void) { INIT(etd_mesh, ETD_MESH_INIT); }
static void i_surface(void) { INIT(etd_surface, ETD_SURFACE_INIT); }
static void i_render_options(void) { INIT(etd_render_options, ETD_RENDER_OPTIONS_INIT); }
static void i_progress(void) { INIT(etd_progress, ETD_PROGRESS_INIT); }
static void i_summary(void) { INIT(etd_summary, ETD_SUMMARY_INIT); }
static void i_scene_info(void) { INIT(etd_scene_info, ETD_SCENE_INFO_INIT); }
static void i_map(void) { INIT(etd_map, ETD_MAP_INIT); }
static void i_image_options(void) { INIT(etd_image_options, ETD_IMAGE_OPTIONS_INIT); }

static void pass_wrong_sizes(void) {
    static const struct {
        const char *name;
        void (*init)(void);
        etd_status (*call)(void);
        size_t size;
        size_t last; /* where the last field begins: no version had less */
        int is_output;
    } cases[] = {
        {"etd_error", i_error, s_error, sizeof(etd_error), offsetof(etd_error, json_path), 1},
        {"etd_device_options", i_device_options, s_device_options, sizeof(etd_device_options),
         offsetof(etd_device_options, user_data), 0},
        {"etd_scene_options", i_scene_options, s_scene_options, sizeof(etd_scene_options),
         offsetof(etd_scene_options, params_file), 0},
        {"etd_film_options", i_film_options, s_film_options, sizeof(etd_film_options),
         offsetof(etd_film_options, reserved), 0},
        {"etd_camera in", i_camera, s_set_camera, sizeof(etd_camera), offsetof(etd_camera, fov_deg), 0},
        {"etd_camera out", i_camera, s_get_camera, sizeof(etd_camera), offsetof(etd_camera, fov_deg), 1},
        {"etd_material in", i_material, s_set_material, sizeof(etd_material), offsetof(etd_material, reserved), 0},
        {"etd_material out", i_material, s_get_material, sizeof(etd_material), offsetof(etd_material, reserved), 1},
        {"etd_mesh", i_mesh, s_mesh, sizeof(etd_mesh), offsetof(etd_mesh, name), 0},
        {"etd_surface in", i_surface, s_set_surface, sizeof(etd_surface), offsetof(etd_surface, transform), 0},
        {"etd_surface out", i_surface, s_get_surface, sizeof(etd_surface), offsetof(etd_surface, transform), 1},
        {"etd_render_options in", i_render_options, s_set_render_options, sizeof(etd_render_options),
         offsetof(etd_render_options, user_data), 0},
        {"etd_render_options out", i_render_options, s_get_render_options, sizeof(etd_render_options),
         offsetof(etd_render_options, user_data), 1},
        {"etd_progress", i_progress, s_progress, sizeof(etd_progress), offsetof(etd_progress, images), 1},
        {"etd_summary", i_summary, s_summary, sizeof(etd_summary), offsetof(etd_summary, cancelled), 1},
        {"etd_scene_info", i_scene_info, s_scene_info, sizeof(etd_scene_info), offsetof(etd_scene_info, build_time), 1},
        {"etd_map", i_map, s_map, sizeof(etd_map), offsetof(etd_map, id), 1},
        {"etd_image_options", i_image_options, s_image_options, sizeof(etd_image_options),
         offsetof(etd_image_options, comments), 0},
    };
    size_t i, k;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const size_t right = cases[i].size;
        const size_t wrong[] = {0, 1, sizeof(size_t), cases[i].last - 1, (size_t)-1, (size_t)-1 / 2, 1000 * right};
        char text[160];
        etd_status got;
        for (k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
            memset(&structure, 0, sizeof structure);
            cases[i].init();
            structure.size = wrong[k];
            got = cases[i].call();
            snprintf(text, sizeof text, "%s of size %lu: %s", cases[i].name, (unsigned long)wrong[k],
                     etd_status_name(got));
            check_that(got == ETD_INVALID_ARGUMENT, __FILE__, __LINE__, text);
        }
        /* A program of a later version: fine as long as it asks for nothing that is not known here. */
        memset(&structure, 0, sizeof structure);
        cases[i].init();
        structure.size = right + 24;
        if (cases[i].is_output) {
            memset(structure.bytes + right, 0x5a, 24);
        }
        got = cases[i].call();
        snprintf(text, sizeof text, "%s of a later version: %s", cases[i].name, etd_status_name(got));
        check_that(got == ETD_OK, __FILE__, __LINE__, text);
        check_that(structure.size == right + 24, __FILE__, __LINE__, "struct_size is the caller's");
        for (k = right; cases[i].is_output && k < right + 24; ++k) {
            check_that(structure.bytes[k] == 0x5a, __FILE__, __LINE__, "what is not known is not written");
        }
        if (!cases[i].is_output) {
            structure.bytes[right + 23] = 1;
            got = cases[i].call();
            snprintf(text, sizeof text, "%s of a later version with an unknown field: %s", cases[i].name,
                     etd_status_name(got));
            check_that(got == ETD_INVALID_ARGUMENT, __FILE__, __LINE__, text);
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Numbers that mean nothing */

static etd_status e_usage(uint32_t value) {
    etd_scene_options options = ETD_SCENE_OPTIONS_INIT;
    etd_scene *made = NULL;
    etd_status status;
    options.usage = value;
    status = etd_scene_new(device, &options, &made);
    CHECK((status == ETD_OK) == (made != NULL));
    etd_scene_release(made);
    return status;
}
static etd_status e_camera_type(uint32_t value) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.projection = value;
    return etd_scene_set_camera(scene, &camera);
}
static etd_status e_fov_axis(uint32_t value) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.fov_axis = value;
    return etd_scene_set_camera(scene, &camera);
}
static etd_status e_bsdf(uint32_t value) {
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = value;
    return etd_scene_set_material(scene, 0, &material);
}
static etd_status e_position_format(uint32_t value) {
    static const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    etd_mesh mesh = small_mesh();
    mesh.position_format = value;
    mesh.positions = positions;
    return etd_scene_set_mesh(scene, mesh_number, &mesh);
}
static etd_status e_sharing(uint32_t value) {
    etd_mesh mesh = small_mesh();
    mesh.sharing = value;
    mesh.position_bytes = sizeof small_positions;
    return etd_scene_set_mesh(scene, mesh_number, &mesh);
}
static etd_status e_sampler(uint32_t value) {
    etd_render_options options = short_render(1);
    options.sampler = value;
    return etd_render(scene, film, &options);
}
static etd_status e_filter(uint32_t value) {
    etd_render_options options = short_render(1);
    options.filter = value;
    return etd_render(scene, film, &options);
}
static etd_status e_integrator(uint32_t value) {
    etd_render_options options = short_render(1);
    options.integrator = value;
    return etd_render(scene, film, &options);
}
static etd_status e_format(uint32_t value) {
    static float pixels[4 * 4 * 4];
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    options.format = value;
    return etd_film_copy(film, ETD_LAYER_COLOR, &options, pixels, sizeof pixels, 0);
}
static etd_status e_tone_map_copy(uint32_t value) {
    static unsigned char pixels[4 * 4 * 3];
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    options.format = ETD_FORMAT_RGB8;
    options.tone_map = value;
    return etd_film_copy(film, ETD_LAYER_COLOR, &options, pixels, sizeof pixels, 0);
}
static etd_status e_tone_map_write(uint32_t value) {
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    options.tone_map = value;
    return etd_film_write(film, "misuse.png", &options);
}
static etd_status e_text(uint32_t value) {
    size_t needed = 0;
    return etd_scene_copy_text(scene, value, NULL, 0, &needed);
}

static void pass_wrong_enumerations(void) {
    static const struct {
        const char *name;
        etd_status (*call)(uint32_t value);
        uint32_t last;
    } cases[] = {
        {"usage", e_usage, ETD_USAGE_DYNAMIC},
        {"camera_type", e_camera_type, ETD_CAMERA_VIEW_PLANE},
        {"fov_axis", e_fov_axis, ETD_FOV_VERTICAL},
        {"bsdf", e_bsdf, ETD_BSDF_DIELECTRIC},
        {"position_format", e_position_format, ETD_POSITION_DOUBLE3},
        {"sharing", e_sharing, ETD_SHARE},
        {"sampler", e_sampler, ETD_SAMPLER_GAUSSIAN},
        {"filter", e_filter, ETD_FILTER_MITCHELL},
        {"integrator", e_integrator, ETD_INTEGRATOR_DIRECT},
        {"format", e_format, ETD_FORMAT_RGBA8},
        {"tone_map of a copy", e_tone_map_copy, ETD_TONE_MAP_ACES},
        {"tone_map of a file", e_tone_map_write, ETD_TONE_MAP_ACES},
        {"text", e_text, ETD_TEXT_WARNINGS},
    };
    static const uint32_t layers[] = {0, 3, ETD_LAYER_ALPHA, 129, 256, UINT32_MAX};
    size_t i, k;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const uint32_t wrong[] = {cases[i].last + 1, 100, 0x80000000u, UINT32_MAX};
        char text[96];
        uint32_t value;
        for (value = 0; value <= cases[i].last; ++value) {
            snprintf(text, sizeof text, "%s %lu is one", cases[i].name, (unsigned long)value);
            check_status(cases[i].call(value), ETD_OK, __FILE__, __LINE__, text);
        }
        for (k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
            snprintf(text, sizeof text, "%s %lu is none", cases[i].name, (unsigned long)wrong[k]);
            check_status(cases[i].call(wrong[k]), ETD_INVALID_ARGUMENT, __FILE__, __LINE__, text);
        }
    }
    for (i = 0; i < sizeof layers / sizeof layers[0]; ++i) {
        etd_map map = ETD_MAP_INIT;
        float pixels[4 * 4 * 4];
        CHECK_STATUS(etd_film_map(film, layers[i], &map), ETD_INVALID_ARGUMENT);
        CHECK(map.data == NULL && map.id == 0);
        CHECK_STATUS(etd_film_copy(film, layers[i], NULL, pixels, sizeof pixels, 0), ETD_INVALID_ARGUMENT);
    }
    {
        etd_map map = ETD_MAP_INIT;
        etd_film_options options = ETD_FILM_OPTIONS_INIT;
        etd_film *made = NULL;
        CHECK_STATUS(etd_film_map(film, ETD_LAYER_DEPTH, &map), ETD_INVALID_OPERATION); /* not kept */
        options.width = options.height = 4;
        options.layers = 256;
        CHECK_STATUS(etd_film_new(device, &options, &made), ETD_INVALID_ARGUMENT);
        options.layers = 255;
        options.reserved = 1;
        CHECK_STATUS(etd_film_new(device, &options, &made), ETD_INVALID_ARGUMENT);
        options.reserved = 0;
        options.width = 0;
        CHECK_STATUS(etd_film_new(device, &options, &made), ETD_INVALID_ARGUMENT);
        options.width = options.height = UINT32_MAX;
        CHECK_STATUS(etd_film_new(device, &options, &made), ETD_INVALID_ARGUMENT);
        CHECK(made == NULL);
    }
    CHECK(strcmp(etd_status_name(12345), "unknown status") == 0);
}

/* How many surfaces, materials, meshes and lights there are, as one number: it tells whether anything was added. */
static uint64_t population(void) {
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    CHECK_OK(etd_scene_get_info(scene, &info));
    return info.surfaces + 1000 * info.materials + 1000000 * info.meshes + 1000000000 * info.point_lights;
}

/* Each number of these arrays in turn becomes NaN and infinite. */
static void pass_numbers(void) {
    const float bad[3] = {(float)NAN, (float)INFINITY, -(float)INFINITY};
    const uint64_t before = population();
    etd_surface surface = matt();
    uint32_t number = 4321;
    size_t i, k;
    for (k = 0; k < 3; ++k) {
        double values[12];
        float floats[12];
#define EACH(original, count, call, wanted)                   \
    for (i = 0; i < (count); ++i) {                           \
        memcpy(values, (original), (count) * sizeof *values); \
        values[i] = (double)bad[k];                           \
        CHECK_STATUS(call, wanted);                           \
    }
        EACH(centre, 3, etd_scene_add_sphere(scene, values, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(triangle_vertices, 9, etd_scene_add_triangle(scene, values, &surface, &number), ETD_INVALID_SCENE)
        EACH(quad_vertices, 12, etd_scene_add_quad(scene, values, &surface, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_disk(scene, values, up_axis, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(up_axis, 3, etd_scene_add_disk(scene, centre, values, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_cylinder(scene, values, up_axis, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(up_axis, 3, etd_scene_add_cylinder(scene, centre, values, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_cone(scene, values, up_axis, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(up_axis, 3, etd_scene_add_cone(scene, centre, values, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_paraboloid(scene, values, up_axis, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(up_axis, 3, etd_scene_add_paraboloid(scene, centre, values, 1, 1, &surface, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_ellipsoid(scene, values, high, &surface, &number), ETD_INVALID_SCENE)
        EACH(high, 3, etd_scene_add_ellipsoid(scene, centre, values, &surface, &number), ETD_INVALID_SCENE)
        EACH(unit_ball, 10, etd_scene_add_quadric(scene, values, NULL, NULL, &surface, &number), ETD_INVALID_SCENE)
        EACH(low, 3, etd_scene_add_quadric(scene, unit_ball, values, high, &surface, &number), ETD_INVALID_SCENE)
        EACH(high, 3, etd_scene_add_quadric(scene, unit_ball, low, values, &surface, &number), ETD_INVALID_SCENE)
        EACH(ones, 12, etd_scene_set_transform(scene, 1, values), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_add_point_light(scene, values, grey, &number), ETD_INVALID_SCENE)
        EACH(centre, 3, etd_scene_set_point_light(scene, 0, values, grey), ETD_INVALID_SCENE)
#undef EACH
        for (i = 0; i < 3; ++i) {
            etd_camera camera = ETD_CAMERA_INIT;
            etd_material material = ETD_MATERIAL_INIT;
            etd_surface glowing = matt();
            memcpy(floats, grey, sizeof grey);
            floats[i] = bad[k];
            CHECK_STATUS(etd_scene_add_point_light(scene, centre, floats, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_point_light(scene, 0, centre, floats), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_emission(scene, 2, floats), ETD_INVALID_SCENE);
            glowing.emission[i] = bad[k];
            CHECK_STATUS(etd_scene_add_sphere(scene, centre, 1, &glowing, &number), ETD_INVALID_SCENE);
            material.color[i] = bad[k];
            CHECK_STATUS(etd_scene_add_material(scene, NULL, &material, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_material(scene, 0, &material), ETD_INVALID_SCENE);
            camera.origin[i] = (double)bad[k];
            CHECK_STATUS(etd_scene_set_camera(scene, &camera), ETD_INVALID_SCENE);
            camera = (etd_camera)ETD_CAMERA_INIT;
            camera.look_at[i] = (double)bad[k];
            CHECK_STATUS(etd_scene_set_camera(scene, &camera), ETD_INVALID_SCENE);
            camera = (etd_camera)ETD_CAMERA_INIT;
            camera.up[i] = (double)bad[k];
            CHECK_STATUS(etd_scene_set_camera(scene, &camera), ETD_INVALID_SCENE);
        }
        for (i = 0; i < 12; ++i) {
            etd_surface placed = matt();
            placed.transform[i] = (double)bad[k];
            CHECK_STATUS(etd_scene_add_sphere(scene, centre, 1, &placed, &number), ETD_INVALID_SCENE);
        }
        for (i = 0; i < 9; ++i) {
            etd_mesh mesh = small_mesh();
            memcpy(floats, small_positions, 9 * sizeof *floats);
            floats[i] = bad[k];
            mesh.positions = floats;
            CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_mesh(scene, mesh_number, &mesh), ETD_INVALID_SCENE);
            mesh = small_mesh();
            mesh.normals = floats;
            CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
            if (i < 6) {
                mesh = small_mesh();
                mesh.uvs = floats;
                CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
            }
        }
        {
            const double x = (double)bad[k];
            etd_camera camera = ETD_CAMERA_INIT;
            etd_render_options options = short_render(1);
            etd_image_options image = ETD_IMAGE_OPTIONS_INIT;
            unsigned char pixels[4 * 4 * 3];
            etd_ray rays[2] = {{{0, 5, 0}, 0, {0, -1, 0}, 100}, {{0, 5, 0}, 0, {0, -1, 0}, 100}};
            etd_hit hits[2];
            uint8_t answers[2];
            CHECK_STATUS(etd_scene_add_sphere(scene, centre, x, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_disk(scene, centre, up_axis, x, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_cylinder(scene, centre, up_axis, x, 1, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_cylinder(scene, centre, up_axis, 1, x, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_cone(scene, centre, up_axis, x, 1, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_cone(scene, centre, up_axis, 1, x, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_paraboloid(scene, centre, up_axis, x, 1, &surface, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_paraboloid(scene, centre, up_axis, 1, x, &surface, &number), ETD_INVALID_SCENE);
            camera.fov_deg = x;
            CHECK_STATUS(etd_scene_set_camera(scene, &camera), ETD_INVALID_SCENE);
            options.time_limit = x;
            CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
            options = short_render(1);
            options.target_error = x;
            CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
            image.format = ETD_FORMAT_RGB8;
            image.exposure = bad[k];
            memset(pixels, 7, sizeof pixels);
            CHECK_STATUS(etd_film_copy(film, ETD_LAYER_COLOR, &image, pixels, sizeof pixels, 0), ETD_INVALID_ARGUMENT);
            CHECK(pixels[0] == 7 && pixels[sizeof pixels - 1] == 7);
            CHECK_STATUS(etd_film_write(film, "misuse.png", &image), ETD_INVALID_ARGUMENT);
            /* A ray that cannot be traced is the only one that goes without an answer. */
            rays[0].origin[k] = bad[k];
            CHECK_STATUS(etd_scene_intersect(scene, rays, 2, hits), ETD_INVALID_ARGUMENT);
            CHECK(hits[0].surface == ETD_NONE && hits[1].surface != ETD_NONE && strstr(etd_last_error_message(), "0"));
            CHECK_STATUS(etd_scene_occluded(scene, rays, 2, answers), ETD_INVALID_ARGUMENT);
            CHECK(answers[0] == 0 && answers[1] == 1);
        }
    }
    CHECK_STATUS(etd_task_wait(task, (double)bad[0]), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_task_wait(task, (double)bad[1]));
    CHECK_OK(etd_task_wait(task, (double)bad[2]));
    CHECK(number == 4321);
    CHECK(population() == before);
}

/* Numbers of nothing, and arguments out of their range. */
static void pass_indices(void) {
    const uint32_t nobody[] = {1000000, UINT32_MAX - 1, UINT32_MAX};
    const uint64_t before = population();
    size_t i;
    for (i = 0; i < 3; ++i) {
        const uint32_t n = nobody[i];
        etd_material material = ETD_MATERIAL_INIT;
        etd_surface surface = matt();
        etd_surface lost = ETD_SURFACE_INIT;
        etd_mesh mesh = small_mesh();
        uint32_t bad_indices[3] = {0, 1, 3};
        double position[3] = {7, 7, 7};
        float intensity[3] = {7, 7, 7};
        uint32_t number = 4321;
        CHECK_STATUS(etd_scene_set_material(scene, n, &material), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_material(scene, n, &material), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_point_light(scene, n, centre, grey), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_point_light(scene, n, position, intensity), ETD_INVALID_ARGUMENT);
        CHECK(position[0] == 7 && intensity[2] == 7);
        CHECK_STATUS(etd_scene_add_mesh_surface(scene, n, 0, &surface, &number), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_remove_surface(scene, n), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_transform(scene, n, ones), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_surface_material(scene, n, 0), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_emission(scene, n, grey), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_surface(scene, n, &surface), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_mesh(scene, n, &mesh), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_remove_mesh(scene, n), ETD_INVALID_ARGUMENT);
        bad_indices[2] = n;
        mesh.indices = bad_indices;
        CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
        bad_indices[2] = 3;
        CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
        if (n != ETD_NONE) {
            lost.material = n;
            CHECK_STATUS(etd_scene_add_sphere(scene, centre, 1, &lost, &number), ETD_INVALID_ARGUMENT);
            CHECK_STATUS(etd_scene_set_surface_material(scene, 0, n), ETD_INVALID_ARGUMENT);
        }
        CHECK(number == 4321);
    }
    {
        etd_mesh mesh = small_mesh();
        etd_mesh absurd;
        etd_film_options film_options = ETD_FILM_OPTIONS_INIT;
        etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
        etd_render_options options = short_render(0);
        etd_material material = ETD_MATERIAL_INIT;
        etd_device *no_device = NULL;
        etd_scene *no_scene = NULL;
        float pixels[4 * 4 * 4];
        char text[4] = "xyz";
        uint32_t number = 4321;
        size_t needed = 0;
        (void)film_options;
        CHECK_STATUS(etd_scene_remove_mesh(scene, mesh_number), ETD_INVALID_SCENE); /* a surface uses it */
        absurd = mesh;
        absurd.vertex_count = 0;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd.vertex_count = (size_t)-1;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd = mesh;
        absurd.triangle_count = 0;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd = mesh;
        absurd.position_stride = 4;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd.position_stride = (size_t)-4;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd = mesh;
        absurd.positions = NULL;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd = mesh;
        absurd.indices = NULL;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd = mesh;
        absurd.name = "grid"; /* taken */
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_SCENE);
        absurd = mesh;
        absurd.sharing = ETD_SHARE; /* 16 bytes cannot be read from the last position on */
        absurd.position_bytes = 9 * sizeof(float);
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd.position_bytes = 0;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        absurd.position_format = ETD_POSITION_DOUBLE3;
        CHECK_STATUS(etd_scene_add_mesh(scene, &absurd, &number), ETD_INVALID_ARGUMENT);
        material.reserved = 1;
        CHECK_STATUS(etd_scene_add_material(scene, NULL, &material, &number), ETD_INVALID_ARGUMENT);
        material.reserved = 0;
        CHECK_STATUS(etd_scene_add_material(scene, "white", &material, &number), ETD_INVALID_SCENE); /* taken */
        CHECK_STATUS(etd_scene_add_material(scene, "\xff\xfe", &material, &number), ETD_INVALID_ARGUMENT);
        CHECK(number == 4321);
        device_options.threads = 1025;
        CHECK_STATUS(etd_device_new(&device_options, &no_device), ETD_INVALID_ARGUMENT);
        device_options.threads = 1;
        device_options.reserved = 1;
        CHECK_STATUS(etd_device_new(&device_options, &no_device), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT); /* never ends */
        options.samples = 1;
        options.shadow_rays = 1025;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_film_copy(film, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels - 1, 0), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_film_copy(film, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels, 15), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_film_copy(film, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels, (size_t)-4),
                     ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_film_copy(film, ETD_LAYER_COLOR, NULL, (char *)pixels + 1, sizeof pixels - 1, 0),
                     ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_film_write(film, "misuse.tiff", NULL), ETD_UNSUPPORTED);
        CHECK_STATUS(etd_film_write(film, "no/such/folder/misuse.png", NULL), ETD_IO);
        CHECK_STATUS(etd_scene_from_file(device, "no-such-file.json", NULL, &no_scene), ETD_IO);
        CHECK_STATUS(etd_scene_from_json(device, "{", 1, NULL, &no_scene), ETD_INVALID_SCENE);
        CHECK_STATUS(etd_scene_from_json(device, "", 0, NULL, &no_scene), ETD_INVALID_SCENE);
        CHECK_STATUS(etd_scene_from_json(device, "\xff", 1, NULL, &no_scene), ETD_INVALID_SCENE);
        CHECK_STATUS(etd_scene_from_json(device, "{}", (size_t)-1, NULL, &no_scene), ETD_INVALID_ARGUMENT);
        CHECK(no_device == NULL && no_scene == NULL);
        CHECK_STATUS(etd_scene_add_mesh_file(scene, NULL, "no-such-file.obj", &number), ETD_IO);
        CHECK_STATUS(etd_scene_find_material(scene, "nobody", &number), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_find_mesh(scene, "nobody", &number), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_find_surface(scene, "surfaces[99999]", &number), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_find_surface(scene, "", &number), ETD_INVALID_ARGUMENT);
        CHECK(number == 4321);
        /* A text that does not fit is cut, and ends with a zero byte. */
        CHECK_OK(etd_scene_copy_text(scene, ETD_TEXT_INFO, text, 3, &needed));
        CHECK(strlen(text) == 2 && needed > 3);
        CHECK_OK(etd_scene_intersect(scene, NULL, 0, NULL));
        CHECK_OK(etd_scene_occluded(scene, NULL, 0, NULL));
        {
            etd_ray ray = {{0, 0, 0}, 0, {0, 0, 0}, 1};
            etd_hit hit;
            CHECK_STATUS(etd_scene_intersect(scene, &ray, (size_t)-1, &hit), ETD_INVALID_ARGUMENT);
            CHECK_STATUS(etd_scene_intersect(scene, &ray, 1, &hit), ETD_INVALID_ARGUMENT); /* no direction */
        }
    }
    CHECK(population() == before);
}

/* The thread and the object say why. */
static void ask_for_errors(void) {
    etd_error error = ETD_ERROR_INIT;
    char message[64];
    static const char broken[] =
        "{\"etendue\": 1,\n" JSON_CAMERA
        ",\n\"surfaces\": [\n{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": -1, "
        "\"emission\": [1, 1, 1]}]}";
    etd_scene *no_scene = NULL;
    CHECK_STATUS(etd_scene_from_json(device, broken, sizeof broken - 1, NULL, &no_scene), ETD_INVALID_SCENE);
    CHECK_OK(etd_last_error(&error));
    CHECK(error.status == ETD_INVALID_SCENE && error.line == 4);
    CHECK(strstr(error.json_path, "surfaces[0]") != NULL && strstr(error.message, "surfaces[0]") != NULL);
    CHECK(strcmp(error.message, etd_last_error_message()) == 0);
    etd_scene_status(scene, NULL, 0);
    CHECK_STATUS(etd_scene_remove_surface(scene, 99999), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_camera(scene, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_status(scene, message, sizeof message), ETD_INVALID_ARGUMENT);
    CHECK(strstr(message, "99999") != NULL); /* the first, not the last */
    CHECK_OK(etd_scene_status(scene, message, sizeof message));
    CHECK(message[0] == 0);
}

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    if (!CHECK(file != NULL)) {
        exit(2);
    }
    CHECK(fputs(text, file) >= 0);
    CHECK(fclose(file) == 0);
}

int main(int count, char **arguments) {
    const int quick = count > 1 && strcmp(arguments[1], "--quick") == 0;
    etd_render_options options = short_render(1);
    write_text("misuse-scene.json", one_sphere);
    write_text("misuse-mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");

    device = new_device(1);
    scene = new_scene(device);
    film = new_film(device, 4, 4, 0);
    {
        etd_mesh mesh = small_mesh();
        etd_surface surface = matt();
        uint32_t number = 0;
        mesh.name = "grid";
        CHECK_OK(etd_scene_add_mesh(scene, &mesh, &mesh_number));
        CHECK_OK(etd_scene_add_mesh_surface(scene, mesh_number, 0, &surface, &number));
    }
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    CHECK_OK(etd_task_wait(task, -1));

    pass_null();
    pass_wrong_handles();
    pass_wrong_sizes();
    pass_wrong_enumerations();
    pass_numbers();
    pass_indices();
    ask_for_errors();
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);

    misuse_life(quick);
    remove("misuse-scene.json");
    remove("misuse-mesh.obj");
    remove("misuse.pfm");
    remove("misuse.png");
    return check_report("misuse");
}
