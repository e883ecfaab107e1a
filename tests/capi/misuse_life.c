/* Misuse over time: wrong states, every order of release, callbacks that call everything, executors that do as they like,
 * cancelling at any moment, edits and questions while others render. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <stdint.h>

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* A gate that a callback waits at, so that a task is certainly running. */
struct gate {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int reached;
    int open;
};

static void gate_init(struct gate *gate) {
    pthread_mutex_init(&gate->lock, NULL);
    pthread_cond_init(&gate->changed, NULL);
    gate->reached = gate->open = 0;
}

static void gate_drop(struct gate *gate) {
    pthread_cond_destroy(&gate->changed);
    pthread_mutex_destroy(&gate->lock);
}

static int32_t wait_at_gate(void *user_data, const etd_progress *progress) {
    struct gate *gate = user_data;
    (void)progress;
    pthread_mutex_lock(&gate->lock);
    gate->reached = 1;
    pthread_cond_broadcast(&gate->changed);
    while (!gate->open) {
        pthread_cond_wait(&gate->changed, &gate->lock);
    }
    pthread_mutex_unlock(&gate->lock);
    return 0;
}

static void gate_await(struct gate *gate) {
    pthread_mutex_lock(&gate->lock);
    while (!gate->reached) {
        pthread_cond_wait(&gate->changed, &gate->lock);
    }
    pthread_mutex_unlock(&gate->lock);
}

static void gate_open(struct gate *gate) {
    pthread_mutex_lock(&gate->lock);
    gate->open = 1;
    pthread_cond_broadcast(&gate->changed);
    pthread_mutex_unlock(&gate->lock);
}

/* Before anything was built or rendered, and while something is. */
static void wrong_states(void) {
    etd_device *device = new_device(1);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 4, 4, 0);
    etd_film *other = new_film(device, 4, 4, 0);
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    etd_summary summary = ETD_SUMMARY_INIT;
    etd_progress progress = ETD_PROGRESS_INIT;
    etd_map map = ETD_MAP_INIT, copy, second = ETD_MAP_INIT;
    etd_render_options options = short_render(2);
    etd_render_options gated = short_render(2);
    etd_task *task = NULL, *none = NULL;
    struct gate gate;
    etd_ray ray = {{0, 5, 0}, 0, {0, -1, 0}, 100};
    etd_hit hit;
    uint8_t answer = 9;
    size_t needed = 77;

    memset(&hit, 0x5a, sizeof hit);
    CHECK_STATUS(etd_scene_get_info(scene, &info), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_scene_copy_text(scene, ETD_TEXT_INFO, NULL, 0, &needed), ETD_INVALID_OPERATION);
    CHECK(needed == 77);
    CHECK_OK(etd_scene_copy_text(scene, ETD_TEXT_WARNINGS, NULL, 0, &needed));
    CHECK_STATUS(etd_scene_intersect(scene, &ray, 1, &hit), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_scene_occluded(scene, &ray, 1, &answer), ETD_INVALID_OPERATION);
    CHECK(answer == 9 && hit.surface == 0x5a5a5a5au);
    CHECK_STATUS(etd_film_get_summary(film, &summary), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_write(film, "misuse.png", NULL), ETD_INVALID_OPERATION);
    CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &map)); /* black, but there */
    CHECK(map.samples == 0 && map.width == 4 && map.height == 4 && map.channels == 4 && map.data[0] == 0.0f);
    copy = map;
    CHECK_STATUS(etd_film_unmap(other, &copy), ETD_INVALID_OPERATION);
    CHECK_OK(etd_film_unmap(film, &map));
    CHECK(map.data == NULL);
    CHECK_STATUS(etd_film_unmap(film, &map), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_unmap(film, &copy), ETD_INVALID_OPERATION);

    /* While a task fills it, a film is nobody else's. */
    gate_init(&gate);
    gated.progress = wait_at_gate;
    gated.user_data = &gate;
    CHECK_OK(etd_render_start(scene, film, &gated, &task));
    gate_await(&gate);
    CHECK_STATUS(etd_task_poll(task, &progress), ETD_RUNNING);
    CHECK_STATUS(etd_task_wait(task, 0), ETD_RUNNING);
    CHECK_STATUS(etd_task_wait(task, 0.001), ETD_RUNNING);
    CHECK_STATUS(etd_task_resume(task), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_render(scene, film, &options), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_render_start(scene, film, &options, &none), ETD_INVALID_OPERATION);
    CHECK(none == NULL);
    CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &map));
    CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &second));
    CHECK(map.id != second.id);
    CHECK_OK(etd_film_unmap(film, &second));
    /* References that are given back now are not missed. */
    etd_film_release(film);
    etd_scene_release(scene);
    gate_open(&gate);
    CHECK_OK(etd_task_wait(task, -1));
    CHECK_OK(etd_task_wait(task, -1));
    CHECK_OK(etd_task_poll(task, &progress));
    CHECK(progress.fraction == 1.0 && progress.phase == ETD_PHASE_END && progress.samples_done == 2);
    CHECK_OK(etd_task_cancel(task)); /* too late, and harmless */
    CHECK_OK(etd_task_poll(task, NULL));
    etd_task_release(task);
    etd_film_release(other);
    etd_device_release(device);
    gate_drop(&gate);
}

