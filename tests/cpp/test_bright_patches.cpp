// Rays that are sent to bright patches find the same light as those that go anywhere, with less noise.
#include <gtest/gtest.h>

#include <numbers>

#include "lumel/eye/bright_patches.h"
#include "lumel/eye/gather_rays.h"
#include "lumel/eye/lobe_draw.h"
#include "lumel/sampling/warp.h"
#include "lumel/solver/session.h"
#include "scenes.h"
#include "stats.h"

namespace lumel::test {

namespace {

constexpr Vec3 kAt{0.3f, 0.4f, 0.01f}, kUp{0, 0, 1};
constexpr int kBatches = 64;
constexpr uint32_t kRays = 512;

/// A closed room with a small square in parallel over the floor, and a plate over a part of the floor that hides a part of it from kAt.
Scene room(bool hidden) {
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(0).quad({0.3f, 0.4f, 0.99f}, {0, 0.1f, 0}, {0.1f, 0, 0});
    if (hidden) b.shape(0).quad({0.3f, 0.4f, 0.495f}, {0, 0.05f, 0}, {0.025f, 0, 0});
    return b.build(400);
}

bool is_spot(const Scene& scene, uint32_t triangle, bool back) {
    const float z = scene.position({triangle, 1.0f / 3, 1.0f / 3}).z;
    return !back && z > 0.98f && z < 0.995f;
}

/// Radiosity 500 on the front of the square, 0.5 elsewhere.
BrightPatches patches_of(const Scene& scene) {
    return {scene, [&](uint32_t side) { return grey(is_spot(scene, scene.triangle_of_side(side), scene.is_back(side)) ? 1000 : 1); }};
}

/// Of directions around (0, 0, 1), drawn from a cosine or a lobe, or sent: the mean of what they count that meet the square, and others.
struct Found {
    Mean spot, rest;
};
Found gathered(const Scene& scene, const BrightPatches& bright, float alpha) {
    const Accel accel(scene);
    const Vec3 wo = normalize(Vec3{0.1f, -0.2f, 1});
    std::vector<double> spots, rests;
    for (int batch = 0; batch < kBatches; ++batch) {
        double spot = 0, rest = 0;
        for (uint32_t i = 0; i < kRays; ++i) {
            EyeStream stream(key(7, static_cast<uint64_t>(batch)), i);
            const auto target = bright.draw(stream);
            LobeDraw lobe;
            if (alpha > 0)
                lobe = target ? LobeDraw::along(normalize(target->x - kAt), kUp, wo, alpha) : LobeDraw(kUp, wo, alpha, stream.next());
            else
                lobe.wi = target ? normalize(target->x - kAt) : Frame(kUp).to_world(square_to_cosine_hemisphere(stream.next()));
            const float pdf_w = alpha > 0 ? lobe.pdf_w : std::max(0.0f, lobe.wi.z) * kInvPi;
            const Hit hit = accel.intersect({kAt, lobe.wi});
            if (hit.is_miss() || !(pdf_w > 0)) continue;
            const double value = double{bright.weight(pdf_w, target, kAt, hit)} * (alpha > 0 ? double{lobe.masked} : 1.0);
            (is_spot(scene, hit.triangle, hit.back) ? spot : rest) += value / kRays;
        }
        spots.push_back(spot), rests.push_back(rest);
    }
    return {mean_of(spots), mean_of(rests)};
}

/// Form factor from a point to a rectangle in parallel at distance 1, one corner of which is right over it.
double corner_factor(double x, double y) {
    const double a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
    return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * std::numbers::pi);
}

constexpr double kSignificance = 1e-4;

}  // namespace

TEST(BrightPatches, show_the_form_factor_of_what_is_bright) {
    for (bool hidden : {false, true}) {
        const Scene scene = room(hidden);
        const BrightPatches bright = patches_of(scene);
        ASSERT_GT(bright.share(), 0.05f);
        const Found sent = gathered(scene, bright, 0), any = gathered(scene, {}, 0);
        constexpr double kDistance = 0.98, kSize = 0.1 / kDistance;
        // The plate is a rectangle over the point, too.
        const double whole = corner_factor(kSize, kSize), expected = hidden ? whole - corner_factor(0.025 / 0.485, 0.05 / 0.485) : whole;
        EXPECT_GT(sent.spot.p_value(expected), kSignificance) << sent.spot.value << " " << expected;
        EXPECT_GT(any.spot.p_value(expected), kSignificance) << any.spot.value << " " << expected;
        EXPECT_GT(sent.rest.p_value(1 - expected), kSignificance) << sent.rest.value << " " << 1 - expected;
        EXPECT_LT(sent.spot.error, 0.5 * any.spot.error);
    }
}

