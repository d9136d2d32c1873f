// Rays from an eye, traced together.
#pragma once

#include "lumel/eye/gather_rays.h"
#include "lumel/eye/small_lamps.h"
#include "lumel/scene/camera.h"

namespace lumel {

/// An eye whose picture is made.
struct Eye {
    const Camera& camera;
    uint32_t number;                 ///< in the solution
    const SmallLamps& small_lamps;   ///< their emission is left to them
    bool pixels;                     ///< specular light of what is seen directly is measured in pixels, and left to them
};

/// Takes the samples of a pass one after the other and adds what they see to their pixels. What they ask of the scene waits until there is
/// much of it: neighbours go nearly the same way. What a pixel gets depends on the samples since the last `finish`, and their order, alone.
class EyeRays {
public:
    /// `pass`: an entry for every pixel of the camera. Each pixel must be served by one EyeRays only.
    EyeRays(const EyeShader& shader, const Eye& eye, std::span<PixelPass> pass)
        : shader_(shader),
          scene_(shader.scene()),
          eye_(eye),
          pass_(pass),
          shadows_(shader.accel(), pass),
          gathers_(shader, shadows_, pass) {}

    /// Add sample `index` of a pixel whose random numbers have the key `stream`.
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
    /// A lobe of a surface in view that waits to be drawn.
    struct Lobe {
        Surface x;
        GatherTask task;  ///< throughput: without the lobe
        Layer lamps;  ///< where the light of lamps counts that it points to,
        bool to_lamps;  ///< if these are asked for
        bool gathers;  ///< along the lobe
    };
    /// A surface in view.
    struct View {
        const Sample& sample;
        const EyeShader::Meeting& met;
        const Surface& x;
        Vec3 wo;
        Lattice::Stencil at;
        float size;  ///< of the patch, m
    };
    void look();
    void aim();
    void see(const Sample& sample, Ray ray, const Hit& hit);
    void see_diffuse(const View& view, EyeStream& stream);
    void see_gloss(const View& view, EyeStream& stream);
    void push_lobe(const View& view, Square s, const Lobe& lobe);
    void follow_lobes();
    /// Gather along a lobe towards its target.
    void send_lobe(const Lobe& lobe, Vec3 wo);

    const EyeShader& shader_;
    const Scene& scene_;
    Eye eye_;
    std::span<PixelPass> pass_;
    RayBlock rays_, lobe_rays_;
    std::vector<Sample> samples_;
    LobeBlock draws_;
    std::vector<Lobe> lobes_;
    ShadowRays shadows_;
    GatherRays gathers_;
};

}  // namespace lumel
