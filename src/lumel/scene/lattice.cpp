#include "lumel/scene/lattice.h"

#include <bit>
#include <unordered_map>
#include <utility>

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

constexpr float kSameNormal = 0.9995f;  // cosine: about 2 degrees

/// Open hash table from grid cells to the vertices in them.
class Welder {
public:
    struct Vertex {
        Vec3 x, normal;
        uint32_t material, next;
    };

    /// `same_normal`: least cosine between normals that are welded.
    Welder(const Scene& scene, size_t points, float same_normal)
        : same_normal_(same_normal),
          lower_(scene.centre() - Vec3{1, 1, 1} * scene.radius()),
          cell_(scene.radius() * 3.7e-5f),
          tolerance_(scene.radius() * 3e-6f),
          heads_(std::bit_ceil(points + 1), Scene::kNone) {}

    uint32_t weld(Vec3 x, Vec3 normal, uint32_t material) {
        // A point near the border of its cell may have been entered in the next one.
        std::array<std::array<int64_t, 2>, 3> cells;
        for (int axis = 0; axis < 3; ++axis) {
            const float at = (x[axis] - lower_[axis]) / cell_, edge = tolerance_ / cell_;
            cells[axis] = {static_cast<int64_t>(std::floor(at - edge)), static_cast<int64_t>(std::floor(at + edge))};
        }
        for (int64_t i = cells[0][0]; i <= cells[0][1]; ++i)
            for (int64_t j = cells[1][0]; j <= cells[1][1]; ++j)
                for (int64_t k = cells[2][0]; k <= cells[2][1]; ++k)
                    for (uint32_t v = heads_[slot(i, j, k)]; v != Scene::kNone; v = vertices_[v].next) {
                        const Vertex& vertex = vertices_[v];
                        const Vec3 d = vertex.x - x;
                        if (vertex.material == material && dot(d, d) <= sqr(tolerance_) && dot(vertex.normal, normal) >= same_normal_)
                            return v;
                    }
        const auto id = static_cast<uint32_t>(vertices_.size());
        const auto at = [&](int axis) { return static_cast<int64_t>(std::floor((x[axis] - lower_[axis]) / cell_)); };
        uint32_t& head = heads_[slot(at(0), at(1), at(2))];
        vertices_.push_back({x, normal, material, head});
        head = id;
        return id;
    }
    uint32_t size() const { return static_cast<uint32_t>(vertices_.size()); }
    const std::vector<Vertex>& vertices() const { return vertices_; }

private:
    size_t slot(int64_t i, int64_t j, int64_t k) const {
        return key(static_cast<uint64_t>(i), static_cast<uint64_t>(j), static_cast<uint64_t>(k)) & (heads_.size() - 1);
    }
    float same_normal_;
    Vec3 lower_;
    float cell_, tolerance_;
    std::vector<uint32_t> heads_;
    std::vector<Vertex> vertices_;
};

}  // namespace

Lattice::Lattice(const Scene& scene) : scene_(&scene) {
    const Tessellation& tessellation = scene.tessellation();
    uint64_t points = 0;
    for (uint32_t cell = 0; cell < tessellation.cells(); ++cell) {
        first_.push_back(static_cast<uint32_t>(points));
        points += lattice_size(tessellation.divisions(cell));
    }
    vertex_.resize(points);
    Welder welder(scene, points, kSameNormal);
    for (uint32_t cell = 0; cell < tessellation.cells(); ++cell) {
        const uint32_t n = tessellation.divisions(cell), t = tessellation.triangle_of_cell(cell);
        for (uint32_t j = 0; j <= n; ++j)
            for (uint32_t i = 0; i + j <= n; ++i) {
                const Square at = tessellation.lattice_point(cell, i, j);
                const SurfacePoint p{t, at.u, at.v};
                vertex_[first_[cell] + lattice_index(n, i, j)] = welder.weld(scene.position(p), scene.shading_normal(p),
                                                                             scene.material_index(t));
            }
    }
    size_ = welder.size();
    Welder places(scene, size_, -2.0f);
    for (const Welder::Vertex& vertex : welder.vertices()) place_.push_back(places.weld(vertex.x, vertex.normal, 0));
    places_ = places.size();
    if (!tessellation.is_uniform()) find_hanging();
}

std::array<uint32_t, 3> Lattice::corners_of_cell(uint32_t cell) const {
    const uint32_t n = scene_->tessellation().divisions(cell), first = first_[cell];
    return {vertex_[first], vertex_[first + lattice_index(n, n, 0)], vertex_[first + lattice_index(n, 0, n)]};
}

