#include "lumel/transport/side_source.h"

namespace lumel {

SideSource::SideSource(const Scene& scene, const Emitters& emitters, uint32_t side, double rays_per_watt, uint32_t part)
    : scene_(&scene),
      material_(&scene.material(scene.triangle_of_side(side))),
      side_(side),
      part_(part),
      area_(scene.side_area(side)),
      density_(static_cast<float>(rays_per_watt) / scene.patch_area(scene.patch_of_side(side))),
      normal_(scene.geometric_normal(scene.triangle_of_side(side)) * (scene.is_back(side) ? -1.0f : 1.0f)),
      diffuse_(emitters.diffuse[side] * (kInvPi / area_)),
      homogeneous_(emitters.homogeneous),
      records_(emitters.records_of(scene, side)) {
    if (!emitters.behind_mirror.empty()) behind_mirror_ = emitters.behind_mirror[side] * (kInvPi / area_);
    if (part != kWhole) {
        const float share = scene.parts(side)->share(part);
        area_ *= share, density_ /= share;
        diffuse_ = emitters.diffuse_of(scene, side, part) * (kInvPi / area_);
    }
    cosine_power_ = lum(diffuse_ + behind_mirror_ + homogeneous_) * kPi * area_;
}

void SideSource::draw_points(Leaving& rays) const {
    // Positions and normals are linear over the triangle, hence over the patch, too.
    const uint32_t triangle = scene_->triangle_of_side(side_), count = padded(rays.size);
    const PatchCorners corners = scene_->tessellation().corners(scene_->patch_of_side(side_));
    const auto point = [&](int k) { return SurfacePoint{triangle, corners[k].u, corners[k].v}; };
    const Vec3 a = scene_->position(point(0)), ab = scene_->position(point(1)) - a, ac = scene_->position(point(2)) - a;
    const Barycentrics b = barycentrics(rays);
    for (uint32_t i = 0; i < count; ++i) rays.y.set(i, a + ab * b.u[i] + ac * b.v[i]);
    const Cover& cover = scene_->cover(side_);
    for (uint32_t i = 0; i < rays.size; ++i) rays.covered[i] = cover.covers({b.u[i], b.v[i]});
    if (!scene_->is_smooth(triangle)) {
        for (uint32_t i = 0; i < count; ++i) rays.shading.set(i, normal_);
        return;
    }
    const float sign = scene_->is_back(side_) ? -1.0f : 1.0f;
    const auto normal = [&](int k) { return scene_->interpolated_normal(point(k)) * sign; };
    const Vec3 n = normal(0), nb = normal(1) - n, nc = normal(2) - n;
    for (uint32_t i = 0; i < count; ++i) rays.shading.set(i, normalize(n + nb * b.u[i] + nc * b.v[i]));
}

SideSource::Barycentrics SideSource::barycentrics(const Leaving& rays) const {
    const uint32_t count = padded(rays.size);
    Barycentrics b;
    if (part_ == kWhole) {
        for (uint32_t i = 0; i < count; ++i) {
            const Square at = square_to_triangle({rays.point_u[i], rays.point_v[i]});
            b.u[i] = at.u, b.v[i] = at.v;
        }
        return b;
    }
    const PartPolygon polygon = scene_->parts(side_)->polygon(part_);
    for (uint32_t i = 0; i < count; ++i) {
        const Square at = polygon.point({rays.point_u[i], rays.point_v[i]});
        b.u[i] = at.u, b.v[i] = at.v;
    }
    return b;
}

void SideSource::draw_directions(Leaving& rays) const {
    // The cosine lobe owns the first positions, then come the records in their order.
    uint32_t cosine = rays.size;
    while (cosine > 0 && !records_.empty() && rays.at[cosine - 1] >= double{cosine_power_}) --cosine;
    draw_cosine(rays, cosine);
    if (cosine < rays.size) draw_lobe(rays, cosine);
}

void SideSource::draw_cosine(Leaving& rays, uint32_t size) const {
    const Frame frame(normal_);
    const uint32_t count = padded(size);
    for (uint32_t i = 0; i < count; ++i)
        rays.w.set(i, frame.to_world(square_to_cosine_hemisphere({rays.direction_u[i], rays.direction_v[i]})));
}

void SideSource::draw_lobe(Leaving& rays, uint32_t from) const {
    // Choose the record of every ray.
    Vec3Array<Leaving::kMost> from_wi;
    size_t record = 0;
    double end = double{cosine_power_} + double{power_of(records_[0])};
    for (uint32_t i = from; i < rays.size; ++i) {
        while (rays.at[i] >= end && record + 1 < records_.size()) end += double{power_of(records_[++record])};
        while (!(power_of(records_[record]) > 0) && record > 0) --record;
        from_wi.set(i, records_[record].wi);
    }
    // What points below the shading normal's horizon has no density: it is lost even where it is above the surface.
    const float alpha = material_->alpha;
    const Vec3 below = -normal_;
    const uint32_t count = rays.size;
    for (uint32_t i = from; i < count; ++i) {
        const Frame frame(rays.shading[i]);
        const Vec3 wi = frame.to_local(from_wi[i]), wo = ggx::sample(wi, alpha, {rays.direction_u[i], rays.direction_v[i]});
        const bool above = wi.z > 0 && wo.z > 0;
        const Vec3 w = frame.to_world(wo);
        rays.w.set(i, {above ? w.x : below.x, above ? w.y : below.y, above ? w.z : below.z});
    }
}

void SideSource::evaluate(Leaving& rays) const {
    const uint32_t count = padded(rays.size);
    Leaving::Floats cos_o;
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 w = rays.w[i];
        cos_o[i] = dot(rays.shading[i], w);
        rays.radiance.set(i, diffuse_);
        rays.pdf_aw[i] = cosine_power_ * kInvPi * std::max(0.0f, dot(normal_, w));
    }
    if (max_component(homogeneous_) > 0)
        for (uint32_t i = 0; i < count; ++i)
            rays.radiance.set(i, diffuse_ + homogeneous_ * (Rgb{1, 1, 1} - material_->diffuse - material_->albedo_s(cos_o[i])));
    for (const Record& record : records_)
        if (power_of(record) > 0) add(record, cos_o, rays);
    for (uint32_t i = 0; i < count; ++i) rays.pdf_aw[i] *= density_;
}

