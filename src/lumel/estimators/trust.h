// How far an estimate can be trusted: what its samples say of themselves.
#pragma once

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

    static bool is_off(const Samples& s) { return s.var_g > 0 && (s.g - 1) * (s.g - 1) > kErrors * kErrors * s.var_g; }
};

}  // namespace lumel
