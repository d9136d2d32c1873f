#include "lumel/raster/row_sweep.h"

#include <bit>

namespace lumel {

void RowSweep::resize(uint32_t width) {
    begins_.assign(width / 64 + 1, 0), events_.assign(width / 64 + 1, 0);
    first_.resize(width);
    spans_.clear(), line_.clear();
}

void RowSweep::add(uint32_t begin, const RowSpan& span) {
    uint64_t& begins = begins_[begin / 64];
    const uint64_t bit = uint64_t{1} << begin % 64;
    spans_.push_back(span);
    spans_.back().next = begins & bit ? first_[begin] : kNoSpan;
    first_[begin] = static_cast<uint32_t>(spans_.size() - 1);
    begins |= bit, events_[begin / 64] |= bit;
    events_[span.end / 64] |= uint64_t{1} << span.end % 64;
}

void RowSweep::change(uint32_t x) {
    // Drop what ends.
    size_t kept = 0;
    for (const RowSpan& span : line_) {
        line_[kept] = span;
        kept += span.end != x;
    }
    line_.resize(kept);
    // Insert what begins.
    if (!(begins_[x / 64] >> x % 64 & 1)) return;
    for (uint32_t i = first_[x]; i != kNoSpan; i = spans_[i].next) {
        size_t at = line_.size();
        line_.push_back(spans_[i]);
        for (; at > 0 && spans_[i].is_before(line_[at - 1], x); --at) line_[at] = line_[at - 1];
        line_[at] = spans_[i];
    }
}

void RowSweep::sort(uint32_t x) {
    for (size_t i = 1; i < line_.size(); ++i) {
        const RowSpan span = line_[i];
        size_t at = i;
        for (; at > 0 && span.is_before(line_[at - 1], x); --at) line_[at] = line_[at - 1];
        line_[at] = span;
    }
}

uint32_t RowSweep::keep_order(uint32_t begin, uint32_t end) {
    const auto is_sorted = [&](uint32_t x) {
        bool sorted = true;
        for (size_t i = 1; i < line_.size(); ++i) sorted &= line_[i - 1].depth(x) < line_[i].depth(x);
        return sorted;
    };
    // Depths are linear, so an order that held before and holds at the end holds between.
    if (is_sorted(end - 1)) return end;
    sort(begin);
    const auto keeps_order = [&](uint32_t x) {
        bool sorted = true;
        for (size_t i = 1; i < line_.size(); ++i) sorted &= line_[i - 1].is_before(line_[i], x);
        return sorted;
    };
    while (!keeps_order(end - 1)) end = begin + (end - begin) / 2;
    return end;
}

void RowSweep::run(std::span<PatchLight> lights, SweepCounters& counters) {
    PatchLight nothing;
    __m256 escaped = _mm256_setzero_ps();
    uint32_t x = 0;
    const auto exchange = [&](uint32_t begin, uint32_t end) {
        const uint32_t width = end - begin;
        const __m256 w = _mm256_set1_ps(static_cast<float>(width));
        const size_t depth = line_.size();
        const PatchLight* before = &nothing;
        PatchLight* here = &lights[line_[0].patch];
        size_t balance = line_[0].facing & 3;
        bool violated = false;
        for (size_t i = 0; i + 1 < depth; ++i) {
            PatchLight* behind = &lights[line_[i + 1].patch];
            here->receive(*before, *behind, w);
            violated |= line_[i].facing == line_[i + 1].facing;
            balance += line_[i + 1].facing & 3;
            before = here, here = behind;
        }
        here->receive(*before, nothing, w);
        const __m256 out = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&lights[line_[0].patch].sent_against.red)),
                                                _mm_load_ps(&here->sent_along.red), 1);
        escaped = _mm256_add_ps(escaped, _mm256_mul_ps(out, w));
        counters.lines += width;
        counters.fragments += width * depth;
        counters.most_depth = std::max(counters.most_depth, uint64_t{depth});
        counters.parity_violations += violated || balance != depth ? width : 0;
    };
    for (size_t word = 0; word < events_.size(); ++word) {
        uint64_t bits = events_[word];
        while (bits != 0) {
            const auto next = static_cast<uint32_t>(word * 64 + static_cast<size_t>(std::countr_zero(bits)));
            bits &= bits - 1;
            while (!line_.empty() && x < next) {
                const uint32_t end = keep_order(x, next);
                exchange(x, end);
                x = end;
            }
            x = next;
            change(x);
        }
        events_[word] = 0;
    }
    std::fill(begins_.begin(), begins_.end(), 0);
    spans_.clear();
    alignas(32) float out[8];
    _mm256_store_ps(out, escaped);
    counters.escaped += Rgb{out[0] + out[4], out[1] + out[5], out[2] + out[6]};
}

}  // namespace lumel
