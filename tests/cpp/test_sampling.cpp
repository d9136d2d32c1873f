// Sampling triples: what is drawn has the density that is claimed.
#include <gtest/gtest.h>

#include "lumel/eye/eye_stream.h"
#include "lumel/sampling/distribution.h"
#include "lumel/sampling/warp.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr double kSignificance = 1e-4;  // of each single chi-square test

double chi_square_cells(const std::vector<double>& observed, double draws) {
    const std::vector<double> expected(observed.size(), draws / static_cast<double>(observed.size()));
    return chi_square_p(observed, expected);
}

}  // namespace

TEST(Statistics, tails_match_tables) {
    EXPECT_NEAR(chi_square_tail(18.307, 10), 0.05, 1e-5);
    EXPECT_NEAR(chi_square_tail(124.342, 100), 0.05, 1e-5);
    EXPECT_NEAR(chi_square_tail(2.558, 10), 0.99, 1e-4);
    EXPECT_NEAR(student_two_sided(2.262, 9), 0.05, 1e-4);
    EXPECT_NEAR(student_quantile(0.001, 15), 4.073, 1e-3);
    EXPECT_TRUE(holm_keeps_all({0.04, 0.03}, 0.05));
    EXPECT_FALSE(holm_keeps_all({0.04, 0.02}, 0.05));
}

TEST(Sobol, every_elementary_interval_of_an_aligned_block_holds_one_point) {
    for (uint64_t seed : {uint64_t{1}, uint64_t{77}, key(3, 4)})
        for (uint32_t log_n : {1u, 4u, 7u, 10u})
            for (uint32_t block : {0u, 1u, 5u, 1000u}) {
                const uint32_t n = 1u << log_n;
                for (uint32_t across = 0; across <= log_n; ++across) {
                    std::vector<int> cells(n);
                    for (uint32_t i = 0; i < n; ++i) {
                        const Square s = sobol2d(block * n + i, seed);
                        const auto columns = 1u << across, rows = n >> across;
                        ++cells[static_cast<uint32_t>(s.v * static_cast<float>(rows)) * columns +
                                static_cast<uint32_t>(s.u * static_cast<float>(columns))];
                    }
                    ASSERT_EQ(std::count(cells.begin(), cells.end(), 1), n) << "seed " << seed << ", block " << block << " of " << n;
                }
            }
}

TEST(Sobol, other_streams_are_independent) {
    // The same index in two streams: pairs of coordinates fill the square evenly.
    std::vector<double> cells(64);
    constexpr int kDraws = 1 << 14;
    for (int i = 0; i < kDraws; ++i) {
        const Square a = sobol2d(5, key(1, i)), b = sobol2d(5, key(2, i));
        ++cells[static_cast<int>(a.u * 8) * 8 + static_cast<int>(b.u * 8)];
    }
    EXPECT_GT(chi_square_cells(cells, kDraws), kSignificance);
    std::fill(cells.begin(), cells.end(), 0);
    for (int i = 0; i < kDraws; ++i) {
        const Square a = sobol2d(5, key(1, i));
        ++cells[static_cast<int>(a.u * 8) * 8 + static_cast<int>(a.v * 8)];
    }
    EXPECT_GT(chi_square_cells(cells, kDraws), kSignificance);
}

TEST(EyeStream, every_pair_of_a_pixel_is_spread_well_and_pairs_are_independent) {
    constexpr uint32_t kPairs = 20, kSamples = 16;
    std::vector<double> cells(64);
    for (uint64_t pixel = 0; pixel < 400; ++pixel) {
        std::vector<EyeStream> streams;
        for (uint32_t i = 0; i < kSamples; ++i) streams.emplace_back(key(9, pixel), i);
        float before = 0;
        for (uint32_t pair = 0; pair < kPairs; ++pair) {
            std::vector<int> intervals(kSamples);
            for (uint32_t i = 0; i < kSamples; ++i) {
                const Square s = streams[i].next();
                ++intervals[static_cast<uint32_t>(s.v * 4) * 4 + static_cast<uint32_t>(s.u * 4)];
                if (i != 5) continue;
                if (pair > 0) ++cells[static_cast<size_t>(before * 8) * 8 + static_cast<size_t>(s.u * 8)];
                before = s.v;
            }
            ASSERT_EQ(std::count(intervals.begin(), intervals.end(), 1), kSamples) << "pair " << pair;
        }
    }
    // The second number of a pair against the first one of the next, in one sample.
    EXPECT_GT(chi_square_cells(cells, 400 * (kPairs - 1)), kSignificance);
}

