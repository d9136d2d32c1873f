// F - b (G - 1): the control variate with the coefficient of the area's own samples.
#pragma once

#include "lumel/estimators/estimator.h"

namespace lumel {

/// Consistent, with a bias of order 1/n; in the limit never worse than `classical` and `weighted`. Needs 8 sums an area. Below about 20
/// hits the coefficient is as noisy as the samples, and this is no better than `weighted`.
inline Estimate regression(const Samples& s, const Samples&) {
    if (!(s.gg > 0)) return {s.plain, s.var_plain, false};
    // All but few samples are 0, so that products of sums vanish against sums of products: b = Cov / Var = sum fg / sum gg.
    const Rgb64 b = s.fg * (1 / s.gg);
    return {s.f - b * (s.g - 1) + s.plain, control_variance(s, b) + s.var_plain, true};
}

}  // namespace lumel
