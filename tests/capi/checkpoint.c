/* Films that are saved, loaded, merged and gone on from: the pixels are those of one render, to the last bit. What is no film, was changed
 * or is of another render is refused by a status, and changes nothing. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

CHECK_MAIN;

/* Six tiles, of which some are cut. */
#define WIDTH 40
#define HEIGHT 24
#define PIXELS (WIDTH * HEIGHT * 4)
#define SHARES 3

/* Bytes of a saved film, to be freed. */
struct bytes {
    unsigned char *data;
    size_t size;
};

static struct bytes saved(const etd_film *film) {
    struct bytes bytes = {NULL, 0};
    size_t again = 0;
    CHECK_OK(etd_film_save_memory(film, NULL, 0, &bytes.size));
    bytes.data = malloc(bytes.size);
    if (bytes.size == 0 || bytes.data == NULL) {
        fprintf(stderr, "nothing was saved\n");
        exit(2);
    }
    CHECK_OK(etd_film_save_memory(film, bytes.data, bytes.size, &again));
    CHECK(again == bytes.size);
    return bytes;
}

static etd_film *loaded(etd_device *device, struct bytes bytes) {
    etd_film *film = NULL;
    CHECK_OK(etd_film_load_memory(device, bytes.data, bytes.size, NULL, &film));
    return film;
}

static int have_same_pixels(const etd_film *a, const etd_film *b) {
    static float of_a[PIXELS], of_b[PIXELS];
    CHECK_OK(etd_film_copy(a, ETD_LAYER_COLOR, NULL, of_a, sizeof of_a, 0));
    CHECK_OK(etd_film_copy(b, ETD_LAYER_COLOR, NULL, of_b, sizeof of_b, 0));
    return memcmp(of_a, of_b, sizeof of_a) == 0;
}

/* Whether two films show the same pixels and say the same errors, which a cancelled render says none of. */
static int are_same(const etd_film *a, const etd_film *b) {
    etd_summary says_a = ETD_SUMMARY_INIT, says_b = ETD_SUMMARY_INIT;
    CHECK_OK(etd_film_get_summary(a, &says_a));
    CHECK_OK(etd_film_get_summary(b, &says_b));
    return have_same_pixels(a, b) && says_a.rel_mse == says_b.rel_mse && says_a.rel_mse > 0 &&
           says_a.rel_mse_standard_error == says_b.rel_mse_standard_error &&
           says_a.display_error == says_b.display_error && says_a.samples == says_b.samples &&
           says_a.samples_min == says_b.samples_min && says_a.samples_max == says_b.samples_max;
}

/* Whether a file has these bytes. */
static int file_has(const char *path, struct bytes bytes) {
    unsigned char *read = malloc(bytes.size + 1);
    FILE *file = fopen(path, "rb");
    int same = 0;
    if (file != NULL && read != NULL) {
        same = fread(read, 1, bytes.size + 1, file) == bytes.size && memcmp(read, bytes.data, bytes.size) == 0;
    }
    if (file != NULL) {
        fclose(file);
    }
    free(read);
    return same;
}

static int message_has(const char *text) {
    const int has = strstr(etd_last_error_message(), text) != NULL;
    if (!has) {
        fprintf(stderr, "expected \"%s\"\n", text);
    }
    return has;
}

static const char path[] = "checkpoint-file";
static const char folder[] = "checkpoint-folder";

static int is_there(const char *name) {
    FILE *file = fopen(name, "rb");
    return file != NULL && fclose(file) == 0;
}

/* Stops a render at its third report with samples. */
static int32_t stop_soon(void *user_data, const etd_progress *progress) {
    int *reports = user_data;
    return progress->phase == ETD_PHASE_RENDER && progress->samples_done > 0 && ++*reports == 3;
}

/* The same where the state is in a file by then. */
static int32_t stop_where_written(void *user_data, const etd_progress *progress) {
    const int32_t stops = stop_soon(user_data, progress);
    if (stops) {
        CHECK(is_there(path));
    }
    return stops;
}

/* Takes the place where the last state is to be written. */
static int32_t lose_folder(void *user_data, const etd_progress *progress) {
    (void)user_data, (void)progress;
    rmdir(folder);
    return 0;
}

static etd_film *stopped(etd_device *device, etd_scene *scene, etd_render_options options) {
    etd_film *film = new_film(device, WIDTH, HEIGHT, 0);
    int reports = 0;
    options.progress = options.checkpoint_file == NULL ? stop_soon : stop_where_written;
    options.user_data = &reports;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_CANCELLED);
    return film;
}

