// Bundles in meshes with holes, with numbers that are none, that cross themselves, and in any garbage.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "lumel/solver/session.h"
#include "runs.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr float kAlbedo = 0.5f;

/// A sphere of radius 1 that shines and reflects alike everywhere, seen from inside.
SceneBuilder shining_sphere() {
    SceneBuilder b;
    b.shape(b.material(matt(kAlbedo)), grey(kInvPi)).sphere({}, 1, 3, true);
    return b;
}

/// What bundles found in a broken sphere of which the part `hole` of the area is gone.
struct Broken {
    BundleStats stats;
    double irradiance = 0, hole = 0;

    explicit Broken(const SceneBuilder& builder) {
        const Stage stage(builder.build(1));
        hole = 1 - stage.scene.total_area() / shining_sphere().build(1).total_area();
        const RunConfig config{
            .solver = {.transport = Transport::kBundles, .first_shot = false, .seed = 45, .window = 128}, .replicas = 4, .rays = 100000};
        const Solver solver = solved(stage, config, no_areas(stage.scene));
        stats = solver.stats().bundles;
        irradiance = mean_over(stage.scene, total_irradiance(solver, stage.scene), fronts());
    }
    /// In a sphere all light goes everywhere alike: a hole lets out its share of what is sent, and takes it from the irradiance,
    /// H = mean(E) / (1 - mean(rho)) over the whole sphere with exitance E = 1 where it is left.
    void expect_closed_form() const {
        EXPECT_NEAR(stats.escaped / stats.sent, hole, 2e-3);
        EXPECT_NEAR(stats.received / stats.sent, 1 - hole, 2e-3);
        const double truth = (1 - hole) / (1 - double{kAlbedo} * (1 - hole));
        EXPECT_NEAR(irradiance, truth, 5e-3 * truth);
    }
};

/// Any garbage, of all kinds of materials and lamps.
Scene garbage(uint64_t seed) {
    SceneBuilder b = soup(seed);
    const uint32_t first = b.shapes();
    Material one_sided = matt(0.8f);
    one_sided.two_sided = false;
    b.shape(b.material(glossy(grey(0.2f), grey(0.6f), 0.3f))).shape(b.material(glossy({}, grey(0.9f), 0.01f)));
    b.shape(b.material(mirror(0.9f))).shape(b.material(one_sided), grey(2)).shape(b.material(matt(0)));
    Rng rng(key(seed, 1));
    for (uint32_t& shape : b.triangle_shape)
        if (rng.uniform() < 0.6f) shape = first + static_cast<uint32_t>(rng.uniform() * 5);
    b.point_lamp({0.3f, 0.2f, 0.1f}, grey(1));
    return b.build(seed % 3 == 0 ? 1 : 150);
}

/// How many are tried: $LUMEL_GARBAGE, as the sanitizers set it, or a few.
uint64_t garbage_meshes() {
    const char* wanted = std::getenv("LUMEL_GARBAGE");
    return wanted ? std::strtoull(wanted, nullptr, 10) : 60;
}

bool is_picture(const Film& film) {
    return std::all_of(film.sum.begin(), film.sum.end(), [](const auto& pixel) {
        const Rgb value = pixel.radiance();
        return std::isfinite(lum(value)) && value.x >= 0 && value.y >= 0 && value.z >= 0;
    });
}

}  // namespace

TEST(BrokenMeshes, a_sound_sphere_lets_nothing_out) {
    const Broken sound(shining_sphere());
    ASSERT_EQ(sound.hole, 0);
    EXPECT_EQ(sound.stats.raster.parity_violations, 0u);
    EXPECT_EQ(sound.stats.mispaired, 0);
    EXPECT_LT(sound.stats.escaped, 1e-6 * sound.stats.sent);
    sound.expect_closed_form();
}

