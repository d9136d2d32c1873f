// Bundles by themselves: their directions, the areas that they stand for, the plain iteration and its variance.
#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "lobe.h"
#include "lumel/areas/bundle_field.h"
#include "lumel/transport/sent_light.h"
#include "lumel/transport/side_source.h"
#include "lumel/transport/variance_growth.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// |mean - truth| within 1e-3 of it and the standard errors that `tests` tests keep at a significance of 1e-3.
void expect_near(const Mean& m, double truth, int tests, const std::string& what) {
    EXPECT_NEAR(m.value, truth, 1e-3 * truth + student_quantile(1e-3 / tests, m.count - 1) * m.error) << what;
    EXPECT_LT(m.error, 0.03 * truth) << what;
}

/// A closed room of one diffuse albedo with a lamp in it.
SceneBuilder grey_room(float albedo) {
    SceneBuilder b;
    const uint32_t wall = b.material(matt(albedo));
    b.shape(wall).box({0, 0, 0}, {1, 1, 1}, true).shape(wall, grey(30)).quad({0.4f, 0.45f, 0.55f}, {0, 0.15f, 0}, {0.15f, 0, 0});
    return b;
}

RunConfig plain(bool first_shot, uint64_t seed) {
    return {.solver = {.transport = Transport::kBundles, .first_shot = first_shot, .seed = seed, .iteration = Iteration::kPlain},
            .replicas = 8,
            .rays = 60000};
}

}  // namespace

TEST(Bundles, directions_are_spread_evenly_over_the_hemisphere) {
    // Every aligned block of 4^k directions has one in each of 2^k x 2^k cells of equal solid angle.
    constexpr uint32_t kSide = 16;
    std::array<int, kSide * kSide> counts{};
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const Vec3 d = bundle_direction(i, 7);
        EXPECT_NEAR(length(d), 1, 1e-6);
        EXPECT_GE(d.z, 0);
        const double turn = std::atan2(double{d.y}, double{d.x}) / (2 * double{kPi});
        const auto column = static_cast<uint32_t>(std::min(kSide - 1.0, double{d.z} * kSide)),
                   row = static_cast<uint32_t>(std::min(kSide - 1.0, (turn < 0 ? turn + 1 : turn) * kSide));
        ++counts[column * kSide + row];
    }
    EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 3);
    EXPECT_GT(std::count(counts.begin(), counts.end(), 1), kSide * kSide * 3 / 4);
}

TEST(Bundles, sides_send_what_their_emitters_say) {
    SceneBuilder b;
    const uint32_t gloss = b.material(glossy({0.2f, 0.1f, 0.3f}, {0.5f, 0.6f, 0.2f}, 0.3f));
    b.shape(gloss).sphere({}, 1, 1, false, true);
    const Scene scene = b.build(1);
    Emitters emitters(scene);
    Rng rng(3);
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        emitters.diffuse[side] = {rng.uniform(), rng.uniform(), rng.uniform()};
        for (Record& record : emitters.open_records(scene, side))
            if (rng.uniform() < 0.7f) record = {square_to_sphere(square(rng)), {rng.uniform(), rng.uniform(), rng.uniform()}, 1};
    }
    const Square at{0.2f, 0.5f};
    const SentLight light(scene, emitters, at);
    std::vector<Rgb> sent(scene.sides());
    for (int i = 0; i < 20; ++i) {
        const Vec3 d = square_to_sphere(square(rng));
        light.along(d, sent);
        for (uint32_t side = 0; side < scene.sides(); ++side) {
            const Surface y(scene, scene.point_on_patch(scene.patch_of_side(side), at), scene.is_back(side));
            const Rgb truth = SideSource(scene, emitters, side, 1).evaluate(y.shading, dot(y.normal, d) > 0 ? d : -d).radiance;
            EXPECT_NEAR(lum(sent[side]), lum(truth), 1e-5 * lum(truth));
        }
    }
}

