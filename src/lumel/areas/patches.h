// Patches as areas of interest: the mean radiance that a patch sends to each eye.
#pragma once

#include <vector>

#include "lumel/areas/tally.h"

namespace lumel {

class BundleSamples;
class LobeLooks;

/// Measures the indirect specular radiance of chosen glossy sides towards many eyes.
///
/// A transfer (x, wi, L_in, p) that lands on side A gives, with w_s = f_s cos(theta_i) towards the eye,
///     f/p = L_in w_s / (A p)      g/p = lum(w_s) / (a_bar A p)
/// where a_bar is the mean of lum(a_s) over the side, so that g integrates to 1 over it. Gathered samples join under one density: with
/// n_g rays a side and step, drawn by the lobe with density p_g, both kinds are divided by q = n_s p + n_g p_g. Then q > 0 wherever
/// g > 0, and no weight g/q exceeds max(g/p_g) / n_g. A bundle is integrated over the side, so that its p is that of a direction alone.
class PatchAreas {
public:
    /// `measured`: glossy sides that scatter, in ascending order. `eyes`: positions.
    PatchAreas(const Scene& scene, std::vector<Vec3> eyes, std::vector<uint32_t> measured);

    uint32_t size() const { return static_cast<uint32_t>(sides_.size()); }
    uint32_t eyes() const { return static_cast<uint32_t>(eyes_.size()); }
    const std::vector<uint32_t>& sides() const { return sides_; }
    /// Pairs of an area and an eye that it faces.
    size_t measured() const {
        return static_cast<size_t>(std::count_if(albedo_.begin(), albedo_.end(), [](double a) { return a > 0; }));
    }
    /// m2
    double area(uint32_t area) const { return double{scene_->side_area(sides_[area])}; }
    /// Mean lum specular albedo of a measured side towards an eye; 0 where the side faces away.
    double albedo(uint32_t eye, uint32_t area) const { return albedo_[at(eye, area)]; }

    void measure(const Step& step);
    /// End a replica: see Tally.
    void close_replica(double weight, double rays) { tally_.close_replica(weight, rays); }
    /// Go back to the start, without a sample.
    void forget() { tally_ = Tally(tally_.size()); }
    uint32_t replicas() const { return tally_.replicas(); }

    /// Sums not yet divided by area and albedo: samples of several areas can be pooled by addition.
    Samples unscaled(uint32_t eye, uint32_t area) const { return tally_.samples(at(eye, area)); }
    uint64_t hits(uint32_t eye, uint32_t area) const { return tally_.hits(at(eye, area)); }
    /// Samples of one area as its estimator wants them.
    Samples samples(uint32_t eye, uint32_t area) const;

private:
    size_t at(uint32_t eye, uint32_t area) const { return size_t{area} * eyes_.size() + eye; }
    void measure_shot(const Step& step, uint32_t area);
    void measure_bundles(const Step& step, BundleSamples& samples, uint32_t area);
    /// Gather, or with nothing to gather look now and then what the density covers.
    void look(const Step& step, uint32_t area, uint32_t eye, LobeLooks& looks) const;

    const Scene* scene_;
    std::vector<Vec3> eyes_;
    std::vector<uint32_t> sides_;
    std::vector<double> albedo_;
    Tally tally_;
};

}  // namespace lumel
