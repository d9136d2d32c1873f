#include "lumel/scene/lattice.h"

#include <bit>

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
    uint64_t points = 0;
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        first_.push_back(static_cast<uint32_t>(points));
        points += lattice_size(scene.divisions(t));
    }
    vertex_.resize(points);
    Welder welder(scene, points, kSameNormal);
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const uint32_t n = scene.divisions(t);
        for (uint32_t j = 0; j <= n; ++j)
            for (uint32_t i = 0; i + j <= n; ++i) {
                const SurfacePoint p{t, static_cast<float>(i) / static_cast<float>(n), static_cast<float>(j) / static_cast<float>(n)};
                vertex_[first_[t] + lattice_index(n, i, j)] = welder.weld(scene.position(p), scene.shading_normal(p),
                                                                          scene.material_index(t));
            }
    }
    size_ = welder.size();
    Welder places(scene, size_, -2.0f);
    for (const Welder::Vertex& vertex : welder.vertices()) place_.push_back(places.weld(vertex.x, vertex.normal, 0));
    places_ = places.size();
}

Lattice::Stencil Lattice::stencil(SurfacePoint p) const {
    const uint32_t n = scene_->divisions(p.triangle), patch = scene_->patch_of(p);
    const PatchPlace place = PatchPlace::of_point(n, p.u, p.v);
    const float fu = p.u * static_cast<float>(n) - static_cast<float>(place.i),
                fv = p.v * static_cast<float>(n) - static_cast<float>(place.j);
    // Corners of an inverted patch are (1,1), (0,1), (1,0) of its cell.
    const std::array<float, 3> raw = place.inverted ? std::array{fu + fv - 1, 1 - fu, 1 - fv} : std::array{1 - fu - fv, fu, fv};
    Stencil s{patch, corners(patch), {}};
    float sum = 0;
    for (int k = 0; k < 3; ++k) sum += s.weight[k] = std::clamp(raw[k], 0.0f, 1.0f);
    for (float& weight : s.weight) weight /= sum;
    return s;
}

}  // namespace lumel
