// Directions of specular lobes, drawn side by side.
#pragma once

#include "lumel/accel/accel.h"
#include "lumel/scene/ggx.h"
#include "lumel/scene/surface.h"

namespace lumel {

/// A direction drawn from the specular lobe around `wo` of a surface.
struct LobeDraw {
    Vec3 wi;
    float pdf_w = 0;   ///< 1/sr; 0: none, it points below the surface
    float masked = 0;  ///< w_s / pdf_w without Fresnel and tint
    float cos_h = 0;   ///< between half vector and directions

    /// `shading`, `wo`: unit directions.
    LobeDraw() = default;
    LobeDraw(Vec3 shading, Vec3 wo, float alpha, Square s) {
        const Frame frame(shading);
        const Vec3 local_o = frame.to_local(wo), local_i = ggx::sample(local_o, alpha, s);
        wi = frame.to_world(local_i);
        set(local_o, local_i, alpha);
    }
    /// As if `wi` had been drawn.
    static LobeDraw along(Vec3 wi, Vec3 shading, Vec3 wo, float alpha) {
        LobeDraw draw;
        draw.wi = wi;
        const Frame frame(shading);
        draw.set(frame.to_local(wo), frame.to_local(wi), alpha);
        return draw;
    }
    /// w_s / pdf_w on a surface of this material.
    Rgb scatter(const Material& material) const {
        const Rgb tint = material.specular * masked;
        return material.fresnel.any ? tint * material.fresnel(cos_h) : tint;
    }

private:
    void set(Vec3 local_o, Vec3 local_i, float alpha) {
        pdf_w = ggx::pdf_w(local_o, local_i, alpha), masked = ggx::G1(local_i.z, alpha), cos_h = 0.5f * length(local_i + local_o);
    }
};

/// Lobes whose draws wait, each coordinate an array.
struct LobeBlock {
    static constexpr uint32_t kMost = RayBlock::kMost, kRoom = RayBlock::kRoom;

    uint32_t size = 0;
    Vec3Array<kRoom> shading, wo, wi;
    alignas(32) std::array<float, kRoom> alpha, u, v, pdf_w, masked, cos_h;

    void push(Vec3 normal, Vec3 w, float roughness, Square s) {
        shading.set(size, normal), wo.set(size, w), alpha[size] = roughness, u[size] = s.u, v[size] = s.v;
        ++size;
    }
    bool is_full() const { return size == kMost; }
    /// Draw all of them.
    void draw();
    LobeDraw operator[](uint32_t i) const {
        LobeDraw d;
        d.wi = wi[i], d.pdf_w = pdf_w[i], d.masked = masked[i], d.cos_h = cos_h[i];
        return d;
    }
};

}  // namespace lumel
