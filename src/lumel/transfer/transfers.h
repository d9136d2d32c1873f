// Transfers: light under way from one point to another, as it arrives; what transports make and areas of interest measure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/math/vec.h"
#include "lumel/scene/scene.h"

namespace lumel {

/// One transfer (x, wi, L_in, p) that ended on a surface, in the form that measuring needs.
struct Transfer {
    static constexpr uint32_t kLost = 0xffffffffu;

    uint32_t side = kLost;  ///< side that holds x; kLost where the ray left the scene or carried no sample
    float u = 0, v = 0;     ///< barycentrics of x in its triangle
    Vec3 wi;                ///< where the light came from
    Rgb flux;               ///< L_in cos(theta_x) / (n p), W: what the transfer carries of the light, over n rays of one step
    float inv_pdf = 0;      ///< cos(theta_x) / (n p), m2 sr; 0: the transfer has no density, it stays outside all ratios
};

/// The transfers of one step in the order of their rays, and an order that groups them by side and keeps rays in order within.
struct Transfers {
    std::vector<Transfer> all;
    std::vector<uint32_t> first;  ///< sides + 1: group of side s is order[first[s]] .. order[first[s+1]]
    std::vector<uint32_t> order;
    uint64_t rays = 0;            ///< n of the densities: rays shot from surfaces and the enclosing sphere
    uint64_t escaped = 0;         ///< rays that left the scene
    double lost_flux = 0;         ///< luminous part of the flux that left the scene, W

    std::span<const uint32_t> group(uint32_t side) const { return {order.data() + first[side], order.data() + first[side + 1]}; }
    /// Sort by side (counting sort, stable: the same order for any number of threads).
    void group_by_side(uint32_t sides);
};

}  // namespace lumel
