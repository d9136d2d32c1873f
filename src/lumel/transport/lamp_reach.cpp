#include "lumel/transport/lamp_reach.h"

#include "lumel/sampling/hash.h"
#include "lumel/sampling/sobol.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kPoint = 1, kDirection };

/// A ray of an area lamp, uniform over its area and cosine-weighted.
Ray from_area(const Scene& scene, const AreaLamp& lamp, uint32_t i, uint32_t samples, uint64_t stream) {
    const uint32_t triangle = lamp.triangles[lamp.by_area.find((i + 0.5) / samples * lamp.by_area.total())];
    const Square b = square_to_triangle(sobol2d(i, key(stream, kPoint)));
    const Surface y(scene, {triangle, b.u, b.v}, false);
    return {y.off(scene.epsilon()), Frame(y.normal).to_world(square_to_cosine_hemisphere(sobol2d(i, key(stream, kDirection))))};
}

template <class Launch>
LampReach reach(const Accel& accel, uint32_t samples, Launch&& launch) {
    LampReach r{std::vector<float>(accel.scene().shapes())};
    const float share = 1.0f / static_cast<float>(samples);
    for (uint32_t i = 0; i < samples; ++i) {
        const Hit hit = accel.intersect(launch(i));
        (hit.is_miss() ? r.escaped : r.onto[accel.scene().shape(hit.triangle)]) += share;
    }
    return r;
}

}  // namespace

std::vector<LampReach> lamp_reach(const Accel& accel, uint32_t samples, uint64_t stream) {
    const FlushDenormals flush;
    const Scene& scene = accel.scene();
    std::vector<LampReach> all;
    for (const AreaLamp& lamp : scene.area_lamps())
        all.push_back(reach(accel, samples, [&](uint32_t i) { return from_area(scene, lamp, i, samples, key(stream, all.size())); }));
    for (const PointLamp& lamp : scene.point_lamps())
        all.push_back(
            reach(accel, samples, [&](uint32_t i) { return Ray{lamp.position, square_to_sphere(sobol2d(i, key(stream, all.size())))}; }));
    return all;
}

}  // namespace lumel
