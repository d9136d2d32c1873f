// What walls make of a side that they stand across: convex parts that have no light in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "lumel/scene/patch_place.h"

namespace lumel {

/// Where a wall stands on a triangle: a u + b v + c is 0 there, with barycentrics (u, v), and of the same sign on one side of it.
struct WallLine {
    float a = 0, b = 0, c = 0;

    float at(Square p) const { return a * p.u + b * p.v + c; }
};

/// A convex polygon in the barycentrics of a patch.
class PartPolygon {
public:
    /// The whole patch.
    PartPolygon() : size_(3), corner_{{{0, 0}, {1, 0}, {0, 1}}} {}

    /// Keep what lies where `values`, given at the corners of the patch and linear over it, are positive, or where they are not.
    void keep(const std::array<float, 3>& values, bool positive);
    /// Its area over that of the patch.
    float share() const;
    /// A point that is uniform by area for a uniform `s`.
    Square point(Square s) const;

private:
    static constexpr uint32_t kMost = 8;
    float share_of_fan(uint32_t k) const;

    uint32_t size_;
    std::array<Square, kMost> corner_{};
};

/// The parts of one side, numbered by the signs of its lines. Lines go on to the edges of the patch: walls that end before only make more
/// parts than there need be.
class PatchParts {
public:
    static constexpr uint32_t kLines = 3, kParts = 1u << kLines;
    static constexpr float kLeast = 1e-4f;  ///< of the patch: smaller parts belong to another one

    explicit PatchParts(uint32_t side) : side_(side) {}

    /// Add a line, if it divides the patch, there is room for it, and it is not there yet. `corners`: of the patch.
    void add(WallLine line, const PatchCorners& corners);

    uint32_t side() const { return side_; }
    bool divides() const { return lines_ > 0; }
    /// The part of a point, given in its triangle.
    uint32_t part_of(Square p) const {
        uint32_t part = 0;
        for (uint32_t i = 0; i < lines_; ++i) part |= static_cast<uint32_t>(line_[i].at(p) > 0) << i;
        return owner_[part];
    }
    /// Area of a part over that of the patch; 0 where there is no such part.
    float share(uint32_t part) const { return share_[part]; }
    PartPolygon polygon(uint32_t part) const;

private:
    void find_shares();

    uint32_t side_, lines_ = 0;
    std::array<WallLine, kLines> line_{};
    std::array<std::array<float, 3>, kLines> at_corner_{};  // values of the lines, 1 at most
    std::array<float, kParts> share_{1};
    std::array<uint8_t, kParts> owner_{};
};

}  // namespace lumel
