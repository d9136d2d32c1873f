#include "lumel/eye/correction.h"

#include <tbb/parallel_for.h>

#include <array>
#include <optional>
#include <span>

#include "lumel/eye/area_sums.h"
#include "lumel/eye/gloss_choice.h"
#include "lumel/eye/likeness.h"

namespace lumel {

namespace {

constexpr int kReach = 2;              // pixels to each side that may be alike
constexpr int kWide = 9;               // pixels to each side, for the usual noise
constexpr float kNear = 0.05f;         // share of rays that must have met something near; twice that, and all is believed
constexpr float kEnough = 6;  // gathering samples a pixel: with fewer, less is believed, for rare bright rays may not have come yet
constexpr uint32_t kEager = 2;  // stride until then, where something is near
constexpr float kProbed = 32;  // gathering samples around that met nothing near: hardly any will
constexpr float kMostBeyond = 2.5f;  // root mean squares that a pixel may differ from those around: rare bright rays differ by more,
constexpr float kSure = 2.5f;        // but not by so many standard errors
constexpr float kMostOfNoise = 3;   // standard errors of others that gathering may find anywhere, but
constexpr float kPassesToBeSure = 2.5f;  // a few passes may agree by chance
constexpr float kMostMissing = 0.15f; // of the light that is known, that second rays may not find; twice that, and pairs count as such
constexpr float kCost = 2;       // of what gathers, a pair of rays, in eye samples without
constexpr float kChance = 1;     // standard errors that chance may explain,
constexpr float kMostChance = 2; // and of what neighbours have in common

/// lum of a variance, as if its channels were one.
float noise(Rgb variance) { return sqr(lum(square_root(variance))); }

/// One kind of indirect light at a pixel: the mean excess, the variance of that mean, the light itself, how much is near.
struct Difference {
    Rgb mean, variance;
    float stderr_ = 0;  ///< lum
    float light = 0, near = 0, samples = 0;
    float passes = 0;  ///< 0: fewer than two, nothing is known

    void set_variance(Rgb v) { variance = v, stderr_ = std::sqrt(noise(v)); }
    /// Make it no larger than `most`, but where it came again and again.
    void limit(float most) {
        const float size = std::abs(lum(mean));
        if (!(size > most) || (passes >= kPassesToBeSure && size > kSure * stderr_)) return;
        const float less = most / size;
        mean *= less, variance *= sqr(less), stderr_ *= less;
    }
};

Difference difference(const Gathered& gathered, float light) {
    const PassMoments& excess = gathered.excess;
    Difference d{.light = light, .near = gathered.near / std::max(1.0f, excess.count()), .samples = excess.count()};
    if (!excess.has_spread()) return d;
    d.mean = excess.mean(), d.passes = excess.passes();
    d.set_variance(excess.variance());
    return d;
}

/// The same of pairs in which the second ray counts by the share `paired`, and the light that is known by the rest.
Difference difference(const GatheredPairs& gathered, float paired, float light) {
    Difference d = difference(gathered, light);
    if (!(d.passes > 0)) return d;
    const float alone = 1 - paired;
    d.mean = d.mean * paired + gathered.alone.mean() * alone;
    const Rgb v = d.variance * paired + gathered.alone.variance() * alone + gathered.others.variance() * (-paired * alone);
    d.set_variance({std::max(0.0f, v.x), std::max(0.0f, v.y), std::max(0.0f, v.z)});
    return d;
}

/// Share of a difference that is worth adding, of which `real` is the square of what is not noise.
float share(float real, float variance) { return real > 0 ? real / (real + variance) : 0.0f; }

/// What noise leaves of a square that `variance` is part of.
float without_noise(float square, float variance, uint32_t passes) {
    return square - variance * (1 + kChance * std::sqrt(2 + 2 / static_cast<float>(passes - 1)));
}

struct Part {
    Rgb value, variance;
    float share = 0;

