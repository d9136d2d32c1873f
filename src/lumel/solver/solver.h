// A solve: independent replicas of one transport, measured in irradiance of all sides and in areas of interest.
#pragma once

#include <memory>
#include <optional>

#include "lumel/areas/irradiance.h"
#include "lumel/areas/patches.h"
#include "lumel/areas/pixels.h"
#include "lumel/transport/frozen_bundles.h"
#include "lumel/transport/iterated_bundles.h"

namespace lumel {

enum class Transport { kWalk, kRays, kBundles };

/// Rays, or bundles, that the number of gathering rays refers to.
inline constexpr double kRaysOfGather = 1 << 20, kBundlesOfGather = 1 << 10;

/// What bundles carry: the light of a state solved by power, or what the bundle before them brought ([WIS] 3.2).
enum class Iteration { kFrozen, kPlain };

struct SolverConfig {
    Transport transport = Transport::kRays;
    float defensive = 0.1f;         ///< share of defensive rays, 0..1; a session chooses one if it is negative
    float gather = 0;               ///< gathering rays for every measured side and eye, and kRaysOfGather
    bool first_shot = true;         ///< compute direct light apart, and shoot its first reflection
    uint32_t direct_samples = 4;    ///< shadow rays a side and replica for the first shot
    Rgb homogeneous{};              ///< for tests: see IlluminationConfig
    uint64_t seed = 0;
    Iteration iteration = Iteration::kFrozen;  ///< of bundles
    uint32_t window = 0;            ///< pixels of an edge of the window of a bundle; 0: chosen by the size of patches
};

/// Counters of all that was done so far.
struct SolverStats {
    uint64_t rays = 0;       ///< shooting rays
    uint64_t escaped = 0;    ///< of them, those that left the scene
    double lost_flux = 0;    ///< lum of the flux that left the scene, summed over steps as `weight` counts them
    std::vector<uint64_t>
        landed;  ///< per shape: transfers that ended there, and bundles that brought a side light, of those that were measured
    BundleStats bundles;
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

    /// Start replica `replicas()`: its own first shot and, but for `walk`, its own solution by power with about `solve_rays` rays.
    void begin_replica(uint64_t solve_rays);
    /// Shoot about `work` rays, one step of `rays` or one whole walk of `walk`; or cast `work` bundles.
    void step(uint64_t work);
    /// The rays that a step of `rays` would trace first, in their order. `rays` transport only, in an open replica.
    std::vector<RayBlock> departures(uint64_t rays) const;
    /// Close the replica; its light counts as one sample. Does nothing if no step was made.
    void end_replica();
    /// Go back to the start, as if no replica had been made.
    void forget();

    /// Steps made in the replica under way.
    uint64_t steps() const { return steps_; }
    uint32_t replicas() const { return areas_.replicas(); }
    SolverStats stats() const;
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
    static constexpr double kReflections = 3;  // before the first walk

    /// Start the transports that keep a state over the steps of a replica.
    void start_rays(uint64_t solve_rays);
    void start_bundles(uint64_t solve_rays);
    /// Measure what a step brought; it counts `weight`, and gets this share of the gathering rays of kRaysOfGather rays.
    void absorb(const Generation& generation, double weight, double full_steps);

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
    std::unique_ptr<BundleLight> bundles_;
    std::vector<Rgb64> received_;
    double weight_ = 0, density_rays_ = 0;
    uint64_t steps_ = 0, generations_ = 0;
    double reflections_ = kReflections;  // rays of a whole walk over those of its first generation, as the last walk had it
};

}  // namespace lumel