/* Parts of a picture, rendered apart, sent as bytes and put together in another order. */
static void pass_shares(etd_device *device, etd_scene *scene) {
    etd_device *elsewhere = new_device(1);
    etd_film *whole = new_film(device, WIDTH, HEIGHT, 0), *merged = NULL, *again, *parts[SHARES];
    etd_render_options options = short_render(16);
    etd_summary one = ETD_SUMMARY_INIT, all = ETD_SUMMARY_INIT;
    struct bytes bytes, again_bytes;
    uint32_t k, number = 7, count = 7;
    CHECK_OK(etd_render(scene, whole, &options));
    CHECK_OK(etd_film_get_share(whole, &number, &count));
    CHECK(number == 0 && count == 0);
    for (k = 0; k < SHARES; ++k) {
        etd_film *part = new_film(device, WIDTH, HEIGHT, 0);
        options.share_number = k + 1;
        options.share_count = SHARES;
        CHECK_OK(etd_render(scene, part, &options));
        bytes = saved(part);
        etd_film_release(part);
        /* The order is 3, 1, 2. */
        parts[(k + 1) % SHARES] = part = loaded(elsewhere, bytes);
        free(bytes.data);
        CHECK_OK(etd_film_get_share(part, &number, &count));
        CHECK(number == k + 1 && count == SHARES);
        CHECK_OK(etd_film_get_resolution(part, &number, &count));
        CHECK(number == WIDTH && count == HEIGHT);
    }
    CHECK_OK(etd_film_merge(parts, SHARES, &merged));
    CHECK(are_same(whole, merged));
    CHECK_OK(etd_film_get_summary(whole, &one));
    CHECK_OK(etd_film_get_summary(merged, &all));
    CHECK(one.rays == all.rays && all.elapsed == 0 && all.ended == ETD_ENDED_SAMPLES && all.cancelled == 0);
    /* The bytes are those of one render, too, and so are those of what was loaded. */
    bytes = saved(whole);
    again_bytes = saved(merged);
    CHECK(bytes.size == again_bytes.size && memcmp(bytes.data, again_bytes.data, bytes.size) == 0);
    free(again_bytes.data);
    again = loaded(device, bytes);
    CHECK(are_same(whole, again));
    again_bytes = saved(again);
    CHECK(bytes.size == again_bytes.size && memcmp(bytes.data, again_bytes.data, bytes.size) == 0);
    free(again_bytes.data);
    free(bytes.data);
    /* The parts are what they were, and the whole may have more samples. */
    CHECK_OK(etd_film_get_share(parts[0], &number, &count));
    CHECK(number == 3 && count == SHARES);
    options = short_render(32);
    CHECK_OK(etd_render(scene, whole, &options));
    options.resume = merged;
    CHECK_OK(etd_render(scene, again, &options));
    CHECK(are_same(whole, again));
    CHECK_OK(etd_film_get_share(merged, &number, &count));
    CHECK(number == 0 && count == 0);
    for (k = 0; k < SHARES; ++k) {
        etd_film_release(parts[k]);
    }
    etd_film_release(whole);
    etd_film_release(again);
    etd_film_release(merged);
    etd_device_release(elsewhere);
}

