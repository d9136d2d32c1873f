// The density is right and covers the target: the mean of g/p is 1 in every area.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "lumel/areas/pixels.h"
#include "runs.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr uint32_t kReplicas = 16;
constexpr uint64_t kRays = 80000;  // of a replica
constexpr Camera kCamera{.origin = {0.5f, 0.1f, 0.8f},
                         .right = {1, 0, 0},
                         .up = {0, 0.6f, 0.8f},
                         .forward = {0, 0.8f, -0.6f},
                         .tan_x = 0.8f,
                         .tan_y = 0.6f,
                         .width = 12,
                         .height = 9};

/// G of areas over replicas, tested against 1.
struct Coverage {
    double pooled = 0;             ///< mean G over all areas by the light that they could reflect
    double pooled_p = 0;           ///< its p-value
    std::vector<double> p_values;  ///< of the areas with at least 100 effective hits
    bool is_kept() const { return holm_keeps_all(p_values, 1e-3) && pooled_p >= 1e-3; }
};

/// Areas of one kind, measured replica by replica.
template <class Areas>
class Measured {
public:
    /// `weights`: per area, what its G counts in the pooled mean.
    Measured(Areas areas, std::vector<double> weights) : areas_(std::move(areas)), weights_(std::move(weights)) {}

    void measure(const Step& step) { areas_.measure(step); }
    void close_replica(double rays) {
        areas_.close_replica(1, rays);
        double all = 0, sum = 0;
        for (uint32_t area = 0; area < weights_.size(); ++area) all += weights_[area], sum += weights_[area] * areas_.samples(0, area).g;
        // The mean over the replicas so far tells what this one added to it.
        const double count = static_cast<double>(pooled_.size() + 1);
        pooled_.push_back(count * sum / all - before_);
        before_ = count * sum / all;
    }
    Coverage coverage() const {
        Coverage c{.pooled = mean_of(pooled_).value, .pooled_p = mean_of(pooled_).p_value(1), .p_values = {}};
        for (uint32_t area = 0; area < weights_.size(); ++area) {
            const Samples s = areas_.samples(0, area);
            if (weights_[area] > 0 && s.g * s.g >= 100 * s.gg)
                c.p_values.push_back(Mean{s.g, std::sqrt(s.var_g), static_cast<int>(s.replicas)}.p_value(1));
        }
        return c;
    }

private:
    Areas areas_;
    std::vector<double> weights_, pooled_;
    double before_ = 0;
};

Measured<PatchAreas> patches_of(const Stage& stage) {
    PatchAreas areas(stage.scene, {kCamera.origin}, glossy_sides_towards(stage.scene, kCamera.origin, reachable(stage)));
    std::vector<double> weights;
    for (uint32_t area = 0; area < areas.size(); ++area) weights.push_back(areas.albedo(0, area) * areas.area(area));
    return {std::move(areas), std::move(weights)};
}

Measured<PixelAreas> pixels_of(const Stage& stage) {
    PixelAreas areas(stage.accel, stage.lattice, {kCamera});
    std::vector<double> weights;
    for (uint32_t pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) weights.push_back(areas.albedo(0, pixel));
    return {std::move(areas), std::move(weights)};
}

/// Changes a transfer that ended on a side before it is measured.
using Tamper = std::function<void(const Stage&, uint32_t side, Transfer&)>;

/// The transfers of a step on all that is not plain, each of them changed.
Transfers tampered(const Stage& stage, const Transfers& step, const Tamper& tamper) {
    std::vector<std::pair<uint32_t, Transfer>> all;
    for (uint32_t side = 0; side < stage.scene.sides(); ++side)
        for (Transfer transfer : step.placed(side)) {
            tamper(stage, side, transfer);
            all.emplace_back(side, transfer);
        }
    Transfers changed;
    changed.rays = step.rays;
    const size_t blocks = (all.size() + TransferBlock::kMost - 1) / TransferBlock::kMost;
    changed.open(blocks);
    for (size_t b = 0; b < blocks; ++b) changed.block(b).plain_size = changed.block(b).placed_size = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        TransferBlock& block = changed.block(i / TransferBlock::kMost);
        block.placed_side[block.placed_size] = all[i].first, block.placed[block.placed_size++] = all[i].second;
    }
    changed.group_by_side(stage.scene.sides());
    return changed;
}