TEST(Bundles, areas_are_their_projections_on_the_mean_whatever_the_window) {
    // Over jitter the rasterised area of a patch is A cos, also where patches are smaller than pixels, and every one of them is met.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).sphere({}, 1, 2, false);
    const Scene scene = b.build(1);
    for (uint32_t window : {16u, 64u}) {
        BundleCaster caster(scene, window);
        const std::vector<Vec3> directions(2000, normalize({0.3f, 0.5f, 0.8f}));
        std::vector<Bundle> bundles;
        BundleStats stats;
        caster.cast(directions, 5, [](uint32_t, Vec3, std::span<Rgb> sent) { std::fill(sent.begin(), sent.end(), Rgb{}); }, bundles, stats);
        std::vector<double> p_values;
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
            std::vector<double> cosines;
            for (const Bundle& bundle : bundles) cosines.push_back(double{bundle.cosine[patch]});
            const double truth = std::abs(dot(scene.geometric_normal(scene.triangle_of_patch(patch)), directions[0]));
            if (truth > 0.05) p_values.push_back(mean_of(cosines).p_value(truth));
        }
        EXPECT_TRUE(holm_keeps_all(p_values, 1e-3)) << window << ", least p " << *std::min_element(p_values.begin(), p_values.end());
    }
}

TEST(Bundles, light_between_patches_is_linear) {
    // On a plane a linear light comes back as it is; on a smooth sphere even radiance does, though every patch sees another part of it.
    SceneBuilder b;
    const uint32_t gloss = b.material(glossy({}, grey(0.5f), 0.2f));
    b.shape(gloss).quad({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}).shape(gloss).sphere({}, 1, 2, false, true);
    const Scene scene = b.build(700);
    const Lattice lattice(scene);
    std::vector<uint32_t> sides(scene.sides());
    std::iota(sides.begin(), sides.end(), 0u);
    BundleField field(scene, lattice, sides);
    std::vector<Bundle> bundles(20);
    const auto radiance = [](Vec3 x) { return Rgb{2, 1 + 0.5f * x.x, 1 - 0.25f * x.y}; };
    for (uint32_t i = 0; i < bundles.size(); ++i) {
        Bundle& bundle = bundles[i];
        bundle.direction = bundle_direction(i, 3);
        for (uint32_t side = 0; side < scene.sides(); ++side) {
            const uint32_t patch = scene.patch_of_side(side), triangle = scene.triangle_of_patch(patch);
            const float cos = std::abs(dot(scene.geometric_normal(triangle), bundle.direction));
            const Vec3 centre = scene.position(scene.centre_of_patch(patch));
            bundle.irradiance.push_back((scene.shape(triangle) == 0 ? radiance(centre) : Rgb{2, 2, 2}) * cos);
            if (side < scene.patches()) bundle.cosine.push_back(cos);
        }
    }
    field.pool(bundles);
    Rng rng(5);
    BundleField::Light light;
    for (int k = 0; k < 2000; ++k) {
        const auto patch = static_cast<uint32_t>(rng.uniform() * static_cast<float>(scene.patches()));
        const SurfacePoint p = scene.point_on_patch(patch, square_to_triangle(square(rng)));
        const Vec3 x = scene.position(p);
        const bool is_flat = scene.shape(p.triangle) == 0;
        // At the rim, vertices have patches on one side alone.
        if (is_flat && std::max(std::abs(x.x), std::abs(x.y)) > 0.8f) continue;
        field.at(p, k % 2 > 0, light);
        for (size_t i = 0; i < bundles.size(); ++i) {
            const float cos = std::abs(dot(scene.geometric_normal(p.triangle), bundles[i].direction));
            const Rgb truth = (is_flat ? radiance(x) : Rgb{2, 2, 2}) * cos;
            EXPECT_NEAR(light.cosine[i], cos, 1e-5f);
            EXPECT_NEAR(length(light.irradiance(i) - truth), 0, 1e-5f);
        }
    }
}

