// Patches: every triangle is divided into equal cells, and every cell into as many patches as the light on it asks for. Rays meet the
// undivided triangles, so that no division can open a crack.
#pragma once

#include <span>
#include <vector>

#include "lumel/scene/patch_place.h"

namespace lumel {

/// A triangle has b x b **cells**, a cell n x n patches; both by the arithmetic of PatchPlace. Where all triangles are one cell each, the
/// tessellation is uniform. Cells and patches of a triangle are numbered without gaps, in the order of triangles.
class Tessellation {
public:
    /// A point in its cell: (u, v) from the first corner of the cell, along its edges.
    struct InCell {
        uint32_t cell;
        Square at;
    };

    Tessellation() = default;
    /// One cell a triangle, of `divisions` each. Throws std::invalid_argument for more than 2^31 patches, as the next one does.
    explicit Tessellation(std::span<const uint16_t> divisions);
    /// The patches of a uniform tessellation become cells; of `divisions` each, which are powers of two.
    Tessellation(const Tessellation& uniform, std::span<const uint8_t> divisions);

    uint32_t patches() const { return static_cast<uint32_t>(patch_cell_.size()); }
    uint32_t cells() const { return static_cast<uint32_t>(cells_.size()); }
    /// Whether every triangle is one cell.
    bool is_uniform() const { return cells_.size() == grids_.size(); }

    // Triangles
    uint32_t first_patch(uint32_t triangle) const { return cells_[grids_[triangle].first_cell].first_patch; }
    /// Patches of a triangle.
    uint32_t count(uint32_t triangle) const {
        return (triangle + 1 < grids_.size() ? first_patch(triangle + 1) : patches()) - first_patch(triangle);
    }
    InCell locate(uint32_t triangle, float u, float v) const {
        const Grid& grid = grids_[triangle];
        const PatchPlace place = PatchPlace::of_point(grid.cells, u, v);
        const float fu = u * static_cast<float>(static_cast<int32_t>(grid.cells)) - static_cast<float>(static_cast<int32_t>(place.i)),
                    fv = v * static_cast<float>(static_cast<int32_t>(grid.cells)) - static_cast<float>(static_cast<int32_t>(place.j));
        return {grid.first_cell + place.index(grid.cells), {place.inverted ? 1 - fu : fu, place.inverted ? 1 - fv : fv}};
    }
    /// The patch that owns the point (u, v).
    uint32_t patch_of(uint32_t triangle, float u, float v) const {
        const InCell p = locate(triangle, u, v);
        const Cell& cell = cells_[p.cell];
        return cell.first_patch + PatchPlace::of_point(cell.divisions, p.at.u, p.at.v).index(cell.divisions);
    }

    /// The same for `count` points, side by side.
    void patches_of(const uint32_t* __restrict triangle, const float* __restrict u, const float* __restrict v, uint32_t count,
                    uint32_t* __restrict patch) const;

    // Cells
    uint32_t triangle_of_cell(uint32_t cell) const { return cells_[cell].triangle; }
    /// Divisions n of the edges of a cell.
    uint32_t divisions(uint32_t cell) const { return cells_[cell].divisions; }
    uint32_t first_patch_of_cell(uint32_t cell) const { return cells_[cell].first_patch; }
    /// The point of a triangle where the lattice of a cell has column `i` and row `j`.
    Square lattice_point(uint32_t cell, uint32_t i, uint32_t j) const;

    // Patches
    uint32_t cell_of(uint32_t patch) const { return patch_cell_[patch]; }
    uint32_t triangle_of(uint32_t patch) const { return cells_[patch_cell_[patch]].triangle; }
    /// Position of a patch in its cell.
    PatchPlace place_in_cell(uint32_t patch) const {
        const Cell& cell = cells_[patch_cell_[patch]];
        return PatchPlace::of_index(cell.divisions, patch - cell.first_patch);
    }
    /// Patches of the size of this one that its triangle has room for.
    float share(uint32_t patch) const {
        const Cell& cell = cells_[patch_cell_[patch]];
        const auto n = static_cast<uint32_t>(cell.divisions) * grids_[cell.triangle].cells;
        return static_cast<float>(n * n);
    }
    /// Corners in the triangle, which turn like it.
    PatchCorners corners(uint32_t patch) const;

private:
    struct Grid {
        uint32_t first_cell, cells;  // cells along an edge
    };
    struct Cell {
        uint32_t first_patch, triangle, divisions;
    };
    void number_patches();

    std::vector<Grid> grids_;            // per triangle
    std::vector<Cell> cells_;
    std::vector<uint32_t> patch_cell_;
};

/// Divisions n of every triangle such that about `patches` patches of about equal area arise (at least one a triangle); areas in m2.
std::vector<uint16_t> divisions_by_area(std::span<const float> areas, uint64_t patches);

}  // namespace lumel
