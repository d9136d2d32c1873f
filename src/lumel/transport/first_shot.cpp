#include "lumel/transport/first_shot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>

#include "lumel/sampling/hash.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

namespace {

constexpr uint32_t kSides = 512;  // of a work item

/// Light from one sampled point of a lamp to one sampled point of a side.
struct DirectSample {
    uint32_t side, index;  ///< the sample is the `index`-th of its side
    Square at;             ///< the point, in its triangle
    Vec3 wi;
    Rgb irradiance;        ///< W/m2, with the shading normal's cosine
    float cos = 0;         ///< of wi to the shading normal
};

/// Samples of the light of lamps on many sides. Their shadow rays wait until there is a block of them.
template <class Use>
class DirectSamples {
public:
    /// `use` is called with every sample that is lit, in the order in which they are drawn.
    DirectSamples(const Accel& accel, uint64_t stream, Use use) : accel_(accel), scene_(accel.scene()), stream_(stream), use_(use) {
        for (const AreaLamp& lamp : scene_.area_lamps()) brightest_ = max(brightest_, lamp.radiance);
    }

    /// Draw samples 0 to `count` of a side.
    void draw(uint32_t side, uint32_t count) {
        const uint64_t here = key(stream_, side);
        const std::array<uint64_t, 3> streams{key(here, 1), key(here, 2), key(here, 3)};
        const uint32_t patch = scene_.patch_of_side(side), triangle = scene_.triangle_of_patch(patch);
        const PatchCorners corners = scene_.tessellation().corners(patch);
        for (uint32_t i = 0; i < count; ++i) {
            const Square at = within(corners, square_to_triangle(sobol2d(i, streams[0])));
            const Surface x(scene_, {triangle, at.u, at.v}, scene_.is_back(side));
            const LampSample lamp = LampView(scene_, x).sample(sobol2d(i, streams[1]).u, sobol2d(i, streams[2]));
            const float cos = dot(x.shading, lamp.wi);
            if (!(lamp.pdf_w > 0) || !(cos > 0) || !(dot(x.normal, lamp.wi) > 0)) continue;
            Rgb irradiance = lamp.radiance * (cos / lamp.pdf_w);
            // No surface has more than pi times the radiance of the brightest lamp. Where a lamp touches it, one of a few samples may.
            if (!lamp.is_point) irradiance = min(irradiance, brightest_ * (kPi * static_cast<float>(count)));
            add({side, i, at, lamp.wi, irradiance, cos}, x.off(scene_.epsilon()), lamp.target);
        }
    }
    /// Cast the shadow rays that wait.
    void cast() {
        BlockedBlock blocked;
        accel_.occluded(shadows_, blocked);
        for (uint32_t k = 0; k < shadows_.size; ++k)
            if (!blocked[k]) use_(samples_[k]);
        shadows_.size = 0;
    }

private:
    void add(const DirectSample& sample, Vec3 from, Vec3 to) {
        samples_[shadows_.size] = sample;
        shadows_.push(from, to - from);
        if (shadows_.is_full()) cast();
    }

    const Accel& accel_;
    const Scene& scene_;
    Rgb brightest_;  // radiance of lamps
    uint64_t stream_;
    Use use_;
    RayBlock shadows_;
    std::array<DirectSample, RayBlock::kMost> samples_;
};

uint32_t part_of(const Scene& scene, const DirectSample& sample) {
    return scene.is_divided(sample.side) ? scene.parts(sample.side)->part_of(sample.at) : 0;
}

/// Write `sample`, one of `count`, to the records of its side, if that is glossy.
void record(const Scene& scene, const DirectSample& sample, uint32_t count, Emitters& emitters) {
    const auto records = emitters.open_records(scene, sample.side);
    if (records.empty()) return;
    const Rgb flux = sample.irradiance * (scene.patch_area(scene.patch_of_side(sample.side)) / static_cast<float>(count));
    const float power = lum(flux * scene.material(scene.triangle_of_side(sample.side)).albedo_s(sample.cos));
    records[sample.index] = {sample.wi, flux, power, part_of(scene, sample)};
}

/// What a matt surface makes of `sample`, one of `count`, W.
Rgb reflected_flux(const Scene& scene, const DirectSample& sample, uint32_t count) {
    const float area = scene.patch_area(scene.patch_of_side(sample.side)) / static_cast<float>(count);
    return sample.irradiance * scene.material(scene.triangle_of_side(sample.side)).diffuse * area;
}

/// Draw `count` samples on all sides that light can reach and that `wants` wants, their lamp records emptied, and hand them to `use`.
template <class Wants, class Use>
void sample_lamps(const Accel& accel, const DefensiveStarts& reachable, uint32_t count, uint64_t stream, Emitters& emitters,
                  const Wants& wants, const Use& use) {
    const Scene& scene = accel.scene();
    if (reachable.by_area.size() == 0) return;
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), kSides), [&](const auto& range) {
        const FlushDenormals flush;
        DirectSamples samples(accel, stream, use);
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            if (!(reachable.by_area.weight(side) > 0) || !scene.scatters(side) || !wants(side)) continue;
            if (const auto records = emitters.open_records(scene, side); !records.empty())
                std::fill_n(records.begin(), std::min<uint32_t>(count, kLampRecords), Record{});
            samples.draw(side, count);
        }
        samples.cast();
    });
}

}  // namespace

std::vector<Rgb> direct_irradiance(const Accel& accel, const DefensiveStarts& reachable, uint32_t samples, uint64_t stream,
                                   Emitters& emitters) {
    const Scene& scene = accel.scene();
    std::vector<Rgb64> sums(scene.sides());
    const auto every = [](uint32_t) { return true; };
    sample_lamps(accel, reachable, samples, stream, emitters, every, [&](const DirectSample& sample) {
        sums[sample.side] += sample.irradiance;
        if (const auto parts = emitters.parts_of(scene, sample.side); !parts.empty())
            parts[part_of(scene, sample)] += reflected_flux(scene, sample, samples);
        if (sample.index < kLampRecords) record(scene, sample, std::min<uint32_t>(samples, kLampRecords), emitters);
    });
    std::vector<Rgb> irradiance(scene.sides());
    for (uint32_t side = 0; side < scene.sides(); ++side)
        if (const double open = scene.open_share(side); open > 0) irradiance[side] = (sums[side] * (1.0 / (samples * open))).to_float();
    return irradiance;
}

void record_lamps(const Accel& accel, const DefensiveStarts& reachable, uint64_t stream, Emitters& emitters, uint32_t part,
                  uint32_t parts) {
    const Scene& scene = accel.scene();
    const auto its_turn = [&](uint32_t side) { return side % parts == part && scene.glossy_index(side) != Scene::kNone; };
    sample_lamps(accel, reachable, kLampRecords, stream, emitters, its_turn,
                 [&](const DirectSample& sample) { record(scene, sample, kLampRecords, emitters); });
}

std::vector<Rgb> emitted_flux(const Scene& scene) {
    std::vector<Rgb> flux(scene.sides());
    for (const AreaLamp& lamp : scene.area_lamps())
        for (uint32_t triangle : lamp.triangles) {
            const uint32_t first = scene.first_patch(triangle), end = first + scene.tessellation().count(triangle);
            for (uint32_t patch = first; patch < end; ++patch) flux[patch] = lamp.radiance * (kPi * scene.side_area(patch));
        }
    return flux;
}

}  // namespace lumel