/* A device, a scene, a film, a task and a map go in each of the 24 orders of the first four, the task running or not. */
static void every_order(void) {
    int order, running;
    for (running = 0; running < 2; ++running) {
        for (order = 0; order < 24; ++order) {
            int left[4] = {0, 1, 2, 3};
            int rest = order, step;
            etd_device *device = new_device(running ? 2 : 1);
            etd_scene *scene = new_scene(device);
            etd_film *film = new_film(device, 8, 8, 0);
            etd_render_options options = short_render(running ? 100000 : 1);
            etd_task *task = NULL;
            etd_map map = ETD_MAP_INIT;
            CHECK_OK(etd_render_start(scene, film, &options, &task));
            if (!running) {
                CHECK_OK(etd_task_wait(task, -1));
            }
            CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &map)); /* never ended */
            for (step = 0; step < 4; ++step) {
                const int places = 4 - step;
                const int at = rest % places;
                const int which = left[at];
                rest /= places;
                memmove(left + at, left + at + 1, (size_t)(places - at - 1) * sizeof *left);
                switch (which) {
                    case 0: etd_device_release(device); break;
                    case 1: etd_scene_release(scene); break;
                    case 2: etd_film_release(film); break;
                    default: etd_task_release(task); break;
                }
            }
        }
    }
}