TEST(BrokenMeshes, cracks_let_out_their_share_of_the_light) {
    // A slit along a meridian, a lid, and triangles that are missing here and there.
    const auto cracked = [](const std::function<bool(Vec3, size_t)>& is_missing) {
        SceneBuilder b = shining_sphere();
        for (size_t t = b.indices.size(); t-- > 0;) {
            const auto [i, j, k] = b.indices[t];
            if (!is_missing((b.vertices[i] + b.vertices[j] + b.vertices[k]) / 3.0f, t)) continue;
            b.indices.erase(b.indices.begin() + static_cast<std::ptrdiff_t>(t));
            b.triangle_shape.pop_back();
        }
        return Broken(b);
    };
    const std::array cracks{cracked([](Vec3 x, size_t) { return std::abs(x.x) < 0.03f && x.y > 0; }),
                            cracked([](Vec3 x, size_t) { return x.z > 0.8f; }), cracked([](Vec3, size_t t) { return t % 7 == 3; })};
    for (const Broken& broken : cracks) {
        EXPECT_GT(broken.hole, 0.01);
        broken.expect_closed_form();
    }
}

TEST(BrokenMeshes, triangles_with_broken_numbers_are_holes) {
    SceneBuilder b = shining_sphere();
    for (size_t i = 0; i < b.vertices.size(); i += 20)
        b.vertices[i].y = i % 3 == 0   ? std::numeric_limits<float>::quiet_NaN()
                          : i % 3 == 1 ? std::numeric_limits<float>::infinity()
                                       : -1e30f;
    const Broken broken(b);
    EXPECT_GT(broken.hole, 0.1);
    broken.expect_closed_form();
}

TEST(BrokenMeshes, a_sphere_that_crosses_itself_is_told_and_loses_nothing) {
    // A part of the wall is pushed out through the wall opposite: closed as before, but lines meet front behind front there.
    SceneBuilder b = shining_sphere();
    for (Vec3& v : b.vertices)
        if (v.z > 0.9f) v.z -= 3;
    const Broken crossing(b);
    EXPECT_GT(static_cast<double>(crossing.stats.raster.parity_violations), 1e-3 * static_cast<double>(crossing.stats.raster.lines));
    EXPECT_GT(crossing.stats.mispaired, 1e-3 * crossing.stats.sent);
    EXPECT_LT(crossing.stats.mispaired, crossing.stats.sent);
    EXPECT_NEAR((crossing.stats.received + crossing.stats.escaped) / crossing.stats.sent, 1, 1e-6);
}

TEST(BrokenMeshes, garbage_gives_pictures) {
    const Camera camera{.origin = {0.1f, 0.2f, 2.5f},
                        .right = {1, 0, 0},
                        .up = {0, 1, 0},
                        .forward = {0, 0, -1},
                        .tan_x = 0.5f,
                        .tan_y = 0.4f,
                        .width = 5,
                        .height = 4};
    uint64_t met = 0;
    const uint64_t meshes = garbage_meshes();
    for (uint64_t seed = 0; seed < meshes && !HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        SessionConfig config;
        config.solver = {.transport = Transport::kBundles,
                         .gather = seed % 2 ? 0.0f : 50.0f,
                         .first_shot = seed % 5 > 0,
                         .seed = seed,
                         .iteration = seed % 16 ? Iteration::kFrozen : Iteration::kPlain,
                         .window = 24};
        config.areas = seed % 3 ? AreaKind::kPixels : AreaKind::kPatches;
        Session session(garbage(seed), {camera}, config);
        for (int replica = 0; replica < 2; ++replica) {
            session.solver().begin_replica(200);
            session.solver().step(16);
            session.solver().end_replica();
        }
        session.reconstruct();
        ASSERT_TRUE(session.eye_pass(0, 1));
        EXPECT_TRUE(is_picture(session.film(0)));
        const BundleStats stats = session.solver().stats().bundles;
        met += stats.raster.fragments > 0;
        EXPECT_NEAR(stats.received + stats.escaped, stats.sent, 1e-5 * stats.sent);
        EXPECT_LE(stats.mispaired, stats.received * (1 + 1e-5));
    }
    // A few are so large that all of them lies between the pixels of a small window.
    EXPECT_GT(met, meshes * 4 / 5);
}
