// Many vectors side by side, so that loops over them become vector code.
#pragma once

#include <array>
#include <cstddef>

#include "lumel/math/vec.h"

namespace lumel {

/// N vectors, each coordinate an array.
template <size_t N>
struct Vec3Array {
    alignas(32) std::array<float, N> x, y, z;

    Vec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
    void set(size_t i, Vec3 v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
};

}  // namespace lumel