static void many_lives(int cycles) {
    int i;
    for (i = 0; i < cycles; ++i) {
        etd_device *device = new_device(i % 16 == 0 ? 2 : 1);
        etd_scene *scene = NULL;
        etd_film *film = new_film(device, 2, 2, i % 256);
        CHECK_OK(etd_device_retain(device));
        etd_device_release(device);
        CHECK_OK(etd_scene_new(device, NULL, &scene));
        CHECK_OK(etd_scene_retain(scene));
        CHECK_OK(etd_film_retain(film));
        etd_scene_release(scene);
        etd_film_release(film);
        etd_film_release(film);
        etd_scene_release(scene);
        etd_device_release(device);
    }
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Callbacks that call */

struct caller {
    etd_device *device;
    etd_scene *scene;
    etd_film *film;
    etd_task *task;
    pthread_mutex_t lock;
    int calls, ends, releases_itself;
    etd_status ended_with;
};

/* What needs no waiting for the work itself is allowed. */
static void call_everything(struct caller *it, int building) {
    etd_film *film = NULL;
    etd_film_options film_options = ETD_FILM_OPTIONS_INIT;
    etd_render_options options = short_render(1);
    etd_render_options own = ETD_RENDER_OPTIONS_INIT;
    etd_progress progress = ETD_PROGRESS_INIT;
    etd_material material = ETD_MATERIAL_INIT;
    etd_map map = ETD_MAP_INIT;
    etd_scene *scene = NULL;
    etd_ray ray = {{0, 5, 0}, 0, {0, -1, 0}, 100};
    etd_hit hit;
    char text[64];
    float pixels[8 * 8 * 4];
    etd_status status;

    CHECK_OK(etd_film_map(it->film, ETD_LAYER_COLOR, &map));
    CHECK_OK(etd_film_copy(it->film, ETD_LAYER_COLOR, NULL, pixels, sizeof pixels, 0));
    CHECK_OK(etd_film_unmap(it->film, &map));
    CHECK_OK(etd_scene_get_render_options(it->scene, &own));
    CHECK_OK(etd_scene_set_material(it->scene, 0, &material));
    status = etd_scene_intersect(it->scene, &ray, 1, &hit);
    CHECK(status == ETD_OK || (building && status == ETD_INVALID_OPERATION));
    CHECK_STATUS(etd_render(it->scene, it->film, &options), ETD_INVALID_OPERATION);
    CHECK_OK(etd_scene_retain(it->scene));
    etd_scene_release(it->scene);
    etd_scene_status(it->scene, text, sizeof text);
    if (it->task != NULL) {
        CHECK_STATUS(etd_task_poll(it->task, &progress), ETD_RUNNING);
        CHECK_STATUS(etd_task_wait(it->task, -1), ETD_INVALID_OPERATION);
        CHECK_STATUS(etd_task_wait(it->task, 0), ETD_INVALID_OPERATION);
        CHECK_STATUS(etd_task_resume(it->task), ETD_INVALID_OPERATION);
        CHECK_OK(etd_task_retain(it->task));
        etd_task_release(it->task);
    }
    if (building) {
        /* The build that it is called by is what it would wait for. */
        CHECK_STATUS(etd_scene_commit(it->scene, NULL, NULL), ETD_INVALID_OPERATION);
    } else {
        CHECK_OK(etd_scene_commit(it->scene, NULL, NULL));
    }
    /* Something else altogether may be built and rendered in here. */
    CHECK_OK(etd_scene_new(it->device, NULL, &scene));
    film_options.width = film_options.height = 2;
    CHECK_OK(etd_film_new(it->device, &film_options, &film));
    CHECK_OK(etd_render(scene, film, &options));
    etd_film_release(film);
    etd_scene_release(scene);
}

static int32_t calling_progress(void *user_data, const etd_progress *progress) {
    struct caller *it = user_data;
    pthread_mutex_lock(&it->lock); /* held until the task's handle is there */
    pthread_mutex_unlock(&it->lock);
    it->calls++;
    if (it->calls <= 6) {
        call_everything(it, progress->phase == ETD_PHASE_BUILD);
    }
    return 0;
}

static void calling_end(void *user_data, etd_status status) {
    struct caller *it = user_data;
    it->ends++;
    it->ended_with = status;
    CHECK_STATUS(etd_task_wait(it->task, -1), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_task_resume(it->task), ETD_INVALID_OPERATION);
    CHECK_OK(etd_task_cancel(it->task));
    if (it->releases_itself) {
        etd_task_release(it->task);
    }
}

static int32_t commit_again(void *user_data, const etd_progress *progress) {
    struct caller *it = user_data;
    (void)progress;
    it->calls++;
    CHECK_STATUS(etd_scene_commit(it->scene, NULL, NULL), ETD_INVALID_OPERATION);
    return 0;
}

static int32_t stop(void *user_data, const etd_progress *progress) {
    (void)progress;
    if (user_data != NULL) {
        ++*(int *)user_data;
    }
    return 1;
}

static int32_t release_task(void *user_data, const etd_progress *progress) {
    struct caller *it = user_data;
    (void)progress;
    pthread_mutex_lock(&it->lock);
    pthread_mutex_unlock(&it->lock);
    if (it->task != NULL) {
        etd_task_release(it->task); /* the last reference: it is cancelled, and not waited for */
        it->task = NULL;
    }
    return 0;
}

static void note_end(void *user_data, etd_status status) {
    struct caller *it = user_data;
    pthread_mutex_lock(&it->lock);
    it->ends++;
    it->ended_with = status;
    pthread_mutex_unlock(&it->lock);
}

static void callbacks(uint32_t threads) {
    struct caller it;
    etd_render_options options = short_render(3);
    etd_film *film;
    int stops = 0;
    memset(&it, 0, sizeof it);
    pthread_mutex_init(&it.lock, NULL);
    it.device = new_device(threads);
    it.scene = new_scene(it.device);
    it.film = new_film(it.device, 8, 8, 0);

    /* Of a render on this thread. */
    options.progress = calling_progress;
    options.user_data = &it;
    CHECK_OK(etd_render(it.scene, it.film, &options));
    CHECK(it.calls > 0);

    /* Of a task, with the end. */
    it.calls = 0;
    options.finished = calling_end;
    pthread_mutex_lock(&it.lock);
    CHECK_OK(etd_render_start(it.scene, it.film, &options, &it.task));
    pthread_mutex_unlock(&it.lock);
    CHECK_OK(etd_task_wait(it.task, -1));
    CHECK(it.calls > 0 && it.ends == 1 && it.ended_with == ETD_OK);
    etd_task_release(it.task);

    /* Of a build. */
    {
        uint32_t mesh;
        add_grid(it.scene, 60, &mesh);
    }
    it.calls = 0;
    CHECK_OK(etd_scene_commit(it.scene, commit_again, &it));
    CHECK(it.calls > 0);

    /* Cancelled by the answer. */
    options = short_render(50);
    options.progress = stop;
    options.user_data = &stops;
    CHECK_STATUS(etd_render(it.scene, it.film, &options), ETD_CANCELLED);
    CHECK(stops == 1);
    {
        uint32_t mesh;
        add_grid(it.scene, 60, &mesh); /* a change so small that there is nothing to report cannot be cancelled either */
        CHECK_STATUS(etd_scene_commit(it.scene, stop, NULL), ETD_CANCELLED);
        CHECK_OK(etd_scene_commit(it.scene, NULL, NULL));
    }

    /* The last reference to a task goes in a function of the task. */
    film = new_film(it.device, 8, 8, 0);
    options = short_render(100000);
    options.progress = release_task;
    options.finished = note_end;
    options.user_data = &it;
    it.ends = 0;
    pthread_mutex_lock(&it.lock);
    CHECK_OK(etd_render_start(it.scene, film, &options, &it.task));
    pthread_mutex_unlock(&it.lock);
    for (;;) {
        int ends;
        pthread_mutex_lock(&it.lock);
        ends = it.ends;
        pthread_mutex_unlock(&it.lock);
        if (ends > 0) {
            break;
        }
        sleep_ms(1);
    }
    CHECK(it.ended_with == ETD_CANCELLED);
    etd_film_release(film);

    etd_film_release(it.film);
    etd_scene_release(it.scene);
    etd_device_release(it.device);
    pthread_mutex_destroy(&it.lock);
}

/* Log and error functions that call as well. */
struct listener {
    etd_device *device;
    pthread_mutex_t lock;
    int logs, errors, inside_errors;
};

static void listen_log(void *user_data, etd_log_level level, const char *message) {
    struct listener *it = user_data;
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    etd_film *film = NULL;
    CHECK(level == ETD_LOG_WARNING || level == ETD_LOG_INFO);
    CHECK(message != NULL && message[0] != 0);
    pthread_mutex_lock(&it->lock);
    it->logs++;
    pthread_mutex_unlock(&it->lock);
    if (it->device != NULL) {
        options.width = options.height = 1;
        CHECK_OK(etd_film_new(it->device, &options, &film));
        etd_film_release(film);
    }
}

static void listen_error(void *user_data, etd_status status, const char *message) {
    struct listener *it = user_data;
    CHECK(status != ETD_OK && message != NULL && message[0] != 0);
    pthread_mutex_lock(&it->lock);
    it->errors++;
    pthread_mutex_unlock(&it->lock);
    /* Fails as well, and is not reported: there would be no end of it. */
    CHECK_STATUS(etd_film_new(it->device, NULL, NULL), ETD_INVALID_ARGUMENT);
}

/* What a progress function was told: how soon after each other, and when the first image came. */
struct pace {
    etd_progress last;
    unsigned long calls;
    unsigned long hasty;
    unsigned long until_image;
};

static int32_t take_time(void *user_data, const etd_progress *progress) {
    struct pace *it = user_data;
    it->hasty += it->calls > 0 && progress->phase == it->last.phase && progress->images == it->last.images &&
                 progress->fraction < 1 && progress->elapsed < it->last.elapsed + 0.099;
    it->hasty += progress->fraction < it->last.fraction;
    it->last = *progress;
    it->calls++;
    if (progress->phase == ETD_PHASE_RENDER && it->until_image == 0 && it->last.images > 0) {
        it->until_image = it->calls;
    }
    return it->until_image > 0 || (progress->phase == ETD_PHASE_RENDER && it->calls > 600);
}

/* Reports come ten times a second, and the first image of a large film before its first pass is done. */
static void paces(void) {
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 1500, 1500, 0);
    etd_render_options options = short_render(16);
    struct pace seen;
    uint32_t mesh;
    memset(&seen, 0, sizeof seen);
    add_grid(scene, 300, &mesh);
    CHECK_OK(etd_scene_commit(scene, take_time, &seen));
    CHECK(seen.calls > 0 && seen.hasty == 0);
    memset(&seen, 0, sizeof seen);
    options.progress = take_time;
    options.user_data = &seen;
    CHECK_STATUS(etd_render(scene, film, &options), ETD_CANCELLED);
    CHECK(seen.hasty == 0);
    /* How many calls come before is a matter of the machine. */
    if (!CHECK(seen.until_image > 0 && seen.last.samples_done == 0)) {
        fprintf(stderr, "  the image came with call %lu, after %.2f s and %u samples\n", seen.until_image, seen.last.elapsed,
                (unsigned)seen.last.samples_done);
    }
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
}

