// From samples to a radiance with its variance. Estimators know nothing of light: only f/p and g/p.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "lumel/math/vec.h"

namespace lumel {

/// Means of f/p and g/p of one area of interest, with the covariances of these means (from independent replicas).
struct Samples {
    Rgb64 f;        ///< F = mean(f/p), W/(m2 sr)
    double g = 0;   ///< G = mean(g/p), 1 in the limit where p covers g
    Rgb64 plain{};  ///< mean of samples that have no density, W/(m2 sr); outside every ratio
    Rgb64 var_f{}, cov_fg{}, var_plain{};
    double var_g = 0;
    Rgb64 fg{};         ///< sum over samples of the product of what each adds to F and to G,
    double gg = 0;      ///< and of the square of what it adds to G: moments of single samples, to find coefficients with
    uint64_t hits = 0;  ///< samples that are not 0
    double size = 1;    ///< of the areas that were pooled, in one unit for an area and those around it
    uint32_t replicas = 0;  ///< that the means and their covariances are made of
    double looks = 0, looks_dark = 0;  ///< looks along the lobe, and those of them from points that no light can reach,
    double looks_uncovered = 0;        ///< those of the others that no transfer could have come along, and
    double looks_size = 0;             ///< the sum over the rest of what a transfer along them would have added to G

    /// Number of hits of equal size that would tell as much, (sum g)^2 / sum g^2.
    double effective_hits() const { return gg > 0 ? g * g / gg : 0; }
    /// Share of the target density that p does not cover, as far as looks tell, 0..1; of the part that light can reach.
    double uncovered() const { return looks > looks_dark ? looks_uncovered / (looks - looks_dark) : 0; }
    /// Share of the target density at points that no light can reach, 0..1.
    double dark() const { return looks > 0 ? looks_dark / looks : 0; }
    /// Variance that G has if p covers g, as far as looks tell: the integral of g^2/(n p) is the mean of g/(n p) over directions by g.
    double var_g_of_looks() const { return looks > looks_uncovered ? looks_size / (looks - looks_uncovered) : 0; }
};

struct Estimate {
    Rgb64 value;     ///< W/(m2 sr)
    Rgb64 variance;  ///< of the value, per channel
    bool valid = true;  ///< false: the area had no sample and the value is a stand-in
};

/// One way to turn samples into a radiance. `around` are the pooled samples of the areas around this one, itself left out.
struct Estimator {
    std::string_view name;
    std::string_view summary;
    Estimate (*rule)(const Samples& own, const Samples& around);
    Estimate (*rule_to_average)(const Samples& own, const Samples& around);  ///< for areas whose estimates are averaged again

    Estimate estimate(const Samples& own, const Samples& around) const { return rule(own, around); }
    Estimate estimate_to_average(const Samples& own, const Samples& around) const { return rule_to_average(own, around); }
    /// For an area that has no neighbours.
    Estimate estimate(const Samples& own) const { return rule(own, {}); }
};

/// Variance of F - b (G - 1) to first order, with b as a constant.
constexpr Rgb64 control_variance(const Samples& s, Rgb64 b) {
    const Rgb64 v = s.var_f - b * s.cov_fg * 2.0 + b * b * s.var_g;
    return {v.x > 0 ? v.x : 0, v.y > 0 ? v.y : 0, v.z > 0 ? v.z : 0};
}

/// All estimators, by name.
std::span<const Estimator> estimators();
/// The estimator of that name, or nullptr.
const Estimator* find_estimator(std::string_view name);

}  // namespace lumel
