/* What errors say: the path of the thing that is wrong, and the option, side or buffer. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "misuse.h"

/* A call fails with this status, and the thread's last error has this JSON path. */
static void refused_at(etd_status got, etd_status wanted, const char *path) {
    etd_error error = ETD_ERROR_INIT;
    CHECK_STATUS(got, wanted);
    CHECK_OK(etd_last_error(&error));
    if (!CHECK(strcmp(error.json_path, path) == 0)) {
        fprintf(stderr, "  the path is '%s', expected '%s'\n", error.json_path, path);
    }
    /* The message of an error about a file begins with the file. */
    CHECK(strstr(error.message, path) != NULL);
}

/* The paths are those that a file would have, with the number that the thing would get. */
static void paths_of_additions(void) {
    static const double flat[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
    static const double no_radii[3] = {1, 0, 1};
    static const double far_away[3] = {0, 1e39, 0};
    static const double no_rows[10] = {1, 1, -1, 0, 0, 0, 0, 0, 0, -1};
    static const float dark[3] = {-1, 0, 0};
    const etd_surface surface = matt();
    etd_scene *own = new_scene(device); /* surfaces 0 to 2, materials 0 and 1, light 0 */
    etd_material material = ETD_MATERIAL_INIT;
    etd_texture texture = small_texture();
    etd_web_light web = ETD_WEB_LIGHT_INIT;
    etd_surface_web surface_web = ETD_SURFACE_WEB_INIT;
    etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
    static float not_finite[16];
    uint32_t number = 77;
    refused_at(etd_scene_add_sphere(own, centre, -1, &surface, &number), ETD_INVALID_SCENE, "surfaces[3].radius");
    refused_at(etd_scene_add_sphere(own, far_away, 1, &surface, &number), ETD_INVALID_SCENE, "surfaces[3].origin[1]");
    refused_at(etd_scene_add_quad(own, flat, &surface, &number), ETD_INVALID_SCENE, "surfaces[3]");
    refused_at(etd_scene_add_disk(own, centre, low, 0, &surface, &number), ETD_INVALID_SCENE, "surfaces[3].radius");
    refused_at(etd_scene_add_cylinder(own, centre, up_axis, 1, 0, &surface, &number), ETD_INVALID_SCENE,
               "surfaces[3].height");
    refused_at(etd_scene_add_cone(own, centre, up_axis, 0, 1, &surface, &number), ETD_INVALID_SCENE,
               "surfaces[3].radius");
    refused_at(etd_scene_add_paraboloid(own, centre, up_axis, 0, 1, &surface, &number), ETD_INVALID_SCENE,
               "surfaces[3].radius");
    refused_at(etd_scene_add_ellipsoid(own, centre, no_radii, &surface, &number), ETD_INVALID_SCENE,
               "surfaces[3].radii[1]");
    refused_at(etd_scene_add_quadric(own, no_rows, NULL, NULL, &surface, &number), ETD_INVALID_SCENE, "surfaces[3]");
    CHECK_OK(etd_scene_remove_surface(own, 1));
    refused_at(etd_scene_add_sphere(own, centre, 0, &surface, &number), ETD_INVALID_SCENE, "surfaces[3].radius");
    refused_at(etd_scene_set_emission(own, 2, dark), ETD_INVALID_SCENE, "surfaces[2].emission[0]");

    material.color[1] = 2;
    refused_at(etd_scene_set_material(own, 1, &material), ETD_INVALID_SCENE, "materials[1].color[1]");

    refused_at(etd_scene_add_point_light(own, centre, dark, &number), ETD_INVALID_SCENE, "lights[1].color[0]");
    spot.outer_cone_deg = 270;
    refused_at(etd_scene_add_spot_light(own, &spot, &number), ETD_INVALID_SCENE, "lights[1].outerConeAngle");
    web.text = "no lamp";
    web.text_bytes = 7;
    refused_at(etd_scene_add_web_light(own, &web, &number), ETD_INVALID_SCENE, "lights[1].file");
    refused_at(etd_scene_set_web_light(own, 0, &web), ETD_INVALID_SCENE, "lights[0].file");
    web.text = NULL;
    web.file = "no-such-lamp.ies";
    refused_at(etd_scene_add_web_light(own, &web, &number), ETD_IO, "lights[1].file");
    surface_web.text = "no lamp";
    surface_web.text_bytes = 7;
    refused_at(etd_scene_set_surface_web(own, 2, &surface_web), ETD_INVALID_SCENE, "surfaces[2].web.file");

    CHECK_OK(etd_scene_add_texture(own, NULL, &texture, &number));
    not_finite[5] = (float)NAN;
    texture.texel_format = ETD_TEXEL_FLOAT;
    texture.texels = not_finite;
    refused_at(etd_scene_add_texture(own, NULL, &texture, &number), ETD_INVALID_SCENE, "textures[1]");
    refused_at(etd_scene_set_texture(own, 0, &texture), ETD_INVALID_SCENE, "textures[0]");
    texture.file = "no-such-image.png";
    refused_at(etd_scene_add_texture(own, NULL, &texture, &number), ETD_IO, "textures[1].file");
    CHECK(number == 0);
    etd_scene_release(own);
}

/* A host sees its own materials alone: a surface without one takes no number, and says that it has none. */
static void surfaces_without_materials(void) {
    static const float bright[3] = {2, 2, 2};
    const double before[3] = {0, 1, 9};
    etd_camera camera = ETD_CAMERA_INIT;
    etd_surface lamp = ETD_SURFACE_INIT;
    etd_surface found = ETD_SURFACE_INIT;
    etd_material grey_one = ETD_MATERIAL_INIT;
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    etd_ray ray = {{0, 1, 9}, 0, {0, 0, -1}, 100};
    etd_hit hit;
    etd_scene *own = NULL;
    uint32_t number = 77;
    CHECK_OK(etd_scene_new(device, NULL, &own));
    memcpy(camera.origin, before, sizeof before);
    CHECK_OK(etd_scene_set_camera(own, &camera));
    memcpy(lamp.emission, bright, sizeof bright);
    CHECK(lamp.material == ETD_NONE);
    CHECK_OK(etd_scene_add_sphere(own, centre, 1, &lamp, &number));
    CHECK_STATUS(etd_scene_set_material(own, 0, &grey_one), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_find_material(own, "(black)", &number), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_add_material(own, "first", &grey_one, &number));
    CHECK(number == 0);
    CHECK_OK(etd_scene_add_sphere(own, low, 1, &lamp, &number));
    CHECK_OK(etd_scene_add_material(own, "second", &grey_one, &number));
    CHECK(number == 1);
    grey_one.color[1] = 2;
    refused_at(etd_scene_add_material(own, NULL, &grey_one, &number), ETD_INVALID_SCENE, "materials[2].color[1]");
    CHECK_OK(etd_scene_get_surface(own, 0, &found));
    CHECK(found.material == ETD_NONE);
    CHECK_OK(etd_scene_commit(own, NULL, NULL));
    CHECK_OK(etd_scene_get_info(own, &info));
    CHECK(info.materials == 2);
    CHECK_OK(etd_scene_intersect(own, &ray, 1, &hit));
    CHECK(hit.surface == 0 && hit.material == ETD_NONE);
    CHECK_OK(etd_scene_set_surface_material(own, 0, 1));
    CHECK_OK(etd_scene_commit(own, NULL, NULL));
    CHECK_OK(etd_scene_intersect(own, &ray, 1, &hit));
    CHECK(hit.surface == 0 && hit.material == 1);
    CHECK_OK(etd_scene_set_surface_material(own, 0, ETD_NONE));
    CHECK_OK(etd_scene_set_emission(own, 0, NULL));
    CHECK_OK(etd_scene_get_surface(own, 0, &found));
    CHECK(found.material == ETD_NONE && found.emission[0] == 0);
    /* More materials than before, so the surface without one has another place in the library. */
    grey_one.color[1] = 0.5f;
    CHECK_OK(etd_scene_add_material(own, NULL, &grey_one, &number));
    CHECK(number == 2);
    CHECK_OK(etd_scene_commit(own, NULL, NULL));
    CHECK_OK(etd_scene_intersect(own, &ray, 1, &hit));
    CHECK(hit.surface == 0 && hit.material == ETD_NONE);
    etd_scene_release(own);
}

/* A call is refused for an argument, with a message that has this in it. */
static void refused_for(etd_status got, const char *what) {
    CHECK_STATUS(got, ETD_INVALID_ARGUMENT);
    if (!CHECK(strstr(etd_last_error_message(), what) != NULL)) {
        fprintf(stderr, "  the message has no '%s'\n", what);
    }
}

static void film_of(uint32_t width, uint32_t height, const char *what) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film *none = NULL;
    options.width = width;
    options.height = height;
    refused_for(etd_film_new(device, &options, &none), what);
    CHECK(none == NULL);
}