struct CoverageRun {
    Transport transport = Transport::kRays;
    float defensive = 0.2f;
    bool first_shot = true;
    Tamper tamper;
};

/// Of every kind of area, by its name.
std::map<std::string, Coverage> coverage(const Stage& stage, const CoverageRun& run) {
    Measured<PatchAreas> patches = patches_of(stage);
    Measured<PixelAreas> pixels = pixels_of(stage);
    for (uint64_t replica = 0; replica < kReplicas; ++replica) {
        // One replica as the solver makes it, its transfers in our hands.
        double samples = 0;
        uint64_t generations = 0;
        const Sink sink = [&](const Generation& generation) {
            const std::optional<Transfers> changed = run.tamper ? std::optional(tampered(stage, generation.transfers, run.tamper))
                                                                : std::nullopt;
            const Step step{.transfers = changed ? *changed : generation.transfers,
                            .sight = generation.sight,
                            .bundles = generation.bundles,
                            .stream = key(64, replica, generations++)};
            patches.measure(step), pixels.measure(step);
            samples += step.samples();
        };
        const Illumination light(stage.accel, stage.defensive, {.first_shot = run.first_shot, .stream = key(60, replica)});
        run_replica(stage, run.transport, light, {kRays, run.defensive, key(61, replica)}, sink);
        patches.close_replica(samples), pixels.close_replica(samples);
    }
    return {{"patches", patches.coverage()}, {"pixels", pixels.coverage()}};
}

void leave_out_cosine(const Stage& stage, uint32_t side, Transfer& t) {
    const Scene& scene = stage.scene;
    const Surface x(scene, {scene.triangle_of_side(side), t.u, t.v}, scene.is_back(side));
    const Hit y = stage.accel.intersect({x.off(scene.epsilon()), t.wi});
    if (!y.is_miss()) t.inv_pdf /= std::max(1e-3f, std::abs(dot(scene.geometric_normal(y.triangle), t.wi)));
}

