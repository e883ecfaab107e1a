/* What programs do that show variants of a thing in windows: meshes that two scenes have, films that get another size, mesh files that
 * are read while the window goes on. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <stdint.h>

enum { VERTICES = 3 };
#define PIXELS(width, height) (4 * (size_t)(width) * (height))

static uint64_t memory_of(etd_device *of) {
    uint64_t used = 0;
    CHECK_OK(etd_device_memory(of, &used, NULL));
    return used;
}

static uint64_t meshes_of(etd_scene *of) {
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    CHECK_OK(etd_scene_commit(of, NULL, NULL));
    CHECK_OK(etd_scene_get_info(of, &info));
    return info.meshes;
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Meshes of two scenes */

static const float sail[16] = {-1, 2, 0, 0, 1, 2, 0, 0, 0, 3, 0, 0};
static const uint32_t sail_indices[3] = {0, 1, 2};

static void count_release(void *user_data) { ++*(int *)user_data; }

static etd_mesh shared_sail(int *releases) {
    etd_mesh mesh = ETD_MESH_INIT;
    mesh.positions = sail;
    mesh.position_stride = 16;
    mesh.position_bytes = sizeof sail;
    mesh.vertex_count = VERTICES;
    mesh.indices = sail_indices;
    mesh.triangle_count = 1;
    mesh.sharing = ETD_SHARE;
    mesh.release = count_release;
    mesh.user_data = releases;
    return mesh;
}

static void use_mesh(etd_scene *in, uint32_t mesh) {
    const etd_surface surface = matt();
    uint32_t number;
    CHECK_OK(etd_scene_add_mesh_surface(in, mesh, 0, &surface, &number));
}

static int hits(etd_scene *in) {
    const etd_ray ray = {{0, 2.5f, 2}, 0, {0, 0, -1}, 100};
    etd_hit hit;
    CHECK_OK(etd_scene_commit(in, NULL, NULL));
    CHECK_OK(etd_scene_intersect(in, &ray, 1, &hit));
    return hit.surface != ETD_NONE;
}

