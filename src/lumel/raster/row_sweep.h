// One row of the window: which triangles lie one behind the other, and the light that neighbours exchange.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lumel/raster/patch_light.h"
#include "lumel/raster/row_patches.h"
#include "lumel/raster/sweep_counters.h"

namespace lumel {

/// The part of a row that a triangle covers, and its place on the lines there.
struct alignas(64) RowSpan {
    double depth_at_0 = 0, step = 0;  ///< whole numbers: the depth at pixel x is depth_at_0 + x step
    RowSpan *nearer = nullptr, *farther = nullptr;  ///< neighbours on the line
    uint32_t end = 0;                               ///< the pixel after the last
    uint32_t triangle = 0;
    uint32_t parity = 0;                      ///< see kOpenParity
    uint32_t also_begins = 0, also_ends = 0;  ///< another span that begins or ends at the same pixel
    uint32_t since = 0;                       ///< pixel from which `farther` is the neighbour
    PatchSteps patches;
    PatchLight *to_nearer = nullptr, *to_farther = nullptr;  ///< of the patches from which on the neighbours have not been seen

    double depth(uint32_t x) const { return depth_at_0 + step * static_cast<int32_t>(x); }
    /// Equal depths are told apart by the number of the triangle.
    bool is_before(const RowSpan& other, uint32_t x) const {
        const double a = depth(x), b = other.depth(x);
        return a != b ? a < b : triangle < other.triangle;
    }

    /// How a triangle counts in the parity of lines: even for closed surfaces, equal for those of one that face the same way. The two
    /// lowest bits sum to the number of triangles on a line where the fronts of closed surfaces are as many as the backs.
    static constexpr uint32_t kOpenParity = 1;
    static uint32_t closed_parity(uint32_t surface, bool front_along) { return surface * 4 + (front_along ? 2 : 0); }
    /// Are they of one closed surface and face the same way?
    bool faces_like(const RowSpan& other) const { return parity == other.parity && parity % 2 == 0; }
};

/// Walks along a row from one begin or end of a span to the next, and keeps the list of the spans of the present pixel, by depth.
/// Neighbours exchange light once, when they part, over all pixels at which they were neighbours. Depths are linear along the row and
/// exact, so two spans change places at most once, at a pixel that is known as soon as they meet.
class RowSweep {
public:
    /// Be ready for windows of `width` pixels a row, and the light of `patches` patches.
    void resize(uint32_t width, uint32_t patches);
    /// Have a patch send light, from its first row on.
    void begin_patch(uint32_t patch, const PatchLight& light) { lights_[patch] = light, as_last_[patch] = 0; }
    /// What a patch has sent and received.
    const PatchLight& light(uint32_t patch) const { return lights_[patch]; }
    /// Pixels at which nothing lies behind a patch.
    uint32_t pixels_as_last(uint32_t patch) const { return as_last_[patch]; }

    /// Be ready for a row of at most `spans` spans with `pixels` pixels of divided ones.
    void begin_row(size_t spans, size_t pixels) {
        if (spans_.size() < spans) spans_.resize(spans);
        size_ = 0;
        patches_.begin_row(pixels);
    }
    /// The patches of the row.
    RowPatches& patches() { return patches_; }
    /// Take the span from pixel `begin` to before `end`, with its patches, the first of which is `patch`.
    void add(uint32_t begin, uint32_t end, double depth_at_0, double step, uint32_t triangle, uint32_t parity, const PatchSteps& patches,
             uint32_t patch) {
        RowSpan& span = spans_[size_];
        span.depth_at_0 = depth_at_0, span.step = step;
        span.end = end, span.triangle = triangle, span.parity = parity, span.patches = patches;
        span.to_nearer = span.to_farther = &lights_[patch];
        span.also_begins = chain(first_begin_, begin), span.also_ends = chain(first_end_, end);
        ++size_;
    }
    /// Exchange light along the row.
    void run();
    /// Add to `counters` what was met since the last call.
    void count(SweepCounters& counters);
    size_t bytes() const {
        return lights_.capacity() * (sizeof(PatchLight) + sizeof(uint32_t)) + patches_.bytes() + spans_.capacity() * sizeof(RowSpan) +
               first_begin_.capacity() * 2 * sizeof(uint32_t);
    }

private:
    static constexpr uint32_t kNone = 0xffffffffu;

    /// Put the new span at the head of the list of pixel `x`; gives the one that was there.
    uint32_t chain(std::vector<uint32_t>& first, uint32_t x) {
        events_[x / 64] |= uint64_t{1} << x % 64;
        return std::exchange(first[x], size_);
    }
    void change(uint32_t x, uint32_t ending, uint32_t beginning);
    bool replace(RowSpan& old, RowSpan& span, uint32_t x);
    void remove(RowSpan& old, uint32_t x);
    void insert(RowSpan& span, uint32_t x);
    void sort(uint32_t x);
    void exchange_until(uint32_t x, RowSpan& near, RowSpan& far);
    void exchange_patches(uint32_t x, RowSpan& near, RowSpan& far);
    void see_nothing_before(RowSpan& first, uint32_t x);
    void see_nothing_behind(RowSpan& last, uint32_t x);
    void note_mispaired(uint32_t x, const RowSpan& near, const RowSpan& far);
    void part(RowSpan& near, uint32_t x);
    void meet(RowSpan& near, uint32_t x);
    void check_order(const RowSpan& near, const RowSpan& far, uint32_t x);
    void expect_crossing(const RowSpan& near, const RowSpan& far, uint32_t x, uint32_t last);

    std::vector<PatchLight> lights_;
    std::vector<uint32_t> as_last_;  // see pixels_as_last
    std::vector<uint64_t> events_, crossings_;  // one bit a pixel: something changes there; neighbours change places
    std::vector<uint32_t> first_begin_, first_end_;  // span that begins or ends at a pixel, or kNone
    RowSpan front_, behind_;  // before and behind all others: those who see them see nothing
    std::vector<RowSpan> spans_;
    RowPatches patches_;
    std::vector<RowSpan*> order_;
    uint32_t size_ = 0;  // of spans_, those in use
    RowSpan* last_ = nullptr;  // of the line, touched last

    uint64_t depth_ = 0;
    int64_t balance_ = 0, unturned_ = 0;  // of the line: spans, fronts - backs of closed surfaces, neighbours that face alike
    SweepCounters counters_;
};

}  // namespace lumel
