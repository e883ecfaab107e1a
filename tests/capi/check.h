/* What the C tests share: checks that say where and why, and a scene to break. */
#ifndef ETENDUE_TESTS_CHECK_H
#define ETENDUE_TESTS_CHECK_H

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <etendue.h>

/* Checks made and failed so far; several threads count. */
struct check_counts {
    pthread_mutex_t lock;
    unsigned long made;
    unsigned long failed;
};
extern struct check_counts check_counts;

/* Defines the counters: once in each program. */
#define CHECK_MAIN struct check_counts check_counts = {PTHREAD_MUTEX_INITIALIZER, 0, 0}

static inline int check_that(int holds, const char *file, int line, const char *what) {
    pthread_mutex_lock(&check_counts.lock);
    check_counts.made++;
    if (!holds) {
        check_counts.failed++;
        fprintf(stderr, "%s:%d: %s (last error: %s)\n", file, line, what, etd_last_error_message());
    }
    pthread_mutex_unlock(&check_counts.lock);
    return holds;
}

static inline int check_status(etd_status got, etd_status wanted, const char *file, int line, const char *what) {
    if (got != wanted) {
        char text[512];
        snprintf(text, sizeof text, "%s: %s, expected %s", what, etd_status_name(got), etd_status_name(wanted));
        return check_that(0, file, line, text);
    }
    return check_that(1, file, line, what);
}

#define CHECK(condition) check_that((condition) ? 1 : 0, __FILE__, __LINE__, #condition)
#define CHECK_STATUS(call, wanted) check_status((call), (wanted), __FILE__, __LINE__, #call)
#define CHECK_OK(call) CHECK_STATUS(call, ETD_OK)

/* Ends the program: says how many checks there were. */
static inline int check_report(const char *program) {
    printf("%s: %lu checks, %lu failed\n", program, check_counts.made, check_counts.failed);
    return check_counts.failed == 0 && check_counts.made > 0 ? 0 : 1;
}

static inline void sleep_ms(double milliseconds) {
    struct timespec time;
    time.tv_sec = (time_t)(milliseconds / 1e3);
    time.tv_nsec = (long)((milliseconds - 1e3 * (double)time.tv_sec) * 1e6);
    nanosleep(&time, NULL);
}

/* Numbers that look random and are the same in every run. */
static inline uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static inline etd_device *new_device(uint32_t threads) {
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_device *device = NULL;
    options.threads = threads;
    CHECK_OK(etd_device_new(&options, &device));
    return device;
}

static inline etd_film *new_film(etd_device *device, uint32_t width, uint32_t height, uint32_t layers) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film *film = NULL;
    options.width = width;
    options.height = height;
    options.layers = layers;
    CHECK_OK(etd_film_new(device, &options, &film));
    return film;
}

/* A floor (surface 0, material 0), a sphere (1, material 1), a lamp (2) and a point light (0). */
static inline etd_scene *new_scene(etd_device *device) {
    static const double floor_quad[12] = {-3, 0, -3, -3, 0, 3, 3, 0, 3, 3, 0, -3};
    static const double lamp_quad[12] = {-1, 4, -1, 1, 4, -1, 1, 4, 1, -1, 4, 1};
    static const double centre[3] = {0, 1, 0};
    static const double light[3] = {2, 3, 2};
    static const float intensity[3] = {4, 4, 4};
    etd_camera camera = ETD_CAMERA_INIT;
    etd_material white = ETD_MATERIAL_INIT;
    etd_material mirror = ETD_MATERIAL_INIT;
    etd_surface on_floor = ETD_SURFACE_INIT;
    etd_surface on_sphere = ETD_SURFACE_INIT;
    etd_surface lamp = ETD_SURFACE_INIT;
    etd_scene *scene = NULL;
    uint32_t number = 0;
    CHECK_OK(etd_scene_new(device, NULL, &scene));
    camera.origin[1] = 1.5;
    camera.origin[2] = 5;
    camera.look_at[1] = 1;
    CHECK_OK(etd_scene_set_camera(scene, &camera));
    mirror.bsdf = ETD_BSDF_MIRROR;
    CHECK_OK(etd_scene_add_material(scene, "white", &white, &number));
    CHECK_OK(etd_scene_add_material(scene, "mirror", &mirror, &number));
    on_floor.material = 0;
    on_sphere.material = 1;
    lamp.emission[0] = lamp.emission[1] = lamp.emission[2] = 3;
    CHECK_OK(etd_scene_add_quad(scene, floor_quad, &on_floor, &number));
    CHECK_OK(etd_scene_add_sphere(scene, centre, 1, &on_sphere, &number));
    CHECK_OK(etd_scene_add_quad(scene, lamp_quad, &lamp, &number));
    CHECK_OK(etd_scene_add_point_light(scene, light, intensity, &number));
    return scene;
}

/* A flat grid of 2 n^2 triangles as mesh `*out_mesh`, used once. */
static inline void add_grid(etd_scene *scene, uint32_t n, uint32_t *out_mesh) {
    const size_t vertices = (size_t)(n + 1) * (n + 1);
    const size_t triangles = 2 * (size_t)n * n;
    float *positions = malloc(vertices * 3 * sizeof *positions);
    uint32_t *indices = malloc(triangles * 3 * sizeof *indices);
    etd_mesh mesh = ETD_MESH_INIT;
    etd_surface surface = ETD_SURFACE_INIT;
    uint32_t number = 0;
    uint32_t x, y;
    if (positions == NULL || indices == NULL) {
        fprintf(stderr, "no memory\n");
        exit(2);
    }
    for (y = 0; y <= n; ++y) {
        for (x = 0; x <= n; ++x) {
            float *p = positions + 3 * ((size_t)y * (n + 1) + x);
            p[0] = 4.0f * (float)x / (float)n - 2.0f;
            p[1] = 0.5f + 0.1f * (float)((x * 7 + y * 13) % 5);
            p[2] = 4.0f * (float)y / (float)n - 2.0f;
        }
    }
    for (y = 0; y < n; ++y) {
        for (x = 0; x < n; ++x) {
            uint32_t *t = indices + 6 * ((size_t)y * n + x);
            const uint32_t corner = y * (n + 1) + x;
            t[0] = corner;
            t[1] = corner + n + 1;
            t[2] = corner + 1;
            t[3] = corner + 1;
            t[4] = corner + n + 1;
            t[5] = corner + n + 2;
        }
    }
    mesh.positions = positions;
    mesh.vertex_count = vertices;
    mesh.indices = indices;
    mesh.triangle_count = triangles;
    CHECK_OK(etd_scene_add_mesh(scene, &mesh, out_mesh));
    surface.material = 0;
    CHECK_OK(etd_scene_add_mesh_surface(scene, *out_mesh, 0, &surface, &number));
    free(positions);
    free(indices);
}

/* Options of a short render. */
static inline etd_render_options short_render(uint32_t samples) {
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    options.samples = samples;
    options.max_depth = 4;
    return options;
}

#endif
