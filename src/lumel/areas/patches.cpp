#include "lumel/areas/patches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "lumel/areas/arrivals.h"
#include "lumel/areas/bundle_samples.h"
#include "lumel/areas/lobe_albedo.h"
#include "lumel/areas/lobe_looks.h"
#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr double kUniform = 0.97;      // albedos of a patch that differ by less are uniform,
constexpr float kFlat = 0.9999f;       // unless its normals differ by more (cosine)
constexpr float kGrazing = 0.4f;       // where it is seen at less (cosine)
constexpr uint32_t kPoints = 64;       // on a patch that is not uniform
constexpr uint32_t kLobeSamples = 64;  // at each midpoint; where it is not seen at grazing angles, hardly any of the lobe is below it,
constexpr uint32_t kFewSamples = 16;   // and these will do

/// Mean lum(a_s) of a side towards an eye: by the edge midpoints rule, and where these differ, at its silhouette say, by many points.
double mean_albedo(const Scene& scene, uint32_t side, Vec3 eye) {
    const auto albedo_at = [&](Square s, uint32_t lobe_samples, uint64_t stream) {
        const Surface x(scene, scene.point_on_patch(scene.patch_of_side(side), s), scene.is_back(side));
        return double{lobe_albedo(x, normalize(eye - x.x), lobe_samples, stream)};
    };
    const Surface centre(scene, scene.centre_of_patch(scene.patch_of_side(side)), scene.is_back(side));
    const bool grazing = dot(centre.shading, normalize(eye - centre.x)) < kGrazing,
               silhouette = grazing && dot(centre.normal, centre.shading) < kFlat;
    const uint32_t samples = grazing ? kLobeSamples : kFewSamples;
    const std::array midpoints{albedo_at({0.5f, 0.0f}, samples, 1), albedo_at({0.5f, 0.5f}, samples, 1),
                               albedo_at({0.0f, 0.5f}, samples, 1)};
    const auto [least, most] = std::minmax_element(midpoints.begin(), midpoints.end());
    if (*least >= kUniform * *most && !silhouette) return (midpoints[0] + midpoints[1] + midpoints[2]) / 3;
    double sum = 0;
    for (uint32_t i = 0; i < kPoints; ++i) sum += albedo_at(square_to_triangle(sobol2d(i, 2)), kLobeSamples / 8, key(3, i));
    return sum / kPoints;
}

}  // namespace

PatchAreas::PatchAreas(const Scene& scene, std::vector<Vec3> eyes, std::vector<uint32_t> measured)
    : scene_(&scene), eyes_(std::move(eyes)), sides_(std::move(measured)) {
    albedo_.resize(sides_.size() * eyes_.size());
    tally_ = Tally(albedo_.size());
    tbb::parallel_for(uint32_t{0}, size(), [&](uint32_t area) {
        for (uint32_t eye = 0; eye < eyes_.size(); ++eye) albedo_[at(eye, area)] = mean_albedo(scene, sides_[area], eyes_[eye]);
    });
}

void PatchAreas::measure(const Step& step) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, size(), 64), [&](const auto& range) {
        BundleSamples samples(step.bundles);
        LobeLooks looks(*scene_, step, tally_);
        for (uint32_t area = range.begin(); area < range.end(); ++area) {
            measure_shot(step, area);
            if (!step.bundles.empty()) measure_bundles(step, samples, area);
            for (uint32_t eye = 0; eye < eyes(); ++eye) look(step, area, eye, looks);
        }
        looks.see();
    });
}

void PatchAreas::measure_shot(const Step& step, uint32_t area) {
    const uint32_t side = sides_[area], triangle = scene_->triangle_of_side(side);
    const bool back = scene_->is_back(side);
    const float gather_density = static_cast<float>(step.gather) / scene_->patch_area(scene_->patch_of_side(side));
    Arrivals arrivals(scene_->material(triangle));
    const auto measure = [&] {
        for (uint32_t eye = 0; eye < eyes(); ++eye) {
            if (!(albedo_[at(eye, area)] > 0)) continue;
            arrivals.look_from(eyes_[eye], gather_density);
            for (uint32_t i = 0; i < arrivals.size(); ++i) {
                if (arrivals.has_density(i))
                    tally_.add(at(eye, area), step, arrivals.f(i), arrivals.g(i));
                else
                    tally_.add_plain(at(eye, area), step, arrivals.f(i));
            }
        }
        arrivals.clear();
    };
    for (const Transfer& transfer : step.transfers.placed(side)) {
        arrivals.add(Surface(*scene_, {triangle, transfer.u, transfer.v}, back), transfer);
        if (arrivals.is_full()) measure();
    }
    measure();
}

void PatchAreas::look(const Step& step, uint32_t area, uint32_t eye, LobeLooks& looks) const {
    if (!(albedo_[at(eye, area)] > 0)) return;
    const uint32_t side = sides_[area], patch = scene_->patch_of_side(side), triangle = scene_->triangle_of_patch(patch);
    const uint64_t stream = key(step.stream, side, eye), point_stream = key(stream, 1), lobe_stream = key(stream, 2);
    const uint32_t count = looks.begin(at(eye, area), double{scene_->patch_area(patch)}, stream);
    if (count == 0) return;
    const PatchCorners corners = scene_->tessellation().corners(patch);
    for (uint32_t i = 0; i < count; ++i) {
        const Square p = within(corners, square_to_triangle(sobol2d(i, point_stream)));
        const Surface x(*scene_, {triangle, p.u, p.v}, scene_->is_back(side));
        looks.draw(x, normalize(eyes_[eye] - x.x), 1, sobol2d(i, lobe_stream));
    }
}

Samples PatchAreas::samples(uint32_t eye, uint32_t area) const {
    const double size = scene_->side_area(sides_[area]), albedo = albedo_[at(eye, area)];
    return scaled(unscaled(eye, area), 1 / size, albedo > 0 ? 1 / (size * albedo) : 0);
}

}  // namespace lumel
