#include "lumel/eye/vertex_pool.h"

namespace lumel {

namespace {

constexpr float kDivided = 1e-4f;  // a patch that a wall divides has light of both parts: it counts where nothing else is known

}  // namespace

void VertexPool::pool(const Lattice& lattice) {
    const auto vertices_of = [&](uint32_t side) {
        auto vertices = lattice.corners(scene_->patch_of_side(side));
        for (uint32_t& vertex : vertices) vertex += scene_->is_back(side) ? lattice.size() : 0;
        return vertices;
    };
    first_.assign(size_t{lattice.size()} * 2 + 1, 0);
    for (uint32_t side = 0; side < scene_->sides(); ++side)
        for (uint32_t vertex : vertices_of(side)) ++first_[vertex + 1];
    for (uint32_t vertex = 0; vertex < size(); ++vertex) first_[vertex + 1] += first_[vertex];
    entries_.resize(first_.back());
    std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
    for (uint32_t side = 0; side < scene_->sides(); ++side)
        for (uint32_t vertex : vertices_of(side)) {
            const float trust = scene_->cover(side).divides ? kDivided : 1.0f;
            const uint32_t on_face = vertex - (scene_->is_back(side) ? lattice.size() : 0);
            entries_[at[vertex]++] = {side, trust * scene_->side_area(side) * lattice.weight(on_face, scene_->patch_of_side(side))};
        }
}

std::optional<uint32_t> VertexPool::draw(uint32_t vertex, float choice) const {
    if (const uint32_t hung = hung_[vertex]; hung != Scene::kNone) {
        const bool second = choice >= 0.5f;
        vertex = hanging_[hung].ends[second];
        choice = 2 * choice - static_cast<float>(second);
    }
    float sum = 0;
    for (const Entry& entry : of(vertex)) sum += entry.weight;
    if (!(sum > 0)) return {};
    float left = choice * sum;
    for (const Entry& entry : of(vertex))
        if (left -= entry.weight; left < 0) return entry.side;
    return of(vertex).back().side;
}

}  // namespace lumel
