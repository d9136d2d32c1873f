// The correction that the neighbours of an area recommend: `weighted` for the many dim directions, `classical` for the bright few.
#pragma once

#include "lumel/estimators/few_hits.h"

namespace lumel {

/// Radiance of the many dim directions around an area, sum fg / sum gg. Own samples join as far as there are enough of them; of few samples
/// it is shrunk, down to `classical` of none.
inline Rgb64 dim_radiance(const Samples& own, const Samples& around) {
    constexpr double kOwnHits = 20, kShrink = 2;
    const double hits = static_cast<double>(own.hits), trust = hits / (hits + kOwnHits);
    const double together = static_cast<double>(around.hits) + trust * hits, gg = around.gg + own.gg * trust;
    return gg > 0 ? (around.fg + own.fg * trust) * (together / (together + kShrink) / gg) : Rgb64{};
}

/// F - b (G - 1). Unbiased, but for what b has of the area's own samples.
inline Estimate corrected(const Samples& s, Rgb64 b) { return {s.f - b * (s.g - 1), control_variance(s, b)}; }

/// For areas that are averaged again, where a bias would stay and noise does not.
inline Estimate automatic_to_average(const Samples& own, const Samples& around) {
    if (!(own.g > 0)) return {own.plain, own.var_plain, false};
    const Estimate e = corrected(own, dim_radiance(own, around));
    return {e.value + own.plain, e.variance + own.var_plain};
}

/// Consistent: F - b (G - 1) of the area. Where it has but few hits, those that are missing join from its neighbours. Needs 8 sums an
/// area and its neighbours. Values may be slightly negative.
inline Estimate automatic(const Samples& own, const Samples& around) {
    if (!(own.g > 0) && !(around.g > 0)) return {own.plain, own.var_plain, false};
    const Rgb64 b = dim_radiance(own, around);
    const double missing = around.g > 0 ? std::max(0.0, kFewHits - own.effective_hits()) : 0;
    Estimate e = corrected(own, b);
    if (missing > 0) e = filled(e, 1 - missing / kFewHits, corrected(around, b), around, missing);
    return {e.value + own.plain, e.variance + own.var_plain};
}

}  // namespace lumel
