// A triangle as a point sees it: its solid angle, and points of it that are uniform by solid angle.
#pragma once

#include "lumel/math/vec.h"
#include "lumel/sampling/sobol.h"

namespace lumel {

/// Sampling after Peters 2021, "BRDF importance sampling for polygonal lights": without differences of angles it holds for tiny triangles
/// too. In double precision, because a point close to an edge sees its ends in nearly opposite directions.
class SphericalTriangle {
public:
    /// A triangle that is not seen.
    SphericalTriangle() = default;

    /// Corners relative to the viewing point, m. The front is seen where a, b, c turn counter-clockwise.
    SphericalTriangle(Vec3 a, Vec3 b, Vec3 c) : a_(a), b_(b), c_(c) {
        const Place n = cross(a_.w, b_.w), middle = a_.w + b_.w;
        volume_ = -dot(n, c_.w), beside_ = dot(middle, c_.w), between_ = 0.5 * dot(middle, middle);
        const double angle = 2 * std::atan2(volume_, between_ + beside_);
        solid_angle_ = angle > kLeast ? angle : 0;
    }

    /// 0..2 pi, sr. 0 where the front is not seen. In the plane of the triangle it is 0 outside of it and undefined within.
    float solid_angle() const { return static_cast<float>(solid_angle_); }

    /// Barycentrics of b and c of a point that is uniform by solid angle; solid_angle() must be positive.
    Square sample(Square s) const {
        // The point d on the arc from a to c that leaves the share s.u of the solid angle between a, b and d: the mirror image of a at
        // h = along_a a + along_c c, for which the tangent of half the solid angle is linear in h.
        const double half = 0.5 * solid_angle_ * double{s.u}, cosine = std::cos(half), sine = std::sin(half);
        const double along_a = volume_ * cosine - beside_ * sine, along_c = between_ * sine;
        const Place h = along_a * a_.w + along_c * c_.w;
        const double twice = 2 * dot(a_.w, h) / dot(h, h);
        const Place d = twice * h + -1.0 * a_.w;

        // The point on the arc from b to d, uniform in its height along b: from_b b + from_d d.
        const Place sum = b_.w + d, difference = b_.w + -1.0 * d;
        const double up = 0.5 * dot(sum, sum), down = 0.5 * dot(difference, difference), height = 1 - double{s.v} * down;
        const double from_d = std::sqrt(double{s.v} * (1 + height) / std::max(up, kLeast * kLeast));
        const double from_b = height - from_d * dot(b_.w, d);

        // A direction is a sum of unit vectors to the corners; its weights over their distances are barycentrics.
        const double at_a = std::max(0.0, from_d * (twice * along_a - 1)) / a_.distance;
        const double at_b = std::max(0.0, from_b) / b_.distance, at_c = std::max(0.0, from_d * twice * along_c) / c_.distance;
        const double all = at_a + at_b + at_c;
        return {static_cast<float>(at_b / all), static_cast<float>(at_c / all)};
    }

private:
    static constexpr double kLeast = 1e-12;

    struct Place {
        double x = 0, y = 0, z = 0;
        friend Place operator+(Place p, Place q) { return {p.x + q.x, p.y + q.y, p.z + q.z}; }
        friend Place operator*(double s, Place p) { return {s * p.x, s * p.y, s * p.z}; }
        friend double dot(Place p, Place q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
        friend Place cross(Place p, Place q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
    };
    struct Corner {
        double distance = 0;
        Place w;  ///< unit direction

        Corner() = default;
        explicit Corner(Vec3 v) : w{double{v.x}, double{v.y}, double{v.z}} {
            distance = std::sqrt(dot(w, w));
            w = (1 / std::max(distance, 1e-300)) * w;
        }
    };
    Corner a_, b_, c_;
    double volume_ = 0, beside_ = 0, between_ = 0;  ///< -a x b . c, (a + b) . c and 1 + a . b of the unit directions
    double solid_angle_ = 0;
};

}  // namespace lumel
