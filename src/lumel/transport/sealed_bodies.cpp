#include "lumel/transport/sealed_bodies.h"

#include <map>

namespace lumel {

SealedBodies::SealedBodies(const Scene& scene, const std::vector<uint32_t>& closed, const std::vector<uint8_t>& sealed)
    : scene_(scene), closed_(closed) {
    struct Body {
        Box box;
        double volume = 0;  // > 0: fronts face outwards
        std::array<bool, 2> is_sealed{};  // fronts, backs
    };
    std::map<uint32_t, Body> bodies;
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        if (closed[t] == Scene::kNone) continue;
        std::array<Vec3, 3> corners;
        for (size_t k = 0; k < 3; ++k) corners[k] = scene.vertices()[scene.indices()[t][k]];
        const Box box = around(t, corners);
        Body& body = bodies.try_emplace(closed[t], Body{.box = box}).first->second;
        body.box.lower = min(body.box.lower, box.lower), body.box.upper = max(body.box.upper, box.upper);
        const Vec3 centre = scene.centre();
        body.volume += double{dot(corners[0] - centre, cross(corners[1] - centre, corners[2] - centre))};
        for (size_t back = 0; back < 2; ++back) body.is_sealed[back] |= sealed[size_t{t} * 2 + back] != 0;
    }
    for (const auto& [surface, body] : bodies) {
        const bool inside = body.volume > 0;  // the backs
        everywhere_ |= body.is_sealed[inside ? 0 : 1];
        if (!body.is_sealed[inside ? 1 : 0]) continue;
        boxes_.push_back(body.box);
        widest_ = std::max(widest_, body.box.upper.x - body.box.lower.x);
    }
    std::ranges::sort(boxes_, {}, [](const Box& box) { return box.lower.x; });
}

SealedBodies::Box SealedBodies::around(uint32_t triangle, const std::array<Vec3, 3>& corners) const {
    const float margin = 2 * scene_.epsilon();
    const Vec3 a = min(corners[0], min(corners[1], corners[2])), b = max(corners[0], max(corners[1], corners[2]));
    return {a - Vec3{margin, margin, margin}, b + Vec3{margin, margin, margin}, closed_[triangle]};
}

bool SealedBodies::may_cover(uint32_t patch) const {
    if (everywhere_) return true;
    const PatchCorners at = scene_.tessellation().corners(patch);
    const uint32_t triangle = scene_.triangle_of_patch(patch);
    std::array<Vec3, 3> corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = scene_.position({triangle, at[k].u, at[k].v});
    const Box here = around(triangle, corners);
    const auto first = std::ranges::lower_bound(boxes_, here.lower.x - widest_, {}, [](const Box& box) { return box.lower.x; });
    for (auto box = first; box != boxes_.end() && box->lower.x <= here.upper.x; ++box)
        if (box->surface != here.surface && box->upper.x >= here.lower.x && box->lower.y <= here.upper.y && box->upper.y >= here.lower.y &&
            box->lower.z <= here.upper.z && box->upper.z >= here.lower.z)
            return true;
    return false;
}

}  // namespace lumel