std::vector<uint32_t> Lattice::edge(uint32_t cell, int which) const {
    const uint32_t n = scene_->tessellation().divisions(cell);
    std::vector<uint32_t> ids(n + 1);
    for (uint32_t k = 0; k <= n; ++k) {
        const std::array<uint32_t, 2> at = which == 0 ? std::array{k, 0u} : which == 1 ? std::array{n - k, k} : std::array{0u, n - k};
        ids[k] = vertex_[first_[cell] + lattice_index(n, at[0], at[1])];
    }
    return ids;
}

void Lattice::find_hanging() {
    // An edge has two welded ends. Of those that divided cells have, find the coarsest division: first among themselves, then undivided.
    const Tessellation& tessellation = scene_->tessellation();
    const auto name = [](uint32_t a, uint32_t b) { return uint64_t{std::min(a, b)} << 32 | std::max(a, b); };
    const auto ends = [&](uint32_t cell, int which) {
        const auto corners = corners_of_cell(cell);
        return name(corners[which], corners[(which + 1) % 3]);
    };
    std::unordered_map<uint64_t, uint32_t> coarsest;
    for (const bool is_divided : {true, false})
        for (uint32_t cell = 0; cell < tessellation.cells(); ++cell) {
            const uint32_t n = tessellation.divisions(cell);
            if ((n > 1) != is_divided) continue;
            for (int which = 0; which < 3; ++which) {
                const auto at = is_divided ? coarsest.try_emplace(ends(cell, which), n).first : coarsest.find(ends(cell, which));
                if (at != coarsest.end()) at->second = std::min(at->second, n);
            }
        }
    // Where a finer cell meets it, every other vertex of the finer one hangs.
    graded_.assign(size_, 0);
    std::vector<uint8_t> hangs(size_);
    for (uint32_t cell = 0; cell < tessellation.cells(); ++cell)
        for (int which = 0; which < 3; ++which) {
            if (tessellation.divisions(cell) == 1 || coarsest.at(ends(cell, which)) == tessellation.divisions(cell)) continue;
            const std::vector<uint32_t> ids = edge(cell, which);
            for (uint32_t k = 0; k < ids.size(); k += 2) graded_[ids[k]] = 1;
            for (uint32_t k = 1; k < ids.size(); k += 2)
                if (!std::exchange(hangs[ids[k]], 1)) hanging_.push_back({ids[k], {ids[k - 1], ids[k + 1]}});
        }
}

Lattice::Stencil Lattice::stencil(SurfacePoint p, bool back) const {
    const Tessellation& tessellation = scene_->tessellation();
    const Tessellation::InCell in = tessellation.locate(p.triangle, p.u, p.v);
    const uint32_t n = tessellation.divisions(in.cell);
    const PatchPlace place = PatchPlace::of_point(n, in.at.u, in.at.v);
    const float fu = in.at.u * static_cast<float>(n) - static_cast<float>(place.i),
                fv = in.at.v * static_cast<float>(n) - static_cast<float>(place.j);
    // Corners of an inverted patch are (1,1), (0,1), (1,0) of its place.
    const std::array<float, 3> raw = place.inverted ? std::array{fu + fv - 1, 1 - fu, 1 - fv} : std::array{1 - fu - fv, fu, fv};
    Stencil s{tessellation.first_patch_of_cell(in.cell) + place.index(n), corners_in_cell(in.cell, place), {}};
    for (int k = 0; k < 3; ++k) s.weight[k] = std::clamp(raw[k], 0.0f, 1.0f);
    const auto& covered = scene_->cover(s.patch + (back ? scene_->patches() : 0)).corner;
    if (covered[0] || covered[1] || covered[2]) {
        keep(s, {!covered[0], !covered[1], !covered[2]});
    } else {
        const float over = 1 / (s.weight[0] + s.weight[1] + s.weight[2]);
        for (float& weight : s.weight) weight *= over;
    }
    return s;
}

bool Lattice::keep(Stencil& stencil, const std::array<bool, 3>& corners) {
    float kept = 0, sum = 0;
    for (int k = 0; k < 3; ++k) sum += stencil.weight[k], kept += corners[k] ? stencil.weight[k] : 0.0f;
    for (int k = 0; k < 3; ++k) stencil.weight[k] = kept > 0 ? (corners[k] ? stencil.weight[k] / kept : 0) : stencil.weight[k] / sum;
    return kept > 0;
}

}  // namespace lumel