static void listeners(void) {
    struct listener it;
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_render_options render = ETD_RENDER_OPTIONS_INIT;
    etd_scene *scene;
    etd_film *film;
    etd_task *task = NULL;
    int run;
    memset(&it, 0, sizeof it);
    pthread_mutex_init(&it.lock, NULL);
    options.threads = 2;
    options.log = listen_log;
    options.error = listen_error;
    options.user_data = &it;
    CHECK_OK(etd_device_new(&options, &it.device));
    scene = new_scene(it.device);
    film = new_film(it.device, 4, 4, 0);
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    CHECK(it.logs > 0);
    CHECK(it.errors == 0);
    CHECK_STATUS(etd_scene_set_camera(scene, NULL), ETD_INVALID_ARGUMENT);
    CHECK(it.errors == 1);
    CHECK(strstr(etd_last_error_message(), "camera") != NULL); /* not that of the call in the callback */
    CHECK_STATUS(etd_film_write(film, "x.png", NULL), ETD_INVALID_OPERATION);
    CHECK(it.errors == 2);
    /* However often a task is asked, it reports once how a run ended. */
    render.samples = 1u << 20;
    for (run = 0; run < 2; ++run) {
        const int errors = it.errors;
        if (run == 0) {
            CHECK_OK(etd_render_start(scene, film, &render, &task));
        } else {
            CHECK_OK(etd_task_resume(task));
        }
        CHECK_STATUS(etd_task_poll(task, NULL), ETD_RUNNING);
        CHECK(it.errors == errors);
        CHECK_OK(etd_task_cancel(task));
        CHECK_STATUS(etd_task_wait(task, -1), ETD_CANCELLED);
        CHECK(it.errors == errors + 1);
        CHECK_STATUS(etd_film_new(NULL, NULL, NULL), ETD_INVALID_ARGUMENT);
        CHECK_STATUS(etd_task_poll(task, NULL), ETD_CANCELLED);
        CHECK(strstr(etd_last_error_message(), "cancelled") != NULL);
        CHECK_STATUS(etd_task_wait(task, 1), ETD_CANCELLED);
        CHECK(it.errors == errors + 1);
        CHECK_STATUS(etd_task_status(task, NULL, 0), ETD_CANCELLED);
        CHECK_STATUS(etd_task_poll(task, NULL), ETD_CANCELLED);
        CHECK_OK(etd_task_status(task, NULL, 0));
    }
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(it.device);
    pthread_mutex_destroy(&it.lock);
}

