/* A denoised render: the film keeps albedo and normal beside the colour, and Intel Open Image Denoise (OIDN) 2 makes an image
 * without noise of the three. docs/denoising.md says what that does to the error.
 *
 * OIDN is loaded while the program runs, so that the program builds and runs where it is not: the noisy image is then all that
 * there is. A host that is linked with OIDN includes <OpenImageDenoise/oidn.h> in place of the declarations below.
 *
 * Build:  cc -std=c99 denoise.c $(pkg-config --cflags --libs etendue) -ldl -o denoise
 * Run:    ./denoise [SCENE] [--samples N] [--size WIDTH HEIGHT] [--seed N] [--threads N] [--auxiliary none|noisy|prefiltered]
 *             [--reuse] [--output PREFIX] [--oidn LIBRARY]
 *         writes PREFIX-noisy.png and .pfm, and PREFIX-denoised.pfm (floats) and .ppm (sRGB, to look at); LIBRARY is otherwise
 *         that of the environment's OIDN_LIBRARY, or libOpenImageDenoise.so.2, or libOpenImageDenoise.so */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */

#include <dlfcn.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <time.h>

#include "common.h"

/* The part of OIDN's C interface that is needed, with its names and values. */
enum { OIDN_DEVICE_TYPE_DEFAULT = 0, OIDN_ERROR_NONE = 0, OIDN_FORMAT_FLOAT3 = 3 };
typedef struct OIDNDeviceImpl *OIDNDevice;
typedef struct OIDNBufferImpl *OIDNBuffer;
typedef struct OIDNFilterImpl *OIDNFilter;

struct oidn {
    OIDNDevice (*new_device)(int type);
    void (*set_device_int)(OIDNDevice device, const char *name, int value);
    int (*get_device_int)(OIDNDevice device, const char *name);
    int (*get_device_error)(OIDNDevice device, const char **message);
    void (*commit_device)(OIDNDevice device);
    void (*release_device)(OIDNDevice device);
    OIDNBuffer (*new_buffer)(OIDNDevice device, size_t size);
    void (*write_buffer)(OIDNBuffer buffer, size_t offset, size_t size, const void *from);
    void (*read_buffer)(OIDNBuffer buffer, size_t offset, size_t size, void *to);
    void (*release_buffer)(OIDNBuffer buffer);
    OIDNFilter (*new_filter)(OIDNDevice device, const char *type);
    void (*set_filter_image)(OIDNFilter filter, const char *name, OIDNBuffer buffer, int format, size_t width, size_t height,
                             size_t offset, size_t pixel_stride, size_t row_stride);
    void (*set_filter_bool)(OIDNFilter filter, const char *name, bool value);
    void (*commit_filter)(OIDNFilter filter);
    void (*execute_filter)(OIDNFilter filter);
    void (*release_filter)(OIDNFilter filter);
};

/* What OIDN is given of each pixel beside its colour. */
enum auxiliary { AUXILIARY_NONE, AUXILIARY_NOISY, AUXILIARY_PREFILTERED };

/* Layers of a film as OIDN takes them: three floats a pixel. `color` becomes the denoised image. */
struct layers {
    uint32_t width, height;
    float *color, *albedo, *normal;
};

struct settings {
    const char *scene, *output, *library;
    uint32_t samples, width, height, seed, threads;
    enum auxiliary auxiliary;
    bool reuse;
};

/* Writes the address of a function to `function`, a pointer to a pointer to it: by its bytes, since ISO C converts no pointer to
 * an object to one to a function, though POSIX says that both look alike. */
static bool find(void *library, const char *name, void *function) {
    void *address = dlsym(library, name);
    memcpy(function, &address, sizeof address);
    return address != NULL;
}

/* Whether there is a library of this name with all of these functions, which OIDN has from 2.0 on. The library is never closed:
 * its threads may outlive the last call. */
