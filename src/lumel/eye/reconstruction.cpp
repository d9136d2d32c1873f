#include "lumel/eye/reconstruction.h"

#include <tbb/parallel_for.h>

#include "lumel/eye/smooth.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

uint64_t edge_name(uint32_t a, uint32_t b) { return uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

/// For every area, the first slot that it has to itself: on flat facets all three corners are alike, and one estimate serves them.
std::vector<uint32_t> first_slots_of_single_areas(const Neighbourhood& neighbourhood, uint32_t areas) {
    std::vector<uint32_t> first(areas, Scene::kNone);
    for (uint32_t slot = 0; slot < neighbourhood.slots(); ++slot)
        if (const auto own = neighbourhood.own(slot); own.size() == 1 && first[own[0]] == Scene::kNone) first[own[0]] = slot;
    return first;
}

}  // namespace

Reconstruction::Reconstruction(const Accel& accel, const Lattice& lattice, const Solution& solution, const Estimator& estimator)
    : accel_(&accel),
      scene_(&accel.scene()),
      lattice_(&lattice),
      neighbourhood_(*scene_, lattice, solution.areas),
      specular_(solution.areas.eyes()) {
    find_cut_edges();
    pool_.emplace(*scene_, lattice, [&](const Lattice::Hanging& hanging, bool back) { return is_cut(hanging, back); });
    const SideField indirect = smoothed(*scene_, lattice, solution.indirect);
    indirect_ = pooled(indirect);
    direct_ = pooled(solution.direct);
    bright_patches_ = {*scene_, [&](uint32_t side) { return indirect.mean[side] + solution.direct.mean[side]; }};
    for (uint32_t eye = 0; eye < solution.areas.eyes(); ++eye) estimate_specular(solution.areas, estimator, eye);
}

void Reconstruction::find_cut_edges() {
    for (uint32_t side = 0; side < scene_->sides(); ++side) {
        const Cover& cover = scene_->cover(side);
        const PatchParts* parts = scene_->parts(side);
        if (!parts && !cover.corner[0] && !cover.corner[1] && !cover.corner[2]) continue;
        const uint32_t patch = scene_->patch_of_side(side);
        const PatchCorners corner = scene_->tessellation().corners(patch);
        const auto vertex = lattice_->corners(patch);
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3;
            const bool is_cut = cover.corner[k] || cover.corner[next] ||
                                (parts && parts->part_of(corner[k]) != parts->part_of(corner[next]));
            const bool back = scene_->is_back(side);
            if (is_cut) cut_edges_.push_back(edge_name(vertex_side(vertex[k], back), vertex_side(vertex[next], back)));
        }
    }
    std::sort(cut_edges_.begin(), cut_edges_.end());
}

bool Reconstruction::is_cut(const Lattice::Hanging& hanging, bool back) const {
    const uint64_t name = edge_name(vertex_side(hanging.ends[0], back), vertex_side(hanging.ends[1], back));
    return std::binary_search(cut_edges_.begin(), cut_edges_.end(), name);
}

Reconstruction::VertexField Reconstruction::pooled(const SideField& field) const {
    VertexField at{std::vector<Rgb>(pool_->size()), std::vector<Rgb>(pool_->size())};
    tbb::parallel_for(uint32_t{0}, pool_->size(), [&](uint32_t vertex) {
        double area = 0;
        Rgb64 value, variance;
        for (const VertexPool::Entry& entry : pool_->of(vertex)) {
            const double a = double{entry.weight};
            area += a;
            value += to_double(field.mean[entry.side]) * a;
            variance += to_double(field.variance[entry.side]) * (a * a);
        }
        if (!(area > 0)) return;
        at.value[vertex] = (value * (1 / area)).to_float();
        at.stderr_[vertex] = square_root((variance * (1 / (area * area))).to_float());
    });
    for (const Lattice::Hanging& hanging : pool_->hanging()) {
        const auto [a, b] = hanging.ends;
        at.value[hanging.vertex] = (at.value[a] + at.value[b]) * 0.5f;
        at.stderr_[hanging.vertex] = (at.stderr_[a] + at.stderr_[b]) * 0.5f;
    }
    return at;
}

