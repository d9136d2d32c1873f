#include "scenes.h"

#include <limits>
#include <map>

#include "lumel/sampling/sobol.h"

namespace lumel::test {

namespace {

/// Unit icosahedron, every triangle divided into four `level` times.
struct Icosphere {
    std::vector<Vec3> points;
    std::vector<Indices> triangles;

    explicit Icosphere(int level) {
        const float t = 0.5f * (1 + std::sqrt(5.0f));
        for (Vec3 p : {Vec3{-1, t, 0},
                       {1, t, 0},
                       {-1, -t, 0},
                       {1, -t, 0},
                       {0, -1, t},
                       {0, 1, t},
                       {0, -1, -t},
                       {0, 1, -t},
                       {t, 0, -1},
                       {t, 0, 1},
                       {-t, 0, -1},
                       {-t, 0, 1}})
            points.push_back(normalize(p));
        triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                     {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
        for (int i = 0; i < level; ++i) divide();
    }

private:
    void divide() {
        std::map<std::array<uint32_t, 2>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [it, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<uint32_t>(points.size()));
            if (is_new) points.push_back(normalize(points[a] + points[b]));
            return it->second;
        };
        std::vector<Indices> finer;
        for (const auto& [a, b, c] : triangles) {
            const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
};

}  // namespace

SceneBuilder& SceneBuilder::triangle(Vec3 a, Vec3 b, Vec3 c) {
    indices.push_back({add_vertex(a), add_vertex(b), add_vertex(c)});
    triangle_shape.push_back(static_cast<uint32_t>(shape_material_.size() - 1));
    return *this;
}

SceneBuilder& SceneBuilder::quad(Vec3 corner, Vec3 u, Vec3 v) {
    return triangle(corner, corner + u, corner + u + v).triangle(corner, corner + u + v, corner + v);
}

SceneBuilder& SceneBuilder::face(int which, Vec3 lower, Vec3 upper, bool inward) {
    const Vec3 d = upper - lower, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
    const std::array<std::array<Vec3, 3>, 6> faces{
        {{lower, y, z}, {lower + x, z, y}, {lower, z, x}, {lower + y, x, z}, {lower, x, y}, {lower + z, y, x}}};
    const auto& [corner, u, v] = faces[static_cast<size_t>(which)];
    return inward ? quad(corner, u, v) : quad(corner, v, u);
}

SceneBuilder& SceneBuilder::box(Vec3 lower, Vec3 upper, bool inward) {
    for (int i = 0; i < 6; ++i) face(i, lower, upper, inward);
    return *this;
}

SceneBuilder& SceneBuilder::sphere(Vec3 centre, float radius, int level, bool inward, bool smooth) {
    const Icosphere ball(level);
    const auto first = static_cast<uint32_t>(vertices.size());
    for (Vec3 p : ball.points) add_vertex(centre + p * radius, smooth ? (inward ? -p : p) : Vec3{});
    for (const auto& [a, b, c] : ball.triangles) {
        indices.push_back(inward ? Indices{first + a, first + c, first + b} : Indices{first + a, first + b, first + c});
        triangle_shape.push_back(static_cast<uint32_t>(shape_material_.size() - 1));
    }
    return *this;
}

SceneBuilder& SceneBuilder::sphere_by_shape(Vec3 centre, float radius, int level, const std::function<uint32_t(Vec3)>& shape_of) {
    const size_t first = indices.size();
    sphere(centre, radius, level, true);
    for (size_t t = first; t < indices.size(); ++t) {
        const auto [a, b, c] = indices[t];
        triangle_shape[t] = shape_of((vertices[a] + vertices[b] + vertices[c]) / 3.0f);
    }
    return *this;
}

Scene SceneBuilder::build(uint64_t patches) const {
    return Scene({.vertices = vertices,
                  .normals = normals,
                  .triangles = indices,
                  .triangle_shape = triangle_shape,
                  .shape_material = shape_material_,
                  .shape_emission = shape_emission_},
                 materials_, point_lamps_, patches);
}

SceneBuilder soup(uint64_t seed) {
    Rng rng(seed);
    SceneBuilder b;
    b.shape(b.material(matt(0.5f)));
    b.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const auto coordinate = [&] {
        const float x = 2 * rng.uniform() - 1, kind = rng.uniform();
        return kind < 0.3f ? std::round(2 * x) / 2 : kind < 0.4f ? 1e-6f * x : x;
    };
    const auto point = [&] { return Vec3{coordinate(), coordinate(), coordinate()}; };
    std::vector<Vec3> corners{point()};
    const auto corner = [&] {
        if (rng.uniform() < 0.6f) return corners[static_cast<size_t>(rng.uniform() * static_cast<float>(corners.size()))];
        return corners.emplace_back(point());
    };
    for (int i = 0; i < 25; ++i) {
        const float kind = rng.uniform();
        const Vec3 p = corner(), q = corner(), r = corner();
        if (kind < 0.7f)
            b.triangle(p, q, r);
        else if (kind < 0.8f)
            b.triangle(p, q, p + (q - p) * 0.5f + r * 1e-5f);
        else if (kind < 0.9f)
            b.shape(0, grey(1)).triangle(p, q, r).shape(0, grey(2)).triangle(q, r, p).shape(0, grey(3)).triangle(q, p, r);
        else if (kind < 0.93f)
            b.triangle(p, q, r * std::numeric_limits<float>::quiet_NaN());
        else if (kind < 0.95f)
            b.triangle(p, q, r * 1e30f);
        else if (kind < 0.97f)
            b.triangle(p, q, r * 1e8f);
        else
            b.triangle(p, p, q);
    }
    return b;
}

Camera camera_over_floor(float x) {
    return {.origin = {x, 0.02f, 0.9f},
            .right = {1, 0, 0},
            .up = {0, 0.8f, 0.6f},
            .forward = {0, 0.6f, -0.8f},
            .tan_x = 1.2f,
            .tan_y = 1.2f,
            .width = 32,
            .height = 32};
}

double lamp_power(const Scene& scene) {
    double power = 0;
    for (const AreaLamp& lamp : scene.area_lamps()) power += lum(lamp.radiance) * double{lamp.area} * double{kPi};
    for (const PointLamp& lamp : scene.point_lamps()) power += 4 * double{kPi} * lum(lamp.intensity);
    return power;
}

}  // namespace lumel::test
