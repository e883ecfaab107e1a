/* Motion: keyframes out of order and out of range, shutters that close before they open, steps of meshes, and things that are
 * removed. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

static void refuse_keys(etd_status wanted, const etd_motion_key *keys, size_t count, const char *word) {
    CHECK_STATUS(etd_scene_set_surface_motion(scene, 0, keys, count), wanted);
    CHECK(strstr(etd_last_error_message(), word) != NULL);
    CHECK_STATUS(etd_scene_set_camera_motion(scene, keys, count), wanted);
    CHECK_STATUS(etd_scene_set_light_motion(scene, 0, keys, count), wanted);
}

static void pass_keys(void) {
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e39};
    etd_motion_key keys[2] = {ETD_MOTION_KEY_INIT, ETD_MOTION_KEY_INIT};
    size_t k;
    keys[1].time = 1;
    keys[1].translation[0] = 0.25;
    CHECK_OK(etd_scene_set_surface_motion(scene, 0, keys, 2));
    CHECK_OK(etd_scene_set_camera_motion(scene, keys, 2));
    CHECK_OK(etd_scene_set_light_motion(scene, 0, keys, 2));
    for (k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
        etd_motion_key wrong[2];
        memcpy(wrong, keys, sizeof wrong);
        wrong[1].time = bad[k];
        refuse_keys(ETD_INVALID_SCENE, wrong, 2, "[1].time");
        memcpy(wrong, keys, sizeof wrong);
        wrong[0].translation[1] = bad[k];
        refuse_keys(ETD_INVALID_SCENE, wrong, 2, "[0].translate[1]");
        memcpy(wrong, keys, sizeof wrong);
        wrong[0].rotation[3] = bad[k];
        refuse_keys(ETD_INVALID_SCENE, wrong, 2, "[0].quaternion");
        memcpy(wrong, keys, sizeof wrong);
        wrong[0].scale[2] = bad[k];
        refuse_keys(ETD_INVALID_SCENE, wrong, 2, "[0].scale[2]");
        memcpy(wrong, keys, sizeof wrong);
        wrong[0].use_matrix = 1;
        wrong[0].matrix[5] = bad[k];
        CHECK(etd_scene_set_surface_motion(scene, 0, wrong, 2) == ETD_INVALID_SCENE || bad[k] == 1e39);
    }
    keys[1].time = 0;
    refuse_keys(ETD_INVALID_SCENE, keys, 2, "not later than the key before");
    keys[1].time = 1;
    keys[1].scale[0] = 0;
    refuse_keys(ETD_INVALID_SCENE, keys, 2, "flattens");
    keys[1].scale[0] = -1;
    refuse_keys(ETD_INVALID_SCENE, keys, 2, "flattened between the keys 0 and 1");
    keys[1].scale[0] = 2;
    CHECK_OK(etd_scene_set_surface_motion(scene, 0, keys, 2));
    CHECK_STATUS(etd_scene_set_camera_motion(scene, keys, 2), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "camera.motion[1]") != NULL);
    keys[1].reserved = 1;
    refuse_keys(ETD_INVALID_ARGUMENT, keys, 2, "reserved");
    refuse_keys(ETD_INVALID_ARGUMENT, keys, SIZE_MAX, "more than any memory");
    CHECK_STATUS(etd_scene_set_surface_motion(scene, ETD_NONE, keys, 1), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_light_motion(scene, ETD_NONE, keys, 1), ETD_INVALID_ARGUMENT);
    /* None is rest, and NULL is none. */
    CHECK_OK(etd_scene_set_surface_motion(scene, 0, NULL, 0));
    CHECK_OK(etd_scene_set_camera_motion(scene, NULL, 0));
    CHECK_OK(etd_scene_set_light_motion(scene, 0, NULL, 0));
}

static void pass_shutter(void) {
    const double curve[] = {0, 1, 0};
    const double closed[] = {0, 0};
    etd_shutter shutter = ETD_SHUTTER_INIT, now = ETD_SHUTTER_INIT;
    shutter.open = 0.25;
    shutter.close = 0.5;
    shutter.curve = curve;
    shutter.curve_count = 3;
    CHECK_OK(etd_scene_set_shutter(scene, &shutter));
    CHECK_OK(etd_scene_get_shutter(scene, &now));
    CHECK(now.open == 0.25 && now.close == 0.5 && now.curve == NULL && now.curve_count == 3);
    shutter.close = 0;
    CHECK_STATUS(etd_scene_set_shutter(scene, &shutter), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "camera.shutter.close") != NULL);
    shutter.close = NAN;
    CHECK_STATUS(etd_scene_set_shutter(scene, &shutter), ETD_INVALID_SCENE);
    shutter.close = 0.5;
    shutter.curve_count = 1;
    CHECK_STATUS(etd_scene_set_shutter(scene, &shutter), ETD_INVALID_SCENE);
    shutter.curve = closed;
    shutter.curve_count = 2;
    CHECK_STATUS(etd_scene_set_shutter(scene, &shutter), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "never open") != NULL);
    shutter.curve = NULL;
    CHECK_STATUS(etd_scene_set_shutter(scene, &shutter), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_get_shutter(scene, &now));
    CHECK(now.close == 0.5 && now.curve_count == 3);
    shutter.open = shutter.close = 0;
    shutter.curve_count = 0;
    CHECK_OK(etd_scene_set_shutter(scene, &shutter));
}

static void pass_steps(void) {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[3] = {0, 1, 2};
    const double times[2] = {0, 1};
    const double late[2] = {1, 1};
    double positions[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
    float normals[18] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    etd_mesh mesh = ETD_MESH_INIT;
    uint32_t number = 0;
    mesh.positions = corners;
    mesh.vertex_count = 3;
    mesh.indices = triangle;
    mesh.triangle_count = 1;
    CHECK_OK(etd_scene_add_mesh(scene, &mesh, &number));
    CHECK_OK(etd_scene_set_mesh_steps(scene, number, times, 2, positions, normals));
    CHECK_OK(etd_scene_set_mesh_steps(scene, number, times, 2, positions, NULL));
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, number, late, 2, positions, NULL), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "steps[1].time") != NULL);
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, number, NULL, 2, positions, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, number, times, 2, NULL, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, ETD_NONE, times, 2, positions, NULL), ETD_INVALID_ARGUMENT);
    positions[7] = NAN;
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, number, times, 2, positions, NULL), ETD_INVALID_SCENE);
    CHECK(strstr(etd_last_error_message(), "steps[0].positions[2][1]") != NULL);
    positions[7] = 1;
    normals[9] = INFINITY;
    CHECK_STATUS(etd_scene_set_mesh_steps(scene, number, times, 2, positions, normals), ETD_INVALID_SCENE);
    CHECK_OK(etd_scene_set_mesh_steps(scene, number, NULL, 0, NULL, NULL));
    CHECK_OK(etd_scene_remove_mesh(scene, number));
}

void misuse_motion(void) {
    pass_keys();
    pass_shutter();
    pass_steps();
}
