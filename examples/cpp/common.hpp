// What the examples share: arguments, and a scene.
#ifndef ETENDUE_EXAMPLES_COMMON_HPP
#define ETENDUE_EXAMPLES_COMMON_HPP

#include <etendue.hpp>

#include <cstdio>
#include <cstdlib>

// The number that is argument `index` of the program, or what it is without one.
inline std::uint32_t number_argument(int count, char **arguments, int index, std::uint32_t otherwise) {
    return count > index ? static_cast<std::uint32_t>(std::strtoul(arguments[index], nullptr, 10)) : otherwise;
}

// Runs a program and says what went wrong.
template <class F>
int reporting(F &&program) {
    try {
        program();
        return 0;
    } catch (const etd::Error &error) {
        std::fprintf(stderr, "%s: %s\n", etd_status_name(error.status()), error.what());
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}

// A floor, a glass ball, a red ball, and a lamp.
struct TwoBalls {
    etd::Scene scene;
    std::uint32_t red;  // the material
    std::uint32_t ball; // the surface

    explicit TwoBalls(const etd::Device &device)
        : scene(etd::Scene::create(device)),
          red(scene.add_material(etd::material(ETD_BSDF_LAMBERT, {0.8F, 0.1F, 0.1F}), "red")),
          ball(scene.add_sphere({1.1, 1, 0}, 1, etd::surface(red))) {
        const auto grey = scene.add_material(etd::material(ETD_BSDF_LAMBERT, {0.7F, 0.7F, 0.7F}), "floor");
        const auto glass = scene.add_material(etd::material(ETD_BSDF_DIELECTRIC), "glass");
        scene.add_quad({-6, 0, -6, -6, 0, 6, 6, 0, 6, 6, 0, -6}, etd::surface(grey));
        scene.add_sphere({-1.1, 1, 0}, 1, etd::surface(glass));
        scene.add_quad({-1, 5, -1, 1, 5, -1, 1, 5, 1, -1, 5, 1}, etd::surface(ETD_NONE, {12, 12, 12}));
        look_from({2, 3, 7});
    }

    void look_from(const etd::Vec3 &origin) {
        etd_camera camera = etd::camera();
        for (std::size_t i = 0; i < 3; ++i) {
            camera.origin[i] = origin[i];
        }
        camera.look_at[1] = 1;
        camera.look_at[2] = 0;
        camera.fov_deg = 50;
        scene.set_camera(camera);
    }
};

#endif
