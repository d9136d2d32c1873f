#include "lumel/transport/frozen_bundles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/transport/sent_light.h"
#include "lumel/transport/solved_sight.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kSolve = 61, kDraw, kPoint, kDirection, kWindow, kRest };

/// Add the mean light of the bundles, W per side. Shading normals are those at `at` of each patch.
void receive(const Scene& scene, std::span<const Bundle> bundles, Square at, std::vector<Rgb>& received) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 1024), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const Surface x(scene, scene.point_on_patch(scene.patch_of_side(side), at), scene.is_back(side));
            Rgb64 sum;
            for (const Bundle& bundle : bundles) sum += sampled_irradiance(bundle, side, x);
            received[side] +=
                (sum * (double{scene.patch_area(scene.patch_of_side(side))} / static_cast<double>(bundles.size()))).to_float();
        }
    });
}

}  // namespace

FrozenBundles::FrozenBundles(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const BundleConfig& config)
    : BundleLight(accel, defensive, light, config),
      solved_(accel, defensive, light, {config.solve_rays, 0, key(config.stream, kSolve)}, rays_),
      over_mirrors_(accel.scene()) {}

void FrozenBundles::step(uint32_t directions, const Sink& sink) {
    const uint32_t most = bundles_of_batch(*scene_);
    for (uint32_t done = 0; done < directions; done += most) cast_batch(std::min(most, directions - done), sink);
}

void FrozenBundles::cast_batch(uint32_t directions, const Sink& sink) {
    const uint32_t batch = batch_++;
    if (scene_->glossy_sides() > 0)
        rays_ += solved_.step(*accel_, *defensive_, *light_, {rays_beside(), 0, key(config_.stream, kDraw, batch)}, [](auto&) {});

    std::vector<Vec3> along(directions);
    for (Vec3& direction : along) direction = bundle_direction(directions_++, key(config_.stream, kDirection));
    const Square at = square_to_triangle(sobol2d(batch, key(config_.stream, kPoint)));
    const SentLight light(*scene_, solved_.emitters(), at);
    const auto sent = [&](uint32_t, Vec3 direction, std::span<Rgb> radiance) { light.along(direction, radiance); };
    caster_.cast(along, key(config_.stream, kWindow, batch), sent, bundles_, stats_);

    shoot_beside(solved_.emitters(), key(config_.stream, kRest, batch), over_mirrors_);
    receive(*scene_, bundles_, at, received_);
    sink({transfers_, SolvedSight(*accel_, *defensive_, solved_.emitters()), received_, solved_.emitters(), bundles_});
}

}  // namespace lumel
