// Eye samples go where the picture is noisy, and their error bars hold for passes of any size.
#include <gtest/gtest.h>

#include <numeric>

#include "lumel/eye/allocation.h"
#include "scenes.h"
#include "stats.h"

namespace lumel::test {

namespace {

constexpr uint32_t kSize = 48;

/// Standard deviation of one sample of a pixel: the right quarter of the picture is noisy.
float deviation(uint32_t pixel) { return pixel % kSize >= kSize * 3 / 4 ? 0.8f : 0.05f; }

/// A film of radiance 1 with noise, after passes of these sizes; evenly dealt out, or as `samples_of_pass` wants it.
Film film_of(std::span<const uint32_t> sizes, bool even, uint64_t seed) {
    Film film(kSize, kSize);
    for (uint32_t size : sizes) {
        const auto samples = even ? std::vector<uint32_t>(film.pixels(), size) : samples_of_pass(film, size);
        std::vector<PixelPass> pass(film.pixels());
        for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
            Rng rng(key(seed, pixel, film.passes));
            for (; pass[pixel].samples < samples[pixel]; ++pass[pixel].samples)
                pass[pixel].sum.direct += grey(1 + deviation(pixel) * std::sqrt(12.0f) * (rng.uniform() - 0.5f));
        }
        film.add(pass);
    }
    return film;
}

constexpr std::array<uint32_t, 6> kSizes{1, 1, 2, 4, 8, 16};
constexpr uint32_t kAll = 32;

}  // namespace

TEST(Allocation, deals_out_all_samples_by_the_root_of_the_variance) {
    const Film film = film_of(kSizes, false, 1);
    double all = 0, noisy = 0;
    for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) {
        const double samples = film.samples(pixel);
        EXPECT_GE(samples, kSizes.size());
        all += samples;
        if (pixel % kSize >= kSize * 3 / 4) noisy += samples;
    }
    EXPECT_NEAR(all, kAll * kSize * kSize, 6);
    // The noisy quarter asks for 16 times the samples of the rest: 0.84 of all, 0.72 with the part that is dealt out evenly.
    EXPECT_GT(noisy / all, 0.65);
    EXPECT_LT(noisy / all, 0.80);
}

TEST(Allocation, makes_the_error_less_and_no_bias) {
    std::vector<double> gains, means;
    for (uint64_t seed = 0; seed < 12; ++seed) {
        const auto square_error = [](const Film& film) {
            double sum = 0;
            for (uint32_t pixel = 0; pixel < film.pixels(); ++pixel) sum += sqr(film.mean(pixel).direct.x - 1);
            return sum;
        };
        const Film adaptive = film_of(kSizes, false, seed);
        gains.push_back(square_error(film_of(kSizes, true, seed)) / square_error(adaptive));
        double mean = 0;
        for (uint32_t pixel = 0; pixel < adaptive.pixels(); ++pixel) mean += adaptive.mean(pixel).direct.x / float{kSize * kSize};
        means.push_back(mean);
    }
    // Even samples leave 0.25 * 0.8^2 / 32; with 0.72 of them in the noisy quarter it is a third of that.
    const Mean gain = mean_of(gains), mean = mean_of(means);
    EXPECT_GT(gain.value, 2.2) << "+- " << gain.error;
    EXPECT_LT(std::abs(mean.value - 1), student_quantile(1e-4, mean.count - 1) * mean.error);
}

TEST(Allocation, is_even_without_noise_and_while_nothing_is_known) {
    Film film(4, 4);
    EXPECT_EQ(samples_of_pass(film, 5), std::vector<uint32_t>(16, 5));
    std::vector<PixelPass> pass(16);
    for (PixelPass& pixel : pass) pixel.samples = 5, pixel.sum.direct = grey(5);
    for (int i = 0; i < 3; ++i) film.add(pass);
    EXPECT_EQ(samples_of_pass(film, 7), std::vector<uint32_t>(16, 7));
}

TEST(PassMoments, tell_the_variance_of_their_mean_for_passes_of_any_size) {
    constexpr int kTrials = 20000;
    std::vector<double> variances, square_errors;
    for (int trial = 0; trial < kTrials; ++trial) {
        PassMoments moments;
        Rng rng(key(9, static_cast<uint64_t>(trial)));
        for (uint32_t size : kSizes) {
            EXPECT_EQ(moments.has_spread(), moments.count() > 1);
            float sum = 0;
            for (uint32_t i = 0; i < size; ++i) sum += rng.uniform();
            moments.add(grey(sum / static_cast<float>(size)), static_cast<float>(size));
        }
        EXPECT_EQ(moments.count(), kAll);
        variances.push_back(moments.variance().x);
        square_errors.push_back(sqr(moments.mean().x - 0.5f));
    }
    constexpr double kTruth = 1.0 / 12 / kAll;
    for (const auto& values : {variances, square_errors}) EXPECT_GT(mean_of(values).p_value(kTruth), 1e-4) << mean_of(values).value;
}

}  // namespace lumel::test
