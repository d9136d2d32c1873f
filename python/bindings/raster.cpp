#include <nanobind/stl/array.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "arrays.h"
#include "lumel/raster/transillumination.h"
#include "lumel/sampling/warp.h"

using namespace lumel;

namespace {

/// Sweeps a scene along random directions, without anything around it: for measuring.
class Raster {
public:
    Raster(const Scene& scene, int threads) : scene_(scene), arena_(threads), workers_([this] { return Worker(scene_); }) {}

    nb::typed<nb::dict, nb::str, nb::int_> sweep(uint32_t resolution, uint32_t directions, uint64_t seed) {
        {
            nb::gil_scoped_release release;
            arena_.execute(
                [&] { tbb::parallel_for(uint32_t{0}, directions, [&](uint32_t i) { workers_.local().sweep(resolution, i, seed); }); });
        }
        SweepCounters sum;
        for (Worker& worker : workers_) sum += std::exchange(worker.counters, {});
        nb::typed<nb::dict, nb::str, nb::int_> d;
        d["directions"] = sum.directions, d["fragments"] = sum.fragments, d["pairs"] = sum.pairs, d["lines"] = sum.lines;
        d["most_depth"] = sum.most_depth, d["parity_violations"] = sum.parity_violations;
        return d;
    }
    /// Memory that the threads hold beside the scene.
    size_t bytes() const {
        size_t sum = 0;
        for (const Worker& worker : workers_) sum += worker.bytes();
        return sum;
    }

private:
    struct Worker {
        const Scene& scene;
        Transillumination transillumination;
        std::vector<Rgb> sent, received;
        std::vector<uint32_t> pixels;
        SweepCounters counters;

        explicit Worker(const RasterScene& raster)
            : scene(raster.scene()),
              transillumination(raster),
              sent(raster.scene().sides(), {1, 1, 1}),
              received(raster.scene().sides()),
              pixels(raster.scene().patches()) {}
        void sweep(uint32_t resolution, uint32_t index, uint64_t seed) {
            const Vec3 direction = square_to_sphere(sobol2d(index, key(seed, 1)));
            transillumination.exchange(Window::covering(scene, direction, resolution, sobol2d(index, key(seed, 2))), sent, received, pixels,
                                       counters);
        }
        size_t bytes() const {
            return transillumination.bytes() + (sent.size() + received.size()) * sizeof(Rgb) + pixels.size() * sizeof(uint32_t);
        }
    };

    RasterScene scene_;
    tbb::task_arena arena_;
    tbb::enumerable_thread_specific<Worker> workers_;
};

}  // namespace

void bind_raster(nb::module_& m) {
    nb::class_<Raster>(m, "Raster")
        .def(nb::init<const Scene&, int>(), nb::arg("scene"), nb::arg("threads"), nb::keep_alive<1, 2>())
        .def("sweep", &Raster::sweep, nb::arg("resolution"), nb::arg("directions"), nb::arg("seed"))
        .def_prop_ro("bytes", &Raster::bytes);
}
