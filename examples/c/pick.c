/* Rays that the host asks for: what lies under a pixel, and what many rays meet.
 *
 * Build:  cc -std=c99 pick.c $(pkg-config --cflags --libs etendue) -lm -o pick
 * Run:    ./pick [SCENE [RAYS_IN_A_ROW]] */
#include <math.h>

#include "common.h"

static void print_hit(const etd_hit *hit) {
    if (hit->surface == ETD_NONE) {
        printf("nothing\n");
    } else {
        printf("surface %u, triangle %u, at distance %.3f, normal %.2f %.2f %.2f\n", hit->surface, hit->primitive,
               (double)hit->t, (double)hit->ng[0], (double)hit->ng[1], (double)hit->ng[2]);
    }
}

int main(int count, char **arguments) {
    const uint32_t row = number_argument(count, arguments, 2, 40);
    const uint32_t rays_count = row * (row / 2);
    etd_device *device = NULL;
    etd_scene *scene = NULL;
    etd_camera camera = ETD_CAMERA_INIT;
    etd_ray one = {{0, 0, 0}, 0, {0, 0, 0}, 0};
    etd_hit hit;
    etd_ray *rays = malloc((rays_count + 1) * sizeof *rays);
    etd_hit *hits = malloc((rays_count + 1) * sizeof *hits);
    uint8_t *occluded = malloc(rays_count + 1);
    uint32_t i, x, y, red, ball, met = 0, hidden = 0;
    if (rays == NULL || hits == NULL || occluded == NULL) {
        fprintf(stderr, "no memory\n");
        return 1;
    }
    must(etd_device_new(NULL, &device));
    if (count > 1) {
        must(etd_scene_from_file(device, arguments[1], NULL, &scene));
    } else {
        scene = two_balls(device, &red, &ball);
        look_from(scene, 0, 2, 6);
    }
    must(etd_scene_commit(scene, NULL, NULL)); /* rays are asked of what was built */

    /* One ray, through the middle of the image. */
    must(etd_scene_get_camera(scene, &camera));
    for (i = 0; i < 3; ++i) {
        one.origin[i] = (float)camera.origin[i];
        one.direction[i] = (float)(camera.look_at[i] - camera.origin[i]);
    }
    one.tfar = INFINITY;
    must(etd_scene_intersect(scene, &one, 1, &hit));
    printf("in the middle: ");
    print_hit(&hit);

    /* Many rays, from above straight down: a map of heights. The scene is 12 wide. */
    for (y = 0, i = 0; y < row / 2; ++y) {
        for (x = 0; x < row; ++x, ++i) {
            etd_ray ray = {{0, 4, 0}, 0, {0, -1, 0}, 100};
            ray.origin[0] = 8.0f * ((float)x + 0.5f) / (float)row - 4;
            ray.origin[2] = 8.0f * ((float)y + 0.5f) / (float)(row / 2) - 4;
            rays[i] = ray;
        }
    }
    must(etd_scene_intersect(scene, rays, rays_count, hits));
    for (i = 0; i < rays_count; ++i) {
        const char shades[] = " .:-=+*#%@";
        const int shade = hits[i].surface == ETD_NONE ? 0 : (int)(9 - 9 * hits[i].t / 16);
        met += hits[i].surface != ETD_NONE;
        putchar(shades[shade < 0 ? 0 : shade]);
        if ((i + 1) % row == 0) {
            putchar('\n');
        }
    }
    /* Whether anything is within half the height: cheaper than asking what. */
    for (i = 0; i < rays_count; ++i) {
        rays[i].tfar = 3;
    }
    must(etd_scene_occluded(scene, rays, rays_count, occluded));
    for (i = 0; i < rays_count; ++i) {
        hidden += occluded[i];
    }
    printf("%u of %u rays met something, %u of them within 3 units\n", met, rays_count, hidden);
    free(rays);
    free(hits);
    free(occluded);
    etd_scene_release(scene);
    etd_device_release(device);
    return 0;
}
