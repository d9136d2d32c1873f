// What sweeps along directions met.
#pragma once

#include <algorithm>
#include <cstdint>

#include "lumel/math/vec.h"

namespace lumel {

struct SweepCounters {
    uint64_t directions = 0;
    uint64_t fragments = 0;   ///< patches met, summed over all lines
    uint64_t lines = 0;       ///< pixels of the window that hold a fragment
    uint64_t pairs = 0;       ///< neighbours on a line; each carries light both ways
    uint64_t most_depth = 0;  ///< most fragments on one line
    /// Lines that enter and leave closed surfaces unequally often, or have two neighbouring fragments of one closed surface that face the
    /// same way: cracks, self-intersections, and depths that cannot be told apart.
    uint64_t parity_violations = 0;
    // Radiance, summed over pixels; times pixel_area it is W/sr.
    Rgb64 escaped;  ///< sent by sides that see nothing
    Rgb64 mispaired;  ///< exchanged, both ways, between neighbours of one closed surface that face the same way

    SweepCounters& operator+=(const SweepCounters& other) {
        directions += other.directions, fragments += other.fragments, lines += other.lines, pairs += other.pairs;
        most_depth = std::max(most_depth, other.most_depth);
        parity_violations += other.parity_violations;
        escaped += other.escaped, mispaired += other.mispaired;
        return *this;
    }
};

}  // namespace lumel