TEST(Bundles, growth_of_the_variance_of_the_plain_iteration) {
    for (float rho : {0.3f, 0.6f, 0.9f}) {
        const Stage stage(grey_room(rho).build(1));
        EXPECT_NEAR(variance_growth(stage.accel, stage.defensive, 1), 4 * double{rho} * double{rho} / 3, 0.03);
    }
    // Gloss that sees gloss, and a room without a back.
    SceneBuilder b;
    b.shape(b.material(glossy({}, grey(0.9f), 0.2f))).box({0, 0, 0}, {1, 1, 1}, true).point_lamp(grey(0.5f), grey(1));
    const Stage gloss(b.build(1));
    EXPECT_GT(variance_growth(gloss.accel, gloss.defensive, 1), 3);
    SceneBuilder flat;
    flat.shape(flat.material(matt(1))).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).point_lamp({0.5f, 0.5f, 1}, grey(1));
    const Stage open(flat.build(1));
    EXPECT_EQ(variance_growth(open.accel, open.defensive, 1), 0);
}

TEST(PlainIteration, mean_irradiance_of_closed_rooms) {
    for (float rho : {0.3f, 0.6f}) {
        const Stage stage(grey_room(rho).build(300));
        ASSERT_LT(variance_growth(stage.accel, stage.defensive, 1), 1);
        const double truth = lamp_power(stage.scene) / (stage.defensive.by_area.total() * (1 - double{rho}));
        for (bool first_shot : {false, true}) {
            RunConfig config = plain(first_shot, 41);
            config.solver.direct_samples = 32;
            expect_near(mean_irradiance(stage, config, {reachable(stage)})[0], truth, 4, "rho " + std::to_string(rho));
        }
    }
}

TEST(PlainIteration, finds_what_the_solved_state_finds) {
    // Gloss, shading normals, a perfect mirror and a point lamp, with a growth below 1.
    SceneBuilder b;
    const uint32_t wall = b.material(matt(0.3f)), gloss = b.material(glossy(grey(0.1f), grey(0.4f), 0.5f));
    b.shape(wall);
    for (int face : {0, 2, 3, 4, 5}) b.face(face, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(mirror(0.8f))).face(1, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(gloss).sphere({0.5f, 0.5f, 0.3f}, 0.2f, 2, false, true).point_lamp({0.2f, 0.8f, 0.7f}, grey(1));
    const Stage stage(b.build(500));
    ASSERT_LT(variance_growth(stage.accel, stage.defensive, 1), 1);
    const std::vector<SideFilter> filters{fronts_of_shape(0), fronts_of_shape(2)};
    const auto reference = mean_irradiance(
        stage, {.solver = {.transport = Transport::kRays, .direct_samples = 16, .seed = 42}, .replicas = 8, .rays = 200000}, filters);
    for (Iteration iteration : {Iteration::kPlain, Iteration::kFrozen}) {
        RunConfig config = plain(true, 43);
        config.solver.iteration = iteration, config.solver.direct_samples = 16;
        const auto found = mean_irradiance(stage, config, filters);
        for (size_t i = 0; i < filters.size(); ++i) {
            const double error = std::hypot(found[i].error, reference[i].error);
            EXPECT_NEAR(found[i].value, reference[i].value, 1e-3 * reference[i].value + student_quantile(1e-3 / 4, 7) * error) << i;
            EXPECT_LT(error, 0.01 * reference[i].value) << i;
        }
    }
}

TEST(PlainIteration, every_estimator_finds_what_the_lobe_sees) {
    const PatchInSphere p(0.6f, 0.15f, ramp);
    ASSERT_LT(variance_growth(p.stage.accel, p.stage.defensive, 1), 1);
    for (float gather : {0.0f, 2.0f}) {
        RunConfig config = plain(true, 44);
        config.solver.gather = gather, config.solver.window = 64;
        expect_truth(ratios_to_truth(p, {config.solver, 40000}), 8, std::string("plain") + (gather > 0 ? ", gathering" : ""));
    }
}
