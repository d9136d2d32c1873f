#include "lumel/areas/patches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/scene/surface.h"

namespace lumel {

namespace {

/// Mean lum(a_s) of a side towards an eye, by the edge midpoints rule.
double mean_albedo(const Scene& scene, uint32_t side, Vec3 eye) {
    constexpr Square kMidpoints[] = {{0.5f, 0.0f}, {0.5f, 0.5f}, {0.0f, 0.5f}};
    double sum = 0;
    for (const Square s : kMidpoints) {
        const Surface x(scene, scene.point_on_patch(scene.patch_of_side(side), s), scene.is_back(side));
        const Vec3 wo = normalize(eye - x.x);
        if (dot(x.normal, wo) > 0) sum += lum(x.material->albedo_s(dot(x.shading, wo)));
    }
    return sum / 3;
}

}  // namespace

PatchAreas::PatchAreas(const Scene& scene, std::vector<Vec3> eyes, std::vector<uint32_t> measured)
    : scene_(&scene), eyes_(std::move(eyes)), sides_(std::move(measured)) {
    albedo_.resize(sides_.size() * eyes_.size());
    current_.resize(albedo_.size());
    closed_.resize(albedo_.size());
    for (uint32_t area = 0; area < size(); ++area)
        for (uint32_t eye = 0; eye < eyes_.size(); ++eye) albedo_[at(eye, area)] = mean_albedo(scene, sides_[area], eyes_[eye]);
}

uint32_t PatchAreas::find(uint32_t side) const {
    const auto it = std::lower_bound(sides_.begin(), sides_.end(), side);
    return it != sides_.end() && *it == side ? static_cast<uint32_t>(it - sides_.begin()) : Scene::kNone;
}

void PatchAreas::measure(const Transfers& transfers, double weight) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, size(), 64), [&](const auto& range) {
        for (uint32_t area = range.begin(); area < range.end(); ++area) measure_area(transfers, area, weight);
    });
}

void PatchAreas::measure_area(const Transfers& transfers, uint32_t area, double weight) {
    const uint32_t side = sides_[area], triangle = scene_->triangle_of_side(side);
    const bool back = scene_->is_back(side);
    for (uint32_t i : transfers.group(side)) {
        const Transfer& transfer = transfers.all[i];
        const Surface x(*scene_, {triangle, transfer.u, transfer.v}, back);
        const Frame frame(x.shading);
        const Vec3 wi = frame.to_local(transfer.wi);
        const float cos = dot(x.normal, transfer.wi);
        if (!(wi.z > 0 && cos > 0)) continue;
        for (uint32_t eye = 0; eye < eyes_.size(); ++eye) {
            const Vec3 wo = frame.to_local(normalize(eyes_[eye] - x.x));
            if (!(albedo_[at(eye, area)] > 0)) continue;
            const Rgb scatter = x.material->scatter_s(wi, wo) * (1 / cos);
            Sums& sums = current_[at(eye, area)];
            // f/p and g/p but for 1/A and 1/(a_bar A); the densities of a step are per ray, so its rays undo that.
            (transfer.inv_pdf > 0 ? sums.f : sums.plain) += to_double(scatter) * to_double(transfer.flux) * weight;
            sums.g += static_cast<double>(transfers.rays) * double{transfer.inv_pdf} * double{lum(scatter)};
            sums.hits += 1;
        }
    }
}

void PatchAreas::close_replica(double weight, double rays) {
    for (size_t i = 0; i < current_.size(); ++i) {
        const Sums& s = current_[i];
        const Rgb64 f = weight > 0 ? s.f * (1 / weight) : Rgb64{}, plain = weight > 0 ? s.plain * (1 / weight) : Rgb64{};
        const double g = rays > 0 ? s.g / rays : 0;
        Moments& m = closed_[i];
        m.f += f, m.plain += plain, m.ff += f * f, m.fg += f * g, m.plain2 += plain * plain;
        m.g += g, m.gg += g * g, m.hits += s.hits;
        current_[i] = {};
    }
    ++replicas_;
}

Samples PatchAreas::unscaled(uint32_t eye, uint32_t area) const {
    const Moments& m = closed_[at(eye, area)];
    const double r = replicas_;
    Samples s{.f = m.f * (1 / r), .g = m.g / r, .plain = m.plain * (1 / r), .var_f = {}, .cov_fg = {}, .var_plain = {}, .var_g = 0, .hits = m.hits};
    if (replicas_ < 2) return s;
    const double scale = 1 / (r * (r - 1));
    s.var_f = (m.ff - m.f * m.f * (1 / r)) * scale;
    s.cov_fg = (m.fg - m.f * (m.g / r)) * scale;
    s.var_plain = (m.plain2 - m.plain * m.plain * (1 / r)) * scale;
    s.var_g = (m.gg - m.g * m.g / r) * scale;
    return s;
}

Samples PatchAreas::samples(uint32_t eye, uint32_t area) const {
    const double size = scene_->side_area(sides_[area]);
    return scaled(unscaled(eye, area), size, size * albedo_[at(eye, area)]);
}

Samples scaled(const Samples& u, double area, double albedo_area) {
    const double f = area > 0 ? 1 / area : 0, g = albedo_area > 0 ? 1 / albedo_area : 0;
    return {u.f * f, u.g * g, u.plain * f, u.var_f * (f * f), u.cov_fg * (f * g), u.var_plain * (f * f), u.var_g * (g * g), u.hits};
}

}  // namespace lumel