    /// The same of what is left when `taken` of all is replaced by what rays found.
    Part beside(const Difference& own, float taken) const {
        const float left = 1 - taken;
        return {value * left + own.mean * taken, variance * sqr(left) + own.variance * sqr(taken), share * left + taken};
    }
};

/// Differences of a pixel and those around that are like it, at their places.
struct Around {
    static constexpr size_t kSide = 2 * kReach + 1, kMost = kSide * kSide, kOwn = kMost / 2;
    std::array<std::optional<Difference>, kMost> at{};  // by rows, empty where the pixel is not alike

    template <class Body>
    void for_each(const Body& body) const {
        for (const auto& d : at)
            if (d) body(*d);
    }
    /// Let a rare bright ray count no more than noise makes of others. `usual`: see `part`.
    void limit(float usual) {
        float roots = 0, lights = 0, count = 0;
        for_each([&](const Difference& d) { roots += d.stderr_, lights += sqr(d.light), ++count; });
        const float most = kMostOfNoise * std::sqrt(std::max(sqr(roots / count), usual * lights / count));
        for (auto& d : at)
            if (d) d->limit(most);
    }
    /// Square of the mean without noise, which makes `variance` of it: from what every other pixel and the pixels between them agree on.
    float square_of_mean(float variance, uint32_t passes) const {
        std::array<float, 2> sum{}, count{};
        for (size_t i = 0; i < at.size(); ++i)
            if (at[i]) sum[i % 2] += lum(at[i]->mean), ++count[i % 2];
        if (!(count[0] > 0) || !(count[1] > 0)) return without_noise(sqr((sum[0] + sum[1]) / (count[0] + count[1])), variance, passes);
        // Each half has twice the variance, and so has the product of two of them for its standard error.
        return sum[0] / count[0] * (sum[1] / count[1]) - 2 * kChance * variance;
    }
    /// The larger of the mean products of what neighbours in a row, and in a column, have beyond `mean`; without the pixel itself. Noise is
    /// independent from pixel to pixel, so only what is truly there remains. Gives its standard error as well, for noise of variance
    /// `noise`.
    std::pair<float, float> common(Rgb mean, float noise) const {
        std::pair<float, float> most{0, 0};
        for (const size_t step : {size_t{1}, kSide}) {
            float sum = 0, pairs = 0;
            for (size_t i = 0; i + step < at.size(); ++i) {
                const bool wraps = step == 1 && i % kSide == kSide - 1;
                if (wraps || !at[i] || !at[i + step] || i == kOwn || i + step == kOwn) continue;
                sum += lum(at[i]->mean - mean) * lum(at[i + step]->mean - mean), ++pairs;
            }
            if (pairs > 0 && sum / pairs > most.first) most = {sum / pairs, noise / std::sqrt(pairs)};
        }
        return most;
    }
};

/// The correction of a pixel from its own difference and those of the pixels like it. `usual`: variance of differences over the square of
/// the light, in a wider neighbourhood: rare bright rays may have missed a small one.
Part part(const Around& around, float usual, uint32_t passes) {
    const Difference& own = *around.at[Around::kOwn];
    float count = 0;
    Rgb mean, variance;
    float near = 0, light = 0, samples = 0, beyond = 0;
    around.for_each([&](const Difference& d) {
        mean += d.mean, variance += d.variance, near += d.near, light += sqr(d.light), samples += d.samples, ++count;
    });
    mean *= 1 / count, variance *= 1 / count, near /= count, light /= count, samples /= count;
    if (!(near > kNear)) return {};
    // What it has beyond them is judged by what the others have: a rare bright ray is no witness for itself, unless it comes again and
    // again.
    const float others = std::max(1.0f, count - 1);
    const Rgb mean_of_others = (mean * count - own.mean) / others, differs = own.mean - mean;
    around.for_each([&](const Difference& d) { beyond += sqr(lum(d.mean - mean_of_others)) / others; });
    beyond = std::max(0.0f, beyond - sqr(lum(own.mean - mean_of_others)) / others);
    const float trust = std::min(1.0f, near / kNear - 1) * std::min(1.0f, samples / kEnough),
                of_one = std::max(noise(variance), usual * light), own_noise = std::max(sqr(own.stderr_), of_one);
    const float size = std::abs(lum(differs)), usual_size = kMostBeyond * std::sqrt(beyond);
    const bool is_sure = own.passes >= kPassesToBeSure && sqr(size) > sqr(kSure) * own_noise;
    const auto [common, error] = around.common(mean_of_others, of_one);
    const float real = common - kMostChance * error, limit = is_sure || size <= usual_size ? 1.0f : usual_size / size;
    const float single = trust * limit *
                         (is_sure ? share(without_noise(sqr(size), own_noise, passes), own_noise)
                                  : share(real, std::max(of_one, beyond - real)));
    // Where the difference from the mean is added, the mean must be as well.
    const float smooth = std::max(trust * share(around.square_of_mean(of_one / count, passes), of_one / count), single);
    return {mean * smooth + differs * single, variance * (sqr(smooth) / count + sqr(single)), smooth};
}

size_t pixel_at(const Film& film, int x, int y) { return size_t{film.width} * static_cast<size_t>(y) + static_cast<size_t>(x); }

/// Visit a pixel and those around.
template <class Body>
void for_each_around(const Film& film, int x, int y, const Body& body) {
    for (int j = y - kReach; j <= y + kReach; ++j)
        for (int i = x - kReach; i <= x + kReach; ++i)
            if (i >= 0 && j >= 0 && i < static_cast<int>(film.width) && j < static_cast<int>(film.height)) body(pixel_at(film, i, j), i, j);
}

/// The share of the second rays of pairs that leaves the least noise around a pixel. These tell what the first ones find by chance, but at
/// a contact both find hardly anything in common, and their noise adds up (control variates: Lavenberg and Welch 1981). Where the second
/// ones do not find the light that is known, bright light may be too rare for either: then only the difference tells anything.
float best_paired(const Film& film, const Likeness& alike, int x, int y) {
    const size_t pixel = pixel_at(film, x, y);
    if (!(film.diffuse[pixel].near > 0)) return 1;
    float common = 0, others = 0, missing = 0, light = 0;
    for_each_around(film, x, y, [&](size_t other, int, int) {
        const GatheredPairs& g = film.diffuse[other];
        if (!g.excess.has_spread() || !alike(pixel, other)) return;
        const float noise = lum(g.others.variance());
        missing += lum(g.others.mean()), light += lum(film.sum[other].indirect_diffuse) / film.samples(other);
        common += g.excess.count() * 0.5f * (lum(g.alone.variance()) + noise - lum(g.excess.variance())),
            others += g.excess.count() * noise;
    });
    const float trust = std::clamp(2 - std::abs(missing) / (kMostMissing * light), 0.0f, 1.0f);
    return others > 0 && trust > 0 ? 1 - trust * (1 - std::clamp(common / others, 0.0f, 1.0f)) : 1.0f;
}

/// The differences of one kind of light in all pixels.
class Differences {
public:
    /// `difference(x, y)`: of a pixel.
    template <class Of>
    Differences(const Film& film, const Likeness& alike, const Of& difference)
        : film_(film),
          alike_(alike),
          all_(differences(film, difference)),
          noises_(film.width, film.height, [&](size_t pixel) { return double{all_[pixel].stderr_}; }),
          lights_(film.width, film.height, [&](size_t pixel) { return double{std::abs(all_[pixel].light)}; }) {}

