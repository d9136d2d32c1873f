// F / G: weighted importance sampling ([WIS] section 2).
#pragma once

#include "lumel/estimators/estimator.h"

namespace lumel {

/// Consistent, with a bias of order 1/n. Needs 4 sums an area. Not where a small bright surface lights the scene: an area that was hit
/// from there alone takes all of its lobe to be that bright. The variance is that of the linearised ratio ([WIS] eq. 3).
inline Estimate weighted(const Samples& s, const Samples&) {
    if (!(s.g > 0)) return {s.plain, s.var_plain, false};
    const double inv = 1 / s.g;
    const Rgb64 ratio = s.f * inv;
    return {ratio + s.plain, control_variance(s, ratio) * (inv * inv) + s.var_plain, true};
}

}  // namespace lumel
