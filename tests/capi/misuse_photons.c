/* Settings of photon maps and irradiance caches: every integrator, every field out of its range, the way from a scene's
 * file to options and back, and programs whose options end before these fields. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

/* Few photons: checkers are slow. */
static etd_render_options few_photons(uint32_t integrator) {
    etd_render_options options = short_render(1);
    options.integrator = integrator;
    options.photon_count = options.caustic_count = 200;
    options.photon_radius = options.caustic_radius = 0.5;
    options.cache_rays = 16;
    return options;
}

static etd_status e_integrator(uint32_t value) {
    etd_render_options options = few_photons(value);
    return etd_render(scene, film, &options);
}
static etd_status e_kernel(uint32_t value) {
    etd_render_options options = short_render(1);
    options.photon_kernel = value;
    return etd_render(scene, film, &options);
}
static etd_status e_sharing(uint32_t value) {
    etd_render_options options = short_render(1);
    options.photon_sharing = value;
    return etd_render(scene, film, &options);
}
static etd_status e_guided(uint32_t value) {
    etd_render_options options = short_render(1);
    options.photons_guided = value;
    return etd_render(scene, film, &options);
}
static etd_status e_progressive(uint32_t value) {
    etd_render_options options = short_render(1);
    options.photons_progressive = value;
    return etd_render(scene, film, &options);
}
static etd_status e_source(uint32_t value) {
    etd_render_options options = short_render(1);
    options.cache_source = value;
    return etd_render(scene, film, &options);
}
static etd_status e_measure(uint32_t value) {
    etd_render_options options = short_render(1);
    options.error_measure = value;
    return etd_render(scene, film, &options);
}
static etd_status e_adaptive(uint32_t value) {
    etd_render_options options = short_render(1);
    options.adaptive = value;
    return etd_render(scene, film, &options);
}

static etd_status e_solver(uint32_t value) {
    etd_render_options options = short_render(1);
    options.radiosity_solver = value;
    return etd_render(scene, film, &options);
}
static etd_status e_ambient(uint32_t value) {
    etd_render_options options = short_render(1);
    options.radiosity_ambient = value;
    return etd_render(scene, film, &options);
}
static etd_status e_final_gather(uint32_t value) {
    etd_render_options options = short_render(1);
    options.integrator = ETD_INTEGRATOR_RADIOSITY;
    options.radiosity_final_gather = value;
    return etd_render(scene, film, &options);
}

static void pass_names(void) {
    static const struct {
        const char *name;
        etd_status (*call)(uint32_t value);
        uint32_t last;
    } cases[] = {
        {"options.integrator", e_integrator, ETD_INTEGRATOR_RADIOSITY},
        {"options.photon_kernel", e_kernel, ETD_PHOTON_KERNEL_EPANECHNIKOV},
        {"options.photon_sharing", e_sharing, ETD_PHOTON_SHARING_AREA},
        {"options.photons_guided", e_guided, ETD_SWITCH_OFF},
        {"options.photons_progressive", e_progressive, ETD_SWITCH_OFF},
        {"options.cache_source", e_source, ETD_CACHE_SOURCE_PHOTONS},
        {"options.radiosity_solver", e_solver, ETD_RADIOSITY_SOLVER_SHOOT},
        {"options.radiosity_ambient", e_ambient, ETD_SWITCH_OFF},
        {"options.radiosity_final_gather", e_final_gather, ETD_SWITCH_OFF},
        {"options.error_measure", e_measure, ETD_ERROR_DISPLAY},
        {"options.adaptive", e_adaptive, ETD_SWITCH_OFF},
    };
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
            check_that(strstr(etd_last_error_message(), cases[i].name) != NULL, __FILE__, __LINE__, text);
        }
    }
}

#define NUMBER(field, limit) {"options." #field ":", offsetof(etd_render_options, field), limit}

