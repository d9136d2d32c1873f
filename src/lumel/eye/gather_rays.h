// Rays that gather indirect light, traced together.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lumel/eye/shade.h"

namespace lumel {

/// What a gathering ray is for.
struct GatherTask {
    uint32_t pixel = 0;
    Layer layer = Layer::kIndirectDiffuse;
    Rgb throughput;      ///< of what the ray brings
    bool coarse = false; ///< light of lamps on what is not near and diffuse comes from the patches, too
    float size = 0;      ///< of the patch that the ray left, m
    uint64_t stream = 0; ///< key of its random numbers, of which it takes those of `number`
    uint32_t number = 0;
    float stretch = 1;   ///< how much farther than from a round lobe what it meets is near
    float pdf_w =
        0;  ///< 1/sr: density of the ray in its lobe, which the throughput is divided by; 0: none of its kind is sent to bright patches
    std::optional<BrightPatches::Target> target{};  ///< if the ray is sent to a bright patch instead
};

/// Gathers radiance along rays, but what their first surface emits: diffuse from the patches, lamps sampled, specular lobes followed. Where
/// a ray meets a patch right beside where it started, the light of that is as uncertain, and one more ray follows. Rays wait until there
/// are many.
class GatherRays {
public:
    /// `pass`: an entry for every pixel.
    GatherRays(const EyeShader& shader, ShadowRays& shadows, std::span<PixelPass> pass)
        : shader_(shader), scene_(shader.scene()), shadows_(shadows), pass_(pass) {}

    void add(const Ray& ray, const GatherTask& task) {
        make_room(1);
        push(ray, {task});
    }
    /// Gather what one ray along `wi`, or to the target, from x finds beyond the reconstruction there, `at`: less what it finds from a
    /// point of the patches that the reconstruction takes its light from. With the same random numbers both see the same of what is far, so
    /// that only what patches are too coarse for is left, and hardly any noise. `known`: the light that it finds there, as what the rays
    /// find with the throughput of the task.
    void add_pair(const Surface& x, const Hit& hit, const Lattice::Stencil& at, Vec3 wi, Rgb known, const GatherTask& task);
    /// Trace all that wait, and what they lead to.
    void finish();

private:
    struct Waiting {
        GatherTask task;
        uint32_t step = 0;  ///< lobes that led to this ray
        Hit from{};  ///< of the first ray of a pair: where it starts. The other one follows it
        Rgb known{};  ///< light there
    };
    struct Block {
        RayBlock rays;
        std::vector<Waiting> tasks;
    };
    void push(const Ray& ray, const Waiting& waiting);
    /// Push a ray of diffuse light from x if it leaves on the right side, or one that meets nothing.
    void push_above(const Surface& x, Vec3 wi, const Waiting& waiting);
    /// Make room for so many rays.
    void make_room(uint32_t rays) {
        while (filling().rays.size + rays > RayBlock::kMost) trace();
    }
    void trace();
    /// Use a ray and what it met; says whether that is so near that the reconstruction may be off where the ray came from.
    bool use(const Waiting& waiting, Ray ray, const Hit& first);
    void use_pair(const Block& block, uint32_t first, const HitBlock& hits);
    /// What a ray that met something near counts in the share of these: those that were sent elsewhere do not.
    float near_of(const GatherTask& task) const;
    void follow_diffuse(const Waiting& waiting, const Surface& x, Rgb throughput, float size, EyeStream& stream);
    void follow_lobe(const Waiting& waiting, const Surface& x, Vec3 wo, Rgb throughput, EyeStream& stream);
    /// Can no light reach what was hit, so that the ray came from under a cover?
    bool is_covered(const Hit& hit) const;

    Block& filling() { return blocks_[filling_]; }

    const EyeShader& shader_;
    const Scene& scene_;
    ShadowRays& shadows_;
    std::span<PixelPass> pass_;
    std::array<Block, 2> blocks_;  // one is filled while the other one is used
    uint32_t filling_ = 0;
};

}  // namespace lumel
