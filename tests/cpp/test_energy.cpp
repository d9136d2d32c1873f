// Diffuse answers in closed form: energy, the sphere, the cube, the room of CIE 171.
#include <gtest/gtest.h>

#include <map>

#include "runs.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// |mean - truth| within `relative` and the standard errors that a family of `tests` tests keeps at a significance of 1e-3.
void expect_near(const Mean& m, double truth, double relative, int tests, const std::string& what) {
    const double k = student_quantile(1e-3 / tests, m.count - 1);
    EXPECT_NEAR(m.value, truth, relative * truth + k * m.error) << what << ": standard error " << m.error << ", k = " << k;
}

/// Relative deviations from the truth, pooled with the weights of their errors: many noisy runs make one sharp test.
class Pool {
public:
    void add(const Mean& m, double truth) {
        const double weight = sqr64(truth / m.error);
        sum_ += weight * (m.value / truth - 1), weight_ += weight;
    }
    /// `k` = 4.5 standard errors: they are estimates themselves, so this is about 1e-3.
    void expect_none(double relative) const {
        const double error = 1 / std::sqrt(weight_);
        EXPECT_NEAR(sum_ / weight_, 0, relative + 4.5 * error);
        EXPECT_LT(error, relative) << "too few samples to tell";
    }

private:
    static double sqr64(double x) { return x * x; }
    double sum_ = 0, weight_ = 0;
};

/// A room with a one-sided lamp in the middle, whose back is lit by the room, all of one material.
SceneBuilder room_with_lamp(const Material& material) {
    SceneBuilder b;
    const uint32_t m = b.material(material);
    b.shape(m).box({0, 0, 0}, {1, 1, 1}, true).shape(m, grey(30)).quad({0.4f, 0.45f, 0.55f}, {0, 0.15f, 0}, {0.15f, 0, 0});
    return b;
}

/// What a surface absorbs of light that arrives, lum.
double absorbed_of(Rgb flux, const Surface& x, Vec3 wi) {
    return lum(flux * (Rgb{1, 1, 1} - x.material->diffuse - x.material->albedo_s(dot(x.shading, wi))));
}

}  // namespace

TEST(Energy, mean_irradiance_of_closed_scenes) {
    // A lobe this sharp reflects 1 - 2e-4 of what diffuse light brings, so its tint is its albedo.
    constexpr float kSharp = 0.005f;
    constexpr int kTests = 5 * 2 * 2 * 2;
    std::map<std::pair<Transport, bool>, Pool> pools;
    for (float rho : {0.05f, 0.3f, 0.6f, 0.8f, 0.95f})
        for (bool half_glossy : {false, true}) {
            const Stage stage(room_with_lamp(half_glossy ? glossy(grey(0.5f * rho), grey(0.5f * rho), kSharp) : matt(rho)).build(600));
            ASSERT_FALSE(stage.defensive.open());
            const double truth = lamp_power(stage.scene) / (stage.defensive.by_area.total() * (1 - double{rho}));
            for (Transport transport : kTransports)
                for (bool first_shot : {false, true}) {
                    const RunConfig config{
                        .solver = {.transport = transport, .defensive = 0.1f, .first_shot = first_shot, .direct_samples = 32, .seed = 1},
                        .replicas = 8,
                        .rays = 40000,
                        .solve_rays = 100000};
                    const Mean m = mean_irradiance(stage, config, {reachable(stage)})[0];
                    const std::string what = name_of(transport) + (first_shot ? ", first shot" : "") +
                                             (half_glossy ? ", half glossy" : "") + ", rho " + std::to_string(rho);
                    EXPECT_LT(m.error, 5e-3 * truth) << what;
                    expect_near(m, truth, 1e-3, kTests, what);
                    pools[{transport, first_shot}].add(m, truth);
                }
        }
    for (const auto& [what, pool] : pools) pool.expect_none(1e-3);
}

