// Transfers that arrived on one side, made ready for many eyes.
#pragma once

#include "lumel/math/vec_array.h"
#include "lumel/scene/surface.h"
#include "lumel/transfer/transfers.h"

namespace lumel {

/// Each quantity is an array over the transfers, so that the lobes of all of them are evaluated side by side.
class Arrivals {
public:
    static constexpr uint32_t kMost = 64;

    explicit Arrivals(const Material& material) : material_(&material) {}

    uint32_t size() const { return size_; }
    bool is_full() const { return size_ == kMost; }
    void clear() { size_ = 0; }
    /// Add a transfer to `x`, if it comes from above both horizons.
    void add(const Surface& x, const Transfer& transfer);

    /// Evaluate what all of them send to `eye`, where `gather_density` rays a m2 are gathered for it.
    void look_from(Vec3 eye, float gather_density);
    /// Of the last look: what transfer `i` adds to the radiance (times m2), and to the density.
    Rgb64 f(uint32_t i) const { return {f_r_[i], f_g_[i], f_b_[i]}; }
    double g(uint32_t i) const { return g_[i]; }
    bool has_density(uint32_t i) const { return inv_pdf_[i] > 0; }

private:
    using Floats = std::array<float, kMost>;

    const Material* material_;
    uint32_t size_ = 0;
    Vec3Array<kMost> x_, shading_, wi_, flux_, scatter_;
    Floats cos_, cos_i_, inv_pdf_, gathered_;  // cosines to the geometric and to the shading normal
    std::array<double, kMost> f_r_, f_g_, f_b_, g_;
};

inline void Arrivals::add(const Surface& x, const Transfer& transfer) {
    const float cos = dot(x.normal, transfer.wi), cos_i = dot(x.shading, transfer.wi);
    if (!(cos > 0 && cos_i > 0)) return;
    x_.set(size_, x.x), shading_.set(size_, x.shading), wi_.set(size_, transfer.wi), flux_.set(size_, transfer.flux);
    cos_[size_] = cos, cos_i_[size_] = cos_i, inv_pdf_[size_] = transfer.inv_pdf;
    ++size_;
}

}  // namespace lumel
