// The raster of bundles: coverage, lists, and what they exchange.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "lumel/sampling/warp.h"
#include "reference_raster.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// What one direction gave.
struct Swept {
    std::vector<Rgb> received;
    std::vector<uint32_t> pixels;
    SweepCounters counters;

    explicit Swept(const Scene& scene) : received(scene.sides()), pixels(scene.patches()) {}
};

Swept sweep(const RasterScene& raster, const Window& window, std::span<const Rgb> sent) {
    Swept result(raster.scene());
    Transillumination(raster).exchange(window, sent, result.received, result.pixels, result.counters);
    return result;
}

/// Small whole numbers, so that sums are exact in whatever order they are made.
std::vector<Rgb> whole_radiance(const Scene& scene, Rng& rng) {
    std::vector<Rgb> sent(scene.sides());
    const auto digit = [&] { return std::floor(8 * rng.uniform()); };
    for (Rgb& s : sent) s = {digit(), digit(), digit()};
    return sent;
}

Window random_window(const Scene& scene, uint32_t resolution, Rng& rng) {
    const Vec3 direction = square_to_sphere(square(rng));
    return Window::covering(scene, direction, resolution, square(rng));
}

void expect_same(const Swept& a, const Swept& b) {
    EXPECT_EQ(a.pixels, b.pixels);
    EXPECT_EQ(a.received, b.received);
    EXPECT_EQ(a.counters.lines, b.counters.lines);
    EXPECT_EQ(a.counters.fragments, b.counters.fragments);
    EXPECT_EQ(a.counters.pairs, b.counters.pairs);
    EXPECT_EQ(a.counters.most_depth, b.counters.most_depth);
    EXPECT_EQ(a.counters.parity_violations, b.counters.parity_violations);
    EXPECT_EQ(a.counters.escaped.x, b.counters.escaped.x);
    EXPECT_EQ(a.counters.escaped.y, b.counters.escaped.y);
    EXPECT_EQ(a.counters.escaped.z, b.counters.escaped.z);
}

/// Sweep a scene along random directions and hold every number against those of the plain form.
void expect_as_in_reference(const Scene& scene, uint32_t resolution, int directions, uint64_t seed) {
    const RasterScene raster(scene);
    Rng rng(seed);
    for (int i = 0; i < directions && !testing::Test::HasFailure(); ++i) {
        const std::vector<Rgb> sent = whole_radiance(scene, rng);
        const Window window = random_window(scene, resolution, rng);
        Swept expected(scene);
        reference_exchange(raster, window, sent, expected.received, expected.pixels, expected.counters);
        SCOPED_TRACE("direction " + std::to_string(i) + " of seed " + std::to_string(seed));
        expect_same(sweep(raster, window, sent), expected);
    }
}

SceneBuilder two_spheres() {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0.3f, 0.1f, 5}, 2, 3, true).sphere({0.3f, 0.1f, 5}, 1, 2, false);
    return b;
}

/// A random mess: triangles large and small, needles, points, shared corners, coinciding and coplanar faces, broken numbers.
SceneBuilder soup(uint64_t seed) {
    Rng rng(seed);
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)));
    b.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const auto coordinate = [&] {
        const float x = 2 * rng.uniform() - 1, kind = rng.uniform();
        return kind < 0.3f ? std::round(2 * x) / 2 : kind < 0.4f ? 1e-6f * x : x;
    };
    const auto point = [&] { return Vec3{coordinate(), coordinate(), coordinate()}; };
    std::vector<Vec3> corners{point()};
    const auto corner = [&] {
        if (rng.uniform() < 0.6f) return corners[static_cast<size_t>(rng.uniform() * static_cast<float>(corners.size()))];
        return corners.emplace_back(point());
    };
    for (int i = 0; i < 25; ++i) {
        const float kind = rng.uniform();
        const Vec3 p = corner(), q = corner(), r = corner();
        if (kind < 0.7f)
            b.triangle(p, q, r);
        else if (kind < 0.8f)
            b.triangle(p, q, p + (q - p) * 0.5f + r * 1e-5f);
        else if (kind < 0.9f)
            b.shape(0, grey(1)).triangle(p, q, r).shape(0, grey(2)).triangle(q, r, p).shape(0, grey(3)).triangle(q, p, r);
        else if (kind < 0.93f)
            b.triangle(p, q, r * std::numeric_limits<float>::quiet_NaN());
        else if (kind < 0.95f)
            b.triangle(p, q, r * 1e30f);
        else if (kind < 0.97f)
            b.triangle(p, q, r * 1e8f);
        else
            b.triangle(p, p, q);
    }
    return b;
}

}  // namespace

TEST(Raster, equals_the_plain_form) {
    expect_as_in_reference(two_spheres().build(4000), 96, 20, 1);
    SceneBuilder room;
    room.shape(room.material(matt(0.5f))).box({0, 0, 0}, {3, 2, 1}, true).box({1, 0, 0.3f}, {1.5f, 1, 0.6f}, false);
    room.sphere({2, 1, 0.5f}, 0.7f, 2, false).quad({0.2f, 0.2f, 0.2f}, {2.5f, 0.3f, 0}, {0, 0.3f, 0.4f});
    for (uint64_t patches : {1u, 300u, 5000u}) expect_as_in_reference(room.build(patches), 128, 20, patches);
}

TEST(Raster, random_soups_equal_the_plain_form) {
    for (uint64_t seed = 0; seed < 1000 && !HasFailure(); ++seed)
        expect_as_in_reference(soup(seed).build(seed % 3 == 0 ? 1 : 150), seed % 2 ? 24 : Window::kLeastResolution + seed % 16, 2, seed);
}
