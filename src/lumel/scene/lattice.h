// Corners of patches, welded where a surface goes on smoothly: what is known of patches is interpolated between them.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

/// One vertex for all patch corners at one place that have the same material and shading normal.
class Lattice {
public:
    explicit Lattice(const Scene& scene);

    uint32_t size() const { return size_; }
    /// Vertices of the corners of a patch.
    std::array<uint32_t, 3> corners(uint32_t patch) const {
        const uint32_t triangle = scene_->triangle_of_patch(patch), n = scene_->divisions(triangle);
        std::array<uint32_t, 3> ids;
        const auto points = scene_->place(patch).lattice();
        for (int k = 0; k < 3; ++k) ids[k] = vertex_[first_[triangle] + lattice_index(n, points[k][0], points[k][1])];
        return ids;
    }
    /// Vertices at one place have the same number here, however the surface bends there.
    uint32_t place(uint32_t vertex) const { return place_[vertex]; }
    uint32_t places() const { return places_; }
    /// Corners and weights (they sum to 1) that interpolate at a point.
    struct Stencil {
        uint32_t patch;
        std::array<uint32_t, 3> vertex;
        std::array<float, 3> weight;
    };
    Stencil stencil(SurfacePoint p) const;

private:
    const Scene* scene_;
    std::vector<uint32_t> first_;   // per triangle: its first lattice point
    std::vector<uint32_t> vertex_;  // per lattice point: the vertex that it belongs to
    std::vector<uint32_t> place_;   // per vertex
    uint32_t size_ = 0, places_ = 0;
};

}  // namespace lumel
