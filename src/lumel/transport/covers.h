// What of every side light can reach.
#pragma once

#include "lumel/transport/defensive.h"

namespace lumel {

/// Covers for Scene::set_covers; empty where all is open.
///
/// Where a box stands on a floor, a patch of the floor lies partly under it. What the patch receives came to the open part, and leaves from
/// there: taken as spread over the whole, some of it would leave under the box and be lost, and the open part would be too dark, both by
/// about the size of a patch over that of the scene.
///
/// A face is sealed if it belongs to a closed surface and no light came to it. A point is covered if a ray that leaves it meets a sealed
/// face; the open share of a side is counted at points spread over it. A wall divides a patch, however thin it is, if it stands on two of
/// its edges.
std::vector<Cover> find_covers(const Accel& accel, const DefensiveStarts& starts);

}  // namespace lumel