TEST(Energy, what_surfaces_absorb_is_what_lamps_emit) {
    // Any roughness and angle: the sum over all transfers of their flux times 1 - a_d - a_s(wi) is the power of the lamps.
    const Stage stage(room_with_lamp(glossy(grey(0.3f), grey(0.6f), 0.4f)).build(600));
    const Scene& scene = stage.scene;
    for (uint32_t triangle = 0; triangle < scene.triangles(); ++triangle) ASSERT_FALSE(scene.is_plain(triangle));
    for (Transport transport : kTransports) {
        std::vector<double> values;
        for (uint64_t replica = 0; replica < 8; ++replica) {
            const Illumination light(stage.accel, stage.defensive, {.first_shot = false, .stream = replica});
            double absorbed = 0;
            size_t bundles = 0;
            const Sink sink = [&](const Generation& generation) {
                for (uint32_t side = 0; side < scene.sides(); ++side)
                    for (const Transfer& t : generation.transfers.placed(side))
                        absorbed += absorbed_of(t.flux, {scene, {scene.triangle_of_side(side), t.u, t.v}, scene.is_back(side)}, t.wi);
                for (const Bundle& bundle : generation.bundles)
                    for (uint32_t side = 0; side < scene.sides(); ++side) {
                        const Surface x(scene, scene.centre_of_patch(scene.patch_of_side(side)), scene.is_back(side));
                        const Rgb flux = bundle.irradiance[side] * (scene.side_area(side) / Bundle::kPdf_w);
                        absorbed += absorbed_of(flux, x, bundle.incoming(x.normal));
                    }
                bundles += generation.bundles.size();
            };
            run_replica(stage, transport, light, {60000, 0.2f, replica}, sink);
            values.push_back(bundles > 0 ? absorbed / static_cast<double>(bundles) : absorbed);
        }
        const Mean m = mean_of(values);
        EXPECT_LT(m.error, 5e-3 * lamp_power(scene));
        expect_near(m, lamp_power(scene), 1e-3, 3, name_of(transport));
    }
}

TEST(Energy, what_leaves_an_open_scene_is_counted) {
    // A black floor under a lamp: what it does not receive is lost.
    SceneBuilder b;
    const uint32_t black = b.material(matt(0));
    b.shape(black).quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}).shape(black, grey(1)).quad({-0.5f, -0.5f, 1}, {0, 1, 0}, {1, 0, 0});
    const Stage stage(b.build(100));
    ASSERT_TRUE(stage.defensive.open());
    const RunConfig config{.solver = {.defensive = 0.2f, .first_shot = false}, .replicas = 1, .rays = 100000};
    const Solver solver = solved(stage, config, no_areas(stage.scene));
    const double floor = mean_over(stage.scene, total_irradiance(solver, stage.scene), fronts_of_shape(0)) * 4;
    EXPECT_NEAR((floor + solver.stats().lost_flux / static_cast<double>(config.rays)) / lamp_power(stage.scene), 1, 0.01);
    EXPECT_GT(solver.stats().escaped, 0u);
}

TEST(Sphere, any_emission_and_albedo) {
    // B = E + rho H with H = mean(E)/(1 - mean(rho)), the same irradiance everywhere. 20 regions around the corners of nowhere special.
    SceneBuilder b;
    std::vector<Vec3> regions;
    Rng rng(17);
    double mean_e = 0, mean_rho = 0;
    std::vector<double> exitance, albedo;
    for (int i = 0; i < 20; ++i) {
        regions.push_back(square_to_sphere(square(rng)));
        exitance.push_back(i % 3 == 0 ? 10 * double{rng.uniform()} : 0), albedo.push_back(0.9 * double{rng.uniform()});
        b.shape(b.material(matt(static_cast<float>(albedo.back()))), grey(static_cast<float>(exitance.back() / double{kPi})));
    }
    b.sphere_by_shape({1, 2, 3}, 2, 4, [&](Vec3 x) {
        uint32_t nearest = 0;
        for (uint32_t i = 1; i < 20; ++i)
            if (dot(x - Vec3{1, 2, 3}, regions[i] - regions[nearest]) > 0) nearest = i;
        return nearest;
    });
    const Stage stage(b.build(5120));
    std::vector<SideFilter> filters{fronts()};
    for (uint32_t i = 0; i < 20; ++i) filters.push_back(fronts_of_shape(i));
    for (uint32_t t = 0; t < stage.scene.triangles(); ++t) {
        const double share = stage.scene.triangle_area(t) / stage.scene.total_area();
        mean_e += share * exitance[stage.scene.shape(t)], mean_rho += share * albedo[stage.scene.shape(t)];
    }
    const double truth = mean_e / (1 - mean_rho);
    for (Transport transport : kTransports)
        for (bool first_shot : {false, true}) {
            const RunConfig config{.solver = {.transport = transport, .first_shot = first_shot, .seed = 2}, .replicas = 8, .rays = 200000};
            const auto means = mean_irradiance(stage, config, filters);
            // 5120 flat triangles are not quite a sphere: neighbours see less of each other, by about 0.1 %.
            for (size_t i = 0; i < means.size(); ++i)
                expect_near(means[i], truth, 2e-3, 4 * 21, name_of(transport) + ", region " + std::to_string(i));
        }
}

