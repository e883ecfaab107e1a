/* Calls under a real lack of memory: whatever the limit of the address space is, they succeed or are refused by a status, and the process
 * goes on. Each try is a child process with a limit of its own.
 *
 * Usage: memory [CALL KIBIBYTES]: only the call of this number with this much room, to find out where it aborts. */
#define _POSIX_C_SOURCE 200809L
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"

CHECK_MAIN;

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HAS_SHADOW_MEMORY 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_SHADOW_MEMORY 1
#endif

struct stage {
    etd_device *device;
    etd_scene *scene;
    etd_film *film;
    char *text;
    size_t length;
};

/* Bytes of address space of this process. */
static size_t address_space(void) {
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        if (fscanf(file, "%lu", &pages) != 1) {
            pages = 0;
        }
        fclose(file);
    }
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

static void smooth_mesh(struct stage *it, uint32_t n) {
    etd_mesh mesh = ETD_MESH_INIT;
    etd_surface surface = ETD_SURFACE_INIT;
    const size_t vertices = (size_t)n * n, triangles = 2 * (size_t)(n - 1) * (n - 1);
    float *positions = malloc(3 * vertices * sizeof *positions);
    uint32_t *indices = malloc(3 * triangles * sizeof *indices);
    uint32_t x, y, number = 0;
    size_t t = 0;
    if (positions == NULL || indices == NULL) {
        _exit(3);
    }
    for (y = 0; y < n; ++y) {
        for (x = 0; x < n; ++x) {
            float *p = positions + 3 * ((size_t)y * n + x);
            p[0] = 4.0f * (float)x / (float)n - 2.0f;
            p[1] = 0.5f + 0.02f * (float)((x * 7 + y * 13) % 5);
            p[2] = 4.0f * (float)y / (float)n - 2.0f;
        }
    }
    for (y = 0; y + 1 < n; ++y) {
        for (x = 0; x + 1 < n; ++x) {
            const uint32_t a = y * n + x;
            const uint32_t corners[6] = {a, a + n, a + 1, a + 1, a + n, a + n + 1};
            memcpy(indices + t, corners, sizeof corners);
            t += 6;
        }
    }
    mesh.positions = positions;
    mesh.vertex_count = vertices;
    mesh.indices = indices;
    mesh.triangle_count = triangles;
    CHECK_OK(etd_scene_add_mesh(it->scene, &mesh, &number));
    surface.material = 0;
    CHECK_OK(etd_scene_add_mesh_surface(it->scene, number, 1, &surface, &number));
    free(positions);
    free(indices);
}

static void with_mesh(struct stage *it) {
    it->scene = new_scene(it->device);
    smooth_mesh(it, 120);
}

static void with_built_mesh(struct stage *it) {
    with_mesh(it);
    CHECK_OK(etd_scene_commit(it->scene, NULL, NULL));
}

static etd_status commit(struct stage *it) { return etd_scene_commit(it->scene, NULL, NULL); }

static void with_picture(struct stage *it) {
    const etd_render_options options = short_render(1);
    it->scene = new_scene(it->device);
    it->film = new_film(it->device, 256, 256, ETD_LAYER_ALBEDO | ETD_LAYER_NORMAL);
    CHECK_OK(etd_render(it->scene, it->film, &options));
}

static etd_status write_exr(struct stage *it) { return etd_film_write(it->film, "memory.exr", NULL); }

static etd_status write_pfm(struct stage *it) { return etd_film_write(it->film, "memory.pfm", NULL); }

static void with_text(struct stage *it) {
    static const char begin[] =
        "{\"etendue\": 1, \"camera\": {\"origin\": [0, 0, 4], \"lookAt\": [0, 0, 0], \"up\": [0, 1, 0], \"fieldOfView\": 60}, "
        "\"surfaces\": [{\"geometry\": \"mesh\", \"emission\": [1, 1, 1], \"triangles\": [[0, 1, 2]], \"positions\": [";
    static const char end[] = "[0, 0, 0]]}]}";
    const size_t most = sizeof begin + sizeof end + 24 * 40000;
    int i;
    it->text = malloc(most);
    if (it->text == NULL) {
        _exit(3);
    }
    it->length = (size_t)sprintf(it->text, "%s", begin);
    for (i = 0; i < 40000; ++i) {
        it->length += (size_t)sprintf(it->text + it->length, "[%d.5, %d, 0.25], ", i % 200, i / 200);
    }
    it->length += (size_t)sprintf(it->text + it->length, "%s", end);
}

