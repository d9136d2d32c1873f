// Whether the plain iteration of bundles keeps its variance bounded.
#pragma once

#include "lumel/transport/defensive.h"

namespace lumel {

/// Factor by which one step of the plain stochastic iteration of bundles ([WIS] 3.2) multiplies the second moment of the light, in the long
/// run: the norm of the operator whose kernel is 2 pi w^2, with w = f cos(theta). In a closed scene of diffuse albedo rho it is 4 rho^2 /
/// 3; sharp gloss that sees gloss makes it far larger. From 1 on the variance has no bound. Estimated by walks, so good to a few percent.
double variance_growth(const Accel& accel, const DefensiveStarts& reachable, uint64_t stream);

}  // namespace lumel
