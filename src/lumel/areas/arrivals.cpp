#include "lumel/areas/arrivals.h"

namespace lumel {

void Arrivals::look_from(Vec3 eye, float gather_density) {
    // w_s = f_s cos(theta_i) towards the eye, and n_g p_g, the density of gathering wi from there.
    const uint32_t count = size_;
    const float alpha = material_->alpha;
    const bool fresnel = material_->fresnel.any;
    Floats f_cos, cos_h;
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 shading = shading_[i], wo = normalize(eye - x_[i]);
        const float cos_o = dot(shading, wo);
        const Vec3 across = wi_[i] + wo - shading * (cos_i_[i] + cos_o);
        const ggx::LobeAndDensity lobe = ggx::eval_with_pdf(cos_o, cos_i_[i], dot(across, across), alpha);
        f_cos[i] = lobe.f * cos_i_[i];
        if (fresnel) cos_h[i] = lobe.cos_h;
        gathered_[i] = gather_density * lobe.pdf_w;
    }
    const Rgb tint = material_->specular;
    if (fresnel)
        for (uint32_t i = 0; i < count; ++i) scatter_.set(i, tint * material_->fresnel(cos_h[i]) * f_cos[i]);
    else
        for (uint32_t i = 0; i < count; ++i) scatter_.set(i, tint * f_cos[i]);

    // Divide by cos/inv_pdf = n_s p and n_g p_g together. With nothing gathered, and without a density, this is the plain quotient.
    for (uint32_t i = 0; i < count; ++i) {
        const double share = 1.0 / (double{cos_[i]} + double{gathered_[i]} * double{inv_pdf_[i]});
        f_r_[i] = double{scatter_.x[i]} * double{flux_.x[i]} * share;
        f_g_[i] = double{scatter_.y[i]} * double{flux_.y[i]} * share;
        f_b_[i] = double{scatter_.z[i]} * double{flux_.z[i]} * share;
        g_[i] = double{lum(scatter_[i])} * double{inv_pdf_[i]} * share;
    }
}

}  // namespace lumel
