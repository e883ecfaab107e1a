/* Renders a scene file as the command-line program does, so that a script can compare the files byte by byte.
 *
 * Usage: same_bytes SCENE SAMPLES COMMENTS IMAGE...
 * COMMENTS goes to the comments of an EXR. IMAGE may be a saved film, which ends in ".film". */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

CHECK_MAIN;

int main(int count, char **arguments) {
    etd_device *device = NULL;
    etd_scene *scene = NULL;
    etd_film *film = NULL;
    etd_film_options film_options = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_image_options image = ETD_IMAGE_OPTIONS_INIT;
    int i;
    if (count < 5) {
        fprintf(stderr, "usage: same_bytes SCENE SAMPLES COMMENTS IMAGE...\n");
        return 2;
    }
    film_options.layers = ETD_LAYER_ALBEDO | ETD_LAYER_NORMAL | ETD_LAYER_DEPTH;
    image.comments = arguments[3];
    CHECK_OK(etd_device_new(NULL, &device));
    if (!CHECK_OK(etd_scene_from_file(device, arguments[1], NULL, &scene))) {
        return 1;
    }
    CHECK_OK(etd_scene_get_resolution(scene, &film_options.width, &film_options.height));
    CHECK_OK(etd_scene_get_render_options(scene, &options));
    options.samples = (uint32_t)atoi(arguments[2]);
    CHECK_OK(etd_film_new(device, &film_options, &film));
    CHECK_OK(etd_render(scene, film, &options));
    for (i = 4; i < count; ++i) {
        const char *dot = strrchr(arguments[i], '.');
        if (dot != NULL && strcmp(dot, ".film") == 0) {
            CHECK_OK(etd_film_save(film, arguments[i]));
        } else {
            CHECK_OK(etd_film_write(film, arguments[i], &image));
        }
    }
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    return check_report("same_bytes");
}
