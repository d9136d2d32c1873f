#include "lumel/transport/bundles.h"

#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kJitter = 51, kBeside, kScatter };

constexpr uint32_t kLeastWindow = 64, kMostWindow = 4096;
constexpr double kPixelsPerPatch = 16;         // of a patch that faces the direction, where no window is given
constexpr uint32_t kLeastBatch = 8, kMostBatch = 64;
constexpr size_t kBatchBytes = size_t{256} << 20;
constexpr uint64_t kLeastRays = 8192;            // beside a batch of bundles

/// The pixels of an edge that give patches of mean area about kPixelsPerPatch pixels.
uint32_t window_of(const Scene& scene) {
    const double patch = scene.total_area() / scene.patches(), edge = 2 * double{scene.radius()};
    return static_cast<uint32_t>(std::clamp(edge * std::sqrt(kPixelsPerPatch / patch), double{kLeastWindow}, double{kMostWindow}));
}

}  // namespace

BundleStats& BundleStats::operator+=(const BundleStats& o) {
    raster += o.raster;
    window = std::max(window, o.window);
    sent += o.sent, received += o.received, escaped += o.escaped, mispaired += o.mispaired;
    return *this;
}

BundleCaster::BundleCaster(const Scene& scene, uint32_t window) : scene_(scene), window_(window > 0 ? window : window_of(scene)) {}

void BundleCaster::cast(std::span<const Vec3> directions, uint64_t stream, const Sent& sent, std::vector<Bundle>& bundles,
                        BundleStats& stats) {
    bundles.resize(directions.size());
    std::vector<BundleStats> stats_of(directions.size());
    tbb::parallel_for(size_t{0}, directions.size(), [&](size_t i) {
        Scratch& scratch = scratch_.local();
        if (!scratch.buffer) scratch.buffer.emplace(scene_);
        scratch.sent.resize(scene_.scene().sides());
        sent(static_cast<uint32_t>(i), directions[i], scratch.sent);
        stats_of[i] = cast_one(directions[i], key(stream, i), scratch, bundles[i]);
    });
    for (const BundleStats& s : stats_of) stats += s;
}

BundleStats BundleCaster::cast_one(Vec3 direction, uint64_t stream, Scratch& scratch, Bundle& bundle) const {
    const Scene& scene = scene_.scene();
    const Window window = Window::covering(scene, direction, window_, sobol2d(0, key(stream, kJitter)));
    scratch.received.assign(scene.sides(), {});
    scratch.pixels.assign(scene.patches(), 0);
    BundleStats stats;
    scratch.buffer->exchange(window, scratch.sent, scratch.received, scratch.pixels, stats.raster);

    // From sums over pixels to means over sides.
    bundle.direction = direction;
    bundle.irradiance.resize(scene.sides());
    bundle.cosine.resize(scene.patches());
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const float share = window.pixel_area / scene.patch_area(patch);
        bundle.cosine[patch] = static_cast<float>(scratch.pixels[patch]) * share;
        for (const uint32_t side : {patch, patch + scene.patches()}) {
            bundle.irradiance[side] = scratch.received[side] * share;
            stats.sent += double{lum(scratch.sent[side])} * scratch.pixels[patch];
            stats.received += double{lum(scratch.received[side])};
        }
    }
    const double pixel = window.pixel_area;
    stats.window = window_;
    stats.sent *= pixel, stats.received *= pixel;
    stats.escaped = lum(stats.raster.escaped) * pixel, stats.mispaired = lum(stats.raster.mispaired) * pixel;
    return stats;
}

Vec3 bundle_direction(uint32_t index, uint64_t stream) {
    const Square s = sobol2d(index, stream);
    return square_to_sphere({0.5f * s.u, s.v});
}

uint32_t bundles_of_batch(const Scene& scene) {
    const size_t each = size_t{scene.sides()} * (sizeof(Rgb) + sizeof(float) / 2);
    return static_cast<uint32_t>(std::clamp(kBatchBytes / each, size_t{kLeastBatch}, size_t{kMostBatch}));
}

BundleLight::BundleLight(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const BundleConfig& config)
    : accel_(&accel),
      defensive_(&defensive),
      light_(&light),
      scene_(&accel.scene()),
      config_(config),
      caster_(*scene_, config.window),
      received_(scene_->sides()) {
    transfers_.group_by_side(scene_->sides());
    const auto& materials = scene_->materials();
    needs_rays_ = scene_->has_mirrors() || std::any_of(materials.begin(), materials.end(), is_sharp);
}

uint64_t BundleLight::rays_beside() const { return std::max<uint64_t>(kLeastRays, 2 * uint64_t{scene_->patches()}); }

void BundleLight::shoot_beside(const Emitters& emitters, uint64_t stream, Emitters& next) {
    std::fill(received_.begin(), received_.end(), Rgb{});
    if (!needs_rays_ && !emitters.point_lamps) return;
    shoot(Shot(*accel_, emitters, *defensive_, {rays_beside(), 0, key(stream, kBeside), true}), transfers_);
    scatter(*scene_, transfers_, key(stream, kScatter), received_, next);
    rays_ += transfers_.shot;
}

}  // namespace lumel
