// What surfaces are made of: Lambert + one GGX lobe + a perfect mirror, each with its share in RGB.
#pragma once

#include <array>
#include <string>

#include "lumel/scene/ggx.h"

namespace lumel {

/// Unpolarised reflectance of a smooth interface of complex index eta + i k; `any` false means 1 for all angles.
struct Fresnel {
    bool any = false;
    Rgb eta{1, 1, 1}, k{};

    Rgb operator()(float cos) const;
};

struct Material {
    std::string name;
    Rgb diffuse{};        ///< diffuse albedo, 0..1
    Rgb specular{};       ///< tint of the GGX lobe, 0..1
    Rgb mirror{};         ///< tint of the perfect mirror, 0..1
    float alpha = 0.1f;   ///< GGX roughness, 0.001..1
    Fresnel fresnel;
    bool two_sided = true;

    bool is_glossy() const { return max_component(specular) > 0; }
    bool is_mirror() const { return max_component(mirror) > 0; }

    /// Specular scattering density w_s = f_s cos(theta_i), 1/sr; directions local to the shading frame.
    Rgb scatter_s(Vec3 wi, Vec3 wo) const {
        const ggx::Lobe lobe = ggx::eval(wi, wo, alpha);
        const Rgb tint = specular * lobe.f_cos;
        return fresnel.any ? tint * fresnel(lobe.cos_h) : tint;
    }
    /// Specular albedo a_s of the direction with cosine `cos` to the shading normal, from a table made by `tabulate`.
    Rgb albedo_s(float cos) const {
        const float at = std::sqrt(std::clamp(cos, 0.0f, 1.0f)) * kNodes;
        const int i = std::min(static_cast<int>(at), kNodes - 1);
        const float t = at - static_cast<float>(i);
        return albedo_[i] * (1.0f - t) + albedo_[i + 1] * t;
    }
    Rgb mirror_reflectance(float cos) const { return mirror * fresnel(cos); }

    /// Probability that a path which meets the surface is continued by the mirror, and not by what else the surface does.
    float mirror_choice() const;
    /// Whether all light that it scatters goes by the mirror.
    bool is_perfect_mirror() const { return mirror_choice() >= 1; }

    /// Integrate the lobe for the table of `albedo_s`. Call once after the fields are set.
    void tabulate();
    /// Largest albedo (diffuse + specular + mirror, over channels and tabulated angles); physical if <= 1.
    float max_albedo() const;

private:
    static constexpr int kNodes = 64;
    std::array<Rgb, kNodes + 1> albedo_{};  // of cos = (i/kNodes)^2, dense at grazing angles where it bends
};

}  // namespace lumel
