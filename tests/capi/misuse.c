/* Wrong arguments to every function: each must be refused with the documented status, and change nothing.
 *
 * In here: NULL for every pointer, in every combination, and handles of the wrong kind. Wrong values are in
 * misuse_values.c, those of photon maps in misuse_photons.c; what goes wrong over time (states, threads, callbacks) is in
 * misuse_life.c. Every exported function occurs in the table below; abi.sh checks that.
 *
 * Usage: misuse [--quick], with few repetitions and small layouts, for slow checkers. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

CHECK_MAIN;

etd_device *device;
etd_scene *scene;
etd_film *film;
etd_task *task;
etd_atlas *atlas;
uint32_t mesh_number;
static uint32_t group_number;

/* The film as it was saved. */
static char saved_film[1 << 16];
static size_t saved_size;

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
#define ATLAS(bit) ((etd_atlas *)handle(bit, atlas))

/* Makes the call that is to be judged. */
#define CALL(call) (remember_outputs(), (call))

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
static etd_status n_device_get_info(void) {
    etd_device_info *info = AT(1, sized_output(sizeof *info));
    return CALL(etd_device_get_info(DEVICE(0), info));
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
static etd_status n_scene_get_principled(void) {
    etd_principled *principled = AT(1, sized_output(sizeof *principled));
    uint32_t number = 0;
    CHECK_OK(etd_scene_find_material(scene, "principled", &number));
    return CALL(etd_scene_get_principled(SCENE(0), number, principled));
}
static etd_status n_metal(void) {
    float *eta = AT(1, output(3 * sizeof *eta));
    float *k = AT(2, output(3 * sizeof *k));
    return CALL(etd_metal(AT(0, "Au"), eta, k));
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
static etd_status n_scene_set_shutter(void) {
    etd_shutter shutter = ETD_SHUTTER_INIT;
    return CALL(etd_scene_set_shutter(SCENE(0), AT(1, &shutter)));
}
static etd_status n_scene_get_shutter(void) {
    etd_shutter *shutter = AT(1, sized_output(sizeof *shutter));
    return CALL(etd_scene_get_shutter(SCENE(0), shutter));
}
/* At rest, since not all renders show motion. */
static etd_status n_scene_set_camera_motion(void) {
    etd_motion_key key = ETD_MOTION_KEY_INIT;
    return CALL(etd_scene_set_camera_motion(SCENE(0), AT(1, &key), 1));
}
static etd_status n_scene_set_surface_motion(void) {
    etd_motion_key key = ETD_MOTION_KEY_INIT;
    return CALL(etd_scene_set_surface_motion(SCENE(0), 0, AT(1, &key), 1));
}
static etd_status n_scene_set_light_motion(void) {
    etd_motion_key key = ETD_MOTION_KEY_INIT;
    return CALL(etd_scene_set_light_motion(SCENE(0), 0, AT(1, &key), 1));
}
static etd_status n_scene_set_mesh_steps(void) {
    return CALL(etd_scene_set_mesh_steps(SCENE(0), 0, NULL, 0, NULL, NULL));
}
/* Dark, since not all renders take a spot light. */
static etd_status n_scene_add_spot_light(void) {
    etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
    uint32_t *number = AT(2, output(sizeof *number));
    memset(spot.intensity, 0, sizeof spot.intensity);
    return CALL(etd_scene_add_spot_light(SCENE(0), AT(1, &spot), number));
}
/* Light 1 is one that an earlier entry of the table has added. */
static etd_status n_scene_set_spot_light(void) {
    etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
    memset(spot.intensity, 0, sizeof spot.intensity);
    return CALL(etd_scene_set_spot_light(SCENE(0), 1, AT(1, &spot)));
}
static etd_status n_scene_get_spot_light(void) {
    etd_spot_light *spot = AT(1, sized_output(sizeof *spot));
    return CALL(etd_scene_get_spot_light(SCENE(0), 1, spot));
}
static etd_status n_scene_set_environment(void) { return CALL(etd_scene_set_environment(SCENE(0), AT(1, grey))); }
static etd_status n_scene_get_environment(void) {
    float *radiance = AT(1, output(3 * sizeof *radiance));
    return CALL(etd_scene_get_environment(SCENE(0), radiance));
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
static etd_status n_scene_set_emits_both(void) { return CALL(etd_scene_set_emits_both(SCENE(0), 2, 0)); }
static etd_status n_scene_set_surface_name(void) {
    return CALL(etd_scene_set_surface_name(SCENE(0), 2, AT(1, "lamp")));
}
static etd_status n_scene_get_surface_name(void) {
    char *buffer = AT(1, output(64));
    size_t *needed = AT(2, output(sizeof *needed));
    if ((nulls & 7u) == 6u) {
        expected = ETD_INVALID_ARGUMENT; /* one of the two must be there */
    }
    return CALL(etd_scene_get_surface_name(SCENE(0), 2, buffer, 64, needed));
}
static etd_status n_scene_get_surface(void) {
    etd_surface *surface = AT(1, sized_output(sizeof *surface));
    return CALL(etd_scene_get_surface(SCENE(0), 0, surface));
}
static etd_status n_scene_get_shape(void) {
    etd_shape *shape = AT(1, sized_output(sizeof *shape));
    return CALL(etd_scene_get_shape(SCENE(0), 0, shape));
}
static etd_status n_scene_get_mesh(void) {
    etd_mesh_info *info = AT(1, sized_output(sizeof *info));
    return CALL(etd_scene_get_mesh(SCENE(0), mesh_number, info));
}
static etd_status n_scene_copy_mesh(void) {
    double *positions = AT(1, output(9 * sizeof *positions));
    uint32_t *indices = AT(2, output(3 * sizeof *indices));
    return CALL(etd_scene_copy_mesh(SCENE(0), mesh_number, 3, 1, positions, NULL, NULL, indices));
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
static etd_status n_scene_add_group(void) {
    const uint32_t surfaces[2] = {1, 2};
    uint32_t *number = AT(3, output(sizeof *number));
    static unsigned count;
    char name[32];
    snprintf(name, sizeof name, "group %u", ++count);
    return CALL(etd_scene_add_group(SCENE(0), AT(1, name), AT(2, surfaces), 2, number));
}
/* What is placed goes at once, since not all renders take many surfaces. */
static etd_status n_scene_place_group(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    uint32_t *first = AT(3, output(sizeof *first));
    const etd_status status = CALL(etd_scene_place_group(SCENE(0), group_number, AT(1, ones), number, first));
    if (status == ETD_OK) {
        CHECK_OK(etd_scene_remove_placement(scene, *number));
    }
    return status;
}
static etd_status n_scene_set_placement_transform(void) {
    return CALL(etd_scene_set_placement_transform(SCENE(0), 0, AT(1, ones)));
}
static etd_status n_scene_set_placement_motion(void) {
    etd_motion_key key = ETD_MOTION_KEY_INIT;
    return CALL(etd_scene_set_placement_motion(SCENE(0), 0, AT(1, &key), 1));
}
static etd_status n_scene_get_placement(void) {
    uint32_t *group = AT(1, output(sizeof *group));
    uint32_t *first = AT(2, output(sizeof *first));
    uint32_t *many = AT(3, output(sizeof *many));
    double *transform = AT(4, output(12 * sizeof *transform));
    return CALL(etd_scene_get_placement(SCENE(0), 0, group, first, many, transform));
}
static etd_status n_scene_remove_placement(void) {
    static uint32_t placed;
    CHECK_OK(etd_scene_place_group(scene, group_number, NULL, &placed, NULL));
    return CALL(etd_scene_remove_placement(SCENE(0), placed));
}
static etd_status n_scene_remove_group(void) {
    const uint32_t surfaces[1] = {1};
    uint32_t number = 0;
    CHECK_OK(etd_scene_add_group(scene, NULL, surfaces, 1, &number));
    return CALL(etd_scene_remove_group(SCENE(0), number));
}
static etd_status n_scene_find_group(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_find_group(SCENE(0), AT(1, "pair"), number));
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
static etd_status n_scene_add_mesh_file_with_progress(void) {
    uint32_t *number = AT(4, output(sizeof *number));
    static unsigned count;
    char name[32];
    snprintf(name, sizeof name, "watched file %u", ++count);
    return CALL(etd_scene_add_mesh_file_with_progress(SCENE(0), AT(1, name), AT(2, "misuse-mesh.obj"), nulls & 8u ? NULL : go_on,
                                                      NULL, number));
}
/* From the scene itself, in whose stead another handle may stand. */
static etd_status n_scene_add_mesh_from(void) {
    uint32_t *number = AT(3, output(sizeof *number));
    static unsigned count;
    char name[32];
    snprintf(name, sizeof name, "from %u", ++count);
    return CALL(etd_scene_add_mesh_from(SCENE(0), AT(2, name), SCENE(1), mesh_number, number));
}
static etd_status n_scene_add_file_surfaces(void) {
    static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    uint32_t *first = AT(3, output(sizeof *first));
    uint32_t *many = AT(4, output(sizeof *many));
    return CALL(etd_scene_add_file_surfaces(SCENE(0), AT(1, "misuse-mesh.obj"), 1, AT(2, identity), first, many));
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
static etd_status n_scene_add_texture(void) {
    etd_texture texture = small_texture();
    uint32_t *number = AT(3, output(sizeof *number));
    return CALL(etd_scene_add_texture(SCENE(0), AT(1, NULL), AT(2, &texture), number));
}
static etd_status n_scene_set_texture(void) {
    etd_texture texture = small_texture();
    return CALL(etd_scene_set_texture(SCENE(0), 0, AT(1, &texture)));
}
static etd_status n_scene_update_texture(void) {
    const etd_texture texture = small_texture();
    CHECK_OK(etd_scene_set_texture(scene, 0, &texture));
    return CALL(etd_scene_update_texture(SCENE(0), 0));
}
static etd_status n_scene_get_texture(void) {
    etd_texture *texture = AT(1, sized_output(sizeof *texture));
    return CALL(etd_scene_get_texture(SCENE(0), 0, texture));
}
static etd_status n_scene_set_environment_map(void) {
    etd_environment_map map = ETD_ENVIRONMENT_MAP_INIT;
    return CALL(etd_scene_set_environment_map(SCENE(0), AT(1, &map)));
}
static etd_status n_scene_get_environment_map(void) {
    etd_environment_map *map = AT(1, sized_output(sizeof *map));
    return CALL(etd_scene_get_environment_map(SCENE(0), map));
}
/* Under a sky of its own. */
static etd_status n_scene_set_portals(void) {
    float before[3] = {0, 0, 0};
    etd_status status;
    CHECK_OK(etd_scene_get_environment(scene, before));
    CHECK_OK(etd_scene_set_environment(scene, grey));
    status = CALL(etd_scene_set_portals(SCENE(0), AT(1, quad_vertices), 1));
    CHECK_OK(etd_scene_set_environment(scene, before[0] > 0 ? before : NULL));
    return status;
}
static etd_status n_scene_set_backplate(void) {
    etd_backplate backplate = ETD_BACKPLATE_INIT;
    return CALL(etd_scene_set_backplate(SCENE(0), AT(1, &backplate)));
}
static etd_status n_scene_get_backplate(void) {
    etd_backplate *backplate = AT(1, sized_output(sizeof *backplate));
    return CALL(etd_scene_get_backplate(SCENE(0), backplate));
}
static etd_status n_scene_get_portals(void) {
    size_t *count = AT(1, output(sizeof *count));
    return CALL(etd_scene_get_portals(SCENE(0), NULL, 0, count));
}
static etd_status n_scene_add_distant_light(void) {
    etd_distant_light light = ETD_DISTANT_LIGHT_INIT;
    uint32_t *number = AT(2, output(sizeof *number));
    light.irradiance[0] = light.irradiance[1] = light.irradiance[2] = 0;
    return CALL(etd_scene_add_distant_light(SCENE(0), AT(1, &light), number));
}
static void have_distant_light(void) {
    etd_distant_light light = ETD_DISTANT_LIGHT_INIT;
    uint32_t number;
    if (etd_scene_get_distant_light(scene, 0, &light) != ETD_OK) {
        light.irradiance[0] = light.irradiance[1] = light.irradiance[2] = 0;
        CHECK_OK(etd_scene_add_distant_light(scene, &light, &number));
    }
}
static etd_status n_scene_set_distant_light(void) {
    etd_distant_light light = ETD_DISTANT_LIGHT_INIT;
    have_distant_light();
    light.irradiance[0] = light.irradiance[1] = light.irradiance[2] = 0;
    return CALL(etd_scene_set_distant_light(SCENE(0), 0, AT(1, &light)));
}
static etd_status n_scene_get_distant_light(void) {
    etd_distant_light *light = AT(1, sized_output(sizeof *light));
    have_distant_light();
    return CALL(etd_scene_get_distant_light(SCENE(0), 0, light));
}
static etd_status n_scene_set_sky(void) {
    etd_sky sky = ETD_SKY_INIT;
    return CALL(etd_scene_set_sky(SCENE(0), AT(1, &sky)));
}
static etd_status n_scene_get_sky(void) {
    etd_sky *sky = AT(1, sized_output(sizeof *sky));
    return CALL(etd_scene_get_sky(SCENE(0), sky));
}
static etd_status n_sun_direction(void) {
    double *direction = AT(0, output(3 * sizeof *direction));
    return CALL(etd_sun_direction(48, 11, 1.8e9, direction));
}
static etd_status n_scene_find_texture(void) {
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_find_texture(SCENE(0), AT(1, "leaf"), number));
}
static etd_status n_scene_set_material_texture(void) {
    etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
    return CALL(etd_scene_set_material_texture(SCENE(0), 0, AT(1, "color"), AT(2, &binding)));
}
static etd_status n_scene_get_material_texture(void) {
    etd_texture_binding *binding = AT(2, sized_output(sizeof *binding));
    return CALL(etd_scene_get_material_texture(SCENE(0), 0, AT(1, "color"), binding));
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
static etd_status n_film_save(void) { return CALL(etd_film_save(FILM(0), AT(1, "misuse.film"))); }
static etd_status n_film_save_memory(void) {
    static char bytes[1 << 16];
    size_t *size = output(sizeof *size);
    return CALL(etd_film_save_memory(FILM(0), AT(1, bytes), sizeof bytes, nulls >> 1 & 1u ? size : AT(2, size)));
}
static etd_status n_film_load(void) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film **out = AT(3, output(sizeof *out));
    etd_status status = CALL(etd_film_load(DEVICE(0), AT(1, "misuse.film"), AT(2, &options), out));
    if (status == ETD_OK) {
        etd_film_release(*out);
    }
    return status;
}
static etd_status n_film_load_memory(void) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film **out = AT(3, output(sizeof *out));
    etd_status status;
    status = CALL(etd_film_load_memory(DEVICE(0), AT(1, saved_film), saved_size, AT(2, &options), out));
    if (status == ETD_OK) {
        etd_film_release(*out);
    }
    return status;
}
static etd_status n_film_merge(void) {
    etd_render_options options = short_render(1);
    etd_film *part = new_film(device, 4, 4, 0);
    etd_film **out = AT(1, output(sizeof *out));
    etd_status status;
    options.share_number = options.share_count = 1;
    CHECK_OK(etd_render(scene, part, &options));
    status = CALL(etd_film_merge(AT(0, &part), 1, out));
    if (status == ETD_OK) {
        etd_film_release(*out);
    }
    etd_film_release(part);
    return status;
}
/* Another film than that of the task, which other entries of the table read. */
static etd_status n_film_resize(void) {
    etd_film *own = new_film(device, 4, 4, 0);
    const etd_status status = CALL(etd_film_resize((etd_film *)handle(0, own), 8, 2));
    etd_film_release(own);
    return status;
}
static etd_status n_film_get_resolution(void) {
    uint32_t *width = AT(1, output(sizeof *width));
    uint32_t *height = AT(2, output(sizeof *height));
    return CALL(etd_film_get_resolution(FILM(0), width, height));
}
static etd_status n_film_get_share(void) {
    uint32_t *number = AT(1, output(sizeof *number));
    uint32_t *count = AT(2, output(sizeof *count));
    return CALL(etd_film_get_share(FILM(0), number, count));
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
static etd_status n_scene_camera_rays(void) {
    static const float corner[2] = {0, 0};
    etd_ray *rays = AT(2, output(4 * sizeof *rays));
    return CALL(etd_scene_camera_rays(SCENE(0), 2, 2, AT(1, corner), rays));
}
static etd_status n_scene_query(void) {
    static const float from[3] = {0, 5, 0}, down[3] = {0, -1, 0};
    etd_ray_query query = ETD_RAY_QUERY_INIT;
    query.count = 1;
    query.origins = from;
    query.directions = down;
    query.t = output(sizeof *query.t);
    return CALL(etd_scene_query(SCENE(0), AT(1, &query)));
}

static etd_status n_atlas_new(void) {
    etd_atlas_options options = ETD_ATLAS_OPTIONS_INIT;
    etd_atlas **out = AT(2, output(sizeof *out));
    etd_status status;
    options.resolution = 256;
    status = CALL(etd_atlas_new(SCENE(0), AT(1, &options), out));
    if (status == ETD_OK) {
        etd_atlas_release(*out);
    }
    return status;
}
static etd_status n_atlas_retain(void) {
    etd_status status = CALL(etd_atlas_retain(ATLAS(0)));
    if (status == ETD_OK) {
        etd_atlas_release(atlas);
    }
    return status;
}
static etd_status n_atlas_release(void) {
    if (nulls == 0 && wrong_handle == NULL) {
        return ETD_OK;
    }
    etd_atlas_release(ATLAS(0));
    return wrong_handle != NULL ? ETD_INVALID_HANDLE : ETD_OK;
}
static etd_status n_atlas_status(void) {
    char *message = AT(1, output(64));
    etd_atlas_status(atlas, NULL, 0);
    return CALL(etd_atlas_status(ATLAS(0), message, 64));
}
static etd_status n_atlas_get_info(void) {
    etd_atlas_info *info = AT(1, sized_output(sizeof *info));
    return CALL(etd_atlas_get_info(ATLAS(0), info));
}

/* Room for all that the atlas has; where that is too much for the outputs, it is not looked at. */
static union {
    float floats[MISUSE_SIDE * MISUSE_SIDE * 3];
    uint32_t numbers[65536];
    etd_atlas_vertex vertices[16384];
    etd_atlas_surface surfaces[1024];
} copied;

#define COPY(name, array)                                                                    \
    static etd_status n_atlas_copy_##name(void) {                                            \
        size_t *needed = AT(2, output(sizeof *needed));                                      \
        const size_t capacity = sizeof copied.array / sizeof copied.array[0];                \
        if ((nulls & 7u) == 6u) {                                                            \
            expected = ETD_INVALID_ARGUMENT; /* one of the two must be there */              \
        }                                                                                    \
        return CALL(etd_atlas_copy_##name(ATLAS(0), AT(1, copied.array), capacity, needed)); \
    }
COPY(vertices, vertices)
COPY(indices, numbers)
COPY(primitives, numbers)
COPY(surfaces, surfaces)
COPY(coverage, floats)

static etd_status n_atlas_bake(void) {
    etd_render_options options = short_render(1);
    etd_bake_target target = ETD_BAKE_TARGET_INIT;
    etd_summary *summary = AT(3, sized_output(sizeof *summary));
    target.irradiance = copied.floats;
    target.size = sizeof copied.floats;
    return CALL(etd_atlas_bake(ATLAS(0), AT(1, &options), AT(2, &target), summary));
}
static etd_status n_scene_bake_vertices(void) {
    etd_render_options options = short_render(1);
    etd_bake_target target = ETD_BAKE_TARGET_INIT;
    etd_summary *summary = AT(3, sized_output(sizeof *summary));
    target.irradiance = copied.floats;
    target.size = sizeof copied.floats;
    return CALL(etd_scene_bake_vertices(SCENE(0), 0, AT(1, &options), AT(2, &target), summary));
}

static etd_status n_scene_measure(void) {
    static const etd_measuring_point points[2] = {{{0, 2, 0}, {0, 1, 0}}, {{2, 1, 0}, {0, 1, 0}}};
    etd_render_options options = short_render(1);
    double *values = AT(3, output(2 * sizeof *values));
    double *errors = AT(4, output(2 * sizeof *errors));
    etd_summary *summary = AT(5, sized_output(sizeof *summary));
    return CALL(etd_scene_measure(SCENE(0), ETD_QUANTITY_ILLUMINANCE, AT(1, points), 2, AT(2, &options), values, errors,
                                  summary));
}
/* Under a sky of its own. */
static etd_status n_scene_exterior_illuminance(void) {
    float before[3] = {0, 0, 0};
    etd_status status;
    double *value = AT(1, output(sizeof *value));
    double *error = AT(2, output(sizeof *error));
    CHECK_OK(etd_scene_get_environment(scene, before));
    CHECK_OK(etd_scene_set_environment(scene, grey));
    status = CALL(etd_scene_exterior_illuminance(SCENE(0), value, error));
    CHECK_OK(etd_scene_set_environment(scene, before[0] > 0 ? before : NULL));
    return status;
}

static etd_status n_scene_trace_mattes(void) {
    etd_render_options options = short_render(1);
    uint32_t *ids = AT(2, output(4 * sizeof *ids));
    float *coverages = AT(3, output(4 * sizeof *coverages));
    return CALL(etd_scene_trace_mattes(SCENE(0), 2, 1, AT(1, &options), ETD_MATTE_OBJECT, 2, ids, coverages));
}
static etd_status n_matte_id(void) {
    uint32_t *id = AT(1, output(sizeof *id));
    return CALL(etd_matte_id(AT(0, "name"), id));
}

static etd_status n_photometric_color(void) {
    float *color = AT(1, output(3 * sizeof *color));
    return CALL(etd_photometric_color(800, 12.566, 0, AT(0, grey), color));
}

/* A dark lamp of a few lines. */
static etd_web_light dark_lamp(void) {
    static const char text[] = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n";
    etd_web_light web = ETD_WEB_LIGHT_INIT;
    web.text = text;
    web.text_bytes = sizeof text - 1;
    memset(web.factor, 0, sizeof web.factor);
    return web;
}
static etd_status n_scene_add_web_light(void) {
    etd_web_light web = dark_lamp();
    uint32_t *number = AT(2, output(sizeof *number));
    return CALL(etd_scene_add_web_light(SCENE(0), AT(1, &web), number));
}
/* Light 2 is one that an earlier entry of the table has added. */
static etd_status n_scene_set_web_light(void) {
    etd_web_light web = dark_lamp();
    return CALL(etd_scene_set_web_light(SCENE(0), 2, AT(1, &web)));
}
/* A triangle with the web of a dark lamp, for one call each. */
static uint32_t web_surface(etd_surface_web *web) {
    static const char text[] = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n";
    static const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const etd_surface surface = matt();
    uint32_t number = 0;
    CHECK_OK(etd_scene_add_triangle(scene, corners, &surface, &number));
    *web = (etd_surface_web)ETD_SURFACE_WEB_INIT;
    web->text = text;
    web->text_bytes = sizeof text - 1;
    CHECK_OK(etd_scene_set_surface_web(scene, number, web));
    return number;
}
static etd_status n_scene_set_surface_web(void) {
    etd_surface_web web;
    const uint32_t number = web_surface(&web);
    const etd_status status = CALL(etd_scene_set_surface_web(SCENE(0), number, AT(1, &web)));
    CHECK_OK(etd_scene_remove_surface(scene, number));
    return status;
}
static etd_status n_scene_get_surface_web(void) {
    etd_surface_web web;
    const uint32_t number = web_surface(&web);
    etd_surface_web *out = AT(1, sized_output(sizeof *out));
    const etd_status status = CALL(etd_scene_get_surface_web(SCENE(0), number, out));
    CHECK_OK(etd_scene_remove_surface(scene, number));
    return status;
}
/* The samples are of a light that gives some; the surface is one of a dark lamp, which stays. */
static etd_status n_scene_set_spectrum(void) {
    static const double samples[4] = {400, 1, 700, 1};
    etd_spectrum spectrum = ETD_SPECTRUM_INIT;
    etd_surface_web web;
    const uint32_t number = web_surface(&web);
    spectrum.samples = samples;
    spectrum.sample_count = 2;
    const etd_status status =
        CALL(etd_scene_set_spectrum(SCENE(0), ETD_SPECTRUM_OF_SURFACE, number, AT(1, &spectrum)));
    CHECK_OK(etd_scene_remove_surface(scene, number));
    return status;
}
static etd_status n_scene_get_spectrum(void) {
    static const double samples[4] = {400, 1, 700, 1};
    etd_spectrum spectrum = ETD_SPECTRUM_INIT;
    etd_surface_web web;
    const uint32_t number = web_surface(&web);
    spectrum.samples = samples;
    spectrum.sample_count = 2;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, number, &spectrum));
    etd_spectrum *out = AT(1, sized_output(sizeof *out));
    const etd_status status = CALL(etd_scene_get_spectrum(SCENE(0), ETD_SPECTRUM_OF_SURFACE, number, out));
    CHECK_OK(etd_scene_remove_surface(scene, number));
    return status;
}
static etd_status n_scene_get_web_light(void) {
    etd_web_light *web = AT(1, sized_output(sizeof *web));
    return CALL(etd_scene_get_web_light(SCENE(0), 2, web));
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
    {"etd_device_get_info", n_device_get_info, 2, 3, 1},
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
    {"etd_scene_get_principled", n_scene_get_principled, 2, 3, 1},
    {"etd_metal", n_metal, 3, 7, 0},
    {"etd_scene_add_point_light", n_scene_add_point_light, 4, 15, 1},
    {"etd_scene_set_point_light", n_scene_set_point_light, 3, 7, 1},
    {"etd_scene_get_point_light", n_scene_get_point_light, 3, 7, 1},
    {"etd_scene_set_shutter", n_scene_set_shutter, 2, 3, 1},
    {"etd_scene_get_shutter", n_scene_get_shutter, 2, 3, 1},
    {"etd_scene_set_camera_motion", n_scene_set_camera_motion, 2, 3, 1},
    {"etd_scene_set_surface_motion", n_scene_set_surface_motion, 2, 3, 1},
    {"etd_scene_set_light_motion", n_scene_set_light_motion, 2, 3, 1},
    {"etd_scene_set_mesh_steps", n_scene_set_mesh_steps, 1, 1, 1},
    {"etd_scene_add_spot_light", n_scene_add_spot_light, 3, 7, 1},
    {"etd_scene_set_spot_light", n_scene_set_spot_light, 2, 3, 1},
    {"etd_scene_get_spot_light", n_scene_get_spot_light, 2, 3, 1},
    {"etd_scene_add_web_light", n_scene_add_web_light, 3, 7, 1},
    {"etd_scene_set_web_light", n_scene_set_web_light, 2, 3, 1},
    {"etd_scene_get_web_light", n_scene_get_web_light, 2, 3, 1},
    {"etd_scene_set_environment", n_scene_set_environment, 2, 1, 1},
    {"etd_scene_get_environment", n_scene_get_environment, 2, 3, 1},
    {"etd_scene_add_distant_light", n_scene_add_distant_light, 3, 7, 1},
    {"etd_scene_set_distant_light", n_scene_set_distant_light, 2, 3, 1},
    {"etd_scene_get_distant_light", n_scene_get_distant_light, 2, 3, 1},
    {"etd_sun_direction", n_sun_direction, 1, 1, 0},
    {"etd_scene_set_sky", n_scene_set_sky, 2, 3, 1},
    {"etd_scene_get_sky", n_scene_get_sky, 2, 3, 1},
    {"etd_scene_set_environment_map", n_scene_set_environment_map, 2, 1, 1},
    {"etd_scene_get_environment_map", n_scene_get_environment_map, 2, 3, 1},
    {"etd_scene_set_backplate", n_scene_set_backplate, 2, 1, 1},
    {"etd_scene_get_backplate", n_scene_get_backplate, 2, 3, 1},
    {"etd_scene_set_portals", n_scene_set_portals, 2, 3, 1},
    {"etd_scene_get_portals", n_scene_get_portals, 2, 3, 1},
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
    {"etd_scene_set_emits_both", n_scene_set_emits_both, 1, 1, 1},
    {"etd_scene_set_surface_name", n_scene_set_surface_name, 2, 1, 1},
    {"etd_scene_get_surface_name", n_scene_get_surface_name, 3, 1, 1},
    {"etd_scene_set_surface_web", n_scene_set_surface_web, 2, 1, 1},
    {"etd_scene_get_surface_web", n_scene_get_surface_web, 2, 3, 1},
    {"etd_scene_set_spectrum", n_scene_set_spectrum, 2, 1, 1},
    {"etd_scene_get_spectrum", n_scene_get_spectrum, 2, 3, 1},
    {"etd_scene_get_surface", n_scene_get_surface, 2, 3, 1},
    {"etd_scene_get_shape", n_scene_get_shape, 2, 3, 1},
    {"etd_scene_get_mesh", n_scene_get_mesh, 2, 3, 1},
    {"etd_scene_copy_mesh", n_scene_copy_mesh, 3, 1, 1},
    {"etd_scene_find_material", n_scene_find_material, 3, 7, 1},
    {"etd_scene_find_mesh", n_scene_find_mesh, 3, 7, 1},
    {"etd_scene_find_surface", n_scene_find_surface, 3, 7, 1},
    {"etd_scene_add_group", n_scene_add_group, 4, 13, 1},
    {"etd_scene_place_group", n_scene_place_group, 4, 5, 1},
    {"etd_scene_set_placement_transform", n_scene_set_placement_transform, 2, 3, 1},
    {"etd_scene_set_placement_motion", n_scene_set_placement_motion, 2, 3, 1},
    {"etd_scene_get_placement", n_scene_get_placement, 5, 1, 1},
    {"etd_scene_remove_placement", n_scene_remove_placement, 1, 1, 1},
    {"etd_scene_remove_group", n_scene_remove_group, 1, 1, 1},
    {"etd_scene_find_group", n_scene_find_group, 3, 7, 1},
    {"etd_scene_add_mesh", n_scene_add_mesh, 3, 7, 1},
    {"etd_scene_add_mesh_file", n_scene_add_mesh_file, 4, 13, 1},
    {"etd_scene_add_mesh_file_with_progress", n_scene_add_mesh_file_with_progress, 5, 21, 1},
    {"etd_scene_add_mesh_from", n_scene_add_mesh_from, 4, 11, 3},
    {"etd_scene_add_file_surfaces", n_scene_add_file_surfaces, 5, 27, 1},
    {"etd_scene_set_mesh", n_scene_set_mesh, 2, 3, 1},
    {"etd_scene_remove_mesh", n_scene_remove_mesh, 1, 1, 1},
    {"etd_scene_add_texture", n_scene_add_texture, 4, 13, 1},
    {"etd_scene_set_texture", n_scene_set_texture, 2, 3, 1},
    {"etd_scene_update_texture", n_scene_update_texture, 1, 1, 1},
    {"etd_scene_get_texture", n_scene_get_texture, 2, 3, 1},
    {"etd_scene_find_texture", n_scene_find_texture, 3, 7, 1},
    {"etd_scene_set_material_texture", n_scene_set_material_texture, 3, 3, 1},
    {"etd_scene_get_material_texture", n_scene_get_material_texture, 3, 7, 1},
    {"etd_film_new", n_film_new, 3, 7, 1},
    {"etd_film_retain", n_film_retain, 1, 1, 1},
    {"etd_film_release", n_film_release, 1, 0, 1},
    {"etd_film_status", n_film_status, 2, 1, 1},
    {"etd_film_map", n_film_map, 2, 3, 1},
    {"etd_film_unmap", n_film_unmap, 2, 3, 1},
    {"etd_film_copy", n_film_copy, 3, 5, 1},
    {"etd_film_write", n_film_write, 3, 3, 1},
    {"etd_film_get_summary", n_film_get_summary, 2, 3, 1},
    {"etd_film_save", n_film_save, 2, 3, 1},
    {"etd_film_save_memory", n_film_save_memory, 3, 1, 1},
    {"etd_film_load", n_film_load, 4, 11, 1},
    {"etd_film_load_memory", n_film_load_memory, 4, 11, 1},
    {"etd_film_merge", n_film_merge, 2, 3, 0},
    {"etd_film_resize", n_film_resize, 1, 1, 1},
    {"etd_film_get_resolution", n_film_get_resolution, 3, 7, 1},
    {"etd_film_get_share", n_film_get_share, 3, 7, 1},
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
    {"etd_scene_query", n_scene_query, 2, 3, 1},
    {"etd_scene_camera_rays", n_scene_camera_rays, 3, 5, 1},
    {"etd_atlas_new", n_atlas_new, 3, 5, 1},
    {"etd_atlas_retain", n_atlas_retain, 1, 1, 1},
    {"etd_atlas_release", n_atlas_release, 1, 0, 1},
    {"etd_atlas_status", n_atlas_status, 2, 1, 1},
    {"etd_atlas_get_info", n_atlas_get_info, 2, 3, 1},
    {"etd_atlas_copy_vertices", n_atlas_copy_vertices, 3, 1, 1},
    {"etd_atlas_copy_indices", n_atlas_copy_indices, 3, 1, 1},
    {"etd_atlas_copy_primitives", n_atlas_copy_primitives, 3, 1, 1},
    {"etd_atlas_copy_surfaces", n_atlas_copy_surfaces, 3, 1, 1},
    {"etd_atlas_copy_coverage", n_atlas_copy_coverage, 3, 1, 1},
    {"etd_atlas_bake", n_atlas_bake, 4, 5, 1},
    {"etd_scene_bake_vertices", n_scene_bake_vertices, 4, 5, 1},
    {"etd_scene_measure", n_scene_measure, 6, 11, 1},
    {"etd_photometric_color", n_photometric_color, 2, 2, 0},
    {"etd_scene_trace_mattes", n_scene_trace_mattes, 4, 13, 1},
    {"etd_matte_id", n_matte_id, 2, 3, 0},
    {"etd_scene_exterior_illuminance", n_scene_exterior_illuminance, 3, 3, 1},
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
static void pass_null(int quick) {
    size_t entry;
    for (entry = 0; entry < TABLE_SIZE; ++entry) {
        const char *name = table[entry].name;
        /* Without options, a layout has 512 x 512 texels, and a bake many samples of each: `quick` leaves out those that are made. */
        const int is_long = strcmp(name, "etd_atlas_new") == 0 || strcmp(name, "etd_atlas_bake") == 0;
        for (nulls = 0; nulls < 1u << table[entry].pointers; ++nulls) {
            expected = nulls & table[entry].needed ? ETD_INVALID_ARGUMENT : ETD_OK;
            if (!(quick && is_long && expected == ETD_OK && nulls & 2u)) {
                judge("NULL for pointers", entry);
            }
        }
        nulls = 0;
    }
}

/* Something else wherever a handle belongs. */
static void pass_wrong_handles(void) {
    size_t entry;
    for (entry = 0; entry < TABLE_SIZE; ++entry) {
        const void *others[7];
        int kind;
        others[0] = device;
        others[1] = scene;
        others[2] = film;
        others[3] = task;
        others[4] = atlas;
        others[5] = &nothing;
        others[6] = nothing.bytes + 1; /* not aligned either */
        for (wrong_at = 0; wrong_at < 2; ++wrong_at) {
            const int from_scene = strcmp(table[entry].name, "etd_scene_add_mesh_from") == 0;
            const char *name = wrong_at == 0 || from_scene ? table[entry].name : "etd_film_";
            if (!(table[entry].handles >> wrong_at & 1u)) {
                continue;
            }
            for (kind = 0; kind < 7; ++kind) {
                static const char *const prefixes[5] = {"etd_device_", "etd_scene_", "etd_film_", "etd_task_",
                                                        "etd_atlas_"};
                int makes_scene = strcmp(name, "etd_scene_new") == 0 || strncmp(name, "etd_scene_from", 14) == 0;
                int makes_film = strcmp(name, "etd_film_new") == 0 || strncmp(name, "etd_film_load", 13) == 0;
                int asks_scene = strncmp(name, "etd_render", 10) == 0 || strcmp(name, "etd_atlas_new") == 0;
                const char *right = makes_scene || makes_film ? "etd_device_" : asks_scene ? "etd_scene_" : name;
                if (kind < 5 && strncmp(right, prefixes[kind], strlen(prefixes[kind])) == 0) {
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
    etd_atlas_status(atlas, NULL, 0);
    CHECK_OK(etd_atlas_status(atlas, NULL, 0));
    CHECK_OK(etd_film_write(film, "misuse.pfm", NULL));
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
    write_text("misuse-mesh.obj", "mtllib misuse-mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    write_text("misuse-mesh.mtl", "newmtl red\nKd 0.75 0.25 0.25\n");

    device = new_device(1);
    scene = new_scene(device);
    film = new_film(device, 4, 4, 0);
    {
        etd_mesh mesh = small_mesh();
        etd_surface surface = matt();
        etd_material material = ETD_MATERIAL_INIT;
        etd_principled principled = ETD_PRINCIPLED_INIT;
        uint32_t number = 0;
        material.bsdf = ETD_BSDF_PRINCIPLED;
        material.principled = &principled;
        CHECK_OK(etd_scene_add_material(scene, "principled", &material, &number));
        mesh.name = "grid";
        CHECK_OK(etd_scene_add_mesh(scene, &mesh, &mesh_number));
        {
            const etd_texture texture = small_texture();
            CHECK_OK(etd_scene_add_texture(scene, "leaf", &texture, &number));
            CHECK(number == 0);
        }
        CHECK_OK(etd_scene_add_mesh_surface(scene, mesh_number, 0, &surface, &number));
    }
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    CHECK_OK(etd_task_wait(task, -1));
    /* From now on the film knows its scene, which the calls below edit. */
    CHECK_OK(etd_film_save(film, "misuse.film"));
    CHECK_OK(etd_film_save_memory(film, saved_film, sizeof saved_film, &saved_size));
    {
        etd_atlas_options layout = ETD_ATLAS_OPTIONS_INIT;
        layout.resolution = MISUSE_SIDE;
        CHECK_OK(etd_atlas_new(scene, &layout, &atlas));
    }

    {
        const uint32_t surfaces[2] = {0, 1};
        uint32_t placed = 9;
        CHECK_OK(etd_scene_add_group(scene, "pair", surfaces, 2, &group_number));
        CHECK_OK(etd_scene_place_group(scene, group_number, NULL, &placed, NULL));
        CHECK(placed == 0);
    }
    pass_null(quick);
    pass_wrong_handles();
    CHECK_OK(etd_scene_remove_placement(scene, 0));
    misuse_values();
    misuse_cameras();
    misuse_motion();
    misuse_photons();
    misuse_bake(quick);
    misuse_lighting();
    misuse_errors();
    misuse_queries();
    etd_atlas_release(atlas);
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);

    if (!quick) {
        /* Valgrind computes in the default state alone. */
        misuse_float();
    }
    misuse_hosts(quick);
    misuse_life(quick);
    remove("misuse-scene.json");
    remove("misuse-mesh.obj");
    remove("misuse-mesh.mtl");
    remove("misuse.pfm");
    remove("misuse.png");
    remove("misuse.film");
    return check_report("misuse");
}