/* The host's arrays belong to both scenes, of two devices, and go with the last of them. */
static void arrays_are_shared(void) {
    etd_device *first_device = new_device(1), *second_device = new_device(1);
    etd_scene *first = new_scene(first_device), *second = new_scene(second_device), *third = new_scene(first_device);
    int releases = 0;
    const etd_mesh copied = small_mesh();
    const etd_mesh arrays = shared_sail(&releases);
    etd_mesh_info info = ETD_MESH_INFO_INIT;
    uint32_t mesh = 9, other = 9, again = 9, found = 9;
    double positions[3 * VERTICES];
    CHECK_OK(etd_scene_add_mesh(first, &arrays, &mesh));
    add_grid(second, 2, &other);
    CHECK_OK(etd_scene_add_mesh_from(second, "sail", first, mesh, &other));
    CHECK(other == 1);
    CHECK_OK(etd_scene_find_mesh(second, "sail", &found));
    CHECK(found == other);
    CHECK_STATUS(etd_scene_find_mesh(first, "sail", &found), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_get_mesh(second, other, &info));
    CHECK(info.vertex_count == VERTICES && info.triangle_count == 1);
    CHECK_OK(etd_scene_copy_mesh(second, other, VERTICES, 1, positions, NULL, NULL, NULL));
    CHECK(positions[0] == -1 && positions[7] == 3);
    /* The same mesh twice in one scene, and from a scene that did not have it first. */
    CHECK_OK(etd_scene_add_mesh_from(second, NULL, second, other, &again));
    CHECK(again == 2);
    CHECK_OK(etd_scene_add_mesh_from(third, NULL, second, again, &again));

    /* What is refused changes nothing. */
    again = 77;
    CHECK_STATUS(etd_scene_add_mesh_from(second, "sail", first, mesh, &again), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "given twice") != NULL);
    CHECK_STATUS(etd_scene_add_mesh_from(second, NULL, first, 1, &again), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "source: there is no mesh 1") != NULL);
    CHECK_STATUS(etd_scene_add_mesh_from(second, NULL, first, ETD_NONE, &again), ETD_INVALID_ARGUMENT);
    CHECK(again == 77 && meshes_of(second) == 3);

    /* Each scene has its own say over what it does with the mesh. */
    use_mesh(first, mesh);
    use_mesh(second, other);
    CHECK(hits(first) && hits(second) && releases == 0);
    CHECK_OK(etd_scene_set_mesh(first, mesh, &copied));
    CHECK(!hits(first) && hits(second));
    CHECK_STATUS(etd_scene_remove_mesh(second, other), ETD_INVALID_SCENE); /* in use */
    CHECK_OK(etd_scene_remove_mesh(second, 2));
    CHECK_STATUS(etd_scene_add_mesh_from(first, NULL, second, 2, &again), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "was removed") != NULL);
    CHECK(hits(second) && releases == 0);
    etd_scene_release(first);
    etd_device_release(first_device);
    CHECK(hits(second) && releases == 0);
    etd_scene_release(second);
    etd_device_release(second_device);
    CHECK(releases == 0);
    etd_scene_release(third);
    CHECK(releases == 1);
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Groups of surfaces */

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* The surface that a ray down the z axis meets at x, and its material. */
static uint32_t seen_at(etd_scene *in, float x, uint32_t *material) {
    etd_ray ray = {{0, 0, 50}, 0, {0, 0, -1}, 100};
    etd_hit hit;
    ray.origin[0] = x;
    CHECK_OK(etd_scene_commit(in, NULL, NULL));
    CHECK_OK(etd_scene_intersect(in, &ray, 1, &hit));
    if (material != NULL) {
        *material = hit.material;
    }
    return hit.surface;
}

