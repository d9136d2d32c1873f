// What single bright rays find is shared among pixels; what comes again stays where it is.
#include <gtest/gtest.h>

#include "lumel/eye/rare_light.h"
#include "scenes.h"

namespace lumel::test {

namespace {

constexpr uint32_t kSize = 16, kOdd = 8 * kSize + 8, kPasses = 12;

/// A film of a wall that is turned by a right angle at column `edge`, and has another gloss in columns `first` to `last`.
Film wall(uint32_t edge, uint32_t first = 0, uint32_t last = 0) {
    Film film(kSize, kSize);
    std::vector<PixelPass> pass(film.pixels());
    for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
        const uint32_t x = pixel % kSize;
        pass[pixel].material = x >= first && x < last ? 1 : 0;
        pass[pixel].samples = 1, pass[pixel].sum.albedo = grey(0.5f), pass[pixel].sum.depth = 2;
        pass[pixel].sum.normal = x < edge ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    }
    film.add(pass);
    return film;
}

/// Differences of +-0.1 a pass; in kOdd `once` more in one pass, and in all of them `always` more, give or take `spread`.
std::vector<Difference> differences(float once, float always = 0, float spread = 0) {
    std::vector<Difference> all;
    for (uint32_t pixel = 0; pixel < kSize * kSize; ++pixel) {
        PassMoments moments;
        for (uint32_t pass = 0; pass < kPasses; ++pass) {
            const float sign = pass % 2 ? 1 : -1, odd = pixel == kOdd ? always + sign * spread + (pass == 3 ? once : 0) : 0;
            moments.add(grey(sign * 0.1f + odd), 8);
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

TEST(RareLight, shares_one_bright_ray_among_pixels_that_show_the_same_gloss) {
    // The wall ends beside the pixel, or its gloss does.
    for (const Film& film : {wall(10), wall(kSize, 10, kSize)}) {
        std::vector<Difference> all = differences(60);
        const double before = sum(all);
        const float error = all[kOdd].stderr_;
        ASSERT_NEAR(all[kOdd].mean.y, 60.0f / kPasses, 1e-4f);
        share_rare(film, Likeness(film), all);
        EXPECT_NEAR(sum(all), before, 1e-4 * before);
        EXPECT_LT(all[kOdd].mean.y, 0.05f * 60 / kPasses);
        EXPECT_GT(all[kOdd - 1].mean.y, 0.01f);
        EXPECT_GT(all[kOdd - 1].stderr_, error / 81) << "what was given is as uncertain as it was";
        EXPECT_NEAR(all[kOdd + 2].mean.y, 0, 1e-6f) << "beyond the edge nothing is taken";
    }
}

TEST(RareLight, leaves_what_comes_again_and_what_is_usual) {
    const Film film = wall(10);
    for (const std::vector<Difference>& before : {differences(0), differences(0.2f), differences(0, 5), differences(0, 5, 3)}) {
        std::vector<Difference> all = before;
        share_rare(film, Likeness(film), all);
        for (size_t pixel = 0; pixel < all.size(); ++pixel) {
            EXPECT_EQ(all[pixel].mean.y, before[pixel].mean.y);
            EXPECT_EQ(all[pixel].stderr_, before[pixel].stderr_);
        }
    }
    std::vector<Difference> noise = differences(0, 5, 9);
    share_rare(film, Likeness(film), noise);
    EXPECT_LT(noise[kOdd].mean.y, 1) << "as much, but within its errors";
}

TEST(RareLight, takes_nothing_from_a_pixel_that_hardly_any_other_is_like) {
    // A strip of gloss that is one pixel wide.
    const Film film = wall(kSize, 8, 9);
    std::vector<Difference> all = differences(60);
    const float before = all[kOdd].mean.y;
    share_rare(film, Likeness(film), all);
    EXPECT_EQ(all[kOdd].mean.y, before);
}

}  // namespace lumel::test
