// Smoothing of what is known of sides: noise goes, what the light does stays.
#include <gtest/gtest.h>

#include "lumel/eye/smooth.h"
#include "lumel/sampling/hash.h"
#include "lumel/scene/surface.h"
#include "scenes.h"

namespace lumel::test {

namespace {

/// About normal, mean 0 and variance 1: a sum of twelve uniform numbers.
float normal(uint64_t stream) {
    Rng rng(stream);
    float sum = -6;
    for (int i = 0; i < 12; ++i) sum += rng.uniform();
    return sum;
}

struct Errors {
    double before = 0, after = 0;        // root mean squares
    double mean = 0, mean_stderr = 0;    // of the smoothed field less the truth, by area, and what noise makes of it
};

/// Add noise of `sigma` to the light of the facets of a sphere, smooth it, and compare with the truth.
Errors errors(float sigma, const std::function<float(Vec3)>& truth) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0, 0, 0}, 1, 4, true);
    const Scene scene = b.build(1);
    const Lattice lattice(scene);
    SideField field{std::vector<Rgb>(scene.sides()), std::vector<Rgb>(scene.sides())};
    std::vector<float> values(scene.patches());
    double mean_area = scene.total_area() / scene.patches();
    for (uint32_t side = 0; side < scene.patches(); ++side) {
        values[side] = truth(Surface(scene, scene.centre_of_patch(side), false).shading);
        const double variance = sigma * sigma * mean_area / scene.side_area(side);
        field.mean[side] = grey(values[side] + static_cast<float>(std::sqrt(variance)) * normal(key(7, side)));
        field.variance[side] = grey(static_cast<float>(variance));
    }
    const SideField smooth = smoothed(scene, lattice, field);
    Errors e;
    for (uint32_t side = 0; side < scene.patches(); ++side) {
        const double before = field.mean[side].y - values[side], after = smooth.mean[side].y - values[side];
        e.before += before * before / scene.patches(), e.after += after * after / scene.patches();
        e.mean += after * scene.side_area(side) / scene.total_area();
    }
    e.before = std::sqrt(e.before), e.after = std::sqrt(e.after), e.mean_stderr = sigma / std::sqrt(scene.patches());
    return e;
}

}  // namespace

TEST(Smooth, takes_noise_out_of_smooth_light_and_keeps_its_mean) {
    const Errors e = errors(0.2f, [](Vec3 n) { return 1 + 0.4f * n.x - 0.3f * n.z; });
    EXPECT_LT(e.after, 0.5 * e.before);
    EXPECT_LT(std::abs(e.mean), 4 * e.mean_stderr);
}

TEST(Smooth, takes_much_noise_out_of_many_small_sides) {
    // Light that is linear in the normal has 4 numbers, which 5120 sides know well, however noisy each of them is.
    const Errors e = errors(1, [](Vec3 n) { return 1 + 0.4f * n.x - 0.3f * n.z; });
    EXPECT_LT(e.after, 0.16 * e.before);
    EXPECT_LT(std::abs(e.mean), 4 * e.mean_stderr);
}

TEST(Smooth, keeps_what_many_sides_show_together) {
    // Half a sphere in shadow: as noisy as it is strong on every side, and still not lost.
    const Errors e = errors(1, [](Vec3 n) { return n.x > 0.1f ? 2.0f : 1.0f; });
    EXPECT_LT(e.after, 0.25 * e.before);
    EXPECT_LT(std::abs(e.mean), 4 * e.mean_stderr);
}

TEST(Smooth, believes_in_no_darkness_where_hardly_any_ray_came) {
    // One side in ten was hit: all others are black and seem to be without noise. The mean stays what it is, and all have it.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0, 0, 0}, 1, 4, true);
    const Scene scene = b.build(1);
    SideField field{std::vector<Rgb>(scene.sides()), std::vector<Rgb>(scene.sides())};
    constexpr float kChance = 0.1f;
    for (uint32_t side = 0; side < scene.patches(); ++side)
        if (to_unit(static_cast<uint32_t>(key(5, side))) < kChance) field.mean[side] = field.variance[side] = grey(1 / kChance);
    for (Rgb& variance : field.variance) variance = variance * variance;
    const SideField smooth = smoothed(scene, Lattice(scene), field);
    const auto patches = static_cast<float>(scene.patches());
    double before = 0, after = 0, off = 0;
    for (uint32_t side = 0; side < scene.patches(); ++side) {
        before += field.mean[side].y / patches, after += smooth.mean[side].y / patches;
        off += sqr(double{smooth.mean[side].y} - 1) / patches;
    }
    EXPECT_NEAR(after, before, 0.1 * before);
    EXPECT_LT(std::sqrt(off), 0.5);  // 3 before
}

TEST(Smooth, tells_a_bright_side_from_rays_that_came_together) {
    // One side has more light than all others: every replica says so, or one of them alone.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({0, 0, 0}, 1, 4, true);
    const Scene scene = b.build(1);
    const Lattice lattice(scene);
    constexpr uint32_t kOdd = 1234;
    constexpr float kSigma = 0.1f, kMore = 0.8f;
    const auto left_of = [&](float sigma_of_odd) {
        SideField field{std::vector<Rgb>(scene.sides()), std::vector<Rgb>(scene.sides(), grey(sqr(kSigma)))};
        for (uint32_t side = 0; side < scene.patches(); ++side) field.mean[side] = grey(1 + kSigma * normal(key(9, side)));
        field.mean[kOdd] = grey(1 + kMore), field.variance[kOdd] = grey(sqr(sigma_of_odd));
        return (smoothed(scene, lattice, field).mean[kOdd].y - 1) / kMore;
    };
    EXPECT_GT(left_of(kSigma), 0.5f);
    EXPECT_LT(left_of(kMore / 2), 0.2f);
}

TEST(Smooth, leaves_sharp_light_as_it_is_known) {
    // A shadow edge and a small bright spot, known 50 times better than they are strong: nothing becomes worse than the noise was.
    const Errors edge = errors(0.02f, [](Vec3 n) { return n.x > 0.1f ? 1.0f : 0.0f; });
    EXPECT_LT(edge.after, 1.1 * edge.before);
    const Errors spot = errors(0.02f, [](Vec3 n) { return n.y > 0.98f ? 5.0f : 0.2f; });
    EXPECT_LT(spot.after, 1.1 * spot.before);
    EXPECT_LT(std::abs(spot.mean), 4 * spot.mean_stderr);
}

TEST(Smooth, does_nothing_without_noise) {
    const Errors e = errors(0, [](Vec3 n) { return n.x * n.y > 0 ? 1.0f : 0.3f; });
    EXPECT_EQ(e.after, 0);
}

}  // namespace lumel::test
