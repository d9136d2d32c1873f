#include "stats.h"

#include <algorithm>
#include <numeric>

namespace lumel::test {

namespace {

constexpr double kPi64 = 3.14159265358979323846;

}  // namespace

double chi_square_tail(double x, int degrees) {
    const double a = 0.5 * degrees, y = 0.5 * x;
    if (!(y > 0)) return 1;
    const double front = std::exp(-y + a * std::log(y) - std::lgamma(a));
    if (y < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < 10000 && term > 1e-15 * sum; ++n) sum += term *= y / (a + n);
        return 1 - front * sum;
    }
    double b = y + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = 1 / (an * d + b), c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return front * h;
}

double student_two_sided(double t, int degrees) {
    if (!std::isfinite(t)) return std::isnan(t) ? 1.0 : 0.0;
    // With t = sqrt(n) tan(x), the density is proportional to cos(x)^(n-1): integrate by the midpoint rule.
    constexpr int kSteps = 2000;
    const double n = degrees, from = std::atan(t / std::sqrt(n)), width = (0.5 * kPi64 - from) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += std::pow(std::cos(from + (i + 0.5) * width), n - 1);
    return 2 * sum * width * std::exp(std::lgamma(0.5 * (n + 1)) - std::lgamma(0.5 * n)) / std::sqrt(kPi64);
}

double student_quantile(double significance, int degrees) {
    double low = 0, high = 1e4;
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (student_two_sided(middle, degrees) > significance ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

Mean mean_of(std::span<const double> values) {
    Mean m{0, 0, static_cast<int>(values.size())};
    for (double v : values) m.value += v / m.count;
    for (double v : values) m.error += (v - m.value) * (v - m.value);
    m.error = std::sqrt(m.error / (m.count * (m.count - 1.0)));
    return m;
}

bool holm_keeps_all(std::vector<double> p_values, double significance) {
    // Holm rejects something exactly if Bonferroni rejects the smallest.
    return p_values.empty() || *std::min_element(p_values.begin(), p_values.end()) >= significance / static_cast<double>(p_values.size());
}

double chi_square_p(std::span<const double> observed, std::span<const double> expected) {
    double chi2 = 0, rest_observed = 0, rest_expected = 0;
    int cells = 0;
    const auto add = [&](double o, double e) { chi2 += (o - e) * (o - e) / e, ++cells; };
    for (size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] >= 5) {
            add(observed[i], expected[i]);
        } else {
            rest_observed += observed[i], rest_expected += expected[i];
        }
    }
    if (rest_expected >= 1) {
        add(rest_observed, rest_expected);
    } else if (rest_observed > 10) {
        return 0;  // where next to nothing was expected
    }
    return chi_square_tail(chi2, cells - 1);
}

double chi_square_directions(const std::function<Vec3(Rng&)>& draw, const std::function<double(Vec3)>& pdf_w, Vec3 axis, int draws,
                             uint64_t seed) {
    // Cells are rings around the axis, narrow near it, cut into sectors.
    constexpr int kRings = 24, kSectors = 16, kFine = 24;
    const Frame frame(axis);
    const auto edge = [](double ring) { return kPi64 * std::pow(ring / kRings, 2.5); };
    std::vector<double> observed(kRings * kSectors + 1), expected(observed.size());
    double inside = 0;
    for (int ring = 0; ring < kRings; ++ring)
        for (int sector = 0; sector < kSectors; ++sector) {
            double sum = 0;
            for (int i = 0; i < kFine; ++i)
                for (int j = 0; j < kFine; ++j) {
                    // Equal steps of the cosine are equal solid angles.
                    const double c0 = std::cos(edge(ring)), c1 = std::cos(edge(ring + 1));
                    const double z = c0 + (c1 - c0) * (i + 0.5) / kFine, r = std::sqrt(std::max(0.0, 1 - z * z));
                    const double phi = 2 * kPi64 * (sector + (j + 0.5) / kFine) / kSectors;
                    const Vec3 local{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)), static_cast<float>(z)};
                    sum += pdf_w(frame.to_world(local)) * (c0 - c1) * 2 * kPi64 / kSectors / (kFine * kFine);
                }
            expected[ring * kSectors + sector] = sum * draws;
            inside += sum;
        }
    expected.back() = std::max(0.0, 1 - inside) * draws;

    Rng rng(seed);
    for (int i = 0; i < draws; ++i) {
        const Vec3 w = draw(rng);
        if (dot(w, w) == 0) {
            ++observed.back();
            continue;
        }
        const Vec3 local = frame.to_local(w);
        const double theta = std::atan2(std::hypot(local.x, local.y), local.z);
        double phi = std::atan2(local.y, local.x);
        if (phi < 0) phi += 2 * kPi64;
        const int ring = std::clamp(static_cast<int>(kRings * std::pow(theta / kPi64, 0.4)), 0, kRings - 1);
        const int sector = std::clamp(static_cast<int>(phi / (2 * kPi64) * kSectors), 0, kSectors - 1);
        ++observed[ring * kSectors + sector];
    }
    return chi_square_p(observed, expected);
}

}  // namespace lumel::test
