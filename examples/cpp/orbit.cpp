// A scene that changes: the camera goes round, a ball moves and changes colour; every frame is rendered anew, and only
// what has changed is built again.
//
// Build:  c++ -std=c++17 orbit.cpp $(pkg-config --cflags --libs etendue) -o orbit
// Run:    ./orbit [FRAMES [WIDTH [HEIGHT [SAMPLES]]]]; writes orbit-000.png and so on
#include "common.hpp"

#include <cmath>

int main(int count, char **arguments) {
    return reporting([&] {
        const std::uint32_t frames = number_argument(count, arguments, 1, 8);
        const etd::Device device = etd::Device::create();
        TwoBalls world(device);
        etd::Film film = etd::Film::create(device, number_argument(count, arguments, 2, 320),
                                           number_argument(count, arguments, 3, 240));
        etd_render_options options = etd::render_options();
        options.samples = number_argument(count, arguments, 4, 16);
        for (std::uint32_t frame = 0; frame < frames; ++frame) {
            const double part = static_cast<double>(frame) / frames;
            const double angle = 6.283185307179586 * part;
            world.look_from({7 * std::sin(angle), 3, 7 * std::cos(angle)});
            world.scene.set_transform(world.ball, {1, 0, 0, 0, 0, 1, 0, 0.8 * std::fabs(std::sin(2 * angle)), 0, 0, 1, 0});
            etd_material red = world.scene.material(world.red);
            red.color[1] = static_cast<float>(part);
            world.scene.set_material(world.red, red);

            double first_pass = -1;
            etd::render(world.scene, film, options, [&](const etd_progress &progress) {
                if (progress.samples_done > 0 && first_pass < 0) {
                    first_pass = progress.elapsed;
                }
                return true;
            });
            const etd_summary summary = film.summary();
            std::printf("frame %u: built in %.2f ms, first pass after %.1f ms, done after %.1f ms\n", frame,
                        1e3 * summary.build_time, 1e3 * first_pass, 1e3 * (summary.build_time + summary.elapsed));
            char path[32];
            std::snprintf(path, sizeof path, "orbit-%03u.png", frame);
            film.write(path);
        }
    });
}
