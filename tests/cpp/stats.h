// Statistics for tests: tails of distributions, chi-square of directions, means over replicas.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "lumel/math/frame.h"
#include "lumel/sampling/hash.h"
#include "lumel/sampling/sobol.h"

namespace lumel::test {

/// P(X > x) of a chi-square variable, by the series or the continued fraction of the incomplete gamma function.
double chi_square_tail(double x, int degrees);

/// P(|T| > t) of Student's t with the given degrees of freedom.
double student_two_sided(double t, int degrees);

/// The t with P(|T| > t) = `significance`.
double student_quantile(double significance, int degrees);

/// Mean of independent values and the standard error of that mean.
struct Mean {
    double value = 0, error = 0;
    int count = 0;

    /// How many of its errors it lies away from `truth`, as a p-value.
    double p_value(double truth) const { return student_two_sided(std::abs(value - truth) / error, count - 1); }
};
Mean mean_of(std::span<const double> values);

/// Are all hypotheses kept by Holm's procedure at the family-wise `significance`?
bool holm_keeps_all(std::vector<double> p_values, double significance);

/// Counts against expectations; cells that expect fewer than 5 are pooled. Returns the p-value.
double chi_square_p(std::span<const double> observed, std::span<const double> expected);

/// Chi-square p-value of directions drawn by `draw` against `pdf_w` (1/sr, over the whole sphere, may integrate to less than 1: the rest
/// are draws that `draw` declares lost by returning a zero vector). `axis`: around it the cells are small.
double chi_square_directions(const std::function<Vec3(Rng&)>& draw, const std::function<double(Vec3)>& pdf_w, Vec3 axis, int draws,
                             uint64_t seed);

inline Square square(Rng& rng) {
    const float u = rng.uniform();
    return {u, rng.uniform()};
}

}  // namespace lumel::test