TEST(Cube, continuous_radiosities) {
    // E = 1 on one face; the means of the faces of the continuous solution, not those of one element a face.
    constexpr std::array kAlbedo{0.5f, 0.7f, 0.6f, 0.3f, 0.5f, 0.8f};
    constexpr std::array kRadiosity{1.1327, 0.2684, 0.2477, 0.1285, 0.2075, 0.3194};
    SceneBuilder b;
    std::vector<SideFilter> filters;
    for (int i = 0; i < 6; ++i) {
        b.shape(b.material(matt(kAlbedo[static_cast<size_t>(i)])), grey(i == 0 ? kInvPi : 0)).face(i, {0, 0, 0}, {1, 1, 1}, true);
        filters.push_back(fronts_of_shape(static_cast<uint32_t>(i)));
    }
    double squares = 0;
    for (uint64_t patches : {1500u, 6000u}) {
        const Stage stage(b.build(patches));
        for (Transport transport : kTransports)
            for (bool first_shot : {false, true}) {
                const RunConfig config{.solver = {.transport = transport, .first_shot = first_shot, .direct_samples = 32, .seed = 3},
                                       .replicas = 8,
                                       .rays = 200000};
                const auto means = mean_irradiance(stage, config, filters);
                for (size_t i = 0; i < 6; ++i) {
                    const double radiosity = (i == 0 ? 1 : 0) + double{kAlbedo[i]} * means[i].value,
                                 error = double{kAlbedo[i]} * means[i].error;
                    EXPECT_NEAR(radiosity, kRadiosity[i], 2e-4 + student_quantile(1e-3 / 48, 7) * error)
                        << name_of(transport) << ", face " << i;
                    squares += error * error;
                }
            }
    }
    EXPECT_LT(std::sqrt(squares / 48), 2e-4);  // the errors that the tolerances above are made of are small, too
}

TEST(Cie171, room_with_a_lamp_in_its_centre) {
    // 5.8: 4 m cube, 10,000 lm, isotropic. Lumens stand for watts.
    Pool pool;
    for (const auto& [rho, truth] :
         {std::pair{0.0f, 104.17}, {0.2f, 130.21}, {0.5f, 208.33}, {0.8f, 520.83}, {0.9f, 1041.67}, {0.95f, 2083.33}}) {
        SceneBuilder b;
        b.shape(b.material(matt(rho))).box({0, 0, 0}, grey(4), true).point_lamp(grey(2), grey(10000 / (4 * kPi)));
        const Stage stage(b.build(3000));
        for (Transport transport : kTransports)
            for (bool first_shot : {false, true}) {
                const RunConfig config{.solver = {.transport = transport, .first_shot = first_shot, .seed = 4},
                                       .replicas = 8,
                                       .rays = 50000,
                                       .solve_rays = 150000};
                const Mean m = mean_irradiance(stage, config, {fronts()})[0];
                expect_near(m, truth, 1e-3, 24, name_of(transport) + ", rho " + std::to_string(rho));
                EXPECT_LT(m.error, 5e-3 * truth);
                pool.add(m, truth);
            }
    }
    pool.expect_none(1e-3);
}