/* The first whole numbers that are too large, and the last that are not. */
static void pass_whole_numbers(void) {
    static const struct {
        const char *name;
        size_t at;
        uint32_t last;
    } cases[] = {
        NUMBER(photon_count, 1u << 29),   NUMBER(caustic_count, 1u << 29), NUMBER(min_photons, 1u << 29),
        NUMBER(photon_neighbours, 65536), NUMBER(gather_rays, 1024),       NUMBER(photon_memory, 1u << 20),
        NUMBER(cache_rays, 1u << 20),     NUMBER(radiosity_iterations, 1u << 24),
        NUMBER(radiosity_memory, 1u << 20),
    };
    size_t i, k;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const uint32_t wrong[] = {cases[i].last + 1, UINT32_MAX - 1};
        etd_render_options options = short_render(1);
        memcpy((char *)&options + cases[i].at, &cases[i].last, sizeof(uint32_t));
        check_status(etd_render(scene, film, &options), ETD_OK, __FILE__, __LINE__, cases[i].name);
        for (k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
            memcpy((char *)&options + cases[i].at, &wrong[k], sizeof(uint32_t));
            check_status(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT, __FILE__, __LINE__, cases[i].name);
            check_that(strstr(etd_last_error_message(), cases[i].name) != NULL, __FILE__, __LINE__, cases[i].name);
        }
    }
    {
        etd_render_options options = short_render(1);
        options.cache_rays = 15;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.cache_rays: 15 is out of range") != NULL);
        options.cache_rays = 16;
        CHECK_OK(etd_render(scene, film, &options));
        options.spectral = 3;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.spectral") != NULL);
        options.spectral = ETD_SWITCH_OFF;
        options.white_balance[0] = 0.9;
        options.white_balance[1] = 0.5;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.white_balance: [0.9, 0.5] is no light that could be white") != NULL);
        options.white_balance[0] = 0.4476;
        options.white_balance[1] = 0.4074;
        CHECK_OK(etd_render(scene, film, &options));
        options.white_balance[0] = options.white_balance[1] = 0;
        options.sensor_bands[0] = 400;
        options.sensor_bands[1] = 700;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.sensor_bands: paths in three channels have no bands") != NULL);
        options.spectral = ETD_SWITCH_ON;
        CHECK_OK(etd_render(scene, film, &options));
        options.sensor_bands[0] = 700;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.sensor_bands: [700, 700] is no range of bands") != NULL);
        options.sensor_bands[0] = 359;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        options.sensor_bands[0] = 400;
        options.sensor_bands[1] = 831;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        options.sensor_bands[1] = (double)NAN;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        options.sensor_bands[0] = options.sensor_bands[1] = 0;
        options.spectral = ETD_SWITCH_DEFAULT;
        options.roulette = ETD_ROULETTE_FILE;
        CHECK_OK(etd_render(scene, film, &options));
        options.roulette = 2;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.roulette is 2, expected 0 to 1") != NULL);
    }
}

/* Hits that pixels share: what shares none refuses that by name. */
static void pass_shared_hits(void) {
    static const char text[] = "{\"etendue\": 1, " JSON_CAMERA ", \"render\": {\"integrator\": {\"type\": \"path\", \"reuse\": true, \"lightPaths\": false}}}";
    etd_scene *read = NULL;
    etd_render_options options = short_render(1), own = ETD_RENDER_OPTIONS_INIT;
    etd_integrator integrator;
    CHECK(own.reuse == ETD_SWITCH_DEFAULT);
    CHECK_OK(etd_scene_get_render_options(scene, &own));
    CHECK(own.reuse == ETD_SWITCH_DEFAULT && own.light_paths == ETD_SWITCH_DEFAULT);
    CHECK_OK(etd_scene_from_json(device, text, sizeof text - 1, NULL, &read));
    CHECK_OK(etd_scene_get_render_options(read, &own));
    CHECK(own.reuse == ETD_SWITCH_ON && own.light_paths == ETD_SWITCH_OFF);
    etd_scene_release(read);
    options.reuse = 3;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.reuse") != NULL);
    options.reuse = ETD_SWITCH_ON;
    CHECK_OK(etd_render(scene, film, &options));
    for (integrator = ETD_INTEGRATOR_WHITTED; integrator <= ETD_INTEGRATOR_RADIOSITY; ++integrator) {
        options.integrator = integrator;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
        CHECK(strstr(etd_last_error_message(), "integrator.reuse is true, and ") != NULL);
        CHECK(strstr(etd_last_error_message(), " shares no hits among pixels") != NULL);
    }
    options.integrator = ETD_INTEGRATOR_PATH;
    options.spectral = ETD_SWITCH_ON;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.reuse is true, and render.spectral") != NULL);
    options.spectral = ETD_SWITCH_DEFAULT;
    options.adaptive = ETD_SWITCH_ON;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.reuse is true, and adaptive sampling") != NULL);
    options.adaptive = ETD_SWITCH_DEFAULT;
    CHECK_OK(etd_render(scene, film, &options));
}

