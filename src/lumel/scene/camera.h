// A pinhole camera.
#pragma once

#include <cstdint>

#include "lumel/math/vec.h"
#include "lumel/sampling/sobol.h"

namespace lumel {

struct Camera {
    Vec3 origin;
    Vec3 right, up, forward;          ///< orthonormal; `right` points to the right of the picture
    float tan_x = 0.5f, tan_y = 0.5f; ///< tangents of half the fields of view
    uint32_t width = 1, height = 1;   ///< pixels

    /// Unit direction through point `film` of the unit square, whose origin is the upper left corner.
    Vec3 direction(Square film) const { return normalize(forward + right * ((2 * film.u - 1) * tan_x) + up * ((1 - 2 * film.v) * tan_y)); }
};

}  // namespace lumel
