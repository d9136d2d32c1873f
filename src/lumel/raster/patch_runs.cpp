#include "lumel/raster/patch_runs.h"

namespace lumel {

DividedTriangle::DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch)
    : n_(n),
      first_patch_(first_patch),
      families_{Family(corners[0], corners[1], corners[0], corners[2], n), Family(corners[0], corners[2], corners[0], corners[1], n),
                Family(corners[0], corners[1], corners[1], corners[2], n)} {
    for (size_t k : {1, 2})
        if (families_[k].denominator > families_[steepest_].denominator) steepest_ = k;
}

DividedTriangle::Family::Family(const SnappedVertex& a, const SnappedVertex& last, const SnappedVertex& from, const SnappedVertex& to,
                                double n) {
    // Turn the lines upward, those along rows to the left: then what is beyond a line is right of it, or above.
    double dx = to.x - from.x, dy = to.y - from.y;
    if (dy < 0 || (dy == 0 && dx > 0)) dx = -dx, dy = -dy;
    start = n * (a.x * dy - dx * a.y), growth = n * kSubpixels * dx;
    between = (last.x - a.x) * dy - dx * (last.y - a.y);
    denominator = n * kSubpixels * dy;
}

DividedTriangle::Cuts::Cuts(const Family& family, int32_t row, uint32_t begin, uint32_t end, uint32_t* columns) : next(columns) {
    // Count the lines before the first pixel, and before the last.
    const double start = family.start + row * family.growth;
    const auto lines_before = [&](uint32_t x) {
        const double lines = (x * family.denominator - start) / family.between;
        return static_cast<int32_t>(family.between > 0 ? std::floor(lines) : std::ceil(lines) - 1);
    };
    passed = lines_before(begin);
    const int32_t last = lines_before(end - 1);

    // Those between are met on the way.
    up = family.between > 0, count = static_cast<uint32_t>(std::abs(last - passed));
    const double line = start + (up ? passed + 1 : passed) * family.between, further = up ? family.between : -family.between;
    for (uint32_t k = 0; k < count; ++k) columns[k] = static_cast<uint32_t>(static_cast<int32_t>(std::ceil((line + static_cast<int32_t>(k) * further) / family.denominator)));
    columns[count] = end;
    step = up ? 1 : -1;
}

uint32_t DividedTriangle::cut(int32_t row, uint32_t begin, uint32_t end, PatchRun* runs, std::vector<uint32_t>& scratch) const {
    const size_t most = n_ + 1;
    scratch.resize(3 * most);
    std::array cuts{Cuts(families_[0], row, begin, end, &scratch[0]), Cuts(families_[1], row, begin, end, &scratch[most]),
                    Cuts(families_[2], row, begin, end, &scratch[2 * most])};

    // The same as PatchPlace::index: it changes by one over lines of u and u + v, and by ever less over those of v.
    const int32_t n = static_cast<int32_t>(n_), i = cuts[0].passed, j = cuts[1].passed, k = cuts[2].passed;
    cuts[1].step = cuts[1].up ? 2 * (n - 1 - j) : 2 * (j - n), cuts[1].growth = -2;
    uint32_t patch = first_patch_ + static_cast<uint32_t>(j * (2 * n - 1 - j) + i + k), count = 0, x = begin;
    const auto run_to = [&](uint32_t column) {
        // Of several lines at one pixel, the patches between have none.
        runs[count] = {column, patch};
        count += column != x;
        x = column;
    };
    const auto cross = [&](Cuts& family, bool crosses) {
        family.next += crosses;
        patch += static_cast<uint32_t>(crosses ? family.step : 0);
        family.step += crosses ? family.growth : 0;
    };

    // The rows meet the steepest lines most often. Between two of these each passes two patches, so it meets one line of the other families.
    Cuts main = cuts[steepest_], a = cuts[(steepest_ + 1) % 3], b = cuts[(steepest_ + 2) % 3];
    const bool upright = i + j == k, main_is_first = (upright == (steepest_ == 2)) == main.up;
    if (main_is_first) run_to(*main.next), cross(main, true);
    for (uint32_t others = a.count + b.count; others > 0; --others) {
        const bool is_a = *a.next < *b.next;
        run_to(std::min(*a.next, *b.next)), cross(a, is_a), cross(b, !is_a);
        run_to(*main.next), cross(main, true);
    }
    run_to(end);
    return count;
}

}  // namespace lumel
