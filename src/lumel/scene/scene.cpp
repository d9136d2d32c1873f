#include "lumel/scene/scene.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

constexpr float kHuge = 1e9f;  // m; squares of areas of larger triangles leave the range of float

bool is_finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_huge(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > kHuge; }

/// Spread the lower 10 bits of x three apart.
uint32_t spread3(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

/// Key of a triangle that does not depend on where its indices start or which way they turn.
struct Corners {
    std::array<Vec3, 3> p;
    bool operator==(const Corners&) const = default;
};
struct CornersHash {
    size_t operator()(const Corners& c) const {
        uint64_t h = 0;
        for (Vec3 v : c.p) h = key(h, std::bit_cast<uint32_t>(v.x), std::bit_cast<uint32_t>(v.y), std::bit_cast<uint32_t>(v.z));
        return h;
    }
};
Corners sorted_corners(Vec3 a, Vec3 b, Vec3 c) {
    Corners corners{{a, b, c}};
    std::sort(corners.p.begin(), corners.p.end(), [](Vec3 l, Vec3 r) { return std::array{l.x, l.y, l.z} < std::array{r.x, r.y, r.z}; });
    return corners;
}

}  // namespace

Scene::Scene(const MeshInput& input, std::vector<Material> materials, std::vector<PointLamp> point_lamps, uint64_t patches)
    : shape_material_(input.shape_material.begin(), input.shape_material.end()),
      shape_emission_(input.shape_emission.begin(), input.shape_emission.end()),
      materials_(std::move(materials)),
      point_lamps_(std::move(point_lamps)) {
    for (Material& material : materials_) {
        material.tabulate();
        has_mirrors_ |= material.is_mirror();
    }
    take_triangles(input);
    order_along_curve();
    divide(Tessellation(divisions_by_area(area_, patches)));
    find_lamps();
}

void Scene::take_triangles(const MeshInput& input) {
    report_.given = input.triangles.size();
    vertices_.assign(input.vertices.begin(), input.vertices.end());
    normals_.assign(input.normals.begin(), input.normals.end());
    normals_.resize(vertices_.size());
    lower_ = Vec3{1, 1, 1} * std::numeric_limits<float>::max();
    upper_ = -lower_;
    std::unordered_set<Corners, CornersHash> seen;

    for (size_t t = 0; t < input.triangles.size(); ++t) {
        // Sort out what no ray could meet, or what would poison the sums.
        const Indices i = input.triangles[t];
        if (std::max({i[0], i[1], i[2]}) >= vertices_.size()) {
            ++report_.bad_index;
            continue;
        }
        const Vec3 a = vertices_[i[0]], b = vertices_[i[1]], c = vertices_[i[2]];
        if (!is_finite(a) || !is_finite(b) || !is_finite(c)) {
            ++report_.nonfinite;
            continue;
        }
        if (is_huge(a) || is_huge(b) || is_huge(c)) {
            ++report_.huge;
            continue;
        }
        // A triangle is degenerate if its height is lost in the rounding of its coordinates.
        const Vec3 n = cross(b - a, c - a);
        const float twice_area = length(n);
        const float longest = std::sqrt(std::max({dot(b - a, b - a), dot(c - a, c - a), dot(c - b, c - b)}));
        if (!(twice_area > 1e-7f * longest * longest) || !(twice_area > 0)) {
            ++report_.degenerate;
            continue;
        }
        // Of triangles in the same place rays would meet either: the first stays, and whatever emits.
        if (!seen.insert(sorted_corners(a, b, c)).second && !(max_component(shape_emission_[input.triangle_shape[t]]) > 0)) {
            ++report_.duplicate;
            continue;
        }

        // Interpolated normals must be on the front side, or the triangle is shaded flat.
        const Vec3 normal = n / twice_area;
        bool smooth = true;
        for (uint32_t vertex : i) smooth &= is_finite(normals_[vertex]) && dot(normals_[vertex], normal) > 0.01f * length(normals_[vertex]);
        indices_.push_back(i);
        shape_.push_back(input.triangle_shape[t]);
        normal_.push_back(normal);
        area_.push_back(0.5f * twice_area);
        smooth_.push_back(smooth);
        total_area_ += area_.back();
        for (Vec3 p : {a, b, c}) lower_ = min(lower_, p), upper_ = max(upper_, p);
    }
    if (indices_.empty()) throw std::invalid_argument("the scene has no usable triangle");
    const Vec3 reach = max(-lower_, upper_);
    epsilon_ = 4e-6f * std::max({std::abs(reach.x), std::abs(reach.y), std::abs(reach.z), radius()});
}

