#include "lumel/transport/defensive.h"

#include <tbb/parallel_for.h>

#include <atomic>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/closed_surfaces.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr uint32_t kWalks = 1u << 14;
constexpr int kSteps = 8;
constexpr uint32_t kLooks = 256;   // from a face that no walk met
constexpr double kLeak = 1e-4;  // a scene is open if more than this share of the steps leaves it

Square square(Rng& rng) {
    const float u = rng.uniform();
    return {u, rng.uniform()};
}

/// Start of a walk at a lamp: each lamp gets its share of the walks.
Ray start(const Scene& scene, uint32_t walk, Rng& rng) {
    const size_t areas = scene.area_lamps().size(), lamp = walk % (areas + scene.point_lamps().size());
    if (lamp >= areas) return {scene.point_lamps()[lamp - areas].position, square_to_sphere(square(rng))};
    const AreaLamp& a = scene.area_lamps()[lamp];
    const uint32_t triangle = a.triangles[a.by_area.find(rng.uniform() * a.by_area.total())];
    const Square b = square_to_triangle(square(rng));
    const Surface y(scene, {triangle, b.u, b.v}, false);
    return {y.off(scene.epsilon()), Frame(y.normal).to_world(square_to_cosine_hemisphere(square(rng)))};
}

/// What rays from a face meet: other faces, or nothing.
struct Outlook {
    std::vector<uint32_t> faces;
    bool sky = false;
};

/// Look from `face`, 2 shape + back, whose triangles are given.
Outlook look_from(const Accel& accel, uint32_t face, const std::vector<uint32_t>& triangles, uint64_t seed) {
    const Scene& scene = accel.scene();
    const Distribution by_area(static_cast<uint32_t>(triangles.size()), [&](uint32_t i) { return scene.triangle_area(triangles[i]); });
    Outlook seen;
    Rng rng(key(seed, 0x6u, face));
    for (uint32_t look = 0; look < kLooks; ++look) {
        const uint32_t triangle = triangles[by_area.find(double{rng.uniform()} * by_area.total())];
        const Square b = square_to_triangle(square(rng));
        const Surface x(scene, {triangle, b.u, b.v}, (face & 1) != 0);
        const Hit hit = accel.intersect({x.off(scene.epsilon()), Frame(x.normal).to_world(square_to_cosine_hemisphere(square(rng)))});
        if (hit.is_miss())
            seen.sky = true;
        else
            seen.faces.push_back(scene.shape(hit.triangle) * 2 + hit.back);
    }
    std::sort(seen.faces.begin(), seen.faces.end());
    seen.faces.erase(std::unique(seen.faces.begin(), seen.faces.end()), seen.faces.end());
    return seen;
}

/// Walks miss what is small. A face sees light where it sees the sky of an open scene, or a face that light reaches; but from the inside of
/// what is closed a floor in which it stands may be seen as well, so the backs of closed shapes must see the sky.
void reach_by_looks(const Accel& accel, uint64_t seed, bool is_open, DefensiveStarts& starts) {
    const Scene& scene = accel.scene();
    std::vector<uint8_t>& reached = starts.reached;
    std::vector<std::vector<uint32_t>> triangles(scene.shapes());
    std::vector<uint8_t> is_closed(scene.shapes());
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const uint32_t shape = scene.shape(t);
        if (!reached[size_t{shape} * 2] || !reached[size_t{shape} * 2 + 1]) triangles[shape].push_back(t);
        is_closed[shape] |= starts.closed[t] != Scene::kNone;
    }
    std::vector<Outlook> outlook(reached.size());
    tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(reached.size()), [&](uint32_t face) {
        const FlushDenormals flush;
        if (!reached[face] && !triangles[face / 2].empty()) outlook[face] = look_from(accel, face, triangles[face / 2], seed);
    });
    for (bool goes_on = true; goes_on;) {
        goes_on = false;
        for (uint32_t face = 0; face < reached.size(); ++face) {
            const bool is_inside = is_closed[face / 2] && (face & 1) != 0;
            const bool sees_light = (is_open && outlook[face].sky) ||
                                    (!is_inside && std::any_of(outlook[face].faces.begin(), outlook[face].faces.end(),
                                                               [&](uint32_t other) { return reached[other] != 0; }));
            if (!reached[face] && sees_light) reached[face] = 1, goes_on = true;
        }
    }
}

}  // namespace

DefensiveStarts survey(const Accel& accel, uint64_t seed) {
    const Scene& scene = accel.scene();
    DefensiveStarts starts;
    if (scene.area_lamps().empty() && scene.point_lamps().empty()) return starts;

    // Walk from the lamps as if all surfaces were white and matt, and mark which faces of which shapes are met.
    std::vector<std::atomic<uint8_t>> reached(size_t{scene.shapes()} * 2);
    std::atomic<uint64_t> steps = 0, escapes = 0;
    tbb::parallel_for(uint32_t{0}, kWalks, [&](uint32_t walk) {
        const FlushDenormals flush;
        Rng rng(key(seed, 0x5u, walk));
        Ray ray = start(scene, walk, rng);
        for (int step = 0; step < kSteps; ++step) {
            const Hit hit = accel.intersect(ray);
            steps.fetch_add(1, std::memory_order_relaxed);
            if (hit.is_miss()) {
                escapes.fetch_add(1, std::memory_order_relaxed);
                return;
            }
            reached[size_t{scene.shape(hit.triangle)} * 2 + hit.back].store(1, std::memory_order_relaxed);
            const Surface x(scene, hit.point(), hit.back);
            ray = {x.off(scene.epsilon()), Frame(x.normal).to_world(square_to_cosine_hemisphere(square(rng)))};
        }
    });
    for (const AreaLamp& lamp : scene.area_lamps()) reached[size_t{lamp.shape} * 2].store(1);

    starts.reached.assign(reached.begin(), reached.end());
    const bool is_open = static_cast<double>(escapes) > kLeak * static_cast<double>(steps);
    starts.closed = closed_surfaces(scene);
    reach_by_looks(accel, seed, is_open, starts);

    // What a perfect mirror reflects has its density already: starts on it would count its directions twice.
    starts.by_area = Distribution(scene.sides(), [&](uint32_t side) {
        if (scene.scatters(side) && scene.material(scene.triangle_of_side(side)).is_perfect_mirror()) return 0.0f;
        return starts.reaches(scene, scene.triangle_of_side(side), scene.is_back(side)) ? scene.patch_area(scene.patch_of_side(side))
                                                                                        : 0.0f;
    });
    if (is_open) starts.sphere_area = 4 * double{kPi} * sqr(scene.radius());
    return starts;
}

}  // namespace lumel
