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
        const auto [triangle, per_area] = choose(choice);
        if (!(per_area > 0)) return {};
        if (near_ && is_near(triangle)) return sample_solid_angle(triangle, per_area, see(triangle), s);
        const Square b = square_to_triangle(s);
        Sample found = towards({triangle, b.u, b.v});
        const Vec3 to = found.y - x_;
        const float cos = -dot(found.normal, found.wi);
        if (cos > 1e-6f) found.pdf_w = per_area * dot(to, to) / cos;
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
        const float per_area = density_of(triangle);
        return near_ && is_near(triangle) ? density(triangle, per_area, see(triangle)) : per_area * sqr(distance) / cos;
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

    /// A triangle of the lamp, and the density of a point that is chosen evenly on it, 1/m2.
    struct Choice {
        uint32_t triangle = 0;
        float per_area = 0;
    };
    /// Of the whole lamp by area, of a round one a facet first.
    Choice choose(float choice) const {
        if (lamp_.triangles.size() == 1) return {lamp_.triangles[0], 1 / lamp_.area};
        if (lamp_.facets.size() == 0) return {lamp_.triangles[lamp_.by_area.find(choice * lamp_.by_area.total())], 1 / lamp_.area};
        const LampFacets::Weights weights = lamp_.facets.weights(x_ - lamp_.centre, lamp_.radius);
        if (!(weights.total > 0)) return {};
        uint32_t facet = 0;
        float at = choice * weights.total;
        for (uint32_t i = 0; i < lamp_.facets.size(); ++i) {
            if (!(weights.weight[i] > 0)) continue;
            facet = i;
            if (at < weights.weight[i]) break;
            at -= weights.weight[i];
        }
        const float rest = std::min(at / weights.weight[facet], 1.0f);
        const uint32_t first = lamp_.facets.first(facet),
                       next = facet + 1 < lamp_.facets.size() ? lamp_.facets.first(facet + 1) : lamp_.by_area.size();
        const double before = lamp_.by_area.before(first), area = lamp_.by_area.before(next) - before;
        const uint32_t found = std::min(lamp_.by_area.find(before + double{rest} * area, first), next - 1);
        return {lamp_.triangles[found], weights.weight[facet] / (weights.total * lamp_.facets.area(facet))};
    }
    /// Density with which `choose`, and a point chosen evenly, finds a point of a triangle, 1/m2.
    float density_of(uint32_t triangle) const {
        if (lamp_.facets.size() == 0) return 1 / lamp_.area;
        const LampFacets::Weights weights = lamp_.facets.weights(x_ - lamp_.centre, lamp_.radius);
        const uint32_t facet = lamp_.facets.of_cell(LampFacets::cell(scene_.geometric_normal(triangle)));
        return weights.total > 0 ? weights.weight[facet] / (weights.total * lamp_.facets.area(facet)) : 0.0f;
    }

    /// A triangle chosen with the density `per_area`, and its point by solid angle.
    float density(uint32_t triangle, float per_area, const SphericalTriangle& seen) const {
        return seen.solid_angle() > 0 ? scene_.triangle_area(triangle) * per_area / seen.solid_angle() : 0.0f;
    }
    Sample sample_solid_angle(uint32_t triangle, float per_area, const SphericalTriangle& seen, Square s) const {
        const float pdf_w = density(triangle, per_area, seen);
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
