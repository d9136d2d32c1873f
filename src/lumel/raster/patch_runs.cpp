#include "lumel/raster/patch_runs.h"

#include <cstring>

namespace lumel {

DividedTriangle::DividedTriangle(const std::array<SnappedVertex, 3>& corners, uint32_t n, uint32_t first_patch)
    : n_(n), first_patch_(first_patch) {
    const auto& [a, b, c] = corners;
    add_family(0, a, b, a, c), add_family(1, a, c, a, b), add_family(2, a, b, b, c);
}

/// Lines in the direction between two corners, the first through `a`, the last through `last`.
void DividedTriangle::add_family(size_t k, const SnappedVertex& a, const SnappedVertex& last, const SnappedVertex& from,
                                 const SnappedVertex& to) {
    // Turn the lines upward, those along rows to the left: then what is beyond a line is right of it, or above.
    double dx = to.x - from.x, dy = to.y - from.y;
    if (dy < 0 || (dy == 0 && dx > 0)) dx = -dx, dy = -dy;
    start_[k] = n_ * (a.x * dy - dx * a.y), growth_[k] = n_ * kSubpixels * dx;
    between_[k] = (last.x - a.x) * dy - dx * (last.y - a.y);
    denominator_[k] = n_ * kSubpixels * dy;
    if (denominator_[k] > denominator_[steepest_]) steepest_ = k;
}

/// Count the lines of each family between the first corner and pixel `x` of a row.
IntLanes DividedTriangle::lines_before(double x, const Lanes& start) const {
    // Lines met downward count from the other side: one that the pixel is on is not before it.
    const Lanes lines = (x * denominator_ - start) / between_;
    Lanes up = -lines, down = lines;
    round_up(up), round_up(down);
    return to_int(between_ > 0 ? -up : down - 1);
}

void DividedTriangle::Cuts::find(double first, double further, double denominator, uint32_t end, uint32_t* columns) {
    for (uint32_t k = 0; k < count; k += kLanes) {
        Lanes column = (first + (k + Lanes{0, 1, 2, 3}) * further) / denominator;
        round_up(column);
        const IntLanes whole = to_int(column);
        std::memcpy(columns + k, &whole, sizeof whole);
    }
    columns[count] = end;
    next = columns;
}

uint32_t DividedTriangle::cut(int32_t row, uint32_t begin, uint32_t end, PatchRun* runs, uint32_t* columns) const {
    // Lines that lie between the first pixel and the last are met on the way.
    const Lanes start = start_ + row * growth_;
    const IntLanes before = lines_before(begin, start), before_last = lines_before(end - 1, start);
    std::array<Cuts, 3> cuts;
    for (size_t k = 0; k < 3; ++k) {
        const bool up = between_[k] > 0;
        cuts[k].count = static_cast<uint32_t>(up ? before_last[k] - before[k] : before[k] - before_last[k]);
        cuts[k].step = up ? 1 : ~0u;
        cuts[k].find(start[k] + (up ? before[k] + 1 : before[k]) * between_[k], std::abs(between_[k]), denominator_[k], end,
                     columns + k * (n_ + kLanes));
    }

    // The same as PatchPlace::index: it changes by one over lines of u and u + v, and by ever less over those of v.
    const auto i = static_cast<uint32_t>(before[0]), j = static_cast<uint32_t>(before[1]), both = static_cast<uint32_t>(before[2]);
    cuts[1].step = between_[1] > 0 ? 2 * (n_ - 1 - j) : 2 * (j - n_), cuts[1].growth = ~1u;
    uint32_t patch = first_patch_ + j * (2 * n_ - 1 - j) + i + both;
    PatchRun* run = runs;
    const auto run_to = [&](uint32_t column) { *run++ = {column, patch}; };

    // Rows meet the steepest lines most often. Between two of these they pass two patches, so just one line of the other families.
    Cuts main = cuts[steepest_], a = cuts[steepest_ == 1 ? 0 : 1], b = cuts[steepest_ == 2 ? 0 : 2];
    const auto cross_main = [&] {
        run_to(*main.next++);
        patch += main.step, main.step += main.growth;
    };
    const bool upright = i + j == both, main_is_next = (upright == (steepest_ == 2)) == (between_[steepest_] > 0);
    if (main_is_next) cross_main();
    for (uint32_t others = a.count + b.count; others > 0; --others) {
        // Which of them is hard to foretell, so do without branches.
        const uint32_t column_a = *a.next, column_b = *b.next, is_a = column_a < column_b ? 1 : 0, if_a = 0 - is_a;
        run_to(std::min(column_a, column_b));
        a.next += is_a, b.next += 1 - is_a;
        patch += b.step + ((a.step - b.step) & if_a), a.step += a.growth & if_a;
        cross_main();
    }
    run_to(end);
    return static_cast<uint32_t>(run - runs);
}

}  // namespace lumel
