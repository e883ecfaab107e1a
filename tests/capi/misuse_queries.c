/* Ray queries by columns: the same hits as etd_scene_intersect whatever the memory, the threads and the choice of values, and what
 * is refused. */
#define _POSIX_C_SOURCE 200809L
#include "misuse.h"

#include <math.h>

/* More than the threads take at a time, four times over. */
#define RAYS 9001

/* What a program may have of each ray. */
struct pick {
    char name[3];
    float distance;
    double point[3];
    uint32_t surface;
    uint8_t hidden;
};

static etd_ray rays[RAYS];
static etd_hit hits[RAYS];
static uint8_t answers[RAYS];
static struct pick picks[RAYS];
static float weights[RAYS][2], uvs[RAYS][2], normals[RAYS][3], shading_normals[RAYS][3];
static uint32_t materials[RAYS], primitives[RAYS];

/* A sphere, a quad, a triangle and two meshes: one in the frame of the scene, one that its transform mirrors. */
static etd_scene *things(void) {
    static const double floor[12] = {-4, -1, -4, -4, -1, 4, 4, -1, 4, 4, -1, -4};
    static const double sail[9] = {-3, 0, 1, -2, 0, 1, -3, 2, 1};
    static const float uv[6] = {0.25f, 0.5f, 0.75f, 0.5f, 0.25f, 1};
    etd_scene *made = NULL;
    etd_material material = ETD_MATERIAL_INIT;
    etd_surface surface = matt();
    etd_mesh mesh = small_mesh();
    uint32_t number;
    int i;
    CHECK_OK(etd_scene_new(device, NULL, &made));
    CHECK_OK(etd_scene_add_material(made, "first", &material, &number));
    CHECK_OK(etd_scene_add_material(made, "second", &material, &number));
    CHECK_OK(etd_scene_add_sphere(made, centre, 1, &surface, &number));
    surface.material = 1;
    CHECK_OK(etd_scene_add_quad(made, floor, &surface, &number));
    surface.material = ETD_NONE;
    surface.emission[0] = 1;
    CHECK_OK(etd_scene_add_triangle(made, sail, &surface, &number));
    mesh.uvs = uv;
    mesh.normals = small_positions;
    CHECK_OK(etd_scene_add_mesh(made, &mesh, &number));
    for (i = 0; i < 2; ++i) {
        etd_surface placed = matt();
        placed.transform[0] = i == 0 ? 2 : -3;
        placed.transform[3] = i == 0 ? 2 : -2;
        placed.transform[11] = -1;
        CHECK_OK(etd_scene_add_mesh_surface(made, 0, 0, &placed, &number));
    }
    return made;
}

/* Rays from all around to all around, some of them long and some short. */
static void throw_rays(void) {
    uint32_t state = 1;
    int i, k;
    for (i = 0; i < RAYS; ++i) {
        float from[3], to[3];
        const float length = i % 7 == 0 ? 1e-9f : i % 5 == 0 ? 1e9f : 1;
        for (k = 0; k < 3; ++k) {
            state = state * 1664525u + 1013904223u;
            from[k] = (float)(state >> 8) / (float)(1 << 24) * 8 - 4;
            state = state * 1664525u + 1013904223u;
            to[k] = (float)(state >> 8) / (float)(1 << 24) * 4 - 2;
            rays[i].origin[k] = from[k];
            rays[i].direction[k] = (to[k] - from[k]) * length;
        }
        rays[i].tnear = i % 3 == 0 ? 0.5f / length : 0;
        rays[i].tfar = i % 4 == 0 ? 1.5f / length : (float)INFINITY;
    }
}

static etd_ray_query of_rays(void) {
    etd_ray_query query = ETD_RAY_QUERY_INIT;
    query.count = RAYS;
    query.origins = rays[0].origin;
    query.directions = rays[0].direction;
    query.tnear = &rays[0].tnear;
    query.tfar = &rays[0].tfar;
    query.origins_stride = query.directions_stride = query.tnear_stride = query.tfar_stride = sizeof rays[0];
    return query;
}

