#include "lumel/areas/bundle_field.h"

#include <tbb/parallel_for.h>

namespace lumel {

namespace {

/// Add `weight` times what `from` has to `to`, lane by lane where `takes`.
void add(const BundleField::Light& from, float weight, const BundleField::Lane& takes, BundleField::Light& to) {
    for (size_t i = 0; i < takes.size(); ++i) {
        const float w = takes[i] > 0 ? weight : 0.0f;
        to.r[i] += w * from.r[i], to.g[i] += w * from.g[i], to.b[i] += w * from.b[i], to.cosine[i] += w * from.cosine[i];
    }
}

}  // namespace

BundleField::BundleField(const Scene& scene, const Lattice& lattice, std::span<const uint32_t> sides)
    : scene_(&scene), lattice_(&lattice), slot_(size_t{lattice.size()} * 2, Scene::kNone) {
    // A vertex of one side alone has nothing to pool.
    const auto for_corners = [&](auto&& visit) {
        for (uint32_t side : sides)
            for (uint32_t corner : lattice.corners(scene.patch_of_side(side)))
                visit(side, corner + (scene.is_back(side) ? lattice.size() : 0));
    };
    std::vector<uint32_t> count(slot_.size());
    for_corners([&](uint32_t, uint32_t vertex) { ++count[vertex]; });
    first_side_.push_back(0);
    for (uint32_t vertex = 0; vertex < slot_.size(); ++vertex)
        if (count[vertex] > 1) {
            slot_[vertex] = static_cast<uint32_t>(first_side_.size() - 1);
            first_side_.push_back(first_side_.back() + count[vertex]);
        }

    // List the sides around each.
    sides_.resize(first_side_.back());
    normal_.resize(first_side_.size() - 1), light_.resize(normal_.size());
    std::vector<uint32_t> next(first_side_.begin(), first_side_.end() - 1);
    for_corners([&](uint32_t side, uint32_t vertex) {
        if (slot_[vertex] == Scene::kNone) return;
        sides_[next[slot_[vertex]]++] = side;
        normal_[slot_[vertex]] += normal_of(side) * scene.side_area(side);
    });
}

void BundleField::cosines(Vec3 normal, Lane& cosine) const {
    for (size_t i = 0; i < cosine.size(); ++i) cosine[i] = normal.x * x_[i] + normal.y * y_[i] + normal.z * z_[i];
}

void BundleField::pool(std::span<const Bundle> bundles) {
    bundles_ = bundles.first(std::min(bundles.size(), BundleSamples::kMost));
    for (size_t i = 0; i < bundles_.size(); ++i)
        x_[i] = bundles[i].direction.x, y_[i] = bundles[i].direction.y, z_[i] = bundles[i].direction.z;
    tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(light_.size()), [&](uint32_t slot) { pool_slot(slot); });
}

void BundleField::pool_slot(uint32_t slot) {
    Light& light = light_[slot] = {};
    Lane front, cosine, weight{};
    cosines(normal_[slot], front);
    for (uint32_t k = first_side_[slot]; k < first_side_[slot + 1]; ++k) {
        const uint32_t side = sides_[k], patch = scene_->patch_of_side(side);
        const float area = scene_->side_area(side), whole = scene_->patch_area(patch);
        cosines(normal_of(side), cosine);
        for (size_t i = 0; i < bundles_.size(); ++i) {
            if (!(front[i] * cosine[i] > 0)) continue;
            const Rgb irradiance = bundles_[i].irradiance[side] * whole;
            light.r[i] += irradiance.x, light.g[i] += irradiance.y, light.b[i] += irradiance.z;
            light.cosine[i] += bundles_[i].cosine[patch] * area, weight[i] += std::abs(cosine[i]) * area;
        }
    }
    for (size_t i = 0; i < weight.size(); ++i) {
        const float scale = weight[i] > 0 ? 1 / weight[i] : 0.0f;
        light.r[i] *= scale, light.g[i] *= scale, light.b[i] *= scale, light.cosine[i] *= scale;
    }
}

void BundleField::at(SurfacePoint p, bool back, Light& light) const {
    const Lattice::Stencil stencil = lattice_->stencil(p, back);
    const uint32_t side = stencil.patch + (back ? scene_->patches() : 0);
    Lane cosine, front, takes, rest{};
    cosines(normal_of(side), cosine);
    light = {};
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t slot = slot_[stencil.vertex[k] + (back ? lattice_->size() : 0)];
        const float weight = stencil.weight[k];
        if (slot == Scene::kNone) {
            for (float& r : rest) r += weight;
            continue;
        }
        // A vertex that sees the other end of a line knows nothing of this one.
        cosines(normal_[slot], front);
        for (size_t i = 0; i < takes.size(); ++i) takes[i] = front[i] * cosine[i], rest[i] += takes[i] > 0 ? 0.0f : weight;
        add(light_[slot], weight, takes, light);
    }
    for (size_t i = 0; i < bundles_.size(); ++i) {
        const float cos = std::abs(cosine[i]);
        light.r[i] *= cos, light.g[i] *= cos, light.b[i] *= cos, light.cosine[i] *= cos;
        if (!(rest[i] > 0)) continue;
        const Rgb own = bundles_[i].irradiance[side];
        light.r[i] += rest[i] * own.x, light.g[i] += rest[i] * own.y, light.b[i] += rest[i] * own.z;
        light.cosine[i] += rest[i] * bundles_[i].cosine[stencil.patch];
    }
}

}  // namespace lumel
