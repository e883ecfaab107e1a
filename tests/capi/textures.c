/* Textures of memory, of files and of patterns: the picture is that of a file with the same texture, texels are shared and
 * changed in place, and wrong ones are refused. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include <math.h>

CHECK_MAIN;

#define SIDE 16
#define PIXELS (SIDE * SIDE * 4)

/* A square with texture coordinates, and above it a lamp. The material of the square is number 0. */
static etd_scene *scene_of(etd_device *device, const char *textures, const char *bindings) {
    char json[2048];
    etd_scene *scene = NULL;
    snprintf(json, sizeof json,
             "{\"etendue\": 1, \"camera\": {\"origin\": [0, 0, 4], \"lookAt\": [0, 0, 0], \"up\": [0, 1, 0], "
             "\"fieldOfView\": 50}, \"textures\": [%s], \"materials\": [{\"name\": \"square\", \"type\": \"diffuse\", "
             "\"color\": [0.8, 0.7, 0.6], \"textures\": {%s}}], \"surfaces\": ["
             "{\"geometry\": \"quad\", \"vertex-1\": [-1.5, -1.5, 0], \"vertex-2\": [1.5, -1.5, 0], "
             "\"vertex-3\": [1.5, 1.5, 0], \"vertex-4\": [-1.5, 1.5, 0], \"material\": \"square\"}, "
             "{\"geometry\": \"quad\", \"vertex-1\": [-1, 3, 1], \"vertex-2\": [1, 3, 1], \"vertex-3\": [1, 3, 3], "
             "\"vertex-4\": [-1, 3, 3], \"emission\": [8, 8, 8]}]}",
             textures, bindings);
    if (!CHECK_OK(etd_scene_from_json(device, json, strlen(json), NULL, &scene))) {
        fprintf(stderr, "%s\n", json);
    }
    return scene;
}

static void render(etd_device *device, etd_scene *scene, float *pixels) {
    etd_film *film = new_film(device, SIDE, SIDE, 0);
    etd_render_options options = short_render(4);
    etd_image_options image = ETD_IMAGE_OPTIONS_INIT;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, &image, pixels, PIXELS * sizeof *pixels, 0));
    etd_film_release(film);
}

static int is_same(const float *a, const float *b) { return memcmp(a, b, PIXELS * sizeof *a) == 0; }

/* Gives the square's colour this texture. */
static void bind(etd_scene *scene, uint32_t texture) {
    etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
    binding.texture = texture;
    CHECK_OK(etd_scene_set_material_texture(scene, 0, "color", &binding));
}

/* The picture of a square with this texture. */
static void render_texture(etd_device *device, const etd_texture *texture, float *pixels) {
    etd_scene *scene = scene_of(device, "", "");
    uint32_t number = 7;
    if (CHECK_OK(etd_scene_add_texture(scene, NULL, texture, &number))) {
        CHECK(number == 0);
        bind(scene, number);
        render(device, scene, pixels);
    }
    etd_scene_release(scene);
}