static void want_all(etd_ray_query *query) {
    query->t = &picks[0].distance;
    query->positions = picks[0].point;
    query->surfaces = &picks[0].surface;
    query->occluded = &picks[0].hidden;
    query->t_stride = query->positions_stride = query->surfaces_stride = query->occluded_stride = sizeof picks[0];
    query->barycentric = weights[0];
    query->uv = uvs[0];
    query->ng = normals[0];
    query->ns = shading_normals[0];
    query->materials = materials;
    query->primitives = primitives;
}

static void spoil(void) {
    memset(picks, 0x55, sizeof picks);
    memset(weights, 0x55, sizeof weights);
    memset(uvs, 0x55, sizeof uvs);
    memset(normals, 0x55, sizeof normals);
    memset(shading_normals, 0x55, sizeof shading_normals);
    memset(materials, 0x55, sizeof materials);
    memset(primitives, 0x55, sizeof primitives);
}

/* The columns have what etd_scene_intersect says of a ray, to the bit. */
static void compare(int i) {
    const etd_hit *hit = &hits[i];
    CHECK(memcmp(&picks[i].distance, &hit->t, sizeof hit->t) == 0);
    CHECK(picks[i].surface == hit->surface && materials[i] == hit->material && primitives[i] == hit->primitive);
    CHECK(picks[i].hidden == (hit->surface != ETD_NONE));
    CHECK(memcmp(weights[i], hit->barycentric, sizeof weights[i]) == 0 && memcmp(uvs[i], hit->uv, sizeof uvs[i]) == 0);
    CHECK(memcmp(normals[i], hit->ng, sizeof normals[i]) == 0);
    CHECK(memcmp(shading_normals[i], hit->ns, sizeof normals[i]) == 0);
    if (hit->surface != ETD_NONE) {
        int k;
        for (k = 0; k < 3; ++k) {
            const double along = rays[i].origin[k] + (double)hit->t * (double)rays[i].direction[k];
            CHECK(fabs(picks[i].point[k] - along) < 1e-5);
        }
    }
}

static void ask(etd_scene *made) {
    static const uint32_t threads[3] = {0, 1, 8};
    size_t k, met = 0;
    int i;
    CHECK_OK(etd_scene_intersect(made, rays, RAYS, hits));
    CHECK_OK(etd_scene_occluded(made, rays, RAYS, answers));
    for (i = 0; i < RAYS; ++i) {
        etd_hit alone;
        CHECK_OK(etd_scene_intersect(made, &rays[i], 1, &alone));
        CHECK(memcmp(&alone, &hits[i], sizeof alone) == 0);
        CHECK(answers[i] == (alone.surface != ETD_NONE));
        met += answers[i];
    }
    CHECK(met > RAYS / 4 && met < RAYS);
    for (k = 0; k < sizeof threads / sizeof *threads; ++k) {
        etd_ray_query query = of_rays();
        want_all(&query);
        query.threads = threads[k];
        spoil();
        CHECK_OK(etd_scene_query(made, &query));
        for (i = 0; i < RAYS; ++i) {
            compare(i);
            CHECK(picks[i].name[0] == 0x55 && picks[i].name[2] == 0x55);
        }
        /* Whether there is anything, and nothing else. */
        query = of_rays();
        query.occluded = answers;
        query.threads = threads[k];
        memset(answers, 7, sizeof answers);
        CHECK_OK(etd_scene_query(made, &query));
        for (i = 0; i < RAYS; ++i) {
            CHECK(answers[i] == (hits[i].surface != ETD_NONE));
        }
    }
}

