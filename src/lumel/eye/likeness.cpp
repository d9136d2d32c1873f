#include "lumel/eye/likeness.h"

#include <tbb/parallel_for.h>

namespace lumel {

Likeness::Likeness(const Film& film) : seen_(film.pixels()) {
    tbb::parallel_for(size_t{0}, film.pixels(), [&](size_t pixel) {
        const EyeSample& sum = film.sum[pixel];
        const float over = 1 / std::max(1.0f, film.samples(pixel)), length2 = dot(sum.normal, sum.normal);
        if (length2 > 0) seen_[pixel] = {sum.normal * (1 / std::sqrt(length2)), sum.depth * over, lum(sum.albedo) * over};
    });
}

}  // namespace lumel
