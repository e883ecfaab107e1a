/* Light maps: every option out of its range, targets that are too small, crooked or of the wrong size, and bakes that are
 * stopped. What is refused writes nothing. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>
#include <stddef.h>

static float texels[MISUSE_SIDE * MISUSE_SIDE * 4];
static float errors[MISUSE_SIDE * MISUSE_SIDE * 4];

static void forget(void) {
    size_t i;
    for (i = 0; i < sizeof texels / sizeof texels[0]; ++i) {
        texels[i] = errors[i] = -7;
    }
}

static int is_untouched(void) {
    size_t i;
    for (i = 0; i < sizeof texels / sizeof texels[0]; ++i) {
        if (texels[i] != -7 || errors[i] != -7) {
            return 0;
        }
    }
    return 1;
}

static etd_bake_target whole(void) {
    etd_bake_target target = ETD_BAKE_TARGET_INIT;
    target.irradiance = texels;
    target.size = sizeof texels;
    return target;
}

static void refuse_layout(etd_atlas_options options, etd_status expected, const char *what) {
    etd_atlas *made = NULL;
    check_status(etd_atlas_new(scene, &options, &made), expected, __FILE__, __LINE__, what);
    CHECK(made == NULL);
}

static void pass_layouts(void) {
    etd_atlas_options options = ETD_ATLAS_OPTIONS_INIT;
    static const double bad[] = {-1, 1e300};
    size_t i;
#define REFUSE(field, value, status)                    \
    do {                                                \
        etd_atlas_options other = options;              \
        other.field = value;                            \
        refuse_layout(other, status, #field " " #value); \
    } while (0)
    REFUSE(resolution, 8193, ETD_INVALID_ARGUMENT);
    REFUSE(resolution, UINT32_MAX, ETD_INVALID_ARGUMENT);
    REFUSE(resolution, 3, ETD_INVALID_SCENE);
    REFUSE(gutter, 65, ETD_INVALID_ARGUMENT);
    REFUSE(texels_per_unit, NAN, ETD_INVALID_ARGUMENT);
    REFUSE(texels_per_unit, INFINITY, ETD_INVALID_ARGUMENT);
    REFUSE(max_angle_deg, 90, ETD_INVALID_ARGUMENT);
    REFUSE(max_angle_deg, -1, ETD_INVALID_ARGUMENT);
    REFUSE(max_angle_deg, NAN, ETD_INVALID_ARGUMENT);
    REFUSE(layout, 3, ETD_INVALID_ARGUMENT);
    REFUSE(layout, UINT32_MAX, ETD_INVALID_ARGUMENT);
    REFUSE(reserved, 1, ETD_INVALID_ARGUMENT);
    REFUSE(struct_size, 0, ETD_INVALID_ARGUMENT);
    REFUSE(struct_size, 8, ETD_INVALID_ARGUMENT);
    /* The mesh has no texture coordinates. */
    REFUSE(layout, ETD_ATLAS_LAYOUT_OWN, ETD_INVALID_SCENE);
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        /* Below 0 is no density; the other is one that this scene is too large for. */
        REFUSE(texels_per_unit, bad[i], bad[i] < 0 ? ETD_INVALID_ARGUMENT : ETD_INVALID_SCENE);
    }
    options.resolution = 8192;
    options.memory = 16;
    refuse_layout(options, ETD_OUT_OF_MEMORY, "8192 texels in 16 MiB");
    {
        etd_scene *empty = NULL;
        etd_atlas *made = NULL;
        CHECK_OK(etd_scene_new(device, NULL, &empty));
        CHECK_STATUS(etd_atlas_new(empty, NULL, &made), ETD_INVALID_SCENE);
        CHECK(made == NULL);
        etd_scene_release(empty);
    }
}

/* What a progress function was told. */
struct told {
    int calls;
    int stop_at;
    int is_sane;
    int is_inner;
    double last;
    etd_phase phase;
};

static int32_t hear(void *user_data, const etd_progress *progress) {
    struct told *told = user_data;
    told->is_sane = told->is_sane && progress->struct_size == sizeof *progress && progress->fraction >= told->last &&
                    progress->fraction <= 1 && progress->phase >= told->phase;
    told->is_inner = told->is_inner || (progress->fraction > 0 && progress->fraction < 1);
    told->last = progress->fraction;
    told->phase = progress->phase;
    return ++told->calls == told->stop_at;
}

static struct told nothing(int stop_at) {
    struct told told = {0, 0, 1, 0, 0, ETD_PHASE_BUILD};
    told.stop_at = stop_at;
    return told;
}