/* Each column alone has what it has among all. */
static void ask_for_one(etd_scene *made) {
    int which, i;
    for (which = 0; which < 9; ++which) {
        etd_ray_query all = of_rays(), query = of_rays();
        want_all(&all);
        spoil();
        for (i = 0; i < RAYS; i += 16) {
            uvs[i][0] = 3;
        }
        switch (which) {
        case 0: query.t = all.t; query.t_stride = all.t_stride; break;
        case 1: query.positions = all.positions; query.positions_stride = all.positions_stride; break;
        case 2: query.surfaces = all.surfaces; query.surfaces_stride = all.surfaces_stride; break;
        case 3: query.materials = all.materials; break;
        case 4: query.primitives = all.primitives; break;
        case 5: query.barycentric = all.barycentric; break;
        case 6: query.uv = all.uv; break;
        case 7: query.ng = all.ng; break;
        default: query.ns = all.ns; break;
        }
        CHECK_OK(etd_scene_query(made, &query));
        for (i = 0; i < RAYS; ++i) {
            const etd_hit *hit = &hits[i];
            switch (which) {
            case 0: CHECK(memcmp(&picks[i].distance, &hit->t, sizeof hit->t) == 0); break;
            case 1: CHECK(hit->surface == ETD_NONE ? picks[i].point[1] == 0 : picks[i].point[1] > -1.001); break;
            case 2: CHECK(picks[i].surface == hit->surface); break;
            case 3: CHECK(materials[i] == hit->material); break;
            case 4: CHECK(primitives[i] == hit->primitive); break;
            case 5: CHECK(memcmp(weights[i], hit->barycentric, sizeof weights[i]) == 0); break;
            case 6: CHECK(memcmp(uvs[i], hit->uv, sizeof uvs[i]) == 0); break;
            case 7: CHECK(memcmp(normals[i], hit->ng, sizeof normals[i]) == 0); break;
            default: CHECK(memcmp(shading_normals[i], hit->ns, sizeof normals[i]) == 0); break;
            }
        }
    }
}

/* Rays that are not active cost nothing and change nothing; what is not given has its default. */
static void leave_out(etd_scene *made) {
    etd_ray_query query = of_rays();
    static uint8_t active[RAYS];
    int i;
    want_all(&query);
    for (i = 0; i < RAYS; ++i) {
        active[i] = i % 3 == 1 ? 255 : 0;
    }
    query.active = active;
    spoil();
    /* One that cannot be traced is not looked at either. */
    rays[0].direction[0] = (float)NAN;
    CHECK_OK(etd_scene_query(made, &query));
    for (i = 0; i < RAYS; ++i) {
        if (active[i]) {
            compare(i);
        } else {
            CHECK(picks[i].surface == 0x55555555u && picks[i].hidden == 0x55 && materials[i] == 0x55555555u);
        }
    }
    query.active = NULL;
    CHECK_STATUS(etd_scene_query(made, &query), ETD_INVALID_ARGUMENT);
    CHECK(strstr(etd_last_error_message(), "ray 0") != NULL && strstr(etd_last_error_message(), "NaN") != NULL);
    CHECK(picks[0].surface == ETD_NONE && picks[0].hidden == 0 && picks[0].distance > 1e30f);
    for (i = 1; i < RAYS; ++i) {
        compare(i);
    }
    throw_rays();
    {
        static const float from[3] = {0, 5, 0}, down[3] = {0, -1, 0};
        etd_ray_query one = ETD_RAY_QUERY_INIT;
        one.count = 1;
        one.origins = from;
        one.directions = down;
        want_all(&one);
        CHECK_OK(etd_scene_query(made, &one));
        CHECK(picks[0].distance == 3 && picks[0].surface == 0 && picks[0].point[1] == 2);
    }
}

