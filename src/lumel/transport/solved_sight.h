// Looking back along a bundle.
#pragma once

#include "lumel/accel/accel.h"
#include "lumel/transfer/sight.h"
#include "lumel/transport/defensive.h"
#include "lumel/transport/emitters.h"

namespace lumel {

/// Sees what bundles carry of the light of emitters: straight from surface to surface, by lobes that are not too sharp. There is no density
/// along a look: that of bundles is the same everywhere (see Bundle). What it refers to must outlive it.
class SolvedSight : public Sight {
public:
    SolvedSight(const Accel& accel, const DefensiveStarts& reachable, const Emitters& emitters)
        : accel_(&accel), reachable_(&reachable), emitters_(&emitters) {}
    void see(std::span<const Look> looks, std::span<Seen> seen) const override;

private:
    const Accel* accel_;
    const DefensiveStarts* reachable_;
    const Emitters* emitters_;
};

}  // namespace lumel
