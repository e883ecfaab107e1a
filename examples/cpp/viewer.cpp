// What a viewer does while an image refines: start, look at the newest image without a copy, draw, repeat; and begin
// anew at once when the user moves the camera.
//
// There is no window here: "drawing" is to print the mean brightness, and the user moves the camera after some images.
//
// Build:  c++ -std=c++17 viewer.cpp $(pkg-config --cflags --libs etendue) -o viewer
// Run:    ./viewer [WIDTH [HEIGHT [SAMPLES [MOVES]]]]
#include "common.hpp"

namespace {

void draw(const etd::Map &image) {
    double sum = 0;
    for (std::uint32_t y = 0; y < image.height(); ++y) {
        for (std::uint32_t x = 0; x < image.width(); ++x) {
            sum += static_cast<double>(image.pixel(x, y)[1]);
        }
    }
    std::printf("  %5u samples: mean brightness %.4f\n", image.samples(), sum / image.width() / image.height());
}

} // namespace

int main(int count, char **arguments) {
    return reporting([&] {
        const etd::Device device = etd::Device::create();
        TwoBalls world(device);
        etd::Film film = etd::Film::create(device, number_argument(count, arguments, 1, 160),
                                           number_argument(count, arguments, 2, 120));
        etd_render_options options = etd::render_options();
        options.samples = number_argument(count, arguments, 3, 256);
        const std::uint32_t moves = number_argument(count, arguments, 4, 3);
        for (std::uint32_t move = 0; move < moves; ++move) {
            std::printf("view %u\n", move);
            world.look_from({2.0 + move, 3, 7});
            const bool is_last = move + 1 == moves;
            etd::Task task = etd::Task::start(world.scene, film, &options);
            std::uint32_t shown = 0;
            for (;;) {
                // A frame of the user interface: here 16 ms, and an end as soon as the task ends.
                const etd_status status = task.wait(0.016);
                const etd_progress progress = task.poll().progress;
                if (progress.images != shown) {
                    shown = progress.images;
                    draw(film.map());
                }
                if (status != ETD_RUNNING) {
                    break;
                }
                if (!is_last && progress.samples_done >= 4) {
                    task.cancel(); // the user has moved the camera
                }
            }
        }
        film.write("viewer.png");
    });
}
