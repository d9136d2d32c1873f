// Light at surfaces that rays from the eye, or gathering rays, have met.
#pragma once

#include <optional>

#include "lumel/accel/accel.h"
#include "lumel/eye/eye_stream.h"
#include "lumel/eye/lobe_draw.h"
#include "lumel/eye/reconstruction.h"
#include "lumel/eye/shadow_rays.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

class EyeShader {
public:
    /// `direct_light`: lamps are sampled here, the solution is without their light.
    EyeShader(const Accel& accel, const Reconstruction& reconstruction, bool direct_light)
        : accel_(accel), scene_(accel.scene()), reconstruction_(reconstruction), direct_light_(direct_light) {}

    const Accel& accel() const { return accel_; }
    const Scene& scene() const { return scene_; }
    const Reconstruction& reconstruction() const { return reconstruction_; }
    bool direct_light() const { return direct_light_; }

    /// A surface met after any number of mirrors.
    struct Meeting {
        Hit hit;
        std::optional<Surface> surface;  ///< none: the sky, or light that ended in a mirror
        Rgb throughput{1, 1, 1};
        Rgb emission;           ///< what the first surface emits
        Rgb mirrored_emission;  ///< what surfaces emit that were met over mirrors, their tints applied
        float distance = 0;     ///< of the first surface, mirror or not
        int mirrors = 0;
    };
    /// Go from what the ray meets first on to what mirrors show; `ray` is the last one then.
    Meeting meet(Ray& ray, const Hit& first, EyeStream& stream) const;

    /// Lamp light reflected at x, by sampling lamps: diffuse alone, and specular weighed against lobe sampling.
    LampLight lamps(const Surface& x, Vec3 wo, EyeStream& stream) const;
    /// Light of the lamp that a ray of the specular lobe points to, `hit` among the lamps; where lamps are sampled weighed against `lamps`,
    /// which could have drawn it (balance heuristic). `scatter`: w_s / pdf_w.
    LampLight lamp_along(const Surface& x, Vec3 wo, const Ray& ray, const Hit& hit, Rgb scatter, float pdf_w) const;

    /// The direction of a gathering ray of diffuse light: to a bright patch, its target, or with density `pdf_cosine`.
    Vec3 draw_diffuse(const Surface& x, EyeStream& stream, std::optional<BrightPatches::Target>& target) const;
    /// Density cos/pi around the shading normal, 1/sr.
    static float pdf_cosine(const Surface& x, Vec3 wi) { return std::max(0.0f, dot(x.shading, wi)) * kInvPi; }
    /// A point of the patches that the light at x, which is looked up at `at` on that face, is reconstructed from.
    std::optional<Surface> draw_source(const Surface& x, const Lattice::Stencil& at, bool back, EyeStream& stream) const;

private:
    const Accel& accel_;
    const Scene& scene_;
    const Reconstruction& reconstruction_;
    bool direct_light_;
};

}  // namespace lumel
