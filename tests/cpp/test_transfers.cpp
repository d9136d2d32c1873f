// Transfers find their sides, whatever the number of threads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "lumel/sampling/hash.h"
#include "lumel/transfer/transfers.h"

using namespace lumel;

namespace {

constexpr uint32_t kSides = 300;
constexpr size_t kBlocks = 40;

bool is_plain(uint32_t side) { return side % 3 != 0; }

/// Blocks of random transfers, each known by its flux, which is a whole number: sums of them are exact.
void write(Transfers& transfers) {
    transfers.open(kBlocks);
    Rng rng(key(17));
    for (size_t b = 0; b < kBlocks; ++b) {
        TransferBlock& block = transfers.block(b);
        block.plain_size = block.placed_size = 0;
        for (uint32_t i = 0; i < TransferBlock::kMost; ++i) {
            const auto side = static_cast<uint32_t>(rng.uniform() * float{kSides});
            const Carried carried{{static_cast<float>(b), static_cast<float>(i), 1}, rng.uniform()};
            if (is_plain(side))
                block.plain_side[block.plain_size] = side, block.plain[block.plain_size++] = carried;
            else
                block.placed_side[block.placed_size] = side, block.placed[block.placed_size++] = {carried, 0.5f, 0.25f, {0, 0, 1}};
        }
    }
}

/// Those of one side in the order of their rays, by looking at all.
std::vector<Rgb> fluxes_of(Transfers& transfers, uint32_t side) {
    std::vector<Rgb> found;
    for (size_t b = 0; b < kBlocks; ++b) {
        const TransferBlock& block = transfers.block(b);
        for (uint32_t i = 0; i < block.plain_size; ++i)
            if (block.plain_side[i] == side) found.push_back(block.plain[i].flux);
        for (uint32_t i = 0; i < block.placed_size; ++i)
            if (block.placed_side[i] == side) found.push_back(block.placed[i].flux);
    }
    return found;
}

}  // namespace

TEST(Transfers, are_grouped_and_summed_by_side) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
    for (int threads : {1, 2, 5}) {
        tbb::task_arena(threads).execute([&] {
            Transfers transfers;
            BySide<Carried> plain;
            for (int step = 0; step < 2; ++step) {  // the second one in the memory of the first
                write(transfers);
                transfers.group_by_side(kSides);
                transfers.group_plain(plain);
            }
            for (uint32_t side = 0; side < kSides; ++side) {
                const std::vector<Rgb> truth = fluxes_of(transfers, side);
                ASSERT_EQ(transfers.arrivals(side), truth.size());
                ASSERT_EQ(is_plain(side) ? plain.of(side).size() : transfers.placed(side).size(), truth.size());
                Rgb64 sum;
                for (size_t i = 0; i < truth.size(); ++i) {
                    EXPECT_EQ(is_plain(side) ? plain.of(side)[i].flux : transfers.placed(side)[i].flux, truth[i]);
                    sum += truth[i];
                }
                EXPECT_EQ(transfers.plain_flux(side), is_plain(side) ? sum : Rgb64{});
            }
        });
    }
}

TEST(Transfers, none_are_no_trouble) {
    Transfers transfers;
    transfers.open(0);
    transfers.group_by_side(kSides);
    for (uint32_t side = 0; side < kSides; ++side) EXPECT_EQ(transfers.arrivals(side), 0u);
}
