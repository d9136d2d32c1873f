// Where the light of each lamp goes first: for people who want to know why their picture is dark or noisy.
#pragma once

#include <vector>

#include "lumel/accel/accel.h"

namespace lumel {

/// What becomes of the rays of one lamp, as shares of its flux that sum to 1.
struct LampReach {
    std::vector<float> onto;  ///< per shape: that it meets first
    float escaped = 0;        ///< that leaves the scene
};

/// Shoot `samples` rays from every lamp: area lamps in the order of the scene, then point lamps.
std::vector<LampReach> lamp_reach(const Accel& accel, uint32_t samples, uint64_t stream);

}  // namespace lumel
