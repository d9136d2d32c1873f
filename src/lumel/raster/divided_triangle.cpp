#include "lumel/raster/divided_triangle.h"

namespace lumel {

DividedTriangle::DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch)
    : n_(static_cast<int32_t>(n)), first_patch_(first_patch) {
    const auto& [a, b, c] = corners;
    add_family(0, a, b, a, c), add_family(1, a, c, a, b), add_family(2, a, b, b, c);
}

/// Lines in the direction between two corners, the first through `a`, the last through `last`.
void DividedTriangle::add_family(int k, const SnappedVertex& a, const SnappedVertex& last, const SnappedVertex& from,
                                 const SnappedVertex& to) {
    // Turn the lines upward, those along rows to the left: then what is beyond a line is right of it, or above.
    double dx = to.x - from.x, dy = to.y - from.y;
    if (dy < 0 || (dy == 0 && dx > 0)) dx = -dx, dy = -dy;
    const double between = (last.x - a.x) * dy - dx * (last.y - a.y);
    start_[k] = n_ * (a.x * dy - dx * a.y), growth_[k] = n_ * kSubpixels * dx;
    between_[k] = std::abs(between), is_down_[k] = between < 0 ? -1 : 0;
    denominator_[k] = n_ * kSubpixels * dy;
}

uint32_t DividedTriangle::cut(int32_t row, uint32_t begin, uint32_t end, int32_t* steps) const {
    // Find the lines from which the first pixel and the last are met, all families side by side.
    const Lanes start = start_ + row * growth_;
    Lanes first = (begin * denominator_ - start) / between_, last = ((end - 1) * denominator_ - start) / between_;
    round_down(first), round_down(last);
    const IntLanes line = to_int(first) ^ is_down_, count = to_int(last - first);
    const Lanes next = start + (first + 1) * between_, beyond = end + Lanes{};

    // The number of the patch is that of PatchPlace::index: it changes by one over lines of u and u + v, and by ever less over those of v.
    const int32_t i = line[0], j = line[1], both = line[2];
    const IntLanes step = (IntLanes{1, 2 * (n_ - j) - 1, 1, 0} ^ is_down_) - is_down_ - IntLanes{0, 1, 0, 0};
    constexpr std::array growth{0, -2, 0};
    for (int k = 0; k < 3; ++k) {
        // Cross lines four at a time; those after the last count at `end`.
        Lanes numerator = next[k] + Lanes{0, 1, 2, 3} * between_[k];
        int32_t grows_by = step[k];
        for (int32_t left = count[k]; left > 0; left -= kLanes, numerator += kLanes * between_[k]) {
            Lanes column = numerator / denominator_[k];
            round_up(column);
            column = column < beyond ? column : beyond;
            const auto at = reinterpret_cast<UintLanes>(to_int(column));
            for (uint32_t lane = 0; lane < kLanes; ++lane, grows_by += growth[k]) steps[at[lane]] += grows_by;
        }
    }
    return first_patch_ + static_cast<uint32_t>(j * (2 * n_ - 1 - j) + i + both);
}

}  // namespace lumel