static bool load(struct oidn *oidn, const char *name) {
    void *library = name != NULL ? dlopen(name, RTLD_NOW | RTLD_LOCAL) : NULL;
    return library != NULL && find(library, "oidnNewDevice", &oidn->new_device) &&
           find(library, "oidnSetDeviceInt", &oidn->set_device_int) &&
           find(library, "oidnGetDeviceInt", &oidn->get_device_int) &&
           find(library, "oidnGetDeviceError", &oidn->get_device_error) &&
           find(library, "oidnCommitDevice", &oidn->commit_device) &&
           find(library, "oidnReleaseDevice", &oidn->release_device) &&
           find(library, "oidnNewBuffer", &oidn->new_buffer) &&
           find(library, "oidnWriteBuffer", &oidn->write_buffer) &&
           find(library, "oidnReadBuffer", &oidn->read_buffer) &&
           find(library, "oidnReleaseBuffer", &oidn->release_buffer) &&
           find(library, "oidnNewFilter", &oidn->new_filter) &&
           find(library, "oidnSetFilterImage", &oidn->set_filter_image) &&
           find(library, "oidnSetFilterBool", &oidn->set_filter_bool) &&
           find(library, "oidnCommitFilter", &oidn->commit_filter) &&
           find(library, "oidnExecuteFilter", &oidn->execute_filter) &&
           find(library, "oidnReleaseFilter", &oidn->release_filter);
}

/* The same for the library that the user names, and otherwise for those that are usual. */
static bool load_any(struct oidn *oidn, const char *name) {
    if (name != NULL) {
        return load(oidn, name);
    }
    return load(oidn, getenv("OIDN_LIBRARY")) || load(oidn, "libOpenImageDenoise.so.2") ||
           load(oidn, "libOpenImageDenoise.so");
}

/* Ends the program where a step of OIDN failed. Its calls return no status: the device keeps the first error of the thread, and
 * NULL has that of a device that could not be made. */
static void check(const struct oidn *oidn, OIDNDevice device, const char *step) {
    const char *message = NULL;
    if (oidn->get_device_error(device, &message) != OIDN_ERROR_NONE) {
        fprintf(stderr, "OIDN, %s: %s\n", step, message != NULL ? message : "an error without a message");
        exit(1);
    }
}

static OIDNDevice open_device(const struct oidn *oidn, uint32_t threads) {
    OIDNDevice device = oidn->new_device(OIDN_DEVICE_TYPE_DEFAULT);
    check(oidn, device, "making a device");
    if (threads != 0) {
        oidn->set_device_int(device, "numThreads", (int)threads);
    }
    oidn->commit_device(device);
    check(oidn, device, "starting the device");
    printf("OIDN %d.%d.%d\n", oidn->get_device_int(device, "versionMajor"), oidn->get_device_int(device, "versionMinor"),
           oidn->get_device_int(device, "versionPatch"));
    return device;
}

/* A copy of a layer that the device can read. The pointer itself would do for a processor, but not for most GPUs. */
static OIDNBuffer buffer_of(const struct oidn *oidn, OIDNDevice device, const struct layers *layers, const float *pixels) {
    const size_t size = (size_t)layers->width * layers->height * 3 * sizeof *pixels;
    OIDNBuffer buffer = oidn->new_buffer(device, size);
    check(oidn, device, "making a buffer");
    oidn->write_buffer(buffer, 0, size, pixels);
    check(oidn, device, "copying a layer");
    return buffer;
}

static void set_image(const struct oidn *oidn, OIDNFilter filter, const char *name, OIDNBuffer buffer,
                      const struct layers *layers) {
    oidn->set_filter_image(filter, name, buffer, OIDN_FORMAT_FLOAT3, layers->width, layers->height, 0, 0, 0);
}

static void execute(const struct oidn *oidn, OIDNDevice device, OIDNFilter filter, const char *name) {
    oidn->commit_filter(filter);
    check(oidn, device, name);
    oidn->execute_filter(filter);
    check(oidn, device, name);
    oidn->release_filter(filter);
}

/* Denoises an auxiliary image by itself, in place. */
static void prefilter(const struct oidn *oidn, OIDNDevice device, const char *name, OIDNBuffer buffer,
                      const struct layers *layers) {
    OIDNFilter filter = oidn->new_filter(device, "RT");
    set_image(oidn, filter, name, buffer, layers);
    set_image(oidn, filter, "output", buffer, layers);
    execute(oidn, device, filter, name);
}

/* Denoises the colour of the layers. A host that denoises many images of one size keeps buffers and filters, whose making takes
 * time, and executes them anew. */
