#include "lumel/eye/eye_pass.h"

#include <tbb/parallel_for.h>

#include "lumel/eye/allocation.h"
#include "lumel/eye/correction.h"
#include "lumel/eye/eye_rays.h"
#include "lumel/eye/small_lamps.h"
#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

constexpr float kSharp = 0.03f;         // roughness below which patches are too coarse for what is reflected: eye passes gather it
constexpr uint32_t kTaskSamples = 8192;  // blocks of rays shall be full, but
constexpr uint32_t kFewestTasks = 32;    // there shall be work for all threads
constexpr uint32_t kSurveySamples = 2;  // per pixel, to find out which patches are visible: light of others is gathered

/// Tasks must not depend on the number of threads, since what a pixel gets is summed up in the order of its task.
uint32_t pixels_of_task(const Film& film, uint32_t samples) {
    return std::max(film.width, std::min(kTaskSamples / samples, static_cast<uint32_t>(film.pixels()) / kFewestTasks));
}

/// Add the specular light that was measured in a pixel to all samples of a pass.
void add_measured(const Reconstructed& specular, PixelPass& pass) {
    const auto samples = static_cast<float>(pass.samples);
    pass.sum.indirect_specular += specular.value * samples;
    pass.sum.solution_stderr += specular.stderr_ * samples;
    pass.sum.specular_stderr = specular.stderr_ * samples;
    pass.sum.trust = specular.trust * samples;
    pass.excess.specular = pass.excess.specular - specular.value * static_cast<float>(pass.specular);
}

}  // namespace

bool eye_pass(const Accel& accel, const Camera& camera, uint32_t eye, const Reconstruction& reconstruction, const PixelRadiance* pixels,
              const EyePassConfig& config, const std::atomic<bool>* stop, Film& film) {
    const SmallLamps small_lamps(accel.scene(), camera);
    const EyeShader shader(accel, reconstruction, config.direct_light);
    const std::vector<uint32_t> samples = samples_of_pass(film, config.samples);
    std::vector<PixelPass> pass(film.pixels());
    const uint32_t size = pixels_of_task(film, config.samples), tasks = (static_cast<uint32_t>(film.pixels()) + size - 1) / size;
    tbb::parallel_for(uint32_t{0}, tasks, [&](uint32_t task) {
        if (stop && stop->load(std::memory_order_relaxed)) return;
        const FlushDenormals flush;
        EyeRays rays(shader, {camera, eye, small_lamps, pixels != nullptr}, pass);
        const uint32_t end = std::min(static_cast<uint32_t>(film.pixels()), (task + 1) * size);
        for (uint32_t pixel = task * size; pixel < end; ++pixel) {
            const auto before = static_cast<uint32_t>(film.samples(pixel));
            const Correction& correction = film.correction[pixel];
            const uint64_t stream = key(config.stream, pixel);
            Gather gather{.every_lobe = correction.gloss,
                          .is_allowed = config.gather,
                          .before_diffuse = film.diffuse[pixel].rays(),
                          .before_specular = film.specular[pixel].rays()};
            for (uint32_t i = before; i < before + samples[pixel]; ++i) {
                gather.diffuse = config.gather && i % correction.stride == 0;
                gather.specular = gather.diffuse || (config.gather && correction.gloss);
                rays.add(pixel, stream, i, gather);
                gather.before_diffuse += gather.diffuse, gather.before_specular += gather.specular;
            }
        }
        rays.finish();
    });
    if (stop && stop->load()) return false;
    for (size_t pixel = 0; pixels && pixel < film.pixels(); ++pixel) add_measured(pixels->pixels[pixel], pass[pixel]);
    small_lamps.add(accel, config.samples, key(config.stream, ~uint64_t{film.passes}), pass);
    film.add(pass);
    if (config.gather) correct(film, config.gloss);
    return true;
}

std::vector<uint32_t> visible_glossy_sides(const Accel& accel, const Lattice& lattice, std::span<const Camera> cameras) {
    const Scene& scene = accel.scene();
    std::vector<std::atomic<uint8_t>> seen(scene.sides());
    for (const Camera& camera : cameras)
        tbb::parallel_for(uint32_t{0}, camera.height, [&](uint32_t y) {
            const FlushDenormals flush;
            for (uint32_t x = 0; x < camera.width; ++x)
                for (uint32_t i = 0; i < kSurveySamples; ++i) {
                    const Square s = sobol2d(i, key(0x51, y, x));
                    const Hit hit = accel.intersect(
                        {camera.origin, camera.direction({(static_cast<float>(x) + s.u) / static_cast<float>(camera.width),
                                                          (static_cast<float>(y) + s.v) / static_cast<float>(camera.height)})});
                    if (!hit.is_miss()) seen[scene.side_of(hit.point(), hit.back)].store(1, std::memory_order_relaxed);
                }
        });

    // Interpolation reads the vertices of visible patches, and vertices pool all patches around them.
    std::vector<uint8_t> near(size_t{lattice.size()} * 2);
    const auto vertices = [&](uint32_t side) {
        auto ids = lattice.corners(scene.patch_of_side(side));
        if (scene.is_back(side))
            for (uint32_t& id : ids) id += lattice.size();
        return ids;
    };
    for (uint32_t side = 0; side < scene.sides(); ++side)
        if (seen[side])
            for (uint32_t vertex : vertices(side)) near[vertex] = 1;
    std::vector<uint32_t> sides;
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        if (scene.glossy_index(side) == Scene::kNone || !scene.scatters(side) ||
            scene.material(scene.triangle_of_side(side)).alpha < kSharp)
            continue;
        const auto ids = vertices(side);
        if (near[ids[0]] || near[ids[1]] || near[ids[2]]) sides.push_back(side);
    }
    return sides;
}

}  // namespace lumel