/* Patterns look as those of files do, and are read back as they were set. */
static void patterns(etd_device *device) {
    static const struct {
        etd_texture_kind kind;
        etd_coordinates coordinates;
        const char *json;
    } cases[] = {
        {ETD_TEXTURE_CHECKER, ETD_COORDINATES_UV, "\"type\": \"checker\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_CHECKER, ETD_COORDINATES_SPACE,
         "\"type\": \"checker\", \"coordinates\": \"space\", \"scale\": [4, 2, 3], \"offset\": [0.25, 0.5, 0.125]"},
        {ETD_TEXTURE_CHECKER, ETD_COORDINATES_BOX,
         "\"type\": \"checker\", \"coordinates\": \"box\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_GRADIENT, ETD_COORDINATES_PLANAR_Z,
         "\"type\": \"gradient\", \"coordinates\": \"planar-z\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_GRADIENT, ETD_COORDINATES_PLANAR_X,
         "\"type\": \"gradient\", \"coordinates\": \"planar-x\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_GRADIENT, ETD_COORDINATES_PLANAR_Y,
         "\"type\": \"gradient\", \"coordinates\": \"planar-y\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_GRID, ETD_COORDINATES_UV, "\"type\": \"grid\", \"lineWidth\": 0.25, \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_GRADIENT, ETD_COORDINATES_UV, "\"type\": \"gradient\", \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_NOISE, ETD_COORDINATES_UV,
         "\"type\": \"noise\", \"octaves\": 3, \"scale\": [4, 2], \"offset\": [0.25, 0.5], \"rotation\": 30"},
        {ETD_TEXTURE_TURBULENCE, ETD_COORDINATES_SPACE,
         "\"type\": \"turbulence\", \"octaves\": 3, \"coordinates\": \"space\", \"scale\": [4, 2, 3], "
         "\"offset\": [0.25, 0.5, 0.125]"},
        {ETD_TEXTURE_MARBLE, ETD_COORDINATES_UV,
         "\"type\": \"marble\", \"octaves\": 3, \"turbulence\": 0.5, \"scale\": [4, 2], \"offset\": [0.25, 0.5], "
         "\"rotation\": 30"},
        {ETD_TEXTURE_WOOD, ETD_COORDINATES_SPACE,
         "\"type\": \"wood\", \"octaves\": 3, \"turbulence\": 0.5, \"coordinates\": \"space\", \"scale\": [4, 2, 3], "
         "\"offset\": [0.25, 0.5, 0.125]"},
    };
    static float expected[PIXELS], found[PIXELS];
    size_t i;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char json[512];
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_texture read = ETD_TEXTURE_INIT;
        etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
        etd_scene *file;
        uint32_t number = 7;
        snprintf(json, sizeof json, "{\"name\": \"pattern\", \"colors\": [[0.25, 0.5, 0.75], [1, 0.5, 0]], %s}", cases[i].json);
        file = scene_of(device, json, "\"color\": \"pattern\"");
        if (file == NULL) {
            break;
        }
        render(device, file, expected);
        texture.kind = cases[i].kind;
        texture.coordinates = cases[i].coordinates;
        texture.colors[0][0] = 0.25f;
        texture.colors[0][1] = 0.5f;
        texture.colors[0][2] = 0.75f;
        texture.colors[1][1] = 0.5f;
        texture.colors[1][2] = 0;
        texture.line_width = 0.25f;
        texture.turbulence = 0.5f;
        texture.octaves = 3;
        texture.scale[0] = 4;
        texture.scale[1] = 2;
        texture.offset[0] = 0.25;
        texture.offset[1] = 0.5;
        if (cases[i].coordinates == ETD_COORDINATES_SPACE) {
            texture.scale[2] = 3;
            texture.offset[2] = 0.125;
        } else {
            texture.rotation_deg = 30;
        }
        render_texture(device, &texture, found);
        check_that(is_same(found, expected), __FILE__, __LINE__, cases[i].json);

        /* What was read from the file is the same, and looks the same once it was set again. */
        CHECK_OK(etd_scene_find_texture(file, "pattern", &number));
        CHECK_OK(etd_scene_get_texture(file, number, &read));
        check_that(read.kind == texture.kind && read.coordinates == texture.coordinates &&
                       memcmp(read.colors, texture.colors, sizeof read.colors) == 0 &&
                       memcmp(read.scale, texture.scale, sizeof read.scale) == 0 &&
                       memcmp(read.offset, texture.offset, sizeof read.offset) == 0 &&
                       fabs(read.rotation_deg - texture.rotation_deg) < 1e-12,
                   __FILE__, __LINE__, cases[i].json);
        CHECK_OK(etd_scene_set_texture(file, number, &read));
        render(device, file, found);
        check_that(is_same(found, expected), __FILE__, __LINE__, cases[i].json);
        CHECK_OK(etd_scene_get_material_texture(file, 0, "color", &binding));
        CHECK(binding.texture == number && binding.channel == ETD_CHANNEL_DEFAULT && binding.strength == 1);
        etd_scene_release(file);
    }
}

/* An image of 3 x 2 texels with gaps between its rows, in four formats of the same numbers. */
static const uint8_t bytes[2][12] = {{255, 0, 51, 102, 204, 255, 51, 153, 0, 9, 9, 9},
                                     {0, 255, 0, 153, 102, 51, 255, 204, 153, 9, 9, 9}};
static uint16_t shorts[2][12];
static uint16_t halves[2][12];
static float floats[2][12];

/* The half of a number in [0, 1] that is a multiple of 1/5 of which the test has six. */
static uint16_t half_of(uint8_t value) {
    switch (value) {
    case 0: return 0x0000;
    case 51: return 0x3266;
    case 102: return 0x3666;
    case 153: return 0x38cd;
    case 204: return 0x3a66;
    default: return 0x3c00;
    }
}

static etd_texture image_of(const void *texels, etd_texel_format format, size_t row_stride) {
    etd_texture texture = ETD_TEXTURE_INIT;
    texture.color_space = ETD_COLOR_SPACE_RAW;
    texture.texels = texels;
    texture.texel_format = format;
    texture.row_stride = row_stride;
    texture.width = 3;
    texture.height = 2;
    texture.channels = 3;
    texture.filter = ETD_TEXTURE_FILTER_NEAREST;
    return texture;
}

