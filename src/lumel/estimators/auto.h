// The correction that the neighbours of an area recommend: `weighted` for the many dim directions, `classical` for the bright few.
#pragma once

#include <algorithm>

#include "lumel/estimators/weighted.h"

namespace lumel {

/// What the neighbours of an area make of its correction; own samples join as far as there are enough of them.
///     b = sum fg / sum gg      r = sum f / sum g
/// b is the radiance of the many dim directions; of few samples it is shrunk, down to `classical` of none.
struct Correction {
    Rgb64 b;
    double r = 0;

    Correction(const Samples& own, const Samples& around) {
        constexpr double kOwnHits = 20, kShrink = 2;
        const double hits = static_cast<double>(own.hits), trust = hits / (hits + kOwnHits);
        const double together = static_cast<double>(around.hits) + trust * hits;
        const double gg = around.gg + own.gg * trust, g = around.g + own.g * trust;
        b = (around.fg + own.fg * trust) * (together / (together + kShrink) / gg);
        r = lum(around.f + own.f * trust) / g;
    }
};

/// F - b (G - 1). Unbiased, but for what b has of the area's own samples.
inline Estimate corrected(const Samples& own, Rgb64 b) {
    return {own.f - b * (own.g - 1) + own.plain, control_variance(own, b) + own.var_plain, true};
}

/// For areas that are averaged again, where a bias would stay and noise does not.
inline Estimate automatic_to_average(const Samples& own, const Samples& around) {
    if (!(own.g > 0)) return {own.plain, own.var_plain, false};
    return corrected(own, Correction(own, around).b);
}

/// Consistent. With k = clamp(b/r, 0, 1): where G < 1, the part of the lobe that was not sampled is taken to look like b, F + b (1 - G);
/// else a mixture of F/G and of F - b (G - 1), by k. Needs 8 sums an area and its neighbours. Values may be slightly negative.
inline Estimate automatic(const Samples& own, const Samples& around) {
    if (!(own.g > 0)) return {own.plain, own.var_plain, false};
    const auto [b, r] = Correction(own, around);
    if (own.g < 1) return corrected(own, b);

    const double k = r > 0 ? std::clamp(lum(b) / r, 0.0, 1.0) : 0.0;
    const Rgb64 ratio = own.f * (1 / own.g), value = ratio * k + (own.f - b * (own.g - 1)) * (1 - k);
    return {value + own.plain, control_variance(own, ratio * k + b * (1 - k)) + own.var_plain, true};
}

}  // namespace lumel
