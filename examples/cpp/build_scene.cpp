// A scene made by calls from the host's arrays: one mesh copied, one read in place and kept by a shared_ptr; a progress
// bar; a time budget.
//
// Build:  c++ -std=c++17 build_scene.cpp $(pkg-config --cflags --libs etendue) -o build_scene
// Run:    ./build_scene [IMAGE [WIDTH [HEIGHT [SAMPLES [SECONDS]]]]]
#include "common.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace {

// The host's own kind of mesh.
struct Ground {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;

    explicit Ground(std::uint32_t n) {
        for (std::uint32_t y = 0; y <= n; ++y) {
            for (std::uint32_t x = 0; x <= n; ++x) {
                const float u = 12.0F * static_cast<float>(x) / static_cast<float>(n) - 6;
                const float w = 12.0F * static_cast<float>(y) / static_cast<float>(n) - 6;
                positions.insert(positions.end(), {u, 0.2F * std::sin(2 * u) * std::cos(2 * w), w});
            }
        }
        positions.push_back(0); // 16 bytes must be readable from the last position on
        for (std::uint32_t y = 0; y < n; ++y) {
            for (std::uint32_t x = 0; x < n; ++x) {
                const std::uint32_t corner = y * (n + 1) + x;
                indices.insert(indices.end(), {corner, corner + n + 1, corner + 1});
                indices.insert(indices.end(), {corner + 1, corner + n + 1, corner + n + 2});
            }
        }
    }
};

} // namespace

int main(int count, char **arguments) {
    return reporting([&] {
        const std::string image = count > 1 ? arguments[1] : "build_scene.png";
        const double seconds = count > 5 ? std::atof(arguments[5]) : 20;
        const etd::Device device = etd::Device::create();
        etd::Scene scene = etd::Scene::create(device);
        etd_camera camera = etd::camera();
        camera.origin[0] = 3;
        camera.origin[1] = 4;
        camera.origin[2] = 7;
        camera.look_at[1] = 1;
        camera.look_at[2] = 0;
        camera.fov_deg = 50;
        scene.set_camera(camera);

        const auto sand = scene.add_material(etd::material(ETD_BSDF_LAMBERT, {0.7F, 0.6F, 0.4F}), "sand");
        const auto red = scene.add_material(etd::material(ETD_BSDF_LAMBERT, {0.7F, 0.15F, 0.1F}), "red");

        auto ground = std::make_shared<const Ground>(64);
        const std::weak_ptr<const Ground> watch = ground;
        const auto mesh = scene.add_mesh(etd::mesh(ground->positions, ground->indices), ground);
        scene.add_mesh_surface(mesh, true, etd::surface(sand));
        ground.reset(); // the scene has it

        const std::vector<double> corners = {-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1, 0, 1.6, 0};
        const std::vector<std::uint32_t> faces = {1, 0, 4, 2, 1, 4, 3, 2, 4, 0, 3, 4};
        const auto pyramid = scene.add_mesh(etd::mesh(corners, faces));
        for (const double x : {-2.0, 0.0, 2.0}) {
            etd_surface surface = etd::surface(red);
            surface.transform[3] = x;
            surface.transform[7] = -0.3;
            scene.add_mesh_surface(pyramid, false, surface);
        }
        scene.add_point_light({{4, 6, 5}, {300, 280, 250}});

        etd::Film film = etd::Film::create(device, number_argument(count, arguments, 2, 480),
                                           number_argument(count, arguments, 3, 320));
        etd_render_options options = etd::render_options();
        options.samples = number_argument(count, arguments, 4, 64);
        const etd_status status = etd::render(scene, film, options, [&](const etd_progress &progress) {
            const int done = static_cast<int>(40 * progress.fraction);
            std::fprintf(stderr, "\r[%s%s] %3.0f %%", std::string(static_cast<std::size_t>(done), '#').c_str(),
                         std::string(static_cast<std::size_t>(40 - done), ' ').c_str(), 100 * progress.fraction);
            return progress.elapsed < seconds;
        });
        std::fputs(status == ETD_CANCELLED ? "\nthe time is up\n" : "\n", stderr);
        film.write(image);
        std::printf("the ground is %s\n", watch.expired() ? "gone" : "in use");
    });
}
