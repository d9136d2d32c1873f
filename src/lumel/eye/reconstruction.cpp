#include "lumel/eye/reconstruction.h"

namespace lumel {

namespace {

constexpr int kRings = 8;  // a vertex without a sample looks this many patches far for one

Rgb square_root(Rgb v) { return {std::sqrt(v.x), std::sqrt(v.y), std::sqrt(v.z)}; }

/// Samples of several patches before division by area, with what to divide them by.
struct Pool {
    Samples sums;
    double area = 0, albedo_area = 0;

    void add(const Samples& s, double a, double aa) {
        sums.f += s.f, sums.plain += s.plain, sums.g += s.g, sums.hits += s.hits;
        sums.var_f += s.var_f, sums.cov_fg += s.cov_fg, sums.var_plain += s.var_plain, sums.var_g += s.var_g;
        area += a, albedo_area += aa;
    }
    void add(const Pool& other) { add(other.sums, other.area, other.albedo_area); }
};

}  // namespace

Reconstruction::Reconstruction(const Scene& scene, const Lattice& lattice, const Solution& solution, const Estimator& estimator)
    : scene_(&scene), lattice_(&lattice), specular_slot_(size_t{lattice.size()} * 2, Scene::kNone), specular_(solution.areas.eyes()) {
    gather_irradiance(solution.indirect, solution.direct);
    for (uint32_t side : solution.areas.sides())
        for (uint32_t vertex : lattice.corners(scene.patch_of_side(side))) {
            uint32_t& slot = specular_slot_[vertex_side(vertex, scene.is_back(side))];
            if (slot == Scene::kNone) slot = slots_++;
        }
    for (uint32_t eye = 0; eye < solution.areas.eyes(); ++eye) gather_specular(solution.areas, estimator, eye);
}

void Reconstruction::gather_irradiance(const SideField& indirect, const SideField& direct) {
    const size_t n = size_t{lattice_->size()} * 2;
    std::vector<double> area(n);
    std::vector<Rgb64> value(n), variance(n), lamps(n);
    for (uint32_t side = 0; side < scene_->sides(); ++side) {
        const double a = scene_->side_area(side);
        for (uint32_t vertex : lattice_->corners(scene_->patch_of_side(side))) {
            const uint32_t at = vertex_side(vertex, scene_->is_back(side));
            area[at] += a;
            value[at] += to_double(indirect.mean[side]) * a;
            variance[at] += to_double(indirect.variance[side]) * (a * a);
            lamps[at] += to_double(direct.mean[side]) * a;
        }
    }
    irradiance_.resize(n), irradiance_stderr_.resize(n), direct_.resize(n);
    for (size_t at = 0; at < n; ++at) {
        if (!(area[at] > 0)) continue;
        irradiance_[at] = (value[at] * (1 / area[at])).to_float();
        irradiance_stderr_[at] = square_root((variance[at] * (1 / (area[at] * area[at]))).to_float());
        direct_[at] = (lamps[at] * (1 / area[at])).to_float();
    }
}

void Reconstruction::gather_specular(const PatchAreas& areas, const Estimator& estimator, uint32_t eye) {
    std::vector<Pool> pools(slots_);
    const auto slots_of = [&](uint32_t area) {
        const uint32_t side = areas.sides()[area];
        auto slots = lattice_->corners(scene_->patch_of_side(side));
        for (uint32_t& slot : slots) slot = specular_slot_[vertex_side(slot, scene_->is_back(side))];
        return slots;
    };
    for (uint32_t area = 0; area < areas.size(); ++area) {
        const double albedo = areas.albedo(eye, area), size = scene_->side_area(areas.sides()[area]);
        if (!(albedo > 0)) continue;
        for (uint32_t slot : slots_of(area)) pools[slot].add(areas.unscaled(eye, area), size, size * albedo);
    }

    // Vertices without a sample take the pools of the patches around them, ring by ring.
    for (int ring = 0; ring < kRings; ++ring) {
        std::vector<std::pair<uint32_t, Pool>> found;
        for (uint32_t area = 0; area < areas.size(); ++area) {
            const auto slots = slots_of(area);
            for (uint32_t empty : slots) {
                if (pools[empty].sums.hits > 0) continue;
                for (uint32_t other : slots)
                    if (pools[other].sums.hits > 0) found.emplace_back(empty, pools[other]);
            }
        }
        if (found.empty()) break;
        for (const auto& [empty, pool] : found) {
            if (pools[empty].sums.hits == 0) pools[empty] = {}, ++borrowed_;
            pools[empty].add(pool);
        }
    }
    specular_[eye].resize(slots_);
    for (uint32_t slot = 0; slot < slots_; ++slot) {
        const Pool& pool = pools[slot];
        if (pool.sums.hits == 0) ++unfilled_;
        const Estimate e = estimator.estimate(scaled(pool.sums, pool.area, pool.albedo_area));
        specular_[eye][slot] = {e.value.to_float(), square_root(e.variance.to_float())};
    }
}

Reconstructed Reconstruction::irradiance(SurfacePoint p, bool back) const {
    const Lattice::Stencil s = lattice_->stencil(p);
    Reconstructed r;
    for (int k = 0; k < 3; ++k) {
        const uint32_t at = vertex_side(s.vertex[k], back);
        r.value += irradiance_[at] * s.weight[k];
        r.stderr_ += irradiance_stderr_[at] * s.weight[k];
    }
    return r;
}

Rgb Reconstruction::total_irradiance(SurfacePoint p, bool back) const {
    const Lattice::Stencil s = lattice_->stencil(p);
    Rgb sum;
    for (int k = 0; k < 3; ++k) {
        const uint32_t at = vertex_side(s.vertex[k], back);
        sum += (irradiance_[at] + direct_[at]) * s.weight[k];
    }
    return sum;
}

Reconstructed Reconstruction::specular(uint32_t eye, SurfacePoint p, bool back) const {
    const Lattice::Stencil s = lattice_->stencil(p);
    Reconstructed r;
    float weight = 0;
    for (int k = 0; k < 3; ++k) {
        const uint32_t slot = specular_slot_[vertex_side(s.vertex[k], back)];
        if (slot == Scene::kNone) continue;
        weight += s.weight[k];
        r.value += specular_[eye][slot].value * s.weight[k];
        r.stderr_ += specular_[eye][slot].stderr_ * s.weight[k];
    }
    return weight > 0 ? Reconstructed{r.value / weight, r.stderr_ / weight} : Reconstructed{};
}

}  // namespace lumel