/* A host that wants warnings alone hears nothing else. */
static void only_warnings(void) {
    struct listener it;
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_render_options render = ETD_RENDER_OPTIONS_INIT;
    etd_scene *scene;
    etd_film *film;
    CHECK(options.log_choice == ETD_LOG_ALL);
    memset(&it, 0, sizeof it);
    pthread_mutex_init(&it.lock, NULL);
    options.threads = 1;
    options.log_choice = ETD_LOG_WARNINGS_ONLY;
    options.log = listen_log;
    options.user_data = &it;
    CHECK_OK(etd_device_new(&options, &it.device));
    scene = new_scene(it.device);
    film = new_film(it.device, 4, 4, 0);
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    CHECK(it.logs == 0);
    render.samples = 1;
    render.max_depth = 1; /* the image is too dark */
    CHECK_OK(etd_render(scene, film, &render));
    CHECK(it.logs > 0);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(it.device);
    pthread_mutex_destroy(&it.lock);
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Executors of the host */

enum { LATE, AT_ONCE, REVERSE, EXECUTORS };
#define MOST_WORK 4096

struct executor {
    int kind;
    pthread_mutex_t lock;
    pthread_t thread;
    etd_work_fn work[MOST_WORK];
    void *arguments[MOST_WORK];
    size_t count, taken;
    int stops;
};

static void submit(void *user_data, etd_work_fn work, void *argument) {
    struct executor *it = user_data;
    if (it->kind == AT_ONCE) {
        work(argument);
        return;
    }
    pthread_mutex_lock(&it->lock);
    if (!CHECK(it->count < MOST_WORK)) {
        exit(2);
    }
    it->work[it->count] = work;
    it->arguments[it->count] = argument;
    it->count++;
    it->taken++;
    pthread_mutex_unlock(&it->lock);
}

static void *execute(void *data) {
    struct executor *it = data;
    for (;;) {
        etd_work_fn work = NULL;
        void *argument = NULL;
        int stops;
        sleep_ms(it->kind == LATE ? 5 : 1);
        pthread_mutex_lock(&it->lock);
        stops = it->stops;
        if (it->count > 0) {
            const size_t at = it->kind == REVERSE ? it->count - 1 : 0;
            work = it->work[at];
            argument = it->arguments[at];
            it->count--;
            memmove(it->work + at, it->work + at + 1, (it->count - at) * sizeof *it->work);
            memmove(it->arguments + at, it->arguments + at + 1, (it->count - at) * sizeof *it->arguments);
        }
        pthread_mutex_unlock(&it->lock);
        if (work != NULL) {
            work(argument);
        } else if (stops) {
            return NULL;
        }
    }
}

static void executors(void) {
    enum { SIDE = 64 }; /* several tiles, or there is nothing to hand out */
    static float wanted[SIDE * SIDE * 4], got[SIDE * SIDE * 4];
    etd_render_options options = short_render(1);
    int kind;
    {
        etd_device *device = new_device(1);
        etd_scene *scene = new_scene(device);
        etd_film *film = new_film(device, SIDE, SIDE, 0);
        CHECK_OK(etd_render(scene, film, &options));
        CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, wanted, sizeof wanted, 0));
        etd_film_release(film);
        etd_scene_release(scene);
        etd_device_release(device);
    }
    for (kind = 0; kind < EXECUTORS; ++kind) {
        static struct executor it;
        etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
        etd_device *device = NULL;
        etd_scene *scene;
        etd_film *film;
        etd_task *task = NULL;
        memset(&it, 0, sizeof it);
        it.kind = kind;
        pthread_mutex_init(&it.lock, NULL);
        CHECK(pthread_create(&it.thread, NULL, execute, &it) == 0);
        device_options.threads = 3;
        device_options.submit = submit;
        device_options.user_data = &it;
        CHECK_OK(etd_device_new(&device_options, &device));
        scene = new_scene(device);
        film = new_film(device, SIDE, SIDE, 0);
        CHECK_OK(etd_render(scene, film, &options));
        CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, got, sizeof got, 0));
        CHECK(memcmp(wanted, got, sizeof got) == 0);
        CHECK(kind == AT_ONCE || it.taken > 0);
        memset(got, 0, sizeof got);
        CHECK_OK(etd_render_start(scene, film, &options, &task));
        CHECK_OK(etd_task_wait(task, -1));
        CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, got, sizeof got, 0));
        CHECK(memcmp(wanted, got, sizeof got) == 0);
        etd_task_release(task);
        /* Nothing of the device is held while what was handed out may still be run. */
        etd_film_release(film);
        etd_scene_release(scene);
        pthread_mutex_lock(&it.lock);
        it.stops = 1;
        pthread_mutex_unlock(&it.lock);
        CHECK(pthread_join(it.thread, NULL) == 0);
        etd_device_release(device);
        pthread_mutex_destroy(&it.lock);
    }
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Any moment */

/* A function of a task may use its handle for as long as the last release has not returned. */
struct handle {
    pthread_mutex_t lock;
    etd_task *task;
    int inside;
};

static int32_t use_handle(void *user_data, const etd_progress *progress) {
    struct handle *handle = user_data;
    etd_task *task;
    pthread_mutex_lock(&handle->lock);
    task = handle->task;
    handle->inside = 1;
    pthread_mutex_unlock(&handle->lock);
    if (task != NULL && progress->phase == ETD_PHASE_RENDER) {
        sleep_ms(20);
        (void)etd_task_poll(task, NULL);
        CHECK_OK(etd_task_cancel(task));
        (void)etd_task_status(task, NULL, 0);
    }
    return 0;
}

static void handles_live_until_released(void) {
    struct handle handle = {PTHREAD_MUTEX_INITIALIZER, NULL, 0};
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 32, 32, 0);
    etd_render_options options = short_render(1u << 20);
    etd_task *task = NULL;
    int inside = 0;
    options.progress = use_handle;
    options.user_data = &handle;
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    pthread_mutex_lock(&handle.lock);
    handle.task = task;
    handle.inside = 0;
    pthread_mutex_unlock(&handle.lock);
    while (!inside) {
        sleep_ms(1);
        pthread_mutex_lock(&handle.lock);
        inside = handle.inside;
        pthread_mutex_unlock(&handle.lock);
    }
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
}

/* While one thread cancels and resumes, another that waits is never told that a task without an end has ended well. */
struct waiting {
    etd_task *task;
    pthread_mutex_t lock;
    int stop;
};

static void *wait_often(void *argument) {
    struct waiting *waiting = argument;
    int stop = 0;
    while (!stop) {
        const etd_status status = etd_task_wait(waiting->task, 0.001);
        CHECK(status == ETD_RUNNING || status == ETD_CANCELLED);
        /* Others want to run too, where only one thread runs at a time. */
        sleep_ms(0.1);
        pthread_mutex_lock(&waiting->lock);
        stop = waiting->stop;
        pthread_mutex_unlock(&waiting->lock);
    }
    return NULL;
}