/* A render that is stopped, moved and gone on with. */
static void pass_interruptions(etd_device *device, etd_scene *scene, etd_integrator integrator) {
    etd_device *elsewhere = new_device(1);
    etd_scene *same = new_scene(elsewhere);
    etd_film *whole = new_film(device, WIDTH, HEIGHT, 0), *film, *moved, *more = new_film(elsewhere, WIDTH, HEIGHT, 0);
    etd_render_options options = short_render(64);
    etd_task *task = NULL;
    etd_summary summary = ETD_SUMMARY_INIT;
    struct bytes bytes;
    options.integrator = integrator;
    options.photon_count = options.caustic_count = 2000;
    CHECK_OK(etd_render(scene, whole, &options));
    film = stopped(device, scene, options);
    CHECK(!have_same_pixels(whole, film));
    bytes = saved(film);
    moved = loaded(elsewhere, bytes);
    CHECK(have_same_pixels(moved, film));
    CHECK_OK(etd_film_get_summary(moved, &summary));
    CHECK(summary.samples > 0 && summary.samples < 64);
    /* On another film, by a task. */
    options.resume = moved;
    CHECK_OK(etd_render_start(same, more, &options, &task));
    CHECK_OK(etd_task_wait(task, -1));
    etd_task_release(task);
    CHECK(are_same(whole, more));
    {
        /* It had less to do. */
        etd_summary all = ETD_SUMMARY_INIT, rest = ETD_SUMMARY_INIT;
        CHECK_OK(etd_film_get_summary(whole, &all));
        CHECK_OK(etd_film_get_summary(more, &rest));
        CHECK(rest.rays < all.rays && summary.rays > 0 && rest.rays + summary.rays >= all.rays);
    }
    /* What it went on from is as it was. */
    {
        struct bytes now = saved(moved);
        CHECK(now.size == bytes.size && memcmp(now.data, bytes.data, bytes.size) == 0);
        free(now.data);
    }
    /* On the film itself, which was loaded or rendered. */
    CHECK_OK(etd_render(same, moved, &options));
    CHECK(are_same(whole, moved));
    options.resume = film;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK(are_same(whole, film));
    /* By a task that is cancelled before it has begun and while it goes on. */
    etd_film_release(moved);
    moved = loaded(elsewhere, bytes);
    options.resume = moved;
    CHECK_OK(etd_render_start(same, more, &options, &task));
    CHECK_OK(etd_task_cancel(task));
    while (etd_task_wait(task, -1) == ETD_CANCELLED) {
        CHECK_OK(etd_task_resume(task));
        sleep_ms(1);
    }
    CHECK_OK(etd_task_wait(task, -1));
    etd_task_release(task);
    CHECK(are_same(whole, more));
    free(bytes.data);
    etd_film_release(whole);
    etd_film_release(film);
    etd_film_release(moved);
    etd_film_release(more);
    etd_scene_release(same);
    etd_device_release(elsewhere);
}

/* Files that renders write, and that are saved. */
static void pass_files(etd_device *device, etd_scene *scene) {
    static const char other[] = "checkpoint-other";
    etd_film *film, *read = NULL, *whole = new_film(device, WIDTH, HEIGHT, 0);
    etd_render_options options = short_render(32);
    etd_error error = ETD_ERROR_INIT;
    char name[64];
    struct bytes bytes;
    CHECK_OK(etd_render(scene, whole, &options));
    /* The text is read during the call alone. */
    strcpy(name, path);
    options.checkpoint_file = name;
    options.checkpoint_seconds = 1e-9;
    film = stopped(device, scene, options);
    bytes = saved(film);
    CHECK(file_has(path, bytes));
    CHECK_OK(etd_film_save(film, other));
    CHECK(file_has(other, bytes));
    free(bytes.data);
    CHECK_OK(etd_film_load(device, path, NULL, &read));
    options.resume = read;
    {
        etd_task *task = NULL;
        CHECK_OK(etd_render_start(scene, film, &options, &task));
        memset(name, '!', sizeof name - 1);
        CHECK_OK(etd_task_wait(task, -1));
        etd_task_release(task);
    }
    CHECK(are_same(whole, film));
    bytes = saved(film);
    CHECK(file_has(path, bytes));
    free(bytes.data);
    etd_film_release(read);
    /* An image of a film that was loaded has the pixels of the rendered one. */
    CHECK_OK(etd_film_load(device, path, NULL, &read));
    CHECK_OK(etd_film_write(film, "checkpoint.pfm", NULL));
    CHECK_OK(etd_film_write(read, "checkpoint-read.pfm", NULL));
    {
        static unsigned char image[PIXELS * 4];
        FILE *file = fopen("checkpoint.pfm", "rb");
        bytes.data = image;
        bytes.size = file == NULL ? 0 : fread(image, 1, sizeof image, file);
        CHECK(bytes.size > WIDTH * HEIGHT * 12 && file_has("checkpoint-read.pfm", bytes));
        if (file != NULL) {
            fclose(file);
        }
    }
    etd_film_release(read);
    read = NULL;
    /* A place that is lost: the picture is there, and the call says that the file is not. */
    options.resume = NULL;
    options.checkpoint_file = "checkpoint-folder/film";
    options.checkpoint_seconds = 0;
    CHECK(mkdir(folder, 0700) == 0);
    options.progress = lose_folder;
    CHECK_OK(etd_render(scene, film, NULL));
    CHECK(!have_same_pixels(whole, film));
    CHECK_STATUS(etd_render(scene, film, &options), ETD_IO);
    CHECK(message_has("checkpoint-folder") && message_has("the film holds what was rendered"));
    CHECK(are_same(whole, film));
    options.progress = NULL;
    /* Places where no file can be. */
    options.checkpoint_file = "no-such-folder/film";
    CHECK_STATUS(etd_render(scene, film, &options), ETD_IO);
    CHECK(message_has("no-such-folder"));
    options.checkpoint_file = "";
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_save(film, "no-such-folder/film"), ETD_IO);
    CHECK_STATUS(etd_film_save(film, ""), ETD_IO);
    CHECK_STATUS(etd_film_load(device, "no-such-file", NULL, &read), ETD_IO);
    CHECK_OK(etd_last_error(&error));
    CHECK(strcmp(error.file, "no-such-file") == 0);
    CHECK_STATUS(etd_film_load(device, "checkpoint.pfm", NULL, &read), ETD_INVALID_SCENE);
    CHECK_OK(etd_last_error(&error));
    CHECK(strcmp(error.file, "checkpoint.pfm") == 0 && message_has("no checkpoint"));
    CHECK(read == NULL);
    CHECK(are_same(whole, film));
    etd_film_release(film);
    etd_film_release(whole);
    remove(path);
    remove(other);
    remove("checkpoint.pfm");
    remove("checkpoint-read.pfm");
}

