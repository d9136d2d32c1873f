// One side as a source of rays: draw points and directions, and tell the radiance and the marginal density of any such pair.
#pragma once

#include "lumel/math/vec_array.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"
#include "lumel/transport/emitters.h"

namespace lumel {

/// Rays that leave one side together, each quantity an array over them. The first four are what they are drawn from.
struct Leaving {
    static constexpr uint32_t kMost = 64;
    using Floats = std::array<float, kMost>;
    static_assert(kMost % kSideBySide == 0);

    uint32_t size = 0;
    std::array<double, kMost> at;                     ///< position in the power of the side that owns the direction, W
    Floats point_u, point_v, direction_u, direction_v;  ///< random numbers
    Vec3Array<kMost> y;                               ///< start
    std::array<bool, kMost> covered;                  ///< whether no light can reach the start: see Cover
    Vec3Array<kMost> shading;                         ///< shading normal there
    Vec3Array<kMost> w;                               ///< unit direction; it may point below the surface
    Vec3Array<kMost> radiance;                        ///< W/(m2 sr)
    Floats pdf_aw;                                    ///< n p_y of all lobes together, rays/(m2 sr), without the defensive part
};

class SideSource {
public:
    /// Radiance along one direction, and n p_y: the expected number of rays per dA dw.
    struct Emission {
        Rgb radiance;       ///< W/(m2 sr)
        Rgb behind_mirror;  ///< radiance that counts once a mirror has been passed
        float pdf_aw = 0;   ///< of all lobes together, rays/(m2 sr), without the defensive part
        Rgb sharp{};        ///< the part of `radiance` that lobes too narrow for bundles send
    };

    /// `rays_per_watt`: rays shot for each watt of lum power. `part`: of a side whose light the emitters keep apart, see Emitters::part_of.
    SideSource(const Scene& scene, const Emitters& emitters, uint32_t side, double rays_per_watt, uint32_t part = kWhole);

    uint32_t side() const { return side_; }
    uint32_t part() const { return part_; }
    Vec3 normal() const { return normal_; }
    Rgb behind_mirror() const { return behind_mirror_; }
    /// The part of a radiance of this side that lobes too narrow for bundles send.
    Rgb sharp(Rgb radiance) const { return records_.empty() || !is_sharp(*material_) ? Rgb{} : radiance - diffuse_; }

    /// Draw points uniform on the patch or its part, with their shading normals.
    void draw_points(Leaving& rays) const;
    /// Draw directions by the lobes that own the positions `at`, which must ascend.
    void draw_directions(Leaving& rays) const;
    /// Draw directions around the geometric normal with density cos/pi.
    void draw_cosine(Leaving& rays) const { draw_cosine(rays, rays.size); }
    /// Evaluate all rays, whichever way they were drawn ([WIS] 3.1 with the marginal over all lobes).
    void evaluate(Leaving& rays) const;
    /// Evaluate direction `w` from a point with the shading normal `shading`.
    Emission evaluate(Vec3 shading, Vec3 w) const;

private:
    /// Points in the patch.
    struct Barycentrics {
        Leaving::Floats u, v;
    };
    Barycentrics barycentrics(const Leaving& rays) const;
    void draw_cosine(Leaving& rays, uint32_t count) const;
    float power_of(const Record& record) const { return record.is_of(part_) ? record.power : 0; }
    void draw_lobe(Leaving& rays, uint32_t from) const;
    void add(const Record& record, const Leaving::Floats& cos_o, Leaving& rays) const;

    const Scene* scene_;
    const Material* material_;
    uint32_t side_, part_;
    float area_, density_;
    Vec3 normal_;  // geometric, on this side
    Rgb diffuse_;  // radiance, as the two below
    Rgb behind_mirror_, homogeneous_;
    float cosine_power_;
    std::span<const Record> records_;
};

}  // namespace lumel