static void waiting_beside_resuming(int times) {
    struct waiting waiting = {NULL, PTHREAD_MUTEX_INITIALIZER, 0};
    etd_device *device = new_device(1);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 8, 8, 0);
    etd_render_options options = short_render(1u << 30);
    pthread_t thread;
    int i;
    CHECK_OK(etd_render_start(scene, film, &options, &waiting.task));
    pthread_create(&thread, NULL, wait_often, &waiting);
    for (i = 0; i < times; ++i) {
        CHECK_OK(etd_task_cancel(waiting.task));
        CHECK_STATUS(etd_task_wait(waiting.task, -1), ETD_CANCELLED);
        CHECK_OK(etd_task_resume(waiting.task));
        if (i % 10 == 0) {
            sleep_ms(3);
        }
    }
    CHECK_OK(etd_task_cancel(waiting.task));
    pthread_mutex_lock(&waiting.lock);
    waiting.stop = 1;
    pthread_mutex_unlock(&waiting.lock);
    pthread_join(thread, NULL);
    etd_task_release(waiting.task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
}

/* What belongs to one film or device is told from what belongs to another. */
static void mixed_up(void) {
    etd_device *device = new_device(1), *other = new_device(1);
    etd_scene *scene = new_scene(device);
    etd_film *one = new_film(device, 8, 8, 0), *two = new_film(device, 8, 8, 0), *foreign = new_film(other, 8, 8, 0);
    etd_render_options options = short_render(1);
    etd_map map_one = ETD_MAP_INIT, map_two = ETD_MAP_INIT;
    CHECK_OK(etd_film_map(one, ETD_LAYER_COLOR, &map_one));
    CHECK_OK(etd_film_map(two, ETD_LAYER_COLOR, &map_two));
    CHECK_STATUS(etd_film_unmap(two, &map_one), ETD_INVALID_OPERATION);
    CHECK_OK(etd_film_unmap(two, &map_two));
    CHECK_OK(etd_film_unmap(one, &map_one));
    CHECK_STATUS(etd_render(scene, foreign, &options), ETD_INVALID_ARGUMENT);
    etd_film_release(foreign);
    etd_film_release(two);
    etd_film_release(one);
    etd_scene_release(scene);
    etd_device_release(other);
    etd_device_release(device);
}

/* Work that the host has queued and not run keeps nothing alive; run at last, it finds nothing to do. */
struct queue {
    etd_work_fn work[64];
    void *argument[64];
    int count;
};

static void enqueue(void *user_data, etd_work_fn work, void *argument) {
    struct queue *queue = user_data;
    CHECK(queue->count < 64);
    queue->work[queue->count] = work;
    queue->argument[queue->count++] = argument;
}

static void count_release(void *user_data);

static void queued_work_keeps_nothing(void) {
    static const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t indices[3] = {0, 1, 2};
    struct queue queue = {{NULL}, {NULL}, 0};
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_device *device = NULL;
    etd_scene *scene;
    etd_film *film;
    etd_task *task = NULL;
    etd_mesh mesh = ETD_MESH_INIT;
    etd_surface surface = ETD_SURFACE_INIT;
    etd_render_options render = short_render(1);
    uint32_t mesh_number, number;
    uint64_t used = 1;
    int released = 0, i;
    options.threads = 3;
    options.submit = enqueue;
    options.user_data = &queue;
    CHECK_OK(etd_device_new(&options, &device));
    scene = new_scene(device);
    film = new_film(device, 64, 64, 0);
    mesh.positions = positions;
    mesh.position_bytes = sizeof positions;
    mesh.vertex_count = 3;
    mesh.indices = indices;
    mesh.triangle_count = 1;
    mesh.sharing = ETD_SHARE;
    mesh.release = count_release;
    mesh.user_data = &released;
    surface.material = 0;
    CHECK_OK(etd_scene_add_mesh(scene, &mesh, &mesh_number));
    CHECK_OK(etd_scene_add_mesh_surface(scene, mesh_number, 0, &surface, &number));
    CHECK_OK(etd_render(scene, film, &render));
    /* A task whose beginning is still queued can be cancelled and released. */
    CHECK_OK(etd_render_start(scene, film, &render, &task));
    CHECK_STATUS(etd_task_wait(task, 0.001), ETD_RUNNING);
    CHECK_OK(etd_task_cancel(task));
    CHECK_STATUS(etd_task_wait(task, -1), ETD_CANCELLED);
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    CHECK(queue.count > 0 && released == 1);
    CHECK_OK(etd_device_memory(device, &used, NULL));
    CHECK(used == 0);
    for (i = 0; i < queue.count; ++i) {
        queue.work[i](queue.argument[i]);
    }
    etd_device_release(device);
    CHECK(released == 1);
}

static void cancel_any_time(int moments) {
    uint32_t random = 12345;
    int i;
    etd_device *device = new_device(2);
    for (i = 0; i < moments; ++i) {
        etd_scene *scene = new_scene(device);
        etd_film *film = new_film(device, 16, 16, ETD_LAYER_DEPTH);
        etd_render_options options = short_render(64);
        etd_map map = ETD_MAP_INIT;
        etd_task *task = NULL;
        etd_status status;
        uint32_t mesh;
        const double wait = (double)(next_random(&random) % 1000) / 1000 * 20;
        add_grid(scene, 80, &mesh);
        CHECK_OK(etd_render_start(scene, film, &options, &task));
        if (i % 5 != 0) {
            sleep_ms(wait);
        }
        CHECK_OK(etd_task_cancel(task));
        status = etd_task_wait(task, -1);
        CHECK(status == ETD_OK || status == ETD_CANCELLED);
        CHECK_OK(etd_film_map(film, ETD_LAYER_COLOR, &map));
        CHECK_OK(etd_film_unmap(film, &map));
        if (i % 3 == 0) {
            CHECK_OK(etd_task_resume(task));
            if (i % 2 == 0) {
                CHECK_OK(etd_task_wait(task, -1));
            }
        }
        etd_task_release(task);
        etd_film_release(film);
        etd_scene_release(scene);
    }
    {
        etd_device_info info = ETD_DEVICE_INFO_INIT;
        CHECK_OK(etd_device_get_info(device, &info));
        CHECK(info.threads == 2 && info.build_threads == 2 && info.memory_limit == 0 && info.reserved == 0);
        CHECK(info.embree_version >= 40300 && info.embree_version < 50000);
        CHECK(info.instruction_set != NULL && strlen(info.instruction_set) >= 3);
    }
    {
        uint64_t used = 1, peak = 0;
        CHECK_OK(etd_device_memory(device, &used, &peak));
        CHECK(used == 0 && peak > 0);
    }
    etd_device_release(device);
}