/* Stopped at each of its reports, the layout is not there; the next one is whole. */
static void pass_stopped_layouts(int quick) {
    etd_atlas_options options = ETD_ATLAS_OPTIONS_INIT;
    etd_scene *own = new_scene(device);
    etd_atlas *made = NULL;
    struct told told = nothing(0);
    uint32_t grid;
    int stop_at;
    add_grid(own, quick ? 12 : 60, &grid);
    options.resolution = quick ? 128 : 1024;
    options.progress = hear;
    options.user_data = &told;
    /* The scene is built on the way, and told of too. */
    CHECK_OK(etd_atlas_new(own, &options, &made));
    CHECK(told.calls > 5 && told.is_sane && told.is_inner && told.phase == ETD_PHASE_BUILD);
    etd_atlas_release(made);
    for (stop_at = 1; stop_at < 1000; ++stop_at) {
        etd_status status;
        made = NULL;
        told = nothing(stop_at);
        status = etd_atlas_new(own, &options, &made);
        if (told.calls < stop_at) {
            CHECK(status == ETD_OK);
            break;
        }
        CHECK(status == ETD_CANCELLED && made == NULL && told.calls == stop_at && told.is_sane);
    }
    CHECK(stop_at > 5);
    etd_atlas_release(made);
    /* While the scene is being built. */
    {
        etd_scene *other = new_scene(device);
        told = nothing(1);
        made = NULL;
        CHECK_STATUS(etd_atlas_new(other, &options, &made), ETD_CANCELLED);
        CHECK(made == NULL && told.calls >= 1);
        told = nothing(0);
        CHECK_OK(etd_atlas_new(other, &options, &made));
        etd_atlas_release(made);
        etd_scene_release(other);
    }
    /* A program of before has no function behind `reserved`: what stands there is not called. */
    options.struct_size = offsetof(etd_atlas_options, progress);
    told = nothing(1);
    made = NULL;
    CHECK_OK(etd_atlas_new(own, &options, &made));
    CHECK(told.calls == 0);
    etd_atlas_release(made);
    etd_scene_release(own);
}

/* Bakes tell what is done, and stop at any report. */
static void pass_told_bakes(void) {
    etd_render_options options = short_render(4);
    etd_bake_target target = whole();
    etd_scene *own = new_scene(device);
    struct told told = nothing(0);
    int stop_at, calls;
    options.progress = hear;
    options.user_data = &told;
    CHECK_OK(etd_scene_bake_vertices(own, 0, &options, &target, NULL));
    CHECK(told.calls > 4 && told.is_sane && told.is_inner && told.phase == ETD_PHASE_RENDER);
    calls = told.calls;
    for (stop_at = 1; stop_at < 3; ++stop_at) {
        etd_scene *other = new_scene(device);
        told = nothing(stop_at);
        forget();
        CHECK_STATUS(etd_scene_bake_vertices(other, 0, &options, &target, NULL), ETD_CANCELLED);
        CHECK(told.calls >= stop_at && told.calls <= calls);
        CHECK(told.phase != ETD_PHASE_BUILD || is_untouched());
        etd_scene_release(other);
    }
    etd_scene_release(own);

    options.integrator = ETD_INTEGRATOR_RADIOSITY;
    options.radiosity_element_size = 1;
    told = nothing(0);
    CHECK_OK(etd_atlas_bake(atlas, &options, &target, NULL));
    CHECK(told.calls > 8 && told.is_sane && told.is_inner && told.phase == ETD_PHASE_RENDER && told.last > 0.8);
    told = nothing(4);
    forget();
    CHECK_STATUS(etd_atlas_bake(atlas, &options, &target, NULL), ETD_CANCELLED);
    CHECK(told.calls == 4 && is_untouched());
}

static void refuse_target(etd_bake_target target, const char *what) {
    etd_render_options options = short_render(1);
    forget();
    check_status(etd_atlas_bake(atlas, &options, &target, NULL), ETD_INVALID_ARGUMENT, __FILE__, __LINE__, what);
    check_that(is_untouched(), __FILE__, __LINE__, what);
}