static void formats(etd_device *device) {
    static float expected[PIXELS], found[PIXELS];
    static uint8_t dense[2][9];
    int x, y, i;
    double difference = 0;
    etd_texture texture;
    FILE *file;
    for (y = 0; y < 2; ++y) {
        for (x = 0; x < 12; ++x) {
            shorts[y][x] = (uint16_t)(257 * bytes[y][x]);
            halves[y][x] = half_of(bytes[y][x]);
            floats[y][x] = (float)bytes[y][x] / 255.0f;
        }
        memcpy(dense[y], bytes[y], sizeof dense[y]);
    }
    texture = image_of(bytes, ETD_TEXEL_UINT8, 12);
    render_texture(device, &texture, expected);
    texture = image_of(dense, ETD_TEXEL_UINT8, 0);
    render_texture(device, &texture, found);
    CHECK(is_same(found, expected));
    texture = image_of(shorts, ETD_TEXEL_UINT16, sizeof shorts[0]);
    render_texture(device, &texture, found);
    CHECK(is_same(found, expected));
    texture = image_of(floats, ETD_TEXEL_FLOAT, sizeof floats[0]);
    render_texture(device, &texture, found);
    CHECK(is_same(found, expected));
    texture = image_of(halves, ETD_TEXEL_HALF, sizeof halves[0]);
    render_texture(device, &texture, found);
    for (i = 0; i < PIXELS; ++i) {
        difference = fmax(difference, fabs((double)found[i] - (double)expected[i]) / (0.01 + fabs((double)expected[i])));
    }
    CHECK(difference > 0 && difference < 1e-3); /* a half has 11 bits */

    /* The same image from a file: a bitmap, whose rows begin below and whose colours are in the order blue, green, red. */
    file = fopen("textures-test.bmp", "wb");
    if (CHECK(file != NULL)) {
        static const uint8_t head[54] = {'B', 'M', 78, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0,
                                         3, 0, 0, 0, 2, 0, 0, 0, 1, 0, 24, 0, 0, 0, 0, 0, 24, 0, 0, 0};
        fwrite(head, 1, sizeof head, file);
        for (y = 1; y >= 0; --y) {
            for (x = 0; x < 3; ++x) {
                fputc(bytes[y][3 * x + 2], file);
                fputc(bytes[y][3 * x + 1], file);
                fputc(bytes[y][3 * x], file);
            }
            fputc(0, file);
            fputc(0, file);
            fputc(0, file);
        }
        fclose(file);
        texture = image_of(NULL, ETD_TEXEL_UINT8, 0);
        texture.file = "textures-test.bmp";
        texture.width = texture.height = texture.channels = 0; /* the file says it */
        render_texture(device, &texture, found);
        CHECK(is_same(found, expected));
        remove("textures-test.bmp");
    }
    /* As colours of sRGB, 8 bits are guessed to be that, and differ from linear light. */
    texture = image_of(bytes, ETD_TEXEL_UINT8, 12);
    texture.color_space = ETD_COLOR_SPACE_SRGB;
    render_texture(device, &texture, found);
    CHECK(!is_same(found, expected));
    texture.color_space = ETD_COLOR_SPACE_BY_USE;
    render_texture(device, &texture, expected);
    CHECK(is_same(found, expected));
}

static void count_release(void *user_data) { ++*(int *)user_data; }

/* Shared texels are read in place and released once; a change in place is seen after it was said. */
static void sharing(etd_device *device) {
    static float expected[PIXELS], found[PIXELS];
    uint8_t texels[2][12];
    int released = 0, other_released = 0;
    uint32_t number = 7;
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    etd_texture texture, read = ETD_TEXTURE_INIT;
    etd_scene *scene = scene_of(device, "", "");
    memcpy(texels, bytes, sizeof texels);
    texture = image_of(bytes, ETD_TEXEL_UINT8, 12);
    render_texture(device, &texture, expected);
    texture.texels = texels;
    texture.sharing = ETD_SHARE;
    texture.release = count_release;
    texture.user_data = &released;
    CHECK_OK(etd_scene_add_texture(scene, "shared", &texture, &number));
    CHECK_STATUS(etd_scene_add_texture(scene, "shared", &texture, &number), ETD_INVALID_SCENE);
    CHECK(released == 0);
    CHECK_OK(etd_scene_get_texture(scene, number, &read));
    CHECK(read.sharing == ETD_SHARE && read.texels == NULL && read.width == 3 && read.height == 2 && read.channels == 3 &&
          read.filter == ETD_TEXTURE_FILTER_NEAREST && read.color_space == ETD_COLOR_SPACE_RAW);
    bind(scene, number);
    render(device, scene, found);
    CHECK(is_same(found, expected));
    CHECK_OK(etd_scene_get_info(scene, &info));
    CHECK(info.textures == 1 && info.texture_bytes == 0);

    memset(texels, 128, sizeof texels);
    CHECK_OK(etd_scene_update_texture(scene, number));
    render(device, scene, found);
    texture.sharing = ETD_COPY;
    texture.release = NULL;
    render_texture(device, &texture, expected);
    CHECK(is_same(found, expected));

    /* Another texture in its place lets go of the first, once it is built. */
    texture.sharing = ETD_SHARE;
    texture.release = count_release;
    texture.user_data = &other_released;
    CHECK_OK(etd_scene_set_texture(scene, number, &texture));
    render(device, scene, found);
    CHECK(is_same(found, expected) && released == 1 && other_released == 0);
    etd_scene_release(scene);
    CHECK(released == 1 && other_released == 1);
}

