// The triangles that cross the present row of the window, four side by side.
#pragma once

#include "lumel/raster/depth_plane.h"
#include "lumel/raster/row_sweep.h"

namespace lumel {

/// A triangle of a window, with n x n patches.
struct ScannedTriangle {
    std::array<SnappedVertex, 3> corners;
    uint32_t triangle = 0, parity = 0, n = 1, first_patch = 0;
};

/// Follows the edges of triangles from row to row. A pixel belongs to a triangle if its centre is inside; a centre exactly on an edge is
/// taken as if it were moved a little to the right, and far less up: the top-left rule. All is computed in whole numbers below 2^53 held in
/// doubles; see round_up for why that is exact.
class ScanTriangles {
public:
    void clear() { fours_.clear(), live_.clear(), free_.clear(), divided_.clear(); }
    size_t bytes() const {
        return fours_.capacity() * (sizeof(Four) + 2 * sizeof(uint32_t)) + divided_.capacity() * sizeof(DividedTriangle);
    }

    /// Take the first `count` of four triangles before their first row is scanned.
    void begin(const std::array<ScannedTriangle, kLanes>& triangles, uint32_t count);
    /// Add the spans of all triangles in `row` to `sweep`.
    void scan(int32_t row, RowSweep& sweep);

private:
    static constexpr uint32_t kUndivided = 0xffffffffu;

    /// Edges from `a` up to `b` cross a row at (start + row * growth) / denominator, in pixels.
    struct Edges {
        Lanes start{}, growth{}, denominator{};

        Edges() = default;
        Edges(const VertexLanes& a, const VertexLanes& b);
    };
    struct FourSpans {
        IntLanes begin, end;
        Lanes depth_at_0, step;
    };
    struct Four {
        Edges long_edge, lower, upper;
        DepthPlanes plane;
        Lanes middle{}, end{};  ///< rows from which the upper edges are met, and nothing
        decltype(Lanes{} < Lanes{}) bends_left{};  ///< are two edges on the left side?
        int32_t last_end = 0;
        bool has_divided = false;
        std::array<uint32_t, kLanes> triangle{}, parity{}, first_patch{}, divided{};

        Four() = default;
        /// Corners are in the order of rows.
        Four(const VertexLanes& a, const VertexLanes& b, const VertexLanes& c);
        void cross(double row, FourSpans& spans) const;
    };

    void add_spans(const Four& four, const FourSpans& spans, int32_t row, RowSweep& sweep);

    std::vector<Four> fours_;
    std::vector<FourSpans> crossed_;  // of those that cross the row
    std::vector<uint32_t> live_, free_;  // of fours_, those that cross the row and those that have ended
    std::vector<DividedTriangle> divided_;  // of this window
};

}  // namespace lumel
