#include "lumel/transport/scatter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

/// Light of one transfer with the adjoint factor of the shading normal, W, and its specular power.
struct Incident {
    Rgb flux;
    float power = 0;
};

Incident incident(const Scene& scene, const Transfer& transfer, bool back, bool glossy) {
    const Surface x(scene, {scene.triangle_of_side(transfer.side), transfer.u, transfer.v}, back);
    const Rgb flux = transfer.flux * x.adjoint(transfer.wi);
    return {flux, glossy ? lum(flux * x.material->albedo_s(dot(x.shading, transfer.wi))) : 0.0f};
}

/// Draw the records of one side: even steps through the running sum of specular power.
void draw_records(const Scene& scene, const Transfers& transfers, uint32_t side, double power, uint64_t stream, std::span<Record> records) {
    const double step = power / kSurfaceRecords;
    double next = step * to_unit(static_cast<uint32_t>(key(stream, side) >> 32)), sum = 0;
    int drawn = 0;
    for (uint32_t i : transfers.group(side)) {
        const Transfer& transfer = transfers.all[i];
        const Incident light = incident(scene, transfer, scene.is_back(side), true);
        for (sum += light.power; drawn < kSurfaceRecords && next < sum; next += step)
            records[kLampRecords + drawn++] = {transfer.wi, light.flux * static_cast<float>(step / light.power), static_cast<float>(step)};
    }
}

}  // namespace

void scatter(const Scene& scene, const Transfers& transfers, uint64_t stream, std::vector<Rgb>& received, Emitters& next) {
    received.resize(scene.sides());
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 1024), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const uint32_t triangle = scene.triangle_of_side(side);
            const bool glossy = scene.glossy_index(side) != Scene::kNone;
            next.clear_records(scene, side);
            Rgb64 sum;
            double power = 0;
            if (!glossy && !scene.is_smooth(triangle)) {
                for (uint32_t i : transfers.group(side)) sum += transfers.all[i].flux;
            } else {
                for (uint32_t i : transfers.group(side)) {
                    const Incident light = incident(scene, transfers.all[i], scene.is_back(side), glossy);
                    sum += light.flux;
                    power += light.power;
                }
            }
            received[side] = sum.to_float();
            next.diffuse[side] = scene.scatters(side) ? received[side] * scene.material(triangle).diffuse : Rgb{};
            if (power > 0) draw_records(scene, transfers, side, power, stream, next.open_records(scene, side));
        }
    });
}

void merge_records(const Scene& scene, const Emitters& generation, uint64_t stream, Emitters& total) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 4096), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const auto candidates = generation.records_of(scene, side);
            if (candidates.empty()) continue;
            const auto kept = total.open_records(scene, side);
            Rng rng(key(stream, side));
            for (int i = kLampRecords; i < kRecords; ++i) {
                if (!(candidates[i].power > 0)) continue;
                const float sum = kept[i].power + candidates[i].power;
                if (rng.uniform() * sum >= kept[i].power) kept[i] = candidates[i];
                kept[i] = {kept[i].wi, kept[i].flux * (sum / kept[i].power), sum};
            }
        }
    });
}

}  // namespace lumel