/* Texels are charged to the allowance of the device. */
static void memory(void) {
    static uint8_t texels[1024 * 1024];
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    uint64_t limits[2] = {0, 1 << 20};
    int i;
    for (i = 0; i < 2; ++i) {
        etd_device *device = NULL;
        etd_scene *scene;
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_scene_info info = ETD_SCENE_INFO_INIT;
        uint64_t before = 0, after = 0;
        uint32_t number = 0;
        etd_status status;
        options.threads = 1;
        options.memory_limit = limits[i];
        CHECK_OK(etd_device_new(&options, &device));
        scene = scene_of(device, "", "");
        texture.texels = texels;
        texture.width = texture.height = 1024;
        texture.channels = 1;
        texture.filter = ETD_TEXTURE_FILTER_MIP;
        CHECK_OK(etd_scene_commit(scene, NULL, NULL));
        CHECK_OK(etd_device_memory(device, &before, NULL));
        CHECK_OK(etd_scene_add_texture(scene, NULL, &texture, &number));
        bind(scene, number);
        status = etd_scene_commit(scene, NULL, NULL);
        CHECK_OK(etd_device_memory(device, &after, NULL));
        if (i == 0) {
            /* 8 bits a texel, and levels of 16 bits of a third as many. */
            CHECK_OK(status);
            CHECK(after - before >= 1747000 && after - before <= 1749000);
            CHECK_OK(etd_scene_get_info(scene, &info));
            CHECK(info.texture_bytes >= 1747000 && info.texture_bytes <= 1749000);
        } else {
            CHECK_STATUS(status, ETD_OUT_OF_MEMORY);
        }
        etd_scene_release(scene);
        etd_device_release(device);
    }
}

/* What is wrong is refused, and nothing is released or changed. */
static void errors(etd_device *device) {
    int released = 0;
    float broken[18] = {0};
    uint32_t number = 7;
    size_t i;
    etd_texture texture = image_of(bytes, ETD_TEXEL_UINT8, 12);
    etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
    etd_material material = ETD_MATERIAL_INIT;
    etd_scene *scene = scene_of(device, "", "");
    texture.sharing = ETD_SHARE;
    texture.release = count_release;
    texture.user_data = &released;
#define REFUSED(change, status)                                                             \
    do {                                                                                    \
        etd_texture wrong = texture;                                                        \
        change;                                                                             \
        CHECK_STATUS(etd_scene_add_texture(scene, NULL, &wrong, &number), status);          \
        CHECK(number == 7 && released == 0);                                                \
    } while (0)
    REFUSED(wrong.width = 0, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.height = 0, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.channels = 0, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.channels = 5, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.row_stride = 8, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.texels = NULL, ETD_INVALID_ARGUMENT);
    REFUSED((wrong.texel_format = ETD_TEXEL_UINT16, wrong.row_stride = 19), ETD_INVALID_ARGUMENT);
    REFUSED((wrong.texel_format = ETD_TEXEL_FLOAT, wrong.texels = bytes[0] + 1, wrong.row_stride = 0), ETD_INVALID_ARGUMENT);
    REFUSED((wrong.width = wrong.height = UINT32_MAX, wrong.row_stride = SIZE_MAX / 2), ETD_INVALID_ARGUMENT);
    REFUSED((wrong.width = wrong.height = 1 << 15, wrong.row_stride = 0), ETD_INVALID_SCENE);
    REFUSED(wrong.coordinates = ETD_COORDINATES_SPACE, ETD_INVALID_ARGUMENT);
    REFUSED(wrong.file = "no-such-file.png", ETD_IO);
    REFUSED(wrong.scale[1] = (double)NAN, ETD_INVALID_SCENE);
    for (i = 0; i < 18; i += 17) {
        broken[i] = INFINITY;
        REFUSED((wrong.texel_format = ETD_TEXEL_FLOAT, wrong.texels = broken, wrong.row_stride = 0), ETD_INVALID_SCENE);
        broken[i] = 0;
    }
    texture.sharing = ETD_COPY;
    REFUSED((wrong.kind = ETD_TEXTURE_CHECKER, wrong.colors[1][2] = 2), ETD_INVALID_SCENE);
    REFUSED((wrong.kind = ETD_TEXTURE_GRID, wrong.line_width = -1), ETD_INVALID_SCENE);
    REFUSED((wrong.kind = ETD_TEXTURE_NOISE, wrong.octaves = 17), ETD_INVALID_SCENE);
    REFUSED((wrong.kind = ETD_TEXTURE_WOOD, wrong.turbulence = NAN), ETD_INVALID_SCENE);
    REFUSED((wrong.kind = ETD_TEXTURE_CHECKER, wrong.coordinates = ETD_COORDINATES_SPACE, wrong.rotation_deg = 1), ETD_INVALID_ARGUMENT);

    CHECK_OK(etd_scene_add_texture(scene, "own", &texture, &number));
    CHECK(number == 0);
    CHECK_STATUS(etd_scene_set_texture(scene, 1, &texture), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_update_texture(scene, 1), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_find_texture(scene, "other", &number), ETD_INVALID_ARGUMENT);
    binding.texture = 0;
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "colour", &binding), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "base_color", &binding), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_set_material_texture(scene, 99, "color", &binding), ETD_INVALID_ARGUMENT);
    binding.texture = 1;
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "color", &binding), ETD_INVALID_SCENE);
    binding.texture = 0;
    binding.cutoff = 0.5f;
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "color", &binding), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_set_material_texture(scene, 0, "opacity", &binding));
    CHECK_OK(etd_scene_get_material_texture(scene, 0, "opacity", &binding));
    CHECK(binding.cutoff == 0.5f);
    CHECK_OK(etd_scene_set_material_texture(scene, 0, "opacity", NULL));
    binding.cutoff = 1.5f;
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "opacity", &binding), ETD_INVALID_SCENE);
    binding.cutoff = 0.0f;
    binding.strength = NAN;
    CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "color", &binding), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_get_material_texture(scene, 0, "color", &binding));
    CHECK(binding.texture == ETD_NONE);

    /* A material keeps its textures where it can; they go by name. */
    bind(scene, 0);
    CHECK_OK(etd_scene_set_material(scene, 0, &material));
    CHECK_OK(etd_scene_get_material_texture(scene, 0, "color", &binding));
    CHECK(binding.texture == 0);
    material.bsdf = ETD_BSDF_BLACK;
    CHECK_STATUS(etd_scene_set_material(scene, 0, &material), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_set_material_texture(scene, 0, "color", NULL));
    CHECK_OK(etd_scene_set_material(scene, 0, &material));
    texture.kind = ETD_TEXTURE_CHECKER;
    CHECK_OK(etd_scene_set_texture(scene, 0, &texture));
    CHECK_STATUS(etd_scene_update_texture(scene, 0), ETD_INVALID_SCENE);
    etd_scene_release(scene);
    CHECK(released == 0);
}