static void denoise(const struct oidn *oidn, OIDNDevice device, struct layers *layers, enum auxiliary auxiliary) {
    const size_t size = (size_t)layers->width * layers->height * 3 * sizeof *layers->color;
    OIDNBuffer color = buffer_of(oidn, device, layers, layers->color);
    OIDNBuffer albedo = buffer_of(oidn, device, layers, layers->albedo);
    OIDNBuffer normal = buffer_of(oidn, device, layers, layers->normal);
    OIDNFilter filter;
    if (auxiliary == AUXILIARY_PREFILTERED) {
        prefilter(oidn, device, "albedo", albedo, layers);
        prefilter(oidn, device, "normal", normal, layers);
    }
    filter = oidn->new_filter(device, "RT");
    set_image(oidn, filter, "color", color, layers);
    if (auxiliary != AUXILIARY_NONE) {
        set_image(oidn, filter, "albedo", albedo, layers);
        set_image(oidn, filter, "normal", normal, layers);
    }
    set_image(oidn, filter, "output", color, layers);
    oidn->set_filter_bool(filter, "hdr", true); /* radiance has no upper limit */
    oidn->set_filter_bool(filter, "cleanAux", auxiliary == AUXILIARY_PREFILTERED);
    execute(oidn, device, filter, "color");
    oidn->read_buffer(color, 0, size, layers->color);
    check(oidn, device, "copying the result");
    oidn->release_buffer(color);
    oidn->release_buffer(albedo);
    oidn->release_buffer(normal);
}

static float *room_for(size_t count) {
    float *memory = calloc(count, sizeof *memory);
    if (memory == NULL) {
        fprintf(stderr, "no memory\n");
        exit(1);
    }
    return memory;
}

/* Copies what OIDN needs of the film: as it is, since normals are in [-1, 1] and albedos in [0, 1] already, and both are 0 where
 * a pixel sees nothing. */
static struct layers copy_layers(const etd_film *film) {
    etd_image_options rgb = ETD_IMAGE_OPTIONS_INIT;
    struct layers layers;
    size_t count, size;
    must(etd_film_get_resolution(film, &layers.width, &layers.height));
    count = (size_t)layers.width * layers.height * 3;
    size = count * sizeof(float);
    layers.color = room_for(count);
    layers.albedo = room_for(count);
    layers.normal = room_for(count);
    rgb.format = ETD_FORMAT_RGB_FLOAT; /* without alpha */
    must(etd_film_copy(film, ETD_LAYER_COLOR, &rgb, layers.color, size, 0));
    must(etd_film_copy(film, ETD_LAYER_ALBEDO, NULL, layers.albedo, size, 0));
    must(etd_film_copy(film, ETD_LAYER_NORMAL, NULL, layers.normal, size, 0));
    return layers;
}

static const char *output_path(const struct settings *settings, const char *ending) {
    static char path[4096];
    const int length = snprintf(path, sizeof path, "%s%s", settings->output, ending);
    if (length < 0 || (size_t)length >= sizeof path) {
        fprintf(stderr, "%s is too long\n", settings->output);
        exit(1);
    }
    return path;
}

static FILE *open_output(const char *path) {
    FILE *file = fopen(path, "wb");
    if (file == NULL) {
        fprintf(stderr, "%s cannot be written\n", path);
        exit(1);
    }
    return file;
}

static void close_output(FILE *file) {
    const int failed = ferror(file);
    if (fclose(file) != 0 || failed) {
        fprintf(stderr, "an image could not be written to its end\n");
        exit(1);
    }
}

/* Floats, the bottom row first; the sign of the scale says that the first byte of a float is its last. */
static void write_pfm(const struct settings *settings, const struct layers *layers) {
    const size_t row = 3 * (size_t)layers->width;
    const uint16_t one = 1;
    unsigned char first;
    FILE *file = open_output(output_path(settings, "-denoised.pfm"));
    uint32_t y;
    memcpy(&first, &one, 1);
    fprintf(file, "PF\n%u %u\n%s\n", layers->width, layers->height, first == 1 ? "-1.0" : "1.0");
    for (y = layers->height; y-- > 0;) {
        fwrite(layers->color + y * row, sizeof(float), row, file);
    }
    close_output(file);
}

