// How far an estimate can be trusted: what its samples say of themselves.
#pragma once

#include <algorithm>
#include <cmath>

#include "lumel/estimators/estimator.h"

namespace lumel {

struct Trust {
    float weight = 0;      ///< G = mean(g/p), 1 where the density covers what the lobe sees
    float hits = 0;        ///< samples
    float correction = 0;  ///< what the estimator added to F, lum W/(m2 sr)
    float flag = 0;  ///< 1 where p misses more than 2 % of the lobe, or G is more than 4 standard errors from 1: a ratio would be off

    Trust() = default;
    Trust(const Samples& s, const Estimate& e)
        : weight(static_cast<float>(s.g)),
          hits(static_cast<float>(s.hits)),
          correction(static_cast<float>(lum(e.value) - lum(s.f) - lum(s.plain))),
          flag(is_off(s) || s.uncovered() > kUncovered ? 1.0f : 0.0f) {}

    Trust& operator+=(const Trust& o) {
        weight += o.weight, hits += o.hits, correction += o.correction, flag += o.flag;
        return *this;
    }
    Trust operator*(float s) const {
        Trust t = *this;
        t.weight *= s, t.hits *= s, t.correction *= s, t.flag *= s;
        return t;
    }

private:
    static constexpr double kErrors = 4, kUncovered = 0.02;

    /// Whether G is so far from 1 that p cannot be the density of the samples, or does not cover g. Heavy tails hide from few hits, and
    /// what was not hit does not show in their spread either; so the standard error is at least what looks tell of it, and the spread of G
    /// is taken where that is 1: few hits that made it small made Var G small in proportion.
    static bool is_off(const Samples& s) {
        if (!(s.var_g > 0) || s.replicas < 2) return false;
        const double spread = s.var_g * std::max(1.0, 1 / s.g);
        // Where light cannot reach part of an area, G falls short of 1 by that.
        const double difference = std::max({0.0, s.g - 1, 1 - s.dark() - s.g}), difference2 = difference * difference;
        if (difference2 <= kErrors * kErrors * s.var_g_of_looks()) return false;
        // The spread of few replicas follows Student's law; Wallace (1959) gives its normal equivalent.
        const double freedom = s.replicas - 1, t2 = difference2 / spread;
        return (8 * freedom + 1) / (8 * freedom + 3) * std::sqrt(freedom * std::log1p(t2 / freedom)) > kErrors;
    }
};

}  // namespace lumel
