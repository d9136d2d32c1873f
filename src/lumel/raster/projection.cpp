#include "lumel/raster/projection.h"

namespace lumel {

void project(const Scene& scene, const Window& window, std::vector<SnappedVertex>& snapped) {
    // Vertices that no triangle uses may be anywhere, or NaN: hold them in the window.
    const double most = window.resolution * kSubpixels;
    const auto snap = [&](double pixels) {
        const double s = pixels * kSubpixels + 0.5;
        return static_cast<int32_t>(s > 0 ? std::min(s, most) : 0.0);
    };
    snapped.resize(scene.vertices().size());
    for (size_t i = 0; i < snapped.size(); ++i) {
        const Vec3 p = scene.vertices()[i];
        const double depth = window.depth(p) * kDepthRange;
        snapped[i] = {snap(window.x(p)), snap(window.y(p)), depth > -kDepthRange ? std::min(depth, kDepthRange) : -kDepthRange};
    }
}

DepthPlane::DepthPlane(SnappedVertex a, SnappedVertex b, SnappedVertex c, int64_t twice_area) {
    // Equal planes give equal numbers, whichever vertex came first.
    const auto before = [](const SnappedVertex& l, const SnappedVertex& r) {
        return l.y != r.y ? l.y < r.y : l.x != r.x ? l.x < r.x : l.depth < r.depth;
    };
    if (before(b, a)) std::swap(a, b), twice_area = -twice_area;
    if (before(c, b)) std::swap(b, c), twice_area = -twice_area;
    if (before(b, a)) std::swap(a, b), twice_area = -twice_area;

    constexpr double kPixels = 1.0 / kSubpixels;
    const double bx = (b.x - a.x) * kPixels, by = (b.y - a.y) * kPixels, cx = (c.x - a.x) * kPixels, cy = (c.y - a.y) * kPixels;
    const double bd = b.depth - a.depth, cd = c.depth - a.depth, area = static_cast<double>(twice_area) * (kPixels * kPixels);
    x = a.x * kPixels, y = a.y * kPixels, depth = a.depth;
    slope_x = (bd * cy - cd * by) / area;
    slope_y = (cd * bx - bd * cx) / area;
    lowest = std::min({a.depth, b.depth, c.depth});
    highest = std::max({a.depth, b.depth, c.depth});
    step = std::floor(slope_x);
}

}  // namespace lumel
