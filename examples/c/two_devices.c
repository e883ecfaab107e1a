/* Two renders at once in two devices that know nothing of each other: their own threads, limits and messages.
 *
 * Build:  cc -std=c99 two_devices.c $(pkg-config --cflags --libs etendue) -o two_devices
 * Run:    ./two_devices [WIDTH [HEIGHT [SAMPLES]]]; writes left.png and right.png */
#include "common.h"

static void tell(void *user_data, etd_log_level level, const char *message) {
    fprintf(stderr, "%s: %s%s\n", (const char *)user_data, level == ETD_LOG_WARNING ? "warning: " : "", message);
}

int main(int count, char **arguments) {
    static char names[2][8] = {"left", "right"};
    etd_device *devices[2] = {NULL, NULL};
    etd_scene *scenes[2];
    etd_film *films[2];
    etd_task *tasks[2] = {NULL, NULL};
    int i;
    for (i = 0; i < 2; ++i) {
        etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
        etd_render_options options = ETD_RENDER_OPTIONS_INIT;
        uint32_t red, ball;
        device_options.threads = 2;
        device_options.memory_limit = 256u << 20;
        device_options.log = tell;
        device_options.user_data = names[i];
        must(etd_device_new(&device_options, &devices[i]));
        scenes[i] = two_balls(devices[i], &red, &ball);
        look_from(scenes[i], i == 0 ? -2.5 : 2.5, 2.5, 6);
        films[i] = new_film(devices[i], number_argument(count, arguments, 1, 320),
                            number_argument(count, arguments, 2, 240));
        options.samples = number_argument(count, arguments, 3, 64);
        must(etd_render_start(scenes[i], films[i], &options, &tasks[i]));
    }
    for (i = 0; i < 2; ++i) {
        char path[16];
        uint64_t peak = 0;
        etd_summary summary = ETD_SUMMARY_INIT;
        must(etd_task_wait(tasks[i], -1));
        must(etd_film_get_summary(films[i], &summary));
        must(etd_device_memory(devices[i], NULL, &peak));
        printf("%s: %.2f s, %.1f million rays, at most %.1f MiB\n", names[i], summary.elapsed,
               1e-6 * (double)summary.rays, (double)peak / 1048576);
        snprintf(path, sizeof path, "%s.png", names[i]);
        must(etd_film_write(films[i], path, NULL));
        etd_task_release(tasks[i]);
        etd_film_release(films[i]);
        etd_scene_release(scenes[i]);
        etd_device_release(devices[i]);
    }
    return 0;
}
