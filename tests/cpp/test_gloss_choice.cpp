// Gloss is taken from the solution or from rays of the lobe, material by material, by their errors.
#include <gtest/gtest.h>

#include "lumel/eye/correction.h"
#include "lumel/eye/gloss_choice.h"
#include "scenes.h"

namespace lumel::test {

namespace {

constexpr uint32_t kSize = 96, kPatch = 12;  // pixels

/// What is seen of a material: its true gloss is 1.
struct Seen {
    float blotches = 0;  ///< error of the solution, of either sign from patch to patch
    float told = 0;      ///< error that it tells
    float noise = 0;     ///< of one ray of the lobe
    float chance = 1;    ///< that a ray brings anything
};

/// A film whose left half sees material 3 and whose right half material 5; every second sample follows the lobe, far from all that is near.
Film film_of(const Seen& left, const Seen& right, uint32_t passes) {
    Film film(kSize, kSize);
    for (uint32_t number = 0; number < passes; ++number) {
        std::vector<PixelPass> pass(film.pixels());
        for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
            const uint32_t x = pixel % kSize, y = pixel / kSize;
            const Seen& seen = x < kSize / 2 ? left : right;
            PixelPass& p = pass[pixel];
            p.material = x < kSize / 2 ? 3 : 5;
            p.samples = 2, p.specular = 1;
            const float off = (key(1, x / kPatch, y / kPatch) & 1) ? seen.blotches : -seen.blotches;
            Rng rng(key(2, pixel, number));
            const float ray = (rng.uniform() < seen.chance ? 1 / seen.chance : 0.0f) +
                              seen.noise * std::sqrt(12.0f) * (rng.uniform() - 0.5f);
            p.sum.indirect_specular = grey(2 * (1 + off)), p.sum.specular_stderr = grey(2 * seen.told);
            p.sum.emission = grey(0.1f * (rng.uniform() - 0.5f));
            p.excess.specular = grey(ray - 1 - off);
        }
        film.add(pass);
    }
    correct(film, true);
    return film;
}

/// Mean and mean square of the error in the columns from `first`.
std::pair<double, double> error(const Film& film, uint32_t first) {
    double mean = 0, square = 0;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = first; x < first + kSize / 2; ++x) {
            const double e = double{film.mean(y * kSize + x).indirect_specular.y} - 1;
            mean += e, square += e * e;
        }
    constexpr double kPixels = kSize * kSize / 2.0;
    return {mean / kPixels, square / kPixels};
}

}  // namespace

TEST(GlossChoice, finds_blotches_that_the_solution_does_not_tell) {
    constexpr uint32_t kPasses = 16;
    constexpr float kBlotches = 0.2f, kNoise = 0.4f;
    const Film film = film_of({.blotches = kBlotches, .noise = kNoise}, {.noise = kNoise}, kPasses);
    const auto choices = choose_gloss(film);
    ASSERT_EQ(choices.size(), 6u);
    // Errors that pixels share count twice. Those of a row of a patch but the last are products of two pixels, as the material is wide.
    const double b2 = 2 * sqr(double{kBlotches}), noise = sqr(double{kNoise}) / kPasses;
    EXPECT_NEAR(double{choices[3].share}, b2 / (b2 + noise), 0.02);
    EXPECT_TRUE(choices[3].gather);
    EXPECT_LT(choices[5].share, 0.05f);
    EXPECT_FALSE(choices[5].gather);
    EXPECT_EQ(choices[4].share, 0);
    EXPECT_LT(error(film, 0).second, 1.05 * noise);
    EXPECT_LT(error(film, kSize / 2).second, 0.05 * noise);
}

TEST(GlossChoice, believes_what_the_solution_tells) {
    // It tells the sum of the errors of three vertices, whose square is twice that of independent ones; what pixels share counts twice.
    constexpr float kTold = 0.1f, kLittle = 0.01f, kNoise = 0.4f;
    constexpr uint32_t kPasses = 16;
    const Film film = film_of({.told = kTold, .noise = kNoise}, {.told = kLittle, .noise = kNoise}, kPasses);
    const auto choices = choose_gloss(film);
    const auto expected = [](float told) { return sqr(told) / (sqr(told) + sqr(kNoise) / kPasses); };
    EXPECT_NEAR(choices[3].share, expected(kTold), 0.03f);
    EXPECT_NEAR(choices[5].share, expected(kLittle), 0.01f);
}

TEST(GlossChoice, leaves_a_small_bright_spot_to_the_solution) {
    // One ray in 400 brings all the light: the solution is off by a tenth and better all the same.
    const Film film = film_of({.blotches = 0.1f, .told = 0.1f, .chance = 1.0f / 400}, {.noise = 0.1f}, 16);
    EXPECT_LT(choose_gloss(film)[3].share, 0.01f);
    EXPECT_LT(error(film, 0).second, 1.1 * sqr(0.1));
}

TEST(GlossChoice, takes_no_light_away_where_most_rays_miss) {
    // Much is mixed in of rays of which one in 400 brings all the light: the mean over pixels stays what it is, within 4 standard errors.
    constexpr double kPasses = 16, kPixels = kSize * kSize / 2.0, kRays = 400;
    const Film film = film_of({.told = 2, .chance = 1 / 400.0f}, {.noise = 0.1f}, 16);
    const double share = double{choose_gloss(film)[3].share};
    EXPECT_GT(share, 0.15);
    EXPECT_NEAR(error(film, 0).first, 0, 4 * share * std::sqrt(kRays / (kPasses * kPixels)));
}

}  // namespace lumel::test
