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
    double pixel = kSubpixels;  ///< units to a pixel
    std::array<Corner, 3> corners;

    PatchOutline(const std::array<SnappedVertex, 3>& triangle, uint32_t n, uint32_t index) : pixel(static_cast<double>(n * kSubpixels)) {
        if (n == 1) {
            for (size_t k = 0; k < 3; ++k) corners[k] = {static_cast<double>(triangle[k].x), static_cast<double>(triangle[k].y)};
            return;
        }
        const auto points = PatchPlace::of_index(n, index).lattice();
        for (size_t k = 0; k < 3; ++k) {
            const double i = points[k][0], j = points[k][1], rest = n - i - j;
            corners[k] = {rest * triangle[0].x + i * triangle[1].x + j * triangle[2].x,
                          rest * triangle[0].y + i * triangle[1].y + j * triangle[2].y};
        }
    }
};

/// The first row of pixels whose centres are not below `y`. The quotient is rounded up exactly: a fraction a/b lies at least 1/b above the
/// whole number below it, and the error of the division is less, as |a| < 2^53.
inline int32_t first_row(double y, double pixel) { return static_cast<int32_t>(std::ceil(y / pixel)); }

}  // namespace lumel
