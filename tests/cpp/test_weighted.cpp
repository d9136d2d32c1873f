// What proves `weighted`: the density p is right and covers g.
#include <gtest/gtest.h>

#include "lobe.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr Rgb kLight{2, 3, 1};

/// A closed box with a glossy box and a glossy one-sided ball in it; tints do not depend on the angle. No lamp.
SceneBuilder homogeneous_scene() {
    SceneBuilder b;
    Material one_sided = glossy({0.1f, 0.3f, 0.2f}, {0.6f, 0.5f, 0.4f}, 0.15f);
    one_sided.two_sided = false;
    const uint32_t walls = b.material(matt(0.4f)), gloss = b.material(glossy(grey(0.2f), {0.7f, 0.5f, 0.3f}, 0.3f)),
                   ball = b.material(one_sided);
    b.shape(walls).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(gloss).box({0.15f, 0.2f, 0.1f}, {0.4f, 0.5f, 0.4f}, false);
    b.shape(ball).sphere({0.7f, 0.6f, 0.5f}, 0.2f, 1, false);
    return b;
}

/// A scene without lamps cannot be surveyed: light is taken to reach all fronts.
DefensiveStarts all_fronts(const Scene& scene) {
    DefensiveStarts starts;
    starts.by_area = Distribution(scene.sides(), [&](uint32_t side) { return scene.is_back(side) ? 0.0f : scene.side_area(side); });
    return starts;
}

/// The mean albedo of a side towards an eye in colour: that of its luminance times the tint.
Rgb tinted(const Scene& scene, const PatchAreas& areas, uint32_t area) {
    const Rgb tint = scene.material(scene.triangle_of_side(areas.sides()[area])).specular;
    return tint * static_cast<float>(areas.albedo(0, area) / double{lum(tint)});
}

void expect_same_colour(Rgb64 value, Rgb truth, double relative, const std::string& what) {
    EXPECT_NEAR(value.x, truth.x, relative * double{truth.x}) << what;
    EXPECT_NEAR(value.y, truth.y, relative * double{truth.y}) << what;
    EXPECT_NEAR(value.z, truth.z, relative * double{truth.z}) << what;
}

/// One step from surfaces that all send the radiance L0, whatever the direction: diffuse flux of pi L0 A on every front; records do so
/// where a lobe sends it.
class HomogeneousStep {
public:
    HomogeneousStep(const Scene& scene, const Accel& accel, Rgb radiance, const ShootConfig& config)
        : emitters_(scene), defensive_(all_fronts(scene)), shot_(accel, lit(scene, radiance), defensive_, config) {
        shoot(shot_, transfers_);
    }
    Step step() const { return {.transfers = transfers_, .sight = shot_}; }
    double rays() const { return static_cast<double>(transfers_.rays); }

private:
    const Emitters& lit(const Scene& scene, Rgb radiance) {
        for (uint32_t side = 0; side < scene.patches(); ++side) emitters_.diffuse[side] = radiance * (kPi * scene.side_area(side));
        return emitters_;
    }
    Emitters emitters_;
    DefensiveStarts defensive_;
    Transfers transfers_;
    Shot shot_;
};

}  // namespace

TEST(Homogeneous, one_step_is_exact_after_one_hit) {
    const Scene scene = homogeneous_scene().build(800);
    const Accel accel(scene);
    const Vec3 eye{0.5f, 0.1f, 0.9f};
    for (float share : {0.0f, 0.3f, 1.0f})
        for (uint64_t rays : {500u, 20000u}) {
            PatchAreas areas(scene, {eye}, glossy_sides_towards(scene, eye, fronts()));
            const HomogeneousStep one(scene, accel, kLight, {rays, share, 7});
            areas.measure(one.step());
            areas.close_replica(1, one.rays());
            int hit = 0;
            for (uint32_t area = 0; area < areas.size(); ++area) {
                const Samples samples = areas.samples(0, area);
                if (!(samples.g > 0)) continue;
                ++hit;
                expect_same_colour(find_estimator("weighted")->estimate(samples).value, kLight * tinted(scene, areas, area), 1e-5,
                                   "share " + std::to_string(share));
            }
            EXPECT_GT(hit, 10);
        }
}