/* A square of two triangles that fills the picture. */
static etd_mesh quad(void) {
    static const float positions[] = {-1.5f, -1.5f, 0, 1.5f, -1.5f, 0, 1.5f, 1.5f, 0, -1.5f, 1.5f, 0, 0, 0, 0, 0};
    static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    etd_mesh mesh = ETD_MESH_INIT;
    mesh.positions = positions;
    mesh.vertex_count = 4;
    mesh.position_bytes = sizeof positions;
    mesh.indices = indices;
    mesh.triangle_count = 2;
    return mesh;
}

/* Puts a mesh of material 0 in the place of the scene's surface. Returns the number of the mesh. */
static uint32_t put_mesh(etd_scene *scene, const etd_mesh *mesh, int smooth) {
    etd_surface look = ETD_SURFACE_INIT;
    uint32_t number = 7, surface = 7;
    CHECK_OK(etd_scene_add_mesh(scene, mesh, &number));
    look.material = 0;
    CHECK_OK(etd_scene_remove_surface(scene, 0));
    CHECK_OK(etd_scene_add_mesh_surface(scene, number, smooth, &look, &surface));
    return number;
}

/* Colours of vertices: a mesh of one colour looks like a material of that colour, and the values are copied. */
static void vertex_colors(etd_device *device) {
    static const etd_sharing sharings[] = {ETD_COPY, ETD_SHARE};
    static float expected[PIXELS], found[PIXELS];
    size_t i, k;
    for (k = 0; k < 3; ++k) {
        float colors[24];
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_texture read = ETD_TEXTURE_INIT;
        etd_mesh mesh = quad();
        etd_material material = ETD_MATERIAL_INIT;
        etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
        etd_scene *scene = scene_of(device, "", "");
        uint32_t number = 7, texture_number = 7;
        for (i = 0; i < 24; ++i) {
            static const float color[] = {0.5f, 0.25f, 0.75f, 1.0f, -7.0f, -7.0f};
            colors[i] = color[i % 6];
        }
        CHECK_OK(etd_scene_get_material(scene, 0, &material));
        /* The material's own colour, then that of vertices times white, then times a pattern of one colour. */
        if (k == 0) {
            material.color[0] *= 0.5f;
            material.color[1] *= 0.25f;
            material.color[2] *= 0.75f;
        } else {
            mesh.colors = colors;
            mesh.color_stride = 6 * sizeof *colors;
            mesh.sharing = sharings[k - 1];
        }
        CHECK_OK(etd_scene_set_material(scene, 0, &material));
        number = put_mesh(scene, &mesh, 0);
        memset(colors, 0, sizeof colors);
        if (k > 0) {
            texture.kind = k == 1 ? ETD_TEXTURE_VERTEX_COLORS : ETD_TEXTURE_CHECKER;
            texture.vertex_colors = k == 2;
            texture.colors[0][0] = texture.colors[0][1] = texture.colors[0][2] = 1;
            CHECK_OK(etd_scene_add_texture(scene, NULL, &texture, &texture_number));
            CHECK_OK(etd_scene_get_texture(scene, texture_number, &read));
            CHECK(read.kind == texture.kind && read.vertex_colors == 1);
            bind(scene, texture_number);
            binding.texture = texture_number;
            CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "normal", &binding), ETD_INVALID_SCENE);
            CHECK_STATUS(etd_scene_set_material_texture(scene, 0, "bump", &binding), ETD_INVALID_SCENE);
            texture.vertex_colors = 2;
            CHECK_STATUS(etd_scene_set_texture(scene, texture_number, &texture), ETD_INVALID_ARGUMENT);
        }
        render(device, scene, k == 0 ? expected : found);
        for (i = 0; k > 0 && i < PIXELS; ++i) {
            if (!CHECK(fabsf(found[i] - expected[i]) <= 1e-5f * (1 + expected[i]))) {
                break;
            }
        }
        mesh.colors = colors;
        mesh.color_stride = 6 * sizeof *colors;
        colors[6] = -1;
        CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_SCENE);
        colors[6] = 1;
        colors[9] = 2;
        CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_SCENE);
        mesh.color_stride = 7;
        CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_ARGUMENT);
        etd_scene_release(scene);
    }
}

