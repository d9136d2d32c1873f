// The first shot: replace the lamps by the light that they send to the surfaces directly, so that small bright lamps make no noise.
#pragma once

#include "lumel/transport/defensive.h"
#include "lumel/transport/emitters.h"

namespace lumel {

/// Direct irradiance of every side that light can reach, W/m2 (per side, RGB), from `samples` points with one shadow ray each. The first of
/// them leave their directions in `emitters`, for glossy sides, and all what the parts of divided sides reflect.
std::vector<Rgb> direct_irradiance(const Accel& accel, const DefensiveStarts& reachable, uint32_t samples, uint64_t stream,
                                   Emitters& emitters);

/// Draw anew, for glossy sides, directions to lamps with the light that comes from there; the other records stay. Only every `parts`-th
/// side is drawn, those that leave the remainder `part`: where there are more sides than rays, old directions serve a few steps.
void record_lamps(const Accel& accel, const DefensiveStarts& reachable, uint64_t stream, Emitters& emitters, uint32_t part = 0,
                  uint32_t parts = 1);

/// Flux that the lamps emit from each side, W. Point lamps are not on it.
std::vector<Rgb> emitted_flux(const Scene& scene);

}  // namespace lumel