TEST(Warp, triangle_is_uniform_and_keeps_inside) {
    // Cells are the 64 equal small triangles of eight divisions.
    constexpr int kDivisions = 8, kDraws = 64000;
    std::vector<double> cells(kDivisions * kDivisions);
    Rng rng(7);
    for (int i = 0; i < kDraws; ++i) {
        const Square b = square_to_triangle(square(rng));
        ASSERT_GE(b.u, 0);
        ASSERT_GE(b.v, 0);
        ASSERT_LE(b.u + b.v, 1.0f + 1e-6f);
        const int column = std::min(static_cast<int>(b.u * kDivisions), kDivisions - 1),
                  row = std::min(static_cast<int>(b.v * kDivisions), kDivisions - 1);
        const bool upper = b.u * kDivisions - static_cast<float>(column) + b.v * kDivisions - static_cast<float>(row) > 1;
        ++cells[row * (2 * kDivisions - row) + 2 * column + (upper ? 1 : 0)];
    }
    EXPECT_GT(chi_square_cells(cells, kDraws), kSignificance);
}

TEST(Warp, directions_have_their_densities) {
    const auto cosine = [](Vec3 w) { return std::max(0.0, double{w.z}) / double{kPi}; };
    const auto uniform = [](Vec3) { return 0.25 / double{kPi}; };
    const Vec3 axis = normalize({1, 2, 3});
    EXPECT_GT(chi_square_directions([](Rng& r) { return square_to_cosine_hemisphere(square(r)); }, cosine, axis, 200000, 11),
              kSignificance);
    EXPECT_GT(chi_square_directions([](Rng& r) { return square_to_sphere(square(r)); }, uniform, axis, 200000, 12), kSignificance);
    // The test itself is tested: one is not the other.
    EXPECT_LT(chi_square_directions([](Rng& r) { return square_to_sphere(square(r)); }, cosine, axis, 200000, 13), 1e-12);
}

TEST(Frame, is_orthonormal_everywhere) {
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 n = i < 2 ? Vec3{0, 0, i == 0 ? 1.0f : -1.0f} : square_to_sphere(square(rng));
        const Frame f(n);
        EXPECT_NEAR(dot(f.s, f.t), 0, 2e-6);
        EXPECT_NEAR(dot(f.s, n), 0, 2e-6);
        EXPECT_NEAR(dot(f.t, n), 0, 2e-6);
        EXPECT_NEAR(length(f.s), 1, 2e-6);
        EXPECT_NEAR(length(cross(f.s, f.t) - n), 0, 4e-6);
        const Vec3 w = square_to_sphere(square(rng));
        EXPECT_NEAR(length(f.to_world(f.to_local(w)) - w), 0, 4e-6);
    }
}

TEST(Distribution, finds_the_owner_and_never_an_empty_item) {
    const std::vector<double> weights{0, 2, 0, 0, 1, 5, 0};
    const Distribution d(static_cast<uint32_t>(weights.size()), [&](uint32_t i) { return weights[i]; });
    EXPECT_EQ(d.total(), 8);
    EXPECT_EQ(d.find(0), 1u);
    EXPECT_EQ(d.find(1.999), 1u);
    EXPECT_EQ(d.find(2), 4u);
    EXPECT_EQ(d.find(3), 5u);
    EXPECT_EQ(d.find(7.9999), 5u);
    EXPECT_EQ(d.find(8), 5u) << "rounding up to the total stays with the last item that has weight";
    EXPECT_EQ(d.find(9), 5u);
    double sum = 0;
    for (uint32_t i = 0; i < d.size(); ++i) {
        EXPECT_DOUBLE_EQ(d.probability(i), weights[i] / 8);
        sum += d.probability(i);
    }
    EXPECT_DOUBLE_EQ(sum, 1);

    std::vector<double> observed(weights.size()), expected;
    Rng rng(5);
    for (int i = 0; i < 80000; ++i) ++observed[d.find(double{rng.uniform()} * d.total())];
    for (double w : weights) expected.push_back(w * 10000);
    EXPECT_GT(chi_square_p(observed, expected), kSignificance);
    EXPECT_EQ(Distribution().total(), 0);
}

TEST(Distribution, finds_the_same_from_anywhere) {
    Rng rng(key(19));
    const Distribution d(1000, [&](uint32_t i) { return i % 5 == 0 ? 0.0f : rng.uniform(); });
    for (int k = 0; k < 2000; ++k) {
        const double at = double{rng.uniform()} * d.total();
        const auto from = static_cast<uint32_t>(rng.uniform() * 1000);
        EXPECT_EQ(d.find(at, from), d.find(at));
    }
    for (uint32_t from : {0u, 500u, 999u}) EXPECT_EQ(d.find(d.total(), from), d.find(d.total()));
}
