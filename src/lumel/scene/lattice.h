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
        const Tessellation& tessellation = scene_->tessellation();
        return corners_in_cell(tessellation.cell_of(patch), tessellation.place_in_cell(patch));
    }
    /// Vertices at one place have the same number here, however the surface bends there.
    uint32_t place(uint32_t vertex) const { return place_[vertex]; }
    uint32_t places() const { return places_; }
    /// Corners and weights (they sum to 1) that interpolate at a point. A covered corner may have the light from beyond what covers it: its
    /// weight goes to the others, which keeps the field continuous.
    struct Stencil {
        uint32_t patch;
        std::array<uint32_t, 3> vertex;
        std::array<float, 3> weight;
    };
    Stencil stencil(SurfacePoint p, bool back) const;
    /// Give all weight to some corners, if they have any. Returns whether they had.
    static bool keep(Stencil& stencil, const std::array<bool, 3>& corners);

    /// A vertex in the middle of an edge of a coarser cell. A field is linear along that edge, so it has the mean of both ends there.
    struct Hanging {
        uint32_t vertex;
        std::array<uint32_t, 2> ends;
    };
    const std::vector<Hanging>& hanging() const { return hanging_; }
    /// Weight of a patch in what a vertex pools, before the noise of either is asked: 1, but where cells of different divisions n meet n^3.
    /// Times its area that is one over its size, which makes the mean over the six patches around a vertex exact for linear fields.
    float weight(uint32_t vertex, uint32_t patch) const {
        if (graded_.empty() || !graded_[vertex]) return 1;
        const auto n = static_cast<float>(scene_->tessellation().divisions(scene_->tessellation().cell_of(patch)));
        return n * n * n;
    }

private:
    std::array<uint32_t, 3> corners_in_cell(uint32_t cell, const PatchPlace& place) const {
        const uint32_t n = scene_->tessellation().divisions(cell);
        std::array<uint32_t, 3> ids;
        const auto points = place.lattice();
        for (int k = 0; k < 3; ++k) ids[k] = vertex_[first_[cell] + lattice_index(n, points[k][0], points[k][1])];
        return ids;
    }
    std::array<uint32_t, 3> corners_of_cell(uint32_t cell) const;
    /// The vertices along an edge of a cell, from one of its corners to the next.
    std::vector<uint32_t> edge(uint32_t cell, int which) const;
    void find_hanging();

    const Scene* scene_;
    std::vector<uint32_t> first_;  // per cell: its first lattice point
    std::vector<uint32_t> vertex_;  // per lattice point: the vertex that it belongs to
    std::vector<uint32_t> place_;  // per vertex
    std::vector<Hanging> hanging_;
    std::vector<uint8_t> graded_;  // per vertex: cells of different divisions meet; empty in a uniform tessellation
    uint32_t size_ = 0, places_ = 0;
};

}  // namespace lumel
