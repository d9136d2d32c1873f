// Rays from an eye, traced together.
#pragma once

#include <span>

#include "lumel/eye/shade.h"
#include "lumel/scene/camera.h"

namespace lumel {

/// Takes the samples of a pass one after the other and adds what they see to their pixels. Rays from the eye, and shadow rays, wait until
/// there are many: neighbours go nearly the same way. What a pixel gets depends on its samples and their order alone.
class EyeRays {
public:
    /// `pass`: an entry for every pixel of the camera. Each pixel must be served by one EyeRays only.
    EyeRays(const Accel& accel, const EyeShader& shader, const Camera& camera, std::span<PixelPass> pass)
        : accel_(accel), shader_(shader), camera_(camera), pass_(pass) {}

    /// Add sample `index` of a pixel whose random numbers have the key `stream`; `gather`: see EyeShader.
    void add(uint32_t pixel, uint64_t stream, uint32_t index, Gather gather);
    /// Trace what still waits.
    void finish();

private:
    /// What a waiting ray from the eye belongs to.
    struct Sample {
        uint32_t pixel, index;
        uint64_t stream;
        Gather gather;
    };
    /// What a waiting shadow ray decides on.
    struct Light {
        uint32_t pixel;
        Rgb radiance;
    };
    void look();
    void aim();
    void light(uint32_t pixel, const LampLight& light);
    void cast_shadows();

    const Accel& accel_;
    const EyeShader& shader_;
    const Camera& camera_;
    std::span<PixelPass> pass_;
    RayBlock rays_, shadows_;
    std::vector<Sample> samples_;
    std::vector<Light> lights_;
};

}  // namespace lumel
