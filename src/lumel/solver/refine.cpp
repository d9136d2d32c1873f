#include "lumel/solver/refine.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "lumel/sampling/hash.h"
#include "lumel/scene/deal_out.h"
#include "lumel/solver/pilot.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kSurvey = 71, kPilot };

constexpr uint64_t kFewest = 256;         // patches to deal out
constexpr double kSmall = 0.25;           // of the mean cell: smaller ones are not looked at
constexpr uint32_t kMostRays = 8;         // of a look, and at most so many in all looks, gloss and shadows apart
constexpr uint64_t kAllRays = 600'000;
constexpr uint32_t kViewRays = 128;       // along each edge of a picture, to find out what a camera sees
constexpr double kLargest = 0.05;         // relative error beyond which it does not matter more: steps would take all patches
constexpr double kUnseen = 0.1;           // weight of what a cell has of the area, against what it has of the pixels
constexpr double kSent = 0.003;           // weight of what is sent, against what is seen
constexpr double kEven = 0.02;            // of the error, spread by area: what the pilot may have missed
constexpr double kEvenPatches = 2.0 / 3;  // share of the patches that are cells: the rest divides some of these
constexpr int kRounds = 2;                // of smoothing

/// Who sees a side: the share that it has of all pictures, and the camera in which that is most.
struct View {
    double share = 0, most = 0;
    const Camera* camera = nullptr;
};

std::vector<View> views(const Accel& accel, std::span<const Camera> cameras) {
    const Scene& scene = accel.scene();
    std::vector<View> views(scene.sides());
    for (const Camera& camera : cameras) {
        std::vector<std::atomic<uint32_t>> seen(scene.sides());
        tbb::parallel_for(uint32_t{0}, kViewRays, [&](uint32_t y) {
            const FlushDenormals flush;
            for (uint32_t x = 0; x < kViewRays; ++x) {
                const Square film{(static_cast<float>(x) + 0.5f) / kViewRays, (static_cast<float>(y) + 0.5f) / kViewRays};
                const Hit hit = accel.intersect({camera.origin, camera.direction(film)});
                if (!hit.is_miss()) seen[scene.side_of(hit.point(), hit.back)].fetch_add(1, std::memory_order_relaxed);
            }
        });
        for (uint32_t side = 0; side < scene.sides(); ++side) {
            const double share = static_cast<double>(seen[side]) / (kViewRays * kViewRays);
            views[side].share += share / static_cast<double>(cameras.size());
            if (share > views[side].most) views[side].most = share, views[side].camera = &camera;
        }
    }
    return views;
}

/// The sides that are looked at: neither dark nor small.
std::vector<uint32_t> large_sides(const Scene& scene, const DefensiveStarts& reachable) {
    const double least = kSmall * scene.total_area() / scene.patches();
    std::vector<uint32_t> sides;
    for (uint32_t side = 0; side < scene.sides(); ++side)
        if (scene.scatters(side) && double{scene.side_area(side)} >= least && reachable.by_area.weight(side) > 0) sides.push_back(side);
    return sides;
}

/// What the pilot finds of these sides; nothing of others.
std::vector<Finding> look_at(std::span<const uint32_t> sides, const Pilot& pilot, const Scene& scene, const CellEdges& edges,
                             std::span<const View> views) {
    const auto rays = static_cast<uint32_t>(std::clamp<uint64_t>(kAllRays / (12 * sides.size() + 1), 1, kMostRays));
    std::vector<Finding> found(scene.sides());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, sides.size(), 64), [&](const auto& range) {
        const FlushDenormals flush;
        for (size_t i = range.begin(); i < range.end(); ++i) {
            const uint32_t side = sides[i];
            const Vec3* eye = views[side].camera ? &views[side].camera->origin : nullptr;
            found[side] = pilot.look(side, eye, edges.border(scene.patch_of_side(side)), rays);
        }
    });
    return found;
}

/// Squared errors of all cells: those that are seen, relative to the light there, and those of what is sent, to the mean light.
std::vector<double> errors(const Scene& scene, std::span<const Finding> findings, std::span<const View> views) {
    double seen = 0, seen_light = 0, light = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        seen += views[side].share, seen_light += views[side].share * findings[side].light;
        light += findings[side].light * double{scene.side_area(side)} / scene.total_area();
    }
    const double mean = seen > 0 ? seen_light / seen : light;
    std::vector<double> error(scene.patches());
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        const Finding& found = findings[side];
        if (!(found.light > 0)) continue;
        const double area = double{scene.side_area(side)} / scene.total_area();
        const double relative = found.bend / (found.light * found.light + 0.01 * mean * mean);
        error[scene.patch_of_side(side)] += (views[side].share + kUnseen * area) * std::min(relative, kLargest * kLargest) +
                                            kSent * area * std::max(0.0, found.spread) / (light * light);
    }
    return error;
}

/// Take noise out of the errors, and give cells in which none was found a little.
std::vector<double> smoothed(std::vector<double> error, const Scene& scene, const CellEdges& edges) {
    for (int round = 0; round < kRounds; ++round) {
        std::vector<double> next(error.size());
        for (uint32_t cell = 0; cell < error.size(); ++cell) {
            const auto around = edges.neighbours(cell);
            double sum = 0;
            for (uint32_t other : around) sum += error[other];
            next[cell] = around.empty() ? error[cell] : (error[cell] + sum / static_cast<double>(around.size())) / 2;
        }
        error = std::move(next);
    }
    double total = 0;
    for (double& e : error) e = std::max(e, 0.0), total += e;
    for (uint32_t cell = 0; cell < error.size(); ++cell) error[cell] += kEven * total * double{scene.patch_area(cell)} / scene.total_area();
    return error;
}

}  // namespace

void refine(Scene& scene, const Accel& accel, std::span<const Camera> cameras, uint64_t patches, bool first_shot) {
    if (patches < scene.triangles() + kFewest) return;
    Tessellation before = scene.tessellation();
    std::vector<float> areas(scene.triangles());
    for (uint32_t t = 0; t < scene.triangles(); ++t) areas[t] = scene.triangle_area(t);
    const auto even = static_cast<uint64_t>(kEvenPatches * static_cast<double>(patches - scene.triangles()));
    scene.divide(Tessellation(divisions_by_area(areas, scene.triangles() + even)));
    const Lattice lattice(scene);
    const CellEdges edges(scene, lattice);
    const DefensiveStarts reachable = survey(accel, kSurvey);
    std::vector<double> error;
    if (reachable.by_area.size() > 0) {
        const std::vector<View> seen = views(accel, cameras);
        const std::vector<uint32_t> sides = large_sides(scene, reachable);
        const Pilot pilot(accel, lattice, reachable, sides, first_shot, kPilot);
        error = smoothed(errors(scene, look_at(sides, pilot, scene, edges, seen), seen), scene, edges);
    }
    const bool is_known = std::any_of(error.begin(), error.end(), [](double e) { return e > 0; });
    scene.divide(is_known ? Tessellation(scene.tessellation(), deal_out(edges, error, patches)) : std::move(before));
}

}  // namespace lumel
