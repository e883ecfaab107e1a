/* Tasks from several threads at once, for ThreadSanitizer: start, poll, wait, cancel, resume, map, copy, edit, release.
 *
 * The library itself is not instrumented, so only what the host does is watched: that the library's calls order the
 * host's memory as they promise (a progress function's writes are seen after the wait, a map's pixels do not change, the
 * arrays of a shared mesh may be freed in their release function). Everything the host shares between threads is hence
 * shared without locks of its own where the interface promises the order. ThreadSanitizer sees that order where it comes
 * from threads that begin and are joined; where it comes from the library's own locks and counters, which it cannot see,
 * HANDED_OVER and TAKEN_OVER say so.
 *
 * Usage: async [ROUNDS] */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

CHECK_MAIN;

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define WATCHED 1
#endif
#endif
#if defined(__SANITIZE_THREAD__) || defined(WATCHED)
void __tsan_acquire(void *address);
void __tsan_release(void *address);
#define HANDED_OVER(address) __tsan_release(address)
#define TAKEN_OVER(address) __tsan_acquire(address)
#else
#define HANDED_OVER(address) ((void)(address))
#define TAKEN_OVER(address) ((void)(address))
#endif

enum { SIDE = 16 };

struct job {
    etd_device *device;
    etd_scene *scene;
    int rounds;
    uint32_t seed;
};

/* Written by a task's functions, read after the wait, without a lock: the wait must order the two. */
struct heard {
    int reports;
    int ends;
    double fraction;
    etd_status status;
    int stop_after;
};

static int32_t hear(void *user_data, const etd_progress *progress) {
    struct heard *heard = user_data;
    heard->reports++;
    heard->fraction = progress->fraction;
    return heard->stop_after > 0 && heard->reports >= heard->stop_after;
}

static void hear_end(void *user_data, etd_status status) {
    struct heard *heard = user_data;
    heard->ends++;
    heard->status = status;
}

static void *run_tasks(void *data) {
    const struct job *job = data;
    uint32_t random = job->seed;
    float first[SIDE * SIDE * 4], second[SIDE * SIDE * 4];
    etd_film *film = new_film(job->device, SIDE, SIDE, ETD_LAYER_SAMPLES);
    int i;
    for (i = 0; i < job->rounds; ++i) {
        struct heard heard = {0, 0, 0, ETD_RUNNING, 0};
        etd_render_options options = short_render(8);
        etd_task *task = NULL;
        etd_map map = ETD_MAP_INIT;
        etd_progress progress = ETD_PROGRESS_INIT;
        etd_status status;
        heard.stop_after = (int)(next_random(&random) % 4);
        options.progress = hear;
        options.finished = hear_end;
        options.user_data = &heard;
        CHECK_OK(etd_render_start(job->scene, film, &options, &task));
        CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &map));
        memcpy(first, map.data, sizeof first);
        status = etd_task_poll(task, &progress);
        CHECK(status == ETD_RUNNING || status == ETD_OK || status == ETD_CANCELLED);
        if (next_random(&random) % 3 == 0) {
            sleep_ms(next_random(&random) % 5);
            CHECK_OK(etd_task_cancel(task));
        }
        status = etd_task_wait(task, -1);
        CHECK(status == ETD_OK || status == ETD_CANCELLED);
        CHECK(heard.ends == 1 && heard.status == status);
        memcpy(second, map.data, sizeof second);
        CHECK(memcmp(first, second, sizeof first) == 0);
        CHECK_OK(etd_film_unmap(film, &map));
        if (status == ETD_CANCELLED) {
            heard.stop_after = 0;
            CHECK_OK(etd_task_resume(task));
            CHECK_OK(etd_task_wait(task, -1));
            CHECK(heard.ends == 2 && heard.status == ETD_OK);
        }
        CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, first, sizeof first, 0));
        etd_task_release(task);
    }
    etd_film_release(film);
    return NULL;
}

/* One task, watched and cancelled by others. */
struct shared_task {
    etd_task *task;
    etd_film *film;
};

static void *watch_task(void *data) {
    struct shared_task *it = data;
    float pixels[SIDE * SIDE * 4];
    etd_status status;
    do {
        etd_progress progress = ETD_PROGRESS_INIT;
        status = etd_task_poll(it->task, &progress);
        CHECK(progress.fraction >= 0 && progress.fraction <= 1);
        CHECK_OK(etd_film_copy(it->film, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels, 0));
        sleep_ms(1);
    } while (status == ETD_RUNNING);
    CHECK(status == ETD_OK || status == ETD_CANCELLED);
    etd_task_release(it->task);
    etd_film_release(it->film);
    return NULL;
}

