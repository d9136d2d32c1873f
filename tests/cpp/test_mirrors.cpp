// Perfect mirrors, alone and as parts of a material, and shading normals.
#include <gtest/gtest.h>

#include "runs.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// Both transports, with and without the first shot.
template <class Test>
void for_all(const Test& test) {
    for (Transport transport : kTransports)
        for (bool first_shot : {false, true})
            test(SolverConfig{.transport = transport, .first_shot = first_shot, .direct_samples = 16},
                 name_of(transport) + (first_shot ? ", first shot" : ""));
}

/// |mean - truth| within 2e-3 of the truth and k standard errors: 1e-3 for `tests` tests together.
void expect_near(const Mean& m, double truth, int tests, const std::string& what) {
    EXPECT_NEAR(m.value, truth, 2e-3 * truth + student_quantile(1e-3 / tests, m.count - 1) * m.error)
        << what << ", standard error " << m.error;
    EXPECT_LT(m.error, 0.01 * truth) << what;
}

/// Irradiance of the floor z = 0 at (x, y) by a rectangle at height z that looks down, by quadrature.
double irradiance_below(double radiance, double x, double y, double z, double x0, double x1, double y0, double y1) {
    constexpr int kN = 100;
    double sum = 0;
    for (int i = 0; i < kN; ++i)
        for (int j = 0; j < kN; ++j) {
            const double dx = x0 + (x1 - x0) * (i + 0.5) / kN - x, dy = y0 + (y1 - y0) * (j + 0.5) / kN - y, d2 = dx * dx + dy * dy + z * z;
            sum += radiance * z * z / (d2 * d2) * (x1 - x0) * (y1 - y0) / (kN * kN);
        }
    return sum;
}

/// Its mean over the floor [0, 1] x [0, 1].
template <class Irradiance>
double mean_over_floor(const Irradiance& irradiance, int n = 16) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += irradiance((i + 0.5) / n, (j + 0.5) / n) / (n * n);
    return sum;
}

}  // namespace

TEST(Mirrors, lamp_seen_over_a_mirror_lights_like_its_image) {
    // A lamp that looks up at a ceiling of mirror: the floor gets the light of the image alone, at height 2 * 2 - 0.5.
    constexpr float kTint = 0.8f;
    SceneBuilder b;
    const uint32_t black = b.material(matt(0)), ceiling = b.material(mirror(kTint));
    b.shape(black).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(ceiling).quad({-4, -4, 2}, {0, 9, 0}, {9, 0, 0});
    b.shape(black, grey(10)).quad({1.2f, 0.3f, 0.5f}, {0.4f, 0, 0}, {0, 0.4f, 0});
    const Stage stage(b.build(1000));
    const double truth = mean_over_floor(
        [](double x, double y) { return irradiance_below(10 * double{kTint}, x, y, 3.5, 1.2, 1.6, 0.3, 0.7); });
    for_all([&](const SolverConfig& solver, const std::string& what) {
        expect_near(mean_irradiance(stage, {.solver = solver, .replicas = 8, .rays = 100000}, {fronts_of_shape(0)})[0], truth, 4, what);
    });
}

TEST(Mirrors, point_lamp_and_its_image) {
    constexpr float kTint = 0.7f;
    SceneBuilder b;
    b.shape(b.material(matt(0))).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(b.material(mirror(kTint))).quad({-4, -4, 2}, {0, 9, 0}, {9, 0, 0});
    b.point_lamp({0.3f, 0.6f, 1.5f}, grey(3));
    const Stage stage(b.build(1000));
    const double truth = mean_over_floor([](double x, double y) {
        const double r2 = (x - 0.3) * (x - 0.3) + (y - 0.6) * (y - 0.6);
        return 3 * 1.5 / std::pow(r2 + 1.5 * 1.5, 1.5) + 3 * double{kTint} * 2.5 / std::pow(r2 + 2.5 * 2.5, 1.5);
    });
    for_all([&](const SolverConfig& solver, const std::string& what) {
        expect_near(mean_irradiance(stage, {.solver = solver, .replicas = 8, .rays = 100000}, {fronts_of_shape(0)})[0], truth, 4, what);
    });
}

