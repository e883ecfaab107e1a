/* Cameras: every field of a lens and of parallel rays out of its range, fields that a projection does not have, the way in and
 * out again, and programs whose cameras end before these fields. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

static etd_camera with_lens(void) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.lens_radius = 0.25;
    camera.focus_distance = 2;
    camera.focus_at[2] = -3;
    return camera;
}

static etd_camera parallel(void) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.projection = ETD_CAMERA_ORTHOGRAPHIC;
    camera.size = 4;
    return camera;
}

static void check_refused(const etd_camera *camera, etd_status wanted, const char *word) {
    etd_camera before = ETD_CAMERA_INIT, after = ETD_CAMERA_INIT;
    CHECK_OK(etd_scene_get_camera(scene, &before));
    CHECK_STATUS(etd_scene_set_camera(scene, camera), wanted);
    CHECK(strstr(etd_last_error_message(), word) != NULL);
    CHECK_OK(etd_scene_get_camera(scene, &after));
    CHECK(memcmp(&before, &after, sizeof before) == 0);
}

static void pass_enumerations(void) {
    uint32_t value;
    for (value = 0; value < 5; ++value) {
        etd_camera camera = with_lens();
        camera.focus = value;
        CHECK_STATUS(etd_scene_set_camera(scene, &camera),
                     value <= ETD_FOCUS_POINT ? ETD_OK : ETD_INVALID_ARGUMENT);
    }
    for (value = 0; value < 40; ++value) {
        etd_camera camera = with_lens();
        const int is_one = value == 0 || (value >= 3 && value <= 32);
        camera.blades = value;
        if (is_one) {
            CHECK_OK(etd_scene_set_camera(scene, &camera));
        } else {
            check_refused(&camera, ETD_INVALID_SCENE, "blades");
        }
    }
}

static void pass_lens_numbers(void) {
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e39, -1e-3};
    size_t k, i;
    for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
        etd_camera camera = with_lens();
        camera.lens_radius = bad[k];
        check_refused(&camera, ETD_INVALID_SCENE, "lensRadius");
        camera = with_lens();
        camera.focus = ETD_FOCUS_DISTANCE;
        camera.focus_distance = bad[k];
        check_refused(&camera, ETD_INVALID_SCENE, "focusDistance");
        camera = with_lens();
        camera.squeeze = bad[k];
        check_refused(&camera, ETD_INVALID_SCENE, "squeeze");
        camera = parallel();
        camera.size = bad[k];
        check_refused(&camera, ETD_INVALID_SCENE, "width");
        if (k < 4) {
            camera = with_lens();
            camera.blade_rotation_deg = bad[k];
            check_refused(&camera, ETD_INVALID_SCENE, "bladeRotation");
            for (i = 0; i < 3; ++i) {
                camera = with_lens();
                camera.focus = ETD_FOCUS_POINT;
                camera.focus_at[i] = bad[k];
                check_refused(&camera, ETD_INVALID_SCENE, "focusAt");
            }
        }
    }
    {
        etd_camera camera = with_lens();
        camera.focus = ETD_FOCUS_DISTANCE;
        camera.focus_distance = 0;
        check_refused(&camera, ETD_INVALID_SCENE, "focusDistance");
        camera = with_lens();
        camera.focus = ETD_FOCUS_POINT;
        camera.focus_at[2] = 3; /* behind */
        check_refused(&camera, ETD_INVALID_SCENE, "focusAt");
        camera = parallel();
        camera.size = 0;
        check_refused(&camera, ETD_INVALID_SCENE, "width");
        camera.fov_axis = ETD_FOV_VERTICAL;
        check_refused(&camera, ETD_INVALID_SCENE, "height");
    }
}

static void pass_foreign_fields(void) {
    size_t i;
    for (i = 0; i < 2; ++i) {
        etd_camera camera = parallel();
        if (i == 1) {
            camera = (etd_camera)ETD_CAMERA_INIT;
            camera.projection = ETD_CAMERA_VIEW_PLANE;
        }
        camera.lens_radius = 0.1;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "lens_radius");
        camera.lens_radius = 0;
        camera.focus = ETD_FOCUS_DISTANCE;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "focus");
        camera.focus = ETD_FOCUS_LOOK_AT;
        camera.blades = 5;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "blades");
        camera.blades = 0;
        camera.squeeze = 1;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "squeeze");
        camera.squeeze = 0;
        CHECK_OK(etd_scene_set_camera(scene, &camera));
        camera.projection = i == 0 ? ETD_CAMERA_PERSPECTIVE : ETD_CAMERA_VIEW_PLANE;
        camera.size = 4;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "size");
    }
}

