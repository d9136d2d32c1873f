// Shadow rays, cast together.
#pragma once

#include <span>
#include <vector>

#include "lumel/accel/accel.h"
#include "lumel/eye/film.h"

namespace lumel {

/// Light of a lamp that counts if nothing is between two points.
struct LampLight {
    Vec3 from, to;
    Rgb radiance;  ///< 0: none

    explicit operator bool() const { return max_component(radiance) > 0; }
};

/// Takes light whose shadow rays wait until there are many: neighbours go nearly the same way.
class ShadowRays {
public:
    /// `pass`: an entry for every pixel.
    ShadowRays(const Accel& accel, std::span<PixelPass> pass) : accel_(accel), pass_(pass) {}

    /// `light`, times `throughput`, counts in `layer` of a pixel if it is seen.
    void add(uint32_t pixel, Layer layer, const LampLight& light, Rgb throughput) {
        if (!light) return;
        rays_.push(light.from, light.to - light.from);
        lights_.push_back({pixel, layer, light.radiance * throughput});
        if (rays_.is_full()) cast();
    }
    /// Cast all that wait.
    void cast();

private:
    struct Light {
        uint32_t pixel;
        Layer layer;
        Rgb radiance;
    };
    const Accel& accel_;
    std::span<PixelPass> pass_;
    RayBlock rays_;
    std::vector<Light> lights_;
};

}  // namespace lumel
