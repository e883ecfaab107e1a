/* Describes a scene by calls, renders it with progress, cancels, reads pixels: with OSPRay 3. */
#define _POSIX_C_SOURCE 199309L
#include <ospray/ospray.h>
#include <ospray/ospray_util.h>

#include "scene.h"

static void on_error(void *data, OSPError error, const char *message) {
    (void)data;
    fprintf(stderr, "OSPRay error %d: %s\n", error, message);
    exit(1);
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

static OSPGeometricModel model_of(OSPGeometry geometry, OSPMaterial material) {
    OSPGeometricModel model = ospNewGeometricModel(geometry);
    ospSetObject(model, "material", material);
    ospCommit(model);
    ospRelease(geometry);
    return model;
}

int main(int argc, const char **argv) {
    double start = now();
    if (ospInit(&argc, argv) != OSP_NO_ERROR) return 1;
    OSPDevice device = ospGetCurrentDevice();
    ospDeviceSetErrorCallback(device, on_error, NULL);

    OSPMaterial material = ospNewMaterial("obj");
    ospSetVec3f(material, "kd", 0.5f, 0.5f, 0.5f);
    ospCommit(material);

    OSPGeometry room = ospNewGeometry("mesh");
    OSPData vertices = array(positions, OSP_VEC3F, sizeof positions / sizeof *positions);
    OSPData indices = array(triangles, OSP_VEC3UI, sizeof triangles / sizeof *triangles);
    ospSetObject(room, "vertex.position", vertices);
    ospSetObject(room, "index", indices);
    ospCommit(room);
    OSPGeometry sphere = ospNewGeometry("sphere");
    OSPData centre = array(ball, OSP_VEC3F, 1);
    ospSetObject(sphere, "sphere.position", centre);
    ospSetFloat(sphere, "radius", ball[3]);
    ospCommit(sphere);
    OSPGeometricModel models[] = {model_of(room, material), model_of(sphere, material)};
    OSPData model_list = array(models, OSP_GEOMETRIC_MODEL, 2);
    OSPGroup group = ospNewGroup();
    ospSetObject(group, "geometry", model_list);
    ospCommit(group);
    OSPInstance instance = ospNewInstance(group);
    ospCommit(instance);
    OSPData instances = array(&instance, OSP_INSTANCE, 1);

    OSPLight light = ospNewLight("quad");
    ospSetVec3f(light, "position", lamp[0][0], lamp[0][1], lamp[0][2]);
    ospSetVec3f(light, "edge1", lamp[1][0] - lamp[0][0], 0, 0);
    ospSetVec3f(light, "edge2", 0, 0, lamp[3][2] - lamp[0][2]);
    ospSetUInt(light, "intensityQuantity", OSP_INTENSITY_QUANTITY_RADIANCE);
    ospSetFloat(light, "intensity", 10);
    ospCommit(light);
    OSPData lights = array(&light, OSP_LIGHT, 1);
    OSPWorld world = ospNewWorld();
    ospSetObject(world, "instance", instances);
    ospSetObject(world, "light", lights);
    ospCommit(world);

    OSPCamera camera = ospNewCamera("perspective");
    ospSetVec3f(camera, "position", 0, 0, 3.2f);
    ospSetVec3f(camera, "direction", 0, 0, -1);
    ospSetVec3f(camera, "up", 0, 1, 0);
    ospSetFloat(camera, "fovy", 40);
    ospCommit(camera);
    OSPRenderer renderer = ospNewRenderer("pathtracer");
    ospSetInt(renderer, "pixelSamples", 1);
    ospSetInt(renderer, "maxPathLength", 100);
    ospCommit(renderer);
    OSPFrameBuffer frame = ospNewFrameBuffer(WIDTH, HEIGHT, OSP_FB_RGBA32F, OSP_FB_COLOR | OSP_FB_ACCUM);
    ospResetAccumulation(frame);

    double first = 0;
    for (int sample = 0; sample < SAMPLES; ++sample) {
        OSPFuture future = ospRenderFrame(frame, renderer, camera, world);
        while (!ospIsReady(future, OSP_TASK_FINISHED)) {
            (void)ospGetProgress(future);
            nap(0.001);
        }
        ospWait(future, OSP_TASK_FINISHED);
        ospRelease(future);
        if (first == 0) first = now() - start;
    }
    printf("ospray: first frame after %.1f ms, %d samples after %.1f ms\n", 1e3 * first, SAMPLES, 1e3 * (now() - start));
    const void *pixels = ospMapFrameBuffer(frame, OSP_FB_COLOR);
    printf("ospray: mean %.4f\n", mean(pixels, (size_t)WIDTH * HEIGHT, 4));
    ospUnmapFrameBuffer(pixels, frame);

    static double latencies[TRIES];
    for (int i = 0; i < TRIES; ++i) {
        OSPFuture future = ospRenderFrame(frame, renderer, camera, world);
        nap(0.001 * (i % 50));
        double cancelled = now();
        ospCancel(future);
        ospWait(future, OSP_TASK_FINISHED);
        latencies[i] = now() - cancelled;
        ospRelease(future);
    }
    report("ospray", latencies);

    OSPObject objects[] = {frame, renderer, camera, world, lights, light, instances, instance, group, model_list, models[0],
                           models[1], centre, indices, vertices, material};
    for (size_t i = 0; i < sizeof objects / sizeof *objects; ++i) ospRelease(objects[i]);
    ospDeviceRelease(device);
    ospShutdown();
    return 0;
}
