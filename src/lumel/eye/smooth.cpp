#include "lumel/eye/smooth.h"

#include <tbb/parallel_for.h>

#include "lumel/eye/smooth_level.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr uint32_t kBlock = 1024;  // sides, for one thread

/// Which patches have a corner at every place.
NodeLists patches_of_places(const Scene& scene, const Lattice& lattice) {
    std::vector<uint32_t> first(size_t{lattice.places()} + 1);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch)
        for (uint32_t vertex : lattice.corners(patch)) ++first[lattice.place(vertex) + 1];
    for (uint32_t place = 0; place < lattice.places(); ++place) first[place + 1] += first[place];
    std::vector<uint32_t> patches(first.back()), at(first.begin(), first.end() - 1);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch)
        for (uint32_t vertex : lattice.corners(patch)) patches[at[lattice.place(vertex)]++] = patch;
    NodeLists lists;
    for (uint32_t place = 0; place < lattice.places(); ++place)
        lists.add({patches.data() + first[place], patches.data() + first[place + 1]});
    return lists;
}

std::vector<SmoothNode> nodes_of_sides(const Scene& scene, const SideField& field) {
    std::vector<SmoothNode> nodes(scene.sides());
    tbb::parallel_for(uint32_t{0}, scene.sides(), [&](uint32_t side) {
        if (!scene.scatters(side)) return;
        const uint32_t patch = scene.patch_of_side(side);
        const Surface x(scene, scene.centre_of_patch(patch), scene.is_back(side));
        // The mean square distance from the centre of a triangle that has equal edges.
        const double spread2 = double{scene.patch_area(patch)} / (3 * std::sqrt(3.0));
        nodes[side] = {x.x,
                       x.shading,
                       double{scene.side_area(side)},
                       to_double(field.mean[side]),
                       double{sqr(lum(square_root(field.variance[side])))},
                       spread2};
    });
    return nodes;
}

/// Sides on the same face that share a place and face about the same way, itself among them.
NodeLists touching_sides(const Scene& scene, const Lattice& lattice, const std::vector<SmoothNode>& nodes) {
    const NodeLists at_place = patches_of_places(scene, lattice);
    std::vector<NodeLists> blocks((scene.sides() + kBlock - 1) / kBlock);
    tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t block) {
        std::vector<uint32_t> found;
        const auto first = static_cast<uint32_t>(block * kBlock);
        for (uint32_t side = first; side < std::min(first + kBlock, scene.sides()); ++side) {
            found.clear();
            const uint32_t patch = scene.patch_of_side(side), face = scene.is_back(side) ? scene.patches() : 0;
            for (uint32_t vertex : lattice.corners(patch))
                for (uint32_t other : at_place.of(lattice.place(vertex)))
                    if (nodes[side].area > 0 && nodes[other + face].area > 0 && are_alike(nodes[side], nodes[other + face]) &&
                        std::find(found.begin(), found.end(), other + face) == found.end())
                        found.push_back(other + face);
            blocks[block].add(found);
        }
    });
    NodeLists touching;
    for (const NodeLists& block : blocks) touching.add(block);
    return touching;
}

}  // namespace

SideField smoothed(const Scene& scene, const Lattice& lattice, const SideField& field) {
    std::vector<SmoothNode> nodes = nodes_of_sides(scene, field);
    NodeLists touching = touching_sides(scene, lattice, nodes);
    const std::vector<LinearLight> lights = SmoothLevel(std::move(nodes), std::move(touching)).smooth();
    SideField smooth = field;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        if (!scene.scatters(side)) continue;
        const Rgb light = lights[side].light.to_float();
        smooth.mean[side] = {std::max(0.0f, light.x), std::max(0.0f, light.y), std::max(0.0f, light.z)};
        // Errors have the colour of the light.
        const float value = lum(smooth.mean[side]);
        const Rgb error = value > 0 ? smooth.mean[side] * (static_cast<float>(std::sqrt(lights[side].variance)) / value) : Rgb{};
        smooth.variance[side] = error * error;
    }
    return smooth;
}

}  // namespace lumel