/* Further sets of texture coordinates: a texture of set 2 looks as one of the first set on a mesh with these coordinates first. */
static void further_sets(etd_device *device) {
    static const float plain[] = {0, 0, 1, 0, 1, 1, 0, 1};
    static const float wide[] = {0.5f, 1, 9, 3, 0.25f, 9, 4, 3, 9, 1, 2, 9};
    static const float tight[] = {0.5f, 1, 3, 0.25f, 4, 3, 1, 2};
    static float expected[PIXELS], found[PIXELS], other[PIXELS];
    size_t k;
    for (k = 0; k < 3; ++k) {
        const float *sets[2] = {NULL, wide};
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_texture read = ETD_TEXTURE_INIT;
        etd_mesh mesh = quad();
        etd_scene *scene = scene_of(device, "", "");
        uint32_t number = 7, texture_number = 7;
        mesh.uvs = k == 0 ? tight : plain;
        if (k > 0) {
            mesh.further_uvs = sets;
            mesh.further_uv_count = 2;
            mesh.further_uv_stride = 3 * sizeof(float);
        }
        texture.kind = ETD_TEXTURE_CHECKER;
        texture.uv_set = k == 1 ? 2 : 0;
        number = put_mesh(scene, &mesh, 0);
        CHECK_OK(etd_scene_add_texture(scene, NULL, &texture, &texture_number));
        CHECK_OK(etd_scene_get_texture(scene, texture_number, &read));
        CHECK(read.uv_set == texture.uv_set);
        bind(scene, texture_number);
        render(device, scene, k == 0 ? expected : k == 1 ? found : other);
        mesh.further_uvs = sets;
        mesh.further_uv_count = 8;
        CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_ARGUMENT);
        texture.uv_set = 8;
        CHECK_STATUS(etd_scene_set_texture(scene, texture_number, &texture), ETD_INVALID_SCENE);
        etd_scene_release(scene);
    }
    CHECK(is_same(found, expected));
    CHECK(!is_same(other, expected));
}

/* Tangents of a mesh: those along u are those of MikkTSpace, and others turn a normal map. */
static void tangents(etd_device *device) {
    static const float uvs[] = {0, 0, 1, 0, 1, 1, 0, 1};
    static const float normals[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    static const float given[3][2] = {{0, 0}, {2, 0}, {0.6f, 0.8f}};
    static float pictures[3][PIXELS];
    size_t i, k;
    for (k = 0; k < 3; ++k) {
        float all[16];
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
        etd_mesh mesh = quad();
        etd_scene *scene = scene_of(device, "", "");
        uint32_t number;
        for (i = 0; i < 16; ++i) {
            all[i] = i % 4 < 2 ? given[k][i % 4] : i % 4 == 2 ? 0.0f : -7.0f;
        }
        mesh.uvs = uvs;
        mesh.normals = normals;
        mesh.tangents = k == 0 ? NULL : all;
        mesh.tangent_stride = 4 * sizeof *all;
        texture.kind = ETD_TEXTURE_CHECKER;
        for (i = 0; i < 2; ++i) {
            texture.colors[i][0] = 0.75f;
            texture.colors[i][1] = 0.4f;
            texture.colors[i][2] = 0.9f;
        }
        number = put_mesh(scene, &mesh, 1);
        memset(all, 0, sizeof all);
        CHECK_OK(etd_scene_add_texture(scene, NULL, &texture, &binding.texture));
        CHECK_OK(etd_scene_set_material_texture(scene, 0, "normal", &binding));
        render(device, scene, pictures[k]);
        mesh.tangents = all;
        mesh.tangent_stride = 7;
        CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_ARGUMENT);
        etd_scene_release(scene);
    }
    for (i = 0; i < PIXELS; ++i) {
        if (!CHECK(fabsf(pictures[1][i] - pictures[0][i]) <= 1e-5f * (1 + pictures[0][i]))) {
            break;
        }
    }
    CHECK(!is_same(pictures[2], pictures[0]));
}