/// Walls of which one is black, a glossy floor and box, and a lamp that shines from one side.
Scene closed_scene() {
    SceneBuilder b;
    const uint32_t wall = b.material(matt(0.6f)), black = b.material(matt(0)),
                   gloss = b.material(glossy(grey(0.2f), {0.7f, 0.6f, 0.2f}, 0.25f));
    b.shape(gloss).face(4, {0, 0, 0}, {1, 1, 1}, true).shape(wall);
    for (int face : {0, 1, 2, 5}) b.face(face, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(black).face(3, {0, 0, 0}, {1, 1, 1}, true);
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

/// Nothing is matt: gloss below and around, a mirror behind that shines a little itself, and a lamp that looks at it.
Scene specular_scene() {
    SceneBuilder b;
    const uint32_t lamp = b.material(matt(0)), gloss = b.material(glossy({}, {0.8f, 0.7f, 0.5f}, 0.3f)), back = b.material(mirror(0.8f));
    b.shape(gloss);
    for (int face : {0, 1, 2, 4, 5}) b.face(face, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(back, grey(0.1f)).face(3, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(lamp, grey(10)).quad({0.4f, 0.4f, 0.6f}, {0, 0, 0.2f}, {0.2f, 0, 0});
    b.shape(gloss).sphere({0.35f, 0.6f, 0.25f}, 0.2f, 2, false, true);
    return b.build(500);
}

/// Gloss among black walls, one of them missing, all one-sided; the lamp shows its back to most of them.
Scene dark_scene() {
    SceneBuilder b;
    Material black = matt(0), gloss = glossy({}, {0.7f, 0.6f, 0.2f}, 0.25f);
    black.two_sided = gloss.two_sided = false;
    const uint32_t wall = b.material(black), shiny = b.material(gloss);
    b.shape(shiny).face(4, {0, 0, 0}, {1, 1, 1}, true).shape(wall);
    for (int face : {0, 1, 3, 5}) b.face(face, {0, 0, 0}, {1, 1, 1}, true);
    b.shape(wall, grey(10)).quad({0.4f, 0.4f, 0.5f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    b.shape(shiny).box({0.3f, 0.5f, 0.1f}, {0.6f, 0.8f, 0.4f}, false);
    return b.build(500);
}

std::string what(const CoverageRun& run) {
    return name_of(run.transport) + (run.first_shot ? ", first shot" : "") + ", defensive " + std::to_string(run.defensive);
}

/// Half-covered areas are what g over a_bar is for.
int pixels_half_on_gloss(const Stage& stage) {
    int count = 0;
    for (uint32_t pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) {
        int gloss = 0;
        constexpr int kPoints = 64;
        for (uint32_t i = 0; i < kPoints; ++i) {
            const Square s = sobol2d(i, 5);
            const Hit hit = stage.accel.intersect(
                {kCamera.origin,
                 kCamera.direction({(static_cast<float>(pixel % kCamera.width) + s.u) / static_cast<float>(kCamera.width),
                                    (static_cast<float>(pixel / kCamera.width) + s.v) / static_cast<float>(kCamera.height)})});
            gloss += !hit.is_miss() && stage.scene.material(hit.triangle).is_glossy();
        }
        count += gloss > kPoints / 4 && gloss < 3 * kPoints / 4;
    }
    return count;
}

}  // namespace

TEST(Coverage, mean_of_g_over_p_is_one_in_every_area) {
    const std::map<std::string, Scene (*)()> scenes{{"closed", closed_scene}, {"open", open_scene}, {"specular", specular_scene}};
    for (const auto& [name, make] : scenes) {
        const Stage stage(make());
        ASSERT_EQ(stage.defensive.open(), name == "open");
        EXPECT_GT(pixels_half_on_gloss(stage), 3) << name;
        for (Transport transport : kTransports)
            for (bool first_shot : {false, true}) {
                const CoverageRun run{transport, 0.3f, first_shot, {}};
                for (const auto& [kind, c] : coverage(stage, run)) {
                    ASSERT_GT(c.p_values.size(), 20u) << what(run) << ", " << name << ", " << kind;
                    EXPECT_TRUE(c.is_kept()) << what(run) << ", " << name << ", " << kind << ": pooled " << c.pooled << ", p " << c.pooled_p
                                             << ", least of " << c.p_values.size() << " p "
                                             << *std::min_element(c.p_values.begin(), c.p_values.end());
                }
            }
    }
}

TEST(Coverage, bundles_need_no_defensive_part) {
    // Among black walls under the sky, all one-sided: where nothing sends light, bundles count.
    for (const auto& [kind, c] : coverage(Stage(dark_scene()), {Transport::kBundles, 0, true, {}})) {
        EXPECT_TRUE(c.is_kept()) << kind << ": pooled " << c.pooled << ", p " << c.pooled_p;
        EXPECT_GT(c.p_values.size(), 20u);
    }
}

TEST(Coverage, test_fails_without_the_cosine_at_the_source) {
    const Stage stage(closed_scene());
    for (Transport transport : kRayTransports)
        for (const auto& [kind, c] : coverage(stage, {transport, 0.3f, true, leave_out_cosine}))
            EXPECT_FALSE(c.is_kept()) << name_of(transport) << ", " << kind;
}

TEST(Coverage, test_fails_without_the_defensive_part_under_the_sky) {
    const Stage stage(open_scene());
    for (Transport transport : kRayTransports)
        for (const auto& [kind, c] : coverage(stage, {transport, 0, true, {}})) {
            EXPECT_FALSE(c.is_kept()) << name_of(transport) << ", " << kind;
            EXPECT_LT(c.pooled, 0.9) << name_of(transport) << ", " << kind;
        }
}
