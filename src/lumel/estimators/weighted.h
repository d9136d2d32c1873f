// F / G: weighted importance sampling ([WIS] section 2).
#pragma once

#include "lumel/estimators/few_hits.h"

namespace lumel {

/// F / G. Its variance is that of the linearised ratio ([WIS] eq. 3).
inline Estimate ratio(const Samples& s) {
    if (!(s.g > 0)) return {{}, {}, false};
    const double inv = 1 / s.g;
    const Rgb64 value = s.f * inv;
    return {value, control_variance(s, value) * (inv * inv)};
}

/// An area that has less than as many hits of its neighbours would make of G is no witness of its own light.
inline constexpr double kFewHits = 4;

/// Consistent, with a bias of order 1/n. Needs 5 sums an area. Not where a small bright surface lights the scene: an area that was hit
/// from there alone takes all of its lobe to be that bright. Where G is less than what a few hits of the neighbours would make of it, these
/// hits join: (F + h F'/G') / (G + h) with h what is missing.
inline Estimate weighted(const Samples& own, const Samples& around) {
    const double hit = hit_size(own, around), missing = std::max(0.0, kFewHits * hit - own.g);
    Estimate e = ratio(own);
    if (missing > 0) e = filled(e, own.g / (own.g + missing), ratio(around), around, missing / hit);
    return {e.value + own.plain, e.variance + own.var_plain, e.valid};
}

}  // namespace lumel
