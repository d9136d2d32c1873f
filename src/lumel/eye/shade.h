// What one ray from the eye sees.
#pragma once

#include "lumel/accel/accel.h"
#include "lumel/eye/film.h"
#include "lumel/eye/reconstruction.h"
#include "lumel/sampling/hash.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

/// Pairs of random numbers for one eye sample; sample `index` of a pixel is well spread against its other samples.
class EyeStream {
public:
    EyeStream(uint64_t pixel, uint32_t index) : pixel_(pixel), index_(index) {}
    Square next() { return sobol2d(index_, key(pixel_, dimension_++)); }
    float next_one() { return next().u; }

private:
    uint64_t pixel_;
    uint32_t index_;
    uint64_t dimension_ = 0;
};

class EyeShader {
public:
    /// `direct_light`: lamps are sampled here, the solution is without their light. `pixels`: the specular light of what is seen
    /// directly is measured in pixels, and left to them.
    EyeShader(const Accel& accel, const Reconstruction& reconstruction, uint32_t eye, bool direct_light, bool pixels)
        : accel_(accel), scene_(accel.scene()), reconstruction_(reconstruction), eye_(eye), direct_light_(direct_light), pixels_(pixels) {}

    EyeSample sample(Ray ray, EyeStream& stream) const;

private:
    /// A surface met after any number of mirrors.
    struct Meeting {
        Hit hit;
        Rgb throughput{1, 1, 1};
        Rgb emission;            ///< what the first surface emits
        Rgb mirrored_emission;   ///< what surfaces emit that were met over mirrors, their tints applied
        float distance = 0;      ///< of the first surface, mirror or not
        int mirrors = 0;
    };
    Meeting meet(Ray& ray, EyeStream& stream) const;
    /// Lamp light reflected at x, by sampling lamps: diffuse alone, and specular weighed against lobe sampling.
    Rgb lamps(const Surface& x, Vec3 wo, EyeStream& stream) const;
    /// Light that one ray of the specular lobe brings: from lamps (weighed against `lamps`), and if `indirect`, from the solution too.
    struct LobeLight {
        Rgb direct, indirect;
    };
    LobeLight lobe(const Surface& x, Vec3 wo, bool indirect, EyeStream& stream) const;
    /// Share that a lamp met by a ray of the lobe has against `lamps`, which could have drawn it: the balance heuristic.
    float share_of_lobe(const Surface& x, float pdf_w, const Ray& ray, const Hit& hit) const;
    /// Radiance along `ray`, but what its first surface emits: diffuse from the patches, lamps sampled, specular lobes followed.
    Rgb gather(Ray ray, Rgb throughput, EyeStream& stream) const;

    const Accel& accel_;
    const Scene& scene_;
    const Reconstruction& reconstruction_;
    uint32_t eye_;
    bool direct_light_, pixels_;
};

}  // namespace lumel
