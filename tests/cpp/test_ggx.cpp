// The BRDF: reciprocity, albedo, sampling, Fresnel, and the vectors that pin it down.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "lumel/sampling/warp.h"
#include "lumel/scene/material.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr std::array kAlphas{0.02f, 0.1f, 0.3f, 0.6f, 1.0f};
constexpr std::array kCosines{1.0f, 0.8f, 0.4f, 0.1f};

Vec3 at_cosine(float cos) { return {std::sqrt(1 - cos * cos) * 0.6f, std::sqrt(1 - cos * cos) * 0.8f, cos}; }

Material conductor(Rgb eta, Rgb k) {
    Material m;
    m.specular = {1, 1, 1}, m.fresnel = {true, eta, k};
    return m;
}

/// Integral of the lobe over the upper hemisphere, by the midpoint rule in cells that are small around the mirror direction and the
/// horizon.
double albedo_by_quadrature(float alpha, float cos) {
    constexpr int kN = 1500;
    // tan(theta_h) = alpha u/(1-u) resolves the peak for every alpha.
    const Vec3 wo = at_cosine(cos);
    double sum = 0;
    for (int i = 0; i < kN; ++i) {
        const double u = (i + 0.5) / kN, tan = alpha * u / (1 - u), theta = std::atan(tan);
        const double dtheta = alpha / ((1 - u) * (1 - u)) / (1 + tan * tan) / kN;
        for (int j = 0; j < kN / 4; ++j) {
            const double phi = 2 * double{kPi} * (j + 0.5) / (kN / 4);
            const Vec3 h{static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::sin(theta) * std::sin(phi)),
                         static_cast<float>(std::cos(theta))};
            const float wo_h = dot(wo, h);
            if (!(wo_h > 0)) continue;
            const Vec3 wi = reflect(wo, h);
            sum += double{ggx::eval(wi, wo, alpha).f_cos} * 4 * double{wo_h} * std::sin(theta) * dtheta * 2 * double{kPi} / (kN / 4);
        }
    }
    return sum;
}

std::filesystem::path vectors() {
    if (const char* shared = std::getenv("LUMEL_SHARED")) return std::filesystem::path(shared) / "vectors";
    return std::filesystem::path(__FILE__).parent_path() / "../../../shared/vectors";
}

/// Rows of a comma separated file without its header.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<std::vector<double>> rows;
    std::string line, cell;
    for (std::getline(file, line); std::getline(file, line);) {
        auto& row = rows.emplace_back();
        for (std::istringstream cells(line); std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    }
    return rows;
}

}  // namespace

TEST(Ggx, is_reciprocal) {
    Rng rng(1);
    for (int i = 0; i < 20000; ++i) {
        const float alpha = kAlphas[static_cast<size_t>(i) % kAlphas.size()];
        const Vec3 a = square_to_cosine_hemisphere(square(rng)), b = square_to_cosine_hemisphere(square(rng));
        if (std::min(a.z, b.z) < 1e-3f) continue;
        const double ab = ggx::eval(a, b, alpha).f_cos / a.z, ba = ggx::eval(b, a, alpha).f_cos / b.z;
        ASSERT_NEAR(ab, ba, 1e-5 * std::abs(ab));
    }
    EXPECT_EQ(ggx::eval({0, 0, -1}, {0, 0, 1}, 0.5f).f_cos, 0);
    EXPECT_EQ(ggx::eval({0, 0, 1}, {1, 0, 0}, 0.5f).f_cos, 0);
}

TEST(Ggx, sampling_has_its_density_below_the_horizon_too) {
    uint64_t seed = 100;
    for (float alpha : kAlphas)
        for (float cos : kCosines) {
            const Vec3 w = at_cosine(cos);
            const auto draw = [&](Rng& rng) {
                const Vec3 wi = ggx::sample(w, alpha, square(rng));
                EXPECT_NEAR(length(wi), 1, 1e-4);
                return wi.z > 0 ? wi : Vec3{};
            };
            const auto pdf = [&](Vec3 wi) { return double{ggx::pdf_w(w, wi, alpha)}; };
            EXPECT_GT(chi_square_directions(draw, pdf, reflect(w, {0, 0, 1}), 100000, ++seed), 1e-4)
                << "alpha " << alpha << ", cosine " << cos;
        }
    // The test itself is tested: a lobe 3 % rougher is found out.
    const Vec3 w = at_cosine(0.8f);
    const auto draw = [&](Rng& rng) {
        const Vec3 wi = ggx::sample(w, 0.309f, square(rng));
        return wi.z > 0 ? wi : Vec3{};
    };
    EXPECT_LT(
        chi_square_directions(draw, [&](Vec3 wi) { return double{ggx::pdf_w(w, wi, 0.3f)}; }, reflect(w, {0, 0, 1}), 100000, 5), 1e-4);
}

TEST(Ggx, lobe_over_density_is_masking_of_the_other_direction) {
    Rng rng(2);
    for (int i = 0; i < 5000; ++i) {
        const float alpha = kAlphas[static_cast<size_t>(i) % kAlphas.size()];
        const Vec3 wo = square_to_cosine_hemisphere(square(rng)), wi = ggx::sample(wo, alpha, square(rng));
        if (wi.z < 1e-3f || wo.z < 1e-3f) continue;
        EXPECT_NEAR(ggx::eval(wi, wo, alpha).f_cos / ggx::pdf_w(wo, wi, alpha), ggx::G1(wi.z, alpha), 1e-4);
    }
}

