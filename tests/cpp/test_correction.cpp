// Gathering corrects the reconstruction where that is off, and leaves it alone elsewhere.
#include <gtest/gtest.h>

#include "lumel/eye/correction.h"
#include "lumel/eye/eye_pass.h"
#include "lumel/solver/session.h"
#include "scenes.h"

namespace lumel::test {

namespace {

constexpr float kNoise = 0.4f;  // of one pass
constexpr uint32_t kSize = 32, kPasses = 32, kOdd = 10 * kSize + 8;

/// A film of a wall whose reconstruction is 1 everywhere, while gathering finds 1 + bias(x) and noise; `near` in the left half. In the
/// pixel kOdd it finds `always` more, and `once` more in one of its passes. Noise is even, or all of it comes from one ray in fifty.
Film film_with(const std::function<float(uint32_t)>& bias, float always = 0, float once = 0, bool rare = false, uint64_t seed = 3) {
    Film film(kSize, kSize);
    for (uint32_t number = 0; number < kPasses; ++number) {
        std::vector<PixelPass> pass(film.pixels());
        for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
            PixelPass& p = pass[pixel];
            p.samples = p.diffuse = p.specular = 1;
            p.sum.indirect_diffuse = grey(1), p.sum.albedo = grey(0.5f), p.sum.normal = {0, 0, 1}, p.sum.depth = 2;
            Rng rng(key(seed, pixel, number));
            constexpr float kRare = 0.02f;
            const float even = std::sqrt(12.0f) * (rng.uniform() - 0.5f), found = rng.uniform() < kRare ? 1 : 0,
                        noise = kNoise * (rare ? (found - kRare) / std::sqrt(kRare * (1 - kRare)) : even);
            const uint32_t x = pixel % kSize;
            const float odd = pixel == kOdd ? always + (number == 5 ? once : 0) : 0;
            p.pairs.here = grey(bias(x) + noise + odd), p.excess.near_diffuse = x < kSize / 2 ? 0.3f : 0.0f;
        }
        film.add(pass);
    }
    correct(film, true);
    return film;
}

/// Mean square of what is left of the bias in columns `first` to `last`.
double left_error(const Film& film, const std::function<float(uint32_t)>& bias, uint32_t first, uint32_t last) {
    double sum = 0;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = first; x < last; ++x) sum += sqr(film.mean(y * kSize + x).indirect_diffuse.y - 1 - bias(x));
    return sum / (kSize * (last - first));
}

/// What gathering makes of a solution of four replicas, of so many rays each, or what is seen without.
Film picture(Scene scene, const Camera& camera, uint64_t rays, bool gather) {
    Session session(std::move(scene), {camera}, {.solver = {.seed = 5}});
    for (int replica = 0; replica < 4; ++replica) {
        session.solver().begin_replica(100000);
        session.solver().step(rays);
        session.solver().end_replica();
    }
    session.reconstruct();
    Film film(camera.width, camera.height);
    for (uint64_t pass = 0; pass < 8; ++pass)
        eye_pass(session.accel(), camera, 0, session.reconstruction(), nullptr, {32, true, gather, gather, pass}, nullptr, film);
    return film;
}

}  // namespace

TEST(Correction, mends_what_is_off_and_adds_little_noise_elsewhere) {
    const double noise = sqr(kNoise) / kPasses;
    // A smooth error is mended at a small part of the noise of gathering, a fine one at less than all of it.
    const auto smooth = [](uint32_t) { return -0.3f; };
    EXPECT_LT(left_error(film_with(smooth), smooth, 2, 14), 0.3 * noise);
    const auto fine = [](uint32_t x) { return x % 2 ? 0.5f : -0.5f; };
    EXPECT_LT(left_error(film_with(fine), fine, 2, 14), 1.2 * noise);
    const auto nothing = [](uint32_t) { return 0.0f; };
    EXPECT_LT(left_error(film_with(nothing), nothing, 2, 14), 0.1 * noise);
    // Where nothing is near, nothing is touched.
    EXPECT_EQ(left_error(film_with(nothing), nothing, 20, kSize), 0);
}

TEST(Correction, asks_the_pixels_around_whether_rare_rays_agree_by_chance) {
    const auto nothing = [](uint32_t) { return 0.0f; };
    int stand_out = 0;
    for (uint64_t seed = 10; seed < 20; ++seed) {
        const Film film = film_with(nothing, 0, 0, true, seed);
        for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) stand_out += std::abs(film.mean(pixel).indirect_diffuse.y - 1) > 0.03f;
    }
    EXPECT_LT(stand_out, 30);  // of 5120 near which something is; without those around 39
}

TEST(Correction, tells_a_small_thing_from_a_rare_bright_ray) {
    const auto nothing = [](uint32_t) { return 0.0f; };
    // Both make the mean of the pixel 0.9 brighter than those around; what comes again in every pass is there.
    constexpr float kMore = 0.9f;
    const float small_thing = film_with(nothing, kMore).mean(kOdd).indirect_diffuse.y - 1;
    const float bright_ray = film_with(nothing, 0, kMore * kPasses).mean(kOdd).indirect_diffuse.y - 1;
    EXPECT_GT(small_thing, 0.6f * kMore);
    EXPECT_LT(std::abs(bright_ray), 0.1f * kMore);
}

