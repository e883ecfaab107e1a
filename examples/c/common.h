/* What the examples share: ending the program where a call fails. A library would pass the status on instead. */
#ifndef ETENDUE_EXAMPLES_COMMON_H
#define ETENDUE_EXAMPLES_COMMON_H

#include <stdio.h>
#include <stdlib.h>

#include <etendue.h>

static inline void must(etd_status status) {
    if (status != ETD_OK) {
        fprintf(stderr, "%s: %s\n", etd_status_name(status), etd_last_error_message());
        exit(1);
    }
}

/* The number that is argument `index` of the program, or what it is without one. */
static inline uint32_t number_argument(int count, char **arguments, int index, uint32_t otherwise) {
    return count > index ? (uint32_t)strtoul(arguments[index], NULL, 10) : otherwise;
}

static inline etd_film *new_film(etd_device *device, uint32_t width, uint32_t height) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film *film = NULL;
    options.width = width;
    options.height = height;
    must(etd_film_new(device, &options, &film));
    return film;
}

static inline uint32_t add_matt(etd_scene *scene, const char *name, float red, float green, float blue) {
    etd_material material = ETD_MATERIAL_INIT;
    uint32_t number = 0;
    material.color[0] = red;
    material.color[1] = green;
    material.color[2] = blue;
    must(etd_scene_add_material(scene, name, &material, &number));
    return number;
}

/* A floor, a ball that is glass, a ball that is red, and a lamp: the scene of several examples. `*ball`: the red one. */
static inline etd_scene *two_balls(etd_device *device, uint32_t *red, uint32_t *ball) {
    static const double floor_quad[12] = {-6, 0, -6, -6, 0, 6, 6, 0, 6, 6, 0, -6};
    static const double lamp_quad[12] = {-1, 5, -1, 1, 5, -1, 1, 5, 1, -1, 5, 1};
    static const double centres[2][3] = {{-1.1, 1, 0}, {1.1, 1, 0}};
    etd_scene *scene = NULL;
    etd_surface surface = ETD_SURFACE_INIT;
    etd_material glass = ETD_MATERIAL_INIT;
    uint32_t number = 0;
    must(etd_scene_new(device, NULL, &scene));
    surface.material = add_matt(scene, "floor", 0.7f, 0.7f, 0.7f);
    must(etd_scene_add_quad(scene, floor_quad, &surface, &number));
    *red = surface.material = add_matt(scene, "red", 0.8f, 0.1f, 0.1f);
    must(etd_scene_add_sphere(scene, centres[1], 1, &surface, ball));
    glass.bsdf = ETD_BSDF_DIELECTRIC;
    glass.ior = 1.5f;
    must(etd_scene_add_material(scene, "glass", &glass, &surface.material));
    must(etd_scene_add_sphere(scene, centres[0], 1, &surface, &number));
    surface.material = ETD_NONE;
    surface.emission[0] = surface.emission[1] = surface.emission[2] = 12;
    must(etd_scene_add_quad(scene, lamp_quad, &surface, &number));
    return scene;
}

/* The camera at this place, looking at the balls. */
static inline void look_from(etd_scene *scene, double x, double y, double z) {
    etd_camera camera = ETD_CAMERA_INIT;
    camera.origin[0] = x;
    camera.origin[1] = y;
    camera.origin[2] = z;
    camera.look_at[1] = 1;
    camera.look_at[2] = 0;
    camera.fov_deg = 50;
    must(etd_scene_set_camera(scene, &camera));
}

#endif
