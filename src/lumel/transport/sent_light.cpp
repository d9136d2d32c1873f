#include "lumel/transport/sent_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/scene/surface.h"

namespace lumel {

SentLight::SentLight(const Scene& scene, const Emitters& emitters, Square at)
    : scene_(&scene), homogeneous_(emitters.homogeneous), diffuse_(scene.sides()) {
    for (uint32_t side = 0; side < scene.sides(); ++side) diffuse_[side] = emitters.diffuse[side] * (kInvPi / scene.side_area(side));
    std::vector<uint32_t> recorded;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        if (is_sharp(scene.material(scene.triangle_of_side(side)))) continue;
        const auto records = emitters.records_of(scene, side);
        if (std::any_of(records.begin(), records.end(), [](const Record& record) { return record.power > 0; })) recorded.push_back(side);
    }
    lobes_.resize(recorded.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, recorded.size(), 256), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) lobes_[i] = lobes_of(recorded[i], emitters.records_of(scene, recorded[i]), at);
    });
}

SentLight::Lobes SentLight::lobes_of(uint32_t side, std::span<const Record> records, Square at) const {
    const Surface y(*scene_, scene_->point_on_patch(scene_->patch_of_side(side), at), scene_->is_back(side));
    Lobes lobes{.side = side, .material = y.material, .normal = y.normal, .shading = Frame(y.shading)};
    for (size_t i = 0; i < kRecords; ++i) {
        const Vec3 wi = records[i].power > 0 ? lobes.shading.to_local(records[i].wi) : Vec3{};
        const bool lit = wi.z > 0;
        const Rgb scale = lit ? y.material->specular * records[i].flux *
                                    (ggx::G1(wi.z, y.material->alpha) / (4 * wi.z * scene_->side_area(side)))
                              : Rgb{};
        lobes.wi_x[i] = lit ? wi.x : 0, lobes.wi_y[i] = lit ? wi.y : 0, lobes.wi_z[i] = lit ? wi.z : 1;
        lobes.r[i] = scale.x, lobes.g[i] = scale.y, lobes.b[i] = scale.z;
    }
    return lobes;
}

Rgb SentLight::reflected(const Lobes& lobes, Vec3 wo) {
    // D of all half vectors at once.
    std::array<float, kRecords> D, h2;
    const float alpha = lobes.material->alpha;
    for (size_t i = 0; i < kRecords; ++i) {
        const float x = lobes.wi_x[i] + wo.x, y = lobes.wi_y[i] + wo.y, z = lobes.wi_z[i] + wo.z;
        h2[i] = x * x + y * y + z * z;
        D[i] = ggx::D(z * z / h2[i], alpha);
    }
    Rgb sum;
    for (size_t i = 0; i < kRecords; ++i) {
        const Rgb light = Rgb{lobes.r[i], lobes.g[i], lobes.b[i]} * D[i];
        sum += lobes.material->fresnel.any ? light * lobes.material->fresnel(0.5f * std::sqrt(h2[i])) : light;
    }
    return sum * (ggx::G1(wo.z, alpha) / wo.z);
}

void SentLight::along(Vec3 direction, std::span<Rgb> sent) const {
    std::copy(diffuse_.begin(), diffuse_.end(), sent.begin());
    for (const Lobes& lobes : lobes_) {
        const Vec3 wo = lobes.shading.to_local(dot(lobes.normal, direction) > 0 ? direction : -direction);
        if (wo.z > 0) sent[lobes.side] += reflected(lobes, wo);
    }
    if (!(max_component(homogeneous_) > 0)) return;
    for (uint32_t side = 0; side < scene_->sides(); ++side) {
        const Surface y(*scene_, scene_->centre_of_patch(scene_->patch_of_side(side)), scene_->is_back(side));
        const float cos = dot(y.shading, dot(y.normal, direction) > 0 ? direction : -direction);
        sent[side] += homogeneous_ * (Rgb{1, 1, 1} - y.material->diffuse - y.material->albedo_s(cos));
    }
}

}  // namespace lumel
