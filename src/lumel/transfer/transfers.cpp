#include "lumel/transfer/transfers.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <bit>

namespace lumel {

namespace {

constexpr size_t kMostParts = 32, kRaysPerSum = 2;  // of the sums of plain sides

}  // namespace

void Transfers::open(size_t blocks) {
    size_ = blocks;
    blocks_.reserve(blocks);
}

void Transfers::group_by_side(uint32_t sides) {
    tbb::parallel_invoke([&] { placed_.sort(sides, size_, [&](size_t b) { return blocks_[b].placed_list(); }); },
                         [&] { sum_plain(sides); });
}

void Transfers::group_plain(BySide<Carried>& sorted) const {
    sorted.sort(static_cast<uint32_t>(plain_.size()), size_, [&](size_t b) { return blocks_[b].plain_list(); });
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
