// The raster of bundles on difficult geometry, and against rays.
#include <gtest/gtest.h>

#include <limits>

#include "lumel/sampling/warp.h"
#include "reference_raster.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

SweepCounters count(const RasterScene& raster, const Window& window, std::vector<uint32_t>& pixels) {
    const Scene& scene = raster.scene();
    std::vector<Rgb> sent(scene.sides()), received(scene.sides());
    SweepCounters counters;
    pixels.assign(scene.patches(), 0);
    Transillumination(raster).exchange(window, sent, received, pixels, counters);
    return counters;
}

/// A sphere around a smaller one, both facing outward, made one closed surface by a tube from a triangle of each that is left out.
SceneBuilder double_sphere(float outer, float inner, int level) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({}, outer, level, false).sphere({}, inner, level, false);
    const size_t half = b.indices.size() / 2;
    const Indices from = b.indices[0], to = b.indices[half];
    b.indices.erase(b.indices.begin() + static_cast<std::ptrdiff_t>(half)), b.indices.erase(b.indices.begin());
    b.triangle_shape.resize(b.indices.size());
    // Every edge is met once each way; that the tube goes through itself harms nothing.
    const std::array opposite{to[1], to[0], to[2]};
    for (size_t k = 0; k < 3; ++k) {
        const size_t next = (k + 1) % 3;
        b.indices.push_back({from[k], from[next], opposite[next]}), b.indices.push_back({from[k], opposite[next], opposite[k]});
        b.triangle_shape.insert(b.triangle_shape.end(), 2, 0);
    }
    return b;
}

/// The patches that rays along the line from `origin` meet one after the other.
std::vector<uint32_t> patches_by_rays(const Accel& accel, Vec3 origin, Vec3 direction) {
    std::vector<uint32_t> patches;
    for (int guard = 0; guard < 100; ++guard) {
        const Hit hit = accel.intersect({origin, direction});
        if (hit.is_miss()) break;
        patches.push_back(accel.scene().patch_of(hit.point()));
        origin = accel.scene().position(hit.point()) + direction * (20 * accel.scene().epsilon());
    }
    return patches;
}

}  // namespace

TEST(RasterScenes, faces_seen_exactly_edge_on_have_no_pixels) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {2, 1, 1}, true);
    const Scene scene = b.build(300);
    const RasterScene raster(scene);
    std::vector<uint32_t> pixels;
    for (Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
        const Window window = Window::covering(scene, axis, 100, {0.3f, 0.6f});
        const SweepCounters counters = count(raster, window, pixels);
        EXPECT_EQ(counters.fragments, 2 * counters.lines);
        EXPECT_EQ(counters.most_depth, 2u);
        EXPECT_EQ(counters.parity_violations, 0u);
        const double area = std::abs(axis.x) > 0 ? 1 : 2;
        EXPECT_NEAR(static_cast<double>(counters.lines) * double{window.pixel_area}, area, 0.03 * area);
        for (uint32_t patch = 0; patch < scene.patches(); ++patch)
            if (std::abs(dot(scene.geometric_normal(scene.triangle_of_patch(patch)), axis)) < 0.5f) {
                EXPECT_EQ(pixels[patch], 0u);
            }
    }
}

TEST(RasterScenes, faces_in_one_place_are_ordered_by_number) {
    // Three lamps in one place, given with different first corners and turning either way: Scene keeps them all.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true);
    const Vec3 p{0.2f, 0.3f, 0.4f}, q{0.8f, 0.35f, 0.5f}, r{0.5f, 0.9f, 0.6f};
    b.shape(0, grey(1)).triangle(p, q, r).shape(0, grey(2)).triangle(q, r, p).shape(0, grey(3)).triangle(q, p, r);
    const Scene scene = b.build(1);
    const RasterScene raster(scene);
    std::vector<uint32_t> lamps;
    for (uint32_t patch = 0; patch < scene.patches(); ++patch)
        if (scene.lamp_of(scene.triangle_of_patch(patch)) >= 0) lamps.push_back(patch);
    ASSERT_EQ(lamps.size(), 3u);
    Rng rng(1);
    for (int i = 0; i < 50; ++i) {
        const Vec3 direction = square_to_sphere(square(rng));
        const Window window = Window::covering(scene, direction, 64, square(rng));
        for (const auto& line : fragment_lists(scene, window)) {
            std::vector<uint32_t> met;
            for (const Fragment& f : line)
                if (scene.lamp_of(scene.triangle_of_patch(f.patch)) >= 0) met.push_back(f.patch);
            if (!met.empty()) {
                ASSERT_EQ(met, lamps);
            }
        }
    }
}

