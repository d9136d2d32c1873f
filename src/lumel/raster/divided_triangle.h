// The patches of one triangle along a row of pixels, exact: the lines that divide the triangle cut the row at columns found by arithmetic.
#pragma once

#include <array>
#include <cstdint>

#include "lumel/raster/lanes.h"
#include "lumel/raster/projection.h"

namespace lumel {

/// The lines that divide a triangle into n x n patches, in three families: u, v and u + v constant, a whole number of n-ths. A pixel
/// belongs to the patch that its centre is in; a centre exactly on a line is taken as if it were moved a little to the right, and far less
/// up: the rule of ScanTriangles, so that patches cover what their triangle covers.
class DividedTriangle {
public:
    /// `corners` are those of (u, v) = (0, 0), (1, 0) and (0, 1), and not on one line; `n` > 1.
    DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch);

    /// Find by how much the number of the patch grows from pixel to pixel of `row`, after `begin` and before `end`, all in the triangle:
    /// steps[x] += step at pixel x. Lines that may lie after the last pixel count at `end`. Gives the patch of `begin`.
    uint32_t cut(int32_t row, uint32_t begin, uint32_t end, int32_t* steps) const;

private:
    void add_family(int k, const SnappedVertex& a, const SnappedVertex& last, const SnappedVertex& from, const SnappedVertex& to);

    int32_t n_;
    uint32_t first_patch_;
    /// Of u, v, u + v: pixels right of x = (start + row * growth + m * between) / denominator are beyond line m of a family, or line ~m of
    /// one that is met downward. All are whole numbers below 2^53 held in doubles; see round_up for why that is exact.
    Lanes start_{}, growth_{}, between_{1, 1, 1, 1}, denominator_{};
    IntLanes is_down_{};
};

}  // namespace lumel