TEST(BrightPatches, are_found_along_lobes_as_by_lobes_alone) {
    const Scene scene = room(true);
    const BrightPatches bright = patches_of(scene);
    for (float alpha : {0.05f, 0.3f}) {
        const Found sent = gathered(scene, bright, alpha), any = gathered(scene, {}, alpha);
        for (const auto& [a, b] : {std::pair(sent.spot, any.spot), std::pair(sent.rest, any.rest)})
            EXPECT_LT(std::abs(a.value - b.value), 4 * std::hypot(a.error, b.error)) << alpha;
    }
}

TEST(BrightPatches, are_found_over_gloss_as_by_lobes_alone) {
    // A lamp that shines on the ceiling right over it, another one that shines down, and a glossy plate on the floor that a gathering ray
    // meets.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(glossy(grey(0.02f), grey(0.95f), 0.4f))).quad({0.2f, 0.2f, 0.02f}, {0.3f, 0, 0}, {0, 0.3f, 0});
    b.shape(b.material(matt(0)), grey(1000)).quad({0.8f, 0.5f, 0.97f}, {0.04f, 0, 0}, {0, 0.04f, 0});
    b.shape(b.material(matt(0)), grey(2)).quad({0.4f, 0.5f, 0.9f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    Session session(b.build(3000), {}, {.solver = {.seed = 5}});
    session.solver().begin_replica(200000);
    session.solver().step(200000);
    session.solver().end_replica();
    session.reconstruct();
    const Reconstruction& reconstruction = session.reconstruction();
    ASSERT_GT(reconstruction.bright_patches().share(), 0.05f);

    const Scene& scene = session.scene();
    const EyeShader shader(session.accel(), reconstruction, true);
    const Ray ray{{0.3f, 0.1f, 0.7f}, normalize(Vec3{0.05f, 0.2f, -0.68f})};
    const Hit plate = session.accel().intersect(ray);
    const Surface x(scene, plate.point(), plate.back);
    ASSERT_TRUE(x.material->is_glossy());
    const Rgb diffuse = x.material->diffuse * reconstruction.irradiance(reconstruction.stencil(plate.point(), plate.back)).value * kInvPi;

    std::vector<PixelPass> pass(kBatches);
    ShadowRays shadows(session.accel(), pass);
    GatherRays gathers(shader, shadows, pass);
    std::vector<double> sent, alone;
    for (uint32_t batch = 0; batch < kBatches; ++batch) {
        double sum = 0;
        for (uint32_t i = 0; i < kRays; ++i) {
            gathers.add(ray, {batch, Layer::kIndirectSpecular, grey(1), true, 0, key(3, batch), i});
            EyeStream stream(key(4, batch), i);
            const LobeDraw lobe(x.shading, -ray.direction, x.material->alpha, stream.next());
            if (!(lobe.pdf_w > 0) || !(dot(x.normal, lobe.wi) > 0)) continue;
            const Hit y = session.accel().intersect({x.off(scene.epsilon()), lobe.wi});
            const Rgb albedo = scene.material(y.triangle).diffuse, emitted = y.back ? Rgb{} : scene.emission(y.triangle),
                      light = emitted + albedo * reconstruction.total_irradiance(reconstruction.stencil(y.point(), y.back)) * kInvPi;
            sum += double{lum(lobe.scatter(*x.material) * light)};
        }
        alone.push_back(double{lum(diffuse)} + sum / kRays);
    }
    gathers.finish();
    shadows.cast();
    for (const PixelPass& p : pass) sent.push_back(double{lum(p.sum.indirect_specular)} / kRays);
    const Mean of_sent = mean_of(sent), of_lobes = mean_of(alone);
    EXPECT_LT(std::abs(of_sent.value - of_lobes.value), 4 * std::hypot(of_sent.error, of_lobes.error))
        << of_sent.value << " " << of_lobes.value;
    EXPECT_LT(of_sent.error, 0.6 * of_lobes.error);
}

TEST(BrightPatches, are_none_where_light_is_spread) {
    const Scene scene = room(false);
    const BrightPatches even(scene, [](uint32_t) { return grey(1); }), dark(scene, [](uint32_t) { return Rgb{}; });
    for (const BrightPatches* none : {&even, &dark}) {
        EXPECT_EQ(none->share(), 0);
        EyeStream stream(1, 2);
        EXPECT_FALSE(none->draw(stream));
        EXPECT_EQ(none->weight(0.1f, {}, kAt, {}), 1);
    }
}

}  // namespace lumel::test
