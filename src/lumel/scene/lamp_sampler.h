// Choose a point of a lamp as seen from a point of a surface: lamps by an estimate of what they contribute there.
#pragma once

#include <array>

#include "lumel/scene/area_lamp_view.h"
#include "lumel/scene/surface.h"

namespace lumel {

struct LampSample {
    Vec3 target;          ///< on the lamp, already off its surface: end of the shadow ray
    Vec3 wi;              ///< unit direction to it
    Rgb radiance;         ///< W/(m2 sr); of a point lamp: intensity / distance^2, W/m2 across the ray
    float pdf_w = 0;      ///< 1/sr; of a point lamp: probability of its choice. 0: no sample
    bool is_point = false;
};

/// Lamps as seen from one point. Build it, then sample any number of times.
class LampView {
public:
    /// With `wo` lamps count by what x reflects of them to there, without it by irradiance.
    explicit LampView(const Scene& scene, const Surface& x, const Vec3* wo = nullptr)
        : scene_(&scene), x_(&x), count_(scene.lamps().size()), glossy_(wo && x.material->is_glossy()) {
        if (glossy_) {
            const Material& m = *x.material;
            wo_ = *wo, cos_o_ = dot(x.shading, *wo);
            alpha_ = m.alpha, diffuse_ = lum(m.diffuse) * kInvPi, specular_ = lum(m.specular);
        }
        // A view costs time for every lamp that it weighs: among very many, one is found by the tree.
        if (count_ > kMost) return;
        if (count_ == 1)
            weight_[0] = 1;
        else if (glossy_)
            weigh_all<true>();
        else
            weigh_all<false>();
        for (uint32_t i = 0; i < count_; ++i) total_ += weight_[i];
    }

    /// `choice` in [0, 1) selects the lamp, `s` the point on it.
    LampSample sample(float choice, Square s) const {
        const Choice chosen = count_ > kMost ? choose_by_tree(choice) : choose(choice);
        if (!(chosen.probability > 0)) return {};
        const auto& areas = scene_->area_lamps();
        return chosen.lamp < areas.size() ? on_area(areas[chosen.lamp], chosen.rest, s, chosen.probability)
                                          : on_point(scene_->point_lamps()[chosen.lamp - areas.size()], chosen.probability);
    }

    /// Density with which `sample` finds the point of a lamp's triangle that is `distance` away along `wi`, 1/sr.
    float pdf_w(uint32_t triangle, Vec3 wi, float distance) const {
        const auto lamp = static_cast<uint32_t>(scene_->lamp_of(triangle));
        const float chosen = probability(lamp);
        return chosen > 0 ? chosen * AreaLampView(*scene_, scene_->area_lamps()[lamp], x_->x).pdf_w(triangle, wi, distance) : 0.0f;
    }

private:
    static constexpr uint32_t kMost = 96;
    static constexpr float kClosest = 1e-12f;  // m2

    struct Choice {
        uint32_t lamp = 0;
        float probability = 0, rest = 0;  ///< rest: what is left of the random number, uniform in [0, 1)
    };
    static constexpr float kBelowOne = 0.9999999f;

    Choice choose(float choice) const {
        if (!(total_ > 0)) return {};
        float at = choice * total_;
        uint32_t i = 0, last = 0;
        for (; i < count_; ++i) {
            if (weight_[i] > 0) last = i;
            if (at < weight_[i]) break;
            at -= weight_[i];
        }
        if (i == count_) i = last, at = 0;
        return {i, weight_[i] / total_, std::clamp(at / weight_[i], 0.0f, kBelowOne)};
    }
    Choice choose_by_tree(float choice) const {
        const LampTree& tree = scene_->lamp_tree();
        uint32_t at = 0;
        float probability = 1;
        while (!tree.node(at).is_leaf()) {
            const LampTree::Node& node = tree.node(at);
            const float left = weigh(tree.node(node.left)), right = weigh(tree.node(node.right)), sum = left + right;
            if (!(sum > 0)) return {};
            const float share = left / sum;
            const bool goes_left = choice < share;
            choice = std::clamp(goes_left ? choice / share : (choice - share) / (1 - share), 0.0f, kBelowOne);
            probability *= goes_left ? share : 1 - share;
            at = goes_left ? node.left : node.right;
        }
        return {tree.node(at).lamp, probability, choice};
    }
    float probability(uint32_t lamp) const {
        if (count_ <= kMost) return total_ > 0 ? weight_[lamp] / total_ : 0.0f;
        const LampTree& tree = scene_->lamp_tree();
        float probability = 1;
        for (uint32_t at = tree.leaf_of(lamp); tree.node(at).parent != LampTree::kNone; at = tree.node(at).parent) {
            const float own = weigh(tree.node(at)), other = weigh(tree.node(tree.sibling(at)));
            // Just as `choose_by_tree` computes it.
            const bool is_left = tree.node(tree.node(at).parent).left == at;
            const float share = (is_left ? own : other) / (own + other);
            probability *= own > 0 ? (is_left ? share : 1 - share) : 0.0f;
        }
        return probability;
    }

