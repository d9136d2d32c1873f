// Looks along the lobe of an eye: gathered samples, and what they tell of the density of shooting.
#pragma once

#include <array>

#include "lumel/areas/tally.h"
#include "lumel/math/frame.h"
#include "lumel/scene/ggx.h"
#include "lumel/scene/surface.h"
#include "lumel/transfer/sight.h"

namespace lumel {

/// A few looks from points of one area of interest, drawn by the visible normals of the lobe towards the eye.
class LobeLooks {
public:
    static constexpr uint32_t kMost = 16;

    uint32_t size() const { return size_; }
    void clear() { size_ = 0; }
    /// Look from x by the lobe towards `to_eye` (a unit vector). `density_a`: of x in the measure of the area, per m2 of surface.
    void draw(const Scene& scene, const Surface& x, Vec3 to_eye, float density_a, Square s) {
        const Frame frame(x.shading);
        const Vec3 wo = frame.to_local(to_eye);
        if (!(wo.z > 0 && density_a > 0)) return;
        const Vec3 wi = ggx::sample(wo, x.material->alpha, s), w = frame.to_world(wi);
        const float cos = dot(x.normal, w), pdf_w = ggx::pdf_w(wo, wi, x.material->alpha);
        if (!(pdf_w > 0 && cos > 0)) return;
        looks_[size_] = {x.off(scene.epsilon()), w};
        drawn_[size_++] = {x.material->scatter_s(wi, wo), pdf_w, cos * (1 - x.material->mirror_choice()) / density_a};
    }
    void see(const Sight& sight) { sight.see(std::span(looks_).first(size_), std::span(seen_).first(size_)); }

    /// Count all looks for an area of `tally`: what a transfer of the step along each would add to G.
    void count(Tally& tally, size_t area, const Step& step) const {
        for (uint32_t i = 0; i < size_; ++i) {
            if (seen_[i].dark)
                tally.add_dark_look(area, step);
            else
                tally.add_look(area, step, double{lum(drawn_[i].scatter)} / (double{seen_[i].density} * double{drawn_[i].cos_per_density}));
        }
    }
    /// Hand f/q and g/q of every look to `add`, with q = n_s p + n_g p_g for `gather` = n_g looks in all. To n_s p belongs `density_aw`,
    /// that of bundles, beside what a look has seen.
    template <class Add>
    void samples(double density_aw, double gather, Add&& add) const {
        for (uint32_t i = 0; i < size_; ++i) {
            const Drawn& d = drawn_[i];
            const double q = double{seen_[i].density} * double{d.cos_per_density} + density_aw + gather * double{d.pdf_w};
            add(to_double(d.scatter) * to_double(seen_[i].radiance) * (1 / q), double{lum(d.scatter)} / q);
        }
    }

private:
    struct Drawn {
        Rgb scatter;  // w_s, 1/sr
        float pdf_w;  // p_g
        float cos_per_density;  // from n_s p / cos(theta_x), per m2 and sr, to the measure of the area
    };
    std::array<Look, kMost> looks_;
    std::array<Seen, kMost> seen_;
    std::array<Drawn, kMost> drawn_;
    uint32_t size_ = 0;
};

/// Call `draw(looks, i)` for 0 <= i < count, `LobeLooks::kMost` at a time, let `sight` answer, and hand the looks to `use`.
template <class Draw, class Use>
void look_around(uint32_t count, const Sight& sight, Draw&& draw, Use&& use) {
    LobeLooks looks;
    for (uint32_t first = 0; first < count; first += LobeLooks::kMost) {
        looks.clear();
        for (uint32_t i = first; i < std::min(count, first + LobeLooks::kMost); ++i) draw(looks, i);
        looks.see(sight);
        use(looks);
    }
}

}  // namespace lumel
