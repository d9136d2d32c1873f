// Parts of a round lamp by where they face.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lumel/math/vec_array.h"

namespace lumel {

/// From any point most of a round lamp is hidden by the lamp itself, or seen at a slant: points are chosen on what faces there. A facet
/// holds the triangles whose normals fall into one cell of a cube, 3 x 3 on each of its sides. A lamp with few triangles, or flat, has
/// none.
class LampFacets {
public:
    static constexpr uint32_t kCells = 54, kRoom = padded(kCells);
    /// The cell of a unit normal.
    static uint32_t cell(Vec3 normal);

    uint32_t size() const { return size_; }
    /// Add the facet of a cell: its triangles, which are those from `first` on of its lamp's, have `area`, the mean normal of length 1 and
    /// make at most the angle of cosine `spread` with it.
    void add(uint32_t cell, uint32_t first, float area, Vec3 normal, float spread);
    /// Index among the triangles of the lamp of the first of a facet.
    uint32_t first(uint32_t facet) const { return first_[facet]; }
    float area(uint32_t facet) const { return area_[facet]; }
    uint32_t of_cell(uint32_t cell) const { return of_cell_[cell]; }

    /// About what each facet sends to where it is seen from, never 0 where there may be something.
    struct Weights {
        std::array<float, kRoom> weight;
        float total = 0;
    };
    /// `to`: from the centre of the lamp; `radius`: of the lamp. From within that, all may face there.
    Weights weights(Vec3 to, float radius) const;

private:
    uint32_t size_ = 0;
    std::vector<float> x_, y_, z_, cos_, sin_, area_;  // normals, the spread around them; padded with facets of no area
    std::vector<uint32_t> first_;
    std::array<uint8_t, kCells> of_cell_{};
};

inline uint32_t LampFacets::cell(Vec3 n) {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const int axis = z > std::max(x, y) ? 2 : y > x ? 1 : 0;
    const float over = 1 / std::max(x, std::max(y, z));
    const auto third = [&](float at) { return static_cast<uint32_t>(std::clamp(1.5f * (at * over + 1), 0.0f, 2.0f)); };
    const auto side = static_cast<uint32_t>(2 * axis) + (n[axis] < 0 ? 1u : 0u);
    return 9 * side + 3 * third(n[(axis + 1) % 3]) + third(n[(axis + 2) % 3]);
}

inline void LampFacets::add(uint32_t cell, uint32_t first, float area, Vec3 normal, float spread) {
    const uint32_t room = padded(size_ + 1);
    for (std::vector<float>* all : {&x_, &y_, &z_, &cos_, &sin_, &area_}) all->resize(room);
    x_[size_] = normal.x, y_[size_] = normal.y, z_[size_] = normal.z, area_[size_] = area;
    cos_[size_] = spread, sin_[size_] = std::sqrt(std::max(0.0f, 1 - spread * spread));
    first_.push_back(first);
    of_cell_[cell] = static_cast<uint8_t>(size_++);
}

inline LampFacets::Weights LampFacets::weights(Vec3 to, float radius) const {
    constexpr float kLeastSpread = 1e-3f, kLeast = 0.01f;
    const float d = length(to);
    Weights found;
    if (!(d > radius)) {
        for (uint32_t i = 0; i < size_; ++i) found.total += found.weight[i] = area_[i];
        return found;
    }
    const float sin_p = radius / d, cos_p = std::sqrt(1 - sin_p * sin_p), unknown = std::max(sin_p * sin_p, kLeast);
    const Vec3 w = to / d;
    const float *nx = x_.data(), *ny = y_.data(), *nz = z_.data(), *cosine = cos_.data(), *sine = sin_.data(), *area = area_.data();
    const uint32_t count = padded(size_);
    for (uint32_t i = 0; i < count; ++i) {
        // Normals spread around the mean, and directions to x around that from the centre. All that may face x has -s < c.
        const float c = nx[i] * w.x + ny[i] * w.y + nz[i] * w.z, sum = sine[i] * cos_p + cosine[i] * sin_p;
        const float s = cosine[i] * cos_p - sine[i] * sin_p > 0 ? std::max(sum, kLeastSpread) : 1.0f, above = c + s;
        // The mean of cosines that spread evenly from c - s to c + s, those below 0 as 0. The nearer x, the less is known of them.
        const float cosine_seen = c > s ? c : above * above / (4 * s);
        found.weight[i] = area[i] * (above > 0 ? (1 - unknown) * cosine_seen + unknown : 0.0f);
    }
    for (uint32_t i = 0; i < size_; ++i) found.total += found.weight[i];
    return found;
}

}  // namespace lumel
