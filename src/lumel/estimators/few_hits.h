// What the neighbours of an area say for it where its own hits are few.
#pragma once

#include <algorithm>

#include "lumel/estimators/estimator.h"

namespace lumel {

/// What one hit of the neighbours would have added to G of the area: the mean of what hits add, by what they add. 0: they have none.
inline double hit_size(const Samples& own, const Samples& around) {
    return around.g > 0 ? around.gg / around.g * (around.size / own.size) : 0;
}

/// Let the estimate of the neighbours count as `hits` more hits, which then have the weight 1 - `share`: so it has the spread of so many
/// hits, however many it is made of.
inline Estimate filled(const Estimate& own, double share, const Estimate& neighbours, const Samples& around, double hits) {
    if (!(share < 1)) return own;
    const double rest = 1 - share, spread = std::max(1.0, around.effective_hits() / hits);
    return {own.value * share + neighbours.value * rest, own.variance * (share * share) + neighbours.variance * (rest * rest * spread),
            true};
}

}  // namespace lumel
