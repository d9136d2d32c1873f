// The GGX microfacet lobe with separable Smith shadowing. Directions are local (z = shading normal) and point away from the surface.
#pragma once

#include "lumel/math/turns.h"
#include "lumel/math/vec.h"
#include "lumel/sampling/sobol.h"

namespace lumel::ggx {

/// Distribution of microfacet normals, 1/sr (Walter et al. 2007, eq. 33), of the squared cosine of the half vector.
inline float D(float cos2, float alpha) {
    const float a2 = alpha * alpha, d = cos2 * (a2 - 1.0f) + 1.0f;
    return a2 * kInvPi / (d * d);
}

/// Smith masking of one direction (Walter et al. 2007, eq. 34).
inline float G1(float cos, float alpha) { return 2.0f * cos / (cos + std::sqrt(alpha * alpha + (1.0f - alpha * alpha) * cos * cos)); }

/// The lobe times cos(theta_i) without Fresnel and tint, and the cosine between half vector and directions.
struct Lobe {
    float f_cos = 0, cos_h = 0;
};
inline Lobe eval(Vec3 wi, Vec3 wo, float alpha) {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    // D depends on the half vector's cosine through (wi + wo) alone, so its length need not be divided out twice.
    const Vec3 h = wi + wo;
    const float h2 = dot(h, h);
    return {D(h.z * h.z / h2, alpha) * G1(wi.z, alpha) * G1(wo.z, alpha) / (4.0f * wo.z), 0.5f * std::sqrt(h2)};
}

/// f cos(theta_i) / cos(theta_i) and the density of `sample` given `w`, which share most of their factors.
struct LobeAndDensity {
    float f = 0, pdf_w = 0, cos_h = 0;
};
/// By cosines, so that no local frame is needed: of `w` and `other` to the normal, and `across2`, the squared length of the part of
/// w + other that is perpendicular to the normal.
inline LobeAndDensity eval_with_pdf(float cos_w, float cos_other, float across2, float alpha) {
    const float above = std::min(cos_w, cos_other) > 0 ? 1.0f : 0.0f;
    const float a2 = alpha * alpha, along2 = sqr(cos_w + cos_other), h2 = across2 + along2;
    // G1(c)/c = 2 / (c + sqrt(a2 + (1 - a2) c^2)); below the horizon anything finite will do.
    const auto masking = [&](float cos) { return 2 / (std::max(cos, 0.0f) + std::sqrt(a2 + (1 - a2) * cos * cos)); };
    // D G1(w) / (4 cos_w), with the quotient by h2 in D multiplied out.
    const float density = above * 0.25f * kInvPi * a2 * sqr(h2 / (across2 + a2 * along2)) * masking(cos_w);
    return {density * masking(cos_other), density, 0.5f * std::sqrt(h2)};
}

/// Draw a microfacet normal visible from `w` (Dupuy and Benyoub 2023: spherical caps).
inline Vec3 sample_normal(Vec3 w, float alpha, Square s) {
    const Vec3 stretched = normalize({w.x * alpha, w.y * alpha, w.z});
    const CosSin turn = cos_sin_turns(s.u);
    const float z = (1.0f - s.v) * (1.0f + stretched.z) - stretched.z;
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const Vec3 h = Vec3{r * turn.cos, r * turn.sin, z} + stretched;
    return normalize({h.x * alpha, h.y * alpha, std::max(h.z, 0.0f)});
}

/// Draw the other direction of a reflection; it may point below the surface (z <= 0), where the lobe is 0.
inline Vec3 sample(Vec3 w, float alpha, Square s) {
    const Vec3 h = sample_normal(w, alpha, s);
    return h * (2.0f * dot(w, h)) - w;
}

/// Density of `sample` given `w`, 1/sr. It integrates to less than 1 over the upper side: the rest points below the surface.
inline float pdf_w(Vec3 w, Vec3 other, float alpha) {
    if (!(w.z > 0 && other.z > 0)) return 0;
    const Vec3 h = w + other;
    return G1(w.z, alpha) * D(h.z * h.z / dot(h, h), alpha) / (4.0f * w.z);
}

}  // namespace lumel::ggx