static etd_status read_text(struct stage *it) {
    return etd_scene_from_json(it->device, it->text, it->length, NULL, &it->scene);
}

static void with_film(struct stage *it) {
    with_built_mesh(it);
    it->film = new_film(it->device, 64, 64, 0);
}

static etd_status render_by(struct stage *it, etd_integrator integrator) {
    etd_render_options options = short_render(1);
    options.integrator = integrator;
    options.radiosity_element_size = 2;
    options.photon_count = options.caustic_count = 20000;
    return etd_render(it->scene, it->film, &options);
}

static void with_patches(struct stage *it) {
    it->scene = new_scene(it->device);
    smooth_mesh(it, 24);
    CHECK_OK(etd_scene_commit(it->scene, NULL, NULL));
    it->film = new_film(it->device, 16, 16, 0);
}

static etd_status radiosity(struct stage *it) { return render_by(it, ETD_INTEGRATOR_RADIOSITY); }

static etd_status paths(struct stage *it) { return render_by(it, ETD_INTEGRATOR_PATH); }

static etd_status photons(struct stage *it) { return render_by(it, ETD_INTEGRATOR_PHOTON); }

static etd_status atlas(struct stage *it) {
    etd_atlas_options options = ETD_ATLAS_OPTIONS_INIT;
    etd_atlas *made = NULL;
    options.resolution = 512;
    return etd_atlas_new(it->scene, &options, &made);
}

/* The light of the scene at so many points. */
#define POINTS 20000

static void with_points(struct stage *it) {
    with_patches(it);
    it->length = POINTS;
    it->text = malloc(POINTS * (sizeof(etd_measuring_point) + sizeof(double)));
    if (it->text == NULL) {
        _exit(3);
    }
}

static etd_status measure(struct stage *it) {
    const etd_render_options options = short_render(1);
    etd_measuring_point *points = (etd_measuring_point *)(void *)it->text;
    double *values = (double *)(void *)(points + POINTS);
    size_t i;
    for (i = 0; i < POINTS; ++i) {
        const etd_measuring_point point = {{(double)(i % 100) / 25 - 2, 1, (double)(i / 100) / 50 - 2}, {0, 1, 0}};
        points[i] = point;
    }
    return etd_scene_measure(it->scene, ETD_QUANTITY_ILLUMINANCE, points, POINTS, &options, values, NULL, NULL);
}

/* The arrays take no more memory than the points. */
static etd_status trace_mattes(struct stage *it) {
    enum { SIDE = 150, LEVELS = 6 };
    const etd_render_options options = short_render(1);
    uint32_t *ids = (uint32_t *)(void *)it->text;
    float *coverages = (float *)(void *)(ids + SIDE * SIDE * LEVELS);
    return etd_scene_trace_mattes(it->scene, SIDE, SIDE, &options, ETD_MATTE_OBJECT, LEVELS, ids, coverages);
}

/* A mesh of a file, whose lines are as short as they can be: what is read of it is many times its size. */
static void with_obj(struct stage *it) {
    FILE *file = fopen("memory.obj", "w");
    int i;
    (void)it;
    if (file == NULL) {
        _exit(3);
    }
    for (i = 0; i < 20000; ++i) {
        fprintf(file, "v %d %d 1\n", i % 100, i / 100);
    }
    for (i = 0; i < 40000; ++i) {
        fprintf(file, "f %d %d %d\n", i % 19000 + 1, i % 19000 + 2, i % 19000 + 101);
    }
    fclose(file);
}

static etd_status read_obj(struct stage *it) { return etd_scene_from_file(it->device, "memory.obj", NULL, &it->scene); }

static void nothing(struct stage *it) { (void)it; }

static etd_status film(struct stage *it) {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    options.width = options.height = 512;
    return etd_film_new(it->device, &options, &it->film);
}

static void with_part(struct stage *it) {
    etd_render_options options = short_render(1);
    options.share_number = options.share_count = 1;
    it->scene = new_scene(it->device);
    it->film = new_film(it->device, 256, 256, ETD_LAYER_ALBEDO | ETD_LAYER_NORMAL);
    CHECK_OK(etd_render(it->scene, it->film, &options));
}