void Scene::order_along_curve() {
    // Sort triangles by the Morton code of their centroids, so that neighbours in space are neighbours in memory.
    std::vector<uint32_t> code(triangles()), order(triangles());
    const Vec3 extent = upper_ - lower_;
    for (uint32_t t = 0; t < triangles(); ++t) {
        const Vec3 c = position({t, 1.0f / 3, 1.0f / 3}) - lower_;
        const auto cell = [](float x, float size) {
            return static_cast<uint32_t>(std::clamp(1023.0f * x / std::max(size, 1e-30f), 0.0f, 1023.0f));
        };
        code[t] = spread3(cell(c.x, extent.x)) | spread3(cell(c.y, extent.y)) << 1 | spread3(cell(c.z, extent.z)) << 2;
    }
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
    const auto permute = [&](auto& values) {
        auto sorted = values;
        for (size_t t = 0; t < order.size(); ++t) sorted[t] = values[order[t]];
        values = std::move(sorted);
    };
    permute(indices_);
    permute(shape_);
    permute(normal_);
    permute(area_);
    permute(smooth_);
    plain_.resize(triangles());
    for (uint32_t t = 0; t < triangles(); ++t) plain_[t] = !smooth_[t] && !material(t).is_glossy();
}

void Scene::divide(Tessellation tessellation) {
    tessellation_ = std::move(tessellation);
    covers_.clear();
    set_parts({}, {});
    first_glossy_.assign(triangles(), kNone);
    glossy_patches_ = 0;
    for (uint32_t t = 0; t < triangles(); ++t) {
        if (!material(t).is_glossy()) continue;
        first_glossy_[t] = glossy_patches_;
        glossy_patches_ += tessellation_.count(t);
    }
    side_order_ = SideOrder(*this);
}

void Scene::set_parts(std::vector<PatchParts> parts, std::span<const uint32_t> walls_before) {
    parts_ = std::move(parts);
    parts_of_side_.assign(parts_.empty() ? 0 : sides(), kNone);
    for (uint32_t i = 0; i < parts_.size(); ++i) parts_of_side_[parts_[i].side()] = i;
    side_order_.start_runs(walls_before);
}

void Scene::find_lamps() {
    shape_lamp_.assign(shapes(), -1);
    for (uint32_t t = 0; t < triangles(); ++t) {
        if (!(max_component(emission(t)) > 0)) continue;
        int& lamp = shape_lamp_[shape_[t]];
        if (lamp < 0) {
            lamp = static_cast<int>(area_lamps_.size());
            area_lamps_.push_back({.shape = shape_[t], .radiance = emission(t)});
        }
        AreaLamp& a = area_lamps_[static_cast<size_t>(lamp)];
        a.triangles.push_back(t);
        a.area += area_[t];
        a.centre += position({t, 1.0f / 3, 1.0f / 3}) * area_[t];
        a.normal += normal_[t] * area_[t];
    }
    for (AreaLamp& lamp : area_lamps_) {
        lamp.centre *= 1 / lamp.area;
        lamp.normal *= 1 / lamp.area;
        find_facets(lamp);
        lamp.by_area = Distribution(static_cast<uint32_t>(lamp.triangles.size()), [&](uint32_t i) { return area_[lamp.triangles[i]]; });
        for (uint32_t t : lamp.triangles)
            for (uint32_t vertex : indices_[t]) lamp.radius = std::max(lamp.radius, length(vertices_[vertex] - lamp.centre));
    }
    for (const AreaLamp& lamp : area_lamps_) lamps_.add(lamp.centre, lamp.normal, lamp.radius, lum(lamp.radiance) * lamp.area);
    for (const PointLamp& lamp : point_lamps_) lamps_.add(lamp.position, {}, 0, lum(lamp.intensity));
    std::vector<LampBall> balls;
    balls.reserve(lamps_.size());
    for (uint32_t i = 0; i < lamps_.size(); ++i)
        balls.push_back({{lamps_.x[i], lamps_.y[i], lamps_.z[i]}, lamps_.radius[i], lamps_.power[i]});
    lamp_tree_ = LampTree(balls);
}

void Scene::find_facets(AreaLamp& lamp) const {
    constexpr size_t kFewest = 5;
    if (lamp.triangles.size() < kFewest || length(lamp.normal) > LampArrays::kFlat) return;
    const auto cell_of = [&](uint32_t triangle) { return LampFacets::cell(normal_[triangle]); };
    std::ranges::sort(lamp.triangles, {}, [&](uint32_t triangle) { return std::pair(cell_of(triangle), triangle); });
    for (size_t first = 0, end = 0; first < lamp.triangles.size(); first = end) {
        const uint32_t cell = cell_of(lamp.triangles[first]);
        float area = 0, spread = 1;
        Vec3 normal;
        for (end = first; end < lamp.triangles.size() && cell_of(lamp.triangles[end]) == cell; ++end)
            area += area_[lamp.triangles[end]], normal += normal_[lamp.triangles[end]] * area_[lamp.triangles[end]];
        normal = normalize(normal);
        for (size_t i = first; i < end; ++i) spread = std::min(spread, dot(normal, normal_[lamp.triangles[i]]));
        lamp.facets.add(cell, static_cast<uint32_t>(first), area, normal, spread);
    }
}

SurfacePoint Scene::point_on_patch(uint32_t patch, Square b) const {
    const Square at = within(tessellation_.corners(patch), b);
    return {triangle_of_patch(patch), at.u, at.v};
}

}  // namespace lumel