void Reconstruction::estimate_specular(const PatchAreas& areas, const Estimator& estimator, uint32_t eye) {
    specular_[eye].resize(neighbourhood_.slots());
    std::vector<uint8_t> borrowed(neighbourhood_.slots()), unfilled(neighbourhood_.slots());
    const auto first_alone = first_slots_of_single_areas(neighbourhood_, areas.size());
    const auto is_repeated = [&](uint32_t slot) {
        const auto own = neighbourhood_.own(slot);
        return own.size() == 1 && first_alone[own[0]] != slot;
    };
    tbb::parallel_for(uint32_t{0}, neighbourhood_.slots(), [&](uint32_t slot) {
        if (is_repeated(slot)) return;
        const AreaEstimate e = estimate_pooled(areas, neighbourhood_, eye, neighbourhood_.own(slot), estimator);
        borrowed[slot] = e.borrowed, unfilled[slot] = e.unfilled;
        specular_[eye][slot] = {e.estimate.value.to_float(), square_root(e.estimate.variance.to_float()), e.trust};
    });
    for (uint32_t slot = 0; slot < neighbourhood_.slots(); ++slot)
        if (is_repeated(slot)) specular_[eye][slot] = specular_[eye][first_alone[neighbourhood_.own(slot)[0]]];
    hang_specular(eye);
    for (const Reconstructed& r : specular_[eye]) measured_ += r.trust.hits > 0, flagged_ += r.trust.flag > 0;
    borrowed_ += static_cast<uint32_t>(std::count(borrowed.begin(), borrowed.end(), 1));
    unfilled_ += static_cast<uint32_t>(std::count(unfilled.begin(), unfilled.end(), 1));
}

void Reconstruction::hang_specular(uint32_t eye) {
    for (const Lattice::Hanging& hanging : lattice_->hanging())
        for (bool back : {false, true}) {
            if (is_cut(hanging, back)) continue;
            const uint32_t slot = neighbourhood_.slot(vertex_side(hanging.vertex, back)),
                           a = neighbourhood_.slot(vertex_side(hanging.ends[0], back)),
                           b = neighbourhood_.slot(vertex_side(hanging.ends[1], back));
            if (slot == Scene::kNone || a == Scene::kNone || b == Scene::kNone) continue;
            const Reconstructed &from = specular_[eye][a], &to = specular_[eye][b];
            Reconstructed& mean = specular_[eye][slot];
            mean.value = (from.value + to.value) * 0.5f, mean.stderr_ = (from.stderr_ + to.stderr_) * 0.5f;
        }
}

Lattice::Stencil Reconstruction::stencil(SurfacePoint p, bool back) const {
    Lattice::Stencil s = lattice_->stencil(p, back);
    for (uint32_t& vertex : s.vertex) vertex = vertex_side(vertex, back);
    if (!scene_->cover(s.patch + (back ? scene_->patches() : 0)).divides) return s;
    const Vec3 from = Surface(*scene_, p, back).off(scene_->epsilon());
    std::array<bool, 3> sees{}, nearest{};
    for (int k = 0; k < 3; ++k) {
        const Surface corner(*scene_, scene_->point_on_patch(s.patch, kCornersFromWithin[k]), back);
        sees[k] = s.weight[k] > 0 && accel_->visible(from, corner.off(scene_->epsilon()));
    }
    nearest[std::max_element(s.weight.begin(), s.weight.end()) - s.weight.begin()] = true;
    if (!Lattice::keep(s, sees)) Lattice::keep(s, nearest);
    return s;
}

Reconstructed Reconstruction::irradiance(const Lattice::Stencil& at) const {
    Reconstructed r;
    for (int k = 0; k < 3; ++k) {
        r.value += indirect_.value[at.vertex[k]] * at.weight[k];
        r.stderr_ += indirect_.stderr_[at.vertex[k]] * at.weight[k];
    }
    return r;
}

std::optional<SurfacePoint> Reconstruction::draw_source(const Lattice::Stencil& at, Square choice, Square where) const {
    int k = 0;
    for (float left = choice.u - at.weight[0]; k < 2 && left >= 0; left -= at.weight[k]) ++k;
    const std::optional<uint32_t> side = pool_->draw(at.vertex[k], choice.v);
    if (!side) return {};
    return scene_->point_on_patch(scene_->patch_of_side(*side), square_to_triangle(where));
}

Rgb Reconstruction::total_irradiance(const Lattice::Stencil& at) const {
    Rgb sum;
    for (int k = 0; k < 3; ++k) sum += (indirect_.value[at.vertex[k]] + direct_.value[at.vertex[k]]) * at.weight[k];
    return sum;
}

std::optional<Reconstructed> Reconstruction::specular(uint32_t eye, const Lattice::Stencil& at) const {
    Reconstructed r;
    float weight = 0;
    for (int k = 0; k < 3; ++k) {
        const uint32_t slot = neighbourhood_.slot(at.vertex[k]);
        if (slot == Scene::kNone) continue;
        const Reconstructed& own = specular_[eye][slot];
        weight += at.weight[k];
        r.value += own.value * at.weight[k], r.stderr_ += own.stderr_ * at.weight[k], r.trust += own.trust * at.weight[k];
    }
    if (!(weight > 0)) return {};
    return Reconstructed{r.value / weight, r.stderr_ / weight, r.trust * (1 / weight)};
}

}  // namespace lumel
