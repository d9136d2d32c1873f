#include "lumel/raster/transillumination.h"

namespace lumel {

void Transillumination::exchange(const Window& window, std::span<const Rgb> sent, std::span<Rgb> received, std::span<uint32_t> pixels,
                                 SweepCounters& counters) {
    const Scene& scene = scene_->scene();
    project(scene, window, vertices_);
    prepare(window, sent);

    active_.clear();
    for (uint32_t y = 0; y < window.resolution; ++y) {
        for (uint32_t i = first_of_row_[y]; i < first_of_row_[y + 1]; ++i) active_.push_back(scan_patch(by_row_[i]));
        sweep_.begin_row(active_.size());
        for (size_t i = 0; i < active_.size();) {
            ScanPatch& patch = active_[i];
            const auto [begin, end, depth] = patch.row();
            if (begin < end) sweep_.add(begin, end, depth, end - begin > 1 ? patch.step() : 0, patch.patch(), facing_[patch.patch()]);
            patch.next_row();
            if (patch.is_done())
                patch = active_.back(), active_.pop_back();
            else
                ++i;
        }
        sweep_.run();
    }
    ++counters.directions;
    sweep_.count(counters);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const PatchLight& light = sweep_.light(patch);
        const uint32_t along = patch + (front_along_[patch] ? 0 : scene.patches()),
                       against = patch + (front_along_[patch] ? scene.patches() : 0);
        received[along] += light.received_along.colour();
        received[against] += light.received_against.colour();
        pixels[patch] += static_cast<uint32_t>(light.received_along.count);
    }
}

ScanPatch Transillumination::scan_patch(uint32_t patch) const {
    const Scene& scene = scene_->scene();
    const uint32_t t = scene.triangle_of_patch(patch);
    const Indices& i = scene.indices()[t];
    const std::array corners{vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
    const uint32_t n = scene.divisions(t);
    return {PatchOutline(corners, n, PatchPlace::of_index(n, patch - scene.first_patch(t))),
            DepthPlane(corners[0], corners[1], corners[2], turn(corners[0], corners[1], corners[2])), patch};
}

void Transillumination::prepare(const Window& window, std::span<const Rgb> sent) {
    const Scene& scene = scene_->scene();
    const uint32_t patches = scene.patches();
    sweep_.resize(window.resolution, patches);
    first_row_.resize(patches), by_row_.resize(patches), front_along_.resize(patches), facing_.resize(patches);
    first_of_row_.assign(window.resolution + 2, 0);
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const Indices& i = scene.indices()[t];
        const std::array corners{vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
        const int64_t twice_area = turn(corners[0], corners[1], corners[2]);
        const uint32_t n = scene.divisions(t), first = scene.first_patch(t);
        const bool front = twice_area > 0;
        for (uint32_t k = 0; k < n * n; ++k) {
            const uint32_t patch = first + k;
            const PatchOutline outline(corners, n, PatchPlace::of_index(n, k));
            const auto [low, high] = std::minmax({outline.corners[0].y, outline.corners[1].y, outline.corners[2].y});
            const int32_t begin = ScanPatch::first_row(low, outline.pixel()), end = ScanPatch::first_row(high, outline.pixel());
            const bool empty = twice_area == 0 || begin == end;
            const uint32_t row = empty ? window.resolution : static_cast<uint32_t>(begin);
            first_row_[patch] = row;
            ++first_of_row_[row + 1];
            const uint32_t surface = scene_->closed_surface(t);
            facing_[patch] = surface == RasterScene::kOpen ? RowSpan::open_parity(patch) : RowSpan::closed_parity(surface, front);
            front_along_[patch] = front;
            sweep_.light(patch) = front ? PatchLight(sent[patch], sent[patch + patches]) : PatchLight(sent[patch + patches], sent[patch]);
        }
    }
    for (uint32_t y = 0; y <= window.resolution; ++y) first_of_row_[y + 1] += first_of_row_[y];
    std::vector<uint32_t> next(first_of_row_.begin(), first_of_row_.end());
    for (uint32_t patch = 0; patch < patches; ++patch) by_row_[next[first_row_[patch]]++] = patch;
}

}  // namespace lumel
