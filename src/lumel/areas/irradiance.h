// The irradiance of every side as an area of interest, over independent replicas.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lumel/areas/tally.h"

namespace lumel {

/// One colour a side with the variance of it.
struct SideField {
    std::vector<Rgb> mean, variance;
};

/// Sums of one field over replicas.
class SideMoments {
public:
    explicit SideMoments(size_t sides) : sum_(sides), squares_(sides) {}

    /// Add the value of a replica.
    void add(size_t side, Rgb64 value) {
        sum_[side] += value;
        squares_[side] += value * value;
    }
    /// Mean over `replicas` and variance of that mean (0 with fewer than two).
    SideField field(uint32_t replicas) const;

private:
    std::vector<Rgb64> sum_, squares_;
};

/// The irradiance of every side with a density to weigh it by (Bekaert, Sbert, Willems 2000): g = cos(theta_i) / pi over the side. With
///     f/p = L_in cos(theta_i) / (A p)      g/p = cos(theta_i) / (pi A p)
/// the same estimators apply as to gloss. It asks for a p that covers the whole hemisphere.
class IrradianceAreas {
public:
    explicit IrradianceAreas(const Scene& scene) : scene_(&scene), tally_(scene.sides()) {}

    void measure(const Step& step);
    /// End a replica: see Tally.
    void close_replica(double weight, double rays) { tally_.close_replica(weight, rays); }
    /// Go back to the start, without a sample.
    void forget() { tally_ = Tally(tally_.size()); }
    /// Samples of one side.
    Samples samples(uint32_t side) const;
    /// Samples of a side that has any, in the mean.
    double mean_hits() const;
    /// Estimate all sides; neighbours are those next to a side in the scene's order of sides.
    SideField field(const Estimator& estimator) const;

private:
    void measure_shot(const Step& step, uint32_t side);
    void measure_bundles(const Step& step, uint32_t side);
    Samples around(uint32_t position) const;

    const Scene* scene_;
    Tally tally_;
    BySide<Carried> plain_;  // of the last step
};

}  // namespace lumel