static void pass_targets(void) {
    const size_t row = MISUSE_SIDE * 12;
    etd_bake_target target = whole();
    union {
        float *right;
        char *bytes;
    } odd;
#define SPOIL(field, value)                      \
    do {                                         \
        etd_bake_target other = target;          \
        other.field = value;                     \
        refuse_target(other, #field " " #value); \
    } while (0)
    SPOIL(size, 0);
    SPOIL(size, MISUSE_SIDE * row - 1);
    SPOIL(stride, 8);
    SPOIL(stride, 13);
    SPOIL(stride, 1024);
    SPOIL(stride, SIZE_MAX / 2);
    SPOIL(stride, SIZE_MAX - 3);
    SPOIL(row_stride, row - 4);
    SPOIL(row_stride, row + 2);
    SPOIL(row_stride, SIZE_MAX - 3);
    SPOIL(side, 2);
    SPOIL(side, UINT32_MAX);
    SPOIL(reserved, 1);
    SPOIL(struct_size, 0);
    SPOIL(struct_size, 16);
    SPOIL(irradiance, NULL);
    odd.right = texels;
    odd.bytes += 2;
    SPOIL(irradiance, odd.right);
    SPOIL(standard_error, odd.right);
}

static void refuse_options(etd_render_options options, etd_status expected, const char *what) {
    etd_bake_target target = whole();
    forget();
    check_status(etd_atlas_bake(atlas, &options, &target, NULL), expected, __FILE__, __LINE__, what);
    check_status(etd_scene_bake_vertices(scene, 0, &options, &target, NULL), expected, __FILE__, __LINE__, what);
    check_that(is_untouched(), __FILE__, __LINE__, what);
}

static int32_t stop(void *user_data, const etd_progress *progress) {
    ++*(int *)user_data;
    return progress->samples_done >= 1;
}

static void pass_bakes(void) {
    etd_render_options options = short_render(4);
    etd_render_options wrong = options;
    etd_bake_target target = whole();
    etd_summary summary = ETD_SUMMARY_INIT;
    etd_atlas_info info = ETD_ATLAS_INFO_INIT;
    size_t needed = 7;
    int calls = 0;
    wrong.samples = 0;
    refuse_options(wrong, ETD_INVALID_ARGUMENT, "no samples and no limit");
    wrong = options;
    wrong.time_limit = NAN;
    refuse_options(wrong, ETD_INVALID_ARGUMENT, "time_limit NaN");
    wrong = options;
    wrong.shadow_rays = 1025;
    refuse_options(wrong, ETD_INVALID_ARGUMENT, "shadow_rays 1025");
    wrong = options;
    wrong.integrator = 100;
    refuse_options(wrong, ETD_INVALID_ARGUMENT, "integrator 100");
    wrong = options;
    wrong.struct_size = 3;
    refuse_options(wrong, ETD_INVALID_ARGUMENT, "struct_size 3");
    wrong = options;
    wrong.reuse = ETD_SWITCH_ON;
    refuse_options(wrong, ETD_UNSUPPORTED, "hits that pixels share");
    CHECK(strstr(etd_last_error_message(), "integrator.reuse is true, and a light map") != NULL);
    wrong = options;
    wrong.light_paths = ETD_SWITCH_ON;
    refuse_options(wrong, ETD_UNSUPPORTED, "light paths to a camera");
    CHECK(strstr(etd_last_error_message(), "integrator.lightPaths is true, and a light map") != NULL);
    wrong = options;
    wrong.first_shadow_rays = 2;
    refuse_options(wrong, ETD_UNSUPPORTED, "light samples at what a camera sees");
    CHECK(strstr(etd_last_error_message(), "integrator.firstShadowRays is given, and a light map") != NULL);
    wrong = options;
    wrong.integrator = ETD_INTEGRATOR_AUTO;
    wrong.allow_bias = ETD_SWITCH_ON;
    refuse_options(wrong, ETD_UNSUPPORTED, "a bias in a choice for a camera");

    /* Capacities that are too small, and how much is needed. */
    CHECK_OK(etd_atlas_get_info(atlas, &info));
    CHECK(info.width == MISUSE_SIDE && info.height == MISUSE_SIDE && info.covered_texels > 0);
    CHECK_OK(etd_atlas_copy_coverage(atlas, NULL, 0, &needed));
    CHECK(needed == MISUSE_SIDE * MISUSE_SIDE);
    needed = 7;
    forget();
    CHECK_STATUS(etd_atlas_copy_coverage(atlas, texels, MISUSE_SIDE * MISUSE_SIDE - 1, &needed), ETD_INVALID_ARGUMENT);
    CHECK(needed == 7 && is_untouched());

    /* Strides, and a side. Between the texels nothing is written. */
    target.standard_error = errors;
    target.stride = 16;
    forget();
    CHECK_OK(etd_atlas_bake(atlas, &options, &target, &summary));
    CHECK(summary.samples == 4 && summary.ended == ETD_ENDED_SAMPLES && summary.rays > 0);
    {
        size_t i;
        int untouched = 1, sane = 1;
        for (i = 0; i < MISUSE_SIDE * MISUSE_SIDE; ++i) {
            untouched = untouched && texels[4 * i + 3] == -7 && errors[4 * i + 3] == -7;
            sane = sane && texels[4 * i] >= 0 && texels[4 * i] < 1e6f;
        }
        CHECK(untouched && sane);
    }
    target.side = ETD_SIDE_BACK;
    CHECK_OK(etd_atlas_bake(atlas, &options, &target, NULL));

    /* Stopped: what was done is there. */
    options.samples = 1u << 30;
    options.progress = stop;
    options.user_data = &calls;
    forget();
    CHECK_STATUS(etd_atlas_bake(atlas, &options, &target, &summary), ETD_CANCELLED);
    CHECK(calls > 0 && summary.cancelled == 1 && texels[0] >= 0);
    CHECK_STATUS(etd_scene_bake_vertices(scene, 0, &options, &target, NULL), ETD_CANCELLED);

    options = short_render(2);
    forget();
    CHECK_STATUS(etd_scene_bake_vertices(scene, 1000000, &options, &target, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_bake_vertices(scene, ETD_NONE, &options, &target, NULL), ETD_INVALID_ARGUMENT);
    target.size = 4;
    CHECK_STATUS(etd_scene_bake_vertices(scene, 0, &options, &target, NULL), ETD_INVALID_ARGUMENT);
    CHECK(is_untouched());

    /* An atlas outlives its scene, and is of the scene as it was. */
    {
        etd_scene *own = new_scene(device);
        etd_atlas *made = NULL;
        etd_atlas_options layout = ETD_ATLAS_OPTIONS_INIT;
        layout.resolution = MISUSE_SIDE;
        CHECK_OK(etd_atlas_new(own, &layout, &made));
        etd_scene_release(own);
        target = whole();
        CHECK_OK(etd_atlas_bake(made, &options, &target, NULL));
        etd_atlas_release(made);
        CHECK_STATUS(etd_atlas_bake(NULL, &options, &target, NULL), ETD_INVALID_ARGUMENT);
    }
}

/* Messages that name the mirror as what radiosity cannot do, and as what it has no irradiance of. */
struct warned {
    int as_black;
    int without;
};

static void listen(void *user_data, etd_log_level level, const char *message) {
    struct warned *warned = user_data;
    if (level != ETD_LOG_WARNING) {
        return;
    }
    warned->as_black += strstr(message, "as black, being mirrors or glass") != NULL;
    warned->without += strstr(message, "no irradiance for 1 surfaces") != NULL;
}

/* What radiosity cannot do is said before the first ray, whoever asks for it. */
static void pass_warnings(void) {
    struct warned warned = {0, 0};
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_atlas_options layout = ETD_ATLAS_OPTIONS_INIT;
    etd_render_options render = short_render(1);
    etd_bake_target target = whole();
    etd_device *own = NULL;
    etd_scene *mirrored;
    etd_film *image;
    etd_atlas *made = NULL;
    options.log = listen;
    options.user_data = &warned;
    CHECK_OK(etd_device_new(&options, &own));
    mirrored = new_scene(own);
    layout.resolution = MISUSE_SIDE;
    CHECK_OK(etd_atlas_new(mirrored, &layout, &made));
    CHECK_OK(etd_atlas_bake(made, &render, &target, NULL));
    CHECK(warned.as_black == 0 && warned.without == 0);
    /* As coarse as it may be: nothing but what is said is looked at. */
    render.integrator = ETD_INTEGRATOR_RADIOSITY;
    render.radiosity_element_size = 1;
    render.radiosity_error = 100;
    CHECK_OK(etd_atlas_bake(made, &render, &target, NULL));
    CHECK(warned.as_black == 1 && warned.without == 1);
    CHECK_OK(etd_scene_bake_vertices(mirrored, 0, &render, &target, NULL));
    CHECK(warned.as_black == 2 && warned.without == 2);
    image = new_film(own, 8, 8, 0);
    CHECK_OK(etd_render(mirrored, image, &render));
    CHECK(warned.as_black == 3 && warned.without == 2);
    etd_film_release(image);
    etd_atlas_release(made);
    etd_scene_release(mirrored);
    etd_device_release(own);
}

void misuse_bake(int quick) {
    pass_layouts();
    pass_stopped_layouts(quick);
    pass_targets();
    pass_bakes();
    pass_told_bakes();
    pass_warnings();
}
