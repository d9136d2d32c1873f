#include "lumel/scene/material.h"

namespace lumel {

namespace {

/// Fresnel reflectance of one channel (Born and Wolf, section 14.2).
float conductor(float cos, float eta, float k) {
    const float cos2 = cos * cos, sin2 = 1.0f - cos2;
    const float t0 = eta * eta - k * k - sin2;
    const float a2b2 = std::sqrt(t0 * t0 + 4.0f * eta * eta * k * k);
    const float a = std::sqrt(std::max(0.0f, 0.5f * (a2b2 + t0)));
    const float s = a2b2 + cos2, t = 2.0f * a * cos;
    const float rs = (s - t) / (s + t);
    const float u = cos2 * a2b2 + sin2 * sin2, v = t * sin2;
    return 0.5f * (rs + rs * (u - v) / (u + v));
}

}  // namespace

Rgb Fresnel::operator()(float cos) const {
    if (!any) return {1, 1, 1};
    cos = std::clamp(cos, 1e-4f, 1.0f);
    return {conductor(cos, eta.x, k.x), conductor(cos, eta.y, k.y), conductor(cos, eta.z, k.z)};
}

float Material::mirror_choice() const {
    if (!is_mirror()) return 0;
    const float m = lum(mirror), rest = lum(diffuse) + lum(specular);
    return rest > 0 ? m / (m + rest) : 1.0f;
}

void Material::tabulate() {
    // a_s(wo) is the mean of F G1(wi) over visible normals, because w_s / pdf_w = F G1(wi).
    constexpr int kSide = 64;
    for (int node = 0; is_glossy() && node <= kNodes; ++node) {
        const float cos = std::max(1e-4f, sqr(static_cast<float>(node) / kNodes));
        const Vec3 wo{std::sqrt(1.0f - cos * cos), 0, cos};
        Rgb64 sum;
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j) {
                // The tail of the lobe, where it meets the horizon, lies at v = 1: steps of 1 - v = t^3 are fine there.
                const float t = (static_cast<float>(j) + 0.5f) / kSide;
                const Vec3 wi = ggx::sample(wo, alpha, {(static_cast<float>(i) + 0.5f) / kSide, 1.0f - t * t * t});
                if (wi.z > 0) sum += fresnel(0.5f * length(wi + wo)) * (3.0f * t * t * ggx::G1(wi.z, alpha));
            }
        albedo_[node] = specular * (sum * (1.0 / (kSide * kSide))).to_float();
    }
}

float Material::max_albedo() const {
    float most = 0;
    for (int node = 0; node <= kNodes; ++node)
        most = std::max(most, max_component(diffuse + albedo_[node] + mirror_reflectance(sqr(static_cast<float>(node) / kNodes))));
    return most;
}

}  // namespace lumel
