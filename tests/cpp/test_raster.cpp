// The raster of bundles: coverage, lists, and what they exchange.
#include <gtest/gtest.h>

#include "lumel/raster/transillumination.h"
#include "lumel/sampling/warp.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// One sweep, with what every side sends given by a function of the side.
struct Sweep {
    Window window;
    std::vector<Rgb> received;
    std::vector<uint32_t> pixels;
    SweepCounters counters;

    template <class Sent>
    Sweep(const RasterScene& raster, Vec3 direction, uint32_t resolution, Square jitter, Sent&& sent)
        : window(Window::covering(raster.scene(), direction, resolution, jitter)),
          received(raster.scene().sides()),
          pixels(raster.scene().patches()) {
        std::vector<Rgb> out(raster.scene().sides());
        for (uint32_t side = 0; side < raster.scene().sides(); ++side) out[side] = sent(side);
        Transillumination(raster).exchange(window, out, received, pixels, counters);
    }
};

}  // namespace

TEST(Raster, closed_meshes_alternate_and_give_back_uniform_radiance) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0.3f, 0.1f, 5}, 2, 3, true).sphere({0.3f, 0.1f, 5}, 1, 2, false);
    const Scene scene = b.build(5000);
    const RasterScene raster(scene);
    ASSERT_TRUE(raster.has_closed_surfaces());
    Rng rng(1);
    for (int i = 0; i < 20; ++i) {
        const Vec3 direction = square_to_sphere(square(rng));
        const Sweep sweep(raster, direction, 128, square(rng), [&](uint32_t side) { return grey(scene.is_back(side) ? 0 : 1); });
        EXPECT_EQ(sweep.counters.parity_violations, 0u);
        double front = 0, back = 0;
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
            ASSERT_EQ(sweep.received[patch].x, static_cast<float>(sweep.pixels[patch]));
            const float cos = dot(scene.geometric_normal(scene.triangle_of_patch(patch)), direction);
            (cos > 0 ? front : back) += sweep.pixels[patch];
        }
        EXPECT_NEAR(front, back, 2);
    }
}
