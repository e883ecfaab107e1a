/* The library leaves the process as it finds it: signal handlers, locale, floating-point mode, output, working folder,
 * environment, and no thread of its own once all is released (Embree's own workers stay, asleep). */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <fenv.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"

CHECK_MAIN;

extern char **environ;

#define SIGNALS 64

struct process {
    struct sigaction handlers[SIGNALS];
    sigset_t blocked;
    fenv_t floating;
    char locale[256];
    char folder[1024];
    size_t variables;
    mode_t mask;
};

static void look(struct process *process) {
    int i;
    memset(process, 0, sizeof *process);
    for (i = 1; i < SIGNALS; ++i) {
        sigaction(i, NULL, &process->handlers[i]);
    }
    pthread_sigmask(SIG_BLOCK, NULL, &process->blocked);
    fegetenv(&process->floating);
    snprintf(process->locale, sizeof process->locale, "%s", setlocale(LC_ALL, NULL));
    CHECK(getcwd(process->folder, sizeof process->folder) != NULL);
    while (environ[process->variables] != NULL) {
        process->variables++;
    }
    process->mask = umask(0);
    umask(process->mask);
}

static void same(const struct process *before, const struct process *after) {
    int i;
    for (i = 1; i < SIGNALS; ++i) {
        CHECK(before->handlers[i].sa_handler == after->handlers[i].sa_handler);
    }
    CHECK(memcmp(&before->blocked, &after->blocked, sizeof before->blocked) == 0);
#ifdef __x86_64__
    /* Flags of what happened (inexact and so on) may be set; control words may not change. */
    CHECK((before->floating.__mxcsr & ~0x3fu) == (after->floating.__mxcsr & ~0x3fu));
    CHECK(before->floating.__control_word == after->floating.__control_word);
#endif
    CHECK(fegetround() == FE_TONEAREST);
    CHECK(strcmp(before->locale, after->locale) == 0);
    CHECK(strcmp(before->folder, after->folder) == 0);
    CHECK(before->variables == after->variables);
    CHECK(before->mask == after->mask);
}

/* Threads of the process whose name begins as the library names its own. */
static int own_threads(void) {
    int count = 0;
    struct dirent *entry;
    DIR *tasks = opendir("/proc/self/task");
    if (tasks == NULL) {
        return 0;
    }
    while ((entry = readdir(tasks)) != NULL) {
        char path[300], name[64] = "";
        FILE *file;
        snprintf(path, sizeof path, "/proc/self/task/%.200s/comm", entry->d_name);
        file = fopen(path, "r");
        if (file != NULL) {
            if (fgets(name, sizeof name, file) != NULL && strncmp(name, "etendue", 7) == 0) {
                count++;
            }
            fclose(file);
        }
    }
    closedir(tasks);
    return count;
}

static void everything(uint32_t threads) {
    etd_device *device = new_device(threads);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 40, 30, ETD_LAYER_DEPTH);
    etd_render_options options = short_render(4);
    etd_task *task = NULL;
    etd_scene *broken = NULL;
    const char *json = "{ nothing";
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_render_start(scene, film, &options, &task));
    CHECK_OK(etd_task_wait(task, -1));
    CHECK(threads < 2 || own_threads() > 0);
    CHECK_STATUS(etd_scene_from_json(device, json, strlen(json), NULL, &broken), ETD_INVALID_SCENE);
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    CHECK(own_threads() == 0);
}

/* A child has none of the threads of its parent: it may edit, build, ask and release, and is refused renders, which would wait for ever,
 * until it has a device of its own. */
static void after_fork(void) {
    etd_device *device = new_device(2);
    etd_scene *scene = new_scene(device);
    etd_film *film = new_film(device, 40, 30, 0);
    const etd_render_options options = short_render(2);
    pid_t child;
    int status = -1;
    CHECK_OK(etd_render(scene, film, &options));
    child = fork();
    CHECK(child >= 0);
    if (child == 0) {
        const unsigned long failed = check_counts.failed;
        const etd_ray ray = {{0, 1, 9}, 0, {0, 0, -1}, 100};
        etd_hit hit;
        etd_task *task = NULL;
        alarm(120);
        CHECK_OK(etd_scene_remove_surface(scene, 2));
        CHECK_OK(etd_scene_commit(scene, NULL, NULL));
        CHECK_OK(etd_scene_intersect(scene, &ray, 1, &hit));
        CHECK(hit.surface == 1);
        {
            /* As many rays as several threads would trace, of which there is one. */
            enum { COUNT = 5000 };
            static etd_ray rays[COUNT];
            static uint32_t surfaces[COUNT];
            etd_ray_query query = ETD_RAY_QUERY_INIT;
            int i;
            for (i = 0; i < COUNT; ++i) {
                rays[i] = ray;
            }
            query.count = COUNT;
            query.threads = 8;
            query.origins = rays[0].origin;
            query.directions = rays[0].direction;
            query.origins_stride = query.directions_stride = sizeof *rays;
            query.surfaces = surfaces;
            CHECK_OK(etd_scene_query(scene, &query));
            CHECK(surfaces[0] == 1 && surfaces[COUNT - 1] == 1);
        }
        CHECK_STATUS(etd_render(scene, film, &options), ETD_UNSUPPORTED);
        CHECK_OK(etd_render_start(scene, film, &options, &task));
        CHECK_STATUS(etd_task_wait(task, -1), ETD_UNSUPPORTED);
        etd_task_release(task);
        etd_film_release(film);
        etd_scene_release(scene);
        etd_device_release(device);
        device = new_device(2);
        scene = new_scene(device);
        film = new_film(device, 40, 30, 0);
        CHECK_OK(etd_render(scene, film, &options));
        etd_film_release(film);
        etd_scene_release(scene);
        etd_device_release(device);
        _exit(check_counts.failed == failed ? 0 : 1);
    }
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    /* The parent has not noticed. */
    CHECK_OK(etd_render(scene, film, &options));
    etd_film_release(film);
    etd_scene_release(scene);
    etd_device_release(device);
    CHECK(own_threads() == 0);
}

int main(void) {
    struct process before, after;
    char path[] = "/tmp/etendue-process-XXXXXX";
    int file = mkstemp(path), out = dup(1), err = dup(2);
    long written;
    CHECK(file >= 0 && out >= 0 && err >= 0);
    unlink(path);
    signal(SIGUSR1, SIG_IGN);
    fesetround(FE_TONEAREST);
    /* Whatever is printed meanwhile goes to the file. */
    fflush(stdout);
    fflush(stderr);
    dup2(file, 1);
    dup2(file, 2);
    look(&before);
    everything(1);
    everything(2);
    after_fork();
    look(&after);
    fflush(stdout);
    fflush(stderr);
    dup2(out, 1);
    dup2(err, 2);
    written = (long)lseek(file, 0, SEEK_END);
    CHECK(written == 0);
    same(&before, &after);
    return check_report("process");
}
