// How patches measure bundles.
#include "lumel/areas/bundle_samples.h"
#include "lumel/areas/patches.h"
#include "lumel/sampling/warp.h"

namespace lumel {

void PatchAreas::measure_bundles(const Step& step, BundleSamples& samples, uint32_t area) {
    const uint32_t side = sides_[area], patch = scene_->patch_of_side(side);
    const double size = scene_->patch_area(patch), open_size = scene_->side_area(side);
    // The light of a bundle is a mean over the side, and one point of it stands for the lobes there.
    const Square s = square_to_triangle(sobol2d(0, key(step.stream, side)));
    const Surface x(*scene_, scene_->point_on_patch(patch, s), scene_->is_back(side));
    for (uint32_t eye = 0; eye < eyes(); ++eye) {
        if (!(albedo_[at(eye, area)] > 0)) continue;
        samples.evaluate(x, normalize(eyes_[eye] - x.x), step.bundle_density_w(), step.gather);
        for (size_t i = 0; i < step.bundles.size(); ++i) {
            if (!samples.is_lit(i) || !(step.bundles[i].cosine[patch] > 0)) continue;
            const Rgb scatter = samples.scatter(i);
            tally_.add(at(eye, area), step, to_double(scatter * step.bundles[i].irradiance[side]) * size,
                       double{lum(scatter)} * double{step.bundles[i].cosine[patch]} * open_size);
        }
    }
}

}  // namespace lumel