/* Light paths to the camera: what traces none refuses that by name. */
static void pass_light_paths(void) {
    etd_render_options options = short_render(1);
    etd_integrator integrator;
    options.light_paths = 3;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.light_paths") != NULL);
    options.light_paths = ETD_SWITCH_ON;
    options.max_depth = 0;
    CHECK_OK(etd_render(scene, film, &options));
    for (integrator = ETD_INTEGRATOR_WHITTED; integrator <= ETD_INTEGRATOR_RADIOSITY; ++integrator) {
        options.integrator = integrator;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
        CHECK(strstr(etd_last_error_message(), "integrator.lightPaths is true, and ") != NULL);
        CHECK(strstr(etd_last_error_message(), " traces none to the camera") != NULL);
    }
    options.integrator = ETD_INTEGRATOR_PATH;
    options.max_depth = 5;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.lightPaths is true, and render.maxDepth") != NULL);
    options.max_depth = 0;
    options.filter = ETD_FILTER_MITCHELL;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "integrator.lightPaths is true, and the filter mitchell") != NULL);
}

/* Light samples at what the camera sees: a number out of range is named, and what has none of its own refuses it. */
static void pass_first_shadow_rays(void) {
    static const char text[] = "{\"etendue\": 1, " JSON_CAMERA ", \"render\": {\"integrator\": {\"type\": \"path\", \"firstShadowRays\": 7}}}";
    etd_scene *read = NULL;
    etd_render_options options = short_render(1), own = ETD_RENDER_OPTIONS_INIT;
    etd_integrator integrator;
    CHECK(own.first_shadow_rays == 0);
    CHECK_OK(etd_scene_from_json(device, text, sizeof text - 1, NULL, &read));
    CHECK_OK(etd_scene_get_render_options(read, &own));
    CHECK(own.first_shadow_rays == 7);
    etd_scene_release(read);
    options.first_shadow_rays = 4;
    CHECK_OK(etd_render(scene, film, &options));
    for (integrator = ETD_INTEGRATOR_WHITTED; integrator <= ETD_INTEGRATOR_RADIOSITY; ++integrator) {
        options.integrator = integrator;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
        CHECK(strstr(etd_last_error_message(), "integrator.firstShadowRays is given, and ") != NULL);
    }
    options.integrator = ETD_INTEGRATOR_PATH;
    options.first_shadow_rays = 1025;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.first_shadow_rays: 1025 is out of range") != NULL);
}

/* A bias that the choice of an integrator may have: what chooses none refuses it. */
static void pass_allowed_bias(void) {
    static const char text[] = "{\"etendue\": 1, " JSON_CAMERA ", \"render\": {\"integrator\": {\"type\": \"auto\", \"bias\": \"allowed\"}}}";
    etd_scene *read = NULL;
    etd_render_options options = few_photons(ETD_INTEGRATOR_AUTO), own = ETD_RENDER_OPTIONS_INIT;
    etd_integrator integrator;
    CHECK(own.allow_bias == ETD_SWITCH_DEFAULT);
    CHECK_OK(etd_scene_from_json(device, text, sizeof text - 1, NULL, &read));
    CHECK_OK(etd_scene_get_render_options(read, &own));
    CHECK(own.allow_bias == ETD_SWITCH_ON);
    etd_scene_release(read);
    options.allow_bias = 3;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.allow_bias") != NULL);
    options.allow_bias = ETD_SWITCH_ON;
    for (integrator = ETD_INTEGRATOR_PATH; integrator <= ETD_INTEGRATOR_RADIOSITY; ++integrator) {
        options.integrator = integrator;
        if (integrator == ETD_INTEGRATOR_AUTO) {
            CHECK_OK(etd_render(scene, film, &options));
            continue;
        }
        CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
        CHECK(strstr(etd_last_error_message(), "integrator.bias is allowed, and ") != NULL);
    }
}

