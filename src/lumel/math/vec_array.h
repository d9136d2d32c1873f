// Many vectors side by side, so that loops over them become vector code.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lumel/math/vec.h"

namespace lumel {

/// Floats of one instruction. Loops over a few things go on to a multiple of it, so that none is left over for slow code.
inline constexpr size_t kSideBySide = 8;
constexpr uint32_t padded(uint32_t count) { return (count + 7u) & ~7u; }
static_assert(padded(1) == kSideBySide);

/// N vectors, each coordinate an array.
template <size_t N>
struct Vec3Array {
    alignas(32) std::array<float, N> x, y, z;

    Vec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
    void set(size_t i, Vec3 v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
};

}  // namespace lumel
