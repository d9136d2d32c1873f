// The correction that the neighbours of an area recommend: `weighted` for the many dim directions, `classical` for the bright few.
#pragma once

#include <cmath>

#include "lumel/estimators/weighted.h"

namespace lumel {

/// Radiance of the many dim directions around an area, sum fg / sum gg. Own samples join as far as there are enough of them.
inline Rgb64 dim_radiance(const Samples& own, const Samples& around) {
    constexpr double kOwnHits = 20;
    const double hits = static_cast<double>(own.hits), trust = hits / (hits + kOwnHits), gg = around.gg + own.gg * trust;
    return gg > 0 ? (around.fg + own.fg * trust) * (1 / gg) : Rgb64{};
}

/// F - b (G - 1). Unbiased, but for what b has of the area's own samples.
inline Estimate corrected(const Samples& s, Rgb64 b) { return {s.f - b * (s.g - 1), control_variance(s, b)}; }

/// For areas that are averaged again, where a bias would stay and noise does not.
inline Estimate automatic_to_average(const Samples& own, const Samples& around) {
    if (!(own.g > 0)) return {own.plain, own.var_plain, false};
    const Estimate e = corrected(own, dim_radiance(own, around));
    return {e.value + own.plain, e.variance + own.var_plain};
}

/// How far an area of so many hits, however small, is to be doubted, 1..0: not with some two hundred.
inline double doubt(uint64_t hits) {
    constexpr double kMany = 80;
    const double many = static_cast<double>(hits) / kMany;
    return std::exp(-many * many);
}

/// F - b (G - 1). Where G > 1 and hits are few, F/G takes over as far as the light around is even:
///     k = clamp(b G'/F', 0, 1) min(1, G - 1)
/// times the doubt is its share.
inline Estimate corrected_or_ratio(const Samples& own, const Samples& around, Rgb64 b) {
    const Estimate e = corrected(own, b);
    const double light = lum(around.f);
    if (!(own.g > 1 && light > 0)) return e;
    const double k = std::clamp(lum(b) * around.g / light, 0.0, 1.0) * std::min(1.0, own.g - 1) * doubt(own.hits);
    const Rgb64 ratio = own.f * (1 / own.g);
    return {ratio * k + e.value * (1 - k), control_variance(own, ratio * k + b * (1 - k))};
}

inline constexpr double kEnoughHits = 8;

/// Share that the neighbours of an area have in its light, 0..1: of few hits, what they lack of kEnoughHits by their effective number or by
/// their size; and until there are some hundred, what G lacks of kFewHits of the neighbours, as in `weighted`.
inline double share_of_neighbours(const Samples& own, const Samples& around) {
    constexpr double kFew = 15;
    if (!(around.g > 0)) return 0;
    const double hits = static_cast<double>(own.hits), by_size = own.g / hit_size(own, around),
                 counted = std::min(by_size, own.effective_hits());
    const double few = std::max(0.0, 1 - counted / kEnoughHits) * std::exp(-hits / kFew),
                 faint = std::max(0.0, 1 - by_size / kFewHits) * doubt(own.hits);
    return std::max(few, faint);
}

/// Consistent: the correction of an area by its own samples, and the same of its neighbours, as far as its hits are few. Needs 8 sums an
/// area and its neighbours. Values may be slightly negative.
inline Estimate automatic(const Samples& own, const Samples& around) {
    if (!(own.g > 0) && !(around.g > 0)) return {own.plain, own.var_plain, false};
    const Rgb64 b = dim_radiance(own, around);
    const double share = share_of_neighbours(own, around);
    Estimate e = corrected_or_ratio(own, around, b);
    if (share > 0) e = filled(e, 1 - share, corrected(around, b), around, share * kEnoughHits);
    return {e.value + own.plain, e.variance + own.var_plain};
}

}  // namespace lumel
