#include "lumel/areas/estimates.h"

#include <tbb/parallel_for.h>

namespace lumel {

namespace {

/// Pool the samples of areas: sums before division by area, and what to divide them by.
struct Pool {
    Samples sums;
    double area = 0, albedo_area = 0;

    Pool(const PatchAreas& areas, uint32_t eye, std::span<const uint32_t> of) {
        for (uint32_t one : of) {
            const double albedo = areas.albedo(eye, one), size = areas.area(one);
            if (!(albedo > 0)) continue;
            sums = pooled(sums, areas.unscaled(eye, one));
            area += size, albedo_area += size * albedo;
        }
    }
    Samples samples() const { return scaled(sums, area > 0 ? 1 / area : 0, albedo_area > 0 ? 1 / albedo_area : 0); }
};

/// The neighbours' samples stand in where there is none.
AreaEstimate estimated(const Samples& own, const Samples& around, const Estimator& estimator) {
    AreaEstimate e;
    e.borrowed = own.hits == 0 && around.hits > 0;
    e.unfilled = own.hits == 0 && around.hits == 0;
    e.samples = e.borrowed ? around : own;
    e.estimate = estimator.estimate(e.samples, around);
    e.trust = Trust(e.samples, e.estimate);
    return e;
}

constexpr int kFarthest = 6;      // pixels
constexpr double kAlike = 0.25;   // relative difference of albedo

/// Mean samples of the glossy pixels like this one in rings around it, itself left out.
Samples around_pixel(const PixelAreas& areas, uint32_t camera, uint32_t pixel) {
    const int width = static_cast<int>(areas.camera(camera).width), height = static_cast<int>(areas.camera(camera).height);
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    const double albedo = areas.albedo(camera, pixel);
    Samples sum;
    double count = 0;
    for (int ring = 1; ring <= kFarthest && sum.hits < kEnoughAround; ++ring)
        for (int dy = -ring; dy <= ring; ++dy)
            for (int dx = -ring; dx <= ring; ++dx) {
                const int i = x + dx, j = y + dy;
                if (std::max(std::abs(dx), std::abs(dy)) != ring || i < 0 || j < 0 || i >= width || j >= height) continue;
                const auto other = static_cast<uint32_t>(j * width + i);
                if (std::abs(areas.albedo(camera, other) - albedo) > kAlike * albedo) continue;
                sum = pooled(sum, areas.samples(camera, other));
                count += 1;
            }
    return count > 0 ? scaled(sum, 1 / count, 1 / count) : sum;
}

}  // namespace

AreaEstimate estimate_pooled(const PatchAreas& areas, const Neighbourhood& neighbourhood, uint32_t eye, std::span<const uint32_t> centre,
                             const Estimator& estimator) {
    const auto enough = [&](std::span<const uint32_t> found) { return Pool(areas, eye, found).sums.hits >= kEnoughAround; };
    const Samples own = Pool(areas, eye, centre).samples();
    const Samples around = Pool(areas, eye, neighbourhood.around(centre, enough)).samples();

    return estimated(own, around, estimator);
}

std::vector<AreaEstimate> estimate_each(const PatchAreas& areas, const Neighbourhood& neighbourhood, uint32_t eye,
                                        const Estimator& estimator) {
    std::vector<AreaEstimate> estimates(areas.size());
    tbb::parallel_for(uint32_t{0}, areas.size(),
                      [&](uint32_t area) { estimates[area] = estimate_pooled(areas, neighbourhood, eye, std::span(&area, 1), estimator); });
    return estimates;
}

AreaEstimate estimate_pixel(const PixelAreas& areas, uint32_t camera, uint32_t pixel, const Estimator& estimator) {
    return estimated(areas.samples(camera, pixel), around_pixel(areas, camera, pixel), estimator);
}

}  // namespace lumel