/* No numbers, and numbers out of range. */
static void pass_other_numbers(void) {
    static const struct {
        const char *name;
        size_t at;
        double high; /* too high */
    } cases[] = {
        NUMBER(photon_radius, 1e30),    NUMBER(caustic_radius, 1e30),       NUMBER(photon_alpha, 1),
        NUMBER(cache_error, 10.5),      NUMBER(cache_min_spacing, 1000.5),  NUMBER(cache_max_spacing, 1.5),
        NUMBER(radiosity_element_size, 1e30), NUMBER(radiosity_error, 1000.5), NUMBER(radiosity_tolerance, 1),
    };
    const float bad_k[] = {0.5f, -1, (float)NAN, (float)INFINITY};
    etd_render_options options;
    size_t i, k;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const double wrong[] = {cases[i].high, -1, 1e-300, -1e-300, 1e300, (double)NAN, (double)INFINITY, -(double)INFINITY};
        for (k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
            char text[96];
            options = short_render(1);
            memcpy((char *)&options + cases[i].at, &wrong[k], sizeof(double));
            snprintf(text, sizeof text, "%s %g", cases[i].name, wrong[k]);
            check_status(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT, __FILE__, __LINE__, text);
            check_that(strstr(etd_last_error_message(), cases[i].name) != NULL, __FILE__, __LINE__, text);
        }
    }
    for (k = 0; k < sizeof bad_k / sizeof bad_k[0]; ++k) {
        options = short_render(1);
        options.photon_kernel_k = bad_k[k]; /* not looked at */
        CHECK_OK(etd_render(scene, film, &options));
        options.photon_kernel = ETD_PHOTON_KERNEL_CONE;
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "options.photon_kernel_k:") != NULL);
    }
}

/* What a file says is what the options say, and what they say renders the same image. */
static void read_settings_of_a_scene(void) {
    static const char text[] =
        "{\"etendue\": 1, " JSON_CAMERA ", \"render\": {\"resolution\": [4, 4], \"samples\": 2, \"integrator\": "
        "\"photon_direct\", \"photonCount\": 300, \"photonRadius\": 0.7, \"minPhotons\": 2, \"causticCount\": 5, "
        "\"causticRadius\": 0.3, \"photonNeighbours\": 60, \"photonKernel\": {\"type\": \"cone\", \"k\": 1.25}, "
        "\"photonAlpha\": 0.7, \"photonSharing\": \"area\", \"photonsGuided\": false, \"photonsProgressive\": false, "
        "\"gatherRays\": 7, \"photonMemory\": 64, \"cacheError\": 0.3, \"cacheRays\": 32, \"cacheMinSpacing\": 2.5, "
        "\"cacheMaxSpacing\": 0.25, \"cacheSource\": \"photons\"}, \"materials\": [{\"name\": \"white\", \"type\": "
        "\"diffuse\", \"color\": [0.8, 0.8, 0.8]}], \"surfaces\": [{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], "
        "\"radius\": 1, \"material\": \"white\"}, {\"geometry\": \"quad\", \"vertex-1\": [-1, 3, -1], \"vertex-2\": "
        "[1, 3, -1], \"vertex-3\": [1, 3, 1], \"vertex-4\": [-1, 3, 1], \"emission\": [9, 9, 9]}]}";
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_film *small = new_film(device, 4, 4, 0);
    etd_scene *read = NULL;
    float own[4 * 4 * 4], asked[4 * 4 * 4];
    CHECK_OK(etd_scene_from_json(device, text, sizeof text - 1, NULL, &read));
    CHECK_OK(etd_scene_get_render_options(read, &options));
    CHECK(options.integrator == ETD_INTEGRATOR_PHOTON_DIRECT && options.samples == 2);
    CHECK(options.photon_count == 300 && options.photon_radius == 0.7 && options.min_photons == 2);
    CHECK(options.caustic_count == 5 && options.caustic_radius == 0.3 && options.photon_neighbours == 60);
    CHECK(options.photon_kernel == ETD_PHOTON_KERNEL_CONE && options.photon_kernel_k == 1.25f);
    CHECK(options.photon_alpha == 0.7 && options.photon_sharing == ETD_PHOTON_SHARING_AREA);
    CHECK(options.photons_guided == ETD_SWITCH_OFF && options.photons_progressive == ETD_SWITCH_OFF);
    CHECK(options.gather_rays == 7 && options.photon_memory == 64 && options.spectral == ETD_SWITCH_OFF);
    CHECK(options.cache_error == 0.3 && options.cache_rays == 32 && options.cache_min_spacing == 2.5);
    CHECK(options.cache_max_spacing == 0.25 && options.cache_source == ETD_CACHE_SOURCE_PHOTONS);
    CHECK_OK(etd_render(read, small, NULL));
    CHECK_OK(etd_film_copy(small, ETD_LAYER_COLOR, NULL, own, sizeof own, 0));
    CHECK_OK(etd_render(read, small, &options));
    CHECK_OK(etd_film_copy(small, ETD_LAYER_COLOR, NULL, asked, sizeof asked, 0));
    CHECK(memcmp(own, asked, sizeof own) == 0);
    etd_scene_release(read);
    etd_film_release(small);
}

