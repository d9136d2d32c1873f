#include "lumel/transfer/transfers.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lumel {

void Transfers::group_by_side(uint32_t sides) {
    const size_t n = all.size();
    const size_t chunks = std::max<size_t>(1, static_cast<size_t>(tbb::this_task_arena::max_concurrency()));
    const auto begin = [&](size_t chunk) { return n * chunk / chunks; };

    // Count the all of every side, chunk by chunk.
    std::vector<std::vector<uint32_t>> counts(chunks);
    tbb::parallel_for(size_t{0}, chunks, [&](size_t chunk) {
        counts[chunk].assign(sides, 0);
        for (size_t i = begin(chunk); i < begin(chunk + 1); ++i)
            if (side_[i] != Transfer::kLost) ++counts[chunk][side_[i]];
    });

    // Give every chunk its place in every group: any number of chunks leads to the one stable order.
    first_.resize(size_t{sides} + 1);
    uint32_t at = 0;
    for (uint32_t s = 0; s < sides; ++s) {
        first_[s] = at;
        for (auto& count : counts) {
            const uint32_t here = count[s];
            count[s] = at;
            at += here;
        }
    }
    first_[sides] = at;
    order_.resize(at + kAhead);
    tbb::parallel_for(size_t{0}, chunks, [&](size_t chunk) {
        for (size_t i = begin(chunk); i < begin(chunk + 1); ++i)
            if (side_[i] != Transfer::kLost) order_[counts[chunk][side_[i]]++] = static_cast<uint32_t>(i);
    });
}

}  // namespace lumel
