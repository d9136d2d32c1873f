// The plan of one step of shooting: how many rays start where, and from it the density of any ray.
#pragma once

#include "lumel/transfer/sight.h"
#include "lumel/transport/defensive.h"
#include "lumel/transport/emitters.h"

namespace lumel {

struct ShootConfig {
    uint64_t rays = 1 << 20;  ///< rays of this step
    float defensive = 0.1f;   ///< share of them that starts at `DefensiveStarts`, 0..1
    uint64_t stream = 0;      ///< key of the random numbers
    bool beside_bundles = false;  ///< bundles carry what goes straight from side to side: only the rest counts, without density
};

/// One step: rays go to surfaces and point lamps by power, and a share of them is defensive. What it refers to must outlive it.
class Shot : public Sight {
public:
    Shot(const Accel& accel, const Emitters& emitters, const DefensiveStarts& defensive, const ShootConfig& config);

    const Accel& accel;
    const Emitters& emitters;
    const DefensiveStarts& defensive;
    const Scene& scene;
    const uint64_t stream;
    const bool beside_bundles;
    Distribution by_power;                                         ///< over sides, W
    uint32_t from_power = 0, from_defensive = 0, from_points = 0;  ///< rays of each kind, in this order
    double rays_per_watt = 0;                                      ///< of the rays by power
    double point_power = 0;                                        ///< of all point lamps that shoot, W

    uint32_t rays() const { return from_power + from_defensive + from_points; }
    /// n p_y / cos(theta_y) of the defensive rays from the sphere around an open scene, 1/(m2 sr).
    float defensive_density() const { return defensive_density_; }
    /// The same of those from a side: 0 where light cannot come.
    float defensive_density(uint32_t side) const {
        return defensive_density_ > 0 && defensive.by_area.weight(side) > 0 ? defensive_density_ : 0.0f;
    }
    void see(std::span<const Look> looks, std::span<Seen> seen) const override;

private:
    /// What a look along `ray` finds, which met `hit`.
    Seen see(Ray ray, Hit hit) const;
    float defensive_density_ = 0;
};

/// A path in a hall of mirrors ends after so many at the latest.
inline constexpr int kMostMirrors = 64;

}  // namespace lumel
