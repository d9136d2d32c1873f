// Depth over the planes of triangles, four side by side.
#pragma once

#include "lumel/raster/lanes.h"
#include "lumel/raster/projection.h"

namespace lumel {

/// One corner of each of four triangles.
struct VertexLanes {
    Lanes x, y, depth;

    VertexLanes(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c, const SnappedVertex& d)
        : x(__builtin_convertvector((IntLanes{a.x, b.x, c.x, d.x}), Lanes)),
          y(__builtin_convertvector((IntLanes{a.y, b.y, c.y, d.y}), Lanes)),
          depth{a.depth, b.depth, c.depth, d.depth} {}
    VertexLanes(const Lanes& x_, const Lanes& y_, const Lanes& depth_) : x(x_), y(y_), depth(depth_) {}
};

/// Exchange corners where `b` is lower than `a`, or else further left, or else nearer.
inline void put_in_order(VertexLanes& a, VertexLanes& b) {
    const auto swap = (b.y < a.y) | ((b.y == a.y) & ((b.x < a.x) | ((b.x == a.x) & (b.depth < a.depth))));
    const VertexLanes given = a;
    a = {swap ? b.x : a.x, swap ? b.y : a.y, swap ? b.depth : a.depth};
    b = {swap ? given.x : b.x, swap ? given.y : b.y, swap ? given.depth : b.depth};
}

/// Depth over the planes of triangles: at pixel (x, y) it is depth + slope_y (y - plane.y) + slope_x (x - plane.x), kept within the depths
/// of the corners and rounded.
struct DepthPlanes {
    Lanes x{}, y{}, depth{};  ///< of the first corners; x and y in pixels
    Lanes slope_x{}, slope_y{};
    Lanes lowest{}, highest{};
    Lanes step{};  ///< from pixel to pixel along a row, a whole number

    DepthPlanes() = default;
    /// Corners are in order, so that equal planes give equal numbers. Triangles without area get any numbers.
    DepthPlanes(const VertexLanes& a, const VertexLanes& b, const VertexLanes& c) {
        constexpr double kPixels = 1.0 / kSubpixels;
        const Lanes bx = (b.x - a.x) * kPixels, by = (b.y - a.y) * kPixels, cx = (c.x - a.x) * kPixels, cy = (c.y - a.y) * kPixels;
        const Lanes bd = b.depth - a.depth, cd = c.depth - a.depth, area = bx * cy - by * cx;
        x = a.x * kPixels, y = a.y * kPixels, depth = a.depth;
        slope_x = (bd * cy - cd * by) / area;
        slope_y = (cd * bx - bd * cx) / area;
        const Lanes low = a.depth < b.depth ? a.depth : b.depth, high = a.depth > b.depth ? a.depth : b.depth;
        lowest = low < c.depth ? low : c.depth, highest = high > c.depth ? high : c.depth;
        step = -slope_x;
        round_up(step);
        step = -step;
    }
    /// Find the depths `d` at pixels (first, row).
    void at(const Lanes& first, double row, Lanes& d) const {
        d = depth + slope_y * (row - y) + slope_x * (first - x);
        d = d > lowest ? d : lowest;
        d = d < highest ? d : highest;
        round(d);
    }
};

}  // namespace lumel
