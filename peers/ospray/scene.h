/* The scene that both hosts describe: a room of five walls as one mesh, a ball on its floor, a lamp under its ceiling. */
#ifndef SCENE_H
#define SCENE_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define WIDTH 512
#define HEIGHT 512
#define SAMPLES 16
#define TRIES 200

static const float positions[][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
static const uint32_t triangles[][3] = {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 1}, {3, 2, 6},
                                        {3, 6, 7}, {0, 3, 7}, {0, 7, 4}, {1, 5, 6}, {1, 6, 2}};
static const float ball[] = {0.2f, -0.6f, -0.1f, 0.4f};
static const float lamp[][3] = {{-0.3f, 0.99f, -0.3f}, {0.3f, 0.99f, -0.3f}, {0.3f, 0.99f, 0.3f}, {-0.3f, 0.99f, 0.3f}};

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void nap(double seconds) {
    struct timespec time = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
    nanosleep(&time, NULL);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void report(const char *what, double *latencies) {
    qsort(latencies, TRIES, sizeof *latencies, by_size);
    printf("%s: cancelled %d times: median %.2f ms, largest %.2f ms\n", what, TRIES, 1e3 * latencies[TRIES / 2],
           1e3 * latencies[TRIES - 1]);
}

static double mean(const float *pixels, size_t count, size_t channels) {
    double sum = 0;
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c) sum += pixels[i * channels + c];
    return sum / (3.0 * (double)count);
}

#endif