    const Difference& operator[](size_t pixel) const { return all_[pixel]; }
    /// The correction of a pixel.
    Part at(int x, int y) const {
        const size_t pixel = pixel_at(film_, x, y);
        Around around;
        for_each_around(film_, x, y, [&](size_t other, int i, int j) {
            if (other != pixel && (!(all_[other].passes > 0) || !alike_(pixel, other))) return;
            around.at[static_cast<size_t>(j - y + kReach) * Around::kSide + static_cast<size_t>(i - x + kReach)] = all_[other];
        });
        const double roots = noises_.around(x, y, kWide), light = lights_.around(x, y, kWide);
        const float usual = light > 0 ? static_cast<float>(sqr(roots / light)) : 0;
        around.limit(usual);
        return part(around, usual, film_.passes);
    }

private:
    template <class Of>
    static std::vector<Difference> differences(const Film& film, const Of& difference) {
        std::vector<Difference> all(film.pixels());
        tbb::parallel_for(0, static_cast<int>(film.height), [&](int y) {
            for (int x = 0; x < static_cast<int>(film.width); ++x) all[pixel_at(film, x, y)] = difference(x, y);
        });
        return all;
    }

    const Film& film_;
    const Likeness& alike_;
    std::vector<Difference> all_;
    AreaSums noises_, lights_;  // roots of the variances of the differences, and the light
};

Differences diffuse_differences(const Film& film, const Likeness& alike) {
    return {film, alike, [&](int x, int y) {
                const size_t pixel = pixel_at(film, x, y);
                return difference(film.diffuse[pixel], best_paired(film, alike, x, y),
                                  lum(film.sum[pixel].indirect_diffuse) / film.samples(pixel));
            }};
}

Differences specular_differences(const Film& film, const Likeness& alike) {
    return {film, alike, [&](int x, int y) {
                const size_t pixel = pixel_at(film, x, y);
                return difference(film.specular[pixel], lum(film.sum[pixel].indirect_specular) / film.samples(pixel));
            }};
}

/// Where gathering counts, its rays and eye samples should be in proportion to the square roots of variance over cost. `of_ray`: variance
/// that one gathering ray leaves in the correction.
uint32_t best_stride(const Film& film, size_t pixel, float of_ray) {
    const float of_sample = lum(film.uncorrected[pixel].variance()) * film.samples(pixel);
    const uint32_t most = film.diffuse[pixel].excess.count() < kEnough ? kEager : Correction::kProbe;
    if (!(of_ray * sqr(static_cast<float>(most)) > kCost * of_sample)) return most;
    return static_cast<uint32_t>(std::max(1.0f, std::round(std::sqrt(kCost * of_sample / of_ray))));
}

}  // namespace

void correct(Film& film, bool gloss) {
    const Likeness alike(film);
    const Differences diffuse = diffuse_differences(film, alike), specular = specular_differences(film, alike);
    const AreaSums samples(film.width, film.height, [&](size_t pixel) { return double{diffuse[pixel].samples}; });
    const AreaSums nears(film.width, film.height, [&](size_t pixel) { return diffuse[pixel].near > 0 || specular[pixel].near > 0; });
    const std::vector<GlossChoice> choices = gloss ? choose_gloss(film) : std::vector<GlossChoice>{};
    tbb::parallel_for(0, static_cast<int>(film.height), [&](int y) {
        for (int x = 0; x < static_cast<int>(film.width); ++x) {
            const size_t pixel = pixel_at(film, x, y);
            Correction& correction = film.correction[pixel];
            correction = {};
            const uint32_t material = film.material[pixel];
            const GlossChoice choice = material < choices.size() ? choices[material] : GlossChoice{};
            correction.gloss = choice.gather;
            const bool near = nears.around(x, y, kReach) > 0;
            if (!near && samples.around(x, y, kReach) > double{kProbed}) correction.stride = Correction::kSeldom;
            if (!near && !(choice.share > 0)) continue;
            // A share of all gloss is that of rays; where something is near, the rest is mended as diffuse light is.
            const Difference &own_d = diffuse[pixel], &own_s = specular[pixel];
            const Part d = near ? diffuse.at(x, y) : Part{}, s = (near ? specular.at(x, y) : Part{}).beside(own_s, choice.share);
            correction.value = {d.value, s.value};
            correction.stderr_ = square_root(d.variance + s.variance);
            const float light_d = std::abs(own_d.light), light_s = std::abs(own_s.light);
            if (light_d + light_s > 0) correction.share = (d.share * light_d + s.share * light_s) / (light_d + light_s);
            // Even where noise still hides what is off, it must be found.
            const float of_ray_d = std::max(lum(d.variance), lum(own_d.variance) / Around::kMost) * own_d.samples;
            if (near) correction.stride = best_stride(film, pixel, of_ray_d + lum(s.variance) * own_s.samples);
        }
    });
}

}  // namespace lumel