static void atlas_of(const etd_atlas_options *options, const char *what) {
    etd_atlas *none = NULL;
    refused_for(etd_atlas_new(scene, options, &none), what);
    CHECK(none == NULL);
}

/* Options are named, with their sides, and so is memory that is not aligned. */
static void options_and_buffers(void) {
    static float pixels[4 * 64 * 64];
    static char texels[80];
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_atlas_options layout = ETD_ATLAS_OPTIONS_INIT;
    etd_image_options floats = ETD_IMAGE_OPTIONS_INIT;
    etd_mesh mesh = small_mesh();
    etd_texture texture = small_texture();
    etd_film *none = NULL;
    uint32_t number = 77;
    film_of(0, 4, "options.width is 0");
    film_of(4, 0, "options.height is 0");
    film_of(UINT32_MAX, 4, "options.width is 4294967295");
    film_of(4, UINT32_MAX, "options.height is 4294967295");
    film_of(65536, 65537, "options.height is 65537, expected ");
    film_of(65537, 65536, "at most beside a height of 65536");
    options.width = options.height = 4;
    options.layers = 1u << 31;
    refused_for(etd_film_new(device, &options, &none), "options.layers");
    options.layers = 0;
    options.reserved = 1;
    refused_for(etd_film_new(device, &options, &none), "options.reserved");

    layout.gutter = 65;
    atlas_of(&layout, "options.gutter");
    layout.gutter = 0;
    layout.resolution = 8193;
    atlas_of(&layout, "options.resolution");
    layout.resolution = 0;
    layout.max_angle_deg = 90;
    atlas_of(&layout, "options.max_angle_deg");
    layout.max_angle_deg = 0;
    layout.texels_per_unit = -1;
    atlas_of(&layout, "options.texels_per_unit");

    floats.format = ETD_FORMAT_FLOAT;
    refused_for(etd_film_copy(film, ETD_LAYER_COLOR, &floats, (char *)pixels + 1, sizeof pixels - 1, 0),
                "pixels is not aligned to 4 bytes");
    refused_for(etd_film_copy(film, ETD_LAYER_COLOR, &floats, pixels, sizeof pixels, 3), "row_stride is 3");
    mesh.positions = (const float *)(const void *)(texels + 1);
    refused_for(etd_scene_add_mesh(scene, &mesh, &number), "is not aligned to 4 bytes");
    mesh = small_mesh();
    mesh.position_stride = 13;
    refused_for(etd_scene_add_mesh(scene, &mesh, &number), "a stride of 13 bytes is not a multiple of 4");
    texture.texel_format = ETD_TEXEL_FLOAT;
    texture.texels = texels + 1;
    refused_for(etd_scene_add_texture(scene, NULL, &texture, &number), "is not aligned to 4 bytes");
    CHECK(number == 77);
}

void misuse_errors(void) {
    paths_of_additions();
    surfaces_without_materials();
    options_and_buffers();
}
