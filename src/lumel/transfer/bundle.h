// Bundles: the parallel light of one direction as it arrives on all sides at once.
#pragma once

#include <vector>

#include "lumel/math/vec.h"

namespace lumel {

/// All lines of one direction through the scene, both ways ([WIS] 3.2). A bundle is integrated over the area of every side, so its sample
/// space is directions alone: light comes to a side from `direction` or from -`direction`, whichever is in front of it.
struct Bundle {
    /// Density of the direction that light comes from, 1/sr: uniform over the hemisphere of any side, lit or not.
    static constexpr float kPdf_w = 0.5f * kInvPi;

    Vec3 direction;
    std::vector<Rgb> irradiance;  ///< per side: mean over it of L_in cos(theta), W/(m2 sr)
    std::vector<float> cosine;  ///< per patch: rasterised projected area over area, whether or not light arrives; stands for cos(theta)

    /// Where light comes from to a side of that normal.
    Vec3 incoming(Vec3 normal) const { return dot(normal, direction) > 0 ? direction : -direction; }
};

}  // namespace lumel
