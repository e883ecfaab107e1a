/* The smallest render: a scene file in, an image out.
 *
 * Build:  cc -std=c99 minimal.c $(pkg-config --cflags --libs etendue) -o minimal
 * Run:    ./minimal scenes/room.json room.png [SAMPLES] */
#include <etendue.h>
#include <stdio.h>
#include <stdlib.h>

int main(int count, char **arguments) {
    etd_device *device = NULL;
    etd_scene *scene = NULL;
    etd_film *film = NULL;
    etd_film_options size = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_status status;
    if (count < 3) {
        fprintf(stderr, "usage: minimal SCENE IMAGE [SAMPLES]\n");
        return 2;
    }
    if ((status = etd_device_new(NULL, &device)) == ETD_OK &&
        (status = etd_scene_from_file(device, arguments[1], NULL, &scene)) == ETD_OK &&
        (status = etd_scene_get_resolution(scene, &size.width, &size.height)) == ETD_OK &&
        (status = etd_scene_get_render_options(scene, &options)) == ETD_OK &&
        (status = etd_film_new(device, &size, &film)) == ETD_OK) {
        options.samples = count > 3 ? (uint32_t)atoi(arguments[3]) : options.samples;
        status = etd_render(scene, film, &options);
    }
    if (status == ETD_OK) status = etd_film_write(film, arguments[2], NULL);
    if (status != ETD_OK) fprintf(stderr, "%s\n", etd_last_error_message());
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    return status == ETD_OK ? 0 : 1;
}