static etd_status merge(struct stage *it) {
    etd_film *whole = NULL;
    return etd_film_merge(&it->film, 1, &whole);
}

static etd_status go_on(struct stage *it) {
    etd_render_options options = short_render(2);
    options.resume = it->film;
    return etd_render(it->scene, it->film, &options);
}

static void with_saved_film(struct stage *it) {
    with_part(it);
    CHECK_OK(etd_film_save_memory(it->film, NULL, 0, &it->length));
    it->text = malloc(it->length);
    if (it->text == NULL) {
        _exit(3);
    }
    CHECK_OK(etd_film_save_memory(it->film, it->text, it->length, NULL));
}

static etd_status save(struct stage *it) { return etd_film_save_memory(it->film, it->text, it->length, NULL); }

static etd_status load(struct stage *it) {
    return etd_film_load_memory(it->device, it->text, it->length, NULL, &it->film);
}

static const struct {
    const char *name;
    void (*prepare)(struct stage *it);
    etd_status (*call)(struct stage *it);
} calls[] = {
    {"commit of a smooth mesh", with_mesh, commit}, {"EXR", with_picture, write_exr},       {"PFM", with_picture, write_pfm},
    {"scene of a text", with_text, read_text},      {"radiosity", with_patches, radiosity}, {"paths", with_film, paths},
    {"photons", with_film, photons},                {"atlas", with_patches, atlas},      {"film", nothing, film},
    {"saved film", with_saved_film, save},          {"loaded film", with_saved_film, load}, {"merged film", with_part, merge},
    {"going on", with_part, go_on},                 {"points", with_points, measure},       {"mattes", with_points, trace_mattes},
    {"mesh of a file", with_obj, read_obj},
};

enum { DONE, REFUSED, OTHER, ABORTED };

/* Makes a call in a child with this much room. */
static int try_call(size_t number, size_t room) {
    int status = 0;
    const pid_t child = fork();
    if (child == 0) {
        struct stage it;
        struct rlimit limit;
        etd_status outcome;
        memset(&it, 0, sizeof it);
        check_counts.failed = 0;
        it.device = new_device(1);
        calls[number].prepare(&it);
        if (check_counts.failed > 0) {
            _exit(OTHER);
        }
        limit.rlim_cur = limit.rlim_max = address_space() + room;
        if (setrlimit(RLIMIT_AS, &limit) != 0) {
            _exit(OTHER);
        }
        outcome = calls[number].call(&it);
        if (outcome != ETD_OK && outcome != ETD_OUT_OF_MEMORY) {
            fprintf(stderr, "%s: %s\n", etd_status_name(outcome), etd_last_error_message());
        }
        _exit(outcome == ETD_OK ? DONE : outcome == ETD_OUT_OF_MEMORY ? REFUSED : OTHER);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        return OTHER;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : ABORTED;
}

int main(int argc, char **argv) {
    size_t number, room;
#ifdef HAS_SHADOW_MEMORY
    (void)argc, (void)argv, (void)calls, (void)try_call, (void)number, (void)room;
    CHECK(1); /* what watches the memory has no limit of the address space */
    return check_report("memory");
#else
    if (argc > 2) {
        return try_call((size_t)atoi(argv[1]), (size_t)atoi(argv[2]) << 10);
    }
    for (number = 0; number < sizeof calls / sizeof calls[0]; ++number) {
        int counts[4] = {0, 0, 0, 0}, outcome = OTHER;
        for (room = 512 << 10; outcome != DONE && room < (size_t)1 << 29; room += room / 2) {
            outcome = try_call(number, room);
            counts[outcome & 3]++;
            if (!CHECK(outcome == DONE || outcome == REFUSED)) {
                fprintf(stderr, "  %s, %lu KiB: %s\n", calls[number].name, (unsigned long)(room >> 10),
                        outcome == ABORTED ? "aborted" : "another error");
            }
        }
        CHECK(outcome == DONE);
        printf("%s: %d refused, %d done with %lu KiB\n", calls[number].name, counts[REFUSED], counts[DONE],
               (unsigned long)(room >> 10));
    }
    remove("memory.exr");
    remove("memory.pfm");
    remove("memory.obj");
    return check_report("memory");
#endif
}
