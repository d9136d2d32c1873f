// The defensive part of the sampling density: starts uniform by area, so that the density covers all that a lobe can see.
#pragma once

#include <cstdint>

#include "lumel/accel/accel.h"

namespace lumel {

/// Where defensive rays start: every side that light can reach, lit or not, and a sphere around an open scene (design: weighted
/// sampling needs p > 0 wherever the target density is). Directions are cosine-weighted, so n p_y / cos(theta_y) = n / (pi area).
struct DefensiveStarts {
    Distribution by_area;      ///< over sides; 0 where no light can come, and on perfect mirrors
    double sphere_area = 0;    ///< m2; 0 in a closed scene
    std::vector<uint8_t> reached;  ///< per face, 2 shape + back: did light come there? Empty where there are no lamps
    std::vector<uint32_t> closed;  ///< the closed surface of every triangle: see closed_surfaces. Empty where there are no lamps
    double area() const { return by_area.total() + sphere_area; }
    bool open() const { return sphere_area > 0; }
    /// Can light come to a face? As far as is known: to all where there are no lamps.
    bool reaches(const Scene& scene, uint32_t triangle, bool back) const {
        return reached.empty() || reached[size_t{scene.shape(triangle)} * 2 + back];
    }
};

/// Find out by walks from the lamps which shapes light can reach, and whether it can leave the scene.
DefensiveStarts survey(const Accel& accel, uint64_t seed);

}  // namespace lumel
