#include "lumel/scene/closed_surfaces.h"

#include <bit>
#include <numeric>
#include <unordered_map>

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

struct PlaceHash {
    size_t operator()(Vec3 v) const {
        // Both zeros are one place.
        const auto bits = [](float x) { return uint64_t{std::bit_cast<uint32_t>(x + 0.0f)}; };
        return key(bits(v.x), bits(v.y), bits(v.z));
    }
};

/// An edge of a triangle, by the places of its ends.
struct Edge {
    uint32_t low = 0, high = 0, triangle = 0;
    int way = 0;  ///< +1 from low to high, -1 back, 0 without length
};

std::vector<Edge> sorted_edges(const Scene& scene) {
    std::unordered_map<Vec3, uint32_t, PlaceHash> places;
    std::vector<Edge> edges;
    edges.reserve(size_t{scene.triangles()} * 3);
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        std::array<uint32_t, 3> corner{};
        for (size_t k = 0; k < 3; ++k)
            corner[k] = places.try_emplace(scene.vertices()[scene.indices()[t][k]], static_cast<uint32_t>(places.size())).first->second;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = corner[k], b = corner[(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), t, a < b ? 1 : a > b ? -1 : 0});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
        return l.low != r.low ? l.low < r.low : l.high != r.high ? l.high < r.high : l.triangle < r.triangle;
    });
    return edges;
}

}  // namespace

std::vector<uint32_t> closed_surfaces(const Scene& scene) {
    // Triangles that share an edge are of one surface: join them under the least of their numbers.
    std::vector<uint32_t> parent(scene.triangles());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](uint32_t t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    const std::vector<Edge> edges = sorted_edges(scene);
    std::vector<uint32_t> open;
    for (size_t first = 0, last = 0; first < edges.size(); first = last) {
        int balance = 0;
        for (; last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high; ++last) {
            balance += edges[last].way;
            const uint32_t a = root(edges[first].triangle), b = root(edges[last].triangle);
            parent[std::max(a, b)] = std::min(a, b);
        }
        if (balance != 0) open.push_back(edges[first].triangle);
    }

    // One unmatched edge opens the whole surface.
    for (uint32_t t = 0; t < scene.triangles(); ++t) parent[t] = root(t);
    std::vector<bool> is_open(scene.triangles());
    for (uint32_t t : open) is_open[parent[t]] = true;
    std::vector<uint32_t> number(scene.triangles());
    for (uint32_t t = 0; t < scene.triangles(); ++t) number[t] = is_open[parent[t]] ? Scene::kNone : parent[t];
    return number;
}

}  // namespace lumel
