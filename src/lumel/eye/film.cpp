#include "lumel/eye/film.h"

namespace lumel {

Rgb Film::standard_error(size_t pixel) const {
    const EyeSample seen = mean(pixel);
    const auto channel = [&](float value, float squares, float solution) {
        if (passes < 2) return solution;
        const auto n = static_cast<float>(passes);
        const float spread = std::max(0.0f, squares / n - value * value) / (n - 1);
        return std::sqrt(spread + solution * solution);
    };
    const Rgb m = seen.radiance(), s = square[pixel], e = seen.solution_stderr;
    return {channel(m.x, s.x, e.x), channel(m.y, s.y, e.y), channel(m.z, s.z, e.z)};
}

}  // namespace lumel
