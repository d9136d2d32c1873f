#include "lumel/scene/tessellation.h"

#include <stdexcept>

#include "lumel/math/vec.h"

namespace lumel {

namespace {

constexpr double kMostDivisions = 4096;

double divisions(double area, double patch_area) { return std::clamp(std::round(std::sqrt(area / patch_area)), 1.0, kMostDivisions); }

}  // namespace

Tessellation::Tessellation(std::span<const uint16_t> divisions) {
    grids_.reserve(divisions.size());
    cells_.reserve(divisions.size());
    for (uint32_t t = 0; t < divisions.size(); ++t) {
        grids_.push_back({t, 1});
        cells_.push_back({0, t, divisions[t]});
    }
    number_patches();
}

Tessellation::Tessellation(const Tessellation& uniform, std::span<const uint8_t> divisions) {
    for (uint32_t t = 0; t < uniform.grids_.size(); ++t) {
        grids_.push_back({static_cast<uint32_t>(cells_.size()), uniform.cells_[t].divisions});
        const uint32_t first = uniform.first_patch(t);
        for (uint32_t k = 0; k < uniform.count(t); ++k) cells_.push_back({0, t, divisions[first + k]});
    }
    number_patches();
}

void Tessellation::number_patches() {
    uint64_t count = 0;
    for (Cell& cell : cells_) {
        cell.first_patch = static_cast<uint32_t>(count);
        count += uint64_t{cell.divisions} * cell.divisions;
        if (count > 0x7fffffffu) throw std::invalid_argument("the scene has more than 2^31 patches");
    }
    patch_cell_.reserve(count);
    for (uint32_t c = 0; c < cells(); ++c) patch_cell_.insert(patch_cell_.end(), size_t{cells_[c].divisions} * cells_[c].divisions, c);
}

void Tessellation::patches_of(const uint32_t* __restrict triangle, const float* __restrict u, const float* __restrict v, uint32_t count,
                              uint32_t* __restrict patch) const {
    for (uint32_t i = 0; i < count; ++i) patch[i] = patch_of(triangle[i], u[i], v[i]);
}

Square Tessellation::lattice_point(uint32_t cell, uint32_t i, uint32_t j) const {
    const uint32_t n = cells_[cell].divisions;
    const Grid& grid = grids_[cells_[cell].triangle];
    const PatchPlace place = PatchPlace::of_index(grid.cells, cell - grid.first_cell);
    const uint32_t column = place.inverted ? (place.i + 1) * n - i : place.i * n + i,
                   row = place.inverted ? (place.j + 1) * n - j : place.j * n + j;
    const auto all = static_cast<float>(grid.cells * n);
    return {static_cast<float>(column) / all, static_cast<float>(row) / all};
}

PatchCorners Tessellation::corners(uint32_t patch) const {
    PatchCorners c;
    const auto points = place_in_cell(patch).lattice();
    for (size_t k = 0; k < 3; ++k) c[k] = lattice_point(patch_cell_[patch], points[k][0], points[k][1]);
    return c;
}

std::vector<uint16_t> divisions_by_area(std::span<const float> areas, uint64_t patches) {
    double total = 0;
    for (float area : areas) total += area;
    std::vector<uint16_t> n(areas.size(), 1);
    if (!(total > 0)) return n;

    // The count falls with the patch area: bisect its logarithm.
    double low = std::log(total) - 60, high = std::log(total) + 1;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high), patch_area = std::exp(middle);
        double count = 0;
        for (float area : areas) count += sqr(static_cast<float>(divisions(area, patch_area)));
        (count > static_cast<double>(patches) ? low : high) = middle;
    }
    for (size_t t = 0; t < areas.size(); ++t) n[t] = static_cast<uint16_t>(divisions(areas[t], std::exp(high)));
    return n;
}

}  // namespace lumel
