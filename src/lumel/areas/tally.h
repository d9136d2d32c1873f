// Sums of f/q and g/q over steps, and their moments over replicas, for many areas of interest.
#pragma once

#include <vector>

#include "lumel/estimators/estimator.h"
#include "lumel/sampling/hash.h"
#include "lumel/transfer/bundle.h"
#include "lumel/transfer/sight.h"
#include "lumel/transfer/transfers.h"

namespace lumel {

/// A whole number whose mean is `expected`: the fraction is left to chance.
inline uint32_t at_random(double expected, uint64_t stream) {
    return static_cast<uint32_t>(expected + double{to_unit(static_cast<uint32_t>(stream >> 32))});
}

/// One step of a transport to measure. Its light counts `weight`; its densities count by its bundles, or its rays if it has none.
struct Step {
    const Transfers& transfers;  ///< of rays; without a density where there are bundles
    const Sight& sight;
    std::span<const Bundle> bundles = {};
    double weight = 1;
    double gather = 0;    ///< n_g: expected gathering rays for every area and eye; areas take turns for a fraction
    uint64_t stream = 0;  ///< key of the random numbers

    /// n_s, what densities of this step count by.
    double samples() const { return static_cast<double>(bundles.empty() ? transfers.rays : bundles.size()); }
    /// n_s p of the bundles, 1/sr: the same for all areas and directions.
    double bundle_density_w() const { return static_cast<double>(bundles.size()) * double{Bundle::kPdf_w}; }
    /// Rays that an area gathers in this step.
    uint32_t gather_count(uint64_t area_stream) const { return at_random(gather, area_stream); }
    /// Looks that only tell what the density covers, where nothing is gathered: a few, that cost up to a tenth of the step's rays in all.
    /// Bundles cover everything.
    uint32_t look_count(size_t areas, uint64_t area_stream) const {
        constexpr double kMost = 4, kShare = 0.1;
        if (!bundles.empty()) return 0;
        const double wanted = kShare * static_cast<double>(transfers.rays) / static_cast<double>(std::max<size_t>(areas, 1));
        return at_random(std::min(kMost, wanted), area_stream);
    }
};

class Tally {
public:
    Tally() = default;
    explicit Tally(size_t areas) : current_(areas), closed_(areas) {}

    size_t size() const { return current_.size(); }
    uint32_t replicas() const { return replicas_; }

    /// Add a sample of a step to an area: what it adds to its light and to its density.
    void add(size_t area, const Step& step, Rgb64 f, double g) {
        Sums& s = current_[area];
        f = f * step.weight, g *= step.samples();
        s.f += f, s.fg += f * g, s.g += g, s.gg += g * g;
        ++s.hits;
    }
    /// Add a sample that has no density.
    void add_plain(size_t area, const Step& step, Rgb64 f) {
        current_[area].plain += f * step.weight;
        ++current_[area].hits;
    }
    /// Count a look along the lobe of an area from a point that no light can reach.
    void add_dark_look(size_t area, const Step& step) {
        const auto rays = static_cast<double>(step.transfers.rays);
        closed_[area].looks += rays, closed_[area].looks_dark += rays;
    }
    /// Count another look; `size` is what a transfer along it would add to the density of the area, infinite where none can come.
    void add_look(size_t area, const Step& step, double size) {
        const auto rays = static_cast<double>(step.transfers.rays);
        Moments& m = closed_[area];
        m.looks += rays;
        (std::isfinite(size) ? m.looks_size : m.looks_uncovered) += std::isfinite(size) ? rays * size * rays : rays;
    }
    /// End a replica: `weight` is the sum of the weights of its light, `rays` the sum of the rays of its steps.
    void close_replica(double weight, double rays);
    /// Add the sums of `other`, over the same areas: its closed replicas to those here, its replica under way to the one here.
    void merge(const Tally& other);
    /// Samples of all closed replicas that are not 0.
    uint64_t hits(size_t area) const { return closed_[area].hits; }
    /// Means over replicas, with the covariances of these means.
    Samples samples(size_t area) const;

private:
    struct Sums {
        Rgb64 f, plain, fg;
        double g = 0, gg = 0;
        uint64_t hits = 0;

        Sums& operator+=(const Sums& o) {
            f += o.f, plain += o.plain, fg += o.fg, g += o.g, gg += o.gg, hits += o.hits;
            return *this;
        }
    };
    struct Moments {
        Rgb64 f, plain, ff, fg, plain2, single_fg;
        double g = 0, gg = 0, single_gg = 0, looks = 0, looks_dark = 0, looks_uncovered = 0, looks_size = 0;
        uint64_t hits = 0;

        Moments& operator+=(const Moments& o) {
            f += o.f, plain += o.plain, ff += o.ff, fg += o.fg, plain2 += o.plain2, single_fg += o.single_fg;
            g += o.g, gg += o.gg, single_gg += o.single_gg, looks += o.looks, looks_dark += o.looks_dark,
                looks_uncovered += o.looks_uncovered, looks_size += o.looks_size;
            hits += o.hits;
            return *this;
        }
    };
    std::vector<Sums> current_;
    std::vector<Moments> closed_;
    uint32_t replicas_ = 0;
    double rays_ = 0;  // of all closed replicas
};

/// Multiply the light of samples by `f` and their density by `g`.
Samples scaled(const Samples& samples, double f, double g);
/// Pool the samples of two areas, which are independent.
Samples pooled(const Samples& a, const Samples& b);

}  // namespace lumel
