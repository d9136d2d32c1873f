// Choose a point of one area lamp as seen from a point.
#pragma once

#include <array>

#include "lumel/sampling/warp.h"
#include "lumel/scene/scene.h"
#include "lumel/scene/spherical_triangle.h"

namespace lumel {

/// What is near is sampled by solid angle: by area, the few samples next to x would carry light without bound. What is far is sampled by
/// area, which is faster. What is near follows from x, the lamp and the triangle alone.
class AreaLampView {
public:
    struct Sample {
        Vec3 y;           ///< on the lamp
        Vec3 normal;      ///< of the lamp there
        Vec3 wi;          ///< unit direction to it
        float pdf_w = 0;  ///< 1/sr; 0: no sample
    };

    AreaLampView(const Scene& scene, const AreaLamp& lamp, Vec3 x) : scene_(scene), lamp_(lamp), x_(x) {
        const Vec3 to = lamp.centre - x;
        near_ = dot(to, to) < sqr(kNearLamp * lamp.radius);
    }

    /// `choice` in [0, 1) selects the triangle, `s` the point on it.
    Sample sample(float choice, Square s) const {
        if (near_ && is_few()) return sample_few(choice, s);
        const uint32_t triangle = lamp_.triangles.size() == 1 ? lamp_.triangles[0]
                                                              : lamp_.triangles[lamp_.by_area.find(choice * lamp_.by_area.total())];
        if (near_ && is_near(triangle)) return sample_solid_angle(triangle, see(triangle), s);
        const Square b = square_to_triangle(s);
        Sample found = towards({triangle, b.u, b.v});
        const Vec3 to = found.y - x_;
        const float cos = -dot(found.normal, found.wi);
        if (cos > 1e-6f) found.pdf_w = dot(to, to) / (lamp_.area * cos);
        return found;
    }

    /// Density with which `sample` finds the point of `triangle` that is `distance` away along `wi`, 1/sr.
    float pdf_w(uint32_t triangle, Vec3 wi, float distance) const {
        const float cos = -dot(scene_.geometric_normal(triangle), wi);
        if (!(cos > 0)) return 0;
        if (near_ && is_few()) {
            float sum = 0;
            for (uint32_t t : lamp_.triangles) sum += see(t).solid_angle();
            return sum > 0 ? 1 / sum : 0.0f;
        }
        if (near_ && is_near(triangle)) return density(triangle, see(triangle));
        return sqr(distance) / (lamp_.area * cos);
    }

private:
    static constexpr uint32_t kFew = 4;
    static constexpr float kNearLamp = 1.5f;   ///< radii of the lamp from its centre
    static constexpr float kNearTriangle = 1;  ///< longest edges of the triangle from its centroid

    bool is_few() const { return lamp_.triangles.size() <= kFew; }

    bool is_near(uint32_t triangle) const {
        const auto [a, b, c] = corners(triangle);
        const Vec3 centroid = (a + b + c) / 3;
        const float edge2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
        return dot(centroid, centroid) < sqr(kNearTriangle) * edge2;
    }
    std::array<Vec3, 3> corners(uint32_t triangle) const {
        const auto [i, j, k] = scene_.indices()[triangle];
        const auto& v = scene_.vertices();
        return {v[i] - x_, v[j] - x_, v[k] - x_};
    }

    /// Nothing is seen from the plane of the triangle: within it, rounding would make up any solid angle.
    SphericalTriangle see(uint32_t triangle) const {
        const auto [a, b, c] = corners(triangle);
        return -dot(scene_.geometric_normal(triangle), a) > scene_.epsilon() ? SphericalTriangle(a, b, c) : SphericalTriangle();
    }

    Sample towards(SurfacePoint p) const {
        const Vec3 y = scene_.position(p), to = y - x_;
        return {y, scene_.geometric_normal(p.triangle), dot(to, to) > 0 ? normalize(to) : Vec3{}, 0};
    }

    /// A triangle chosen by area, and its point by solid angle.
    float density(uint32_t triangle, const SphericalTriangle& seen) const {
        return seen.solid_angle() > 0 ? scene_.triangle_area(triangle) / (lamp_.area * seen.solid_angle()) : 0.0f;
    }
    Sample sample_solid_angle(uint32_t triangle, const SphericalTriangle& seen, Square s) const {
        const float pdf_w = density(triangle, seen);
        if (!(pdf_w > 0)) return {};
        const Square b = seen.sample(s);
        Sample found = towards({triangle, b.u, b.v});
        found.pdf_w = pdf_w;
        return found;
    }

    /// Of few triangles all are looked at, and the whole lamp is sampled by solid angle.
    Sample sample_few(float choice, Square s) const {
        std::array<SphericalTriangle, kFew> seen;
        float sum = 0;
        for (size_t i = 0; i < lamp_.triangles.size(); ++i) seen[i] = see(lamp_.triangles[i]), sum += seen[i].solid_angle();
        if (!(sum > 0)) return {};
        size_t chosen = 0;
        float at = choice * sum;
        for (size_t i = 0; i < lamp_.triangles.size(); ++i) {
            if (!(seen[i].solid_angle() > 0)) continue;
            chosen = i;
            if (at < seen[i].solid_angle()) break;
            at -= seen[i].solid_angle();
        }
        const Square b = seen[chosen].sample(s);
        Sample found = towards({lamp_.triangles[chosen], b.u, b.v});
        found.pdf_w = 1 / sum;
        return found;
    }

    const Scene& scene_;
    const AreaLamp& lamp_;
    Vec3 x_;
    bool near_;
};

}  // namespace lumel
