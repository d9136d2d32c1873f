// One side as a source of rays: draw a point and a direction, and tell the radiance and the marginal density of any such pair.
#pragma once

#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"
#include "lumel/transport/emitters.h"

namespace lumel {

class SideSource {
public:
    /// Radiance along one direction, and n p_y: the expected number of rays per dA dw.
    struct Emission {
        Rgb radiance;       ///< W/(m2 sr)
        Rgb behind_mirror;  ///< radiance that counts once a mirror has been passed
        float pdf_aw = 0;   ///< of all lobes together, rays/(m2 sr), without the defensive part
        Rgb sharp{};        ///< the part of `radiance` that lobes too narrow for bundles send
    };

    /// `rays_per_watt`: rays shot for each watt of lum power.
    SideSource(const Scene& scene, const Emitters& emitters, uint32_t side, double rays_per_watt)
        : scene_(&scene),
          triangle_(scene.triangle_of_side(side)),
          back_(scene.is_back(side)),
          corners_(scene.place(scene.patch_of_side(side)).corners(scene.divisions(triangle_))),
          area_(scene.side_area(side)),
          density_(static_cast<float>(rays_per_watt / area_)),
          diffuse_(emitters.diffuse[side]),
          homogeneous_(emitters.homogeneous),
          records_(emitters.records_of(scene, side)) {
        if (!emitters.behind_mirror.empty()) behind_mirror_ = emitters.behind_mirror[side];
        cosine_power_ = lum(diffuse_) + lum(behind_mirror_) + lum(homogeneous_) * kPi * area_;
    }

    Surface draw_point(Square s) const {
        const Square b = square_to_triangle(s);
        const float w = 1 - b.u - b.v;
        const SurfacePoint p{triangle_, w * corners_[0].u + b.u * corners_[1].u + b.v * corners_[2].u,
                             w * corners_[0].v + b.u * corners_[1].v + b.v * corners_[2].v};
        return {*scene_, p, back_};
    }

    /// A direction from y by the lobe that owns position `at` of [0, power); it may point below the surface.
    Vec3 draw_direction(const Surface& y, double at, Square s) const {
        at -= cosine_power_;
        if (at >= 0) {
            const Record* chosen = nullptr;
            for (const Record& record : records_) {
                if (!(record.power > 0)) continue;
                chosen = &record;
                if ((at -= record.power) < 0) break;
            }
            if (chosen) {
                const Frame frame(y.shading);
                const Vec3 wi = frame.to_local(chosen->wi);
                if (!(wi.z > 0)) return -y.normal;
                // What points below the shading normal's horizon has no density: it is lost even where it is above the surface.
                const Vec3 wo = ggx::sample(wi, y.material->alpha, s);
                return wo.z > 0 ? frame.to_world(wo) : -y.normal;
            }
        }
        return draw_cosine(y, s);
    }
    static Vec3 draw_cosine(const Surface& y, Square s) { return Frame(y.normal).to_world(square_to_cosine_hemisphere(s)); }

    /// Evaluate direction `w` from `y`, whichever way it was drawn ([WIS] 3.1 with the marginal over all lobes).
    Emission evaluate(const Surface& y, Vec3 w) const {
        const float cos = std::max(0.0f, dot(y.normal, w));
        Emission e{diffuse_ * (kInvPi / area_), behind_mirror_ * (kInvPi / area_), cosine_power_ * cos * kInvPi};
        if (max_component(homogeneous_) > 0)
            e.radiance += homogeneous_ * (Rgb{1, 1, 1} - y.material->diffuse - y.material->albedo_s(dot(y.shading, w)));
        if (!records_.empty()) {
            const Frame frame(y.shading);
            const Vec3 wo = frame.to_local(w);
            Rgb lobes;
            for (const Record& record : records_) {
                if (!(record.power > 0)) continue;
                const Vec3 wi = frame.to_local(record.wi);
                if (!(wi.z > 0 && wo.z > 0)) continue;
                const ggx::LobeAndDensity lobe = ggx::eval_with_pdf(wi, wo, y.material->alpha);
                lobes += y.material->specular * y.material->fresnel(lobe.cos_h) * record.flux * (lobe.f / area_);
                e.pdf_aw += record.power * lobe.pdf_w;
            }
            e.radiance += lobes;
            if (is_sharp(*y.material)) e.sharp = lobes;
        }
        e.pdf_aw *= density_;
        return e;
    }

private:
    const Scene* scene_;
    uint32_t triangle_;
    bool back_;
    PatchCorners corners_;
    float area_, density_;
    Rgb diffuse_, behind_mirror_, homogeneous_;
    float cosine_power_ = 0;
    std::span<const Record> records_;
};

}  // namespace lumel
