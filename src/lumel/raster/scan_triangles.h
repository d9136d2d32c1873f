// The triangles that cross the present row of the window, four side by side.
#pragma once

#include "lumel/raster/patch_runs.h"
#include "lumel/raster/row_sweep.h"

namespace lumel {

/// Follows the edges of triangles from row to row. A pixel belongs to a triangle if its centre is inside; a centre exactly on an edge is
/// taken as if it were moved a little to the right, and far less up: the top-left rule. All is computed in whole numbers below 2^53 held in
/// doubles; see round_up for why that is exact.
class ScanTriangles {
public:
    void clear() { size_ = 0, divided_.clear(); }
    size_t bytes() const {
        return fours_.capacity() * sizeof(Four) + divided_.capacity() * sizeof(DividedTriangle) + columns_.capacity() * sizeof(uint32_t);
    }

    /// Take a triangle from its first row on, with n x n patches.
    void push(const std::array<SnappedVertex, 3>& corners, const DepthPlane& plane, uint32_t triangle, uint32_t parity, uint32_t n, uint32_t first_patch);
    /// Add the spans of all triangles in `row` to `sweep`, and go on to the next row.
    void scan(int32_t row, RowSweep& sweep);

private:
    static constexpr size_t kLeft = 0, kRight = 1;
    static constexpr uint32_t kUndivided = 0xffffffffu;

    /// Where an edge from `a` up to `b` crosses a row is numerator / denominator, in pixels.
    struct Edge {
        double numerator = 0, growth = 0, denominator = 1;

        Edge() = default;
        Edge(const SnappedVertex& a, const SnappedVertex& b, int32_t row) {
            const double dx = b.x - a.x, dy = b.y - a.y;
            numerator = a.x * dy + dx * (static_cast<double>(row * kSubpixels) - a.y);
            growth = dx * kSubpixels, denominator = dy * kSubpixels;
        }
    };
    struct FourSpans {
        IntLanes begin, end;
        Lanes depth_at_0, step;
    };
    struct Four {
        Lanes numerator[2]{}, growth[2]{}, denominator[2]{Lanes{1, 1, 1, 1}, Lanes{1, 1, 1, 1}};
        Lanes x{}, y{}, depth{}, slope_x{}, slope_y{}, lowest{}, highest{}, step{};  // of the planes
        Edge upper[kLanes];                                           // follows on the side that has two edges
        IntLanes next_change{}, end_row{};
        uint32_t short_side[kLanes] = {}, triangle[kLanes] = {}, parity[kLanes] = {}, first_patch[kLanes] = {}, divided[kLanes] = {};

        void set_edge(uint32_t side, uint32_t lane, const Edge& edge) {
            numerator[side][lane] = edge.numerator, growth[side][lane] = edge.growth, denominator[side][lane] = edge.denominator;
        }
        void cross(double row, FourSpans& spans);
        void copy(uint32_t to, const Four& other, uint32_t from);
    };

    std::vector<Four> fours_;
    std::vector<DividedTriangle> divided_;  // of this window
    std::vector<uint32_t> columns_;
    uint32_t size_ = 0;
};

}  // namespace lumel