static void refuse_columns(etd_scene *made) {
    etd_ray_query query = of_rays();
    uint32_t surfaces[2];
    float time = 0.5f;
    char bytes[64];
    want_all(&query);
#define REFUSED(change, where)                                                                                          \
    do {                                                                                                                \
        etd_ray_query wrong = query;                                                                                    \
        change;                                                                                                         \
        spoil();                                                                                                        \
        CHECK_STATUS(etd_scene_query(made, &wrong), ETD_INVALID_ARGUMENT);                                              \
        CHECK(strstr(etd_last_error_message(), where) != NULL);                                                         \
        CHECK(picks[1].surface == 0x55555555u);                                                                         \
    } while (0)
    REFUSED(wrong.origins = NULL, "query.origins");
    REFUSED(wrong.directions = NULL, "query.directions");
    REFUSED(wrong.reserved = 1, "reserved");
    REFUSED(wrong.threads = 1025, "query.threads");
    REFUSED(wrong.origins_stride = 8, "query.origins_stride");
    REFUSED(wrong.t_stride = 7, "query.t_stride");
    REFUSED(wrong.positions_stride = 28, "query.positions_stride");
    REFUSED(wrong.surfaces = (uint32_t *)(void *)(bytes + 1), "query.surfaces");
    REFUSED(wrong.positions = (double *)(void *)((char *)picks[0].point + 4), "query.positions");
    REFUSED(wrong.count = (size_t)-1, "query.origins");
    REFUSED(wrong.materials_stride = (size_t)-4, "query.materials");
#undef REFUSED
    memset(surfaces, 0, sizeof surfaces);
    {
        etd_ray_query one = of_rays();
        one.count = 1;
        one.surfaces = surfaces;
        one.times = &time;
        CHECK_OK(etd_scene_query(made, &one));
        time = 1.5f;
        CHECK_STATUS(etd_scene_query(made, &one), ETD_INVALID_ARGUMENT);
        CHECK(strstr(etd_last_error_message(), "time 1.5") != NULL && surfaces[0] == ETD_NONE && surfaces[1] == 0);
        one.count = 0;
        one.origins = NULL;
        CHECK_OK(etd_scene_query(made, &one));
    }
}

/* The camera's rays, and the layers that queries make of them. */
static void look(etd_scene *made) {
    etd_camera camera = ETD_CAMERA_INIT;
    etd_ray_query query = of_rays();
    static const float wrong[3][2] = {{-0.1f, 0}, {0, 1.1f}, {0, (float)NAN}};
    const double from[3] = {0, 1, 5};
    const uint32_t side = 31;
    uint32_t i, seen = 0, of_the_sphere = 0;
    memcpy(camera.origin, from, sizeof from);
    memcpy(camera.look_at, centre, sizeof from);
    camera.fov_deg = 60;
    CHECK_OK(etd_scene_set_camera(made, &camera));
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    CHECK_OK(etd_scene_camera_rays(made, side, side, NULL, rays));
    {
        const etd_ray *middle = &rays[side * side / 2], *corner = &rays[0], *last = &rays[side * side - 1];
        CHECK(middle->origin[2] == 5 && middle->tnear == 0 && isinf(middle->tfar));
        CHECK(fabsf(middle->direction[0]) < 1e-6f && fabsf(middle->direction[2] + 1) < 1e-6f);
        /* The first pixel is at the top left, and the image is as wide as it is high. */
        CHECK(corner->direction[0] < -0.3f && fabsf(corner->direction[0] + corner->direction[1]) < 1e-6f);
        CHECK(fabsf(corner->direction[0] + last->direction[0]) < 1e-6f && last->direction[1] < -0.3f);
    }
    query.count = side * side;
    query.surfaces = primitives;
    query.positions = picks[0].point;
    query.positions_stride = sizeof picks[0];
    CHECK_OK(etd_scene_query(made, &query));
    for (i = 0; i < side * side; ++i) {
        if (primitives[i] == 0) {
            const double *p = picks[i].point;
            of_the_sphere++;
            CHECK(fabs(p[0] * p[0] + (p[1] - 1) * (p[1] - 1) + p[2] * p[2] - 1) < 1e-5);
        }
    }
    /* A ball of radius 1 at the distance 5 fills pi / (4 tan^2(30 degrees) (5^2 - 1)) of the film, and less is hidden. */
    CHECK(of_the_sphere > 80 && of_the_sphere <= 100);
    camera.projection = ETD_CAMERA_FISHEYE;
    camera.fov_deg = 180;
    CHECK_OK(etd_scene_set_camera(made, &camera));
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    CHECK_OK(etd_scene_camera_rays(made, side, side, NULL, rays));
    for (i = 0; i < side * side; ++i) {
        seen += rays[i].tfar > 0;
    }
    CHECK(seen > 700 && seen < 800 && rays[0].tfar == 0); /* pi/4 of them */
    CHECK_OK(etd_scene_query(made, &query));
    for (i = 0; i < 3; ++i) {
        CHECK_STATUS(etd_scene_camera_rays(made, side, side, wrong[i], rays), ETD_INVALID_ARGUMENT);
    }
    CHECK_STATUS(etd_scene_camera_rays(made, 0, side, NULL, rays), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_camera_rays(made, 1 << 16, 1 << 16, NULL, rays), ETD_INVALID_ARGUMENT);
}

