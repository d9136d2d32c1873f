// The raster of bundles: coverage, lists, and what they exchange.
#include <gtest/gtest.h>

#include <cstring>

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
    EXPECT_EQ(a.counters.escaped, b.counters.escaped);
    EXPECT_EQ(a.counters.mispaired, b.counters.mispaired);
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

TEST(Raster, patches_smaller_than_pixels_equal_the_plain_form) {
    for (uint64_t seed = 0; seed < 20 && !HasFailure(); ++seed) expect_as_in_reference(soup(seed).build(20000), 16, 2, seed);
}

TEST(Raster, the_same_sweep_gives_the_same_bytes_whatever_was_swept_before) {
    const Scene scene = two_spheres().build(4000);
    const RasterScene raster(scene);
    Rng rng(3);
    std::vector<Rgb> sent(scene.sides());
    for (Rgb& s : sent) s = {rng.uniform(), rng.uniform(), rng.uniform()};
    const Window window = random_window(scene, 100, rng), other = random_window(scene, 300, rng);
    const Swept expected = sweep(raster, window, sent);
    Transillumination used(raster);
    Swept ignored(scene), again(scene);
    used.exchange(other, sent, ignored.received, ignored.pixels, ignored.counters);
    used.exchange(window, sent, again.received, again.pixels, again.counters);
    EXPECT_EQ(again.pixels, expected.pixels);
    EXPECT_EQ(std::memcmp(again.received.data(), expected.received.data(), again.received.size() * sizeof(Rgb)), 0);
}

TEST(Raster, closed_meshes_alternate_and_give_back_uniform_radiance) {
    const Scene scene = two_spheres().build(5000);
    const RasterScene raster(scene);
    for (uint32_t t = 0; t < scene.triangles(); ++t) ASSERT_NE(raster.closed_surface(t), RasterScene::kOpen);
    Rng rng(1);
    for (int i = 0; i < 50; ++i) {
        const Window window = random_window(scene, 200, rng);
        std::vector<Rgb> sent(scene.sides());
        for (uint32_t side = 0; side < scene.sides(); ++side) sent[side] = scene.is_back(side) ? Rgb{} : Rgb{1, 3, 0.25f};
        const Swept swept = sweep(raster, window, sent);
        EXPECT_EQ(swept.counters.parity_violations, 0u);
        // The fronts enclose the space between the spheres: L = 1 everywhere, and nothing escapes. The backs receive nothing.
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
            const auto pixels = static_cast<float>(swept.pixels[patch]);
            ASSERT_EQ(swept.received[patch], (Rgb{pixels, 3 * pixels, 0.25f * pixels}));
            ASSERT_EQ(swept.received[patch + scene.patches()], Rgb{});
        }
        EXPECT_EQ(swept.counters.escaped.x, 0);
        // Both ways the closed meshes show the same projected area.
        int64_t balance = 0;
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
            const float cos = dot(scene.geometric_normal(scene.triangle_of_patch(patch)), window.direction);
            balance += cos > 0 ? int64_t{swept.pixels[patch]} : -int64_t{swept.pixels[patch]};
        }
        EXPECT_LE(std::abs(balance), 2) << "but for patches seen edge-on, whose snapped corners may turn the other way";
    }
}

TEST(Raster, energy_is_exchanged_not_made) {
    // What all sides receive and what escapes is what all sides sent, pixel by pixel.
    const Scene scene = soup(77).build(500);
    const RasterScene raster(scene);
    Rng rng(4);
    for (int i = 0; i < 20; ++i) {
        const Window window = random_window(scene, 150, rng);
        const std::vector<Rgb> sent = whole_radiance(scene, rng);
        const Swept swept = sweep(raster, window, sent);
        Rgb64 out, in = swept.counters.escaped;
        for (uint32_t side = 0; side < scene.sides(); ++side) {
            out += to_double(sent[side]) * swept.pixels[scene.patch_of_side(side)];
            in += swept.received[side];
        }
        EXPECT_EQ(in.x, out.x);
        EXPECT_EQ(in.y, out.y);
        EXPECT_EQ(in.z, out.z);
    }
}

