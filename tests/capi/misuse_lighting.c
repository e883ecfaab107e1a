/* Illuminance and luminance: points and quantities that do not exist, and work that is stopped. What is refused writes
 * nothing. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

static double values[2];
static double errors[2];

static void refuse(etd_quantity quantity, const etd_measuring_point *points, size_t count, etd_status expected,
                   const char *what) {
    const etd_render_options options = short_render(1);
    values[0] = values[1] = errors[0] = errors[1] = -7;
    check_status(etd_scene_measure(scene, quantity, points, count, &options, values, errors, NULL), expected, __FILE__,
                 __LINE__, what);
    CHECK(values[0] == -7 && values[1] == -7 && errors[0] == -7 && errors[1] == -7);
}

static int32_t stop(void *user_data, const etd_progress *progress) {
    (void)user_data;
    return progress->phase == ETD_PHASE_RENDER && progress->samples_done >= 8;
}

/* Light in photometric units. */
static void pass_units(void) {
    static const double no_value[] = {0, -1, -0.0};
    static const double no_kelvin[] = {999, 15001, -1};
    static const float black[3] = {0, 0, 0};
    static const float negative[3] = {1, -1, 1};
    static const float hue[3] = {2, 1, 0};
    float color[3] = {-7, -7, -7};
    size_t i;
    for (i = 0; i < 3; ++i) {
        CHECK_STATUS(etd_photometric_color(no_value[i], 0, 0, NULL, color), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_photometric_color(1, 0, no_kelvin[i], NULL, color), ETD_INVALID_ARGUMENT);
    }
    CHECK_STATUS(etd_photometric_color(NAN, 0, 0, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(INFINITY, 0, 0, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1e300, 0, 0, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, NAN, 0, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, -1, 0, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, 0, NAN, NULL, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, 0, 3000, grey, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, 0, 0, black, color), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_photometric_color(1, 0, 0, negative, color), ETD_INVALID_ARGUMENT);
    CHECK(color[0] == -7 && color[1] == -7 && color[2] == -7);
    CHECK_OK(etd_photometric_color(683, 0, 0, NULL, color));
    CHECK(fabs(color[0] - 1) < 1e-6 && color[0] == color[1] && color[1] == color[2]);
    CHECK_OK(etd_photometric_color(683 * 2, 4, 0, hue, color));
    CHECK(fabs(0.2126 * color[0] + 0.7152 * color[1] - 0.5) < 1e-6 && color[0] == 2 * color[1] && color[2] == 0);
    CHECK_OK(etd_photometric_color(683, 0, 2700, NULL, color));
    CHECK(color[0] > color[1] && color[1] > color[2] && color[2] > 0);
    CHECK(fabs(0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2] - 1) < 1e-6);
}

void misuse_lighting(void) {
    static const etd_measuring_point good[2] = {{{0, 2.5, 0}, {0, 5, 0}}, {{2, 1, 0}, {0, 1, 0}}};
    static const double bad[] = {1e39, -1e39};
    etd_render_options options = short_render(16);
    etd_scene *lamp = NULL;
    etd_summary summary = ETD_SUMMARY_INIT;
    const double position[3] = {0, 2, 0};
    const float intensity[3] = {1, 1, 1};
    double value = -7;
    uint32_t number;
    size_t i;
    pass_units();
    for (i = 0; i < sizeof bad / sizeof bad[0] + 2; ++i) {
        const double wrong = i == 0 ? (double)NAN : i == 1 ? (double)INFINITY : bad[i - 2];
        etd_measuring_point points[2];
        points[0] = points[1] = good[0];
        points[1].position[2] = wrong;
        refuse(ETD_QUANTITY_ILLUMINANCE, points, 2, ETD_INVALID_SCENE, "a point beyond single precision");
        points[1] = good[0];
        points[1].direction[0] = wrong;
        refuse(ETD_QUANTITY_LUMINANCE, points, 2, ETD_INVALID_SCENE, "a direction beyond single precision");
        points[1] = good[0];
        points[1].direction[1] = 0;
        refuse(ETD_QUANTITY_LUMINANCE, points, 2, ETD_INVALID_SCENE, "no direction");
    }
    refuse(2, good, 2, ETD_INVALID_ARGUMENT, "a third quantity");
    refuse(UINT32_MAX, good, 2, ETD_INVALID_ARGUMENT, "the last quantity");
    refuse(ETD_QUANTITY_ILLUMINANCE, good, 0, ETD_INVALID_SCENE, "no point");
    refuse(ETD_QUANTITY_ILLUMINANCE, good, SIZE_MAX / 4, ETD_INVALID_ARGUMENT, "more points than memory holds");
    /* 2 W/sr in a distance of 2 and 1 would be lux of 683 / 4 and 683; of nothing but a lamp they are exact. */
    CHECK_OK(etd_scene_new(device, NULL, &lamp));
    CHECK_OK(etd_scene_add_point_light(lamp, position, intensity, &number));
    CHECK_STATUS(etd_scene_exterior_illuminance(lamp, &value, NULL), ETD_INVALID_SCENE);
    CHECK(value == -7);
    {
        static const etd_measuring_point below[2] = {{{0, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, 1, 0}}};
        CHECK_OK(etd_scene_measure(lamp, ETD_QUANTITY_ILLUMINANCE, below, 2, &options, values, NULL, &summary));
        CHECK(fabs(values[0] / (683.0 / 4) - 1) < 1e-5 && fabs(values[1] / 683.0 - 1) < 1e-5);
        CHECK(summary.samples == 16);
    }
    options.reuse = ETD_SWITCH_ON;
    CHECK_STATUS(etd_scene_measure(lamp, ETD_QUANTITY_ILLUMINANCE, good, 2, &options, values, NULL, &summary), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.reuse is true, and light at given points") != NULL);
    options.reuse = ETD_SWITCH_DEFAULT;
    options.light_paths = ETD_SWITCH_ON;
    CHECK_STATUS(etd_scene_measure(lamp, ETD_QUANTITY_ILLUMINANCE, good, 2, &options, values, NULL, &summary), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.lightPaths is true, and light at given points") != NULL);
    options.light_paths = ETD_SWITCH_DEFAULT;
    options.first_shadow_rays = 2;
    CHECK_STATUS(etd_scene_measure(lamp, ETD_QUANTITY_ILLUMINANCE, good, 2, &options, values, NULL, &summary), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.firstShadowRays is given, and light at given points") != NULL);
    options.first_shadow_rays = 0;
    CHECK_OK(etd_scene_set_environment(lamp, grey));
    CHECK_OK(etd_scene_exterior_illuminance(lamp, &value, NULL));
    CHECK(fabs(value / (683.0 * 3.14159265358979 * 0.5) - 1) < 1e-3);
    etd_scene_release(lamp);
    /* Stopped, the arrays have what there was by then. */
    options.samples = 1u << 30;
    options.progress = stop;
    values[0] = values[1] = -7;
    CHECK_STATUS(etd_scene_measure(scene, ETD_QUANTITY_ILLUMINANCE, good, 2, &options, values, errors, &summary), ETD_CANCELLED);
    CHECK(values[0] >= 0 && values[1] >= 0 && summary.samples >= 8);
}
