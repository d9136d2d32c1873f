#include "lumel/raster/transillumination.h"

#include "lumel/raster/patch_outline.h"

namespace lumel {

SweepCounters& SweepCounters::operator+=(const SweepCounters& other) {
    directions += other.directions, fragments += other.fragments, lines += other.lines, pairs += other.pairs;
    most_depth = std::max(most_depth, other.most_depth);
    parity_violations += other.parity_violations;
    escaped += other.escaped;
    return *this;
}

namespace {

struct Fragment {
    int64_t depth = 0;
    uint32_t patch = 0;
    bool front_along = false;  ///< the front looks along the direction
};

/// Is a pixel centre inside? One that lies exactly on an edge is taken as if it were moved a little to the right, and far less up.
bool covers(const PatchOutline& outline, int64_t x, int64_t y) {
    for (size_t k = 0; k < 3; ++k) {
        const auto &a = outline.corners[k], &b = outline.corners[(k + 1) % 3];
        const int64_t ex = b.x - a.x, ey = b.y - a.y;
        const int64_t side = ex * (y * outline.pixel() - a.y) - ey * (x * outline.pixel() - a.x);
        if (side < 0 || (side == 0 && !(ey < 0 || (ey == 0 && ex > 0)))) return false;
    }
    return true;
}

}  // namespace

void Transillumination::exchange(const Window& window, std::span<const Rgb> sent, std::span<Rgb> received, std::span<uint32_t> pixels,
                                 SweepCounters& counters) {
    const Scene& scene = scene_->scene();
    project(scene, window, vertices_);
    std::vector<std::vector<Fragment>> lines(size_t{window.resolution} * window.resolution);
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const Indices& i = scene.indices()[t];
        const std::array corners{vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
        const int64_t twice_area = turn(corners[0], corners[1], corners[2]);
        if (twice_area == 0) continue;
        const DepthPlane plane(corners[0], corners[1], corners[2], twice_area);
        const uint32_t n = scene.divisions(t), first = scene.first_patch(t);
        for (uint32_t k = 0; k < n * n; ++k) {
            const PatchOutline outline(corners, twice_area > 0, n, PatchPlace::of_index(n, k));
            const auto [x0, x1] = std::minmax({outline.corners[0].x, outline.corners[1].x, outline.corners[2].x});
            const auto [y0, y1] = std::minmax({outline.corners[0].y, outline.corners[1].y, outline.corners[2].y});
            for (int64_t y = ceil_div(y0, outline.pixel()); y * outline.pixel() <= y1; ++y) {
                int64_t depth = 0;
                bool inside = false;
                for (int64_t x = ceil_div(x0, outline.pixel()); x * outline.pixel() <= x1; ++x) {
                    if (!covers(outline, x, y)) continue;
                    depth = inside ? depth + plane.step() : plane.at(static_cast<int32_t>(x), static_cast<int32_t>(y));
                    inside = true;
                    lines[static_cast<size_t>(y) * window.resolution + static_cast<size_t>(x)].push_back(
                        {depth, first + k, twice_area > 0});
                    ++pixels[first + k];
                }
            }
        }
    }
    ++counters.directions;
    const uint32_t patches = scene.patches();
    for (std::vector<Fragment>& line : lines) {
        if (line.empty()) continue;
        std::sort(line.begin(), line.end(),
                  [](const Fragment& l, const Fragment& r) { return l.depth != r.depth ? l.depth < r.depth : l.patch < r.patch; });
        const auto along = [&](const Fragment& f) { return f.front_along ? f.patch : f.patch + patches; };
        const auto against = [&](const Fragment& f) { return f.front_along ? f.patch + patches : f.patch; };
        int64_t balance = 0;
        bool violated = false;
        for (size_t i = 0; i < line.size(); ++i) {
            const uint32_t surface = scene_->closed_surface(scene.triangle_of_patch(line[i].patch));
            if (surface != RasterScene::kOpen) balance += line[i].front_along ? 1 : -1;
            if (i + 1 == line.size()) break;
            const Fragment &near = line[i], &far = line[i + 1];
            received[along(near)] += sent[against(far)];
            received[against(far)] += sent[along(near)];
            violated |= surface != RasterScene::kOpen && near.front_along == far.front_along &&
                        surface == scene_->closed_surface(scene.triangle_of_patch(far.patch));
        }
        counters.escaped += sent[against(line.front())];
        counters.escaped += sent[along(line.back())];
        counters.fragments += line.size(), counters.pairs += line.size() - 1, ++counters.lines;
        counters.most_depth = std::max(counters.most_depth, uint64_t{line.size()});
        counters.parity_violations += violated || balance != 0;
    }
}

}  // namespace lumel
