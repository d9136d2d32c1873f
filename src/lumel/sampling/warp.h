// From the unit square to triangles, hemispheres and spheres, with the densities that belong to them.
#pragma once

#include "lumel/math/turns.h"
#include "lumel/math/vec.h"
#include "lumel/sampling/sobol.h"

namespace lumel {

/// Barycentrics (u, v) uniform by area over a triangle: the square is folded along its diagonal (Heitz 2019), which keeps strata.
inline Square square_to_triangle(Square s) {
    if (s.v > s.u) {
        const float u = 0.5f * s.u;
        return {u, s.v - u};
    }
    const float v = 0.5f * s.v;
    return {s.u - v, v};
}

/// Direction around +z with density cos/pi, 1/sr.
inline Vec3 square_to_cosine_hemisphere(Square s) {
    const float r = std::sqrt(s.u);
    const CosSin turn = cos_sin_turns(s.v);
    return {r * turn.cos, r * turn.sin, std::sqrt(std::max(0.0f, 1.0f - s.u))};
}

/// Direction with density 1/(4 pi), 1/sr.
inline Vec3 square_to_sphere(Square s) {
    const float z = 1.0f - 2.0f * s.u, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const CosSin turn = cos_sin_turns(s.v);
    return {r * turn.cos, r * turn.sin, z};
}

}  // namespace lumel
