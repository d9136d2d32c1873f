// The vertices of a scene in a window: snapped to a grid finer than the pixels, so that all tests of coverage are exact.
#pragma once

#include <cstring>

#include "lumel/raster/lanes.h"
#include "lumel/raster/window.h"

namespace lumel {

inline constexpr int kSubpixelBits = 8;
/// Places along one edge of a pixel where a vertex can be.
inline constexpr int64_t kSubpixels = int64_t{1} << kSubpixelBits;
/// Depths are whole numbers from -kDepthRange to kDepthRange over the diameter of the scene, and linear along each row of a triangle
/// without rounding: two pixels of a row grow by 2 kDepthRange at most, the farthest is Window::kMostResolution away, and 53 bits hold all.
inline constexpr double kDepthRange = 0x1p39;

/// A vertex in the window: x and y in subpixels, the depth in its own units.
struct SnappedVertex {
    int32_t x = 0, y = 0;
    double depth = 0;
};

/// Snap all vertices of `scene` into `snapped`. Vertices in the same place are snapped to the same place.
void project(const Scene& scene, const Window& window, std::vector<SnappedVertex>& snapped);

/// Twice the signed area of three snapped vertices, in square subpixels: positive where the front looks along the window's direction.
constexpr int64_t turn(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c) {
    return int64_t{b.x - a.x} * (c.y - a.y) - int64_t{b.y - a.y} * (c.x - a.x);
}

/// The first row of a triangle, or the highest number if it has no pixel for certain: many of the smallest lie between two rows or columns.
inline uint32_t first_row(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c) {
    // The first two of the lanes are x and y.
    const auto lanes = [](const SnappedVertex& v) {
        IntLanes place;
        std::memcpy(&place, &v, sizeof place);
        return place;
    };
    const IntLanes pa = lanes(a), pb = lanes(b), pc = lanes(c);
    const IntLanes ab_least = pa < pb ? pa : pb, ab_most = pa > pb ? pa : pb;
    const IntLanes least = ((ab_least < pc ? ab_least : pc) + static_cast<int32_t>(kSubpixels - 1)) >> kSubpixelBits;
    const IntLanes most = ((ab_most > pc ? ab_most : pc) + static_cast<int32_t>(kSubpixels - 1)) >> kSubpixelBits;
    const IntLanes has_none = least == most;
    return static_cast<uint32_t>(least[1] | has_none[0] | has_none[1]);
}

}  // namespace lumel
