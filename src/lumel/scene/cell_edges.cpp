#include "lumel/scene/cell_edges.h"

#include <algorithm>

namespace lumel {

CellEdges::CellEdges(const Scene& scene, const Lattice& lattice)
    : first_(size_t{scene.patches()} + 1), border_(scene.patches(), {true, true, true}) {
    // Sort all edges by their ends: equal ones are shared.
    struct Edge {
        uint64_t ends;
        uint32_t cell, which;
    };
    std::vector<Edge> edges;
    edges.reserve(size_t{scene.patches()} * 3);
    for (uint32_t cell = 0; cell < scene.patches(); ++cell) {
        const auto corners = lattice.corners(cell);
        for (uint32_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(corners[k], corners[(k + 1) % 3]);
            edges.push_back({uint64_t{a} << 32 | b, cell, k});
        }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.ends != b.ends ? a.ends < b.ends : a.cell < b.cell; });

    // List who meets whom.
    std::vector<std::array<uint32_t, 2>> meetings;
    for (size_t i = 0; i < edges.size(); ++i)
        for (size_t j = i + 1; j < edges.size() && edges[j].ends == edges[i].ends; ++j) {
            meetings.push_back({edges[i].cell, edges[j].cell}), meetings.push_back({edges[j].cell, edges[i].cell});
            border_[edges[i].cell][edges[i].which] = border_[edges[j].cell][edges[j].which] = false;
        }
    std::sort(meetings.begin(), meetings.end());
    neighbours_.reserve(meetings.size());
    for (const auto& [cell, other] : meetings) ++first_[cell + 1], neighbours_.push_back(other);
    for (size_t cell = 0; cell + 1 < first_.size(); ++cell) first_[cell + 1] += first_[cell];
}

}  // namespace lumel
