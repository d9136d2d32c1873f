// How pixels measure bundles.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/areas/bundle_samples.h"
#include "lumel/areas/pixels.h"

namespace lumel {

void PixelAreas::measure_bundles(const Step& step, uint32_t camera) {
    const Camera& view = cameras_[camera];
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, view.width * view.height, 256), [&](const auto& range) {
        const FlushDenormals flush;
        BundleSamples samples(step.bundles);
        for (uint32_t pixel = range.begin(); pixel < range.end(); ++pixel) {
            if (!(albedo(camera, pixel) > 0)) continue;
            // One point of the pixel stands for its lobes; the light there is that of the whole patch.
            const Ray ray{view.origin, view.direction(view.on_film(pixel, sobol2d(0, key(step.stream, camera, pixel))))};
            const Hit hit = accel_->intersect(ray);
            if (hit.is_miss()) continue;
            const Surface x(*scene_, hit.point(), hit.back);
            if (!x.scatters || !x.material->is_glossy()) continue;
            const uint32_t side = scene_->side_of(hit.point(), hit.back), patch = scene_->patch_of_side(side);
            samples.evaluate(x, -ray.direction, step.bundle_density_w(), step.gather);
            for (size_t i = 0; i < step.bundles.size(); ++i) {
                const Bundle& bundle = step.bundles[i];
                if (!samples.is_lit(i) || !(bundle.cosine[patch] > 0)) continue;
                const Rgb scatter = samples.scatter(i);
                tally_.add(at(camera, pixel), step, to_double(scatter * bundle.irradiance[side]),
                           double{lum(scatter)} * double{bundle.cosine[patch]});
            }
        }
    });
}

}  // namespace lumel
