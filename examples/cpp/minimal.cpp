// The smallest render: a scene file in, an image out.
//
// Build:  c++ -std=c++17 minimal.cpp $(pkg-config --cflags --libs etendue) -o minimal
// Run:    ./minimal scenes/room.json room.png [SAMPLES]
#include <cstdlib>
#include <etendue.hpp>

int main(int count, char **arguments) {
    if (count < 3) {
        std::fputs("usage: minimal SCENE IMAGE [SAMPLES]\n", stderr);
        return 2;
    }
    try {
        const etd::Device device = etd::Device::create();
        etd::Scene scene = etd::Scene::from_file(device, arguments[1]);
        const auto [width, height] = scene.resolution();
        etd::Film film = etd::Film::create(device, width, height);
        etd_render_options options = scene.render_options();
        if (count > 3) {
            options.samples = static_cast<std::uint32_t>(std::atoi(arguments[3]));
        }
        etd::render(scene, film, options);
        film.write(arguments[2]);
    } catch (const etd::Error &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