/// Add the specular lobe around a record: f flux / A, and the share that the lobe has in the density.
void SideSource::add(const Record& record, const Leaving::Floats& cos_o, Leaving& rays) const {
    const uint32_t count = padded(rays.size);
    const Vec3 wi = record.wi;
    const float alpha = material_->alpha, power = record.power;
    const bool fresnel = material_->fresnel.any;
    Leaving::Floats f, cos_h;
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 shading = rays.shading[i];
        const float cos_i = dot(shading, wi);
        const Vec3 across = wi + rays.w[i] - shading * (cos_i + cos_o[i]);
        const ggx::LobeAndDensity lobe = ggx::eval_with_pdf(cos_i, cos_o[i], dot(across, across), alpha);
        f[i] = lobe.f;
        if (fresnel) cos_h[i] = lobe.cos_h;
        rays.pdf_aw[i] += power * lobe.pdf_w;
    }
    const Rgb flux = material_->specular * record.flux * (1 / area_);
    if (fresnel)
        for (uint32_t i = 0; i < count; ++i) rays.radiance.set(i, rays.radiance[i] + flux * material_->fresnel(cos_h[i]) * f[i]);
    else
        for (uint32_t i = 0; i < count; ++i) rays.radiance.set(i, rays.radiance[i] + flux * f[i]);
}

SideSource::Emission SideSource::evaluate(Vec3 shading, Vec3 w) const {
    Leaving one;
    one.size = 1;
    for (uint32_t i = 0; i < kSideBySide; ++i) one.shading.set(i, shading), one.w.set(i, w);
    evaluate(one);
    const Rgb radiance = one.radiance[0];
    return {radiance, behind_mirror_, one.pdf_aw[0], sharp(radiance)};
}

}  // namespace lumel
