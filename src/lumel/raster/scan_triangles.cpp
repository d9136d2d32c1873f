#include "lumel/raster/scan_triangles.h"

#include <bit>
#include <memory>

namespace lumel {

ScanTriangles::Edges::Edges(const VertexLanes& a, const VertexLanes& b) {
    const Lanes dx = b.x - a.x, dy = b.y - a.y;
    start = a.x * dy - dx * a.y;
    growth = dx * kSubpixels, denominator = dy * kSubpixels;
}

ScanTriangles::Four::Four(const VertexLanes& a, const VertexLanes& b, const VertexLanes& c)
    : long_edge(a, c), lower(a, b), upper(b, c), plane(a, b, c), middle(b.y * (1.0 / kSubpixels)), end(c.y * (1.0 / kSubpixels)) {
    round_up(middle), round_up(end);
    bends_left = (b.x - a.x) * (c.y - a.y) < (b.y - a.y) * (c.x - a.x);
}

void ScanTriangles::begin(const std::array<ScannedTriangle, kLanes>& triangles, uint32_t count) {
    const auto corner = [&](size_t k) {
        return VertexLanes(triangles[0].corners[k], triangles[1].corners[k], triangles[2].corners[k], triangles[3].corners[k]);
    };
    VertexLanes a = corner(0), b = corner(1), c = corner(2);
    put_in_order(a, b), put_in_order(b, c), put_in_order(a, b);

    // Take the place of four that have ended, if there is one.
    if (free_.empty()) free_.push_back(static_cast<uint32_t>(fours_.size())), fours_.emplace_back();
    Four& four = fours_[free_.back()];
    live_.push_back(free_.back()), free_.pop_back();
    std::construct_at(&four, a, b, c);
    for (uint32_t lane = 0; lane < count; ++lane) {
        const ScannedTriangle& t = triangles[lane];
        four.last_end = std::max(four.last_end, static_cast<int32_t>(four.end[lane]));
        four.triangle[lane] = t.triangle, four.parity[lane] = t.parity, four.first_patch[lane] = t.first_patch;
        four.divided[lane] = kUndivided;
        if (t.n == 1) continue;
        four.has_divided = true;
        four.divided[lane] = static_cast<uint32_t>(divided_.size());
        divided_.emplace_back(t.corners, t.n, t.first_patch);
    }
    for (uint32_t lane = count; lane < kLanes; ++lane) four.end[lane] = 0;
}

/// Find what a row covers of the triangles. Every statement is one for all lanes.
inline void ScanTriangles::Four::cross(double row, FourSpans& spans) const {
    // Each triangle has one edge on one side, and two that follow each other on the other.
    const auto is_lower = row < middle;
    Lanes one = (long_edge.start + row * long_edge.growth) / long_edge.denominator;
    Lanes two = ((is_lower ? lower.start : upper.start) + row * (is_lower ? lower.growth : upper.growth)) /
                (is_lower ? lower.denominator : upper.denominator);
    round_up(one), round_up(two);
    const Lanes first = bends_left ? two : one, after = row < end ? (bends_left ? one : two) : first;

    // Depths of the first pixels, and what they grow by; single pixels may have any slope, so they get none.
    spans.step = after - first > 1 ? plane.step : Lanes{};
    plane.at(first, row, spans.depth_at_0);
    spans.depth_at_0 -= spans.step * first;
    spans.begin = to_int(first), spans.end = to_int(after);
}

void ScanTriangles::scan(int32_t row, RowSweep& sweep) {
    // Cross all before looking at any: which of them have pixels is hard to foretell.
    crossed_.resize(live_.size());
    size_t pixels = 0;
    for (size_t i = 0; i < live_.size(); ++i) {
        const Four& four = fours_[live_[i]];
        FourSpans& spans = crossed_[i];
        four.cross(row, spans);
        if (!four.has_divided) continue;
        const IntLanes room = spans.end - spans.begin + static_cast<int32_t>(RowPatches::kMargin);
        pixels += static_cast<uint32_t>(room[0] + room[1] + room[2] + room[3]);
    }
    sweep.begin_row(live_.size() * kLanes, pixels);

    // Those that end here leave their place to others.
    size_t left = 0;
    for (size_t i = 0; i < live_.size(); ++i) {
        const Four& four = fours_[live_[i]];
        add_spans(four, crossed_[i], row, sweep);
        if (four.last_end > row + 1)
            live_[left++] = live_[i];
        else
            free_.push_back(live_[i]);
    }
    live_.resize(left);
}

inline void ScanTriangles::add_spans(const Four& four, const FourSpans& spans, int32_t row, RowSweep& sweep) {
    for (uint32_t left = bits(spans.begin < spans.end); left != 0; left &= left - 1) {
        const auto k = static_cast<uint32_t>(std::countr_zero(left));
        const auto begin = static_cast<uint32_t>(spans.begin[k]), end = static_cast<uint32_t>(spans.end[k]);
        uint32_t patch = four.first_patch[k];
        PatchSteps patches = sweep.patches().none();
        if (four.divided[k] != kUndivided) patches = sweep.patches().add(divided_[four.divided[k]], row, begin, end, patch);
        sweep.add(begin, end, spans.depth_at_0[k], spans.step[k], four.triangle[k], four.parity[k], patches, patch);
    }
}

}  // namespace lumel
