// Bundles as [WIS] 3.2 iterates them: what one direction brought is what the next one carries.
#pragma once

#include "lumel/transport/bundles.h"

namespace lumel {

/// Plain stochastic iteration. The state of a chain is one incoming direction and an irradiance a side; the BRDF gives the radiance that
/// leaves it. Independent chains, whose directions are spread evenly against each other, keep all threads busy. Their first iterations,
/// which lack late reflections, are not measured. The variance is bounded where `variance_growth` is below 1.
class IteratedBundles : public BundleLight {
public:
    IteratedBundles(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const BundleConfig& config);
    void step(uint32_t directions, const Sink& sink) override;

private:
    /// Light of the last iteration as one sample: `irradiance` per side in W/m2, from `direction` or -`direction`.
    struct Chain {
        Vec3 direction;
        std::vector<Rgb> irradiance;
    };
    /// One direction for every chain; without a sink nothing is measured or counted.
    void iterate(const Sink* sink);
    /// Add what a chain sends along a line, the shading normals being those at `at` of each patch.
    void add_reflected(const Chain& chain, Vec3 direction, Square at, std::span<Rgb> sent) const;
    /// Take what the bundles brought as the state of the chains, and add it to what sides received.
    void take_bundles(Square at, uint64_t stream);

    Emitters lamps_;         // what surfaces send of the lamps' light,
    Emitters over_mirrors_;  // of the light that came over mirrors in the last iteration,
    Emitters reflected_;     // and of what the bundles brought, on the mean over the chains
    std::vector<Chain> chains_;
};

}  // namespace lumel
