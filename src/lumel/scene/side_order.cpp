#include "lumel/scene/side_order.h"

#include <algorithm>
#include <numeric>

#include "lumel/scene/scene.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr float kFarthest = 0.05f;  // between neighbours, of the radius of the scene
constexpr float kAlike = 0.8f;      // cosine between their normals

/// One of six sectors of the sphere: the axis that is nearest.
uint32_t sector(Vec3 n) {
    const Vec3 a{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const uint32_t largest = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    return largest * 2 + (largest == 0 ? n.x < 0 : largest == 1 ? n.y < 0 : n.z < 0);
}

}  // namespace

SideOrder::SideOrder(const Scene& scene) : order_(scene.sides()), starts_run_(scene.sides()) {
    std::vector<uint64_t> kind(scene.sides());
    std::vector<Vec3> normal(scene.sides()), centre(scene.sides());
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        const Surface x(scene, scene.centre_of_patch(scene.patch_of_side(side)), scene.is_back(side));
        normal[side] = x.shading, centre[side] = x.x;
        kind[side] = (uint64_t{scene.material_index(scene.triangle_of_side(side))} << 32 | sector(x.shading) << 1 | scene.is_back(side));
    }
    // Patches are numbered along a curve through the scene already.
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) { return kind[a] != kind[b] ? kind[a] < kind[b] : a < b; });
    for (uint32_t i = 0; i < size(); ++i) {
        const uint32_t a = i > 0 ? order_[i - 1] : 0, b = order_[i];
        starts_run_[i] = i == 0 || kind[a] != kind[b] || length(centre[a] - centre[b]) > kFarthest * scene.radius() ||
                         dot(normal[a], normal[b]) < kAlike;
    }
}

}  // namespace lumel
