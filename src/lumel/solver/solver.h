// A solve: independent replicas of one transport, measured in irradiance of all sides and in areas of interest.
#pragma once

#include <memory>
#include <optional>

#include "lumel/areas/irradiance.h"
#include "lumel/areas/patches.h"
#include "lumel/areas/pixels.h"
#include "lumel/transport/rays.h"

namespace lumel {

enum class Transport { kWalk, kRays };

struct SolverConfig {
    Transport transport = Transport::kRays;
    float defensive = 0.1f;         ///< share of defensive rays, 0..1; a session chooses one if it is negative
    float gather = 0;               ///< gathering rays for every measured side, eye and full step; -1: a session chooses
    bool first_shot = true;         ///< compute direct light apart, and shoot its first reflection
    uint32_t direct_samples = 4;    ///< shadow rays a side and replica for the first shot
    Rgb homogeneous{};              ///< for tests: see IlluminationConfig
    uint64_t seed = 0;
};

/// Counters of all that was done so far.
struct SolverStats {
    uint64_t rays = 0;       ///< shooting rays
    uint64_t escaped = 0;    ///< of them, those that left the scene
    double lost_flux = 0;    ///< lum of the flux that left the scene, summed over steps as `weight` counts them
    std::vector<uint64_t> landed;  ///< per shape: transfers that ended there, of those that were measured
};

/// Work goes in the order begin_replica, step..., end_replica; pictures may be made after any end_replica.
/// All results are pure functions of scene, config and the sequence of calls, whatever the number of threads.
class Solver {
public:
    Solver(const Accel& accel, const DefensiveStarts& defensive, SolverConfig config, PatchAreas areas);
    /// Measure pixels too, from the first replica on.
    void measure_pixels(PixelAreas pixels) { pixels_ = std::move(pixels); }

    /// Give irradiance a density to weigh it by, from the first replica on.
    void weigh_irradiance() { irradiance_.emplace(accel_->scene()); }

    /// Start replica `replicas()`: its own first shot and, for `rays`, its own solution by power with about `solve_rays` rays.
    void begin_replica(uint64_t solve_rays);
    /// Shoot about `rays` rays: one step of `rays`, or one whole walk of `walk`.
    void step(uint64_t rays);
    /// The rays that a step of `rays` would trace first, in their order. `rays` transport only, in an open replica.
    std::vector<RayBlock> departures(uint64_t rays) const;
    /// Close the replica; its light counts as one sample. Does nothing if no step was made.
    void end_replica();

    /// Steps made in the replica under way.
    uint64_t steps() const { return steps_; }
    uint32_t replicas() const { return areas_.replicas(); }
    const SolverStats& stats() const { return stats_; }
    const PatchAreas& areas() const { return areas_; }
    /// Pixels, if they are measured too.
    const PixelAreas* pixels() const { return pixels_ ? &*pixels_ : nullptr; }
    /// Irradiance that was shot with its density, if it is weighed.
    const IrradianceAreas* irradiance() const { return irradiance_ ? &*irradiance_ : nullptr; }
    /// Irradiance straight from lamps (first shot), W/m2.
    SideField direct() const { return direct_.field(replicas()); }
    /// Irradiance that was shot, W/m2: indirect light, or all light without the first shot.
    SideField indirect() const { return indirect_.field(replicas()); }

private:
    void absorb(const Generation& generation, double weight);

    const Accel* accel_;
    const DefensiveStarts* defensive_;
    SolverConfig config_;
    PatchAreas areas_;
    std::optional<PixelAreas> pixels_;
    std::optional<IrradianceAreas> irradiance_;
    SolverStats stats_;
    SideMoments direct_, indirect_;

    // The replica under way
    std::unique_ptr<Illumination> light_;
    std::unique_ptr<FrozenLight> frozen_;
    std::vector<Rgb64> received_;
    double weight_ = 0, density_rays_ = 0;
    uint64_t steps_ = 0, generations_ = 0;
    double reflections_ = 3;  // rays of a whole walk over those of its first generation, as the last walk had it
};

}  // namespace lumel
