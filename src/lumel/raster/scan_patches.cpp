#include "lumel/raster/scan_patches.h"

namespace lumel {

void ScanPatches::push(const PatchOutline& outline, const DepthPlane& plane, uint32_t patch, uint32_t parity) {
    // Order the corners by height; where two are equally high, either order gives the same rows.
    auto [a, b, c] = outline.corners;
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    const double pixel = outline.pixel;
    const int32_t row = first_row(a.y, pixel), middle = first_row(b.y, pixel), end = first_row(c.y, pixel);

    if (size_ == fours_.size() * kLanes) fours_.emplace_back();
    Four& four = fours_[size_ / kLanes];
    const uint32_t lane = size_++ % kLanes;

    // The long edge is on one side, on the other the lower edge and then the upper one.
    const bool long_is_left = (b.x - a.x) * (c.y - a.y) > (c.x - a.x) * (b.y - a.y);
    const uint32_t short_side = long_is_left ? kRight : kLeft;
    four.set_edge(1 - short_side, lane, Edge(a, c, row, pixel));
    four.upper[lane] = Edge(b, c, middle, pixel);
    four.set_edge(short_side, lane, row < middle ? Edge(a, b, row, pixel) : four.upper[lane]);
    four.next_change[lane] = row < middle ? middle : end;
    four.end_row[lane] = end;
    four.short_side[lane] = short_side, four.patch[lane] = patch, four.parity[lane] = parity;

    four.x.of[lane] = plane.x, four.y.of[lane] = plane.y, four.depth.of[lane] = plane.depth;
    four.slope_x.of[lane] = plane.slope_x, four.slope_y.of[lane] = plane.slope_y, four.step.of[lane] = plane.step;
    four.lowest.of[lane] = plane.lowest, four.highest.of[lane] = plane.highest;
}

void ScanPatches::scan(int32_t row, RowSweep& sweep) {
    sweep.begin_row(size_);
    const __m256d y = _mm256_set1_pd(row), one = _mm256_set1_pd(1);
    const __m128i next_row = _mm_set1_epi32(row + 1);
    uint32_t changing = size_;
    for (uint32_t first = 0; first < size_; first += kLanes) {
        Four& four = fours_[first / kLanes];
        const auto load = [](const Lanes& lanes) { return _mm256_load_pd(lanes.of); };

        // Where the row enters and leaves the patches.
        const __m256d left = load(four.numerator[kLeft]), right = load(four.numerator[kRight]);
        const __m256d begin = _mm256_ceil_pd(_mm256_div_pd(left, load(four.denominator[kLeft])));
        const __m256d end = _mm256_ceil_pd(_mm256_div_pd(right, load(four.denominator[kRight])));
        _mm256_store_pd(four.numerator[kLeft].of, _mm256_add_pd(left, load(four.growth[kLeft])));
        _mm256_store_pd(four.numerator[kRight].of, _mm256_add_pd(right, load(four.growth[kRight])));

        // Depths of the first pixels, and what they grow by; single pixels may have any slope, so they get none.
        const __m256d at_row = _mm256_add_pd(load(four.depth), _mm256_mul_pd(load(four.slope_y), _mm256_sub_pd(y, load(four.y))));
        const __m256d there = _mm256_add_pd(at_row, _mm256_mul_pd(load(four.slope_x), _mm256_sub_pd(begin, load(four.x))));
        const __m256d depth = _mm256_floor_pd(_mm256_min_pd(_mm256_max_pd(there, load(four.lowest)), load(four.highest)));
        const __m256d is_wide = _mm256_cmp_pd(_mm256_sub_pd(end, begin), one, _CMP_GT_OQ);
        const __m256d step = _mm256_and_pd(load(four.step), is_wide);

        alignas(32) double depth_at_0[kLanes], steps[kLanes];
        alignas(16) uint32_t begins[kLanes], ends[kLanes];
        _mm256_store_pd(depth_at_0, _mm256_sub_pd(depth, _mm256_mul_pd(step, begin)));
        _mm256_store_pd(steps, step);
        _mm_store_si128(reinterpret_cast<__m128i*>(begins), _mm256_cvttpd_epi32(begin));
        _mm_store_si128(reinterpret_cast<__m128i*>(ends), _mm256_cvttpd_epi32(end));
        const uint32_t lanes = std::min(kLanes, size_ - first);
        for (uint32_t lane = 0; lane < lanes; ++lane)
            if (begins[lane] < ends[lane])
                sweep.add(begins[lane], ends[lane], depth_at_0[lane], steps[lane], four.patch[lane], four.parity[lane]);

        const __m128i changes = _mm_cmpeq_epi32(next_row, _mm_loadu_si128(reinterpret_cast<const __m128i*>(four.next_change)));
        if (changing == size_ && !_mm_testz_si128(changes, changes)) changing = first;
    }
    // Edges and patches end; the last patch takes the place of one that does.
    for (uint32_t i = changing; i < size_; ) {
        Four& four = fours_[i / kLanes];
        const uint32_t lane = i % kLanes;
        if (four.next_change[lane] != row + 1) { ++i; continue; }
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

void ScanPatches::Four::copy(uint32_t to, const Four& other, uint32_t from) {
    for (size_t side : {kLeft, kRight}) {
        numerator[side].of[to] = other.numerator[side].of[from];
        growth[side].of[to] = other.growth[side].of[from];
        denominator[side].of[to] = other.denominator[side].of[from];
    }
    for (Lanes Four::*lanes : {&Four::x, &Four::y, &Four::depth, &Four::slope_x, &Four::slope_y, &Four::lowest, &Four::highest, &Four::step})
        (this->*lanes).of[to] = (other.*lanes).of[from];
    upper[to] = other.upper[from];
    next_change[to] = other.next_change[from], end_row[to] = other.end_row[from];
    short_side[to] = other.short_side[from], patch[to] = other.patch[from], parity[to] = other.parity[from];
}

}  // namespace lumel
