// Which measured areas meet at a vertex, and which lie around these.
#pragma once

#include <vector>

#include "lumel/areas/patches.h"
#include "lumel/scene/lattice.h"

namespace lumel {

/// Hits that the neighbours of an area should have together.
inline constexpr uint64_t kEnoughAround = 128;

/// Vertices of the measured sides are numbered as slots; each knows the areas that share it and can look further.
class Neighbourhood {
public:
    Neighbourhood(const Scene& scene, const Lattice& lattice, const PatchAreas& areas);

    uint32_t slots() const { return static_cast<uint32_t>(first_own_.size() - 1); }
    /// Slot of a vertex on one face, or Scene::kNone. Those on backs are numbered behind those on fronts.
    uint32_t slot(uint32_t vertex) const { return slot_[vertex]; }
    /// Areas whose patches share the vertex of a slot.
    std::span<const uint32_t> own(uint32_t slot) const { return {own_.data() + first_own_[slot], own_.data() + first_own_[slot + 1]}; }

    /// Areas around those given, which are left out: ring by ring over patches that touch, of the same material and about the same normal,
    /// until they have hits enough or nothing new is near. If that is too few, whatever their normals. `hits`: of an area.
    template <class Hits>
    std::vector<uint32_t> around(std::span<const uint32_t> centre, const Hits& hits) const;

private:
    static constexpr int kRings = 6;
    static constexpr float kSameSide = 0.9f;  // cosine: about 25 degrees

    std::span<const uint32_t> at_place(uint32_t id) const {
        return {at_place_.data() + first_at_place_[id], at_place_.data() + first_at_place_[id + 1]};
    }
    bool alike(uint32_t a, uint32_t b, float cosine) const { return material_[a] == material_[b] && dot(normal_[a], normal_[b]) >= cosine; }
    /// Rings of areas whose normals make at least `cosine` with that of the first in the centre, and the hits that they have.
    template <class Hits>
    std::vector<uint32_t> rings(std::span<const uint32_t> centre, float cosine, const Hits& hits, uint64_t& sum) const;

    std::vector<uint32_t> slot_, first_own_, own_;
    std::vector<uint32_t> first_at_place_, at_place_;  // areas at every place, each face apart
    std::vector<std::array<uint32_t, 3>> places_;  // per area: the places of its corners
    std::vector<Vec3> normal_;  // per area, on its side
    std::vector<uint32_t> material_;  // per area
};

template <class Hits>
std::vector<uint32_t> Neighbourhood::around(std::span<const uint32_t> centre, const Hits& hits) const {
    uint64_t sum = 0;
    std::vector<uint32_t> found = rings(centre, kSameSide, hits, sum);
    if (sum < kEnoughAround) found = rings(centre, -1, hits, sum);
    return found;
}

template <class Hits>
std::vector<uint32_t> Neighbourhood::rings(std::span<const uint32_t> centre, float cosine, const Hits& hits, uint64_t& sum) const {
    // What was seen in this call bears its number; wide rings hold hundreds of areas, too many to search.
    thread_local std::vector<uint32_t> seen;
    thread_local uint32_t call = 0;
    if (seen.size() < normal_.size() || ++call == 0) seen.assign(normal_.size(), 0), call = 1;
    std::vector<uint32_t> found, edge(centre.begin(), centre.end());
    for (uint32_t area : centre) seen[area] = call;
    sum = 0;
    for (int ring = 0; ring < kRings && !edge.empty() && sum < kEnoughAround; ++ring) {
        std::vector<uint32_t> next;
        for (uint32_t from : edge)
            for (uint32_t place : places_[from])
                for (uint32_t area : at_place(place))
                    if (seen[area] != call && alike(area, centre[0], cosine)) {
                        seen[area] = call, sum += hits(area);
                        next.push_back(area);
                    }
        found.insert(found.end(), next.begin(), next.end());
        edge = std::move(next);
    }
    return found;
}

}  // namespace lumel
