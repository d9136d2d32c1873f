#include "lumel/eye/pixel_radiance.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace lumel {

PixelRadiance estimate_pixels(const PixelAreas& areas, uint32_t camera, const Estimator& estimator) {
    const uint32_t pixels = areas.camera(camera).width * areas.camera(camera).height;
    PixelRadiance radiance{std::vector<Reconstructed>(pixels)};
    std::vector<uint8_t> borrowed(pixels), unfilled(pixels);
    tbb::parallel_for(uint32_t{0}, pixels, [&](uint32_t pixel) {
        if (!(areas.albedo(camera, pixel) > 0)) return;
        const AreaEstimate e = estimate_pixel(areas, camera, pixel, estimator);
        borrowed[pixel] = e.borrowed, unfilled[pixel] = e.unfilled;
        radiance.pixels[pixel] = {e.estimate.value.to_float(), square_root(e.estimate.variance.to_float()), e.trust};
    });
    radiance.borrowed = static_cast<uint32_t>(std::count(borrowed.begin(), borrowed.end(), 1));
    radiance.unfilled = static_cast<uint32_t>(std::count(unfilled.begin(), unfilled.end(), 1));
    for (const Reconstructed& r : radiance.pixels) radiance.measured += r.trust.hits > 0, radiance.flagged += r.trust.flag > 0;
    return radiance;
}

}  // namespace lumel
