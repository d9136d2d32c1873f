#include "lumel/areas/tally.h"

namespace lumel {

void Tally::close_replica(double weight, double rays) {
    const double per_weight = weight > 0 ? 1 / weight : 0, per_ray = rays > 0 ? 1 / rays : 0;
    for (size_t i = 0; i < current_.size(); ++i) {
        const Sums& s = current_[i];
        const Rgb64 f = s.f * per_weight, plain = s.plain * per_weight;
        const double g = s.g * per_ray;
        Moments& m = closed_[i];
        m.f += f, m.plain += plain, m.ff += f * f, m.fg += f * g, m.plain2 += plain * plain;
        m.g += g, m.gg += g * g, m.hits += s.hits;
        m.single_fg += s.fg * (per_weight * per_ray), m.single_gg += s.gg * (per_ray * per_ray);
        current_[i] = {};
    }
    ++replicas_;
    rays_ += rays;
}

void Tally::merge(const Tally& other) {
    for (size_t i = 0; i < current_.size(); ++i) current_[i] += other.current_[i], closed_[i] += other.closed_[i];
    replicas_ += other.replicas_;
    rays_ += other.rays_;
}

Samples Tally::samples(size_t area) const {
    const Moments& m = closed_[area];
    const double r = std::max(1u, replicas_);
    Samples s{.f = m.f * (1 / r),
              .g = m.g / r,
              .plain = m.plain * (1 / r),
              .fg = m.single_fg * (1 / (r * r)),
              .gg = m.single_gg / (r * r),
              .hits = m.hits,
              .replicas = replicas_,
              .looks = m.looks,
              .looks_dark = m.looks_dark,
              .looks_uncovered = m.looks_uncovered,
              .looks_size = rays_ > 0 ? m.looks_size / rays_ : 0};
    if (replicas_ < 2) return s;
    const double scale = 1 / (r * (r - 1));
    s.var_f = (m.ff - m.f * m.f * (1 / r)) * scale;
    s.cov_fg = (m.fg - m.f * (m.g / r)) * scale;
    s.var_plain = (m.plain2 - m.plain * m.plain * (1 / r)) * scale;
    s.var_g = (m.gg - m.g * m.g / r) * scale;
    return s;
}

Samples scaled(const Samples& u, double f, double g) {
    Samples s = u;
    s.f = u.f * f, s.g = u.g * g, s.plain = u.plain * f;
    s.var_f = u.var_f * (f * f), s.cov_fg = u.cov_fg * (f * g), s.var_plain = u.var_plain * (f * f), s.var_g = u.var_g * (g * g);
    s.fg = u.fg * (f * g), s.gg = u.gg * (g * g), s.looks_size = u.looks_size * g;
    return s;
}

Samples pooled(const Samples& a, const Samples& b) {
    Samples s = a;
    s.f += b.f, s.plain += b.plain, s.g += b.g, s.hits += b.hits, s.fg += b.fg, s.gg += b.gg;
    s.replicas = std::max(a.replicas, b.replicas);
    s.looks += b.looks, s.looks_dark += b.looks_dark, s.looks_uncovered += b.looks_uncovered, s.looks_size += b.looks_size;
    s.var_f += b.var_f, s.cov_fg += b.cov_fg, s.var_plain += b.var_plain, s.var_g += b.var_g;
    return s;
}

}  // namespace lumel
