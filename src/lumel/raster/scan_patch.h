// A patch on its way through the rows of a window.
#pragma once

#include <immintrin.h>

#include "lumel/raster/patch_outline.h"

namespace lumel {

/// Gives the pixels of a patch row by row. All is computed in whole numbers below 2^53 held in doubles, so that rounding up the quotient
/// of two of them is exact: a fraction a/b lies at least 1/b above the whole number below it, and |a| 2^-53 < 1.
class ScanPatch {
public:
    ScanPatch(const PatchOutline& outline, const DepthPlane& plane, uint32_t patch) : plane_(plane), patch_(patch) {
        // Order the corners by height; where two are equally high, either order gives the same rows.
        auto [a, b, c] = outline.corners;
        if (b.y < a.y) std::swap(a, b);
        if (c.y < b.y) std::swap(b, c);
        if (b.y < a.y) std::swap(a, b);
        const double pixel = outline.pixel();
        row_ = first_row(a.y, pixel), middle_row_ = first_row(b.y, pixel), end_row_ = first_row(c.y, pixel);

        // The long edge is on one side, on the other the lower edge and then the upper one.
        const bool long_is_left = (b.x - a.x) * (c.y - a.y) > (c.x - a.x) * (b.y - a.y);
        short_side_ = long_is_left ? 1 : 0;
        set_edge(1 - short_side_, Edge(a, c, row_, pixel));
        upper_ = Edge(b, c, middle_row_, pixel);
        set_edge(short_side_, row_ < middle_row_ ? Edge(a, b, row_, pixel) : upper_);
    }
    static int32_t first_row(double y, double pixel) { return static_cast<int32_t>(std::ceil(y / pixel)); }

    uint32_t patch() const { return patch_; }
    bool is_done() const { return row_ >= end_row_; }

    /// Pixels of the present row: from `begin` to before `end`; `depth` is that of the first one.
    struct Row {
        int32_t begin = 0, end = 0;
        double depth = 0;
    };
    Row row() const {
        const __m128d crossings = _mm_ceil_pd(_mm_div_pd(_mm_load_pd(numerator_), _mm_load_pd(denominator_)));
        const __m128i pixels = _mm_cvttpd_epi32(crossings);
        return {_mm_cvtsi128_si32(pixels), _mm_extract_epi32(pixels, 1), plane_.at(_mm_cvtsd_f64(crossings), row_)};
    }
    /// What the depth grows by from pixel to pixel.
    double step() const { return plane_.step(); }
    void next_row() {
        ++row_;
        numerator_[0] += growth_[0], numerator_[1] += growth_[1];
        if (row_ == middle_row_) set_edge(short_side_, upper_);
    }

private:
    /// Where an edge from `a` up to `b` crosses a row is numerator / denominator, in pixels.
    struct Edge {
        double numerator = 0, growth = 0, denominator = 1;

        Edge() = default;
        Edge(PatchOutline::Corner a, PatchOutline::Corner b, int32_t row, double pixel)
            : numerator(a.x * (b.y - a.y) + (b.x - a.x) * (row * pixel - a.y)),
              growth((b.x - a.x) * pixel),
              denominator((b.y - a.y) * pixel) {}
    };
    void set_edge(uint32_t side, const Edge& edge) {
        numerator_[side] = edge.numerator, growth_[side] = edge.growth, denominator_[side] = edge.denominator;
    }

    alignas(16) double numerator_[2];  // of the left edge, of the right one
    alignas(16) double growth_[2], denominator_[2];
    Edge upper_;
    DepthPlane plane_;
    int32_t row_ = 0, middle_row_ = 0, end_row_ = 0;
    uint32_t short_side_ = 0, patch_ = 0;
};

}  // namespace lumel
