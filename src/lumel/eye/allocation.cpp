#include "lumel/eye/allocation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <functional>

namespace lumel {

namespace {

constexpr int kReach = 1;           // pixels to each side whose variances are averaged
constexpr float kEven = 0.2f;       // share of the samples that is dealt out evenly: few passes may have missed what is rare
constexpr float kMostAtOnce = 16;   // times the mean
constexpr int kBisections = 16;

/// Variance of one sample over L^2 + e for every pixel, summed over channels.
std::vector<float> relative_variances(const Film& film) {
    const float e = Film::kDark * sqr(static_cast<float>(film.mean_light()));
    std::vector<float> relative(film.pixels());
    tbb::parallel_for(size_t{0}, film.pixels(), [&](size_t pixel) {
        const Rgb mean = film.uncorrected[pixel].mean(), corrected = film.correction[pixel].stderr_;
        const Rgb variance = (film.uncorrected[pixel].variance() + corrected * corrected) * film.samples(pixel);
        const auto channel = [&](float v, float l) { return v > 0 ? v / (l * l + e) : 0.0f; };
        relative[pixel] = channel(variance.x, mean.x) + channel(variance.y, mean.y) + channel(variance.z, mean.z);
    });
    return relative;
}

/// Square roots of the means over the pixels around.
std::vector<float> smooth_roots(const Film& film, const std::vector<float>& values) {
    const int width = static_cast<int>(film.width), height = static_cast<int>(film.height);
    std::vector<float> roots(values.size());
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            float sum = 0, count = 0;
            for (int j = std::max(0, y - kReach); j <= std::min(height - 1, y + kReach); ++j)
                for (int i = std::max(0, x - kReach); i <= std::min(width - 1, x + kReach); ++i)
                    sum += values[static_cast<size_t>(j) * film.width + static_cast<size_t>(i)], ++count;
            roots[static_cast<size_t>(y) * film.width + static_cast<size_t>(x)] = std::sqrt(sum / count);
        }
    });
    return roots;
}

/// The same whatever the number of threads.
template <class Value>
double sum_in_parallel(size_t count, const Value& value) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<size_t>(0, count, 4096), 0.0,
        [&](const auto& range, double sum) {
            for (size_t i = range.begin(); i < range.end(); ++i) sum += value(i);
            return sum;
        },
        std::plus{});
}

}  // namespace

std::vector<uint32_t> samples_of_pass(const Film& film, uint32_t mean) {
    std::vector<uint32_t> samples(film.pixels(), mean);
    if (film.passes < 2 || mean < 2) return samples;
    const std::vector<float> need = smooth_roots(film, relative_variances(film));
    const auto pixels = static_cast<double>(film.pixels());
    const double mean_need = sum_in_parallel(need.size(), [&](size_t pixel) { return double{need[pixel]}; }) / pixels;
    if (!(mean_need > 0)) return samples;

    // A pixel shall have `level` samples by its need, those of the passes before included: bisect the level that takes what there is.
    const auto most = kMostAtOnce * static_cast<float>(mean);
    const auto wanted = [&](size_t pixel, double level) {
        const double share = double{kEven} + double{1 - kEven} * double{need[pixel]} / mean_need;
        return std::clamp(static_cast<float>(level * share) - film.samples(pixel), 1.0f, most);
    };
    const double so_far = sum_in_parallel(film.pixels(), [&](size_t pixel) { return double{film.samples(pixel)}; });
    double low = 0, high = 2 * (mean + so_far / pixels);
    for (int step = 0; step < kBisections; ++step) {
        const double level = 0.5 * (low + high);
        const double sum = sum_in_parallel(film.pixels(), [&](size_t pixel) { return double{wanted(pixel, level)}; });
        (sum > mean * pixels ? high : low) = level;
    }
    // Round so that what is cut off goes to the next pixel.
    float rest = 0;
    for (size_t pixel = 0; pixel < film.pixels(); ++pixel) {
        rest += wanted(pixel, low);
        samples[pixel] = static_cast<uint32_t>(std::max(1.0f, rest));
        rest -= static_cast<float>(samples[pixel]);
    }
    return samples;
}

}  // namespace lumel