/* What a camera sees in this direction of a sky alone. */
static void look(etd_device *device, etd_scene *scene, double x, double y, double z, float *color) {
    static float pixels[PIXELS];
    etd_camera camera = ETD_CAMERA_INIT;
    camera.look_at[0] = x;
    camera.look_at[1] = y;
    camera.look_at[2] = z;
    camera.up[0] = camera.up[1] = 0.3;
    camera.up[2] = 0.9;
    camera.fov_deg = 0.2;
    CHECK_OK(etd_scene_set_camera(scene, &camera));
    render(device, scene, pixels);
    memcpy(color, pixels, 3 * sizeof *color);
}

/* A sky of memory: faces of a cube, an octahedron, and a picture by longitude and latitude, shared and changed in place. */
static void skies(etd_device *device) {
    static float cube[6 * 2 * 2 * 3], octahedron[4 * 4 * 3], around[2 * 4 * 3];
    static float *const texels[3] = {around, octahedron, cube};
    static const uint32_t sizes[3][2] = {{4, 2}, {4, 4}, {2, 12}};
    static const double ways[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const char json[] = "{\"etendue\": 1, \"camera\": {\"origin\": [0, 0, 0], \"lookAt\": [0, 0, -1], \"up\": "
                               "[0, 1, 0], \"fieldOfView\": 50}, \"surfaces\": []}";
    uint32_t k, i;
    for (i = 0; i < 6 * 2 * 2 * 3; ++i) {
        cube[i] = 1 + (float)(i / 12); /* the number of the face, from 1 on */
    }
    for (i = 0; i < 4 * 4 * 3; ++i) {
        octahedron[i] = 1 + (float)(i / 3);
    }
    for (i = 0; i < 2 * 4 * 3; ++i) {
        around[i] = 1 + (float)(i / 3);
    }
    for (k = 0; k < 3; ++k) {
        etd_scene *scene = NULL;
        etd_texture texture = ETD_TEXTURE_INIT;
        etd_environment_map map = ETD_ENVIRONMENT_MAP_INIT;
        etd_environment_map same = ETD_ENVIRONMENT_MAP_INIT;
        etd_environment_map wrong = ETD_ENVIRONMENT_MAP_INIT;
        etd_backplate behind = ETD_BACKPLATE_INIT;
        float color[3];
        if (!CHECK_OK(etd_scene_from_json(device, json, strlen(json), NULL, &scene))) {
            return;
        }
        CHECK_OK(etd_scene_get_environment_map(scene, &same));
        CHECK(same.texture == ETD_NONE && same.radiance[1] == 0);
        CHECK_STATUS((wrong.texture = 0, etd_scene_set_environment_map(scene, &wrong)), ETD_INVALID_SCENE);
        texture.texels = texels[k];
        texture.width = sizes[k][0];
        texture.height = sizes[k][1];
        texture.channels = 3;
        texture.texel_format = ETD_TEXEL_FLOAT;
        texture.sharing = ETD_SHARE;
        CHECK_OK(etd_scene_add_texture(scene, NULL, &texture, &map.texture));
        map.projection = k;
        map.radiance[1] = 0.5f;
        CHECK_OK(etd_scene_set_environment_map(scene, &map));
        CHECK_OK(etd_scene_get_environment_map(scene, &same));
        CHECK(same.texture == map.texture && same.projection == k && same.radiance[1] == 0.5f && same.up[1] == 1);
        for (i = 0; i < 6; ++i) {
            /* By longitude and latitude, between four texels at the horizon; at a pole, where one looks from counts. */
            static const float by_angles[6] = {5.5f, 3.5f, 0, 0, 4.5f, 4.5f};
            /* The right edge, the left one, all four of the middle, corners, the lower edge and the upper one. */
            static const float unfolded[6] = {10, 7, 8.5f, 0, 14.5f, 2.5f};
            const float expected = k == ETD_SKY_CUBE ? 1 + (float)i : k == ETD_SKY_OCTAHEDRAL ? unfolded[i] : by_angles[i];
            look(device, scene, ways[i][0], ways[i][1], ways[i][2], color);
            CHECK(fabsf(color[1] - 0.5f * color[0]) <= 1e-5f * color[0]);
            if (expected > 0 && !CHECK(fabsf(color[0] - expected) < 0.1f)) {
                fprintf(stderr, "projection %u, direction %u: %g, not %g\n", k, i, color[0], expected);
            }
        }
        /* Texels that the host changes. */
        for (i = 0; i < sizes[k][0] * sizes[k][1] * 3; ++i) {
            texels[k][i] = 7;
        }
        CHECK_OK(etd_scene_update_texture(scene, map.texture));
        look(device, scene, 0.3, 0.2, -1, color);
        CHECK(fabsf(color[0] - 7) < 1e-4f);
        /* Of one that cameras do not see, nothing is left in the picture. */
        map.hidden = 1;
        CHECK_OK(etd_scene_set_environment_map(scene, &map));
        look(device, scene, 0.3, 0.2, -1, color);
        CHECK(color[0] == 0);
        /* A backplate stands there in its place, from the same memory. */
        behind.texture = map.texture;
        behind.radiance[1] = 0.5f;
        CHECK_OK(etd_scene_set_backplate(scene, &behind));
        look(device, scene, 0.3, 0.2, -1, color);
        CHECK(fabsf(color[0] - 7) < 1e-4f && fabsf(color[1] - 3.5f) < 1e-4f);
        behind.texture = map.texture + 1;
        CHECK_STATUS(etd_scene_set_backplate(scene, &behind), ETD_INVALID_SCENE);
        CHECK_OK(etd_scene_get_backplate(scene, &behind));
        CHECK(behind.texture == map.texture && behind.radiance[1] == 0.5f);
        texture.coordinates = ETD_COORDINATES_BOX;
        CHECK_OK(etd_scene_set_environment_map(scene, NULL));
        CHECK_STATUS(etd_scene_set_texture(scene, map.texture, &texture), ETD_INVALID_SCENE);
        texture.coordinates = ETD_COORDINATES_UV;
        CHECK_OK(etd_scene_set_environment_map(scene, &map));
        CHECK_OK(etd_scene_set_backplate(scene, NULL));
        CHECK_OK(etd_scene_get_backplate(scene, &behind));
        CHECK(behind.texture == ETD_NONE && behind.radiance[0] == 0);
        look(device, scene, 0.3, 0.2, -1, color);
        CHECK(color[0] == 0);
        /* A projection of another shape, and a texture of another shape. */
        wrong = map;
        wrong.projection = k == ETD_SKY_CUBE ? ETD_SKY_OCTAHEDRAL : ETD_SKY_CUBE;
        CHECK_STATUS(etd_scene_set_environment_map(scene, &wrong), ETD_INVALID_SCENE);
        texture.width = texture.height = 1;
        if (k == ETD_SKY_CUBE) {
            CHECK_STATUS(etd_scene_set_texture(scene, map.texture, &texture), ETD_INVALID_SCENE);
        }
        CHECK_OK(etd_scene_set_environment_map(scene, NULL));
        CHECK_OK(etd_scene_get_environment_map(scene, &same));
        CHECK(same.texture == ETD_NONE && same.radiance[0] == 0);
        etd_scene_release(scene);
    }
}

struct told {
    double last;
    int calls;
    int is_sane;
    double end;
};

static int32_t tell(void *user_data, const etd_progress *progress) {
    struct told *told = user_data;
    told->is_sane &= progress->fraction >= told->last && progress->fraction <= 1 && progress->phase == ETD_PHASE_BUILD;
    told->last = progress->fraction;
    ++told->calls;
    return progress->fraction >= told->end;
}

/* A scene with an image is read with progress, and the reading can be stopped. Reports come ten times a second, and at the beginning and
 * the end. */
static void reading(etd_device *device) {
    static const char json[] =
        "{\"etendue\": 1, \"camera\": {\"origin\": [0, 0, 4], \"lookAt\": [0, 0, 0], \"up\": [0, 1, 0], \"fieldOfView\": 50}, "
        "\"textures\": [{\"name\": \"t\", \"type\": \"image\", \"file\": \"reading.bmp\"}], \"surfaces\": []}";
    static const unsigned char header[] = {'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0,
                                           1, 0, 24, 0, 0, 0, 0, 0, 0, 0, 12, 0};
    static const double ends[] = {2, 0};
    FILE *file = fopen("reading.bmp", "wb");
    size_t i;
    if (!CHECK(file != NULL)) {
        return;
    }
    fwrite(header, 1, sizeof header, file);
    for (i = sizeof header; i < 54 + 3 * 512 * 512; ++i) {
        fputc(i < 54 ? 0 : (int)(i % 251), file);
    }
    CHECK(fclose(file) == 0);
    for (i = 0; i < 2; ++i) {
        struct told told = {0, 0, 1, 0};
        etd_scene_options options = ETD_SCENE_OPTIONS_INIT;
        etd_scene *scene = NULL;
        etd_status status;
        told.end = ends[i];
        options.progress = tell;
        options.user_data = &told;
        status = etd_scene_from_json(device, json, strlen(json), &options, &scene);
        CHECK_STATUS(status, i == 0 ? ETD_OK : ETD_CANCELLED);
        CHECK(told.is_sane && (i == 0 ? told.calls >= 2 && told.last == 1 : told.last < 0.8 && scene == NULL));
        etd_scene_release(scene);
    }
    remove("reading.bmp");
}

int main(void) {
    etd_device *device = new_device(1);
    reading(device);
    tangents(device);
    skies(device);
    further_sets(device);
    vertex_colors(device);
    patterns(device);
    formats(device);
    sharing(device);
    memory();
    errors(device);
    etd_device_release(device);
    return check_report("textures");
}
