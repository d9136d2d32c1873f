#include "lumel/raster/row_sweep.h"

#include <bit>
#include <limits>

namespace lumel {

void RowSweep::resize(uint32_t width, uint32_t patches) {
    events_.assign(width / 64 + 1, 0), crossings_.assign(width / 64 + 1, 0);
    first_begin_.assign(width + 1, kNone), first_end_.assign(width + 1, kNone);
    patches_.resize(width);
    lights_.resize(patches), as_last_.resize(patches);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    front_ = {.depth_at_0 = -kFar, .end = kNone, .parity = RowSpan::kOpenParity};
    behind_ = {.depth_at_0 = kFar, .end = kNone, .parity = RowSpan::kOpenParity};
}

/// Two neighbours have seen each other up to before pixel `x`.
inline void RowSweep::exchange_until(uint32_t x, RowSpan& near, RowSpan& far) {
    if (near.since == x) return;
    // Small triangles are one patch each.
    if (patches_.has_none(near.patches) && patches_.has_none(far.patches) && unturned_ == 0)
        exchange(*near.to_farther, *far.to_nearer, x - near.since);
    else
        exchange_patches(x, near, far);
}

/// The same, patch by patch: over each stretch of pixels on which neither changes.
void RowSweep::exchange_patches(uint32_t x, RowSpan& near, RowSpan& far) {
    if (&near == &front_) return see_nothing_before(far, x);
    if (&far == &behind_) return see_nothing_behind(near, x);
    if (near.faces_like(far)) note_mispaired(x, near, far);
    const PatchSteps a = near.patches, b = far.patches;
    PatchLight *in_a = near.to_farther, *in_b = far.to_nearer;
    size_t from = near.since;
    const auto changes = [=](size_t word) { return a.changes[word] | b.changes[word]; };
    for_each_change(from, x, changes, [&](size_t end) {
        exchange(*in_a, *in_b, static_cast<uint32_t>(end - from));
        in_a += a.steps[end], in_b += b.steps[end], from = end;
    });
    near.to_farther = in_a, far.to_nearer = in_b;
}

/// The first of the line is met.
void RowSweep::see_nothing_before(RowSpan& first, uint32_t x) {
    if (&first == &behind_) return;
    counters_.lines += x - front_.since;
    if (x == first.end) return;
    const PatchSteps a = first.patches;
    for_each_change(front_.since, x, [=](size_t word) { return a.changes[word]; }, [&](size_t end) { first.to_nearer += a.steps[end]; });
}

/// The last of the line is left.
void RowSweep::see_nothing_behind(RowSpan& last, uint32_t x) {
    const PatchSteps a = last.patches;
    uint32_t* pixels = as_last_.data() + (last.to_farther - lights_.data());
    size_t from = last.since;
    for_each_change(
        from, x, [=](size_t word) { return a.changes[word]; },
        [&](size_t end) {
            *pixels += static_cast<uint32_t>(end - from);
            pixels += a.steps[end], from = end;
        });
    last.to_farther = lights_.data() + (pixels - as_last_.data());
}

/// Add up what they are about to exchange.
void RowSweep::note_mispaired(uint32_t x, const RowSpan& near, const RowSpan& far) {
    const PatchSteps &a = near.patches, &b = far.patches;
    const PatchLight *in_a = near.to_farther, *in_b = far.to_nearer;
    size_t from = near.since;
    const auto changes = [&](size_t word) { return a.changes[word] | b.changes[word]; };
    for_each_change(from, x, changes, [&](size_t end) {
        const Rgb both = PatchLight::colour(in_a->sent_along + in_b->sent_against);
        counters_.mispaired += to_double(both) * static_cast<double>(end - from);
        in_a += a.steps[end], in_b += b.steps[end], from = end;
    });
}

inline void RowSweep::part(RowSpan& near, uint32_t x) {
    RowSpan& far = *near.farther;
    exchange_until(x, near, far);
    unturned_ -= near.faces_like(far);
}

inline void RowSweep::meet(RowSpan& near, uint32_t x) {
    const RowSpan& far = *near.farther;
    near.since = x;
    unturned_ += near.faces_like(far);
    check_order(near, far, x);
}

inline void RowSweep::check_order(const RowSpan& near, const RowSpan& far, uint32_t x) {
    const uint32_t last = std::min(near.end, far.end) - 1;
    if (!(near.depth(last) < far.depth(last))) expect_crossing(near, far, x, last);
}

/// Note the first pixel from `x` to `last` at which `far` is before `near`.
void RowSweep::expect_crossing(const RowSpan& near, const RowSpan& far, uint32_t x, uint32_t last) {
    // One of them may end right here, and is about to be removed.
    if (last < x || near.is_before(far, last)) return;
    while (x < last) {
        const uint32_t middle = x + (last - x) / 2;
        if (far.is_before(near, middle))
            last = middle;
        else
            x = middle + 1;
    }
    events_[last / 64] |= uint64_t{1} << last % 64;
    crossings_[last / 64] |= uint64_t{1} << last % 64;
}

/// Let a span take the place of another where it fits; most often they are of neighbours in a mesh.
inline bool RowSweep::replace(RowSpan& old, RowSpan& span, uint32_t x) {
    RowSpan &near = *old.nearer, &far = *old.farther;
    // Those that end here as well are not there any more.
    const RowSpan *before = &near, *behind = &far;
    while (before->end == x) before = before->nearer;
    while (behind->end == x) behind = behind->farther;
    const double depth = span.depth(x);
    if (!(before->depth(x) < depth && depth < behind->depth(x))) return false;
    exchange_until(x, near, old), exchange_until(x, old, far);
    span.nearer = &near, span.farther = &far;
    near.farther = far.nearer = last_ = &span;
    near.since = span.since = x;
    check_order(near, span, x), check_order(span, far, x);
    if (span.parity != old.parity) {
        unturned_ += near.faces_like(span) + span.faces_like(far) - near.faces_like(old) - old.faces_like(far);
        balance_ += static_cast<int64_t>(span.parity & 3) - static_cast<int64_t>(old.parity & 3);
    }
    return true;
}

void RowSweep::remove(RowSpan& old, uint32_t x) {
    RowSpan& near = *old.nearer;
    part(near, x), part(old, x);
    near.farther = old.farther, old.farther->nearer = last_ = &near;
    meet(near, x);
    --depth_, balance_ -= static_cast<int64_t>(old.parity & 3) - 1;
}

void RowSweep::insert(RowSpan& span, uint32_t x) {
    // Look for its place from that of the last change on.
    RowSpan* near = last_;
    while (span.is_before(*near, x)) near = near->nearer;
    while (near->farther->is_before(span, x)) near = near->farther;
    part(*near, x);
    span.nearer = near, span.farther = near->farther;
    near->farther = span.farther->nearer = last_ = &span;
    meet(*near, x), meet(span, x);
    counters_.most_depth = std::max(counters_.most_depth, ++depth_);
    balance_ += static_cast<int64_t>(span.parity & 3) - 1;
}

void RowSweep::sort(uint32_t x) {
    order_.clear();
    for (RowSpan* span = front_.farther; span != &behind_; span = span->farther) order_.push_back(span);
    for (RowSpan* span = &front_; span != &behind_; span = span->farther) part(*span, x);
    std::sort(order_.begin(), order_.end(), [&](const RowSpan* a, const RowSpan* b) { return a->is_before(*b, x); });
    RowSpan* near = &front_;
    for (RowSpan* span : order_) near->farther = span, span->nearer = near, near = span;
    near->farther = &behind_, behind_.nearer = near;
    for (RowSpan* span = &front_; span != &behind_; span = span->farther) meet(*span, x);
}

inline void RowSweep::change(uint32_t x, uint32_t ending, uint32_t beginning) {
    RowSpan* const spans = spans_.data();
    while (ending != kNone && beginning != kNone && replace(spans[ending], spans[beginning], x))
        ending = spans[ending].also_ends, beginning = spans[beginning].also_begins;
    for (; ending != kNone; ending = spans[ending].also_ends) remove(spans[ending], x);
    for (; beginning != kNone; beginning = spans[beginning].also_begins) insert(spans[beginning], x);
}

void RowSweep::run() {
    front_.since = 0, front_.farther = &behind_, behind_.nearer = &front_;
    last_ = &front_;
    uint32_t before = 0;
    for (size_t word = 0; word < events_.size(); ++word) {
        while (const uint64_t events = events_[word]) {
            const auto x = static_cast<uint32_t>(word) * 64 + static_cast<uint32_t>(std::countr_zero(events));
            if ((balance_ | unturned_) != 0) counters_.parity_violations += x - before;
            before = x;
            change(x, std::exchange(first_end_[x], kNone), std::exchange(first_begin_[x], kNone));
            const uint64_t bit = events & -events;
            if (crossings_[word] & bit) sort(x);
            events_[word] &= ~bit, crossings_[word] &= ~bit;
        }
    }
}

void RowSweep::count(SweepCounters& counters) {
    counters += counters_;
    counters_ = {};
}

}  // namespace lumel