TEST(Raster, pixels_stand_for_the_projected_area) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {3, 2, 1}, true).sphere({1.5f, 1, 0.5f}, 0.4f, 1, false);
    const Scene scene = b.build(400);
    const RasterScene raster(scene);
    const std::vector<Rgb> sent(scene.sides());
    Rng rng(5);
    std::vector<double> p_values;
    for (int d = 0; d < 10; ++d) {
        // Over jitters the mean is A |cos|.
        const Vec3 direction = square_to_sphere(square(rng));
        constexpr int kJitters = 100;
        const double pixel_area = Window::covering(scene, direction, 48, {}).pixel_area;
        std::vector<std::vector<double>> area(scene.patches());
        for (int j = 0; j < kJitters; ++j) {
            const Window window = Window::covering(scene, direction, 48, square(rng));
            const Swept swept = sweep(raster, window, sent);
            for (uint32_t patch = 0; patch < scene.patches(); ++patch) area[patch].push_back(swept.pixels[patch] * pixel_area);
        }
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
            // Of fewer pixels, and of strips seen edge-on, 100 means are not normal yet.
            const double projected = double{scene.patch_area(patch)} *
                                     double{std::abs(dot(scene.geometric_normal(scene.triangle_of_patch(patch)), direction))};
            if (projected < 3 * pixel_area || projected < 0.2 * double{scene.patch_area(patch)}) continue;
            p_values.push_back(mean_of(area[patch]).p_value(projected));
        }
    }
    EXPECT_GT(p_values.size(), 2000u);
    EXPECT_TRUE(holm_keeps_all(p_values, 1e-3));
}

TEST(Raster, shared_edges_are_owned_once_however_finely_neighbours_are_divided) {
    // A fan of triangles of very different sizes covers a convex polygon: every pixel of it once, with divisions or without.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)));
    const Vec3 hub{0.1f, 0.05f, 0};
    std::array<Vec3, 9> rim;
    const std::array angles{0.0f, 0.05f, 0.2f, 1.1f, 1.15f, 2.9f, 4.0f, 4.01f, 5.5f};
    for (size_t k = 0; k < rim.size(); ++k) rim[k] = {std::cos(angles[k]), std::sin(angles[k]), 0.3f * std::sin(angles[k])};
    const auto tilted = [](Vec3 v) { return Vec3{v.x, v.y, 0.3f * v.y}; };
    for (size_t k = 0; k < rim.size(); ++k) b.triangle(tilted(hub), rim[k], rim[(k + 1) % rim.size()]);
    const Scene whole = b.build(1), divided = b.build(3000);
    std::vector<uint32_t> kinds;
    for (uint32_t t = 0; t < divided.triangles(); ++t) kinds.push_back(divided.divisions(t));
    EXPECT_GT(*std::max_element(kinds.begin(), kinds.end()), 5 * *std::min_element(kinds.begin(), kinds.end()));
    const RasterScene raster_whole(whole), raster_divided(divided);
    Rng rng(6);
    for (int i = 0; i < 400; ++i) {
        // The pole of the plane and directions in it as well.
        const Vec3 normal = divided.geometric_normal(0), random = square_to_sphere(square(rng));
        const Vec3 direction = i == 0 ? normal : i % 20 == 1 ? normalize(cross(normal, random)) : random;
        const Square jitter = i % 3 == 0 ? Square{0, 0} : square(rng);
        const Swept one = sweep(raster_whole, Window::covering(whole, direction, 200, jitter), std::vector<Rgb>(whole.sides()));
        const Swept many = sweep(raster_divided, Window::covering(divided, direction, 200, jitter), std::vector<Rgb>(divided.sides()));
        ASSERT_EQ(many.counters.lines, one.counters.lines);
        ASSERT_EQ(many.counters.fragments, one.counters.fragments);
        for (uint32_t t = 0; t < whole.triangles(); ++t) {
            uint64_t sum = 0;
            for (uint32_t k = 0; k < kinds[t] * kinds[t]; ++k) sum += many.pixels[divided.first_patch(t) + k];
            ASSERT_EQ(sum, one.pixels[t]) << "direction " << i << ", triangle " << t;
        }
        // Seen edge-on a sheet may fold over itself within a fraction of a pixel.
        if (std::abs(dot(direction, normal)) > 0.01f) {
            ASSERT_EQ(many.counters.fragments, many.counters.lines) << "direction " << i;
        }
    }
}
