/* What the parts of the test of misuse share. */
#ifndef ETENDUE_TESTS_MISUSE_H
#define ETENDUE_TESTS_MISUSE_H

#include "check.h"

/* What wrong calls are made on: built, rendered, ended; the mesh is called "grid" and is used. */
extern etd_device *device;
extern etd_scene *scene;
extern etd_film *film;
extern etd_task *task;
extern etd_atlas *atlas;
extern uint32_t mesh_number;

/* Wrong values in arguments and structures. */
void misuse_values(void);

/* Settings of photon maps and caches. */
void misuse_photons(void);

/* Keyframes, shutters and steps, in misuse_motion.c. */
void misuse_motion(void);
/* Cameras and lenses, in misuse_cameras.c. */
void misuse_cameras(void);

/* Texels along a side of the atlas. */
#define MISUSE_SIDE 64

/* Light maps. `quick`: small ones. */
void misuse_bake(int quick);

/* Illuminance and luminance, in misuse_lighting.c. */
void misuse_lighting(void);

/* Where errors say that something is wrong, in misuse_errors.c. */
void misuse_errors(void);

/* Ray queries by columns, in misuse_queries.c. */
void misuse_queries(void);

/* The caller's floating-point state, in misuse_float.c. */
void misuse_float(void);

/* Meshes of two scenes, films that get another size and mesh files with progress, in misuse_hosts.c. `quick`: a small file. */
void misuse_hosts(int quick);

/* What goes wrong over time: states, orders, threads, callbacks. `quick`: with few repetitions. */
void misuse_life(int quick);

/* Right arguments, to be spoiled one at a time. */
static const double ones[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const double triangle_vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static const double quad_vertices[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const double unit_ball[10] = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1};
static const double low[3] = {-2, -2, -2};
static const double high[3] = {2, 2, 2};
static const double up_axis[3] = {0, 1, 0};
static const double centre[3] = {0, 1, 0};
static const float grey[3] = {0.5f, 0.5f, 0.5f};
static const float small_positions[10] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
static const uint32_t small_indices[3] = {0, 1, 2};

static inline etd_mesh small_mesh(void) {
    etd_mesh mesh = ETD_MESH_INIT;
    mesh.positions = small_positions;
    mesh.vertex_count = 3;
    mesh.indices = small_indices;
    mesh.triangle_count = 1;
    return mesh;
}

static const float small_texels[16];

static inline etd_texture small_texture(void) {
    etd_texture texture = ETD_TEXTURE_INIT;
    texture.texels = small_texels;
    texture.width = texture.height = 2;
    texture.channels = 4;
    return texture;
}

static inline etd_surface matt(void) {
    etd_surface surface = ETD_SURFACE_INIT;
    surface.material = 0;
    return surface;
}

#define JSON_CAMERA "\"camera\": {\"origin\": [0, 0, 4], \"lookAt\": [0, 0, 0], \"up\": [0, 1, 0], \"fieldOfView\": 60}"
static const char one_sphere[] =
    "{\"etendue\": 1, " JSON_CAMERA ", \"surfaces\": [{\"geometry\": \"sphere\", \"origin\": [0, 0, 0], \"radius\": 1, "
    "\"emission\": [1, 1, 1]}]}";

#endif
