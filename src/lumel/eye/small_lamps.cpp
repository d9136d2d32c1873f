#include "lumel/eye/small_lamps.h"

#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

constexpr float kMostRadius = 2;   // pixels
constexpr float kPoints = 16;      // for every pixel that a lamp covers, and sample
constexpr float kFewestPoints = 4; // for a lamp and sample

}  // namespace

SmallLamps::SmallLamps(const Scene& scene, const Camera& camera) : scene_(scene), camera_(camera) {
    const float pixels_of_tan = 0.5f *
                                std::max(static_cast<float>(camera.width) / camera.tan_x, static_cast<float>(camera.height) / camera.tan_y);
    for (const AreaLamp& lamp : scene.area_lamps()) {
        const float depth = dot(lamp.centre - camera.origin, camera.forward) - lamp.radius, radius = lamp.radius / depth * pixels_of_tan;
        if (!(depth > 0) || !(radius < kMostRadius)) continue;
        is_small_.resize(scene.shapes());
        is_small_[lamp.shape] = 1;
        const Vec3 to = lamp.centre - camera.origin;
        const float widest = depth + 2 * lamp.radius;  // of its points, the deepest
        if (std::abs(dot(to, camera.right)) - lamp.radius > widest * camera.tan_x) continue;
        if (std::abs(dot(to, camera.up)) - lamp.radius > widest * camera.tan_y) continue;
        lamps_.push_back({&lamp, std::max(kFewestPoints, kPoints * kPi * sqr(radius))});
    }
    // Very many lamps share as many points as there are eye samples.
    float points = 0;
    for (const Lamp& lamp : lamps_) points += lamp.points;
    const float most = static_cast<float>(camera.width) * static_cast<float>(camera.height);
    if (points > most)
        for (Lamp& lamp : lamps_) lamp.points *= most / points;
}

void SmallLamps::add(const Accel& accel, uint32_t samples, uint64_t stream, std::span<PixelPass> pass) const {
    std::vector<std::vector<Splat>> found(lamps_.size());
    tbb::parallel_for(size_t{0}, lamps_.size(), [&](size_t i) {
        const FlushDenormals flush;
        const float points = std::max(1.0f, static_cast<float>(samples) * lamps_[i].points);
        found[i] = splats(accel, *lamps_[i].lamp, static_cast<uint32_t>(points), key(stream, i));
    });
    for (const std::vector<Splat>& all : found)
        for (const Splat& splat : all) pass[splat.pixel].sum.emission += splat.radiance * static_cast<float>(pass[splat.pixel].samples);
}

std::vector<SmallLamps::Splat> SmallLamps::splats(const Accel& accel, const AreaLamp& lamp, uint32_t points, uint64_t stream) const {
    // Area of a point, over that of a pixel on the plane at distance 1 before the camera.
    const float area = lamp.area / static_cast<float>(points) * static_cast<float>(camera_.width) * static_cast<float>(camera_.height) /
                       (4 * camera_.tan_x * camera_.tan_y);
    std::vector<Splat> all;
    for (uint32_t i = 0; i < points; ++i) {
        const double at = double{sobol2d(i, key(stream, 0)).u} * lamp.by_area.total();
        const uint32_t triangle = lamp.triangles[lamp.by_area.find(at)];
        const Square b = square_to_triangle(sobol2d(i, key(stream, 1)));
        const Vec3 y = scene_.position({triangle, b.u, b.v}) + scene_.geometric_normal(triangle) * scene_.epsilon(),
                   to = y - camera_.origin;
        const float depth = dot(to, camera_.forward), cos = -dot(scene_.geometric_normal(triangle), to);  // times the distance
        const float u = 0.5f + 0.5f * dot(to, camera_.right) / (depth * camera_.tan_x),
                    v = 0.5f - 0.5f * dot(to, camera_.up) / (depth * camera_.tan_y);
        if (!(cos > 0) || !(depth > 0) || !(u >= 0 && u < 1 && v >= 0 && v < 1) || !accel.visible(camera_.origin, y)) continue;
        const auto column = std::min(static_cast<uint32_t>(u * static_cast<float>(camera_.width)), camera_.width - 1),
                   row = std::min(static_cast<uint32_t>(v * static_cast<float>(camera_.height)), camera_.height - 1);
        all.push_back({row * camera_.width + column, lamp.radiance * (area * cos / (depth * depth * depth))});
    }
    return all;
}

}  // namespace lumel
