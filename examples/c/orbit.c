/* A scene that changes: the camera goes round, a ball moves and changes colour; every frame is rendered anew.
 *
 * Only what has changed is built again, so that the first image of a frame is there at once. For each frame it prints
 * the time to the first pass (one sample for each pixel) and to the end.
 *
 * Build:  cc -std=c99 orbit.c $(pkg-config --cflags --libs etendue) -lm -o orbit
 * Run:    ./orbit [FRAMES [WIDTH [HEIGHT [SAMPLES]]]]; writes orbit-000.png and so on */
#include <math.h>

#include "common.h"

/* Notes when the first pass is complete. */
static int32_t watch(void *user_data, const etd_progress *progress) {
    double *first_pass = user_data;
    if (progress->samples_done > 0 && *first_pass < 0) {
        *first_pass = progress->elapsed;
    }
    return 0;
}

int main(int count, char **arguments) {
    const uint32_t frames = number_argument(count, arguments, 1, 8);
    const uint32_t width = number_argument(count, arguments, 2, 320);
    const uint32_t height = number_argument(count, arguments, 3, 240);
    const double turn = 6.283185307179586;
    etd_device *device = NULL;
    etd_scene *scene;
    etd_film *film;
    uint32_t red, ball, frame;
    must(etd_device_new(NULL, &device));
    scene = two_balls(device, &red, &ball);
    film = new_film(device, width, height);
    for (frame = 0; frame < frames; ++frame) {
        const double part = (double)frame / frames;
        const double angle = turn * part;
        double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        etd_material material = ETD_MATERIAL_INIT;
        etd_render_options options = ETD_RENDER_OPTIONS_INIT;
        etd_summary summary = ETD_SUMMARY_INIT;
        double first_pass = -1;
        char path[32];
        look_from(scene, 7 * sin(angle), 3, 7 * cos(angle));
        transform[7] = 0.8 * fabs(sin(2 * angle)); /* it hops */
        must(etd_scene_set_transform(scene, ball, transform));
        must(etd_scene_get_material(scene, red, &material));
        material.color[1] = (float)part;
        must(etd_scene_set_material(scene, red, &material));

        options.samples = number_argument(count, arguments, 4, 16);
        options.progress = watch;
        options.user_data = &first_pass;
        must(etd_render(scene, film, &options));
        must(etd_film_get_summary(film, &summary));
        printf("frame %u: built in %.2f ms, first pass after %.1f ms, done after %.1f ms\n", frame,
               1e3 * summary.build_time, 1e3 * first_pass, 1e3 * (summary.build_time + summary.elapsed));
        snprintf(path, sizeof path, "orbit-%03u.png", frame);
        must(etd_film_write(film, path, NULL));
    }
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    return 0;
}