/* Eight bits of the sRGB curve, as etd_film_write gives a PNG without a tone map. */
static void write_ppm(const struct settings *settings, const struct layers *layers) {
    const size_t count = 3 * (size_t)layers->width * layers->height;
    FILE *file = open_output(output_path(settings, "-denoised.ppm"));
    size_t i;
    fprintf(file, "P6\n%u %u\n255\n", layers->width, layers->height);
    for (i = 0; i < count; ++i) {
        const float value = layers->color[i];
        const float linear = value > 0 ? (value < 1 ? value : 1) : 0;
        const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
        putc((int)(255 * encoded + 0.5f), file);
    }
    close_output(file);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void usage(void) {
    fprintf(stderr, "usage: denoise [SCENE] [--samples N] [--size WIDTH HEIGHT] [--seed N] [--threads N] "
                    "[--auxiliary none|noisy|prefiltered] [--reuse] [--output PREFIX] [--oidn LIBRARY]\n");
    exit(2);
}

static struct settings read_arguments(int count, char **arguments) {
    static const char *const auxiliaries[] = {"none", "noisy", "prefiltered"};
    struct settings settings = {NULL, "denoise", NULL, 16, 320, 240, 0, 0, AUXILIARY_PREFILTERED, false};
    int i;
    for (i = 1; i < count; ++i) {
        const char *name = arguments[i];
        const int left = count - i - 1;
        if (strcmp(name, "--samples") == 0 && left >= 1) {
            settings.samples = number_argument(count, arguments, ++i, 0);
        } else if (strcmp(name, "--size") == 0 && left >= 2) {
            settings.width = number_argument(count, arguments, ++i, 0);
            settings.height = number_argument(count, arguments, ++i, 0);
        } else if (strcmp(name, "--seed") == 0 && left >= 1) {
            settings.seed = number_argument(count, arguments, ++i, 0);
        } else if (strcmp(name, "--threads") == 0 && left >= 1) {
            settings.threads = number_argument(count, arguments, ++i, 0);
        } else if (strcmp(name, "--auxiliary") == 0 && left >= 1) {
            unsigned which = 0;
            ++i;
            while (which < 3 && strcmp(arguments[i], auxiliaries[which]) != 0) {
                ++which;
            }
            if (which == 3) {
                usage();
            }
            settings.auxiliary = (enum auxiliary)which;
        } else if (strcmp(name, "--reuse") == 0) {
            settings.reuse = true;
        } else if (strcmp(name, "--output") == 0 && left >= 1) {
            settings.output = arguments[++i];
        } else if (strcmp(name, "--oidn") == 0 && left >= 1) {
            settings.library = arguments[++i];
        } else if (name[0] != '-' && settings.scene == NULL) {
            settings.scene = name;
        } else {
            usage();
        }
    }
    return settings;
}

int main(int count, char **arguments) {
    const struct settings settings = read_arguments(count, arguments);
    etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
    etd_film_options film_options = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_summary summary = ETD_SUMMARY_INIT;
    etd_device *device = NULL;
    etd_scene *scene = NULL;
    etd_film *film = NULL;
    struct oidn oidn;
    device_options.threads = settings.threads;
    must(etd_device_new(&device_options, &device));
    if (settings.scene != NULL) {
        must(etd_scene_from_file(device, settings.scene, NULL, &scene));
        must(etd_scene_get_render_options(scene, &options));
    } else {
        uint32_t red, ball;
        scene = two_balls(device, &red, &ball);
        look_from(scene, 0, 2.5, 6);
    }
    film_options.width = settings.width;
    film_options.height = settings.height;
    film_options.layers = ETD_LAYER_ALBEDO | ETD_LAYER_NORMAL;
    must(etd_film_new(device, &film_options, &film));
    options.samples = settings.samples;
    options.seed = settings.seed;
    /* Shared hits make the noise of neighbouring pixels alike, and OIDN takes what neighbours have in common for the picture: it
     * would leave clouds on even walls. */
    options.reuse = settings.reuse ? ETD_SWITCH_ON : ETD_SWITCH_OFF;
    must(etd_render(scene, film, &options));
    must(etd_film_get_summary(film, &summary));
    printf("rendered in %.3f s, %u samples a pixel, estimated relMSE %.2e\n", summary.elapsed, summary.samples, summary.rel_mse);
    must(etd_film_write(film, output_path(&settings, "-noisy.png"), NULL));
    must(etd_film_write(film, output_path(&settings, "-noisy.pfm"), NULL));

    if (load_any(&oidn, settings.library)) {
        OIDNDevice denoiser = open_device(&oidn, settings.threads);
        struct layers layers = copy_layers(film);
        const double begin = now();
        denoise(&oidn, denoiser, &layers, settings.auxiliary);
        printf("denoised in %.3f s\n", now() - begin);
        oidn.release_device(denoiser);
        write_pfm(&settings, &layers);
        write_ppm(&settings, &layers);
        free(layers.color);
        free(layers.albedo);
        free(layers.normal);
    } else {
        printf("Open Image Denoise 2 was not found (--oidn or OIDN_LIBRARY may name it), so that only the noisy image was "
               "written.\n");
    }
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    return 0;
}
