// Orthonormal frames around a normal, and mirror directions.
#pragma once

#include "lumel/math/vec.h"

namespace lumel {

/// A right-handed orthonormal basis whose third axis is `n` (Duff et al. 2017, JCGT 6(1)).
struct Frame {
    Vec3 s, t, n;

    explicit Frame(Vec3 normal) : n(normal) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        s = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        t = {b, sign + n.y * n.y * a, -n.y};
    }
    Vec3 to_local(Vec3 v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
    Vec3 to_world(Vec3 v) const { return s * v.x + t * v.y + n * v.z; }
};

/// `v`, turned as the unit vector `from` is turned into `to` on the shortest way; these are not opposite.
constexpr Vec3 turned(Vec3 v, Vec3 from, Vec3 to) {
    const Vec3 axis = cross(from, to);
    const float cosine = dot(from, to);
    return v * cosine + cross(axis, v) + axis * (dot(axis, v) / (1 + cosine));
}

/// The direction that a mirror of normal `m` sends `w` to; both point away from the surface.
constexpr Vec3 reflect(Vec3 w, Vec3 m) { return m * (2.0f * dot(w, m)) - w; }

}  // namespace lumel
