// All lamps side by side, as far as choosing among them needs: area lamps first, then point lamps.
#pragma once

#include <cstdint>
#include <vector>

#include "lumel/math/vec.h"

namespace lumel {

/// Each quantity is an array over the lamps, so that loops over them become vector code.
struct LampArrays {
    std::vector<float> x, y, z;     ///< centre
    std::vector<float> nx, ny, nz;  ///< unit normal of a flat lamp, else 0
    std::vector<float> round;       ///< 1: seen alike from all sides, 0: flat
    std::vector<float> radius;      ///< all of the lamp is within it, m
    std::vector<float> power;       ///< lum of radiance times area, or of intensity, W/sr

    uint32_t size() const { return static_cast<uint32_t>(x.size()); }
    static constexpr float kFlat = 0.9999f;  ///< length of the mean normal from which on a lamp is flat
    /// `mean_normal`: its length tells how flat the lamp is.
    void add(Vec3 centre, Vec3 mean_normal, float lamp_radius, float lamp_power) {
        const float flatness = length(mean_normal);
        const bool flat = flatness > kFlat;
        const Vec3 normal = flat ? mean_normal / flatness : Vec3{};
        x.push_back(centre.x), y.push_back(centre.y), z.push_back(centre.z);
        nx.push_back(normal.x), ny.push_back(normal.y), nz.push_back(normal.z);
        round.push_back(flat ? 0.0f : 1.0f), radius.push_back(lamp_radius), power.push_back(lamp_power);
    }
};

}  // namespace lumel
