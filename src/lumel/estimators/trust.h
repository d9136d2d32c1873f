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
    float flag = 0;  ///< 1 where G is more than 4 standard errors from 1, or p misses more than 2 % of the lobe: a ratio would be off

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

    /// Whether |G - 1| is as unlikely as kErrors standard errors of a normal variable. The spread of few replicas follows Student's law
    /// (Wallace 1959 gives its normal equivalent), and where few hits made G small they made its spread small, too: Var G is proportional
    /// to G.
    static bool is_off(const Samples& s) {
        if (!(s.var_g > 0) || s.replicas < 2) return false;
        const double freedom = s.replicas - 1, t2 = (s.g - 1) * (s.g - 1) / (s.var_g * std::max(1.0, 1 / s.g));
        const double normal = (8 * freedom + 1) / (8 * freedom + 3) * std::sqrt(freedom * std::log1p(t2 / freedom));
        return normal > kErrors;
    }
};

}  // namespace lumel
