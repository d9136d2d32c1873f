// Equal division of a triangle into n x n patches, addressed by arithmetic.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "lumel/sampling/sobol.h"

namespace lumel {

/// Barycentric corners (u, v) of one patch in its triangle, where x = (1-u-v) a + u b + v c.
using PatchCorners = std::array<Square, 3>;

/// The point of a patch with barycentrics `b` in it, in its triangle.
constexpr Square within(const PatchCorners& c, Square b) {
    const float w = 1 - b.u - b.v;
    return {w * c[0].u + b.u * c[1].u + b.v * c[2].u, w * c[0].v + b.u * c[1].v + b.v * c[2].v};
}

/// Number of lattice points of a triangle with n divisions of each edge.
constexpr uint32_t lattice_size(uint32_t n) { return (n + 1) * (n + 2) / 2; }

/// Lattice point of column `i` (along u) and row `j` (along v), numbered row by row.
constexpr uint32_t lattice_index(uint32_t n, uint32_t i, uint32_t j) { return j * (2 * n + 3 - j) / 2 + i; }

/// Position of a patch in its triangle: row by row along v; in a row, upright and inverted patches alternate along u.
struct PatchPlace {
    uint32_t i = 0, j = 0;
    bool inverted = false;

    constexpr uint32_t index(uint32_t n) const { return j * (2 * n - j) + 2 * i + (inverted ? 1 : 0); }

    /// The patch that owns the point (u, v).
    static PatchPlace of_point(uint32_t n, float u, float v) {
        const auto m = static_cast<int32_t>(n);  // which vectors convert from and to floats
        const auto fn = static_cast<float>(m);
        const int32_t j = std::min(static_cast<int32_t>(std::max(v, 0.0f) * fn), m - 1);
        const int32_t i = std::min(static_cast<int32_t>(std::max(u, 0.0f) * fn), m - 1 - j);
        const float rest = u * fn - static_cast<float>(i) + v * fn - static_cast<float>(j);
        const bool inverted = (rest > 1.0f) & (i + j + 1 < m);
        return {static_cast<uint32_t>(i), static_cast<uint32_t>(j), inverted};
    }
    static PatchPlace of_index(uint32_t n, uint32_t index) {
        // Rows from j on hold (n-j)^2 patches together.
        const uint32_t left = n * n - index;
        auto rows = static_cast<uint32_t>(std::sqrt(static_cast<float>(left)));
        while (rows * rows < left) ++rows;
        while ((rows - 1) * (rows - 1) >= left) --rows;
        const uint32_t j = n - rows, k = index - j * (2 * n - j);
        return {k / 2, j, (k & 1) != 0};
    }
    /// Lattice points of the corners, counter-clockwise like the triangle.
    std::array<std::array<uint32_t, 2>, 3> lattice() const {
        if (inverted) return {{{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}};
        return {{{i, j}, {i + 1, j}, {i, j + 1}}};
    }
    PatchCorners corners(uint32_t n) const {
        PatchCorners c;
        const auto points = lattice();
        for (int k = 0; k < 3; ++k)
            c[k] = {static_cast<float>(points[k][0]) / static_cast<float>(n), static_cast<float>(points[k][1]) / static_cast<float>(n)};
        return c;
    }
};

}  // namespace lumel
