#include "lumel/raster/scan_triangles.h"

namespace lumel {

void ScanTriangles::push(const std::array<SnappedVertex, 3>& corners, const DepthPlane& plane, uint32_t triangle, uint32_t parity, uint32_t n, uint32_t first_patch) {
    // Order the corners by height; where two are equally high, either order gives the same rows.
    auto [a, b, c] = corners;
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    const int32_t row = first_pixel(a.y), middle = first_pixel(b.y), end = first_pixel(c.y);

    if (size_ == fours_.size() * kLanes) fours_.emplace_back();
    Four& four = fours_[size_ / kLanes];
    const uint32_t lane = size_++ % kLanes;

    // The long edge is on one side, on the other the lower edge and then the upper one.
    const uint32_t short_side = turn(a, c, b) < 0 ? kRight : kLeft;
    four.set_edge(1 - short_side, lane, Edge(a, c, row));
    four.upper[lane] = Edge(b, c, middle);
    four.set_edge(short_side, lane, row < middle ? Edge(a, b, row) : four.upper[lane]);
    four.next_change[lane] = row < middle ? middle : end;
    four.end_row[lane] = end;
    four.short_side[lane] = short_side, four.triangle[lane] = triangle, four.parity[lane] = parity;
    four.first_patch[lane] = first_patch, four.divided[lane] = kUndivided;
    if (n > 1) {
        four.divided[lane] = static_cast<uint32_t>(divided_.size());
        divided_.emplace_back(corners, n, first_patch);
    }

    four.x[lane] = plane.x, four.y[lane] = plane.y, four.depth[lane] = plane.depth;
    four.slope_x[lane] = plane.slope_x, four.slope_y[lane] = plane.slope_y, four.step[lane] = plane.step;
    four.lowest[lane] = plane.lowest, four.highest[lane] = plane.highest;
}

/// Find what a row covers of the triangles, and go on to the next. Every statement is one for all lanes.
inline void ScanTriangles::Four::cross(double row, FourSpans& spans) {
    Lanes first = numerator[kLeft] / denominator[kLeft], after = numerator[kRight] / denominator[kRight];
    round_up(first), round_up(after);
    numerator[kLeft] += growth[kLeft], numerator[kRight] += growth[kRight];

    // Depths of the first pixels, and what they grow by; single pixels may have any slope, so they get none.
    Lanes at = depth + slope_y * (row - y) + slope_x * (first - x);
    at = at > lowest ? at : lowest;
    at = at < highest ? at : highest;
    round(at);
    spans.step = after - first > 1 ? step : Lanes{};
    spans.depth_at_0 = at - spans.step * first;
    spans.begin = to_int(first), spans.end = to_int(after);
}

void ScanTriangles::scan(int32_t row, RowSweep& sweep) {
    sweep.begin_row(size_);
    IntLanes changes{};
    for (uint32_t first = 0; first < size_; first += kLanes) {
        Four& four = fours_[first / kLanes];
        FourSpans spans;
        four.cross(row, spans);
        const uint32_t lanes = std::min(kLanes, size_ - first);
        for (uint32_t k = 0; k < lanes; ++k)
            if (spans.begin[k] < spans.end[k]) {
                const auto begin = static_cast<uint32_t>(spans.begin[k]), end = static_cast<uint32_t>(spans.end[k]);
                sweep.add(begin, end, spans.depth_at_0[k], spans.step[k], four.triangle[k], four.parity[k]);
                if (four.divided[k] == kUndivided) {
                    sweep.add_run({end, four.first_patch[k]});
                    continue;
                }
                const DividedTriangle& divided = divided_[four.divided[k]];
                PatchRun* runs = sweep.room_for_runs(divided.room_for_runs());
                columns_.resize(std::max<size_t>(columns_.size(), divided.room_for_columns()));
                sweep.add_runs(divided.cut(row, begin, end, runs, columns_.data()));
            }
        changes = changes | (four.next_change == row + 1);
    }
    if ((changes[0] | changes[1] | changes[2] | changes[3]) == 0) return;

    // Edges and triangles end; the last triangle takes the place of one that does.
    for (uint32_t i = 0; i < size_;) {
        Four& four = fours_[i / kLanes];
        const uint32_t lane = i % kLanes;
        if (four.next_change[lane] != row + 1) {
            ++i;
            continue;
        }
        if (four.end_row[lane] == row + 1) {
            --size_;
            four.copy(lane, fours_[size_ / kLanes], size_ % kLanes);
            continue;
        }
        four.set_edge(four.short_side[lane], lane, four.upper[lane]);
        four.next_change[lane] = four.end_row[lane];
        ++i;
    }
}

void ScanTriangles::Four::copy(uint32_t to, const Four& other, uint32_t from) {
    for (size_t side : {kLeft, kRight}) {
        numerator[side][to] = other.numerator[side][from];
        growth[side][to] = other.growth[side][from];
        denominator[side][to] = other.denominator[side][from];
    }
    for (Lanes Four::* lanes :
         {&Four::x, &Four::y, &Four::depth, &Four::slope_x, &Four::slope_y, &Four::lowest, &Four::highest, &Four::step})
        (this->*lanes)[to] = (other.*lanes)[from];
    upper[to] = other.upper[from];
    next_change[to] = other.next_change[from], end_row[to] = other.end_row[from];
    short_side[to] = other.short_side[from], triangle[to] = other.triangle[from], parity[to] = other.parity[from];
    first_patch[to] = other.first_patch[from], divided[to] = other.divided[from];
}

}  // namespace lumel