static void pass_there_and_back(void) {
    size_t i;
    for (i = 0; i < 5; ++i) {
        etd_camera camera = i < 3 ? with_lens() : parallel(), seen = ETD_CAMERA_INIT;
        if (i < 3) {
            camera.focus = (uint32_t)i;
            camera.blades = 7;
            camera.blade_rotation_deg = -12.5;
            camera.squeeze = 1.5;
        }
        camera.fov_axis = i % 2 == 0 ? ETD_FOV_HORIZONTAL : ETD_FOV_VERTICAL;
        CHECK_OK(etd_scene_set_camera(scene, &camera));
        CHECK_OK(etd_scene_get_camera(scene, &seen));
        /* Fields that say nothing come back as 0. */
        if (i >= 3) {
            camera.fov_deg = 0;
        }
        if (camera.focus != ETD_FOCUS_DISTANCE) {
            camera.focus_distance = 0;
        }
        if (camera.focus != ETD_FOCUS_POINT) {
            camera.focus_at[2] = 0;
        }
        CHECK(memcmp(&camera, &seen, sizeof camera) == 0);
    }
}

static void pass_films(void) {
    const double bad[] = {NAN, INFINITY, -1e9, 100.5};
    const uint32_t all[] = {ETD_CAMERA_PERSPECTIVE, ETD_CAMERA_VIEW_PLANE, ETD_CAMERA_ORTHOGRAPHIC, ETD_CAMERA_SPHERICAL,
                            ETD_CAMERA_CYLINDRICAL, ETD_CAMERA_FISHEYE};
    size_t i, k;
    for (i = 0; i < sizeof all / sizeof all[0]; ++i) {
        etd_camera camera = ETD_CAMERA_INIT, seen = ETD_CAMERA_INIT;
        const int has_shift = all[i] == ETD_CAMERA_PERSPECTIVE || all[i] == ETD_CAMERA_ORTHOGRAPHIC;
        const int has_shape = all[i] != ETD_CAMERA_VIEW_PLANE && all[i] != ETD_CAMERA_SPHERICAL;
        camera.projection = all[i];
        camera.size = all[i] == ETD_CAMERA_ORTHOGRAPHIC ? 2 : 0;
        for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
            camera.shift[k % 2] = bad[k];
            check_refused(&camera, has_shift ? ETD_INVALID_SCENE : ETD_INVALID_ARGUMENT, "shift");
            camera.shift[k % 2] = 0;
            camera.pixel_aspect = bad[k];
            check_refused(&camera, has_shape ? ETD_INVALID_SCENE : ETD_INVALID_ARGUMENT,
                          has_shape ? "pixelAspect" : "pixel_aspect");
            camera.pixel_aspect = 0;
        }
        camera.shift[0] = has_shift ? -0.25 : 0;
        camera.shift[1] = has_shift ? 0.5 : 0;
        camera.pixel_aspect = has_shape ? 1.5 : 0;
        CHECK_OK(etd_scene_set_camera(scene, &camera));
        CHECK_OK(etd_scene_get_camera(scene, &seen));
        CHECK(memcmp(camera.shift, seen.shift, sizeof seen.shift) == 0 && seen.pixel_aspect == camera.pixel_aspect);
        if (has_shape) {
            /* 1 is what 0 means, and comes back as 0. */
            camera.pixel_aspect = 1;
            CHECK_OK(etd_scene_set_camera(scene, &camera));
            CHECK_OK(etd_scene_get_camera(scene, &seen));
            CHECK(seen.pixel_aspect == 0);
        }
    }
}

