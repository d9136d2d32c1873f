// Queries of whole blocks of rays, in Embree's packets.
#pragma once

#include "lumel/accel/accel.h"
#include "lumel/accel/embree.h"

namespace lumel::packets {

/// Closest hits of all rays. `wide`: sixteen at a time where they go similar ways, for processors that hold so many side by side; otherwise
/// eight.
void intersect(RTCScene scene, bool wide, const RayBlock& rays, Coherence coherence, HitBlock& hits);
/// For all rays that are traced, whether anything is met between origin and origin + direction.
void occluded(RTCScene scene, const RayBlock& segments, BlockedBlock& blocked);

}  // namespace lumel::packets
