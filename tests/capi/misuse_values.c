/* Wrong values: structures of the wrong size, enumerations without that value, numbers that are none, numbers of nothing.
 * Each must be refused with the documented status, and change nothing. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

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
static etd_status s_set_shutter(void) { return etd_scene_set_shutter(scene, (etd_shutter *)(void *)&structure); }
static etd_status s_get_shutter(void) { return etd_scene_get_shutter(scene, (etd_shutter *)(void *)&structure); }
static etd_status s_set_camera(void) { return etd_scene_set_camera(scene, (etd_camera *)(void *)&structure); }
static etd_status s_get_camera(void) { return etd_scene_get_camera(scene, (etd_camera *)(void *)&structure); }
static etd_status s_set_material(void) { return etd_scene_set_material(scene, 0, (etd_material *)(void *)&structure); }
static etd_status s_get_material(void) { return etd_scene_get_material(scene, 0, (etd_material *)(void *)&structure); }
static uint32_t principled_number(void) {
    uint32_t number = 0;
    CHECK_OK(etd_scene_find_material(scene, "principled", &number));
    return number;
}
static etd_status s_set_principled(void) {
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_PRINCIPLED;
    material.principled = (etd_principled *)(void *)&structure;
    return etd_scene_set_material(scene, principled_number(), &material);
}
static etd_status s_get_principled(void) {
    return etd_scene_get_principled(scene, principled_number(), (etd_principled *)(void *)&structure);
}
static etd_status s_mesh(void) {
    etd_mesh *mesh = (etd_mesh *)(void *)&structure;
    mesh->positions = small_positions;
    mesh->vertex_count = 3;
    mesh->indices = small_indices;
    mesh->triangle_count = 1;
    return etd_scene_set_mesh(scene, mesh_number, mesh);
}
static etd_status s_texture(void) {
    etd_texture *texture = (etd_texture *)(void *)&structure;
    texture->kind = ETD_TEXTURE_CHECKER;
    return etd_scene_set_texture(scene, 0, texture);
}
static etd_status s_get_texture(void) {
    return etd_scene_get_texture(scene, 0, (etd_texture *)(void *)&structure);
}
static etd_status s_binding(void) {
    return etd_scene_set_material_texture(scene, 0, "color", (etd_texture_binding *)(void *)&structure);
}
static etd_status s_get_binding(void) {
    return etd_scene_get_material_texture(scene, 0, "color", (etd_texture_binding *)(void *)&structure);
}
/* Removes a sky that was tried, since not all renders take one. */
static etd_status then_no_sky(etd_status status) {
    CHECK_OK(etd_scene_set_environment(scene, NULL));
    return status;
}
static etd_status try_sky(const etd_environment_map *map) {
    return then_no_sky(etd_scene_set_environment_map(scene, map));
}
static etd_status s_set_environment_map(void) { return try_sky((etd_environment_map *)(void *)&structure); }
static etd_status s_get_environment_map(void) {
    return etd_scene_get_environment_map(scene, (etd_environment_map *)(void *)&structure);
}
static etd_status s_set_backplate(void) {
    etd_status status = etd_scene_set_backplate(scene, (etd_backplate *)(void *)&structure);
    CHECK_OK(etd_scene_set_backplate(scene, NULL));
    return status;
}
static etd_status s_get_backplate(void) {
    return etd_scene_get_backplate(scene, (etd_backplate *)(void *)&structure);
}
static etd_status s_add_distant_light(void) {
    uint32_t number = 0;
    etd_status status = etd_scene_add_distant_light(scene, (etd_distant_light *)(void *)&structure, &number);
    if (status == ETD_OK) {
        etd_distant_light off = ETD_DISTANT_LIGHT_INIT; /* since not all renders take one */
        off.irradiance[0] = off.irradiance[1] = off.irradiance[2] = 0;
        CHECK_OK(etd_scene_set_distant_light(scene, number, &off));
    }
    return status;
}
static etd_status s_get_distant_light(void) {
    return etd_scene_get_distant_light(scene, 0, (etd_distant_light *)(void *)&structure);
}
static etd_status s_set_sky(void) { return then_no_sky(etd_scene_set_sky(scene, (etd_sky *)(void *)&structure)); }
static etd_status s_get_sky(void) { return etd_scene_get_sky(scene, (etd_sky *)(void *)&structure); }
/* Light 1 is a dark spot light of the table of calls. */
static etd_status s_set_spot(void) {
    etd_spot_light *spot = (etd_spot_light *)(void *)&structure;
    memset(spot->intensity, 0, sizeof spot->intensity);
    return etd_scene_set_spot_light(scene, 1, spot);
}
static etd_status s_get_spot(void) {
    return etd_scene_get_spot_light(scene, 1, (etd_spot_light *)(void *)&structure);
}
/* Light 2 is a dark measured lamp of the table of calls. Without a file and a text it keeps its intensities. */
static etd_status s_set_web(void) {
    etd_web_light *web = (etd_web_light *)(void *)&structure;
    memset(web->factor, 0, sizeof web->factor);
    return etd_scene_set_web_light(scene, 2, web);
}
static etd_status s_get_web(void) { return etd_scene_get_web_light(scene, 2, (etd_web_light *)(void *)&structure); }
/* A triangle with a dark web, which is made once. */
static const char dark_web[] = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n0 0\n";
static uint32_t web_triangle(void) {
    static uint32_t number = ETD_NONE;
    if (number == ETD_NONE) {
        static const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        const etd_surface surface = matt();
        etd_surface_web web = ETD_SURFACE_WEB_INIT;
        CHECK_OK(etd_scene_add_triangle(scene, corners, &surface, &number));
        web.text = dark_web;
        web.text_bytes = sizeof dark_web - 1;
        CHECK_OK(etd_scene_set_surface_web(scene, number, &web));
    }
    return number;
}
static etd_status s_set_surface_web(void) {
    return etd_scene_set_surface_web(scene, web_triangle(), (etd_surface_web *)(void *)&structure);
}
static etd_status s_get_surface_web(void) {
    return etd_scene_get_surface_web(scene, web_triangle(), (etd_surface_web *)(void *)&structure);
}
static etd_status s_set_spectrum(void) {
    ((etd_spectrum *)(void *)&structure)->kind = ETD_SPECTRUM_ILLUMINANT;
    return etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, web_triangle(), (etd_spectrum *)(void *)&structure);
}
static etd_status s_get_spectrum(void) {
    etd_spectrum spectrum = ETD_SPECTRUM_INIT;
    spectrum.kind = ETD_SPECTRUM_ILLUMINANT;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, web_triangle(), &spectrum));
    return etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, web_triangle(), (etd_spectrum *)(void *)&structure);
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
static etd_status s_shape(void) { return etd_scene_get_shape(scene, 0, (etd_shape *)(void *)&structure); }
static etd_status s_mesh_info(void) {
    return etd_scene_get_mesh(scene, mesh_number, (etd_mesh_info *)(void *)&structure);
}
static etd_status s_ray_query(void) { return etd_scene_query(scene, (etd_ray_query *)(void *)&structure); }
static etd_status s_map(void) {
    etd_map *map = (etd_map *)(void *)&structure;
    etd_status status = etd_film_map(film, ETD_LAYER_COLOR, map);
    if (status == ETD_OK) {
        etd_map same = ETD_MAP_INIT;
        same.id = map->id;
        same.data = map->data;
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
static void i_principled(void) { INIT(etd_principled, ETD_PRINCIPLED_INIT); }
static void i_mesh(void) { INIT(etd_mesh, ETD_MESH_INIT); }
static void i_texture(void) { INIT(etd_texture, ETD_TEXTURE_INIT); }
static void i_binding(void) { INIT(etd_texture_binding, ETD_TEXTURE_BINDING_INIT); }
static void i_backplate(void) { INIT(etd_backplate, ETD_BACKPLATE_INIT); }
static void i_environment_map(void) { INIT(etd_environment_map, ETD_ENVIRONMENT_MAP_INIT); }
static void i_distant_light(void) { INIT(etd_distant_light, ETD_DISTANT_LIGHT_INIT); }
static void i_sky(void) { INIT(etd_sky, ETD_SKY_INIT); }
static void i_shutter(void) { INIT(etd_shutter, ETD_SHUTTER_INIT); }
static void i_spot(void) { INIT(etd_spot_light, ETD_SPOT_LIGHT_INIT); }
static void i_web(void) { INIT(etd_web_light, ETD_WEB_LIGHT_INIT); }
static void i_surface_web(void) { INIT(etd_surface_web, ETD_SURFACE_WEB_INIT); }
static void i_spectrum(void) { INIT(etd_spectrum, ETD_SPECTRUM_INIT); }
static void i_surface(void) { INIT(etd_surface, ETD_SURFACE_INIT); }
static void i_render_options(void) { INIT(etd_render_options, ETD_RENDER_OPTIONS_INIT); }
static void i_progress(void) { INIT(etd_progress, ETD_PROGRESS_INIT); }
static void i_summary(void) { INIT(etd_summary, ETD_SUMMARY_INIT); }
static void i_scene_info(void) { INIT(etd_scene_info, ETD_SCENE_INFO_INIT); }
static void i_shape(void) { INIT(etd_shape, ETD_SHAPE_INIT); }
static void i_mesh_info(void) { INIT(etd_mesh_info, ETD_MESH_INFO_INIT); }
static void i_ray_query(void) { INIT(etd_ray_query, ETD_RAY_QUERY_INIT); }
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
        {"etd_principled in", i_principled, s_set_principled, sizeof(etd_principled),
         offsetof(etd_principled, transmission_depth), 0},
        {"etd_principled out", i_principled, s_get_principled, sizeof(etd_principled),
         offsetof(etd_principled, transmission_depth), 1},
        {"etd_mesh", i_mesh, s_mesh, sizeof(etd_mesh), offsetof(etd_mesh, name), 0},
        {"etd_texture in", i_texture, s_texture, sizeof(etd_texture), offsetof(etd_texture, offset), 0},
        {"etd_texture out", i_texture, s_get_texture, sizeof(etd_texture), offsetof(etd_texture, offset), 1},
        {"etd_texture_binding in", i_binding, s_binding, sizeof(etd_texture_binding),
         offsetof(etd_texture_binding, cutoff), 0},
        {"etd_texture_binding out", i_binding, s_get_binding, sizeof(etd_texture_binding),
         offsetof(etd_texture_binding, cutoff), 1},
        {"etd_distant_light in", i_distant_light, s_add_distant_light, sizeof(etd_distant_light),
         offsetof(etd_distant_light, angle_deg), 0},
        {"etd_distant_light out", i_distant_light, s_get_distant_light, sizeof(etd_distant_light),
         offsetof(etd_distant_light, angle_deg), 1},
        {"etd_sky in", i_sky, s_set_sky, sizeof(etd_sky), offsetof(etd_sky, perez), 0},
        {"etd_sky out", i_sky, s_get_sky, sizeof(etd_sky), offsetof(etd_sky, perez), 1},
        {"etd_backplate in", i_backplate, s_set_backplate, sizeof(etd_backplate), offsetof(etd_backplate, radiance), 0},
        {"etd_backplate out", i_backplate, s_get_backplate, sizeof(etd_backplate), offsetof(etd_backplate, radiance), 1},
        {"etd_environment_map in", i_environment_map, s_set_environment_map, sizeof(etd_environment_map),
         offsetof(etd_environment_map, rotation_deg), 0},
        {"etd_environment_map out", i_environment_map, s_get_environment_map, sizeof(etd_environment_map),
         offsetof(etd_environment_map, rotation_deg), 1},
        {"etd_shutter in", i_shutter, s_set_shutter, sizeof(etd_shutter), offsetof(etd_shutter, curve), 0},
        {"etd_shutter out", i_shutter, s_get_shutter, sizeof(etd_shutter), offsetof(etd_shutter, curve), 1},
        {"etd_spot_light in", i_spot, s_set_spot, sizeof(etd_spot_light), offsetof(etd_spot_light, inner_cone_deg), 0},
        {"etd_spot_light out", i_spot, s_get_spot, sizeof(etd_spot_light), offsetof(etd_spot_light, inner_cone_deg), 1},
        {"etd_web_light in", i_web, s_set_web, sizeof(etd_web_light), offsetof(etd_web_light, factor), 0},
        {"etd_web_light out", i_web, s_get_web, sizeof(etd_web_light), offsetof(etd_web_light, factor), 1},
        {"etd_surface_web in", i_surface_web, s_set_surface_web, sizeof(etd_surface_web),
         offsetof(etd_surface_web, tilt_deg), 0},
        {"etd_spectrum in", i_spectrum, s_set_spectrum, sizeof(etd_spectrum), offsetof(etd_spectrum, sample_count), 0},
        {"etd_spectrum out", i_spectrum, s_get_spectrum, sizeof(etd_spectrum), offsetof(etd_spectrum, sample_count), 1},
        {"etd_surface_web out", i_surface_web, s_get_surface_web, sizeof(etd_surface_web),
         offsetof(etd_surface_web, tilt_deg), 1},
        {"etd_surface in", i_surface, s_set_surface, sizeof(etd_surface), offsetof(etd_surface, transform), 0},
        {"etd_surface out", i_surface, s_get_surface, sizeof(etd_surface), offsetof(etd_surface, transform), 1},
        {"etd_render_options in", i_render_options, s_set_render_options, sizeof(etd_render_options),
         offsetof(etd_render_options, user_data), 0},
        {"etd_render_options out", i_render_options, s_get_render_options, sizeof(etd_render_options),
         offsetof(etd_render_options, user_data), 1},
        {"etd_progress", i_progress, s_progress, sizeof(etd_progress), offsetof(etd_progress, images), 1},
        {"etd_summary", i_summary, s_summary, sizeof(etd_summary), offsetof(etd_summary, cancelled), 1},
        {"etd_scene_info", i_scene_info, s_scene_info, sizeof(etd_scene_info), offsetof(etd_scene_info, build_time), 1},
        {"etd_shape", i_shape, s_shape, sizeof(etd_shape), offsetof(etd_shape, clip_max), 1},
        {"etd_mesh_info", i_mesh_info, s_mesh_info, sizeof(etd_mesh_info), offsetof(etd_mesh_info, has_uvs), 1},
        {"etd_ray_query", i_ray_query, s_ray_query, sizeof(etd_ray_query), offsetof(etd_ray_query, primitives_stride), 0},
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
    camera.size = value == ETD_CAMERA_ORTHOGRAPHIC ? 4 : 0;
    return etd_scene_set_camera(scene, &camera);
}
static etd_status e_fov_axis(uint32_t value) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.fov_axis = value;
    return etd_scene_set_camera(scene, &camera);
}
/* Of a material that may name another, which is its own before and after. */
static etd_status set_second(etd_material material) {
    etd_material before = ETD_MATERIAL_INIT;
    etd_status status;
    CHECK_OK(etd_scene_get_material(scene, 1, &before));
    status = etd_scene_set_material(scene, 1, &material);
    CHECK_OK(etd_scene_set_material(scene, 1, &before));
    return status;
}
static etd_status e_bsdf(uint32_t value) {
    const etd_principled principled = ETD_PRINCIPLED_INIT;
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = value;
    material.principled = value == ETD_BSDF_PRINCIPLED ? &principled : NULL;
    return set_second(material);
}
static etd_status e_distribution(uint32_t value) {
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_CONDUCTOR;
    material.distribution = value;
    return set_second(material);
}
static etd_status e_masking(uint32_t value) {
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_ROUGH_DIELECTRIC;
    material.masking = value;
    return set_second(material);
}
static etd_status e_single_scattering(uint32_t value) {
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_CONDUCTOR;
    material.single_scattering = value;
    return set_second(material);
}
static etd_status e_principled_single_scattering(uint32_t value) {
    etd_principled principled = ETD_PRINCIPLED_INIT;
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_PRINCIPLED;
    material.principled = &principled;
    principled.single_scattering = value;
    return set_second(material);
}
static etd_status e_thin_walled(uint32_t value) {
    etd_principled principled = ETD_PRINCIPLED_INIT;
    etd_material material = ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_PRINCIPLED;
    material.principled = &principled;
    principled.thin_walled = value;
    return set_second(material);
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
#define TEXTURE_FIELD(name, field)                   \
    static etd_status name(uint32_t value) {         \
        etd_texture texture = small_texture();       \
        texture.field = value;                       \
        return etd_scene_set_texture(scene, 0, &texture); \
    }
TEXTURE_FIELD(e_texture_kind, kind)
TEXTURE_FIELD(e_texel_format, texel_format)
TEXTURE_FIELD(e_color_space, color_space)
TEXTURE_FIELD(e_texture_filter, filter)
TEXTURE_FIELD(e_wrap_u, wrap_u)
TEXTURE_FIELD(e_wrap_v, wrap_v)
TEXTURE_FIELD(e_texture_sharing, sharing)
static etd_status e_coordinates(uint32_t value) {
    etd_texture texture = small_texture();
    texture.kind = ETD_TEXTURE_CHECKER;
    texture.coordinates = value;
    return etd_scene_set_texture(scene, 0, &texture);
}
static etd_status e_texture_channel(uint32_t value) {
    etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
    binding.channel = value;
    return etd_scene_set_material_texture(scene, 0, "color", &binding);
}
static etd_status e_sky_projection(uint32_t value) {
    etd_environment_map map = ETD_ENVIRONMENT_MAP_INIT;
    map.projection = value;
    return try_sky(&map);
}
static etd_status e_hidden_sky(uint32_t value) {
    etd_environment_map map = ETD_ENVIRONMENT_MAP_INIT;
    map.hidden = value;
    return try_sky(&map);
}
static etd_status e_cie(uint32_t value) {
    etd_sky sky = ETD_SKY_INIT;
    sky.cie = value;
    sky.perez[1] = -1;
    return then_no_sky(etd_scene_set_sky(scene, &sky));
}
static etd_status e_horizontal(uint32_t value) {
    etd_sky sky = ETD_SKY_INIT;
    sky.horizontal = value;
    return then_no_sky(etd_scene_set_sky(scene, &sky));
}
/** A clear sky of Hosek and Wilkie, with nothing else. */
static etd_sky turbid(void) {
    etd_sky sky = ETD_SKY_INIT;
    sky.cie = 0;
    sky.turbidity = 3;
    return sky;
}
static etd_status e_no_disk(uint32_t value) {
    etd_sky sky = turbid();
    sky.no_disk = value;
    return then_no_sky(etd_scene_set_sky(scene, &sky));
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
static etd_status e_primaries_write(uint32_t value) {
    etd_image_options options = ETD_IMAGE_OPTIONS_INIT;
    options.primaries = value;
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
        {"camera_type", e_camera_type, ETD_CAMERA_FISHEYE},
        {"fov_axis", e_fov_axis, ETD_FOV_VERTICAL},
        {"bsdf", e_bsdf, ETD_BSDF_TWO_SIDED},
        {"distribution", e_distribution, ETD_DISTRIBUTION_BECKMANN},
        {"masking", e_masking, ETD_MASKING_V_CAVITY},
        {"single_scattering", e_single_scattering, 1},
        {"single_scattering of a principled material", e_principled_single_scattering, 1},
        {"thin_walled", e_thin_walled, 1},
        {"position_format", e_position_format, ETD_POSITION_DOUBLE3},
        {"sharing", e_sharing, ETD_SHARE},
        {"kind", e_texture_kind, ETD_TEXTURE_VERTEX_COLORS},
        {"texel_format", e_texel_format, ETD_TEXEL_FLOAT},
        {"color_space", e_color_space, ETD_COLOR_SPACE_RAW},
        {"filter of a texture", e_texture_filter, ETD_TEXTURE_FILTER_STOCHASTIC},
        {"wrap_u", e_wrap_u, ETD_WRAP_BLACK},
        {"wrap_v", e_wrap_v, ETD_WRAP_BLACK},
        {"sharing of texels", e_texture_sharing, ETD_SHARE},
        {"coordinates", e_coordinates, ETD_COORDINATES_PLANAR_Z},
        {"channel", e_texture_channel, ETD_CHANNEL_ALPHA},
        {"projection of a sky", e_sky_projection, ETD_SKY_CUBE},
        {"hidden sky", e_hidden_sky, 1},
        {"cie", e_cie, 15},
        {"horizontal", e_horizontal, 1},
        {"no_disk", e_no_disk, 1},
        {"sampler", e_sampler, ETD_SAMPLER_GAUSSIAN},
        {"filter", e_filter, ETD_FILTER_MITCHELL},
        {"format", e_format, ETD_FORMAT_RGBA8},
        {"tone_map of a copy", e_tone_map_copy, ETD_TONE_MAP_ACES},
        {"tone_map of a file", e_tone_map_write, ETD_TONE_MAP_ACES},
        {"primaries of a file", e_primaries_write, ETD_PRIMARIES_XYZ},
        {"text", e_text, ETD_TEXT_WARNINGS},
    };
    static const uint32_t layers[] = {0, 3, ETD_LAYER_ALPHA, 129, 4096, UINT32_MAX};
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
        options.layers = 4096;
        CHECK_STATUS(etd_film_new(device, &options, &made), ETD_INVALID_ARGUMENT);
        options.layers = 4095;
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
    const uint32_t with_web = web_triangle();
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
            etd_environment_map sky = ETD_ENVIRONMENT_MAP_INIT;
            etd_backplate backplate = ETD_BACKPLATE_INIT;
            etd_sky formula = ETD_SKY_INIT;
            etd_distant_light distant = ETD_DISTANT_LIGHT_INIT;
            etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
            etd_web_light web = ETD_WEB_LIGHT_INIT;
            etd_surface_web surface_web = ETD_SURFACE_WEB_INIT;
            memcpy(floats, grey, sizeof grey);
            floats[i] = bad[k];
            CHECK_STATUS(etd_scene_add_point_light(scene, centre, floats, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_point_light(scene, 0, centre, floats), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_environment(scene, floats), ETD_INVALID_SCENE);
            spot.intensity[i] = bad[k];
            CHECK_STATUS(etd_scene_add_spot_light(scene, &spot, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_spot_light(scene, 1, &spot), ETD_INVALID_SCENE);
            web.factor[i] = bad[k];
            CHECK_STATUS(etd_scene_set_web_light(scene, 2, &web), ETD_INVALID_SCENE);
            web = (etd_web_light)ETD_WEB_LIGHT_INIT;
            web.tilt_deg = i == 0 ? (double)NAN : i == 1 ? -181 : 181;
            CHECK_STATUS(etd_scene_set_web_light(scene, 2, &web), ETD_INVALID_SCENE);
            surface_web.c0[i] = (double)bad[k];
            CHECK_STATUS(etd_scene_set_surface_web(scene, with_web, &surface_web), ETD_INVALID_SCENE);
            surface_web = (etd_surface_web)ETD_SURFACE_WEB_INIT;
            surface_web.tilt_deg = i == 0 ? (double)NAN : i == 1 ? -181 : 181;
            CHECK_STATUS(etd_scene_set_surface_web(scene, with_web, &surface_web), ETD_INVALID_SCENE);
            sky.radiance[i] = bad[k];
            CHECK_STATUS(etd_scene_set_environment_map(scene, &sky), ETD_INVALID_SCENE);
            backplate.radiance[i] = bad[k];
            CHECK_STATUS(etd_scene_set_backplate(scene, &backplate), ETD_INVALID_SCENE);
            formula = (etd_sky)ETD_SKY_INIT;
            formula.radiance[i] = bad[k];
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = (etd_sky)ETD_SKY_INIT;
            formula.ground[i] = bad[k];
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = (etd_sky)ETD_SKY_INIT;
            formula.sun[i] = NAN;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = (etd_sky)ETD_SKY_INIT;
            formula.cie = 0;
            formula.perez[i] = NAN;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = turbid();
            formula.turbidity = i == 0 ? bad[k] : i == 1 ? 0.99 : 10.01;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = turbid();
            formula.angle_deg = i == 0 ? NAN : i == 1 ? -1 : 181;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = turbid();
            formula.radiance[i] = bad[k];
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = turbid();
            formula.sun[1] = -1;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_SCENE);
            formula = turbid();
            formula.cie = 12;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_ARGUMENT);
            formula = turbid();
            formula.horizontal = 1;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_ARGUMENT);
            formula = turbid();
            formula.reserved_1 = 1;
            CHECK_STATUS(etd_scene_set_sky(scene, &formula), ETD_INVALID_ARGUMENT);
            distant = (etd_distant_light)ETD_DISTANT_LIGHT_INIT;
            distant.irradiance[i] = bad[k];
            CHECK_STATUS(etd_scene_add_distant_light(scene, &distant, &number), ETD_INVALID_SCENE);
            distant = (etd_distant_light)ETD_DISTANT_LIGHT_INIT;
            distant.towards[i] = NAN;
            CHECK_STATUS(etd_scene_add_distant_light(scene, &distant, &number), ETD_INVALID_SCENE);
            distant = (etd_distant_light)ETD_DISTANT_LIGHT_INIT;
            distant.angle_deg = i == 0 ? NAN : i == 1 ? -1 : 181;
            CHECK_STATUS(etd_scene_add_distant_light(scene, &distant, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_emission(scene, 2, floats), ETD_INVALID_SCENE);
            glowing.emission[i] = 1;
            glowing.emits_both = 1;
            CHECK_STATUS(etd_scene_add_sphere(scene, centre, 1, &glowing, &number), ETD_UNSUPPORTED);
            glowing.emission[i] = 0;
            CHECK_STATUS(etd_scene_add_disk(scene, centre, ones, 1, &glowing, &number), ETD_INVALID_SCENE);
            glowing.reserved = 1;
            CHECK_STATUS(etd_scene_add_disk(scene, centre, ones, 1, &glowing, &number), ETD_INVALID_ARGUMENT);
            glowing.emits_both = glowing.reserved = 0;
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

/* A material is refused, as a new one and in the place of another, which it does not change. */
static void refuse(const etd_material *material, etd_status wanted, const char *what) {
    etd_material before = ETD_MATERIAL_INIT;
    etd_material after = ETD_MATERIAL_INIT;
    uint32_t number = 4321;
    CHECK_OK(etd_scene_get_material(scene, 1, &before));
    check_status(etd_scene_add_material(scene, NULL, material, &number), wanted, __FILE__, __LINE__, what);
    check_status(etd_scene_set_material(scene, 1, material), wanted, __FILE__, __LINE__, what);
    check_that(number == 4321, __FILE__, __LINE__, what);
    CHECK_OK(etd_scene_get_material(scene, 1, &after));
    check_that(memcmp(&before, &after, sizeof before) == 0, __FILE__, __LINE__, what);
}

/* Every number of every model in turn becomes none, infinite, too small and too large. */
/* Webs of surfaces that are not flat, that send light behind, and that are given twice or not at all. */
static void pass_surface_webs(void) {
    static const char even[] = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 180\n0\n5 5\n";
    static const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    etd_surface surface = matt();
    etd_surface_web web = ETD_SURFACE_WEB_INIT;
    etd_surface_web out = ETD_SURFACE_WEB_INIT;
    uint32_t flat = 0;
    uint32_t round = 0;
    surface.emission[0] = surface.emission[1] = surface.emission[2] = 1;
    CHECK_OK(etd_scene_add_triangle(scene, corners, &surface, &flat));
    CHECK_OK(etd_scene_add_sphere(scene, centre, 1, &surface, &round));
    CHECK_STATUS(etd_scene_set_surface_web(scene, flat, &web), ETD_INVALID_ARGUMENT); /* nothing to keep */
    CHECK_STATUS(etd_scene_get_surface_web(scene, flat, &out), ETD_INVALID_ARGUMENT);
    web.file = "no-such-file.ies";
    CHECK_STATUS(etd_scene_set_surface_web(scene, flat, &web), ETD_IO);
    web.text = even;
    web.text_bytes = sizeof even - 1;
    CHECK_STATUS(etd_scene_set_surface_web(scene, flat, &web), ETD_INVALID_ARGUMENT); /* given twice */
    web.file = NULL;
    CHECK_STATUS(etd_scene_set_surface_web(scene, round, &web), ETD_UNSUPPORTED);
    CHECK_STATUS(etd_scene_set_surface_web(scene, flat, &web), ETD_INVALID_SCENE); /* half of the light goes behind */
    CHECK_OK(etd_scene_set_emits_both(scene, flat, 1));
    web.c0[1] = 2;
    CHECK_OK(etd_scene_set_surface_web(scene, flat, &web));
    CHECK_STATUS(etd_scene_set_emits_both(scene, flat, 0), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_get_surface_web(scene, flat, &out));
    CHECK(out.text == NULL && out.file == NULL && out.c0[1] == 2 && out.tilt_deg == 0);
    CHECK_OK(etd_scene_set_surface_web(scene, flat, &out)); /* keeps its intensities */
    CHECK_OK(etd_scene_set_surface_web(scene, flat, NULL));
    CHECK_STATUS(etd_scene_get_surface_web(scene, flat, &out), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_set_emits_both(scene, flat, 0));
    web.text = "no lamp";
    web.text_bytes = 7;
    CHECK_STATUS(etd_scene_set_surface_web(scene, flat, &web), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_remove_surface(scene, flat));
    CHECK_OK(etd_scene_remove_surface(scene, round));
}

/* Spectra that are none, of things that do not exist, and of parameters that a material does not have. */
static void pass_spectra(void) {
    static const double good[4] = {400, 0.25, 700, 0.75};
    static const double falling[4] = {700, 0.25, 400, 0.75};
    static const double bright[4] = {400, 0.25, 700, 1.75};
    static const double unseen[4] = {1000, 1, 2000, 1};
    static const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const unsigned targets[] = {ETD_SPECTRUM_OF_SURFACE, ETD_SPECTRUM_OF_POINT_LIGHT,
                                       ETD_SPECTRUM_OF_DISTANT_LIGHT, ETD_SPECTRUM_OF_COLOR};
    etd_surface surface = matt();
    etd_spectrum spectrum = ETD_SPECTRUM_INIT;
    etd_spectrum out = ETD_SPECTRUM_INIT;
    etd_surface known = ETD_SURFACE_INIT;
    uint32_t flat = 0;
    size_t i;
    CHECK_OK(etd_scene_add_triangle(scene, corners, &surface, &flat));
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_SCENE); /* no samples */
    spectrum.sample_count = 2;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_ARGUMENT);
    spectrum.samples = good;
    spectrum.sample_count = (size_t)1 << 60;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_ARGUMENT);
    spectrum.sample_count = 2;
    for (i = 0; i < sizeof targets / sizeof *targets; ++i) {
        CHECK_STATUS(etd_scene_set_spectrum(scene, targets[i], 1000000, &spectrum), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_spectrum(scene, targets[i], 1000000, &out), ETD_INVALID_ARGUMENT);
    }
    CHECK_STATUS(etd_scene_set_spectrum(scene, 11, 0, &spectrum), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_ENVIRONMENT, 1, &spectrum), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_ETA, 0, &spectrum), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &out), ETD_INVALID_ARGUMENT);
    spectrum.samples = falling;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &spectrum), ETD_INVALID_SCENE);
    spectrum.samples = bright;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &spectrum), ETD_INVALID_SCENE);
    spectrum.samples = unseen;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_SCENE);
    spectrum.samples = good;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &spectrum));
    CHECK_OK(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &out));
    CHECK(out.kind == ETD_SPECTRUM_SAMPLES && out.sample_count == 2 && out.samples == NULL);
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, NULL));
    CHECK_STATUS(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_COLOR, 0, &out), ETD_INVALID_ARGUMENT);
    spectrum.kind = ETD_SPECTRUM_BLACK_BODY;
    spectrum.temperature = 3;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_SCENE);
    spectrum.temperature = (double)NAN;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_SCENE);
    spectrum.kind = ETD_SPECTRUM_DAYLIGHT;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_SCENE);
    spectrum.temperature = 5000;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum));
    CHECK_OK(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &out));
    CHECK(out.kind == ETD_SPECTRUM_DAYLIGHT && out.temperature == 5000);
    spectrum.kind = ETD_SPECTRUM_ILLUMINANT;
    spectrum.illuminant = ETD_ILLUMINANT_FL12;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum));
    CHECK_OK(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &out));
    CHECK(out.kind == ETD_SPECTRUM_ILLUMINANT && out.illuminant == ETD_ILLUMINANT_FL12);
    spectrum.illuminant = 18;
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_ARGUMENT);
    spectrum.illuminant = ETD_ILLUMINANT_D65;
    CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum));
    CHECK_OK(etd_scene_get_surface(scene, flat, &known));
    CHECK(known.emission[0] > 0.99F && known.emission[0] < 1.01F && known.emission[2] > 0.99F && known.emission[2] < 1.01F);
    {
        char name[16] = "before";
        size_t needed = 0;
        CHECK_OK(etd_scene_get_surface_name(scene, flat, name, sizeof name, &needed));
        CHECK(needed == 1 && name[0] == 0);
        CHECK_STATUS(etd_scene_set_surface_name(scene, flat, "\xff"), ETD_INVALID_ARGUMENT);
        CHECK_OK(etd_scene_set_surface_name(scene, flat, "the lamp"));
        CHECK_OK(etd_scene_get_surface_name(scene, flat, name, 4, &needed));
        CHECK(needed == 9 && strcmp(name, "the") == 0);
        CHECK_OK(etd_scene_set_surface_name(scene, flat, NULL));
        CHECK_OK(etd_scene_get_surface_name(scene, flat, name, sizeof name, NULL));
        CHECK(name[0] == 0);
    }
    CHECK_OK(etd_scene_remove_surface(scene, flat));
    CHECK_STATUS(etd_scene_set_surface_name(scene, flat, "gone"), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_SURFACE, flat, &spectrum), ETD_INVALID_ARGUMENT);
    { /* lights that are changed keep their spectra */
        etd_distant_light sun = ETD_DISTANT_LIGHT_INIT;
        etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
        uint32_t number = 0;
        CHECK_OK(etd_scene_add_distant_light(scene, &sun, &number));
        CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_DISTANT_LIGHT, number, &spectrum));
        CHECK_OK(etd_scene_set_distant_light(scene, number, &sun));
        CHECK_OK(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_DISTANT_LIGHT, number, &out));
        CHECK(out.kind == ETD_SPECTRUM_ILLUMINANT && out.illuminant == ETD_ILLUMINANT_D65);
        sun.irradiance[0] = sun.irradiance[1] = sun.irradiance[2] = 0;
        CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_DISTANT_LIGHT, number, NULL));
        CHECK_OK(etd_scene_set_distant_light(scene, number, &sun));
        CHECK_OK(etd_scene_add_spot_light(scene, &spot, &number));
        CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_POINT_LIGHT, number, &spectrum));
        CHECK_OK(etd_scene_set_spot_light(scene, number, &spot));
        CHECK_OK(etd_scene_get_spectrum(scene, ETD_SPECTRUM_OF_POINT_LIGHT, number, &out));
        CHECK_OK(etd_scene_set_spectrum(scene, ETD_SPECTRUM_OF_POINT_LIGHT, number, NULL));
        spot.intensity[0] = spot.intensity[1] = spot.intensity[2] = 0;
        CHECK_OK(etd_scene_set_spot_light(scene, number, &spot));
    }
}

