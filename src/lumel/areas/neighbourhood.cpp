#include "lumel/areas/neighbourhood.h"

#include "lumel/scene/surface.h"

namespace lumel {

namespace {

/// Turn lists of three numbers an area into lists of areas a number: `first` has one entry more than there are numbers.
void invert(const std::vector<std::array<uint32_t, 3>>& numbers, uint32_t count, std::vector<uint32_t>& first,
            std::vector<uint32_t>& areas) {
    first.assign(size_t{count} + 1, 0);
    for (const auto& three : numbers)
        for (uint32_t number : three) ++first[number + 1];
    for (uint32_t number = 0; number < count; ++number) first[number + 1] += first[number];
    areas.resize(first.back());
    std::vector<uint32_t> at(first.begin(), first.end() - 1);
    for (uint32_t area = 0; area < numbers.size(); ++area)
        for (uint32_t number : numbers[area]) areas[at[number]++] = area;
}

}  // namespace

Neighbourhood::Neighbourhood(const Scene& scene, const Lattice& lattice, const PatchAreas& areas)
    : slot_(size_t{lattice.size()} * 2, Scene::kNone) {
    // Number the vertices of all measured sides, and note the slots and the places of the corners of each.
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
        }
        places_.push_back(places);
        normal_.push_back(Surface(scene, scene.centre_of_patch(patch), back).shading);
        material_.push_back(scene.material_index(scene.triangle_of_patch(patch)));
    }
    invert(slots_of, slots, first_own_, own_);
    invert(places_, 2 * lattice.places(), first_at_place_, at_place_);
}

}  // namespace lumel