/* Emitted, direct and indirect light: a film of any of them keeps all three, through a file as well, and their sum is the colour. */
static void pass_light(etd_device *device, etd_scene *scene) {
    static const etd_layer kinds[] = {ETD_LAYER_EMISSION, ETD_LAYER_DIRECT, ETD_LAYER_INDIRECT};
    etd_film *film = new_film(device, WIDTH, HEIGHT, ETD_LAYER_DIRECT), *read = NULL;
    etd_film_options asked = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = short_render(4);
    static float color[PIXELS], again[WIDTH * HEIGHT * 3], parts[3][WIDTH * HEIGHT * 3];
    struct bytes bytes;
    size_t i, part;
    CHECK_OK(etd_render(scene, film, &options));
    bytes = saved(film);
    asked.layers = ETD_LAYER_EMISSION | ETD_LAYER_DIRECT | ETD_LAYER_INDIRECT;
    CHECK_OK(etd_film_load_memory(device, bytes.data, bytes.size, &asked, &read));
    CHECK_OK(etd_film_copy(read, ETD_LAYER_COLOR, NULL, color, sizeof color, 0));
    for (part = 0; part < 3; ++part) {
        float largest = 0;
        CHECK_OK(etd_film_copy(read, kinds[part], NULL, parts[part], sizeof parts[part], 0));
        for (i = 0; i < WIDTH * HEIGHT * 3; ++i)
            if (parts[part][i] > largest) largest = parts[part][i];
        CHECK(largest > 0 || kinds[part] == ETD_LAYER_EMISSION);
    }
    for (i = 0; i < WIDTH * HEIGHT * 3; ++i) {
        const float off = parts[0][i] + parts[1][i] + parts[2][i] - color[i / 3 * 4 + i % 3];
        CHECK(off < 1e-4f && off > -1e-4f);
    }
    CHECK_OK(etd_film_copy(film, ETD_LAYER_DIRECT, NULL, again, sizeof again, 0));
    CHECK(memcmp(again, parts[1], sizeof again) == 0);
    CHECK_STATUS(etd_film_copy(film, ETD_LAYER_INDIRECT, NULL, again, sizeof again, 0), ETD_INVALID_OPERATION);
    options.integrator = ETD_INTEGRATOR_SPPM;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(message_has("sppm does not count how often light was scattered"));
    etd_film_release(read);
    etd_film_release(film);
    free(bytes.data);
}

