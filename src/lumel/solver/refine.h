// Patches where the light varies.
#pragma once

#include <span>

#include "lumel/accel/accel.h"
#include "lumel/scene/camera.h"

namespace lumel {

/// Divide the triangles of `scene`, which `accel` was built over, into about `patches` patches anew: small where the light bends, above all
/// in view of a camera. Half of those that there are beyond one a triangle become cells of about equal area, the rest is dealt out to these
/// by a pilot (see Pilot, deal_out). Equal scenes and cameras give equal patches. `first_shot`: direct light is computed apart. Where there
/// is nothing to deal out, the scene stays as it is.
void refine(Scene& scene, const Accel& accel, std::span<const Camera> cameras, uint64_t patches, bool first_shot);

}  // namespace lumel
