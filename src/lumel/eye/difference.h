// What gathering found at a pixel beyond the reconstruction, with its noise.
#pragma once

#include "lumel/eye/film.h"

namespace lumel {

/// lum of a variance, as if its channels were one.
inline float noise(Rgb variance) { return sqr(lum(square_root(variance))); }

/// One kind of indirect light at a pixel: the mean excess, the variance of that mean, the light itself, how much is near.
struct Difference {
    Rgb mean, variance;
    float stderr_ = 0;  ///< lum
    float light = 0, near = 0, samples = 0;
    float passes = 0;  ///< 0: fewer than two, nothing is known

    static constexpr float kSure = 2.5f;            ///< standard errors, but
    static constexpr float kPassesToBeSure = 2.5f;  ///< a few passes may agree by chance

    /// Is what differs by `size`, with that error, no single ray?
    bool is_sure(float size, float error) const { return passes >= kPassesToBeSure && size > kSure * error; }
    void set_variance(Rgb v) { variance = v, stderr_ = std::sqrt(noise(v)); }
    /// Make it no larger than `most`, but where it came again and again.
    void limit(float most) {
        const float size = std::abs(lum(mean));
        if (!(size > most) || is_sure(size, stderr_)) return;
        const float less = most / size;
        mean *= less, variance *= sqr(less), stderr_ *= less;
    }
};

inline Difference difference(const Gathered& gathered, float light) {
    const PassMoments& excess = gathered.excess;
    Difference d{.light = light, .near = gathered.near / std::max(1.0f, excess.count()), .samples = excess.count()};
    if (!excess.has_spread()) return d;
    d.mean = excess.mean(), d.passes = excess.passes();
    d.set_variance(excess.variance());
    return d;
}

/// The same of pairs in which the second ray counts by the share `paired`, and the light that is known by the rest.
inline Difference difference(const GatheredPairs& gathered, float paired, float light) {
    Difference d = difference(gathered, light);
    if (!(d.passes > 0)) return d;
    const float alone = 1 - paired;
    d.mean = d.mean * paired + gathered.alone.mean() * alone;
    const Rgb v = d.variance * paired + gathered.alone.variance() * alone + gathered.others.variance() * (-paired * alone);
    d.set_variance({std::max(0.0f, v.x), std::max(0.0f, v.y), std::max(0.0f, v.z)});
    return d;
}

}  // namespace lumel