TEST(RasterScenes, needles_count_by_their_area) {
    // A sheet of needles, each a twentieth of a pixel wide: together they cover it once.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)));
    constexpr int kNeedles = 1000;
    const auto height = [](int i) { return static_cast<float>(i) / kNeedles; };
    for (int i = 0; i < kNeedles; ++i)
        b.triangle({0, height(i), 0}, {1, height(i), 0}, {0, height(i + 1), 0})
            .triangle({1, height(i), 0}, {1, height(i + 1), 0}, {0, height(i + 1), 0});
    const Scene scene = b.build(1);
    ASSERT_EQ(scene.triangles(), 2u * kNeedles);
    const RasterScene raster(scene);
    Rng rng(2);
    std::vector<uint32_t> pixels;
    for (int i = 0; i < 100; ++i) {
        const Vec3 direction = square_to_sphere(square(rng));
        const Window window = Window::covering(scene, direction, 80, square(rng));
        const SweepCounters counters = count(raster, window, pixels);
        // Needles thinner than a subpixel or two may fold, and then count once more each way.
        EXPECT_EQ((counters.fragments - counters.lines) % 2, 0u);
        if (std::abs(direction.z) > 0.2f) {
            EXPECT_EQ(counters.fragments, counters.lines);
        }
        const double expected = std::abs(direction.z) / double{window.pixel_area};
        EXPECT_NEAR(static_cast<double>(counters.lines), expected, 4 * std::sqrt(expected) + 2);
    }
}

TEST(RasterScenes, closed_surfaces_are_told_from_open_ones) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true).box({2, 0, 0}, {3, 1, 1}, false);
    for (int face = 0; face < 5; ++face) b.face(face, {4, 0, 0}, {5, 1, 1}, false);
    b.quad({0.2f, 0.2f, 0.2f}, {0.5f, 0, 0}, {0, 0.5f, 0});
    const Scene scene = b.build(1);
    const RasterScene raster(scene);
    std::array<uint32_t, 2> surface{RasterScene::kOpen, RasterScene::kOpen};
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const Vec3 c = scene.position(scene.centre_of_patch(t));
        const bool is_open = c.x > 3.5f || (c.x > 0.1f && c.x < 0.9f && std::abs(c.z - 0.2f) < 0.1f && c.y > 0.1f && c.y < 0.9f);
        ASSERT_EQ(raster.closed_surface(t) == RasterScene::kOpen, is_open) << c.x << " " << c.y << " " << c.z;
        if (is_open) continue;
        uint32_t& expected = surface[c.x > 1.5f];
        if (expected == RasterScene::kOpen) expected = raster.closed_surface(t);
        ASSERT_EQ(raster.closed_surface(t), expected);
    }
    EXPECT_NE(surface[0], surface[1]);
}

TEST(RasterScenes, parity_shows_where_closed_surfaces_cross_themselves) {
    // Two spheres that cross are closed each by itself, so no line is wrong.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0, 0, 0}, 1, 2, false).sphere({1, 0, 0}, 1, 2, false);
    std::vector<uint32_t> pixels;
    const Scene spheres = b.build(1);
    EXPECT_EQ(count(RasterScene(spheres), Window::covering(spheres, {0.6f, 0, 0.8f}, 100, {0.5f, 0.5f}), pixels).parity_violations, 0u);

    // One sphere bent around so far that its ends are in each other is wrong just there.
    SceneBuilder bent;
    bent.shape(bent.material(matt(0.5f))).sphere({0, 0, 0}, 1, 3, false);
    for (Vec3& v : bent.vertices) {
        const float angle = 1.2f * kPi * v.x;
        v = {(2 + v.z) * std::cos(angle), v.y, (2 + v.z) * std::sin(angle)};
    }
    const Scene crossing = bent.build(1);
    const SweepCounters counters = count(RasterScene(crossing), Window::covering(crossing, {0, 1, 0}, 100, {0.5f, 0.5f}), pixels);
    EXPECT_GT(counters.parity_violations, counters.lines / 100);
    EXPECT_LT(counters.parity_violations, counters.lines / 5);
}

