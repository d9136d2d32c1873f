// Transport `bundles`: the whole scene shoots along one direction at a time ([WIS] 3.2).
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <optional>

#include "lumel/raster/transillumination.h"
#include "lumel/scene/surface.h"
#include "lumel/transfer/bundle.h"
#include "lumel/transport/walk.h"

namespace lumel {

/// Counters of all bundles cast so far.
struct BundleStats {
    SweepCounters raster;
    uint32_t window = 0;  ///< pixels of an edge
    // lum of flux, W/sr
    double sent = 0, received = 0;  ///< that left sides, and that arrived at sides
    double escaped = 0;             ///< that left the scene
    double mispaired = 0;           ///< see SweepCounters: what arrived at sides that no light of a sound mesh goes between

    BundleStats& operator+=(const BundleStats& o);
};

/// Casts bundles through a scene, one direction per thread at a time.
class BundleCaster {
public:
    /// Radiance of every side along the line of direction `index`, towards the end that it faces, W/(m2 sr).
    using Sent = std::function<void(uint32_t index, Vec3 direction, std::span<Rgb> sent)>;

    /// `window`: pixels a side of the square that directions are rasterised into; 0: about 16 a patch.
    BundleCaster(const Scene& scene, uint32_t window);

    /// One bundle for each of `directions`; windows are jittered by `stream`. The result is a pure function of the arguments.
    void cast(std::span<const Vec3> directions, uint64_t stream, const Sent& sent, std::vector<Bundle>& bundles, BundleStats& stats);

    uint32_t window() const { return window_; }

private:
    /// What one thread works with.
    struct Scratch {
        std::optional<Transillumination> buffer;
        std::vector<Rgb> sent, received;
        std::vector<uint32_t> pixels;
    };
    BundleStats cast_one(Vec3 direction, uint64_t stream, Scratch& scratch, Bundle& bundle) const;

    RasterScene scene_;
    uint32_t window_;
    tbb::enumerable_thread_specific<Scratch> scratch_;
};

/// Point `index` of a sequence of directions that is spread evenly over the hemisphere: a bundle goes both ways.
Vec3 bundle_direction(uint32_t index, uint64_t stream);

/// Bundles of a batch: enough for all threads and for vectors, few enough for memory.
uint32_t bundles_of_batch(const Scene& scene);

/// Irradiance that a bundle brings to a side as one sample of it, W/m2, with the adjoint factor of the shading normal at x.
inline Rgb sampled_irradiance(const Bundle& bundle, uint32_t side, const Surface& x) {
    return bundle.irradiance[side] * (adjoint(x.shading, x.normal, bundle.incoming(x.normal)) / Bundle::kPdf_w);
}

/// What a replica's bundles start from.
struct BundleConfig {
    uint32_t window = 0;  ///< see BundleCaster
    uint64_t solve_rays = 0;  ///< of the first generation of a solve by power
    uint64_t stream = 0;  ///< key of the random numbers
};

/// The light of one replica, carried by bundles.
class BundleLight {
public:
    BundleLight(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const BundleConfig& config);
    BundleLight(const BundleLight&) = delete;
    BundleLight& operator=(const BundleLight&) = delete;
    virtual ~BundleLight() = default;

    /// Cast `directions` bundles and hand them to `sink`, in batches.
    virtual void step(uint32_t directions, const Sink& sink) = 0;

    const BundleStats& stats() const { return stats_; }
    /// Rays shot: for the solve, for records, and for the light that bundles do not carry.
    uint64_t rays() const { return rays_; }

protected:
    /// Rays of a step that draws records anew, or carries light over mirrors.
    uint64_t rays_beside() const;
    /// Shoot what bundles cannot carry, light over mirrors, by sharp lobes and of point lamps: it gets no density. Leaves what arrived in
    /// transfers_, received_ (W per side) and `next` (what of it is sent on).
    void shoot_beside(const Emitters& emitters, uint64_t stream, Emitters& next);

    const Accel* accel_;
    const DefensiveStarts* defensive_;
    const Illumination* light_;
    const Scene* scene_;
    BundleConfig config_;
    BundleCaster caster_;
    BundleStats stats_;
    uint64_t rays_ = 0;
    uint32_t batch_ = 0;  // number of the next one
    bool needs_rays_ = false;  // for mirrors or sharp lobes
    std::vector<Bundle> bundles_;
    Transfers transfers_;
    std::vector<Rgb> received_;
};

}  // namespace lumel
