// The transillumination buffer in its plainest form: every pixel of every patch by integer edge functions, a list a pixel, std::sort.
#pragma once

#include "lumel/raster/transillumination.h"

namespace lumel::test {

struct Fragment {
    double depth = 0;
    uint32_t patch = 0;
    bool front_along = false;  ///< the front looks along the direction
};

/// What each pixel of the window meets, by depth; pixel (x, y) is at y * resolution + x.
std::vector<std::vector<Fragment>> fragment_lists(const Scene& scene, const Window& window);

/// The same as Transillumination::exchange.
void reference_exchange(const RasterScene& raster, const Window& window, std::span<const Rgb> sent, std::span<Rgb> received,
                        std::span<uint32_t> pixels, SweepCounters& counters);

}  // namespace lumel::test
