#include "lumel/eye/correction.h"

#include <tbb/parallel_for.h>

#include <array>
#include <optional>
#include <span>

#include "lumel/eye/area_sums.h"
#include "lumel/eye/around.h"
#include "lumel/eye/difference.h"
#include "lumel/eye/gloss_choice.h"
#include "lumel/eye/likeness.h"
#include "lumel/eye/rare_light.h"

namespace lumel {

namespace {

constexpr int kReach = 2;              // pixels to each side that may be alike
constexpr int kWide = 9;               // pixels to each side, for the usual noise
constexpr float kNear = 0.05f;         // share of rays that must have met something near; twice that, and all is believed
constexpr float kEnough = 6;  // gathering samples a pixel: with fewer, less is believed, for rare bright rays may not have come yet
constexpr uint32_t kEager = 2;  // stride until then, where something is near
constexpr float kProbed = 32;  // gathering samples around that met nothing near: hardly any will
constexpr float kMostBeyond = 2.5f;  // root mean squares that a pixel may differ from those around: rare bright rays differ by more,
constexpr float kMostOfNoise = 3;   // standard errors of others that gathering may find anywhere, but
constexpr float kMostMissing = 0.15f; // of the light that is known, that second rays may not find; twice that, and pairs count as such
constexpr float kCost = 2;       // of what gathers, a pair of rays, in eye samples without
constexpr float kChance = 1;     // standard errors that chance may explain,
constexpr float kMostChance = 2; // and of what neighbours have in common,
constexpr float kMostAlone = 2.5f; // and of what the pixels around one agree on, if those further on do not
constexpr float kApart = 0.3f; // of the pixels around, those whose neighbourhoods count as different ones

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
    /// Square of the mean, to which noise adds nothing: from what every other pixel and the pixels between them agree on. Nothing if one of
    /// these has no pixel.
    std::optional<float> square_of_mean() const {
        std::array<float, 2> sum{}, count{};
        for (size_t i = 0; i < at.size(); ++i)
            if (at[i]) sum[i % 2] += lum(at[i]->mean), ++count[i % 2];
        if (!(count[0] > 0) || !(count[1] > 0)) return {};
        return sum[0] / count[0] * (sum[1] / count[1]);
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

/// Squares of the means around a pixel, and summed over the pixels like it that are around it.
struct Agreed {
    std::optional<float> here;
    float sum = 0, count = 0;

    /// What is no noise in the square of the mean around a pixel, if that has `variance`. Means in a row of neighbourhoods share most of
    /// their pixels, but one that is far from 0 by chance stands among others that are not.
    std::optional<float> without_noise(float variance) const {
        if (!here) return {};
        // Each half has twice the variance, and so has the product of two of them for its standard error.
        const float error = 2 * variance;
        return std::max(*here - kMostAlone * error, sum / count - kChance * error / std::sqrt(count * kApart));
    }
};

/// The correction of a pixel from its own difference and those of the pixels like it. `usual`: variance of differences over the square of
/// the light, in a wider neighbourhood: rare bright rays may have missed a small one.
Part part(const Around& around, float usual, uint32_t passes, const Agreed& agreed) {
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
    const bool is_sure = own.is_sure(size, std::sqrt(own_noise));
    const auto [common, error] = around.common(mean_of_others, of_one);
    const float real = common - kMostChance * error, limit = is_sure || size <= usual_size ? 1.0f : usual_size / size;
    const float single = trust * limit *
                         (is_sure ? share(without_noise(sqr(size), own_noise, passes), own_noise)
                                  : share(real, std::max(of_one, beyond - real)));
    // Where the difference from the mean is added, the mean must be as well.
    const float of_mean = of_one / count, square = agreed.without_noise(of_mean).value_or(without_noise(sqr(lum(mean)), of_mean, passes));
    const float smooth = std::max(trust * share(square, of_mean), single);
    return {mean * smooth + differs * single, variance * (sqr(smooth) / count + sqr(single)), smooth};
}

/// The share of the second rays of pairs that leaves the least noise around a pixel. These tell what the first ones find by chance, but at
/// a contact both find hardly anything in common, and their noise adds up (control variates: Lavenberg and Welch 1981). Where the second
/// ones do not find the light that is known, bright light may be too rare for either: then only the difference tells anything.
float best_paired(const Film& film, const Likeness& alike, int x, int y) {
    const size_t pixel = pixel_at(film, x, y);
    if (!(film.diffuse[pixel].near > 0)) return 1;
    float common = 0, others = 0, missing = 0, light = 0;
    for_each_around(film, x, y, kReach, [&](size_t other, int, int) {
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

/// `difference(x, y)` of every pixel.
template <class Of>
std::vector<Difference> differences(const Film& film, const Of& difference) {
    std::vector<Difference> all(film.pixels());
    tbb::parallel_for(0, static_cast<int>(film.height), [&](int y) {
        for (int x = 0; x < static_cast<int>(film.width); ++x) all[pixel_at(film, x, y)] = difference(x, y);
    });
    return all;
}

std::vector<Difference> diffuse_differences(const Film& film, const Likeness& alike) {
    return differences(film, [&](int x, int y) {
        const size_t pixel = pixel_at(film, x, y);
        return difference(film.diffuse[pixel], best_paired(film, alike, x, y), lum(film.sum[pixel].indirect_diffuse) / film.samples(pixel));
    });
}

std::vector<Difference> specular_differences(const Film& film, const Likeness& alike) {
    std::vector<Difference> all = differences(film, [&](int x, int y) {
        const size_t pixel = pixel_at(film, x, y);
        return difference(film.specular[pixel], lum(film.sum[pixel].indirect_specular) / film.samples(pixel));
    });
    share_rare(film, alike, all);
    return all;
}

/// Corrections of one kind of light from the differences of all pixels.
class Corrections {
public:
    /// `nears`: pixels where something is near.
    Corrections(const Film& film, const Likeness& alike, const AreaSums& nears, std::span<const Difference> differences)
        : film_(film),
          alike_(alike),
          differences_(differences),
          noises_(film.width, film.height, [&](size_t pixel) { return double{differences[pixel].stderr_}; }),
          lights_(film.width, film.height, [&](size_t pixel) { return double{std::abs(differences[pixel].light)}; }),
          agreed_(film.pixels()) {
        tbb::parallel_for(0, static_cast<int>(film.height), [&](int y) {
            for (int x = 0; x < static_cast<int>(film.width); ++x)
                if (nears.around(x, y, kReach) > 0) agreed_[pixel_at(film, x, y)] = around(x, y, usual(x, y)).square_of_mean();
        });
    }

    /// The correction of a pixel near to which something is.
    Part at(int x, int y) const {
        const float noise_of_light = usual(x, y);
        return part(around(x, y, noise_of_light), noise_of_light, film_.passes, agreed(x, y));
    }

private:
    /// Variance of differences over the square of the light, in a wide neighbourhood.
    float usual(int x, int y) const {
        const double roots = noises_.around(x, y, kWide), light = lights_.around(x, y, kWide);
        return light > 0 ? static_cast<float>(sqr(roots / light)) : 0;
    }
    Around around(int x, int y, float usual) const {
        const size_t pixel = pixel_at(film_, x, y);
        Around around;
        for_each_around(film_, x, y, kReach, [&](size_t other, int i, int j) {
            if (other != pixel && (!(differences_[other].passes > 0) || !alike_(pixel, other))) return;
            around.at[static_cast<size_t>(j - y + kReach) * Around::kSide + static_cast<size_t>(i - x + kReach)] = differences_[other];
        });
        around.limit(usual);
        return around;
    }
    Agreed agreed(int x, int y) const {
        const size_t pixel = pixel_at(film_, x, y);
        Agreed all{.here = agreed_[pixel]};
        for_each_around(film_, x, y, kReach, [&](size_t other, int, int) {
            if (agreed_[other] && (other == pixel || alike_(pixel, other))) all.sum += *agreed_[other], ++all.count;
        });
        return all;
    }

    const Film& film_;
    const Likeness& alike_;
    std::span<const Difference> differences_;
    AreaSums noises_, lights_;  // roots of the variances of the differences, and the light
    std::vector<std::optional<float>> agreed_;  // squares of the means around each pixel near to which something is
};

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
    const std::vector<Difference> diffuse = diffuse_differences(film, alike), specular = specular_differences(film, alike);
    const AreaSums samples(film.width, film.height, [&](size_t pixel) { return double{diffuse[pixel].samples}; });
    const AreaSums nears(film.width, film.height, [&](size_t pixel) { return diffuse[pixel].near > 0 || specular[pixel].near > 0; });
    const Corrections diffuse_corrections(film, alike, nears, diffuse), specular_corrections(film, alike, nears, specular);
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
            const Part d = near ? diffuse_corrections.at(x, y) : Part{},
                       s = (near ? specular_corrections.at(x, y) : Part{}).beside(own_s, choice.share);
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