TEST(Mirrors, partial_mirror_reflects_its_share_and_receives_all) {
    // The ceiling mirrors 0.5 and scatters 0.3 of what it gets; the floor sees the image of the lamp and the lit ceiling.
    SceneBuilder b;
    Material partial = matt(0.3f);
    partial.mirror = grey(0.5f);
    const uint32_t black = b.material(matt(0)), ceiling = b.material(partial);
    b.shape(black).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(ceiling).quad({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    b.point_lamp({0.5f, 0.5f, 0.5f}, grey(1));
    const Stage stage(b.build(1000));
    // The ceiling gets what the floor gets straight from the lamp; the image is seen through the window that the ceiling is.
    const auto direct = [](double x, double y) { return 0.5 / std::pow((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + 0.25, 1.5); };
    const double ceiling_truth = mean_over_floor(direct, 64);
    const double image = mean_over_floor(
        [](double x, double y) { return 0.5 * 1.5 / std::pow((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + 2.25, 1.5); }, 64);
    constexpr int kN = 16;
    double scattered = 0;
    for (int i = 0; i < kN; ++i)
        for (int j = 0; j < kN; ++j) {
            const double x = (i + 0.5) / kN, y = (j + 0.5) / kN;
            scattered += mean_over_floor(
                             [&](double u, double v) {
                                 return 0.3 * direct(u, v) / std::pow((u - x) * (u - x) + (v - y) * (v - y) + 1, 2);
                             },
                             kN) /
                         double{kPi} / (kN * kN);
        }
    for_all([&](const SolverConfig& solver, const std::string& what) {
        const auto means = mean_irradiance(stage, {.solver = solver, .replicas = 8, .rays = 200000},
                                           {fronts_of_shape(0), fronts_of_shape(1)});
        expect_near(means[0], ceiling_truth + image + scattered, 8, what + ", floor");
        expect_near(means[1], ceiling_truth, 8, what + ", ceiling");
    });
}

TEST(Mirrors, room_with_a_mirror_wall_is_half_of_a_room_twice_as_long) {
    const auto make = [](bool unfolded) {
        SceneBuilder b;
        const uint32_t wall = b.material(matt(0.6f)), side = b.material(matt(0.3f));
        const float length = unfolded ? 2 : 1;
        const Vec3 upper{length, 1, 1};
        b.shape(wall);
        for (int face : {2, 3, 4, 5}) b.face(face, {0, 0, 0}, upper, true);
        b.shape(side).face(0, {0, 0, 0}, upper, true);
        b.shape(unfolded ? side : b.material(mirror(1))).face(1, {0, 0, 0}, upper, true);
        b.shape(wall, grey(10)).quad({0.5f, 0.3f, 0.8f}, {0, 0.3f, 0}, {0.3f, 0, 0});
        if (unfolded) b.shape(wall, grey(10)).quad({1.2f, 0.3f, 0.8f}, {0, 0.3f, 0}, {0.3f, 0, 0});
        return b.build(unfolded ? 4000 : 2000);
    };
    const Stage folded(make(false)), unfolded(make(true));
    // Near and far half of the long walls, the wall opposite of the mirror, the lamp itself.
    const auto part = [](float from, float to) {
        return [=](const Scene& scene, uint32_t s) {
            const float x = scene.position(scene.centre_of_patch(scene.patch_of_side(s))).x;
            return !scene.is_back(s) && scene.shape(scene.triangle_of_side(s)) == 0 && x >= from && x < to;
        };
    };
    const std::vector<SideFilter> filters{part(0, 1), fronts_of_shape(1), fronts_of_shape(3)};
    const auto reference = mean_irradiance(unfolded, {.solver = {.first_shot = false, .seed = 50}, .replicas = 8, .rays = 200000}, filters);
    for_all([&](const SolverConfig& solver, const std::string& what) {
        const auto means = mean_irradiance(folded, {.solver = solver, .replicas = 8, .rays = 100000}, filters);
        for (size_t i = 0; i < means.size(); ++i) {
            const double error = std::hypot(means[i].error, reference[i].error);
            EXPECT_NEAR(means[i].value, reference[i].value, 5e-3 * reference[i].value + student_quantile(1e-3 / 12, 7) * error)
                << what << ", part " << i;
            EXPECT_LT(error, 0.015 * reference[i].value) << what << ", part " << i;
        }
    });
}

TEST(Mirrors, closed_hall_of_partial_mirrors_keeps_the_energy) {
    // Every surface mirrors 0.4 and scatters 0.3: all that arrives counts as irradiance, so the mean is Phi / (S (1 - 0.7)).
    SceneBuilder b;
    Material partial = matt(0.3f);
    partial.mirror = grey(0.4f);
    const uint32_t m = b.material(partial);
    b.shape(m).box({0, 0, 0}, {1, 1, 1}, true).point_lamp(grey(0.4f), grey(1));
    const Stage stage(b.build(1000));
    for_all([&](const SolverConfig& solver, const std::string& what) {
        const Mean mean = mean_irradiance(stage, {.solver = solver, .replicas = 8, .rays = 100000}, {fronts()})[0];
        expect_near(mean, 4 * double{kPi} / (6 * 0.3), 4, what);
    });
}

TEST(ShadingNormals, coarse_smooth_ball_acts_like_a_fine_faceted_one) {
    // A white ball hangs beside a lamp in a dim room; what it gets, and what the wall behind it gets from it, must agree.
    const auto make = [](int level, bool smooth) {
        SceneBuilder b;
        const uint32_t wall = b.material(matt(0.2f)), ball = b.material(matt(0.9f));
        b.shape(wall).box({0, 0, 0}, {1, 1, 1}, true).shape(ball).sphere({0.4f, 0.5f, 0.4f}, 0.25f, level, false, smooth);
        b.shape(wall, grey(10)).quad({0.7f, 0.4f, 0.9f}, {0, 0.2f, 0}, {0.2f, 0, 0});
        return b.build(3000);
    };
    const Stage smooth(make(2, true)), fine(make(5, false));
    const std::vector<SideFilter> filters{fronts_of_shape(0), fronts_of_shape(1)};
    const auto reference = mean_irradiance(fine, {.solver = {.first_shot = false, .seed = 51}, .replicas = 8, .rays = 200000}, filters);
    for_all([&](const SolverConfig& solver, const std::string& what) {
        const auto means = mean_irradiance(smooth, {.solver = solver, .replicas = 8, .rays = 200000}, filters);
        for (size_t i = 0; i < means.size(); ++i) {
            // The 320 triangles are inscribed, their ball is 1 % smaller: that much is granted.
            const double error = std::hypot(means[i].error, reference[i].error);
            EXPECT_NEAR(means[i].value, reference[i].value, 0.01 * reference[i].value + student_quantile(1e-3 / 8, 7) * error)
                << what << ", part " << i;
            EXPECT_LT(error, 0.01 * reference[i].value) << what << ", part " << i;
        }
    });
}
