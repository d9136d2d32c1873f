// Light as it enters a transport: either replaced by its first reflection, or as the lamps themselves.
#pragma once

#include "lumel/transport/first_shot.h"

namespace lumel {

struct IlluminationConfig {
    bool first_shot = true;         ///< replace the lamps by their first reflection
    uint32_t direct_samples = 4;    ///< shadow rays a side for it
    Rgb homogeneous{};              ///< for tests, instead of lamps: see Emitters
    uint64_t stream = 0;            ///< key of the random numbers
};

/// What the lamps give to one replica of a transport.
class Illumination {
public:
    Illumination(const Accel& accel, const DefensiveStarts& reachable, const IlluminationConfig& config)
        : accel_(&accel), reachable_(&reachable), config_(config), emitters_(accel.scene()) {
        const Scene& scene = accel.scene();
        if (config.first_shot) {
            direct_ = direct_irradiance(accel, reachable, config.direct_samples, config.stream, emitters_);
            for (uint32_t side = 0; side < scene.sides(); ++side)
                emitters_.diffuse[side] = direct_[side] * scene.material(scene.triangle_of_side(side)).diffuse * scene.side_area(side);
            if (scene.has_mirrors()) emitters_.behind_mirror = emitted_flux(scene);
        } else {
            emitters_.diffuse = emitted_flux(scene);
            emitters_.spread_over_parts(scene);
        }
        emitters_.homogeneous = config.homogeneous;
        emitters_.point_lamps_direct = !config.first_shot;
        emitters_.point_lamps = !scene.point_lamps().empty() && (!config.first_shot || scene.has_mirrors());
    }

    /// Irradiance straight from the lamps, W/m2 per side; empty without the first shot.
    const std::vector<Rgb>& direct() const { return direct_; }

    /// Emitters that send the lamps' light: what surfaces reflect of it, or with no first shot what the lamps emit.
    const Emitters& emitters() const { return emitters_; }

    /// Draw anew the directions in which gloss sees the lamps; `part` of `parts`: see record_lamps.
    void refresh(uint64_t stream, Emitters& e, uint32_t part = 0, uint32_t parts = 1) const {
        if (config_.first_shot) record_lamps(*accel_, *reachable_, stream, e, part, parts);
    }

private:
    const Accel* accel_;
    const DefensiveStarts* reachable_;
    IlluminationConfig config_;
    Emitters emitters_;
    std::vector<Rgb> direct_;
};

}  // namespace lumel
