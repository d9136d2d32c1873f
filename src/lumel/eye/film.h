// The picture under way: sums of all layers over passes.
#pragma once

#include <cstdint>
#include <vector>

#include "lumel/estimators/trust.h"
#include "lumel/math/vec.h"

namespace lumel {

/// What one eye sample, or the mean of several, saw. Radiance in W/(m2 sr).
struct EyeSample {
    Rgb emission, direct, indirect_diffuse, indirect_specular;
    Rgb albedo;          ///< diffuse + specular albedo of what is seen, 0..1
    Vec3 normal;         ///< shading normal towards the eye
    float depth = 0;     ///< m to what is seen; 0 where there is nothing
    Rgb solution_stderr; ///< standard error of the reconstructed solution
    Trust trust;         ///< of the specular estimate; all 0 where there is none

    Rgb radiance() const { return emission + direct + indirect_diffuse + indirect_specular; }
    EyeSample& operator+=(const EyeSample& o) {
        emission += o.emission, direct += o.direct, indirect_diffuse += o.indirect_diffuse, indirect_specular += o.indirect_specular;
        albedo += o.albedo, normal += o.normal, depth += o.depth, solution_stderr += o.solution_stderr, trust += o.trust;
        return *this;
    }
    EyeSample operator*(float s) const {
        return {emission * s,        direct * s, indirect_diffuse * s, indirect_specular * s, albedo * s, normal * s, depth * s,
                solution_stderr * s, trust * s};
    }
};

/// One entry a pixel, row by row from the upper left.
struct Film {
    uint32_t width = 0, height = 0;
    uint32_t passes = 0;             ///< independent passes summed up
    std::vector<EyeSample> sum;      ///< sum over passes of the mean of a pass
    std::vector<Rgb> square;         ///< sum over passes of the squared radiance of a pass

    Film(uint32_t w, uint32_t h) : width(w), height(h), sum(size_t{w} * h), square(size_t{w} * h) {}

    EyeSample mean(size_t pixel) const { return sum[pixel] * (1.0f / static_cast<float>(std::max(1u, passes))); }
    /// Standard error of the pixel: the spread of the passes and the error of the solution that all of them share.
    Rgb standard_error(size_t pixel) const;
};

}  // namespace lumel