/* A task that was cancelled and resumed comes to the image of one that was not. */
static void resume_to_the_same(void) {
    enum { SIDE = 16 };
    float wanted[SIDE * SIDE * 4], got[SIDE * SIDE * 4];
    etd_render_options options = short_render(16);
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, SIDE, SIDE, 0);
    etd_task *task = NULL;
    int stops = 0, rounds = 0;
    etd_status status;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, wanted, sizeof wanted, 0));
    options.progress = stop; /* at every report: each round does a little */
    options.user_data = &stops;
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    for (status = etd_task_wait(task, -1); status == ETD_CANCELLED && rounds < 1000; ++rounds) {
        CHECK_OK(etd_task_resume(task));
        status = etd_task_wait(task, -1);
    }
    CHECK_STATUS(status, ETD_OK);
    CHECK(rounds > 0);
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, NULL, got, sizeof got, 0));
    CHECK(memcmp(wanted, got, sizeof got) == 0);
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* All at once */

struct crowd {
    etd_device *device;
    etd_scene *scene;
    int rounds;
};

static void *keep_rendering(void *data) {
    struct crowd *it = data;
    etd_film *film = new_film(it->device, 8, 8, ETD_LAYER_NORMAL);
    etd_render_options options = short_render(2);
    int i;
    for (i = 0; i < it->rounds; ++i) {
        CHECK_OK(etd_render(it->scene, film, &options));
    }
    etd_film_release(film);
    return NULL;
}

static void *keep_editing(void *data) {
    struct crowd *it = data;
    static const double centre[3] = {1, 1, 1};
    int i;
    for (i = 0; i < it->rounds; ++i) {
        etd_material material = ETD_MATERIAL_INIT;
        etd_surface surface = ETD_SURFACE_INIT;
        etd_camera camera = ETD_CAMERA_INIT;
        double transform[12];
        const float glow[3] = {(float)i, 1, 1};
        uint32_t number = ETD_NONE;
        memcpy(transform, identity, sizeof transform);
        transform[3] = 0.01 * i;
        camera.origin[2] = 5 + 0.1 * i;
        surface.material = 0;
        material.color[0] = 0.1f;
        CHECK_OK(etd_scene_set_material(it->scene, 0, &material));
        CHECK_OK(etd_scene_set_transform(it->scene, 1, transform));
        CHECK_OK(etd_scene_set_camera(it->scene, &camera));
        CHECK_OK(etd_scene_set_emission(it->scene, 2, glow));
        CHECK_OK(etd_scene_add_sphere(it->scene, centre, 0.2, &surface, &number));
        CHECK_OK(etd_scene_commit(it->scene, NULL, NULL));
        CHECK_OK(etd_scene_remove_surface(it->scene, number));
        CHECK_STATUS(etd_scene_get_surface(it->scene, number, &surface), ETD_INVALID_ARGUMENT);
    }
    return NULL;
}

static void *keep_asking(void *data) {
    struct crowd *it = data;
    int i;
    for (i = 0; i < 50 * it->rounds; ++i) {
        etd_ray rays[2] = {{{2.5f, 5, 2.5f}, 0, {0, -1, 0}, 100}, {{0, -5, 0}, 0, {0, -1, 0}, 100}};
        etd_hit hits[2];
        uint8_t answers[2];
        CHECK_OK(etd_scene_intersect(it->scene, rays, 2, hits));
        CHECK(hits[0].surface == 0 && hits[0].t > 4.9f && hits[0].t < 5.1f && hits[1].surface == ETD_NONE);
        CHECK_OK(etd_scene_occluded(it->scene, rays, 2, answers));
        CHECK(answers[0] == 1 && answers[1] == 0);
    }
    return NULL;
}

static void crowd(int rounds) {
    struct crowd it;
    pthread_t threads[5];
    size_t i;
    uint32_t mesh;
    it.device = new_device(2);
    it.scene = new_scene(it.device);
    it.rounds = rounds;
    add_grid(it.scene, 20, &mesh);
    CHECK_OK(etd_scene_commit(it.scene, NULL, NULL));
    CHECK(pthread_create(&threads[0], NULL, keep_rendering, &it) == 0);
    CHECK(pthread_create(&threads[1], NULL, keep_rendering, &it) == 0);
    CHECK(pthread_create(&threads[2], NULL, keep_editing, &it) == 0);
    CHECK(pthread_create(&threads[3], NULL, keep_asking, &it) == 0);
    CHECK(pthread_create(&threads[4], NULL, keep_asking, &it) == 0);
    for (i = 0; i < 5; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0);
    }
    etd_scene_release(it.scene);
    etd_device_release(it.device);
}

