// The specular albedo that a target density is normalised by: of those directions alone from which light can arrive.
#pragma once

#include "lumel/math/frame.h"
#include "lumel/sampling/sobol.h"
#include "lumel/scene/ggx.h"
#include "lumel/scene/surface.h"

namespace lumel {

/// Share of the specular albedo at x towards `to_eye` that lies below the triangle, where a shading normal tilts the lobe: no light comes
/// from there. From `samples` directions.
inline float share_below(const Surface& x, Vec3 to_eye, uint32_t samples, uint64_t stream) {
    constexpr float kUntilted = 1 - 1e-6f;  // cosine between the normals
    if (dot(x.normal, x.shading) > kUntilted) return 0;
    const Frame frame(x.shading);
    const Vec3 wo = frame.to_local(to_eye);
    float below = 0, all = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        const Vec3 wi = ggx::sample(wo, x.material->alpha, sobol2d(i, stream));
        if (!(wi.z > 0)) continue;
        const float a = ggx::G1(wi.z, x.material->alpha);
        all += a;
        if (!(dot(x.normal, frame.to_world(wi)) > 0)) below += a;
    }
    return all > 0 ? below / all : 0;
}

/// lum(a_s) at x towards `to_eye`, without what lies below the triangle; 0 where the surface faces away.
inline float lobe_albedo(const Surface& x, Vec3 to_eye, uint32_t samples, uint64_t stream) {
    const float cos = dot(x.shading, to_eye);
    if (!(cos > 0 && dot(x.normal, to_eye) > 0)) return 0;
    return lum(x.material->albedo_s(cos)) * (1 - share_below(x, to_eye, samples, stream));
}

}  // namespace lumel
