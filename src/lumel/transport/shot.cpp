#include "lumel/transport/shot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/transport/side_source.h"

namespace lumel {

Shot::Shot(const Accel& a, const Emitters& e, const DefensiveStarts& d, const ShootConfig& config)
    : accel(a), emitters(e), defensive(d), scene(a.scene()), stream(config.stream), beside_bundles(config.beside_bundles) {
    std::vector<double> power_of(scene.sides());
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 4096), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) power_of[side] = emitters.power(scene, side);
    });
    by_power = Distribution(scene.sides(), [&](uint32_t side) { return power_of[side]; });
    if (emitters.point_lamps)
        for (const PointLamp& lamp : scene.point_lamps()) point_power += 4 * kPi * lum(lamp.intensity);
    const double power = by_power.total() + point_power;
    if (!(power > 0)) return;

    // The defensive part takes its share of the rays from surfaces.
    const auto rays = static_cast<uint32_t>(std::min<uint64_t>(config.rays, 1u << 30));
    from_points = static_cast<uint32_t>(std::llround(rays * (point_power / power)));
    const double surface = rays - from_points;
    const double share = by_power.total() > 0 ? static_cast<double>(config.defensive) : 1.0;
    if (defensive.area() > 0) from_defensive = static_cast<uint32_t>(std::llround(surface * share));
    if (by_power.total() > 0) {
        from_power = rays - from_points - from_defensive;
        rays_per_watt = from_power / by_power.total();
    }
    if (defensive.area() > 0) defensive_density_ = static_cast<float>(from_defensive / (kPi * defensive.area()));
}

void Shot::see(std::span<const Look> looks, std::span<Seen> seen) const {
    RayBlock rays;
    HitBlock hits;
    for (size_t first = 0; first < looks.size(); first += RayBlock::kMost) {
        rays.size = static_cast<uint32_t>(std::min<size_t>(looks.size() - first, RayBlock::kMost));
        for (uint32_t i = 0; i < rays.size; ++i) {
            const Look& look = looks[first + i];
            rays.origin.set(i, look.origin), rays.direction.set(i, look.direction), rays.traced[i] = -1;
        }
        accel.intersect(rays, hits);
        for (uint32_t i = 0; i < rays.size; ++i) seen[first + i] = see(rays[i], hits[i]);
    }
}

Seen Shot::see(Ray ray, Hit hit) const {
    Rgb tint{1, 1, 1};
    float survive = 1;
    for (int mirrors = 0; mirrors < kMostMirrors; ++mirrors) {
        if (mirrors > 0) hit = accel.intersect(ray);
        if (hit.is_miss()) return {{}, defensive.open() ? defensive_density_ * survive : 0.0f};
        const Surface y(scene, hit.point(), hit.back);
        const Vec3 w = -ray.direction;

        // A perfect mirror sends the look on; étendue is conserved, and roulette on its tint multiplies the density.
        if (y.scatters && y.material->is_perfect_mirror()) {
            const float cos = dot(y.shading, w);
            const Vec3 out = reflect(w, y.shading);
            if (!(cos > 0) || !(dot(out, y.normal) > 0)) return {};
            const Rgb reflectance = y.material->mirror_reflectance(cos);
            tint *= reflectance;
            survive *= std::min(1.0f, max_component(reflectance));
            ray = {y.off(scene.epsilon()), out};
            continue;
        }
        const uint32_t side = scene.side_of(hit.point(), hit.back);
        const float cos = dot(y.normal, w);
        if (!(cos > 1e-6f)) return {};
        const SideSource source(scene, emitters, side, rays_per_watt, emitters.part_of(scene, side, {hit.u, hit.v}));
        const SideSource::Emission e = source.evaluate(y.shading, w);
        const Rgb radiance = mirrors > 0 ? e.radiance + e.behind_mirror : e.radiance;
        const float density = (e.pdf_aw / cos + defensive_density(side)) * survive;
        // Light goes both ways, so what sees a side that none can reach is out of its reach, too.
        const bool sends = density > 0 || max_component(radiance) > 0;
        return {radiance * tint, density, !sends && !defensive.reaches(scene, hit.triangle, hit.back)};
    }
    return {};
}

}  // namespace lumel
