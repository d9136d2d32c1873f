#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include "arrays.h"
#include "lumel/accel/accel.h"
#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"

using namespace lumel;

namespace {

/// Closest hits of incoherent rays, from random patches in all directions: for measuring.
uint64_t closest_hits(const Accel& accel, uint64_t rays, uint64_t seed, int threads) {
    nb::gil_scoped_release release;
    const Scene& scene = accel.scene();
    const auto hits_of = [&](const tbb::blocked_range<uint64_t>& range, uint64_t hits) {
        const FlushDenormals flush;
        for (uint64_t i = range.begin(); i < range.end(); ++i) {
            Rng rng(key(seed, i));
            const auto patch = static_cast<uint32_t>(rng.bits() % scene.patches());
            const SurfacePoint point = scene.centre_of_patch(patch);
            const float u = rng.uniform();
            const Vec3 direction = square_to_sphere({u, rng.uniform()}), normal = scene.geometric_normal(point.triangle);
            const Vec3 off = normal * std::copysign(scene.epsilon(), dot(direction, normal));
            hits += !accel.intersect({scene.position(point) + off, direction}).is_miss();
        }
        return hits;
    };
    tbb::task_arena arena(threads);
    return arena.execute([&] { return tbb::parallel_reduce(tbb::blocked_range<uint64_t>(0, rays), uint64_t{0}, hits_of, std::plus<>()); });
}

}  // namespace

void bind_accel(nb::module_& m) {
    nb::class_<Accel>(m, "Accel")
        .def(nb::init<const Scene&>(), nb::arg("scene"), nb::keep_alive<1, 2>())
        .def("closest_hits", closest_hits, nb::arg("rays"), nb::arg("seed"), nb::arg("threads"));
}