/* Layers that the films keep. */
static void pass_layers(etd_device *device, etd_scene *scene) {
    const uint32_t layers = ETD_LAYER_NORMAL | ETD_LAYER_ALPHA | ETD_LAYER_STANDARD_ERROR;
    etd_film *film = new_film(device, WIDTH, HEIGHT, layers), *plain = new_film(device, WIDTH, HEIGHT, 0), *read = NULL;
    etd_film_options asked = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = short_render(4);
    etd_map of_film = ETD_MAP_INIT, of_read = ETD_MAP_INIT;
    struct bytes bytes, small;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_render(scene, plain, &options));
    bytes = saved(film);
    small = saved(plain);
    CHECK(small.size < bytes.size);
    asked.layers = layers;
    CHECK_OK(etd_film_load_memory(device, bytes.data, bytes.size, &asked, &read));
    CHECK(are_same(film, read));
    CHECK_OK(etd_film_map(film, ETD_LAYER_NORMAL, &of_film));
    CHECK_OK(etd_film_map(read, ETD_LAYER_NORMAL, &of_read));
    CHECK(of_read.channels == 3 && of_read.samples == 4);
    CHECK(memcmp(of_film.data, of_read.data, WIDTH * HEIGHT * 3 * sizeof(float)) == 0);
    CHECK_OK(etd_film_unmap(film, &of_film));
    CHECK_OK(etd_film_unmap(read, &of_read));
    CHECK_STATUS(etd_film_map(read, ETD_LAYER_DEPTH, &of_read), ETD_INVALID_OPERATION);
    etd_film_release(read);
    read = NULL;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_UNSUPPORTED);
    CHECK(message_has("first hits"));
    asked.layers = ETD_LAYER_INDIRECT;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_UNSUPPORTED);
    CHECK(message_has("parts of the light"));
    asked.layers = ETD_LAYER_STANDARD_ERROR;
    asked.width = WIDTH;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_UNSUPPORTED);
    CHECK(message_has("40 x 24 pixels; the options expect 40 x 0"));
    asked.height = HEIGHT;
    CHECK_OK(etd_film_load_memory(device, small.data, small.size, &asked, &read));
    etd_film_release(read);
    read = NULL;
    asked.layers = 4096;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_INVALID_ARGUMENT);
    asked.layers = 0;
    asked.reserved = 1;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_INVALID_ARGUMENT);
    asked.reserved = 0;
    asked.struct_size = 3;
    CHECK_STATUS(etd_film_load_memory(device, small.data, small.size, &asked, &read), ETD_INVALID_ARGUMENT);
    CHECK(read == NULL);
    /* What keeps first hits goes on without being asked to, the other way round is refused. */
    options.resume = film;
    options.samples = 8;
    CHECK_OK(etd_render(scene, plain, &options));
    options.resume = read = loaded(device, small);
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(message_has("layers"));
    etd_film_release(read);
    etd_film_release(film);
    etd_film_release(plain);
    free(bytes.data);
    free(small.data);
}

/* A render of something else does not go on, and its film stays as it is. */
static void pass_other_renders(etd_device *device) {
    etd_scene *scene = new_scene(device);
    const double there[3] = {2, 3, 2}, elsewhere[3] = {2, 3, 2.5};
    const float intensity[3] = {4, 4, 4};
    etd_film *film, *copy, *large = new_film(device, WIDTH + 1, HEIGHT, 0), *held;
    etd_render_options options = short_render(64), other;
    struct bytes bytes;
    film = stopped(device, scene, options);
    bytes = saved(film);
    held = loaded(device, bytes);
    copy = loaded(device, bytes);
    options.resume = held;
    CHECK_OK(etd_scene_set_point_light(scene, 0, elsewhere, intensity));
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(message_has("another scene"));
    CHECK_OK(etd_scene_set_point_light(scene, 0, there, intensity));
    other = options;
    other.seed = 5;
    CHECK_STATUS(etd_render(scene, film, &other), ETD_UNSUPPORTED);
    CHECK(message_has("`seed` null, and this render has 5"));
    CHECK_STATUS(etd_render(scene, large, &options), ETD_UNSUPPORTED);
    CHECK(message_has("`resolution`"));
    other = options;
    other.share_number = other.share_count = 1;
    CHECK_STATUS(etd_render(scene, film, &other), ETD_UNSUPPORTED);
    CHECK(message_has("share 1/1"));
    other = options;
    other.adaptive = ETD_SWITCH_ON;
    CHECK_STATUS(etd_render(scene, film, &other), ETD_UNSUPPORTED);
    CHECK(message_has("adaptive"));
    CHECK(have_same_pixels(film, copy));
    CHECK_OK(etd_render(scene, copy, &options));
    options.resume = film;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK(are_same(film, copy));
    /* Without a fingerprint from the beginning, it is made of the scene that was rendered, as long as that is there. */
    options.resume = NULL;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_scene_set_point_light(scene, 0, elsewhere, intensity));
    CHECK_STATUS(etd_film_save(film, "checkpoint-none"), ETD_INVALID_OPERATION);
    CHECK(message_has("fingerprint"));
    options.resume = film;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_OPERATION);
    options.resume = NULL;
    options.checkpoint_file = "checkpoint-none";
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_scene_set_point_light(scene, 0, there, intensity));
    etd_scene_release(scene);
    CHECK_OK(etd_film_save(film, "checkpoint-none"));
    remove("checkpoint-none");
    free(bytes.data);
    etd_film_release(film);
    etd_film_release(copy);
    etd_film_release(held);
    etd_film_release(large);
}

