// How pixels measure bundles.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/areas/bundle_samples.h"
#include "lumel/areas/pixels.h"

namespace lumel {

void PixelAreas::measure_bundles(const Step& step) {
    field_.pool(step.bundles);
    for (uint32_t camera = 0; camera < cameras(); ++camera) measure_bundles(step, camera);
}

void PixelAreas::measure_bundles(const Step& step, uint32_t camera) {
    const Camera& view = cameras_[camera];
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, view.width * view.height, 256), [&](const auto& range) {
        const FlushDenormals flush;
        BundleSamples samples(step.bundles);
        BundleField::Light light;
        for (uint32_t pixel = range.begin(); pixel < range.end(); ++pixel) {
            if (!(albedo(camera, pixel) > 0)) continue;
            // One point of the pixel stands for its lobes.
            const Ray ray{view.origin, view.direction(view.on_film(pixel, sobol2d(0, key(step.stream, camera, pixel))))};
            const Hit hit = accel_->intersect(ray);
            if (hit.is_miss()) continue;
            const Surface x(*scene_, hit.point(), hit.back);
            if (!x.scatters || !x.material->is_glossy()) continue;
            samples.evaluate(x, -ray.direction, step.bundle_density_w(), step.gather);
            field_.at(hit.point(), hit.back, light);
            for (size_t i = 0; i < step.bundles.size(); ++i) {
                if (!samples.is_lit(i) || !(light.cosine[i] > 0)) continue;
                const Rgb scatter = samples.scatter(i);
                tally_.add(at(camera, pixel), step, to_double(scatter * light.irradiance(i)),
                           double{lum(scatter)} * double{light.cosine[i]});
            }
        }
    });
}

}  // namespace lumel
