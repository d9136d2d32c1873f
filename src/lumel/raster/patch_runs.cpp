#include "lumel/raster/patch_runs.h"

namespace lumel {

DividedTriangle::DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch)
    : n_(n), first_patch_(first_patch) {
    const auto& [a, b, c] = corners;
    families_ = {family(a, a, c, b), family(a, a, b, c), family(a, b, c, b)};
}

/// Lines in the direction from `from` to `to`, the first through `a`, the last through `last`.
DividedTriangle::Family DividedTriangle::family(const SnappedVertex& a, const SnappedVertex& from, const SnappedVertex& to,
                                                const SnappedVertex& last) const {
    // Turn them upward, those along rows to the left: then what comes after a line is right of it, or above.
    double dx = to.x - from.x, dy = to.y - from.y;
    if (dy < 0 || (dy == 0 && dx > 0)) dx = -dx, dy = -dy;
    const double n = n_;
    return {.start = n * (a.x * dy - dx * a.y),
            .growth = n * kSubpixels * dx,
            .between = (last.x - a.x) * dy - dx * (last.y - a.y),
            .denominator = n * kSubpixels * dy};
}

DividedTriangle::Cuts DividedTriangle::cuts(const Family& family, int32_t row, uint32_t begin, uint32_t end, uint32_t* columns) {
    // Count the lines that lie before the first pixel, and before the last.
    const double start = family.start + row * family.growth;
    const auto passed = [&](uint32_t x) {
        const double lines = (x * family.denominator - start) / family.between;
        return static_cast<int32_t>(family.between > 0 ? std::floor(lines) : std::ceil(lines) - 1);
    };
    const int32_t first = passed(begin), last = passed(end - 1);

    // The lines between are met on the way.
    const int32_t count = std::abs(last - first), way = first < last ? 1 : -1;
    const double line = start + family.between * (first < last ? first + 1 : first), step = family.between * way;
    for (int32_t k = 0; k < count; ++k) columns[k] = static_cast<uint32_t>(static_cast<int32_t>(std::ceil((line + step * k) / family.denominator)));
    columns[count] = end;
    return {columns, static_cast<uint32_t>(first), static_cast<uint32_t>(way)};
}

uint32_t DividedTriangle::cut(int32_t row, uint32_t begin, uint32_t end, PatchRun* runs, std::vector<uint32_t>& scratch) const {
    scratch.resize(3 * (n_ + 1));
    std::array<Cuts, 3> cuts_of;
    for (size_t k = 0; k < 3; ++k) cuts_of[k] = cuts(families_[k], row, begin, end, &scratch[k * (n_ + 1)]);
    auto [u, v, w] = cuts_of;

    // Go from cut to cut. Of several at one pixel, the patches between have none.
    uint32_t count = 0;
    for (uint32_t x = begin;;) {
        const uint32_t next = std::min({*u.next, *v.next, *w.next});
        // The same as PatchPlace::index, where i + j lines of the third family are passed in upright patches, and one more in inverted ones.
        runs[count] = {next, first_patch_ + v.passed * (2 * n_ - 1 - v.passed) + u.passed + w.passed};
        count += next != x;
        if (next == end) return count;
        for (Cuts* family : {&u, &v, &w}) {
            const bool meets = *family->next == next;
            family->next += meets, family->passed += meets ? family->way : 0;
        }
        x = next;
    }
}

}  // namespace lumel
