// F: the mean of f/p.
#pragma once

#include "lumel/estimators/estimator.h"

namespace lumel {

/// Unbiased. Needs 3 sums an area. Not for gloss that many dim surfaces light: few hits carry all of its noise.
inline Estimate classical(const Samples& s, const Samples&) { return {s.f + s.plain, s.var_f + s.var_plain, true}; }

}  // namespace lumel
