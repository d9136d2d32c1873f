// The correction that the neighbours of an area recommend: `weighted` for the many dim directions, `classical` for the bright few.
#pragma once

#include <cmath>

#include "lumel/estimators/few_hits.h"

namespace lumel {

inline constexpr double kOwnHits = 20;  // with about so many an area begins to go by its own samples

/// Radiance of the many dim directions around an area, sum fg / sum gg. Own samples join as far as there are enough of them.
inline Rgb64 dim_radiance(const Samples& own, const Samples& around) {
    const double hits = static_cast<double>(own.hits), trust = hits / (hits + kOwnHits), gg = around.gg + own.gg * trust;
    return gg > 0 ? (around.fg + own.fg * trust) * (1 / gg) : Rgb64{};
}

/// Hits that an area lacks of kEnoughHits, by their effective number or by what as many of its neighbours would add to G. The more hits
/// it has, however small, the less it is doubted.
inline constexpr double kEnoughHits = 8;
inline double missing_hits(const Samples& own, const Samples& around) {
    if (!(around.g > 0)) return 0;
    const double counted = std::min(own.effective_hits(), own.g / hit_size(own, around));
    return std::max(0.0, kEnoughHits - counted) * std::exp(-static_cast<double>(own.hits) / kOwnHits);
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
    const double missing = missing_hits(own, around);
    Estimate e = corrected(own, b);
    if (missing > 0) e = filled(e, 1 - missing / kEnoughHits, corrected(around, b), around, missing);
    return {e.value + own.plain, e.variance + own.var_plain};
}

}  // namespace lumel
