#include "lumel/eye/shadow_rays.h"

namespace lumel {

void ShadowRays::cast() {
    BlockedBlock blocked;
    accel_.occluded(rays_, blocked);
    for (uint32_t i = 0; i < rays_.size; ++i)
        if (!blocked[i]) pass_[lights_[i].pixel][lights_[i].layer] += lights_[i].radiance;
    rays_.size = 0;
    lights_.clear();
}

}  // namespace lumel
