// What one ray from the eye sees.
#pragma once

#include "lumel/accel/accel.h"
#include "lumel/eye/eye_stream.h"
#include "lumel/eye/film.h"
#include "lumel/eye/reconstruction.h"
#include "lumel/eye/small_lamps.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

/// Light of a lamp that counts if nothing is between two points.
struct LampLight {
    Vec3 from, to;
    Rgb radiance;  ///< 0: none

    explicit operator bool() const { return max_component(radiance) > 0; }
};

class EyeShader {
public:
    /// The emission of `small_lamps` is left to them. `direct_light`: lamps are sampled here, the solution is without their light.
    /// `pixels`: the specular light of what is seen directly is measured in pixels, and left to them.
    EyeShader(const Accel& accel, const Reconstruction& reconstruction, const SmallLamps& small_lamps, uint32_t eye, bool direct_light,
              bool pixels)
        : accel_(accel),
          scene_(accel.scene()),
          reconstruction_(reconstruction),
          small_lamps_(small_lamps),
          eye_(eye),
          direct_light_(direct_light),
          pixels_(pixels) {}

    /// What a ray sees, and what one gathering ray of each lobe finds beyond it. `direct` of the sample is without the light of the
    /// lamps: its shadow rays are left to the caller, who can trace those of many samples together.
    struct Seen {
        EyeSample sample;
        Excess excess;
        LampLight lamps, lobe;  ///< direct light by sampling lamps, and by sampling the specular lobe
        uint32_t material = PixelPass::kNoMaterial;  ///< of measured gloss
    };
    /// `first`: what the ray meets. `gather`: send gathering rays, too (lamps must be sampled here).
    Seen sample(Ray ray, const Hit& first, Gather gather, EyeStream& stream) const;

private:
    /// A surface met after any number of mirrors.
    struct Meeting {
        Hit hit;
        Rgb throughput{1, 1, 1};
        Rgb emission;  ///< what the first surface emits
        Rgb mirrored_emission;  ///< what surfaces emit that were met over mirrors, their tints applied
        float distance = 0;  ///< of the first surface, mirror or not
        int mirrors = 0;
    };
    Meeting meet(Ray& ray, const Hit& first, EyeStream& stream) const;
    /// Lamp light reflected at x, by sampling lamps: diffuse alone, and specular weighed against lobe sampling.
    LampLight lamps(const Surface& x, Vec3 wo, EyeStream& stream) const;
    /// Light of the lamp that a ray of the specular lobe points to; where lamps are sampled weighed against `lamps`, which could have drawn
    /// it (balance heuristic). `scatter`: w_s / pdf_w.
    LampLight lamp_along(const Surface& x, Vec3 wo, const Ray& ray, Rgb scatter, float pdf_w) const;
    bool is_lit(const LampLight& light) const { return light && accel_.visible(light.from, light.to); }
    /// Light of lamps that one ray of the specular lobe meets.
    LampLight lobe(const Surface& x, Vec3 wo, EyeStream& stream) const;
    /// What one ray brings.
    struct Brought {
        Rgb radiance;
        bool near = false;  ///< it met something so close that the reconstruction may be off where it came from
        bool covered = false;  ///< it met what no light can reach, so that it came from under a cover
    };
    /// Indirect irradiance over pi at x, W/(m2 sr), from one ray along `wi`, whose density is cos/pi.
    Brought gather_irradiance(const Surface& x, Vec3 wi, float size, EyeStream& stream) const;
    /// The same beyond the reconstruction: what one ray with density cos/pi finds there, less what it
    /// finds at a point of the patches that the reconstruction takes its light from. With the same random numbers both see the same of
    /// what is far, so that only what patches are too coarse for is left, and hardly any noise.
    Brought gather_beyond_patches(const Surface& x, SurfacePoint p, bool back, float size, EyeStream& stream) const;
    /// What x reflects of one ray of the specular lobe: from the solution, which holds the light of lamps as well if they are not sampled.
    Brought gather_lobe(const Surface& x, Vec3 wo, float size, EyeStream& stream) const;
    /// Radiance along `ray`, but what its first surface emits: diffuse from the patches, lamps sampled, specular lobes followed.
    /// `coarse`: the light of lamps on what is not near and diffuse comes from the patches too. `size`: of the patch that the ray left,
    /// m, longer for narrow lobes.
    Brought gather(Ray ray, Rgb throughput, bool coarse, float size, EyeStream& stream) const;

    const Accel& accel_;
    const Scene& scene_;
    const Reconstruction& reconstruction_;
    const SmallLamps& small_lamps_;
    uint32_t eye_;
    bool direct_light_, pixels_;
};

}  // namespace lumel