/* A film that is a part of a picture has the pixels of the picture. */
static void pass_parts_of_pictures(void) {
    etd_film *whole = new_film(device, 12, 9, 0), *part = new_film(device, 4, 3, 0);
    etd_render_options options = short_render(4), own = ETD_RENDER_OPTIONS_INIT;
    float all[12 * 9 * 4], some[4 * 3 * 4];
    uint32_t row;
    CHECK_OK(etd_render(scene, whole, &options));
    CHECK_OK(etd_film_copy(whole, ETD_LAYER_COLOR, NULL, all, sizeof all, 0));
    options.picture_width = 12;
    options.picture_height = 9;
    options.crop_left = 8;
    options.crop_top = 5;
    CHECK_OK(etd_render(scene, part, &options));
    CHECK_OK(etd_film_copy(part, ETD_LAYER_COLOR, NULL, some, sizeof some, 0));
    for (row = 0; row < 3; ++row) {
        CHECK(memcmp(some + row * 4 * 4, all + ((5 + row) * 12 + 8) * 4, 4 * 4 * sizeof(float)) == 0);
    }
    options.crop_left = 9;
    CHECK_STATUS(etd_render(scene, part, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.picture_width is 12") != NULL);
    options.crop_left = 0;
    options.crop_top = UINT32_MAX;
    CHECK_STATUS(etd_render(scene, part, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.picture_height is 9") != NULL);
    options.picture_width = options.picture_height = 0;
    CHECK_STATUS(etd_render(scene, part, &options), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "options.crop_top is 4294967295, expected 0 without") != NULL);
    options.crop_top = 0;
    options.picture_width = options.picture_height = UINT32_MAX;
    CHECK_STATUS(etd_render(scene, part, &options), ETD_INVALID_ARGUMENT);
    /* A picture that is the film is what zeros are. */
    options.picture_width = 12;
    options.picture_height = 9;
    CHECK_OK(etd_render(scene, whole, &options));
    CHECK_OK(etd_scene_get_render_options(scene, &own));
    CHECK(own.picture_width == 0 && own.picture_height == 0 && own.crop_left == 0 && own.crop_top == 0);
    etd_film_release(whole);
    etd_film_release(part);
}

/* A program of the version without these fields: what lies behind its structure is not its options. */
static void pass_options_of_the_first_version(void) {
    const size_t first = offsetof(etd_render_options, photon_radius);
    etd_render_options options = short_render(1);
    float whole[4 * 4 * 4], cut[4 * 4 * 4];
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, whole, sizeof whole, 0));
    memset((char *)&options + first, 0x5a, sizeof options - first);
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    options.struct_size = first;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, cut, sizeof cut, 0));
    CHECK(memcmp(whole, cut, sizeof whole) == 0);
    CHECK_OK(etd_scene_get_render_options(scene, &options));
    CHECK(options.struct_size == first && options.spectral == 0x5a5a5a5au && options.photon_count == 0x5a5a5a5au);
    options.struct_size = first - 1 - sizeof options.user_data;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
}

void misuse_photons(void) {
    pass_names();
    pass_whole_numbers();
    pass_other_numbers();
    pass_shared_hits();
    pass_light_paths();
    pass_first_shadow_rays();
    pass_allowed_bias();
    read_settings_of_a_scene();
    pass_parts_of_pictures();
    pass_options_of_the_first_version();
}
