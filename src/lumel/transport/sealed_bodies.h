// Where the closed bodies are whose inside no light reaches: what lies in none of their boxes is covered by none.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

class SealedBodies {
public:
    /// `closed`: the closed surface of every triangle (see `closed_surfaces`). `sealed`: per face, 2 triangle + back, can no light reach
    /// it?
    SealedBodies(const Scene& scene, const std::vector<uint32_t>& closed, const std::vector<uint8_t>& sealed);

    /// May a body that the patch is no part of cover some of it? Where the outside of a closed surface is sealed, as that of a room, all
    /// may be covered.
    bool may_cover(uint32_t patch) const;

private:
    struct Box {
        Vec3 lower, upper;
        uint32_t surface = 0;
    };
    Box around(uint32_t triangle, const std::array<Vec3, 3>& corners) const;

    const Scene& scene_;
    const std::vector<uint32_t>& closed_;
    bool everywhere_ = false;
    std::vector<Box> boxes_;  // by the x of their lower corners
    float widest_ = 0;  // along x
};

}  // namespace lumel
