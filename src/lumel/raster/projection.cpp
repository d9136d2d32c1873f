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

}  // namespace lumel
