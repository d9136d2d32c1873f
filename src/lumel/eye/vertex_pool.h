// Which sides a vertex of the lattice pools, and in what shares.
#pragma once

#include <optional>
#include <span>

#include "lumel/scene/lattice.h"

namespace lumel {

/// A field has at a vertex the mean of the sides around it, and between vertices it is linear: so at any point it is a mean over sides.
/// Vertices of both faces are numbered together, those of the backs behind those of the fronts.
class VertexPool {
public:
    /// `is_cut`: of a hanging vertex, on the front or the back: whether something stands across its edge, so that it has a value of its
    /// own.
    template <class IsCut>
    VertexPool(const Scene& scene, const Lattice& lattice, const IsCut& is_cut) : scene_(&scene) {
        pool(lattice);
        hung_.assign(size(), Scene::kNone);
        for (const Lattice::Hanging& hanging : lattice.hanging())
            for (bool back : {false, true}) {
                if (is_cut(hanging, back)) continue;
                const uint32_t first = back ? lattice.size() : 0;
                hung_[hanging.vertex + first] = static_cast<uint32_t>(hanging_.size());
                hanging_.push_back({hanging.vertex + first, {hanging.ends[0] + first, hanging.ends[1] + first}});
            }
    }

    struct Entry {
        uint32_t side;
        float weight;  ///< m2
    };
    uint32_t size() const { return static_cast<uint32_t>(first_.size() - 1); }
    std::span<const Entry> of(uint32_t vertex) const { return {entries_.data() + first_[vertex], entries_.data() + first_[vertex + 1]}; }
    /// Vertices that have the mean of two others.
    const std::vector<Lattice::Hanging>& hanging() const { return hanging_; }

    /// A side drawn in proportion to its share in the value of a vertex; nothing where it pools none.
    std::optional<uint32_t> draw(uint32_t vertex, float choice) const;

private:
    void pool(const Lattice& lattice);

    const Scene* scene_;
    std::vector<uint32_t> first_;
    std::vector<Entry> entries_;
    std::vector<uint32_t> hung_;  // per vertex: its number among those that hang
    std::vector<Lattice::Hanging> hanging_;
};

}  // namespace lumel
