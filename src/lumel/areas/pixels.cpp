#include "lumel/areas/pixels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <optional>

#include "lumel/areas/lobe_albedo.h"
#include "lumel/areas/lobe_looks.h"
#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

constexpr uint32_t kSides = 256;         // receivers of a work item
constexpr uint32_t kPixels = 256;        // of a work item
constexpr uint32_t kAlbedoSamples = 16;  // for a pixel, and this many times as many where it is not uniform
constexpr uint32_t kLobeSamples = 8;     // for each of these

/// |ds/dA| of a pixel at x; 0 where the surface faces away. dw/ds falls as the cube of the cosine over the film.
float film_density(const Camera& camera, const Surface& x) {
    const Vec3 to = camera.origin - x.x;
    const float d2 = dot(to, to), d = std::sqrt(d2), cos = dot(x.normal, to) / d, film = -dot(camera.forward, to) / d;
    if (!(cos > 0 && film > 0)) return 0;
    const float solid_angle = 4 * camera.tan_x * camera.tan_y * film * film * film / static_cast<float>(camera.width * camera.height);
    return cos / (d2 * solid_angle);
}

/// Pixel on which x falls, if it is on the film.
std::optional<uint32_t> pixel_of(const Camera& camera, Vec3 x) {
    const Vec3 d = x - camera.origin;
    const float depth = dot(d, camera.forward);
    if (!(depth > 0)) return {};
    const float u = 0.5f * (1 + dot(d, camera.right) / (depth * camera.tan_x)), v = 0.5f * (1 - dot(d, camera.up) / (depth * camera.tan_y));
    if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return {};
    const auto column = static_cast<uint32_t>(u * static_cast<float>(camera.width)),
               row = static_cast<uint32_t>(v * static_cast<float>(camera.height));
    return std::min(row, camera.height - 1) * camera.width + std::min(column, camera.width - 1);
}

}  // namespace

PixelAreas::PixelAreas(const Accel& accel, const Lattice& lattice, std::vector<Camera> cameras)
    : accel_(&accel), scene_(&accel.scene()), cameras_(std::move(cameras)) {
    size_t areas = 0;
    for (const Camera& camera : cameras_) {
        first_.push_back(areas);
        areas += size_t{camera.width} * camera.height;
    }
    albedo_.resize(areas);
    tally_ = Tally(areas);
    find_receivers();
    field_ = BundleField(*scene_, lattice, receivers_);
    find_albedo();
}

void PixelAreas::find_receivers() {
    for (uint32_t side = 0; side < scene_->sides(); ++side) {
        if (scene_->glossy_index(side) == Scene::kNone) continue;
        const Surface x(*scene_, scene_->centre_of_patch(scene_->patch_of_side(side)), scene_->is_back(side));
        const auto faces = [&](const Camera& camera) { return dot(x.normal, camera.origin - x.x) > 0; };
        if (std::any_of(cameras_.begin(), cameras_.end(), faces)) receivers_.push_back(side);
    }
}

void PixelAreas::find_albedo() {
    for (uint32_t c = 0; c < cameras(); ++c) {
        const Camera& camera = cameras_[c];
        tbb::parallel_for(uint32_t{0}, camera.width * camera.height, [&](uint32_t pixel) {
            const FlushDenormals flush;
            double sum = 0, least = INFINITY, most = 0;
            uint32_t wanted = kAlbedoSamples;
            for (uint32_t i = 0; i < wanted; ++i) {
                const Ray ray{camera.origin, camera.direction(camera.on_film(pixel, sobol2d(i, key(c, pixel))))};
                const Hit hit = accel_->intersect(ray);
                double albedo = 0;
                if (!hit.is_miss()) {
                    const Surface x(*scene_, hit.point(), hit.back);
                    if (x.scatters && x.material->is_glossy())
                        albedo = double{lobe_albedo(x, -ray.direction, kLobeSamples, key(c, pixel, i))};
                }
                sum += albedo, least = std::min(least, albedo), most = std::max(most, albedo);
                if (i + 1 == kAlbedoSamples && most - least > 0.01 * most) wanted *= kAlbedoSamples;
            }
            albedo_[at(c, pixel)] = sum / wanted;
        });
    }
}

