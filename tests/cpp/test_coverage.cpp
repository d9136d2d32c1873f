// The density is right and covers the target: the mean of g/p is 1 in every area.
#include <gtest/gtest.h>

#include "runs.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr uint32_t kReplicas = 16;

/// G of areas over replicas, tested against 1.
struct Coverage {
    double pooled = 0;            ///< mean G over all areas by area and albedo
    double pooled_p = 0;          ///< its p-value
    std::vector<double> p_values;  ///< of the areas with at least 100 effective hits
    bool is_kept() const { return holm_keeps_all(p_values, 1e-3) && pooled_p >= 1e-3; }
};

/// Changes the transfers of a step before they are measured.
using Tamper = std::function<void(const Stage&, std::vector<Transfer>&)>;

struct CoverageRun {
    Transport transport = Transport::kRays;
    float defensive = 0.2f;
    bool first_shot = true;
    Tamper tamper;
};

/// g of a transfer but for a_bar and the number of rays, from its definition: lum(w_s) / (A p).
double g_of(const Scene& scene, const Transfer& t, Vec3 eye) {
    const Surface x(scene, {scene.triangle_of_side(t.side), t.u, t.v}, scene.is_back(t.side));
    const Frame frame(x.shading);
    const float cos = dot(x.normal, t.wi);
    if (!(cos > 0)) return 0;
    const Rgb w = x.material->scatter_s(frame.to_local(t.wi), frame.to_local(normalize(eye - x.x)));
    return double{lum(w)} * double{t.inv_pdf} / double{cos} / double{scene.side_area(t.side)};
}

Coverage coverage(const Stage& stage, Vec3 eye, const CoverageRun& run) {
    const Scene& scene = stage.scene;
    const PatchAreas blank(scene, {eye}, glossy_sides_towards(scene, eye, reachable(stage)));
    std::vector<std::vector<double>> g(blank.size());
    std::vector<double> sum(blank.size()), squares(blank.size()), pooled;
    double all = 0;
    for (uint32_t area = 0; area < blank.size(); ++area) all += blank.albedo(0, area) * double{scene.side_area(blank.sides()[area])};

    for (uint64_t replica = 0; replica < kReplicas; ++replica) {
        // One replica as the solver makes it, its transfers in our hands.
        PatchAreas areas = blank;
        double rays_measured = 0;
        const Sink sink = [&](const Generation& generation) {
            Transfers transfers = generation.transfers;
            if (run.tamper) run.tamper(stage, transfers.all);
            areas.measure({.transfers = transfers, .sight = generation.sight});
            rays_measured += static_cast<double>(transfers.rays);
            for (uint32_t area = 0; area < areas.size(); ++area)
                for (const Transfer& transfer : transfers.group(areas.sides()[area])) {
                    const double value = g_of(scene, transfer, eye) * static_cast<double>(transfers.rays);
                    sum[area] += value, squares[area] += value * value;
                }
        };
        const Illumination light(stage.accel, stage.defensive, {.first_shot = run.first_shot, .stream = key(60, replica)});
        if (run.transport == Transport::kWalk) {
            walk(stage.accel, stage.defensive, light.emitters(key(62, replica)), {60000, run.defensive, key(61, replica)}, sink);
        } else {
            uint64_t rays = 0;
            FrozenLight frozen(stage.accel, stage.defensive, light, {30000, 0, key(62, replica)}, rays);
            frozen.step(stage.accel, stage.defensive, light, {120000, run.defensive, key(63, replica)}, sink);
        }
        areas.close_replica(1, rays_measured);
        double total = 0;
        for (uint32_t area = 0; area < areas.size(); ++area) {
            g[area].push_back(areas.samples(0, area).g);
            total += g[area].back() * blank.albedo(0, area) * double{scene.side_area(blank.sides()[area])};
        }
        pooled.push_back(total / all);
    }
    Coverage result{.pooled = mean_of(pooled).value, .pooled_p = mean_of(pooled).p_value(1), .p_values = {}};
    for (uint32_t area = 0; area < blank.size(); ++area)
        if (blank.albedo(0, area) > 0 && sum[area] * sum[area] >= 100 * squares[area])
            result.p_values.push_back(mean_of(g[area]).p_value(1));
    return result;
}

void leave_out_cosine(const Stage& stage, std::vector<Transfer>& transfers) {
    for (Transfer& t : transfers) {
        if (t.side == Transfer::kLost) continue;
        const Scene& scene = stage.scene;
        const Surface x(scene, {scene.triangle_of_side(t.side), t.u, t.v}, scene.is_back(t.side));
        const Hit y = stage.accel.intersect({x.off(scene.epsilon()), t.wi});
        if (!y.is_miss()) t.inv_pdf /= std::max(1e-3f, std::abs(dot(scene.geometric_normal(y.triangle), t.wi)));
    }
}

const Vec3 kEye{0.5f, 0.1f, 0.8f};

Scene closed_scene() {
    SceneBuilder b;
    const uint32_t wall = b.material(matt(0.6f)), gloss = b.material(glossy(grey(0.2f), {0.7f, 0.6f, 0.2f}, 0.25f));
    b.shape(gloss).face(4, {0, 0, 0}, {1, 1, 1}, true).shape(wall);
    for (int face : {0, 1, 2, 3, 5}) b.face(face, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(wall, grey(10)).quad({0.4f, 0.4f, 0.95f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    b.shape(gloss).box({0.3f, 0.5f, 0.1f}, {0.6f, 0.8f, 0.4f}, false);
    return b.build(500);
}

/// A glossy floor and a matt wall under the sky, a lamp above.
Scene open_scene() {
    SceneBuilder b;
    const uint32_t wall = b.material(matt(0.6f)), gloss = b.material(glossy(grey(0.2f), {0.7f, 0.6f, 0.2f}, 0.25f));
    b.shape(gloss).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(wall).quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
    b.shape(wall, grey(10)).quad({0.4f, 0.4f, 1.1f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    return b.build(300);
}

std::string what(const CoverageRun& run) {
    return name_of(run.transport) + (run.first_shot ? ", first shot" : "") + ", defensive " + std::to_string(run.defensive);
}

}  // namespace

TEST(Coverage, mean_of_g_over_p_is_one_in_every_area) {
    for (bool open : {false, true}) {
        const Stage stage(open ? open_scene() : closed_scene());
        ASSERT_EQ(stage.defensive.open(), open);
        for (Transport transport : kTransports)
            for (bool first_shot : {false, true}) {
                const CoverageRun run{transport, 0.3f, first_shot, {}};
                const Coverage c = coverage(stage, kEye, run);
                EXPECT_TRUE(c.is_kept()) << what(run) << (open ? ", open" : ", closed") << ": pooled " << c.pooled << ", p " << c.pooled_p
                                         << ", least p " << *std::min_element(c.p_values.begin(), c.p_values.end());
                EXPECT_GT(c.p_values.size(), 20u);
            }
    }
}

TEST(Coverage, test_fails_without_the_cosine_at_the_source) {
    const Stage stage(closed_scene());
    for (Transport transport : kTransports)
        EXPECT_FALSE(coverage(stage, kEye, {transport, 0.3f, true, leave_out_cosine}).is_kept()) << name_of(transport);
}

TEST(Coverage, test_fails_without_the_defensive_part_under_the_sky) {
    const Stage stage(open_scene());
    for (Transport transport : kTransports) {
        const Coverage c = coverage(stage, kEye, {transport, 0, true, {}});
        EXPECT_FALSE(c.is_kept()) << name_of(transport);
        EXPECT_LT(c.pooled, 0.9) << name_of(transport);
    }
}
