#include "lumel/eye/film.h"

#include <tbb/parallel_for.h>

namespace lumel {

namespace {

/// Add a correction, which takes no more light than there is.
Rgb corrected(Rgb light, Rgb correction) {
    const auto channel = [](float l, float c) { return std::max(l + c, std::min(l, 0.0f)); };
    return {channel(light.x, correction.x), channel(light.y, correction.y), channel(light.z, correction.z)};
}

}  // namespace

void Film::add(std::span<const PixelPass> pass) {
    tbb::parallel_for(size_t{0}, pixels(), [&](size_t pixel) {
        const PixelPass& p = pass[pixel];
        const auto samples = static_cast<float>(p.samples);
        sum[pixel] += p.sum;
        uncorrected[pixel].add(p.sum.radiance() / samples, samples);
        if (material[pixel] == PixelPass::kNoMaterial) material[pixel] = p.material;
        diffuse[pixel].add(p.pairs, p.excess.near_diffuse, p.diffuse);
        specular[pixel].add(p.excess.specular, p.excess.near_specular, p.specular);
    });
    ++passes;
}

double Film::mean_light() const {
    double light = 0;
    for (const PassMoments& pixel : uncorrected) light += double{lum(pixel.mean())};
    return light / static_cast<double>(pixels());
}

EyeSample Film::mean(size_t pixel) const {
    EyeSample seen = sum[pixel] * (1 / std::max(1.0f, samples(pixel)));
    seen.indirect_diffuse = corrected(seen.indirect_diffuse, correction[pixel].value.diffuse);
    seen.indirect_specular = corrected(seen.indirect_specular, correction[pixel].value.specular);
    seen.solution_stderr *= 1 - correction[pixel].share;
    return seen;
}

Rgb Film::standard_error(size_t pixel) const {
    // A few passes may agree by chance: for its light, a sample is held to vary at least as it does in the mean pixel around.
    const auto x = static_cast<uint32_t>(pixel % width), y = static_cast<uint32_t>(pixel / width);
    Rgb around;
    float count = 0;
    for (uint32_t j = y > 0 ? y - 1 : 0; j <= y + 1 && j < height; ++j)
        for (uint32_t i = x > 0 ? x - 1 : 0; i <= x + 1 && i < width; ++i, ++count) {
            const PassMoments& other = uncorrected[size_t{width} * j + i];
            const float light = lum(other.mean());
            if (light > 0) around += other.variance() * (other.count() / sqr(light));
        }
    const Rgb own = uncorrected[pixel].variance(),
              least = around * (sqr(lum(uncorrected[pixel].mean())) / (count * std::max(1.0f, samples(pixel))));
    const Rgb spread = max(own, least);
    const Rgb solution = mean(pixel).solution_stderr, mended = correction[pixel].stderr_;
    return square_root(spread + solution * solution + mended * mended);
}

}  // namespace lumel
