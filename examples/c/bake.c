/* A light map as a game would bake it: a room made by calls, laid out in one square of texels, its irradiance in the program's
 * own array, padded at the seams; then the vertices of one mesh.
 *
 * The program keeps its own vertex and texture memory: the library is asked how much there is, and fills what it is given. The
 * light map is written as a PPM to look at; a game would hand the floats to its graphics interface as they are (row 0 is v = 0).
 *
 * Build:  cc -std=c99 bake.c $(pkg-config --cflags --libs etendue) -lm -o bake
 * Run:    ./bake [IMAGE.ppm [RESOLUTION [SAMPLES]]] */
#include <math.h>

#include "common.h"

/* A texel of the program: the library is told the distance from one to the next. */
struct texel {
    float irradiance[3];
    float unused;
};

static etd_scene *make_room(etd_device *device, uint32_t *box) {
    static const double floor_quad[12] = {-2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2};
    static const double ceiling[12] = {-2, 2.5, -2, 2, 2.5, -2, 2, 2.5, 2, -2, 2.5, 2};
    static const double walls[4][12] = {{-2, 0, 2, -2, 0, -2, -2, 2.5, -2, -2, 2.5, 2},
                                        {2, 0, -2, 2, 0, 2, 2, 2.5, 2, 2, 2.5, -2},
                                        {-2, 0, -2, 2, 0, -2, 2, 2.5, -2, -2, 2.5, -2},
                                        {2, 0, 2, -2, 0, 2, -2, 2.5, 2, 2, 2.5, 2}};
    static const double lamp[12] = {-0.5, 2.45, -0.5, 0.5, 2.45, -0.5, 0.5, 2.45, 0.5, -0.5, 2.45, 0.5};
    /* A box without a floor of its own, each face with four corners to itself. */
    static const float corners[8][3] = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f},
                                        {-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}};
    static const int faces[5][4] = {{1, 0, 4, 5}, {2, 1, 5, 6}, {3, 2, 6, 7}, {0, 3, 7, 4}, {7, 6, 5, 4}};
    float positions[20][3];
    uint32_t indices[10][3];
    etd_scene *scene = NULL;
    etd_surface surface = ETD_SURFACE_INIT;
    etd_mesh mesh = ETD_MESH_INIT;
    uint32_t number, i, k;
    must(etd_scene_new(device, NULL, &scene));
    surface.material = add_matt(scene, "plaster", 0.75f, 0.75f, 0.7f);
    must(etd_scene_add_quad(scene, floor_quad, &surface, &number));
    must(etd_scene_add_quad(scene, ceiling, &surface, &number));
    must(etd_scene_add_quad(scene, walls[2], &surface, &number));
    must(etd_scene_add_quad(scene, walls[3], &surface, &number));
    surface.material = add_matt(scene, "red", 0.6f, 0.1f, 0.1f);
    must(etd_scene_add_quad(scene, walls[0], &surface, &number));
    surface.material = add_matt(scene, "green", 0.15f, 0.5f, 0.15f);
    must(etd_scene_add_quad(scene, walls[1], &surface, &number));

    for (i = 0; i < 5; ++i) {
        static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
        for (k = 0; k < 4; ++k) {
            positions[4 * i + k][0] = corners[faces[i][k]][0];
            positions[4 * i + k][1] = corners[faces[i][k]][1];
            positions[4 * i + k][2] = corners[faces[i][k]][2];
        }
        for (k = 0; k < 6; ++k) {
            indices[2 * i + k / 3][k % 3] = 4 * i + halves[k / 3][k % 3];
        }
    }
    mesh.positions = positions;
    mesh.vertex_count = 20;
    mesh.indices = indices[0];
    mesh.triangle_count = 10;
    must(etd_scene_add_mesh(scene, &mesh, &number));
    surface.material = add_matt(scene, "wood", 0.5f, 0.35f, 0.2f);
    surface.transform[3] = 0.6;
    must(etd_scene_add_mesh_surface(scene, number, 0, &surface, box));

    surface = (etd_surface)ETD_SURFACE_INIT;
    surface.emission[0] = surface.emission[1] = surface.emission[2] = 10;
    must(etd_scene_add_quad(scene, lamp, &surface, &number));
    return scene;
}

/* A bar on standard error. Anything but 0 would cancel. */
static int32_t show(void *user_data, const etd_progress *progress) {
    (void)user_data;
    fprintf(stderr, "\r%3.0f %%, %u samples", 100 * progress->fraction, progress->samples_done);
    return 0;
}

static void *room_for(size_t count, size_t size) {
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fprintf(stderr, "no memory\n");
        exit(1);
    }
    return memory;
}

/* As bright as a white wall would look, the sRGB curve nearly. */
static int to_byte(float irradiance) {
    const float radiance = irradiance / 3.14159265f;
    const float clamped = radiance < 0 ? 0 : radiance > 1 ? 1 : radiance;
    return (int)(255 * powf(clamped, 1 / 2.2f) + 0.5f);
}