/* What a scene is, read back: the shapes that were added, by whatever call, and the arrays of a mesh. */
static void read_back(etd_scene *made) {
    static const etd_shape_kind kinds[6] = {ETD_SHAPE_SPHERE, ETD_SHAPE_QUAD, ETD_SHAPE_TRIANGLE,
                                            ETD_SHAPE_MESH,   ETD_SHAPE_MESH, ETD_SHAPE_QUADRIC};
    etd_scene_info info = ETD_SCENE_INFO_INIT;
    etd_shape shape = ETD_SHAPE_INIT;
    etd_mesh_info mesh = ETD_MESH_INFO_INIT;
    etd_surface surface = matt();
    double positions[9];
    float mesh_normals[9], mesh_uvs[6];
    uint32_t indices[3], number, i;
    static const double axis[3] = {1, 0, 0};
    CHECK_OK(etd_scene_add_cylinder(made, centre, axis, 0.5, 2, &surface, &number));
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    CHECK_OK(etd_scene_get_info(made, &info));
    CHECK(info.surfaces == 6 && info.meshes == 1);
    for (i = 0; i < 6; ++i) {
        CHECK_OK(etd_scene_get_shape(made, i, &shape));
        CHECK(shape.kind == kinds[i] && shape.mesh == (kinds[i] == ETD_SHAPE_MESH ? 0 : ETD_NONE));
        if (i == 0) {
            CHECK(shape.radius == 1 && memcmp(shape.centre, centre, sizeof shape.centre) == 0 && shape.frame[5] == 1);
        } else if (i == 1) {
            CHECK(shape.vertices[0] == -4 && shape.vertices[1] == -1 && shape.vertices[11] == -4);
        } else if (i == 2) {
            CHECK(shape.vertices[0] == -3 && shape.vertices[7] == 2 && shape.vertices[9] == 0);
        } else if (i == 5) {
            /* A point of its own frame that is on the quadric is on the cylinder. */
            const double *f = shape.frame, *c = shape.coefficients;
            const double radius = c[9] == 0 ? 0 : sqrt(-c[9] / c[0]), p[3] = {radius, 0, 0};
            double q[3];
            int k;
            for (k = 0; k < 3; ++k) {
                q[k] = f[4 * k] * p[0] + f[4 * k + 1] * p[1] + f[4 * k + 2] * p[2] + f[4 * k + 3];
            }
            CHECK(fabs((q[1] - 1) * (q[1] - 1) + q[2] * q[2] - 0.25) < 1e-12 && shape.clip_max[1] > shape.clip_min[1]);
        }
    }
    CHECK_OK(etd_scene_get_mesh(made, 0, &mesh));
    CHECK(mesh.vertex_count == 3 && mesh.triangle_count == 1 && mesh.has_normals == 1 && mesh.has_uvs == 1);
    CHECK_OK(etd_scene_copy_mesh(made, 0, 3, 1, positions, mesh_normals, mesh_uvs, indices));
    for (i = 0; i < 9; ++i) {
        CHECK(positions[i] == (double)small_positions[i] && mesh_normals[i] == small_positions[i]);
    }
    CHECK(mesh_uvs[0] == 0.25f && mesh_uvs[5] == 1 && memcmp(indices, small_indices, sizeof indices) == 0);
    positions[0] = 7;
    CHECK_STATUS(etd_scene_copy_mesh(made, 0, 4, 1, positions, NULL, NULL, NULL), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_copy_mesh(made, 0, 3, 1, positions, (float *)(void *)((char *)mesh_uvs + 1), NULL, NULL),
                 ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_copy_mesh(made, 1, 3, 1, positions, NULL, NULL, NULL), ETD_INVALID_ARGUMENT);
    CHECK(positions[0] == 7);
    CHECK_STATUS(etd_scene_get_shape(made, 6, &shape), ETD_INVALID_ARGUMENT);
    CHECK_STATUS(etd_scene_get_mesh(made, 1, &mesh), ETD_INVALID_ARGUMENT);
    /* A mesh without normals and texture coordinates, and a surface that is removed. */
    {
        const etd_mesh plain = small_mesh();
        CHECK_OK(etd_scene_add_mesh(made, &plain, &number));
        CHECK_OK(etd_scene_get_mesh(made, number, &mesh));
        CHECK(mesh.has_normals == 0 && mesh.has_uvs == 0);
        CHECK_STATUS(etd_scene_copy_mesh(made, number, 3, 1, positions, NULL, mesh_uvs, NULL), ETD_INVALID_ARGUMENT);
        CHECK_OK(etd_scene_copy_mesh(made, number, 3, 1, NULL, NULL, NULL, indices));
    }
    CHECK_OK(etd_scene_remove_surface(made, 1));
    CHECK_OK(etd_scene_get_shape(made, 1, &shape));
    CHECK(shape.kind == ETD_SHAPE_NONE && shape.vertices[0] == 0);
}

