// Choose a point of a lamp as seen from a point of a surface: lamps by an estimate of what they contribute there.
#pragma once

#include <array>
#include <optional>

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
    explicit LampView(const Scene& scene, const Surface& x, const Vec3* wo = nullptr) : scene_(&scene), x_(&x) {
        if (wo && x.material->is_glossy()) {
            frame_.emplace(x.shading);
            wo_ = frame_->to_local(*wo);
        }
        const auto& areas = scene.area_lamps();
        const auto& points = scene.point_lamps();
        count_ = static_cast<uint32_t>(areas.size() + points.size());
        // A view costs time for every lamp that it weighs: among very many, one is found by the tree.
        if (count_ > kMost) return;
        for (uint32_t i = 0; i < count_; ++i) total_ += weight_[i] = weigh(i);
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

    float weigh(uint32_t lamp) const {
        const auto& areas = scene_->area_lamps();
        return lamp < areas.size() ? weigh(areas[lamp]) : weigh(scene_->point_lamps()[lamp - areas.size()]);
    }
    /// The same for all lamps of a node, which are somewhere in its ball.
    float weigh(const LampTree::Node& node) const {
        if (node.is_leaf()) return weigh(node.lamp);
        const Vec3 to = node.ball.centre - x_->x;
        const float above = dot(to, x_->normal) + node.ball.radius;
        if (!(above > 0)) return 0;
        const float d2 = std::max(dot(to, to), sqr(node.ball.radius)), d = std::sqrt(d2);
        return node.ball.power * std::max(0.05f, std::min(1.0f, above / d)) / d2 * brdf(to / d, node.ball.radius / d);
    }
    /// Estimate of the irradiance, never 0 where there may be some.
    float weigh(const AreaLamp& lamp) const {
        const Vec3 to = lamp.centre - x_->x;
        const float above = dot(to, x_->normal) + lamp.radius;
        if (!(above > 0)) return 0;
        const float d2 = std::max(dot(to, to), 0.25f * sqr(lamp.radius)), d = std::sqrt(d2);
        const float flatness = length(lamp.normal);
        float cos = 1;
        if (flatness > 0.9999f) {
            cos = -dot(to, lamp.normal) / (flatness * d);
            if (!(cos > 0)) return 0;
            // Seen from next to a flat lamp, some of it is in front although its centre is at the side.
            cos = std::min(1.0f, cos + 0.25f * sqr(lamp.radius) / d2);
        }
        const float irradiance = lum(lamp.radiance) * lamp.area * std::max(0.05f, std::min(1.0f, above / d)) * std::max(cos, 0.02f) / d2;
        return irradiance * brdf(to / d, lamp.radius / d);
    }
    float weigh(const PointLamp& lamp) const {
        const Vec3 to = lamp.position - x_->x;
        const float d2 = std::max(dot(to, to), 1e-12f), d = std::sqrt(d2), cos = dot(to, x_->normal);
        return cos > 0 ? lum(lamp.intensity) * std::max(0.05f, cos / d) / d2 * brdf(to / d, 0) : 0.0f;
    }
    /// BRDF for light from about `wi`, the lobe widened by what the lamp subtends, and never quite without the lobe.
    float brdf(Vec3 wi, float subtended) const {
        if (!frame_) return 1;
        const Material& m = *x_->material;
        const float alpha = std::min(1.0f, m.alpha + 0.5f * subtended);
        const Vec3 local = frame_->to_local(wi);
        const float lobe = ggx::eval(local, wo_, alpha).f_cos / std::max(local.z, 0.05f);
        return lum(m.diffuse) * kInvPi + lum(m.specular) * std::max(lobe, 0.1f * kInvPi);
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
    uint32_t count_ = 0;
    float total_ = 0;
    std::optional<Frame> frame_;  // of a glossy surface that is looked at
    Vec3 wo_;
    std::array<float, kMost> weight_;
};

}  // namespace lumel
