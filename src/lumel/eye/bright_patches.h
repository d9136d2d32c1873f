// Patches that are much brighter than most, as where a spotlight or the sun falls: rays of a lobe seldom find them.
#pragma once

#include <optional>
#include <vector>

#include "lumel/accel/accel.h"
#include "lumel/eye/eye_stream.h"
#include "lumel/sampling/distribution.h"
#include "lumel/scene/scene.h"

namespace lumel {

/// Sends a share of the gathering rays to bright patches, in proportion to their power. Rays of both kinds are weighed by the balance
/// heuristic (Veach and Guibas 1995), so nothing is counted twice.
class BrightPatches {
public:
    BrightPatches() = default;
    /// `irradiance(side)`: of all light, W/m2.
    template <class Irradiance>
    BrightPatches(const Scene& scene, const Irradiance& irradiance) : scene_(&scene) {
        std::vector<float> radiosity(scene.sides());
        for (uint32_t side = 0; side < scene.sides(); ++side)
            if (scene.scatters(side)) radiosity[side] = lum(scene.material(scene.triangle_of_side(side)).diffuse * irradiance(side));
        choose(radiosity);
    }

    /// Of the gathering rays, 0 to 0.5: half of that of the bright patches in all light.
    float share() const { return share_; }
    /// A point that a ray is sent to.
    struct Target {
        Vec3 x;
        uint32_t side;
    };
    /// Draw a target, or, for the rest of the rays, nothing.
    std::optional<Target> draw(EyeStream& stream) const;
    /// What a ray from `origin` counts that met `hit`: `pdf_w` > 0 is the density of its lobe, 1/sr, and `target` where it was sent, if it
    /// was.
    float weight(float pdf_w, const std::optional<Target>& target, Vec3 origin, const Hit& hit) const;

private:
    void choose(const std::vector<float>& radiosity);

    const Scene* scene_ = nullptr;
    float share_ = 0;
    std::vector<uint32_t> sides_;
    Distribution power_;
    std::vector<float> pdf_area_;  // 1/m2, of every side
};

}  // namespace lumel
