// A short look at the light, to find out where it varies.
#pragma once

#include <array>
#include <vector>

#include "lumel/scene/lattice.h"
#include "lumel/scene/surface.h"
#include "lumel/transport/defensive.h"

namespace lumel {

/// What was found of one side of a cell, in luminance; light towards the eye is pi times its radiance, W/m2.
struct Finding {
    double light = 0;   ///< mean towards the eye
    double bend = 0;  ///< mean square of what is missed of its indirect part, if that is reconstructed from patches as large as the cell
    double spread = 0;  ///< variance of the radiosity in the cell: what is missed if it is sent from all of it alike
};

/// Solves roughly for the light of a coarse uniform tessellation, and gathers it at points of its patches, the cells.
class Pilot {
public:
    /// Indirect light is found for the sides `large`, and taken as the same everywhere on others. `first_shot`: direct light is computed
    /// apart, and not reconstructed.
    Pilot(const Accel& accel, const Lattice& lattice, const DefensiveStarts& reachable, std::span<const uint32_t> large, bool first_shot,
          uint64_t stream);

    /// Gather 12 * `rays` rays for each lobe, all points of the side with the same random numbers, so that differences have little noise.
    /// What is left has no part in the squares, which are products of two independent halves; so they may be negative. `eye`: a point that
    /// sees the side, or null; `border`: edges at which the reconstruction has no patches beyond.
    Finding look(uint32_t side, const Vec3* eye, const std::array<bool, 3>& border, uint32_t rays) const;

private:
    /// Light at the corners of a cell and in the middle of its edges, by one half of the rays.
    struct Half {
        std::array<double, 6> indirect;  // towards the eye
        std::array<double, 3> radiosity;
        double direct = 0;  // mean radiosity of direct light
    };
    Half half(uint32_t side, const Vec3* eye, uint32_t rays, uint64_t stream) const;
    /// Mean radiosity that rays meet which leave x by its diffuse lobe; by its specular one, times what it reflects of it.
    double irradiance(const Surface& x, uint32_t rays, uint64_t stream) const;
    double gloss(const Surface& x, Vec3 wo, uint32_t rays, uint64_t stream) const;
    double radiosity(const Ray& ray) const;
    double lamps(const Surface& x, uint64_t stream) const;
    /// Pool what all sides send, W/m2, at the vertices.
    void pool(std::span<const double> radiosity);

    const Accel& accel_;
    const Scene& scene_;
    const Lattice& lattice_;
    bool first_shot_;
    uint64_t stream_;
    std::vector<double> radiosity_;  // per vertex and face, W/m2
};

}  // namespace lumel