TEST(Homogeneous, one_step_is_exact_after_one_hit_of_a_pixel) {
    // Pixels half on one tint and half on another have no colour of their own, but a luminance: white light shows it.
    constexpr float kWhite = 2;
    const Scene scene = homogeneous_scene().build(800);
    const Accel accel(scene);
    const Lattice lattice(scene);
    const Camera camera{.origin = {0.5f, 0.1f, 0.9f},
                        .right = {1, 0, 0},
                        .up = {0, 0.6f, 0.8f},
                        .forward = {0, 0.8f, -0.6f},
                        .tan_x = 0.6f,
                        .tan_y = 0.5f,
                        .width = 24,
                        .height = 20};
    for (float share : {0.0f, 0.3f, 1.0f})
        for (uint64_t rays : {5000u, 100000u}) {
            PixelAreas areas(accel, lattice, {camera});
            const HomogeneousStep one(scene, accel, grey(kWhite), {rays, share, 7});
            areas.measure(one.step());
            areas.close_replica(1, one.rays());
            int hit = 0;
            for (uint32_t pixel = 0; pixel < camera.width * camera.height; ++pixel) {
                const Samples samples = areas.samples(0, pixel);
                if (!(samples.g > 0)) continue;
                ++hit;
                const double truth = double{kWhite} * areas.albedo(0, pixel);
                EXPECT_NEAR(lum(find_estimator("weighted")->estimate(samples).value), truth, 1e-5 * truth) << "share " << share;
            }
            EXPECT_GT(hit, 10);
        }
}

TEST(Homogeneous, full_solves_keep_the_radiance) {
    const Scene scene = homogeneous_scene().build(800);
    const Accel accel(scene);
    const DefensiveStarts defensive = all_fronts(scene);
    const Vec3 eye{0.5f, 0.1f, 0.9f};
    const PatchAreas areas(scene, {eye}, glossy_sides_towards(scene, eye, fronts()));
    constexpr uint32_t kReplicas = 8;
    for (Transport transport : kTransports) {
        // Of every replica: mean irradiance of each shape over pi L0, and the sum of F over that of G a_bar L0.
        std::array<std::vector<double>, 4> ratios;
        for (uint32_t i = 0; i < kReplicas; ++i) {
            const RunConfig config{
                .solver = {.transport = transport, .defensive = 0.2f, .first_shot = false, .homogeneous = kLight, .seed = key(5, i)},
                .replicas = 1,
                .rays = 200000,
                .solve_rays = 200000};
            Solver solver(accel, defensive, config.solver, areas);
            run_replica(solver, config);
            for (uint32_t shape = 0; shape < 3; ++shape)
                ratios[shape].push_back(mean_over(scene, solver.indirect().mean, fronts_of_shape(shape)) /
                                        (double{kPi} * double{lum(kLight)}));
            double f = 0, g = 0;
            for (uint32_t area = 0; area < areas.size(); ++area) {
                const Samples samples = solver.areas().samples(0, area);
                f += lum(samples.f), g += samples.g * double{lum(kLight * tinted(scene, areas, area))};
            }
            ratios[3].push_back(f / g);
        }
        for (const auto& values : ratios) {
            const Mean m = mean_of(values);
            EXPECT_NEAR(m.value, 1, 1e-3 + student_quantile(1e-3 / 8, kReplicas - 1) * m.error)
                << name_of(transport) << ", error " << m.error;
            EXPECT_LT(m.error, &values == &ratios[3] ? 0.03 : 0.01);
        }
    }
}

TEST(Lobe, any_share_of_defensive_rays) {
    const PatchInSphere grey_sphere(0.5f, 0.15f, ramp);
    for (Transport transport : kRayTransports)
        for (float defensive : {0.1f, 0.2f, 0.5f}) {
            const SolverConfig config{.transport = transport, .defensive = defensive, .first_shot = false, .seed = 21};
            expect_truth(ratios_to_truth(grey_sphere, {config}), 12, name_of(transport) + ", defensive " + std::to_string(defensive));
        }
}

TEST(Lobe, half_in_the_dark) {
    // The lobe looks at the rim of a bright spot. Only with the defensive part, or with bundles, does p cover what it sees of the dark.
    const PatchInSphere p(0, 0.3f, spot);
    const SolverConfig bundles{.transport = Transport::kBundles, .first_shot = false, .seed = 23};
    expect_truth(ratios_to_truth(p, {bundles, 200000}), 4, "bundles, half in the dark");
    for (Transport transport : kRayTransports) {
        const SolverConfig covered{.transport = transport, .defensive = 0.3f, .first_shot = false, .seed = 23};
        expect_truth(ratios_to_truth(p, {covered, 200000}), 4, name_of(transport) + ", half in the dark");
        SolverConfig uncovered = covered;
        uncovered.defensive = 0;
        const auto ratios = ratios_to_truth(p, {uncovered, 200000});
        EXPECT_GT(ratios.at("weighted").value, 1.5) << "the test cannot fail";
        EXPECT_NEAR(ratios.at("classical").value, 1, 0.02 + 6 * ratios.at("classical").error);
    }
}