static void write_map(const char *path, const struct texel *texels, const etd_atlas_info *info) {
    FILE *file = fopen(path, "wb");
    uint32_t i;
    if (file == NULL) {
        fprintf(stderr, "%s cannot be written\n", path);
        exit(1);
    }
    fprintf(file, "P6\n%u %u\n255\n", info->width, info->height);
    for (i = 0; i < info->width * info->height; ++i) {
        int k;
        for (k = 0; k < 3; ++k) {
            putc(to_byte(texels[i].irradiance[k]), file);
        }
    }
    fclose(file);
}

/* The texel of one coordinate: 0 is the outer side of the first, 1 that of the last. */
static uint32_t texel_at(float coordinate, uint32_t count) {
    const uint32_t texel = (uint32_t)(coordinate * (float)count);
    return texel < count ? texel : count - 1;
}

int main(int count, char **arguments) {
    const char *image = count > 1 ? arguments[1] : "bake.ppm";
    etd_device *device = NULL;
    etd_atlas *atlas = NULL;
    etd_scene *scene;
    etd_atlas_options layout = ETD_ATLAS_OPTIONS_INIT;
    etd_atlas_info info = ETD_ATLAS_INFO_INIT;
    etd_bake_target target = ETD_BAKE_TARGET_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_summary summary = ETD_SUMMARY_INIT;
    etd_atlas_vertex *vertices;
    etd_atlas_surface *surfaces;
    uint32_t *indices;
    float *coverage;
    struct texel *texels;
    float box_vertices[20][3];
    double sum = 0, area = 0;
    uint32_t box, i, k;
    must(etd_device_new(NULL, &device));
    scene = make_room(device, &box);

    /* Where everything lies in the light map. */
    layout.resolution = number_argument(count, arguments, 2, 256);
    must(etd_atlas_new(scene, &layout, &atlas));
    must(etd_atlas_get_info(atlas, &info));
    vertices = room_for(info.vertex_count, sizeof *vertices);
    indices = room_for(3 * info.triangle_count, sizeof *indices);
    surfaces = room_for(info.surface_count, sizeof *surfaces);
    coverage = room_for((size_t)info.width * info.height, sizeof *coverage);
    texels = room_for((size_t)info.width * info.height, sizeof *texels);
    must(etd_atlas_copy_vertices(atlas, vertices, info.vertex_count, NULL));
    must(etd_atlas_copy_indices(atlas, indices, 3 * info.triangle_count, NULL));
    must(etd_atlas_copy_surfaces(atlas, surfaces, info.surface_count, NULL));
    must(etd_atlas_copy_coverage(atlas, coverage, (size_t)info.width * info.height, NULL));
    printf("%ux%u texels, %.1f to a unit; %lu charts of %lu triangles, %lu vertices\n", info.width, info.height,
           info.texels_per_unit, (unsigned long)info.chart_count, (unsigned long)info.triangle_count,
           (unsigned long)info.vertex_count);

    /* The light, into the program's own texels. */
    target.irradiance = texels[0].irradiance;
    target.size = (size_t)info.width * info.height * sizeof *texels;
    target.stride = sizeof *texels;
    options.samples = number_argument(count, arguments, 3, 64);
    options.progress = show;
    must(etd_atlas_bake(atlas, &options, &target, &summary));
    fprintf(stderr, "\n");
    for (i = 0; i < info.width * info.height; ++i) {
        sum += coverage[i] * texels[i].irradiance[1];
        area += coverage[i];
    }
    printf("%u samples a texel, %.1f million rays; mean irradiance %.3f W/m^2, relative error %.3f\n", summary.samples,
           1e-6 * (double)summary.rays, sum / area, summary.relative_error);
    write_map(image, texels, &info);

    /* What a program looks up: the first corner of each surface. */
    for (i = 0; i < info.surface_count; ++i) {
        const etd_atlas_vertex *vertex = vertices + indices[3 * surfaces[i].first_triangle];
        const uint32_t x = texel_at(vertex->uv[0], info.width);
        const uint32_t y = texel_at(vertex->uv[1], info.height);
        printf("surface %u: %u triangles, at (%.2f, %.2f, %.2f) irradiance %.3f\n", surfaces[i].surface,
               surfaces[i].triangle_count, vertex->position[0], vertex->position[1], vertex->position[2],
               texels[y * info.width + x].irradiance[1]);
    }

    /* The box once more, at its vertices. */
    target = (etd_bake_target)ETD_BAKE_TARGET_INIT;
    target.irradiance = box_vertices[0];
    target.size = sizeof box_vertices;
    options.progress = NULL;
    must(etd_scene_bake_vertices(scene, box, &options, &target, NULL));
    for (k = 0; k < 5; ++k) {
        printf("face %u of the box: %.3f %.3f %.3f %.3f\n", k, box_vertices[4 * k][1], box_vertices[4 * k + 1][1],
               box_vertices[4 * k + 2][1], box_vertices[4 * k + 3][1]);
    }
    free(vertices);
    free(indices);
    free(surfaces);
    free(coverage);
    free(texels);
    etd_atlas_release(atlas);
    etd_scene_release(scene);
    etd_device_release(device);
    return 0;
}
