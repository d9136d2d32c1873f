#include "lumel/transport/first_shot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

namespace {

/// Light from one sampled point of a lamp to one sampled point of a side.
struct DirectSample {
    Vec3 wi;
    Rgb irradiance;   ///< W/m2, with the shading normal's cosine
    float cos = 0;    ///< of wi to the shading normal
};

DirectSample sample_direct(const Accel& accel, uint32_t side, uint32_t index, uint64_t stream) {
    const Scene& scene = accel.scene();
    const uint64_t here = key(stream, side);
    const SurfacePoint p = scene.point_on_patch(scene.patch_of_side(side), square_to_triangle(sobol2d(index, key(here, 1))));
    const Surface x(scene, p, scene.is_back(side));
    const LampSample lamp = LampView(scene, x).sample(sobol2d(index, key(here, 2)).u, sobol2d(index, key(here, 3)));
    const float cos = dot(x.shading, lamp.wi);
    if (!(lamp.pdf_w > 0) || !(cos > 0) || !(dot(x.normal, lamp.wi) > 0)) return {};
    if (!accel.visible(x.off(scene.epsilon()), lamp.target)) return {};
    return {lamp.wi, lamp.radiance * (cos / lamp.pdf_w), cos};
}

/// Writes `count` samples of the light of lamps to the records of a side, if it is glossy.
class LampRecorder {
public:
    LampRecorder(const Scene& scene, uint32_t side, uint32_t count, Emitters& emitters)
        : material_(scene.material(scene.triangle_of_side(side))),
          area_(scene.patch_area(scene.patch_of_side(side)) / static_cast<float>(count)),
          records_(emitters.open_records(scene, side)) {}

    void operator()(uint32_t i, const DirectSample& direct) const {
        if (records_.empty()) return;
        const Rgb flux = direct.irradiance * area_;
        records_[i] = {direct.wi, flux, lum(flux * material_.albedo_s(direct.cos))};
    }

private:
    const Material& material_;
    float area_;  // for each of the samples, m2
    std::span<Record> records_;
};

template <class Body>
void for_each_reachable_side(const Scene& scene, const DefensiveStarts& reachable, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 512), [&](const auto& range) {
        const FlushDenormals flush;
        for (uint32_t side = range.begin(); side < range.end(); ++side)
            if (reachable.by_area.size() > 0 && reachable.by_area.weight(side) > 0 && scene.scatters(side)) body(side);
    });
}

}  // namespace

std::vector<Rgb> direct_irradiance(const Accel& accel, const DefensiveStarts& reachable, uint32_t samples, uint64_t stream,
                                   Emitters& emitters) {
    const Scene& scene = accel.scene();
    std::vector<Rgb> irradiance(scene.sides());
    for_each_reachable_side(scene, reachable, [&](uint32_t side) {
        const LampRecorder record(scene, side, std::min<uint32_t>(samples, kLampRecords), emitters);
        Rgb64 sum;
        for (uint32_t i = 0; i < samples; ++i) {
            const DirectSample direct = sample_direct(accel, side, i, stream);
            sum += direct.irradiance;
            if (i < kLampRecords) record(i, direct);
        }
        irradiance[side] = (sum * (1.0 / (samples * double{scene.open_share(side)}))).to_float();
    });
    return irradiance;
}

void record_lamps(const Accel& accel, const DefensiveStarts& reachable, uint64_t stream, Emitters& emitters, uint32_t part,
                  uint32_t parts) {
    const Scene& scene = accel.scene();
    for_each_reachable_side(scene, reachable, [&](uint32_t side) {
        if (side % parts != part || scene.glossy_index(side) == Scene::kNone) return;
        const LampRecorder record(scene, side, kLampRecords, emitters);
        for (uint32_t i = 0; i < kLampRecords; ++i) record(i, sample_direct(accel, side, i, stream));
    });
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