/* Mattes: what is refused writes nothing, names change without a build, and pixels rank what they see. */
static void trace_mattes(etd_scene *made) {
    enum { SIDE = 8, LEVELS = 3, COUNT = SIDE * SIDE * LEVELS };
    static uint32_t ids[COUNT], before[COUNT];
    static float shares[COUNT];
    etd_render_options options = short_render(16);
    etd_scene_info old = ETD_SCENE_INFO_INIT, now = ETD_SCENE_INFO_INIT;
    uint32_t ball = 0, path = 0, first = 0;
    size_t i, k, met = 0, mixed = 0;
    const struct {
        uint32_t width, height, kind, levels, samples;
    } wrong[] = {
        {0, SIDE, 0, LEVELS, 1},           {SIDE, 0, 0, LEVELS, 1},  {1u << 14, 1u << 13, 0, LEVELS, 1},
        {UINT32_MAX, UINT32_MAX, 0, 1, 1}, {SIDE, SIDE, 2, LEVELS, 1}, {SIDE, SIDE, UINT32_MAX, LEVELS, 1},
        {SIDE, SIDE, 0, 0, 1},             {SIDE, SIDE, 0, 65, 1},   {SIDE, SIDE, 0, UINT32_MAX, 1},
        {SIDE, SIDE, 0, LEVELS, 0},
    };
    memset(ids, 0x5a, sizeof ids);
    memcpy(before, ids, sizeof ids);
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        options.samples = wrong[i].samples;
        options.time_limit = wrong[i].samples == 0 ? 1 : 0;
        CHECK_STATUS(etd_scene_trace_mattes(made, wrong[i].width, wrong[i].height, &options, wrong[i].kind,
                                            wrong[i].levels, ids, shares),
                     ETD_INVALID_ARGUMENT);
    }
    CHECK(memcmp(ids, before, sizeof ids) == 0);
    options = short_render(16);
    options.seed = 3;
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    CHECK_OK(etd_scene_get_info(made, &old));
    CHECK_OK(etd_scene_set_surface_name(made, 0, "ball"));
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    CHECK_OK(etd_scene_get_info(made, &now));
    CHECK(memcmp(&old, &now, sizeof old) == 0);
    CHECK_OK(etd_matte_id("ball", &ball));
    CHECK_OK(etd_matte_id("surfaces[1]", &path));
    CHECK_OK(etd_matte_id("first", &first));
    CHECK_OK(etd_matte_id("bunny", &before[0]));
    CHECK(before[0] == 0x13851a76);
    CHECK_STATUS(etd_matte_id("\xff", &before[0]), ETD_INVALID_ARGUMENT);
    CHECK_OK(etd_scene_trace_mattes(made, SIDE, SIDE, &options, ETD_MATTE_OBJECT, LEVELS, ids, shares));
    for (i = 0; i < COUNT; i += LEVELS) {
        float sum = 0;
        for (k = 0; k < LEVELS; ++k) {
            const float share = shares[i + k];
            CHECK((share > 0) == (ids[i + k] != 0) && share * 16 == (float)(int)(share * 16));
            CHECK(k == 0 || share <= shares[i + k - 1]);
            met += ids[i + k] == ball || ids[i + k] == path;
            sum += share;
        }
        mixed += shares[i + 1] > 0;
        CHECK(sum <= 1);
    }
    CHECK(met > 0 && mixed > 0);
    CHECK_OK(etd_scene_trace_mattes(made, SIDE, SIDE, &options, ETD_MATTE_MATERIAL, LEVELS, ids, shares));
    for (i = 0, met = 0; i < COUNT; ++i) {
        met += ids[i] == first;
    }
    CHECK(met > 0);
    CHECK_OK(etd_scene_set_surface_name(made, 0, ""));
}

