#include "lumel/eye/pixel_radiance.h"

#include <tbb/parallel_for.h>

namespace lumel {

namespace {

constexpr int kFarthest = 6;             // pixels
constexpr double kAlike = 0.25;          // relative difference of albedo

/// Mean samples of the glossy pixels like this one in rings around it, itself left out.
Samples around(const PixelAreas& areas, const Camera& camera, uint32_t index, uint32_t pixel) {
    const int x = static_cast<int>(pixel % camera.width), y = static_cast<int>(pixel / camera.width);
    const double albedo = areas.albedo(index, pixel);
    Samples sum;
    double count = 0;
    for (int ring = 1; ring <= kFarthest && sum.hits < kEnoughAround; ++ring)
        for (int dy = -ring; dy <= ring; ++dy)
            for (int dx = -ring; dx <= ring; ++dx) {
                const int i = x + dx, j = y + dy;
                if (std::max(std::abs(dx), std::abs(dy)) != ring || i < 0 || j < 0 || i >= static_cast<int>(camera.width) ||
                    j >= static_cast<int>(camera.height))
                    continue;
                const auto other = static_cast<uint32_t>(j) * camera.width + static_cast<uint32_t>(i);
                if (std::abs(areas.albedo(index, other) - albedo) > kAlike * albedo) continue;
                sum = pooled(sum, areas.samples(index, other));
                count += 1;
            }
    return count > 0 ? scaled(sum, 1 / count, 1 / count) : sum;
}

}  // namespace

PixelRadiance estimate_pixels(const PixelAreas& areas, const Camera& camera, uint32_t index, const Estimator& estimator) {
    PixelRadiance radiance{std::vector<Reconstructed>(size_t{camera.width} * camera.height)};
    std::vector<uint8_t> borrowed(radiance.pixels.size()), unfilled(radiance.pixels.size());
    tbb::parallel_for(uint32_t{0}, camera.width * camera.height, [&](uint32_t pixel) {
        if (!(areas.albedo(index, pixel) > 0)) return;
        const Samples own = areas.samples(index, pixel), near = around(areas, camera, index, pixel);
        borrowed[pixel] = own.hits == 0 && near.hits > 0;
        unfilled[pixel] = own.hits == 0 && near.hits == 0;
        const Estimate e = estimator.estimate(borrowed[pixel] ? near : own, near);
        const Rgb variance = e.variance.to_float();
        radiance.pixels[pixel] = {e.value.to_float(),
                                  {std::sqrt(variance.x), std::sqrt(variance.y), std::sqrt(variance.z)},
                                  Trust(borrowed[pixel] ? near : own, e)};
    });
    radiance.borrowed = static_cast<uint32_t>(std::count(borrowed.begin(), borrowed.end(), 1));
    radiance.unfilled = static_cast<uint32_t>(std::count(unfilled.begin(), unfilled.end(), 1));
    for (const Reconstructed& r : radiance.pixels) radiance.measured += r.trust.hits > 0, radiance.flagged += r.trust.flag > 0;
    return radiance;
}

}  // namespace lumel