TEST(Ggx, albedo_table_is_the_integral_of_the_lobe) {
    for (float alpha : kAlphas) {
        Material m = glossy({}, {1, 1, 1}, alpha);
        m.tabulate();
        for (float cos : {1.0f, 0.9f, 0.7f, 0.5f, 0.25f, 0.1f, 0.03f}) {
            const double truth = albedo_by_quadrature(alpha, cos);
            EXPECT_NEAR(m.albedo_s(cos).x, truth, 2e-3) << "alpha " << alpha << ", cosine " << cos;
            EXPECT_LE(m.albedo_s(cos).x, 1.0f);
        }
        EXPECT_LE(m.max_albedo(), 1.0f);
    }
    Material rough = glossy({}, {1, 1, 1}, 1);
    rough.tabulate();
    EXPECT_NEAR(rough.albedo_s(1).y, 1 - std::log(2.0), 2e-4);
    EXPECT_NEAR(albedo_by_quadrature(1, 1), 1 - std::log(2.0), 1e-4);
}

TEST(Ggx, albedo_adds_up_over_parts_and_tints) {
    Material m = glossy({0.5f, 0.2f, 0.1f}, {0.5f, 0.4f, 0.1f}, 0.2f);
    m.tabulate();
    EXPECT_NEAR(m.albedo_s(0.6f).y / m.albedo_s(0.6f).x, 0.8, 1e-5);
    EXPECT_NEAR(m.max_albedo(), 0.5f + m.albedo_s(1).x, 1e-5) << "a lobe of this roughness is most reflecting head on";
    Material too_bright = glossy(grey(0.8f), grey(0.8f), 0.2f);
    too_bright.tabulate();
    EXPECT_GT(too_bright.max_albedo(), 1.5f);
}

TEST(Ggx, agrees_with_the_shared_vectors) {
    const auto rows = read_rows(vectors() / "ggx_eval.csv"), albedos = read_rows(vectors() / "ggx_albedo.csv");
    if (rows.empty() || albedos.empty()) GTEST_SKIP() << "set LUMEL_SHARED to the shared folder: no vectors in " << vectors();
    for (const auto& r : rows) {
        const auto f = [&](int i) { return static_cast<float>(r[static_cast<size_t>(i)]); };
        const Vec3 wi{f(1), f(2), f(3)}, wo{f(4), f(5), f(6)};
        // Near the peak of a sharp lobe the value follows the rounding of the given directions: to first order, by its slope.
        const double value = ggx::eval(wi, wo, f(0)).f_cos;
        const double slope = std::abs(double{ggx::eval(normalize(wi + Vec3{1e-5f, 0, 0}), wo, f(0)).f_cos} - value) +
                             std::abs(double{ggx::eval(normalize(wi + Vec3{0, 1e-5f, 0}), wo, f(0)).f_cos} - value);
        EXPECT_NEAR(value, r[7], 1e-4 * r[7] + 0.1 * slope + 1e-7);
    }
    for (const auto& r : albedos) {
        Material m = glossy({}, {1, 1, 1}, static_cast<float>(r[0]));
        m.tabulate();
        EXPECT_NEAR(m.albedo_s(static_cast<float>(r[1])).x, r[2], 1e-3 + 4 * r[3]) << "alpha " << r[0] << ", cosine " << r[1];
    }
}

TEST(Fresnel, has_its_limits) {
    EXPECT_EQ(Fresnel{}(0.3f), (Rgb{1, 1, 1}));
    // Glass at normal incidence: ((n-1)/(n+1))^2; at Brewster's angle only half of one polarisation is left.
    const Fresnel glass{true, grey(1.5f), {}};
    EXPECT_NEAR(glass(1).x, 0.04, 1e-6);
    const double brewster = std::atan(1.5), refracted = std::asin(std::sin(brewster) / 1.5);
    const double rs = std::sin(refracted - brewster) / std::sin(refracted + brewster);
    EXPECT_NEAR(glass(static_cast<float>(std::cos(brewster))).x, 0.5 * rs * rs, 1e-5);
    EXPECT_NEAR(glass(0).x, 1, 1e-3);
    // A metal at normal incidence: ((n-1)^2 + k^2) / ((n+1)^2 + k^2).
    const Fresnel metal{true, {0.2f, 0.9f, 1.5f}, {3.9f, 2.5f, 1.9f}};
    for (int c = 0; c < 3; ++c) {
        const double n = metal.eta[c], k = metal.k[c];
        EXPECT_NEAR(metal(1)[c], ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), 1e-5);
        EXPECT_NEAR(metal(0)[c], 1, 2e-3);
    }
}

TEST(Fresnel, lowers_the_specular_albedo) {
    Material m = conductor({0.2f, 0.9f, 1.5f}, {3.9f, 2.5f, 1.9f});
    m.alpha = 0.01f;
    m.tabulate();
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.albedo_s(0.8f)[c], m.fresnel(0.8f)[c], 2e-3);
    Rng rng(9);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 a = square_to_cosine_hemisphere(square(rng)), b = square_to_cosine_hemisphere(square(rng));
        if (std::min(a.z, b.z) < 1e-3f) continue;
        m.alpha = 0.3f;
        const Rgb ab = m.scatter_s(a, b) / a.z, ba = m.scatter_s(b, a) / b.z;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(ab[c], ba[c], 2e-5f * ab[c]);
    }
}
