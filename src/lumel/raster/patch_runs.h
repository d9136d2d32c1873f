// The patches of one triangle along a row of pixels, exact: the lines that divide the triangle cut the row at columns found by arithmetic.
#pragma once

#include <array>
#include <cstdint>

#include "lumel/raster/lanes.h"
#include "lumel/raster/projection.h"

namespace lumel {

/// Pixels of a row that belong to one patch, from where the run before it ends to before `end`; there may be none.
struct PatchRun {
    uint32_t end = 0, patch = 0;
};

/// The lines that divide a triangle into n x n patches, in three families: u, v and u + v constant, a whole number of n-ths. A pixel
/// belongs to the patch that its centre is in; a centre exactly on a line is taken as if it were moved a little to the right, and far less
/// up: the rule of ScanTriangles, so that patches cover what their triangle covers.
class DividedTriangle {
public:
    /// `corners` are those of (u, v) = (0, 0), (1, 0) and (0, 1), and not on one line; `n` > 1.
    DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch);

    /// Room that `cut` needs: for runs, and for columns.
    uint32_t room_for_runs() const { return 2 * n_ + 2; }
    uint32_t room_for_columns() const { return 3 * (n_ + kLanes); }
    /// Find the patches from pixel `begin` to before `end` of `row`, all in the triangle; gives how many `runs` there are. `columns` are
    /// overwritten.
    uint32_t cut(int32_t row, uint32_t begin, uint32_t end, PatchRun* runs, uint32_t* columns) const;

private:
    /// Lines that a row meets one after the other, and what crossing them does to the number of the patch.
    struct Cuts {
        const uint32_t* next = nullptr;  ///< columns in order, and then the end of the row
        uint32_t count = 0, step = 0, growth = 0;

        /// Find the columns `first` + k `further`, rounded up, over `denominator`.
        void find(double first, double further, double denominator, uint32_t end, uint32_t* columns);
    };
    void add_family(size_t k, const SnappedVertex& a, const SnappedVertex& last, const SnappedVertex& from, const SnappedVertex& to);
    IntLanes lines_before(double x, const Lanes& start) const;

    uint32_t n_, first_patch_;
    size_t steepest_ = 0;  // of the families
    /// Of u, v, u + v: pixels right of x = (start + row * growth + m * between) / denominator are beyond line m of a family. All are whole
    /// numbers below 2^53 held in doubles; see round_up for why that is exact.
    Lanes start_{}, growth_{}, between_{1, 1, 1, 1}, denominator_{};
};

}  // namespace lumel
