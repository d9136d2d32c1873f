#include "lumel/raster/transillumination.h"

namespace lumel {

void Transillumination::exchange(const Window& window, std::span<const Rgb> sent, std::span<Rgb> received, std::span<uint32_t> pixels,
                                 SweepCounters& counters) {
    prepare(window);
    active_.clear();
    for (uint32_t row = 0; row < window.resolution; ++row) {
        begin_patches(row, sent);
        active_.scan(static_cast<int32_t>(row), sweep_);
        sweep_.run();
    }
    ++counters.directions;
    sweep_.count(counters);
    collect(received, pixels);
}

void Transillumination::prepare(const Window& window) {
    const Scene& scene = scene_->scene();
    const uint32_t patches = scene.patches();
    project(scene, window, vertices_);
    sweep_.resize(window.resolution, patches);
    turns_.resize(scene.triangles()), first_row_.resize(patches), by_row_.resize(patches);

    // Sort the patches by their first rows.
    first_of_row_.assign(window.resolution + 2, 0);
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const std::array c = corners(t);
        turns_[t] = turn(c[0], c[1], c[2]);
        enqueue(t, c);
    }
    for (uint32_t row : first_row_) ++first_of_row_[row + 1];
    for (uint32_t row = 0; row <= window.resolution; ++row) first_of_row_[row + 1] += first_of_row_[row];
    for (uint32_t patch = 0; patch < patches; ++patch) by_row_[first_of_row_[first_row_[patch]]++] = patch;
    for (uint32_t row = window.resolution + 1; row > 0; --row) first_of_row_[row] = first_of_row_[row - 1];
    first_of_row_[0] = 0;
}

/// Find the first rows of the patches of a triangle.
void Transillumination::enqueue(uint32_t triangle, const std::array<SnappedVertex, 3>& corners) {
    const Scene& scene = scene_->scene();
    const auto none = static_cast<uint32_t>(first_of_row_.size() - 2);
    uint32_t* first = &first_row_[scene.first_patch(triangle)];
    const uint32_t n = scene.divisions(triangle);
    const auto put = [&](int32_t a, int32_t b, int32_t c) {
        const int32_t begin = std::min({a, b, c}), end = std::max({a, b, c});
        *first++ = begin < end && turns_[triangle] != 0 ? static_cast<uint32_t>(begin) : none;
    };
    const auto [a, b, c] = corners;
    if (n == 1) {
        // Many of the smallest lie between two columns.
        const auto pixel = [](int32_t x) { return static_cast<int32_t>((x + kSubpixels - 1) >> kSubpixelBits); };
        const int32_t column = pixel(a.x);
        if (pixel(b.x) == column && pixel(c.x) == column)
            *first = none;
        else
            put(pixel(a.y), pixel(b.y), pixel(c.y));
        return;
    }

    // Patches lie between two rows of lattice points.
    lattice_rows_.resize(2 * (n + 1));
    int32_t *here = lattice_rows_.data(), *next = here + n + 1;
    const double pixel = static_cast<double>(n * kSubpixels);
    const auto find_rows = [&](int32_t* rows, uint32_t j) {
        const double y = static_cast<double>(n - j) * a.y + static_cast<double>(j) * c.y;
        for (uint32_t i = 0; i + j <= n; ++i) rows[i] = first_row(y + static_cast<double>(i) * (b.y - a.y), pixel);
    };
    find_rows(here, 0);
    for (uint32_t j = 0; j < n; ++j) {
        find_rows(next, j + 1);
        for (uint32_t i = 0; i + j < n; ++i) {
            put(here[i], here[i + 1], next[i]);
            if (i + j + 1 < n) put(next[i + 1], next[i], here[i + 1]);
        }
        std::swap(here, next);
    }
}

void Transillumination::begin_patches(uint32_t row, std::span<const Rgb> sent) {
    const Scene& scene = scene_->scene();
    uint32_t triangle = scene.triangles();
    std::array<SnappedVertex, 3> c;
    DepthPlane plane;
    for (uint32_t i = first_of_row_[row]; i < first_of_row_[row + 1]; ++i) {
        const uint32_t patch = by_row_[i];
        if (scene.triangle_of_patch(patch) != triangle) {
            triangle = scene.triangle_of_patch(patch);
            c = corners(triangle);
            plane = DepthPlane(c[0], c[1], c[2], turns_[triangle]);
        }
        const bool front_along = turns_[triangle] > 0;
        const uint32_t front = patch, back = patch + scene.patches(), surface = scene_->closed_surface(triangle);
        sweep_.light(patch) = front_along ? PatchLight(sent[front], sent[back]) : PatchLight(sent[back], sent[front]);
        active_.push(PatchOutline(c, scene.divisions(triangle), patch - scene.first_patch(triangle)), plane, patch,
                     surface == RasterScene::kOpen ? RowSpan::kOpenParity : RowSpan::closed_parity(surface, front_along));
    }
}

void Transillumination::collect(std::span<Rgb> received, std::span<uint32_t> pixels) {
    const Scene& scene = scene_->scene();
    const auto none = static_cast<uint32_t>(first_of_row_.size() - 2);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        if (first_row_[patch] == none) continue;
        const PatchLight& light = sweep_.light(patch);
        const bool front_along = turns_[scene.triangle_of_patch(patch)] > 0;
        const uint32_t front = patch, back = patch + scene.patches();
        received[front_along ? front : back] += PatchLight::colour(light.received_along);
        received[front_along ? back : front] += PatchLight::colour(light.received_against);
        pixels[patch] += static_cast<uint32_t>(PatchLight::count(light.received_along));
    }
}

size_t Transillumination::bytes() const {
    const auto of = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
    return of(vertices_) + of(turns_) + of(first_row_) + of(first_of_row_) + of(by_row_) + of(lattice_rows_) + active_.bytes() +
           sweep_.bytes();
}

}  // namespace lumel
