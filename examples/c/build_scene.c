/* A scene made by calls from the host's arrays: one mesh copied, one read in place; a progress bar; a time budget.
 *
 * The wavy ground is an array of vertices with other things between the positions, as programs have them; the library
 * reads it where it is (ETD_SHARE), and says when it is done with it. The render ends when its samples are taken or the
 * time is up: then the progress function cancels, and the image holds what was done.
 *
 * Build:  cc -std=c99 build_scene.c $(pkg-config --cflags --libs etendue) -lm -o build_scene
 * Run:    ./build_scene [IMAGE [WIDTH [HEIGHT [SAMPLES [SECONDS]]]]] */
#include <math.h>

#include "common.h"

/* A vertex of the host: the library is told the distance from one to the next. */
struct vertex {
    float position[3];
    float normal[3];
    float temperature; /* of no concern to a renderer */
};

struct ground {
    struct vertex *vertices;
    uint32_t *indices;
    int released;
};

static void ground_released(void *user_data) {
    struct ground *ground = user_data;
    free(ground->vertices);
    free(ground->indices);
    ground->released = 1;
}

static struct ground make_ground(uint32_t n, etd_mesh *mesh) {
    struct ground ground;
    uint32_t x, y, i;
    /* The library may read 16 bytes from the last position on: the normal behind it is there for that already. */
    ground.vertices = malloc((size_t)(n + 1) * (n + 1) * sizeof *ground.vertices);
    ground.indices = malloc((size_t)n * n * 6 * sizeof *ground.indices);
    ground.released = 0;
    if (ground.vertices == NULL || ground.indices == NULL) {
        fprintf(stderr, "no memory\n");
        exit(1);
    }
    for (y = 0; y <= n; ++y) {
        for (x = 0; x <= n; ++x) {
            struct vertex *v = ground.vertices + (size_t)y * (n + 1) + x;
            const float u = 12.0f * (float)x / (float)n - 6, w = 12.0f * (float)y / (float)n - 6;
            v->position[0] = u;
            v->position[1] = 0.2f * sinf(2 * u) * cosf(2 * w);
            v->position[2] = w;
            v->normal[0] = -0.4f * cosf(2 * u) * cosf(2 * w);
            v->normal[1] = 1;
            v->normal[2] = 0.4f * sinf(2 * u) * sinf(2 * w);
            v->temperature = 20;
        }
    }
    for (y = 0, i = 0; y < n; ++y) {
        for (x = 0; x < n; ++x, i += 6) {
            const uint32_t corner = y * (n + 1) + x;
            const uint32_t two[6] = {corner, corner + n + 1, corner + 1, corner + 1, corner + n + 1, corner + n + 2};
            uint32_t k;
            for (k = 0; k < 6; ++k) {
                ground.indices[i + k] = two[k];
            }
        }
    }
    *mesh = (etd_mesh)ETD_MESH_INIT;
    mesh->positions = ground.vertices[0].position;
    mesh->position_stride = sizeof *ground.vertices;
    mesh->vertex_count = (size_t)(n + 1) * (n + 1);
    mesh->normals = ground.vertices[0].normal;
    mesh->normal_stride = sizeof *ground.vertices;
    mesh->indices = ground.indices;
    mesh->triangle_count = (size_t)n * n * 2;
    mesh->name = "ground";
    return ground;
}

/* A bar on standard error; cancels when the time is up. */
static int32_t show(void *user_data, const etd_progress *progress) {
    const double seconds = *(const double *)user_data;
    const int done = (int)(40 * progress->fraction);
    fprintf(stderr, "\r[%.*s%*s] %3.0f %%, %u samples", done, "########################################", 40 - done, "",
            100 * progress->fraction, progress->samples_done);
    return progress->elapsed > seconds;
}

int main(int count, char **arguments) {
    const char *image = count > 1 ? arguments[1] : "build_scene.png";
    const uint32_t width = number_argument(count, arguments, 2, 480);
    const uint32_t height = number_argument(count, arguments, 3, 320);
    double seconds = count > 5 ? atof(arguments[5]) : 20;
    /* A copied mesh: the arrays may go as soon as the call returns. */
    const float pyramid[15] = {-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1, 0, 1.6f, 0};
    const uint32_t faces[12] = {1, 0, 4, 2, 1, 4, 3, 2, 4, 0, 3, 4};
    const double places[3][12] = {{1, 0, 0, -2, 0, 1, 0, -0.3, 0, 0, 1, 0},
                                  {0.7, 0, 0.7, 2, 0, 1.5, 0, -0.3, -0.7, 0, 0.7, 0},
                                  {0.5, 0, 0, 0, 0, 0.5, 0, -0.3, 0, 0, 0.5, 2}};
    const double light[3] = {4, 6, 5};
    const float intensity[3] = {300, 280, 250};
    etd_device *device = NULL;
    etd_scene *scene = NULL;
    etd_film *film;
    etd_mesh mesh;
    struct ground ground;
    etd_surface surface = ETD_SURFACE_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    etd_status status;
    uint32_t number, sand, red, i;
    must(etd_device_new(NULL, &device));
    must(etd_scene_new(device, NULL, &scene));
    look_from(scene, 3, 4, 7);
    sand = add_matt(scene, "sand", 0.7f, 0.6f, 0.4f);
    red = add_matt(scene, "red", 0.7f, 0.15f, 0.1f);

    ground = make_ground(64, &mesh);
    mesh.sharing = ETD_SHARE;
    mesh.release = ground_released;
    mesh.user_data = &ground;
    mesh.position_bytes = mesh.vertex_count * sizeof(struct vertex);
    status = etd_scene_add_mesh(scene, &mesh, &number);
    if (status != ETD_OK) {
        ground_released(&ground); /* not taken: still ours */
    }
    must(status);
    surface.material = sand;
    must(etd_scene_add_mesh_surface(scene, number, 1, &surface, &i));

    /* One pyramid, used three times. */
    mesh = (etd_mesh)ETD_MESH_INIT;
    mesh.positions = pyramid;
    mesh.vertex_count = 5;
    mesh.indices = faces;
    mesh.triangle_count = 4;
    must(etd_scene_add_mesh(scene, &mesh, &number));
    surface.material = red;
    for (i = 0; i < 3; ++i) {
        uint32_t unused, k;
        for (k = 0; k < 12; ++k) {
            surface.transform[k] = places[i][k];
        }
        must(etd_scene_add_mesh_surface(scene, number, 0, &surface, &unused));
    }
    must(etd_scene_add_point_light(scene, light, intensity, &number));

    film = new_film(device, width, height);
    options.samples = number_argument(count, arguments, 4, 64);
    options.progress = show;
    options.user_data = &seconds;
    status = etd_render(scene, film, &options);
    fprintf(stderr, "\n");
    if (status == ETD_CANCELLED) {
        fprintf(stderr, "the time is up\n");
    } else {
        must(status);
    }
    must(etd_scene_get_info(scene, &info));
    printf("%lu surfaces, %lu triangles and %lu instances; %lu bytes of geometry are the library's\n",
           (unsigned long)info.surfaces, (unsigned long)(info.triangles + info.shared_triangles),
           (unsigned long)info.instances, (unsigned long)info.geometry_bytes);
    must(etd_film_write(film, image, NULL));
    etd_film_release(film);
    etd_scene_release(scene); /* and with it the ground */
    etd_device_release(device);
    printf("the ground was %s\n", ground.released ? "released" : "kept");
    return ground.released ? 0 : 1;
}
