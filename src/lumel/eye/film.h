// The picture under way: sums of all layers over passes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/estimators/trust.h"
#include "lumel/eye/pass_moments.h"
#include "lumel/math/vec.h"

namespace lumel {

/// What one eye sample, or the mean of several, saw. Radiance in W/(m2 sr).
struct EyeSample {
    Rgb emission, direct, indirect_diffuse, indirect_specular;
    Rgb albedo;          ///< diffuse + specular albedo of what is seen, 0..1
    Vec3 normal;         ///< shading normal towards the eye
    float depth = 0;     ///< m to what is seen; 0 where there is nothing
    Rgb solution_stderr; ///< standard error of the reconstructed solution,
    Rgb specular_stderr; ///< and of its specular part
    Trust trust;         ///< of the specular estimate; all 0 where there is none

    Rgb radiance() const { return emission + direct + indirect_diffuse + indirect_specular; }
    EyeSample& operator+=(const EyeSample& o) {
        emission += o.emission, direct += o.direct, indirect_diffuse += o.indirect_diffuse, indirect_specular += o.indirect_specular;
        albedo += o.albedo, normal += o.normal, depth += o.depth;
        solution_stderr += o.solution_stderr, specular_stderr += o.specular_stderr, trust += o.trust;
        return *this;
    }
    EyeSample operator*(float s) const {
        return {emission * s, direct * s, indirect_diffuse * s, indirect_specular * s, albedo * s,
                normal * s,   depth * s,  solution_stderr * s,  specular_stderr * s,   trust * s};
    }
};

/// What gathering found at a pixel beyond the reconstruction: indirect light, W/(m2 sr).
struct Excess {
    Rgb diffuse, specular;
    float near_diffuse = 0, near_specular = 0;  ///< shares of gathering rays that met something near, 0..1
};

/// What is added to the reconstruction of a pixel: see `correct`.
struct Correction {
    Excess value;
    Rgb stderr_;         ///< of the value
    float share = 0;     ///< of what was gathered in the indirect light: 0 where the reconstruction is kept, 1 where it is replaced
    uint32_t stride = kProbe;  ///< one eye sample in so many should gather
    bool gloss = false;        ///< every eye sample should follow the specular lobe

    static constexpr uint32_t kProbe = 8;    ///< while nothing is known; where gathering changes the pixel, all do
    static constexpr uint32_t kSeldom = 32;  ///< where nothing is near
};

/// Pairs of gathering rays, summed: what they found from the point and from the patches that its light is reconstructed from, and that
/// light.
struct Pairs {
    Rgb here, there, known;
};

/// One kind of light that was gathered at a pixel.
struct Gathered {
    PassMoments excess;
    float near = 0;  ///< gathering rays that met something near

    uint32_t rays() const { return static_cast<uint32_t>(excess.count()); }
    /// Add the sums over the gathering rays of a pass.
    void add(Rgb excess_of_pass, float near_of_pass, uint32_t rays) {
        if (rays == 0) return;
        const auto count = static_cast<float>(rays);
        excess.add(excess_of_pass / count, count);
        near += near_of_pass;
    }
};

/// The same of diffuse light, which is gathered by pairs.
struct GatheredPairs : Gathered {
    PassMoments alone;   ///< what the first rays found beyond the light that is known,
    PassMoments others;  ///< and the second ones. The difference of both is `excess`

    void add(const Pairs& pairs, float near_of_pass, uint32_t rays) {
        Gathered::add(pairs.here - pairs.there, near_of_pass, rays);
        if (rays == 0) return;
        const auto count = static_cast<float>(rays);
        alone.add((pairs.here - pairs.known) / count, count);
        others.add((pairs.there - pairs.known) / count, count);
    }
};

/// For which lobes an eye sample gathers indirect light, and how many samples of the pixel did so before it.
struct Gather {
    bool diffuse = false, specular = false;
    bool every_lobe = false;  ///< all samples of the pixel gather along the specular lobe
    bool is_allowed = false;  ///< where nothing else tells the light, all eye samples gather
    uint32_t before_diffuse = 0, before_specular = 0;
};

/// Where light counts in a pixel that is found after its eye sample was looked at.
enum class Layer : uint8_t { kDirect, kIndirectDiffuse, kIndirectSpecular, kExcessSpecular, kHere, kThere };

/// What one pass saw in a pixel, summed over its samples.
struct PixelPass {
    EyeSample sum;
    Excess excess;  ///< its diffuse part is that of `pairs`
    Pairs pairs;
    Rgb& operator[](Layer layer) {
        switch (layer) {
        case Layer::kDirect:
            return sum.direct;
        case Layer::kIndirectDiffuse:
            return sum.indirect_diffuse;
        case Layer::kIndirectSpecular:
            return sum.indirect_specular;
        case Layer::kExcessSpecular:
            return excess.specular;
        case Layer::kHere:
            return pairs.here;
        case Layer::kThere:
            return pairs.there;
        }
        __builtin_unreachable();
    }
    uint32_t samples = 0, diffuse = 0, specular = 0;  ///< of the samples, those that gathered for a lobe
    uint32_t material = kNoMaterial;                  ///< whose measured gloss was seen first

    static constexpr uint32_t kNoMaterial = 0xffffffffu;
};

/// One entry a pixel, row by row from the upper left. A pass counts in a pixel by its samples there.
struct Film {
    uint32_t width = 0, height = 0;
    uint32_t passes = 0;                   ///< summed up
    std::vector<EyeSample> sum;            ///< over the samples of all passes
    std::vector<PassMoments> uncorrected;  ///< radiance without correction
    std::vector<GatheredPairs> diffuse;
    std::vector<Gathered> specular;
    std::vector<Correction> correction;
    std::vector<uint32_t> material;        ///< whose measured gloss was seen first, or kNoMaterial

    Film(uint32_t w, uint32_t h)
        : width(w),
          height(h),
          sum(size_t{w} * h),
          uncorrected(size_t{w} * h),
          diffuse(size_t{w} * h),
          specular(size_t{w} * h),
          correction(size_t{w} * h),
          material(size_t{w} * h, PixelPass::kNoMaterial) {}

    size_t pixels() const { return sum.size(); }
    /// Samples of all passes.
    float samples(size_t pixel) const { return uncorrected[pixel].count(); }
    /// Mean radiance of the picture, lum, without corrections. Errors are held against L^2 + kDark times its square.
    double mean_light() const;
    static constexpr float kDark = 0.01f;
    /// Add a pass, one entry a pixel with at least one sample each.
    void add(std::span<const PixelPass> pass);
    /// The mean of all samples, corrected.
    EyeSample mean(size_t pixel) const;
    /// Standard error of the pixel: the spread of the passes and the error of the solution that all of them share.
    Rgb standard_error(size_t pixel) const;
};

}  // namespace lumel