TEST(RasterScenes, light_of_wrong_pairs_is_their_share_of_lines) {
    // A line through both spheres meets front, front, back, back: of its three pairs two are wrong. With all sides equally bright the share
    // of what is sent over them is 4 pi r^2 / (4 pi R^2 + 4 pi r^2) of projected areas; the tube and the triangles make it a little less.
    const float inner = 0.5f;
    const Scene scene = double_sphere(1, inner, 4).build(1);
    const RasterScene raster(scene);
    ASSERT_NE(raster.closed_surface(0), RasterScene::kOpen);
    const std::vector<Rgb> sent(scene.sides(), {1, 2, 3});
    std::vector<Rgb> received(scene.sides());
    std::vector<uint32_t> pixels(scene.patches());
    SweepCounters counters;
    Rng rng(9);
    for (int i = 0; i < 20; ++i) {
        const Window window = Window::covering(scene, square_to_sphere(square(rng)), 200, {0.3f, 0.6f});
        Transillumination(raster).exchange(window, sent, received, pixels, counters);
    }
    const double truth = double{inner * inner} / (1 + double{inner * inner});
    EXPECT_NEAR(counters.mispaired.x / (2 * static_cast<double>(counters.fragments)), truth, 0.01 * truth);
    EXPECT_NEAR(counters.mispaired.z, 3 * counters.mispaired.x, 1e-9 * counters.mispaired.z);
    EXPECT_NEAR(static_cast<double>(counters.parity_violations) / static_cast<double>(counters.lines), double{inner * inner}, 0.01);
}

TEST(RasterScenes, lines_meet_what_rays_meet) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)))
        .box({0, 0, 0}, {3, 2, 1}, true)
        .sphere({1, 1, 0.5f}, 0.4f, 2, false)
        .sphere({2, 1, 0.5f}, 0.45f, 3, false);
    b.quad({0.2f, 0.2f, 0.2f}, {2.5f, 0.3f, 0}, {0, 0.3f, 0.4f});
    const Scene scene = b.build(3000);
    const Accel accel(scene);
    Rng rng(8);
    int compared = 0, lines = 0;
    for (int i = 0; i < 6; ++i) {
        const Vec3 direction = square_to_sphere(square(rng));
        const Window window = Window::covering(scene, direction, 64, square(rng));
        const auto lists = fragment_lists(scene, window);
        for (uint32_t y = 0; y < window.resolution; ++y)
            for (uint32_t x = 0; x < window.resolution; ++x) {
                // Compare where rays a few subpixels aside meet the same.
                const Vec3 origin = window.start_of_line(x, y) - direction;
                const auto expected = patches_by_rays(accel, origin, window.direction);
                const auto aside = static_cast<float>(0.02 / window.pixels_per_metre);
                bool clear = true;
                for (Vec3 shift : {window.right, -window.right, window.up, -window.up})
                    clear &= patches_by_rays(accel, origin + shift * aside, window.direction) == expected;
                lines += !expected.empty();
                if (!clear) continue;
                std::vector<uint32_t> met;
                for (const Fragment& f : lists[size_t{y} * window.resolution + x]) met.push_back(f.patch);
                ASSERT_EQ(met, expected) << "pixel " << x << ", " << y << " of direction " << i;
                compared += !expected.empty();
            }
    }
    EXPECT_GT(compared, lines / 2);
}

TEST(RasterScenes, windows_refuse_what_they_cannot_cover) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true);
    const Scene scene = b.build(1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(Window::covering(scene, {0, 0, 1}, 3, {}), std::invalid_argument);
    EXPECT_THROW(Window::covering(scene, {0, 0, 1}, Window::kMostResolution + 1, {}), std::invalid_argument);
    EXPECT_THROW(Window::covering(scene, {0, 0, 2}, 64, {}), std::invalid_argument);
    EXPECT_THROW(Window::covering(scene, {0, 0, nan}, 64, {}), std::invalid_argument);
    EXPECT_THROW(Window::covering(scene, {0, 0, 1}, 64, {1, 0}), std::invalid_argument);
    EXPECT_THROW(Window::covering(scene, {0, 0, 1}, 64, {0, nan}), std::invalid_argument);
    EXPECT_NO_THROW(Window::covering(scene, {0, 0, 1}, Window::kMostResolution, {0.999f, 0}));
}
