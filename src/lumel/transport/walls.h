// The walls that stand across patches.
#pragma once

#include "lumel/accel/accel.h"

namespace lumel {

/// Parts for Scene::set_parts, of the sides that something divides (Cover::divides), in their order.
///
/// Light that came to one part of such a side must not leave from another: it would go through the wall. What stands across a patch is
/// found by looks along its edges; the plane of every triangle that they meet is a wall.
std::vector<PatchParts> find_parts(const Accel& accel);

/// Positions in the order of sides whose side lies in one plane with the one before it and does not see it, a wall being between.
std::vector<uint32_t> walls_in_order(const Accel& accel);

}  // namespace lumel
