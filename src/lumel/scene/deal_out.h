// How many patches every cell gets: a budget dealt out to where each patch takes away most of the error.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/scene/cell_edges.h"

namespace lumel {

inline constexpr uint8_t kMostDivisions = 8;  ///< of a cell

/// Divisions (1, 2, 4 or 8) of every cell such that there are at most `patches` patches, or one a cell, and those of neighbours differ
/// by no more than a factor of 2. `error`: the squared error of each cell while it is undivided, 0 or more, in any unit; it is taken to
/// fall as divisions^-3.
std::vector<uint8_t> deal_out(const CellEdges& edges, std::span<const double> error, uint64_t patches);

}  // namespace lumel
