#include "lumel/transport/defensive.h"

#include <tbb/parallel_for.h>

#include <atomic>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

constexpr uint32_t kWalks = 1u << 14;
constexpr int kSteps = 8;
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

    // What a perfect mirror reflects has its density already: starts on it would count its directions twice.
    starts.by_area = Distribution(scene.sides(), [&](uint32_t side) {
        if (scene.scatters(side) && scene.material(scene.triangle_of_side(side)).is_perfect_mirror()) return 0.0f;
        return starts.reaches(scene, scene.triangle_of_side(side), scene.is_back(side)) ? scene.patch_area(scene.patch_of_side(side))
                                                                                        : 0.0f;
    });
    if (static_cast<double>(escapes) > kLeak * static_cast<double>(steps)) starts.sphere_area = 4 * double{kPi} * sqr(scene.radius());
    return starts;
}

}  // namespace lumel
