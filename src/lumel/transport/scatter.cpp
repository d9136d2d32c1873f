#include "lumel/transport/scatter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr int kDrawn = kRecords - 1;

/// Light of one arrival with the adjoint factor of the shading normal, W, and its specular power.
struct Incident {
    Rgb flux;
    float power = 0;
};

Incident incident(const Scene& scene, const Arrival& arrival, bool back, bool glossy) {
    const Surface x(scene, {scene.triangle_of_side(arrival.side), arrival.u, arrival.v}, back);
    const Rgb flux = arrival.flux * x.adjoint(arrival.wi);
    return {flux, glossy ? lum(flux * x.material->albedo_s(dot(x.shading, arrival.wi))) : 0.0f};
}

/// Draw the records of one side: even steps through the running sum of specular power.
void draw_records(const Scene& scene, const Hits& hits, uint32_t side, double power, uint64_t stream, std::span<Record> records) {
    const double step = power / kDrawn;
    double next = step * to_unit(static_cast<uint32_t>(key(stream, side) >> 32)), sum = 0;
    int drawn = 0;
    for (uint32_t i : hits.group(side)) {
        const Arrival& arrival = hits.arrivals[i];
        const Incident light = incident(scene, arrival, scene.is_back(side), true);
        for (sum += light.power; drawn < kDrawn && next < sum; next += step)
            records[1 + drawn++] = {arrival.wi, light.flux * static_cast<float>(step / light.power), static_cast<float>(step)};
    }
}

}  // namespace

void scatter(const Scene& scene, const Hits& hits, uint64_t stream, std::vector<Rgb>& received, Emitters& next) {
    received.resize(scene.sides());
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 1024), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const uint32_t triangle = scene.triangle_of_side(side);
            const auto records = next.records_of(scene, side);
            for (Record& record : records) record = {};
            Rgb64 sum;
            double power = 0;
            if (records.empty() && !scene.is_smooth(triangle)) {
                for (uint32_t i : hits.group(side)) sum += hits.arrivals[i].flux;
            } else {
                for (uint32_t i : hits.group(side)) {
                    const Incident light = incident(scene, hits.arrivals[i], scene.is_back(side), !records.empty());
                    sum += light.flux;
                    power += light.power;
                }
            }
            received[side] = sum.to_float();
            next.diffuse[side] = scene.scatters(side) ? received[side] * scene.material(triangle).diffuse : Rgb{};
            if (power > 0) draw_records(scene, hits, side, power, stream, records);
        }
    });
}

void merge_records(const Emitters& generation, uint64_t stream, Emitters& total) {
    for (size_t i = 0; i < total.records.size(); ++i) {
        const Record& candidate = generation.records[i];
        Record& kept = total.records[i];
        if (!(candidate.power > 0)) continue;
        const float sum = kept.power + candidate.power;
        const bool replace = Rng(key(stream, i)).uniform() * sum >= kept.power;
        if (replace) kept = candidate;
        const float scale = sum / kept.power;
        kept = {kept.wi, kept.flux * scale, sum};
    }
}

}  // namespace lumel
