// The vertices of a scene in a window: snapped to a grid finer than the pixels, so that all tests of coverage are exact.
#pragma once

#include "lumel/raster/window.h"

namespace lumel {

inline constexpr int kSubpixelBits = 8;
/// Places along one edge of a pixel where a vertex can be.
inline constexpr int64_t kSubpixels = int64_t{1} << kSubpixelBits;
/// Depths are whole numbers from -kDepthRange to kDepthRange over the diameter of the scene, and linear along each row of a patch without
/// rounding: two pixels of a row grow by 2 kDepthRange at most, the farthest is Window::kMostResolution away, and 53 bits hold all.
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

/// Depth over the plane of a triangle.
class DepthPlane {
public:
    /// `twice_area` is turn(a, b, c) and not 0. The order of the vertices does not matter.
    DepthPlane(SnappedVertex a, SnappedVertex b, SnappedVertex c, int64_t twice_area);

    /// Depth at a pixel, a whole number.
    double at(double x, double y) const {
        const double d = depth_ + slope_x_ * (x - x_) + slope_y_ * (y - y_);
        return std::floor(std::min(std::max(d, lowest_), highest_));
    }
    /// What the depth grows by from a pixel to the next of the same row, a whole number. Meant for rows of at least two pixels.
    double step() const { return step_; }

private:
    double x_ = 0, y_ = 0, depth_ = 0, slope_x_ = 0, slope_y_ = 0, lowest_ = 0, highest_ = 0, step_ = 0;
};

}  // namespace lumel