static void pass_panoramas(void) {
    const uint32_t kinds[] = {ETD_CAMERA_SPHERICAL, ETD_CAMERA_CYLINDRICAL, ETD_CAMERA_FISHEYE};
    const double bad[] = {NAN, INFINITY, -1, 0, 361};
    size_t i, k;
    for (i = 0; i < 3; ++i) {
        etd_camera camera = ETD_CAMERA_INIT, seen = ETD_CAMERA_INIT;
        camera.projection = kinds[i];
        camera.fov_deg = 360;
        CHECK_OK(etd_scene_set_camera(scene, &camera));
        CHECK_OK(etd_scene_get_camera(scene, &seen));
        CHECK(memcmp(&camera, &seen, sizeof camera) == 0);
        for (k = 0; i > 0 && k < sizeof bad / sizeof bad[0]; ++k) {
            camera.fov_deg = bad[k];
            check_refused(&camera, ETD_INVALID_SCENE, "fieldOfView");
        }
        camera.fov_deg = 200;
        camera.fov_axis = ETD_FOV_VERTICAL;
        CHECK_STATUS(etd_scene_set_camera(scene, &camera), i == 1 ? ETD_INVALID_ARGUMENT : ETD_OK);
        camera.fov_axis = ETD_FOV_HORIZONTAL;
        camera.size = 1;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "size");
        camera.size = 0;
        camera.lens_radius = 1;
        check_refused(&camera, ETD_INVALID_ARGUMENT, "lens_radius");
    }
}

/* A program of the version without lenses: what lies behind its structure is not its camera, and its camera is a pinhole. */
static void pass_cameras_of_the_first_version(void) {
    const size_t first = offsetof(etd_camera, size);
    etd_camera camera = ETD_CAMERA_INIT, seen = ETD_CAMERA_INIT;
    memset((char *)&camera + first, 0x5a, sizeof camera - first);
    CHECK_STATUS(etd_scene_set_camera(scene, &camera), ETD_INVALID_ARGUMENT);
    camera.struct_size = first;
    CHECK_OK(etd_scene_set_camera(scene, &camera));
    CHECK_OK(etd_scene_get_camera(scene, &seen));
    CHECK(seen.lens_radius == 0 && seen.blades == 0 && seen.squeeze == 0 && seen.size == 0);
    CHECK(seen.shift[0] == 0 && seen.shift[1] == 0 && seen.pixel_aspect == 0);
    CHECK_OK(etd_scene_get_camera(scene, &camera));
    CHECK(camera.struct_size == first && camera.blades == 0x5a5a5a5au);
}

/* A ball before the lens hides what is behind it from a pinhole, but not from the lens. */
static void pass_pictures(void) {
    etd_scene *made = NULL;
    etd_film *small = NULL;
    etd_film_options size = ETD_FILM_OPTIONS_INIT;
    etd_surface ball = ETD_SURFACE_INIT, lamp = ETD_SURFACE_INIT;
    const double near[3] = {0, 0, -1}, far[3] = {0, 0, -10};
    etd_camera camera = ETD_CAMERA_INIT;
    etd_material black = ETD_MATERIAL_INIT;
    etd_render_options options = short_render(16);
    float pixels[4 * 4 * 4];
    uint32_t number;
    size_t i;
    size.width = size.height = 4;
    CHECK_OK(etd_scene_new(device, NULL, &made));
    CHECK_OK(etd_film_new(device, &size, &small));
    black.bsdf = ETD_BSDF_BLACK;
    CHECK_OK(etd_scene_add_material(made, NULL, &black, &ball.material));
    CHECK_OK(etd_scene_add_sphere(made, near, 0.4, &ball, &number));
    lamp.emission[0] = lamp.emission[1] = lamp.emission[2] = 1;
    CHECK_OK(etd_scene_add_sphere(made, far, 6, &lamp, &number));
    for (i = 0; i < 3; ++i) {
        camera.fov_deg = 20;
        camera.lens_radius = i == 1 ? 1 : 0;
        if (i == 2) {
            camera.projection = ETD_CAMERA_ORTHOGRAPHIC;
            camera.size = 4;
        }
        camera.look_at[2] = -4;
        CHECK_OK(etd_scene_set_camera(made, &camera));
        CHECK_OK(etd_render(made, small, &options));
        CHECK_OK(etd_film_copy(small, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels, 0));
        CHECK((pixels[0] > 0.2f) == (i > 0));
    }
    etd_film_release(small);
    etd_scene_release(made);
}

void misuse_cameras(void) {
    etd_camera before = ETD_CAMERA_INIT;
    CHECK_OK(etd_scene_get_camera(scene, &before));
    pass_enumerations();
    pass_lens_numbers();
    pass_foreign_fields();
    pass_there_and_back();
    pass_films();
    pass_panoramas();
    pass_cameras_of_the_first_version();
    pass_pictures();
    CHECK_OK(etd_scene_set_camera(scene, &before));
}
