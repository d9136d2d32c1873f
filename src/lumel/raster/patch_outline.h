// The outline of a patch in a window, exact: its corners are whole numbers once they are multiplied by the divisions of its triangle.
#pragma once

#include <array>

#include "lumel/raster/projection.h"

namespace lumel {

/// Edges of patches lie exactly on the lines that divide their triangle, and these end exactly on its edges. So neighbours share
/// their edges, however finely each is divided.
struct PatchOutline {
    /// In subpixels times divisions: below 2^32, so that products with differences of corners are exact in a double.
    struct Corner {
        double x = 0, y = 0;
    };
    double divisions = 1;
    std::array<Corner, 3> corners;

    PatchOutline(const std::array<SnappedVertex, 3>& triangle, uint32_t n, const PatchPlace& place) : divisions(n) {
        const auto points = place.lattice();
        for (size_t k = 0; k < 3; ++k) {
            const double i = points[k][0], j = points[k][1], rest = divisions - i - j;
            corners[k] = {rest * triangle[0].x + i * triangle[1].x + j * triangle[2].x,
                          rest * triangle[0].y + i * triangle[1].y + j * triangle[2].y};
        }
    }
    /// Units of the corners to a pixel.
    double pixel() const { return divisions * kSubpixels; }
};

}  // namespace lumel
