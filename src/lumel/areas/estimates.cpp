#include "lumel/areas/estimates.h"

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
    double albedo() const { return area > 0 ? albedo_area / area : 0; }
    /// Their means, as if all had the albedo `seen`.
    Samples samples(double seen) const {
        const double inv = albedo_area > 0 ? 1 / albedo_area : 0;
        Samples means = scaled(sums, seen * inv, inv);
        means.size = albedo_area;
        return means;
    }
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

/// Mean samples of the glossy pixels like this one in rings around it, itself left out, as if all had its albedo.
Samples around_pixel(const PixelAreas& areas, uint32_t camera, uint32_t pixel) {
    const int width = static_cast<int>(areas.camera(camera).width), height = static_cast<int>(areas.camera(camera).height);
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    const double albedo = areas.albedo(camera, pixel);
    Samples sum;
    double albedos = 0;
    for (int ring = 1; ring <= kFarthest && sum.hits < kEnoughAround; ++ring)
        for (int dy = -ring; dy <= ring; ++dy)
            for (int dx = -ring; dx <= ring; ++dx) {
                const int i = x + dx, j = y + dy;
                if (std::max(std::abs(dx), std::abs(dy)) != ring || i < 0 || j < 0 || i >= width || j >= height) continue;
                const auto other = static_cast<uint32_t>(j * width + i);
                if (std::abs(areas.albedo(camera, other) - albedo) > kAlike * albedo) continue;
                sum = pooled(sum, areas.unscaled(camera, other));
                albedos += areas.albedo(camera, other);
            }
    if (albedos > 0) sum = scaled(sum, albedo / albedos, 1 / albedos);
    sum.size = albedos;
    return sum;
}

}  // namespace

AreaEstimate estimate_pooled(const PatchAreas& areas, const Neighbourhood& neighbourhood, uint32_t eye, std::span<const uint32_t> centre,
                             const Estimator& estimator) {
    const auto hits = [&](uint32_t area) { return areas.albedo(eye, area) > 0 ? areas.hits(eye, area) : 0; };
    const Pool own(areas, eye, centre), around(areas, eye, neighbourhood.around(centre, hits));
    return estimated(own.samples(own.albedo()), around.samples(own.albedo()), estimator);
}

AreaEstimate estimate_pixel(const PixelAreas& areas, uint32_t camera, uint32_t pixel, const Estimator& estimator) {
    return estimated(areas.samples(camera, pixel), around_pixel(areas, camera, pixel), estimator);
}

}  // namespace lumel
