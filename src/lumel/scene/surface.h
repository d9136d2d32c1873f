// A point of a surface as light meets it from one side.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

/// |Ns.wi| / |Ng.wi|: what shading normals do to light that arrives from `wi` by its geometric density (Veach 1997, section 5.3).
/// Bounded, because at grazing angles the quotient is noise.
inline float adjoint(Vec3 shading, Vec3 normal, Vec3 wi) {
    constexpr float kMost = 8;
    const float geometric = dot(normal, wi);
    return geometric > 0 ? std::clamp(dot(shading, wi) / geometric, 0.0f, kMost) : 0.0f;
}

struct Surface {
    Vec3 x;
    Vec3 normal;    ///< geometric, on the side that was met
    Vec3 shading;   ///< shading normal on that side
    const Material* material = nullptr;
    bool scatters = true;  ///< false on the black back of a one-sided surface

    Surface(const Scene& scene, SurfacePoint p, bool back) {
        x = scene.position(p);
        const float sign = back ? -1.0f : 1.0f;
        normal = scene.geometric_normal(p.triangle) * sign;
        shading = scene.is_smooth(p.triangle) ? scene.shading_normal(p) * sign : normal;
        material = &scene.material(p.triangle);
        scatters = !back || material->two_sided;
    }

    /// Start of a ray that leaves on this side.
    Vec3 off(float epsilon) const { return x + normal * epsilon; }
};

}  // namespace lumel
