/* The floating-point state of the caller: directions of rounding, unmasked exceptions and flushed subnormal numbers change no image and
 * no hit, the state is the same after a call, and the host's functions see it. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#if defined(__x86_64__)

#include <fenv.h>
#include <xmmintrin.h>

/* The default state: all exceptions masked, none raised, rounding to nearest. */
#define DEFAULT_STATE 0x1f80u
#define EXCEPTION_FLAGS 0x3fu
#define UNMASKED_INVALID (DEFAULT_STATE & ~0x0080u)
#define UNMASKED_ALL (DEFAULT_STATE & ~0x1f80u)
#define FLUSHED (DEFAULT_STATE | 0x8040u)
#define INEXACT_RAISED 0x20u
#define DIVIDED_BY_ZERO 0x04u

#define SIDE 32
#define RAYS 64

struct outcome {
    float pixels[SIDE * SIDE * 4];
    etd_hit hits[RAYS];
    double sun[3];
};

/* What functions of the host saw: the state on the thread of the call, and on other threads. */
struct witness {
    pthread_t caller;
    unsigned wanted;
    unsigned long calls;
    unsigned long wrong;
    int changes_state;
    pthread_mutex_t lock;
};

static void look(void *user_data) {
    struct witness *it = user_data;
    const unsigned seen = _mm_getcsr() & ~EXCEPTION_FLAGS;
    pthread_mutex_lock(&it->lock);
    it->calls++;
    it->wrong += seen != (pthread_equal(it->caller, pthread_self()) ? it->wanted : DEFAULT_STATE);
    pthread_mutex_unlock(&it->lock);
    if (it->changes_state) {
        _mm_setcsr(FLUSHED | 0x6000u);
    }
}

static int32_t look_at_progress(void *user_data, const etd_progress *progress) {
    (void)progress;
    look(user_data);
    return 0;
}

static void look_at_message(void *user_data, etd_log_level level, const char *message) {
    (void)level;
    (void)message;
    look(user_data);
}

static void look_at_error(void *user_data, etd_status status, const char *message) {
    (void)status;
    (void)message;
    look(user_data);
}

static unsigned short x87_control(void) {
    unsigned short control;
    __asm__ volatile("fnstcw %0" : "=m"(control));
    return control;
}

/* Does all in one state, and checks that no call changes it. */
static void do_all(unsigned state, uint32_t threads, int changes_state, struct outcome *out) {
    struct witness seen;
    etd_device_options device_options = ETD_DEVICE_OPTIONS_INIT;
    etd_render_options options = short_render(2);
    etd_device *here = NULL;
    etd_scene *room = NULL;
    etd_film *picture = NULL;
    etd_task *render = NULL;
    etd_progress progress = ETD_PROGRESS_INIT;
    etd_ray rays[RAYS];
    uint32_t number = 0;
    const unsigned short x87 = x87_control();
    int i;
    /* What this program computes is not to depend on the state. */
    _mm_setcsr(DEFAULT_STATE);
    memset(&seen, 0, sizeof seen);
    memset(rays, 0, sizeof rays);
    seen.caller = pthread_self();
    seen.wanted = state & ~EXCEPTION_FLAGS;
    seen.changes_state = changes_state;
    pthread_mutex_init(&seen.lock, NULL);
    device_options.threads = threads;
    device_options.log = look_at_message;
    device_options.error = look_at_error;
    device_options.user_data = &seen;
    options.progress = look_at_progress;
    options.user_data = &seen;
    options.integrator = ETD_INTEGRATOR_PATH;
    for (i = 0; i < RAYS; ++i) {
        rays[i].origin[0] = 0.03f * (float)(i - RAYS / 2);
        rays[i].origin[1] = 1.3f;
        rays[i].origin[2] = 4;
        rays[i].direction[0] = 0.003f * (float)(i % 7);
        rays[i].direction[1] = -0.07f;
        rays[i].direction[2] = -1;
        rays[i].tfar = 100;
    }

#define UNCHANGED() CHECK(_mm_getcsr() == state && x87_control() == x87)
    _mm_setcsr(state);
    CHECK_OK(etd_device_new(&device_options, &here));
    UNCHANGED();
    _mm_setcsr(DEFAULT_STATE);
    seen.wanted = DEFAULT_STATE;
    room = new_scene(here);
    add_grid(room, 24, &number);
    seen.wanted = state & ~EXCEPTION_FLAGS;
    _mm_setcsr(state);
    CHECK_OK(etd_scene_commit(room, look_at_progress, &seen));
    UNCHANGED();
    picture = new_film(here, SIDE, SIDE, 0);
    UNCHANGED();
    CHECK_OK(etd_render(room, picture, &options));
    UNCHANGED();
    CHECK_OK(etd_film_copy(picture, ETD_LAYER_COLOR, NULL, out->pixels, sizeof out->pixels, 0));
    UNCHANGED();
    CHECK_OK(etd_scene_intersect(room, rays, RAYS, out->hits));
    UNCHANGED();
    CHECK_OK(etd_sun_direction(48.137, 11.575, 1782036000, out->sun));
    UNCHANGED();
    CHECK_STATUS(etd_scene_remove_surface(room, 999), ETD_INVALID_ARGUMENT);
    UNCHANGED();
    CHECK_OK(etd_render_start(room, picture, &options, &render));
    CHECK_OK(etd_task_wait(render, -1));
    CHECK_OK(etd_task_poll(render, &progress));
    UNCHANGED();
    etd_task_release(render);
    etd_film_release(picture);
    etd_scene_release(room);
    etd_device_release(here);
    UNCHANGED();
    _mm_setcsr(DEFAULT_STATE);
    CHECK(seen.calls > 4);
    CHECK(seen.wrong == 0);
}

void misuse_float(void) {
    static const unsigned states[] = {DEFAULT_STATE | DIVIDED_BY_ZERO,
                                      DEFAULT_STATE | 0x2000u,
                                      DEFAULT_STATE | 0x4000u | INEXACT_RAISED,
                                      DEFAULT_STATE | 0x6000u,
                                      FLUSHED,
                                      UNMASKED_INVALID,
                                      UNMASKED_ALL};
    static struct outcome expected_outcome, got;
    const unsigned before = _mm_getcsr();
    uint32_t threads;
    size_t i;
    for (threads = 1; threads <= 2; ++threads) {
        do_all(DEFAULT_STATE, threads, 0, &expected_outcome);
        for (i = 0; i < sizeof states / sizeof states[0]; ++i) {
            memset(&got, 0, sizeof got);
            do_all(states[i], threads, (int)(i % 2), &got);
            CHECK(memcmp(&got, &expected_outcome, sizeof got) == 0);
        }
    }
    /* The state of the C library's own functions, which is that of the x87 unit as well. */
    if (CHECK(fesetround(FE_UPWARD) == 0)) {
        memset(&got, 0, sizeof got);
        do_all(_mm_getcsr() & ~EXCEPTION_FLAGS, 2, 0, &got);
        CHECK(memcmp(&got, &expected_outcome, sizeof got) == 0);
        CHECK((x87_control() & 0x0c00) == 0x0800);
        fesetround(FE_TONEAREST);
    }
    _mm_setcsr(before);
}

#else

void misuse_float(void) {}

#endif
