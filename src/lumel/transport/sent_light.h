// The light that all sides send along any one direction, made ready for many directions.
#pragma once

#include <array>
#include <span>

#include "lumel/transport/emitters.h"

namespace lumel {

/// What `SideSource::evaluate` says of the radiance of one side, for all sides at a time: diffuse light as one colour, and the lobes of all
/// records of a side evaluated together.
class SentLight {
public:
    /// Shading normals are those at the point of each patch with the barycentrics `at`. Lamps behind mirrors send nothing here,
    /// nor do sharp lobes.
    SentLight(const Scene& scene, const Emitters& emitters, Square at);

    /// Radiance of every side along the line of `direction`, towards the end that it faces, W/(m2 sr).
    void along(Vec3 direction, std::span<Rgb> sent) const;

private:
    /// The lobes that the records of a side make, but for what depends on the outgoing direction.
    struct Lobes {
        uint32_t side;
        const Material* material;
        Vec3 normal;
        Frame shading{{0, 0, 1}};
        std::array<float, kRecords> wi_x, wi_y, wi_z;  // local
        std::array<float, kRecords> r, g, b;  // tint flux G1(wi) / (4 cos(theta_i) area)
    };
    static Rgb reflected(const Lobes& lobes, Vec3 wo);
    Lobes lobes_of(uint32_t side, std::span<const Record> records, Square at) const;

    const Scene* scene_;
    Rgb homogeneous_;
    std::vector<Rgb> diffuse_;  // radiance of every side
    std::vector<Lobes> lobes_;  // of those that have records
};

}  // namespace lumel
