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
        // With very many lamps each is as likely as the next: a view costs time for every lamp it weighs.
        if (count_ > kMost) {
            total_ = static_cast<float>(count_);
            return;
        }
        for (uint32_t i = 0; i < count_; ++i) total_ += weight_[i] = i < areas.size() ? weigh(areas[i]) : weigh(points[i - areas.size()]);
    }

    bool is_dark() const { return !(total_ > 0); }

    /// `choice` in [0, 1) selects the lamp, `s` the point on it.
    LampSample sample(float choice, Square s) const {
        if (is_dark()) return {};
        float at = choice * total_;
        uint32_t i = 0;
        if (count_ > kMost) {
            i = std::min(static_cast<uint32_t>(at), count_ - 1);
            at -= static_cast<float>(i);
        } else {
            uint32_t last = 0;
            for (; i < count_; ++i) {
                if (weight_[i] > 0) last = i;
                if (at < weight_[i]) break;
                at -= weight_[i];
            }
            if (i == count_) i = last, at = 0;
        }
        const float weight = lamp_weight(i), rest = std::clamp(at / weight, 0.0f, 0.9999999f);
        const auto& areas = scene_->area_lamps();
        return i < areas.size() ? on_area(areas[i], rest, s, weight / total_)
                                : on_point(scene_->point_lamps()[i - areas.size()], weight / total_);
    }

    /// Density with which `sample` finds the point of a lamp's triangle that is `distance` away along `wi`, 1/sr.
    float pdf_w(uint32_t triangle, Vec3 wi, float distance) const {
        const auto lamp = static_cast<uint32_t>(scene_->lamp_of(triangle));
        if (is_dark()) return 0;
        return lamp_weight(lamp) / total_ * AreaLampView(*scene_, scene_->area_lamps()[lamp], x_->x).pdf_w(triangle, wi, distance);
    }

private:
    static constexpr uint32_t kMost = 96;

    float lamp_weight(uint32_t i) const { return count_ > kMost ? 1.0f : weight_[i]; }

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
