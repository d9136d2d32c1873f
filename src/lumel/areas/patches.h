// Patches as areas of interest: the mean radiance that a patch sends to each eye.
#pragma once

#include <vector>

#include "lumel/estimators/estimator.h"
#include "lumel/transfer/sight.h"
#include "lumel/transfer/transfers.h"

namespace lumel {

/// Measures the indirect specular radiance of chosen glossy sides towards many eyes.
///
/// A transfer (x, wi, L_in, p) that lands on side A gives, with w_s = f_s cos(theta_i) towards the eye,
///     f/p = L_in w_s / (A p)      g/p = lum(w_s) / (a_bar A p)
/// where a_bar is the mean of lum(a_s) over the side, so that g integrates to 1 over it. Gathered samples join under one density: with
/// n_g rays a side and step, drawn by the lobe with density p_g, both kinds are divided by q = n_s p + n_g p_g. Then q > 0 wherever
/// g > 0, and no weight g/q exceeds max(g/p_g) / n_g.
class PatchAreas {
public:
    /// `measured`: glossy sides that scatter, in ascending order. `eyes`: positions.
    PatchAreas(const Scene& scene, std::vector<Vec3> eyes, std::vector<uint32_t> measured);

    uint32_t size() const { return static_cast<uint32_t>(sides_.size()); }
    uint32_t eyes() const { return static_cast<uint32_t>(eyes_.size()); }
    const std::vector<uint32_t>& sides() const { return sides_; }
    /// Index of a side among the measured ones, or Scene::kNone.
    uint32_t find(uint32_t side) const;
    /// Mean lum specular albedo of a measured side towards an eye; 0 where the side faces away.
    double albedo(uint32_t eye, uint32_t area) const { return albedo_[at(eye, area)]; }

    /// One step of a transport to measure. Its light counts `weight`; its densities count by its rays.
    struct Step {
        const Transfers& transfers;
        const Sight& sight;
        double weight = 1;
        double gather = 0;    ///< n_g: expected gathering rays for every side and eye; areas take turns for a fraction
        uint64_t stream = 0;  ///< key of the random numbers
    };
    void measure(const Step& step);
    /// End a replica: `weight` is the sum of the weights of its light, `rays` the sum of the rays of its steps.
    void close_replica(double weight, double rays);
    uint32_t replicas() const { return replicas_; }

    /// Sums not yet divided by area and albedo: samples of several areas can be pooled by addition.
    Samples unscaled(uint32_t eye, uint32_t area) const;
    /// Samples of one area as its estimator wants them.
    Samples samples(uint32_t eye, uint32_t area) const;

private:
    struct Sums {
        Rgb64 f, plain, fg;
        double g = 0, gg = 0;
        uint64_t hits = 0;

        void add(Rgb64 df, double dg) {
            f += df, fg += df * dg, g += dg, gg += dg * dg;
            ++hits;
        }
    };
    struct Moments {
        Rgb64 f, plain, ff, fg, plain2, single_fg;
        double g = 0, gg = 0, single_gg = 0;
        uint64_t hits = 0;
    };
    size_t at(uint32_t eye, uint32_t area) const { return size_t{area} * eyes_.size() + eye; }
    void measure_shot(const Step& step, uint32_t area);
    void measure_gathered(const Step& step, uint32_t area, uint32_t eye);

    const Scene* scene_;
    std::vector<Vec3> eyes_;
    std::vector<uint32_t> sides_;
    std::vector<double> albedo_;
    std::vector<Sums> current_;
    std::vector<Moments> closed_;
    uint32_t replicas_ = 0;
};

/// Bring unscaled sums over `area` m2 with the given integral of albedo over area (m2) to the estimators' form.
Samples scaled(const Samples& unscaled, double area, double albedo_area);

}  // namespace lumel
