// Runs of the transports, for tests: independent replicas and what is measured of them.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"
#include "lumel/solver/session.h"
#include "scenes.h"
#include "stats.h"

namespace lumel::test {

/// Every transport. A new one joins all tests when it is entered here.
inline constexpr std::array kTransports{Transport::kWalk, Transport::kRays, Transport::kBundles};
/// Those of single rays, which have a defensive part.
inline constexpr std::array kRayTransports{Transport::kWalk, Transport::kRays};
inline std::string name_of(Transport transport) {
    return transport == Transport::kWalk ? "walk" : transport == Transport::kRays ? "rays" : "bundles";
}

struct RunConfig {
    SolverConfig solver;
    uint32_t replicas = 8;
    uint64_t rays = 100000;  ///< of a replica's steps together
    uint64_t solve_rays = 50000;
    uint32_t steps = 1;
};

/// Work of a step that takes about as long as `rays` rays: so many rays, or bundles.
inline uint64_t work_of(Transport transport, uint64_t rays) {
    constexpr uint64_t kRaysPerBundle = 200;
    return transport == Transport::kBundles ? rays / kRaysPerBundle : rays;
}

inline void run_replica(Solver& solver, const RunConfig& config) {
    solver.begin_replica(config.solve_rays);
    for (uint32_t i = 0; i < config.steps; ++i) solver.step(work_of(config.solver.transport, config.rays / config.steps));
    solver.end_replica();
}

/// One replica as the solver makes it, its generations in our hands: a walk or a step of `rays`, or bundles for about as long.
inline void run_replica(const Stage& stage, Transport transport, const Illumination& light, const WalkConfig& config, const Sink& sink) {
    const uint64_t solve = key(config.stream, 1);
    uint64_t rays = 0;
    switch (transport) {
    case Transport::kWalk:
        walk(stage.accel, stage.defensive, light.emitters(), config, sink);
        break;
    case Transport::kRays: {
        FrozenLight frozen(stage.accel, stage.defensive, light, {config.rays / 2, 0, solve}, rays);
        frozen.step(stage.accel, stage.defensive, light, {config.rays, config.defensive, config.stream}, sink);
        break;
    }
    case Transport::kBundles:
        FrozenBundles(stage.accel, stage.defensive, light, {.solve_rays = config.rays / 2, .stream = solve})
            .step(static_cast<uint32_t>(work_of(transport, config.rays)), sink);
        break;
    }
}

/// A solver after `config.replicas` replicas.
inline Solver solved(const Stage& stage, const RunConfig& config, PatchAreas areas) {
    Solver solver(stage.accel, stage.defensive, config.solver, std::move(areas));
    for (uint32_t i = 0; i < config.replicas; ++i) run_replica(solver, config);
    return solver;
}
inline PatchAreas no_areas(const Scene& scene) { return PatchAreas(scene, {}, {}); }

/// What surfaces without gloss absorb, over what the lamps send, after four replicas.
inline double absorbed_share(Session& session) {
    for (int replica = 0; replica < 4; ++replica) run_replica(session.solver(), {.rays = 100000, .solve_rays = 100000});
    const SideField direct = session.solver().direct(), indirect = session.indirect();
    const Scene& scene = session.scene();
    double absorbed = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        const double keeps = 1 - double{lum(scene.material(scene.triangle_of_side(side)).diffuse)};
        if (scene.open_share(side) > 0)
            absorbed += keeps * double{lum(direct.mean[side] + indirect.mean[side])} * double{scene.side_area(side)};
    }
    return absorbed / lamp_power(scene);
}

/// Direct and shot irradiance of every side together, W/m2.
inline std::vector<Rgb> total_irradiance(const Solver& solver, const Scene& scene) {
    std::vector<Rgb> sum = solver.indirect().mean;
    const SideField direct = solver.direct();
    for (uint32_t side = 0; side < scene.sides(); ++side) sum[side] += direct.mean[side];
    return sum;
}

/// Which sides count for a mean.
using SideFilter = std::function<bool(const Scene&, uint32_t side)>;
inline SideFilter fronts() {
    return [](const Scene& scene, uint32_t side) { return !scene.is_back(side); };
}
/// The sides that light can reach, as the survey of the scene found out.
inline SideFilter reachable(const Stage& stage) {
    return [&stage](const Scene&, uint32_t side) { return stage.defensive.by_area.weight(side) > 0; };
}
inline SideFilter fronts_of_shape(uint32_t shape) {
    return
        [shape](const Scene& scene, uint32_t side) { return !scene.is_back(side) && scene.shape(scene.triangle_of_side(side)) == shape; };
}

/// Luminous mean over the area of the chosen sides.
inline double mean_over(const Scene& scene, const std::vector<Rgb>& field, const SideFilter& chosen) {
    double sum = 0, area = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side)
        if (chosen(scene, side)) sum += double{lum(field[side])} * double{scene.side_area(side)}, area += double{scene.side_area(side)};
    return sum / area;
}

/// Mean irradiance of the sides that each filter chooses, with its error: every replica has a solver and a seed of its own.
inline std::vector<Mean> mean_irradiance(const Stage& stage, const RunConfig& config, const std::vector<SideFilter>& filters) {
    std::vector<std::vector<double>> values(filters.size());
    for (uint32_t i = 0; i < config.replicas; ++i) {
        RunConfig one = config;
        one.replicas = 1, one.solver.seed = key(config.solver.seed, i);
        const auto field = total_irradiance(solved(stage, one, no_areas(stage.scene)), stage.scene);
        for (size_t k = 0; k < filters.size(); ++k) values[k].push_back(mean_over(stage.scene, field, filters[k]));
    }
    std::vector<Mean> means;
    for (const auto& v : values) means.push_back(mean_of(v));
    return means;
}

/// The glossy sides that face at least one of the eyes.
inline std::vector<uint32_t>
glossy_sides_towards(const Scene& scene, Vec3 eye, const SideFilter& chosen = [](const Scene&, uint32_t) { return true; }) {
    std::vector<uint32_t> sides;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        if (scene.glossy_index(side) == Scene::kNone || !chosen(scene, side)) continue;
        const Vec3 n = scene.geometric_normal(scene.triangle_of_side(side)) * (scene.is_back(side) ? -1.0f : 1.0f);
        if (dot(eye - scene.position(scene.centre_of_patch(scene.patch_of_side(side))), n) > 0) sides.push_back(side);
    }
    return sides;
}

}  // namespace lumel::test
