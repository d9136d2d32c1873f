#include "lumel/eye/film.h"

namespace lumel {

void Film::add(std::span<const PixelPass> pass) {
    for (size_t pixel = 0; pixel < pixels(); ++pixel) {
        const PixelPass& p = pass[pixel];
        const auto samples = static_cast<float>(p.samples), gathering = static_cast<float>(p.gathering);
        sum[pixel] += p.sum;
        uncorrected[pixel].add(p.sum.radiance() / samples, samples);
        if (p.gathering == 0) continue;
        diffuse[pixel].excess.add(p.excess.diffuse / gathering, gathering);
        specular[pixel].excess.add(p.excess.specular / gathering, gathering);
        diffuse[pixel].near += p.excess.near_diffuse, specular[pixel].near += p.excess.near_specular;
    }
    ++passes;
}

EyeSample Film::mean(size_t pixel) const {
    EyeSample seen = sum[pixel] * (1 / std::max(1.0f, samples(pixel)));
    // Irradiance is never negative, nor is what a diffuse surface sends.
    const Rgb corrected = seen.indirect_diffuse + correction[pixel].value.diffuse;
    seen.indirect_diffuse = {std::max(0.0f, corrected.x), std::max(0.0f, corrected.y), std::max(0.0f, corrected.z)};
    seen.indirect_specular += correction[pixel].value.specular;
    seen.solution_stderr *= 1 - correction[pixel].share;
    return seen;
}

Rgb Film::standard_error(size_t pixel) const {
    const Rgb solution = mean(pixel).solution_stderr, corrected = correction[pixel].stderr_;
    return square_root(uncorrected[pixel].variance() + solution * solution + corrected * corrected);
}

}  // namespace lumel
