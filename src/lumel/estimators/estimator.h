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
    Rgb64 plain;    ///< mean of samples that have no density, W/(m2 sr); outside every ratio
    Rgb64 var_f, cov_fg, var_plain;
    double var_g = 0;
    uint64_t hits = 0;  ///< samples that are not 0
};

struct Estimate {
    Rgb64 value;     ///< W/(m2 sr)
    Rgb64 variance;  ///< of the value, per channel
    bool valid = true;  ///< false: the area had no sample and the value is a stand-in
};

/// One way to turn samples into a radiance.
struct Estimator {
    std::string_view name;
    std::string_view summary;
    Estimate (*estimate)(const Samples&);
};

/// All estimators, by name.
std::span<const Estimator> estimators();
/// The estimator of that name, or nullptr.
const Estimator* find_estimator(std::string_view name);

}  // namespace lumel
