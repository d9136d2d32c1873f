// The outline of a patch in a window, exact: its corners are whole numbers once they are multiplied by the divisions of its triangle.
#pragma once

#include <array>

#include "lumel/raster/projection.h"

namespace lumel {

/// Edges of patches lie exactly on the lines that divide their triangle, and these end exactly on its edges. So neighbours share
/// their edges, however finely each is divided.
struct PatchOutline {
    struct Corner {
        int64_t x = 0, y = 0;  ///< subpixels times divisions
    };
    int64_t divisions = 1;
    std::array<Corner, 3> corners;  ///< they turn left in the window

    PatchOutline(const std::array<SnappedVertex, 3>& triangle, bool turns_left, uint32_t n, const PatchPlace& place) : divisions(n) {
        const auto points = place.lattice();
        for (size_t k = 0; k < 3; ++k) {
            const int64_t i = points[k][0], j = points[k][1], rest = divisions - i - j;
            corners[turns_left ? k : 2 - k] = {rest * triangle[0].x + i * triangle[1].x + j * triangle[2].x,
                                               rest * triangle[0].y + i * triangle[1].y + j * triangle[2].y};
        }
    }
    /// Units of the corners to a pixel.
    int64_t pixel() const { return divisions * kSubpixels; }
};

/// The least whole number that is not below a / b, for b > 0.
constexpr int64_t ceil_div(int64_t a, int64_t b) { return a / b + (a % b > 0 ? 1 : 0); }

}  // namespace lumel
