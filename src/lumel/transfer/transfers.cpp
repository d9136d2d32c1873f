#include "lumel/transfer/transfers.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <bit>

namespace lumel {

namespace {

constexpr size_t kMostParts = 32, kRaysPerSum = 2;  // of the sums of plain sides
constexpr uint32_t kAhead = 16;                      // to fetch what is written next

}  // namespace

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

void Transfers::open(size_t blocks) {
    size_ = blocks;
    blocks_.reserve(blocks);
}

void Transfers::group_by_side(uint32_t sides) {
    tbb::parallel_invoke([&] { placed_.sort(sides, size_, [&](size_t b) { return blocks_[b].placed_list(); }); },
                         [&] { sum_plain(sides); });
}

BySide<Carried> Transfers::plain_by_side() const {
    BySide<Carried> sorted;
    sorted.sort(static_cast<uint32_t>(plain_.size()), size_, [&](size_t b) { return blocks_[b].plain_list(); });
    return sorted;
}

void Transfers::sum_plain(uint32_t sides) {
    // Sum parts of the blocks, as many as cost little beside the rays; how many does not depend on the threads.
    const size_t parts = std::clamp(std::bit_floor(size_ * TransferBlock::kMost / (kRaysPerSum * sides)), size_t{1}, kMostParts);
    parts_.reserve(parts * sides);
    tbb::parallel_for(size_t{0}, parts, [&](size_t part) {
        Sum* sums = parts_.data() + part * sides;
        std::fill_n(sums, sides, Sum{});
        for (size_t b = size_ * part / parts; b < size_ * (part + 1) / parts; ++b) {
            const auto [of, carried] = blocks_[b].plain_list();
            for (size_t i = 0; i < of.size(); ++i) sums[of[i]].flux += carried[i].flux, ++sums[of[i]].arrivals;
        }
    });
    plain_.resize(sides);
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, sides, 4096), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            plain_[side] = parts_[side];
            for (size_t part = 1; part < parts; ++part) {
                const Sum& sum = parts_[part * sides + side];
                plain_[side].flux += sum.flux, plain_[side].arrivals += sum.arrivals;
            }
        }
    });
}

}  // namespace lumel