static void *wait_task(void *data) {
    struct shared_task *it = data;
    const etd_status status = etd_task_wait(it->task, -1);
    CHECK(status == ETD_OK || status == ETD_CANCELLED);
    etd_task_release(it->task);
    etd_film_release(it->film);
    return NULL;
}

static void watched(const struct job *job) {
    int i;
    for (i = 0; i < job->rounds; ++i) {
        struct shared_task it = {NULL, NULL};
        etd_render_options options = short_render(200);
        pthread_t threads[4];
        size_t k;
        it.film = new_film(job->device, SIDE, SIDE, 0);
        CHECK_OK(etd_render_start(job->scene, it.film, &options, &it.task));
        for (k = 0; k < 4; ++k) {
            CHECK_OK(etd_task_retain(it.task));
            CHECK_OK(etd_film_retain(it.film));
            CHECK(pthread_create(&threads[k], NULL, k % 2 == 0 ? watch_task : wait_task, &it) == 0);
        }
        sleep_ms(10);
        CHECK_OK(etd_task_cancel(it.task));
        etd_task_release(it.task);
        etd_film_release(it.film);
        for (k = 0; k < 4; ++k) {
            CHECK(pthread_join(threads[k], NULL) == 0);
        }
    }
}

static void *edit_and_ask(void *data) {
    const struct job *job = data;
    int i;
    for (i = 0; i < job->rounds; ++i) {
        etd_material material = ETD_MATERIAL_INIT;
        etd_ray ray = {{2.5f, 5, 2.5f}, 0, {0, -1, 0}, 100};
        etd_hit hit;
        material.color[0] = 0.01f * (float)(i % 100);
        CHECK_OK(etd_scene_set_material(job->scene, 0, &material));
        CHECK_OK(etd_scene_commit(job->scene, NULL, NULL));
        CHECK_OK(etd_scene_intersect(job->scene, &ray, 1, &hit));
        CHECK(hit.surface == 0);
    }
    return NULL;
}

/* The arrays of a shared mesh may be freed in the release function, whoever was reading them last. */
static void free_arrays(void *user_data) {
    float *positions = user_data;
    TAKEN_OVER(positions);
    positions[0] = -1;
    free(positions);
}

static void *share_meshes(void *data) {
    const struct job *job = data;
    static const uint32_t indices[3] = {0, 1, 2};
    int i;
    for (i = 0; i < job->rounds; ++i) {
        etd_scene *scene = new_scene(job->device);
        etd_film *film = new_film(job->device, 4, 4, 0);
        etd_render_options options = short_render(2);
        etd_task *task = NULL;
        int k;
        uint32_t number = 0, use = 0;
        for (k = 0; k < 3; ++k) {
            etd_mesh mesh = ETD_MESH_INIT;
            etd_surface surface = ETD_SURFACE_INIT;
            float *positions = calloc(12, sizeof *positions);
            if (!CHECK(positions != NULL)) {
                exit(2);
            }
            positions[3] = positions[7] = 1;
            mesh.positions = positions;
            mesh.position_bytes = 12 * sizeof *positions;
            mesh.vertex_count = 3;
            mesh.indices = indices;
            mesh.triangle_count = 1;
            mesh.sharing = ETD_SHARE;
            mesh.release = free_arrays;
            mesh.user_data = positions;
            HANDED_OVER(positions);
            if (k == 0) {
                CHECK_OK(etd_scene_add_mesh(scene, &mesh, &number));
                surface.material = 0;
                CHECK_OK(etd_scene_add_mesh_surface(scene, number, 0, &surface, &use));
                CHECK_OK(etd_render_start(scene, film, &options, &task));
            } else {
                CHECK_OK(etd_scene_set_mesh(scene, number, &mesh));
            }
        }
        etd_scene_release(scene);
        etd_film_release(film);
        CHECK_OK(etd_task_wait(task, -1));
        etd_task_release(task);
    }
    return NULL;
}

int main(int count, char **arguments) {
    struct job jobs[4];
    pthread_t threads[4];
    size_t i;
    const int rounds = count > 1 ? atoi(arguments[1]) : 20;
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    for (i = 0; i < 4; ++i) {
        jobs[i].device = device;
        jobs[i].scene = scene;
        jobs[i].rounds = rounds;
        jobs[i].seed = (uint32_t)i + 1;
    }
    CHECK(pthread_create(&threads[0], NULL, run_tasks, &jobs[0]) == 0);
    CHECK(pthread_create(&threads[1], NULL, run_tasks, &jobs[1]) == 0);
    CHECK(pthread_create(&threads[2], NULL, edit_and_ask, &jobs[2]) == 0);
    CHECK(pthread_create(&threads[3], NULL, share_meshes, &jobs[3]) == 0);
    watched(&jobs[0]);
    for (i = 0; i < 4; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0);
    }
    etd_scene_release(scene);
    etd_device_release(device);
    return check_report("async");
}
