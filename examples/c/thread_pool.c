/* A host with threads of its own: the library gives its work to them, and starts none.
 *
 * The pool is the simplest there is: a list and some threads. Work that waits in it does no harm: a render goes on with
 * the threads that have come, the calling one at least.
 *
 * Build:  cc -std=c99 -pthread thread_pool.c $(pkg-config --cflags --libs etendue) -o thread_pool
 * Run:    ./thread_pool [THREADS [WIDTH [HEIGHT [SAMPLES]]]]; writes thread_pool.png */
#include <pthread.h>

#include "common.h"

struct item {
    etd_work_fn work;
    void *argument;
    struct item *next;
};

struct pool {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    struct item *first, **last;
    int closed;
    unsigned long done;
};

static void *run(void *data) {
    struct pool *pool = data;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        struct item *item = pool->first;
        if (item != NULL) {
            pool->first = item->next;
            if (pool->first == NULL) {
                pool->last = &pool->first;
            }
            pthread_mutex_unlock(&pool->lock);
            item->work(item->argument);
            free(item);
            pthread_mutex_lock(&pool->lock);
            pool->done++;
        } else if (pool->closed) {
            break;
        } else {
            pthread_cond_wait(&pool->changed, &pool->lock);
        }
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* What the library calls: takes the work and returns at once. */
static void submit(void *user_data, etd_work_fn work, void *argument) {
    struct pool *pool = user_data;
    struct item *item = malloc(sizeof *item);
    if (item == NULL) {
        work(argument); /* no room in the list: it must be done all the same */
        return;
    }
    item->work = work;
    item->argument = argument;
    item->next = NULL;
    pthread_mutex_lock(&pool->lock);
    *pool->last = item;
    pool->last = &item->next;
    pthread_cond_signal(&pool->changed);
    pthread_mutex_unlock(&pool->lock);
}

int main(int count, char **arguments) {
    const uint32_t threads = number_argument(count, arguments, 1, 4);
    struct pool pool;
    pthread_t *workers = malloc((threads > 0 ? threads : 1) * sizeof *workers);
    etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
    etd_render_options options = ETD_RENDER_OPTIONS_INIT;
    etd_device *device = NULL;
    etd_scene *scene;
    etd_film *film;
    etd_task *task = NULL;
    uint32_t red, ball, i;
    if (workers == NULL || threads == 0) {
        fprintf(stderr, "no threads, no image\n");
        return 1;
    }
    pthread_mutex_init(&pool.lock, NULL);
    pthread_cond_init(&pool.changed, NULL);
    pool.first = NULL;
    pool.last = &pool.first;
    pool.closed = 0;
    pool.done = 0;
    for (i = 0; i < threads; ++i) {
        if (pthread_create(&workers[i], NULL, run, &pool) != 0) {
            fprintf(stderr, "a thread cannot be started\n");
            return 1;
        }
    }

    device_options.threads = threads;
    device_options.submit = submit;
    device_options.user_data = &pool;
    must(etd_device_new(&device_options, &device));
    scene = two_balls(device, &red, &ball);
    look_from(scene, 2, 3, 7);
    film = new_film(device, number_argument(count, arguments, 2, 320), number_argument(count, arguments, 3, 240));
    options.samples = number_argument(count, arguments, 4, 64);
    must(etd_render_start(scene, film, &options, &task));
    must(etd_task_wait(task, -1));
    must(etd_film_write(film, "thread_pool.png", NULL));
    etd_task_release(task);
    etd_film_release(film);
    etd_scene_release(scene);

    /* The pool ends what it has taken, and only then the device goes. */
    pthread_mutex_lock(&pool.lock);
    pool.closed = 1;
    pthread_cond_broadcast(&pool.changed);
    pthread_mutex_unlock(&pool.lock);
    for (i = 0; i < threads; ++i) {
        pthread_join(workers[i], NULL);
    }
    etd_device_release(device);
    printf("%u threads did %lu pieces of work\n", threads, pool.done);
    pthread_cond_destroy(&pool.changed);
    pthread_mutex_destroy(&pool.lock);
    free(workers);
    return 0;
}
