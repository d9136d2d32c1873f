// Scenes built in code, for tests.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lumel/accel/accel.h"
#include "lumel/scene/camera.h"
#include "lumel/scene/lattice.h"
#include "lumel/transport/defensive.h"

namespace lumel::test {

/// Collects triangles; every shape has one material and one emission.
class SceneBuilder {
public:
    uint32_t material(Material m) {
        materials_.push_back(std::move(m));
        return static_cast<uint32_t>(materials_.size() - 1);
    }
    /// A shape: what is added from now on belongs to it. `emission` is the radiance of its front, W/(m2 sr).
    SceneBuilder& shape(uint32_t of_material, Rgb emission = {}) {
        shape_material_.push_back(of_material), shape_emission_.push_back(emission);
        return *this;
    }
    SceneBuilder& triangle(Vec3 a, Vec3 b, Vec3 c);
    uint32_t shapes() const { return static_cast<uint32_t>(shape_material_.size()); }
    /// Corner and edges; the front is on the side of u x v.
    SceneBuilder& quad(Vec3 corner, Vec3 u, Vec3 v);
    /// Face 0..5 (-x, +x, -y, +y, -z, +z) of a box, front inward or outward.
    SceneBuilder& face(int which, Vec3 lower, Vec3 upper, bool inward);
    SceneBuilder& box(Vec3 lower, Vec3 upper, bool inward);
    /// A sphere of 20 * 4^level triangles, front inward or outward. Smooth: with the sphere's own normals at its vertices.
    SceneBuilder& sphere(Vec3 centre, float radius, int level, bool inward, bool smooth = false);
    /// The same, but `shape_of(centroid)` chooses the shape of each triangle among those made before.
    SceneBuilder& sphere_by_shape(Vec3 centre, float radius, int level, const std::function<uint32_t(Vec3)>& shape_of);
    SceneBuilder& point_lamp(Vec3 position, Rgb intensity) {
        point_lamps_.push_back({position, intensity});
        return *this;
    }
    Scene build(uint64_t patches) const;

    // For tests of bad input.
    std::vector<Vec3> vertices, normals;
    std::vector<Indices> indices;
    std::vector<uint32_t> triangle_shape;

private:
    uint32_t add_vertex(Vec3 x, Vec3 normal = {}) {
        vertices.push_back(x), normals.push_back(normal);
        return static_cast<uint32_t>(vertices.size() - 1);
    }
    std::vector<uint32_t> shape_material_;
    std::vector<Rgb> shape_emission_;
    std::vector<Material> materials_;
    std::vector<PointLamp> point_lamps_;
};

constexpr Rgb grey(float value) { return {value, value, value}; }

inline Material matt(float albedo) {
    Material m;
    m.diffuse = grey(albedo);
    return m;
}
inline Material glossy(Rgb diffuse, Rgb specular, float alpha) {
    Material m;
    m.diffuse = diffuse, m.specular = specular, m.alpha = alpha;
    return m;
}
inline Material mirror(float tint) {
    Material m;
    m.mirror = grey(tint);
    return m;
}

/// A random mess: triangles large and small, needles, points, shared corners, coinciding and coplanar faces, broken numbers.
SceneBuilder soup(uint64_t seed);

/// A scene with what shooting needs. It stays where it is made: the parts point to each other.
struct Stage {
    Scene scene;
    Accel accel{scene};
    Lattice lattice{scene};
    DefensiveStarts defensive = survey(accel, 99);

    explicit Stage(Scene s) : scene(std::move(s)) {}
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
};

/// A camera of 32 x 32 pixels within the unit cube, at `x` beside the face y = 0, that looks down on the floor.
Camera camera_over_floor(float x);

/// Flux of all lamps, W (luminance).
double lamp_power(const Scene& scene);

}  // namespace lumel::test
