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

    /// Point of the film, in the unit square of the whole picture, at `s` of a pixel.
    Square on_film(uint32_t pixel, Square s) const {
        const uint32_t column = pixel % width, row = pixel / width;
        return on_film(static_cast<float>(column), static_cast<float>(row), s);
    }
    Square on_film(float column, float row, Square s) const {
        return {(column + s.u) / static_cast<float>(width), (row + s.v) / static_cast<float>(height)};
    }
    /// Unit direction through point `film` of the unit square, whose origin is the upper left corner.
    Vec3 direction(Square film) const { return normalize(forward + right * ((2 * film.u - 1) * tan_x) + up * ((1 - 2 * film.v) * tan_y)); }
};

}  // namespace lumel
