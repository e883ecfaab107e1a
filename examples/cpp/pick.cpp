// Rays that the host asks for: what lies in the middle of the image, and what many rays meet.
//
// Build:  c++ -std=c++17 pick.cpp $(pkg-config --cflags --libs etendue) -o pick
// Run:    ./pick [RAYS_IN_A_ROW]
#include "common.hpp"

#include <algorithm>
#include <vector>

int main(int count, char **arguments) {
    return reporting([&] {
        const std::uint32_t row = number_argument(count, arguments, 1, 40);
        const etd::Device device = etd::Device::create();
        TwoBalls world(device);
        world.scene.commit(); // rays are asked of what was built

        const etd_camera camera = world.scene.camera();
        etd_ray one = etd::ray({}, {});
        for (std::size_t i = 0; i < 3; ++i) {
            one.origin[i] = static_cast<float>(camera.origin[i]);
            one.direction[i] = static_cast<float>(camera.look_at[i] - camera.origin[i]);
        }
        const etd_hit hit = world.scene.intersect(one);
        if (hit.surface == ETD_NONE) {
            std::puts("in the middle: nothing");
        } else {
            std::printf("in the middle: surface %u at distance %.3f\n", hit.surface, static_cast<double>(hit.t));
        }

        std::vector<etd_ray> rays;
        for (std::uint32_t y = 0; y < row / 2; ++y) {
            for (std::uint32_t x = 0; x < row; ++x) {
                rays.push_back(etd::ray({8 * (static_cast<float>(x) + 0.5F) / static_cast<float>(row) - 4, 4,
                                         16 * (static_cast<float>(y) + 0.5F) / static_cast<float>(row) - 4},
                                        {0, -1, 0}));
            }
        }
        std::vector<etd_hit> hits(rays.size());
        world.scene.intersect(rays, hits);
        const auto met = std::count_if(hits.begin(), hits.end(), [](const etd_hit &h) { return h.surface != ETD_NONE; });

        for (etd_ray &ray : rays) {
            ray.tfar = 3;
        }
        std::vector<std::uint8_t> near(rays.size());
        world.scene.occluded(rays, near);
        std::printf("%td of %zu rays met something, %td of them within 3 units\n", met, rays.size(),
                    std::count(near.begin(), near.end(), std::uint8_t{1}));
    });
}
