#include "lumel/raster/transillumination.h"

namespace lumel {

void Transillumination::exchange(const Window& window, std::span<const Rgb> sent, std::span<Rgb> received, std::span<uint32_t> pixels,
                                 SweepCounters& counters) {
    prepare(window);
    active_.clear();
    for (uint32_t row = 0; row < window.resolution; ++row) {
        begin_triangles(row, sent);
        active_.scan(static_cast<int32_t>(row), sweep_);
        sweep_.run();
    }
    SweepCounters met{.directions = 1};
    sweep_.count(met);
    collect(received, pixels, met);
    met.pairs = met.fragments - met.lines;
    counters += met;
}

void Transillumination::prepare(const Window& window) {
    const Scene& scene = scene_->scene();
    const uint32_t triangles = scene.triangles();
    project(scene, window, vertices_);
    sweep_.resize(window.resolution, scene.patches());
    front_along_.resize(triangles), first_row_.resize(triangles), by_row_.resize(triangles);

    // Sort the triangles by their first rows.
    first_of_row_.assign(window.resolution + 2, 0);
    for (uint32_t t = 0; t < triangles; ++t) {
        const auto [a, b, c] = corners(scene_->triangles()[t]);
        const int64_t twice_area = turn(a, b, c);
        front_along_[t] = twice_area > 0;
        first_row_[t] = twice_area == 0 ? window.resolution : std::min(first_row(a, b, c), window.resolution);
    }
    for (uint32_t row : first_row_) ++first_of_row_[row + 1];
    for (uint32_t row = 0; row <= window.resolution; ++row) first_of_row_[row + 1] += first_of_row_[row];
    for (uint32_t t = 0; t < triangles; ++t) by_row_[first_of_row_[first_row_[t]]++] = t;
    for (uint32_t row = window.resolution + 1; row > 0; --row) first_of_row_[row] = first_of_row_[row - 1];
    first_of_row_[0] = 0;
}

void Transillumination::begin_triangles(uint32_t row, std::span<const Rgb> sent) {
    if (first_of_row_[row] == first_of_row_[row + 1]) return;
    const uint32_t patches = scene_->scene().patches();
    std::array<ScannedTriangle, kLanes> four{};
    for (uint32_t i = first_of_row_[row], lane = 0; i < first_of_row_[row + 1]; ++i) {
        const uint32_t triangle = by_row_[i];
        const auto& [indices, n, first, surface] = scene_->triangles()[triangle];
        const bool front_along = front_along_[triangle];
        const uint32_t end = first + n * n;
        const Rgb* along = &sent[front_along ? 0 : patches];
        const Rgb* against = &sent[front_along ? patches : 0];
        for (uint32_t patch = first; patch < end; ++patch) sweep_.begin_patch(patch, PatchLight(along[patch], against[patch]));

        four[lane++] = {corners(scene_->triangles()[triangle]), triangle,
                        surface == RasterScene::kOpen ? RowSpan::kOpenParity : RowSpan::closed_parity(surface, front_along), n, first};
        if (lane < kLanes && i + 1 < first_of_row_[row + 1]) continue;
        active_.begin(four, lane);
        lane = 0;
    }
}

void Transillumination::collect(std::span<Rgb> received, std::span<uint32_t> pixels, SweepCounters& counters) {
    const uint32_t patches = scene_->scene().patches(), triangles = scene_->scene().triangles();
    const auto none = static_cast<uint32_t>(first_of_row_.size() - 2);
    Lanes escaped{};
    for (uint32_t triangle = 0; triangle < triangles; ++triangle) {
        if (first_row_[triangle] == none) continue;
        const auto& [indices, n, first, surface] = scene_->triangles()[triangle];
        const bool front_along = front_along_[triangle];
        const uint32_t end = first + n * n;
        Rgb* along = &received[front_along ? 0 : patches];
        Rgb* against = &received[front_along ? patches : 0];
        for (uint32_t patch = first; patch < end; ++patch) {
            const PatchLight& light = sweep_.light(patch);
            PatchLight::add(along[patch], light.received_along);
            PatchLight::add(against[patch], light.received_against);

            // What nothing received leaves the scene.
            const uint32_t last = sweep_.pixels_as_last(patch), covered = PatchLight::count(light.received_along) + last;
            const uint32_t as_first = covered - PatchLight::count(light.received_against);
            pixels[patch] += covered;
            counters.fragments += covered;
            if ((last | as_first) == 0) continue;
            const PatchLight::Flow unseen = light.sent_along * static_cast<float>(last) + light.sent_against * static_cast<float>(as_first);
            escaped += __builtin_convertvector(unseen, Lanes);
        }
    }
    counters.escaped += Rgb64{escaped[0], escaped[1], escaped[2]};
}

size_t Transillumination::bytes() const {
    const auto of = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
    return of(vertices_) + of(front_along_) + of(first_row_) + of(first_of_row_) + of(by_row_) + active_.bytes() + sweep_.bytes();
}

}  // namespace lumel
