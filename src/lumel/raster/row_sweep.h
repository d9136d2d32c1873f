// One row of the window: which patches lie one behind the other, pixel by pixel, and the light that neighbours exchange.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/raster/patch_light.h"
#include "lumel/raster/sweep_counters.h"

namespace lumel {

/// The part of a row that a patch covers.
struct RowSpan {
    double depth_at_0 = 0, step = 0;  ///< whole numbers: the depth at pixel x is depth_at_0 + x step
    uint32_t end = 0;                 ///< the pixel after the last
    uint32_t patch = 0;
    uint32_t next = 0;                ///< another span that begins at the same pixel, or kNoSpan
    uint32_t facing = 0;              ///< equal for fragments that must not be neighbours; see RasterScene::facing

    double depth(uint32_t x) const { return depth_at_0 + step * x; }
    bool is_before(const RowSpan& other, uint32_t x) const {
        const double a = depth(x), b = other.depth(x);
        return a != b ? a < b : patch < other.patch;
    }
};

/// Walks along a row from one begin or end of a span to the next. Between them the same patches are met in the same order, unless two
/// cross, so that all pixels there exchange at once.
class RowSweep {
public:
    /// Forget all spans, and be ready for rows of `width` pixels.
    void resize(uint32_t width);
    /// Take a span that begins at pixel `begin` and is not empty.
    void add(uint32_t begin, const RowSpan& span);
    /// Exchange light along the row, then forget its spans. `lights` has one entry a patch.
    void run(std::span<PatchLight> lights, SweepCounters& counters);

private:
    static constexpr uint32_t kNoSpan = 0xffffffffu;

    void change(uint32_t x);
    void sort(uint32_t x);
    uint32_t keep_order(uint32_t begin, uint32_t end);

    std::vector<uint64_t> begins_, events_;  // one bit a pixel
    std::vector<uint32_t> first_;            // span that begins at a pixel, where begins_ says so
    std::vector<RowSpan> spans_, line_;      // of the row; of the present pixel, by depth
};

}  // namespace lumel