void PixelAreas::measure(const Step& step) {
    // Sides are measured in parallel, and their deposits summed in the order of the sides.
    const auto blocks = static_cast<uint32_t>((receivers_.size() + kSides - 1) / kSides);
    std::vector<std::vector<Deposit>> deposits(blocks);
    tbb::parallel_for(uint32_t{0}, blocks, [&](uint32_t block) {
        const FlushDenormals flush;
        for (size_t i = size_t{block} * kSides; i < std::min(receivers_.size(), (size_t{block} + 1) * kSides); ++i)
            shoot_side(step, receivers_[i], deposits[block]);
    });
    for (const auto& list : deposits)
        for (const Deposit& d : list) {
            if (d.plain)
                tally_.add_plain(d.area, step, to_double(d.f));
            else
                tally_.add(d.area, step, to_double(d.f), double{d.g});
        }
    if (!step.bundles.empty()) measure_bundles(step);
    for (uint32_t camera = 0; camera < cameras(); ++camera)
        tbb::parallel_for(tbb::blocked_range<uint32_t>(0, cameras_[camera].width * cameras_[camera].height, kPixels),
                          [&](const auto& range) {
                              const FlushDenormals flush;
                              LobeLooks looks(*scene_, step, tally_);
                              for (uint32_t pixel = range.begin(); pixel < range.end(); ++pixel) look(step, camera, pixel, looks);
                              looks.see();
                          });
}

void PixelAreas::shoot_side(const Step& step, uint32_t side, std::vector<Deposit>& deposits) const {
    const uint32_t triangle = scene_->triangle_of_side(side);
    for (const Transfer& transfer : step.transfers.placed(side)) {
        const Surface x(*scene_, {triangle, transfer.u, transfer.v}, scene_->is_back(side));
        const Frame frame(x.shading);
        const Vec3 wi = frame.to_local(transfer.wi);
        const float cos = dot(x.normal, transfer.wi);
        if (!(wi.z > 0 && cos > 0)) continue;
        for (uint32_t c = 0; c < cameras(); ++c) {
            // Connect the hit to every eye that it may reach.
            const float density = film_density(cameras_[c], x);
            if (!(density > 0)) continue;
            const auto pixel = pixel_of(cameras_[c], x.x);
            if (!pixel || !(albedo(c, *pixel) > 0)) continue;
            const Vec3 wo = frame.to_local(normalize(cameras_[c].origin - x.x));
            const Rgb scatter = x.material->scatter_s(wi, wo);
            if (!(max_component(scatter) > 0) || !accel_->visible(x.off(scene_->epsilon()), cameras_[c].origin)) continue;
            const bool plain = !(transfer.inv_pdf > 0);
            const float gathered = static_cast<float>(step.gather) * density * ggx::pdf_w(wo, wi, x.material->alpha) * transfer.inv_pdf;
            const float share = density / (cos + gathered);
            deposits.push_back(
                {static_cast<uint32_t>(at(c, *pixel)), plain, scatter * transfer.flux * share, lum(scatter) * transfer.inv_pdf * share});
        }
    }
}

void PixelAreas::look(const Step& step, uint32_t camera, uint32_t pixel, LobeLooks& looks) const {
    if (!(albedo(camera, pixel) > 0)) return;
    const uint64_t stream = key(step.stream, camera, pixel);
    const uint32_t count = looks.begin(at(camera, pixel), 1, stream);
    for (uint32_t i = 0; i < count; ++i) {
        const Ray ray{cameras_[camera].origin, cameras_[camera].direction(cameras_[camera].on_film(pixel, sobol2d(i, key(stream, 1))))};
        const Hit hit = accel_->intersect(ray);
        if (hit.is_miss()) continue;
        const Surface x(*scene_, hit.point(), hit.back);
        if (!x.scatters || !x.material->is_glossy()) continue;
        looks.draw(x, -ray.direction, film_density(cameras_[camera], x), sobol2d(i, key(stream, 2)));
    }
}

Samples PixelAreas::samples(uint32_t camera, uint32_t pixel) const {
    const double a = albedo(camera, pixel);
    Samples means = scaled(unscaled(camera, pixel), 1, a > 0 ? 1 / a : 0);
    means.size = a;
    return means;
}

}  // namespace lumel
