// Areas with few hits take what is missing from their neighbours; others are left alone.
#include <gtest/gtest.h>

#include <cmath>

#include "lumel/estimators/auto.h"
#include "lumel/estimators/weighted.h"

using namespace lumel;

namespace {

/// `hits` hits that each add `size` to G and see the radiance L, with independent replicas behind them.
Samples hits_of(double hits, double size, Rgb64 radiance) {
    const double g = hits * size;
    return {.f = radiance * g,
            .g = g,
            .var_f = radiance * radiance * (size * g),
            .cov_fg = radiance * (size * g),
            .var_g = size * g,
            .fg = radiance * (size * g),
            .gg = size * g,
            .hits = static_cast<uint64_t>(std::llround(hits)),
            .replicas = 8};
}

constexpr Rgb64 kBright{20, 10, 30}, kDim{2, 3, 1};
constexpr double kHit = 0.2;  // of an area that has five hits

/// 30 areas around, of five hits each.
Samples neighbours() {
    Samples around = hits_of(5 * 30, kHit / 30, kDim);
    around.size = 30;
    return around;
}

void expect_near(Rgb64 a, Rgb64 b, double tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

using Rule = Estimate (*)(const Samples&, const Samples&);
constexpr Rule kRules[]{weighted, automatic};

}  // namespace

TEST(FewHits, a_hit_of_the_neighbours_has_the_size_of_one_here) {
    EXPECT_NEAR(hit_size(hits_of(1, 1, kDim), neighbours()), kHit, 1e-12);
    EXPECT_EQ(hit_size(hits_of(1, 1, kDim), Samples{}), 0);
}

TEST(FewHits, enough_hits_are_left_alone) {
    const Samples own = hits_of(8, kHit, kBright);
    const Estimate e = weighted(own, neighbours());
    expect_near(e.value, own.f * (1 / own.g), 1e-12);
    expect_near(e.value, weighted(own, {}).value, 0);
    expect_near(automatic(own, neighbours()).value, corrected_or_ratio(own, neighbours(), dim_radiance(own, neighbours())).value, 0);
}

TEST(FewHits, many_hits_are_trusted_even_if_one_outweighs_the_rest) {
    Samples own = hits_of(1, kHit, kBright);
    const double few = share_of_neighbours(own, neighbours());
    own.hits = 250;
    EXPECT_LT(share_of_neighbours(own, neighbours()), 1e-4 * few);
}

TEST(FewHits, without_a_hit_the_neighbours_stand_in) {
    for (Rule rule : kRules) {
        const Estimate e = rule({}, neighbours());
        EXPECT_TRUE(e.valid);
        expect_near(e.value, kDim, 1e-9);
        EXPECT_FALSE(rule({}, {}).valid);
    }
}

TEST(FewHits, a_faint_hit_does_not_speak_for_the_whole_lobe) {
    // One hit of a hundredth of the usual size: alone it would make the area ten times too bright.
    const Samples own = hits_of(1, kHit / 100, kBright);
    expect_near(weighted(own, {}).value, kBright, 1e-9);
    const double share = 0.01 / kFewHits;
    expect_near(weighted(own, neighbours()).value, kBright * share + kDim * (1 - share), 1e-9);
}

TEST(FewHits, the_step_from_few_to_enough_has_no_jump) {
    for (const auto& [rule, enough] : {std::pair{kRules[0], kFewHits}, std::pair{kRules[1], kEnoughHits}}) {
        const Estimate below = rule(hits_of(enough - 1e-9, kHit, kBright), neighbours()),
                       above = rule(hits_of(enough + 1e-9, kHit, kBright), neighbours());
        expect_near(below.value, above.value, 1e-6);
        expect_near(below.variance, above.variance, 1e-6);
    }
}

TEST(FewHits, what_neighbours_fill_in_has_the_spread_of_so_many_hits) {
    // Neighbours that differ among themselves: a mean of a few of their hits is worth no more for being known well.
    Samples around = neighbours();
    around.var_f = around.var_f * 4.0;
    const Estimate e = weighted({}, around), all = ratio(around);
    expect_near(e.variance, all.variance * (around.effective_hits() / kFewHits), 1e-9);
}