    /// Weigh all lamps; the compiler makes vector code of the loop.
    template <bool kGlossy>
    void weigh_all() {
        const LampArrays& l = scene_->lamps();
        const uint32_t count = count_;
        for (uint32_t i = 0; i < count; ++i) weight_[i] = weigh<kGlossy>(l, i);
    }
    float weigh(uint32_t lamp) const { return glossy_ ? weigh<true>(scene_->lamps(), lamp) : weigh<false>(scene_->lamps(), lamp); }
    /// Estimate of what a lamp contributes, never 0 where there may be something.
    template <bool kGlossy>
    [[gnu::always_inline]] float weigh(const LampArrays& l, uint32_t lamp) const {
        const Vec3 to = Vec3{l.x[lamp], l.y[lamp], l.z[lamp]} - x_->x, lamp_normal{l.nx[lamp], l.ny[lamp], l.nz[lamp]};
        const float radius = l.radius[lamp], above = dot(to, x_->normal) + radius;
        const float d2 = std::max(std::max(dot(to, to), 0.25f * sqr(radius)), kClosest), d = std::sqrt(d2);
        const float cos = l.round[lamp] - dot(to, lamp_normal) / d;
        // Seen from next to a flat lamp, some of it is in front although its centre is at the side.
        const float seen = std::max(std::min(1.0f, cos + 0.25f * sqr(radius) / d2), 0.02f);
        const float irradiance = l.power[lamp] * std::max(0.05f, std::min(1.0f, above / d)) * seen / d2;
        const float scattered = kGlossy ? irradiance * brdf(to / d, radius / d) : irradiance;
        return std::min(above, cos) > 0 ? scattered : 0.0f;
    }
    /// The same for all lamps of a node, which are somewhere in its ball.
    float weigh(const LampTree::Node& node) const {
        if (node.is_leaf()) return weigh(node.lamp);
        const Vec3 to = node.ball.centre - x_->x;
        const float above = dot(to, x_->normal) + node.ball.radius;
        if (!(above > 0)) return 0;
        const float d2 = std::max(dot(to, to), sqr(node.ball.radius)), d = std::sqrt(d2);
        return node.ball.power * std::max(0.05f, std::min(1.0f, above / d)) / d2 * (glossy_ ? brdf(to / d, node.ball.radius / d) : 1.0f);
    }
    /// BRDF for light from about `wi`, the lobe widened by what the lamp subtends, and never quite without the lobe.
    [[gnu::always_inline]] float brdf(Vec3 wi, float subtended) const {
        const float alpha = std::min(1.0f, alpha_ + 0.5f * subtended), cos_i = dot(x_->shading, wi);
        const Vec3 across = wi + wo_ - x_->shading * (cos_i + cos_o_);
        const float lobe = ggx::eval_with_pdf(cos_i, cos_o_, dot(across, across), alpha).f;
        return diffuse_ + specular_ * std::max(lobe * std::min(1.0f, cos_i / 0.05f), 0.1f * kInvPi);
    }
    LampSample on_area(const AreaLamp& lamp, float choice, Square s, float probability) const {
        const AreaLampView::Sample found = AreaLampView(*scene_, lamp, x_->x).sample(choice, s);
        return {found.y + found.normal * scene_->epsilon(), found.wi, lamp.radiance, probability * found.pdf_w, false};
    }
    LampSample on_point(const PointLamp& lamp, float probability) const {
        const Vec3 to = lamp.position - x_->x;
        const float d2 = dot(to, to);
        if (!(d2 > 0)) return {};
        return {lamp.position, to / std::sqrt(d2), lamp.intensity / d2, probability, true};
    }

    const Scene* scene_;
    const Surface* x_;
    uint32_t count_;
    float total_ = 0;
    bool glossy_;  // and looked at: then what follows is set
    Vec3 wo_;
    float cos_o_ = 0, alpha_ = 0, diffuse_ = 0, specular_ = 0;
    std::array<float, kMost> weight_;
};

}  // namespace lumel
