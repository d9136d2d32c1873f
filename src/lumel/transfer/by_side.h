// Things grouped by the side that they belong to.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lumel/math/buffer.h"

namespace lumel {

/// The things of one side lie together, in the order in which they came.
template <class T>
class BySide {
public:
    std::span<const T> of(uint32_t side) const { return {sorted_.data() + first_[side], first_[side + 1] - first_[side]}; }

    /// Things with the sides that they belong to.
    struct List {
        std::span<const uint32_t> sides;
        std::span<const T> things;
    };
    /// Sort the things of many lists, list(0) and so on (counting sort, stable: the same order for any number of threads).
    template <class Lists>
    void sort(uint32_t sides, size_t lists, const Lists& list);

private:
    static constexpr size_t kAhead = 16;  // to fetch what is written next

    std::vector<uint32_t> first_;  // sides + 1: those of side s are first_[s] .. first_[s+1]
    Buffer<T> sorted_;
    Buffer<uint32_t> counts_;  // of every side for each thread's share of the lists
};

template <class T>
template <class Lists>
void BySide<T>::sort(uint32_t sides, size_t lists, const Lists& list) {
    const size_t chunks = std::max<size_t>(1, static_cast<size_t>(tbb::this_task_arena::max_concurrency()));
    const auto begin = [&](size_t chunk) { return lists * chunk / chunks; };
    counts_.reserve(chunks * sides);
    const auto counts_of = [&](size_t chunk) { return counts_.data() + chunk * sides; };

    // Count what belongs to every side, chunk by chunk.
    tbb::parallel_for(size_t{0}, chunks, [&](size_t chunk) {
        uint32_t* counts = counts_of(chunk);
        std::fill_n(counts, sides, 0u);
        for (size_t b = begin(chunk); b < begin(chunk + 1); ++b)
            for (uint32_t side : list(b).sides) ++counts[side];
    });

    // Give every chunk its place in every group: any number of chunks leads to the one stable order.
    first_.resize(size_t{sides} + 1);
    uint32_t at = 0;
    for (uint32_t side = 0; side < sides; ++side) {
        first_[side] = at;
        for (size_t chunk = 0; chunk < chunks; ++chunk) at += std::exchange(counts_of(chunk)[side], at);
    }
    first_[sides] = at;
    sorted_.reserve(at);
    tbb::parallel_for(size_t{0}, chunks, [&](size_t chunk) {
        uint32_t* next = counts_of(chunk);
        for (size_t b = begin(chunk); b < begin(chunk + 1); ++b) {
            const auto [of, things] = list(b);
            for (size_t i = 0; i < of.size(); ++i) {
                if (i + kAhead < of.size()) __builtin_prefetch(&sorted_[next[of[i + kAhead]]], 1);
                sorted_[next[of[i]]++] = things[i];
            }
        }
    });
}

}  // namespace lumel
