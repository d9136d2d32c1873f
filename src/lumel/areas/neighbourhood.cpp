#include "lumel/areas/neighbourhood.h"

#include "lumel/scene/surface.h"

namespace lumel {

Neighbourhood::Neighbourhood(const Scene& scene, const Lattice& lattice, const PatchAreas& areas)
    : lattice_(&lattice), slot_(size_t{lattice.size()} * 2, Scene::kNone) {
    // Number the vertices of all measured sides, and note which areas each of them has.
    uint32_t slots = 0;
    std::vector<std::array<uint32_t, 3>> slots_of(areas.size());
    for (uint32_t area = 0; area < areas.size(); ++area) {
        const uint32_t side = areas.sides()[area], patch = scene.patch_of_side(side);
        const bool back = scene.is_back(side);
        const auto corners = lattice.corners(patch);
        std::array<uint32_t, 3> places{};
        for (int k = 0; k < 3; ++k) {
            uint32_t& slot = slot_[corners[k] + (back ? lattice.size() : 0)];
            if (slot == Scene::kNone) slot = slots++;
            slots_of[area][k] = slot;
            places[k] = lattice.place(corners[k]) + (back ? lattice.places() : 0);
            by_place_.push_back({places[k], area});
        }
        places_.push_back(places);
        normal_.push_back(Surface(scene, scene.centre_of_patch(patch), back).shading);
        material_.push_back(scene.material_index(scene.triangle_of_patch(patch)));
    }
    std::sort(by_place_.begin(), by_place_.end(), [](Place a, Place b) { return a.id != b.id ? a.id < b.id : a.area < b.area; });

    // Turn the lists of areas into lists of slots.
    first_own_.assign(size_t{slots} + 1, 0);
    for (const auto& corners : slots_of)
        for (uint32_t slot : corners) ++first_own_[slot + 1];
    for (uint32_t slot = 0; slot < slots; ++slot) first_own_[slot + 1] += first_own_[slot];
    own_.resize(first_own_.back());
    std::vector<uint32_t> at(first_own_.begin(), first_own_.end() - 1);
    for (uint32_t area = 0; area < areas.size(); ++area)
        for (uint32_t slot : slots_of[area]) own_[at[slot]++] = area;
}

std::span<const Neighbourhood::Place> Neighbourhood::at_place(uint32_t id) const {
    const auto begin = std::lower_bound(by_place_.begin(), by_place_.end(), id, [](Place p, uint32_t i) { return p.id < i; });
    auto end = begin;
    while (end != by_place_.end() && end->id == id) ++end;
    return {begin, end};
}

}  // namespace lumel
