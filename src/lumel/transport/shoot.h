// One step of shooting: rays leave the emitters by their power, and arrive with their light and their exact density.
#pragma once

#include "lumel/transfer/transfers.h"
#include "lumel/transport/shot.h"

namespace lumel {

/// Trace the rays of `shot` and leave the transfers in `transfers`, grouped by side. Perfect mirrors are passed on the way. The result is
/// a pure function of the shot, whatever the number of threads.
void shoot(const Shot& shot, Transfers& transfers);

/// The rays of `shot` as they leave, block by block as `shoot` traces them: what tracing alone costs is measured with them.
std::vector<RayBlock> departures(const Shot& shot);

inline void shoot(const Accel& accel, const Emitters& emitters, const DefensiveStarts& defensive, const ShootConfig& config,
                  Transfers& transfers) {
    shoot(Shot(accel, emitters, defensive, config), transfers);
}

}  // namespace lumel
