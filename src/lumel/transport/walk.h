// Transport `walk`: random walks from the lights, one generation at a time.
#pragma once

#include <algorithm>
#include <functional>

#include "lumel/transfer/bundle.h"
#include "lumel/transport/illumination.h"
#include "lumel/transport/scatter.h"
#include "lumel/transport/shoot.h"

namespace lumel {

struct WalkConfig {
    uint64_t rays = 1 << 20;   ///< of the first generation; later ones get as many as power is left
    float defensive = 0.1f;    ///< share of defensive rays
    uint64_t stream = 0;       ///< key of the random numbers
};

/// What one step of a transport made: its transfers and bundles, and the light that every side received in it, W.
struct Generation {
    const Transfers& transfers;
    const Sight& sight;                ///< to gather from the same step
    const std::vector<Rgb>& received;
    const Emitters& next;  ///< what of it is sent on
    std::span<const Bundle> bundles = {};

    /// Transfers that ended on a side, and bundles that brought it light.
    uint64_t arrivals(uint32_t side) const {
        const auto lit = std::count_if(bundles.begin(), bundles.end(),
                                       [&](const Bundle& b) { return max_component(b.irradiance[side]) > 0; });
        return transfers.arrivals(side) + static_cast<uint64_t>(lit);
    }
};
using Sink = std::function<void(const Generation&)>;

/// Walk from `emitters` until roulette ends it. Every generation is shot from the patches that the last one reached (the points drawn anew
/// on them), so its density is exact given the state before. Hands each generation to `sink`; returns the rays shot. The mean over streams
/// has no bias but that of patches.
uint64_t walk(const Accel& accel, const DefensiveStarts& defensive, Emitters emitters, const WalkConfig& config, const Sink& sink);

}  // namespace lumel