static void pass_materials(void) {
    static const struct {
        const char *name;
        etd_bsdf model;
        size_t field;
        size_t count;
        float below, above;
    } numbers[] = {
#define OF(model, field, count, below, above) \
    {#model " " #field, model, offsetof(etd_material, field), count, below, above}
        OF(ETD_BSDF_EON, color, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_EON, roughness, 1, -0.1f, 1.1f),
        OF(ETD_BSDF_DIFFUSE_TRANSMISSION, color, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_DIFFUSE_TRANSMISSION, transmittance, 3, -1, 0.6f),
        OF(ETD_BSDF_SHEEN, color, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_SHEEN, roughness, 1, -0.1f, 1.1f),
        OF(ETD_BSDF_CONDUCTOR, color, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_CONDUCTOR, edge_tint, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_CONDUCTOR, eta, 3, -0.1f, 2e6f),
        OF(ETD_BSDF_CONDUCTOR, roughness, 1, -0.1f, 1.1f),
        OF(ETD_BSDF_CONDUCTOR, anisotropy, 1, -0.1f, 1),
        OF(ETD_BSDF_CONDUCTOR, rotation_deg, 1, -361, 361),
        OF(ETD_BSDF_ROUGH_DIELECTRIC, ior, 1, 0, -1.5f),
        OF(ETD_BSDF_ROUGH_DIELECTRIC, exterior_ior, 1, -1, -0.1f),
        OF(ETD_BSDF_ROUGH_DIELECTRIC, roughness, 1, -0.1f, 1.1f),
        OF(ETD_BSDF_ROUGH_DIELECTRIC, anisotropy, 1, -0.1f, 1),
        OF(ETD_BSDF_ROUGH_DIELECTRIC, rotation_deg, 1, -361, 361),
        OF(ETD_BSDF_THIN_DIELECTRIC, ior, 1, 0, -1.5f),
        OF(ETD_BSDF_THIN_DIELECTRIC, exterior_ior, 1, -1, -0.1f),
        OF(ETD_BSDF_THIN_DIELECTRIC, transmittance, 3, -1, 1.1f),
        OF(ETD_BSDF_COATED_DIFFUSE, color, 3, -0.1f, 1.1f),
        OF(ETD_BSDF_COATED_DIFFUSE, ior, 1, 0, -1.5f),
        OF(ETD_BSDF_COATED_DIFFUSE, exterior_ior, 1, -1, -0.1f),
        OF(ETD_BSDF_COATED_DIFFUSE, roughness, 1, -0.1f, 1.1f),
        OF(ETD_BSDF_COATED_DIFFUSE, anisotropy, 1, -0.1f, 1),
        OF(ETD_BSDF_COATED_DIFFUSE, rotation_deg, 1, -361, 361),
        OF(ETD_BSDF_MIX, weight, 1, -0.1f, 1.1f),
#undef OF
    };
    static const struct {
        const char *name;
        size_t field;
        size_t count;
        float below, above;
    } parameters[] = {
#define OF(field, count, below, above) {#field, offsetof(etd_principled, field), count, below, above}
        OF(base_weight, 1, -0.1f, 1.1f),
        OF(base_color, 3, -0.1f, 1.1f),
        OF(base_diffuse_roughness, 1, -0.1f, 1.1f),
        OF(base_metalness, 1, -0.1f, 1.1f),
        OF(specular_weight, 1, -0.1f, 1.1f),
        OF(specular_color, 3, -0.1f, 1.1f),
        OF(specular_roughness, 1, -0.1f, 1.1f),
        OF(specular_roughness_anisotropy, 1, -0.1f, 1),
        OF(specular_rotation_deg, 1, -361, 361),
        OF(specular_ior, 1, 0, -1.5f),
        OF(transmission_weight, 1, -0.1f, 1.1f),
        OF(transmission_color, 3, -0.1f, 1.1f),
        OF(transmission_depth, 1, -0.1f, -1e30f),
        OF(coat_weight, 1, -0.1f, 1.1f),
        OF(coat_color, 3, -0.1f, 1.1f),
        OF(coat_roughness, 1, -0.1f, 1.1f),
        OF(coat_roughness_anisotropy, 1, -0.1f, 1),
        OF(coat_ior, 1, 0, -1.5f),
        OF(coat_darkening, 1, -0.1f, 1.1f),
        OF(fuzz_weight, 1, -0.1f, 1.1f),
        OF(fuzz_color, 3, -0.1f, 1.1f),
        OF(fuzz_roughness, 1, 0, 1.1f),
#undef OF
    };
    const float none = (float)NAN;
    const float infinite = (float)INFINITY;
    const uint64_t before = population();
    const uint32_t nobody[] = {1, 1000000, UINT32_MAX - 1, UINT32_MAX};
    etd_material material = ETD_MATERIAL_INIT;
    etd_principled principled = ETD_PRINCIPLED_INIT;
    uint32_t number = 4321;
    uint32_t glass = 0;
    size_t i, at, k;
    for (i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        const float bad[] = {none, infinite, -infinite, numbers[i].below, numbers[i].above};
        for (at = 0; at < numbers[i].count; ++at) {
            for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
                material = (etd_material)ETD_MATERIAL_INIT;
                material.bsdf = numbers[i].model;
                memcpy((char *)&material + numbers[i].field + at * sizeof(float), &bad[k], sizeof(float));
                refuse(&material, ETD_INVALID_SCENE, numbers[i].name);
            }
        }
    }
    for (i = 0; i < 3; ++i) {
        const float bad[] = {none, infinite, -infinite, -0.1f, 2e6f};
        for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
            material = (etd_material)ETD_MATERIAL_INIT;
            material.bsdf = ETD_BSDF_CONDUCTOR;
            material.eta[0] = material.eta[1] = material.eta[2] = 1;
            material.k[i] = bad[k];
            refuse(&material, ETD_INVALID_SCENE, "k");
        }
    }
    for (k = 0; k < 5; ++k) {
        const float bad[] = {none, infinite, -infinite, -0.1f, 10001};
        material = (etd_material)ETD_MATERIAL_INIT;
        material.bsdf = ETD_BSDF_DIELECTRIC;
        material.film_ior = 1.3f;
        material.film_thickness = bad[k];
        refuse(&material, ETD_INVALID_SCENE, "film_thickness");
    }
    for (k = 0; k < 6; ++k) {
        const float bad[] = {none, infinite, -infinite, -0.1f, 0, 101};
        material = (etd_material)ETD_MATERIAL_INIT;
        material.bsdf = ETD_BSDF_CONDUCTOR;
        material.film_thickness = 100;
        material.film_ior = bad[k];
        refuse(&material, ETD_INVALID_SCENE, "film_ior");
    }
    material = (etd_material)ETD_MATERIAL_INIT;
    material.film_thickness = 100;
    material.film_ior = 1.3f;
    refuse(&material, ETD_INVALID_SCENE, "a film on a diffuse surface");
    /* Three zeros are no index; one zero is a wrong index. */
    material = (etd_material)ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_CONDUCTOR;
    material.eta[1] = 1;
    refuse(&material, ETD_INVALID_SCENE, "an index of zero in a channel");
    for (i = 0; i < sizeof parameters / sizeof parameters[0]; ++i) {
        const float bad[] = {none, infinite, -infinite, parameters[i].below, parameters[i].above};
        for (at = 0; at < parameters[i].count; ++at) {
            for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
                principled = (etd_principled)ETD_PRINCIPLED_INIT;
                material = (etd_material)ETD_MATERIAL_INIT;
                material.bsdf = ETD_BSDF_PRINCIPLED;
                material.principled = &principled;
                memcpy((char *)&principled + parameters[i].field + at * sizeof(float), &bad[k], sizeof(float));
                refuse(&material, ETD_INVALID_SCENE, parameters[i].name);
            }
        }
    }
    material.principled = NULL;
    refuse(&material, ETD_INVALID_ARGUMENT, "no parameters");

    /* Materials that do not exist, come later, or are the material itself. */
    for (i = 0; i < sizeof nobody / sizeof nobody[0]; ++i) {
        const etd_bsdf models[2] = {ETD_BSDF_MIX, ETD_BSDF_TWO_SIDED};
        for (k = 0; k < 4; ++k) {
            material = (etd_material)ETD_MATERIAL_INIT;
            material.bsdf = models[k / 2];
            *(k % 2 == 0 ? &material.first : &material.second) = nobody[i];
            CHECK_STATUS(etd_scene_set_material(scene, 1, &material), ETD_INVALID_SCENE);
            if (nobody[i] != 1) {
                refuse(&material, ETD_INVALID_SCENE, "a material that does not exist");
            }
        }
    }
    material = (etd_material)ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_MIX;
    CHECK_STATUS(etd_scene_set_material(scene, 0, &material), ETD_INVALID_SCENE);

    /* A side that transmits light, and a material that begins to, while another has it as a side. */
    CHECK(population() == before);
    material = (etd_material)ETD_MATERIAL_INIT;
    material.bsdf = ETD_BSDF_THIN_DIELECTRIC;
    CHECK_OK(etd_scene_add_material(scene, NULL, &material, &glass));
    material.bsdf = ETD_BSDF_TWO_SIDED;
    material.second = glass;
    CHECK_STATUS(etd_scene_add_material(scene, NULL, &material, &number), ETD_INVALID_SCENE);
    material.second = 0;
    CHECK_OK(etd_scene_set_material(scene, glass, &material));
    material.bsdf = ETD_BSDF_DIELECTRIC;
    CHECK_STATUS(etd_scene_set_material(scene, 0, &material), ETD_INVALID_SCENE);
    CHECK(number == 4321);

    /* What is not principled has no such parameters, and nothing is written. */
    principled.base_weight = 7;
    CHECK_STATUS(etd_scene_get_principled(scene, 0, &principled), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_get_principled(scene, 1000000, &principled), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_get_principled(scene, ETD_NONE, &principled), ETD_INVALID_ARGUMENT);
    CHECK(principled.base_weight == 7);
    {
        static const char *const unknown[] = {"", "au", "Au ", "AU", "gold", "\xff\xfe", "Ag\xc3\xa9"};
        float eta[3] = {7, 7, 7};
        float extinction[3] = {7, 7, 7};
        char long_name[4097];
        memset(long_name, 'x', sizeof long_name - 1);
        long_name[sizeof long_name - 1] = 0;
        for (i = 0; i < sizeof unknown / sizeof unknown[0]; ++i) {
            CHECK_STATUS(etd_metal(unknown[i], eta, extinction), ETD_INVALID_ARGUMENT);
        }
        CHECK_STATUS(etd_metal(long_name, eta, extinction), ETD_INVALID_ARGUMENT);
        CHECK(strlen(etd_last_error_message()) < 256);
        CHECK(strstr(etd_last_error_message(), "Ag, Al, Au, Cr, Cu, Fe, Hg, Ir, Ni, Rh, TiN, W") != NULL);
        CHECK(eta[0] == 7 && extinction[2] == 7);
    }
    {
        /* A program of the first version knows neither the fields nor what lies behind its structure. */
        const size_t first_version = offsetof(etd_material, anisotropy);
        etd_material old = ETD_MATERIAL_INIT;
        memset((char *)&old + first_version, 0x5a, sizeof old - first_version);
        old.struct_size = first_version;
        CHECK_OK(etd_scene_set_material(scene, 0, &old));
        CHECK_OK(etd_scene_get_material(scene, 0, &old));
        CHECK(old.first == 0x5a5a5a5a && old.struct_size == first_version && old.color[0] == 0.5f);
    }
    /* All the surfaces that were added until now become glass, of which radiosity takes no time. */
    material = (etd_material)ETD_MATERIAL_INIT;
    CHECK_OK(etd_scene_set_material(scene, glass, &material));
    material.bsdf = ETD_BSDF_DIELECTRIC;
    CHECK_OK(etd_scene_set_material(scene, 0, &material));
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
        etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
        etd_web_light web = ETD_WEB_LIGHT_INIT;
        etd_mesh mesh = small_mesh();
        uint32_t bad_indices[3] = {0, 1, 3};
        double position[3] = {7, 7, 7};
        float intensity[3] = {7, 7, 7};
        uint32_t number = 4321;
        CHECK_STATUS(etd_scene_set_material(scene, n, &material), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_material(scene, n, &material), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_point_light(scene, n, centre, grey), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_point_light(scene, n, position, intensity), ETD_INVALID_ARGUMENT);
        {
            etd_distant_light light = ETD_DISTANT_LIGHT_INIT;
            CHECK_STATUS(etd_scene_set_distant_light(scene, n, &light), ETD_INVALID_ARGUMENT);
            CHECK_STATUS(etd_scene_get_distant_light(scene, n, &light), ETD_INVALID_ARGUMENT);
        }
        CHECK(position[0] == 7 && intensity[2] == 7);
        CHECK_STATUS(etd_scene_set_spot_light(scene, n, &spot), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_spot_light(scene, n, &spot), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_web_light(scene, n, &web), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_get_web_light(scene, n, &web), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_add_mesh_surface(scene, n, 0, &surface, &number), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_remove_surface(scene, n), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_transform(scene, n, ones), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_surface_material(scene, n, 0), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_emission(scene, n, grey), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_emits_both(scene, n, 1), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_scene_set_surface_name(scene, n, "none"), ETD_INVALID_ARGUMENT);
        {
            char name[4];
            CHECK_STATUS(etd_scene_get_surface_name(scene, n, name, sizeof name, NULL), ETD_INVALID_ARGUMENT);
        }
        {
            etd_surface_web lit = ETD_SURFACE_WEB_INIT;
            CHECK_STATUS(etd_scene_set_surface_web(scene, n, &lit), ETD_INVALID_ARGUMENT);
            CHECK_STATUS(etd_scene_set_surface_web(scene, n, NULL), ETD_INVALID_ARGUMENT);
            CHECK_STATUS(etd_scene_get_surface_web(scene, n, &lit), ETD_INVALID_ARGUMENT);
        }
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
        device_options.log_choice = 2;
        CHECK_STATUS(etd_device_new(&device_options, &no_device), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.log_choice is 2, expected 0 to 1") != NULL);
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
        CHECK_STATUS(etd_scene_add_file_surfaces(scene, "no-such-file.obj", 0, NULL, &number, &number), ETD_IO);
        {
            static const double flat[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
            static const double none[12] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
            CHECK_STATUS(etd_scene_add_file_surfaces(scene, "misuse-mesh.obj", 0, flat, &number, &number), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_add_file_surfaces(scene, "misuse-mesh.obj", 0, none, &number, &number),
                         ETD_INVALID_ARGUMENT);
        }
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

void misuse_values(void) {
    pass_wrong_sizes();
    pass_wrong_enumerations();
    pass_numbers();
    pass_surface_webs();
    pass_spectra();
    pass_materials();
    pass_indices();
    ask_for_errors();
}
