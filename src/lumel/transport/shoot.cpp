#include "lumel/transport/shoot.h"

#include <tbb/parallel_for.h>

#include <optional>

#include "lumel/sampling/hash.h"
#include "lumel/transport/launch.h"

namespace lumel {

namespace {

constexpr uint32_t kBlock = Flights::kMost;  // rays a work item
constexpr uint64_t kMirror = 3;              // stream of the choices at mirrors

/// One ray under way with what it carries (see Flights).
struct Flight {
    Ray ray;
    Rgb flux, behind_mirror;
    float inv_pdf = 0;
};

/// What left the scene.
struct Lost {
    uint64_t rays = 0;
    double flux = 0;  ///< lum, W

    void add(Rgb f) { ++rays, flux += double{lum(f)}; }
};

/// The end of a flight on `side`; nothing where it neither carries light nor counts for a density.
Transfer arrive(const Scene& scene, const Hit& hit, const Flight& flight) {
    if (flight.inv_pdf == 0 && max_component(flight.flux) == 0) return {};
    return {scene.side_of(hit.point(), hit.back), hit.u, hit.v, -flight.ray.direction, flight.flux, flight.inv_pdf};
}

/// Follow a flight that met `hit` over perfect mirrors to the side where it is measured. Choosing between a surface's mirror and the rest
/// of it, and roulette, multiply the density.
Transfer follow(const Shot& shot, Flight flight, Hit hit, uint32_t ray, Lost& lost) {
    const Scene& scene = shot.scene;
    std::optional<Rng> rng;
    for (int mirrors = 0; mirrors < kMostMirrors; ++mirrors) {
        if (hit.is_miss()) {
            lost.add(flight.flux);
            return {};
        }
        const Material& material = scene.material(hit.triangle);
        if (!material.is_mirror() || (hit.back && !material.two_sided)) return arrive(scene, hit, flight);

        // Decide between the mirror and the rest. Light over a partial mirror has a second way into the same transfer, from the
        // surface's own lobes, whose density is not known here: it goes outside the ratios.
        if (!rng) rng.emplace(key(shot.stream, ray, kMirror));
        const Surface m(scene, hit.point(), hit.back);
        const float choice = material.mirror_choice();
        if (choice < 1) {
            const bool mirrored = rng->uniform() < choice;
            const float scale = 1 / (mirrored ? choice : 1 - choice);
            flight.flux *= scale, flight.behind_mirror *= scale, flight.inv_pdf *= mirrored ? 0 : scale;
            if (!mirrored) return arrive(scene, hit, flight);
        }
        const Vec3 wi = -flight.ray.direction;
        const float cos = dot(m.shading, wi);
        const Vec3 out = reflect(wi, m.shading);
        if (!(cos > 0) || !(dot(out, m.normal) > 0)) return {};
        const Rgb tint = material.mirror_reflectance(cos);
        const float survive = std::min(1.0f, max_component(tint));
        if (!(rng->uniform() < survive)) return {};
        flight.flux = (flight.flux + flight.behind_mirror) * tint * (1 / survive);
        flight.behind_mirror = {};
        flight.inv_pdf /= survive;
        flight.ray = {m.off(scene.epsilon()), out};
        hit = shot.accel.intersect(flight.ray);
    }
    return {};
}

/// Write the ends of a block of flights to `ends`, one for each.
Lost land(const Shot& shot, const Flights& flights, const HitBlock& hits, uint32_t first, Transfer* ends) {
    Lost lost;
    const bool mirrors = shot.scene.has_mirrors();
    for (uint32_t i = 0; i < flights.rays.size; ++i) {
        const Flight flight{flights.rays[i], flights.flux[i], flights.behind_mirror[i], flights.inv_pdf[i]};
        if (!flights.rays.traced[i])
            ends[i] = {};
        else if (mirrors || hits[i].is_miss())
            ends[i] = follow(shot, flight, hits[i], first + i, lost);
        else
            ends[i] = arrive(shot.scene, hits[i], flight);
    }
    return lost;
}

}  // namespace

void shoot(const Shot& shot, Transfers& transfers) {
    const uint32_t rays = shot.rays(), blocks = (rays + kBlock - 1) / kBlock;
    transfers.all.resize(rays);
    transfers.rays = shot.from_power + shot.from_defensive;
    std::vector<Lost> lost(blocks);

    // Every block of rays is a work item of its own: launch, trace, land.
    tbb::parallel_for(uint32_t{0}, blocks, [&](uint32_t block) {
        const FlushDenormals flush;
        const uint32_t first = block * kBlock;
        Flights flights;
        HitBlock hits;
        Launcher{shot}(first, std::min(kBlock, rays - first), flights);
        shot.accel.intersect(flights.rays, hits);
        lost[block] = land(shot, flights, hits, first, transfers.all.data() + first);
    });
    transfers.escaped = 0, transfers.lost_flux = 0;
    for (const Lost& part : lost) transfers.escaped += part.rays, transfers.lost_flux += part.flux;
    transfers.group_by_side(shot.scene.sides());
}

std::vector<RayBlock> departures(const Shot& shot) {
    std::vector<RayBlock> blocks;
    Flights flights;
    for (uint32_t first = 0; first < shot.rays(); first += kBlock) {
        Launcher{shot}(first, std::min(kBlock, shot.rays() - first), flights);
        blocks.push_back(flights.rays);
    }
    return blocks;
}

}  // namespace lumel
