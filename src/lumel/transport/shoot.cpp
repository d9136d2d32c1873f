#include "lumel/transport/shoot.h"

#include <tbb/parallel_for.h>

#include <optional>

#include "lumel/sampling/hash.h"
#include "lumel/transport/launch.h"

namespace lumel {

namespace {

constexpr uint32_t kBlock = Flights::kMost;  // rays a work item
static_assert(kBlock == TransferBlock::kMost);
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

/// Follow a flight that met `hit` over perfect mirrors to what it meets behind them. Choosing between a surface's mirror and the rest of
/// it, and roulette, multiply the density. Gives whether the flight goes on to `hit`.
bool pass_mirrors(const Shot& shot, uint32_t ray, Flight& flight, Hit& hit) {
    const Scene& scene = shot.scene;
    std::optional<Rng> rng;
    for (int mirrors = 0; mirrors < kMostMirrors; ++mirrors) {
        if (hit.is_miss()) return true;
        const Material& material = scene.material(hit.triangle);
        if (!material.is_mirror() || (hit.back && !material.two_sided)) return true;

        // Decide between the mirror and the rest. Light over a partial mirror has a second way into the same transfer, from the
        // surface's own lobes, whose density is not known here: it goes outside the ratios.
        if (!rng) rng.emplace(key(shot.stream, ray, kMirror));
        const Surface m(scene, hit.point(), hit.back);
        const float choice = material.mirror_choice();
        if (choice < 1) {
            const bool mirrored = rng->uniform() < choice;
            const float scale = 1 / (mirrored ? choice : 1 - choice);
            flight.flux *= scale, flight.behind_mirror *= scale, flight.inv_pdf *= mirrored ? 0 : scale;
            if (!mirrored) return true;
        }
        const Vec3 wi = -flight.ray.direction;
        const float cos = dot(m.shading, wi);
        const Vec3 out = reflect(wi, m.shading);
        if (!(cos > 0) || !(dot(out, m.normal) > 0)) return false;
        const Rgb tint = material.mirror_reflectance(cos);
        const float survive = std::min(1.0f, max_component(tint));
        if (!(rng->uniform() < survive)) return false;
        flight.flux = (flight.flux + flight.behind_mirror) * tint * (1 / survive);
        flight.behind_mirror = {};
        flight.inv_pdf /= survive;
        flight.ray = {m.off(scene.epsilon()), out};
        hit = shot.accel.intersect(flight.ray);
    }
    return false;
}

/// The same for all flights of a block; `first` is the index of its first ray.
void pass_mirrors(const Shot& shot, uint32_t first, Flights& flights, HitBlock& hits) {
    for (uint32_t i = 0; i < flights.rays.size; ++i) {
        if (!flights.rays.traced[i]) continue;
        Flight flight{flights.rays[i], flights.flux[i], flights.behind_mirror[i], flights.inv_pdf[i]};
        Hit hit = hits[i];
        if (!pass_mirrors(shot, first + i, flight, hit)) flights.rays.traced[i] = 0;
        flights.rays.direction.set(i, flight.ray.direction);
        flights.flux.set(i, flight.flux), flights.inv_pdf[i] = flight.inv_pdf;
        hits.set(i, hit);
    }
}

/// Write the ends of a block of flights. Gives what left the scene.
Lost land(const Scene& scene, const Flights& flights, const HitBlock& hits, TransferBlock& transfers) {
    // Find the side of every hit. Nothing arrives where light is neither carried nor counts for a density.
    const uint32_t count = flights.rays.size;
    std::array<uint32_t, kBlock> triangle, side;
    std::array<int32_t, kBlock> hit, arrives;
    for (uint32_t i = 0; i < count; ++i) {
        hit[i] = hits.triangle[i] != Hit::kMiss;
        triangle[i] = hit[i] ? hits.triangle[i] : 0;
        arrives[i] = std::max(flights.inv_pdf[i], max_component(flights.flux[i])) > 0 ? flights.rays.traced[i] & hit[i] : 0;
    }
    scene.tessellation().patches_of(triangle.data(), hits.u.data(), hits.v.data(), count, side.data());
    for (uint32_t i = 0; i < count; ++i) side[i] += hits.back[i] ? scene.patches() : 0;

    // What starts under a box and comes to a patch that is open in part has met that part of it that is under the box as well.
    for (uint32_t i = 0; scene.has_covers() && i < count; ++i)
        if (flights.covered[i] && scene.is_open_in_part(side[i])) arrives[i] = 0;

    // Write all that arrives to where the next one of its kind goes: that takes less time than to decide whether to write.
    uint32_t plain = 0, placed = 0;
    std::array<uint32_t, kBlock + 1> ray_of_placed;
    for (uint32_t i = 0; i < count; ++i) {
        // Where light came to counts on divided sides, however plain.
        const bool is_plain = scene.is_plain(triangle[i]) && !scene.is_divided(side[i]);
        transfers.plain_side[plain] = side[i];
        transfers.plain[plain] = {flights.flux[i], flights.inv_pdf[i]};
        ray_of_placed[placed] = i;
        plain += is_plain & (arrives[i] != 0);
        placed += !is_plain & (arrives[i] != 0);
    }
    for (uint32_t k = 0; k < placed; ++k) {
        const uint32_t i = ray_of_placed[k];
        transfers.placed_side[k] = side[i];
        transfers.placed[k] = {{flights.flux[i], flights.inv_pdf[i]}, hits.u[i], hits.v[i], -flights.rays.direction[i]};
    }
    transfers.plain_size = plain, transfers.placed_size = placed;

    Lost lost;
    for (uint32_t i = 0; i < count; ++i)
        if (flights.rays.traced[i] && !hit[i]) lost.add(flights.flux[i]);
    return lost;
}

}  // namespace

void shoot(const Shot& shot, Transfers& transfers) {
    const uint32_t rays = shot.rays(), blocks = (rays + kBlock - 1) / kBlock;
    transfers.open(blocks);
    transfers.shot = rays;
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
        if (shot.scene.has_mirrors()) pass_mirrors(shot, first, flights, hits);
        lost[block] = land(shot.scene, flights, hits, transfers.block(block));
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