/* Films of which there is no state, or that are in use. */
static void pass_states(etd_device *device, etd_scene *scene) {
    etd_film *film = new_film(device, WIDTH, HEIGHT, 0), *other = new_film(device, WIDTH, HEIGHT, 0), *out = NULL;
    etd_render_options options = short_render(1u << 30);
    etd_task *task = NULL;
    size_t size = 7;
    uint32_t number = 7, count = 7;
    CHECK_STATUS(etd_film_save(film, "checkpoint-none"), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_save_memory(film, NULL, 0, &size), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_merge(&film, 1, &out), ETD_INVALID_OPERATION);
    CHECK(message_has("films[0]: nothing was rendered"));
    CHECK_STATUS(etd_film_get_share(film, &number, &count), ETD_INVALID_OPERATION);
    options.resume = film;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_render(scene, other, &options), ETD_INVALID_OPERATION);
    options.resume = NULL;
    options.share_number = options.share_count = 1;
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    CHECK_STATUS(etd_film_save(film, "checkpoint-none"), ETD_INVALID_OPERATION);
    CHECK(message_has("being rendered to"));
    CHECK_STATUS(etd_film_save_memory(film, NULL, 0, &size), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_merge(&film, 1, &out), ETD_INVALID_OPERATION);
    options.resume = film;
    CHECK_STATUS(etd_render(scene, other, &options), ETD_INVALID_OPERATION);
    CHECK(size == 7 && number == 7 && count == 7 && out == NULL);
    CHECK_OK(etd_task_cancel(task));
    CHECK_STATUS(etd_task_wait(task, -1), ETD_CANCELLED);
    etd_task_release(task);
    etd_film_release(film);
    etd_film_release(other);
}

/* Options that are no part and no plan. */
static void pass_options(etd_device *device, etd_scene *scene) {
    static const uint32_t wrong[][2] = {{0, 1}, {1, 0}, {2, 1}, {UINT32_MAX, UINT32_MAX}, {1, (1u << 16) + 1}};
    static const double seconds[] = {-1, -1e-300, (double)NAN, (double)INFINITY};
    const etd_measuring_point point = {{0, 1, 2}, {0, 1, 0}};
    double lux = -7;
    etd_film *film = new_film(device, WIDTH, HEIGHT, 0);
    etd_render_options options;
    size_t i;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        options = short_render(1);
        options.share_number = wrong[i][0];
        options.share_count = wrong[i][1];
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(message_has("options.share"));
        CHECK_STATUS(etd_scene_measure(scene, ETD_QUANTITY_ILLUMINANCE, &point, 1, &options, &lux, NULL, NULL),
                     ETD_INVALID_ARGUMENT);
    }
    for (i = 0; i < sizeof seconds / sizeof seconds[0]; ++i) {
        options = short_render(1);
        options.checkpoint_seconds = seconds[i];
        CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
        CHECK(message_has("options.checkpoint_seconds"));
    }
    options = short_render(1);
    options.checkpoint_file = "\xff\xfe";
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_ARGUMENT);
    CHECK(message_has("options.checkpoint_file is not UTF-8"));
    options.checkpoint_file = "checkpoint-none";
    CHECK_STATUS(etd_scene_measure(scene, ETD_QUANTITY_ILLUMINANCE, &point, 1, &options, &lux, NULL, NULL),
                 ETD_INVALID_ARGUMENT);
    CHECK(message_has("options.checkpoint_file is for renders of pictures"));
    options = short_render(1);
    options.resume = film;
    CHECK_STATUS(etd_scene_measure(scene, ETD_QUANTITY_ILLUMINANCE, &point, 1, &options, &lux, NULL, NULL),
                 ETD_INVALID_ARGUMENT);
    CHECK(message_has("options.resume") && lux == -7);
    options.resume = (const etd_film *)(const void *)scene;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_HANDLE);
    CHECK(message_has("options.resume"));
    options = short_render(64);
    options.share_number = options.share_count = 1;
    options.target_error = 0.1;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    options.target_error = 0;
    options.adaptive = ETD_SWITCH_ON;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
    CHECK(message_has("adaptive sampling"));
    etd_film_release(film);
}

