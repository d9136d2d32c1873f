// A glossy patch in a sphere of known light: every estimator of every transport must find what the lobe sees.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "runs.h"

namespace lumel::test {

/// A small glossy patch in the middle of a sphere that is lit by bands of exitance, W/m2, across an axis; of one albedo.
struct PatchInSphere {
    static constexpr float kSize = 0.2f;
    float rho;
    Vec3 eye = normalize({-0.5f, 0.1f, 0.8f}) * 0.5f;
    double mean_exitance = 0;
    Stage stage;

    PatchInSphere(float albedo, float alpha, const std::function<float(float)>& exitance)
        : rho(albedo), stage(make(albedo, alpha, exitance)) {
        double area = 0;
        for (uint32_t t = 0; t < stage.scene.triangles(); ++t) {
            if (stage.scene.material(t).is_glossy()) continue;
            mean_exitance += double{stage.scene.emission(t).x} * double{kPi} * double{stage.scene.triangle_area(t)};
            area += double{stage.scene.triangle_area(t)};
        }
        mean_exitance /= area;
    }
    static Scene make(float albedo, float alpha, const std::function<float(float)>& exitance) {
        SceneBuilder b;
        const uint32_t wall = b.material(matt(albedo)), gloss = b.material(glossy({}, {0.9f, 0.6f, 0.3f}, alpha));
        for (int i = 0; i < 40; ++i) b.shape(wall, grey(exitance(-0.975f + 0.05f * static_cast<float>(i)) * kInvPi));
        b.sphere_by_shape({}, 1, 3, [](Vec3 x) { return static_cast<uint32_t>(std::clamp((light_axis(x) + 1) * 20, 0.0f, 39.0f)); });
        b.shape(gloss).quad({-kSize / 2, -kSize / 2, 0}, {kSize, 0, 0}, {0, kSize, 0});
        return b.build(1);
    }
    /// -1..1 along the axis of the bands.
    static float light_axis(Vec3 x) { return dot(normalize(x), Vec3{0.8f, 0, 0.6f}); }

    PatchAreas areas() const { return PatchAreas(stage.scene, {eye}, glossy_sides_towards(stage.scene, eye, fronts())); }
    /// Radiance that the sphere sends everywhere: B / pi, without the emission if `reflected`.
    double radiance_from(uint32_t triangle, bool reflected) const {
        const double h = mean_exitance / (1 - double{rho});
        return double{rho} * h / double{kPi} + (reflected ? 0 : double{stage.scene.emission(triangle).x});
    }
    /// Specular radiance towards the eye from an area, by quadrature over the lobe and the patch.
    Rgb64 truth(uint32_t side, bool reflected) const {
        constexpr uint32_t kDraws = 1 << 15;
        const Scene& scene = stage.scene;
        Rgb64 sum;
        for (uint32_t i = 0; i < kDraws; ++i) {
            const Surface x(scene, scene.point_on_patch(scene.patch_of_side(side), square_to_triangle(sobol2d(i, 1))), scene.is_back(side));
            const Frame frame(x.shading);
            const Vec3 wo = frame.to_local(normalize(eye - x.x)), wi = ggx::sample(wo, x.material->alpha, sobol2d(i, 2));
            if (!(wi.z > 0)) continue;
            const Hit hit = stage.accel.intersect({x.off(scene.epsilon()), frame.to_world(wi)});
            sum += to_double(x.material->specular * ggx::G1(wi.z, x.material->alpha)) * (radiance_from(hit.triangle, reflected) / kDraws);
        }
        return sum;
    }
};

struct LobeRun {
    SolverConfig solver;
    uint64_t rays = 80000;
    uint32_t replicas = 10;
};

/// Mean over the areas of estimate / truth by the name of the estimator, with its error over replicas.
inline std::map<std::string, Mean> ratios_to_truth(const PatchInSphere& p, const LobeRun& run) {
    const PatchAreas areas = p.areas();
    std::vector<double> truths;
    for (uint32_t side : areas.sides()) truths.push_back(lum(p.truth(side, run.solver.first_shot)));
    std::map<std::string, std::vector<double>> values;
    for (uint32_t i = 0; i < run.replicas; ++i) {
        RunConfig one{.solver = run.solver, .replicas = 1, .rays = run.rays};
        one.solver.seed = key(run.solver.seed, i);
        const Solver solver = solved(p.stage, one, areas);
        for (const Estimator& estimator : estimators()) {
            double ratio = 0;
            for (uint32_t area = 0; area < areas.size(); ++area)
                ratio += lum(estimator.estimate(solver.areas().samples(0, area)).value) / truths[area] / areas.size();
            values[std::string(estimator.name)].push_back(ratio);
        }
    }
    std::map<std::string, Mean> means;
    for (const auto& [name, v] : values) means[name] = mean_of(v);
    return means;
}

/// Within 2 % and the standard errors kept by `tests` tests together at 1e-3.
inline void expect_truth(const std::map<std::string, Mean>& ratios, int tests, const std::string& what) {
    for (const auto& [name, ratio] : ratios) {
        const double k = student_quantile(1e-3 / tests, ratio.count - 1);
        EXPECT_NEAR(ratio.value, 1, 0.02 + k * ratio.error) << name << ", " << what << ": standard error " << ratio.error;
    }
}

/// Exitances along the axis, W/m2.
inline float even(float) { return 1; }
inline float ramp(float c) { return 1 + c + 2 * std::max(0.0f, c - 0.5f); }
inline float spot(float c) { return c > 0.9f ? 1.0f : 0.0f; }

}  // namespace lumel::test
