#include "lumel/eye/bright_patches.h"

#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr double kBright = 4;     // mean radiosities
constexpr double kOfLight = 0.5;  // share of the rays, of that in all light
constexpr double kLeast = 0.25;   // share in all light below which they are not worth a ray

}  // namespace

void BrightPatches::choose(const std::vector<float>& radiosity) {
    const auto area = [&](uint32_t side) { return double{scene_->patch_area(scene_->patch_of_side(side))}; };
    const auto power_of = [&](uint32_t side) { return area(side) * double{radiosity[side]}; };
    double lit = 0, power = 0, bright = 0;
    for (uint32_t side = 0; side < radiosity.size(); ++side)
        if (radiosity[side] > 0) lit += area(side), power += power_of(side);
    for (uint32_t side = 0; side < radiosity.size(); ++side)
        if (double{radiosity[side]} * lit > kBright * power) sides_.push_back(side), bright += power_of(side);
    if (!(bright > kLeast * power)) return;
    share_ = static_cast<float>(kOfLight * bright / power);
    power_ = Distribution(static_cast<uint32_t>(sides_.size()), [&](uint32_t i) { return power_of(sides_[i]); });
    pdf_area_.resize(radiosity.size());
    for (uint32_t i = 0; i < sides_.size(); ++i) pdf_area_[sides_[i]] = static_cast<float>(power_.probability(i) / area(sides_[i]));
}

std::optional<BrightPatches::Target> BrightPatches::draw(EyeStream& stream) const {
    if (!(share_ > 0)) return {};
    const Square choice = stream.next();
    if (!(choice.u < share_)) return {};
    const uint32_t side = sides_[power_.find(double{choice.v} * power_.total())];
    const SurfacePoint at = scene_->point_on_patch(scene_->patch_of_side(side), square_to_triangle(stream.next()));
    return Target{scene_->position(at), side};
}

float BrightPatches::weight(float pdf_w, const std::optional<Target>& target, Vec3 origin, const Hit& hit) const {
    if (!(share_ > 0)) return 1;
    const uint32_t side = scene_->side_of(hit.point(), hit.back);
    if (target && side != target->side) return 0;
    float sent = 0;
    if (pdf_area_[side] > 0) {
        const Vec3 way = scene_->position(hit.point()) - origin;
        const float d2 = dot(way, way), cos = std::abs(dot(scene_->geometric_normal(hit.triangle), way)) / std::sqrt(d2);
        if (!(cos > 0)) return 0;
        sent = pdf_area_[side] * d2 / cos;
    }
    return pdf_w / ((1 - share_) * pdf_w + share_ * sent);
}

}  // namespace lumel
