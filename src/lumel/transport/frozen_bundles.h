// Bundles from a solved state: solve by power first, then cast from that frozen state and average.
#pragma once

#include "lumel/transport/bundles.h"
#include "lumel/transport/rays.h"

namespace lumel {

/// The solved light of one replica. What bundles bring is measured and not fed back; records are drawn anew for every batch by rays, which
/// find the directions of a lobe far better than bundles do.
class FrozenBundles : public BundleLight {
public:
    FrozenBundles(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const BundleConfig& config);
    void step(uint32_t directions, const Sink& sink) override;

private:
    void cast_batch(uint32_t directions, const Sink& sink);

    FrozenLight solved_;
    Emitters over_mirrors_;
    uint32_t directions_ = 0;  // number of the next one
};

}  // namespace lumel
