// What single bright rays find is shared among pixels; what comes again stays where it is.
#include <gtest/gtest.h>

#include "lumel/eye/rare_light.h"
#include "scenes.h"

namespace lumel::test {

namespace {

constexpr uint32_t kSize = 16, kOdd = 8 * kSize + 8, kPasses = 12;

/// A film of a wall that is turned by a right angle at column `edge`.
Film wall(uint32_t edge) {
    Film film(kSize, kSize);
    std::vector<PixelPass> pass(film.pixels());
    for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
        pass[pixel].samples = 1, pass[pixel].sum.albedo = grey(0.5f), pass[pixel].sum.depth = 2;
        pass[pixel].sum.normal = pixel % kSize < edge ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    }
    film.add(pass);
    return film;
}

/// Differences of +-0.1 a pass, and `once` more in one pass of kOdd, or in all of them `always`.
std::vector<Difference> differences(float once, float always) {
    std::vector<Difference> all;
    for (uint32_t pixel = 0; pixel < kSize * kSize; ++pixel) {
        PassMoments moments;
        for (uint32_t pass = 0; pass < kPasses; ++pass) {
            const float odd = pixel == kOdd ? always + (pass == 3 ? once : 0) : 0;
            moments.add(grey((pass % 2 ? 0.1f : -0.1f) + odd), 8);
        }
        Difference& d = all.emplace_back();
        d.mean = moments.mean(), d.passes = moments.passes(), d.samples = moments.count();
        d.set_variance(moments.variance());
    }
    return all;
}

double sum(const std::vector<Difference>& all) {
    double total = 0;
    for (const Difference& d : all) total += double{d.mean.y};
    return total;
}

}  // namespace

TEST(RareLight, shares_one_bright_ray_among_pixels_that_see_the_like) {
    const Film film = wall(10);
    const Likeness alike(film);
    std::vector<Difference> all = differences(60, 0);
    const double before = sum(all);
    ASSERT_NEAR(all[kOdd].mean.y, 60.0f / kPasses, 1e-4f);
    share_rare(film, alike, all);
    EXPECT_NEAR(sum(all), before, 1e-4 * before);
    EXPECT_LT(all[kOdd].mean.y, 0.05f * 60 / kPasses);
    EXPECT_GT(all[kOdd - 1].mean.y, 0.01f);
    EXPECT_EQ(all[kOdd + 2].mean.y, all[kOdd + 3].mean.y) << "beyond the edge nothing is taken";
    EXPECT_NEAR(all[kOdd + 2].mean.y, 0, 1e-6f);
}

TEST(RareLight, leaves_what_comes_again_and_what_is_usual) {
    const Film film = wall(10);
    const Likeness alike(film);
    for (const auto& [once, always] : {std::pair(0.0f, 5.0f), std::pair(0.0f, 0.0f), std::pair(0.2f, 0.0f)}) {
        const std::vector<Difference> before = differences(once, always);
        std::vector<Difference> all = before;
        share_rare(film, alike, all);
        for (size_t pixel = 0; pixel < all.size(); ++pixel) {
            EXPECT_EQ(all[pixel].mean.y, before[pixel].mean.y);
            EXPECT_EQ(all[pixel].stderr_, before[pixel].stderr_);
        }
    }
}

TEST(RareLight, takes_nothing_from_a_pixel_that_is_like_no_other) {
    const Film film = wall(0);
    const Likeness alike(film);
    std::vector<Difference> all = differences(60, 0);
    for (size_t pixel = 0; pixel < all.size(); ++pixel)
        if (pixel != kOdd) all[pixel].passes = 0;
    const float before = all[kOdd].mean.y;
    share_rare(film, alike, all);
    EXPECT_EQ(all[kOdd].mean.y, before);
}

}  // namespace lumel::test
