#include "lumel/areas/irradiance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/areas/neighbourhood.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr uint32_t kFarthest = 32;  // neighbours on either side in the order of sides
constexpr uint32_t kSides = 512;    // of a work item

}  // namespace

SideField SideMoments::field(uint32_t replicas) const {
    const double r = std::max(1u, replicas);
    SideField field{std::vector<Rgb>(sum_.size()), std::vector<Rgb>(sum_.size())};
    for (size_t side = 0; side < sum_.size(); ++side) {
        const Rgb64 mean = sum_[side] * (1 / r);
        field.mean[side] = mean.to_float();
        if (replicas < 2) continue;
        const Rgb64 spread = (squares_[side] - mean * mean * r) * (1 / (r * (r - 1)));
        field.variance[side] = Rgb64{std::max(0.0, spread.x), std::max(0.0, spread.y), std::max(0.0, spread.z)}.to_float();
    }
    return field;
}

void IrradianceAreas::measure(const Step& step) {
    step.transfers.group_plain(plain_);
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene_->sides(), kSides), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            measure_bundles(step, side);
            measure_shot(step, side);
        }
    });
}

void IrradianceAreas::measure_shot(const Step& step, uint32_t side) {
    const auto add = [&](Rgb light, float inv_pdf) {
        if (inv_pdf > 0)
            tally_.add(side, step, to_double(light), double{inv_pdf} / double{kPi});
        else
            tally_.add_plain(side, step, to_double(light));
    };
    for (const Carried& carried : plain_.of(side)) add(carried.flux, carried.inv_pdf);
    for (const Transfer& transfer : step.transfers.placed(side)) {
        const Surface x(*scene_, {scene_->triangle_of_side(side), transfer.u, transfer.v}, scene_->is_back(side));
        add(transfer.flux * adjoint(x.shading, x.normal, transfer.wi), transfer.inv_pdf);
    }
}

void IrradianceAreas::measure_bundles(const Step& step, uint32_t side) {
    if (step.bundles.empty()) return;
    const uint32_t patch = scene_->patch_of_side(side);
    const Surface x(*scene_, scene_->centre_of_patch(patch), scene_->is_back(side));
    const double scale = double{scene_->patch_area(patch)} / step.bundle_density_w(), open = double{scene_->open_share(side)};
    for (const Bundle& bundle : step.bundles) {
        if (!(bundle.cosine[patch] > 0)) continue;
        const Rgb light = bundle.irradiance[side] * adjoint(x.shading, x.normal, bundle.incoming(x.normal));
        tally_.add(side, step, to_double(light) * scale, double{bundle.cosine[patch]} / double{kPi} * scale * open);
    }
}

Samples IrradianceAreas::samples(uint32_t side) const {
    const double per_area = 1 / double{scene_->side_area(side)};
    Samples means = scaled(tally_.samples(side), per_area, per_area);
    means.size = double{scene_->side_area(side)};
    return means;
}

double IrradianceAreas::mean_hits() const {
    uint64_t hits = 0, sides = 0;
    for (uint32_t side = 0; side < scene_->sides(); ++side)
        if (const uint64_t here = tally_.hits(side); here > 0) hits += here, ++sides;
    return sides > 0 ? static_cast<double>(hits) / static_cast<double>(sides) : 0;
}

Samples IrradianceAreas::around(uint32_t position) const {
    const SideOrder& order = scene_->side_order();
    Samples sum;
    double area = 0;
    const auto add = [&](uint32_t at) {
        sum = pooled(sum, tally_.samples(order.side(at)));
        area += double{scene_->side_area(order.side(at))};
    };
    bool before = !order.starts_run(position), after = true;
    for (uint32_t away = 1; away <= kFarthest && sum.hits < kEnoughAround && (before || after); ++away) {
        if (before) add(position - away), before = !order.starts_run(position - away);
        after = after && position + away < order.size() && !order.starts_run(position + away);
        if (after) add(position + away);
    }
    if (area > 0) sum = scaled(sum, 1 / area, 1 / area);
    sum.size = area;
    return sum;
}

SideField IrradianceAreas::field(const Estimator& estimator) const {
    const SideOrder& order = scene_->side_order();
    SideField field{std::vector<Rgb>(order.size()), std::vector<Rgb>(order.size())};
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, order.size(), kSides), [&](const auto& range) {
        for (uint32_t position = range.begin(); position < range.end(); ++position) {
            const uint32_t side = order.side(position);
            const Estimate e = estimator.estimate_to_average(samples(side), around(position));
            field.mean[side] = e.value.to_float(), field.variance[side] = e.variance.to_float();
        }
    });
    return field;
}

}  // namespace lumel
