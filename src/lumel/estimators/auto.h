// The correction that the neighbours of an area recommend: `weighted` for the many dim directions, `classical` for the bright few.
#pragma once

#include <algorithm>

#include "lumel/estimators/weighted.h"

namespace lumel {

/// Consistent. With moments over the neighbours (own samples join as far as there are enough of them),
///     b = sum fg / sum gg      r = sum f / sum g      k = clamp(b/r, 0, 1)
/// b is the radiance of the many dim directions; of few samples it is shrunk, down to `classical` of none. Where G < 1, the part of the
/// lobe that was not sampled is taken to look like that, F + b (1 - G); else a mixture of F/G and of F - b (G - 1), by k. Needs 8 sums an
/// area and its neighbours. Values may be slightly negative.
inline Estimate automatic(const Samples& own, const Samples& around) {
    if (!(own.g > 0)) return {own.plain, own.var_plain, false};
    constexpr double kOwnHits = 20, kShrink = 2;
    const double hits = static_cast<double>(own.hits), trust = hits / (hits + kOwnHits);
    const double together = static_cast<double>(around.hits) + trust * hits;
    const Rgb64 fg = around.fg + own.fg * trust, f = around.f + own.f * trust;
    const double gg = around.gg + own.gg * trust, g = around.g + own.g * trust;
    const Rgb64 b = fg * (together / (together + kShrink) / gg);
    if (own.g < 1) return {own.f + b * (1 - own.g) + own.plain, control_variance(own, b) + own.var_plain, true};

    const double r = lum(f) / g, k = r > 0 ? std::clamp(lum(b) / r, 0.0, 1.0) : 0.0;
    const Rgb64 ratio = own.f * (1 / own.g), value = ratio * k + (own.f - b * (own.g - 1)) * (1 - k);
    return {value + own.plain, control_variance(own, ratio * k + b * (1 - k)) + own.var_plain, true};
}

}  // namespace lumel
