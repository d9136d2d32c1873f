// The transillumination buffer in its plainest form: every pixel of every patch by integer edge functions, a list a pixel, std::sort.
#pragma once

#include "lumel/raster/transillumination.h"

namespace lumel::test {

struct Fragment {
    double depth = 0;
    uint32_t patch = 0;
    bool front_along = false;  ///< the front looks along the direction
};

/// Is the centre of pixel (x, y) in a patch of a snapped triangle with n x n of them? One that lies exactly on an edge is taken as if it
/// were moved a little to the right, and far less up.
bool patch_covers(const std::array<SnappedVertex, 3>& triangle, uint32_t n, const PatchPlace& place, int64_t x, int64_t y);

/// What each pixel of the window meets, by depth; pixel (x, y) is at y * resolution + x.
std::vector<std::vector<Fragment>> fragment_lists(const Scene& scene, const Window& window);

/// The same as Transillumination::exchange.
void reference_exchange(const RasterScene& raster, const Window& window, std::span<const Rgb> sent, std::span<Rgb> received,
                        std::span<uint32_t> pixels, SweepCounters& counters);

}  // namespace lumel::test
