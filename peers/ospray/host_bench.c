/* Keeps one scene, written by dump.py, in OSPRay 3 and renders it as often as it is told, for ../bench.py.
 *
 *   host_bench FOLDER THREADS
 *
 * A line of JSON in, {"spp", "seed", "output"}, makes a PFM file and a line out, {"spp", "seconds", "cpu"}. The first line
 * out, when the scene is committed and one frame is drawn, has the version. OSPRay takes no seed: its random numbers follow
 * from the number of the frame. So frames are counted on from render to render, and an image is the difference of two
 * sums. */
#define _POSIX_C_SOURCE 200809L
#include <ospray/ospray.h>
#include <ospray/ospray_util.h>
#include <ospray/version.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 65536, MAX_PATH = 1024 };

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void fail(const char *what, const char *about) {
    fprintf(stderr, "error: %s %s\n", what, about);
    exit(1);
}

static void on_error(void *data, OSPError error, const char *message) {
    (void)data;
    (void)error;
    fail("OSPRay:", message);
}

static void *memory(size_t size) {
    void *bytes = malloc(size ? size : 1);
    if (!bytes) fail("no memory", "");
    return bytes;
}

static OSPData array(const void *items, OSPDataType type, uint64_t count) {
    OSPData shared = ospNewSharedData1D(items, type, count);
    OSPData data = ospNewData1D(type, count);
    ospCommit(shared);
    ospCopyData1D(shared, data, 0);
    ospRelease(shared);
    ospCommit(data);
    return data;
}

static void set_array(OSPObject object, const char *name, const void *items, OSPDataType type, uint64_t count) {
    OSPData data = array(items, type, count);
    ospSetObject(object, name, data);
    ospRelease(data);
}

static OSPMaterial material_of(const char *kind, const float *v) {
    OSPMaterial material;
    if (!strcmp(kind, "diffuse")) {
        material = ospNewMaterial("obj");
        ospSetVec3f(material, "kd", v[0], v[1], v[2]);
    } else if (!strcmp(kind, "mirror")) {
        /* The same reflectance at all angles. */
        material = ospNewMaterial("alloy");
        ospSetVec3f(material, "color", v[0], v[1], v[2]);
        ospSetVec3f(material, "edgeColor", v[0], v[1], v[2]);
        ospSetFloat(material, "roughness", 0);
    } else if (!strcmp(kind, "glass")) {
        material = ospNewMaterial("glass");
        ospSetFloat(material, "etaInside", v[0]);
        ospSetFloat(material, "etaOutside", v[1]);
    } else {
        material = ospNewMaterial("luminous");
        ospSetVec3f(material, "color", v[0], v[1], v[2]);
        ospSetFloat(material, "intensity", 1);
    }
    ospCommit(material);
    return material;
}

static OSPGeometry mesh_of(const char *folder, const char *name, size_t vertices, size_t triangles, bool normals) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    float *positions = memory(12 * vertices), *directions = memory(12 * vertices);
    uint32_t *indices = memory(12 * triangles);
    if (!file || fread(positions, 12, vertices, file) != vertices || fread(indices, 12, triangles, file) != triangles ||
        (normals && fread(directions, 12, vertices, file) != vertices))
        fail("cannot read", path);
    fclose(file);
    OSPGeometry mesh = ospNewGeometry("mesh");
    set_array(mesh, "vertex.position", positions, OSP_VEC3F, vertices);
    set_array(mesh, "index", indices, OSP_VEC3UI, triangles);
    if (normals) set_array(mesh, "vertex.normal", directions, OSP_VEC3F, vertices);
    ospCommit(mesh);
    free(positions);
    free(directions);
    free(indices);
    return mesh;
}

static int width, height;
static OSPCamera camera;

/* World of the scene in the folder; also sets size and camera. */
static OSPWorld world_of(const char *folder) {
    static OSPMaterial materials[MOST];
    static OSPGeometricModel models[MOST];
    size_t material_count = 0, model_count = 0;
    char path[4096], word[64], kind[64], name[256];
    snprintf(path, sizeof path, "%s/scene.txt", folder);
    FILE *file = fopen(path, "r");
    if (!file) fail("cannot read", path);
    while (fscanf(file, "%63s", word) == 1) {
        float v[11];
        int number = 0, normals = 0, count = 0;
        size_t vertices = 0, triangles = 0;
        OSPGeometry geometry = NULL;
        if (model_count == MOST || material_count == MOST) fail("too many objects in", path);
        if (!strcmp(word, "image")) {
            if (fscanf(file, "%d %d", &width, &height) != 2) fail("bad image in", path);
        } else if (!strcmp(word, "camera")) {
            for (int i = 0; i < 11; ++i) count += fscanf(file, "%f", &v[i]);
            if (count != 11) fail("bad camera in", path);
            camera = ospNewCamera("perspective");
            ospSetVec3f(camera, "position", v[0], v[1], v[2]);
            ospSetVec3f(camera, "direction", v[3], v[4], v[5]);
            ospSetVec3f(camera, "up", v[6], v[7], v[8]);
            ospSetFloat(camera, "fovy", v[9]);
            ospSetFloat(camera, "aspect", v[10]);
            ospCommit(camera);
        } else if (!strcmp(word, "material")) {
            if (fscanf(file, "%63s %f %f %f", kind, &v[0], &v[1], &v[2]) != 4) fail("bad material in", path);
            materials[material_count++] = material_of(kind, v);
        } else if (!strcmp(word, "sphere")) {
            if (fscanf(file, "%d %f %f %f %f", &number, &v[0], &v[1], &v[2], &v[3]) != 5) fail("bad sphere in", path);
            geometry = ospNewGeometry("sphere");
            set_array(geometry, "sphere.position", v, OSP_VEC3F, 1);
            ospSetFloat(geometry, "radius", v[3]);
            ospCommit(geometry);
        } else if (!strcmp(word, "mesh")) {
            if (fscanf(file, "%d %zu %zu %d %255s", &number, &vertices, &triangles, &normals, name) != 5)
                fail("bad mesh in", path);
            geometry = mesh_of(folder, name, vertices, triangles, normals);
        } else {
            fail("unknown word in", path);
        }
        if (geometry) {
            if (number < 0 || (size_t)number >= material_count) fail("unknown material in", path);
            models[model_count] = ospNewGeometricModel(geometry);
            ospSetObject(models[model_count], "material", materials[number]);
            ospCommit(models[model_count++]);
            ospRelease(geometry);
        }
    }
    fclose(file);
    OSPGroup group = ospNewGroup();
    set_array(group, "geometry", models, OSP_GEOMETRIC_MODEL, model_count);
    ospCommit(group);
    OSPInstance instance = ospNewInstance(group);
    ospCommit(instance);
    OSPWorld world = ospNewWorld();
    set_array(world, "instance", &instance, OSP_INSTANCE, 1);
    ospCommit(world);
    return world;
}