/* Arrays that are shared are given back once, when nobody reads them any more, and never if they were not taken. */
static void count_release(void *user_data) { ++*(int *)user_data; }

static void shared_arrays(void) {
    static float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0};
    static const uint32_t indices[3] = {0, 1, 2};
    static const uint32_t wrong[3] = {0, 1, 9};
    etd_device *device = new_device(1);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 4, 4, 0);
    etd_mesh mesh = ETD_MESH_INIT;
    etd_surface surface = ETD_SURFACE_INIT;
    etd_render_options options = short_render(1);
    int releases = 0, others = 0;
    uint32_t number = 0, use = 0;
    surface.material = 0;
    mesh.positions = positions;
    mesh.position_bytes = sizeof positions;
    mesh.vertex_count = 3;
    mesh.indices = wrong;
    mesh.triangle_count = 1;
    mesh.sharing = ETD_SHARE;
    mesh.release = count_release;
    mesh.user_data = &releases;
    CHECK_STATUS(etd_scene_add_mesh(scene, &mesh, &number), ETD_INVALID_SCENE);
    CHECK(releases == 0);
    mesh.indices = indices;
    CHECK_OK(etd_scene_add_mesh(scene, &mesh, &number));
    CHECK_OK(etd_scene_add_mesh_surface(scene, number, 0, &surface, &use));
    CHECK_OK(etd_render(scene, film, &options));
    CHECK(releases == 0);
    mesh.indices = wrong;
    mesh.user_data = &others;
    CHECK_STATUS(etd_scene_set_mesh(scene, number, &mesh), ETD_INVALID_SCENE);
    CHECK(releases == 0 && others == 0);
    mesh.indices = indices;
    CHECK_OK(etd_scene_set_mesh(scene, number, &mesh));
    CHECK_OK(etd_render(scene, film, &options));
    CHECK(others == 0);
    CHECK_OK(etd_scene_remove_surface(scene, use));
    CHECK_OK(etd_scene_remove_mesh(scene, number));
    CHECK_OK(etd_scene_commit(scene, NULL, NULL));
    etd_scene_release(scene);
    etd_film_release(film);
    CHECK(releases == 1 && others == 1);
    etd_device_release(device);
}

static double seconds_since(const struct timespec *begin) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - begin->tv_sec) + 1e-9 * (double)(now.tv_nsec - begin->tv_nsec);
}

/* Adds surfaces to a new scene and finds each of them. Returns the scene; `times` are those of adding and of finding. */
static etd_scene *find_all(etd_device *device, uint32_t count, double times[2]) {
    etd_scene *scene = new_scene(device); /* surfaces 0 to 2 */
    const etd_surface surface = matt();
    struct timespec begin;
    uint32_t number = 0;
    uint32_t i;
    char path[32];
    unsigned long wrong = 0;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (i = 3; i < count; ++i) {
        wrong += etd_scene_add_sphere(scene, centre, 1, &surface, &number) != ETD_OK || number != i;
    }
    times[0] = seconds_since(&begin);
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (i = 0; i < count; ++i) {
        snprintf(path, sizeof path, "surfaces[%u]", (unsigned)i);
        wrong += etd_scene_find_surface(scene, path, &number) != ETD_OK || number != i;
    }
    times[1] = seconds_since(&begin);
    CHECK(wrong == 0);
    return scene;
}

/* To find every surface takes about as long as to add it, in a scene of many too, and what was added or removed since is found or is
 * not. */
static void find_many(uint32_t count) {
    etd_device *device = new_device(1);
    double times[2];
    etd_scene *scene = find_all(device, count, times);
    const etd_surface surface = matt();
    uint32_t number = 0;
    int tries;
    char path[32];
    /* A search of all takes a hundred times as long, each time. What else the machine does holds up some tries, and not all. */
    for (tries = 1; times[1] >= 6 * times[0] + 0.05 && tries < 10; ++tries) {
        etd_scene_release(scene);
        scene = find_all(device, count, times);
    }
    if (!CHECK(times[1] < 6 * times[0] + 0.05)) {
        fprintf(stderr, "  %u surfaces were added in %.3f s, and found in %.3f s\n", (unsigned)count, times[0], times[1]);
    }
    CHECK_OK(etd_scene_remove_surface(scene, 7));
    CHECK_STATUS(etd_scene_find_surface(scene, "surfaces[7]", &number), ETD_INVALID_ARGUMENT);
    snprintf(path, sizeof path, "surfaces[%u]", (unsigned)count);
    CHECK_STATUS(etd_scene_find_surface(scene, path, &number), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_add_sphere(scene, centre, 1, &surface, &number));
    number = 0;
    CHECK_OK(etd_scene_find_surface(scene, path, &number));
    CHECK(number == count);
    etd_scene_release(scene);
    etd_device_release(device);
}

void misuse_life(int quick) {
    find_many(quick ? 20000 : 50000);
    wrong_states();
    every_order();
    shared_arrays();
    listeners();
    only_warnings();
    if (!quick) {
        /* A checker is too slow for times. */
        paces();
    }
    callbacks(1);
    callbacks(2);
    executors();
    resume_to_the_same();
    many_lives(quick ? 5 : 1000);
    queued_work_keeps_nothing();
    handles_live_until_released();
    if (!quick) {
        /* Three threads that never rest: under a checker that runs one at a time, one of them may wait for ever. */
        waiting_beside_resuming(200);
    }
    mixed_up();
    cancel_any_time(quick ? 3 : 50);
    crowd(quick ? 2 : 30);
}
