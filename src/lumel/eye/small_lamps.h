// Lamps that a camera sees as a few pixels or less: their emission is looked for from the lamps.
#pragma once

#include <span>
#include <vector>

#include "lumel/accel/accel.h"
#include "lumel/eye/film.h"
#include "lumel/scene/camera.h"

namespace lumel {

/// Eye samples seldom meet a lamp that is smaller than a pixel: its picture is noise, and too dark on the whole, since pixels that missed
/// it get fewer samples than those that met it. Points of the lamp find their pixel, all of them.
class SmallLamps {
public:
    /// Lamps that lie wholly before the camera and are small there.
    SmallLamps(const Scene& scene, const Camera& camera);

    /// Is the emission of this triangle, seen directly, left to `add`?
    bool has(uint32_t triangle) const { return !is_small_.empty() && is_small_[scene_.shape(triangle)]; }
    /// Add what the camera sees of these lamps to every sample of a pass that has `samples` samples a pixel in the mean. `stream`: key of
    /// the random numbers of the pass.
    void add(const Accel& accel, uint32_t samples, uint64_t stream, std::span<PixelPass> pass) const;

private:
    struct Lamp {
        const AreaLamp* lamp;
        float points;  ///< for every sample a pixel
    };
    /// Radiance in one pixel.
    struct Splat {
        uint32_t pixel;
        Rgb radiance;
    };
    std::vector<Splat> splats(const Accel& accel, const AreaLamp& lamp, uint32_t points, uint64_t stream) const;

    const Scene& scene_;
    const Camera& camera_;
    std::vector<uint8_t> is_small_;  // by shape, empty if none is
    std::vector<Lamp> lamps_;  // those that may be in the picture
};

}  // namespace lumel
