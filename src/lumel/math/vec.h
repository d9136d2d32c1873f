// Three floats: a point, a direction, or a colour.
#pragma once

#include <algorithm>
#include <cmath>

namespace lumel {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 1.0f / kPi;

struct Vec3 {
    float x = 0, y = 0, z = 0;

    constexpr float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
constexpr Vec3 operator/(Vec3 a, float s) { return a * (1.0f / s); }
constexpr Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
constexpr Vec3& operator*=(Vec3& a, Vec3 b) { return a = a * b; }
constexpr Vec3& operator*=(Vec3& a, float s) { return a = a * s; }
constexpr bool operator==(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(Vec3 a) { return a * (1.0f / length(a)); }
constexpr float max_component(Vec3 a) { return std::max(a.x, std::max(a.y, a.z)); }
constexpr float sqr(float x) { return x * x; }
constexpr double sqr(double x) { return x * x; }
/// Of each component the smaller one, or the larger one.
constexpr Vec3 min(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
constexpr Vec3 max(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
inline Vec3 square_root(Vec3 a) { return {std::sqrt(a.x), std::sqrt(a.y), std::sqrt(a.z)}; }

/// Linear Rec.709 colour; radiance in W/(m2 sr), flux in W, albedo in 0..1.
using Rgb = Vec3;

/// Luminance of a linear Rec.709 colour.
constexpr float lum(Rgb c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// A colour summed in double precision.
struct Rgb64 {
    double x = 0, y = 0, z = 0;

    constexpr Rgb64& operator+=(Rgb c) {
        x += c.x, y += c.y, z += c.z;
        return *this;
    }
    constexpr Rgb64& operator+=(Rgb64 c) {
        x += c.x, y += c.y, z += c.z;
        return *this;
    }
    constexpr Rgb to_float() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
};
constexpr Rgb64 to_double(Rgb c) { return {double{c.x}, double{c.y}, double{c.z}}; }
constexpr Rgb64 operator*(Rgb64 c, double s) { return {c.x * s, c.y * s, c.z * s}; }
constexpr Rgb64 operator*(Rgb64 a, Rgb64 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Rgb64 operator+(Rgb64 a, Rgb64 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Rgb64 operator-(Rgb64 a, Rgb64 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr bool operator==(Rgb64 a, Rgb64 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
constexpr double lum(Rgb64 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

}  // namespace lumel
