// Sums of samples can be split over parts and merged by addition.
#include <gtest/gtest.h>

#include "lumel/areas/tally.h"

using namespace lumel;

namespace {

constexpr size_t kAreas = 40;
constexpr uint32_t kReplicas = 5, kSteps = 3, kSamples = 500;

struct NoSight : Sight {
    void see(std::span<const Look>, std::span<Seen>) const override {}
};

/// Hand all samples of one step of a replica to `add`: many sizes, some without a density, some looks.
template <class Part>
void samples_of_step(uint32_t replica, uint32_t step, Part&& part) {
    Transfers transfers;
    transfers.rays = 1000 + 100 * step;
    const NoSight sight;
    const Step of{.transfers = transfers, .sight = sight, .weight = 1.0 + step};
    Rng rng(key(3, replica, step));
    for (uint32_t i = 0; i < kSamples; ++i) {
        const auto area = static_cast<size_t>(rng.uniform() * float{kAreas});
        const double size = std::exp(10 * double{rng.uniform()} - 5);
        const Rgb64 f{size, size * double{rng.uniform()}, 0.1 * size};
        Tally& tally = part(i);
        switch (i % 8) {
        case 0:
            tally.add_plain(area, of, f);
            break;
        case 1:
            i % 3 == 0 ? tally.add_dark_look(area, of) : tally.add_look(area, of, i % 5 == 0 ? INFINITY : size);
            break;
        default:
            tally.add(area, of, f, size * double{rng.uniform()});
        }
    }
}

void close(Tally& tally) { tally.close_replica(1.0 + 2.0 + 3.0, 1000.0 + 1100.0 + 1200.0); }

/// All replicas in one tally, one after the other.
Tally in_one_go() {
    Tally tally(kAreas);
    for (uint32_t replica = 0; replica < kReplicas; ++replica) {
        for (uint32_t step = 0; step < kSteps; ++step) samples_of_step(replica, step, [&](uint32_t) -> Tally& { return tally; });
        close(tally);
    }
    return tally;
}

/// All numbers of a tally, in one row.
std::vector<double> numbers(const Tally& tally) {
    std::vector<double> all{static_cast<double>(tally.replicas())};
    for (size_t area = 0; area < tally.size(); ++area) {
        const Samples s = tally.samples(area);
        for (Rgb64 v : {s.f, s.plain, s.var_f, s.cov_fg, s.var_plain, s.fg}) all.insert(all.end(), {v.x, v.y, v.z});
        all.insert(all.end(), {s.g, s.var_g, s.gg, static_cast<double>(s.hits), s.looks, s.looks_uncovered});
    }
    return all;
}

/// Equal but for rounding: to 1e-12 of the sums that go into a number. Covariances are differences of such sums.
void expect_equal_to_rounding(const Tally& a, const Tally& b) {
    for (size_t area = 0; area < kAreas; ++area) {
        const Samples x = a.samples(area), y = b.samples(area);
        const double f = y.f.x + y.plain.x, g = y.g;
        const auto near = [](double one, double other, double scale) { EXPECT_NEAR(one, other, 1e-12 * scale); };
        near(x.f.x, y.f.x, f), near(x.plain.x, y.plain.x, f), near(x.g, g, g);
        near(x.fg.x, y.fg.x, y.fg.x), near(x.gg, y.gg, y.gg);
        near(x.var_f.x, y.var_f.x, f * f), near(x.cov_fg.x, y.cov_fg.x, f * g), near(x.var_g, y.var_g, g * g);
        near(x.var_plain.x, y.var_plain.x, f * f);
        EXPECT_EQ(x.hits, y.hits);
        EXPECT_EQ(x.looks, y.looks);
        EXPECT_EQ(x.looks_uncovered, y.looks_uncovered);
        EXPECT_EQ(x.looks_dark, y.looks_dark);
        near(x.looks_size, y.looks_size, y.looks_size);
    }
    EXPECT_EQ(a.replicas(), b.replicas());
}

}  // namespace

TEST(Tally, replicas_made_apart_and_merged_in_their_order_give_the_same_bytes) {
    Tally merged(kAreas);
    for (uint32_t replica = 0; replica < kReplicas; ++replica) {
        Tally part(kAreas);
        for (uint32_t step = 0; step < kSteps; ++step) samples_of_step(replica, step, [&](uint32_t) -> Tally& { return part; });
        close(part);
        merged.merge(part);
    }
    EXPECT_EQ(numbers(merged), numbers(in_one_go()));
}

TEST(Tally, replicas_in_any_groups_agree_to_rounding) {
    // Odd ones in one part, even ones in another, and the later part first.
    std::array<Tally, 2> parts{Tally(kAreas), Tally(kAreas)};
    for (uint32_t replica = 0; replica < kReplicas; ++replica) {
        Tally& part = parts[replica % 2];
        for (uint32_t step = 0; step < kSteps; ++step) samples_of_step(replica, step, [&](uint32_t) -> Tally& { return part; });
        close(part);
    }
    parts[1].merge(parts[0]);
    expect_equal_to_rounding(parts[1], in_one_go());
}

TEST(Tally, samples_of_one_replica_in_any_parts_agree_to_rounding) {
    for (uint32_t count : {2u, 7u}) {
        Tally merged(kAreas);
        for (uint32_t replica = 0; replica < kReplicas; ++replica) {
            std::vector<Tally> parts(count, Tally(kAreas));
            for (uint32_t step = 0; step < kSteps; ++step)
                samples_of_step(replica, step, [&](uint32_t i) -> Tally& { return parts[i * i % count]; });
            for (const Tally& part : parts) merged.merge(part);
            close(merged);
        }
        expect_equal_to_rounding(merged, in_one_go());
    }
}
