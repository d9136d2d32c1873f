#include "lumel/eye/film.h"

namespace lumel {

EyeSample Film::mean(size_t pixel) const {
    EyeSample seen = sum[pixel] * (1.0f / static_cast<float>(std::max(1u, passes)));
    // Irradiance is never negative, nor is what a diffuse surface sends.
    const Rgb diffuse = seen.indirect_diffuse + correction[pixel].value.diffuse;
    seen.indirect_diffuse = {std::max(0.0f, diffuse.x), std::max(0.0f, diffuse.y), std::max(0.0f, diffuse.z)};
    seen.indirect_specular += correction[pixel].value.specular;
    seen.solution_stderr *= 1 - correction[pixel].share;
    return seen;
}

Rgb Film::standard_error(size_t pixel) const {
    const Rgb uncorrected = sum[pixel].radiance() / static_cast<float>(std::max(1u, passes));
    const auto channel = [&](float value, float squares, float solution, float correction_error) {
        if (passes < 2) return solution;
        const auto n = static_cast<float>(passes);
        const float spread = std::max(0.0f, squares / n - value * value) / (n - 1);
        return std::sqrt(spread + solution * solution + correction_error * correction_error);
    };
    const Rgb s = square[pixel], e = mean(pixel).solution_stderr, c = correction[pixel].stderr_;
    return {channel(uncorrected.x, s.x, e.x, c.x), channel(uncorrected.y, s.y, e.y, c.y), channel(uncorrected.z, s.z, e.z, c.z)};
}

}  // namespace lumel