/* Parts that make no picture. */
static void pass_wrong_parts(etd_device *device, etd_scene *scene) {
    etd_film *parts[4], *out = NULL, *list[4];
    etd_render_options options = short_render(16);
    uint32_t k;
    for (k = 0; k < 4; ++k) {
        parts[k] = new_film(device, WIDTH, HEIGHT, 0);
        options.share_number = k < 3 ? k + 1 : 0;
        options.share_count = k < 3 ? SHARES : 0;
        CHECK_OK(etd_render(scene, parts[k], &options));
    }
    CHECK_STATUS(etd_film_merge(parts, 0, &out), ETD_INVALID_ARGUMENT);
    CHECK(message_has("count is 0"));
    CHECK_STATUS(etd_film_merge(NULL, 3, &out), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_merge(parts, 3, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_merge(parts, (size_t)-1, &out), ETD_INVALID_ARGUMENT);
    etd_film_status(parts[0], NULL, 0);
    CHECK_STATUS(etd_film_merge(parts, 2, &out), ETD_INVALID_ARGUMENT);
    CHECK(message_has("of 3 shares, these are missing: 3"));
    CHECK_STATUS(etd_film_status(parts[0], NULL, 0), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_merge(parts, 4, &out), ETD_INVALID_ARGUMENT);
    CHECK(message_has("all of the picture"));
    list[0] = list[1] = parts[0];
    list[2] = parts[2];
    CHECK_STATUS(etd_film_merge(list, 3, &out), ETD_INVALID_ARGUMENT);
    CHECK(message_has("share 1 is given twice"));
    list[1] = NULL;
    CHECK_STATUS(etd_film_merge(list, 3, &out), ETD_INVALID_ARGUMENT);
    CHECK(message_has("films[1]: the film is NULL"));
    list[1] = (etd_film *)(void *)scene;
    CHECK_STATUS(etd_film_merge(list, 3, &out), ETD_INVALID_HANDLE);
    CHECK(message_has("films[1]"));
    /* A part of a render with another seed, and one of another division. */
    options.seed = 1;
    options.share_number = 2;
    options.share_count = SHARES;
    CHECK_OK(etd_render(scene, parts[1], &options));
    CHECK_STATUS(etd_film_merge(parts, 3, &out), ETD_UNSUPPORTED);
    CHECK(message_has("`seed`"));
    options.seed = 0;
    options.share_count = 2;
    CHECK_OK(etd_render(scene, parts[1], &options));
    CHECK_STATUS(etd_film_merge(parts, 3, &out), ETD_INVALID_ARGUMENT);
    CHECK(out == NULL);
    /* After all that, the films can be rendered to, and merged. */
    options.share_count = SHARES;
    CHECK_OK(etd_render(scene, parts[1], &options));
    CHECK_OK(etd_film_merge(parts, 3, &out));
    CHECK(are_same(out, parts[3]));
    etd_film_release(out);
    for (k = 0; k < 4; ++k) {
        etd_film_release(parts[k]);
    }
}

static uint32_t crc32_of(const unsigned char *bytes, size_t size) {
    uint32_t sum = UINT32_MAX;
    size_t i;
    int bit;
    for (i = 0; i < size; ++i) {
        sum ^= bytes[i];
        for (bit = 0; bit < 8; ++bit) {
            sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
        }
    }
    return ~sum;
}

static void put_u32(unsigned char *bytes, uint32_t value) {
    int i;
    for (i = 0; i < 4; ++i) {
        bytes[i] = (unsigned char)(value >> 8 * i);
    }
}

/* The bytes with all occurrences of a text in the header replaced, with their checksum; the header alone. */
static struct bytes forged(struct bytes bytes, const char *old, const char *with) {
    struct bytes made;
    const unsigned char *text = bytes.data + 16;
    const size_t length = bytes.data[12] | (size_t)bytes.data[13] << 8;
    size_t at = 0;
    made.data = malloc(2 * bytes.size + 4096);
    if (made.data == NULL) {
        exit(2);
    }
    memcpy(made.data, bytes.data, 16);
    made.size = 16;
    while (at < length) {
        if (length - at >= strlen(old) && memcmp(text + at, old, strlen(old)) == 0) {
            memcpy(made.data + made.size, with, strlen(with));
            made.size += strlen(with);
            at += strlen(old);
        } else {
            made.data[made.size++] = text[at++];
        }
    }
    CHECK(made.size != 16 + length || memcmp(made.data, bytes.data, made.size) != 0);
    put_u32(made.data + 12, (uint32_t)(made.size - 16));
    put_u32(made.data + made.size, crc32_of(made.data, made.size));
    made.size += 4;
    return made;
}

/* Bytes that anybody may have sent. */
static void pass_damage(etd_device *device, etd_scene *scene) {
    etd_device_options limited = ETD_DEVICE_OPTIONS_INIT;
    etd_device *small = NULL;
    etd_film *film = new_film(device, 5, 3, 0), *read = NULL;
    etd_render_options options = short_render(2);
    struct bytes bytes, longer, forgery;
    uint64_t before = 0, after = 0;
    uint32_t random = 1;
    unsigned char *buffer;
    size_t i, size = 7;
    CHECK_OK(etd_render(scene, film, &options));
    bytes = saved(film);
    CHECK_OK(etd_device_memory(device, &before, NULL));
    /* Any bit of any byte, and any length. */
    for (i = 0; i < bytes.size; ++i) {
        const unsigned char flipped = (unsigned char)(1u << next_random(&random) % 8);
        etd_status status;
        bytes.data[i] ^= flipped;
        status = etd_film_load_memory(device, bytes.data, bytes.size, NULL, &read);
        check_that(status == ETD_INVALID_SCENE || status == ETD_UNSUPPORTED, __FILE__, __LINE__, "a changed byte");
        bytes.data[i] ^= flipped;
        CHECK_STATUS(etd_film_load_memory(device, bytes.data, i, NULL, &read), ETD_INVALID_SCENE);
    }
    longer.size = bytes.size + 1;
    longer.data = calloc(1, longer.size);
    if (longer.data == NULL) {
        exit(2);
    }
    memcpy(longer.data, bytes.data, bytes.size);
    CHECK_STATUS(etd_film_load_memory(device, longer.data, longer.size, NULL, &read), ETD_INVALID_SCENE);
    CHECK(message_has("something follows its end"));
    for (i = 0; i < longer.size; ++i) {
        longer.data[i] = (unsigned char)next_random(&random);
    }
    CHECK_STATUS(etd_film_load_memory(device, longer.data, longer.size, NULL, &read), ETD_INVALID_SCENE);
    /* Headers with right checksums, of films that are not there. */
    CHECK_OK((limited.memory_limit = 1u << 24, etd_device_new(&limited, &small)));
    forgery = forged(bytes, "[5,3]", "[8192,8192]");
    CHECK_STATUS(etd_film_load_memory(small, forgery.data, forgery.size, NULL, &read), ETD_OUT_OF_MEMORY);
    free(forgery.data);
    forgery = forged(bytes, "[5,3]", "[4294967295,4294967295]");
    CHECK_STATUS(etd_film_load_memory(device, forgery.data, forgery.size, NULL, &read), ETD_INVALID_SCENE);
    free(forgery.data);
    forgery = forged(bytes, "[5,3]", "[0,0]");
    CHECK_STATUS(etd_film_load_memory(device, forgery.data, forgery.size, NULL, &read), ETD_INVALID_SCENE);
    free(forgery.data);
    forgery = forged(bytes, "[5,3]", "[50,30]");
    CHECK_STATUS(etd_film_load_memory(small, forgery.data, forgery.size, NULL, &read), ETD_INVALID_SCENE);
    CHECK(message_has("it ends early"));
    free(forgery.data);
    CHECK(read == NULL);
    CHECK_OK(etd_device_memory(device, &after, NULL));
    CHECK(before == after);
    CHECK_OK(etd_device_memory(small, &after, NULL));
    CHECK(after == 0);
    /* Right bytes and wrong arguments. */
    CHECK_STATUS(etd_film_load_memory(device, bytes.data, 0, NULL, &read), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_film_load_memory(device, bytes.data, (size_t)-1, NULL, &read), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_load_memory(device, NULL, bytes.size, NULL, &read), ETD_INVALID_ARGUMENT);
    buffer = malloc(bytes.size);
    if (buffer == NULL) {
        exit(2);
    }
    memset(buffer, 0xa5, bytes.size);
    CHECK_STATUS(etd_film_save_memory(film, buffer, bytes.size - 1, &size), ETD_INVALID_ARGUMENT);
    CHECK(message_has("capacity is"));
    CHECK_STATUS(etd_film_save_memory(film, buffer, 0, &size), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_save_memory(film, NULL, bytes.size, NULL), ETD_INVALID_ARGUMENT);
    for (i = 0; i < bytes.size && buffer[i] == 0xa5; ++i) {
    }
    CHECK(i == bytes.size && size == 7);
    CHECK_OK(etd_film_save_memory(film, buffer, bytes.size, NULL));
    CHECK(memcmp(buffer, bytes.data, bytes.size) == 0);
    free(buffer);
    free(longer.data);
    free(bytes.data);
    etd_film_release(film);
    etd_device_release(small);
}

int main(void) {
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    pass_shares(device, scene);
    pass_interruptions(device, scene, ETD_INTEGRATOR_PATH);
    pass_interruptions(device, scene, ETD_INTEGRATOR_SPPM);
    pass_files(device, scene);
    pass_light(device, scene);
    pass_layers(device, scene);
    pass_other_renders(device);
    pass_states(device, scene);
    pass_options(device, scene);
    pass_wrong_parts(device, scene);
    pass_damage(device, scene);
    etd_scene_release(scene);
    etd_device_release(device);
    return check_report("checkpoint");
}
