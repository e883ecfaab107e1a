/* Describes a scene by calls, renders it with progress, cancels, reads pixels: with Étendue. */
#define _POSIX_C_SOURCE 199309L
#include <etendue.h>

#include "scene.h"

static void check(etd_status status) {
    if (status == ETD_OK) return;
    fprintf(stderr, "%s\n", etd_last_error_message());
    exit(1);
}

int main(void) {
    double start = now();
    etd_device *device;
    etd_scene *scene;
    etd_film *film;
    uint32_t grey, number, mesh;
    check(etd_device_new(NULL, &device));
    check(etd_scene_new(device, NULL, &scene));

    etd_material material = ETD_MATERIAL_INIT;
    check(etd_scene_add_material(scene, "grey", &material, &grey));
    etd_mesh arrays = ETD_MESH_INIT;
    arrays.positions = positions;
    arrays.vertex_count = sizeof positions / sizeof *positions;
    arrays.indices = triangles[0];
    arrays.triangle_count = sizeof triangles / sizeof *triangles;
    check(etd_scene_add_mesh(scene, &arrays, &mesh));
    etd_surface surface = ETD_SURFACE_INIT;
    surface.material = grey;
    check(etd_scene_add_mesh_surface(scene, mesh, 0, &surface, &number));
    double centre[3] = {ball[0], ball[1], ball[2]};
    check(etd_scene_add_sphere(scene, centre, ball[3], &surface, &number));
    etd_surface light = ETD_SURFACE_INIT;
    light.emission[0] = light.emission[1] = light.emission[2] = 10;
    double corners[12];
    for (int i = 0; i < 12; ++i) corners[i] = lamp[i / 3][i % 3];
    check(etd_scene_add_quad(scene, corners, &light, &number));
    etd_camera camera = ETD_CAMERA_INIT;
    camera.origin[2] = 3.2;
    camera.fov_deg = 40;
    check(etd_scene_set_camera(scene, &camera));

    etd_film_options film_options = ETD_FILM_OPTIONS_INIT;
    film_options.width = WIDTH;
    film_options.height = HEIGHT;
    check(etd_film_new(device, &film_options, &film));

    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    options.samples = SAMPLES;
    etd_task *task;
    check(etd_render_start(scene, film, &options, &task));
    etd_progress progress = ETD_PROGRESS_INIT;
    double first = 0;
    while (etd_task_poll(task, &progress) == ETD_RUNNING) {
        if (first == 0 && progress.images > 0) first = now() - start;
        nap(0.001);
    }
    check(etd_task_wait(task, -1));
    etd_task_release(task);
    printf("etendue: first frame after %.1f ms, %d samples after %.1f ms\n", 1e3 * (first > 0 ? first : now() - start),
           SAMPLES, 1e3 * (now() - start));
    etd_map map = ETD_MAP_INIT;
    check(etd_film_map(film, ETD_LAYER_COLOR, &map));
    printf("etendue: mean %.4f\n", mean(map.data, (size_t)map.width * map.height, map.channels));
    check(etd_film_unmap(film, &map));

    static double latencies[TRIES];
    options.samples = 1 << 20;
    for (int i = 0; i < TRIES; ++i) {
        check(etd_render_start(scene, film, &options, &task));
        nap(0.001 * (i % 50));
        double cancelled = now();
        check(etd_task_cancel(task));
        etd_task_wait(task, -1);
        latencies[i] = now() - cancelled;
        etd_task_release(task);
    }
    report("etendue", latencies);

    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    return 0;
}
