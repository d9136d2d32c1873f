// Which cells meet along an edge: the patches of a uniform tessellation, before they are divided further.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lumel/scene/lattice.h"

namespace lumel {

class CellEdges {
public:
    /// `scene` has a uniform tessellation, and `lattice` is its lattice.
    CellEdges(const Scene& scene, const Lattice& lattice);

    uint32_t cells() const { return static_cast<uint32_t>(border_.size()); }
    /// Cells that share an edge with this one along which the surface goes on smoothly, in ascending order.
    std::span<const uint32_t> neighbours(uint32_t cell) const {
        return {neighbours_.data() + first_[cell], neighbours_.data() + first_[cell + 1]};
    }
    /// Whether the edges from each corner to the next have no such neighbour: the surface ends there, or bends.
    std::array<bool, 3> border(uint32_t cell) const { return border_[cell]; }

private:
    std::vector<uint32_t> first_, neighbours_;
    std::vector<std::array<bool, 3>> border_;
};

}  // namespace lumel
