#include "lumel/areas/bundle_samples.h"

namespace lumel {

BundleSamples::BundleSamples(std::span<const Bundle> bundles) : n_(std::min(bundles.size(), kMost)) {
    for (size_t i = 0; i < n_; ++i) x_[i] = bundles[i].direction.x, y_[i] = bundles[i].direction.y, z_[i] = bundles[i].direction.z;
}

void BundleSamples::evaluate(const Surface& x, Vec3 wo, double density_w, double gather) {
    specular_ = x.material->specular, fresnel_ = x.material->fresnel;
    const Frame frame(x.shading);
    const Vec3 n = x.normal, s = frame.s, t = frame.t, m = frame.n, o = frame.to_local(wo);
    if (!(o.z > 0)) {
        share_.fill(0);
        return;
    }
    const float alpha = x.material->alpha, g1_o = ggx::G1(o.z, alpha), p_s = static_cast<float>(density_w),
                n_g = static_cast<float>(gather);
    for (size_t i = 0; i < n_; ++i) {
        // The end of the line that is in front of the surface.
        const float side = n.x * x_[i] + n.y * y_[i] + n.z * z_[i], sign = std::copysign(1.0f, side), cos = std::abs(side);
        const float ix = sign * (s.x * x_[i] + s.y * y_[i] + s.z * z_[i]), iy = sign * (t.x * x_[i] + t.y * y_[i] + t.z * z_[i]),
                    iz = sign * (m.x * x_[i] + m.y * y_[i] + m.z * z_[i]);
        const float hx = ix + o.x, hy = iy + o.y, hz = iz + o.z, h2 = hx * hx + hy * hy + hz * hz;
        // f_s cos(theta_i) and p_g have D G1(wo) / (4 cos(theta_o)) in common.
        const float visible = ggx::D(hz * hz / h2, alpha) * g1_o / (4 * o.z);
        const float scatter = visible * ggx::G1(std::max(iz, 0.0f), alpha);
        share_[i] = iz > 0 && cos > 0 ? scatter / (cos * (p_s + n_g * visible)) : 0.0f;
        cos_h_[i] = 0.5f * std::sqrt(h2);
    }
}

}  // namespace lumel
