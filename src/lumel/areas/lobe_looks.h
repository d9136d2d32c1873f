// Looks along the lobe of an eye: gathered samples, and what they tell of the density of shooting.
#pragma once

#include <array>

#include "lumel/areas/tally.h"
#include "lumel/math/frame.h"
#include "lumel/scene/ggx.h"
#include "lumel/scene/surface.h"
#include "lumel/transfer/sight.h"

namespace lumel {

/// Looks from points of areas of interest, drawn by the visible normals of the lobe towards the eye. They wait until there are enough to
/// be answered together. Where the step gathers they are samples, and otherwise they tell what a transfer of the step along each of them
/// would add to G of its area.
class LobeLooks {
public:
    LobeLooks(const Scene& scene, const Step& step, Tally& tally) : scene_(scene), step_(step), tally_(tally) {}

    /// Go on with area `area` of the tally, whose measure is `size` times that of the density `density_a` below. Gives how many looks it
    /// gets; `stream` is the key of its random numbers.
    uint32_t begin(size_t area, double size, uint64_t stream) {
        area_ = area, size_ = size;
        return gathers() ? step_.gather_count(stream) : step_.look_count(tally_.size(), stream);
    }
    /// Look from x by the lobe towards `to_eye` (a unit vector). `density_a`: of x in the measure of the area, per m2 of surface.
    void draw(const Surface& x, Vec3 to_eye, float density_a, Square s) {
        const Frame frame(x.shading);
        const Vec3 wo = frame.to_local(to_eye);
        if (!(wo.z > 0 && density_a > 0)) return;
        const Vec3 wi = ggx::sample(wo, x.material->alpha, s), w = frame.to_world(wi);
        const float cos = dot(x.normal, w), pdf_w = ggx::pdf_w(wo, wi, x.material->alpha);
        if (!(pdf_w > 0 && cos > 0)) return;
        looks_[waiting_] = {x.off(scene_.epsilon()), w};
        drawn_[waiting_++] = {area_, size_, x.material->scatter_s(wi, wo), pdf_w, cos * (1 - x.material->mirror_choice()) / density_a};
        if (waiting_ == kMost) see();
    }
    /// Answer all that wait.
    void see() {
        step_.sight.see(std::span(looks_).first(waiting_), std::span(seen_).first(waiting_));
        for (uint32_t i = 0; i < waiting_; ++i) gathers() ? sample(drawn_[i], seen_[i]) : count(drawn_[i], seen_[i]);
        waiting_ = 0;
    }

private:
    static constexpr uint32_t kMost = 64;

    struct Drawn {
        size_t area;
        double size;
        Rgb scatter;  // w_s, 1/sr
        float pdf_w;  // p_g
        float cos_per_density;  // from n_s p / cos(theta_x), per m2 and sr, to the measure of the area
    };
    bool gathers() const { return step_.gather > 0; }
    /// What a transfer of the step along a look would add to G.
    void count(const Drawn& d, const Seen& seen) {
        if (seen.dark)
            tally_.add_dark_look(d.area, step_);
        else
            tally_.add_look(d.area, step_, double{lum(d.scatter)} / (double{seen.density} * double{d.cos_per_density}));
    }
    /// f/q and g/q of a look, with q = n_s p + n_g p_g for n_g looks in all. To n_s p belong bundles, beside what a look has seen. A point
    /// that no light can reach is no part of the area, so it counts neither as light nor as density.
    void sample(const Drawn& d, const Seen& seen) {
        if (seen.dark) return;
        const double q = double{seen.density} * double{d.cos_per_density} +
                         (step_.bundle_density_w() + step_.gather * double{d.pdf_w}) / d.size;
        tally_.add(d.area, step_, to_double(d.scatter) * to_double(seen.radiance) * (1 / q), double{lum(d.scatter)} / q);
    }

    const Scene& scene_;
    const Step& step_;
    Tally& tally_;
    size_t area_ = 0;
    double size_ = 1;
    uint32_t waiting_ = 0;
    std::array<Look, kMost> looks_;
    std::array<Seen, kMost> seen_;
    std::array<Drawn, kMost> drawn_;
};

}  // namespace lumel