/* The threads of a host: they run what they are given at once, and the first gives back the last references that the host has. */
static struct {
    etd_device *device;
    etd_scene *scene;
    int jobs;
} given;

static void submit(void *user_data, etd_work_fn work, void *argument) {
    (void)user_data;
    given.jobs++;
    etd_scene_release(given.scene);
    etd_device_release(given.device);
    given.scene = NULL;
    given.device = NULL;
    work(argument);
}

static void ask_on_host_threads(void) {
    etd_device_options options = ETD_DEVICE_OPTIONS_INIT;
    etd_ray_query query = of_rays();
    etd_device *own = device;
    size_t met = 0;
    int i;
    options.threads = 4;
    options.submit = submit;
    CHECK_OK(etd_device_new(&options, &given.device));
    device = given.device;
    given.scene = things();
    device = own;
    CHECK_OK(etd_scene_commit(given.scene, NULL, NULL));
    throw_rays();
    rays[RAYS - 1].direction[1] = (float)NAN;
    query.threads = 4;
    query.surfaces = primitives;
    given.jobs = 0;
    CHECK_STATUS(etd_scene_query(given.scene, &query), ETD_INVALID_ARGUMENT);
    CHECK(given.jobs > 0 && given.scene == NULL && strstr(etd_last_error_message(), "ray 9000") != NULL);
    for (i = 0; i < RAYS - 1; ++i) {
        CHECK((primitives[i] == ETD_NONE) == (hits[i].surface == ETD_NONE));
        met += primitives[i] != ETD_NONE;
    }
    CHECK(met > RAYS / 4 && primitives[RAYS - 1] == ETD_NONE);
    throw_rays();
}

void misuse_queries(void) {
    etd_scene *made = things();
    etd_ray_query query = of_rays();
    throw_rays();
    CHECK_STATUS(etd_scene_query(made, &query), ETD_INVALID_OPERATION);
    CHECK_STATUS(etd_scene_camera_rays(made, 2, 2, NULL, rays), ETD_INVALID_OPERATION);
    CHECK_OK(etd_scene_commit(made, NULL, NULL));
    ask(made);
    ask_on_host_threads();
    ask_for_one(made);
    leave_out(made);
    refuse_columns(made);
    look(made);
    read_back(made);
    trace_mattes(made);
    etd_scene_release(made);
}
