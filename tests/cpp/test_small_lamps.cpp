// Lamps smaller than pixels have all of their light in the picture.
#include <gtest/gtest.h>

#include <numeric>

#include "lumel/eye/small_lamps.h"
#include "scenes.h"

namespace lumel::test {

namespace {

constexpr uint32_t kWidth = 48, kHeight = 32;
constexpr float kLight = 7;

Camera camera() {
    return {.origin = {0, 0, 0},
            .right = {1, 0, 0},
            .up = {0, 1, 0},
            .forward = {0, 0, -1},
            .tan_x = 0.6f,
            .tan_y = 0.4f,
            .width = kWidth,
            .height = kHeight};
}

/// A lamp, seen from its front, whose corner is at `corner`, and what stands before it.
Scene scene_with(Vec3 corner, Vec3 u, Vec3 v, bool half_hidden) {
    SceneBuilder b;
    const uint32_t black = b.material(matt(0));
    b.shape(black, grey(kLight)).quad(corner, u, v);
    if (half_hidden) b.shape(black).quad(corner * 0.5f, u * 0.25f, v * 0.5f);
    return b.build(100);
}

/// Emission of all pixels, by passes of two samples.
std::vector<float> picture(const Scene& scene, uint32_t passes) {
    const Accel accel(scene);
    const Camera eye = camera();
    const SmallLamps lamps(scene, eye);
    std::vector<float> sum(size_t{kWidth} * kHeight);
    for (uint32_t number = 0; number < passes; ++number) {
        std::vector<PixelPass> pass(sum.size());
        // Pixels differ in their samples, and have the same radiance all the same.
        for (uint32_t pixel = 0; pixel < pass.size(); ++pixel) pass[pixel].samples = 1 + pixel % 3;
        lamps.add(accel, 2, number, pass);
        for (size_t pixel = 0; pixel < pass.size(); ++pixel)
            sum[pixel] += pass[pixel].sum.emission.y / static_cast<float>(pass[pixel].samples * passes);
    }
    return sum;
}

double total(const std::vector<float>& picture) { return std::accumulate(picture.begin(), picture.end(), 0.0); }

/// Pixels on the plane at distance 1 before the camera, for each unit of its area.
constexpr double kPixelsOfPlane = kWidth * kHeight / (4 * 0.6 * 0.4);

}  // namespace

TEST(SmallLamps, have_the_light_of_the_part_of_the_picture_that_they_cover) {
    // A lamp that faces the camera is a rectangle of its size over its distance.
    constexpr float kSize = 0.03f, kFar = 3;
    const Scene scene = scene_with({0.7f, -0.5f, -kFar}, {kSize, 0, 0}, {0, kSize, 0}, false);
    ASSERT_TRUE(SmallLamps(scene, camera()).has(0));
    const double expected = double{kLight} * sqr(double{kSize} / double{kFar}) * kPixelsOfPlane;
    EXPECT_NEAR(total(picture(scene, 4)), expected, 1e-3 * expected);

    // Half of it is hidden; by points, so with noise: within 4 standard errors of independent ones, 4 for each of 2 samples in 64 passes.
    const Scene hidden = scene_with({0.7f, -0.5f, -kFar}, {kSize, 0, 0}, {0, kSize, 0}, true);
    EXPECT_NEAR(total(picture(hidden, 64)), expected / 2, 4 * expected * 0.5 / std::sqrt(4.0 * 2 * 64));
}

TEST(SmallLamps, are_foreshortened) {
    // Tilted towards the camera: the area of the quadrangle that its corners make on the plane at distance 1.
    const Vec3 corner{-0.9f, 0.6f, -2.5f}, u{0.04f, 0, 0.03f}, v{0.01f, 0.05f, -0.02f};
    const Scene scene = scene_with(corner, u, v, false);
    const auto on_plane = [](Vec3 x) { return std::array{double{x.x / -x.z}, double{x.y / -x.z}}; };
    const std::array corners{on_plane(corner), on_plane(corner + u), on_plane(corner + u + v), on_plane(corner + v)};
    double twice = 0;
    for (size_t k = 0; k < 4; ++k) {
        const auto &a = corners[k], &b = corners[(k + 1) % 4];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    const double expected = double{kLight} * twice / 2 * kPixelsOfPlane;
    EXPECT_NEAR(total(picture(scene, 16)), expected, 5e-3 * expected);
}

TEST(SmallLamps, are_those_before_the_camera_that_cover_few_pixels) {
    const auto is_small = [](Vec3 corner, float size) {
        return SmallLamps(scene_with(corner, {size, 0, 0}, {0, size, 0}, false), camera()).has(0);
    };
    EXPECT_TRUE(is_small({0, 0, -2}, 0.01f));
    EXPECT_FALSE(is_small({0, 0, -2}, 0.5f));
    EXPECT_FALSE(is_small({0, 0, -0.01f}, 0.01f));
    EXPECT_FALSE(is_small({0, 0, 2}, 0.01f));
    // What it does not see has no light in its picture.
    EXPECT_EQ(total(picture(scene_with({5, 0, -2}, {0.01f, 0, 0}, {0, 0.01f, 0}, false), 1)), 0);
}

}  // namespace lumel::test
