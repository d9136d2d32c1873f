// One step of shooting: rays leave the emitters by their power, and arrive with their light and their exact density.
#pragma once

#include "lumel/transport/defensive.h"
#include "lumel/transport/emitters.h"
#include "lumel/transfer/transfers.h"

namespace lumel {

struct ShootConfig {
    uint64_t rays = 1 << 20;  ///< rays of this step
    float defensive = 0.1f;   ///< share of them that starts at `DefensiveStarts`, 0..1
    uint64_t stream = 0;      ///< key of the random numbers
};

/// Shoot from `emitters` and leave the transfers in `transfers`, grouped by side. Perfect mirrors are passed on the way. The result
/// is a pure function of the arguments, whatever the number of threads.
void shoot(const Accel& accel, const Emitters& emitters, const DefensiveStarts& defensive, const ShootConfig& config, Transfers& transfers);

}  // namespace lumel
