#include "lumel/transport/iterated_bundles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/transport/sent_light.h"
#include "lumel/transport/solved_sight.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kLamps = 71, kPoint, kDirection, kWindow, kRest, kDraw, kMerge };

constexpr uint32_t kMostChains = 16;
constexpr double kUnsettled = 1e-3;   // share of the light that may be missing when measuring begins
constexpr int kMostWarmUp = 256;

/// Iterations until what is left of the light that was there at first is reflected away.
int warm_up(const Scene& scene) {
    float most = 0;
    for (const Material& material : scene.materials()) most = std::max(most, material.max_albedo());
    if (!(most < 1)) return kMostWarmUp;
    return most > 0 ? static_cast<int>(std::clamp(std::ceil(std::log(kUnsettled) / std::log(double{most})), 1.0, double{kMostWarmUp})) : 1;
}

/// Draw the surface records of a side from the light of all chains: even steps through the running sum of its power.
void draw_records(std::span<const Record> arrived, double power, uint64_t stream, std::span<Record> records) {
    const double step = power / kSurfaceRecords;
    double next = step * to_unit(static_cast<uint32_t>(stream >> 32)), sum = 0;
    int drawn = 0;
    for (const Record& light : arrived)
        for (sum += light.power; drawn < kSurfaceRecords && next < sum; next += step)
            records[kLampRecords + drawn++] = {light.wi, light.flux * static_cast<float>(step / light.power), static_cast<float>(step)};
}

/// Add the light of `part` to `total`.
void add(const Scene& scene, const Emitters& part, uint64_t stream, Emitters& total) {
    for (size_t side = 0; side < total.diffuse.size(); ++side) total.diffuse[side] += part.diffuse[side];
    merge_records(scene, part, stream, total);
}

}  // namespace

IteratedBundles::IteratedBundles(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light,
                                 const BundleConfig& config)
    : BundleLight(accel, defensive, light, config),
      lamps_(light.emitters()),
      over_mirrors_(accel.scene()),
      reflected_(accel.scene()),
      chains_(std::min(kMostChains, bundles_of_batch(accel.scene()))) {
    for (Emitters* emitters : {&lamps_, &over_mirrors_, &reflected_}) emitters->of_part.clear();  // bundles bring light to sides as a whole
    for (Chain& chain : chains_) chain.irradiance.resize(scene_->sides());
    for (int i = warm_up(*scene_); i > 0; --i) iterate(nullptr);
}

void IteratedBundles::step(uint32_t directions, const Sink& sink) {
    for (size_t done = 0; done < directions; done += chains_.size()) iterate(&sink);
}

void IteratedBundles::iterate(const Sink* sink) {
    const uint64_t stream = key(config_.stream, batch_++);
    light_->refresh(key(stream, kLamps), lamps_);
    Emitters source = lamps_;
    add(*scene_, over_mirrors_, key(stream, kMerge, 0), source);

    // Directions of one iteration are spread over the chains; those of one chain are independent, as its light went through all of them.
    std::vector<Vec3> directions(chains_.size());
    for (uint32_t i = 0; i < directions.size(); ++i) directions[i] = bundle_direction(i, key(stream, kDirection));
    const Square at = square_to_triangle(sobol2d(0, key(stream, kPoint)));
    const SentLight light(*scene_, source, at);
    const auto sent = [&](uint32_t i, Vec3 direction, std::span<Rgb> radiance) {
        light.along(direction, radiance);
        add_reflected(chains_[i], direction, at, radiance);
    };
    BundleStats unmeasured;
    caster_.cast(directions, key(stream, kWindow), sent, bundles_, sink ? stats_ : unmeasured);

    Emitters all = std::move(source);
    add(*scene_, reflected_, key(stream, kMerge, 1), all);
    shoot_beside(all, key(stream, kRest), over_mirrors_);
    take_bundles(at, key(stream, kDraw));
    if (sink) (*sink)({transfers_, SolvedSight(*accel_, *defensive_, all), received_, reflected_, bundles_});
}

void IteratedBundles::add_reflected(const Chain& chain, Vec3 direction, Square at, std::span<Rgb> sent) const {
    for (uint32_t side = 0; side < scene_->sides(); ++side) {
        const Rgb irradiance = chain.irradiance[side];
        if (!(max_component(irradiance) > 0)) continue;
        const Material& material = scene_->material(scene_->triangle_of_side(side));
        sent[side] += material.diffuse * irradiance * kInvPi;
        if (!material.is_glossy() || is_sharp(material)) continue;
        const Surface y(*scene_, scene_->point_on_patch(scene_->patch_of_side(side), at), scene_->is_back(side));
        const Frame frame(y.shading);
        const Vec3 wi = frame.to_local(dot(y.normal, chain.direction) > 0 ? chain.direction : -chain.direction);
        const Vec3 wo = frame.to_local(dot(y.normal, direction) > 0 ? direction : -direction);
        if (wi.z > 0) sent[side] += material.scatter_s(wi, wo) * irradiance * (1 / wi.z);
    }
}

void IteratedBundles::take_bundles(Square at, uint64_t stream) {
    for (size_t i = 0; i < chains_.size(); ++i) chains_[i].direction = bundles_[i].direction;
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene_->sides(), 512), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const Surface x(*scene_, scene_->point_on_patch(scene_->patch_of_side(side), at), scene_->is_back(side));
            const bool scatters = scene_->scatters(side), glossy = scene_->glossy_index(side) != Scene::kNone;
            const float share = scene_->patch_area(scene_->patch_of_side(side)) / static_cast<float>(chains_.size());
            std::array<Record, kMostChains> arrived;
            Rgb64 sum;
            double power = 0;
            for (size_t i = 0; i < chains_.size(); ++i) {
                const Rgb irradiance = sampled_irradiance(bundles_[i], side, x);
                chains_[i].irradiance[side] = scatters ? irradiance * (1 / scene_->open_share(side)) : Rgb{};
                const Vec3 wi = bundles_[i].incoming(x.normal);
                const Rgb flux = irradiance * share;
                arrived[i] = {wi, flux, glossy ? lum(flux * x.material->albedo_s(dot(x.shading, wi))) : 0.0f};
                sum += flux, power += double{arrived[i].power};
            }
            received_[side] += sum.to_float();
            reflected_.diffuse[side] = scatters ? sum.to_float() * x.material->diffuse : Rgb{};
            reflected_.clear_records(*scene_, side);
            if (!(power > 0)) continue;
            draw_records(std::span(arrived).first(chains_.size()), power, key(stream, side), reflected_.open_records(*scene_, side));
        }
    });
}

}  // namespace lumel
