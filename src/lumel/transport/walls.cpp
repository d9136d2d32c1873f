#include "lumel/transport/walls.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr float kFlat = 0.9999f, kOffPlane = 1e-3f;  // of sides in one plane: cosine of their normals, and slope from one to the other
constexpr float kInset = 1e-3f;  // of looks along the edges, of the patch: walls often stand right on these

/// The line in which the plane of triangle `wall` meets that of `triangle`.
WallLine line_of(const Scene& scene, uint32_t wall, uint32_t triangle) {
    const Vec3 normal = scene.geometric_normal(wall), on = scene.vertices()[scene.indices()[wall][0]];
    std::array<double, 3> value;
    for (int k = 0; k < 3; ++k) {
        const Vec3 x = scene.vertices()[scene.indices()[triangle][k]];
        value[k] = double{normal.x} * (double{x.x} - double{on.x}) + double{normal.y} * (double{x.y} - double{on.y}) +
                   double{normal.z} * (double{x.z} - double{on.z});
    }
    return {static_cast<float>(value[1] - value[0]), static_cast<float>(value[2] - value[0]), static_cast<float>(value[0])};
}

PatchParts parts_of(const Accel& accel, uint32_t side) {
    const Scene& scene = accel.scene();
    const uint32_t patch = scene.patch_of_side(side), triangle = scene.triangle_of_side(side);
    const PatchCorners corners = scene.tessellation().corners(patch);
    std::array<Vec3, 3> corner;
    for (uint32_t k = 0; k < 3; ++k) {
        const Square b{k == 1 ? 1 - 2 * kInset : kInset, k == 2 ? 1 - 2 * kInset : kInset};
        corner[k] = Surface(scene, scene.point_on_patch(patch, b), scene.is_back(side)).off(scene.epsilon());
    }
    PatchParts parts(side);
    for (uint32_t k = 0; k < 3; ++k)
        for (uint32_t other : {(k + 1) % 3, (k + 2) % 3}) {
            const Hit hit = accel.intersect({corner[k], corner[other] - corner[k], 1.0f});
            if (!hit.is_miss()) parts.add(line_of(scene, hit.triangle, triangle), corners);
        }
    return parts;
}

/// Do two sides lie in one plane and not see each other?
bool has_wall_between(const Accel& accel, uint32_t a, uint32_t b) {
    const Scene& scene = accel.scene();
    if (!scene.scatters(a) || !scene.scatters(b)) return false;
    const auto centre = [&](uint32_t side) {
        return Surface(scene, scene.centre_of_patch(scene.patch_of_side(side)), scene.is_back(side));
    };
    const Surface x = centre(a), y = centre(b);
    const Vec3 way = y.x - x.x;
    if (!(dot(x.normal, y.normal) > kFlat) || !(std::abs(dot(x.normal, way)) <= kOffPlane * length(way))) return false;
    return !accel.visible(x.off(scene.epsilon()), y.off(scene.epsilon()));
}

}  // namespace

std::vector<PatchParts> find_parts(const Accel& accel) {
    const Scene& scene = accel.scene();
    std::vector<PatchParts> parts;
    for (uint32_t side = 0; side < scene.sides(); ++side)
        if (scene.cover(side).divides) parts.emplace_back(side);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, parts.size(), 64), [&](const auto& range) {
        const FlushDenormals flush;
        for (size_t i = range.begin(); i < range.end(); ++i) parts[i] = parts_of(accel, parts[i].side());
    });
    std::erase_if(parts, [](const PatchParts& p) { return !p.divides(); });
    return parts;
}

std::vector<uint32_t> walls_in_order(const Accel& accel) {
    const Scene& scene = accel.scene();
    const SideOrder& order = scene.side_order();
    std::vector<uint8_t> is_wall(order.size());
    tbb::parallel_for(tbb::blocked_range<uint32_t>(1, order.size(), 1024), [&](const auto& range) {
        const FlushDenormals flush;
        for (uint32_t i = range.begin(); i < range.end(); ++i)
            is_wall[i] = !order.starts_run(i) && has_wall_between(accel, order.side(i - 1), order.side(i));
    });
    std::vector<uint32_t> positions;
    for (uint32_t i = 0; i < order.size(); ++i)
        if (is_wall[i]) positions.push_back(i);
    return positions;
}

}  // namespace lumel