int main(int argc, const char **argv) {
    if (argc != 3) fail("usage: host_bench FOLDER THREADS", "");
    /* Lines of our own only go to standard output. */
    int init_count = 1;
    if (ospInit(&init_count, argv) != OSP_NO_ERROR) fail("OSPRay does not start", "");
    OSPDevice device = ospGetCurrentDevice();
    ospDeviceSetParam(device, "numThreads", OSP_INT, &(int){atoi(argv[2])});
    ospDeviceCommit(device);
    ospDeviceSetErrorCallback(device, on_error, NULL);

    OSPWorld world = world_of(argv[1]);
    OSPRenderer renderer = ospNewRenderer("pathtracer");
    ospSetInt(renderer, "pixelSamples", 1);
    ospSetInt(renderer, "maxPathLength", MAX_PATH);
    ospSetInt(renderer, "maxScatteringEvents", MAX_PATH);
    ospSetFloat(renderer, "minContribution", 0);
    ospSetInt(renderer, "lightSamples", 1);
    ospSetUInt(renderer, "pixelFilter", OSP_PIXELFILTER_BOX);
    ospSetVec4f(renderer, "backgroundColor", 0, 0, 0, 1);
    ospCommit(renderer);
    OSPFrameBuffer frame = ospNewFrameBuffer(width, height, OSP_FB_RGBA32F, OSP_FB_COLOR | OSP_FB_ACCUM);
    ospResetAccumulation(frame);
    ospWait(ospRenderFrame(frame, renderer, camera, world), OSP_TASK_FINISHED);
    ospResetAccumulation(frame);

    size_t pixels = (size_t)width * (size_t)height;
    double *before = memory(3 * pixels * sizeof *before);
    float *image = memory(3 * pixels * sizeof *image);
    memset(before, 0, 3 * pixels * sizeof *before);
    printf("{\"version\": \"%d.%d.%d\"}\n", OSPRAY_VERSION_MAJOR, OSPRAY_VERSION_MINOR, OSPRAY_VERSION_PATCH);
    fflush(stdout);
    long done = 0;
    char line[8192], output[4096];
    while (fgets(line, sizeof line, stdin)) {
        long spp = 0;
        const char *at = strstr(line, "\"spp\": "), *to = strstr(line, "\"output\": \"");
        if (!at || !to || sscanf(at + 7, "%ld", &spp) != 1 || sscanf(to + 11, "%4095[^\"]", output) != 1)
            fail("cannot read the order", line);
        double start = now();
        clock_t busy = clock();
        for (long i = 0; i < spp; ++i) {
            OSPFuture future = ospRenderFrame(frame, renderer, camera, world);
            ospWait(future, OSP_TASK_FINISHED);
            ospRelease(future);
        }
        const float *mean = ospMapFrameBuffer(frame, OSP_FB_COLOR);
        double seconds = now() - start, cpu = (double)(clock() - busy) / CLOCKS_PER_SEC;
        done += spp;
        for (size_t i = 0; i < pixels; ++i)
            for (size_t c = 0; c < 3; ++c) {
                double sum = (double)mean[4 * i + c] * (double)done;
                image[3 * i + c] = (float)((sum - before[3 * i + c]) / (double)spp);
                before[3 * i + c] = sum;
            }
        ospUnmapFrameBuffer(mean, frame);
        FILE *file = fopen(output, "wb");
        if (!file) fail("cannot write", output);
        fprintf(file, "PF\n%d %d\n-1.0\n", width, height);
        fwrite(image, 12, pixels, file);
        fclose(file);
        printf("{\"spp\": %ld, \"seconds\": %.6f, \"cpu\": %.6f}\n", spp, seconds, cpu);
        fflush(stdout);
    }
    return 0;
}