static void groups_are_placed(void) {
    etd_device *on = new_device(1);
    etd_scene *of = new_scene(on);
    double moved[12], got[12];
    const double middle[3] = {0, 0, 0}, aside[3] = {2, 0, 0};
    etd_surface ball = matt();
    etd_material red = ETD_MATERIAL_INIT;
    etd_motion_key keys[2] = {ETD_MOTION_KEY_INIT, ETD_MOTION_KEY_INIT};
    uint32_t parts[3], wrong[2], group = 9, more = 9, placed = 9, again = 9, first = 9, count = 9, material = 9, number = 9;
    memcpy(moved, identity, sizeof moved);
    moved[3] = 10;
    CHECK_OK(etd_scene_add_material(of, "red", &red, &number));
    CHECK_OK(etd_scene_add_sphere(of, middle, 0.5, &ball, &parts[0]));
    CHECK_OK(etd_scene_add_sphere(of, aside, 0.5, &ball, &parts[1]));
    CHECK_OK(etd_scene_add_group(of, "two", parts, 2, &group));
    CHECK_OK(etd_scene_find_group(of, "two", &more));
    CHECK(group == 0 && more == 0);
    CHECK_OK(etd_scene_place_group(of, group, moved, &placed, &first));
    CHECK(placed == 0 && first == parts[1] + 1);
    CHECK(seen_at(of, 10, &material) == first && material == ball.material && seen_at(of, 12, NULL) == first + 1);

    /* One placement looks otherwise; the group and the surfaces that it was made of stay what they are. */
    CHECK_OK(etd_scene_set_surface_material(of, first, number));
    CHECK(seen_at(of, 10, &material) == first && material == number);
    CHECK_OK(etd_scene_remove_surface(of, parts[0]));
    moved[3] = -10;
    CHECK_OK(etd_scene_place_group(of, group, moved, &again, NULL));
    CHECK(seen_at(of, -10, &material) == first + 2 && material == ball.material && seen_at(of, 0, NULL) != parts[0]);
    CHECK_OK(etd_scene_get_placement(of, again, &more, &first, &count, got));
    CHECK(more == group && first == parts[1] + 3 && count == 2 && got[3] == -10 && got[0] == 1);

    /* Moved as a whole, and a group of a placement. */
    moved[3] = 20;
    CHECK_OK(etd_scene_set_placement_transform(of, again, moved));
    CHECK(seen_at(of, -10, NULL) == ETD_NONE && seen_at(of, 22, NULL) == first + 1);
    parts[0] = first;
    parts[2] = first + 1;
    CHECK_OK(etd_scene_add_group(of, NULL, parts, 3, &more));
    moved[3] = 10;
    CHECK_OK(etd_scene_place_group(of, more, moved, &number, &first));
    CHECK(more == 1 && seen_at(of, 32, NULL) == first + 2);
    CHECK_OK(etd_scene_remove_placement(of, number));
    CHECK(seen_at(of, 32, NULL) == ETD_NONE);
    CHECK_STATUS(etd_scene_get_placement(of, number, &more, NULL, NULL, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_remove_placement(of, number), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_placement_transform(of, number, identity), ETD_INVALID_ARGUMENT);

    /* All surfaces of a placement move, and those of a group do not. */
    keys[1].time = 1;
    keys[1].translation[0] = 1;
    CHECK_OK(etd_scene_set_placement_motion(of, placed, keys, 2));
    CHECK_OK(etd_scene_get_placement(of, placed, NULL, &wrong[0], NULL, NULL));
    CHECK_STATUS(etd_scene_add_group(of, NULL, wrong, 1, &number), ETD_UNSUPPORTED);
    CHECK(strstr(etd_last_error_message(), "rest in its frame") != NULL);
    CHECK_OK(etd_scene_set_placement_motion(of, placed, NULL, 0));
    CHECK_OK(etd_scene_add_group(of, NULL, wrong, 1, &number));

    /* What is refused changes nothing. */
    number = 77;
    CHECK_OK(etd_scene_remove_surface(of, parts[0]));
    CHECK_STATUS(etd_scene_add_group(of, NULL, parts, 1, &number), ETD_INVALID_SCENE);
    wrong[1] = 999;
    CHECK_STATUS(etd_scene_add_group(of, NULL, wrong, 2, &number), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_add_group(of, "two", wrong, 1, &number), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_add_group(of, NULL, wrong, 0, &number), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_place_group(of, 99, NULL, &number, NULL), ETD_INVALID_ARGUMENT);
    moved[0] = 0;
    CHECK_STATUS(etd_scene_place_group(of, group, moved, &number, NULL), ETD_INVALID_SCENE);
    memset(moved, 0, sizeof moved);
    CHECK_STATUS(etd_scene_place_group(of, group, moved, &number, NULL), ETD_INVALID_ARGUMENT);
    CHECK(number == 77 && seen_at(of, 12, NULL) == parts[1] + 2);
    CHECK_STATUS(etd_scene_get_placement(of, placed, NULL, (uint32_t *)(void *)((char *)wrong + 1), NULL, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_place_group(of, group, NULL, &number, (uint32_t *)(void *)((char *)wrong + 1)), ETD_INVALID_ARGUMENT);

    /* Groups go where they are not placed. */
    CHECK_STATUS(etd_scene_remove_group(of, group), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_remove_group(of, more));
    CHECK_STATUS(etd_scene_remove_group(of, more), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_place_group(of, more, NULL, &number, NULL), ETD_INVALID_SCENE);
    CHECK_STATUS(etd_scene_remove_group(of, 99), ETD_INVALID_ARGUMENT);
    etd_scene_release(of);
    etd_device_release(on);
}

static void picture(etd_device *on, etd_scene *of, float pixels[PIXELS(8, 8)]) {
    const etd_render_options options = short_render(4);
    etd_film *to = new_film(on, 8, 8, 0);
    CHECK_OK(etd_render(of, to, &options));
    CHECK_OK(etd_film_copy(to, ETD_LAYER_COLOR, NULL, pixels, PIXELS(8, 8) * sizeof *pixels, 0));
    etd_film_release(to);
}

/* Steps come along, and are then those of each scene. */
static void steps_are_shared(void) {
    static const double times[2] = {0, 1};
    double positions[2 * 3 * VERTICES];
    static float wanted[PIXELS(8, 8)], got[PIXELS(8, 8)];
    etd_device *on = new_device(1);
    etd_scene *first = new_scene(on), *second = new_scene(on);
    etd_shutter shutter = ETD_SHUTTER_INIT;
    etd_mesh mesh = small_mesh();
    uint32_t number = 0, other = 0;
    int i;
    mesh.positions = sail;
    mesh.position_stride = 16;
    for (i = 0; i < 2 * VERTICES; ++i) {
        const float *from = sail + 4 * (i % VERTICES);
        positions[3 * i] = from[0];
        positions[3 * i + 1] = from[1] - (i < VERTICES ? 0 : 1.5);
        positions[3 * i + 2] = 2;
    }
    shutter.close = 1;
    CHECK_OK(etd_scene_set_shutter(first, &shutter));
    CHECK_OK(etd_scene_set_shutter(second, &shutter));
    CHECK_OK(etd_scene_add_mesh(first, &mesh, &number));
    CHECK_OK(etd_scene_set_mesh_steps(first, number, times, 2, positions, NULL));
    CHECK_OK(etd_scene_add_mesh_from(second, NULL, first, number, &other));
    use_mesh(first, number);
    use_mesh(second, other);
    picture(on, first, wanted);
    picture(on, second, got);
    CHECK(memcmp(wanted, got, sizeof got) == 0);
    CHECK_OK(etd_scene_set_mesh_steps(first, number, NULL, 0, NULL, NULL));
    picture(on, first, got);
    CHECK(memcmp(wanted, got, sizeof got) != 0);
    picture(on, second, got);
    CHECK(memcmp(wanted, got, sizeof got) == 0);
    etd_scene_release(first);
    etd_scene_release(second);
    etd_device_release(on);
}

struct exchange {
    etd_scene *to, *from;
};

static void *take_meshes(void *data) {
    const struct exchange *it = data;
    int i;
    for (i = 0; i < 300; ++i) {
        uint32_t number;
        CHECK_OK(etd_scene_add_mesh_from(it->to, NULL, it->from, 0, &number));
        CHECK_OK(etd_scene_remove_mesh(it->to, number));
    }
    return NULL;
}

/* Two threads that give meshes to each other's scenes do not wait for each other. */
static void meshes_are_exchanged(void) {
    etd_device *on = new_device(1);
    etd_scene *first = new_scene(on), *second = new_scene(on);
    struct exchange exchanges[2];
    pthread_t threads[2];
    uint32_t number;
    int i;
    add_grid(first, 2, &number);
    add_grid(second, 2, &number);
    exchanges[0].to = exchanges[1].from = first;
    exchanges[0].from = exchanges[1].to = second;
    for (i = 0; i < 2; ++i) {
        CHECK(pthread_create(&threads[i], NULL, take_meshes, &exchanges[i]) == 0);
    }
    for (i = 0; i < 2; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0);
    }
    etd_scene_release(first);
    etd_scene_release(second);
    etd_device_release(on);
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Films of another size */

static void has_size(etd_film *it, uint32_t width, uint32_t height) {
    uint32_t got[2] = {0, 0};
    CHECK_OK(etd_film_get_resolution(it, &got[0], &got[1]));
    CHECK(got[0] == width && got[1] == height);
}

static void copy_film(etd_film *of, float *pixels, size_t count) {
    CHECK_OK(etd_film_copy(of, ETD_LAYER_COLOR, NULL, pixels, count * sizeof *pixels, 0));
}

static void is_black(etd_film *it, uint32_t width, uint32_t height) {
    etd_map map = ETD_MAP_INIT;
    etd_summary summary = ETD_SUMMARY_INIT;
    uint32_t share[2];
    size_t size = 0, i, lit = 0;
    has_size(it, width, height);
    CHECK_OK(etd_film_map(it, ETD_LAYER_COLOR, &map));
    CHECK(map.width == width && map.height == height && map.samples == 0);
    for (i = 0; i < PIXELS(width, height); ++i) {
        lit += map.data[i] != 0.0f;
    }
    CHECK(lit == 0);
    CHECK_OK(etd_film_unmap(it, &map));
    CHECK_STATUS(etd_film_get_summary(it, &summary), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_get_share(it, &share[0], &share[1]), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_save_memory(it, NULL, 0, &size), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_film_write(it, "misuse.png", NULL), ETD_INVALID_OPERATION);
}

/* The film is as a new one of that size, with the layers that it had, and what was mapped stays. */
static void films_get_another_size(void) {
    static const uint32_t sizes[][2] = {{24, 20}, {5, 3}, {5, 3}, {40, 8}};
    static float wanted[PIXELS(40, 20)], got[PIXELS(40, 20)], kept[PIXELS(8, 6)];
    const uint32_t layers = ETD_LAYER_NORMAL | ETD_LAYER_ALPHA;
    const etd_render_options options = short_render(3);
    etd_device *on = new_device(2);
    etd_scene *of = new_scene(on);
    etd_film *it;
    etd_map old = ETD_MAP_INIT;
    uint64_t without;
    size_t i;
    CHECK_OK(etd_scene_commit(of, NULL, NULL));
    without = memory_of(on);
    it = new_film(on, 8, 6, layers);
    CHECK_OK(etd_render(of, it, &options));
    copy_film(it, kept, PIXELS(8, 6));
    CHECK_OK(etd_film_map(it, ETD_LAYER_COLOR, &old));
    for (i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        const uint32_t width = sizes[i][0], height = sizes[i][1];
        etd_film *fresh;
        etd_map map = ETD_MAP_INIT;
        uint64_t used;
        CHECK_OK(etd_film_resize(it, width, height));
        is_black(it, width, height);
        used = memory_of(on);
        fresh = new_film(on, width, height, layers);
        CHECK(memory_of(on) - used == used - without);
        CHECK_OK(etd_render(of, fresh, &options));
        CHECK_OK(etd_render(of, it, &options));
        copy_film(fresh, wanted, PIXELS(width, height));
        copy_film(it, got, PIXELS(width, height));
        CHECK(memcmp(wanted, got, PIXELS(width, height) * sizeof *got) == 0);
        CHECK_OK(etd_film_map(it, ETD_LAYER_NORMAL, &map));
        CHECK(map.width == width && map.height == height && map.channels == 3 && map.samples == 3);
        CHECK_OK(etd_film_unmap(it, &map));
        etd_film_release(fresh);
        CHECK(memory_of(on) == used);
    }
    CHECK(old.width == 8 && old.height == 6 && memcmp(old.data, kept, sizeof kept) == 0);
    CHECK_OK(etd_film_resize(it, 40, 8));
    CHECK_OK(etd_film_unmap(it, &old));
    /* The memory of that map is not taken for images of the new size. */
    CHECK_OK(etd_render(of, it, &options));
    copy_film(it, got, PIXELS(40, 8));
    CHECK(memcmp(wanted, got, PIXELS(40, 8) * sizeof *got) == 0);

    CHECK_STATUS(etd_film_resize(it, 0, 8), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "width is 0") == etd_last_error_message());
    CHECK_STATUS(etd_film_resize(it, 8, 0), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_resize(it, UINT32_MAX, UINT32_MAX), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_film_resize(it, 1, UINT32_MAX), ETD_INVALID_ARGUMENT);
    has_size(it, 40, 8);
    copy_film(it, got, PIXELS(40, 8));
    CHECK(memcmp(wanted, got, PIXELS(40, 8) * sizeof *got) == 0);
    etd_film_release(it);
    CHECK(memory_of(on) == without);
    etd_scene_release(of);
    etd_device_release(on);
}

/* The old size does not count beside the new one, and a film that has no room stays as it is. */
static void films_have_room(void) {
    static float wanted[PIXELS(112, 112)], got[PIXELS(112, 112)];
    const etd_render_options options = short_render(1);
    etd_device_options limited = ETD_DEVICE_OPTIONS_INIT;
    etd_device *on = new_device(1);
    etd_film *it = new_film(on, 128, 128, 0);
    etd_scene *of;
    const uint64_t need = memory_of(on);
    uint64_t used, for_scene;
    etd_film_release(it);
    of = new_scene(on);
    CHECK_OK(etd_scene_commit(of, NULL, NULL));
    for_scene = memory_of(on);
    etd_scene_release(of);
    etd_device_release(on);
    limited.threads = 1;
    limited.memory_limit = need + for_scene + need / 8;
    on = NULL;
    CHECK_OK(etd_device_new(&limited, &on));
    of = new_scene(on);
    it = new_film(on, 112, 112, 0);
    CHECK_OK(etd_render(of, it, &options));
    copy_film(it, wanted, PIXELS(112, 112));
    used = memory_of(on);
    CHECK_STATUS(etd_film_resize(it, 256, 256), ETD_OUT_OF_MEMORY);
    has_size(it, 112, 112);
    CHECK(memory_of(on) == used);
    copy_film(it, got, PIXELS(112, 112));
    CHECK(memcmp(wanted, got, sizeof got) == 0);
    CHECK_OK(etd_film_save(it, "misuse.film"));
    CHECK_OK(etd_film_resize(it, 128, 128));
    is_black(it, 128, 128);
    etd_film_release(it);
    etd_scene_release(of);
    etd_device_release(on);
}

struct resizer {
    etd_film *own, *read;
    int builds, renders;
};

static int32_t resize_in_use(void *user_data, const etd_progress *progress) {
    struct resizer *it = user_data;
    if (progress->phase == ETD_PHASE_BUILD) {
        it->builds++;
        CHECK_STATUS(etd_film_resize(it->read, 4, 4), ETD_INVALID_OPERATION);
        CHECK(strstr(etd_last_error_message(), "gone on from") != NULL);
    } else {
        it->renders++;
    }
    CHECK_STATUS(etd_film_resize(it->own, 4, 4), ETD_INVALID_OPERATION);
    CHECK(strstr(etd_last_error_message(), "being rendered to") != NULL);
    return 0;
}

static int32_t stop_once(void *user_data, const etd_progress *progress) {
    int *stops = user_data;
    return progress->phase == ETD_PHASE_RENDER && ++*stops == 1;
}

/* While a render uses a film or goes on from it, and for tasks that were stopped. */
static void films_are_in_use(void) {
    static float wanted[PIXELS(16, 16)], got[PIXELS(16, 16)];
    etd_device *on = new_device(1);
    etd_scene *of = new_scene(on), *same = new_scene(on);
    etd_film *it = new_film(on, 16, 16, 0), *other = new_film(on, 16, 16, 0);
    etd_render_options options = short_render(4);
    etd_task *stopped = NULL;
    struct resizer resizer;
    uint32_t mesh;
    int stops = 0;
    add_grid(of, 60, &mesh);
    add_grid(same, 60, &mesh);
    CHECK_OK(etd_render(of, it, &options));
    memset(&resizer, 0, sizeof resizer);
    resizer.own = other;
    resizer.read = it;
    options = short_render(64);
    options.resume = it;
    options.progress = resize_in_use;
    options.user_data = &resizer;
    CHECK_OK(etd_render(same, other, &options));
    CHECK(resizer.builds > 0 && resizer.renders > 0);
    copy_film(other, wanted, PIXELS(16, 16));
    CHECK_OK(etd_film_resize(it, 4, 4)); /* nobody reads it any more */

    /* A task that was stopped goes on if the film has its size again. */
    CHECK_OK(etd_film_resize(it, 16, 16));
    options = short_render(64);
    options.progress = stop_once;
    options.user_data = &stops;
    CHECK_OK(etd_render_start(of, it, &options, &stopped));
    CHECK_STATUS(etd_task_wait(stopped, -1), ETD_CANCELLED);
    CHECK_OK(etd_film_resize(it, 8, 32));
    CHECK_STATUS(etd_task_resume(stopped), ETD_INVALID_OPERATION);
    CHECK(strstr(etd_last_error_message(), "resized to 8 x 32") != NULL);
    is_black(it, 8, 32);
    CHECK_OK(etd_film_resize(it, 16, 16));
    is_black(it, 16, 16);
    CHECK_OK(etd_task_resume(stopped));
    CHECK_OK(etd_task_wait(stopped, -1));
    copy_film(it, got, PIXELS(16, 16));
    CHECK(memcmp(wanted, got, sizeof got) == 0);
    etd_task_release(stopped);

    /* Nor is the image of a cancelled render, which nobody has asked for yet, that of the film. */
    stops = 0;
    options = short_render(1u << 20);
    options.progress = stop_once;
    options.user_data = &stops;
    CHECK_STATUS(etd_render(of, it, &options), ETD_CANCELLED);
    CHECK_OK(etd_film_resize(it, 32, 32));
    is_black(it, 32, 32);
    etd_film_release(it);
    etd_film_release(other);
    etd_scene_release(of);
    etd_scene_release(same);
    etd_device_release(on);
}

/* ------------------------------------------------------------------------------------------------------------------ */
/* Mesh files with progress */

struct reading {
    etd_scene *scene;
    double last;
    int calls;
    /* The call that says to stop; below 0: the one at the end; 0: none. */
    int stops_at;
    /* Whether a mesh is added meanwhile, and by which name. */
    int adds;
    const char *name;
};

static int32_t hear_reading(void *user_data, const etd_progress *progress) {
    struct reading *it = user_data;
    uint32_t number;
    it->calls++;
    CHECK(progress->fraction >= it->last && progress->fraction <= 1);
    it->last = progress->fraction;
    /* The scene is nobody's. */
    CHECK_OK(etd_scene_find_material(it->scene, "white", &number));
    if (it->adds && it->calls == 1) {
        etd_mesh mesh = small_mesh();
        mesh.name = it->name;
        CHECK_OK(etd_scene_add_mesh(it->scene, &mesh, &number));
    }
    return it->stops_at < 0 ? progress->fraction == 1 : it->calls == it->stops_at;
}

static void write_sheet(const char *path, int side) {
    FILE *file = fopen(path, "w");
    int x, y;
    if (!CHECK(file != NULL)) {
        exit(2);
    }
    for (y = 0; y < side; ++y) {
        for (x = 0; x < side; ++x) {
            fprintf(file, "v %d.125 %d.25 0.5\n", x, y);
        }
    }
    fprintf(file, "f 1 2\n"); /* left out with a warning */
    for (y = 0; y + 1 < side; ++y) {
        for (x = 1; x < side; ++x) {
            const int corner = y * side + x;
            fprintf(file, "f %d %d %d %d\n", corner, corner + 1, corner + side + 1, corner + side);
        }
    }
    CHECK(fclose(file) == 0);
}

static void warnings_hold(etd_scene *of, const char *text, int wanted) {
    char warnings[4096] = "";
    CHECK_OK(etd_scene_copy_text(of, ETD_TEXT_WARNINGS, warnings, sizeof warnings, NULL));
    CHECK((strstr(warnings, text) != NULL) == wanted);
}

static void mesh_files_are_watched(int quick) {
    static const char path[] = "misuse-sheet.obj";
    static const int stops[] = {1, 2, -1};
    const int side = quick ? 80 : 160; /* more than the 64 KiB that are read at once */
    etd_device *on = new_device(1);
    etd_scene *of = new_scene(on);
    struct reading reading;
    etd_mesh_info info = ETD_MESH_INFO_INIT, same = ETD_MESH_INFO_INIT;
    uint32_t number = 77, plain = 77;
    size_t i;
    write_sheet(path, side);
    memset(&reading, 0, sizeof reading);
    reading.scene = of;
    for (i = 0; i < sizeof stops / sizeof stops[0]; ++i) {
        reading.calls = 0;
        reading.last = 0;
        reading.stops_at = stops[i];
        CHECK_STATUS(etd_scene_add_mesh_file_with_progress(of, "sheet", path, hear_reading, &reading, &number), ETD_CANCELLED);
        CHECK(reading.calls > 0 && (stops[i] != 1 || reading.calls == 1));
        CHECK(number == 77 && meshes_of(of) == 0);
        CHECK_STATUS(etd_scene_find_mesh(of, "sheet", &plain), ETD_INVALID_ARGUMENT);
        warnings_hold(of, "left out", 0);
    }

    /* A name that is taken is refused before the file is read; one that is taken meanwhile, at the end. */
    reading.stops_at = reading.calls = 0;
    reading.last = 0;
    reading.adds = 1;
    reading.name = "taken";
    CHECK_STATUS(etd_scene_add_mesh_file_with_progress(of, "taken", path, hear_reading, &reading, &number), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "given twice") != NULL && number == 77 && reading.last == 1);
    reading.calls = 0;
    CHECK_STATUS(etd_scene_add_mesh_file_with_progress(of, "taken", path, hear_reading, &reading, &number), ETD_INVALID_SCENE);
    CHECK(reading.calls == 0 && meshes_of(of) == 1);

    /* Messages have the number that the mesh gets. */
    reading.last = 0;
    reading.name = NULL;
    CHECK_OK(etd_scene_add_mesh_file_with_progress(of, "sheet", path, hear_reading, &reading, &number));
    CHECK(number == 2 && reading.calls >= 2 && reading.last == 1);
    warnings_hold(of, "meshes[2].file: misuse-sheet.obj: 1 faces", 1);
    CHECK_OK(etd_scene_find_mesh(of, "sheet", &plain));
    CHECK(plain == number);
    CHECK_OK(etd_scene_add_mesh_file(of, NULL, path, &plain));
    CHECK_OK(etd_scene_add_mesh_file_with_progress(of, NULL, path, NULL, NULL, &number));
    CHECK(plain == 3 && number == 4);
    CHECK_OK(etd_scene_get_mesh(of, 2, &info));
    CHECK_OK(etd_scene_get_mesh(of, plain, &same));
    CHECK(info.vertex_count == (uint64_t)side * (uint64_t)side && info.triangle_count == same.triangle_count);

    CHECK_STATUS(etd_scene_add_mesh_file_with_progress(of, NULL, "no-such-file.obj", hear_reading, &reading, &number), ETD_IO);
    CHECK_STATUS(etd_scene_add_mesh_file_with_progress(of, NULL, "", hear_reading, &reading, &number), ETD_INVALID_SCENE);
    CHECK(number == 4 && meshes_of(of) == 5);
    remove(path);
    etd_scene_release(of);
    etd_device_release(on);
}

void misuse_hosts(int quick) {
    arrays_are_shared();
    groups_are_placed();
    steps_are_shared();
    meshes_are_exchanged();
    films_get_another_size();
    films_have_room();
    films_are_in_use();
    mesh_files_are_watched(quick);
}