TEST(Correction, brings_coarse_patches_to_what_fine_ones_show_in_a_gap) {
    const auto room = [](uint64_t patches) {
        SceneBuilder b;
        const uint32_t white = b.material(matt(0.7f));
        b.shape(white).box({0, 0, 0}, {1, 1, 1}, true).box({0.35f, 0.35f, 0.02f}, {0.65f, 0.65f, 0.3f}, false);
        b.shape(b.material(matt(0)), grey(10)).quad({0.1f, 0.1f, 0.99f}, {0, 0.2f, 0}, {0.2f, 0, 0});
        return b.build(patches);
    };
    const Camera camera{.origin = {0.95f, 0.5f, 0.5f},
                        .right = {0, 1, 0},
                        .up = normalize({-0.6f, 0, 1}),
                        .forward = normalize({-1, 0, -0.6f}),
                        .tan_x = 0.5f,
                        .tan_y = 0.5f,
                        .width = 32,
                        .height = 32};
    const Film truth = picture(room(12000), camera, 2000000, true), plain = picture(room(1000), camera, 200000, false),
               corrected = picture(room(1000), camera, 200000, true);
    double off = 0, left = 0, mean_off = 0, mean_left = 0;
    for (size_t pixel = 0; pixel < truth.sum.size(); ++pixel) {
        const float r = truth.mean(pixel).indirect_diffuse.y;
        off += sqr(plain.mean(pixel).indirect_diffuse.y - r), left += sqr(corrected.mean(pixel).indirect_diffuse.y - r);
        mean_off += plain.mean(pixel).indirect_diffuse.y - r, mean_left += corrected.mean(pixel).indirect_diffuse.y - r;
    }
    // The block hovers a little above the floor: nothing is covered, and patches cannot follow the light below.
    EXPECT_LT(left, 0.6 * off);
    EXPECT_LT(std::abs(mean_left), std::abs(mean_off));
}

TEST(Correction, knows_that_under_a_fine_ball_a_coarse_floor_is_dark) {
    // Of a patch of the floor as large as the ball, all would send what its lit part reflects, also to the ball right above its shadow.
    const auto plain = [](uint64_t patches) {
        SceneBuilder b;
        const uint32_t white = b.material(matt(0.7f));
        b.shape(white).quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        b.shape(white).sphere({0, 0, 0.101f}, 0.1f, 3, false, true);
        b.shape(b.material(matt(0)), grey(10)).quad({-0.1f, -0.1f, 2}, {0, 0.2f, 0}, {0.2f, 0, 0});
        return b.build(patches);
    };
    const Camera camera{.origin = {0.35f, 0, 0.06f},
                        .right = {0, 1, 0},
                        .up = normalize({-0.06f, 0, 0.3f}),
                        .forward = normalize({-0.3f, 0, -0.06f}),
                        .tan_x = 0.1f,
                        .tan_y = 0.05f,
                        .width = 32,
                        .height = 16};
    const Film truth = picture(plain(60000), camera, 4000000, true), coarse = picture(plain(2200), camera, 400000, true);
    double found = 0, expected = 0;
    for (size_t pixel = 0; pixel < truth.sum.size(); ++pixel) {
        const EyeSample there = truth.mean(pixel);
        if (!(there.normal.z > 0.99f) || there.direct.y > 0) continue;  // the floor in shadow
        found += coarse.mean(pixel).indirect_diffuse.y, expected += there.indirect_diffuse.y;
    }
    EXPECT_NEAR(found / expected, 1, 0.2);  // 1.7 if all of what the floor's patches send came from close by as well
}

TEST(Correction, gathers_the_light_of_what_no_ray_has_met) {
    // A block of 2 mm in a sphere of radius 1 that emits 1 and reflects half: the radiance is 2 all around, of which the first reflection
    // of what the sphere emits is seen as direct light. So half of what is left is what the block reflects, though hardly a ray met it.
    constexpr float kHalf = 0.001f;
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)), grey(1)).sphere({0, 0, 0}, 1, 3, true);
    b.shape(b.material(matt(0.5f))).box({-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, kHalf}, false);
    const Camera camera{.origin = {0, 0, 0.01f},
                        .right = {1, 0, 0},
                        .up = {0, 1, 0},
                        .forward = {0, 0, -1},
                        .tan_x = 0.05f,
                        .tan_y = 0.05f,
                        .width = 16,
                        .height = 16};
    Session session(b.build(2000), {camera}, {.solver = {.gather = 16, .seed = 5}});
    for (int replica = 0; replica < 4; ++replica) {
        session.solver().begin_replica(20000);
        session.solver().step(20000);
        session.solver().end_replica();
    }
    session.reconstruct();
    for (int pass = 0; pass < 4; ++pass) session.eye_pass(0, 16);
    double sum = 0;
    for (size_t pixel = 0; pixel < session.film(0).pixels(); ++pixel) sum += double{session.film(0).mean(pixel).indirect_diffuse.y};
    EXPECT_NEAR(sum / static_cast<double>(session.film(0).pixels()), 0.5, 0.03);
}

}  // namespace lumel::test
