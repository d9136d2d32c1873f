// Transport `rays`: ray shooting from a solved state ([WIS] 3.1). Solve by power first, then shoot from that frozen state and average.
#pragma once

#include "lumel/transport/walk.h"

namespace lumel {

/// The solved light of one replica: diffuse flux frozen, records drawn anew by every step from what the step received.
class FrozenLight {
public:
    /// Solve with about `config.rays` times the number of reflections rays; adds the rays shot to `rays`.
    FrozenLight(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const WalkConfig& config, uint64_t& rays);

    /// Shoot one step of `config.rays` rays and hand it to `sink`; returns the rays shot.
    uint64_t step(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const ShootConfig& config,
                  const Sink& sink);

    /// The rays that a step would shoot (see `departures`).
    std::vector<Ray> departures(const Accel& accel, const DefensiveStarts& defensive, const ShootConfig& config) const {
        return lumel::departures(Shot(accel, emitters_, defensive, config));
    }
    /// What the next step would shoot.
    const Emitters& emitters() const { return emitters_; }

private:
    Emitters emitters_, next_;
    std::vector<Rgb> received_;
    Transfers transfers_;
    uint32_t steps_ = 0;
};

}  // namespace lumel
