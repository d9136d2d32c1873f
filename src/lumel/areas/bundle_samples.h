// From the bundles of a step to samples of one glossy point: what comes of all their directions towards one eye.
#pragma once

#include <array>
#include <span>

#include "lumel/scene/surface.h"
#include "lumel/transfer/bundle.h"

namespace lumel {

/// The share of each bundle in f/q and g/q at a point of a side. With I the irradiance and C the cosine that the bundle has for the side,
///     f/q = I w_s / (cos(theta_i) q)      g/q = C lum(w_s) / (cos(theta_i) a_bar q)      q = n_s p + n_g p_g
/// of which all but I, C and a_bar is computed here, for all bundles at once; cos(theta_i) is geometric.
class BundleSamples {
public:
    static constexpr size_t kMost = 64;  ///< bundles at a time
    using Lane = std::array<float, kMost>;

    /// Directions of `bundles`, at most kMost.
    explicit BundleSamples(std::span<const Bundle> bundles);

    /// Evaluate the lobe at `x` towards `wo`. `density_w` is n_s p, `gather` n_g.
    void evaluate(const Surface& x, Vec3 wo, double density_w, double gather);
    /// w_s / (cos(theta_i) q) of bundle `i`; 0 where its light comes from below the surface.
    Rgb scatter(size_t i) const { return fresnel_.any ? specular_ * (share_[i] * fresnel_(cos_h_[i])) : specular_ * share_[i]; }
    bool is_lit(size_t i) const { return share_[i] > 0; }

private:
    size_t n_;
    Lane x_{}, y_{}, z_{};  // of the directions
    Lane share_{}, cos_h_{};
    Rgb specular_;
    Fresnel fresnel_;
};

}  // namespace lumel
