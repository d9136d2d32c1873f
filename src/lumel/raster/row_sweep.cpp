#include "lumel/raster/row_sweep.h"

#include <bit>
#include <limits>

namespace lumel {

void RowSweep::resize(uint32_t width, uint32_t patches) {
    events_.assign(width / 64 + 1, 0), crossings_.assign(width / 64 + 1, 0);
    first_begin_.assign(width + 1, kNone), first_end_.assign(width + 1, kNone);
    lights_.resize(patches), as_last_.resize(patches);
    runs_.resize(std::max<size_t>(runs_.size(), 1));
    runs_[kNothing] = {};
    constexpr double kFar = std::numeric_limits<double>::infinity();
    front_ = {.depth_at_0 = -kFar, .end = kNone, .parity = RowSpan::kOpenParity, .run_to_farther = kNothing};
    behind_ = {.depth_at_0 = kFar, .end = kNone, .parity = RowSpan::kOpenParity, .run_to_nearer = kNothing};
}

/// Two neighbours have seen each other up to before pixel `x`.
inline void RowSweep::exchange_until(uint32_t x, RowSpan& near, RowSpan& far) {
    const PatchRun &a = runs_[near.run_to_farther], &b = runs_[far.run_to_nearer];
    // Most often each is one patch all the way.
    if (x <= a.end && x <= b.end && unturned_ == 0)
        exchange(lights_[a.patch], lights_[b.patch], x - near.since);
    else
        exchange_runs(x, near, far);
}

/// The same, patch by patch.
void RowSweep::exchange_runs(uint32_t x, RowSpan& near, RowSpan& far) {
    uint32_t from = near.since;
    if (from == x) return;
    if (&near == &front_) {
        if (&far != &behind_) counters_.lines += x - from;
        return;
    }
    const PatchRun *a = &runs_[near.run_to_farther], *b = &runs_[far.run_to_nearer];
    while (a->end <= from) ++a;
    if (&far == &behind_) {
        for (; a->end < x; from = a++->end) as_last_[a->patch] += a->end - from;
        as_last_[a->patch] += x - from;
        near.run_to_farther = static_cast<uint32_t>(a - runs_.data());
        return;
    }
    while (b->end <= from) ++b;
    const bool face_alike = near.faces_like(far);
    const auto see = [&](uint32_t until) {
        exchange(lights_[a->patch], lights_[b->patch], until - from);
        if (!face_alike) return;
        const Rgb both = PatchLight::colour(lights_[a->patch].sent_along + lights_[b->patch].sent_against);
        counters_.mispaired += to_double(both) * static_cast<double>(until - from);
    };
    // Which run ends first is hard to foretell, so do without branches.
    for (uint32_t end; (end = std::min(a->end, b->end)) < x; from = end) {
        see(end);
        a += a->end == end, b += b->end == end;
    }
    see(x);
    near.run_to_farther = static_cast<uint32_t>(a - runs_.data()), far.run_to_nearer = static_cast<uint32_t>(b - runs_.data());
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
    const double depth = span.depth(x);
    if (near.end == x || far.end == x || !(near.depth(x) < depth && depth < far.depth(x))) return false;
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
