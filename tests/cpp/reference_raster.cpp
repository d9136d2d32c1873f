#include "reference_raster.h"

namespace lumel::test {

namespace {

struct Point {
    int64_t x = 0, y = 0;
};

/// Depth over a triangle, at pixel (x, y), of its corners in whatever order.
struct Plane {
    SnappedVertex a;
    double slope_x = 0, slope_y = 0, lowest = 0, highest = 0;

    explicit Plane(std::array<SnappedVertex, 3> v) {
        std::sort(v.begin(), v.end(), [](const SnappedVertex& l, const SnappedVertex& r) {
            return l.y != r.y ? l.y < r.y : l.x != r.x ? l.x < r.x : l.depth < r.depth;
        });
        constexpr double kPixel = kSubpixels;
        a = v[0];
        const double bx = (v[1].x - a.x) / kPixel, by = (v[1].y - a.y) / kPixel, cx = (v[2].x - a.x) / kPixel, cy = (v[2].y - a.y) / kPixel;
        const double bd = v[1].depth - a.depth, cd = v[2].depth - a.depth, area = bx * cy - by * cx;
        slope_x = (bd * cy - cd * by) / area, slope_y = (cd * bx - bd * cx) / area;
        lowest = std::min({v[0].depth, v[1].depth, v[2].depth}), highest = std::max({v[0].depth, v[1].depth, v[2].depth});
    }
    double operator()(double x, double y) const {
        const double d = a.depth + slope_y * (y - a.y / double{kSubpixels}) + slope_x * (x - a.x / double{kSubpixels});
        return std::nearbyint(std::clamp(d, lowest, highest));
    }
};

/// A patch in subpixels times divisions, its corners in the order of a left turn.
struct Outline {
    int64_t pixel = 0;
    std::array<Point, 3> corners;

    Outline(const std::array<SnappedVertex, 3>& v, bool turns_left, int64_t n, const PatchPlace& place) : pixel(n * kSubpixels) {
        const auto points = place.lattice();
        for (size_t k = 0; k < 3; ++k) {
            const int64_t i = points[k][0], j = points[k][1];
            corners[turns_left ? k : 2 - k] = {(n - i - j) * v[0].x + i * v[1].x + j * v[2].x,
                                               (n - i - j) * v[0].y + i * v[1].y + j * v[2].y};
        }
    }
    /// Is a pixel centre inside? One that lies exactly on an edge is taken as if it were moved a little to the right, and far less up.
    bool covers(int64_t x, int64_t y) const {
        for (size_t k = 0; k < 3; ++k) {
            const Point a = corners[k], b = corners[(k + 1) % 3];
            const int64_t ex = b.x - a.x, ey = b.y - a.y;
            const int64_t side = ex * (y * pixel - a.y) - ey * (x * pixel - a.x);
            if (side < 0 || (side == 0 && !(ey < 0 || (ey == 0 && ex > 0)))) return false;
        }
        return true;
    }
};

}  // namespace

bool patch_covers(const std::array<SnappedVertex, 3>& triangle, uint32_t n, const PatchPlace& place, int64_t x, int64_t y) {
    return Outline(triangle, turn(triangle[0], triangle[1], triangle[2]) > 0, n, place).covers(x, y);
}

std::vector<std::vector<Fragment>> fragment_lists(const Scene& scene, const Window& window) {
    std::vector<SnappedVertex> vertices;
    project(scene, window, vertices);
    std::vector<std::vector<Fragment>> lines(size_t{window.resolution} * window.resolution);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const uint32_t t = scene.triangle_of_patch(patch);
        const Indices& i = scene.indices()[t];
        const std::array v{vertices[i[0]], vertices[i[1]], vertices[i[2]]};
        const int64_t twice_area = turn(v[0], v[1], v[2]);
        if (twice_area == 0) continue;
        const Plane plane(v);
        const Outline whole(v, twice_area > 0, 1, {}),
            outline(v, twice_area > 0, scene.divisions(t), scene.tessellation().place_in_cell(patch));
        const auto [x0, x1] = std::minmax({outline.corners[0].x, outline.corners[1].x, outline.corners[2].x});
        const auto [y0, y1] = std::minmax({outline.corners[0].y, outline.corners[1].y, outline.corners[2].y});
        for (int64_t y = y0 / outline.pixel; y * outline.pixel <= y1; ++y) {
            std::vector<int32_t> row;
            for (int64_t x = x0 / outline.pixel; x * outline.pixel <= x1; ++x)
                if (outline.covers(x, y)) row.push_back(static_cast<int32_t>(x));
            // The depth of the first pixel of the triangle in the row, and a whole step to each further one.
            int32_t first = row.empty() ? 0 : row[0];
            while (first > 0 && whole.covers(first - 1, y)) --first;
            const auto depth = [&](int32_t x) { return plane(first, static_cast<double>(y)) + (x - first) * std::floor(plane.slope_x); };
            for (int32_t x : row)
                lines[static_cast<size_t>(y) * window.resolution + static_cast<size_t>(x)].push_back({depth(x), patch, twice_area > 0});
        }
    }
    for (std::vector<Fragment>& line : lines)
        std::sort(line.begin(), line.end(),
                  [](const Fragment& l, const Fragment& r) { return l.depth != r.depth ? l.depth < r.depth : l.patch < r.patch; });
    return lines;
}

void reference_exchange(const RasterScene& raster, const Window& window, std::span<const Rgb> sent, std::span<Rgb> received,
                        std::span<uint32_t> pixels, SweepCounters& counters) {
    const Scene& scene = raster.scene();
    const uint32_t patches = scene.patches();
    const auto along = [&](const Fragment& f) { return f.front_along ? f.patch : f.patch + patches; };
    const auto against = [&](const Fragment& f) { return f.front_along ? f.patch + patches : f.patch; };
    ++counters.directions;
    for (const std::vector<Fragment>& line : fragment_lists(scene, window)) {
        if (line.empty()) continue;
        int balance = 0;
        bool violated = false;
        for (size_t i = 0; i < line.size(); ++i) {
            ++pixels[line[i].patch];
            const uint32_t surface = raster.closed_surface(scene.triangle_of_patch(line[i].patch));
            if (surface != RasterScene::kOpen) balance += line[i].front_along ? 1 : -1;
            if (i + 1 == line.size()) break;
            const Fragment &near = line[i], &far = line[i + 1];
            received[along(near)] += sent[against(far)];
            received[against(far)] += sent[along(near)];
            if (surface != RasterScene::kOpen && near.front_along == far.front_along &&
                surface == raster.closed_surface(scene.triangle_of_patch(far.patch))) {
                violated = true;
                counters.mispaired += to_double(sent[along(near)]) + to_double(sent[against(far)]);
            }
        }
        counters.escaped += sent[against(line.front())];
        counters.escaped += sent[along(line.back())];
        counters.fragments += line.size(), counters.pairs += line.size() - 1, ++counters.lines;
        counters.most_depth = std::max(counters.most_depth, uint64_t{line.size()});
        counters.parity_violations += violated || balance != 0;
    }
}

}  // namespace lumel::test
