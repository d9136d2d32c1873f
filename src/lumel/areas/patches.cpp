#include "lumel/areas/patches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr uint32_t kLooks = 16;  // gathered at a time

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

void PatchAreas::measure(const Step& step) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, size(), 64), [&](const auto& range) {
        for (uint32_t area = range.begin(); area < range.end(); ++area) {
            measure_shot(step, area);
            for (uint32_t eye = 0; step.gather > 0 && eye < eyes(); ++eye) measure_gathered(step, area, eye);
        }
    });
}

void PatchAreas::measure_shot(const Step& step, uint32_t area) {
    const uint32_t side = sides_[area], triangle = scene_->triangle_of_side(side);
    const bool back = scene_->is_back(side);
    const float gather_density = static_cast<float>(step.gather) / scene_->side_area(side);
    for (uint32_t i : step.transfers.group(side)) {
        const Transfer& transfer = step.transfers.all[i];
        const Surface x(*scene_, {triangle, transfer.u, transfer.v}, back);
        const Frame frame(x.shading);
        const Vec3 wi = frame.to_local(transfer.wi);
        const float cos = dot(x.normal, transfer.wi);
        if (!(wi.z > 0 && cos > 0)) continue;
        for (uint32_t eye = 0; eye < eyes(); ++eye) {
            if (!(albedo_[at(eye, area)] > 0)) continue;
            const Vec3 wo = frame.to_local(normalize(eyes_[eye] - x.x));
            const Rgb scatter = x.material->scatter_s(wi, wo);
            Sums& sums = current_[at(eye, area)];
            if (!(transfer.inv_pdf > 0)) {
                sums.plain += to_double(scatter) * to_double(transfer.flux) * (step.weight / double{cos});
                ++sums.hits;
                continue;
            }
            // Divide by cos/inv_pdf = n_s p and n_g p_g together; with nothing gathered this is the plain quotient.
            const float gathered = gather_density > 0 ? gather_density * ggx::pdf_w(wo, wi, x.material->alpha) : 0.0f;
            const double share = 1.0 / (double{cos} + double{gathered} * double{transfer.inv_pdf});
            sums.add(to_double(scatter) * to_double(transfer.flux) * (step.weight * share),
                     static_cast<double>(step.transfers.rays) * double{transfer.inv_pdf} * double{lum(scatter)} * share);
        }
    }
}

void PatchAreas::measure_gathered(const Step& step, uint32_t area, uint32_t eye) {
    if (!(albedo_[at(eye, area)] > 0)) return;
    const uint32_t side = sides_[area], patch = scene_->patch_of_side(side);
    const float gather_density = static_cast<float>(step.gather) / scene_->side_area(side);
    const uint64_t stream = key(step.stream, side, eye);
    const auto count = static_cast<uint32_t>(step.gather + double{to_unit(static_cast<uint32_t>(stream >> 32))});
    Sums& sums = current_[at(eye, area)];
    for (uint32_t first = 0; first < count; first += kLooks) {
        // Draw points on the side and directions of the lobe around the eye's.
        std::array<Look, kLooks> looks;
        std::array<Seen, kLooks> seen;
        std::array<Rgb, kLooks> scatter;
        std::array<float, kLooks> pdf, cos;
        uint32_t n = 0;
        for (uint32_t i = first; i < std::min(count, first + kLooks); ++i) {
            const SurfacePoint p = scene_->point_on_patch(patch, square_to_triangle(sobol2d(i, key(stream, 1))));
            const Surface x(*scene_, p, scene_->is_back(side));
            const Frame frame(x.shading);
            const Vec3 wo = frame.to_local(normalize(eyes_[eye] - x.x));
            if (!(wo.z > 0)) continue;
            const Vec3 wi = ggx::sample(wo, x.material->alpha, sobol2d(i, key(stream, 2))), w = frame.to_world(wi);
            cos[n] = dot(x.normal, w);
            pdf[n] = ggx::pdf_w(wo, wi, x.material->alpha);
            if (!(pdf[n] > 0 && cos[n] > 0)) continue;
            scatter[n] = x.material->scatter_s(wi, wo);
            cos[n] *= 1 - x.material->mirror_choice();
            looks[n++] = {x.off(scene_->epsilon()), w};
        }
        step.sight.see(std::span(looks).first(n), std::span(seen).first(n));
        for (uint32_t i = 0; i < n; ++i) {
            const double q = double{seen[i].density} * double{cos[i]} + double{gather_density} * double{pdf[i]};
            sums.add(to_double(scatter[i]) * to_double(seen[i].radiance) * (step.weight / q),
                     static_cast<double>(step.transfers.rays) * double{lum(scatter[i])} / q);
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
        if (weight > 0 && rays > 0) m.single_fg += s.fg * (1 / (weight * rays)), m.single_gg += s.gg / (rays * rays);
        current_[i] = {};
    }
    ++replicas_;
}

Samples PatchAreas::unscaled(uint32_t eye, uint32_t area) const {
    const Moments& m = closed_[at(eye, area)];
    const double r = replicas_;
    Samples s{.f = m.f * (1 / r), .g = m.g / r, .plain = m.plain * (1 / r), .fg = m.single_fg * (1 / (r * r)), .gg = m.single_gg / (r * r), .hits = m.hits};
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
    Samples s = u;
    s.f = u.f * f, s.g = u.g * g, s.plain = u.plain * f;
    s.var_f = u.var_f * (f * f), s.cov_fg = u.cov_fg * (f * g), s.var_plain = u.var_plain * (f * f), s.var_g = u.var_g * (g * g);
    s.fg = u.fg * (f * g), s.gg = u.gg * (g * g);
    return s;
}

}  // namespace lumel
