#include "lumel/raster/window.h"

#include <stdexcept>
#include <string>

namespace lumel {

namespace {

/// Part of a ball's radius that rounding may add to the place of a vertex.
constexpr float kRounding = 1e-5f;

}  // namespace

Window Window::covering(const Scene& scene, Vec3 direction, uint32_t resolution, Square jitter) {
    if (resolution < kLeastResolution || resolution > kMostResolution)
        throw std::invalid_argument("a window has " + std::to_string(kLeastResolution) + " to " + std::to_string(kMostResolution) +
                                    " pixels along its edge, not " + std::to_string(resolution));
    if (!(jitter.u >= 0 && jitter.u < 1 && jitter.v >= 0 && jitter.v < 1))
        throw std::invalid_argument("the jitter of a window is within [0, 1)");
    const float norm = length(direction);
    if (!(std::abs(norm - 1) < 1e-3f)) throw std::invalid_argument("the direction of a window has length 1");

    Window w;
    const Frame frame(direction / norm);
    w.right = frame.s, w.up = frame.t, w.direction = frame.n;
    w.centre = scene.centre(), w.radius = scene.radius() * (1 + kRounding);
    w.resolution = resolution, w.jitter = jitter;

    // The ball fills all but two pixels of an edge: one for the jitter, one for the rounding of pixels to whole numbers.
    w.pixels_per_metre = (resolution - 2) / (2 * double{w.radius});
    w.pixel_area = static_cast<float>(1 / (w.pixels_per_metre * w.pixels_per_metre));
    return w;
}

Vec3 Window::start_of_line(uint32_t x, uint32_t y) const {
    const auto metres = [&](uint32_t pixel, float shift) {
        return static_cast<float>((pixel - middle() - double{shift}) / pixels_per_metre);
    };
    return centre + right * metres(x, jitter.u) + up * metres(y, jitter.v) - direction * radius;
}

}  // namespace lumel
